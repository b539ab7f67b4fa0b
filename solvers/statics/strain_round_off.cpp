#include "solvers/statics/strain_round_off.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "solvers/linear/block_solver.hpp"

namespace mbd {
namespace {

// By multiplier, the largest derivative of its gap by a displacement; 0 of those without a compliance.
VecX gap_per_length(const System& system, std::span<const Slot> slots) {
  VecX largest = VecX::Zero(system.multipliers());
  const auto nodes = static_cast<int>(system.nodes()) - 1;
  const BlockGraph& graph = system.graph();
  for (std::size_t i = 0; i < graph.contributions.size(); ++i) {
    const auto [row, column] = graph.contributions[i];
    if (row < nodes || column < 0 || column >= nodes) continue;
    const ConstraintInfo& info = system.constraints()[static_cast<std::size_t>(row - nodes)];
    for (Index r = 0; info.gives && r < info.rows; ++r)
      for (Index j = 0; j < 3; ++j) {
        double& most = largest(info.first_row + r);
        most = std::max(most, std::abs(slots[i].data[j * slots[i].ld + r]));
      }
  }
  return largest;
}

}  // namespace

std::optional<double> round_off_of_forces(const System& system, const State& state) {
  constexpr int samples = 4;
  const auto& constraints = system.constraints();
  if (std::ranges::none_of(constraints, &ConstraintInfo::gives)) return std::nullopt;
  const std::unique_ptr<LinearSolver> solver =
      make_linear_solver(LinearMethod::block, PivotOrder::merged);
  solver->analyze(system.graph());
  VecX r;
  system.linearize(state, {}, r, *solver);
  double farthest = system.length_scale();
  for (const Pose<double>& H : state.pose) farthest = std::max(farthest, H.r.cwiseAbs().maxCoeff());
  const VecX off =
      std::numeric_limits<double>::epsilon() * farthest * gap_per_length(system, solver->slots());
  if (solver->factor() != FactorStatus::ok) return std::nullopt;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  double largest = 0.0;
  for (int k = 0; k < samples; ++k) {
    VecX x = VecX::Zero(system.unknowns());
    for (Index i = 0; i < off.size(); ++i) x(6 * (system.nodes() - 1) + i) = share(random) * off(i);
    solver->solve({x.data(), static_cast<std::size_t>(x.size())});
    for (const ConstraintInfo& info : constraints)
      for (Index i = 0; i < info.rows; ++i) {
        const double change = std::abs(x(6 * (system.nodes() - 1) + info.first_row + i));
        const double force =
            info.is_position[static_cast<std::size_t>(i)] ? change : change / system.length_scale();
        if (!(force <= largest)) largest = force;  // what is not a number stays
      }
  }
  return std::isfinite(largest) ? std::optional(largest) : std::nullopt;
}

}  // namespace mbd
