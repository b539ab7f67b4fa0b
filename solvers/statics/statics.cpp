#include "solvers/statics/statics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstdio>

#include "solvers/statics/equilibrium.hpp"
#include "solvers/statics/stability.hpp"

namespace mbd {
namespace {

constexpr double smallest_increment = 1e-6;  // of the load
constexpr int easy_iterations = 6;  // with as many or fewer the next load step is twice as large
constexpr double giving_way =
    30.0;  // growth of the motion per load that tells a limit point from others

// Motion and multipliers per load at an equilibrium whose tangent has been factored; empty if it is not finite.
VecX motion_per_load(const System& system, const LinearSolver& solver, const State& state) {
  VecX rate;
  system.load_rate(state, rate);
  VecX z = -rate.tail(system.unknowns());
  solver.solve({z.data(), static_cast<std::size_t>(z.size())});
  return z.allFinite() ? z : VecX();
}
VecX motion_per_load_anew(const System& system, LinearSolver& solver, const State& state) {
  VecX r;
  system.linearize(state, {}, r, solver);
  return solver.factor() == FactorStatus::ok ? motion_per_load(system, solver, state) : VecX();
}

// Why there is no equilibrium a little beyond this one, if its tangent tells.
std::string reason(const System& system, LinearSolver& solver, const State& start,
                   const State& last, const std::string& failure) {
  const VecX w = motion_weights(system);
  const VecX first = motion_per_load_anew(system, solver, start),
             now = motion_per_load_anew(system, solver, last);
  if (first.size() == 0 || now.size() == 0) return failure;
  const double before = std::sqrt(first.dot(w.cwiseProduct(first))),
               size = std::sqrt(now.dot(w.cwiseProduct(now)));
  if (!(size > giving_way * before)) return failure;
  const std::optional<CriticalMode> mode = critical_mode(system, solver, last);
  if (!mode) return failure;
  return fmt::format(
      "the structure gives way: its tangent is nearly singular, in a mode in which {} most (a "
      "limit "
      "point, or a bifurcation; <path> in place of <static> follows the equilibria through it)",
      name_of_motion(system, mode->shape));
}

}  // namespace

StaticReport solve_statics(const System& system, LinearSolver& solver, const StaticOptions& options,
                           State& state) {
  StaticReport report;
  solver.analyze(system.graph());
  double increment = 1.0 / std::max(1, options.steps);
  const auto equilibrium =
      options.solver == StaticSolver::kinsol ? kinsol_equilibrium : newton_equilibrium;
  const State start = [&state] {
    State unloaded = state;
    unloaded.load_factor = 0.0;
    return unloaded;
  }();
  State trial;
  VecX rate, bend;  // of the path over the load: the next step starts from where they lead
  MixedIterate mixed;
  std::vector<Vec6> S, S_rate, S_bend;  // the same of resultants
  system.linearized_resultants(state, {}, S);
  while (report.load_factor < 1.0) {
    double next = report.load_factor + increment;
    if (next > 1.0 - 1e-9) next = 1.0;
    const double ahead = next - report.load_factor;
    trial = state;
    if (rate.size() > 0) retract(trial, ahead * rate);
    if (bend.size() > 0) retract(trial, 0.5 * ahead * ahead * bend);
    trial.load_factor = next;
    mixed.resultants = S;
    for (std::size_t i = 0; i < S_rate.size(); ++i) mixed.resultants[i] += ahead * S_rate[i];
    for (std::size_t i = 0; i < S_bend.size(); ++i)
      mixed.resultants[i] += 0.5 * ahead * ahead * S_bend[i];
    std::string failure;
    const long before = report.counters.iterations;
    NewtonOptions newton = options.newton;
    newton.line_search = false;
    NeutralMotions neutral;
    bool found = equilibrium(system, solver, newton, trial, report.counters, failure, &neutral, &mixed);
    if (!found && options.newton.line_search && options.solver == StaticSolver::newton) {
      newton.line_search = true;
      trial = state;
      trial.load_factor = next;
      mixed.resultants.clear();
      found = newton_equilibrium(system, solver, newton, trial, report.counters, failure, &neutral,
                                 &mixed);
      report.searched += found ? 1 : 0;
    }
    if (std::getenv("TRACE")) fprintf(stderr, "load %.6g (+%.3g) found %d: %ld iterations\n", next, ahead, found, report.counters.iterations - before);
    if (found) {
      state = trial;
      // Newton's last tangent is that of the solution, up to its last increment.
      VecX now = motion_per_load(system, solver, state);
      if (neutral.count() > 0 && now.size() > 0) neutral.take_out(motion_weights(system), now);
      report.neutral.clear();
      for (Index i = 0; i < neutral.count(); ++i)
        report.neutral.push_back(name_of_motion(system, neutral.shapes.col(i)));
      bend.resize(0);
      if (rate.size() > 0 && now.size() > 0) bend = (now - rate) / ahead;
      rate = std::move(now);
      system.linearized_resultants(state, {}, S);
      std::vector<Vec6> S_now;
      if (rate.size() > 0 && !S.empty()) {
        // Where the tangent was taken: a rate strains stiff directions by round-off there, by more elsewhere.
        std::vector<Vec6> there;
        system.linearized_resultants(mixed.linearized, {}, there);
        system.linearized_resultants(mixed.linearized, rate, S_now);
        for (std::size_t i = 0; i < S.size(); ++i) S_now[i] -= there[i];
      }
      S_bend.clear();
      if (S_rate.size() == S_now.size() && bend.size() > 0) {
        S_bend = S_now;
        for (std::size_t i = 0; i < S.size(); ++i) S_bend[i] = (S_now[i] - S_rate[i]) / ahead;
      }
      S_rate = std::move(S_now);
      system.follow_angles(state);
      report.load_factor = next;
      ++report.counters.steps;
      const auto iterations = static_cast<int>(report.counters.iterations - before);
      report.most_iterations = std::max(report.most_iterations, iterations);
      if (options.accepted && !options.accepted(state)) return report;
      if (iterations <= easy_iterations) increment *= 2.0;
    } else {
      ++report.counters.retries;
      if (failure.starts_with("nothing holds the motion")) {  // nor under a smaller load
        report.failure = report.load_factor > 0.0
                             ? fmt::format("no equilibrium beyond {:.9g} of the load: {}",
                                           report.load_factor, failure)
                             : failure;
        return report;
      }
      increment *= 0.5;
      if (increment < smallest_increment) {
        report.failure =
            fmt::format("no equilibrium beyond {:.9g} of the load: {}", report.load_factor,
                        reason(system, solver, start, state, failure));
        return report;
      }
    }
  }
  report.converged = true;
  return report;
}

}  // namespace mbd
