#include "solvers/generalized_alpha.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libmbd/core/error.hpp"
#include "libmbd/core/spectral.hpp"

namespace mbd {
namespace {

// Policy of the kept tangent (speed.md).
// A contraction measured at small increments is partly luck: with a floor of 1e-3 (speed.md) a stale one
// let multipliers of a chain pass that were wrong by 1e-3; 0.1 costs a few per cent of the iterations.
constexpr double theta_floor = 0.1;
constexpr double theta_memory = 0.3;    // how fast a good contraction is believed
constexpr double theta_refactor = 0.5;  // worse: a new tangent inside the step
constexpr double theta_fresh = 0.05;    // assumed of a new tangent
constexpr double time_rounding = 1e-6;  // of a step: what sums of steps can be wrong by, and more
constexpr double same_step = 1e-3;      // steps that differ less share a tangent
constexpr int most_halvings = 40;
// Of a rank-tolerant step: eps in units of 1/mass, and a factor on the tolerance of multipliers, of which some
// are not determined there.
constexpr double rank_tolerance = 1e-3;
constexpr double multiplier_slack = 1e5;
constexpr int successes_double = 4;     // so many small steps in a row: back to twice the size
constexpr int iterations_refactor = 3;  // this many: a new tangent at the next step
// Adaptive steps: the estimate (4) goes with h^3, the error with h^2; the constant was chosen so that errors of
// the dynamic models are about the tolerance.
constexpr int error_order = 3;
constexpr double local_tolerance = 0.03;
constexpr double longest = 0.05;      // step, of the time until the end
constexpr double time_floor = 1e-12;  // round-off of times, of the time until the end

}  // namespace

GeneralizedAlphaParameters generalized_alpha_parameters(double rho) {
  GeneralizedAlphaParameters a{};
  a.alpha_m = (2.0 * rho - 1.0) / (rho + 1.0);
  a.alpha_f = rho / (rho + 1.0);
  a.gamma = 0.5 + a.alpha_f - a.alpha_m;
  a.beta = 0.25 * (a.gamma + 0.5) * (a.gamma + 0.5);
  return a;
}

GeneralizedAlpha::GeneralizedAlpha(const System& system, std::unique_ptr<LinearSolver> solver,
                                   const GeneralizedAlphaOptions& options)
    : system_(system),
      solver_(std::move(solver)),
      options_(options),
      a_(generalized_alpha_parameters(options.rho_infinity)),
      norm_(system, options.newton),
      dense_(system, HermiteStep::Degree::cubic) {
  const bool adaptive = options.step == 0.0 && options.tolerances.relative != 0.0;
  if (!adaptive && (!(options.step > 0.0) || !std::isfinite(options.step)))
    throw Error(fmt::format("the time step must be positive, not {}", options.step));
  if (adaptive && !(options.end > 0.0 && std::isfinite(options.end)))
    throw Error(fmt::format("adaptive steps need a time at which they end, not {}", options.end));
  if (!(options.max_step >= 0.0))
    throw Error(
        fmt::format("max_step must be positive, or 0 for the usual one, not {}", options.max_step));
  if (!(options.rho_infinity >= 0.0 && options.rho_infinity <= 1.0))
    throw Error(fmt::format("rho_infinity must lie in [0, 1], not {}", options.rho_infinity));
  if (!system.with_rates())
    throw Error("the system was compiled for statics: it has no inertia to integrate");
  if (!(options.max_halvings >= 0 && options.max_halvings <= most_halvings))
    throw Error(fmt::format("max_halvings must lie in 0 … {}, not {}", most_halvings,
                            options.max_halvings));
  const auto n = static_cast<std::size_t>(system.nodes());
  if (options.balance == Balance::momentum) {
    momentum_.resize(n);
    p_.resize(n);
  }
  solver_->analyze(own_graph(false));
  Q_.assign(n, Vec6::Zero());
  A_.assign(n, Vec6::Zero());
  Vdot_old_.assign(n, Vec6::Zero());
  T_inv_.assign(n, Mat6::Identity());
  x_.resize(system.unknowns());
  if (adaptive) error_.assign(n, Vec6::Zero());
}

// The system's graph, then what the stepper adds: diagonal blocks of the nodes for a balance of momenta, and of
// the multipliers.
BlockGraph GeneralizedAlpha::own_graph(bool tolerant) const {
  BlockGraph graph = system_.graph();
  const int nodes = static_cast<int>(system_.nodes()) - 1;
  if (!momentum_.empty())
    for (int k = 0; k < nodes; ++k) graph.contributions.push_back({k, k});
  if (tolerant)
    for (int k = nodes; k < static_cast<int>(graph.blocks.size()); ++k)
      graph.contributions.push_back({k, k});
  return graph;
}

StepReport GeneralizedAlpha::start(State& state) {
  origin_ = state.t;
  if (!error_.empty()) {
    const double span = options_.end - origin_;
    if (!(span > 0.0))
      throw Error(fmt::format("the end {} s is not after the start {} s", options_.end, origin_));
    error_norm_ = std::make_unique<ErrorNorm>(system_, options_.tolerances, span);
    controller_ = std::make_unique<StepController>(
        error_order, options_.max_step > 0.0 ? options_.max_step : longest * span);
    slack_ = time_floor * span;
  } else {
    slack_ = time_rounding * options_.step;
  }
  for (const Breakpoint& b : system_.breakpoints())  // one that is here but for round-off
    if (b.t > origin_ && b.t <= origin_ + slack_) state.t = b.t;
  count_ = 0;
  halvings_ = 0;
  sizes_ = {};
  return restart(state);
}

StepReport GeneralizedAlpha::restart(State& state) {
  StepReport report;
  report.failure = initial_accelerations(system_, *solver_, state, mass_, counters_);
  if (!report.failure.empty()) return report;
  system_.linearize(state, {.U = 1.0, .V = 0.0, .A = 0.0, .T_inv = {}}, r_, *solver_);
  stiffness_ = largest_stiffness(system_, *solver_);
  ++counters_.tangents;
  if (!momentum_.empty()) {
    // Inertial force: what keeps the others in balance. With momentum_rate = 1, r = M V + the others.
    system_.momenta(state, p_);
    state.momentum_rate = 1.0;
    system_.residual(state, r_);
    state.momentum_rate = 0.0;
    for (std::size_t n = 1; n < momentum_.size(); ++n) {
      const Vec6 f = p_[n] - r_.segment<6>(6 * static_cast<Index>(n));
      Momentum& m = momentum_[n];
      m.mu = inertial_wrench<double>(state.pose[n], p_[n]);
      m.f = m.a = inertial_wrench<double>(state.pose[n], f);
    }
  }
  A_ = state.Vdot;
  Vdot_old_ = state.Vdot;
  lambda_old_ = state.lambda;
  lambda_older_ = state.lambda;
  norm_.observe(state.lambda);
  power_ = system_.load_power(state);
  drive_power_ = system_.drive_power(state);
  history_ = 0;
  h_ = 0.0;
  factored_ = false;
  refactor_next_ = true;
  if (controller_) controller_->start(first_step(system_, state, options_.end - state.t));
  report.converged = true;
  return report;
}

// A, and a of (3), for a step of another size.
void GeneralizedAlpha::set_step(const State& state, double h) {
  // Not the round-off of times: accelerations see it divided by h^2.
  if (std::abs(h - options_.step) <= time_rounding * options_.step) h = options_.step;
  if (h == h_) return;
  if (h_ > 0.0) {
    const double ratio = h / h_;
    for (std::size_t n = 1; n < A_.size(); ++n)
      A_[n] = state.Vdot[n] + ratio * (A_[n] - state.Vdot[n]);
    for (Momentum& m : momentum_) m.a = m.f + ratio * (m.a - m.f);
    if (std::abs(ratio - 1.0) > same_step) refactor_next_ = true;
  }
  h_ = h;
  norm_.set_floor(state, stiffness_ + mass_ / (a_.beta * h * h));
}

// Predicted end of the step, and what of (1) does not change in the iterations.
void GeneralizedAlpha::predict(const State& state, double t, bool extrapolate) {
  const double h = h_;
  end_ = state;
  system_.set_time(end_, t, Side::left);  // what acts during the step, if it ends on a jump
  const double ahead = extrapolate && history_ >= 1 ? h / (state.t - t_old_) : 0.0;
  if (extrapolate && history_ >= 2) {
    const auto w = lagrange<3>({state.t, t_old_, t_older_}, t);
    end_.lambda = w[0] * state.lambda + w[1] * lambda_old_ + w[2] * lambda_older_;
  } else if (ahead > 0.0) {
    end_.lambda = state.lambda + ahead * (state.lambda - lambda_old_);
  }
  for (std::size_t n = 1; n < Q_.size(); ++n) {
    const Vec6& Vdot_i = state.Vdot[n];
    const Vec6 Vdot_f = Vdot_i + ahead * (Vdot_i - Vdot_old_[n]);
    const Vec6 A_f = ((1.0 - a_.alpha_f) * Vdot_f + a_.alpha_f * Vdot_i - a_.alpha_m * A_[n]) /
                     (1.0 - a_.alpha_m);
    Q_[n] = h * state.V[n] + h * h * ((0.5 - a_.beta) * A_[n] + a_.beta * A_f);
    end_.V[n] = state.V[n] + h * ((1.0 - a_.gamma) * A_[n] + a_.gamma * A_f);
    end_.Vdot[n] = Vdot_f;
  }
  if (!momentum_.empty()) {
    const double m = (1.0 - a_.alpha_m) / (1.0 - a_.alpha_f), g = a_.gamma;
    end_.momentum_rate = m / (g * h);
    for (Momentum& n : momentum_)
      n.past = m * (n.mu / (g * h) + ((1.0 - g) / g) * n.a) +
               (a_.alpha_f * n.f - a_.alpha_m * n.a) / (1.0 - a_.alpha_f);
  }
  update_poses();
}

void GeneralizedAlpha::update_poses() {
  for (std::size_t n = 1; n < Q_.size(); ++n) end_.pose[n] = begin_.pose[n] * exp_se3(Q_[n]);
}

// r of (1), or of (3), at the present iterate. False if an element is out of its range.
bool GeneralizedAlpha::residual() {
  const bool in_range = system_.residual(end_, r_);
  for (std::size_t n = 1; n < momentum_.size(); ++n)
    r_.segment<6>(6 * static_cast<Index>(n)) -=
        body_wrench<double>(end_.pose[n], momentum_[n].past);
  return in_range;
}

// Tangent (2) and residual at the present iterate.
bool GeneralizedAlpha::factorize(StepReport& report, bool& in_range) {
  const double h = h_, s = a_.beta * h * h;
  for (std::size_t n = 1; n < Q_.size(); ++n) T_inv_[n] = T_inverse(Q_[n]).matrix();
  in_range = system_.linearize(
      end_,
      {.U = s, .V = a_.gamma * h, .A = (1.0 - a_.alpha_m) / (1.0 - a_.alpha_f), .T_inv = T_inv_},
      r_, solver());
  std::span<const Slot> own = solver().slots().subspan(system_.graph().contributions.size());
  for (std::size_t n = 1; n < momentum_.size(); ++n) {
    // d(Ad^T p) = (Ad^T p)^U dU
    const Vec6 past = body_wrench<double>(end_.pose[n], momentum_[n].past);
    r_.segment<6>(6 * static_cast<Index>(n)) -= past;
    Eigen::Map<Mat6, 0, Eigen::OuterStride<>>(
        own[n - 1].data, Eigen::OuterStride<>(own[n - 1].ld)) -= s * wrench_hat(past);
  }
  if (tolerant_) {
    if (!momentum_.empty()) own = own.subspan(momentum_.size() - 1);
    for (std::size_t k = 0; k < own.size(); ++k)
      for (Index i = 0; i < system_.constraints()[k].rows; ++i)
        own[k].data[i * (own[k].ld + 1)] -= rank_tolerance / mass_;
  }
  ++counters_.tangents;
  ++counters_.factorizations;
  factored_ = solver().factor() == FactorStatus::ok;
  if (!factored_) {
    const Index row = solver().singular_row();
    report.failure =
        fmt::format("the tangent is singular{}: redundant constraints or a mechanism in a lock",
                    row >= 0 ? " at " + system_.name_of(row + 6) : std::string());
  }
  theta_ = theta_fresh;
  return factored_;
}

bool GeneralizedAlpha::iterate(StepReport& report) {
  const double h = h_, s = a_.beta * h * h;
  const double gamma_ = a_.gamma / (h * a_.beta);
  const double beta_ = (1.0 - a_.alpha_m) / (h * h * a_.beta * (1.0 - a_.alpha_f));
  const Index motions = 6 * (system_.nodes() - 1);
  const bool always = options_.newton.tangent == NewtonOptions::Tangent::every_iteration;
  double previous = 0.0;
  bool refactor = refactor_next_ || !factored_;
  bool fresh = false;  // tangent of this step
  report.iterations = 0;
  for (int k = 0; k < options_.newton.max_iterations; ++k) {
    bool in_range = true;
    if (refactor || always) {
      if (!factorize(report, in_range)) return false;
      fresh = true;
      refactor = false;
      previous = 0.0;
    } else {
      in_range = residual();
    }
    ++counters_.residuals;
    x_ = -r_.tail(x_.size());
    x_.head(motions) *= s;
    solver().solve({x_.data(), static_cast<std::size_t>(x_.size())});
    ++report.iterations;
    ++counters_.iterations;
    const double e = norm_({x_.data(), static_cast<std::size_t>(x_.size())}, s,
                           tolerant_ ? multiplier_slack : 1.0);
    if (static_cast<std::size_t>(k) < report.increments.size())
      report.increments[static_cast<std::size_t>(k)] = e;
    report.error = e;
    if (!std::isfinite(e)) {
      report.failure =
          fmt::format("the residual is not finite at {}", system_.name_of(worst_row(system_, r_)));
      return false;
    }
    if (previous > 0.0) {
      theta_ = std::max({e / previous, theta_memory * theta_, theta_floor});
      if (e > 2.0 * previous && !(fresh && k < 4) && e > 1.0) {
        if (fresh) break;  // diverges with its own tangent
        refactor = true;   // the increment is not taken: start again from the present iterate
        continue;
      }
    }
    previous = e;

    for (Index n = 1; n < system_.nodes(); ++n) {
      const auto N = static_cast<std::size_t>(n);
      const Vec6 dQ = T_inverse_times<double>(Q_[N], x_.segment<6>(6 * (n - 1)));
      Q_[N] += dQ;
      end_.V[N] += gamma_ * dQ;
      end_.Vdot[N] += beta_ * dQ;
    }
    end_.lambda += x_.tail(x_.size() - motions) / s;
    update_poses();

    const double left = always ? e : e * std::min(1.0, theta_ / (1.0 - std::min(theta_, 0.999)));
    report.error = left;
    if (left < 1.0) {
      if (!in_range) break;
      if (report.iterations == 1) theta_ = std::min(2.0 * theta_, 0.9);
      refactor_next_ = report.iterations >= iterations_refactor;
      return true;
    }
    if (theta_ > theta_refactor) refactor = true;
  }
  if (report.failure.empty()) {
    residual();
    const std::string element = system_.out_of_range(end_);
    report.failure =
        element.empty()
            ? fmt::format(
                  "Newton's iterations do not converge (worst equation: {}); look for a lock, a "
                  "jump or an instability there, or try a smaller step",
                  system_.name_of(worst_row(system_, r_)))
            : range_failure(element);
  }
  return false;
}

StepReport GeneralizedAlpha::step(State& state) {
  if (controller_) return adaptive_step(state);
  StepReport report;
  const double end = origin_ + static_cast<double>(count_ + 1) * options_.step;
  double reached = state.t;
  while (reached < end - slack_) {
    const Landing landing = next_landing(system_.breakpoints(), state.t, end, slack_);
    reached = landing.t;
    if (!advance(state, landing.t, report) || !land(state, landing, report)) return report;
  }
  ++count_;
  ++counters_.steps;
  report.converged = true;
  return report;
}

// What happens at the end of a step: a restart, if what accelerates jumps there.
bool GeneralizedAlpha::land(State& state, const Landing& landing, StepReport& report) {
  if (!landing.restart) return true;
  const double t = state.t;
  state.t = landing.restart_at;
  const StepReport again = restart(state);
  ++counters_.restarts;
  if (again.converged) return true;
  report.converged = false;
  report.failure =
      fmt::format("at t = {:.9g} s, where a load or drive jumps: {}", t, again.failure);
  return false;
}

StepReport GeneralizedAlpha::adaptive_step(State& state) {
  StepReport report;
  const Landing landing = next_landing(system_.breakpoints(), state.t, options_.end, slack_);
  const double factor =
      local_tolerance * std::sqrt(options_.tolerances.relative);  // of tolerance^(3/2)
  for (;;) {
    double h = controller_->step();
    const double rest = landing.t - state.t;
    const bool last = h > rest * (1.0 - same_step);
    if (last)
      h = rest;
    else if (2.0 * h > rest)
      h = 0.5 * rest;  // two alike, rather than a whole one and a rest
    if (!(h > slack_)) {
      report.failure = fmt::format(
          "at t = {:.9g} s the step has shrunk to {:.3g} s, where times are round-off: {}", state.t,
          h,
          report.failure.empty() ? "the estimated error stays too large at " +
                                       system_.name_of(error_norm_->worst_row())
                                 : report.failure);
      report.converged = false;
      return report;
    }
    if (!try_step(state, last ? landing.t : state.t + h, report)) {
      ++counters_.retries;
      controller_->failed(h);
      continue;
    }
    estimate_error();
    error_norm_->measure(begin_, end_);
    const double error = (*error_norm_)(error_, {}, factor);
    report.error = error;
    if (!(error <= 1.0)) {
      ++counters_.rejected;
      controller_->rejected(h, error);
      refactor_next_ = true;
      continue;
    }
    controller_->accepted(h, error);
    if (!last && (sizes_.least == 0.0 || h < sizes_.least)) sizes_.least = h;
    sizes_.most = std::max(sizes_.most, h);
    sizes_.worst_error = std::max(sizes_.worst_error, error);
    sizes_.position_error += error_norm_->position();
    sizes_.rotation_error += error_norm_->rotation();
    accept(state);
    ++counters_.steps;
    report.failure.clear();
    if (last && !land(state, landing, report)) return report;
    report.converged = true;
    return report;
  }
}

// To time t, in one step or in pieces.
bool GeneralizedAlpha::advance(State& state, double t, StepReport& report) {
  const double whole = t - state.t;
  for (;;) {
    const double h = std::ldexp(whole, -halvings_);
    const bool last = h > (t - state.t) * (1.0 - time_rounding);
    if (try_step(state, last ? t : state.t + h, report)) {
      accept(state);
      if (halvings_ > 0 && ++good_ == successes_double) {
        --halvings_;
        good_ = 0;
      }
      if (last) return true;
      continue;
    }
    good_ = 0;
    if (halvings_ == options_.max_halvings) break;
    ++halvings_;
    ++counters_.retries;
  }
  report.converged = false;
  report.failure =
      fmt::format("from t = {:.9g} s{}: {}", state.t,
                  options_.max_halvings > 0
                      ? fmt::format(", even with a step of {:.3g} s", std::ldexp(whole, -halvings_))
                      : std::string(),
                  report.failure);
  return false;
}

// Solves a step from `state` to t: end_ is then a solution, not yet accepted.
bool GeneralizedAlpha::try_step(const State& state, double t, StepReport& report) {
  begin_ = state;
  set_step(begin_, t - begin_.t);
  const int before = report.iterations;
  report.iterations = 0;
  report.failure.clear();
  predict(begin_, t, true);
  bool converged = iterate(report);
  if (!converged) {  // once more without extrapolation, with a tangent of its own
    report.failure.clear();
    refactor_next_ = true;
    predict(begin_, t, false);
    converged = iterate(report);
  }
  if (!converged && system_.multipliers() > 0) converged = try_tolerantly(t, report);
  report.iterations += before;
  if (converged)
    report.failure.clear();
  else
    settle(false);
  return converged;
}

// After a step has been accepted, or has failed: the rank-tolerant tangent is not kept.
void GeneralizedAlpha::settle(bool accepted) {
  if (accepted && !tolerant_) return;
  tolerant_ = false;
  factored_ = false;  // or by the other solver
  refactor_next_ = true;
}

// The filtered error (4) of the step that has converged.
void GeneralizedAlpha::estimate_error() {
  const double h = h_, c = h * h * (a_.beta - 1.0 / 6.0 - 0.5 * (a_.gamma - 0.5));
  const double m = (1.0 - a_.alpha_m) / (1.0 - a_.alpha_f);
  scratch_ = end_;
  for (std::size_t n = 1; n < error_.size(); ++n)
    scratch_.V[n] = c * m * (end_.Vdot[n] - begin_.Vdot[n]);
  system_.momenta(scratch_, error_);
  x_.setZero();
  for (std::size_t n = 1; n < error_.size(); ++n)
    x_.segment<6>(6 * static_cast<Index>(n - 1)) = error_[n];
  solver().solve({x_.data(), static_cast<std::size_t>(x_.size())});
  for (std::size_t n = 1; n < error_.size(); ++n)
    error_[n] = x_.segment<6>(6 * static_cast<Index>(n - 1));
}

// Once more with the block -eps I. What it leaves of the constraints must be as small as increments may be.
bool GeneralizedAlpha::try_tolerantly(double t, StepReport& report) {
  if (!tolerant_solver_) {
    tolerant_solver_ = solver_->another();
    if (!tolerant_solver_) return false;
    tolerant_solver_->analyze(own_graph(true));
  }
  const std::string failure = report.failure;  // of the iterations that users know
  tolerant_ = true;
  refactor_next_ = true;
  predict(begin_, t, true);
  bool converged = iterate(report);
  if (converged) {
    residual();
    converged = r_.tail(system_.multipliers()).cwiseAbs().maxCoeff() <=
                options_.newton.tolerance * std::max(1.0, system_.length_scale());
  }
  if (converged) {
    ++counters_.tolerant;
  } else {
    tolerant_ = false;
    report.failure = failure;
  }
  return converged;
}

void GeneralizedAlpha::accept(State& state) {
  for (std::size_t n = 1; n < Q_.size(); ++n) {
    const Vec6 A_f =
        ((1.0 - a_.alpha_f) * end_.Vdot[n] + a_.alpha_f * begin_.Vdot[n] - a_.alpha_m * A_[n]) /
        (1.0 - a_.alpha_m);
    A_[n] = A_f;
    renormalize(end_.pose[n]);
  }
  if (!momentum_.empty()) {
    system_.momenta(end_, p_);
    for (std::size_t n = 1; n < momentum_.size(); ++n) {
      Momentum& m = momentum_[n];
      const Vec6 mu = inertial_wrench<double>(end_.pose[n], p_[n]);
      const Vec6 a = (mu - m.mu) / (h_ * a_.gamma) - ((1.0 - a_.gamma) / a_.gamma) * m.a;
      m.f = ((1.0 - a_.alpha_m) * a + a_.alpha_m * m.a - a_.alpha_f * m.f) / (1.0 - a_.alpha_f);
      m.a = a;
      m.mu = mu;
    }
    end_.momentum_rate = 0.0;
  }
  system_.follow_angles(end_);
  const double power = system_.load_power(end_), drive_power = system_.drive_power(end_);
  end_.work.loads += 0.5 * h_ * (power_ + power);
  end_.work.drives += 0.5 * h_ * (drive_power_ + drive_power);
  power_ = power;
  drive_power_ = drive_power;
  if (observer_) {
    dense_.set(begin_, end_, Q_);
    observer_(dense_);
  }
  std::swap(Vdot_old_, begin_.Vdot);
  std::swap(lambda_older_, lambda_old_);
  std::swap(lambda_old_, begin_.lambda);
  t_older_ = t_old_;
  t_old_ = begin_.t;
  norm_.observe(end_.lambda);
  state = end_;
  history_ = tolerant_ ? 0 : std::min(history_ + 1, 2);  // nothing to extrapolate multipliers from
  ++counters_.substeps;
  settle(true);
}

}  // namespace mbd
