#include "solvers/time/stepper.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libmbd/core/error.hpp"
#include "solvers/newton/increments.hpp"

namespace mbd {

bool Stepper::restart_at(double t, State& state, StepReport& report) {
  const double reached = state.t;
  state.t = t;
  const StepReport again = restart(state);
  ++counters_.restarts;
  if (again.converged) return true;
  report.converged = false;
  report.failure =
      fmt::format("at t = {:.9g} s, where a load or drive jumps: {}", reached, again.failure);
  return false;
}

void Stepper::record_size(double h, bool cut) {
  if (!cut && (sizes_.least == 0.0 || h < sizes_.least)) sizes_.least = h;
  sizes_.most = std::max(sizes_.most, h);
}

Landing next_landing(std::span<const Breakpoint> breakpoints, double t, double end, double slack) {
  auto first = std::upper_bound(breakpoints.begin(), breakpoints.end(), t + slack,
                                [](double at, const Breakpoint& b) { return at < b.t; });
  Landing landing{.t = end, .restart_at = end};
  if (first == breakpoints.end() || first->t > end + slack) return landing;
  auto last = first;
  for (; last != breakpoints.end() && last->t <= std::min(first->t, end) + slack; ++last)
    landing.restart = landing.restart || last->restart;
  landing.t = first->t;
  landing.breakpoint = true;
  landing.restart_at = std::prev(last)->t;
  return landing;
}

double start_time(std::span<const Breakpoint> breakpoints, double t, double slack) {
  double start = t;
  for (const Breakpoint& b : breakpoints)
    if (b.t > t && b.t <= t + slack) start = b.t;
  return start;
}

double last_usable(const System& system, State state, double t, double slack, std::string& why) {
  double from = state.t, to = t;
  if (why.empty()) {
    system.set_time(state, t, Side::left);
    why = system.unusable_signal(state);
  }
  while (to - from > slack) {
    const double middle = from + 0.5 * (to - from);
    if (!(from < middle && middle < to)) break;
    system.set_time(state, middle, Side::left);
    std::string unusable = system.unusable_signal(state);
    (unusable.empty() ? from : to) = middle;
    if (!unusable.empty()) why = std::move(unusable);
  }
  return from;
}

void check_motion(const System& system, double max_step) {
  if (!system.with_rates())
    throw Error("the system was compiled for statics: it has no inertia to integrate");
  if (!(max_step >= 0.0))
    throw Error(fmt::format("max_step must be positive, or 0 for the usual one, not {}", max_step));
}

double time_between(double start, double end) {
  if (!(end > start))
    throw Error(fmt::format("the end {} s is not after the start {} s", end, start));
  return end - start;
}

std::string singular_failure(const std::string& unknown) {
  return fmt::format(
      "the tangent is singular{}: a mechanism in a lock, or constraints that repeat each other "
      "there",
      unknown.empty() ? unknown : " at " + unknown);
}

std::string initial_accelerations(const System& system, LinearSolver& solver, State& state,
                                  double& mass, Counters& counters) {
  VecX r, gdot, gddot_rest;
  VecX x(system.unknowns());
  system.set_time(state, state.t, Side::right);
  if (std::string unusable = system.unusable_signal(state, true); !unusable.empty())
    return unusable;
  // r is linear in Vdot and lambda: one solve, and one more against round-off.
  for (Vec6& a : state.Vdot) a.setZero();
  state.lambda.setZero();
  system.constraint_rates(state, gdot, gddot_rest);
  system.linearize(state, {.U = 0.0, .V = 0.0, .A = 1.0, .T_inv = {}}, r, solver);
  mass = largest_stiffness(system, solver);
  ++counters.tangents;
  ++counters.factorizations;
  if (solver.factor() != FactorStatus::ok) {
    const Index row = solver.singular_row();
    return fmt::format(
        "the initial accelerations are not determined{}: a node without inertia that no joint "
        "holds",
        row >= 0 ? " at " + system.name_of(row + 6) : std::string());
  }
  const Index motions = 6 * (system.nodes() - 1);
  for (int pass = 0; pass < 2; ++pass) {
    if (pass > 0) system.residual(state, r);
    x = -r.tail(x.size());
    // B Vdot + gddot_rest, with B Vdot from what has been solved: the residual's constraint rows are g.
    if (pass == 0)
      x.tail(gddot_rest.size()) = -gddot_rest;
    else
      x.tail(gddot_rest.size()).setZero();
    solver.solve({x.data(), static_cast<std::size_t>(x.size())});
    for (Index n = 1; n < system.nodes(); ++n)
      state.Vdot[static_cast<std::size_t>(n)] += x.segment<6>(6 * (n - 1));
    state.lambda += x.tail(x.size() - motions);
  }
  if (!x.allFinite()) return "the initial accelerations are not finite";
  return {};
}

}  // namespace mbd
