// Peaks of laws of the motion that steps would go over: of a spring, a damper, a table, a load with sensors, against closed forms; what
// fixed steps go over is told, and what is no peak costs nothing.
// Seen to fail: all but the last before there was a look at features, the tent while a step might go over six knots of a table.
#include "solvers/laws/passed_features.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "tests/support/certificates.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_passed_features {
namespace {

// A free mass of 1 with a speed of 1 on a rail, and something in its way.
std::string on_rail(const std::string& in_its_way, const std::string& settings) {
  return fmt::format(
      R"(<body name="b" mass="1" inertia="1 1 1" velocity="1 0 0"/>
         <prismatic name="rail" between="ground b" axis="1 0 0"/>{}
         <transient duration="10" output="0.1" {}/>
         <record name="b" joint="rail" quantities="displacement speed"/>)",
      in_its_way, settings);
}

double last_speed(const std::string& model) {
  const History h = run_to_table(read(model));
  EXPECT_EQ(h.report.failure, "");
  return h.table["b.speed"].back();
}

const char* const adaptive[] = {R"(method="radau" tolerance="1e-4")",
                                R"(method="radau" tolerance="1e-7")",
                                R"(method="radau" tolerance="1e-4" stages="5")",
                                R"(method="generalized_alpha" tolerance="1e-5")"};

// A hill of the energy 80 w pi^1/2 that is w wide: v^2 = 1 - 2 80 w pi^1/2 beyond it.
TEST(PassedFeatures, HillsOfAnyWidthAreMet) {
  for (const double w : {1e-4, 1e-3, 0.02})
    for (const char* const settings : adaptive) {
      const double height = 0.08 / w, v = std::sqrt(1.0 - 2.0 * 0.08 * std::sqrt(std::numbers::pi));
      const std::string spring = fmt::format(
          R"xml(<joint_spring name="s" joint="rail" force="{}*exp(-((x-5.234)/{})^2)"/>)xml",
          height, w);
      const std::string load = fmt::format(
          R"xml(<load at="b" force="-{}*exp(-((rail.displacement-5.234)/{})^2) 0 0"/>)xml", height,
          w);
      EXPECT_NEAR(last_speed(on_rail(spring, settings)), v, 2e-3) << w << " " << settings;
      EXPECT_NEAR(last_speed(on_rail(load, settings)), v, 2e-3) << w << " " << settings;
    }
}

// Beside another sensor, which stays at 0, or is what the hill is multiplied with and stays at 1.
TEST(PassedFeatures, OfSeveralSensorsEachIsLookedAt) {
  const double v = std::sqrt(1.0 - 2.0 * 0.08 * std::sqrt(std::numbers::pi));
  for (const char* const force :
       {"-80*exp(-((rail.displacement-other.displacement-5.234)/0.001)^2)",
        "-80*(1+other.displacement)*exp(-((rail.displacement-5.234)/0.001)^2)"})
    EXPECT_NEAR(last_speed(on_rail(fmt::format(R"(<body name="c" mass="1" inertia="1 1 1"/>
            <prismatic name="other" between="ground c" axis="1 0 0"/>
            <load at="b" force="{} 0 0"/>)",
                                               force),
                                   adaptive[0])),
                v, 2e-3)
        << force;
}

// A tent of a table: the energy is its area.
TEST(PassedFeatures, TentsOfTablesAreMet) {
  const std::string tent = R"(<joint_spring name="s" joint="rail">
      <table interpolation="linear">-1 0  5 0  5.001 200  5.002 0  20 0</table></joint_spring>)";
  for (const char* const settings : adaptive)
    EXPECT_NEAR(last_speed(on_rail(tent, settings)), std::sqrt(1.0 - 2.0 * 0.2), 2e-3) << settings;
}

// A damper that holds just below the speed of its peak, where 0.2 v + 40 exp(..) is the force that drives: a barrier that a step in
// velocity passed over, to an end 8 m away.
TEST(PassedFeatures, ABarrierOfSpeedHolds) {
  for (const char* const settings : adaptive) {
    const std::string model = fmt::format(
        R"xml(<body name="b" mass="1" inertia="1 1 1"/>
           <prismatic name="rail" between="ground b" axis="1 0 0"/>
           <joint_spring name="s" joint="rail" damping_force="0.2*v+40*exp(-((v-0.5)/0.0005)^2)"/>
           <load at="b" force="0.4 0 0"/><transient duration="10" output="0.1" {}/>
           <record name="b" joint="rail" quantities="displacement speed"/>)xml",
        settings);
    // 40 exp(-y^2) = 0.4 - 0.2 v, v = 0.5 - 0.0005 y.
    double v = 0.499;
    for (int i = 0; i < 50; ++i) v = 0.5 - 0.0005 * std::sqrt(std::log(40.0 / (0.4 - 0.2 * v)));
    EXPECT_NEAR(last_speed(model), v, 1e-4) << settings;
  }
}

