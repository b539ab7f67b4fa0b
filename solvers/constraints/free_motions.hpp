// Motions that constraints leave free to the first order, at a state: B u = 0.
//
// In one unit: displacements of a node (body frame) over the size of what constraints tie together with it (tied_lengths), and
// rotations; rows of B have length one at the state. So mechanisms of any sizes beside each other are looked at alike.
#pragma once

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <vector>

#include "libmbd/core/system.hpp"

namespace mbd {

class UnitMotions {
 public:
  // `system` outlives this.
  UnitMotions(const System& system, const State& state);

  // Of all rows of B at a state, idle ones too, in the units of the state that this was made with.
  Eigen::SparseMatrix<double> gradient(const State& state) const;
  // What constraints are open by at a state, idle ones too, over the lengths of their rows.
  VecX gaps(const State& state) const;
  // Of a combination n of rows, n^T B, the same combination of unit rows.
  Eigen::SparseMatrix<double> of_unit_rows(const Eigen::SparseMatrix<double>& n) const;

  // What motion z is of a node [m, rad].
  Vec6 of_node(const VecX& z, std::size_t node) const;
  // A state after the motion `by` times z.
  State moved(State state, const VecX& z, double by) const;

 private:
  const System& system_;
  std::vector<double> length_;  // by node
  VecX row_;                    // lengths of rows
};

// Onto what rows of B (of UnitMotions) but those that are idle (rising) leave free, if they are independent: by [1 B^T; B 0].
class OntoFreeMotions {
 public:
  OntoFreeMotions(const Eigen::SparseMatrix<double>& B, std::vector<Index> rows,
                  const std::vector<Index>& idle);
  bool ok() const { return lu_.info() == Eigen::Success; }  // else they are not

  // The nearest free ones, column by column.
  Eigen::MatrixXd operator()(const Eigen::MatrixXd& motions) const;
  // The same for each seed, the largest entry 1; empty if nothing is free.
  VecX random(unsigned seed) const;
  // The smallest motion that closes gaps (of all rows) of those that are not idle, to the first order.
  VecX closing(const VecX& gaps) const;
  const std::vector<Index>& rows() const { return rows_; }  // that are not idle

 private:
  Index motions_;
  std::vector<Index> rows_;
  Eigen::SparseLU<Eigen::SparseMatrix<double>, Eigen::COLAMDOrdering<int>> lu_;
};

// OntoFreeMotions::random() of all constraints at the state of `units`, which satisfies them; where they nearly depend on each
// other, any motion. Throws Error as find_redundancy() does.
VecX random_free_motion(const System& system, const State& state, const UnitMotions& units,
                        unsigned seed);

}  // namespace mbd
