#include "elements/beam/mesh_error.hpp"

#include <algorithm>
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

// Stiffness that stands for that of a stretch [N]: its own, or that of bending over the length.
double stretched(const Mat6& compliance, double length) {
  if (compliance(0, 0) > 0.0) return 1.0 / compliance(0, 0);
  const double bends = compliance.diagonal().tail<3>().maxCoeff() * length * length / 12.0;
  return 1.0 / std::max(bends, compliance.diagonal().head<3>().maxCoeff());
}

}  // namespace

Mat6 compliance_of(const Mat6& D, const StrainSet& held) {
  if (!any(held)) return Mat6(D.ldlt().solve(Mat6::Identity()));
  Mat6 alone = D;
  for (Index c = 0; c < 6; ++c)
    if (held[static_cast<std::size_t>(c)]) {
      alone.row(c).setZero();
      alone.col(c).setZero();
      alone(c, c) = 1.0;
    }
  Mat6 compliance = alone.ldlt().solve(Mat6::Identity());
  for (Index c = 0; c < 6; ++c)
    if (held[static_cast<std::size_t>(c)]) compliance(c, c) = 0.0;
  return compliance;
}

MeshErrorRule::MeshErrorRule(const SpectralTable& table)
    : points_(table.rule.points),
      gauss_(gauss_rule(table.order).points),
      order_(table.order),
      sign_(table.order % 2 == 0 ? 1.0 : -1.0) {
  // (1) is of degree N + 1, S_h of N at most.
  const Quadrature rule = gauss_rule(table.order + 2);
  weights_ = rule.weights;
  at_ = rule.points;
  for (const double x : at_) {
    P_.push_back(legendre(table.order, x));
    own_.push_back(lagrange(points_, x));
    best_.push_back(best(x));
    int nearest = 0;
    for (int i = 1; i < static_cast<int>(points_.size()); ++i)
      if (std::abs(points_[static_cast<std::size_t>(i)] - x) <
          std::abs(points_[static_cast<std::size_t>(nearest)] - x))
        nearest = i;
    nearest_.push_back(nearest);
  }
  first_ = best(-1.0);
  last_ = best(1.0);
}

// Of the polynomial through the Gauss points, of S_h at the points of the rule.
VecX MeshErrorRule::best(double xi) const {
  const VecX l = lagrange(gauss_, xi);
  VecX sum = VecX::Zero(std::ssize(points_));
  for (std::size_t k = 0; k < gauss_.size(); ++k)
    sum += l(static_cast<Index>(k)) * lagrange(points_, gauss_[k]);
  return sum;
}

MeshError MeshErrorRule::operator()(double length, std::span<const Vec6> S,
                                    std::span<const Mat6> compliance, const Vec6& begin,
                                    const Vec6& end, std::span<const SectionSample> samples,
                                    const StrainSet& held) const {
  const auto at = [](const VecX& l, std::span<const Vec6> of) {
    Vec6 sum = Vec6::Zero();
    for (std::size_t i = 0; i < of.size(); ++i) sum += l(static_cast<Index>(i)) * of[i];
    return sum;
  };
  const Vec6 first = sign_ * (begin - at(first_, S)), last = end - at(last_, S);
  const Vec6 a = 0.5 * (first + last), b = 0.5 * (last - first);
  MeshError sum;
  const auto add = [&sum, length](double w, const Vec6& whole, const Vec6& missed, const Mat6& C) {
    sum.error += w * missed.dot(C * missed);
    sum.energy += w * whole.dot(C * whole);
    sum.unit += w * stretched(C, length);
  };
  if (samples.empty()) {
    for (std::size_t i = 0; i < at_.size(); ++i) {
      const Vec6 whole = at(best_[i], S) + P_[i] * (a + at_[i] * b);
      add(0.25 * length * weights_[i], whole, whole - at(own_[i], S),
          compliance[static_cast<std::size_t>(nearest_[i])]);
    }
    return sum;
  }
  std::vector<Vec6> E(S.size());
  for (std::size_t i = 0; i < S.size(); ++i) E[i] = compliance[i] * S[i];
  for (const SectionSample& one : samples) {
    const Vec6 whole = at(best(one.xi), S) + legendre(order_, one.xi) * (a + one.xi * b);
    add(0.25 * length * one.weight, whole, whole - one.D * at(lagrange(points_, one.xi), E),
        compliance_of(one.D, held));
  }
  return sum;
}

}  // namespace mbd::beam
