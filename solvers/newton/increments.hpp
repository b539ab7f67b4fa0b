// How large an increment of motion and multipliers is, in units of the tolerance: what Newton's iterations
// of statics and of dynamics both stop on.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "libmbd/core/system.hpp"
#include "solvers/newton/report.hpp"

namespace mbd {

class IncrementNorm {
 public:
  IncrementNorm(const System& system, const NewtonOptions& options);

  // Largest weighted component of an increment [dU; dlambda] of the unknowns, dlambda divided by
  // `multiplier_scale`; NaN if any component is not finite. `slack` is a factor on the tolerance of
  // multipliers, `share` one on that of motion. `exact` becomes the same without the floor of round-off under
  // the tolerance of motion.
  double operator()(std::span<const double> increment, double multiplier_scale, double slack = 1.0,
                    double share = 1.0, double* exact = nullptr) const;

  // Follows the size of the multipliers, against which their increments are measured.
  void observe(const VecX& lambda);

  // Round-off below which increments mean nothing: positions are known to eps times their size, forces to
  // that times the stiffness [N/m], and, with a step h, times mass / (beta h^2). `stiffness` is the
  // largest entry of the tangent that takes increments of motion to forces.
  void set_floor(const State& state, double stiffness);
  double floor() const { return floor_ / tolerance_; }  // under motion, in units of its tolerance

  // What it has followed (solvers/time/archive.hpp).
  void archive(auto& a) { a(floor_, force_, force_floor_); }

 private:
  Index motions_;
  double length_, tolerance_, multiplier_tolerance_;
  double floor_ = 0.0;  // of the tolerance on motion
  // By multiplier: a moment counts as force times length; infinity: not at all, as one with a compliance follows from motion,
  // with the round-off of a strain over it.
  std::vector<double> arm_;
  double force_ = 0.0;        // largest multiplier met [N]
  double force_floor_ = 0.0;  // [N]
};

// Whether Newton's iterations end with an increment e, after `previous`, both in units of the tolerance. Convergence is
// quadratic: what is left after e < 1 is far below the tolerance. At the floor of round-off increments stop falling.
inline bool has_converged(double e, double previous) {
  return e < 1.0 || (previous > 0.0 && e < 1e3 && e > 0.5 * previous && previous < 1e3);
}

// Largest entry of the node-node blocks of what has been added to slots, in units of force per motion: moments
// and turns count by the scene's length [N/m, or kg of a mass matrix]; not after factor().
double largest_stiffness(const System& system, std::span<const Slot> slots);
double largest_stiffness(const System& system, const LinearSolver& S);

// The same, or what stands behind multipliers with a compliance C, B^2/C, in place of node-node blocks, where that is more [N/m]:
// by what round-off of motion is multiplied in forces.
double largest_stiffness_behind(const System& system, std::span<const Slot> slots);

// By multiplier, the largest derivative of its gap by a motion, turns over the scene's length; 0 of those without a compliance.
// Not after factor().
VecX gap_per_motion(const System& system, std::span<const Slot> slots);

// Largest multiplier, moments over the scene's length [N]; NaN if one is.
double largest_force(const System& system, const VecX& lambda);

// What to say of the element or joint that System::out_of_range names.
std::string range_failure(const std::string& name);

// Largest entry of what constraint rows violate, lengths over that of the scene [rad, or rad/s of rates]; NaN if
// one is. `row`: which, -1 if all are zero.
double largest_violation(const System& system, const VecX& g, Index* row = nullptr);

// The fastest node: its spin, or its speed over the scene's length [rad/s].
double fastest(const System& system, const State& state);

// Row of a residual whose force, moment or gap is the worst, each kind in its own scale; for messages.
Index worst_row(const System& system, const VecX& residual);

}  // namespace mbd
