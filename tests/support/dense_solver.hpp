// A dense matrix behind the solver's interface: shows the tests what has been assembled, and solves by
// LU with full pivoting of the matrix scaled to largest entries of 1 in rows and columns.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "libmbd/core/linear_solver.hpp"

namespace mbd::test {

class DenseSolver : public LinearSolver {
 public:
  void analyze(const BlockGraph& graph) override {
    std::vector<Index> first;
    Index n = 0;
    int largest = 1;
    for (const auto& block : graph.blocks) {
      first.push_back(n);
      n += block.size;
      largest = std::max(largest, block.size);
    }
    S_.setZero(n, n);
    trash_.setZero(largest, largest);
    slots_.clear();
    for (const auto& [row, column] : graph.contributions) {
      if (row < 0 || column < 0) {
        slots_.push_back({trash_.data(), trash_.rows()});
      } else {
        double* place =
            &S_(first[static_cast<std::size_t>(row)], first[static_cast<std::size_t>(column)]);
        slots_.push_back({place, n});
      }
    }
  }
  std::span<const Slot> slots() const override { return slots_; }
  void set_zero() override { S_.setZero(); }

  FactorStatus factor() override;
  // The unknown with the largest share in the first vector of the kernel.
  Index singular_row() const override;
  void solve(std::span<double> x) const override;
  double reciprocal_condition() const override;
  Index nonzeros() const override { return S_.size(); }

  const Eigen::MatrixXd& matrix() const { return S_; }

 private:
  Eigen::MatrixXd S_, trash_;
  VecX rows_, columns_;  // scales
  struct Factors;
  std::shared_ptr<const Factors> lu_;
  std::vector<Slot> slots_;
};

}  // namespace mbd::test
