// Equilibrium at a fixed load factor: the nonlinear solution behind load stepping and path following.
#pragma once

#include <string>

#include "libmbd/core/system.hpp"
#include "solvers/newton/report.hpp"
#include "solvers/statics/stability.hpp"

namespace mbd {

// Moves a state by `scale` times an increment of the unknowns [U of each node; multipliers].
void retract(State& state, const VecX& increment, double scale = 1.0);

// Newton's method with the exact tangent and a line search; leaves `state` at the solution, or where it
// gave up.
//
// Line search (Deuflhard's natural monotonicity): a share a of the increment x is taken if the increment
// that the same tangent asks for after it is shorter than (1 - a/4) x, so that stiff and soft directions,
// forces and gaps are judged in one measure, of motion. Skipped where increments are small.
//
// Where the tangent is singular at the start by neutral motions (stability.hpp), they are left as they are: of all
// increments the least is taken. It fails where loads drive one of them. `neutral` becomes those of the solution.
bool newton_equilibrium(const System& system, LinearSolver& solver, const NewtonOptions& options,
                        State& state, Counters& counters, std::string& failure,
                        NeutralMotions* neutral = nullptr);

// KINSOL (SUNDIALS) with its line search on the scaled norm of the residual, the same tangent and linear
// solver; a last Newton iteration by ours measures what is left in the same units.
bool kinsol_equilibrium(const System& system, LinearSolver& solver, const NewtonOptions& options,
                        State& state, Counters& counters, std::string& failure,
                        NeutralMotions* neutral = nullptr);

}  // namespace mbd
