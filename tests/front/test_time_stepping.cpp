// How a <transient> is carried out: methods and tolerances, when rows of results are written, what is said of
// them, and what the command line changes. What the methods themselves are worth is tested in tests/solvers.

#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/scene/transient.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "libmbd/results/summary.hpp"
#include "libmbd/run/describe.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/shell.hpp"
#include "tests/support/this_build.hpp"

namespace mbd::test::test_time_stepping {
namespace {

namespace fs = std::filesystem;
using test::History;
using test::quote;
using test::run_to_table;
using test::shell;

const fs::path models = fs::path(MBD_SOURCE_DIR) / "models";

#define EXPECT_HAS(text, part) \
  EXPECT_NE((text).find(part), std::string::npos) << "no \"" << (part) << "\" in:\n" << (text)

// A ball thrown to the side: x = 2 t, z = -9.81/2 t^2. `more` stands in the <mbd> as well.
// Balance of accelerations, which makes of a ball in free fall a linear system: exact, not to Newton's tolerance.
Scene ball(const std::string& transient, const std::string& more = "") {
  const bool alpha = transient.find("method=") == std::string::npos;
  return read_model_text(R"(<mbd name="ball">
      <parameter name="dt" value="0.01"/>
      <body name="ball" mass="1" inertia="1 1 1" velocity="2 0 0"/>
      <gravity acceleration="0 0 -9.81"/>
      <transient )" + transient +
                         (alpha ? " balance=\"acceleration\"" : "") +
                         R"(/>
      <record name="ball" at="ball" quantities="position velocity acceleration"/>
    )" + more + "</mbd>");
}

// The pendulum of the models for a second, in parts by `method`; then it is at `x_1`.
constexpr double x_1 = 0.98629175113;
Scene pendulum(const std::string& transient) {
  return read_model_text(R"(<mbd name="pendulum">
      <body name="bob" at="-1 0 0" mass="1" inertia="0 0 0"/>
      <revolute name="O" between="ground bob" at="0 0 0" axis="0 0 1"/>
      <gravity acceleration="0 -9.81 0"/>
      <transient duration="1" )" +
                         transient +
                         R"(/>
      <record name="bob" at="bob" quantities="position velocity"/>
      <record name="O" joint="O" quantities="angle"/>
    </mbd>)");
}

