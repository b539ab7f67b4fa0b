// Modes of a scene: eigenvalues and shapes of small motions about its static equilibrium, about a steady rotation of
// all of it, or about a state on its way, with names that say what moves.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/scene/scene.hpp"
#include "libmbd/study/modes/mac.hpp"
#include "solvers/modes/eigenmodes.hpp"
#include "solvers/modes/steady_rotation.hpp"

namespace mbd {

// What linear studies say of a scene that has controllers.
inline constexpr std::string_view controllers_are_held =
    "outputs of controllers are held at what they are: small motions do not change them";

inline constexpr double small_component_error = 0.01;  // of a stiffness: nothing is said of less

// A mode, and what it is.
struct NamedMode : Mode {
  // Shares of kinetic energy, of beams and of nodes that are in none, the largest first.
  std::vector<std::pair<std::string, double>> parts;
  std::string name;  // `bending of beam "shaft" along b3`
  // Of a rotation: how nodes circle about the axis, and their tilts, as seen in the axes of the modes, weighted by kinetic
  // energy across the axis: 1 circles with the rotation, -1 against it, 0 lines. Empty without one, or where little moves across.
  std::optional<double> orbit = {};

  // Frequency in inertial axes [rad/s], positive with the rotation (forward whirl), negative against it. In turning axes,
  // of a mode whose orbits are circles: otherwise there are two frequencies and no whirl.
  std::optional<double> whirl(double rate, ModeAxes axes) const;
};

// Where one of the options below comes from, for reports: what <modes> of the scene says, or an option of the command.
struct AskedForModes {
  std::string name, value;
  bool by_scene = false;
};

struct ModesOptions {
  int count = ModesScene{}.count;
  double near = 0.0;                            // [rad/s]
  std::optional<SteadyRotation> rotation = {};  // otherwise it rests
  std::vector<std::string> at_rest = {};        // bodies and flexible beams that do not turn
  // [s] of a run: about its state then, with the coefficients that small motions have at that moment; without a rotation.
  std::optional<double> time = {};
  bool mac = false;                                    // of the modes among themselves
  std::shared_ptr<const ShapesOfModes> compared = {};  // or with these
  std::vector<AskedForModes> asked = {};
};

// Over which rates a scene turns.
struct RangeOfRates {
  SteadyRotation rotation = {};           // its axis; the rate is not used
  std::vector<std::string> at_rest = {};  // bodies and flexible beams that do not turn
  double from = 0.0, to = 0.0;            // rates [rad/s], from < to, not negative
};

// Throws Error, which begins with `what`, unless its rates are such.
void require_rising(const RangeOfRates& range, const std::string& what = "rates");

// Throws Error if the scene's run ends before then [s]: up to then the model says what happens.
void require_state_at(const Scene& scene, double time);

// As a scene asks for it. Its axis has a length (ModesScene::contradiction).
ModesOptions modes_options(const ModesScene& asked);

// Whether orbits are circles, for all that one can see.
inline constexpr double circular = 0.999;

struct ModesStudy {
  std::string model, file;
  std::optional<SteadyRotation> rotation;
  ModeAxes axes = ModeAxes::turning;  // of a rotation
  std::optional<double> time;         // [s] of the run
  double near = 0.0;                  // [rad/s]
  // Largest displacement of a node in the equilibrium, from the reference configuration [m], and which.
  double displacement = 0.0;
  std::string displaced;
  std::vector<std::string> nodes;   // names, the ground left out
  std::vector<Pose<double>> poses;  // of the nodes in equilibrium
  std::vector<NamedMode> modes;     // by frequency where `near` is 0, else by distance from it
  KrylovWork work;                  // that found them
  std::vector<AskedForModes> asked;
  std::optional<MacTable> mac;  // if it was asked for
  std::vector<std::string> notes;
};

// A scene compiled for small motions, in its equilibrium at rest, or in a state of a run of it.
class MotionsOfScene {
 public:
  // <static> says how equilibrium is found (default: as <static/>); <transient> and <path> are not used. Loads and
  // drives are as at t = 0. With a time [s], it is where states_of_run.hpp leads, with its velocities and accelerations.
  // Throws Error as compile() does, and where there is no equilibrium, or the run fails.
  explicit MotionsOfScene(const Scene& scene, std::optional<double> time = {});

