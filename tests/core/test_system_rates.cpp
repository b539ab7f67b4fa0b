// What steps of several stages ask a System: the tangent of rates alone, and constraints alone.
#include <gtest/gtest.h>

#include <array>

#include "libmbd/core/system.hpp"
#include "tests/support/dense_solver.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_system_rates {
namespace {

using Eigen::MatrixXd;

// Off every equilibrium, constraints open, everything moving.
State random_state(const System& system, Rng& rng) {
  State s = system.reference_state();
  system.set_time(s, uniform(rng, 0.1, 1.9));
  for (std::size_t n = 1; n < s.pose.size(); ++n) {
    Vec6 U = random_vector<6>(rng, 0.05);
    U.head<3>() *= 0.02;
    s.pose[n] = s.pose[n] * exp_se3<double>(U);
    s.V[n] = random_vector<6>(rng, 5.0);
    s.Vdot[n] = random_vector<6>(rng, 50.0);
  }
  s.lambda = VecX::NullaryExpr(system.multipliers(), [&] { return uniform(rng, -1e3, 1e3); });
  return s;
}

// 0 of nothing: free_beam has no constraint.
double magnitude(const VecX& x) { return x.size() == 0 ? 0.0 : x.lpNorm<Eigen::Infinity>(); }

class SystemRates : public testing::TestWithParam<const char*> {
 protected:
  Model model = compile(model_scene(GetParam()));
  const System& system = *model.system;
};

TEST_P(SystemRates, TangentIsTheOneWithoutStiffness) {
  Rng rng(3);
  std::vector<Mat6> T_inv{Mat6::Identity()};
  for (Index n = 1; n < system.nodes(); ++n)
    T_inv.push_back(T_inverse<double>(random_vector<6>(rng, 0.5)).matrix());
  Worst worst("rate tangent", 1e-14);
  const State state = random_state(system, rng);
  for (const auto& [V, A, turned] : {std::tuple{1.0, 0.0, false},
                                     {0.0, 1.0, false},
                                     {3.0, 70.0, false},
                                     {3.0, 70.0, true},
                                     {1.0, 0.0, true}}) {
    const std::span<const Mat6> T = turned ? std::span<const Mat6>(T_inv) : std::span<const Mat6>();
    DenseSolver whole, stiffness, rates;
    for (DenseSolver* solver : {&whole, &stiffness, &rates}) solver->analyze(system.graph());
    VecX r, again;
    system.linearize(state, {.U = 1.0, .V = V, .A = A, .T_inv = T}, r, whole);
    system.linearize(state, {.U = 1.0, .V = 0.0, .A = 0.0, .T_inv = T}, r, stiffness);
    rates.set_zero();
    system.add_rate_tangent(state, {.U = 1.0, .V = V, .A = A, .T_inv = T}, rates.slots());
    const MatrixXd want = whole.matrix() - stiffness.matrix();
    // The difference has the round-off of the stiffness.
    const double scale = rates.matrix().cwiseAbs().maxCoeff(),
                 lost = eps * stiffness.matrix().cwiseAbs().maxCoeff() / scale;
    ASSERT_GT(scale, 0.0);
    worst.add((want - rates.matrix()).cwiseAbs().maxCoeff() / scale / std::max(1.0, lost / eps));
    const Index motions = 6 * (system.nodes() - 1);
    EXPECT_TRUE(rates.matrix().bottomRows(system.multipliers()).isZero(0.0));
    EXPECT_TRUE(rates.matrix().rightCols(system.multipliers()).isZero(0.0));
    EXPECT_EQ(rates.matrix().rows(), motions + system.multipliers());
    // it adds
    const MatrixXd once = rates.matrix();
    system.add_rate_tangent(state, {.U = 0.0, .V = V, .A = A, .T_inv = T}, rates.slots());
    EXPECT_LE((rates.matrix() - 2.0 * once).cwiseAbs().maxCoeff(), 4 * eps * scale);
  }
}

// linearize() into slots adds to what they hold, and is that into a solver.
TEST_P(SystemRates, TangentIntoSlotsIsTheSame) {
  Rng rng(4);
  const State state = random_state(system, rng);
  const TangentWeights weights{.U = 2.0, .V = 3.0, .A = 5.0, .T_inv = {}};
  DenseSolver a, b;
  a.analyze(system.graph());
  b.analyze(system.graph());
  VecX r, s, t;
  const bool in_range = system.linearize(state, weights, r, a);
  b.set_zero();
  EXPECT_EQ(system.linearize(state, weights, s, b.slots()), in_range);
  EXPECT_TRUE((a.matrix().array() == b.matrix().array()).all());
  EXPECT_TRUE((r.array() == s.array()).all());
  EXPECT_EQ(system.residual(state, t), in_range);
  EXPECT_TRUE((r.array() == t.array()).all());
  system.linearize(state, weights, s, b.slots());
  EXPECT_LE((b.matrix() - 2.0 * a.matrix()).cwiseAbs().maxCoeff(),
            8 * eps * a.matrix().cwiseAbs().maxCoeff());
}

TEST_P(SystemRates, ConstraintsAreThoseOfTheResidual) {
  Rng rng(5);
  for (int i = 0; i < 10; ++i) {
    const State state = random_state(system, rng);
    VecX r, g, gdot = VecX::Constant(1, 7.0), other, rest;  // neither size nor values matter
    system.residual(state, r);
    system.constraints(state, g, gdot);
    system.constraint_rates(state, other, rest);
    ASSERT_EQ(g.size(), system.multipliers());
    ASSERT_EQ(gdot.size(), system.multipliers());
    const VecX want = r.tail(system.multipliers());
    const double scale = std::max(1.0, magnitude(want));
    EXPECT_LE(magnitude(g - want), 4 * eps * scale);
    EXPECT_LE(magnitude(gdot - other), 16 * eps * std::max(1.0, magnitude(other)));
  }
}

// In one pass over the elements what linearize() and add_rate_tangent() give in five.
TEST_P(SystemRates, PowersOfTheTangentAreThePartsTaken) {
  Rng rng(7);
  const State state = random_state(system, rng);
  std::vector<Mat6> V_hat(static_cast<std::size_t>(system.nodes()), Mat6::Zero());
  for (std::size_t n = 1; n < V_hat.size(); ++n)
    V_hat[n] = twist_hat<double>(random_vector<6>(rng, 5.0));
  const auto rates = [&](double V, double A, bool turned, DenseSolver& to) {
    system.add_rate_tangent(
        state,
        {.U = 0.0,
         .V = V,
         .A = A,
         .T_inv = turned ? std::span<const Mat6>(V_hat) : std::span<const Mat6>()},
        to.slots());
  };
  std::array<DenseSolver, 3> want, got;
  for (std::array<DenseSolver, 3>* all : {&want, &got})
    for (DenseSolver& one : *all) {
      one.analyze(system.graph());
      one.set_zero();
    }
  VecX r, r_want;
  system.linearize(state, {}, r_want, want[0].slots());
  rates(1.0, 0.0, true, want[0]);
  rates(1.0, 0.0, false, want[1]);
  rates(0.0, 1.0, true, want[1]);
  rates(0.0, 1.0, false, want[2]);
  system.linearize_powers(state, V_hat, r, {got[0].slots(), got[1].slots(), got[2].slots()});
  EXPECT_EQ((r - r_want).cwiseAbs().maxCoeff(), 0.0);
  for (std::size_t k = 0; k < 3; ++k) {
    const double scale = want[k].matrix().cwiseAbs().maxCoeff();
    ASSERT_GT(scale, 0.0);
    EXPECT_LE((got[k].matrix() - want[k].matrix()).cwiseAbs().maxCoeff(), 16 * eps * scale) << k;
  }
}

// dr/d(load factor) of loads and of what is prescribed: differences of order 8 of the residual.
TEST_P(SystemRates, LoadRateIsTheDerivativeByTheLoadFactor) {
  Rng rng(8);
  State state = random_state(system, rng);
  state.load_factor = 0.7;
  VecX rate = VecX::Zero(system.rows());
  system.load_rate(state, rate);
  const auto at = [&](double h) {
    State moved = state;
    moved.load_factor += h;
    VecX r;
    system.residual(moved, r);
    return r;
  };
  const VecX want = first_difference(at, 1e-3);
  VecX residual;
  system.residual(state, residual);
  EXPECT_LE(magnitude(rate - want), 1e-11 * std::max(magnitude(want), magnitude(residual)));
}

// gdot is the rate of g along the motion: differences of order 8.
TEST_P(SystemRates, ConstraintRateIsTheRateOfTheConstraint) {
  Rng rng(6);
  const State state = random_state(system, rng);
  VecX g, gdot;
  system.constraints(state, g, gdot);
  const auto at = [&](double h) {
    State moved = state;
    for (std::size_t n = 1; n < moved.pose.size(); ++n)
      moved.pose[n] = moved.pose[n] * exp_se3<double>(h * state.V[n]);
    system.set_time(moved, state.t + h);
    VecX a, b;
    system.constraints(moved, a, b);
    return a;
  };
  const VecX rate = first_difference(at, 1e-3);
  EXPECT_LE(magnitude(rate - gdot), 1e-9 * std::max(1.0, magnitude(gdot)));
}

INSTANTIATE_TEST_SUITE_P(Models, SystemRates,
                         testing::Values("four_bar", "shaft", "every_joint", "windows",
                                         "free_beam"),
                         [](const auto& name) { return std::string(name.param); });

}  // namespace
}  // namespace mbd::test::test_system_rates
