#include "libmbd/study/modes/modes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "elements/component/component_batch.hpp"
#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/study/modes/states_of_run.hpp"
#include "libmbd/text/files.hpp"
#include "libmbd/view/drawing.hpp"
#include "libmbd/view/motion.hpp"
#include "solvers/linear/block_solver.hpp"
#include "solvers/modes/linearizable.hpp"
#include "solvers/newton/increments.hpp"
#include "solvers/statics/statics.hpp"

namespace mbd {
namespace {

using Complex = std::complex<double>;

constexpr double most_of_it = 0.9;   // of the kinetic energy: a mode is named after it
constexpr double part_of_it = 0.05;  // and what else is named
constexpr double across = 0.1;       // of the kinetic energy, across the axis: orbits are looked at

// What moves in a mode, by components of kinetic energy in section axes, each half of Re x^H M x.
struct Energy {
  std::array<double, 6> of{};
  double total = 0.0;
};

std::string kind_of(const Energy& energy, bool is_beam) {
  const auto& e = energy.of;
  const double stretch = e[0], along2 = e[1], along3 = e[2], twist = e[3],
               turns = e[3] + e[4] + e[5], moves = e[0] + e[1] + e[2];
  if (!is_beam) {
    const std::array<const char*, 6> words{"moves along its axis 1", "moves along its axis 2",
                                           "moves along its axis 3", "turns about its axis 1",
                                           "turns about its axis 2", "turns about its axis 3"};
    const auto most = std::max_element(e.begin(), e.end());
    if (*most > most_of_it * energy.total) return words[static_cast<std::size_t>(most - e.begin())];
    return moves > turns ? "moves" : "turns";
  }
  const double whole = energy.total;
  if (twist > 0.5 * whole) return "twist";
  if (stretch > 0.5 * whole) return "stretching";
  if (along2 + along3 > 0.5 * whole) {
    if (along2 > most_of_it * (along2 + along3)) return "bending along b2";
    if (along3 > most_of_it * (along2 + along3)) return "bending along b3";
    return "bending";
  }
  return "motion";
}

// Names the beam in `bending along b2`: `bending of beam "b" along b2`.
std::string of_beam(std::string kind, const std::string& part) {
  const std::size_t blank = kind.find(' ');
  const std::string rest = blank == std::string::npos ? "" : kind.substr(blank);
  return kind.substr(0, blank) + " of " + part + rest;
}

// Where digits are lost that a reader would believe; empty if none are.
std::string note_on_round_off(const std::vector<NamedMode>& modes) {
  constexpr double believed = 1e-6;
  const auto worst = std::ranges::max_element(modes, {}, &Mode::round_off);
  if (worst == modes.end() || !(worst->round_off > believed)) return "";
  if (worst->residual > blurred)
    return fmt::format(
        "of mode {} about {:.0e} is unknown: solutions near it are none, as something moves freely "
        "that the mode does not need; "
        "hold it, or ask for modes near a frequency (--near)",
        worst - modes.begin() + 1, worst->round_off);
  return fmt::format(
      "round-off leaves about {:.0e} of mode {} unknown, in whose stiffness nearly all cancels: "
      "the mesh is finer than it "
      "needs to be; fewer elements, of a higher order, keep more digits",
      worst->round_off, worst - modes.begin() + 1);
}

double time_within(const Scene& scene, double time) {
  require_state_at(scene, time);
  return time > 0.0 ? time : 1.0;
}

}  // namespace

void require_rising(const RangeOfRates& range, const std::string& what) {
  if (!(range.from >= 0.0) || !(range.to > range.from) || !std::isfinite(range.to))
    throw Error(what + ": give two that rise and are not negative");
}

void require_state_at(const Scene& scene, double time) {
  constexpr double round_off = 1e-9;
  if (scene.transient && time > scene.transient->duration * (1.0 + round_off))
    throw Error(scene.transient->source,
                fmt::format("transient: ends at {:.6g} s, there is no state of it at {:.6g} s; ask "
                            "for an earlier one, or give it a longer duration",
                            scene.transient->duration, time));
}

ModesOptions modes_options(const ModesScene& asked) {
  ModesOptions options;
  options.count = asked.count;
  options.near = 2.0 * std::numbers::pi * asked.near;
  options.time = asked.at;
  options.mac = asked.mac;
  if (!asked.rate) return options;
  options.rotation = SteadyRotation{*asked.rate, asked.direction(), asked.point_of_axis(), {}};
  options.at_rest = asked.at_rest;
  return options;
}

std::optional<double> NamedMode::whirl(double rate, ModeAxes axes) const {
  constexpr double a_line = 1e-6;
  if (!orbit || !(std::abs(*orbit) > (axes == ModeAxes::turning ? circular : a_line)))
    return std::nullopt;
  const double sense = *orbit > 0.0 ? 1.0 : -1.0, frequency = sense * eigenvalue.imag();
  if (axes == ModeAxes::resting) return rate < 0.0 ? -frequency : frequency;
  return rate < 0.0 ? -(frequency + rate) : frequency + rate;
}

MotionsOfScene::MotionsOfScene(const Scene& scene, std::optional<double> time)
    // Inertia takes part, steps do not.
    : scene_(scene_of_run(scene, time_within(scene, time.value_or(0.0)))),
      duration_(scene.transient ? scene.transient->duration : 1.0) {
  if (!time && !scene_.statics) scene_.statics.emplace();
  model_ = compile(scene_);
  const System& system = *model_.system;
  motions_ = std::make_unique<SmallMotions>(system);
  if (time)
    run_to(*time);
  else
    rest();
  if (!scene_.controllers.empty()) notes_.push_back(std::string(controllers_are_held));

  const auto nodes = static_cast<std::size_t>(system.nodes());
  part_of_node_.assign(nodes, -1);
  axes_of_node_.assign(nodes, Quaternion<double>::Identity());
  for (const Model::Line& line : model_.lines) {
    const auto part = static_cast<int>(part_names_.size());
    part_names_.push_back("beam \"" + line.name + '"');
    for (std::size_t k = 0; k < line.size(); ++k) {
      const auto node = static_cast<std::size_t>(line.nodes[k]);
      if (node == 0 || part_of_node_[node] >= 0) continue;
      part_of_node_[node] = part;
      axes_of_node_[node] = line.frames[k].p;
    }
  }
}

void MotionsOfScene::rest() {
  state_ = model_.initial;
  for (Vec6& V : state_.V) V.setZero();
  for (Vec6& V : state_.Vdot) V.setZero();
  const StaticReport found = find_equilibrium(scene_, model_, state_);
  if (!found.converged)
    throw Error(scene_.source,
                "there is no equilibrium to have small motions about: " + found.failure);
  notes_ = found.passed;
  if (!motions_->about(state_))
    throw Error(scene_.source, range_failure(model_.system->out_of_range(state_)));
}

void MotionsOfScene::run_to(double time) {
  const System& system = *model_.system;
  state_ = states_of_run(scene_, model_, start_of_run(scene_, model_), {time}, "modes").front();
  if (const std::string failure = make_consistent(system, state_); !failure.empty())
    throw Error(scene_.source, "modes: " + failure);
  if (!motions_->frozen_at(state_))
    throw Error(scene_.source, range_failure(system.out_of_range(state_)));
  if (std::ranges::any_of(state_.V, [](const Vec6& V) { return !V.isZero(0.0); }))
    notes_.push_back(
        "the state moves: coefficients are as they are at that time, in axes of the bodies, and "
        "what "
        "is slow beside the motion need be no frequency of it (mbd floquet is about a whole "
        "motion)");
}

std::vector<char> MotionsOfScene::nodes_of(const std::vector<std::string>& names) const {
  const System& system = *model_.system;
  std::vector<char> found(static_cast<std::size_t>(system.nodes()), 0);
  for (const std::string& name : names) {
    bool any = false;
    for (const Model::Line& line : model_.lines) {
      if (line.name != name) continue;
      any = true;
      for (const int node : line.nodes) found[static_cast<std::size_t>(node)] = 1;
    }
    for (Index n = 1; n < system.nodes(); ++n)
      if (system.node_name(n) == "body '" + name + "'") {
        any = true;
        found[static_cast<std::size_t>(n)] = 1;
      }
    if (!any)
      throw Error(scene_.source,
                  "no body with a node of its own and no flexible beam is called \"" + name + '"');
  }
  found[0] = 0;
  return found;
}

IsDriven MotionsOfScene::driven() const {
  return [this](Index row) {
    return model_.makers[static_cast<std::size_t>(row)].label.starts_with("drive");
  };
}

// Again where the rate has grown. Leaves `motions_` assembled in the axes.
void MotionsOfScene::check_axes() {
  constexpr double often = 3.0;
  const double rate = std::abs(rotation_->rate);
  if (rate > often * checked_) {
    checked_ = rate;
    if (const std::string broken = broken_symmetry(*motions_, *rotation_, *axes_, state_, driven());
        !broken.empty())
      throw Error(
          scene_.source,
          fmt::format("steady rotation has no small motions with constant coefficients at {:.6g} "
                      "rad/s: {}; name what does not turn (--at-rest), and nothing that an "
                      "unbalance moves",
                      rotation_->rate, broken));
  }
  about_rotation(*motions_, *rotation_, *axes_, state_);
}

// What moves aside from the axis in equilibrium, under its weight, does not turn about it.
std::string MotionsOfScene::aside() const {
  constexpr double seen = 1e-9;  // of the size of the scene
  const auto [moved, node] = largest_displacement();
  if (!(moved > seen * model_.system->length_scale())) return {};
  return fmt::format(
      " (in equilibrium {} has moved by {:.3g} m, and may be beside it: leave the weight out, "
      "--without gravity, or take the axis through where it is, --through)",
      model_.system->node_name(node), moved);
}

void MotionsOfScene::turn(const SteadyRotation& rotation) {
  const double from = rotation_ ? rotation_->rate : 0.0;
  rotation_ = rotation;
  rotation_->rate = from;
  if (!axes_)
    if (const std::string held = held_fast(*motions_, rotation, state_, driven()); !held.empty())
      throw Error(scene_.source, "steady rotation: " + held + aside() +
                                     "; name what does not turn (--at-rest), or hold it otherwise");
  if (!axes_)
    if (const std::string drive = unsteady_drive(*motions_, rotation, state_, duration_);
        !drive.empty())
      throw Error(drive);  // which says where it is
  const SteadyReport report = find_steady_rotation(*motions_, rotation, from, {}, state_);
  rotation_->rate = report.rate;
  if (!report.converged) throw Error(scene_.source, report.failure);
  if (axes_) return check_axes();
  checked_ = std::abs(rotation.rate);
  const std::string turning =
      broken_symmetry(*motions_, rotation, ModeAxes::turning, state_, driven());
  if (turning.empty()) {
    axes_ = ModeAxes::turning;
    return;
  }
  const std::string resting =
      broken_symmetry(*motions_, rotation, ModeAxes::resting, state_, driven());
  if (!resting.empty())
    throw Error(scene_.source,
                "steady rotation has no small motions with constant coefficients here: in "
                "axes that turn " +
                    turning + "; in axes that rest " + resting +
                    "; leave that out (--without), name what does not turn (--at-rest), or "
                    "make either side alike in all directions about the axis");
  axes_ = ModeAxes::resting;
}

void MotionsOfScene::settle(const SteadyRotation& rotation, const State& state) {
  state_ = state;
  rotation_ = rotation;
  turn_steadily(rotation, state_);
  check_axes();
}

void MotionsOfScene::require_linear() {
  const System& system = *model_.system;
  const std::string why =
      has_rank_ ? kink_at(system, {&state_, 1}) : why_not_linear(system, state_);
  has_rank_ = true;
  if (!why.empty()) throw Error(scene_.source, "small motions: " + why);
}

double MotionsOfScene::error_of_components(std::string* why) const {
  double most = 0.0;
  for (const std::unique_ptr<Batch>& batch : model_.system->batches()) {
    const auto* const components = dynamic_cast<const ComponentBatch*>(batch.get());
    for (Index k = 0; components != nullptr && k < components->size(); ++k) {
      const ComponentBatch::Wrong wrong = components->wrong_by(state_, k);
      // Of modes with fixed places, tension changes nothing: where it is most of the stiffness, all frequencies are wrong.
      const double error = std::max(wrong.error, std::min(1.0, wrong.share / 3.0));
      if (!(error > most)) continue;
      most = error;
      if (why != nullptr)
        *why = fmt::format(
            "component modes of {} are {}: within it turns by {:.2g} rad, and forces change its "
            "stiffness by {:+.2g} of it, which they know about two thirds of at best; leave the "
            "reduction out, or divide it",
            components->name_of(k),
            most < 1.0 ? fmt::format("known to {:.0e} of its stiffness only", most)
                       : std::string("wrong by any amount"),
            wrong.turn, wrong.share);
    }
  }
  return most;
}

std::vector<std::string> MotionsOfScene::notes_on_state() const {
  std::vector<std::string> all = notes_;
  std::string components;
  if (error_of_components(&components) > small_component_error) all.push_back(components);
  if (std::string range = range_of_linearity(*model_.system, state_); !range.empty())
    all.push_back(std::move(range));
  return all;
}

std::vector<NamedMode> MotionsOfScene::modes(const ModeOptions& options) {
  require_linear();
  ModesFound found = find_modes(*motions_, options);
  work_ += found.work;
  if (!found.failure.empty()) throw Error(scene_.source, "modes: " + found.failure);
  std::vector<NamedMode> result;
  for (Mode& mode : found.modes) {
    NamedMode named;
    static_cast<Mode&>(named) = std::move(mode);
    name(named);
    result.push_back(std::move(named));
  }
  return result;
}

std::pair<double, Index> MotionsOfScene::largest_displacement() const {
  std::pair<double, Index> most{0.0, 0};
  for (Index n = 1; n < model_.system->nodes(); ++n) {
    const double moved =
        (state_.pose[static_cast<std::size_t>(n)].r - model_.system->reference_pose(n).r).norm();
    if (moved > most.first) most = {moved, n};
  }
  return most;
}

std::optional<double> MotionsOfScene::orbit_of(const Mode& mode, const VecXc& p,
                                               double whole) const {
  double crossing = 0.0, area = 0.0;
  const Vec3 e1 = rotation_->axis;
  const Eigen::Vector3d some = Eigen::Vector3d(e1).unitOrthogonal();
  const Vec3 e2 = some, e3 = e1.cross(e2);
  for (Index i = 0; i < motions_->motions(); i += 6) {
    const auto node = static_cast<std::size_t>(i / 6 + 1);
    const Eigen::Matrix3d to_inertial = state_.pose[node].p.toRotationMatrix();
    for (Index k = 0; k < 6; k += 3) {  // displacements, and tilts
      const Eigen::Vector3cd d = to_inertial * mode.shape.segment<3>(i + k),
                             w = to_inertial * p.segment<3>(i + k);
      const auto along = [](const Vec3& e, const Eigen::Vector3cd& x) {
        return Eigen::Vector3d(e).cast<Complex>().dot(x);
      };
      const Complex y = along(e2, d), z = along(e3, d);
      const double moved = std::norm(y) + std::norm(z);
      const double energy_across =
          std::max(0.0, std::real(std::conj(y) * along(e2, w) + std::conj(z) * along(e3, w)));
      if (!(moved > 0.0)) continue;
      crossing += 0.5 * energy_across;
      area += -2.0 * energy_across / moved * std::imag(std::conj(y) * z);
    }
  }
  if (!(crossing > across * whole)) return std::nullopt;
  return 0.5 * area / crossing;
}

void MotionsOfScene::name(NamedMode& mode) const {
  const Index n = motions_->motions();
  VecXc p = motions_->mass_times(mode.shape);
  // Of what has next to no mass the kinetic energy is round-off: it is named after how far it moves.
  constexpr double no_mass = 1e-12;
  const double L = model_.system->length_scale();
  VecXc far = mode.shape;
  for (Index i = 0; i < n; i += 6) far.segment<3>(i) /= L * L;
  if (!(std::real(mode.shape.dot(p)) >
        no_mass * motions_->mass() * L * L * std::real(mode.shape.dot(far))))
    p = far;

  std::map<int, Energy> energies;  // by part; of nodes in none by -1 - node
  double whole = 0.0;
  for (Index i = 0; i < n; i += 6) {
    const auto node = static_cast<std::size_t>(i / 6 + 1);
    const Eigen::Matrix3d to_section = axes_of_node_[node].conjugate().toRotationMatrix();
    Eigen::Matrix<Complex, 6, 1> u, f;
    for (Index k = 0; k < 6; k += 3) {
      u.segment<3>(k) = to_section * mode.shape.segment<3>(i + k);
      f.segment<3>(k) = to_section * p.segment<3>(i + k);
    }
    const int part = part_of_node_[node] >= 0 ? part_of_node_[node] : -1 - static_cast<int>(node);
    Energy& energy = energies[part];
    for (Index k = 0; k < 6; ++k) {
      const double share = 0.5 * std::real(std::conj(u(k)) * f(k));
      energy.of[static_cast<std::size_t>(k)] += share;
      energy.total += share;
      whole += share;
    }
  }
  if (rotation_) mode.orbit = orbit_of(mode, p, whole);

  const auto name_of_part = [&](int part) {
    return part >= 0 ? part_names_[static_cast<std::size_t>(part)]
                     : model_.system->node_name(-1 - part);
  };
  std::vector<std::pair<double, int>> order;
  for (const auto& [part, energy] : energies) order.emplace_back(energy.total, part);
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [total, part] : order)
    if (whole > 0.0) mode.parts.emplace_back(name_of_part(part), total / whole);
  if (order.empty() || !(whole > 0.0)) {
    mode.name = "no motion that has mass";
    return;
  }
  const auto [total, part] = order.front();
  const std::string kind = kind_of(energies[part], part >= 0);
  const std::string first = name_of_part(part);
  mode.name = part >= 0 ? of_beam(kind, first) : first + " " + kind;
  if (mode.rigid) mode.name = "free motion: " + (part >= 0 ? first : mode.name);
  std::vector<std::string> others;
  for (std::size_t i = 1; i < mode.parts.size() && others.size() < 2; ++i)
    if (mode.parts[i].second > part_of_it)
      others.push_back(
          fmt::format("{} {:.0f} %", mode.parts[i].first, 100.0 * mode.parts[i].second));
  if (!others.empty())
    mode.name += fmt::format(" {:.0f} % ({})", 100.0 * total / whole, fmt::join(others, ", "));
}

