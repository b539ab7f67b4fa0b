#include "solvers/time/stepper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

#include "libmbd/core/error.hpp"
#include "libmbd/core/hash.hpp"
#include "solvers/newton/increments.hpp"

namespace mbd {
namespace {

// Whether constraints of positions hold as steps leave them, and those of velocities as steps without constraints of velocities
// do, which err by the square of the step: what is wrong by more has been set so.
bool is_consistent(const System& system, const State& state, StepReport& report) {
  constexpr double open = 1e-6,
                   torn = 0.2;   // of the scene's length and 1 rad; of the fastest motion
  constexpr double slow = 1e-3;  // [rad/s] no motion to speak of
  if (system.multipliers() == 0) return true;
  VecX g, gdot;
  system.constraints(state, g, gdot);
  Index row = 0;
  const double gap = largest_violation(system, g, &row);
  const bool is_open = !(gap <= open);
  const double rate = is_open ? 0.0 : largest_violation(system, gdot, &row);
  if (!is_open && rate <= std::max(slow, torn * fastest(system, state))) return true;
  report.converged = false;
  report.kind = Failure::inconsistent;
  report.failure = fmt::format(
      "the state at t = {:.9g} s breaks {}: {} by {:.3g} {}; begin with states that their joints "
      "allow",
      state.t, system.name_of(6 * system.nodes() + row),
      is_open ? "it is open" : "its velocities part", is_open ? gap : rate,
      is_open ? "(of the scene's length, or rad)" : "(of the scene's length or rad, a second)");
  return false;
}

}  // namespace

bool Stepper::restart_at(double t, State& state, double slack, StepReport& report, bool sampled) {
  const double reached = state.t;
  state.t = t;
  std::string wrong;
  bool goes_on = sampled;
  if (system().sample(state, slack, wrong)) {
    for (std::size_t i = 0; goes_on && i < inputs_.size(); ++i) {
      const InputValue &was = inputs_[i], &is = state.inputs[i];
      const bool held = was.fdot == 0.0 && was.fddot == 0.0 && is.fdot == 0.0 && is.fddot == 0.0;
      goes_on = was.f == is.f && held;
    }
    inputs_ = state.inputs;
  }
  if (!wrong.empty()) {
    report.converged = false;
    report.failure = fmt::format("at t = {:.9g} s: {}", reached, wrong);
    report.kind = Failure::law;
    return false;
  }
  if (goes_on) return true;
  const StepReport again = restart(state);
  ++counters_.restarts;
  if (again.converged) return true;
  report.converged = false;
  report.failure =
      fmt::format("at t = {:.9g} s, where a load or drive jumps: {}", reached, again.failure);
  report.kind = again.kind;
  return false;
}

void Stepper::begin_watching(const System& system, const State& state) {
  check_sizes(system, state);
  watched_ = state.t;
  inputs_ = state.inputs;
}

StepReport Stepper::first_restart(const System& system, State& state, double slack) {
  StepReport report = restart(state);
  if (!report.converged || !is_consistent(system, state, report)) return report;
  std::string wrong;
  if (!system.sample(state, slack, wrong)) return report;
  inputs_ = state.inputs;
  if (wrong.empty()) return restart(state);
  report.converged = false;
  report.failure = fmt::format("at t = {:.9g} s: {}", state.t, wrong);
  report.kind = Failure::law;
  return report;
}

Landing Stepper::landing_of(const System& system, const State& state, double end, double slack,
                            double apart) {
  Landing landing = next_landing(system.breakpoints(), state.t, end, slack, apart);
  if (system.controllers().empty()) return landing;
  const double instant = system.next_instant(state, slack);
  if (instant > landing.t + slack) return landing;
  if (instant < landing.t - slack)
    return {
        .t = instant, .breakpoint = true, .restart = true, .restart_at = instant, .sampled = true};
  landing.sampled = !landing.breakpoint;
  landing.breakpoint = landing.restart = true;
  landing.restart_at = std::max(landing.restart_at, instant);
  return landing;
}

// The state is the one that was left.
bool Stepper::goes_on_from(const State& state, StepReport& report) const {
  if (watched_ && state.t == *watched_) return true;
  report.failure = !watched_
                       ? "start() comes before step()"
                       : fmt::format(
                             "the state is of t = {:.9g} s, and the stepper was left at {:.9g} s; "
                             "call start() with it",
                             state.t, *watched_);
  report.kind = Failure::order;
  return false;
}

bool Stepper::may_step(const System& system, State& state, InputChange restarts,
                       StepReport& report) {
  if (!goes_on_from(state, report)) return false;
  const auto same = [](const InputValue& a, const InputValue& b) {
    return a.f == b.f && a.fdot == b.fdot && a.fddot == b.fddot && a.since == b.since;
  };
  if (std::equal(state.inputs.begin(), state.inputs.end(), inputs_.begin(), inputs_.end(), same))
    return true;
  if (state.inputs.size() != inputs_.size()) check_sizes(system, state);
  // What laws make of them before and after, at the same time; what is said anew in other words does not jump.
  std::vector<InputValue> old, now;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    const InputValue &was = inputs_[i], &is = state.inputs[i];
    const auto size = [&](const InputValue& u) {
      const double tau = state.t - u.since;
      return std::abs(u.f) + std::abs(u.fdot * tau) + std::abs(u.fddot * tau * tau);
    };
    const Taylor2 a = was.at(state.t), b = is.at(state.t);
    constexpr double round_off = 1e-13;
    const bool goes_on = std::abs(b.v - a.v) <= round_off * std::max(size(was), size(is));
    old.push_back({a.v, a.d, a.dd, state.t});
    now.push_back({goes_on ? a.v : b.v, b.d, b.dd, state.t});
  }
  std::vector<SignalValue> before, after;
  system.signals_at(state.t, Side::right, old, before, &state);
  system.signals_at(state.t, Side::right, now, after, &state);
  bool jump = restarts == InputChange::any;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const SignalValue &was = before[i], &is = after[i];
    if (system.signal_use(i) == SignalUse::load) {
      jump = jump || is.f != was.f;
      continue;
    }
    constexpr double round_off = 1e-9;
    const double least = round_off * std::min(1.0, system.length_scale());
    const auto differs = [&](double x, double y) {
      return !(std::abs(x - y) <= std::max(least, round_off * std::max(std::abs(x), std::abs(y))));
    };
    if (differs(is.f, was.f) || differs(is.fdot, was.fdot)) {
      const bool rate = !differs(is.f, was.f);
      report.failure = fmt::format(
          "at t = {:.9g} s an input makes {}{} jump from {:.9g} to {:.9g}, an impact; let it go on "
          "from its value and its rate (InputValue)",
          state.t, rate ? "the rate of " : "", system.signal_name(i), rate ? was.fdot : was.f,
          rate ? is.fdot : is.f);
      report.kind = Failure::law;
      return false;
    }
    jump = jump || is.fddot != was.fddot;
  }
  inputs_ = state.inputs;
  return !jump || restart_at(state.t, state, 0.0, report);
}

