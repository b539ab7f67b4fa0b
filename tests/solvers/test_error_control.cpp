// Units of errors, first steps, what the controller makes of errors, and where steps land.
#include "solvers/time/error_control.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libmbd/core/error.hpp"
#include "solvers/time/stepper.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_error_control {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

// Two bodies 4 m apart.
Model two_bodies(const std::string& attributes = "") {
  return compile(read_model_text(R"xml(<mbd name="test">
    <body name="a" mass="1" inertia="1 1 1" )xml" +
                                     attributes + R"xml(/>
    <body name="b" at="4 0 0" mass="1" inertia="1 1 1"/>
    <transient duration="2" step="0.01"/></mbd>)xml",
                                 "test.xml"));
}

// ---- norm ---------------------------------------------------------------------------------------

TEST(ErrorNorm, HasUnits) {
  const Model model = two_bodies();
  const double L = model.system->length_scale();
  ASSERT_GT(L, 0.0);
  ErrorNorm norm(*model.system, {.relative = 1e-3}, 10.0);
  State begin = model.initial, end = begin;
  begin.V[1] << 3, 4, 0, 0, 0, 0;  // 5 m/s
  end.V[2] << 0, 0, 0, 0, 2, 0;    // 2 rad/s
  norm.measure(begin, end);
  std::vector<Vec6> U(3, Vec6::Zero()), V(3, Vec6::Zero());
  EXPECT_EQ(norm(U, V, 1.0), 0.0);
  EXPECT_EQ(norm.worst_row(), -1);
  U[2](1) = -1e-3 * L;
  EXPECT_NEAR(norm(U, V, 1.0), 1.0, 1e-14);
  EXPECT_NEAR(norm(U, V, 4.0), 0.25, 1e-14);
  EXPECT_EQ(norm.worst_row(), 13);
  EXPECT_NEAR(norm.position(), 1e-3 * L, 1e-16);
  EXPECT_EQ(norm.rotation(), 0.0);
  U[1](5) = 2e-3;  // rad
  EXPECT_NEAR(norm(U, V, 1.0), 2.0, 1e-14);
  EXPECT_EQ(norm.worst_row(), 11);
  EXPECT_NEAR(norm.rotation(), 2e-3, 1e-18);
  V[1](0) = 3e-3 * 5.0;  // m/s
  EXPECT_NEAR(norm(U, V, 1.0), 3.0, 1e-13);
  EXPECT_EQ(norm.worst_row(), 6);
  EXPECT_NEAR(norm(U, {}, 1.0), 2.0, 1e-14);  // velocities are not measured
  V[2](4) = 4e-3 * 2.0;                       // rad/s
  EXPECT_NEAR(norm(U, V, 1.0), 4.0, 1e-13);
  EXPECT_EQ(norm.worst_row(), 16);
  U[0].setConstant(1e9);  // the ground does not move
  V[0].setConstant(1e9);
  EXPECT_NEAR(norm(U, V, 1.0), 4.0, 1e-13);
  EXPECT_EQ(norm.limits().rotation, 1e-3);
}

TEST(ErrorNorm, TakesPhysicalLimitsInstead) {
  const Model model = two_bodies();
  State state = model.initial;
  state.V[1] << 5, 0, 0, 0, 0, 2;
  std::vector<Vec6> U(3, Vec6::Zero()), V(3, Vec6::Zero());
  U[1] << 1e-6, 0, 0, 0, 0, 0;
  V[1] = Vec6::Zero();
  const auto size = [&](const ErrorTolerances& tolerances) {
    ErrorNorm norm(*model.system, tolerances, 10.0);
    norm.measure(state, state);
    return norm(U, V, 1.0);
  };
  EXPECT_NEAR(size({.relative = 1e-3, .position = 1e-7}), 10.0, 1e-12);
  EXPECT_NEAR(size({.relative = 1e-12, .position = 1.0}), 1e-6, 1e-18);
  EXPECT_NEAR(size({.relative = 1e-3, .rotation = 1e-9}), 1e-3 / model.system->length_scale(),
              1e-15);
  U[1].setZero();
  U[1](3) = 1e-6;
  EXPECT_NEAR(size({.relative = 1e-3, .rotation = 1e-7}), 10.0, 1e-12);
  U[1].setZero();
  V[1](1) = 1e-6;
  EXPECT_NEAR(size({.relative = 1e-3, .velocity = 1e-7}), 10.0, 1e-12);
  EXPECT_NEAR(size({.relative = 1e-3}), 1e-6 / (1e-3 * 5.0), 1e-15);
  V[1].setZero();
  V[1](4) = 1e-6;
  EXPECT_NEAR(size({.relative = 1e-3, .angular_velocity = 1e-7}), 10.0, 1e-12);
  EXPECT_NEAR(size({.relative = 1e-3}), 1e-6 / (1e-3 * 2.0), 1e-15);
}

