// Constraints that repeat each other: found, left out of the equations, given back to the reactions.
//
// Where rows of B, the gradient of the constraints, depend on each other, multipliers are not unique and the
// tangent is singular, though the motion is determined. Of k such dependences n_i^T B = 0, k rows are left idle
// (State::idle): not imposed, their multipliers 0. The others have full rank and determine the same motion; idle
// rows are looked at after each step (idle_rows_open), since what repeats another constraint at one configuration
// only may part from it.
//
// Reactions are those of least norm, sum of F^2 + (M/L)^2 over the multipliers, L the largest distance in the scene
// (System::reaction_length; a turned scene has the same, and so the same reactions, turned with it):
// lambda less its part in the span of the n_i (minimum_norm). They are zero along what the joints could do against
// each other, and the same whichever rows are idle.
//
// Small motions of the nodes (body frames) are measured as displacements and rotations times the size of what constraints tie
// together (tied_lengths); rows of B are scaled to length one, so that ranks are free of units, and of what else a scene holds. A row depends on others when it is nearer than 1e-8 to
// their span: far above round-off, and far below what two drawn axes differ by. Rows are taken one by one
// by a sparse QR of B^T without exchange of columns (row_echelon.hpp), joints first, then drives and motions, each in
// the order of the scene: so the later of two joints is named, and a drive before the joint it drives; idle rows are
// chosen otherwise, as those by which the n_i are best told apart, so that no kept row comes close to another.
//
// Not used: -eps I in place of the zero block, for all of a run: needs no choice, but multipliers along the n_i are
// then what round-off and Newton's last iterate leave, over eps. (Rank-tolerant steps, one_step.hpp, use it where
// rank is lost for a moment.)
#pragma once

#include <Eigen/SparseCore>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/core/system.hpp"

namespace mbd {

// A constraint row that the others imply to first order.
struct RedundantRow {
  Index row = 0;               // in State::lambda
  std::vector<Index> repeats;  // the rows that imply it together, the most important first
};

// Whether constraints can depend on each other at all: they cannot where they tie nodes together like a tree.
bool has_loops(const System& system);

struct Redundancy {
  std::vector<RedundantRow> rows;    // named
  std::vector<Index> idle;           // chosen, rising; as many
  Eigen::SparseMatrix<double> null;  // a column n with n^T B = 0 for each of `rows`, by multiplier
};

// Of the rows at a state that satisfies them; nothing idle is left out. A system without loops has none. Throws Error
// where more than 1000 rows repeat others of the same constraints: what is done with them is dense, and cubic in their
// number.
Redundancy find_redundancy(const System& system, const State& state);

// The same at a state that is off them by more than round-off, as rank-tolerant steps end: rows that are dependent but for that.
Redundancy find_redundancy_nearby(const System& system, const State& state);

// Multipliers with the same forces on all nodes, of least norm; those of `state` where rows are independent. A state
// inside a step is off its constraints by the error of interpolation, and rows that repeat each other look
// independent there: those that are idle are taken as what they are.
VecX minimum_norm(const System& system, const State& state);

// Multipliers with the same forces on all nodes that are 0 in the rows `idle`, as find_redundancy gives them.
VecX without_idle(const System& system, const State& state, const std::vector<Index>& idle);

// The worst idle row of a state that satisfies the others, if it is open by far more than they are; in words, with
// what it contradicts. `tolerated`: of the scene's length and of the fastest motion, what the rows that are imposed may
// have led it astray by, besides what they are open themselves.
std::optional<std::string> idle_rows_open(const System& system, const State& state,
                                          double tolerated = 0.0);

// A row in words: "revolute 'D', position 2".
std::string row_in_words(const System& system, Index row);

// One sentence on a redundant row: "revolute 'D', position 2 repeats revolute 'A', position 2 and …".
std::string to_text(const System& system, const RedundantRow& row);

// --- for other analyses of constraints ---

// Entries of a matrix with a row for each multiplier.
using ConstraintEntries = std::vector<Eigen::Triplet<double>>;

// A block of B at a state, idle rows too; of constraints that tie something (ConstraintInfo::gives).
struct GradientBlock {
  int constraint = 0, node = 0;
  Eigen::MatrixXd B;  // of body-frame increments of the node [m, rad]
};
std::vector<GradientBlock> constraint_gradients(const System& system, const State& state);

// [m] By node: the size of what constraints tie together with it, by their lever arms and the distances of nodes; the scene's
// where there is none. The ground ties nothing: of mechanisms beside each other each has its own.
std::vector<double> tied_lengths(const System& system, const State& state);

// Rows of B at a state, idle ones too, over motions of the nodes but the ground in one unit: displacements, and rotations times
// `lengths` [m] by node; by default tied_lengths() of the state.
ConstraintEntries scaled_gradient(const System& system, const State& state);
ConstraintEntries scaled_gradient(const System& system, const State& state,
                                  const std::vector<double>& lengths);

// Rows of constraints that may depend on each other: of those in parts of the graph of nodes and constraints that
// have a loop. The ground takes part in every loop through it, and joins nothing.
std::vector<Index> rows_in_loops(const System& system);

// Of which constraints are drives and motions.
std::vector<char> prescribed_constraints(const System& system);

// Rows that earlier ones imply. `order`: rows of the matrix; those that come first are blamed last.
struct Dependence {
  std::vector<Index> rank_of_first;  // rank of the first n rows, for each n from 0
  std::vector<RedundantRow> redundant;
  Eigen::SparseMatrix<double>
      null;  // a column n with n^T B = 0 for each of `redundant`; not orthonormal
};
inline constexpr double independent = 1e-8;  // least distance of a unit row from the span of others
Dependence find_dependent(const ConstraintEntries& entries, Index rows, Index columns,
                          const std::vector<Index>& order, double least = independent);

}  // namespace mbd
