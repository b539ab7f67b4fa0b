#include "solvers/generalized_alpha.hpp"

#include <fmt/format.h>

#include <cmath>

#include "libmbd/core/error.hpp"

namespace mbd {
namespace {

// Policy of the kept tangent (speed.md).
// A contraction measured at small increments is partly luck: with a floor of 1e-3 (speed.md) a stale one
// let multipliers of a chain pass that were wrong by 1e-3; 0.1 costs a few per cent of the iterations.
constexpr double theta_floor = 0.1;
constexpr double theta_memory = 0.3;    // how fast a good contraction is believed
constexpr double theta_refactor = 0.5;  // worse: a new tangent inside the step
constexpr double theta_fresh = 0.05;    // assumed of a new tangent
constexpr double jump_rounding = 1e-6;  // of a step: what sums of steps can be wrong by, and more
constexpr int iterations_refactor = 3;  // this many: a new tangent at the next step

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
      norm_(system, options.newton) {
  if (!(options.step > 0.0) || !std::isfinite(options.step))
    throw Error(fmt::format("the time step must be positive, not {}", options.step));
  if (!(options.rho_infinity >= 0.0 && options.rho_infinity <= 1.0))
    throw Error(fmt::format("rho_infinity must lie in [0, 1], not {}", options.rho_infinity));
  if (!system.with_rates())
    throw Error("the system was compiled for statics: it has no inertia to integrate");
  solver_->analyze(system.graph());
  const auto n = static_cast<std::size_t>(system.nodes());
  Q_.assign(n, Vec6::Zero());
  A_.assign(n, Vec6::Zero());
  A_end_.assign(n, Vec6::Zero());
  Vdot_old_.assign(n, Vec6::Zero());
  T_inv_.assign(n, Mat6::Identity());
  x_.resize(system.unknowns());
}

StepReport GeneralizedAlpha::start(State& state) {
  StepReport report;
  system_.set_time(state, state.t, Side::right);
  // r is linear in Vdot and lambda: one solve, and one more against round-off.
  for (Vec6& a : state.Vdot) a.setZero();
  state.lambda.setZero();
  VecX gdot, gddot_rest;
  system_.constraint_rates(state, gdot, gddot_rest);
  system_.linearize(state, {.U = 0.0, .V = 0.0, .A = 1.0, .T_inv = {}}, r_, *solver_);
  ++counters_.tangents;
  ++counters_.factorizations;
  if (solver_->factor() != FactorStatus::ok) {
    const Index row = solver_->singular_row();
    report.failure = fmt::format(
        "the initial accelerations are not determined{}: a node without inertia that no joint "
        "holds, or redundant "
        "constraints",
        row >= 0 ? " at " + system_.name_of(row + 6) : std::string());
    return report;
  }
  const Index motions = 6 * (system_.nodes() - 1);
  for (int pass = 0; pass < 2; ++pass) {
    if (pass > 0) system_.residual(state, r_);
    x_ = -r_.tail(x_.size());
    x_.tail(gddot_rest.size()) = -gddot_rest;
    // B Vdot + gddot_rest, with B Vdot from what has been solved: the residual's constraint rows are g.
    if (pass > 0) x_.tail(gddot_rest.size()).setZero();
    solver_->solve({x_.data(), static_cast<std::size_t>(x_.size())});
    for (Index n = 1; n < system_.nodes(); ++n)
      state.Vdot[static_cast<std::size_t>(n)] += x_.segment<6>(6 * (n - 1));
    state.lambda += x_.tail(x_.size() - motions);
  }
  if (!x_.allFinite()) {
    report.failure = "the initial accelerations are not finite";
    return report;
  }
  const double h = options_.step;
  VecX unused;
  system_.linearize(
      state,
      {.U = a_.beta * h * h, .V = 0.0, .A = (1.0 - a_.alpha_m) / (1.0 - a_.alpha_f), .T_inv = {}},
      unused, *solver_);
  norm_.set_floor(state, largest_stiffness(system_, *solver_) / (a_.beta * h * h));
  A_ = state.Vdot;
  Vdot_old_ = state.Vdot;
  lambda_old_ = state.lambda;
  lambda_older_ = state.lambda;
  norm_.observe(state.lambda);
  history_ = 0;
  start_time_ = state.t;
  factored_ = false;
  refactor_next_ = true;
  report.converged = true;
  return report;
}

// Predicted end of the step, and what of (1) does not change in the iterations.
void GeneralizedAlpha::predict(const State& state, double t, bool extrapolate) {
  const double h = options_.step;
  end_ = state;
  system_.set_time(end_, t, Side::left);  // what acts during the step, if it ends on a jump
  if (extrapolate && history_ >= 2) {
    end_.lambda = 3.0 * (state.lambda - lambda_old_) + lambda_older_;
  } else if (extrapolate && history_ == 1) {
    end_.lambda = 2.0 * state.lambda - lambda_old_;
  }
  for (std::size_t n = 1; n < Q_.size(); ++n) {
    const Vec6& Vdot_i = state.Vdot[n];
    const Vec6 Vdot_f = extrapolate && history_ >= 1 ? Vec6(2.0 * Vdot_i - Vdot_old_[n]) : Vdot_i;
    const Vec6 A_f = ((1.0 - a_.alpha_f) * Vdot_f + a_.alpha_f * Vdot_i - a_.alpha_m * A_[n]) /
                     (1.0 - a_.alpha_m);
    Q_[n] = h * state.V[n] + h * h * ((0.5 - a_.beta) * A_[n] + a_.beta * A_f);
    end_.V[n] = state.V[n] + h * ((1.0 - a_.gamma) * A_[n] + a_.gamma * A_f);
    end_.Vdot[n] = Vdot_f;
  }
  update_poses();
}

void GeneralizedAlpha::update_poses() {
  for (std::size_t n = 1; n < Q_.size(); ++n) end_.pose[n] = begin_.pose[n] * exp_se3(Q_[n]);
}

// Tangent (2) and residual at the present iterate.
bool GeneralizedAlpha::factorize(StepReport& report, bool& in_range) {
  const double h = options_.step, s = a_.beta * h * h;
  for (std::size_t n = 1; n < Q_.size(); ++n) T_inv_[n] = T_inverse(Q_[n]).matrix();
  in_range = system_.linearize(
      end_,
      {.U = s, .V = a_.gamma * h, .A = (1.0 - a_.alpha_m) / (1.0 - a_.alpha_f), .T_inv = T_inv_},
      r_, *solver_);
  ++counters_.tangents;
  ++counters_.factorizations;
  factored_ = solver_->factor() == FactorStatus::ok;
  if (!factored_) {
    const Index row = solver_->singular_row();
    report.failure =
        fmt::format("the tangent is singular{}: redundant constraints or a mechanism in a lock",
                    row >= 0 ? " at " + system_.name_of(row + 6) : std::string());
  }
  theta_ = theta_fresh;
  return factored_;
}

bool GeneralizedAlpha::iterate(StepReport& report) {
  const double h = options_.step, s = a_.beta * h * h;
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
      in_range = system_.residual(end_, r_);
    }
    ++counters_.residuals;
    x_ = -r_.tail(x_.size());
    x_.head(motions) *= s;
    solver_->solve({x_.data(), static_cast<std::size_t>(x_.size())});
    ++report.iterations;
    ++counters_.iterations;
    const double e = norm_({x_.data(), static_cast<std::size_t>(x_.size())}, s);
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
    system_.residual(end_, r_);
    const std::string element = system_.out_of_range(end_);
    report.failure =
        element.empty()
            ? fmt::format(
                  "Newton's iterations do not converge (worst equation: {}); try a smaller step",
                  system_.name_of(worst_row(system_, r_)))
            : fmt::format("{} is bent beyond the range of its metric; give the beam more elements",
                          element);
  }
  return false;
}

