// The paper's form of the beam: the laws of laws.hpp; and those of the energy form, which it obeys only in
// the limit of fine meshes.
#include <gtest/gtest.h>

#include "tests/elements/laws.hpp"

namespace {

using namespace mbd;
using namespace mbd::laws;

const auto metrics = testing::Values(Metric::matrix, Metric::quaternion, Metric::geodesic);

struct ElasticPaperLaws : testing::TestWithParam<Metric> {
  const BeamLaws laws{GetParam(), Form::paper};
};
INSTANTIATE_TEST_SUITE_P(Every, ElasticPaperLaws, metrics, metric_name);

TEST_P(ElasticPaperLaws, ForceIsAsWritten) { laws.force_is_as_written(); }
TEST_P(ElasticPaperLaws, TangentIsTheDerivative) { laws.tangent_is_the_derivative(); }
TEST_P(ElasticPaperLaws, TangentFailsUnderMutation) { laws.tangent_fails_under_mutation(); }
TEST_P(ElasticPaperLaws, ResidualIsTheSameWithAndWithoutTangent) {
  laws.residual_is_the_same_with_and_without_tangent();
}
TEST_P(ElasticPaperLaws, FixedAndRunTimeSizesAgree) { laws.sizes_agree(); }
TEST_P(ElasticPaperLaws, Objectivity) { laws.objectivity(); }
TEST_P(ElasticPaperLaws, RigidMotionCostsNothing) { laws.rigid_motion_costs_nothing(); }
TEST_P(ElasticPaperLaws, FreeElementHasSixRigidMotions) { laws.rank(); }
TEST_P(ElasticPaperLaws, RangeIsEnforced) { laws.range(); }

TEST(ElasticPaper, RollsUpExactly) { BeamLaws(Metric::geodesic, Form::paper).rolls_up_exactly(); }

// --- refinement, on a smooth curve ---

struct Defects {
  double work = 0;  // of the forces, less dphi of the energy form, on smooth fields / largest dphi
  double balance =
      0;  // largest resultant of an element's forces about its first node / largest end force
  double symmetry =
      0;  // of the tangent's bilinear form on smooth fields, less F.(xi~ eta) / largest
};

// `mutation` is a factor on one entry of D in the paper's form only.
Defects defects(Metric metric, int order, int elements, double mutation = 1.0) {
  constexpr int fields = 4;
  Rng rng(31);
  const Mat6 D = test::random_spd(rng, 1.0, 1.0);
  Mat6 D_paper = D;
  D_paper(1, 1) *= mutation;
  VecX work = VecX::Zero(fields), gradient = VecX::Zero(fields);
  MatrixXd skew = MatrixXd::Zero(fields, fields), size = skew;
  Defects d;
  double end_force = 0;
  for (int e = 0; e < elements; ++e) {
    const Beam b = smooth_element(metric, Form::paper, order, e, elements, D_paper);
    const Beam energy = smooth_element(metric, Form::energy, order, e, elements, D);
    const std::vector<double> nodes = gauss_lobatto_rule(order + 1).points;
    MatrixXd eta(6 * (order + 1), fields);
    for (int k = 0; k <= order; ++k)
      for (int n = 0; n < fields; ++n)
        eta.block<6, 1>(6 * k, n) =
            smooth_field(n, (e + 0.5 * (1 + nodes[static_cast<std::size_t>(k)])) / elements);
    const BeamValue v = BeamSystem(b, false)(b.pose);
    work += eta.transpose() * v.r;
    gradient += eta.transpose() * BeamSystem(energy, false).residual(b.pose);
    const MatrixXd a = eta.transpose() * v.K * eta;
    skew += a - a.transpose() - eta.transpose() * skew_part(v.r) * eta;
    size += a.cwiseAbs();
    d.balance = std::max(d.balance, resultant(v.r, b.pose).cwiseAbs().maxCoeff());
    end_force = std::max(end_force, v.r.head<6>().cwiseAbs().maxCoeff());
  }
  d.work = (work - gradient).cwiseAbs().maxCoeff() / gradient.cwiseAbs().maxCoeff();
  d.balance /= end_force;
  d.symmetry = skew.cwiseAbs().maxCoeff() / size.maxCoeff();
  return d;
}

struct ElasticPaperRefinement : testing::TestWithParam<Metric> {};
INSTANTIATE_TEST_SUITE_P(Every, ElasticPaperRefinement, metrics, metric_name);

// Gradient of an energy, symmetric tangent: to order 2N. Self-equilibrium of an element: to order 2N + 1.
TEST_P(ElasticPaperRefinement, ObeysTheLawsOfTheEnergyFormInTheLimit) {
  for (int order = 1; order <= 4; ++order) {
    const Defects coarse = defects(GetParam(), order, 8), fine = defects(GetParam(), order, 16);
    const double work = std::log2(coarse.work / fine.work),
                 balance = std::log2(coarse.balance / fine.balance);
    const double symmetry = std::log2(coarse.symmetry / fine.symmetry);
    EXPECT_NEAR(work, 2 * order, 0.25) << "N = " << order << ", error " << fine.work;
    EXPECT_NEAR(symmetry, 2 * order, 0.25) << "N = " << order << ", error " << fine.symmetry;
    EXPECT_NEAR(balance, 2 * order + 1, 0.4) << "N = " << order << ", error " << fine.balance;
    EXPECT_LT(std::max({fine.work, fine.balance, fine.symmetry}), 0.01);
    RecordProperty("slopes" + std::to_string(order),
                   testing::PrintToString(std::tuple(work, balance, symmetry)));
  }
}

TEST_P(ElasticPaperRefinement, FailsUnderMutation) {
  for (int order = 1; order <= 4; ++order) {
    const Metric metric = GetParam();
    const double coarse = defects(metric, order, 8, 1.1).work,
                 fine = defects(metric, order, 16, 1.1).work;
    EXPECT_LT(std::log2(coarse / fine), 1.0) << order;  // 2N wanted
  }
  // and on one element at a large random state none of the laws of the energy form holds
  Rng rng(33);
  double balance = 0, symmetry = 0;
  for (int i = 0; i < 10; ++i) {
    const BeamLaws laws(GetParam(), Form::paper);
    const Beam b = laws.random(rng, Rule::gauss, 3, 0.5 * laws.largest_angle());
    const BeamValue v = BeamSystem(b, false)(b.pose), v0 = BeamSystem(b, false)(b.reference);
    balance =
        std::max(balance, force_size(resultant(v.r, b.pose), b.length) / force_size(v.r, b.length));
    symmetry = std::max(symmetry, tangent_error(v0.K, v0.K.transpose(), b.length));
  }
  EXPECT_GT(balance, 1e-4);
  EXPECT_GT(symmetry, 1e-4);
}

}  // namespace
