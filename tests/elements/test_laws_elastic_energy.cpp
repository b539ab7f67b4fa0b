// The energy form of the beam: the laws of laws.hpp, and those that only the gradient of an energy obeys.
#include <gtest/gtest.h>

#include "tests/elements/laws.hpp"

namespace {

using namespace mbd;
using namespace mbd::laws;

const auto metrics = testing::Values(Metric::matrix, Metric::quaternion, Metric::geodesic);

struct ElasticEnergyLaws : testing::TestWithParam<Metric> {
  const BeamLaws laws{GetParam(), Form::energy};
};
INSTANTIATE_TEST_SUITE_P(Every, ElasticEnergyLaws, metrics, metric_name);

TEST_P(ElasticEnergyLaws, ForceIsAsWritten) { laws.force_is_as_written(); }
TEST_P(ElasticEnergyLaws, TangentIsTheDerivative) { laws.tangent_is_the_derivative(); }
TEST_P(ElasticEnergyLaws, TangentFailsUnderMutation) { laws.tangent_fails_under_mutation(); }
TEST_P(ElasticEnergyLaws, ResidualIsTheSameWithAndWithoutTangent) {
  laws.residual_is_the_same_with_and_without_tangent();
}
TEST_P(ElasticEnergyLaws, FixedAndRunTimeSizesAgree) { laws.sizes_agree(); }
TEST_P(ElasticEnergyLaws, Objectivity) { laws.objectivity(); }
TEST_P(ElasticEnergyLaws, RigidMotionCostsNothing) { laws.rigid_motion_costs_nothing(); }
TEST_P(ElasticEnergyLaws, FreeElementHasSixRigidMotions) { laws.rank(); }
TEST_P(ElasticEnergyLaws, RangeIsEnforced) { laws.range(); }

TEST_P(ElasticEnergyLaws, ForceIsTheGradientOfTheEnergy) {
  Worst error("error", 32);
  double mutated = INFINITY;
  laws.sample(8, [&](Rng&, const Beam& b) {
    const BeamValue v = BeamSystem(b, false)(b.pose);
    const double unit = eps * (tangent_size(v.K, b.length) * b.length + force_size(v.r, b.length));
    const VecX gradient = dual_energy_gradient(b);
    error.add(force_size(v.r - gradient, b.length) / unit, BeamLaws::name(b));
    Beam mutant = b;
    for (Mat6& D : mutant.D) D(1, 1) *= 1.1;
    const VecX other = dual_energy_gradient(mutant);
    const double strained = force_size(v.r, b.length) / unit;
    if (strained > 1e6) mutated = std::min(mutated, force_size(v.r - other, b.length) / unit);
  });
  EXPECT_GT(mutated, 1e3) << "D 10 % off in one entry may pass unnoticed";
}

// Work along a finite motion H_k exp(tau U_k) is the difference of the energies: dphi/dt = F.V.
TEST_P(ElasticEnergyLaws, PowerBalance) {
  Worst error("error", 64);
  double mutated = INFINITY;
  const Quadrature rule = gauss_rule(16);
  laws.sample(4, [&](Rng& rng, const Beam& b) {
    BeamSystem s(b, false);
    Beam mutant = b;
    for (Mat6& D : mutant.D) D(1, 1) *= 1.1;
    BeamSystem other(mutant, false);
    std::vector<Vec6> U;
    for (std::size_t k = 0; k < b.pose.size(); ++k) {
      U.push_back(test::random_vector<6>(rng, 0.05 * std::min(1.0, max_angle(b.pose))));
      U.back().head<3>() *= b.length;
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
    error.add(std::abs(work - difference) / unit, BeamLaws::name(b));
    if (max_angle(b.pose) > 1e-3)
      mutated = std::min(mutated, std::abs(other_work - difference) / unit);
  });
  EXPECT_GT(mutated, 1e3) << "D 10 % off in one entry may pass unnoticed";
}

TEST_P(ElasticEnergyLaws, ForcesAreSelfEquilibrated) {
  Worst error("error", 64);
  laws.sample(16, [&](Rng&, const Beam& b) {
    const BeamValue v = BeamSystem(b, false)(b.pose);
    error.add(force_size(resultant(v.r, b.pose), b.length) / (eps * force_size(v.r, b.length)),
              BeamLaws::name(b));
  });
}

// K - K^T = blockdiag(F^U) at any state; symmetric where the force is zero.
TEST_P(ElasticEnergyLaws, TangentIsSymmetricButForTheFrames) {
  Worst any("any_state", 64 * eps), unstressed("unstressed", 64 * eps);
  double mutated = 0;
  laws.sample(8, [&](Rng&, const Beam& b) {
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

TEST(ElasticEnergy, RollsUpExactly) { BeamLaws(Metric::geodesic, Form::energy).rolls_up_exactly(); }

TEST_P(ElasticEnergyLaws, EnergyConvergesToTheContinuum) {
  laws.energy_converges_to_the_continuum();
}

}  // namespace
