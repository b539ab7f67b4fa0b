// Kinds of failures beside their messages: each is asked for once.
//
// Tried, and killed: a law said to be out of range; step() before start() of no kind; open joints taken, and velocities that tear one; the
// kind of a step not given to its run; of steps of bounded cost: twice as many iterations, a factorisation at each, nothing said of what
// is left undone.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "libmbd/compile/ports.hpp"
#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/run/run.hpp"
#include "solvers/linear/block_solver.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/time/generalized_alpha.hpp"
#include "tests/support/read_text.hpp"

namespace mbd::test::test_failures {
namespace {

const std::string pendulum = R"(
  <body name="m" at="0 0 0" center="0 0 -1" mass="1" inertia="0.1 0.1 0.1"/>
  <revolute name="hinge" between="ground m" axis="0 1 0"/>
  <gravity acceleration="0 0 -9.81"/>
  <record name="hinge" joint="hinge" quantities="angle"/>)";

Failure kind_of(const std::string& inside) {
  try {
    compile(read(inside));
  } catch (const Error& error) {
    return error.kind();
  }
  return Failure::none;
}

TEST(Failures, OfModelsAndOfRequests) {
  const std::string end = R"(<transient duration="1" step="0.1"/>)";
  EXPECT_EQ(kind_of(pendulum + end), Failure::none);
  EXPECT_EQ(kind_of(pendulum + "<gravty/>" + end), Failure::model);
  EXPECT_EQ(kind_of(pendulum + R"(<revolute name="r" between="ground n" axis="0 1 0"/>)" + end),
            Failure::model);
  EXPECT_EQ(Error("a setting").kind(), Failure::request);
  const Model model = compile(read(pendulum + end));
  try {
    GeneralizedAlpha stepper(*model.system, make_klu_solver(), {.step = -1.0, .newton = {}});
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Failure::request);
  }
  EXPECT_EQ(name_of(Failure::memory), "memory");
  EXPECT_EQ(name_of(Failure::order), "order");
}

TEST(Failures, StepsInTheRightOrder) {
  const Scene scene = read(pendulum + R"(<transient duration="1" step="0.01"/>)");
  const Model model = compile(scene);
  for (const TimeMethod method : {TimeMethod::generalized_alpha, TimeMethod::radau}) {
    TransientScene transient = *scene.transient;
    transient.method = method;
    const auto stepper = make_stepper(*model.system, transient);
    State state = model.initial;
    StepReport report = stepper->step(state);
    EXPECT_FALSE(report.converged);
    EXPECT_EQ(report.kind, Failure::order);
    report = stepper->start(state);
    ASSERT_TRUE(report.converged) << report.failure;
    EXPECT_EQ(report.kind, Failure::none);
    report = stepper->step(state);
    ASSERT_TRUE(report.converged);
    EXPECT_EQ(report.kind, Failure::none);
    State earlier = state;
    earlier.t -= 0.005;
    EXPECT_EQ(stepper->step(earlier).kind, Failure::order);
    State other = state;
    other.pose.pop_back();
    EXPECT_THROW(static_cast<void>(stepper->start(other)), Error);
  }
}

TEST(Failures, StartsFromStatesThatJointsAllow) {
  const Scene scene = read(pendulum + R"(<transient duration="1" step="0.01"/>)");
  const Model model = compile(scene);
  const auto stepper = make_stepper(*model.system, *scene.transient);
  State open = model.initial;
  open.pose[1].r.x() += 1e-3;
  StepReport report = stepper->start(open);
  EXPECT_EQ(report.kind, Failure::inconsistent);
  EXPECT_SAYS(report.failure, "hinge");
  EXPECT_SAYS(report.failure, "open");
  State torn = model.initial;
  torn.V[1].head<3>() = Vec3(0.0, 0.5, 0.0);  // along the hinge
  report = stepper->start(torn);
  EXPECT_EQ(report.kind, Failure::inconsistent);
  EXPECT_SAYS(report.failure, "hinge");
  State turned = model.initial;
  turned.V[1].tail<3>() = Vec3(0.0, 2.0, 0.0);  // about it
  EXPECT_TRUE(stepper->start(turned).converged);
}

