#include "solvers/time/generalized_alpha.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libmbd/core/error.hpp"
#include "libmbd/core/spectral.hpp"
#include "libmbd/core/stop.hpp"

namespace mbd {
namespace {

// With a floor of 1e-3 a stale contraction let multipliers of a chain pass that were wrong by 1e-3; 0.1 costs a few per
// cent of the iterations.
constexpr KeptTangent::Policy tangent_policy{
    .floor = 0.1, .memory = 0.3, .renew = 0.5, .fresh = 0.05, .iterations = 3};
// Adaptive steps: the estimate (4) goes with h^3, the error with h^2; the constant was chosen so that errors of
// the dynamic models are about the tolerance.
constexpr int error_order = 3;
constexpr double local_tolerance = 0.03;
// What rings. Gdot is -2 to 2 times the last one where it does; one that errs by the method alone changes little.
constexpr double alternating = 0.5;  // of the product of sizes
constexpr int few_alternations = 3, more_alternations = 5;
constexpr double much_ringing = 5e-3;    // gdot/h, of the accelerations, after few alternations,
constexpr double some_ringing = 5e-4;    // and after more
constexpr double least_of_speed = 5e-5;  // gdot, of the velocities
constexpr double of_round_off = 1e-6;    // rates of one kind, of those of the other
constexpr double steps_of_round_off = 100.0;  // gdot h, of the round-off of positions
constexpr double too_large = 0.02;            // gdot, of the velocities, but for
constexpr long steps_of_a_start = 20;         // where all velocities may be small
constexpr double damps_little =
    0.91;  // rho_infinity: beyond, a step that fails is taken for ringing
// Rank-tolerant steps: increments of multipliers that fall no faster, where those of the motion are that small.
constexpr double creeping = 0.5, converged_motion = 0.1;
constexpr double without_multipliers = 1e300;  // a slack with which they do not count
// Of a node in a step [rad]: angles of joints, between two nodes, are unwrapped to the nearest value, up to pi.
constexpr double most_turn = 1.5;
// Of a node in a step, beside what its velocity foretells [rad]: more is not resolved, and may be another solution of the
// step, of many times the energy, to which iterations have gone astray. Shorter steps are tried first.
constexpr double most_surprise = 0.5;
// Of a step, over the last: those that follow estimated errors grow by 6 at most.
constexpr double most_growth = 8.0;
// A less Vdot is (alpha_m - alpha_f) h times the rate of Vdot, and a part that dies out, by half a step where rho_infinity is 0:
// scaled up by more than that part dies out it would grow from step to step. Then the rate is that of the last step.
constexpr double most_scaling = 2.0;

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
    : OneStep(system, std::move(solver), settings_of(options), error_order),
      a_(generalized_alpha_parameters(options.rho_infinity)),
      kept_(tangent_policy),
      dense_(system, HermiteStep::Degree::cubic),
      mixed_(system) {
  if (!(options.rho_infinity >= 0.0 && options.rho_infinity <= 1.0))
    throw Error(fmt::format("rho_infinity must lie in [0, 1], not {}", options.rho_infinity));
  const auto n = static_cast<std::size_t>(system.nodes());
  if (options.balance == Balance::momentum) momentum_.resize(n);
  if (options.keep_momenta && momentum_.empty()) free_ = FreeMomenta(system);
  damps_little_ = options.rho_infinity > damps_little;
  if (options.max_cost < 0)
    throw Error(fmt::format("max_cost must not be negative, and is {}", options.max_cost));
  if (options.max_cost > 0 && settings_.adaptive())
    throw Error("max_cost is of fixed steps; give a step in place of tolerances");
  max_cost_ = options.max_cost;
  bounded_ = max_cost_ > 0;
  p_.resize(n);
  solver_->analyze(own_graph(false));
  Q_.assign(n, Vec6::Zero());
  A_.assign(n, Vec6::Zero());
  Vdot_old_.assign(n, Vec6::Zero());
  T_inv_.assign(n, Mat6::Identity());
  x_.resize(system.unknowns());
  if (settings_.adaptive()) error_.assign(n, Vec6::Zero());
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

std::string GeneralizedAlpha::signature() const {
  const double balance = !momentum_.empty() ? 1.0 : free_.empty() ? 0.0 : 2.0;
  return signature_of("generalized-alpha", {a_.alpha_m, a_.alpha_f, balance, mixed_.signature()});
}

void GeneralizedAlpha::archive(Archive& a) {
  OneStep::archive(a);
  a(kept_, h_, starting_, stiffness_, A_, history_, t_old_, t_older_, Vdot_old_, lambda_old_,
    lambda_older_, mixed_, S_, S_old_, S_older_, power_, gdot_old_, alternations_,
    steps_since_start_, projects_, damps_little_, calm_next_, taken_, rate_);
  for (Momentum& m : momentum_) a(m.mu, m.f, m.f_old, m.rate, m.a, m.past, m.at_start);
  free_.archive(a);
}

// Pivots too are chosen anew.
void GeneralizedAlpha::take_new_tangent() {
  solver_->analyze(own_graph(false));
  tolerant_solver_.reset();
  factored_ = false;
  refactor_next_ = true;
}

void GeneralizedAlpha::begin_at(State& state) {
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
      m.f = m.f_old = m.a = m.at_start = inertial_wrench<double>(state.pose[n], f);
    }
  }
  free_.begin(state);
  A_ = state.Vdot;
  Vdot_old_ = state.Vdot;
  lambda_old_ = state.lambda;
  lambda_older_ = state.lambda;
  mixed_.set(state, S_);
  S_old_ = S_older_ = S_;
  power_ = system_.power(state);
  history_ = 0;
  h_ = 0.0;
  starting_ = true;
  factored_ = false;
  refactor_next_ = true;
  gdot_old_.resize(0);
  alternations_ = 0;
  steps_since_start_ = 0;
  taken_ = 0.0;
  rate_.clear();
}

// Equation (4), for a step of h from begin_. Where its matrix is singular, the accelerations are left as they are.
void GeneralizedAlpha::filter_start(double h) {
  scratch_ = begin_;
  scratch_.V = begin_.Vdot;
  system_.momenta(scratch_, p_);  // M Vdot
  system_.constraint_rates(begin_, gdot_, gddot_rest_);
  system_.linearize(begin_, {.U = h * h, .V = 0.0, .A = 1.0, .T_inv = {}}, r_, *solver_);
  ++counters_.tangents;
  ++counters_.factorizations;
  factored_ = false;
  refactor_next_ = true;
  if (solver_->factor() != FactorStatus::ok) return;
  for (std::size_t n = 1; n < p_.size(); ++n) x_.segment<6>(6 * static_cast<Index>(n - 1)) = p_[n];
  x_.tail(gddot_rest_.size()) = -gddot_rest_;
  solver_->solve({x_.data(), static_cast<std::size_t>(x_.size())});
  if (!x_.allFinite()) return;
  if (!momentum_.empty()) {  // B^T mu of (4), which a sum over the nodes may contain
    scratch_ = begin_;
    scratch_.lambda += x_.tail(gddot_rest_.size());
    system_.residual(scratch_, r_mu_);
    r_mu_ -= r_;
  }
  for (std::size_t n = 1; n < A_.size(); ++n) {
    const Vec6 A = x_.segment<6>(6 * static_cast<Index>(n - 1));
    scratch_.V[n] = A - begin_.Vdot[n];
    begin_.Vdot[n] = A;
  }
  if (momentum_.empty()) return;
  system_.momenta(scratch_, p_);
  Vec6 sum = Vec6::Zero();
  for (std::size_t n = 1; n < momentum_.size(); ++n)
    sum += inertial_wrench<double>(begin_.pose[n],
                                   p_[n] + r_mu_.segment<6>(6 * static_cast<Index>(n)));
  sum /= static_cast<double>(momentum_.size() - 1);
  for (std::size_t n = 1; n < momentum_.size(); ++n) {
    Momentum& m = momentum_[n];
    m.f = m.a = m.at_start + inertial_wrench<double>(begin_.pose[n], p_[n]) - sum;
  }
}

// A, and a of (3), for a step of another size.
void GeneralizedAlpha::set_step(double h) {
  if (starting_) {
    filter_start(h);
    A_ = begin_.Vdot;
    lag_by_rate(h);
  }
  if (h == h_) return;
  if (h_ > 0.0 && !starting_) {
    const double ratio = h / h_;
    if (ratio > most_scaling && !rate_.empty()) {
      lag_by_rate(h);
    } else if (ratio > most_scaling && history_ >= 2) {  // after a start rates are of what rings
      find_rate();
      lag_by_rate(h);
      rate_.clear();
    } else {
      for (std::size_t n = 1; n < A_.size(); ++n)
        A_[n] = begin_.Vdot[n] + ratio * (A_[n] - begin_.Vdot[n]);
      for (Momentum& m : momentum_) m.a = m.f + ratio * (m.a - m.f);
      free_.scale(ratio);
    }
    if (std::abs(ratio - 1.0) > same_step) refactor_next_ = true;
  }
  h_ = h;
  norm_.set_floor(begin_, stiffness_ + mass_ / (a_.beta * h * h));
}

// Predicted end of the step, and what of (1) does not change in the iterations.
void GeneralizedAlpha::predict(double t, bool extrapolate) {
  const State& state = begin_;
  const double h = h_;
  end_ = state;
  system_.set_time(end_, t, Side::left);  // what acts during the step, if it ends on a jump
  const double ahead = extrapolate && history_ >= 1 ? h / (state.t - t_old_) : 0.0;
  if (mixed_.should_begin(counters_)) {
    mixed_.begin();
    mixed_.set(state, S_);
    S_old_ = S_older_ = S_;
    refactor_next_ = true;
  }
  resultants_.S = S_;
  if (extrapolate && history_ >= 2) {
    // Not by lagrange<3>, which differs in the last bits: windows is sensitive to them where it is singular.
    const double t0 = state.t, t1 = t_old_, t2 = t_older_;
    end_.lambda = ((t - t1) * (t - t2) / ((t0 - t1) * (t0 - t2))) * state.lambda +
                  ((t - t0) * (t - t2) / ((t1 - t0) * (t1 - t2))) * lambda_old_ +
                  ((t - t0) * (t - t1) / ((t2 - t0) * (t2 - t1))) * lambda_older_;
    const auto w = lagrange<3>({t0, t1, t2}, t);
    for (std::size_t i = 0; i < S_.size(); ++i)
      resultants_.S[i] = w[0] * S_[i] + w[1] * S_old_[i] + w[2] * S_older_[i];
  } else if (ahead > 0.0) {
    end_.lambda = state.lambda + ahead * (state.lambda - lambda_old_);
    for (std::size_t i = 0; i < S_.size(); ++i) resultants_.S[i] += ahead * (S_[i] - S_old_[i]);
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

[[gnu::flatten]] void GeneralizedAlpha::update_poses() {
  each_pack(1, Q_.size(), [&](const PackOf& pack) {
    unpack(packed(begin_.pose, pack) * exp_se3<Pack>(packed(Q_, pack)), pack, end_.pose);
  });
}

// The iterate after an increment x of (2).
[[gnu::flatten]] void GeneralizedAlpha::take_increment(double s) {
  const double gamma_ = a_.gamma / (h_ * a_.beta);
  const double beta_ = (1.0 - a_.alpha_m) / (h_ * h_ * a_.beta * (1.0 - a_.alpha_f));
  each_pack(1, Q_.size(), [&](const PackOf& pack) {
    Vector6<Pack> x, Q = packed(Q_, pack);
    pack_into(x, [&](int k) { return x_.data() + 6 * (pack[k] - 1); });
    const Vector6<Pack> dQ = T_inverse_times<Pack>(Q, x);
    Q += dQ;
    unpack(Q, pack, Q_);
    unpack(packed(end_.V, pack) + Pack(gamma_) * dQ, pack, end_.V);
    unpack(packed(end_.Vdot, pack) + Pack(beta_) * dQ, pack, end_.Vdot);
    unpack(packed(begin_.pose, pack) * exp_se3<Pack>(Q), pack, end_.pose);
  });
  const Index motions = 6 * (system_.nodes() - 1);
  end_.lambda += x_.tail(x_.size() - motions) / s;
}

// r of (1), or of (3), at the present iterate. False if an element is out of its range.
bool GeneralizedAlpha::residual() {
  const bool in_range = mixed_.residual(end_, resultants_, r_);
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
  mixed_.keep_tangent(end_, s, resultants_, solver().slots());
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
    add_rank_tolerance(own);
  }
  ++counters_.tangents;
  ++counters_.factorizations;
  factored_ = solver().factor() == FactorStatus::ok;
  if (!factored_) {
    const Index row = solver().singular_row();
    report.failure = singular_failure(row >= 0 ? system_.name_of(row + 6) : std::string());
    report.kind = Failure::singular;
  }
  kept_.renewed();
  return factored_;
}

// Solves (2) for the increment, whose size it returns. In iteration k of a step.
double GeneralizedAlpha::solve_increment(double s, int k, StepReport& report) {
  x_ = -r_.tail(x_.size());
  x_.head(6 * (system_.nodes() - 1)) *= s;
  solver().solve({x_.data(), static_cast<std::size_t>(x_.size())});
  ++report.iterations;
  ++counters_.iterations;
  // Velocities are increments over h: of a step that is cut short they are to be no worse than of a whole one.
  const double share = is_cut_short() ? h_ / usual_ : 1.0;
  const double e =
      norm_({x_.data(), static_cast<std::size_t>(x_.size())}, s, multiplier_slack(), share);
  if (static_cast<std::size_t>(k) < report.increments.size())
    report.increments[static_cast<std::size_t>(k)] = e;
  report.error = e;
  if (!std::isfinite(e))
    report.failure =
        fmt::format("the residual is not finite at {}", system_.name_of(worst_row(system_, r_)));
  return e;
}

// What is left after an increment of size e, whose predecessor had the size `before`. Multipliers may not settle any more:
// then the iterate is as good as it gets, where the motion has settled.
GeneralizedAlpha::Rest GeneralizedAlpha::rest_after(double e, double before, double s) {
  const bool always = settings_.newton.tangent == NewtonOptions::Tangent::every_iteration;
  double left = always ? e : e * kept_.share_left();
  // What is not determined in a rank-tolerant step: gaps of round-off, over eps, are added to it for ever. The motion
  // does not feel it.
  const bool creeps = before > 0.0 && e > creeping * before;
  const double motion =
      creeps ? norm_({x_.data(), static_cast<std::size_t>(x_.size())}, s, without_multipliers)
             : 0.0;
  if (tolerant_ && creeps && motion < converged_motion) left = motion;
  // Multipliers that do not settle any more, where the motion has: as large as what round-off of the gaps makes of them,
  // which in a long row of bodies is far above what one body feels of it.
  const bool is_settled =
      left >= 1.0 && creeps && !tolerant_ && motion < converged_motion && is_round_off(e);
  return {left, is_settled};
}

bool GeneralizedAlpha::iterate(StepReport& report) {
  const double s = a_.beta * h_ * h_;
  const bool always = settings_.newton.tangent == NewtonOptions::Tangent::every_iteration;
  double previous = 0.0, last = 0.0;  // increments: with the same tangent, with any
  bool refactor = refactor_next_ || !factored_;
  bool fresh = false;  // tangent of this step
  report.iterations = 0;
  report.contraction = 0.0;
  bool in_range = true;
  const int most = bounded_ ? max_cost_ : settings_.newton.max_iterations;
  for (int k = 0; k < most; ++k) {
    stop::check();
    in_range = true;
    if ((refactor || always) && !(bounded_ && fresh)) {
      if (!factorize(report, in_range)) return false;
      fresh = true;
      refactor = false;
      previous = 0.0;
      report.contraction = 0.0;
    } else {
      in_range = residual();
    }
    ++counters_.residuals;
    const double e = solve_increment(s, k, report);
    if (!std::isfinite(e)) return false;
    const double contraction = report.contraction;  // without what round-off makes of it
    if (previous > 0.0) {
      kept_.measured(e, previous);
      if (previous > 1.0) report.contraction = std::max(report.contraction, e / previous);
      if (e > 2.0 * previous && !(fresh && k < 4) && e > 1.0) {
        if (fresh) {  // diverges with its own tangent
          in_range = false;
          break;
        }
        refactor = true;  // the increment is not taken: start again from the present iterate
        continue;
      }
    }
    const double before = last;
    previous = last = e;

    take_increment(s);
    mixed_.advance(x_, resultants_);

    const auto [left, is_settled] = rest_after(e, before, s);
    report.error = left;
    if (is_settled) report.contraction = contraction;
    if (left < 1.0 || is_settled) {
      if (!in_range) break;
      kept_.accepted_after(report.iterations);
      refactor_next_ = kept_.is_old_after(report.iterations);
      return true;
    }
    if (kept_.is_poor()) refactor = true;
  }
  return take_unconverged(in_range && report.iterations == most, report);
}

// A step of bounded cost is taken as the last of its iterations leaves it (`whole`: all were made); another has failed.
bool GeneralizedAlpha::take_unconverged(bool whole, StepReport& report) {
  if (bounded_ && whole && report.failure.empty()) {
    report.undone = true;
    refactor_next_ = true;
    return true;
  }
  if (report.failure.empty()) {
    residual();
    const std::string out_of_range = system_.out_of_range(end_);
    report.failure = newton_failure(out_of_range, r_);
    report.kind = out_of_range.empty() ? Failure::convergence : Failure::range;
  }
  return false;
}

bool GeneralizedAlpha::solve_step(double t, double h, StepReport& report) {
  // Before the iterations, which may go anywhere in such steps, and of their result.
  const auto turns_far = [&](const auto& rotation) {
    for (std::size_t n = 1; n < Q_.size(); ++n)
      if (!(rotation(n).norm() < most_turn)) {
        report.failure = fmt::format("{} turns by more than {} rad in a step; take smaller steps",
                                     system_.node_name(static_cast<Index>(n)), most_turn);
        return true;
      }
    return false;
  };
  if (turns_far([&](std::size_t n) { return Vec3(h * begin_.V[n].tail<3>()); })) return false;
  if (calm_next_ || outgrows(h)) restart_calmly(begin_);
  set_step(h);
  predict(t, true);
  if (!usable(end_, report)) return false;
  bool converged = iterate(report);
  if (bounded_ && !converged) return false;
  if (!converged) {  // once more without extrapolation, with a tangent of its own
    report.failure.clear();
    refactor_next_ = true;
    predict(t, false);
    converged = iterate(report);
  }
  converged = converged || (system_.multipliers() > 0 && solve_tolerantly(t, report));
  return converged && !turns_far([&](std::size_t n) { return Vec3(Q_[n].tail<3>()); }) &&
         !surprises(report);
}

// Whether a step is so much longer than the last, which a switching time or a law of time had cut, that what is wrong with
// accelerations after that, of (tolerance or round-off) / h^2, and A less Vdot, of h times their rate, must not go on.
bool GeneralizedAlpha::outgrows(double h) const {
  return taken_ > 0.0 && h > most_growth * taken_ && !bounded_;
}

// Over the last step before begin_.
void GeneralizedAlpha::find_rate() {
  const double h = begin_.t - t_old_;
  rate_.assign(A_.size(), Vec6::Zero());
  for (std::size_t n = 1; n < rate_.size(); ++n) rate_[n] = (begin_.Vdot[n] - Vdot_old_[n]) / h;
  for (Momentum& m : momentum_) m.rate = (m.f - m.f_old) / h;
  free_.find_rate(h);
}

// Of a step that is cut short, before it is accepted: the rate over the last one that was not, since its own is round-off.
void GeneralizedAlpha::keep_rate() {
  if (!is_cut_short())
    rate_.clear();
  else if (rate_.empty() && history_ >= 1)
    find_rate();
}

// What is algorithmic lags behind by (alpha_m - alpha_f) h of that rate, where nothing has jumped.
void GeneralizedAlpha::lag_by_rate(double h) {
  if (rate_.empty()) return;
  const double lag = (a_.alpha_m - a_.alpha_f) * h;
  for (std::size_t n = 1; n < A_.size(); ++n) A_[n] = begin_.Vdot[n] + lag * rate_[n];
  for (Momentum& m : momentum_) m.a = m.f + lag * m.rate;
  free_.lag(lag);
}

bool GeneralizedAlpha::is_cut_short() const { return most_growth * h_ < usual_; }

// Whether a fixed step that may still be halved does what the motion at its beginning does not foretell.
bool GeneralizedAlpha::surprises(StepReport& report) {
  if (settings_.adaptive() || h_ < 1.5 * std::ldexp(settings_.step, -settings_.max_halvings))
    return false;
  for (std::size_t n = 1; n < Q_.size(); ++n)
    if (!((Q_[n] - h_ * begin_.V[n]).tail<3>().norm() < most_surprise)) {
      report.failure = fmt::format(
          "{} turns by {} rad more than its angular velocity foretells; take smaller steps",
          system_.node_name(static_cast<Index>(n)), most_surprise);
      return true;
    }
  return false;
}

void GeneralizedAlpha::settle() {
  projects_ = projects_ || (damps_little_ && !tolerant_);
  calm_next_ = projects_ && !tolerant_ && !starting_ && !bounded_;
  tolerant_ = false;
  factored_ = false;  // or by the other solver
  refactor_next_ = true;
}

void GeneralizedAlpha::forget() {
  settle();
  history_ = 0;
}

// At end_, the state accepted last.
void GeneralizedAlpha::pass_kink() {
  A_ = end_.Vdot;
  rate_.clear();
  for (Momentum& m : momentum_) m.a = m.f;
  free_.scale(0.0);
  history_ = 0;
}

// The filtered error (5).
double GeneralizedAlpha::estimated_error(bool) {
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
  error_norm_->measure(begin_, end_);
  // Of tolerance^(3/2).
  return (*error_norm_)(error_, {}, local_tolerance * std::sqrt(settings_.tolerances.relative));
}

// Gaps of eps times positions, of which (2) makes dU and s dlambda.
// Whether an increment of that size is what gaps of eps times positions make of motion and multipliers, with the present
// tangent. The signs of these gaps are not those of the iterations, so a few times as much counts.
bool GeneralizedAlpha::is_round_off(double e) {
  constexpr double few = 10.0;
  if (system_.multipliers() == 0) return false;
  const std::span<double> x(x_.data(), static_cast<std::size_t>(x_.size()));
  set_round_off(round_off_of_positions(end_), x);
  solver().solve(x);
  return e < few * norm_(x, a_.beta * h_ * h_, multiplier_slack());
}

std::optional<RoundOff> GeneralizedAlpha::round_off() {
  if (!factored_ || history_ == 0 || system_.multipliers() == 0) return std::nullopt;
  const std::span<double> x(x_.data(), static_cast<std::size_t>(x_.size()));
  set_round_off(round_off_of_positions(end_), x);
  solver_->solve(x);
  RoundOff result = round_off_of(x, a_.gamma / (h_ * a_.beta), 1.0 / (a_.beta * h_ * h_));
  result.reciprocal_condition = solver_->reciprocal_condition();
  return result;
}

// Once more with the block -eps I. What it leaves of the constraints must be as small as increments may be. What many
// loops hold all but singularly converges slowly with the usual eps, and as well as it should with a smaller one.
bool GeneralizedAlpha::solve_tolerantly(double t, StepReport& report) {
  if (!tolerant_solver_) {
    tolerant_solver_ = solver_->another();
    if (!tolerant_solver_) return false;
    tolerant_solver_->analyze(own_graph(true));
  }
  const std::string failure = report.failure;  // of the iterations that users know
  tolerant_ = true;
  bool converged = false;
  for (const double part : {1.0, 1e-3}) {
    rank_tolerance_ = part * rank_tolerance;
    report.failure.clear();
    refactor_next_ = true;
    predict(t, true);
    converged = iterate(report);
    if (converged) {
      residual();
      converged = largest_violation(system_, r_.tail(system_.multipliers())) <=
                  std::max(settings_.newton.tolerance, norm_.floor() * settings_.newton.tolerance);
    }
    if (converged) break;
  }
  rank_tolerance_ = rank_tolerance;
  if (!converged) report.failure = failure;
  return converged;
}

// Whether the rates of gaps of end_ ring: they change sign from step to step, in much of what they are, and are no
// small part of what moves; or they are as large as no error of the method should be.
bool GeneralizedAlpha::rings() {
  const double size = gdot_.norm() * gdot_old_.norm();
  const bool alternates =
      gdot_old_.size() == gdot_.size() && gdot_.dot(gdot_old_) < -alternating * size;
  alternations_ = alternates ? alternations_ + 1 : 0;
  std::swap(gdot_old_, gdot_);
  ++steps_since_start_;
  // What round-off of positions makes of rates of gaps [m/s]; of angles, over the scene's length.
  const double length = system_.length_scale();
  const double round_off = steps_of_round_off * round_off_of_positions(end_) / h_;
  // Of the largest velocity, or acceleration, of its kind: gaps of points and angles.
  const auto share = [&](const std::vector<Vec6>& motions) {
    double linear = 0.0, angular = 0.0, worst = 0.0;
    for (const Vec6& v : motions) {
      linear = std::max(linear, v.head<3>().norm());
      angular = std::max(angular, v.tail<3>().norm());
    }
    // Where nothing turns, or nothing but turns, its rates are of round-off, and so are the rates of its gaps.
    linear = std::max(linear, of_round_off * length * angular);
    angular = std::max(angular, of_round_off * linear / length);
    for (const ConstraintInfo& c : system_.constraints())
      for (Index i = 0; i < c.rows; ++i) {
        const bool is_position = c.is_position[static_cast<std::size_t>(i)];
        const double rate = std::abs(gdot_old_(c.first_row + i));
        const double most = is_position ? linear : angular;
        if (most > 0.0 && rate > (is_position ? round_off : round_off / length))
          worst = std::max(worst, rate / most);
      }
    return worst;
  };
  const bool may_be_large = steps_since_start_ > steps_of_a_start;
  if (alternations_ < few_alternations && !may_be_large) return false;
  const double of_speed = share(end_.V);
  if (may_be_large && of_speed > too_large) return true;
  if (alternations_ < few_alternations || of_speed < least_of_speed) return false;
  return share(end_.Vdot) > h_ * (alternations_ < more_alternations ? much_ringing : some_ringing);
}

// Puts the velocities of end_ on their constraints, by the smallest change in the norm of (2), once that rings.
void GeneralizedAlpha::calm_velocities() {
  if (system_.multipliers() == 0 || tolerant_) return;
  system_.constraints(end_, g_, gdot_);
  if (!projects_) {
    if (!rings()) return;
    projects_ = true;
    calm_next_ = !bounded_;  // that costs a factorisation
    system_.constraints(end_, g_, gdot_);
  }
  constexpr int most_passes = 3;
  constexpr double enough = 1e-9;  // of the fastest motion
  for (int pass = 0; pass < most_passes; ++pass) {
    x_.setZero();
    x_.tail(gdot_.size()) = -gdot_;
    solver().solve({x_.data(), static_cast<std::size_t>(x_.size())});
    for (std::size_t n = 1; n < Q_.size(); ++n)
      end_.V[n] += x_.segment<6>(6 * static_cast<Index>(n - 1));
    system_.constraints(end_, g_, gdot_);
    if (!(largest_violation(system_, gdot_) > enough * fastest(system_, end_))) return;
  }
}

// Makes accelerations and multipliers, which ring as well, consistent with the motion, and forgets those of the past.
bool GeneralizedAlpha::restart_calmly(State& state) {
  const bool rings = calm_next_;
  calm_next_ = false;
  scratch_ = state;
  const double mass = mass_;
  const std::string failure = initial_accelerations(system_, *solver_, scratch_, mass_, counters_);
  factored_ = false;
  refactor_next_ = true;
  // Near a singular configuration they may be anything; those of the steps are no worse then.
  if (!failure.empty() || (!rings && !(most_of(scratch_.Vdot) <=
                                       2.0 * std::max(most_of(state.Vdot), most_of(Vdot_old_))))) {
    mass_ = mass;
    return false;
  }
  std::swap(state, scratch_);
  const double taken = taken_;  // a step that fails now is tried from the same state again
  std::vector<Vec6> rate = rings ? std::vector<Vec6>() : std::move(rate_);
  begin_at(state);
  taken_ = taken;
  rate_ = std::move(rate);
  return true;
}

// Of motions, by the scene's length.
double GeneralizedAlpha::most_of(const std::vector<Vec6>& motions) const {
  double most = 0.0;
  for (const Vec6& v : motions)
    most = std::max({most, v.head<3>().norm() / system_.length_scale(), v.tail<3>().norm()});
  return most;
}

void GeneralizedAlpha::accept() {
  keep_rate();
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
      m.f_old = m.f;
      m.f = ((1.0 - a_.alpha_m) * a + a_.alpha_m * m.a - a_.alpha_f * m.f) / (1.0 - a_.alpha_f);
      m.a = a;
      m.mu = mu;
    }
    end_.momentum_rate = 0.0;
  }
  calm_velocities();
  free_.keep({a_.alpha_m, a_.alpha_f, a_.gamma, a_.beta}, h_, end_, Q_);
  system_.follow_angles(end_);
  const Work power = system_.power(end_);
  end_.work += 0.5 * h_ * (power_ + power);
  power_ = power;
  if (observer_) {
    dense_.set(begin_, end_, Q_);
    observer_(dense_);
  }
  std::swap(Vdot_old_, begin_.Vdot);
  std::swap(lambda_older_, lambda_old_);
  std::swap(lambda_old_, begin_.lambda);
  std::swap(S_older_, S_old_);
  std::swap(S_old_, S_);
  std::swap(S_, resultants_.S);
  t_older_ = t_old_;
  t_old_ = begin_.t;
  // After a jump the motion has no past to go by, and such a step leaves it none.
  const bool is_first = taken_ == 0.0 && is_cut_short() && !bounded_ && !tolerant_;
  starting_ = false;
  taken_ = h_;
  if (calm_next_ || is_first) {
    const bool rings = calm_next_;
    if (restart_calmly(end_) || rings) return;
  }
  history_ = tolerant_ ? 0 : std::min(history_ + 1, 2);  // nothing to extrapolate multipliers from
}

}  // namespace mbd
