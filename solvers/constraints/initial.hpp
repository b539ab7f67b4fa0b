// Checks and completes an initial state (NOTATION.md 4).
#pragma once

#include <optional>
#include <string>

#include "libmbd/core/system.hpp"

namespace mbd {

// Largest constraint violations of a state, and where.
struct ConstraintResiduals {
  double position = 0.0;    // max |g|     [m, rad]
  double velocity = 0.0;    // max |gdot|  [m/s, rad/s]
  Index position_row = -1;  // in State::lambda
  Index velocity_row = -1;
};
ConstraintResiduals constraint_residuals(const System& system, const State& state);

// A constraint that a state violates by more than the round-off of what was written, in words.
struct OpenConstraint {
  Index multiplier = 0;  // in State::lambda
  std::string row;       // of the joint: "position 2"
  std::string what;      // by how much, and what to do
};
// What turns by a radian, or moves by the scene's length, in 1/`slow` is at rest [rad/s].
std::optional<OpenConstraint> find_open_constraint(const System& system, const State& state,
                                                   double slow = 1.0);

// Throws Error that names the open joint and the gap at position or velocity level.
void check_initial_state(const System& system, const State& state, double slow = 1.0);

}  // namespace mbd