Eigen::MatrixXcd MotionsOfScene::mass_times(const Eigen::MatrixXcd& shapes) const {
  const auto turned = [this](Eigen::MatrixXcd X, bool to_body) {
    for (Index row = 0; row < X.rows(); row += 3) {
      const Mat3 R = state_.pose[static_cast<std::size_t>(row / 6 + 1)].R();
      X.middleRows(row, 3) =
          (to_body ? Mat3(R.transpose()) : R).cast<Complex>() * X.middleRows(row, 3);
    }
    return X;
  };
  return turned(motions_->mass_times(turned(shapes, true)), false);
}

void MotionsOfScene::write_motion(const Mode& mode, const std::filesystem::path& file, int frames,
                                  double amplitude) const {
  const MotionBlocks blocks = motion_blocks(model_);
  MotionWriter writer(file, drawing(scene_, model_), blocks);
  std::vector<double> row(blocks.size());
  const double omega = mode.eigenvalue.imag(),
               period = omega > 0.0 ? 2.0 * std::numbers::pi / omega : 1.0;
  for (int k = 0; k <= frames; ++k) {
    const double share = static_cast<double>(k) / frames;
    const Complex factor =
        amplitude *
        (omega > 0.0 ? std::polar(1.0, 2.0 * std::numbers::pi * share) : Complex(share));
    State state = state_;
    state.t = share * period;
    for (std::size_t n = 1; n < state.pose.size(); ++n) {
      const Vec6 u = (factor * mode.shape.segment<6>(6 * static_cast<Index>(n - 1))).real();
      state.pose[n] = state.pose[n] * exp_se3<double>(u);
    }
    motion_row(model_, state, row);
    writer.write(row);
  }
  writer.close();
}

