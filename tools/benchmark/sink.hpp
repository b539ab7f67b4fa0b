#pragma once

#include <span>
#include <vector>

#include "libmbd/core/linear_solver.hpp"

namespace mbd {

// Throws away what is added: the cost of the kernel and of handing over, not of a solver.
class Sink : public LinearSolver {
 public:
  void analyze(const BlockGraph& graph) override {
    slots_.assign(graph.contributions.size(), {block_, 6});
  }
  std::span<const Slot> slots() const override { return slots_; }
  void set_zero() override {}
  FactorStatus factor() override { return FactorStatus::ok; }
  Index singular_row() const override { return -1; }
  void solve(std::span<double>) const override {}
  double reciprocal_condition() const override { return 1.0; }
  Index nonzeros() const override { return 0; }

 private:
  double block_[36] = {};
  std::vector<Slot> slots_;
};

}  // namespace mbd
