// Static equilibrium by load stepping: one load factor over every load, from 0 to 1.
//
// A load step starts from where motion and resultants lead to second order, and is solved by mixed Newton
// (equilibrium.hpp), in which steps may be large. So that what is found belongs to the path of equilibria from no load, and
// not to whichever side the step happens to lead to, a step is taken only where
//   the tangents of all iterates have a determinant of the same sign as the equilibrium before (conservative loads),
//   as many eigenvalues are negative as before, where they are counted,
//   resultants change as their rates at both ends say:  |dS - h (S'_0 + S'_1)/2| < |dS|/2,              (1)
//   forces and moments each, and the motion found is nearer to the one foretold than the last equilibrium. (2)
// It is halved otherwise. No step turns what is prescribed by more than 2 rad: a whole turn is none to the constraint. A step that
// cannot be halved further passes a point where stability changes, if it moves little: it is taken, and said. If it moves
// much, the structure gives way.
// The path begins in the equilibrium without load, to which what is stressed beforehand moves.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/core/system.hpp"
#include "solvers/newton/report.hpp"

namespace mbd {

struct StaticOptions {
  int steps = 1;  // first load increment is 1/steps; halved on failure, grown when easy
  NewtonOptions newton;
  StaticSolver solver = StaticSolver::newton;
  bool has_potential = false;  // of all forces: negative eigenvalues are counted (stability.hpp)
  // That loads have one: signs of the determinant are judged. Under dead moments and follower loads they change without
  // a branch: the tangent of a ring closed by a moment is singular to round-off.
  bool conservative = has_potential;
  // Shown each equilibrium found, in order of its load factor, the last at 1. False ends the solution
  // there.
  std::function<bool(const State&)> accepted = {};
};

struct StaticReport {
  bool converged = false;
  double load_factor = 0.0;  // reached
  Counters counters;
  int most_iterations = 0;  // in one accepted load step
  int searched = 0;         // load steps that the line search saved
  std::vector<std::string>
      neutral;  // motions of the last equilibrium that nothing answers, in words
  std::vector<std::string> passed;  // where stability was lost or found on the way, in words
  std::string failure;              // when not converged; empty if `accepted` ended it
  std::optional<Index> negative;    // eigenvalues of the last equilibrium, where they were counted
  // Without a potential: real ones of the twelve of the last equilibrium that are nearest to zero (nearest_modes.hpp).
  std::optional<Index> diverging;
};

// Moves `state` to equilibrium at state.t. On failure it is the last equilibrium found.
StaticReport solve_statics(const System& system, LinearSolver& solver, const StaticOptions& options,
                           State& state);

}  // namespace mbd