void Stepper::archive(Archive& a) { a(counters_, sizes_, stop_, watched_, inputs_); }

namespace {

std::uint64_t hash_of(std::span<const char> bytes) {
  Hash hash;
  hash.add(bytes.data(), bytes.size());
  return hash.value();
}

// Of everything that a system's equations depend on: its parts by name, laws of time, inputs and sensors and what controllers do
// as they are, and the residuals of some motions of many sizes, by which laws of springs and the like are known.
std::uint64_t fingerprint(const System& system) {
  Hash hash;
  for (Index n = 0; n < system.nodes(); ++n) hash.add(system.node_name(n));
  for (const ConstraintInfo& c : system.constraints()) hash.add(c.name);
  for (std::size_t i = 0; i < system.signals().size(); ++i) {
    hash.add(system.signal_name(i));
    bool is_rate = false;
    if (const Expression* const law = system.signals()[i].expression(is_rate)) {
      hash.add(is_rate);
      hash.add(law->signature());
    }
  }
  for (const InputInfo& input : system.inputs()) hash.add(input.name + " " + input.unit);
  const State reference = system.reference_state();
  State state = reference;
  const auto motion = [&](double size, Index n) {
    Vec6 x;
    for (Index i = 0; i < 6; ++i)
      x(i) = size * std::sin(1.0 + 6.0 * static_cast<double>(n) + static_cast<double>(i)) *
             (i < 3 ? system.length_scale() : 1.0);
    return x;
  };
  VecX r;
  for (const double size : {1e-3, -1e-6, 1e-5, -1e-4, 1e-2, -0.1, 0.5}) {
    for (Index n = 1; n < system.nodes(); ++n) {
      const auto N = static_cast<std::size_t>(n);
      state.pose[N] = reference.pose[N] * exp_se3<double>(motion(size, n));
      state.V[N] = motion(1e3 * size, n + 1);
      state.Vdot[N] = motion(1e3 * size, n + 2);
    }
    try {
      system.residual(state, r);
    } catch (const std::exception&) {  // a program's force, which knows no such motion
      r.setZero();
    }
    hash.add(std::span<const double>(r.data(), static_cast<std::size_t>(r.size())));
  }
  for (const auto& controller : system.controllers()) {
    hash.add(controller->name());
    hash.add(controller->period());
    hash.add(controller->signature());
  }
  std::string failure;
  if (system.sample(state, 0.0, failure)) {  // what they make of that motion
    hash.add(std::span<const double>(state.control));
    for (const InputValue& input : state.inputs) hash.add(input.f);
  }
  return hash.value();
}

constexpr std::string_view checkpoint_format = "mbd checkpoint 4";

}  // namespace

std::uint64_t Stepper::fingerprint_of_model() const {
  if (!fingerprint_) fingerprint_ = fingerprint(system());
  return *fingerprint_;
}

