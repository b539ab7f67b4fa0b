// Steps that a switching time or a law of time cuts short, and the whole ones after them.
//
// Tried in the library, and killed: no restart after a first step that is cut short, or after each; none before a step that outgrows
// the last; accelerations taken however large they are; those that lag behind scaled with every step; an impulse that goes on
// where a controller has jumped; the second run of the estimate reaching as far as the first.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/support/certificates.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_cut_short {
namespace {

// Two arms on parallel hinges, without gravity, and a moment on the first: 20 N.m, and -20 from `jump` on. In absolute angles,
// by Lagrange's equations and RK4 in steps that end on the jump.
class TwoArms {
 public:
  static constexpr double end = 1.0, m2 = 0.7, l = 0.6, c2 = 0.25;
  static constexpr double A = 0.05 + 1.3 * 0.3 * 0.3 + m2 * l * l, B = 0.02 + m2 * c2 * c2;

  // Relative angles at the end, and the largest force of the first hinge.
  static std::array<double, 3> after(double jump) {
    std::array<double, 4> y{};
    double most = 0.0;
    go(y, 20.0, jump, most);
    go(y, -20.0, end - jump, most);
    return {y[0], y[1] - y[0], most};
  }
  static std::string scene(const std::string& law, double rho) {
    return fmt::format(R"x({}
      <body name="a" at="0 0 0" mass="1.3" center="0.3 0 0" inertia="0.02 0.05 0.05"/>
      <body name="b" at="0.6 0 0" mass="0.7" center="0.25 0 0" inertia="0.01 0.02 0.02"/>
      <revolute name="j1" between="ground a" at="0 0 0" axis="0 1 0"/>
      <revolute name="j2" between="a b" at="0.6 0 0" axis="0 1 0"/>
      <joint_torque joint="j1" moment="y"/>
      <transient duration="1" step="1e-3" rho_infinity="{}"/>
      <record name="j1" joint="j1" quantities="angle reaction_force"/>
      <record name="j2" joint="j2" quantities="angle"/>)x",
                       law, rho);
  }

 private:
  static std::array<double, 4> rate(const std::array<double, 4>& y, double moment) {
    const double d = y[1] - y[0], C = m2 * l * c2 * std::cos(d), S = m2 * l * c2 * std::sin(d);
    const double f = moment + S * y[3] * y[3], g = -S * y[2] * y[2], det = A * B - C * C;
    return {y[2], y[3], (B * f - C * g) / det, (A * g - C * f) / det};
  }
  // Mass times acceleration of both.
  static double force(const std::array<double, 4>& y, double moment) {
    constexpr double m1 = 1.3, c1 = 0.3;
    const std::array<double, 4> now = rate(y, moment);
    const double w1 = now[0], w2 = now[1], a1 = now[2], a2 = now[3];
    const auto along = [&](double r1, double r2, double c, double s) {
      return r1 * (a1 * -s - w1 * w1 * c) + r2 * (a2 * -std::sin(y[1]) - w2 * w2 * std::cos(y[1]));
    };
    const auto across = [&](double r1, double r2, double c, double s) {
      return r1 * (a1 * c - w1 * w1 * s) + r2 * (a2 * std::cos(y[1]) - w2 * w2 * std::sin(y[1]));
    };
    const double c = std::cos(y[0]), s = std::sin(y[0]), r1 = m1 * c1 + m2 * l, r2 = m2 * c2;
    return std::hypot(along(r1, r2, c, s), across(r1, r2, c, s));
  }
  static void go(std::array<double, 4>& y, double moment, double duration, double& most) {
    constexpr int steps = 20'000;
    const double h = duration / steps;
    const auto moved = [&](const std::array<double, 4>& k, double by) {
      std::array<double, 4> x = y;
      for (std::size_t i = 0; i < 4; ++i) x[i] += by * k[i];
      return x;
    };
    for (int n = 0; n < steps; ++n) {
      most = std::max(most, force(y, moment));
      const auto k1 = rate(y, moment), k2 = rate(moved(k1, h / 2), moment),
                 k3 = rate(moved(k2, h / 2), moment), k4 = rate(moved(k3, h), moment);
      for (std::size_t i = 0; i < 4; ++i) y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    }
  }
};

