#include "elements/beam/mesh_error.hpp"

#include <cmath>

namespace mbd::beam {
namespace {

double legendre(int n, double x) {
  double before = 1.0, now = x;
  if (n == 0) return before;
  for (int k = 2; k <= n; ++k) {
    const double next = ((2 * k - 1) * x * now - (k - 1) * before) / k;
    before = now;
    now = next;
  }
  return now;
}

}  // namespace

MeshErrorRule::MeshErrorRule(const SpectralTable& table)
    : sign_(table.order % 2 == 0 ? 1.0 : -1.0) {
  const std::vector<double>& points = table.rule.points;
  const std::vector<double> gauss = gauss_rule(table.order).points;
  const auto best = [&](double x) {
    const VecX l = lagrange(gauss, x);
    VecX sum = VecX::Zero(std::ssize(points));
    for (std::size_t k = 0; k < gauss.size(); ++k)
      sum += l(static_cast<Index>(k)) * lagrange(points, gauss[k]);
    return sum;
  };
  // (1) is of degree N + 1, S_h of N at most.
  const Quadrature rule = gauss_rule(table.order + 2);
  weights_ = rule.weights;
  at_ = rule.points;
  for (const double x : at_) {
    P_.push_back(legendre(table.order, x));
    own_.push_back(lagrange(points, x));
    best_.push_back(best(x));
    int nearest = 0;
    for (int i = 1; i < static_cast<int>(points.size()); ++i)
      if (std::abs(points[static_cast<std::size_t>(i)] - x) <
          std::abs(points[static_cast<std::size_t>(nearest)] - x))
        nearest = i;
    nearest_.push_back(nearest);
  }
  first_ = best(-1.0);
  last_ = best(1.0);
}

MeshError MeshErrorRule::operator()(double length, std::span<const Vec6> S,
                                    std::span<const Mat6> compliance, const Vec6& begin,
                                    const Vec6& end) const {
  const auto at = [S](const VecX& l) {
    Vec6 sum = Vec6::Zero();
    for (std::size_t i = 0; i < S.size(); ++i) sum += l(static_cast<Index>(i)) * S[i];
    return sum;
  };
  const Vec6 first = sign_ * (begin - at(first_)), last = end - at(last_);
  const Vec6 a = 0.5 * (first + last), b = 0.5 * (last - first);
  MeshError sum;
  for (std::size_t i = 0; i < at_.size(); ++i) {
    const Vec6 whole = at(best_[i]) + P_[i] * (a + at_[i] * b);
    const Vec6 missed = whole - at(own_[i]);
    const Mat6& C = compliance[static_cast<std::size_t>(nearest_[i])];
    const double w = 0.25 * length * weights_[i];
    sum.error += w * missed.dot(C * missed);
    sum.energy += w * whole.dot(C * whole);
    sum.unit += w / C(0, 0);
  }
  return sum;
}

}  // namespace mbd::beam
