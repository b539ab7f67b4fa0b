#include "solvers/statics/stability.hpp"

#include <fmt/format.h>

#include <cmath>

namespace mbd {

VecX motion_weights(const System& system) {
  const Index nodes = system.nodes() - 1;
  VecX w = VecX::Zero(system.unknowns());
  const double one = 1.0 / static_cast<double>(std::max<Index>(nodes, 1)),
               length = system.length_scale();
  for (Index i = 0; i < 6 * nodes; ++i) w(i) = i % 6 < 3 ? one / (length * length) : one;
  return w;
}

StabilityCount::StabilityCount(const System& system)
    : system_(system), solver_(make_inertia_solver()) {
  solver_->analyze(system.graph());
}

std::optional<Index> StabilityCount::operator()(const State& equilibrium) {
  system_.linearize(equilibrium, {}, r_, *solver_);
  if (solver_->factor() != FactorStatus::ok) return std::nullopt;
  const std::optional<Index> negative = solver_->negative_eigenvalues();
  // Fewer than constraints: they are not independent, and the count means nothing.
  if (!negative || *negative < system_.multipliers()) return std::nullopt;
  return *negative - system_.multipliers();
}

std::optional<CriticalMode> critical_mode(const System& system, LinearSolver& solver,
                                          const State& state, const VecX& guess) {
  constexpr int most_iterations = 60;
  constexpr double converged = 1e-13;  // of the eigenvalue, relative; twice in a row
  VecX r;
  system.linearize(state, {}, r, solver);
  if (solver.factor() != FactorStatus::ok) return std::nullopt;
  const VecX w = motion_weights(system);
  CriticalMode mode;
  mode.shape = guess;
  if (guess.size() != w.size()) {
    mode.shape.resize(w.size());  // with a share of every mode, the same in every run
    for (Index i = 0; i < w.size(); ++i)
      mode.shape(i) = std::sin(1.0 + 2.7 * static_cast<double>(i * i % 1009));
  }
  const auto normalise = [&w](VecX& x) {
    const double size = std::sqrt(x.dot(w.cwiseProduct(x)));
    x /= size;
  };
  normalise(mode.shape);
  VecX y(w.size());
  for (int k = 0, still = 0; k < most_iterations && still < 2; ++k) {
    y = w.cwiseProduct(mode.shape);
    solver.solve({y.data(), static_cast<std::size_t>(y.size())});
    const double inverse = mode.shape.dot(w.cwiseProduct(y));
    const double before = mode.eigenvalue;
    mode.eigenvalue = 1.0 / inverse;
    mode.shape = y;
    normalise(mode.shape);
    if (!mode.shape.allFinite()) return std::nullopt;
    still =
        std::abs(mode.eigenvalue - before) <= converged * std::abs(mode.eigenvalue) ? still + 1 : 0;
  }
  return mode;
}

std::string name_of_motion(const System& system, const VecX& shape) {
  const VecX w = motion_weights(system);
  Index largest = 0;
  double most = -1.0;
  for (Index i = 0; i < 6 * (system.nodes() - 1); ++i)
    if (const double size = w(i) * shape(i) * shape(i); size > most) {
      most = size;
      largest = i;
    }
  return fmt::format("{} {} its axis {}", system.node_name(largest / 6 + 1),
                     largest % 6 < 3 ? "moves along" : "turns about", largest % 3 + 1);
}

}  // namespace mbd
