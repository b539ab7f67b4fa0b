// The classical beam: the laws of laws.hpp, those of the gradient of an energy, and its interpolation.
#include <gtest/gtest.h>

#include "tests/elements/laws.hpp"

namespace {

using namespace mbd;
using namespace mbd::laws;

const BeamLaws classical = BeamLaws::classical();

TEST(ClassicalLaws, TangentIsTheDerivative) { classical.tangent_is_the_derivative(); }
TEST(ClassicalLaws, TangentFailsUnderMutation) { classical.tangent_fails_under_mutation(); }
TEST(ClassicalLaws, ResidualIsTheSameWithAndWithoutTangent) {
  classical.residual_is_the_same_with_and_without_tangent();
}
TEST(ClassicalLaws, Objectivity) { classical.objectivity(); }
TEST(ClassicalLaws, RigidMotionCostsNothing) { classical.rigid_motion_costs_nothing(); }
TEST(ClassicalLaws, FreeElementHasSixRigidMotions) { classical.rank(); }
TEST(ClassicalLaws, RangeIsEnforced) { classical.range(); }

// One rounding of a position is worth dphi = F dU, and K dU^2 at the reference, as in BeamLaws::objectivity.
TEST(ClassicalLaws, FixedAndRunTimeSizesAgree) {
  Worst force("force", 16), tangent("tangent", 32 * eps), energy("energy", 16);
  classical.sample(8, [&](Rng&, const Beam& b) {
    const BeamValue fixed = BeamSystem(b, false)(b.pose), run_time = BeamSystem(b, true)(b.pose);
    const double K = tangent_size(run_time.K, b.length), F = force_size(run_time.r, b.length);
    const double dU = eps * b.length;
    force.add(force_size(fixed.r - run_time.r, b.length) / (K * dU + eps * F), BeamLaws::name(b));
    tangent.add(tangent_error(fixed.K, run_time.K, b.length), BeamLaws::name(b));
    energy.add(
        std::abs(fixed.energy - run_time.energy) / ((F + K * dU) * dU + eps * run_time.energy),
        BeamLaws::name(b));
  });
}

// The interpolated curve itself, at xi on any scalar, and its strains by dual numbers in xi: no formula of
// the kernel but that of the interpolation. Coefficients from the Lagrange polynomials at a point and their
// derivatives there.
Vec6 curvature_by_dual_numbers(const std::vector<Pose<double>>& H, const VecX& l, const VecX& dl) {
  return curvature_of(
      [&](const D1& xi) {
        Vector3<D1> r = Vector3<D1>::Zero();
        Matrix<D1, 4, 1> p = Matrix<D1, 4, 1>::Zero();
        for (std::size_t k = 0; k < H.size(); ++k) {
          const auto K = static_cast<Index>(k);
          const D1 l_k = D1(l(K)) + D1(dl(K)) * D1(0.0, xi.d);
          const double sign = H[k].p.dot(H[0].p) < 0 ? -1.0 : 1.0;
          for (Index i = 0; i < 3; ++i) r(i) += l_k * D1(H[k].r(i));
          for (Index i = 0; i < 4; ++i) p(i) += l_k * D1(sign * H[k].p.coeffs()(i));
        }
        const D1 size = sqrt(p.squaredNorm());
        return Pose<D1>{Quaternion<D1>(p(3) / size, p(0) / size, p(1) / size, p(2) / size), r};
      },
      0.0);
}

struct Written {
  double energy = 0.0;
  std::vector<Vec6> S;  // sectional forces at the quadrature points
};
Written written(const Beam& b) {
  const SpectralTable t = spectral_table(b.order, b.rule);
  Written w;
  for (std::size_t i = 0; i < t.rule.points.size(); ++i) {
    const VecX l = lagrange(t.nodes.points, t.rule.points[i]);
    const VecX dl = lagrange_derivative(t.nodes.points, t.rule.points[i]);
    double J = 0;
    for (Index j = 0; j < l.size(); ++j) J += l(j) * b.J[static_cast<std::size_t>(j)];
    const Vec6 E =
        (curvature_by_dual_numbers(b.pose, l, dl) - curvature_by_dual_numbers(b.reference, l, dl)) /
        J;
    const Vec6 S = b.D[b.D.size() > 1 ? i : 0] * E;
    w.S.push_back(S);
    w.energy += 0.5 * t.rule.weights[i] * J * E.dot(S);
  }
  return w;
}

TEST(ClassicalLaws, EnergyAndSectionalForcesAreThoseOfTheInterpolation) {
  Worst energy("energy", 128), resultants("resultants", 128);
  double mutated = INFINITY;
  classical.sample(8, [&](Rng&, const Beam& b) {
    BeamSystem s(b, false);
    const BeamValue v = s(b.pose);
    const Written w = written(b);
    const double unit = eps * (tangent_size(v.K, b.length) * b.length + force_size(v.r, b.length));
    energy.add(std::abs(v.energy - w.energy) / (unit * b.length), BeamLaws::name(b));
    const SpectralTable t = spectral_table(b.order, b.rule);
    for (std::size_t i = 0; i < w.S.size(); ++i)
      resultants.add(force_size(s.resultants(b.pose, t.rule.points[i]) - w.S[i], b.length) / unit,
                     BeamLaws::name(b));
    if (v.energy > 1e6 * unit * b.length) {
      Beam mutant = b;
      for (Mat6& D : mutant.D) D(1, 1) *= 1.1;
      mutated = std::min(mutated, std::abs(v.energy - written(mutant).energy) / (unit * b.length));
    }
  });
  EXPECT_GT(mutated, 512) << "D 10 % off in one entry may pass unnoticed";
}

TEST(ClassicalLaws, ForceIsTheGradientOfTheEnergy) {
  Worst error("error", 64);
  double mutated = INFINITY;
  classical.sample(8, [&](Rng&, const Beam& b) {
    const BeamValue v = BeamSystem(b, false)(b.pose);
    const double unit = eps * (tangent_size(v.K, b.length) * b.length + force_size(v.r, b.length));
    const VecX gradient = dual_energy_gradient(b);
    error.add(force_size(v.r - gradient, b.length) / unit, BeamLaws::name(b));
    Beam mutant = b;
    for (Mat6& D : mutant.D) D(1, 1) *= 1.1;
    const VecX other = dual_energy_gradient(mutant);
    if (force_size(v.r, b.length) / unit > 1e6)
      mutated = std::min(mutated, force_size(v.r - other, b.length) / unit);
  });
  EXPECT_GT(mutated, 1e3) << "D 10 % off in one entry may pass unnoticed";
}

TEST(ClassicalLaws, ForcesAreSelfEquilibrated) {
  Worst error("error", 64);
  double mutated = INFINITY;
  classical.sample(16, [&](Rng&, const Beam& b) {
    BeamSystem s(b, false);
    const BeamValue v = s(b.pose);
    const double unit = eps * (force_size(v.r, b.length) + tangent_size(v.K, b.length) * b.length);
    error.add(force_size(resultant(v.r, b.pose), b.length) / unit, BeamLaws::name(b));
    // the last node's force 10 % off
    VecX wrong = v.r;
    wrong.tail<6>() *= 1.1;
    if (force_size(v.r.tail<6>(), b.length) > 1e6 * unit)
      mutated = std::min(mutated, force_size(resultant(wrong, b.pose), b.length) / unit);
  });
  EXPECT_GT(mutated, 1e3);
}

// K - K^T = blockdiag(F^U) at any state; symmetric where the force is zero.
TEST(ClassicalLaws, TangentIsSymmetricButForTheFrames) {
  Worst any("any_state", 64 * eps), unstressed("unstressed", 64 * eps);
  double mutated = 0;
  classical.sample(8, [&](Rng&, const Beam& b) {
    BeamSystem s(b, false);
    const BeamValue v = s(b.pose), v0 = s(b.reference);
    const double size = tangent_size(v.K, b.length);
    any.add(tangent_size(v.K - v.K.transpose() - skew_part(v.r), b.length) / size,
            BeamLaws::name(b));
    unstressed.add(tangent_size(v0.K - v0.K.transpose(), b.length) / size, BeamLaws::name(b));
    mutated = std::max(mutated, tangent_size(v.K - v.K.transpose(), b.length) / size);
  });
  EXPECT_GT(mutated, 1e-3) << "the law says nothing about these states";
}

// The same element from its other end: section axes turned by pi about b3, and the list of nodes reversed.
// The same energy, so nothing hangs on node 0 being the one that chooses the signs.
TEST(ClassicalLaws, NeitherEndIsTheFirst) {
  Worst error("error", 64);
  double mutated = INFINITY;
  Mat6 flip = Mat6::Zero();
  flip.diagonal() << -1, -1, 1, -1, -1, 1;
  // E of the reversed curve: t changes sign with d/ds and is turned, so -flip E
  const Quaternion<double> turn(0, 0, 0, 1);
  classical.sample(8, [&](Rng&, const Beam& b) {
    Beam r = b;
    std::reverse(r.J.begin(), r.J.end());
    for (auto* H : {&r.reference, &r.pose}) {
      std::reverse(H->begin(), H->end());
      for (auto& one : *H) one.p = one.p * turn;
    }
    std::reverse(r.D.begin(), r.D.end());
    for (Mat6& D : r.D) D = flip * D * flip;
    BeamSystem s(b, false);
    const BeamValue v = s(b.pose);
    const double unit = eps * (tangent_size(v.K, b.length) * b.length + force_size(v.r, b.length));
    const double reversed = BeamSystem(r, false).energy(r.pose);
    error.add(std::abs(reversed - v.energy) / (unit * b.length), BeamLaws::name(b));
    for (Mat6& D : r.D) D(2, 2) *= 1.1;
    if (v.energy > 1e6 * unit * b.length)
      mutated = std::min(
          mutated, std::abs(BeamSystem(r, false).energy(r.pose) - v.energy) / (unit * b.length));
  });
  EXPECT_GT(mutated, 512) << "D 10 % off in one entry may pass unnoticed";
}

TEST(ClassicalLaws, EnergyConvergesToTheContinuum) {
  classical.energy_converges_to_the_continuum();
}

// Three nodes turned by 120 degrees from one to the next, the last so that it is also 120 from the first: no
// pair is beyond the limit, but the turn along the element is.
TEST(Classical, AWholeTurnWithinAnElementIsOutOfRange) {
  Rng rng(5);
  Beam b = classical.random(rng, Rule::gauss, 2, 0.1);
  for (std::size_t k = 0; k < 3; ++k)
    b.pose[k].p = test::rotation(static_cast<double>(k) * 2 * std::numbers::pi / 3, Vec3::UnitZ());
  EXPECT_LT(max_angle(b.pose), 0.7 * std::numbers::pi);
  EXPECT_FALSE(BeamSystem(b, false)(b.pose).in_range);
  for (std::size_t k = 0; k < 3; ++k)
    b.pose[k].p = test::rotation(static_cast<double>(k) * 1.0, Vec3::UnitZ());
  EXPECT_TRUE(BeamSystem(b, false)(b.pose).in_range);
}

}  // namespace
