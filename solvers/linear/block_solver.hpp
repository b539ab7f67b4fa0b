// Block LU on the graph of nodes and multipliers (block_lu.hpp), behind the same interfaces as KLU.
//
// Pivots are chosen by the graph alone, so whether they serve is found out: the first solution after each factorisation is
// put into its equations. Its backward error there,
//   max over groups of rows of  |b - A x| / (|A| |x| + |b|),
// groups being forces and moments of a node and rows of a joint, may be 1e-10; up to 1e-9 it is refined, once. In it |x| has
// 1e-4 of the largest of its kind added (displacements, rotations, multipliers; of motions also of |b_i| over the largest
// number of their column, what they would be without constraints): what is less than 1e-14 of that is round-off, and not
// judged. Where the error is larger, or a pivot is zero, KLU factorises the same matrix, and some of the next ones, twice
// as many each time; facts() counts them. KLU also does rank-tolerant steps: another() is KLU, as is a pencil with such a
// diagonal.
//
// Matrices that a step keeps singular or nearly so are KLU's, which names the row; the order of pivots changes from
// nodes_first to merged (elimination.hpp) where that finds pivots that the first did not.
#pragma once

#include <memory>
#include <string>

#include "libmbd/core/choices.hpp"
#include "libmbd/core/linear_solver.hpp"
#include "solvers/linear/elimination.hpp"
#include "solvers/linear/pencil_solver.hpp"

namespace mbd {

// `order`: nodes_first for matrices with mass, merged for those of statics.
std::unique_ptr<LinearSolver> make_block_solver(PivotOrder order);
std::unique_ptr<PencilSolver> make_block_pencil_solver(PivotOrder order = PivotOrder::nodes_first);

// As chosen; block is with `order`.
std::unique_ptr<LinearSolver> make_linear_solver(LinearMethod method, PivotOrder order);
std::unique_ptr<PencilSolver> make_pencil_solver(LinearMethod method);

// "block LU, nodes first: 33 pivots of 3 to 6 unknowns, 8.5e+04 flops", or "KLU", for a graph.
std::string describe_linear_solver(LinearMethod method, PivotOrder order, const BlockGraph& graph);

}  // namespace mbd