// Controllers whose instants lie a little before the ends of steps, down to the round-off of times, and a jump of a law there:
// motion and reactions are those of whole steps. (Accelerations of a step are increments over h^2: they were wrong by 1e7, runs
// ended, and the whole steps that followed had angles wrong by 0.5 to 10 rad.)
TEST(CutShort, StepsLeaveTheMotionAsItIs) {
  for (const double rho : {0.0, 0.8})
    for (const double period : {10e-3, 9.999e-3, 9.9999e-3, 9.999999e-3, 3.333e-3, 3.3333e-3}) {
      SCOPED_TRACE(fmt::format("period {}, rho {}", period, rho));
      const double jump = (std::floor(0.455 / period) + 1.0) * period;
      const std::array<double, 3> right = TwoArms::after(jump);
      const History history =
          run_to_table(read(TwoArms::scene(fmt::format(R"x(<controller name="c" period="{:.17g}">
                            <output name="y" start="20" value="t > 0.455 ? -20 : 20"/></controller>)x",
                                                       period),
                                           rho)));
      ASSERT_EQ(history.report.failure, "");
      // Of whole steps: 0.059 rad with rho = 0, 0.0014 with 0.8.
      const double allowed = rho == 0.0 ? 0.15 : 4e-3;
      EXPECT_NEAR(history.table["j1.angle"].back(), right[0], allowed);
      EXPECT_NEAR(history.table["j2.angle"].back(), right[1], 5.0 * allowed);
      double most = 0.0;
      const auto &x = history.table["j1.reaction_force.1"],
                 &z = history.table["j1.reaction_force.2"];
      for (std::size_t i = 0; i < x.size(); ++i) most = std::max(most, std::hypot(x[i], z[i]));
      EXPECT_NEAR(most, right[2], 0.05 * right[2]);
      const Check* const momentum = find(history.report.certificate, "linear momentum");
      ASSERT_NE(momentum, nullptr);
      EXPECT_EQ(momentum->verdict, Verdict::pass) << words(history.report.certificate);
    }
}

// Of one law, without a controller: 1e-8 s before the end of a step.
TEST(CutShort, AJumpJustBeforeTheEndOfAStep) {
  for (const double before : {1e-5, 1e-6, 1e-8}) {
    std::string text = TwoArms::scene("", 0.8);
    const std::string law = fmt::format("t > {:.17g} ? -20 : 20", 0.45 - before);
    text.replace(text.find("moment=\"y\""), 10, "moment=\"" + law + "\"");
    const History history = run_to_table(read(text));
    ASSERT_EQ(history.report.failure, "");
    const std::array<double, 3> right = TwoArms::after(0.45 - before);
    EXPECT_NEAR(history.table["j1.angle"].back(), right[0], 4e-3) << before;
    EXPECT_NEAR(history.table["j2.angle"].back(), right[1], 2e-2) << before;
  }
}

// What is cut short by the knots of a table, which says next to nothing, is not begun anew each time: an oscillator without
// damping keeps its energy as in whole steps of their size (99.88 % at 1 ms, rho = 0; begun anew: 61 %).
TEST(CutShort, DenseKnotsDampNoMore) {
  for (const double every : {1e-3, 1.3e-3}) {
    std::string table;
    for (int k = 0; k * every <= 5.0 + every; ++k)
      table += fmt::format("{:.17g} {:.17g} ", k * every, 1e-9 * (k % 2));
    const History history = run_to_table(read(fmt::format(R"x(<function name="f">{}</function>
        <body name="b" at="0 0 0" mass="1" inertia="1 1 1" velocity="2 0 0"/>
        <prismatic name="p" between="ground b" at="0 0 0" axis="1 0 0"/>
        <joint_spring name="s" joint="p" stiffness="400"/>
        <load at="b" force="f(t) 0 0"/>
        <transient duration="5" step="0.01"/>
        <record name="b" at="b" quantities="displacement velocity"/>)x",
                                                          table)));
    ASSERT_EQ(history.report.failure, "");
    const double x = history.table["b.displacement.1"].back(),
                 v = history.table["b.velocity.1"].back();
    EXPECT_NEAR((0.5 * v * v + 200.0 * x * x) / 2.0, 1.0, 0.01) << every;
    EXPECT_LT(history.report.transient_counters.factorizations, 2000) << every;
  }
}