std::string message_of(const Scene& scene) {
  try {
    run(scene);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

// ---- what a model may say ----------------------------------------------------------------------

TEST(Transient, IsReadWithUnits) {
  const Scene scene = ball(
      R"(duration="2 s" method="radau" tolerance="1e-7" position_tolerance="2 um"
         rotation_tolerance="1e-3 deg" velocity_tolerance="1 mm/s" angular_velocity_tolerance="1 rpm"
         max_step="5 ms" output="20 ms")");
  const TransientScene& t = *scene.transient;
  EXPECT_EQ(t.duration, 2.0);
  EXPECT_EQ(t.method, TimeMethod::radau);
  EXPECT_FALSE(t.step);
  EXPECT_EQ(t.tolerance, 1e-7);
  EXPECT_NEAR(*t.position_tolerance, 2e-6, 1e-20);
  EXPECT_NEAR(*t.rotation_tolerance, std::acos(-1.0) / 180e3, 1e-18);
  EXPECT_EQ(t.velocity_tolerance, 1e-3);
  EXPECT_NEAR(*t.angular_velocity_tolerance, std::acos(-1.0) / 30, 1e-15);
  EXPECT_EQ(t.max_step, 5e-3);
  EXPECT_EQ(t.output, 20e-3);
  EXPECT_FALSE(t.output_steps);
  EXPECT_FALSE(t.newton_tolerance || t.rho_infinity || t.balance);
  const ErrorTolerances tolerances = error_tolerances(t);
  EXPECT_EQ(tolerances.relative, 1e-7);
  EXPECT_EQ(tolerances.position, *t.position_tolerance);
  EXPECT_EQ(tolerances.angular_velocity, *t.angular_velocity_tolerance);
}

TEST(Transient, OutputIsANumberOrAWord) {
  EXPECT_TRUE(ball(R"(duration="1" step="dt" output="steps")").transient->output_steps);
  EXPECT_FALSE(ball(R"(duration="1" step="dt" output="steps")").transient->output);
  EXPECT_EQ(ball(R"(duration="1" step="dt" output="dt/4")").transient->output, 0.0025);
  EXPECT_FALSE(ball(R"(duration="1" step="dt")").transient->output);
  // A parameter of that name is asked about.
  try {
    read_model_text(R"(<mbd name="m"><parameter name="steps" value="2"/>
      <transient duration="1" step="0.1" output="steps"/></mbd>)");
    FAIL();
  } catch (const Error& error) {
    EXPECT_HAS(std::string(error.what()), "(steps)");
  }
  EXPECT_EQ(read_model_text(R"xml(<mbd name="m"><parameter name="steps" value="2"/>
      <transient duration="1" step="0.1" output="(steps)"/></mbd>)xml")
                .transient->output,
            2.0);
}

TEST(Transient, SettingsAreTheMethodsOwnWhereNoneAreGiven) {
  TransientScene t{.duration = 1.0, .step = 0.1};
  EXPECT_EQ(newton_options(t).tolerance, NewtonOptions().tolerance);
  EXPECT_EQ(rho_infinity_of(t), 0.0);
  EXPECT_TRUE(takes_newton_tolerance(t));
  t.method = TimeMethod::radau;
  EXPECT_LT(newton_options(t).tolerance, NewtonOptions().tolerance);
  EXPECT_TRUE(takes_newton_tolerance(t));
  t.newton_tolerance = 1e-5;
  EXPECT_EQ(newton_options(t).tolerance, 1e-5);
  t.step.reset();
  t.tolerance = 1e-6;
  EXPECT_FALSE(takes_newton_tolerance(t));
  EXPECT_EQ(name_of(TimeMethod::generalized_alpha), "generalized_alpha");
  EXPECT_EQ(name_of(TimeMethod::radau), "radau");
  EXPECT_EQ(name_of(TimeMethod::ida), "ida");
}

// ---- when rows are written ---------------------------------------------------------------------

TEST(Rows, AreAtMultiplesOfTheOutputAndAtTheEnd) {
  for (const char* const transient :
       {R"(duration="0.1" step="0.01" output="0.03")",
        R"(duration="0.1" step="0.02" output="0.03")", R"(duration="0.1" step="0.1" output="0.03")",
        R"(duration="0.1" tolerance="1e-6" output="0.03")",
        R"(duration="0.1" method="radau" step="0.05" output="0.03")",
        R"(duration="0.1" method="radau" tolerance="1e-6" output="0.03")"}) {
    SCOPED_TRACE(transient);
    const History history = run_to_table(ball(transient));
    EXPECT_TRUE(history.report.complete()) << history.report.failure;
    ASSERT_EQ(history.table.rows(), 5u);
    EXPECT_EQ(history.report.rows, 5);
    for (std::size_t k = 0; k < 5; ++k) {
      const double t = k < 4 ? 0.03 * static_cast<double>(k) : 0.1;
      EXPECT_NEAR(history.table["time"][k], t, 1e-15);
      // A parabola is exact, inside steps too.
      EXPECT_NEAR(history.table["ball.position.1"][k], 2.0 * t, 1e-12);
      EXPECT_NEAR(history.table["ball.position.3"][k], -9.81 / 2 * t * t, 1e-12);
      EXPECT_NEAR(history.table["ball.velocity.3"][k], -9.81 * t, 1e-11);
      EXPECT_NEAR(history.table["ball.acceleration.3"][k], -9.81, 1e-9);
    }
  }
}

TEST(Rows, AreAThousandByDefaultOfATolerance) {
  const History history = run_to_table(ball(R"(duration="0.5" tolerance="1e-4")"));
  ASSERT_EQ(history.table.rows(), 1001u);
  for (std::size_t k = 0; k <= 1000; ++k)
    EXPECT_NEAR(history.table["time"][k], 5e-4 * static_cast<double>(k), 1e-14);
  EXPECT_LT(history.report.transient_counters.steps, 1000);
}

// A last interval that is shorter, intervals longer than the run, and a duration of no whole number of them.
TEST(Rows, EndWhereTheRunEnds) {
  EXPECT_EQ(run_to_table(ball(R"(duration="0.1" step="0.01" output="3")")).table.rows(), 2u);
  EXPECT_EQ(run_to_table(ball(R"(duration="0.1" step="0.01" output="0.1")")).table.rows(), 2u);
  EXPECT_EQ(run_to_table(ball(R"(duration="1" step="1/3" output="1/7")")).table.rows(), 8u);
  EXPECT_EQ(run_to_table(ball(R"(duration="0.3" step="0.1" output="0.1")")).table.rows(), 4u);
  EXPECT_EQ(run_to_table(ball(R"(duration="7/3" tolerance="1e-3" output="1/3")")).table.rows(), 8u);
}

// Interpolation does not disturb the steps: rows at their ends are the same to the last bit.
TEST(Rows, InsideStepsLeaveTheStepsAsTheyAre) {
  for (const std::string method : {R"(rho_infinity="0.8")", R"(method="radau")"}) {
    const std::string transient = method + R"( step="0.02" )";
    const History steps = run_to_table(pendulum(transient));
    const History dense = run_to_table(pendulum(transient + R"(output="0.005")"));
    const History some = run_to_table(pendulum(transient + R"(output="0.1")"));
    ASSERT_EQ(steps.table.rows(), 51u);
    ASSERT_EQ(dense.table.rows(), 201u);
    ASSERT_EQ(some.table.rows(), 11u);
    for (const std::string name : {"time", "bob.position.1", "bob.velocity.2", "O.angle"}) {
      for (std::size_t k = 0; k <= 50; ++k)
        EXPECT_EQ(steps.table[name][k], dense.table[name][4 * k]) << name << " " << k;
      for (std::size_t k = 0; k <= 10; ++k)
        EXPECT_EQ(steps.table[name][5 * k], some.table[name][k]) << name << " " << k;
    }
    // and between them lies the motion: against steps four times shorter
    const History fine = run_to_table(pendulum(method + R"( step="0.005")"));
    const double error = method.find("radau") == std::string::npos ? 2e-3 : 1e-6;
    for (std::size_t k = 0; k <= 200; ++k)
      EXPECT_NEAR(dense.table["bob.position.1"][k], fine.table["bob.position.1"][k], error) << k;
    EXPECT_EQ(steps.report.transient_counters.iterations,
              dense.report.transient_counters.iterations);
  }
}

TEST(Rows, AtTheEndsOfStepsAndAtTimesOfExpectedValues) {
  Scene scene = pendulum(R"(method="radau" tolerance="1e-9" output="steps")");
  for (const double at : {1.0 / 3.0, 0.25, 1.0, 0.0, 0.25}) {
    ExpectScene expect;
    expect.quantity = "time";
    expect.at = at;
    expect.value = at;
    expect.tolerance = 1e-15;
    scene.expects.push_back(expect);
  }
  const History history = run_to_table(scene);
  EXPECT_TRUE(history.report.as_expected()) << summary(history.report);
  // a row at the start, at each step and at two times inside
  EXPECT_EQ(history.report.rows, history.report.transient_counters.steps + 3);
  for (std::size_t k = 1; k < history.table.rows(); ++k)
    EXPECT_LT(history.table["time"][k - 1], history.table["time"][k]);
  EXPECT_NEAR(history.table["bob.position.1"].back(), x_1, 1e-8);

  scene.transient->tolerance.reset();
  scene.transient->step = 0.05;
  const History fixed = run_to_table(scene);
  EXPECT_TRUE(fixed.report.as_expected()) << summary(fixed.report);
  EXPECT_EQ(fixed.report.rows, 22);  // 0.25 is the end of a step, a third of a second is not
}

TEST(Rows, ExpectedValuesAreAtTheirTimes) {
  Scene scene = pendulum(R"(tolerance="1e-4")");
  ExpectScene expect;
  expect.quantity = "bob.position.1";
  expect.at = 0.0125;
  expect.value = 0.0;
  expect.tolerance = 2.0;
  scene.expects.push_back(expect);
  EXPECT_HAS(message_of(scene), "between rows");
  EXPECT_HAS(message_of(scene), "0.012 and 0.013");
  scene.expects[0].at = 0.0120;
  EXPECT_EQ(message_of(scene), "no error");
  scene.transient->output = 0.3;
  scene.expects[0].at = 1.0;  // the end
  EXPECT_EQ(message_of(scene), "no error");
  scene.transient->output.reset();
  scene.transient->output_steps = true;
  scene.expects[0].at = 0.0125;
  EXPECT_EQ(message_of(scene), "no error");
  scene.expects[0].at = 1.0125;
  EXPECT_HAS(message_of(scene), "after the end");
}

// At a jump the row has what acts from then on, at the end of a step as inside one.
TEST(Rows, AtAJumpAreAfterIt) {
  const std::string push = R"(<load at="ball" force="t&lt;0.5?0:3 0 0"/>)";
  for (const char* const transient :
       {R"(duration="1" step="0.1" output="0.05")",
        R"(duration="1" step="0.4/3*1.5" output="0.05")",
        R"(duration="1" step="0.125" output="0.25")",
        R"(duration="1" tolerance="1e-5" output="0.05")",
        R"(duration="1" method="radau" step="0.2" output="0.1")",
        R"(duration="1" method="radau" tolerance="1e-5" output="0.05")"}) {
    SCOPED_TRACE(transient);
    const History history = run_to_table(ball(transient, push));
    EXPECT_TRUE(history.report.complete()) << history.report.failure;
    for (std::size_t k = 0; k < history.table.rows(); ++k) {
      const double t = history.table["time"][k];
      EXPECT_NEAR(history.table["ball.acceleration.1"][k], t < 0.5 - 1e-9 ? 0.0 : 3.0, 1e-6) << t;
    }
  }
}

// A step that ends at a breakpoint just before its time ends there, and its row is not lost.
TEST(Rows, AtABreakpointBesideTheEndOfAStep) {
  for (const char* const output : {"0.1", "0.2", "0.05"})
    for (const char* const t : {"0.6", "0.59999999999", "0.60000000001"}) {
      const History history =
          run_to_table(ball(R"(duration="1" step="0.1" output=")" + std::string(output) + "\"",
                            R"(<load at="ball" force="t&lt;)" + std::string(t) + R"(?0:3 0 0"/>)"));
      const std::vector<double>& time = history.table["time"];
      ASSERT_EQ(std::lround(1.0 / std::stod(output)) + 1, std::ssize(time)) << output << " " << t;
      for (std::size_t k = 0; k < time.size(); ++k)
        EXPECT_NEAR(time[k], std::stod(output) * static_cast<double>(k), 1e-10) << t;
    }
}

TEST(Rows, UpToAFailureAreKept) {
  for (const char* const transient :
       {R"(duration="1" step="0.01" output="0.004")",
        R"(duration="1" tolerance="1e-5" output="0.004")",
        R"(duration="1" method="radau" tolerance="1e-5" output="0.004")",
        R"(duration="1" method="radau" tolerance="1e-5" output="steps")"}) {
    SCOPED_TRACE(transient);
    const History history =
        run_to_table(ball(transient, R"(<load at="ball" force="sqrt(0.5-t) 0 0"/>)"));
    EXPECT_FALSE(history.report.complete());
    EXPECT_NEAR(history.report.t, 0.5, 0.02);
    ASSERT_GT(history.table.rows(), 5u);
    EXPECT_NEAR(history.table["time"].back(), history.report.t, 0.012);
    EXPECT_EQ(history.report.rows, static_cast<long>(history.table.rows()));
  }
}

class Counts : public Observer {
 public:
  void accepted(const Sample& sample) override {
    last = sample.state.t;
    if (++rows == 10) throw Error("ten are enough");
  }
  int rows = 0;
  double last = 0.0;
};

TEST(Rows, EndWithAnObserverThatHasSeenEnough) {
  Counts counts;
  const RunReport report = run(ball(R"(duration="1" method="radau" tolerance="1e-3")"),
                               {.output = {}, .observers = {&counts}, .progress = {}});
  EXPECT_EQ(report.failure, "ten are enough");
  EXPECT_EQ(counts.rows, 10);
  EXPECT_EQ(report.rows, 9);
  EXPECT_NEAR(counts.last, 9e-3, 1e-12);
}

// ---- methods -----------------------------------------------------------------------------------

TEST(Methods, FindTheSameMotion) {
  struct Case {
    const char* transient;
    double error;
  };
  for (const Case& c : {Case{R"(step="1e-3")", 1e-5},
                        {R"(tolerance="1e-5")", 1e-3},
                        {R"(method="radau" step="0.02")", 1e-7},
                        {R"(method="radau" tolerance="1e-8")", 1e-7},
                        {R"(method="radau" tolerance="1e-4" position_tolerance="1e-9"
                             rotation_tolerance="1e-9" velocity_tolerance="1e-8"
                             angular_velocity_tolerance="1e-8")",
                         1e-7}}) {
    SCOPED_TRACE(c.transient);
    const Scene scene = pendulum(c.transient);
    const History history = run_to_table(scene);
    EXPECT_TRUE(history.report.complete()) << history.report.failure;
    EXPECT_EQ(history.report.t, 1.0);
    EXPECT_NEAR(history.table["bob.position.1"].back(), x_1, c.error);
    // states that were stepped to, not interpolated ones
    EXPECT_LE(history.report.sampled_states, 202);
    EXPECT_GT(history.report.sampled_states, 3);
    EXPECT_LT(history.report.position.value, 1e-12);
    const StepSizes& sizes = history.report.step_sizes;
    if (scene.transient->tolerance) {
      EXPECT_GT(sizes.most, sizes.least);
      EXPECT_GT(sizes.worst_error, 0.0);
      EXPECT_LE(sizes.worst_error, 1.0);
    }
  }
}