ModesStudy study_modes(const Scene& scene, const ModesOptions& options,
                       const std::filesystem::path& motions) {
  if (options.rotation && options.time)
    throw Error(scene.source,
                "modes: about a steady rotation, or about a state of a run, not both");
  if (options.time && !(*options.time >= 0.0))
    throw Error(scene.source, "modes: the time of a run must not be negative");
  MotionsOfScene scene_motions(scene, options.time);
  if (options.rotation) {
    SteadyRotation rotation = *options.rotation;
    if (!options.at_rest.empty()) rotation.rests = scene_motions.nodes_of(options.at_rest);
    scene_motions.turn(rotation);
  }
  ModesStudy study;
  study.model = scene.name;
  study.file = scene.file;
  study.rotation = options.rotation;
  study.axes = scene_motions.axes();
  study.time = options.time;
  study.near = options.near;
  study.asked = options.asked;
  ModeOptions mode_options;
  mode_options.count = options.count;
  mode_options.near = options.near;
  mode_options.conditions = true;
  study.modes = scene_motions.modes(mode_options);
  study.work = scene_motions.work();
  if (options.near == 0.0)
    std::stable_sort(study.modes.begin(), study.modes.end(), [](const Mode& a, const Mode& b) {
      return std::abs(a.eigenvalue) < std::abs(b.eigenvalue);
    });
  if (!motions.empty())
    for (std::size_t i = 0; i < study.modes.size(); ++i) {
      const std::filesystem::path directory = motions / fmt::format("mode_{}", i + 1);
      make_directory(directory);
      scene_motions.write_motion(study.modes[i], directory / "motion.bin");
    }
  const auto [moved, node] = scene_motions.largest_displacement();
  const System& system = *scene_motions.model().system;
  study.displacement = moved;
  study.displaced = system.node_name(node);
  for (Index n = 1; n < system.nodes(); ++n) {
    study.nodes.push_back(system.node_name(n));
    study.poses.push_back(scene_motions.state().pose[static_cast<std::size_t>(n)]);
  }
  study.notes = scene_motions.notes_on_state();
  if (const std::string note = note_on_round_off(study.modes); !note.empty())
    study.notes.push_back(note);
  const Weigh weigh = [&](const Eigen::MatrixXcd& X) { return scene_motions.mass_times(X); };
  if (options.compared)
    study.mac = mac_table(shapes_of(study), weigh, *options.compared);
  else if (options.mac)
    study.mac = mac_table(shapes_of(study), weigh);
  return study;
}

ShapesOfModes shapes_of(const ModesStudy& study) {
  ShapesOfModes all;
  all.model = study.model;
  all.file = study.file.empty() ? study.model : study.file;
  all.nodes = study.nodes;
  for (const Pose<double>& H : study.poses) all.positions.push_back(H.r);
  all.shapes.resize(6 * std::ssize(study.nodes), std::ssize(study.modes));
  for (const NamedMode& mode : study.modes) {
    const auto number = static_cast<Index>(all.names.size());
    all.names.push_back(mode.name);
    all.eigenvalues.push_back(mode.eigenvalue);
    all.frequencies.push_back(mode.frequency());
    all.round_off.push_back(mode.round_off);
    for (Index row = 0; row < all.shapes.rows(); row += 3)
      all.shapes.block<3, 1>(row, number) =
          study.poses[static_cast<std::size_t>(row / 6)].R().cast<Complex>() *
          mode.shape.segment<3>(row);
  }
  return all;
}

}  // namespace mbd
