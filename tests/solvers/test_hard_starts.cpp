// Starts that must be refused, by name and with a remedy; steps that fail; starts that are known in closed
// form; laws that hold whatever the motion.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "elements/element_batch.hpp"
#include "elements/node/mass.hpp"
#include "solvers/constraints/initial.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/statics/statics.hpp"
#include "solvers/time/generalized_alpha.hpp"
#include "tests/support/rigid_motion.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_hard_starts {
namespace {

// What an Error says; empty when none is thrown.
template <class F>
std::string message_of(const F& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return {};
}

void expect_words(const std::string& message, const std::vector<std::string>& words) {
  for (const std::string& word : words)
    EXPECT_NE(message.find(word), std::string::npos) << "no \"" << word << "\" in: " << message;
}

constexpr double nan_ = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity_ = std::numeric_limits<double>::infinity();

// ---- what is refused --------------------------------------------------------------------------

TEST(HardStart, AnOpenJointIsNamedWithItsGap) {
  Scene scene = model_scene("four_bar");
  std::get<Straight>(scene.beams.at(1).line).from(0) += 1e-3;
  expect_words(message_of([&] { compile(scene); }),
               {"four_bar.xml:", "revolute", "\"B\"", "open", "0.001 m"});

  const Model model = compile(model_scene("pendulum"));
  State state = model.initial;
  state.pose.at(1).r(2) += 2e-3;
  expect_words(message_of([&] { check_initial_state(*model.system, state); }),
               {"revolute 'O'", "open", "0.002"});
  state = model.initial;
  state.pose.at(1).r(0) = nan_;
  EXPECT_FALSE(message_of([&] { check_initial_state(*model.system, state); }).empty());
}

TEST(HardStart, InconsistentVelocitiesAreNamedWithTheirGap) {
  Scene top = model_scene("heavy_top");
  top.bodies.at(0).velocity.setZero();
  expect_words(message_of([&] { compile(top); }), {"spherical \"O\"", "velocit", "4.61538"});

  Scene driven = model_scene("four_bar");  // at rest, but driven at once
  driven.drives.at(0).rate = Expression::parse("0.6", {}, Variables::time);
  expect_words(message_of([&] { compile(driven); }), {"drive: joint \"A\"", "velocit", "0.6"});

  const Model model = compile(model_scene("pendulum"));
  State state = model.initial;
  state.V.at(1)(0) = 0.25;  // along the rod
  expect_words(message_of([&] { check_initial_state(*model.system, state); }),
               {"revolute 'O'", "0.25"});
  state.V.at(1)(0) = nan_;
  EXPECT_FALSE(message_of([&] { check_initial_state(*model.system, state); }).empty());
}

TEST(HardStart, BadSettingsAreErrors) {
  const Model model = compile(model_scene("pendulum"));
  const auto make = [&](double step, double rho) {
    return message_of([&] {
      GeneralizedAlpha integrator(*model.system, make_klu_solver(),
                                  {.step = step, .rho_infinity = rho, .newton = {}});
    });
  };
  EXPECT_EQ(make(1e-3, 0.0), "");
  EXPECT_EQ(make(1e-3, 1.0), "");
  for (const double rho : {-1e-9, 1.0 + 1e-9, 7.0, nan_})
    expect_words(make(1e-3, rho), {"rho_infinity", "[0, 1]"});
  for (const double step : {0.0, -1e-3, infinity_, nan_})
    expect_words(make(step, 0.5), {"step", "positive"});

  for (const double rho : {-0.1, 1.5, nan_}) {
    Scene scene = model_scene("pendulum");
    scene.transient->rho_infinity = rho;
    expect_words(message_of([&] { run(scene); }), {"rho_infinity"});
  }
  for (const double step : {0.0, -1.0, infinity_, nan_}) {
    Scene scene = model_scene("pendulum");
    scene.transient->step = step;
    EXPECT_NE(message_of([&] { run(scene); }), "") << step;
  }
}

TEST(HardStart, ASystemWithoutInertiaIsNotIntegrated) {
  const Model model = compile(model_scene("bend45"));
  expect_words(message_of([&] {
                 GeneralizedAlpha integrator(*model.system, make_klu_solver(),
                                             {.step = 1e-3, .rho_infinity = 0.5, .newton = {}});
               }),
               {"static", "inertia"});
}

// ---- what fails, and says so ------------------------------------------------------------------

TEST(HardStart, SingularStaticsAreReportedByName) {
  for (const char* const name : {"pendulum", "chain"}) {
    Scene scene = model_scene(name);
    scene.statics = StaticScene{};
    expect_words(message_of([&] { run(scene); }), {"static: no equilibrium", "free to move in"});
  }
}

// A structure that can move freely has no equilibrium of its own; under no load any place is one.
TEST(HardStart, AFreeBeamHasNoEquilibriumUnderLoad) {
  const Scene scene = read_model_text(R"(<mbd name="free">
      <section name="s"><stiffness EA="1e4" GA2="1e4" GA3="1e4" GJ="500" EI2="500" EI3="500"/></section>
      <beam name="beam" section="s" from="0 0 0" to="10 0 0" normal="0 0 1" elements="5" order="3"/>
      <load at="beam.end" force="0 0 1"/>
      <static/>
      <record name="end" at="beam.end" quantities="displacement"/>
    </mbd>)");
  expect_words(message_of([&] { run(scene); }),
               {"static: no equilibrium", "free to move in 6 ways"});
}

TEST(HardStart, RedundantConstraintsAreReportedByName) {
  Scene scene = model_scene("pendulum");
  scene.joints.push_back(scene.joints.front());
  scene.joints.back().name = "again";
  const RunReport report = run(scene);
  EXPECT_TRUE(report.complete()) << report.failure;
  ASSERT_EQ(report.redundant.size(), 1u);
  EXPECT_EQ(report.redundant[0],
            "revolute \"again\" repeats revolute \"O\" in position 1, position 2, position 3, "
            "direction a3.b1, direction a3.b2");
}

bool same(const State& a, const State& b) {
  bool equal = a.t == b.t && a.lambda == b.lambda && a.angles == b.angles;
  for (std::size_t n = 0; n < a.pose.size(); ++n) {
    equal = equal && a.pose[n].r == b.pose[n].r && a.pose[n].p.coeffs() == b.pose[n].p.coeffs();
    equal = equal && a.V[n] == b.V[n] && a.Vdot[n] == b.Vdot[n];
  }
  for (std::size_t i = 0; i < a.signals.size(); ++i)
    equal = equal && a.signals[i].f == b.signals[i].f && a.signals[i].fdot == b.signals[i].fdot;
  return equal;
}

// A step over the whole turn past the change point: no solution near.
TEST(HardStart, AStepThatFailsLeavesTheStateAndNamesAnEquation) {
  const Model model = compile(model_scene("four_bar"));
  GeneralizedAlpha usual(*model.system, make_klu_solver(),
                         {.step = 9e-3, .rho_infinity = 0.0, .newton = {}});
  State state = model.initial;
  ASSERT_TRUE(usual.start(state).converged);
  for (int k = 0; k < 400; ++k) ASSERT_TRUE(usual.step(state).converged);

  GeneralizedAlpha huge(*model.system, make_klu_solver(),
                        {.step = 4.0, .rho_infinity = 0.0, .max_halvings = 0, .newton = {}});
  State copy = state;
  ASSERT_TRUE(huge.start(copy).converged);
  const State before = copy;
  const StepReport report = huge.step(copy);
  EXPECT_FALSE(report.converged);
  EXPECT_TRUE(same(copy, before));
  EXPECT_TRUE(report.failure.find("worst equation: ") != std::string::npos ||
              report.failure.find(" element ") != std::string::npos ||
              report.failure.find("wrong side") != std::string::npos ||
              report.failure.find("turns by more than") != std::string::npos)
      << report.failure;
  EXPECT_TRUE(report.failure.find("'bar") != std::string::npos ||
              report.failure.find("revolute '") != std::string::npos ||
              report.failure.find("drive of 'A'") != std::string::npos)
      << report.failure;
  EXPECT_EQ(huge.counters().steps, 0);

  // It was the step: with usual ones the same state goes on.
  GeneralizedAlpha again(*model.system, make_klu_solver(),
                         {.step = 9e-3, .rho_infinity = 0.0, .newton = {}});
  ASSERT_TRUE(again.start(copy).converged);
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(again.step(copy).converged);
  EXPECT_NEAR(copy.t, 450 * 9e-3, 1e-12);
}

// ---- consistent starts ------------------------------------------------------------------------

State started(const Scene& scene) {
  const Model model = compile(scene);
  GeneralizedAlpha integrator(
      *model.system, make_klu_solver(),
      {.step = scene.transient->step.value(), .rho_infinity = 0.5, .newton = {}});
  State state = model.initial;
  EXPECT_TRUE(integrator.start(state).converged);
  return state;
}

// Horizontal, at rest: falls with g, turns with g/L, no tension.
TEST(HardStart, PendulumStartsWithGravity) {
  for (const double L : {1.0, 0.25}) {
    const State state = started(model_scene("pendulum", {{"L", std::to_string(L)}}));
    const Vec6& a = state.Vdot.at(1);
    const double g = 9.81;
    EXPECT_LT((a.head<3>() - Vec3(0, -g, 0)).norm(), 1e-12 * g);
    EXPECT_LT((a.tail<3>() - Vec3(0, 0, g / L)).norm(), 1e-12 * g / L);
    EXPECT_LT(state.lambda.norm(), 1e-12);
  }
}

TEST(HardStart, HeavyTopStartsAsEulerSays) {
  FixedPointBody body;
  body.mass = 15;
  body.center = {0, 1, 0};
  body.inertia = Eigen::Vector3d(15.234375, .46875, 15.234375).asDiagonal();
  body.gravity = {0, 0, -9.81};
  FixedPointState start;
  start.w = {0, 150, -4.61538};
  const State state = started(model_scene("heavy_top"));
  const Eigen::Vector3d wdot = angular_acceleration(body, start);
  EXPECT_LT((Eigen::Vector3d(state.Vdot.at(1).tail<3>()) - wdot).norm(), 1e-12 * wdot.norm());
  const Eigen::Vector3d vdot = wdot.cross(body.center);  // body axes: the derivative of w x c
  EXPECT_LT((Eigen::Vector3d(state.Vdot.at(1).head<3>()) - vdot).norm(), 1e-12 * wdot.norm());
  EXPECT_NEAR(state.lambda.norm(), reaction(body, start).norm(),
              1e-12 * reaction(body, start).norm());
}

// In equilibrium at rest, with a drive that starts smoothly: nothing moves, and R and T carry the weight.
TEST(HardStart, ShaftStartsAtRest) {
  Scene scene = model_scene("shaft");
  const Model model = compile(scene);
  const auto solver = make_klu_solver();
  State state = model.initial;
  StaticOptions statics;
  statics.newton.tolerance = scene.statics->tolerance;
  ASSERT_TRUE(solve_statics(*model.system, *solver, statics, state).converged);
  GeneralizedAlpha integrator(*model.system, make_klu_solver(),
                              {.step = 5e-3, .rho_infinity = 0.0, .newton = {}});
  const VecX lambda = state.lambda;
  ASSERT_TRUE(integrator.start(state).converged);
  for (const Vec6& a : state.Vdot) EXPECT_LT(a.head<3>().norm(), 1e-4);  // of 9.8 m/s2; 3e-6
  EXPECT_LT((state.lambda - lambda).norm(), 1e-8 * lambda.norm());
}

// ---- a free flexible beam, tumbling -------------------------------------------------------------

// models/free_beam.xml: loads until 5 s, then none. Energy form, geodesic metric.
Scene free_beam(double step) {
  Scene scene = read_model_text(R"(<mbd name="free_beam">
      <section name="s">
        <stiffness EA="1e4" GA2="1e4" GA3="1e4" GJ="500" EI2="500" EI3="500"/>
        <mass per_length="1" inertia="20 10 10"/>
      </section>
      <beam name="beam" section="s" from="0 0 0" to="10 0 0" normal="0 0 1" elements="5" order="3"/>
      <load at="beam.end" force="t&lt;2.5?8*t:t&lt;5?8*(5-t):0 0 0"
            moment="0 t&lt;2.5?80*t:t&lt;5?80*(5-t):0 t&lt;2.5?40*t:t&lt;5?40*(5-t):0"/>
      <transient duration="15" step="0.025" rho_infinity="0.9"/>
      <record name="end" at="beam.end" quantities="position"/>
    </mbd>)");
  scene.transient->step = step;
  return with(scene, Metric::geodesic, Form::energy);
}

// Momentum and angular momentum about the inertial origin, inertial axes; or their rates, from Vdot.
Vec6 momentum(const System& system, const State& state, bool rate) {
  const ElementBatch<Mass>* mass = nullptr;
  for (const auto& batch : system.batches())
    if (const auto* found = dynamic_cast<const ElementBatch<Mass>*>(batch.get())) mass = found;
  EXPECT_NE(mass, nullptr);
  EXPECT_EQ(mass->size(), system.nodes() - 1);
  Vec6 sum = Vec6::Zero();
  for (Index n = 1; n < system.nodes(); ++n) {
    const auto N = static_cast<std::size_t>(n);
    const Mat6& M = mass->data(n - 1).M;
    Vec6 p = M * state.V[N];
    if (rate) p = M * state.Vdot[N] - twist_hat_transpose_times<double>(state.V[N], p);
    const Vec3 linear = state.pose[N].p * Vec3(p.head<3>());
    sum.head<3>() += linear;
    sum.tail<3>() += state.pose[N].p * Vec3(p.tail<3>()) + state.pose[N].r.cross(linear);
  }
  return sum;
}

struct Tumbling {
  Vec3 end = Vec3::Zero();  // momentum at 5 s
  double rate = 0.0;        // largest |d/dt| of momentum after 5 s, over that of the loads at 2.5 s
  double drift = 0.0;       // largest change of momentum after 5 s, over its size
  double angular_drift = 0.0;
  double energy_gain = 0.0, energy_loss = 0.0;  // largest after 5 s, over the energy at 5 s
};

Tumbling tumble(double step) {
  const Model model = compile(free_beam(step));
  GeneralizedAlphaOptions options{.step = step, .rho_infinity = 0.9, .newton = {}};
  options.newton.tangent = NewtonOptions::Tangent::every_iteration;
  GeneralizedAlpha integrator(*model.system, make_klu_solver(), options);
  State state = model.initial;
  EXPECT_TRUE(integrator.start(state).converged);
  Tumbling result;
  Vec6 first = Vec6::Zero();
  double energy = 0.0;
  for (long k = 1; k <= std::lround(15.0 / step); ++k) {
    const StepReport report = integrator.step(state);
    EXPECT_TRUE(report.converged) << report.failure;
    if (!report.converged) break;
    if (state.t < 5.0 - 1e-9) continue;
    const Vec6 p = momentum(*model.system, state, false);
    const double e = model.system->energies(state).total();
    if (energy == 0.0) {
      first = p;
      energy = e;
      result.end = p.head<3>();
    }
    const Vec6 rate = momentum(*model.system, state, true);
    result.rate =
        std::max({result.rate, rate.head<3>().norm() / 20.0, rate.tail<3>().norm() / 200.0});
    result.drift = std::max(result.drift, (p - first).head<3>().norm() / first.head<3>().norm());
    result.angular_drift =
        std::max(result.angular_drift, (p - first).tail<3>().norm() / first.tail<3>().norm());
    result.energy_gain = std::max(result.energy_gain, e / energy - 1.0);
    result.energy_loss = std::max(result.energy_loss, 1.0 - e / energy);
  }
  return result;
}

// What is exact: inertia forces of every accepted state balance, because the internal forces of the energy
// form are in equilibrium by themselves (3e-14 with the tangent refreshed each iteration). What the integrator makes of them, in body axes, is of order 2:
// momentum drifts (the scheme conserves none of a turning body), energy neither grows nor falls by more.
// Measured at steps of 25, 12.5, 6.25 ms over 10 s: momentum 8.6e-3, 2.1e-3, 5.4e-4 of itself, angular
// momentum 3.9e-2, 9.8e-3, 2.5e-3, energy +3.4e-5, +8.1e-6, +2.0e-6 and -1.2e-5, -3.1e-6, -7.7e-7.
TEST(HardStartSlow, FreeBeamKeepsMomentumAndEnergyToTheOrderOfTheScheme) {
  std::vector<double> steps = {0.025, 0.0125, 0.00625}, end, drift, angular, gain, loss;
  for (const double step : steps) {
    const Tumbling t = tumble(step);
    EXPECT_LT(t.rate, 1e-10);
    end.push_back((t.end - Vec3(50, 0, 0)).norm());
    drift.push_back(t.drift);
    angular.push_back(t.angular_drift);
    gain.push_back(t.energy_gain);
    loss.push_back(t.energy_loss);
  }
  EXPECT_NEAR(fitted_order(steps, end), 2.0, 0.1) << testing::PrintToString(end);
  EXPECT_NEAR(fitted_order(steps, drift), 2.0, 0.1) << testing::PrintToString(drift);
  EXPECT_NEAR(fitted_order(steps, angular), 2.0, 0.1) << testing::PrintToString(angular);
  EXPECT_GT(fitted_order(steps, gain), 1.8) << testing::PrintToString(gain);
  EXPECT_GT(fitted_order(steps, loss), 1.8) << testing::PrintToString(loss);
  EXPECT_LT(end.back(), 5e-3);
  EXPECT_LT(drift.back(), 1e-3);
  EXPECT_LT(angular.back(), 5e-3);
  EXPECT_LT(gain.back(), 5e-6);
  EXPECT_LT(loss.back(), 5e-6);
}

}  // namespace
}  // namespace mbd::test::test_hard_starts