// What rests is measured in a length, or a radian, over the whole time.
TEST(ErrorNorm, HasAScaleAtRest) {
  const Model model = two_bodies();
  const double L = model.system->length_scale();
  ErrorNorm norm(*model.system, {.relative = 1e-3}, 10.0);
  norm.measure(model.initial, model.initial);
  std::vector<Vec6> U(3, Vec6::Zero()), V(3, Vec6::Zero());
  V[1](0) = 1e-3 * L / 10.0;
  EXPECT_NEAR(norm(U, V, 1.0), 1.0, 1e-13);
  V[1].setZero();
  V[1](3) = 1e-3 / 10.0;
  EXPECT_NEAR(norm(U, V, 1.0), 1.0, 1e-13);
  EXPECT_NEAR(norm.velocity_share(1.0), 0.1, 1e-14);
  EXPECT_EQ(norm.velocity_share(0.01), 1.0);
  EXPECT_NEAR(norm.velocity_share(100.0), 1e-3, 1e-16);
}

TEST(ErrorNorm, SeesWhatIsNotFinite) {
  const Model model = two_bodies();
  ErrorNorm norm(*model.system, {.relative = 1e-3}, 10.0);
  for (const double bad : {nan, inf, -inf})
    for (std::size_t where = 0; where < 4; ++where) {
      std::vector<Vec6> U(3, Vec6::Zero()), V(3, Vec6::Zero());
      U[1](0) = 1.0;
      (where < 2 ? U : V)[2](where % 2 == 0 ? 1 : 4) = bad;
      EXPECT_TRUE(std::isnan(norm(U, V, 1.0)));
    }
}

TEST(ErrorNorm, RefusesTolerancesWithoutSense) {
  const Model model = two_bodies();
  const auto said = [&model](const ErrorTolerances& tolerances) -> std::string {
    try {
      ErrorNorm(*model.system, tolerances, 1.0);
    } catch (const Error& e) {
      return e.what();
    }
    return "none";
  };
  const auto has = [&said](const ErrorTolerances& tolerances, const std::string& part) {
    EXPECT_NE(said(tolerances).find(part), std::string::npos) << said(tolerances);
  };
  has({}, "the tolerance must be positive, not 0");
  has({.relative = -1.0}, "the tolerance must be positive, not -1");
  has({.relative = nan}, "not nan");
  has({.relative = inf}, "not inf");
  has({.relative = 1e-15}, "1e-15 is below round-off");
  has({.relative = 1e-3, .position = -2.0}, "position_tolerance must be positive, not -2");
  has({.relative = 1e-3, .rotation = nan}, "rotation_tolerance");
  has({.relative = 1e-3, .velocity = inf}, "velocity_tolerance");
  has({.relative = 1e-3, .angular_velocity = -1.0}, "angular_velocity_tolerance");
  EXPECT_EQ(said({.relative = 1e-14}), "none");
}

// ---- first step ---------------------------------------------------------------------------------

TEST(FirstStep, MovesLittle) {
  const Model model = two_bodies();
  const System& system = *model.system;
  const double L = system.length_scale();
  State state = model.initial;
  EXPECT_NEAR(first_step(system, state, 7.0), 0.07, 1e-15);  // at rest
  state.V[1] << 0, 100 * L, 0, 0, 0, 0;
  EXPECT_NEAR(first_step(system, state, 7.0), 1e-4, 1e-16);
  state.V[1] << 0, 0, 0, 0, 50, 0;
  EXPECT_NEAR(first_step(system, state, 7.0), 2e-4, 1e-16);
  state.Vdot[2] << 0, 0, 1e7 * L, 0, 0, 0;
  EXPECT_NEAR(first_step(system, state, 7.0), 1e-5, 1e-17);
  state.Vdot[2] << 0, 0, 0, 1e9, 0, 0;
  EXPECT_NEAR(first_step(system, state, 7.0), 1e-6, 1e-18);
  EXPECT_NEAR(first_step(system, state, 1e-5), 1e-7, 1e-19);
}

// ---- controller ---------------------------------------------------------------------------------

constexpr double safety = 0.85;
double ideal(double error, int order) { return safety * std::pow(error, -1.0 / order); }

