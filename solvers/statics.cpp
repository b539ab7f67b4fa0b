#include "solvers/statics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "solvers/increments.hpp"

namespace mbd {
namespace {

constexpr double smallest_increment = 1e-6;  // of the load
constexpr double largest_rotation = 0.5;  // [rad] of a Newton increment; larger ones are shortened

// Newton's method at a fixed load factor, with the exact tangent.
bool equilibrium(const System& system, LinearSolver& solver, const NewtonOptions& options,
                 State& state, Counters& counters, std::string& failure) {
  IncrementNorm norm(system, options);
  VecX r, x(system.unknowns());
  const Index motions = 6 * (system.nodes() - 1);
  double previous = 0.0;
  for (int k = 0; k < options.max_iterations; ++k) {
    system.linearize(state, {}, r, solver);
    ++counters.iterations;
    ++counters.residuals;
    ++counters.tangents;
    ++counters.factorizations;
    if (k == 0) norm.set_floor(state, largest_stiffness(system, solver));
    if (solver.factor() != FactorStatus::ok) {
      const Index row = solver.singular_row();
      failure = fmt::format(
          "the tangent is singular{}: the structure can move freely there, or constraints are "
          "redundant",
          row >= 0 ? " at " + system.name_of(row + 6) : std::string());
      return false;
    }
    x = -r.tail(x.size());
    solver.solve({x.data(), static_cast<std::size_t>(x.size())});
    double rotation = 0.0;
    for (Index n = 0; n < motions; n += 6)
      rotation = std::max(rotation, x.segment<3>(n + 3).norm());
    const double cut = rotation > largest_rotation ? largest_rotation / rotation : 1.0;
    if (cut < 1.0) x.head(motions) *= cut;
    for (Index n = 1; n < system.nodes(); ++n) {
      Pose<double>& H = state.pose[static_cast<std::size_t>(n)];
      H = H * exp_se3<double>(x.segment<6>(6 * (n - 1)));
      renormalize(H);
    }
    state.lambda += x.tail(x.size() - motions);
    norm.observe(state.lambda);
    const double e = norm({x.data(), static_cast<std::size_t>(x.size())}, 1.0);
    if (!std::isfinite(e)) {
      failure =
          fmt::format("the residual is not finite at {}", system.name_of(worst_row(system, r)));
      return false;
    }
    // Quadratic convergence: what is left after an increment e < 1 is far below the tolerance. At the
    // floor of round-off increments stop falling.
    if (cut == 1.0 &&
        (e < 1.0 || (previous > 0.0 && e < 1e3 && e > 0.5 * previous && previous < 1e3))) {
      if (const std::string element = system.out_of_range(state); !element.empty()) {
        failure = range_failure(element);
        return false;
      }
      return true;
    }
    previous = e;
  }
  failure = fmt::format("Newton's iterations do not converge (worst equation: {})",
                        system.name_of(worst_row(system, r)));
  return false;
}

}  // namespace

StaticReport solve_statics(const System& system, LinearSolver& solver, const StaticOptions& options,
                           State& state) {
  StaticReport report;
  solver.analyze(system.graph());
  double increment = 1.0 / std::max(1, options.steps);
  State trial;
  while (report.load_factor < 1.0) {
    double next = report.load_factor + increment;
    if (next > 1.0 - 1e-9) next = 1.0;
    trial = state;
    trial.load_factor = next;
    std::string failure;
    const long before = report.counters.iterations;
    if (equilibrium(system, solver, options.newton, trial, report.counters, failure)) {
      state = trial;
      system.follow_angles(state);
      report.load_factor = next;
      ++report.counters.steps;
      const auto iterations = static_cast<int>(report.counters.iterations - before);
      report.most_iterations = std::max(report.most_iterations, iterations);
      if (options.accepted && !options.accepted(state)) return report;
      if (iterations <= 6) increment *= 2.0;
    } else {
      ++report.counters.retries;
      increment *= 0.5;
      if (increment < smallest_increment) {
        report.failure = fmt::format(
            "no equilibrium beyond {:.6g} of the load: {}; see what holds the structure and how "
            "large the loads are, or take more steps",
            report.load_factor, failure);
        return report;
      }
    }
  }
  report.converged = true;
  return report;
}

}  // namespace mbd
