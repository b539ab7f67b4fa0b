// The rods of support/path_references.hpp against numbers from elsewhere: limit and bifurcation points, to be
// compared with the library's paths. Every tolerance is shown to see 10 % of what the number depends on.
//
// Measured: 12 and 24 steps of the integration agree to 1e-10 in all loads (deep arch: 4e-9).
#include <gtest/gtest.h>

#include "tests/support/path_references.hpp"

namespace mbd::test::test_path_references {
namespace {

using Eigen::VectorXd;
using std::numbers::pi;

double relative(double x, double reference) { return std::abs(x / reference - 1); }
double distance(const LoadedPoint& p, double u1, double u2) {
  return std::hypot(p.u1 - u1, p.u2 - u2);
}

// From the state without load, the first points where an event changes its sign.
template <class F, class Event>
std::vector<LoadedPoint> points(const F& f, Eigen::Index unknowns, double step, int count,
                                const Event& event) {
  const EquilibriumPath<F> path(f);
  PathPoint p =
      path.at(VectorXd::Zero(unknowns), unknowns - 1, VectorXd::Unit(unknowns, unknowns - 1));
  std::vector<LoadedPoint> found;
  while (count-- > 0) {
    const PathPoint here = path.find(p, step, 1000, event);
    found.push_back(f.loaded_point(here));
    p = path.step(here, 0.02 * step);
  }
  return found;
}

// A cantilever under a transverse force, shear and extension left out by D^-1 = diag(0, 0, 0, 1, 1, 1):
// Bisshopp, Drucker, Large deflection of cantilever beams (1945), by elliptic integrals. With theta the
// angle of the tip, k^2 = (1 + sin theta)/2, sin phi = 1/(k sqrt 2), a^2 = P L^2/EI:
//   a = K - F(phi),  deflection/L = 1 - 2 (E - E(phi))/a,  1 - shortening/L = sqrt(2 sin theta)/a
// Order 12: a step less than half as long is a thousandth of the error and less.
TEST(RodPath, ElasticaByEllipticIntegrals) {
  for (const double theta : {0.4, 0.9, 1.3}) {
    const double k = std::sqrt((1 + std::sin(theta)) / 2), phi = std::asin(1 / (k * std::sqrt(2)));
    const double a = std::comp_ellint_1(k) - std::ellint_1(k, phi);
    const double deflection = 1 - 2 / a * (std::comp_ellint_2(k) - std::ellint_2(k, phi)),
                 length = std::sqrt(2 * std::sin(theta)) / a;
    std::vector<double> error;
    for (const int steps : {1, 3, 12}) {
      RodPiece piece{1, RodMatrix::Zero(), 0, steps};
      piece.compliance.bottomRightCorner<3, 3>().setIdentity();
      RodSection<double> root;
      root.n << 0, a * a, 0;
      root.m << 0, 0, a * a * length;
      const RodSection<double> tip = integrate(piece, root);
      error.push_back((tip.r - Eigen::Vector3d(length, deflection, 0)).norm() + tip.m.norm() +
                      std::abs(std::asin(tip.R(1, 0)) - theta));
    }
    EXPECT_LT(error[2], 1e-12) << theta;  // round-off of a, 5e-13 in the largest
    if (theta > 0.8) {
      EXPECT_LT(error[1], 1e-3 * error[0]) << theta;
    }
  }
}

// Lee, Manuel, Rossow; the numbers of a calculation of its own (scenes, B).
TEST(LeeFrameReferenceSlow, LimitPoints) {
  LeeFrame frame;
  const auto limits = points(frame, 4, 0.2, 2, limit_event);
  EXPECT_NEAR(limits[0].P, 18556.7, 0.05);
  EXPECT_LT(distance(limits[0], 26.881, -48.735), 1e-3);
  EXPECT_NEAR(limits[1].P, -9414.4, 0.05);
  EXPECT_LT(distance(limits[1], 90.196, -58.217), 1e-3);
  // Shear: what it takes off the load falls with 1/GA, to 2e-7 of it at GA = 1e3 EA.
  std::vector<double> P;
  for (const double ratio : {10.0, 100.0}) {
    frame.GA = ratio * frame.EA;
    P.push_back(points(frame, 4, 0.2, 1, limit_event)[0].P);
  }
  EXPECT_NEAR((limits[0].P - P[0]) / (limits[0].P - P[1]), (100 - 1) / (10 - 1.0), 0.05);
  EXPECT_LT(relative(P[1], limits[0].P), 2e-6);
  frame = {};
  frame.EI *= 1.1;
  EXPECT_GT(points(frame, 4, 0.2, 1, limit_event)[0].P - 18556.7, 1000);
}

// DaDeppo, Schmidt (models/arch.xml); the numbers of a calculation of its own, which finds the arch leave its
// plane near P = 243.9, |u| = 14.57.
TEST(DeepArchReferenceSlow, LimitPoints) {
  CircularArch arch;
  const auto limits = points(arch, 4, 0.4, 2, limit_event);
  EXPECT_NEAR(limits[0].P, 897.289134, 1e-5);
  EXPECT_NEAR(std::hypot(limits[0].u1, limits[0].u2), 129.12394, 1e-5);
  EXPECT_LT(distance(limits[0], 61.141, -113.730), 2e-3);
  EXPECT_NEAR(limits[1].P, -73.04876, 1e-5);
  EXPECT_NEAR(std::hypot(limits[1].u1, limits[1].u2), 134.74696, 1e-5);
  arch.EI *= 1.1;
  EXPECT_GT(points(arch, 4, 0.4, 1, limit_event)[0].P - 897.289134, 10);
}
// P = -17.8 is crossed at |u| = 133.0793, falling, and 148.68, rising: the paper's point. 12, 24 and 48 steps give 133.07929.
TEST(DeepArchReferenceSlow, PointsBetweenTheLimits) {
  const CircularArch arch;
  const auto crossings =
      points(arch, 4, 0.4, 2, [&](const PathPoint& p) { return arch.loaded_point(p).P + 17.8; });
  EXPECT_NEAR(std::hypot(crossings[0].u1, crossings[0].u2), 133.0793, 1e-4);
  EXPECT_NEAR(std::hypot(crossings[1].u1, crossings[1].u2), 148.68, 0.005);
}
TEST(DeepArchReferenceSlow, LeavesItsPlane) {
  CircularArch arch;
  const auto buckles = [&arch] {
    return points(arch, 4, 0.2, 1, [&](const PathPoint& p) { return arch.sideways(p); })[0];
  };
  const LoadedPoint p = buckles();
  EXPECT_NEAR(p.P, 243.9, 0.05);
  EXPECT_NEAR(p.P, 243.9292058, 1e-6);  // this calculation
  EXPECT_NEAR(std::hypot(p.u1, p.u2), 14.57, 0.01);
  arch.GJ *= 1.1;
  EXPECT_GT(buckles().P - p.P, 1);
}

// Symmetric limit points and asymmetric bifurcations of a shallow arch. Two calculations: half the arch in
// its symmetry, and the whole. The bifurcation of a slender one against Pi, Bradford, Uy, In-plane stability
// of arches (2002): at a thrust of pi^2 EI/(half the length)^2, which neglects strains beside one.
TEST(ShallowArchReferenceSlow, SymmetricLimitOfAThickOne) {
  SymmetricArch half;
  half.arch.EI = half.arch.GJ = 1e8;
  half.arch.force = 1e6;
  CircularArch whole = half.arch;
  const auto limits = points(half, 3, 0.1, 2, limit_event);
  EXPECT_NEAR(limits[0].P, 193950.1924, 1e-3);  // this calculation
  EXPECT_NEAR(limits[0].u2, -2.0349289889, 1e-8);
  EXPECT_NEAR(limits[1].P, 42743.5957, 1e-3);
  EXPECT_NEAR(limits[1].u2, -5.2600492350, 1e-8);
  const auto same = points(whole, 4, 0.1, 2, limit_event);
  EXPECT_LT(relative(same[0].P, limits[0].P), 1e-9);
  EXPECT_LT(relative(same[1].P, limits[1].P), 1e-8);
  EXPECT_LT(distance(same[0], limits[0].u1, limits[0].u2), 1e-6);
  // It never leaves its symmetry, up to where it hangs below its feet and carries more than ever.
  const EquilibriumPath<SymmetricArch> path(half);
  PathPoint p = path.at(VectorXd::Zero(3), 2, VectorXd::Unit(3, 2));
  const auto leaves = [&](const PathPoint& x) { return half.antisymmetric(x); };
  EXPECT_THROW(path.find(p, 0.1, 60, leaves), std::runtime_error);
  EXPECT_GT(half.loaded_point(p).P, 2 * limits[0].P);
  EXPECT_LT(half.loaded_point(p).u2, -7);
  half.arch.EI *= 1.1;
  EXPECT_GT(relative(points(half, 3, 0.1, 1, limit_event)[0].P, limits[0].P), 0.02);
}
TEST(ShallowArchReferenceSlow, AsymmetricBifurcationOfASlenderOne) {
  SymmetricArch half;  // EI = 1e6
  half.arch.force = 1e4;
  const auto first = [&half](const auto& event) {
    const EquilibriumPath<SymmetricArch> path(half);
    PathPoint p = path.at(VectorXd::Zero(3), 2, VectorXd::Unit(3, 2));
    return path.find(p, 0.1, 100, event);
  };
  const auto leaves = [&half](const PathPoint& p) { return half.antisymmetric(p); };
  const PathPoint branch = first(leaves), limit = first(limit_event);
  const LoadedPoint at = half.loaded_point(branch);
  EXPECT_NEAR(at.P, 4445.378236, 1e-5);  // this calculation
  EXPECT_NEAR(at.u2, -0.8068882016, 1e-8);
  EXPECT_NEAR(half.loaded_point(limit).P, 5116.210350, 1e-5);
  EXPECT_LT(branch.load(), limit.load()) << "before the limit point";
  const double S = half.arch.radius * half.arch.angle / 2;
  EXPECT_LT(relative(half.thrust(branch), pi * pi * half.arch.EI / (S * S)), 0.005);
  half.arch.EI *= 1.1;
  EXPECT_GT(relative(half.loaded_point(first(leaves)).P, at.P), 0.08);
}

// Argyris et al. (1979), Simo, Vu-Quoc (1986): 1.088 N, the load along the first leg and away from the
// clamp. It is reached with the torsion of a thin strip, w t^3/3; with 1 - 0.63 t/w of it the load is 1.0841.
TEST(RightAngleFrameReference, LeavesItsPlane) {
  RightAngleFrame frame;
  const auto buckles = [&frame](const Eigen::Vector3d& direction) {
    frame.direction = direction;
    const EquilibriumPath<RightAngleFrame> path(frame);
    PathPoint p = path.at(VectorXd::Zero(2), 1, VectorXd::Unit(2, 1));
    return path.find(p, 0.1, 200, [&](const PathPoint& x) { return frame.sideways(x); }).load();
  };
  const double P = buckles(Eigen::Vector3d(1, 0, 0));
  EXPECT_NEAR(P, 1.088, 0.001);
  EXPECT_NEAR(P, 1.087517841, 1e-8);  // this calculation
  EXPECT_NEAR(buckles(Eigen::Vector3d(-1, 0, 0)), 0.6804273623, 1e-8);
  // along the second leg: pulled, pressed
  EXPECT_NEAR(buckles(Eigen::Vector3d(0, 1, 0)), 3.979483882, 1e-8);
  EXPECT_NEAR(buckles(Eigen::Vector3d(0, -1, 0)), 0.6507651634, 1e-8);
  frame.torsion *= 0.9;
  EXPECT_GT(relative(buckles(Eigen::Vector3d(1, 0, 0)), P), 0.01);
  frame = {};
  frame.thickness *= 1.1;
  EXPECT_GT(relative(buckles(Eigen::Vector3d(1, 0, 0)), P), 0.1);
}

}  // namespace
}  // namespace mbd::test::test_path_references