StepReport GeneralizedAlpha::step(State& state) {
  StepReport report;
  begin_ = state;
  double t = start_time_ + static_cast<double>(history_ + 1) * options_.step;
  for (const double jump : system_.jump_times())
    if (std::abs(t - jump) < jump_rounding * options_.step)
      t = jump;  // so that its left limit is taken
  predict(begin_, t, true);
  bool converged = iterate(report);
  if (!converged) {  // once more without extrapolation, with a tangent of its own
    report.failure.clear();
    refactor_next_ = true;
    predict(begin_, t, false);
    converged = iterate(report);
  }
  report.converged = converged;
  if (!converged) {
    refactor_next_ = true;
    report.failure = fmt::format("to t = {:.9g} s: {}", t, report.failure);
    return report;
  }
  accept(state);
  return report;
}

void GeneralizedAlpha::accept(State& state) {
  for (std::size_t n = 1; n < Q_.size(); ++n) {
    const Vec6 A_f =
        ((1.0 - a_.alpha_f) * end_.Vdot[n] + a_.alpha_f * begin_.Vdot[n] - a_.alpha_m * A_[n]) /
        (1.0 - a_.alpha_m);
    A_[n] = A_f;
    renormalize(end_.pose[n]);
  }
  system_.follow_angles(end_);
  std::swap(Vdot_old_, begin_.Vdot);
  std::swap(lambda_older_, lambda_old_);
  lambda_old_ = begin_.lambda;
  norm_.observe(end_.lambda);
  state = end_;
  ++history_;
  ++counters_.steps;
}

}  // namespace mbd
