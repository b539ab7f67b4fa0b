#include "solvers/time/collocation_step.hpp"

#include <algorithm>

#include "libmbd/core/se3.hpp"
#include "solvers/constraints/redundancy.hpp"

namespace mbd {

void CollocationStep::set(const State& begin, const State& end, const Inside& inside) {
  set_ends(begin, end);
  inside_ = inside;
  prepared_ = false;
}

CollocationStep::WeightsAt CollocationStep::weights_at(double x) const {
  const std::size_t n = inside_.tableau->stages + 1;
  WeightsAt w;
  const auto value = [&](std::size_t k, double at) {
    double product = scale_[k];
    for (std::size_t j = 0; j < n; ++j)
      if (j != k) product *= at - node_[j];
    return product;
  };
  static const Quadrature rule =
      gauss_rule(static_cast<int>(most / 2));  // exact for degree most - 1
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = 0; i < rule.points.size(); ++i)
      w.sum[k] += 0.5 * x * rule.weights[i] * value(k, 0.5 * x * (1.0 + rule.points[i]));
    w.value[k] = value(k, x);
    for (std::size_t i = 0; i < n; ++i) {
      if (i == k) continue;
      double product = scale_[k];
      for (std::size_t j = 0; j < n; ++j)
        if (j != k && j != i) product *= x - node_[j];
      w.slope[k] += product;
    }
  }
  return w;
}

// h times the mean power until then.
Work CollocationStep::work_at(const Weights& sums) const {
  Work work = sums[0] * power_begin_;
  for (std::size_t k = 1; k <= inside_.tableau->stages; ++k) work += sums[k] * inside_.power[k - 1];
  return (end_->t - begin_->t) * work;
}

void CollocationStep::prepare() const {
  const RadauTableau& tableau = *inside_.tableau;
  const std::size_t s = tableau.stages;
  const double h = end_->t - begin_->t;
  std::copy_n(tableau.c.begin(), s, node_.begin() + 1);
  for (std::size_t k = 0; k <= s; ++k) {
    double product = 1.0;
    for (std::size_t j = 0; j <= s; ++j)
      if (j != k) product *= node_[k] - node_[j];
    scale_[k] = 1.0 / product;
  }
  const std::size_t nodes = begin_->pose.size();
  delta_.resize(nodes);
  for (std::vector<Vec6>& rate : rate_) rate.resize(nodes);
  for (std::size_t n = 1; n < nodes; ++n) {
    const Vec6& V = begin_->V[n];
    delta_[n] = inside_.q[s - 1][n];
    for (std::size_t j = 0; j < s; ++j) {
      const Vec6& q = inside_.q[j][n];
      const Vec6 dV = j + 1 == s ? Vec6(end_->V[n] - V) : inside_.dV[j][n];
      rate_[j][n] = h * (T_inverse_times<double>(q, dV) + twist_hat<double>(q) * V);
      delta_[n] -= tableau.b[j] * rate_[j][n];
    }
  }
  std::vector<Index> idle = end_->idle;
  if (inside_.tolerant) idle = find_redundancy_nearby(system_, *end_).idle;
  for (std::size_t j = 0; j < s; ++j) {
    lambda_[j] = inside_.stage[j]->lambda;
    if (idle.empty()) continue;
    State stage = *inside_.stage[j];
    stage.idle = idle;
    lambda_[j] = minimum_norm(system_, stage);
  }
  power_begin_ = system_.power(*begin_);
  work_left_ = end_->work + -1.0 * (begin_->work + work_at(weights_at(1.0).sum));
  prepared_ = true;
}

DenseStep::Balance CollocationStep::balance() const {
  Balance balance;
  balance.size = inside_.tableau->stages;
  for (std::size_t j = 0; j < balance.size; ++j) {
    balance.states[j] = inside_.stage[j];
    balance.weights[j] = inside_.tableau->b[j];
  }
  return balance;
}

void CollocationStep::at(double t, State& out) const {
  if (!prepared_) prepare();
  const std::size_t s = inside_.tableau->stages;
  const double h = end_->t - begin_->t, since = t - begin_->t, x = since / h;
  const WeightsAt w = weights_at(x);
  make_room(*begin_, out);
  system_.set_time(out, t, x < 1.0 ? Side::right : Side::left);
  for (std::size_t n = 1; n < begin_->pose.size(); ++n) {
    const Vec6& V0 = begin_->V[n];
    Vec6 q = x * x * (3.0 - 2.0 * x) * delta_[n], rate = 6.0 * x * (1.0 - x) / h * delta_[n],
         acceleration = 6.0 * (1.0 - 2.0 * x) / (h * h) * delta_[n];
    for (std::size_t j = 0; j < s; ++j) {
      q += w.sum[j + 1] * rate_[j][n];
      rate += w.value[j + 1] / h * rate_[j][n];
      acceleration += w.slope[j + 1] / (h * h) * rate_[j][n];
    }
    const Vec6 turned = twist_hat<double>(q) * V0, turned_rate = twist_hat<double>(rate) * V0;
    const Vector6<Dual<double>> dV =
        T_times<Dual<double>>(dual(q, rate), dual(rate - turned, acceleration - turned_rate));
    for (Index i = 0; i < 6; ++i) {
      out.V[n](i) = V0(i) + dV(i).v;
      out.Vdot[n](i) = dV(i).d;
    }
    out.pose[n] = begin_->pose[n] * exp_se3<double>(Vec6(since * V0)) * exp_se3<double>(q);
  }
  out.lambda.setZero(end_->lambda.size());
  for (std::size_t j = 0; j < s; ++j) {
    double l = 1.0;
    for (std::size_t i = 0; i < s; ++i)
      if (i != j) l *= (x - node_[i + 1]) / (node_[j + 1] - node_[i + 1]);
    out.lambda += l * lambda_[j];
  }
  out.work = begin_->work + work_at(w.sum) + x * work_left_;
  out.angles = begin_->angles;
  system_.follow_angles(out);
}

}  // namespace mbd
