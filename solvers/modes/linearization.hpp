// The equations of motion linearised about a state, as matrices: for control, estimation, and other programs.
//
//   M u'' + C u' + K u + B^T dlambda = F dw,   B u = 0                                               (1)
// as small_motions.hpp has them, w the inputs of the system in their own units, F = -dr/dw.
//
// On the constraints. Where B does not change in time (at rest, or in axes in which a steady rotation rests), columns of
// B are taken, lengths over the scene's, by pivoting: B = [Bd Bi] with Bd of the rank of B. So
//   u = N q,   N = [-Bd^+ Bi ; I],   q the motions that are left,                                     (2)
//   E x' = A x + G dw,   x = [q ; q'],   E = [I, 0 ; 0, N^T M N],                                    (3)
//   A = [0, I ; -N^T K N, -N^T C N],   G = [0 ; N^T F].
// Not used: orthogonal N, whose coordinates have no names.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "libmbd/core/system.hpp"
#include "solvers/modes/small_motions.hpp"

namespace mbd {

using MatX = Eigen::MatrixXd;

// (1), of all motions: six for each node but the ground, [u; psi] in body axes [m, rad], and all multipliers.
struct LinearMotion {
  Eigen::SparseMatrix<double> M, C, K, B;
  MatX F;  // a column for each input
};
// Of what small_motions is about. Throws Error for an input that prescribes a motion: it is no force.
LinearMotion linear_motion(const SmallMotions& motions);
// F alone.
MatX input_forces(const System& system, const State& state);

// (2) and (3).
struct ReducedMotion {
  std::vector<Index> coordinates;  // of the motions of (1), which q are
  MatX N, E, A, G;
};
// Dense: for at most `most` motions. Throws Error for more, and where N^T M N is singular: something without inertia moves.
inline constexpr Index most_reduced = 3000;
ReducedMotion reduced_motion(const System& system, const LinearMotion& all);

// "body 'arm', displacement 2": of a motion of (1).
std::string name_of_coordinate(const System& system, Index motion);

}  // namespace mbd