// Found by a reviewer: a peak between three kinks of conditions is two pieces, and cells of smooth laws were allowed four. A damper
// that a push of 1 N does not overcome: v' = 1 - 5 (v - 0.5)/w from 0.5 s on. And a spring that turns the mass round.
// Killed: places of conditions taken for cells.
TEST(PassedFeatures, TentsOfConditionsAreMet) {
  for (const double w : {1e-4, 5e-3})
    for (const char* const settings : adaptive) {
      // A step of generalized_alpha has a solution beyond so narrow a peak, and may take it (models/MANUAL.md).
      if (w < 1e-3 && std::string_view(settings).find("alpha") != std::string_view::npos) continue;
      const auto tent = [w](const char* x, double at, double height) {
        return fmt::format(
            "{0} > {1} ? ({0} > {1}+{2} ? ({0} > {1}+2*{2} ? 0 : {3}*({1}+2*{2}-{0})/{2}) : "
            "{3}*({0}-{1})/{2}) : 0",
            x, at, w, height);
      };
      const History h = run_to_table(read(fmt::format(
          R"xml(<body name="b" mass="1" inertia="1 1 1"/><prismatic name="rail" between="ground b" axis="1 0 0"/>
             <joint_spring name="s" joint="rail" damping_force="{}"/><load at="b" force="1 0 0"/>
             <transient duration="2" output="0.1" {}/>
             <record name="b" joint="rail" quantities="displacement speed"/>)xml",
          tent("v", 0.5, 5.0), settings)));
      ASSERT_EQ(h.report.failure, "");
      EXPECT_NEAR(h.table["b.speed"].back(), 0.5 + w / 5.0, 1e-3) << w << " " << settings;
      EXPECT_NEAR(h.table["b.displacement"].back(), 0.875, 3e-3) << w << " " << settings;
      const std::string spring = fmt::format(
          R"xml(<joint_spring name="s" joint="rail" force="{}"/>)xml", tent("x", 5.234, 0.6 / w));
      EXPECT_NEAR(last_speed(on_rail(spring, settings)), -1.0, 4e-3) << w << " " << settings;
    }
}

// Steps that are what they are say so.
TEST(PassedFeatures, FixedStepsSaySo) {
  const std::string hill =
      R"xml(<joint_spring name="s" joint="rail" force="80*exp(-((x-5.234)/0.001)^2)"/>)xml";
  for (const auto& [settings, told] : {std::pair{R"(method="radau" step="0.1")", true},
                                       {R"(method="generalized_alpha" step="0.05")", true},
                                       {R"(method="radau" step="2e-4")", false}}) {
    const History h = run_to_table(read(on_rail(hill, settings)));
    const Check* const check = find(h.report.certificate, "kinks passed over");
    EXPECT_EQ(check != nullptr, told) << settings;
  }
}

// A friction that turns round within 1e-3 m/s goes over many cells at each turn, but to no peak; a spring of the third degree has one.
TEST(PassedFeatures, FrictionIsNoPeak) {
  const auto steps = [](const std::string& law) {
    const History h = run_to_table(read(fmt::format(
        R"(<body name="b" mass="1" inertia="1 1 1" velocity="1 0 0"/>
           <prismatic name="rail" between="ground b" axis="1 0 0"/>
           <joint_spring name="spring" joint="rail" stiffness="4" {}/>
           <transient duration="10" output="0.1" method="radau" tolerance="1e-6"/>
           <record name="b" joint="rail" quantities="displacement"/>)",
        law)));
    EXPECT_EQ(h.report.failure, "");
    return h.report.transient_counters;
  };
  // Counts, of Radau's steps without a look at features: regression.
  EXPECT_LE(steps(R"(force="0.5*x^3")").steps, 60);
  EXPECT_LE(steps(R"xml(damping_force="0.1*tanh(v/1e-3)")xml").steps, 250);
}

}  // namespace
}  // namespace mbd::test::test_passed_features
