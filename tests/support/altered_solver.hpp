// KLU to which some contributions never come: what a tangent without them would do. Derived solvers say which,
// in analyze().
#pragma once

#include <memory>
#include <vector>

#include "solvers/linear/klu_solver.hpp"

namespace mbd::test {

class AlteredSolver : public LinearSolver {
 public:
  void analyze(const BlockGraph& graph) override {
    inner_->analyze(graph);
    slots_.assign(inner_->slots().begin(), inner_->slots().end());
    trash_.assign(36, 0.0);  // the largest block is 6 x 6
  }
  std::span<const Slot> slots() const override { return slots_; }
  void set_zero() override { inner_->set_zero(); }
  FactorStatus factor() override { return inner_->factor(); }
  Index singular_row() const override { return inner_->singular_row(); }
  void solve(std::span<double> x) const override { inner_->solve(x); }
  double reciprocal_condition() const override { return inner_->reciprocal_condition(); }
  Index nonzeros() const override { return inner_->nonzeros(); }

 protected:
  void drop(std::size_t contribution) { slots_[contribution] = {trash_.data(), 6}; }

 private:
  std::unique_ptr<LinearSolver> inner_ = make_klu_solver();
  std::vector<Slot> slots_;
  std::vector<double> trash_;
};

inline bool is_multiplier(const BlockGraph& graph, int block) {
  return block >= 0 &&
         graph.blocks[static_cast<std::size_t>(block)].kind == BlockGraph::Kind::multiplier;
}

}  // namespace mbd::test