TEST(StepController, GrowsAtTheStart) {
  StepController c(4, 1.0);
  c.start(1e-6);
  EXPECT_EQ(c.step(), 1e-6);
  c.accepted(1e-6, 1e-20);
  EXPECT_NEAR(c.step(), 6e-6, 1e-18);
  c.accepted(6e-6, 1e-20);
  EXPECT_NEAR(c.step(), 36e-6, 1e-17);
  c.accepted(c.step(), 0.1);
  EXPECT_NEAR(c.step(), 36e-6 * ideal(0.1, 4), 1e-17);
}

TEST(StepController, DoesNotPassTheLongestStep) {
  StepController c(4, 0.02);
  c.start(0.01);
  for (int k = 0; k < 20; ++k) c.accepted(c.step(), 1e-20);
  EXPECT_EQ(c.step(), 0.02);
  c.start(0.5);  // nor at the start
  EXPECT_LE(c.step(), 0.02);
}

TEST(StepController, KeepsAStepThatLittleWouldBeGained) {
  StepController c(4, 1.0);
  c.start(0.01);
  for (int k = 0; k < 50; ++k) {
    c.accepted(c.step(), 0.45);  // gain 1.04
    EXPECT_EQ(c.step(), 0.01);
  }
}

TEST(StepController, ShortensAtOnce) {
  StepController c(4, 1.0);
  c.start(0.01);
  c.accepted(0.01, 0.95);  // accepted, but the next one would be too large
  EXPECT_NEAR(c.step(), 0.01 * ideal(0.95, 4), 1e-16);
  const double h = c.step();
  c.rejected(h, 3.0);
  EXPECT_LT(c.step(), 0.8 * h * (1 + 1e-12));
  EXPECT_GE(c.step(), 0.1 * h);
  const double before = c.step();
  c.rejected(before, 1e30);
  EXPECT_NEAR(c.step(), 0.1 * before, 1e-16);
  const double smaller = c.step();
  c.rejected(smaller, nan);
  EXPECT_NEAR(c.step(), 0.1 * smaller, 1e-17);
  const double least = c.step();
  c.failed(least);
  EXPECT_NEAR(c.step(), 0.4 * least, 1e-18);
}

// An error that goes up and down: the step waits, then grows by the least gain of those it has seen.
TEST(StepController, WaitsWhereSomethingRings) {
  StepController c(4, 1.0);
  c.start(0.01);
  c.rejected(0.01, 2.0);
  const double h = c.step();
  const double errors[] = {0.05, 0.3, 0.1, 0.25, 0.05, 0.3, 0.1};
  for (const double e : errors) {
    c.accepted(h, e);
    EXPECT_EQ(c.step(), h);
  }
  c.accepted(h, 0.1);  // the eighth
  EXPECT_NEAR(c.step(), h * ideal(0.3, 4), 1e-15);
  EXPECT_GT(c.step(), h);
}

TEST(StepController, RecoversFromAFailure) {
  StepController c(4, 1.0);
  c.start(0.01);
  c.failed(0.01);
  c.failed(c.step());
  EXPECT_NEAR(c.step(), 0.0016, 1e-16);
  int steps = 0;
  while (c.step() < 0.01 && steps < 20) {
    const double e = 0.3 * std::pow(c.step() / 0.01, 4);
    c.accepted(c.step(), e);
    ++steps;
  }
  EXPECT_LE(steps, 10);  // large gains are not waited for long
  EXPECT_GE(c.step(), 0.01);
}

// Steps cut by a breakpoint say little.
TEST(StepController, IgnoresStepsThatWereCut) {
  StepController c(4, 1.0);
  c.start(0.01);
  c.accepted(1e-4, 1e-10);
  EXPECT_EQ(c.step(), 0.01);
  c.accepted(1e-4, 0.95);
  EXPECT_EQ(c.step(), 0.01);
}

// An error that goes with h^5 and changes slowly is followed with few rejections and few changes.
TEST(StepController, FollowsASlowChange) {
  StepController c(4, 1.0);
  c.start(1e-4);
  int changes = 0, rejections = 0, steps = 0;
  double t = 0.0, last = 0.0;
  while (t < 10.0) {
    const double h = c.step();
    const double e = std::pow(h / (0.02 * (1.0 + 0.8 * std::sin(t))), 4);
    if (e > 1.0) {
      c.rejected(h, e);
      ++rejections;
      continue;
    }
    c.accepted(h, e);
    t += h;
    ++steps;
    if (c.step() != last) ++changes;
    last = c.step();
  }
  RecordProperty("steps", std::to_string(steps) + " changes " + std::to_string(changes) +
                              " rejections " + std::to_string(rejections));
  EXPECT_LT(rejections, steps / 10);
  EXPECT_LT(changes, steps / 2);
  EXPECT_LT(steps, 1500);
}

