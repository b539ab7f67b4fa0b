#include "solvers/time/dense_output.hpp"

#include "libmbd/core/se3.hpp"

namespace mbd {
namespace {
using D = Dual<double>;
}

void make_room(const State& begin, State& out) {
  out.load_factor = begin.load_factor;
  out.inputs = begin.inputs;
  out.momentum_rate = 0.0;
  out.pose.resize(begin.pose.size());
  out.V.resize(begin.pose.size());
  out.Vdot.resize(begin.pose.size());
}

void HermiteStep::set(const State& begin, const State& end, std::span<const Vec6> Q) {
  balance_ = {};
  set_ends(begin, end);
  Q_ = Q;
  inner_ = {};
  prepared_ = false;
}

void HermiteStep::set_inside(const std::array<double, 2>& times,
                             const std::array<const VecX*, 2>& multipliers,
                             const std::array<Work, 2>& powers) {
  times_ = times;
  inner_ = multipliers;
  inner_powers_ = powers;
}

void HermiteStep::prepare() const {
  const double h = end_->t - begin_->t;
  powers_ = {system_.power(*begin_), system_.power(*end_)};
  c_.resize(Q_.size());
  for (std::size_t n = 1; n < Q_.size(); ++n) {
    const Vec6& Q = Q_[n];
    const Vec6 rate = T_inverse_times<double>(Q, end_->V[n]);
    auto& c = c_[n];
    c[0] = h * begin_->V[n];
    const Vec6 d = Q - c[0], d1 = h * rate - c[0];
    if (degree_ == Degree::cubic) {
      c[1] = 3.0 * d - d1;
      c[2] = d1 - 2.0 * d;
      c[3].setZero();
      c[4].setZero();
      continue;
    }
    const Vector6<D> both = T_inverse_times<D>(dual(Q, rate), dual(end_->V[n], end_->Vdot[n]));
    Vec6 acceleration;
    for (Index i = 0; i < 6; ++i) acceleration(i) = both(i).d;
    c[1] = 0.5 * h * h * begin_->Vdot[n];
    const Vec6 e = d - c[1], e1 = d1 - 2.0 * c[1], e2 = h * h * acceleration - 2.0 * c[1];
    c[2] = 10.0 * e - 4.0 * e1 + 0.5 * e2;
    c[3] = -15.0 * e + 7.0 * e1 - e2;
    c[4] = 6.0 * e - 3.0 * e1 + 0.5 * e2;
  }
  prepared_ = true;
}

void HermiteStep::at(double t, State& out) const {
  if (!prepared_) prepare();
  const double h = end_->t - begin_->t;
  const double s = (t - begin_->t) / h;
  make_room(*begin_, out);
  system_.set_time(out, t, s < 1.0 ? Side::right : Side::left);
  for (std::size_t n = 1; n < c_.size(); ++n) {
    const auto& c = c_[n];
    const Vec6 Q = s * (c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * c[4]))));
    const Vec6 rate =
        (c[0] + s * (2.0 * c[1] + s * (3.0 * c[2] + s * (4.0 * c[3] + s * 5.0 * c[4])))) / h;
    const Vec6 acceleration =
        (2.0 * c[1] + s * (6.0 * c[2] + s * (12.0 * c[3] + s * 20.0 * c[4]))) / (h * h);
    const Vector6<D> V = T_times<D>(dual(Q, rate), dual(rate, acceleration));
    for (Index i = 0; i < 6; ++i) {
      out.V[n](i) = V(i).v;
      out.Vdot[n](i) = V(i).d;
    }
    out.pose[n] = begin_->pose[n] * exp_se3<double>(Q);
  }
  if (inner_[0] == nullptr) {
    out.lambda = (1.0 - s) * begin_->lambda + s * end_->lambda;
    out.work = work_inside<2>(s, h, {0.0, 1.0}, powers_, begin_->work, end_->work);
  } else {
    const auto w = lagrange<3>({times_[0], times_[1], end_->t}, t);
    out.lambda = w[0] * *inner_[0] + w[1] * *inner_[1] + w[2] * end_->lambda;
    out.work = work_inside<4>(
        s, h, {0.0, (times_[0] - begin_->t) / h, (times_[1] - begin_->t) / h, 1.0},
        {powers_[0], inner_powers_[0], inner_powers_[1], powers_[1]}, begin_->work, end_->work);
  }
  out.angles = begin_->angles;
  system_.follow_angles(out);
}

}  // namespace mbd
