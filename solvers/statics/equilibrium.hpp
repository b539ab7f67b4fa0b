// Equilibrium at a fixed load factor: the nonlinear solution behind load stepping and path following.
#pragma once

#include <string>
#include <vector>

#include "libmbd/core/system.hpp"
#include "solvers/newton/report.hpp"
#include "solvers/statics/stability.hpp"

namespace mbd {

// Moves a state by `scale` times an increment of the unknowns [U of each node; multipliers]. Angles of joints are
// followed on the way, so that an increment of more than half a turn loses none.
void retract(const System& system, State& state, const VecX& increment, double scale = 1.0);

// Largest motion between two states: displacements over the scene's length, rotations [rad].
double motion_between(const System& system, const State& a, const State& b);

// Largest rotation of an increment of the unknowns [rad].
double largest_rotation_in(const System& system, const VecX& increment);

// How resultants change along a direction of the unknowns, D B dU, in order of System::linearized_resultants.
std::vector<Vec6> rates_of_resultants(const System& system, const State& state,
                                      const VecX& direction);

// Resultants at the quadrature points of beams as iterates beside a state (NOTATION.md 5), in order of
// System::linearized_resultants.
struct MixedIterate {
  std::vector<Vec6> resultants;  // S* [N; N.m]; empty: those of the state, D E
  // Of a solution: the state at which its last tangent was taken, the sign of its determinant, 0 if not known, and
  // whether that of another iterate was not the same.
  State linearized;
  int sign = 0;
  bool sign_varied = false;
  std::string out_of_range = {};  // an element that one of the iterates left the range of
};

// Newton's method on the saddle point of Hellinger and Reissner, whose unknowns are motion U and resultants S,
//   B^T S = f,   E(U) = C S,   C = D^-1,                                                              (1)
// condensed element by element: of its increments dS = D (E + B dU) - S, and dU solves
//   [ B^T D B + d(B^T S)/dU - df/dU ] dU = f - B^T D E.                                               (2)
// Residual and solution are those of the displacements U alone; what differs is that the geometric stiffness is that
// of S, which obeys the linearised (1), and not of D E, which is off by D times the square of the last increment
// where D is large. Iterations do not depend on how stiff stretching and shear are beside bending. Measured: 4 to 5 a
// load step, where the tangent at D E takes hundreds.
// Leaves `state` at the solution, or where it gave up; `mixed` is the resultants to start from and those found.
//
// Line search (Deuflhard's natural monotonicity), with the tangent at S = D E: a share a of the increment x is taken if
// the increment that the same tangent asks for after it is shorter than (1 - a/4) x, so that stiff and soft directions,
// forces and gaps are judged in one measure, of motion. Skipped where increments are small.
//
// Where the tangent is singular at the start by neutral motions (stability.hpp), they are left as they are: of all
// increments the least is taken. It fails where loads drive one of them. `neutral` becomes those of the solution. Off an
// equilibrium what is neutral at it has some stiffness, of the order of the residual, and increments along it are of any size:
// those that are known of an equilibrium nearby are given in `neutral`, and held from the first iteration.
bool newton_equilibrium(const System& system, LinearSolver& solver, const NewtonOptions& options,
                        State& state, Counters& counters, std::string& failure,
                        NeutralMotions* neutral = nullptr, MixedIterate* mixed = nullptr);

// The same without line search, and where that does not lead to one with it, if the options have it. `state` is the solution, or
// where the last of them gave up.
bool find_equilibrium(const System& system, LinearSolver& solver, NewtonOptions options,
                      State& state, Counters& counters, std::string& failure,
                      NeutralMotions* neutral = nullptr, MixedIterate* mixed = nullptr);

// KINSOL (SUNDIALS) with its line search on the scaled norm of the residual, the same tangent and linear
// solver; a last Newton iteration by ours measures what is left in the same units.
bool kinsol_equilibrium(const System& system, LinearSolver& solver, const NewtonOptions& options,
                        State& state, Counters& counters, std::string& failure,
                        NeutralMotions* neutral = nullptr, MixedIterate* mixed = nullptr);

}  // namespace mbd