// ---- landings -----------------------------------------------------------------------------------

TEST(NextLanding, IsTheEndOrABreakpointBeforeIt) {
  const std::vector<Breakpoint> b = {{1.0, false}, {2.0, true}, {3.0, false}};
  const auto at = [&b](double t, double end) { return next_landing(b, t, end, 1e-9, 0.1); };
  Landing l = at(0.0, 0.5);
  EXPECT_EQ(l.t, 0.5);
  EXPECT_FALSE(l.restart);
  EXPECT_EQ(l.restart_at, 0.5);
  l = at(0.0, 1.5);
  EXPECT_EQ(l.t, 1.0);
  EXPECT_FALSE(l.restart);
  l = at(1.0, 5.0);
  EXPECT_EQ(l.t, 2.0);
  EXPECT_TRUE(l.restart);
  EXPECT_EQ(l.restart_at, 2.0);
  l = at(3.0, 5.0);
  EXPECT_EQ(l.t, 5.0);
  EXPECT_FALSE(l.restart);
}

TEST(NextLanding, KnowsRoundOff) {
  const std::vector<Breakpoint> b = {{1.0, true}};
  const auto at = [&b](double t, double end) { return next_landing(b, t, end, 1e-9, 0.1); };
  EXPECT_EQ(at(1.0 - 1e-10, 2.0).t, 2.0);  // has been passed
  EXPECT_FALSE(at(1.0 - 1e-10, 2.0).restart);
  EXPECT_EQ(at(1.0 - 1e-8, 2.0).t, 1.0);
  const Landing l = at(0.0, 1.0 - 1e-10);  // the end is the breakpoint but for round-off
  EXPECT_EQ(l.t, 1.0);
  EXPECT_TRUE(l.restart);
  EXPECT_EQ(at(0.0, 1.0 - 1e-8).t, 1.0 - 1e-8);
}

// Breakpoints that are one but for round-off are one: the restart is at the last of them, and if one jumps.
TEST(NextLanding, JoinsBreakpoints) {
  const std::vector<Breakpoint> b = {
      {1.0, false}, {1.0 + 4e-10, true}, {1.0 + 8e-10, false}, {2.0, true}};
  const Landing l = next_landing(b, 0.0, 5.0, 1e-9, 0.1);
  EXPECT_EQ(l.t, 1.0);
  EXPECT_TRUE(l.restart);
  EXPECT_EQ(l.restart_at, 1.0 + 8e-10);
  EXPECT_EQ(next_landing(b, l.restart_at, 5.0, 1e-9, 0.1).t, 2.0);
  EXPECT_EQ(next_landing({}, 0.0, 5.0, 1e-9, 0.1).t, 5.0);
}

// Where only higher derivatives jump steps land if they go past nothing else there: not on each point of a table.
// Mutation seen: on none.
TEST(NextLanding, OnSmoothOnesThatAreApart) {
  const std::vector<Breakpoint> b = {{1.0, false, true},
                                     {2.0, false, true},
                                     {2.01, false, true},
                                     {2.02, true},
                                     {3.0, false, true}};
  const auto at = [&b](double t, double apart) { return next_landing(b, t, 5.0, 1e-9, apart); };
  EXPECT_EQ(at(0.0, 0.1).t, 1.0);
  EXPECT_FALSE(at(0.0, 0.1).restart);
  EXPECT_EQ(at(1.0, 0.1).t, 2.02);
  EXPECT_TRUE(at(1.0, 0.1).restart);
  EXPECT_EQ(at(1.0, 1e-3).t, 2.0);
  EXPECT_EQ(at(2.02, 0.1).t, 3.0);
  EXPECT_EQ(at(2.02, 2.0).t, 5.0);
  constexpr double never = std::numeric_limits<double>::infinity();
  EXPECT_EQ(at(0.0, never).t, 2.02);
  const std::vector<Breakpoint> alone = {{1.0, false, true}};
  EXPECT_EQ(next_landing(alone, 0.0, 5.0, 1e-9, 0.1).t, 1.0);
  EXPECT_EQ(next_landing(alone, 0.0, 5.0, 1e-9, never).t, 5.0);
}

}  // namespace
}  // namespace mbd::test::test_error_control