// A driven slider-crank of equal lengths, at 1 s in the position where its slider may go either way; a load of next to nothing
// has a kink near there. Accelerations there are anything: steps that are cut short do not take them. It goes on through.
TEST(CutShort, BesideASingularPosition) {
  for (const double kink : {1.0 - 1e-6, 1.0, 1.0 + 1e-6}) {
    const History history = run_to_table(read(fmt::format(R"x(
        <body name="crank" at="0 0 0" center="0.5 0 0" mass="1" inertia="0.1 0.1 0.1" angular_velocity="0 0 pi/2"/>
        <body name="rod" at="1 0 0" center="0.5 0 0" mass="1" inertia="0.1 0.1 0.1" angular_velocity="0 0 -pi/2"
          velocity="0 pi/2 0"/>
        <body name="slider" at="2 0 0" mass="1" inertia="0.1 0.1 0.1"/>
        <revolute name="o" between="ground crank" at="0 0 0" axis="0 0 1"/>
        <revolute name="p" between="crank rod" at="1 0 0" axis="0 0 1"/>
        <revolute name="q" between="rod slider" at="2 0 0" axis="0 0 1"/>
        <prismatic name="s" between="ground slider" axis="1 0 0"/>
        <drive joint="o" angle="t*pi/2"/>
        <load at="slider" force="t&lt;{0:.17g}?0:1e-3*(t-{0:.17g}) 0 0"/>
        <transient duration="0.0099*200" step="0.0099"/>
        <record name="s" joint="s" quantities="displacement speed"/>)x",
                                                          kink)));
    ASSERT_EQ(history.report.failure, "");
    // x = 2 cos(pi t/2) - 2
    EXPECT_NEAR(history.table["s.displacement"].back(),
                2.0 * std::cos(std::numbers::pi / 2.0 * 1.98) - 2.0, 1e-6)
        << kink;
    for (const double speed : history.table["s.speed"]) EXPECT_LT(std::abs(speed), 3.2) << kink;
  }
}

std::string blow(double width, const std::string& settings) {
  return fmt::format(R"x(<body name="b" at="0 0 0" mass="2" inertia="1 1 1"/>
      <load at="b" force="0 0 exp(-((t-2.2137)/{0:.17g})^2)/{0:.17g}"/>
      <transient duration="10" output="0.1" {1}/>
      <record name="b" at="b" quantities="velocity"/>)x",
                     width, settings);
}
// Of the blow: the integral of the force over the mass.
const double speed = std::sqrt(std::numbers::pi) / 2.0;

// Adaptive steps after a short and smooth pulse grow by 6 each: what dies out in the algorithmic accelerations by half a step was
// scaled up with them, and the velocity became 11 to 1e9 times as large. Reference: impulse over mass.
TEST(CutShort, AdaptiveStepsAfterAPulse) {
  for (const double width : {1e-3, 1e-4, 1e-6})
    for (const double tolerance : {0.01, 1e-4})
      for (const double rho : {0.0, 0.6, 0.9}) {
        const History history = run_to_table(read(
            blow(width, fmt::format(R"x(tolerance="{}" rho_infinity="{}")x", tolerance, rho))));
        ASSERT_EQ(history.report.failure, "");
        EXPECT_NEAR(history.table["b.velocity.3"].back(), speed, 0.05 * speed)
            << width << " " << tolerance << " " << rho;
      }
}

