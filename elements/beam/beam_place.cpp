#include "elements/beam/beam_place.hpp"

#include <array>

#include "elements/beam/beam_field.hpp"
#include "elements/beam/beam_motion.hpp"
#include "libmbd/core/dual.hpp"

namespace mbd::beam {
namespace {

using D = Dual<double>;

// g and its rate, where W is the velocity of its end in its own frame.
Pose<D> moving(const Pose<double>& g, const Vec6& W) {
  const Vec3 w = angular(W), v = g.p * linear(W);
  const Quaternion<double> dp = g.p * Quaternion<double>(0.0, 0.5 * w(0), 0.5 * w(1), 0.5 * w(2));
  return {
      Quaternion<D>(D(g.p.w(), dp.w()), D(g.p.x(), dp.x()), D(g.p.y(), dp.y()), D(g.p.z(), dp.z())),
      Vector3<D>(D(g.r(0), v(0)), D(g.r(1), v(1)), D(g.r(2), v(2)))};
}

template <class Metric>
NodeState<double> of_motions(std::span<const NodeState<double>> nodes, const VecX& l, bool rates) {
  std::array<Pose<double>, max_order + 1> poses;
  for (std::size_t k = 0; k < nodes.size(); ++k) poses[k] = nodes[k].H;
  const auto [H, inverse] = interpolated_pose<Metric, double>(
      std::span<const Pose<double>>(poses.data(), nodes.size()), l);
  NodeState<double> place{H, Vec6::Zero(), Vec6::Zero()};
  if (!rates) return place;
  Vec6 sum = Vec6::Zero();
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const typename Metric::template Pair<double> pair(relative(H, nodes[k].H));
    sum += l(static_cast<Index>(k)) * (pair.T_inverse() * nodes[k].V);  // (1)
  }
  place.V = inverse * sum;
  const Vector6<D> V = place.V.cast<D>();
  sum.setZero();
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const Pose<double> g = relative(H, nodes[k].H);
    const typename Metric::template Pair<D> pair(
        moving(g, nodes[k].V - adjoint_inverse(g) * place.V));
    Vector6<D> V_k;
    for (Index i = 0; i < 6; ++i) V_k(i) = D(nodes[k].V(i), nodes[k].Vdot(i));
    const DualMatrix<D> T = pair.T_inverse();
    const Vector6<D> term = T * V_k - T.transposed_parts() * V;  // (2)
    for (Index i = 0; i < 6; ++i) sum(i) += l(static_cast<Index>(k)) * term(i).d;
  }
  place.Vdot = inverse * sum;
  return place;
}

NodeState<double> of_displacements_and_rotations(std::span<const NodeState<double>> nodes,
                                                 const VecX& l, bool rates) {
  // Differences from the first node: nothing is lost far from the origin.
  const NodeState<double>& first = nodes.front();
  Vec3 r = Vec3::Zero(), dr = r, ddr = r;
  Eigen::Vector4d a = first.H.p.coeffs(), da = Eigen::Vector4d::Zero(), dda = da;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const NodeState<double>& node = nodes[k];
    const double weight = l(static_cast<Index>(k));
    const double sign = sign_of(first.H.p.dot(node.H.p));
    r += weight * (node.H.r - first.H.r);
    a += weight * (sign * node.H.p.coeffs() - first.H.p.coeffs());
    if (!rates) continue;
    const auto turned = [](const Quaternion<double>& p, const Vec3& w) {  // p [0; w]/2
      return p * Quaternion<double>(0.0, 0.5 * w(0), 0.5 * w(1), 0.5 * w(2));
    };
    const Vec3 v = linear(node.V), w = angular(node.V);
    dr += weight * (node.H.p * v);
    ddr += weight * (node.H.p * Vec3(linear(node.Vdot) + w.cross(v)));
    const Quaternion<double> dp = turned(node.H.p, w);  // (3)
    da += weight * sign * dp.coeffs();
    dda += weight * sign * (turned(dp, w).coeffs() + turned(node.H.p, angular(node.Vdot)).coeffs());
  }
  const double n = a.squaredNorm();
  const Quaternion<double> A(a), p(Eigen::Vector4d(a / std::sqrt(n)));
  NodeState<double> place{{p, first.H.r + r}, Vec6::Zero(), Vec6::Zero()};
  if (!rates) return place;
  const auto along = [&](const Eigen::Vector4d& b) {  // 2 Im(a* b)/n
    return Vec3(2.0 / n * (A.conjugate() * Quaternion<double>(b)).vec());
  };
  const Vec3 w = along(da), v = p.conjugate() * dr;  // (4)
  place.V = six<double>(v, w);
  place.Vdot =
      six<double>(p.conjugate() * ddr - w.cross(v), Vec3(along(dda) - 2.0 * a.dot(da) / n * w));
  return place;
}

}  // namespace

NodeState<double> motion_within(Kinematics kinematics, Metric metric,
                                std::span<const NodeState<double>> nodes, const VecX& l,
                                bool rates) {
  if (kinematics == Kinematics::classical) return of_displacements_and_rotations(nodes, l, rates);
  switch (metric) {
    case Metric::matrix:
      return of_motions<MatrixMetric>(nodes, l, rates);
    case Metric::quaternion:
      return of_motions<QuaternionMetric>(nodes, l, rates);
    case Metric::geodesic:
      break;
  }
  return of_motions<GeodesicMetric>(nodes, l, rates);
}

}  // namespace mbd::beam
