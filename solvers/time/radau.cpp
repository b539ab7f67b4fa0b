#include "solvers/time/radau.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <utility>

#include "libmbd/core/se3.hpp"
#include "libmbd/core/spectral.hpp"
#include "libmbd/core/stop.hpp"
#include "solvers/time/radau_stages.hpp"

namespace mbd {
namespace {

constexpr KeptTangent::Policy tangent_policy{
    .floor = 0.02, .memory = 0.3, .renew = 0.35, .fresh = 0.05, .iterations = 6, .more = 2};
constexpr double stagnation = 0.3;  // increments below round-off that fall no faster are round-off
// The tolerance of fixed steps is near the round-off of stiff scenes: what stalls this close to it is accepted.
constexpr double stalled_fixed = 20.0;
// At the end of a rank-tolerant step: violations of constraints, of the scene's length, and their rates, of the fastest
// motion. Where links pass through a line at a tolerance of 1e-3 they are 4e-6 and 5e-5, and less; where they cannot,
// rates are 0.3, and violations grow.
constexpr double torn = 1e-4, locked = 1e-2;
// Multipliers that such a step does not determine go on for ever, by what gaps over its eps give them, and take the motion along by
// so little: of the scene's length, or [rad].
// The less in shorter steps, which are tried first.
constexpr double crept = 1e-11, crept_at_last = 1e-8,
                 crept_of_step = 1e-4;  // the last: of its motion
constexpr double most_turn = 2.5;       // [rad] in a step: rotations are told apart up to pi
// [rad] of two nodes: angles of joints are followed from step to step.
constexpr double most_relative_turn = 3.0;
// Adaptive steps: the estimate goes with h^(s + 1), errors of rows with h^(s + 2); the constants were chosen so that errors
// of the dynamic models are about the tolerance (of more than three stages: of pendulum, heavy_top and double_pendulum).
int error_order(std::size_t stages) { return static_cast<int>(stages) + 1; }
constexpr double local_tolerance = 0.1, local_tolerance_of_motion = 0.03;
double looser(const RadauTableau& t) { return t.stages == 3 ? 1.0 : t.stages == 5 ? 3.0 : 6.0; }
constexpr double newton_share = 0.01;  // of the tolerance, for Newton's increments
// h dV/dU of a stage: about |gamma|, |mu|.
double velocity_gain(const RadauTableau& t) { return t.stages == 3 ? 4.0 : t.gamma; }

// No two nodes, the ground among them, turn faster against each other [rad/s]: of the box that has all angular velocities.
double relative_spin(const State& state) {
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  for (std::size_t n = 1; n < state.V.size(); ++n) {
    const Vec3 w = state.pose[n].R() * state.V[n].tail<3>();
    low = low.cwiseMin(w);
    high = high.cwiseMax(w);
  }
  return (high - low).norm();
}

// The stages that a run begins with.
std::size_t first_stages(const RadauOptions& options) {
  if (options.stages == 0) return 3;
  if (options.stages != 3 && options.stages != 5 && options.stages != 7)
    throw Error(fmt::format("Radau IIA has 3, 5 or 7 stages here, not {}", options.stages));
  return options.stages;
}

// use(how many, as a constant).
template <class Use>
auto with_stages(std::size_t stages, const Use& use) {
  if (stages == 3) return use(std::integral_constant<std::size_t, 3>());
  if (stages == 5) return use(std::integral_constant<std::size_t, 5>());
  return use(std::integral_constant<std::size_t, 7>());
}

}  // namespace

// Of adaptive steps Newton's iterations go as far as the tolerance asks for.
OneStep::Settings Radau::settings_with_newton(const RadauOptions& options) {
  Settings settings = settings_of(options);
  if (settings.adaptive()) {
    NewtonOptions& newton = settings.newton;
    newton.tolerance = newton_share * settings.tolerances.relative;
    newton.multiplier_tolerance = std::clamp(10.0 * newton.tolerance, 1e-9, 1e-5);
  }
  return settings;
}

Radau::Radau(const System& system, std::unique_ptr<LinearSolver> solver,
             std::unique_ptr<PencilSolver> pencil, const RadauOptions& options)
    : OneStep(system, std::move(solver), settings_with_newton(options),
              error_order(first_stages(options))),
      stages_(options.stages),
      t_(&radau_tableau(first_stages(options))),
      pencil_(std::move(pencil)),
      kept_(tangent_policy),
      dense_(system, HermiteStep::Degree::quintic),
      dense_higher_(system),
      mixed_(system) {
  // Fixed steps have no end: what moves less than a length, or a radian, in a thousand of them is at rest.
  if (!settings_.adaptive())
    error_norm_ = std::make_unique<ErrorNorm>(
        system, ErrorTolerances{.relative = settings_.newton.tolerance}, 1000.0 * settings_.step);
  solver_->analyze(system.graph());
  analyze_pencil();
  const auto n = static_cast<std::size_t>(system.nodes());
  use_stages(t_->stages);
  if (settings_.adaptive() && stages_ == 0)
    choice_ = std::make_unique<RadauStages>(settings_.tolerances.relative);
  Q_.assign(n, Vec6::Zero());
  carry_.assign(n, Vec6::Zero());
  V_hat_.assign(n, Mat6::Zero());
  eQ_.assign(n, Vec6::Zero());
  eV_.assign(n, Vec6::Zero());
  x_.resize(system.unknowns());
  y_.resize(system.unknowns());
}

Radau::~Radau() = default;

void Radau::use_stages(std::size_t stages) {
  t_ = &radau_tableau(stages);
  const auto n = static_cast<std::size_t>(system_.nodes());
  for (std::size_t j = 0; j < stages; ++j) {
    q_[j].resize(n, Vec6::Zero());
    q_old_[j].resize(n, Vec6::Zero());
    dV_[j].resize(n, Vec6::Zero());
    reference_[j].resize(n);
    delta_[j].resize(system_.unknowns());
  }
  for (std::size_t k = 0; k < t_->pairs(); ++k)
    z_[k].resize(static_cast<std::size_t>(system_.unknowns()));
}

void Radau::analyze_pencil() {
  BlockGraph graph =
      system_.graph();  // and diagonal blocks of multipliers, for rank-tolerant steps
  const int blocks = static_cast<int>(graph.blocks.size());
  for (int k = static_cast<int>(system_.nodes()) - 1; k < blocks; ++k)
    graph.contributions.push_back({k, k});
  pencil_->analyze(graph);
}

std::string Radau::signature() const {
  return signature_of("Radau", {static_cast<double>(stages_), mixed_.signature()});
}

void Radau::archive(Archive& a) {
  OneStep::archive(a);
  std::size_t stages = t_->stages;
  a(stages, stages_old_, counted_);
  if (choice_) a(*choice_);
  use_stages(stages);
  if (!settings_.adaptive()) a(*error_norm_);
  a(kept_, carry_, history_, t_old_, h_old_, q_old_, pose_old_, V_old_, lambda_old_, mixed_, S_old_,
    stiffness_);
}

// Pivots too are chosen anew.
void Radau::take_new_tangent() {
  analyze_pencil();
  solver_->analyze(system_.graph());
  linearized_ = false;
  fresh_ = false;
  factored_step_ = 0.0;
  relinearize_next_ = true;
}

void Radau::begin_at(State&) {
  history_ = false;
  linearized_ = false;
  for (Vec6& c : carry_) c.setZero();
  factored_step_ = 0.0;
}

double Radau::time_of(std::size_t stage) const { return begin_.t + t_->c[stage] * h_; }

// Stages from the polynomial of the last step, or from the rates at the start.
void Radau::predict(bool extrapolate) {
  const bool known = extrapolate && history_;
  if (mixed_.should_begin(counters_)) {
    mixed_.begin();
    for (std::vector<double>& S : S_old_) mixed_.set(begin_, S);
    relinearize_next_ = true;
  }
  for (std::size_t j = 0; j < t_->stages; ++j) {
    const double tau = time_of(j) - begin_.t;
    each_pack(1, eQ_.size(), [&](const PackOf& pack) {
      unpack(packed(begin_.pose, pack) * exp_se3<Pack>(Pack(tau) * packed(begin_.V, pack)), pack,
             reference_[j]);
    });
    if (known) {
      with_stages(stages_old_, [&]<std::size_t s>(std::integral_constant<std::size_t, s>) {
        extrapolate_of<s>(j);
      });
    } else {
      for (std::size_t n = 1; n < eQ_.size(); ++n) q_[j][n] = 0.5 * tau * tau * begin_.Vdot[n];
      stage_[j].lambda = begin_.lambda;
    }
  }
  if (!known)
    for (std::size_t j = 0; j < t_->stages; ++j) mixed_.set(begin_, resultants_[j].S);
  update_stages();
}

// Stage j from the polynomials through the s stages of the last step.
template <std::size_t s>
void Radau::extrapolate_of(std::size_t j) {
  const RadauTableau& old = radau_tableau(s);
  std::array<double, s> c;
  std::array<double, s + 1> with_start{};
  std::copy_n(old.c.begin(), s, c.begin());
  std::copy_n(old.c.begin(), s, with_start.begin() + 1);
  const double since = time_of(j) - t_old_;
  const auto w = lagrange<s + 1>(with_start, since / h_old_);
  const auto v = lagrange<s>(c, since / h_old_);
  [&]<std::size_t... l>(std::index_sequence<l...>) {
    each_pack(1, eQ_.size(), [&](const PackOf& pack) {
      const Vector6<Pack> q = (... + (Pack(w[l + 1]) * packed(q_old_[l], pack)));
      const Pose<Pack> H = packed(pose_old_, pack) *
                           exp_se3<Pack>(Pack(since) * packed(V_old_, pack)) * exp_se3<Pack>(q);
      unpack(log_se3<Pack>(relative(packed(reference_[j], pack), H)), pack, q_[j]);
    });
    stage_[j].lambda = (... + (v[l] * lambda_old_[l]));
    std::vector<double>& S = resultants_[j].S;
    S.resize(mixed_.size());
    for (std::size_t i = 0; i < mixed_.size(); ++i) S[i] = (... + (v[l] * S_old_[l][i]));
  }
  (std::make_index_sequence<s>());
}

// Poses and rates of the stages from q. With Ad(exp(-q)) - I = -T(q) q~ the change of velocity is
// T(q) (q' - q~ V_i), without the round-off of V.
void Radau::update_stages() {
  with_stages(t_->stages, [&]<std::size_t s>(std::integral_constant<std::size_t, s>) {
    update_stages_of<s>();
  });
}
template <std::size_t s>
[[gnu::flatten]] void Radau::update_stages_of() {
  const auto& D = t_->D;
  const double rate = 1.0 / h_;
  const auto derivative = [&](Index j, const std::array<Vector6<Pack>, s>& x) {
    return [&]<std::size_t... l>(std::index_sequence<l...>) {
      return Vector6<Pack>(Pack(rate) * (... + (Pack(D(j, static_cast<Index>(l))) * x[l])));
    }
    (std::make_index_sequence<s>());
  };
  each_pack(1, eQ_.size(), [&](const PackOf& pack) {
    const Vector6<Pack> V = packed(begin_.V, pack);
    const Vector3<Pack> v = linear(V), w = angular(V);
    std::array<Vector6<Pack>, s> q, dV;
    for (std::size_t j = 0; j < s; ++j) q[j] = packed(q_[j], pack);
    for (std::size_t j = 0; j < s; ++j) {
      const Vector3<Pack> u = linear(q[j]), psi = angular(q[j]);
      const Vector6<Pack> qdot =
          derivative(static_cast<Index>(j), q) - six<Pack>(psi.cross(v) + u.cross(w), psi.cross(w));
      dV[j] = T_times<Pack>(q[j], qdot);
      unpack(dV[j], pack, dV_[j]);
      unpack(V + dV[j], pack, stage_[j].V);
      unpack(packed(reference_[j], pack) * exp_se3<Pack>(q[j]), pack, stage_[j].pose);
    }
    for (std::size_t j = 0; j < s; ++j)
      unpack(derivative(static_cast<Index>(j), dV), pack, stage_[j].Vdot);
  });
}

// r and gdot of all stages. False if an element is out of its range.
bool Radau::residuals() {
  bool in_range = true;
  for (std::size_t j = 0; j < t_->stages; ++j) {
    in_range &= mixed_.residual(stage_[j], resultants_[j], r_[j]);
    system_.constraints(stage_[j], g_, gdot_);
    r_[j].tail(gdot_.size()) = gdot_;
  }
  return in_range;
}

// P0, P1, P2 at a state of the step with the resultants of a stage: the middle one, in Newton's iterations.
bool Radau::linearize(const State& at, std::size_t stage) {
  pencil_->set_zero();
  for (std::size_t n = 1; n < V_hat_.size(); ++n) V_hat_[n] = twist_hat<double>(begin_.V[n]);
  const bool in_range = system_.linearize_powers(
      at, V_hat_, r_[1], {pencil_->slots(0), pencil_->slots(1), pencil_->slots(2)});
  mixed_.keep_tangent(at, 1.0, resultants_[stage], pencil_->slots(0));
  if (tolerant_)
    add_rank_tolerance(pencil_->slots(0).subspan(system_.graph().contributions.size()));
  stiffness_ = largest_stiffness(system_, pencil_->slots(0));
  ++counters_.tangents;
  linearized_ = true;
  factored_step_ = 0.0;
  kept_.renewed();
  return in_range;
}

bool Radau::factorize(StepReport& report) {
  const double x = t_->gamma / h_;
  std::array<std::complex<double>, most / 2> z;
  for (std::size_t k = 0; k < t_->pairs(); ++k) z[k] = t_->mu[k] / h_;
  ++counters_.factorizations;
  if (pencil_->factor(1.0 / (x * x), x, std::span(z.data(), t_->pairs())) != FactorStatus::ok) {
    const Index row = pencil_->singular_row();
    report.failure = singular_failure(row >= 0 ? system_.name_of(row + 6) : std::string());
    report.kind = Failure::singular;
    factored_step_ = 0.0;
    return false;
  }
  factored_step_ = h_;
  return true;
}

// The pencil of the stages, factored for this step.
bool Radau::make_ready(StepReport& report) {
  fresh_ = false;
  if (relinearize_next_ || !linearized_) {
    linearize(stage_[t_->stages / 2], t_->stages / 2);
    fresh_ = true;
    relinearize_next_ = false;
  }
  const bool is_factored =
      factored_step_ > 0.0 && std::abs(h_ - factored_step_) <= same_step * factored_step_;
  return is_factored || factorize(report);
}

// Right-hand sides of (2), from the residuals.
template <std::size_t s>
void Radau::set_right_sides() {
  const auto& T_inv = t_->T_inv;
  const double x = t_->gamma / h_, scale = 1.0 / (x * x);
  std::array<std::complex<double>, s / 2> z;
  for (std::size_t k = 0; k < s / 2; ++k) z[k] = t_->mu[k] / h_;
  const Index motions = 6 * (system_.nodes() - 1);
  for (Index i = 0; i < system_.unknowns(); ++i) {
    std::array<double, s> r;
    for (std::size_t j = 0; j < s; ++j) r[j] = r_[j](i + 6);
    const auto weighted = [&](Index row) {
      return [&]<std::size_t... j>(std::index_sequence<j...>) {
        return (... + (T_inv(row, static_cast<Index>(j)) * r[j]));
      }
      (std::make_index_sequence<s>());
    };
    const auto I = static_cast<std::size_t>(i);
    const bool moves = i < motions;
    x_(i) = moves ? -scale * weighted(0) : -weighted(0) / x;
    for (std::size_t k = 0; k < s / 2; ++k) {
      const auto row = static_cast<Index>(2 * k + 1);
      const std::complex<double> c(weighted(row), -weighted(row + 1));
      z_[k][I] = moves ? -scale * c : -c / z[k];
    }
  }
}

template <std::size_t s>
void Radau::solve_pencils() {
  pencil_->solve({x_.data(), static_cast<std::size_t>(x_.size())});
  for (std::size_t k = 0; k < s / 2; ++k) pencil_->solve(std::span(z_[k]), k);
}

// Increments of the stages from the solutions of (2); their largest, in tolerances.
template <std::size_t s>
Radau::Increment Radau::set_increments(double slack, double share) {
  const auto& T = t_->T;
  const double x = t_->gamma / h_, scale = 1.0 / (x * x);
  const Index size = system_.unknowns();
  Increment largest;
  for (std::size_t j = 0; j < s; ++j) {
    const auto J = static_cast<Index>(j);
    for (Index i = 0; i < size; ++i) {
      double sum = T(J, 0) * x_(i);
      for (std::size_t k = 0; k < s / 2; ++k) {
        const std::complex<double>& w = z_[k][static_cast<std::size_t>(i)];
        const auto column = static_cast<Index>(2 * k + 1);
        sum = sum + T(J, column) * w.real() - T(J, column + 1) * w.imag();
      }
      delta_[j](i) = sum;
    }
    double exact = 0.0;
    const double one =
        norm_({delta_[j].data(), static_cast<std::size_t>(size)}, scale, slack, share, &exact);
    largest.floored = one <= largest.floored ? largest.floored : one;  // a NaN stays
    largest.exact = std::max(largest.exact, exact);
  }
  return largest;
}

Radau::Increment Radau::increments(double slack, double share) {
  return with_stages(t_->stages, [&]<std::size_t s>(std::integral_constant<std::size_t, s>) {
    set_right_sides<s>();
    solve_pencils<s>();
    return set_increments<s>(slack, share);
  });
}

void Radau::move_stages() {
  const double x = t_->gamma / h_, s = 1.0 / (x * x);
  for (std::size_t j = 0; j < t_->stages; ++j) {
    each_pack(1, eQ_.size(), [&](const PackOf& pack) {
      Vector6<Pack> delta, q = packed(q_[j], pack);
      pack_into(delta, [&](int lane) { return delta_[j].data() + 6 * (pack[lane] - 1); });
      unpack(q + T_inverse_times<Pack>(q, delta), pack, q_[j]);
    });
    stage_[j].lambda += delta_[j].tail(stage_[j].lambda.size()) / s;
    mixed_.advance(delta_[j], resultants_[j]);
  }
  update_stages();
}

void Radau::explain_failure(StepReport& report) {
  residuals();
  std::string element;
  for (std::size_t j = 0; j < t_->stages && element.empty(); ++j)
    element = system_.out_of_range(stage_[j]);
  report.failure = newton_failure(element, r_[last()]);
  report.kind = element.empty() ? Failure::convergence : Failure::range;
}

void Radau::note(double increment, StepReport& report) {
  const auto k = static_cast<std::size_t>(report.iterations++);
  if (k < report.increments.size()) report.increments[k] = increment;
  report.error = increment;
}

void Radau::explain_not_finite(StepReport& report) const {
  std::size_t bad = 0;
  while (bad < last() && r_[bad].allFinite()) ++bad;
  report.failure =
      fmt::format("the residual is not finite at {}", system_.name_of(worst_row(system_, r_[bad])));
}

// Whether fixed steps, whose tolerance is near round-off, take what is left: of adaptive ones the tolerance says it.
bool Radau::has_crept() const {
  if (!tolerant_ || settings_.adaptive()) return false;
  const double L = system_.length_scale();
  double largest = 0.0, in_step = 0.0;
  for (Index i = 0; i < 6 * (system_.nodes() - 1); ++i) {
    const double unit = i % 6 < 3 ? L : 1.0;
    for (std::size_t j = 0; j < t_->stages; ++j)
      largest = std::max(largest, std::abs(delta_[j](i)) / unit);
    const auto n = static_cast<std::size_t>(i / 6 + 1);
    const double moved = h_ * std::abs(begin_.V[n](i % 6)) + std::abs(q_[last()][n](i % 6));
    in_step = std::max(in_step, moved / unit);
  }
  return largest < std::min(is_shortest() ? crept_at_last : crept, crept_of_step * in_step);
}

bool Radau::iterate(StepReport& report) {
  report.iterations = 0;
  report.contraction = 0.0;
  if (!make_ready(report)) return false;
  const double x = t_->gamma / h_;
  norm_.set_floor(begin_, stiffness_ + mass_ * x * x);
  const double share = error_norm_->velocity_share(velocity_gain(*t_) / h_);
  const double stalled = settings_.adaptive() ? 1.0 : stalled_fixed;
  const double slack = multiplier_slack();
  double previous = 0.0, last = 0.0;  // increments, in tolerances; of the last with its floor
  for (int k = 0; k < settings_.newton.max_iterations; ++k) {
    stop::check();
    const bool in_range = residuals();
    counters_.residuals += static_cast<long>(t_->stages);
    ++counters_.iterations;
    const auto [e, exact] = increments(slack, share);
    note(e, report);
    if (!std::isfinite(e)) {
      explain_not_finite(report);
      return false;
    }
    bool renew = false;
    const bool stagnates = previous > 0.0 && exact > stagnation * previous;
    if (previous > 0.0) {
      kept_.measured(exact, previous);
      if (last > 1.0) report.contraction = std::max(report.contraction, e / last);
      if (e > stalled && exact > 2.0 * previous) {
        if (fresh_ && k > 2) break;  // diverges with its own tangents
        renew = !fresh_;
      }
    }
    if (!renew) {
      previous = exact;
      last = e;
      move_stages();
      const double factor = kept_.share_left();
      report.error = e * factor;
      // As small as asked for; or as round-off lets it become.
      if (exact * factor < 1.0 || (e * factor < stalled && stagnates) ||
          (stagnates && has_crept())) {
        if (!in_range) break;
        kept_.accepted_after(report.iterations, fresh_);
        relinearize_next_ = kept_.is_old_after(report.iterations) && !fresh_ && !stagnates;
        return true;
      }
      if (kept_.is_poor() && !fresh_ && e > stalled) renew = true;
    }
    if (renew) {
      previous = last = 0.0;
      report.contraction = 0.0;
      relinearize_next_ = true;
      if (!make_ready(report)) return false;
    }
  }
  if (report.failure.empty()) explain_failure(report);
  return false;
}

bool Radau::solve_step(double t, double h, StepReport& report) {
  h_ = h;
  for (std::size_t j = 0; j < t_->stages; ++j) {
    stage_[j] = begin_;
    system_.set_time(stage_[j], j == last() ? t : time_of(j), Side::left);
    if (!usable(stage_[j], report)) return false;
  }
  error_norm_->measure(begin_, begin_);
  predict(true);
  bool converged = iterate(report);
  if (!converged &&
      !(fresh_ && !history_)) {  // once more from the start of the step, with new tangents
    report.failure.clear();
    relinearize_next_ = true;
    predict(false);
    converged = iterate(report);
  }
  if (!converged && system_.multipliers() > 0) {
    const std::string failure = report.failure;  // of the iterations that users know
    tolerant_ = true;
    relinearize_next_ = true;
    report.failure.clear();
    predict(true);
    converged = iterate(report);
    if (!converged) report.failure = failure;
  }
  if (converged && tolerant_) {
    // Where the mechanism locks, such a step stands still and says that it has converged.
    system_.constraints(stage_[last()], g_, gdot_);
    Index row = 0;
    if (!(largest_violation(system_, g_, &row) <= torn) ||
        !(largest_violation(system_, gdot_, &row) <= locked * fastest(system_, stage_[last()]))) {
      converged = false;
      report.failure =
          fmt::format("the constraints cannot all be kept (worst: {}): the mechanism locks there",
                      system_.name_of(6 * system_.nodes() + row));
    }
  }
  if (converged) {
    report.failure = turns_too_far();
    converged = report.failure.empty();
  }
  return converged;
}

std::string Radau::turns_too_far() const {
  double more_turn = 0.0;  // [rad] of what velocities at its begin do not tell
  for (std::size_t n = 1; n < eQ_.size(); ++n) {
    const double more = q_[last()][n].tail<3>().norm();
    more_turn = std::max(more_turn, more);
    if (!(h_ * begin_.V[n].tail<3>().norm() + more < most_turn))
      return fmt::format("{} turns by more than {} rad in a step",
                         system_.node_name(static_cast<Index>(n)), most_turn);
  }
  if (!begin_.angles.empty() &&
      !(h_ * relative_spin(begin_) + 2.0 * more_turn < most_relative_turn))
    return fmt::format("bodies turn against each other by more than {} rad in a step",
                       most_relative_turn);
  return {};
}

// So that steps do not fail for turns: more than three stages might pass over whole ones.
double Radau::longest_from(const State& state) const {
  constexpr double share = 0.85;  // the rest is for velocities that grow
  double longest = OneStep::longest_from(state);
  if (!state.angles.empty())
    longest = std::min(longest, share * most_relative_turn / relative_spin(state));
  if (t_->stages == 3) return longest;
  double spin = 0.0;
  for (const Vec6& V : state.V) spin = std::max(spin, V.tail<3>().norm());
  return std::min(longest, share * most_turn / spin);
}

void Radau::settle() {
  relinearize_next_ = true;
  if (!tolerant_) return;
  tolerant_ = false;
  linearized_ = false;
  history_ = false;  // nothing to extrapolate multipliers from
}

void Radau::forget() {
  relinearize_next_ = true;
  tolerant_ = false;
  linearized_ = false;
  history_ = false;
}

double Radau::estimated_error(bool again) {
  const double factor =
      (settings_.tolerances.of == ErrorsOf::motion ? local_tolerance_of_motion : local_tolerance) *
      looser(*t_) *
      std::pow(settings_.tolerances.relative, -1.0 / (static_cast<double>(t_->stages) + 2.0));
  estimate(false);
  error_norm_->measure(begin_, stage_[last()]);
  const double error = (*error_norm_)(eQ_, eV_, factor);
  // After a rejection, and at a start, the estimate may be of what is too stiff for the step.
  if (!(error > 1.0 && (again || !history_))) return error;
  estimate(true);
  return (*error_norm_)(eQ_, eV_, factor);
}

// Equation (3) into eQ_ and eV_.
// `filtered`: from the start of the step moved by the first estimate, which is wrong where things are stiffer than
// the step resolves: what decays within it is then taken out (IV.8.20).
void Radau::estimate(bool filtered) {
  with_stages(t_->stages, [&]<std::size_t s>(std::integral_constant<std::size_t, s>) {
    estimate_of(filtered, std::make_index_sequence<s>());
  });
}
template <std::size_t... l>
void Radau::estimate_of(bool filtered, std::index_sequence<l...>) {
  const RadauTableau& t = *t_;
  const double x = t.gamma / h_, s = 1.0 / (x * x), rate = 1.0 / h_;
  const Index size = system_.unknowns(), motions = 6 * (system_.nodes() - 1);
  VecX& rhs = delta_[0];
  VecX &first = delta_[1], &second = delta_[2];
  if (filtered) {
    moved_ = begin_;
    for (std::size_t n = 1; n < eQ_.size(); ++n) {
      moved_.pose[n] = begin_.pose[n] * exp_se3<double>(eQ_[n]);
      moved_.V[n] += eV_[n];
      moved_.Vdot[n].setZero();
    }
    moved_.lambda += rhs.tail(size - motions) / s;
    system_.residual(moved_, r_[0]);
    system_.constraints(moved_, g_, gdot_);
    ++counters_.residuals;
  }
  first.setZero();   // what P1 is applied to
  second.setZero();  // what P2 is applied to
  for (Index n = 1; n < system_.nodes(); ++n) {
    const auto N = static_cast<std::size_t>(n);
    Vec6 dQ = rate * (... + (t.e[l] * q_[l][N]));
    Vec6 dV = rate * (... + (t.e[l] * dV_[l][N]));
    if (filtered)
      dQ += eV_[N] - V_hat_[N] * eQ_[N];  // q' there; V' is in the residual
    else
      dV += begin_.Vdot[N];
    eV_[N] = dQ;
    first.segment<6>(6 * (n - 1)) = dQ;
    second.segment<6>(6 * (n - 1)) = dV + x * dQ - V_hat_[N] * dQ;
  }
  const auto span_of = [&](VecX& v) {
    return std::span<double>(v.data(), static_cast<std::size_t>(v.size()));
  };
  rhs.setZero();
  pencil_->multiply(1, span_of(first), span_of(rhs));
  pencil_->multiply(2, span_of(second), span_of(rhs));
  if (filtered) rhs.head(motions) -= r_[0].segment(6, motions);
  rhs.head(motions) *= s;
  y_.setZero();
  pencil_->multiply(0, span_of(first), span_of(y_));
  if (filtered) y_.tail(size - motions) -= gdot_;
  rhs.tail(size - motions) = y_.tail(size - motions) / x;  // B dQ
  pencil_->solve(span_of(rhs));
  for (Index n = 1; n < system_.nodes(); ++n) {
    const auto N = static_cast<std::size_t>(n);
    eQ_[N] = rhs.segment<6>(6 * (n - 1));
    eV_[N] = x * eQ_[N] + V_hat_[N] * eQ_[N] - eV_[N];
  }
}

// Rates of gaps of eps times velocities, of which (2) makes W and s dL.
std::optional<RoundOff> Radau::round_off() {
  if (factored_step_ == 0.0 || !history_ || system_.multipliers() == 0) return std::nullopt;
  constexpr double eps = std::numeric_limits<double>::epsilon();
  const double x = t_->gamma / factored_step_;
  double fastest = 0.0;
  for (const Vec6& V : end_.V)
    fastest = std::max({fastest, V.head<3>().cwiseAbs().maxCoeff(),
                        V.tail<3>().cwiseAbs().maxCoeff() * system_.length_scale()});
  const std::span<double> response(x_.data(), static_cast<std::size_t>(x_.size()));
  set_round_off(eps * fastest / x, response);
  pencil_->solve(response);
  RoundOff result = round_off_of(response, x, x * x);
  result.reciprocal_condition = pencil_->reciprocal_condition();
  return result;
}

// Puts end_ on the constraints, at both levels.
void Radau::project() {
  if (system_.multipliers() == 0) return;
  constexpr int most_passes = 20;
  constexpr double slow = 0.1, worth = 100.0;
  constexpr double eps = std::numeric_limits<double>::epsilon();
  double farthest = system_.length_scale();
  for (const Pose<double>& H : end_.pose) farthest = std::max(farthest, H.r.cwiseAbs().maxCoeff());
  const double round_off = eps * farthest / system_.length_scale();
  const auto correct = [&](const VecX& violation) {
    x_.setZero();
    x_.tail(violation.size()) = -violation;
    pencil_->solve({x_.data(), static_cast<std::size_t>(x_.size())});
  };
  // Corrects until the violation is round-off, or no longer falls. Where things turn far in a step the kept
  // gradients are too old for that. Near a lock no correction helps, and one that opens a joint is taken back: no other,
  // since where links come into line those at the size of round-off still count.
  bool renewed = tolerant_;
  const auto settle_on = [&](const VecX& violation, double enough, double open,
                             std::vector<Vec6>& increments, const auto& move_to) {
    double before = std::numeric_limits<double>::infinity();
    for (int pass = 0; pass < most_passes; ++pass) {
      system_.constraints(end_, g_, gdot_);
      const double size = largest_violation(system_, violation);
      if (pass > 0 && !(size <= before) && !(size <= open)) {
        std::swap(increments, Q_);
        move_to(increments);
        return;
      }
      if (size <= enough || !(size < 0.9 * before)) return;
      if (pass >= 2 && size > slow * before && size > worth * enough && !renewed) {
        renewed = true;
        linearize(end_, last());
        StepReport report;
        if (!factorize(report)) return;
      }
      before = size;
      correct(violation);
      Q_ = increments;
      for (Index n = 1; n < system_.nodes(); ++n) {
        Vec6& u = increments[static_cast<std::size_t>(n)];
        const Vec6 change = x_.segment<6>(6 * (n - 1));
        u += &increments == &q_[last()] ? T_inverse_times<double>(u, change) : change;
      }
      move_to(increments);
    }
  };
  settle_on(g_, 2.0 * round_off, torn, q_[last()], [&](const std::vector<Vec6>& q) {
    for (std::size_t n = 1; n < q.size(); ++n)
      end_.pose[n] = reference_[last()][n] * exp_se3<double>(q[n]);
  });
  const double pace = fastest(system_, end_);
  settle_on(gdot_, 4.0 * eps * pace, locked * pace, dV_[last()], [&](const std::vector<Vec6>& dV) {
    for (std::size_t n = 1; n < dV.size(); ++n) end_.V[n] = begin_.V[n] + dV[n];
  });
}

void Radau::accept() {
  end_ = stage_[last()];
  project();
  for (std::size_t n = 1; n < eQ_.size(); ++n) {
    renormalize(end_.pose[n]);
    const Vec6 change = dV_[last()][n] + carry_[n];
    end_.V[n] = begin_.V[n] + change;
    carry_[n] = change - (end_.V[n] - begin_.V[n]);
  }
  system_.follow_angles(end_);
  std::array<Work, most> power;
  for (std::size_t j = 0; j < t_->stages; ++j) {
    power[j] = system_.power(j == last() ? end_ : stage_[j]);
    end_.work += h_ * t_->b[j] * power[j];
  }
  if (observer_) {
    for (std::size_t n = 1; n < Q_.size(); ++n)
      Q_[n] = log_se3<double>(relative(begin_.pose[n], end_.pose[n]));
    show(power);
  }
  std::swap(q_, q_old_);
  std::swap(pose_old_, begin_.pose);
  std::swap(V_old_, begin_.V);
  for (std::size_t j = 0; j < t_->stages; ++j) {
    std::swap(lambda_old_[j], stage_[j].lambda);
    std::swap(S_old_[j], resultants_[j].S);
  }
  t_old_ = begin_.t;
  h_old_ = h_;
  stages_old_ = t_->stages;
  if (t_->stages == 5) ++counters_.of_five_stages;
  if (t_->stages == 7) ++counters_.of_seven_stages;
  history_ = true;
  if (choice_) choose_stages();
}

// For the next step.
void Radau::choose_stages() {
  const std::array<long, 3> now = {counters_.iterations, counters_.tangents,
                                   counters_.factorizations};
  const double work = RadauStages::work(t_->stages, now[0] - counted_[0], now[1] - counted_[1],
                                        now[2] - counted_[2]);
  counted_ = now;
  if (!choice_->accepted(h_, work)) return;
  use_stages(choice_->stages());
  factored_step_ = 0.0;
  change_error_order(error_order(t_->stages), choice_->step());
}

void Radau::pass_failure(double h) {
  if (!choice_ || !choice_->failed()) return;
  use_stages(choice_->stages());
  factored_step_ = 0.0;
  change_error_order(error_order(t_->stages), h);
}

void Radau::show(const std::array<Work, most>& power) {
  if (t_->stages == 3) {
    dense_.set(begin_, end_, Q_);
    dense_.set_inside({time_of(0), time_of(1)}, {&stage_[0].lambda, &stage_[1].lambda},
                      {power[0], power[1]});
    dense_.set_balance(
        {{&stage_[0], &stage_[1], &end_}, {t_->b[0], t_->b[1], t_->b[2]}, t_->stages});
    observer_(dense_);
    return;
  }
  CollocationStep::Inside inside;
  inside.tableau = t_;
  for (std::size_t j = 0; j < t_->stages; ++j) {
    inside.q[j] = q_[j];
    inside.dV[j] = dV_[j];
    inside.stage[j] = j + 1 == t_->stages ? &end_ : &stage_[j];
    inside.power[j] = power[j];
  }
  inside.tolerant = tolerant_;
  dense_higher_.set(begin_, end_, inside);
  observer_(dense_higher_);
}

}  // namespace mbd
