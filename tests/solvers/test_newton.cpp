// Newton's iterations in a time step: quadratic with the tangent refreshed at each, the same trajectory
// with the tangent kept.
//
// Measure: increments e_k of the motion (largest component, metres over the scene's length or radians) in
// steps of 5 to 40 times the usual 9 ms, from states of the four-bar in motion. All pairs (e_k, e_k+1) with
// e_k < 0.03, where the iteration has settled, and e_k+1 > 1e-13, above round-off; order: least-squares
// slope of log e_k+1 against log e_k. A pair by itself tells less: e_k+1 / e_k^2 swings between 0.3 and 300,
// because an increment along a stiff direction is followed by one along soft ones.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "solvers/linear/block_solver.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/newton/increments.hpp"
#include "solvers/time/generalized_alpha.hpp"
#include "tests/support/altered_solver.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_newton {
namespace {

// A mutation: KLU without the geometric stiffness of the joints, which are the four contributions before
// those of a joint's multipliers.
class WithoutGeometricStiffness : public AlteredSolver {
 public:
  void analyze(const BlockGraph& graph) override {
    AlteredSolver::analyze(graph);
    dropped_ = 0;
    for (std::size_t i = 4; i < graph.contributions.size(); ++i) {
      const auto &one = graph.contributions[i], &before = graph.contributions[i - 1];
      if (!is_multiplier(graph, one.column) || is_multiplier(graph, before.column) ||
          is_multiplier(graph, before.row))
        continue;
      for (std::size_t k = i - 4; k < i; ++k, ++dropped_) drop(k);
    }
  }
  int dropped() const { return dropped_; }

