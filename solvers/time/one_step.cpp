#include "solvers/time/one_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "libmbd/core/error.hpp"
#include "libmbd/core/flush_to_zero.hpp"
#include "solvers/constraints/redundancy.hpp"

namespace mbd {
namespace {

constexpr int most_halvings = 40;
constexpr int most_contradictions = 30;  // beyond these steps would only creep
// So many steps in a row, each that many times the round-off of times: a run that would never end.
constexpr int most_short_steps = 300;
constexpr double short_step = 100.0;
constexpr double least_of_turn = 1e-4;  // of a step: what turns at once has been met where it began
constexpr int successes_double = 4;     // so many small steps in a row: back to twice the size
constexpr double loose_multipliers = 1e-2;  // their relative tolerance in a rank-tolerant step

// A law of time may ask for less than the estimate of the error does, which knows only what it has seen.
double wanted_step(const StepController& controller, const LawSteps& laws, std::size_t cells,
                   double t, double longest) {
  return std::min({controller.step(), laws.end_of_step(t, cells) - t, longest});
}

}  // namespace

OneStep::OneStep(const System& system, std::unique_ptr<LinearSolver> solver,
                 const Settings& settings, int error_order)
    : system_(system),
      solver_(std::move(solver)),
      settings_(settings),
      norm_(system, settings.newton),
      error_order_(error_order) {
  const bool adaptive = settings.adaptive();
  if (!adaptive && (!(settings.step > 0.0) || !std::isfinite(settings.step)))
    throw Error(fmt::format("the time step must be positive, not {}", settings.step));
  if (adaptive && !(settings.end > 0.0 && std::isfinite(settings.end)))
    throw Error(fmt::format("adaptive steps need a time at which they end, not {}", settings.end));
  check_motion(system, settings.max_step);
  if (!(settings.max_halvings >= 0 && settings.max_halvings <= most_halvings))
    throw Error(fmt::format("max_halvings must lie in 0 … {}, not {}", most_halvings,
                            settings.max_halvings));
}

bool OneStep::usable(const State& state, StepReport& report) {
  report.failure = system_.unusable_signal(state);
  if (report.failure.empty()) return true;
  last_usable_ = last_usable(system_, begin_, state.t, slack_, report.failure);
  report.kind = Failure::law;
  return false;
}

void OneStep::add_rank_tolerance(std::span<const Slot> own) const {
  const double length = system_.length_scale();
  for (std::size_t k = 0; k < own.size(); ++k)
    for (Index i = 0; i < system_.constraints()[k].rows; ++i)
      own[k].data[i * (own[k].ld + 1)] -=
          rank_tolerance_ / (system_.constraints()[k].is_position[static_cast<std::size_t>(i)]
                                 ? mass_
                                 : mass_ * length * length);
}

double OneStep::multiplier_slack() const {
  return tolerant_ ? std::max(1.0, loose_multipliers / settings_.newton.multiplier_tolerance) : 1.0;
}

double OneStep::round_off_of_positions(const State& state) const {
  double farthest = system_.length_scale();
  for (const Pose<double>& H : state.pose) farthest = std::max(farthest, H.r.cwiseAbs().maxCoeff());
  return std::numeric_limits<double>::epsilon() * farthest;
}

void OneStep::set_round_off(double size, std::span<double> x) const {
  std::fill(x.begin(), x.end(), 0.0);
  auto row = x.end() - system_.multipliers();
  // Signs without a pattern that a mechanism could share: bits of multiples of the golden ratio.
  std::uint32_t bits = 0;
  for (const ConstraintInfo& c : system_.constraints())
    for (const bool is_position : c.is_position) {
      bits += 0x9E3779B9u;
      const double signed_size = (bits >> 31) != 0 ? -size : size;
      *row++ = is_position ? signed_size : signed_size / system_.length_scale();
    }
}

RoundOff OneStep::round_off_of(std::span<const double> x, double rate, double force_rate) const {
  RoundOff r;
  auto value = x.begin();
  for (Index n = 1; n < system_.nodes(); ++n)
    for (Index i = 0; i < 6; ++i, ++value)
      if (i < 3) r.velocity = std::max(r.velocity, rate * std::abs(*value));
  for (const ConstraintInfo& c : system_.constraints())
    for (const bool is_position : c.is_position) {
      double& largest = is_position ? r.force : r.moment;
      largest = std::max(largest, force_rate * std::abs(*value++));
    }
  return r;
}

std::string OneStep::newton_failure(const std::string& out_of_range, const VecX& r) const {
  if (!out_of_range.empty()) return range_failure(out_of_range);
  return fmt::format(
      "Newton's iterations do not converge (worst equation: {}); look for a lock, a jump or an "
      "instability there, or try a smaller step",
      system_.name_of(worst_row(system_, r)));
}

StepReport OneStep::start(State& state) {
  origin_ = state.t;
  prepare();
  state.t = start_time(system_.breakpoints(), origin_, slack_);
  begin_watching(system_, state);
  count_ = 0;
  halvings_ = 0;
  sizes_ = {};
  return first_restart(system_, state, slack_);
}

namespace {

// Instants nearer than `slack` [s] are one, but those that a law states so near to each other: a pulse of that width has its
// impulse.
double slack_between(std::span<const Breakpoint> breakpoints, double slack) {
  constexpr double same = 1e-13, part = 0.25;
  for (std::size_t i = 1; i < breakpoints.size(); ++i) {
    const double apart = breakpoints[i].t - breakpoints[i - 1].t;
    if (apart > same * std::abs(breakpoints[i].t)) slack = std::min(slack, part * apart);
  }
  return slack;
}

}  // namespace

// What follows from settings and the time of start().
void OneStep::prepare() {
  if (!settings_.adaptive()) {
    slack_ = slack_between(system_.breakpoints(), time_rounding * settings_.step);
    return;
  }
  const double span = time_between(origin_, settings_.end);
  error_norm_ = std::make_unique<ErrorNorm>(system_, settings_.tolerances, span);
  controller_ = std::make_unique<StepController>(
      error_order_, settings_.max_step > 0.0 ? settings_.max_step : longest_step * span);
  slack_ = time_floor * span;
  laws_ = LawSteps(system_, origin_, settings_.end);
}

void OneStep::change_error_order(int order, double h) {
  error_order_ = order;
  controller_->change_order(order);
  controller_->start(h);
}

void OneStep::archive(Archive& a) {
  const double before = origin_;
  const bool started = controller_ != nullptr;
  a(origin_);
  if (a.reads() && !(started && origin_ == before)) prepare();
  Stepper::archive(a);
  a(norm_, mass_, tolerant_, rank_tolerance_, count_, halvings_, good_, contradictions_,
    short_steps_, choose_rows_);
  if (error_norm_) a(*error_norm_);
  if (controller_) a(*controller_);
}

std::string OneStep::signature_of(std::string_view method,
                                  std::initializer_list<double> own) const {
  const ErrorTolerances& t = settings_.tolerances;
  const NewtonOptions& n = settings_.newton;
  std::string text = fmt::format(
      "{} with step {:.17g}, tolerances {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}, end {:.17g}, "
      "longest step {:.17g}, {} halvings, Newton {:.17g} {:.17g} {} {}",
      method, settings_.step, t.relative, t.position, t.rotation, t.velocity, t.angular_velocity,
      settings_.end, settings_.max_step, settings_.max_halvings, n.tolerance,
      n.multiplier_tolerance, n.max_iterations, static_cast<int>(n.tangent));
  for (const double x : own) text += fmt::format(", {:.17g}", x);
  return text;
}

StepReport OneStep::restart(State& state) {
  StepReport report;
  report.failure = initial_accelerations(system_, *solver_, state, mass_, counters_);
  if (!report.failure.empty()) {
    report.kind = Failure::singular;
    return report;
  }
  norm_.observe(state.lambda);
  begin_at(state);
  if (controller_) controller_->start(first_step(system_, state, settings_.end - state.t));
  report.converged = true;
  return report;
}

StepReport OneStep::step(State& state) {
  StepReport report;
  const FlushToZero fast;
  if (!may_step(system_, state, InputChange::jump, report)) return report;
  report = settings_.adaptive() ? adaptive_step(state) : fixed_step(state);
  watch(state);
  if (report.converged)
    report.kind = Failure::none;
  else if (report.kind == Failure::none)
    report.kind = Failure::convergence;
  return report;
}

bool OneStep::try_step(const State& state, double t, StepReport& report) {
  begin_ = state;
  double h = t - begin_.t;
  // Not the round-off of times: accelerations see it divided by h^2.
  if (std::abs(h - settings_.step) <= time_rounding * settings_.step) h = settings_.step;
  const int before = report.iterations;
  const double contraction = report.contraction;
  report.iterations = 0;
  report.failure.clear();
  report.kind = Failure::none;
  last_usable_.reset();
  bool converged = attempt(t, h, report);
  if (!converged && !bounded_ && !last_usable_ && system_.idle_rows_allowed())
    converged = attempt_with_other_rows(t, h, report);
  report.iterations += before;
  report.contraction = converged ? std::max(contraction, report.contraction) : contraction;
  report.floor = norm_.floor();
  if (converged)
    report.failure.clear();
  else
    settle();
  return converged;
}

// Solves the step from begin_, and looks at its idle rows.
bool OneStep::attempt(double t, double h, StepReport& report) {
  parted_ = false;
  if (!solve_step(t, h, report)) return false;
  if (begin_.idle.empty()) return true;
  const std::optional<std::string> open = idle_rows_open(system_, solved());
  if (!open) return true;
  parted_ = true;
  report.failure = *open;
  return false;
}

bool OneStep::attempt_with_other_rows(double t, double h, StepReport& report) {
  const std::string failure = report.failure;
  bool parted = parted_;  // in any attempt
  const Redundancy found = find_redundancy(system_, begin_);
  if (found.idle != begin_.idle) {
    forget();
    begin_.lambda = without_idle(system_, begin_, found.idle);
    begin_.idle = found.idle;
    if (attempt(t, h, report)) return true;
    parted = parted || parted_;
  }
  if (parted && !begin_.idle.empty()) {
    forget();
    begin_.idle.clear();
    choose_rows_ = solve_step(t, h, report);
    if (choose_rows_) return true;
  }
  forget();
  parted_ = parted;
  report.failure = failure;
  return false;
}

void OneStep::take_step(State& state) {
  accept();
  if (choose_rows_) {
    end_.idle = find_redundancy_nearby(system_, end_).idle;
    end_.lambda = without_idle(system_, end_, end_.idle);
    forget();
    choose_rows_ = false;
  }
  norm_.observe(end_.lambda);
  state = end_;
  ++counters_.substeps;
  if (!tolerant_) return;
  ++counters_.tolerant;
  settle();
}

StepReport OneStep::fixed_step(State& state) {
  StepReport report;
  const double end = origin_ + static_cast<double>(count_ + 1) * settings_.step;
  double reached = state.t;
  while (reached < end - slack_) {
    const Landing landing =
        landing_of(system_, state, end, slack_, std::numeric_limits<double>::infinity());
    reached = landing.t;
    const double whole = landing.t - state.t;
    for (bool last = false; !last;) {  // in one step, or in pieces
      const double h = std::ldexp(whole, -halvings_);
      usual_ = std::ldexp(settings_.step, -halvings_);
      last = h > (landing.t - state.t) * (1.0 - time_rounding);
      if (try_step(state, last ? landing.t : state.t + h, report)) {
        if (passed_.passes(begin_, inside(), solved())) ++counters_.passed_kinks;
        take_step(state);
        if (halvings_ > 0 && ++good_ == successes_double) {
          --halvings_;
          good_ = 0;
        }
        continue;
      }
      last = false;
      good_ = 0;
      if (bounded_ || halvings_ == settings_.max_halvings) {
        report.failure = fmt::format("from t = {:.9g} s{}: {}", state.t,
                                     !bounded_ && settings_.max_halvings > 0 && !last_usable_
                                         ? fmt::format(", even with a step of {:.3g} s", h)
                                         : std::string(),
                                     report.failure);
        return report;
      }
      ++halvings_;
      ++counters_.retries;
    }
    if (landing.restart && !restart_at(landing.restart_at, state, slack_, report,
                                       landing.sampled && landing.t >= end - slack_))
      return report;
  }
  ++count_;
  ++counters_.steps;
  report.converged = true;
  return report;
}

bool OneStep::is_too_short(double h, double t, const std::string& unusable,
                           StepReport& report) const {
  if (h > slack_) return false;
  if (!unusable.empty()) {
    report.failure = fmt::format("from t = {:.9g} s: {}", t, unusable);
    return true;
  }
  report.failure = fmt::format(
      "at t = {:.9g} s the step has shrunk to {:.3g} s, where times are round-off: {}", t, h,
      report.failure.empty()
          ? fmt::format("the estimated error stays too large at {}; look for a lock, a jump or an "
                        "instability there",
                        system_.name_of(error_norm_->worst_row()))
          : report.failure);
  if (report.kind == Failure::none) report.kind = Failure::step_size;
  return true;
}

bool OneStep::stays_short(double h, bool last, double t, StepReport& report) {
  if (h > short_step * slack_) short_steps_ = 0;
  if (h > short_step * slack_ || last || ++short_steps_ <= most_short_steps) return false;
  report.failure = fmt::format(
      "at t = {:.9g} s the steps remain shorter than {:.3g} s, where times are nearly "
      "round-off, "
      "{} of them in a row: {}",
      t, short_step * slack_, most_short_steps, shortened_by_);
  report.kind = Failure::step_size;
  return true;
}

// Of a step that is wanted, with `rest` to go: two alike, rather than a whole one and a rest.
double OneStep::fitted(double wanted, double rest) {
  if (wanted > rest * (1.0 - same_step)) return rest;
  return 2.0 * wanted > rest ? 0.5 * rest : wanted;
}

void OneStep::record_error(double error) {
  sizes_.worst_error = std::max(sizes_.worst_error, error);
  sizes_.position_error += error_norm_->position();
  sizes_.rotation_error += error_norm_->rotation();
  sizes_.velocity_left = std::max(sizes_.velocity_left, error_norm_->velocity_left());
}

StepReport OneStep::past_the_end(double t) const {
  StepReport report;
  report.failure = fmt::format("t = {:.9g} s is the end of the integration{}", t,
                               stop_ < settings_.end ? " (Stepper::stop_at)" : "");
  report.kind = Failure::end;
  return report;
}

// Whether in the solved step of h [s] something turns beyond a kink of its law: there the step should end.
bool OneStep::turns_in_step(double h, Landing& landing) {
  const std::optional<double> turn = passed_.turn(begin_, inside(), solved());
  if (!turn || *turn - begin_.t <= least_of_turn * h) return false;
  if (tolerant_) settle();
  landing = {.t = *turn};
  return true;
}

StepReport OneStep::adaptive_step(State& state) {
  StepReport report;
  const double end = std::min(settings_.end, stop_);
  Landing landing = landing_of(system_, state, end, slack_, controller_->step());
  std::string unusable;  // why the step has to end at landing.t, if a signal is the reason
  bool again = false, contradicted = false, turned = false;
  const double creeping = 100.0 * short_step * slack_;  // of longer ones none asks why
  if (!(landing.t - state.t > slack_)) return past_the_end(state.t);
  for (;;) {
    const double rest = landing.t - state.t;
    usual_ = wanted_step(*controller_, laws_, cells_, state.t, longest_from(state));
    const double h = fitted(usual_, rest);
    const bool last = h == rest;
    if (is_too_short(h, state.t, unusable, report)) return report;
    if (!try_step(state, last ? landing.t : state.t + h, report)) {
      ++counters_.retries;
      if (last_usable_) {
        unusable = report.failure;
        landing = {.t = *last_usable_};
        continue;
      }
      contradicted = contradicted || parted_;
      if (parted_ && ++contradictions_ > most_contradictions) {
        report.failure = fmt::format("at t = {:.9g} s: {}", state.t, report.failure);
        return report;
      }
      if (h < creeping) shortened_by_ = report.failure;
      pass_failure(h);
      controller_->failed(h);
      continue;
    }
    report.error = estimated_error(again);
    if (!(report.error <= 1.0)) {
      ++counters_.rejected;
      again = true;
      if (h < creeping)
        shortened_by_ = "the estimated error of longer ones is too large at " +
                        system_.name_of(error_norm_->worst_row());
      controller_->rejected(h, report.error);
      if (tolerant_) settle();
      continue;
    }
    turned = !turned && turns_in_step(h, landing);
    if (turned) continue;
    controller_->accepted(h, report.error);
    if (!contradicted) contradictions_ = std::max(contradictions_ - 1, 0);
    if (stays_short(h, last, state.t, report)) return report;
    record_size(h, last);
    record_error(report.error);
    take_step(state);
    ++counters_.steps;
    if (last && landing.restart && !restart_at(landing.restart_at, state, slack_, report))
      return report;
    if (last && landing.breakpoint && !landing.restart) pass_kink();
    report.converged = true;
    return report;
  }
}

}  // namespace mbd