// With the kind of the linear solver, on which last digits depend.
std::string Stepper::signed_with_solver() const {
  const std::string of = signature(), method = linear_facts().method;
  return of.empty() || method.empty() ? of : of + ", " + method.substr(0, method.find(','));
}

Checkpoint Stepper::kept(const State& state) const {
  const std::string of = signed_with_solver();
  if (of.empty())
    throw Error(
        "this method keeps a history that cannot be saved; keep the state, and start() from it");
  if (!watched_ || state.t != *watched_)
    throw Error(fmt::format("the state of t = {:.9g} s is not the one that the stepper has reached",
                            state.t));
  Archive a;
  std::string format(checkpoint_format), signed_by = of;
  std::uint64_t model = fingerprint_of_model();
  State copy = state;
  a(format, signed_by, model, copy);
  const_cast<Stepper*>(this)->archive(a);  // which writes
  Checkpoint made{a.take()};
  const std::uint64_t sum = hash_of(made.bytes);
  const auto* const first = reinterpret_cast<const char*>(&sum);
  made.bytes.insert(made.bytes.end(), first, first + sizeof sum);
  return made;
}

void Stepper::resume(const Checkpoint& checkpoint, State& state) {
  std::uint64_t sum = 0, model = 0;
  std::span<const char> bytes(checkpoint.bytes);
  if (bytes.size() > sizeof sum) {
    std::memcpy(&sum, &*(bytes.end() - sizeof sum), sizeof sum);
    bytes = bytes.first(bytes.size() - sizeof sum);
  }
  if (bytes.empty() || sum != hash_of(bytes))
    throw Error("the checkpoint is damaged: it is cut off, or has been changed");
  Archive a(bytes);
  std::string format, signed_by;
  a(format);
  if (format != checkpoint_format)
    throw Error("this is no checkpoint, or one of another version of mbd");
  a(signed_by, model);
  if (model != fingerprint_of_model())
    throw Error("the checkpoint is of another model, or of other values of its parameters");
  if (const std::string own = signed_with_solver(); signed_by != own)
    throw Error(fmt::format("the checkpoint is of {}, and this is {}", signed_by, own));
  State read;
  a(read);
  check_sizes(system(), read);
  archive(a);
  state = read;  // arrays stay where they are, for those who look at them
}

Checkpoint Stepper::save(const State& state) {
  Checkpoint made = kept(state);
  take_new_tangent();
  return made;
}

void Stepper::restore(const Checkpoint& checkpoint, State& state) {
  resume(checkpoint, state);
  take_new_tangent();
}

Checkpoint Stepper::remember(const State& state) const { return kept(state); }

void Stepper::go_back(const Checkpoint& checkpoint, State& state) { resume(checkpoint, state); }

void check_sizes(const System& system, const State& state) {
  const auto nodes = static_cast<std::size_t>(system.nodes());
  const std::size_t rates = system.with_rates() ? nodes : 0;
  const auto check = [](const char* what, std::size_t is, std::size_t wanted) {
    if (is != wanted)
      throw Error(
          fmt::format("the state is not one of this model: {} {}, and the model has {}; "
                      "begin with Model::initial",
                      is, what, wanted));
  };
  check("nodes", state.pose.size(), nodes);
  check("velocities", state.V.size(), rates);
  check("accelerations", state.Vdot.size(), rates);
  check("multipliers", static_cast<std::size_t>(state.lambda.size()),
        static_cast<std::size_t>(system.multipliers()));
  check("signals", state.signals.size(), system.signals().size());
  check("inputs", state.inputs.size(), system.inputs().size());
  check("numbers of controllers", state.control.size(), system.reference_state().control.size());
}

void Stepper::record_size(double h, bool cut) {
  if (!cut && (sizes_.least == 0.0 || h < sizes_.least)) sizes_.least = h;
  sizes_.most = std::max(sizes_.most, h);
}

Landing next_landing(std::span<const Breakpoint> breakpoints, double t, double end, double slack,
                     double apart) {
  auto first = std::upper_bound(breakpoints.begin(), breakpoints.end(), t + slack,
                                [](double at, const Breakpoint& b) { return at < b.t; });
  const auto counts = [&](auto b) {
    return !b->smooth ||
           (std::isfinite(apart) && (b == breakpoints.begin() || b->t - std::prev(b)->t > apart) &&
            (std::next(b) == breakpoints.end() || std::next(b)->t - b->t > apart));
  };
  while (first != breakpoints.end() && !counts(first)) ++first;
  Landing landing{.t = end, .restart_at = end};
  if (first == breakpoints.end() || first->t > end + slack) return landing;
  auto last = first;
  for (; last != breakpoints.end() && last->t <= std::min(first->t, end) + slack; ++last)
    if (counts(last)) {
      landing.restart = landing.restart || last->restart;
      landing.breakpoint = landing.breakpoint || !last->smooth;
      landing.restart_at = last->t;
    }
  landing.t = first->t;
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
