#include "solvers/time/radau.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "libmbd/core/se3.hpp"
#include "libmbd/core/spectral.hpp"
#include "libmbd/core/stop.hpp"

namespace mbd {
namespace {

constexpr KeptTangent::Policy tangent_policy{
    .floor = 0.02, .memory = 0.3, .renew = 0.35, .fresh = 0.05, .iterations = 6};
constexpr double stagnation = 0.3;  // increments below round-off that fall no faster are round-off
// The tolerance of fixed steps is near the round-off of stiff scenes: what stalls this close to it is accepted.
constexpr double stalled_fixed = 20.0;
// At the end of a rank-tolerant step: violations of constraints, of the scene's length, and their rates, of the fastest
// motion. Where links pass through a line at a tolerance of 1e-3 they are 4e-6 and 5e-5, and less; where they cannot,
// rates are 0.3, and violations grow.
constexpr double torn = 1e-4, locked = 1e-2;
constexpr double most_turn = 2.5;  // [rad] in a step: rotations are told apart up to pi
// Adaptive steps: the estimate goes with h^4, the error with h^5; the constant was chosen so that errors of
// the dynamic models are about the tolerance.
constexpr int error_order = 4;
constexpr double local_tolerance = 0.1, local_tolerance_of_motion = 0.03;
constexpr double newton_share = 0.01;  // of the tolerance, for Newton's increments
constexpr double velocity_gain = 4.0;  // h dV/dU of a stage: about |gamma|, |mu|

// Of a matrix, for a single eigenvalue: across two rows of D - x I; its last component is 1.
template <class S>
Matrix<S, 3, 1> eigenvector(const Mat3& D, S x) {
  const Matrix<S, 3, 1> first(D(0, 0) - x, D(0, 1), D(0, 2)), second(D(1, 0), D(1, 1) - x, D(1, 2));
  // Not cross(), which conjugates.
  const Matrix<S, 3, 1> v(first(1) * second(2) - first(2) * second(1),
                          first(2) * second(0) - first(0) * second(2),
                          first(0) * second(1) - first(1) * second(0));
  return v / v(2);
}

// The tableau, its inverse, and the transformation that uncouples the stages.
struct Tableau {
  Vec3 c, b, e;
  Mat3 D, T, T_inv;
  double gamma;
  std::complex<double> mu;

