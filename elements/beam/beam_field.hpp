// The field of a spectral beam element between its nodes: the interpolated motion with its curvature, and the
// curvature that the element assumes in its place. For output, comparison and tests; the residual needs only
// nodes.
//
// Interpolated motion (NOTATION.md 2; HB 17, 18). H(xi) solves
//   sum_k l_k(xi) q_k = 0,   q_k the motion parameters of H^-1 H_k,                                 (1)
// and, with dq_k = -T^-1(-q_k) dU of an increment dU of H, its curvature is
//   K = [ sum_k l_k T^-1(-q_k) ]^-1 sum_k l'_k q_k / J,   J = sum_k l_k J_k.                        (2)
// The quaternion metric solves (1) in closed form: H is the normalised sum sum_k l_k p_k of unit dual
// quaternions of one sign. The others iterate, H <- H exp([..]^-1 sum_k l_k q_k) with the bracket of (2), which is
// Newton's method, from there.
//
// Assumed curvature (HB 19, 20). The nodal curvatures K_j = sum_k d_jk q_jk / J_j, at the N Gauss points,
//   K_i = sum_j l_j(xi_i) K_j,                                                                      (3)
// and the polynomial of degree N - 1 through these (of degree N through the nodes for Gauss-Lobatto).
//
// Symbols: K = [t; k] curvature in section axes [-, 1/m]; J = ds/dxi [m]; poses and their frames as in se3.hpp.
// Not used: polar decomposition, the closed form of the matrix metric, which needs an iteration itself.
#pragma once

#include <Eigen/LU>
#include <cmath>
#include <span>
#include <type_traits>

#include "elements/metrics.hpp"
#include "libmbd/core/error.hpp"
#include "libmbd/core/spectral.hpp"

namespace mbd::beam {

template <class S>
struct FieldPoint {
  Pose<S> H;     // [-, m]
  Vector6<S> K;  // curvature [-, 1/m]
};

// The normalised sum of dual quaternions (1), as a pose relative to the node `base`, so that nothing is lost
// far from the origin.
template <class S>
Pose<S> blended(std::span<const Pose<S>> nodes, const VecX& l, std::size_t base) {
  Eigen::Matrix<S, 4, 1> real = Eigen::Matrix<S, 4, 1>::Zero(), dual = real;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const Pose<S> g = relative(nodes[base], nodes[k]);
    const S weight = S(l(static_cast<Index>(k))) * sign_of(S(g.p.w()));
    const Quaternion<S> rp =
        Quaternion<S>(S(0), g.r(0), g.r(1), g.r(2)) * g.p;  // twice the dual part
    real += weight * g.p.coeffs();
    dual += weight * rp.coeffs();
  }
  const S n = S(1) / real.norm();
  const Quaternion<S> p(Eigen::Matrix<S, 4, 1>(n * real)), d(Eigen::Matrix<S, 4, 1>(n * dual));
  return nodes[base] * Pose<S>{p, (d * p.conjugate()).vec()};
}

// What solves (1), and the inverse of the bracket of (2) there.
template <class S>
struct InterpolatedPose {
  Pose<S> H;
  DualMatrix<S> inverse;
};

// (1) at a place where the Lagrange polynomials of the nodes are l.
// Throws Error where the iteration does not converge: the nodes are too far apart for the metric.
template <class Metric, class S>
InterpolatedPose<S> interpolated_pose(std::span<const std::type_identity_t<Pose<S>>> nodes,
                                      const VecX& l) {
  using Pair = typename Metric::template Pair<S>;
  Index nearest = 0;
  l.cwiseAbs().maxCoeff(&nearest);
  Pose<S> H = blended<S>(nodes, l, static_cast<std::size_t>(nearest));
  const S length = (nodes.back().r - nodes.front().r).norm();
  constexpr int most = 50;
  bool found = std::is_same_v<Metric, QuaternionMetric>;  // the closed form is it from the first
  for (int i = 0; i < most; ++i) {
    DualMatrix<S> bracket{Matrix3<S>::Zero(), Matrix3<S>::Zero()};
    Vector6<S> sum = Vector6<S>::Zero();
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const Pair pair(relative(H, nodes[k]));
      sum += S(l(static_cast<Index>(k))) * pair.q();
      const DualMatrix<S> T = pair.T_inverse();
      bracket.A += S(l(static_cast<Index>(k))) * T.A.transpose();  // T^-1(-q) = A^T + eps B^T
      bracket.B += S(l(static_cast<Index>(k))) * T.B.transpose();
    }
    const Matrix3<S> A = bracket.A.inverse();
    const DualMatrix<S> inverse{A, -A * bracket.B * A};
    if (found) return {H, inverse};
    const Vector6<S> U = inverse * sum;
    H = H * exp_se3<S>(U);
    // The next increment would be its square, which is round-off.
    found = linear(U).norm() / length + angular(U).norm() < S(1e-9);
  }
  throw Error(
      "the motion of a beam element cannot be interpolated: its nodes are turned too far against "
      "each other; take more elements");
}

// (1) and (2), where the derivatives of the polynomials are dl.
template <class Metric, class S>
FieldPoint<S> interpolated_field(std::span<const std::type_identity_t<Pose<S>>> nodes,
                                 const VecX& l, const VecX& dl, const S& J) {
  const InterpolatedPose<S> at = interpolated_pose<Metric, S>(nodes, l);
  Vector6<S> slope = Vector6<S>::Zero();
  for (std::size_t k = 0; k < nodes.size(); ++k)
    slope += S(dl(static_cast<Index>(k))) *
             typename Metric::template Pair<S>(relative(at.H, nodes[k])).q();
  return {at.H, at.inverse * slope / J};
}

// The same at xi in [-1, 1] of an element with the nodal Jacobians `J` [m].
template <class Metric, class S>
FieldPoint<S> interpolated_field(const SpectralTable& table, std::span<const double> J,
                                 std::span<const std::type_identity_t<Pose<S>>> nodes, double xi) {
  const VecX l = lagrange(table.nodes.points, xi);
  const VecX dl = lagrange_derivative(table.nodes.points, xi);
  double Jx = 0.0;
  for (std::size_t k = 0; k < J.size(); ++k) Jx += l(static_cast<Index>(k)) * J[k];
  return interpolated_field<Metric, S>(nodes, l, dl, S(Jx));
}

// (3) at xi in [-1, 1].
template <class Metric>
Vec6 assumed_curvature(const SpectralTable& table, std::span<const double> J,
                       std::span<const Pose<double>> nodes, double xi) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> K(6, table.order + 1);  // K_j
  K.setZero();
  for (Index j = 0; j <= table.order; ++j)
    for (Index k = 0; k <= table.order; ++k) {
      if (k == j) continue;
      const auto a = static_cast<std::size_t>(j), b = static_cast<std::size_t>(k);
      const typename Metric::template Pair<double> pair(relative(nodes[a], nodes[b]));
      K.col(j) += table.d(j, k) / J[a] * pair.q();
    }
  return K * table.l_at_points.transpose() * lagrange(table.rule.points, xi);
}

}  // namespace mbd::beam
