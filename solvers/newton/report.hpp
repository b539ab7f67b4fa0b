// What the solvers say of themselves. Numbers that go wrong are reported here, never thrown.
#pragma once

#include <array>
#include <string>

#include "libmbd/core/choices.hpp"

namespace mbd {

struct NewtonOptions {
  double tolerance = 1e-9;  // on increments of motion, of the scene's length and of 1 rad
  double multiplier_tolerance = 1e-7;  // on increments of multipliers, of the largest met
  int max_iterations = 20;
  enum class Tangent { kept, every_iteration } tangent = Tangent::kept;
  bool line_search = true;  // of equilibrium.hpp; steps in time have none
};

// What a point of a path of equilibria is (path.hpp).
enum class PathEvent { none, limit, bifurcation, crossing };

struct Counters {
  long steps = 0;     // whole ones
  long substeps = 0;  // accepted, among them those cut by a breakpoint and parts of a failed step
  long retries = 0;   // steps that failed and were tried in halves
  long rejected = 0;  // steps whose estimated error was too large
  long tolerant = 0;  // steps near a singular configuration, done with a rank-tolerant tangent
  long restarts = 0;  // at jumps of loads and drives
  long passed_kinks =
      0;  // steps in which a law of the motion passed a kink and came back unseen (passed_kinks.hpp)
  long iterations = 0;
  long residuals = 0;
  long tangents = 0;
  long factorizations = 0;
  long of_five_stages = 0, of_seven_stages = 0;  // substeps of Radau with more stages than three
};

// What step control did, and what it believes of the error.
struct StepSizes {
  // Accepted steps [s]; `least` without those cut by a breakpoint or the end.
  double least = 0.0, most = 0.0;
  // Largest estimated local error of an accepted step, of what was allowed.
  double worst_error = 0.0;
  // Sums of the estimated local errors of all accepted steps: positions [m], rotations [rad]. Of the error at
  // the end they are a bound only where nothing amplifies errors.
  double position_error = 0.0, rotation_error = 0.0;
  // Where velocities are not held: the largest estimated error of one, of what moves fastest at the time.
  double velocity_left = 0.0;
};

struct [[nodiscard]] StepReport {
  bool converged = false;
  int iterations = 0;
  double error = 0.0;  // estimate of what is left, in units of the tolerance
  // Largest ratio of an increment to the one before it, above the tolerance, in the iterations that converged with
  // their last tangent; 0: none was measured, the first increment was small enough.
  double contraction = 0.0;
  double floor = 0.0;  // round-off of motion in units of its tolerance; above 1 it takes its place
  std::array<double, 32>
      increments{};  // size of each iteration's increment, in units of the tolerance
  std::string
      failure;  // when not converged: what happened, naming the worst equation and the remedy
  Failure kind = Failure::none;  // and of what kind
  // Of steps whose cost is bounded: their iterations ended before the tolerance, and `error` is what that left undone.
  bool undone = false;
};

}  // namespace mbd