  Tableau() {
    const double q = std::sqrt(6.0);
    c << (4.0 - q) / 10.0, (4.0 + q) / 10.0, 1.0;
    Mat3 A;
    A << (88.0 - 7.0 * q) / 360.0, (296.0 - 169.0 * q) / 1800.0, (-2.0 + 3.0 * q) / 225.0,
        (296.0 + 169.0 * q) / 1800.0, (88.0 + 7.0 * q) / 360.0, (-2.0 - 3.0 * q) / 225.0,
        (16.0 - q) / 36.0, (16.0 + q) / 36.0, 1.0 / 9.0;
    b = A.row(2).transpose();
    D = A.inverse();
    e << -(13.0 + 7.0 * q) / 3.0, (-13.0 + 7.0 * q) / 3.0, -1.0 / 3.0;
    // Eigenvalues of D: roots of x^3 - 9 x^2 + 36 x - 60.
    const double third = std::cbrt(3.0), ninth = std::cbrt(9.0);
    gamma = 3.0 - third + ninth;
    mu = {3.0 + 0.5 * (third - ninth), 0.5 * std::sqrt(3.0) * (third + ninth)};
    T.col(0) = eigenvector<double>(D, gamma);
    const Matrix<std::complex<double>, 3, 1> v = eigenvector(D, mu);
    T.col(1) = v.real();
    T.col(2) = v.imag();
    T_inv = T.inverse();
  }
};
const Tableau& tableau() {
  static const Tableau t;
  return t;
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
    : OneStep(system, std::move(solver), settings_with_newton(options), error_order),
      pencil_(std::move(pencil)),
      kept_(tangent_policy),
      dense_(system, HermiteStep::Degree::quintic),
      mixed_(system) {
  // Fixed steps have no end: what moves less than a length, or a radian, in a thousand of them is at rest.
  if (!settings_.adaptive())
    error_norm_ = std::make_unique<ErrorNorm>(
        system, ErrorTolerances{.relative = settings_.newton.tolerance}, 1000.0 * settings_.step);
  solver_->analyze(system.graph());
  analyze_pencil();
  const auto n = static_cast<std::size_t>(system.nodes());
  for (std::size_t j = 0; j < stages; ++j) {
    q_[j].assign(n, Vec6::Zero());
    q_old_[j].assign(n, Vec6::Zero());
    dV_[j].assign(n, Vec6::Zero());
    reference_[j].resize(n);
    delta_[j].resize(system.unknowns());
  }
  Q_.assign(n, Vec6::Zero());
  carry_.assign(n, Vec6::Zero());
  V_hat_.assign(n, Mat6::Zero());
  eQ_.assign(n, Vec6::Zero());
  eV_.assign(n, Vec6::Zero());
  x_.resize(system.unknowns());
  y_.resize(system.unknowns());
  z_.resize(static_cast<std::size_t>(system.unknowns()));
}

void Radau::analyze_pencil() {
  BlockGraph graph =
      system_.graph();  // and diagonal blocks of multipliers, for rank-tolerant steps
  const int blocks = static_cast<int>(graph.blocks.size());
  for (int k = static_cast<int>(system_.nodes()) - 1; k < blocks; ++k)
    graph.contributions.push_back({k, k});
  pencil_->analyze(graph);
}

std::string Radau::signature() const { return signature_of("Radau", {mixed_.signature()}); }

void Radau::archive(Archive& a) {
  OneStep::archive(a);
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

double Radau::time_of(std::size_t stage) const {
  return begin_.t + tableau().c(static_cast<Index>(stage)) * h_;
}

// Stages from the polynomial of the last step, or from the rates at the start.
void Radau::predict(bool extrapolate) {
  const bool known = extrapolate && history_;
  if (mixed_.should_begin(counters_)) {
    mixed_.begin();
    for (std::vector<double>& S : S_old_) mixed_.set(begin_, S);
    relinearize_next_ = true;
  }
  const Vec3& c = tableau().c;
  for (std::size_t j = 0; j < stages; ++j) {
    State& stage = stage_[j];
    const double tau = time_of(j) - begin_.t;
    each_pack(1, eQ_.size(), [&](const PackOf& pack) {
      unpack(packed(begin_.pose, pack) * exp_se3<Pack>(Pack(tau) * packed(begin_.V, pack)), pack,
             reference_[j]);
    });
    if (known) {
      const double since = time_of(j) - t_old_;
      const auto w = lagrange<4>({0.0, c(0), c(1), c(2)}, since / h_old_);
      each_pack(1, eQ_.size(), [&](const PackOf& pack) {
        const Vector6<Pack> q = Pack(w[1]) * packed(q_old_[0], pack) +
                                Pack(w[2]) * packed(q_old_[1], pack) +
                                Pack(w[3]) * packed(q_old_[2], pack);
        const Pose<Pack> H = packed(pose_old_, pack) *
                             exp_se3<Pack>(Pack(since) * packed(V_old_, pack)) * exp_se3<Pack>(q);
        unpack(log_se3<Pack>(relative(packed(reference_[j], pack), H)), pack, q_[j]);
      });
      const auto v = lagrange<3>({c(0), c(1), c(2)}, since / h_old_);
      stage.lambda = v[0] * lambda_old_[0] + v[1] * lambda_old_[1] + v[2] * lambda_old_[2];
      resultants_[j].S.resize(mixed_.size());
      for (std::size_t i = 0; i < mixed_.size(); ++i)
        resultants_[j].S[i] = v[0] * S_old_[0][i] + v[1] * S_old_[1][i] + v[2] * S_old_[2][i];
    } else {
      for (std::size_t n = 1; n < eQ_.size(); ++n) q_[j][n] = 0.5 * tau * tau * begin_.Vdot[n];
      stage.lambda = begin_.lambda;
    }
  }
  if (!known)
    for (KeptResultants::Iterate& resultants : resultants_) mixed_.set(begin_, resultants.S);
  update_stages();
}

// Poses and rates of the stages from q. With Ad(exp(-q)) - I = -T(q) q~ the change of velocity is
// T(q) (q' - q~ V_i), without the round-off of V.
[[gnu::flatten]] void Radau::update_stages() {
  const Mat3& D = tableau().D;
  const double rate = 1.0 / h_;
  const auto derivative = [&](Index j, const std::array<Vector6<Pack>, stages>& x) {
    return Vector6<Pack>(Pack(rate) *
                         (Pack(D(j, 0)) * x[0] + Pack(D(j, 1)) * x[1] + Pack(D(j, 2)) * x[2]));
  };
  each_pack(1, eQ_.size(), [&](const PackOf& pack) {
    const Vector6<Pack> V = packed(begin_.V, pack);
    const Vector3<Pack> v = linear(V), w = angular(V);
    std::array<Vector6<Pack>, stages> q, dV;
    for (std::size_t j = 0; j < stages; ++j) q[j] = packed(q_[j], pack);
    for (std::size_t j = 0; j < stages; ++j) {
      const Vector3<Pack> u = linear(q[j]), psi = angular(q[j]);
      const Vector6<Pack> qdot =
          derivative(static_cast<Index>(j), q) - six<Pack>(psi.cross(v) + u.cross(w), psi.cross(w));
      dV[j] = T_times<Pack>(q[j], qdot);
      unpack(dV[j], pack, dV_[j]);
      unpack(V + dV[j], pack, stage_[j].V);
      unpack(packed(reference_[j], pack) * exp_se3<Pack>(q[j]), pack, stage_[j].pose);
    }
    for (std::size_t j = 0; j < stages; ++j)
      unpack(derivative(static_cast<Index>(j), dV), pack, stage_[j].Vdot);
  });
}

// r and gdot of all stages. False if an element is out of its range.
bool Radau::residuals() {
  bool in_range = true;
  for (std::size_t j = 0; j < stages; ++j) {
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
  const double x = tableau().gamma / h_;
  ++counters_.factorizations;
  if (pencil_->factor(1.0 / (x * x), x, tableau().mu / h_) != FactorStatus::ok) {
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
    linearize(stage_[1], 1);
    fresh_ = true;
    relinearize_next_ = false;
  }
  const bool is_factored =
      factored_step_ > 0.0 && std::abs(h_ - factored_step_) <= same_step * factored_step_;
  return is_factored || factorize(report);
}

// Right-hand sides of (2), from the residuals.
void Radau::set_right_sides() {
  const Tableau& t = tableau();
  const double x = t.gamma / h_, s = 1.0 / (x * x);
  const std::complex<double> z = t.mu / h_;
  const Index motions = 6 * (system_.nodes() - 1);
  for (Index i = 0; i < system_.unknowns(); ++i) {
    const double r0 = r_[0](i + 6), r1 = r_[1](i + 6), r2 = r_[2](i + 6);
    const auto weighted = [&](Index row) {
      return t.T_inv(row, 0) * r0 + t.T_inv(row, 1) * r1 + t.T_inv(row, 2) * r2;
    };
    const std::complex<double> c(weighted(1), -weighted(2));
    const auto I = static_cast<std::size_t>(i);
    if (i < motions) {
      x_(i) = -s * weighted(0);
      z_[I] = -s * c;
    } else {
      x_(i) = -weighted(0) / x;
      z_[I] = -c / z;
    }
  }
}

// Increments of the stages from the solutions of (2); their largest, in tolerances.
Radau::Increment Radau::set_increments(double slack, double share) {
  const Tableau& t = tableau();
  const double x = t.gamma / h_, s = 1.0 / (x * x);
  const Index size = system_.unknowns();
  Increment largest;
  for (std::size_t j = 0; j < stages; ++j) {
    const auto J = static_cast<Index>(j);
    for (Index i = 0; i < size; ++i) {
      const std::complex<double>& w = z_[static_cast<std::size_t>(i)];
      delta_[j](i) = t.T(J, 0) * x_(i) + t.T(J, 1) * w.real() - t.T(J, 2) * w.imag();
    }
    double exact = 0.0;
    const double one =
        norm_({delta_[j].data(), static_cast<std::size_t>(size)}, s, slack, share, &exact);
    largest.floored = one <= largest.floored ? largest.floored : one;  // a NaN stays
    largest.exact = std::max(largest.exact, exact);
  }
  return largest;
}

void Radau::move_stages() {
  const double x = tableau().gamma / h_, s = 1.0 / (x * x);
  for (std::size_t j = 0; j < stages; ++j) {
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
  for (std::size_t j = 0; j < stages && element.empty(); ++j)
    element = system_.out_of_range(stage_[j]);
  report.failure = newton_failure(element, r_[2]);
  report.kind = element.empty() ? Failure::convergence : Failure::range;
}

void Radau::note(double increment, StepReport& report) {
  const auto k = static_cast<std::size_t>(report.iterations++);
  if (k < report.increments.size()) report.increments[k] = increment;
  report.error = increment;
}

void Radau::explain_not_finite(StepReport& report) const {
  std::size_t bad = 0;
  while (bad < 2 && r_[bad].allFinite()) ++bad;
  report.failure =
      fmt::format("the residual is not finite at {}", system_.name_of(worst_row(system_, r_[bad])));
}

bool Radau::iterate(StepReport& report) {
  report.iterations = 0;
  report.contraction = 0.0;
  if (!make_ready(report)) return false;
  const double x = tableau().gamma / h_;
  norm_.set_floor(begin_, stiffness_ + mass_ * x * x);
  const double share = error_norm_->velocity_share(velocity_gain / h_);
  const double stalled = settings_.adaptive() ? 1.0 : stalled_fixed;
  const double slack = multiplier_slack();
  double previous = 0.0, last = 0.0;  // increments, in tolerances; of the last with its floor
  for (int k = 0; k < settings_.newton.max_iterations; ++k) {
    stop::check();
    const bool in_range = residuals();
    counters_.residuals += 3;
    set_right_sides();
    pencil_->solve({x_.data(), static_cast<std::size_t>(x_.size())});
    pencil_->solve(std::span<std::complex<double>>(z_));
    ++counters_.iterations;
    const auto [e, exact] = set_increments(slack, share);
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
      if (exact * factor < 1.0 || (e * factor < stalled && stagnates)) {
        if (!in_range) break;
        kept_.accepted_after(report.iterations);
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
  for (std::size_t j = 0; j < stages; ++j) {
    stage_[j] = begin_;
    system_.set_time(stage_[j], j + 1 == stages ? t : time_of(j), Side::left);
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
    system_.constraints(stage_[2], g_, gdot_);
    Index row = 0;
    if (!(largest_violation(system_, g_, &row) <= torn) ||
        !(largest_violation(system_, gdot_, &row) <= locked * fastest(system_, stage_[2]))) {
      converged = false;
      report.failure =
          fmt::format("the constraints cannot all be kept (worst: {}): the mechanism locks there",
                      system_.name_of(6 * system_.nodes() + row));
    }
  }
  if (converged)
    for (std::size_t n = 1; n < eQ_.size() && converged; ++n)
      if (!(h_ * begin_.V[n].tail<3>().norm() + q_[2][n].tail<3>().norm() < most_turn)) {
        converged = false;
        report.failure = fmt::format("{} turns by more than {} rad in a step",
                                     system_.node_name(static_cast<Index>(n)), most_turn);
      }
  return converged;
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
  // Of tolerance^(4/5).
  const double factor =
      (settings_.tolerances.of == ErrorsOf::motion ? local_tolerance_of_motion : local_tolerance) *
      std::pow(settings_.tolerances.relative, -0.2);
  estimate(false);
  error_norm_->measure(begin_, stage_[2]);
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
  const Tableau& t = tableau();
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
    Vec6 dQ = rate * (t.e(0) * q_[0][N] + t.e(1) * q_[1][N] + t.e(2) * q_[2][N]);
    Vec6 dV = rate * (t.e(0) * dV_[0][N] + t.e(1) * dV_[1][N] + t.e(2) * dV_[2][N]);
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
  const double x = tableau().gamma / factored_step_;
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
    double last = std::numeric_limits<double>::infinity();
    for (int pass = 0; pass < most_passes; ++pass) {
      system_.constraints(end_, g_, gdot_);
      const double size = largest_violation(system_, violation);
      if (pass > 0 && !(size <= last) && !(size <= open)) {
        std::swap(increments, Q_);
        move_to(increments);
        return;
      }
      if (size <= enough || !(size < 0.9 * last)) return;
      if (pass >= 2 && size > slow * last && size > worth * enough && !renewed) {
        renewed = true;
        linearize(end_, 2);
        StepReport report;
        if (!factorize(report)) return;
      }
      last = size;
      correct(violation);
      Q_ = increments;
      for (Index n = 1; n < system_.nodes(); ++n) {
        Vec6& u = increments[static_cast<std::size_t>(n)];
        const Vec6 change = x_.segment<6>(6 * (n - 1));
        u += &increments == &q_[2] ? T_inverse_times<double>(u, change) : change;
      }
      move_to(increments);
    }
  };
  settle_on(g_, 2.0 * round_off, torn, q_[2], [&](const std::vector<Vec6>& q) {
    for (std::size_t n = 1; n < q.size(); ++n)
      end_.pose[n] = reference_[2][n] * exp_se3<double>(q[n]);
  });
  const double pace = fastest(system_, end_);
  settle_on(gdot_, 4.0 * eps * pace, locked * pace, dV_[2], [&](const std::vector<Vec6>& dV) {
    for (std::size_t n = 1; n < dV.size(); ++n) end_.V[n] = begin_.V[n] + dV[n];
  });
}

void Radau::accept() {
  const Tableau& t = tableau();
  end_ = stage_[2];
  project();
  for (std::size_t n = 1; n < eQ_.size(); ++n) {
    renormalize(end_.pose[n]);
    const Vec6 change = dV_[2][n] + carry_[n];
    end_.V[n] = begin_.V[n] + change;
    carry_[n] = change - (end_.V[n] - begin_.V[n]);
  }
  system_.follow_angles(end_);
  std::array<Work, stages> power;
  for (std::size_t j = 0; j < stages; ++j) {
    power[j] = system_.power(j + 1 == stages ? end_ : stage_[j]);
    end_.work += h_ * t.b(static_cast<Index>(j)) * power[j];
  }
  if (observer_) {
    for (std::size_t n = 1; n < Q_.size(); ++n)
      Q_[n] = log_se3<double>(relative(begin_.pose[n], end_.pose[n]));
    dense_.set(begin_, end_, Q_);
    dense_.set_inside({time_of(0), time_of(1)}, {&stage_[0].lambda, &stage_[1].lambda},
                      {power[0], power[1]});
    observer_(dense_);
  }
  std::swap(q_, q_old_);
  std::swap(pose_old_, begin_.pose);
  std::swap(V_old_, begin_.V);
  for (std::size_t j = 0; j < stages; ++j) {
    std::swap(lambda_old_[j], stage_[j].lambda);
    std::swap(S_old_[j], resultants_[j].S);
  }
  t_old_ = begin_.t;
  h_old_ = h_;
  history_ = true;
}

}  // namespace mbd