  // Which nodes belong to bodies and flexible beams of these names, for SteadyRotation::rests. Throws Error for a name
  // that is neither.
  std::vector<char> nodes_of(const std::vector<std::string>& names) const;

  // To the steady rotation, from the equilibrium that there is. Small motions are in turning axes where they have
  // constant coefficients there, else in resting ones; what is found at the first call holds for the next. Throws Error where
  // the rotation is not found, where a drive does not go with it (unsteady_drive()), and where coefficients are constant in neither.
  void turn(const SteadyRotation& rotation);
  // Null: none.
  const SteadyRotation* rotation() const { return rotation_ ? &*rotation_ : nullptr; }
  ModeAxes axes() const { return axes_.value_or(ModeAxes::turning); }
  // In a steady rotation that has been found elsewise, in the axes of turn(), which has been called. Throws Error where
  // coefficients are not constant in these: forces of unbalance show with the rate.
  void settle(const SteadyRotation& rotation, const State& state);

  // Throws Error where motions near the state are not linear (linearizable.hpp).
  void require_linear();

  // As find_modes(), named. Throws Error where it fails, and as require_linear().
  std::vector<NamedMode> modes(const ModeOptions& options);
  const KrylovWork& work() const { return work_; }  // of all modes() so far

  // M times shapes (ShapesOfModes::shapes).
  Eigen::MatrixXcd mass_times(const Eigen::MatrixXcd& shapes) const;

  const Model& model() const { return model_; }
  const State& state() const { return state_; }
  SmallMotions& motions() { return *motions_; }
  const std::vector<std::string>& notes() const { return notes_; }
  // And in which range small motions about the state are linear, and what component modes are not right about.
  std::vector<std::string> notes_on_state() const;
  // The largest part of its stiffness that a <reduction> is wrong by (ComponentBatch::wrong_by; 1: not known), and why.
  double error_of_components(std::string* why = nullptr) const;
  std::pair<double, Index> largest_displacement() const;  // [m], node

  // A period of a mode as the motion of a run (libmbd/view/motion.hpp), frame by frame: `amplitude` times the size of the scene,
  // or radians, where it is largest. Without oscillation it grows from nothing. Throws Error if the file cannot be written.
  void write_motion(const Mode& mode, const std::filesystem::path& file, int frames = 48,
                    double amplitude = 0.05) const;

 private:
  void rest();
  void run_to(double time);
  IsDriven driven() const;
  void check_axes();
  std::string aside() const;
  void name(NamedMode& mode) const;
  // How nodes go round the axis of rotation (Mode::orbit); none where too little of the energy, of which there is `whole`,
  // goes across it. p: M times the shape.
  std::optional<double> orbit_of(const Mode& mode, const VecXc& p, double whole) const;

  Scene scene_;
  double duration_;  // [s] of the scene's own run
  Model model_;
  State state_;
  std::optional<ModeAxes> axes_;
  std::optional<SteadyRotation> rotation_;
  bool has_rank_ = false;  // constraints have been looked at
  double checked_ = 0.0;   // [rad/s] the fastest rate at which coefficients have been looked at
  std::unique_ptr<SmallMotions> motions_;
  std::vector<int> part_of_node_;                 // -1: none; else of part_names_
  std::vector<Quaternion<double>> axes_of_node_;  // section axes in its frame
  std::vector<std::string> part_names_;
  std::vector<std::string> notes_;
  KrylovWork work_;
};

// `motions`: directory that gets a directory mode_1, mode_2 … with a motion.bin for each mode; empty: none.
// Throws Error as MotionsOfScene does, and as mac_table() where modes are compared.
ModesStudy study_modes(const Scene& scene, const ModesOptions& options,
                       const std::filesystem::path& motions = {});

// The modes of a study, to be compared.
ShapesOfModes shapes_of(const ModesStudy& study);

}  // namespace mbd