 private:
  int dropped_ = 0;
};

constexpr double usual_step = 9e-3;  // [s]

Scene four_bar(double duration) {
  Scene scene = model_scene("four_bar");
  scene.transient->duration = duration;
  return scene;
}

State state_at(const Model& model, double t) {
  GeneralizedAlpha integrator(*model.system, make_klu_solver(),
                              {.step = usual_step, .rho_infinity = 0.0, .newton = {}});
  State state = model.initial;
  EXPECT_TRUE(integrator.start(state).converged);
  while (state.t < t - 0.5 * usual_step)
    if (!integrator.step(state).converged) {
      ADD_FAILURE() << "at " << state.t;
      break;
    }
  return state;
}

// The measure above.
struct Rate {
  double order = 0.0;
  double largest_constant = 0.0;  // of e_k+1 / e_k^2
  std::size_t pairs = 0;
};

template <class MakeSolver>
Rate measure_rate(const MakeSolver& make_solver) {
  constexpr double tolerance = 1e-14;
  const Model model = compile(four_bar(36));
  std::vector<double> from, to;
  for (const double t : {2.997, 3.996, 4.5, 4.995}) {
    const State start = state_at(model, t);
    for (const double factor : {5.0, 10.0, 20.0, 40.0}) {
      GeneralizedAlphaOptions options{
          .step = factor * usual_step, .rho_infinity = 0.0, .newton = {}};
      options.newton.tangent = NewtonOptions::Tangent::every_iteration;
      options.newton.tolerance = tolerance;
      options.newton.multiplier_tolerance = 1.0;  // the motion alone is looked at
      GeneralizedAlpha integrator(*model.system, make_solver(), options);
      State state = start;
      EXPECT_TRUE(integrator.start(state).converged);
      const StepReport report = integrator.step(state);
      EXPECT_TRUE(report.converged) << report.failure;
      for (std::size_t k = 0; k + 1 < static_cast<std::size_t>(report.iterations); ++k) {
        const double e = tolerance * report.increments.at(k),
                     next = tolerance * report.increments.at(k + 1);
        if (!(e < 0.03 && next > 1e-13)) continue;
        from.push_back(e);
        to.push_back(next);
      }
    }
  }
  Rate rate{.order = fitted_order(from, to), .largest_constant = 0.0, .pairs = from.size()};
  for (std::size_t k = 0; k < from.size(); ++k)
    rate.largest_constant = std::max(rate.largest_constant, to[k] / (from[k] * from[k]));
  testing::Test::RecordProperty("order", testing::PrintToString(rate.order));
  testing::Test::RecordProperty("constant", testing::PrintToString(rate.largest_constant));
  return rate;
}

// Measured: 21 pairs above the floor of round-off.
TEST(Newton, IsQuadraticOnTheFourBar) {
  const Rate rate = measure_rate([] { return make_klu_solver(); });
  EXPECT_GE(rate.pairs, 15u);
  EXPECT_GE(rate.order, 1.8);
  EXPECT_LE(rate.largest_constant, 2e3);
}

// Measured: order 1.29, constant 7e7: linear at the end.
TEST(NewtonMutation, WithoutGeometricStiffnessOfTheJoints) {
  const Model model = compile(four_bar(36));
  WithoutGeometricStiffness solver;
  solver.analyze(model.system->graph());
  ASSERT_EQ(solver.dropped(), 4 * static_cast<int>(model.system->constraints().size()));
  const Rate rate = measure_rate([] { return std::make_unique<WithoutGeometricStiffness>(); });
  EXPECT_LT(rate.order, 1.5);
  EXPECT_GT(rate.largest_constant, 1e5);
}

// From t = 5 s, twenty usual steps at once. The residual is not mutated, so the solution is the same.
TEST(NewtonMutation, TakesMoreIterationsToTheSameSolution) {
  const Model model = compile(four_bar(36));
  GeneralizedAlphaOptions options{.step = 20 * usual_step, .rho_infinity = 0.0, .newton = {}};
  options.newton.tangent = NewtonOptions::Tangent::every_iteration;
  options.newton.tolerance = 1e-14;
  options.newton.multiplier_tolerance = 1.0;
  State state = state_at(model, 4.995);
  GeneralizedAlpha right(*model.system, make_klu_solver(), options);
  GeneralizedAlpha wrong(*model.system, std::make_unique<WithoutGeometricStiffness>(), options);
  State a = state, b = state;
  ASSERT_TRUE(right.start(a).converged);
  ASSERT_TRUE(wrong.start(b).converged);
  const StepReport good = right.step(a), bad = wrong.step(b);
  ASSERT_TRUE(good.converged && bad.converged) << good.failure << bad.failure;
  EXPECT_GT(bad.iterations, good.iterations);
  for (std::size_t n = 0; n < a.pose.size(); ++n)
    EXPECT_LT((a.pose[n].r - b.pose[n].r).norm(), 1e-11);  // of iterations that end at round-off
}

// ---- the kept tangent -------------------------------------------------------------------------

// One trajectory, whatever the tangent: largest difference over all nodes and accepted times to t = 9 s
// (past the first change point), positions over the scene's length, multipliers over the largest met.
// Measured 1.7e-10, and 1.4e-8 … 1.0e-7 with round-off; the tolerances are 1e-10 and 1e-7 a step.
TEST(NewtonSlow, KeptTangentGivesTheSameTrajectory) {
  const Model model = compile(four_bar(9));
  GeneralizedAlphaOptions options{.step = usual_step, .rho_infinity = 0.0, .newton = {}};
  GeneralizedAlpha kept(*model.system, make_klu_solver(), options);
  options.newton.tangent = NewtonOptions::Tangent::every_iteration;
  GeneralizedAlpha refreshed(*model.system, make_klu_solver(), options);
  State a = model.initial, b = model.initial;
  ASSERT_TRUE(kept.start(a).converged);
  ASSERT_TRUE(refreshed.start(b).converged);
  double motion = 0.0, multipliers = 0.0, largest_multiplier = 0.0;
  for (int k = 0; k < 1000; ++k) {
    ASSERT_TRUE(kept.step(a).converged);
    ASSERT_TRUE(refreshed.step(b).converged);
    for (std::size_t n = 0; n < a.pose.size(); ++n)
      motion = std::max(motion, (a.pose[n].r - b.pose[n].r).norm() / model.system->length_scale());
    multipliers = std::max(multipliers, (a.lambda - b.lambda).cwiseAbs().maxCoeff());
    largest_multiplier = std::max(largest_multiplier, b.lambda.cwiseAbs().maxCoeff());
  }
  EXPECT_LT(motion, 1e-9);
  EXPECT_LT(multipliers / largest_multiplier, 1e-6);
  EXPECT_LT(kept.counters().factorizations, refreshed.counters().factorizations / 5);
}

// Ten rods falling, small steps, little damping: multipliers of the two tangents differ by no more than
// 300 tolerances of 1e-7 of the largest, over 400 steps. What a step leaves of an increment, the scheme with
// rho_infinity = 0.9 carries on: about fifty times is natural (measured with an honest contraction).
TEST(Newton, KeptTangentGivesTheSameMultipliersOfAChain) {
  for (const double step : {5e-4, 1e-4}) {
    Scene scene = model_scene("chain", {{"N", "10"}});
    scene.transient->step = step;
    const Model model = compile(scene);
    GeneralizedAlphaOptions options{.step = step, .rho_infinity = 0.9, .newton = {}};
    GeneralizedAlpha kept(*model.system, make_klu_solver(), options);
    options.newton.tangent = NewtonOptions::Tangent::every_iteration;
    GeneralizedAlpha refreshed(*model.system, make_klu_solver(), options);
    State a = model.initial, b = model.initial;
    ASSERT_TRUE(kept.start(a).converged);
    ASSERT_TRUE(refreshed.start(b).converged);
    double difference = 0.0, largest_multiplier = 0.0;
    for (int k = 0; k < 400; ++k) {
      ASSERT_TRUE(kept.step(a).converged);
      ASSERT_TRUE(refreshed.step(b).converged);
      difference = std::max(difference, (a.lambda - b.lambda).cwiseAbs().maxCoeff());
      largest_multiplier = std::max(largest_multiplier, b.lambda.cwiseAbs().maxCoeff());
    }
    EXPECT_LT(difference / largest_multiplier, 3e-5) << "step " << step;
  }
}

// A kilometre of rods of 0.1 m, held at one end, falls: gaps of round-off make multipliers along it that are thousands of
// tolerances of what is there at first. What is far from the end falls freely: z = -g t^2/2. Steps end with their own tangent,
// whether it is kept or not. (Without is_round_off() both end at the first step: only rank-tolerant ones went on, to the sixth.)
TEST(NewtonSlow, LongChainsEndAtTheRoundOffOfTheirMultipliers) {
  const Scene scene = model_scene("chain", {{"N", "10000"}});
  const Model model = compile(scene);
  for (const auto tangent :
       {NewtonOptions::Tangent::kept, NewtonOptions::Tangent::every_iteration}) {
    GeneralizedAlpha stepper(*model.system, make_block_solver(PivotOrder::nodes_first),
                             {.step = 1e-3, .rho_infinity = 0.9, .newton = {.tangent = tangent}});
    State state = model.initial;
    ASSERT_TRUE(stepper.start(state).converged);
    for (int k = 0; k < 10; ++k) {
      const StepReport report = stepper.step(state);
      ASSERT_TRUE(report.converged) << report.failure;
      EXPECT_LE(report.iterations, 8);
      EXPECT_LT(report.contraction, 1.0);  // which is not that of round-off
    }
    EXPECT_EQ(stepper.counters().tolerant, 0);
    EXPECT_EQ(stepper.counters().retries, 0);
    const double fall = 0.5 * 9.81 * state.t * state.t;
    EXPECT_NEAR(state.pose.back().r.z(), -fall, 1e-3 * fall);
  }
}

// Before a number and behind one: a multiplier that is none must reach the certificate. (A loop that kept what is not smaller
// forgot it with the next.)
TEST(LargestForce, IsNoNumberIfOneMultiplierIsNone) {
  const Model model = compile(read(
      R"(<body name="b" at="0 0 2" mass="1" inertia="1 1 1"/><body name="c" mass="1" inertia="1 1 1"/>
                      <revolute name="r" between="ground b" at="0 0 2" axis="0 1 0"/>
                      <revolute name="q" between="ground c" at="0 0 0" axis="0 1 0"/><transient step="1e-3" duration="1"/>)"));
  const System& system = *model.system;
  VecX lambda = VecX::Zero(system.multipliers());
  const ConstraintInfo& info = system.constraints().front();
  for (Index i = 0; i < info.rows; ++i)
    lambda(info.first_row + i) = info.is_position[static_cast<std::size_t>(i)] ? -3.0 : 8.0;
  EXPECT_DOUBLE_EQ(largest_force(system, lambda), std::max(3.0, 8.0 / system.length_scale()));
  for (Index i = 0; i < lambda.size(); ++i) {
    VecX spoiled = lambda;
    spoiled(i) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(std::isnan(largest_force(system, spoiled))) << i;
  }
}

}  // namespace
}  // namespace mbd::test::test_newton