TEST(Methods, TakeStepsNoLongerThanAllowed) {
  const History history =
      run_to_table(pendulum(R"(method="radau" tolerance="1e-4" max_step="2 ms" output="steps")"));
  // All but the first, which follows from how fast things move at the start.
  for (std::size_t k = 2; k < history.table.rows(); ++k)
    EXPECT_LE(history.table["time"][k] - history.table["time"][k - 1], 2e-3 * (1 + 1e-9)) << k;
  EXPECT_GT(history.table.rows(), 490u);
}

TEST(Methods, ProgressGoesByTime) {
  std::vector<Progress> seen;
  const RunReport report =
      run(pendulum(R"(method="radau" tolerance="1e-6")"),
          {.output = {}, .progress = [&seen](const Progress& p) { seen.push_back(p); }});
  ASSERT_EQ(std::ssize(seen), report.transient_counters.steps);
  EXPECT_EQ(seen.back().t, seen.back().duration);
  EXPECT_EQ(seen.back().steps, 0);
  EXPECT_EQ(seen.back().step, report.transient_counters.steps);
}

// ---- what is said of them ----------------------------------------------------------------------

nlohmann::json json_of(const RunReport& report) { return nlohmann::json::parse(to_json(report)); }

TEST(TransientReport, HasTheSettingsUsed) {
  nlohmann::json all = json_of(run(pendulum(R"(step="0.01" rho_infinity="0.7")")));
  nlohmann::json used = all["settings"]["transient"];
  EXPECT_EQ(used["method"], "generalized_alpha");
  EXPECT_EQ(used["step"], 0.01);
  EXPECT_EQ(used["output"], 0.01);
  EXPECT_EQ(used["rho_infinity"], 0.7);
  EXPECT_EQ(used["balance"], "acceleration");
  EXPECT_EQ(used["newton_tolerance"], NewtonOptions().tolerance);
  EXPECT_FALSE(used.contains("tolerance"));
  EXPECT_FALSE(all["solver"]["transient"].contains("least_step"));

  const RunReport report =
      run(pendulum(R"(method="radau" tolerance="1e-6" velocity_tolerance="1e-5" max_step="0.03")"));
  all = json_of(report);
  used = all["settings"]["transient"];
  EXPECT_EQ(used["method"], "radau");
  EXPECT_EQ(used["tolerance"], 1e-6);
  EXPECT_EQ(used["velocity_tolerance"], 1e-5);
  EXPECT_EQ(used["max_step"], 0.03);
  EXPECT_EQ(used["output"], 1e-3);
  for (const char* const absent : {"step", "rho_infinity", "balance", "newton_tolerance"})
    EXPECT_FALSE(used.contains(absent)) << absent;
  const nlohmann::json& solver = all["solver"]["transient"];
  EXPECT_EQ(solver["steps"], report.transient_counters.steps);
  EXPECT_EQ(solver["rejected"], report.transient_counters.rejected);
  EXPECT_EQ(solver["least_step"], report.step_sizes.least);
  EXPECT_EQ(solver["most_step"], report.step_sizes.most);
  EXPECT_EQ(solver["largest_error_of_a_step"], report.step_sizes.worst_error);
  EXPECT_EQ(solver["sum_of_errors"]["position"], report.step_sizes.position_error);
  EXPECT_TRUE(report.notes.empty());

  used = json_of(run(pendulum(R"(method="radau" step="0.1" newton_tolerance="1e-9"
                                 output="steps")")))["settings"]["transient"];
  EXPECT_EQ(used["newton_tolerance"], 1e-9);
  EXPECT_EQ(used["output"], "steps");
  EXPECT_FALSE(used.contains("rho_infinity"));
}

TEST(TransientReport, SummaryTellsMethodAndSteps) {
  RunReport report = run(pendulum(R"(method="radau" tolerance="1e-6")"));
  report.transient_counters.rejected = 7;
  const std::string text = summary(report);
  EXPECT_HAS(text, "transient      radau, tolerance 1e-06; ");
  EXPECT_HAS(text, ", 7 rejected");
  EXPECT_HAS(text, "step sizes     from ");
  EXPECT_HAS(text, "estimated errors: ");
  const std::string fixed = summary(run(pendulum(R"(step="0.01")")));
  EXPECT_HAS(fixed, "transient      generalized_alpha, step 0.01 s; 100 steps");
  EXPECT_EQ(fixed.find("step sizes"), std::string::npos);
}

TEST(TransientReport, CheckAndExplainTellThePlan) {
  const auto plan = [](const Scene& scene) {
    std::string text = to_text(check_model(scene, compile(scene)));
    for (std::size_t at; (at = text.find("\n     ")) != std::string::npos;)
      text.replace(at, text.find_first_not_of(" \n", at) - at, " ");
    return text;
  };
  EXPECT_HAS(plan(pendulum(R"(step="0.01")")),
             "transient of 1 s by generalized_alpha in 100 steps of 0.01 s\n");
  EXPECT_HAS(plan(pendulum(R"(method="radau" step="0.01" output="0.005")")),
             "transient of 1 s by radau in 100 steps of 0.01 s, rows every 0.005 s");
  const Scene adaptive = pendulum(R"(method="radau" tolerance="1e-6" output="steps")");
  EXPECT_HAS(
      plan(adaptive),
      "transient of 1 s by radau of as many stages as come farthest, steps for a tolerance of "
      "1e-06, rows where they end");
  const nlohmann::json json =
      nlohmann::json::parse(to_json(check_model(adaptive, compile(adaptive))));
  EXPECT_EQ(json["settings"]["transient"]["method"], "radau");
  EXPECT_EQ(json["settings"]["transient"]["tolerance"], 1e-6);
  EXPECT_FALSE(json["settings"]["transient"].contains("step"));
  EXPECT_HAS(
      plan(pendulum(R"(method="radau" tolerance="1e-6" velocity_tolerance="2" max_step="0.1")")),
      "tolerance of 1e-06, velocity_tolerance 2 m/s, max_step 0.1 s, rows every 0.001 s");
  const std::string explained = to_text(explain_model(adaptive, compile(adaptive)));
  EXPECT_HAS(explained, "by radau");
  EXPECT_EQ(explained.find("rho_infinity"), std::string::npos) << explained;
}

TEST(TransientReport, OnlyGeneralizedAlphaIsWarnedOfRho) {
  EXPECT_EQ(run(pendulum(R"(step="0.01" rho_infinity="1")")).notes.size(), 1u);
  EXPECT_EQ(run(pendulum(R"(step="0.01" method="radau")")).notes.size(), 0u);
}

// ---- the command line --------------------------------------------------------------------------

class TransientCommand : public testing::Test {
 protected:
  test::Output run_model(const std::string& model, const std::string& arguments) const {
    return shell(quote(test::mbd_program) + " run " + quote((models / model).string()) + " --out " +
                 quote(directory_.path().string()) + " " + arguments);
  }
  nlohmann::json settings() const { return report()["settings"]["transient"]; }
  nlohmann::json report() const {
    return nlohmann::json::parse(test::read_text(directory_.path() / "report.json"));
  }
  test::Table history() const { return test::read_csv(directory_.path() / "history.csv"); }

  const test::TemporaryDirectory directory_;
};

TEST_F(TransientCommand, AnotherMethodKeepsTheRows) {
  ASSERT_EQ(run_model("pendulum.xml", "--set step=0.01").status, 2);  // too coarse
  const test::Table before = history();
  const test::Output output =
      run_model("pendulum.xml", "--set step=0.01 --method radau --tolerance 1e-9");
  EXPECT_EQ(output.status, 0) << output.text;
  EXPECT_EQ(settings()["method"], "radau");
  EXPECT_EQ(settings()["tolerance"], 1e-9);
  EXPECT_EQ(settings()["output"], 0.01);
  EXPECT_HAS(output.text, "note: rho_infinity of the model is not used");
  EXPECT_HAS(std::string(report()["notes"][0]), "rho_infinity");
  const test::Table after = history();
  ASSERT_EQ(after.rows(), before.rows());
  for (std::size_t k = 0; k < after.rows(); ++k)
    EXPECT_NEAR(after["time"][k], before["time"][k], 1e-12);

  EXPECT_EQ(run_model("pendulum.xml", "-m radau --step '10 ms' --output 0.5 -q").status, 0);
  EXPECT_EQ(settings()["step"], 0.01);
  EXPECT_EQ(history().rows(), 21u);
  EXPECT_EQ(run_model("pendulum.xml", "-t 1e-7 --output steps -q").status, 0);
  EXPECT_EQ(settings()["method"], "generalized_alpha");
  EXPECT_EQ(settings()["rho_infinity"], 0.9);
  EXPECT_EQ(settings()["output"], "steps");
  EXPECT_EQ(run_model("pendulum.xml", "-m radau -t 1e-9 --stages 7 -q").status, 0);
  EXPECT_EQ(settings()["stages"], "7");
  EXPECT_EQ(run_model("pendulum.xml", "-m radau -t 1e-9 --stages auto -q").status, 0);
  EXPECT_EQ(settings()["stages"], "auto");
  EXPECT_EQ(run_model("pendulum.xml", "--step step/2 -q").status, 0);  // a parameter of the model
  EXPECT_EQ(settings()["step"], 0.5e-3);
}

TEST_F(TransientCommand, FixedStepsTakeThePlaceOfATolerance) {
  const test::Output output = run_model("cart_pole.xml", "--step 0.01 --method radau");
  EXPECT_EQ(settings()["step"], 0.01) << output.text;
  EXPECT_FALSE(settings().contains("tolerance"));
  EXPECT_EQ(settings()["output"], "steps");
  // balance and the tolerance of the iterations go with generalized_alpha
  const test::Output beam =
      run_model("free_beam.xml", "--method radau --tolerance 1e-5 --set step=0.25");
  EXPECT_NE(beam.status, 1) << beam.text;
  EXPECT_HAS(beam.text, "balance of the model is not used");
  EXPECT_HAS(beam.text, "newton_tolerance of the model is not used");
}

TEST_F(TransientCommand, RefusesWhatCannotBe) {
  const auto said = [&](const std::string& model, const std::string& arguments) {
    const test::Output output = run_model(model, arguments);
    EXPECT_GE(output.status, 1) << arguments;
    EXPECT_EQ(std::count(output.text.begin(), output.text.end(), '\n'), output.status == 1 ? 1 : 2)
        << output.text;
    EXPECT_TRUE(fs::is_empty(directory_.path()));
    return output.text;
  };
  EXPECT_HAS(said("pendulum.xml", "--method ida"), "--tolerance");
  EXPECT_HAS(said("pendulum.xml", "--method rk4"), "radau");
  EXPECT_HAS(said("pendulum.xml", "--step '2 kg'"), "--step 2 kg: ");
  EXPECT_HAS(said("pendulum.xml", "--step=-1"), "must be positive");
  EXPECT_HAS(said("pendulum.xml", "--step 0.3"), "whole number of steps");
  EXPECT_HAS(said("pendulum.xml", "--step stp"), "step");
  EXPECT_HAS(said("pendulum.xml", "--tolerance 0"), "between 1e-14 and 0.1");
  EXPECT_HAS(said("pendulum.xml", "--tolerance 1e-3 --step 0.1"), "give one of them");
  EXPECT_HAS(said("pendulum.xml", "--stages 5"), "add --method radau");
  EXPECT_HAS(said("pendulum.xml", "--method radau --stages 4"), "--stages");
  EXPECT_HAS(said("pendulum.xml", "--method radau --step 0.01 --stages auto"), "--tolerance");
  EXPECT_HAS(said("pendulum.xml", "--output stepps"), "--output stepps: ");
  EXPECT_HAS(said("pendulum.xml", "--output 0.3"), "between rows");
  EXPECT_HAS(said("bend45.xml", "--method radau"), "no <transient>");
  EXPECT_HAS(said("bend45.xml", "--output 1"), "--output");
}

TEST_F(TransientCommand, IsInTheHelpAndCompleted) {
  const test::Output help = shell(quote(test::mbd_program) + " run --help");
  for (const char* const option :
       {"-m, --method", "--step H", "-t, --tolerance T", "--output DT", "--tolerance 1e-8"})
    EXPECT_HAS(help.text, option);
  const test::Output completion = shell(quote(test::mbd_program) + " completion bash");
  EXPECT_HAS(completion.text, "--method) kind=words words='generalized_alpha radau ida'");
}

}  // namespace
}  // namespace mbd::test::test_time_stepping