TEST(Failures, OfSteps) {
  const auto ended = [](const std::string& inside) {
    const Scene scene = read(inside);
    const Model model = compile(scene);
    const auto stepper = make_stepper(*model.system, *scene.transient);
    State state = model.initial;
    StepReport report = stepper->start(state);
    while (report.converged && state.t < scene.transient->duration - 1e-9)
      report = stepper->step(state);
    if (report.converged && scene.transient->tolerance) report = stepper->step(state);
    return report;
  };
  const StepReport law = ended(
      pendulum + R"(<load at="m" force="sqrt(0.5-t) 0 0"/><transient duration="1" step="0.01"/>)");
  EXPECT_EQ(law.kind, Failure::law) << law.failure;
  const StepReport end = ended(pendulum + R"(<transient duration="0.1" tolerance="1e-4"/>)");
  EXPECT_EQ(end.kind, Failure::end) << end.failure;
}

TEST(Failures, OfRuns) {
  const RunReport report = run(read(
      pendulum + R"(<load at="m" force="sqrt(0.5-t) 0 0"/><transient duration="1" step="0.01"/>)"));
  EXPECT_FALSE(report.complete());
  EXPECT_EQ(report.kind, Failure::law) << report.failure;
  EXPECT_NE(to_json(report).find("\"failure_kind\": \"law\""), std::string::npos);
  const RunReport good = run(read(pendulum + R"(<transient duration="0.1" step="0.01"/>)"));
  EXPECT_EQ(good.kind, Failure::none);
  EXPECT_EQ(to_json(good).find("failure_kind"), std::string::npos);
}

// Real time (GeneralizedAlphaOptions::max_cost): bounded, said, and near the whole iterations; where they are enough, equal to them.
TEST(Failures, BoundedStepsSayWhatTheyLeave) {
  const Scene scene = read(R"(
    <section name="s"><stiffness EA="1e5" GA2="4e4" GA3="4e4" GJ="8" EI2="10" EI3="6"/>
      <mass per_length="1.2" inertia="2e-3 1e-3 1e-3"/></section>
    <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="3"/>
    <revolute name="hinge" between="ground b.start" axis="0 1 0"/>
    <gravity acceleration="0 0 -9.81"/><transient duration="0.5" step="2e-3"/>
    <record name="tip" at="b.end" quantities="displacement"/>)");
  const Model model = compile(scene);
  struct Way {
    double tip = 0.0, left = 0.0;
    long undone = 0, iterations = 0, factorizations = 0, most = 0;
  };
  const auto go = [&](int most, NewtonOptions newton = {}) {
    GeneralizedAlpha stepper(
        *model.system, make_block_solver(PivotOrder::nodes_first),
        {.step = 2e-3, .rho_infinity = 0.8, .newton = newton, .max_cost = most});
    State state = model.initial;
    StepReport report = stepper.start(state);
    Way way;
    while (report.converged && state.t < 0.5 - 1e-9) {
      const bool is_first = state.t == 0.0;
      const long before = stepper.counters().factorizations,
                 iterations = stepper.counters().iterations;
      report = stepper.step(state);
      if (most > 0) {
        EXPECT_LE(stepper.counters().factorizations - before, is_first ? 2 : 1);
        EXPECT_LE(stepper.counters().iterations - iterations, most);
      }
      way.most = std::max(way.most, stepper.counters().iterations - iterations);
      if (report.undone) {
        ++way.undone;
        way.left = std::max(way.left, report.error);
        EXPECT_GT(report.error, 1.0);
      }
    }
    EXPECT_TRUE(report.converged) << report.failure;
    way.factorizations = stepper.counters().factorizations;
    VecX y(static_cast<Index>(ports(model).outputs.size()));
    outputs(model, state, {y.data(), static_cast<std::size_t>(y.size())});
    way.tip = y(2);
    return way;
  };
  const Way whole = go(0), few = go(2), enough = go(20);
  go(3, {.tangent = NewtonOptions::Tangent::every_iteration});  // of which there is one, too
  EXPECT_EQ(whole.undone, 0);
  EXPECT_EQ(enough.undone, 0);
  EXPECT_GT(whole.most, 2);
  EXPECT_GT(few.undone, 10);
  EXPECT_LE(few.most, 2);
  EXPECT_NEAR(few.tip, whole.tip, 1e-5);
  EXPECT_NEAR(enough.tip, whole.tip, 1e-8);
  EXPECT_THROW(
      GeneralizedAlpha(*model.system, make_klu_solver(),
                       {.tolerances = {.relative = 1e-4}, .end = 1.0, .newton = {}, .max_cost = 3}),
      Error);
}

}  // namespace
}  // namespace mbd::test::test_failures
