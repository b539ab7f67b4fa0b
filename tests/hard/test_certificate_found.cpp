// Runs that are right and that certificates failed, found by a reviewer, and one that is wrong.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <utility>

#include "tests/hard/hard_case.hpp"
#include "tests/support/certificates.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/shell.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/this_build.hpp"

namespace mbd::test::test_certificate_found {
namespace {

namespace fs = std::filesystem;

std::string beam(const std::string& rest) {
  return R"(<mbd name="s"><section name="s">
      <stiffness EA="4e6" GA2="2e6" GA3="1.5e6" GJ="300" EI2="500" EI3="900"/>
      <mass per_length="1.3" inertia="0.1 0.04 0.06"/></section>
      <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="2" order="4"/>)" +
         rest + "</mbd>";
}

// A section that varies within an element: a linear moment is known exactly, and the deflection is not. Rotation of a tip by a moment
// M: M/L int ds/EI, of EI falling linearly from 100 to e: M ln(100/e)/(100 - e); the check is about its error. And a step of the
// section in one element. Mutation: D of the points of the rule for that of the section.
TEST(CertificateFound, MeshesOfSectionsThatVary) {
  const auto report = [](const std::string& stations, int elements, int order) {
    return run_to_table(read_model_text(fmt::format(
        R"(<mbd name="m"><section name="s">{}</section>
        <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="{}" order="{}"/>
        <fixed name="w" between="ground b.start"/><load at="b.end" moment="0 1e-3 0"/><static/>
        <record name="t" at="b.end" quantities="rotation"/></mbd>)",
        stations, elements, order)));
  };
  const auto station = [](double at, double EI) {
    return fmt::format(
        R"(<station at="{}"><stiffness EA="1e7" GA2="5e6" GA3="5e6" GJ="80" EI2="{}" EI3="120"/></station>)",
        at, EI);
  };
  struct Case {
    double e;
    int elements, order;
  };
  for (const auto& [e, elements, order] : {Case{10, 1, 3}, Case{10, 1, 2}, Case{1, 1, 3},
                                           Case{1, 4, 3}, Case{50, 1, 2}, Case{1, 8, 4}}) {
    const History history = report(station(0, 100) + station(1, e), elements, order);
    const double exact = 1e-3 * std::log(100 / e) / (100 - e),
                 error = std::abs(history.table["t.rotation.2"].back() / exact - 1.0);
    const Check* const mesh = find(history.report.certificate, "mesh");
    ASSERT_NE(mesh, nullptr);
    EXPECT_GT(mesh->value, 0.7 * error) << e << " " << elements << " " << order;
    EXPECT_LT(mesh->value, 1.5 * error + 1e-6) << e << " " << elements << " " << order;
    EXPECT_EQ(mesh->verdict == Verdict::pass, mesh->value < 0.01);
  }
  const History step =
      report(station(0, 100) + station(0.499, 100) + station(0.501, 1) + station(1, 1), 1, 3);
  const double exact = 1e-3 * (0.5 / 100 + 0.5),
               error = std::abs(step.table["t.rotation.2"].back() / exact - 1.0);
  EXPECT_GT(error, 0.3);
  EXPECT_GT(find(step.report.certificate, "mesh")->value, 0.7 * error);
}

