// How far two runs of a scene may differ that ought to give the same: by what its own tolerances leave open, and by
// what its motion makes of round-off. Both are measured, by runs of the scene: as it is, with another tolerance,
// and, three times, with its numbers changed in the twelfth digit.
//
// For a quantity q (norm.hpp) over its scale, at place k,
//   noise_q(k) = max over j <= k of |A_j - B_j| + max |A_j - C_j|,   bound_q(k) = 10 noise_q(k) + floor_q,   (1)
// A as it is, B of the other tolerance, C those perturbed; floor_q is ten times the tolerance of the run that q is under
// (of fixed steps the root of their number, if that is more; of velocities at least the tolerance over half a step; of
// displacements and rotations as many units of round-off of a pose besides, which is known to 8 eps of 1 rad and of the
// scene's length however little it changes).
// Runs are compared as long as the bound is below 1e-3: later, where the motion is chaotic or the run not resolved,
// a difference says nothing.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "libmbd/study/trial/norm.hpp"
#include "libmbd/study/trial/trial.hpp"

namespace mbd {

// What round-off of positions does besides, `distance` [m] away from the origin. Each step leaves 8 eps distance of
// the motion (the floor of Newton's iterations), and that over the step of velocities, as in a random walk; `lever`
// is the shortest over which positions make rotations. The motion amplifies it as it did C.
struct FarNoise {
  double distance = 0.0;  // 0: none
  double length = 1.0;    // of the scene [m]
  double lever = 1.0;     // [m]
};

// The shortest distance between nodes, points of joints and pitches of screws, of those that are not zero [m].
double shortest_lever(const Scene& scene);

struct Sameness {
  bool comparable = false;  // there was something to compare
  double difference = 0.0;  // the worst beside its bound, over the scale of its quantity
  double bound = 0.0;       // of that
  std::string quantity;     // whose
  double at = 0.0;          // where it is: a time, a load factor, the number of a special point
  double until = 0.0;       // up to which place all quantities were compared
  bool whole = false;       // the last one
  std::string what;         // that differs otherwise: fewer places; empty: nothing
  bool same() const { return comparable && what.empty() && difference <= bound; }
};

class Twins {
 public:
  // Runs `scene` five times (run_trial), with records of its own besides those of the scene. failure() tells if
  // one of them did not come to its end. Throws Error for a scene that cannot be compiled.
  Twins(const Scene& scene, const TrialOptions& options);

  const std::string& failure() const { return failure_; }
  const Scene& scene() const {
    return scene_;
  }  // that was run: with the records, without <expect> and <plot>
  const Trial& base() const { return base_; }
  double cpu() const { return cpu_; }  // of all of them [s]

  // The findings of another run, brought back to the axes and units of scene().
  Sameness compare(const Findings& other, const FarNoise& far = {}) const;

  // Displacements and rotations of a finer run of scene(), beside `bound`, as long as the bound (1) is below 1e-3.
  Sameness compare_finer(const Findings& other, double bound) const;

 private:
  Sameness compare(const Findings& other, const FarNoise& far, std::optional<double> fixed) const;
  bool run_twins(const TrialOptions& once);
  void set_round_off(const Model& model, double mass);
  double floor_of(const Components& quantity, double scale) const;
  // Over its scale; nothing: not to be compared there.
  std::optional<double> far_noise(const Components& quantity, double scale, std::size_t place,
                                  const FarNoise& far) const;

  Scene scene_;
  Trial base_;
  double length_ = 1.0;  // of the scene [m]
  // What round-off of poses makes by the largest stiffness [N], and of a node of the mean mass [m/s2].
  double force_unit_ = 0.0, acceleration_unit_ = 0.0;
  std::vector<Components> quantities_;
  std::vector<double> scales_,
      own_scales_;  // of what is zero beside the scene, by the scene and by itself
  // By quantity and place: noise_q(k) of (1), and what a relative change of the numbers becomes.
  std::vector<std::vector<double>> noise_, growth_;
  std::string failure_;
  double cpu_ = 0.0;
};

// The scene with records of energies, momenta, and positions and velocities of its bodies and ends of beams (at most
// 20 of them), named "certify…", without <expect> and <plot>.
Scene with_probes(const Scene& scene);

// A transient cut to `duration` [s], rounded to whole steps.
Scene shortened(const Scene& scene, double duration);

}  // namespace mbd