// Where laws limit the steps, a second run at ten times the tolerance would take the same, and find no error: it reaches over
// more of the law. The error that is believed is no less than a tenth of the true one.
TEST(CutShort, EstimatesSeeStepsThatLawsLimit) {
  for (const auto& [width, settings] :
       {std::pair{1e-6, R"x(method="radau" stages="5" tolerance="1e-2")x"},
        std::pair{1e-6, R"x(method="radau" stages="7" tolerance="1e-2")x"},
        std::pair{1e-6, R"x(method="radau" tolerance="1e-4")x"},
        std::pair{1e-4, R"x(method="radau" tolerance="1e-3")x"},
        std::pair{1e-4, R"x(tolerance="1e-3")x"}}) {
    TableMaker maker(1);
    const RunReport report = run(read(blow(width, settings)), {.observers = {&maker}});
    ASSERT_EQ(report.failure, "");
    const double error = std::abs(maker.table["b.velocity.3"].back() / speed - 1.0);
    ASSERT_TRUE(report.time_error && report.time_error->known);
    EXPECT_GT(report.time_error->relative, 0.1 * error) << width << " " << settings;
  }
}

// Found by a reviewer: pulses narrower than a millionth of a fixed step were dropped, and certified. An impulse of 1 N.s on 1 kg at
// 1 m/s, at an instant that is an end of steps and at one that is not.
// Killed: instants nearer than that taken for one.
TEST(CutShort, NarrowPulsesHaveTheirImpulse) {
  for (const double width : {1e-6, 1e-8, 1e-10})
    for (const double at : {0.2, 0.2037})
      for (const char* settings : {R"(step="0.01")", R"(step="0.01" method="radau")",
                                   R"(step="0.01" rho_infinity="0.5")"}) {
        TableMaker maker(1);
        const RunReport report = run(read(fmt::format(R"x(
              <body name="b" mass="1" inertia="1 1 1" velocity="1 0 0"/>
              <prismatic name="r" between="ground b" axis="1 0 0"/>
              <load at="b" force="t>={0}&amp;&amp;{0}+{1}>t?1/{1}:0 0 0"/>
              <transient duration="1" output="0.1" {2}/>
              <record name="r" joint="r" quantities="displacement speed"/>)x",
                                                      at, width, settings)),
                                     {.observers = {&maker}});
        ASSERT_EQ(report.failure, "") << width << " " << settings;
        // The width is known to round-off of the time.
        const double tolerance = 1e-7 + 1e-16 / width;
        EXPECT_NEAR(maker.table["r.speed"].back(), 2.0, tolerance) << width << " " << settings;
        EXPECT_NEAR(maker.table["r.displacement"].back(), 2.0 - at, tolerance + width)
            << width << " " << settings;
      }
}

// A force that a controller steps up: fixed steps are right to round-off, and so is the balance of momentum. (The impulse of a
// piece began with the force before the step.)
TEST(CutShort, ImpulsesOfSampledForces) {
  for (const char* settings : {R"x(step="0.05")x", R"x(method="radau" step="0.05")x",
                               R"x(method="ida" tolerance="1e-6")x"}) {
    const History history = run_to_table(read(fmt::format(
        R"x(<controller name="c" period="0.1"><output name="v" value="floor(t/0.1+1e-9)"/>
      </controller><body name="a" at="2 0 0" mass="1" inertia="1 1 1"/><load at="a" force="0 0 v"/>
      <record name="a" at="a" quantities="velocity"/><transient duration="1" {}/>)x",
        settings)));
    ASSERT_EQ(history.report.failure, "");
    EXPECT_NEAR(history.table["a.velocity.3"].back(), 4.5, 1e-5) << settings;
    const Check* const momentum = find(history.report.certificate, "linear momentum");
    ASSERT_NE(momentum, nullptr);
    EXPECT_LT(momentum->value, 1e-5) << settings;
  }
}

}  // namespace
}  // namespace mbd::test::test_cut_short