// Distributed loads that go up and down between nodes: sin(20 s) on two elements of order 3 is 5 times as large there as in truth
// (deflection of the tip, u = int q s^2 (3 L - s)/(6 EI) ds). Mutation: no check of it.
TEST(CertificateFound, DistributedLoadsThatNodesDoNotResolve) {
  const auto history = [](const std::string& force, int elements, int order) {
    return run_to_table(read_model_text(fmt::format(
        R"(<mbd name="m"><section name="s">
        <stiffness EA="1e7" GA2="5e8" GA3="5e8" GJ="80" EI2="100" EI3="100"/></section>
        <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="{}" order="{}"/>
        <fixed name="w" between="ground b.start"/><distributed beam="b" force="0 0 {}"/><static/>
        <record name="t" at="b.end" quantities="displacement"/></mbd>)",
        elements, order, force)));
  };
  double exact = 0.0;
  constexpr int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double s = (i + 0.5) / n;
    exact += std::sin(20 * s) * s * s * (3 - s) / 600 / n;
  }
  for (const auto& [elements, order] :
       {std::pair{1, 3}, std::pair{2, 3}, std::pair{7, 3}, std::pair{20, 4}}) {
    const History h = history("1e-3*sin(20*s)", elements, order);
    const double error = std::abs(h.table["t.displacement.3"].back() / (1e-3 * exact) - 1.0);
    const Check* const loads = find(h.report.certificate, "distributed loads");
    ASSERT_NE(loads, nullptr);
    EXPECT_EQ(loads->verdict == Verdict::pass, elements == 20) << loads->value << " " << error;
    EXPECT_GT(loads->value, 0.2 * error) << elements;
  }
  // However narrow it is: between all points at which a mesh could look. (Twelve points an element saw none of these.)
  for (const char* const needle : {"-1-3000*exp(-((s-0.31)/0.002)^2)",
                                   "-1-3e5*exp(-((s-0.31)/2e-5)^2)", "s>0.31&&s<0.3101?-3e4:-1"})
    EXPECT_NE(find(history(needle, 2, 4).report.certificate, "distributed loads")->verdict,
              Verdict::pass)
        << needle;
  // Beside what a sensor reads as well.
  EXPECT_NE(find(history("1e-3*sin(20*s)*(1+b.end.displacement.3)", 2, 3).report.certificate,
                 "distributed loads")
                ->verdict,
            Verdict::pass);
  // What is resolved passes: linear loads on any order, and a parabola on order 3; what does not vary is not asked.
  for (const auto& [force, elements, order] :
       {std::tuple{"s", 20, 1}, std::tuple{"s", 1, 2}, std::tuple{"1-s^2", 1, 3}})
    EXPECT_EQ(
        find(history(force, elements, order).report.certificate, "distributed loads")->verdict,
        Verdict::pass)
        << force << order;
  EXPECT_EQ(find(history("3", 1, 3).report.certificate, "distributed loads"), nullptr);
}

