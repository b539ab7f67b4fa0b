#include "solvers/statics/strain_round_off.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "solvers/linear/block_solver.hpp"
#include "solvers/newton/increments.hpp"

namespace mbd {

std::optional<double> round_off_of_forces(const System& system, const State& state) {
  constexpr int samples = 4;
  if (std::ranges::none_of(system.constraints(), &ConstraintInfo::gives)) return std::nullopt;
  const std::unique_ptr<LinearSolver> solver =
      make_linear_solver(LinearMethod::block, PivotOrder::merged);
  solver->analyze(system.graph());
  VecX r;
  system.linearize(state, {}, r, *solver);
  double farthest = system.length_scale();
  for (const Pose<double>& H : state.pose) farthest = std::max(farthest, H.r.cwiseAbs().maxCoeff());
  const VecX off =
      std::numeric_limits<double>::epsilon() * farthest * gap_per_motion(system, solver->slots());
  if (solver->factor() != FactorStatus::ok) return std::nullopt;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  double largest = 0.0;
  for (int k = 0; k < samples; ++k) {
    VecX x = VecX::Zero(system.unknowns());
    for (Index i = 0; i < off.size(); ++i) x(6 * (system.nodes() - 1) + i) = share(random) * off(i);
    solver->solve({x.data(), static_cast<std::size_t>(x.size())});
    const double force = largest_force(system, VecX(x.tail(off.size())));
    if (!std::isfinite(force)) return std::nullopt;
    largest = std::max(largest, force);
  }
  return largest;
}

}  // namespace mbd
