// The energy form of the beam: the laws of laws.hpp, and those that only the gradient of an energy obeys.
#include <gtest/gtest.h>

#include "tests/elements/laws.hpp"

namespace {

using namespace mbd;
using namespace mbd::laws;

template <class M>
struct ElasticEnergyLaws : testing::Test {
  using Laws = BeamLaws<M, beam::EnergyForm>;
  using DualKernel = DualBeam<M, beam::EnergyForm>;
};
using Metrics = testing::Types<MatrixMetric, QuaternionMetric, GeodesicMetric>;
TYPED_TEST_SUITE(ElasticEnergyLaws, Metrics);

TYPED_TEST(ElasticEnergyLaws, ForceIsAsWritten) { TestFixture::Laws::force_is_as_written(); }
TYPED_TEST(ElasticEnergyLaws, TangentIsTheDerivative) {
  TestFixture::Laws::tangent_is_the_derivative();
}
TYPED_TEST(ElasticEnergyLaws, TangentFailsUnderMutation) {
  TestFixture::Laws::tangent_fails_under_mutation();
}
TYPED_TEST(ElasticEnergyLaws, ResidualIsTheSameWithAndWithoutTangent) {
  TestFixture::Laws::residual_is_the_same_with_and_without_tangent();
}
TYPED_TEST(ElasticEnergyLaws, FixedAndRunTimeSizesAgree) { TestFixture::Laws::sizes_agree(); }
TYPED_TEST(ElasticEnergyLaws, Objectivity) { TestFixture::Laws::objectivity(); }
TYPED_TEST(ElasticEnergyLaws, RigidMotionCostsNothing) {
  TestFixture::Laws::rigid_motion_costs_nothing();
}
TYPED_TEST(ElasticEnergyLaws, FreeElementHasSixRigidMotions) { TestFixture::Laws::rank(); }
TYPED_TEST(ElasticEnergyLaws, RangeIsEnforced) { TestFixture::Laws::range(); }

TYPED_TEST(ElasticEnergyLaws, ForceIsTheGradientOfTheEnergy) {
  Worst error("error", 32);
  double mutated = INFINITY;
  TestFixture::Laws::sample(8, [&](Rng&, const Beam& b) {
    const BeamValue v = BeamSystem(b, false)(b.pose);
    const double unit = eps * (tangent_size(v.K, b.length) * b.length + force_size(v.r, b.length));
    const VecX gradient = typename TestFixture::DualKernel(b).energy_gradient(b.pose);
    error.add(force_size(v.r - gradient, b.length) / unit, TestFixture::Laws::name(b));
    Beam mutant = b;
    for (Mat6& D : mutant.D) D(1, 1) *= 1.1;
    const VecX other = typename TestFixture::DualKernel(mutant).energy_gradient(b.pose);
    const double strained = force_size(v.r, b.length) / unit;
    if (strained > 1e6) mutated = std::min(mutated, force_size(v.r - other, b.length) / unit);
  });
  EXPECT_GT(mutated, 1e3) << "D 10 % off in one entry may pass unnoticed";
}

// Work along a finite motion H_k exp(tau U_k) is the difference of the energies: dphi/dt = F.V.
TYPED_TEST(ElasticEnergyLaws, PowerBalance) {
  Worst error("error", 64);
  double mutated = INFINITY;
  const Quadrature rule = gauss_rule(16);
  TestFixture::Laws::sample(4, [&](Rng& rng, const Beam& b) {
    BeamSystem s(b, false);
    Beam mutant = b;
    for (Mat6& D : mutant.D) D(1, 1) *= 1.1;
    BeamSystem other(mutant, false);
    std::vector<Vec6> U;
    for (std::size_t k = 0; k < b.pose.size(); ++k) {
      U.push_back(test::random_vector<6>(rng, 0.05 * std::min(1.0, max_angle(b.pose))));
      U.back().template head<3>() *= b.length;
    }
    const auto at = [&](double tau) {
      std::vector<Pose<double>> H = b.pose;
      for (std::size_t k = 0; k < H.size(); ++k) H[k] = H[k] * exp_se3<double>(tau * U[k]);
      return H;
    };
    const double start = 0.0, end = -0.5;
    double work = 0, gross = 0, other_work = 0;
    for (std::size_t i = 0; i < rule.points.size(); ++i) {
      const auto H = at(0.5 * (start + end) + 0.5 * (end - start) * rule.points[i]);
      const VecX F = s.residual(H), F_other = other.residual(H);
      for (std::size_t k = 0; k < U.size(); ++k) {
        const double weight = 0.5 * (end - start) * rule.weights[i];
        const double power = weight * F.segment<6>(6 * static_cast<Index>(k)).dot(U[k]);
        work += power;
        gross += std::abs(power);
        other_work += weight * F_other.segment<6>(6 * static_cast<Index>(k)).dot(U[k]);
      }
    }
    // round-off: of the work, of the energies, and of the positions in the energies
    const double K = tangent_size(s(b.pose).K, b.length);
    const double size = s.energy(at(start)) + s.energy(at(end)) + gross;
    const double unit = eps * (size + std::sqrt(size * K) * b.length);
    const double difference = s.energy(at(end)) - s.energy(at(start));
    error.add(std::abs(work - difference) / unit, TestFixture::Laws::name(b));
    if (max_angle(b.pose) > 1e-3)
      mutated = std::min(mutated, std::abs(other_work - difference) / unit);
  });
  EXPECT_GT(mutated, 1e3) << "D 10 % off in one entry may pass unnoticed";
}

TYPED_TEST(ElasticEnergyLaws, ForcesAreSelfEquilibrated) {
  Worst error("error", 64);
  TestFixture::Laws::sample(16, [&](Rng&, const Beam& b) {
    const BeamValue v = BeamSystem(b, false)(b.pose);
    error.add(force_size(resultant(v.r, b.pose), b.length) / (eps * force_size(v.r, b.length)),
              TestFixture::Laws::name(b));
  });
}

// K - K^T = blockdiag(F^U) at any state; symmetric where the force is zero.
TYPED_TEST(ElasticEnergyLaws, TangentIsSymmetricButForTheFrames) {
  Worst any("any_state", 64 * eps), unstressed("unstressed", 64 * eps);
  double mutated = 0;
  TestFixture::Laws::sample(8, [&](Rng&, const Beam& b) {
    BeamSystem s(b, false);
    const BeamValue v = s(b.pose), v0 = s(b.reference);
    const double size = tangent_size(v.K, b.length);
    any.add(tangent_size(v.K - v.K.transpose() - skew_part(v.r), b.length) / size,
            TestFixture::Laws::name(b));
    unstressed.add(tangent_size(v0.K - v0.K.transpose(), b.length) / size,
                   TestFixture::Laws::name(b));
    mutated = std::max(mutated, tangent_size(v.K - v.K.transpose(), b.length) / size);
  });
  EXPECT_GT(mutated, 1e-3) << "the law says nothing about these states";
}

TEST(ElasticEnergy, RollsUpExactly) {
  BeamLaws<GeodesicMetric, beam::EnergyForm>::rolls_up_exactly();
}

// The energy of a smooth strained curve, order 2N in the size of the elements.
TYPED_TEST(ElasticEnergyLaws, EnergyConvergesToTheContinuum) {
  Rng rng(32);
  const Mat6 D = test::random_spd(rng, 1.0, 1.0);
  const auto energy_of = [](const Mat6& stiffness) {
    double sum = 0;
    const Quadrature q = gauss_rule(40);
    for (std::size_t i = 0; i < q.points.size(); ++i) {
      const double s = 0.5 * (1 + q.points[i]);
      const Vec6 E = curvature_of([](const D1& x) { return smooth_pose(x); }, s) -
                     curvature_of([](const D1& x) { return smooth_reference(x); }, s);
      sum += 0.25 * q.weights[i] * E.dot(stiffness * E);
    }
    return sum;
  };
  Mat6 mutant = D;
  mutant(1, 1) *= 1.1;
  const double exact = energy_of(D);
  EXPECT_GT(std::abs(energy_of(mutant) / exact - 1), 1e-3);
  for (int order = 1; order <= 4; ++order) {
    const auto error = [&](int elements) {
      double sum = 0;
      for (int e = 0; e < elements; ++e) {
        const Beam b = smooth_element(metric_of<TypeParam>(), Form::energy, order, e, elements, D);
        sum += BeamSystem(b, false).energy(b.pose);
      }
      return std::abs(sum / exact - 1);
    };
    const double coarse = error(8), fine = error(16), slope = std::log2(coarse / fine);
    EXPECT_NEAR(slope, 2 * order, 0.15) << "N = " << order << ", error " << fine;
    EXPECT_LT(fine, 0.01);
    this->RecordProperty("slope" + std::to_string(order), testing::PrintToString(slope));
  }
}

}  // namespace