// What is zero in truth is round-off, by itself of any size: forces in free fall, the acceleration of a clamp, of the axis of a bar in
// torsion, velocities of what hangs at rest. Mutations: quantities measured by themselves alone; round-off of velocities judged at
// rest.
TEST(CertificateFoundSlow, WhatIsZeroInTruthIsNotJudgedByItself) {
  const std::pair<const char*, std::string> models[] = {
      {"fall", beam(R"(<gravity acceleration="0 0 -9.81"/>
          <transient duration="0.3" step="1e-3" rho_infinity="0.8"/>
          <record name="e" at="b.end" quantities="position force"/>)")},
      {"clamp",
       beam(R"(<fixed name="c" between="ground b.start"/><fixed name="d" between="ground b.end"/>
          <load at="b@0.5" force="0 0 1e3*sin(5*t)^2"/>
          <transient duration="0.5" step="5e-4" rho_infinity="0.8"/>
          <record name="m" at="b@0.5" quantities="position"/>
          <record name="e" at="b.end" quantities="acceleration"/>)")},
      {"twist", beam(R"(<fixed name="c" between="ground b.start"/>
          <load at="b.end" moment="10*sin(5*t)^2 0 0"/>
          <transient duration="0.5" step="1e-3" rho_infinity="0.8"/>
          <record name="e" at="b.end" quantities="rotation acceleration"/>)")},
      {"hang", beam(R"(<revolute name="c" between="ground b.start" axis="0 1 0"/>
          <gravity acceleration="9.81 0 0"/><static/><transient duration="0.3" step="1e-3"/>
          <record name="e" at="b.end" quantities="position"/>)")},
  };
  const TemporaryDirectory directory;
  for (const auto& [name, text] : models) {
    const fs::path model = directory.path() / "m.xml", out = directory.path() / "out";
    std::ofstream(model) << text;
    const Output ran = shell(quote(test::mbd_program) + " run " + quote(model.string()) +
                             " --certify --certify-within 1e5 --out " + quote(out.string()));
    EXPECT_EQ(ran.status, 0) << name << ": " << ran.text;
    for (const nlohmann::json& check :
         nlohmann::json::parse(read_text(out / "report.json")).at("certificate").at("checks"))
      EXPECT_NE(check.at("verdict"), "fail") << name << ": " << check.dump();
  }
}

RunReport report_of(const std::string& text) {
  return run(read_model_text(text, "s.xml"), {.output = {}, .observers = {}, .progress = {}});
}

// A cantilever that sags under its weight, shaken by 1e-7 N: 1e-16 J move, beside 0.3 J. Mutation: energies known to 8 units of round-off of
// their sum, in which strain and potential cancel.
TEST(CertificateFound, EnergiesThatRoundOffHidesAreNotJudged) {
  const RunReport report = report_of(
      beam(R"(<fixed name="c" between="ground b.start"/><gravity acceleration="0 0 -9.81"/>
          <load at="b.end" force="0 0 1e-7*sin(50*t)^2"/><static/>
          <transient duration="0.5" step="2e-4" rho_infinity="0.8"/>
          <record name="e" at="b.end" quantities="position"/>)"));
  EXPECT_EQ(find(report.certificate, "spurious energy"), nullptr);
  EXPECT_NE(report.certificate.verdict(), Verdict::fail) << words(report.certificate);
}

// A stiff bar that turns by 0.3 to 0.8 rad in a step: its reaction turns with it, and the trapezium of it is 1 to 5 % too small.
// Mutation: trapezia as they are.
TEST(CertificateFound, ImpulsesOfForcesThatTurn) {
  for (const double step : {0.03, 0.05, 0.08}) {
    const RunReport report = report_of(fmt::format(R"(<mbd name="s"><section name="s">
        <stiffness EA="4e7" GA2="2e7" GA3="2e7" GJ="300" EI2="5e5" EI3="5e5"/>
        <mass per_length="1.3" inertia="0.1 0.04 0.06"/></section>
        <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1"/>
        <revolute name="h" between="ground b.start" axis="0 0 1"/>
        <drive joint="h" rate="2>t?2.5*t*t*(3-t):10"/><transient duration="6" step="{}"/>
        <record name="e" at="b.end" quantities="position"/></mbd>)",
                                                   step));
    const Check* const linear = find(report.certificate, "linear momentum");
    ASSERT_NE(linear, nullptr);
    EXPECT_LT(linear->value, step < 0.06 ? 0.01 : 0.05) << step;
  }
}

// Two wishbones on stiff damped bushings, 1e12 N/m, from rest: what they do within the first steps is not what a polynomial through their ends makes of
// it, and the stages balance it. (Lobatto's rule in the interpolated states, as it was, is 100 times the momentum off.)
TEST(CertificateFound, ImpulsesOfStiffBushings) {
  const RunReport report = report_of(R"xml(<mbd name="wishbone1e12">
      <body name="lo" at="0 0.3 0" mass="2" center="0 0.2 0" inertia=".02 .01 .02"/>
      <bushing name="bu_lo0" between="ground lo" at="-0.15 0.3 0"
        axis="1 0 0" stiffness="1e12 1e12 1e11" angular_stiffness="1e8 1e8 0"
        damping="1e8 1e8 1e8"/>
      <bushing name="bu_lo1" between="ground lo" at="0.15 0.3 0"
        axis="1 0 0" stiffness="1e12 1e12 1e11" angular_stiffness="1e8 1e8 0"
        damping="1e8 1e8 1e8"/>
      <body name="up" at="0 0.35 0.3" mass="2" center="0 0.15 0" inertia=".02 .01 .02"/>
      <bushing name="bu_up0" between="ground up" at="-0.15 0.35 0.3"
        axis="1 0 0" stiffness="1e12 1e12 1e11" angular_stiffness="1e8 1e8 0"
        damping="1e8 1e8 1e8"/>
      <bushing name="bu_up1" between="ground up" at="0.15 0.35 0.3"
        axis="1 0 0" stiffness="1e12 1e12 1e11" angular_stiffness="1e8 1e8 0"
        damping="1e8 1e8 1e8"/>
      <body name="hub" at="0 .68 .15" mass="20" inertia=".3 .4 .3"/>
      <spherical name="bl" between="lo hub" at="0 .7 0"/><spherical name="bt" between="up hub" at="0 .65 .3"/>
      <distance name="tie" between="ground hub" at_a="-.12 .33 .1" at_b="-.12 .68 .1"/>
      <spring name="shock" between="ground lo" at_a="0 .4 .5" at_b="0 .6 0" stiffness="3e4" damping="1500"/>
      <load at="hub" force="0 0 0.05>t?0:(0.1>t?3e3*sin((t-0.05)*pi/0.05):0)"/>
      <gravity acceleration="0 0 -9.81"/>
      <transient duration="0.4" method="radau" tolerance="1e-7" output="0.004"/>
      <record name="p_hub" at="hub" quantities="position rotation"/><record name="p_lo" at="lo" quantities="position rotation"/>
      </mbd>)xml");
  const Check* const linear = find(report.certificate, "linear momentum");
  ASSERT_NE(linear, nullptr);
  EXPECT_LT(linear->value, 1e-3) << words(report.certificate);
}

// Seven stages in fixed steps of a good part of a period. Mutation: states of stages not asked for.
TEST(CertificateFound, ImpulsesOfLongSteps) {
  const RunReport report = report_of(R"(<mbd name="s">
      <body name="p" at="0 0 0" center="0 0 -1" mass="2" inertia="0.2 0.3 0.1"/>
      <spherical name="h" between="ground p"/><gravity acceleration="0 0 -9.81"/>
      <load at="p" force="3*sin(2*t) 2*cos(3*t) 0" offset="0 0 -1"/>
      <transient duration="4" method="radau" stages="7" step="0.4" output="0.1"/>
      <record name="a" at="p" quantities="position"/></mbd>)");
  for (const char* const name : {"linear momentum", "angular momentum"}) {
    const Check* const check = find(report.certificate, name);
    ASSERT_NE(check, nullptr);
    EXPECT_LT(check->value, 0.01) << words(report.certificate);
  }
}

// Friction that turns round within 1e-9 m/s: Newton's increments of velocity are below the tolerance long before forces balance, and
// steps keep what does not. It is failed, as impulses are those of the stages.
TEST(CertificateFound, StagesOutOfBalanceAreSeen) {
  const RunReport report = report_of(R"xml(<mbd name="s">
      <body name="b" mass="1" inertia=".1 .1 .1"/>
      <prismatic name="P" between="ground b" axis="1 0 0"/>
      <joint_spring name="f" joint="P" damping_force="5*tanh(v/1e-9)"/>
      <body name="d" at="1 0 0" mass="1" inertia="1 1 1"/>
      <motion name="m" of="d" displacement="0.5*t^2/(0.1+t) 0 0" rotation="0 0 0"/>
      <spring name="k" between="b d" at_a="0 0 0" at_b="1 0 0" stiffness="50"/>
      <transient duration="3" method="radau" tolerance="1e-4" output="0.03"/>
      <record name="b" at="b" quantities="position"/></mbd>)xml");
  EXPECT_EQ(report.certificate.verdict(), Verdict::fail) << words(report.certificate);
}

}  // namespace
}  // namespace mbd::test::test_certificate_found
