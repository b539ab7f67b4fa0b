// Motions that constraints leave free to the first order, at a state: B u = 0.
//
// Motions are those of the nodes but the ground (body frames), in one unit: displacements [m], and rotations times the scene's
// length (System::length_scale).
#pragma once

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <vector>

#include "libmbd/core/system.hpp"

namespace mbd {

// All rows of B at a state, idle ones too.
Eigen::SparseMatrix<double> unit_gradient(const System& system, const State& state);

// Onto what rows of B but those that are idle (rising) leave free, if they are independent: by [1 B^T; B 0].
class FreeMotions {
 public:
  FreeMotions(const Eigen::SparseMatrix<double>& B, std::vector<Index> rows,
              const std::vector<Index>& idle);
  bool ok() const { return lu_.info() == Eigen::Success; }  // else they are not

  // The nearest free ones, column by column.
  Eigen::MatrixXd operator()(const Eigen::MatrixXd& motions) const;
  // The same at each call, the largest entry 1; empty if nothing is free.
  VecX random() const;

 private:
  Index motions_;
  Eigen::SparseLU<Eigen::SparseMatrix<double>, Eigen::COLAMDOrdering<int>> lu_;
};

// FreeMotions::random() of all constraints at a state that satisfies them; where they nearly depend on each other, any motion.
// Throws Error as find_redundancy() does.
VecX random_free_motion(const System& system, const State& state);

// The state after the motion `by` times z.
State moved(const System& system, State state, const VecX& z, double by);

}  // namespace mbd
