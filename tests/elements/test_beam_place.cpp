// The motion of a place within a beam element: what it is at nodes, of a rigid motion, against differences in time, and up
// to the limit of each metric.

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <vector>

#include "elements/beam/beam_classical.hpp"
#include "elements/beam/beam_motion.hpp"
#include "elements/beam/beam_place.hpp"
#include "elements/metrics.hpp"
#include "libmbd/core/spectral.hpp"
#include "tests/support/random.hpp"

namespace mbd::test::test_beam_place {
namespace {

struct Case {
  const char* name;
  Kinematics kinematics;
  Metric metric;
  double max_angle;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

constexpr Case cases[] = {
    {"matrix", Kinematics::motion, Metric::matrix, MatrixMetric::max_angle},
    {"quaternion", Kinematics::motion, Metric::quaternion, QuaternionMetric::max_angle},
    {"geodesic", Kinematics::motion, Metric::geodesic, GeodesicMetric::max_angle},
    {"classical", Kinematics::classical, Metric::geodesic, beam::ClassicalRange::max_angle},
};

class Place : public testing::TestWithParam<Case> {
 protected:
  static NodeState<double> at(const std::vector<NodeState<double>>& nodes, double xi,
                              bool rates = true) {
    const auto order = static_cast<int>(nodes.size()) - 1;
    const VecX l = lagrange(spectral_table(order, Rule::gauss).nodes.points, xi);
    return beam::motion_within(GetParam().kinematics, GetParam().metric, nodes, l, rates);
  }
};

double distance(const Pose<double>& a, const Pose<double>& b) {
  return log_se3(relative(a, b)).norm();
}

// A strained, bent and twisted element of length 2 in any motion.
std::vector<NodeState<double>> random_nodes(Rng& rng, int order, double bend = 0.3) {
  std::vector<NodeState<double>> nodes;
  const Pose<double> G = random_pose(rng, 3.0);
  const Vec6 a = random_vector<6>(rng, bend), b = random_vector<6>(rng, bend / 3);
  for (const double xi : spectral_table(order, Rule::gauss).nodes.points) {
    Vec6 U = (1 + xi) * a + (1 + xi) * (1 + xi) * b;
    U(0) += 1 + xi;
    Pose<double> H = G * exp_se3(U);
    if (uniform(rng, 0, 1) < 0.5) H.p.coeffs() *= -1.0;  // the same rotation
    nodes.push_back({H, random_vector<6>(rng, 2.0), random_vector<6>(rng, 5.0)});
  }
  return nodes;
}

TEST_P(Place, IsThatOfANodeAtANode) {
  Rng rng(1);
  for (int i = 0; i < 80; ++i) {
    const auto nodes = random_nodes(rng, 1 + i % 8);
    const SpectralTable table = spectral_table(static_cast<int>(nodes.size()) - 1, Rule::gauss);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const NodeState<double> x = at(nodes, table.nodes.points[k]);
      EXPECT_LT(distance(x.H, nodes[k].H), 1e-14);
      EXPECT_LT((x.V - nodes[k].V).norm(), 1e-13);
      EXPECT_LT((x.Vdot - nodes[k].Vdot).norm(), 1e-12);
    }
  }
}

TEST_P(Place, IsExactInARigidMotion) {
  Rng rng(2);
  for (int i = 0; i < 80; ++i) {
    auto nodes = random_nodes(rng, 1 + i % 8);
    const double xi = uniform(rng, -1, 1);
    const Pose<double> before = at(nodes, xi, false).H, G = random_pose(rng, 10.0);
    const Vec6 V = random_vector<6>(rng, 2.0), Vdot = random_vector<6>(rng, 5.0);  // in the frame G
    for (NodeState<double>& node : nodes) {
      const DualMatrix<double> Ad = adjoint_inverse(node.H);
      node = {G * node.H, Ad * V, Ad * Vdot};
    }
    const NodeState<double> x = at(nodes, xi);
    const DualMatrix<double> Ad = adjoint_inverse(before);
    EXPECT_LT(distance(x.H, G * before), 3e-14);
    EXPECT_LT((x.V - Ad * V).norm(), 1e-12);
    EXPECT_LT((x.Vdot - Ad * Vdot).norm(), 1e-11);
  }
}

// Nodes on H_k exp(t V_k + t^2/2 V_k'), whose velocity at t = 0 is V_k with the rate V_k'; Q of the place's
// motion H exp(Q) has the derivatives V and V' there.
TEST_P(Place, HasTheDerivativesOfItsPose) {
  Rng rng(3);
  for (int i = 0; i < 48; ++i) {
    const auto nodes = random_nodes(rng, 1 + i % 8);
    const double xi = uniform(rng, -1, 1);
    const NodeState<double> now = at(nodes, xi);
    const auto Q = [&](double t) -> Vec6 {
      auto then = nodes;
      for (NodeState<double>& node : then)
        node.H = node.H * exp_se3<double>(t * node.V + 0.5 * t * t * node.Vdot);
      return log_se3(relative(now.H, at(then, xi, false).H));
    };
    EXPECT_LT((now.V - first_difference(Q, 2e-3)).norm(), 1e-10);
    EXPECT_LT((now.Vdot - second_difference(Q, 4e-3)).norm(), 1e-7);
  }
}

// Elements bent as far as the metric allows from end to end are still interpolated: a record ends no run.
TEST_P(Place, IsFoundUpToTheLimitOfItsMetric) {
  Rng rng(4);
  for (int i = 0; i < 400; ++i) {
    const int order = 1 + i % 8;
    const Vec3 turn = uniform(rng, 0.9, 1.0) * GetParam().max_angle * random_direction(rng);
    const Vec3 stretch(uniform(rng, 0.2, 2.0), uniform(rng, -0.5, 0.5), uniform(rng, -0.5, 0.5));
    std::vector<NodeState<double>> nodes;
    for (const double xi : spectral_table(order, Rule::gauss).nodes.points) {
      // Unevenly: the turn is not proportional to xi.
      const double s = 0.5 * (1 + xi), u = s + 0.3 * s * (1 - s);
      nodes.push_back({exp_se3(six<double>(s * stretch, u * turn)), random_vector<6>(rng),
                       random_vector<6>(rng)});
    }
    for (const double xi : {-0.9, -0.3, 0.0, 0.5, 0.95}) {
      const NodeState<double> x = at(nodes, xi);
      EXPECT_TRUE(x.H.r.allFinite() && x.V.allFinite() && x.Vdot.allFinite());
      EXPECT_LT(std::abs(x.H.p.norm() - 1.0), 1e-13);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Of, Place, testing::ValuesIn(cases),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace mbd::test::test_beam_place
