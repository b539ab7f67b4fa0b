// Strains that are held at zero (infinite stiffnesses of sections): tangents and rates by differences at large motions, the
// elastica, Euler's column, beam and ring in closed form, forces of hanging and spinning beams, the limit of large stiffnesses,
// four integrators against each other, what is refused.
// Mutations seen: multipliers without w J; the geometric stiffness of held forces; g without the frames of offset nodes; the
// second derivative of g; held forces left out of sectional forces, of mesh errors; compliance of held strains.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "elements/beam/beam_elastic_batch.hpp"
#include "elements/beam/held_strains.hpp"
#include "libmbd/compile/model.hpp"
#include "libmbd/run/describe.hpp"
#include "solvers/modes/eigenmodes.hpp"
#include "solvers/statics/equilibrium.hpp"
#include "tests/support/certificates.hpp"
#include "tests/support/increments.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_held_strains {
namespace {

std::string stiffness(const std::string& EA, const std::string& GA) {
  return fmt::format(R"(<stiffness EA="{0}" GA2="{1}" GA3="{1}" GJ="1" EI2="1" EI3="2"/>)", EA, GA);
}
std::string section(const std::string& stiff, const std::string& more = "") {
  return "<section name=\"s\">" + stiff + more + "</section>";
}
const std::string slender = stiffness("inf", "inf");
std::string straight(int elements, int order, const std::string& more = "") {
  return fmt::format(
      R"(<beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="{}" order="{}" {}/>)",
      elements, order, more);
}
const std::string clamp = R"(<fixed name="clamp" between="ground b.start"/>)";

double last(const History& history, const std::string& column) {
  return history.table[column].back();
}

// Curved and twisted beams of several metrics and orders, one with nodes fixed in a body away from them, and the ground.
Scene all_kinds() {
  return read(
      R"(<section name="s"><stiffness EA="inf" GA2="3" GA3="inf" GJ="inf" EI2="2" EI3="3"/>
           <mass per_length="1" inertia="1e-2 1e-2 1e-2"/></section>
         <section name="u"><stiffness EA="40" GA2="inf" GA3="30" GJ="2" EI2="inf" EI3="3"/>
           <mass per_length="1" inertia="1e-2 1e-2 1e-2"/></section>
         <arc name="a" section="s" from="1 0 0" center="0 0 0" axis="0 0 1" angle="1.2" normal="0 0 1"
              elements="2" order="3" metric="quaternion"/>
         <beam name="b" section="u" from="2 0 0" to="3 0.5 0" normal="0 0 1" order="5" metric="matrix"/>
         <beam name="c" section="s" from="4 0 0" to="4 0 1" normal="1 0 0" order="1"/>
         <body name="m" at="1.7 0.1 0.3" mass="1" inertia="1 2 3"/>
         <fixed name="f" between="m b.start"/>
         <fixed name="g" between="ground c.start"/>
         <transient duration="1" step="0.1"/>)");
}

// By differences of sixth order of the residual along random increments, poses and multipliers moved far.
TEST(HeldStrains, TangentIsTheDerivative) {
  const Model model = compile(all_kinds());
  const System& system = *model.system;
  ASSERT_EQ(system.multipliers(), 2 * 3 * 3 + 5 * 2 + 3 + 6);  // and those of the ground
  Rng rng(3);
  for (int trial = 0; trial < 5; ++trial) {
    State state = model.initial;
    move_at_random(state, rng, 0.3);
    for (double& l : state.lambda) l = uniform(rng, -5.0, 5.0);
    VecX r, alone;
    const Eigen::MatrixXd K = dense_tangent(system, state, r);
    system.residual(state, alone);
    EXPECT_EQ((r - alone).cwiseAbs().maxCoeff(), 0.0);
    const VecX x = random_increment(system, rng);
    const VecX slope = slope_along(system, state, x);
    EXPECT_LT((slope - K * x).norm(), 1e-9 * slope.norm()) << trial;
  }
}

// g' and g'' without accelerations along H exp(tau V), by differences of g.
TEST(HeldStrains, RatesAreDerivatives) {
  const Model model = compile(all_kinds());
  const System& system = *model.system;
  Rng rng(4);
  State state = model.initial;
  move_at_random(state, rng, 0.3);
  for (std::size_t n = 1; n < state.V.size(); ++n) state.V[n] = random_vector<6>(rng, 1.0);
  VecX g, gdot, rate, rest;
  system.constraints(state, g, gdot);
  VecX r;
  system.residual(state, r);
  EXPECT_LT((r.tail(system.multipliers()) - g).norm(), 1e-13 * g.norm());
  system.constraint_rates(state, rate, rest);
  const auto at = [&](double tau) {
    State moved = state;
    for (std::size_t n = 1; n < moved.pose.size(); ++n)
      moved.pose[n] = moved.pose[n] * exp_se3<double>(Vec6(tau * state.V[n]));
    VecX there, unused;
    system.constraints(moved, there, unused);
    return there;
  };
  constexpr double h = 1e-2;
  const VecX first =
      (45.0 * (at(h) - at(-h)) - 9.0 * (at(2 * h) - at(-2 * h)) + (at(3 * h) - at(-3 * h))) /
      (60.0 * h);
  const VecX second = (270.0 * (at(h) + at(-h)) - 27.0 * (at(2 * h) + at(-2 * h)) +
                       2.0 * (at(3 * h) + at(-3 * h)) - 490.0 * g) /
                      (180.0 * h * h);
  EXPECT_LT((first - gdot).norm(), 1e-10 * gdot.norm());
  EXPECT_LT((rate - gdot).norm(), 1e-13 * gdot.norm());
  EXPECT_LT((second - rest).norm(), 1e-8 * rest.norm());
}

// Bisshopp and Drucker, Quart. Appl. Math. 3 (1945): P L^2/EI = 10, by elliptic integrals to 30 digits.
TEST(HeldStrains, Elastica) {
  const auto of = [](int elements) {
    return run_to_table(read(section(slender) + straight(elements, 4) + clamp +
                             R"(<load name="P" at="b.end" force="0 -20 0"/><static/>
                                <record name="tip" at="b.end" quantities="displacement"/>
                                <record name="root" at="b.start" quantities="force moment"/>)"));
  };
  std::vector<double> errors;
  for (const int elements : {2, 4, 8}) {
    const History h = of(elements);
    ASSERT_EQ(h.report.failure, "");
    errors.push_back(std::hypot(last(h, "tip.displacement.1") + 0.554995597753751269573,
                                last(h, "tip.displacement.2") + 0.810609024880296453229));
  }
  EXPECT_LT(errors.back(), 2e-9);
  // Ends of elements are of order 2N.
  EXPECT_GT(std::log2(errors[0] / errors[1]), 6.5) << testing::PrintToString(errors);
  EXPECT_GT(std::log2(errors[1] / errors[2]), 7.0) << testing::PrintToString(errors);
  const History h = of(8);
  // At the ends of elements, of the polynomial through their points.
  EXPECT_NEAR(last(h, "root.moment.3"), -2.0 * 4.45004402242248730426, 1e-3);
  EXPECT_NEAR(last(h, "root.force.2"), -20.0, 5e-3);
}

// Load factors of the clamped column without extension and shear are (2k - 1)^2 pi^2 EI/(4 L^2), in both planes.
TEST(HeldStrains, EulersColumn) {
  const Scene scene = read(section(slender) + straight(4, 4) + clamp +
                           R"(<load name="P" at="b.end" force="-10 0 0"/><path/>
                              <record name="tip" at="b.end" quantities="displacement"/>)");
  const History h = run_to_table(scene);
  ASSERT_EQ(h.report.failure, "");
  constexpr double P = std::numbers::pi * std::numbers::pi / 4.0 / 10.0;
  std::vector<double> found;
  for (const SpecialPoint& point : h.report.special)
    if (point.event == PathEvent::bifurcation) found.push_back(point.load_factor);
  std::ranges::sort(found);
  ASSERT_GE(found.size(), 2U);
  EXPECT_NEAR(found[0], P, 1e-8 * P);
  EXPECT_NEAR(found[1], 2.0 * P, 1e-8 * P);
}

// Without rotary inertia the frequencies of Euler's beam: to the order of the mesh.
TEST(HeldStrains, EulersBeam) {
  const Model model =
      compile(read(section(slender, R"(<mass per_length="1" inertia="0 0 0"/>)") + straight(6, 5) +
                   clamp + R"(<transient duration="1" step="0.1"/>)"));
  SmallMotions motions(*model.system);
  motions.about(model.initial);
  const ModesFound found = find_modes(motions, {.count = 4});
  ASSERT_EQ(found.failure, "");
  constexpr double first = 1.87510406871196117, second = 4.69409113297417458;
  const std::vector<double> want = {first * first, first * first * std::sqrt(2.0), second * second,
                                    second * second * std::sqrt(2.0)};
  ASSERT_EQ(found.modes.size(), want.size());
  for (std::size_t i = 0; i < want.size(); ++i)
    EXPECT_NEAR(std::abs(found.modes[i].eigenvalue), want[i], 1e-7 * want[i]) << i;
}

// A quarter of a ring under forces 2P on a diameter: it bends alone, and moves by (pi/4 - 2/pi) P R^3/EI along the forces,
// by (2/pi - 1/2) P R^3/EI across (Timoshenko, Strength of Materials II, 1956, 80).
TEST(HeldStrains, Ring) {
  constexpr double P = 1e-5, R = 3.0, EI = 2.0;
  const History h = run_to_table(read(
      section(stiffness("inf", "inf")) +
      R"(<arc name="b" section="s" from="3 0 0" center="0 0 0" axis="0 0 1" angle="pi/2" normal="0 0 1"
                   elements="4" order="4"/>
              <prismatic name="A" between="ground b.start" axis="1 0 0"/>
              <prismatic name="B" between="ground b.end" axis="0 1 0"/>
              <load name="P" at="b.end" force="0 -1e-5 0"/><static/>
              <record name="side" at="b.start" quantities="displacement force"/>
              <record name="top" at="b.end" quantities="displacement"/>)"));
  ASSERT_EQ(h.report.failure, "");
  constexpr double pi = std::numbers::pi;
  const double unit = P * R * R * R / EI;
  EXPECT_NEAR(last(h, "top.displacement.2"), -(pi / 4.0 - 2.0 / pi) * unit, 2e-5 * unit);
  EXPECT_NEAR(last(h, "side.displacement.1"), (2.0 / pi - 0.5) * unit, 2e-5 * unit);
  EXPECT_NEAR(last(h, "side.force.1"), -P, 1e-4 * P);
}

// N = m g (L - s) of a hanging beam, and m w^2 (L^2 - s^2)/2 of one that spins, also where no stiffness could give it.
TEST(HeldStrains, ForcesAreThoseOfBalance) {
  const History hang = run_to_table(read(
      section(slender, R"(<mass per_length="2" inertia="1e-3 1e-3 1e-3"/>)") +
      R"(<beam name="b" section="s" from="0 0 0" to="0 0 -3" normal="1 0 0" elements="3" order="3"/>
              <fixed name="top" between="ground b.start"/><gravity acceleration="0 0 -10"/><static/>
              <record name="p" at="b@0.3" quantities="force"/><record name="q" at="b@0.9" quantities="force"/>)"));
  ASSERT_EQ(hang.report.failure, "");
  EXPECT_NEAR(last(hang, "p.force.1"), 2.0 * 10.0 * 3.0 * 0.7, 1e-9);
  EXPECT_NEAR(last(hang, "q.force.1"), 2.0 * 10.0 * 3.0 * 0.1, 1e-9);
  const History spin = run_to_table(read(
      R"xml(<section name="s"><stiffness EA="inf" GA2="inf" GA3="inf" GJ="1e4" EI2="1e4" EI3="1e4"/>
           <mass per_length="2" inertia="1e-3 1e-3 1e-3"/><damping stiffness_proportional="0.05"/></section>
         <beam name="b" section="s" from="0 0 0" to="3 0 0" normal="0 0 1" elements="3" order="3"/>
         <revolute name="O" between="ground b.start" axis="0 0 1"/>
         <drive joint="O" rate="t >= 0.5 ? 5 : 5*(t/0.5)^2*(3 - 2*t/0.5)"/>
         <transient duration="3" step="0.01"/>
         <record name="p" at="b@0.3" quantities="force"/><record name="tip" at="b.end" quantities="position"/>)xml"));
  ASSERT_EQ(spin.report.failure, "");
  EXPECT_NEAR(last(spin, "p.force.1"), 2.0 * 25.0 * 9.0 * (1.0 - 0.09) / 2.0, 1e-5);
  EXPECT_NEAR(std::hypot(last(spin, "tip.position.1"), last(spin, "tip.position.2")), 3.0, 1e-12);
}

std::string swing(const std::string& stiff, const std::string& transient) {
  return section(stiff, R"(<mass per_length="0.5" inertia="1e-4 5e-5 5e-5"/>)") + straight(3, 3) +
         R"(<spherical name="A" between="ground b.start"/><gravity acceleration="0 2 -9.81"/>)" +
         transient +
         R"(<record name="tip" at="b.end" quantities="position"/>
            <record name="F" at="b@0.5" quantities="force moment"/><record name="e" quantities="total_energy"/>)";
}

// What a stiffness k leaves of stretching and shearing falls with 1/k to nothing.
TEST(HeldStrains, AreTheLimitOfStiffness) {
  const std::string radau =
      R"(<transient duration="0.4" method="radau" tolerance="1e-9" output="0.1"/>)";
  const History held = run_to_table(read(swing(slender, radau)));
  ASSERT_EQ(held.report.failure, "");
  std::vector<double> apart;
  for (const char* const k : {"1e3", "1e4", "1e5"}) {
    const History soft = run_to_table(read(swing(stiffness(k, k), radau)));
    ASSERT_EQ(soft.report.failure, "");
    double sum = 0.0;
    for (const char* const c : {"tip.position.1", "tip.position.2", "tip.position.3"})
      sum += std::pow(last(soft, c) - last(held, c), 2);
    apart.push_back(std::sqrt(sum));
  }
  EXPECT_GT(apart[0], 1e-4);
  for (std::size_t i = 0; i + 1 < apart.size(); ++i)
    EXPECT_NEAR(std::log10(apart[i] / apart[i + 1]), 1.0, 0.2) << testing::PrintToString(apart);
}

// Integrators that know nothing of each other; energy is kept.
TEST(HeldStrains, IntegratorsAgree) {
  const auto with = [](const std::string& settings) {
    const History h = run_to_table(
        read(swing(slender, "<transient duration=\"0.4\" output=\"0.1\" " + settings + "/>")));
    EXPECT_EQ(h.report.failure, "") << settings;
    return h;
  };
  const History radau = with(R"(method="radau" tolerance="1e-9")"),
                ida = with(R"(method="ida" tolerance="1e-8")"), alpha = with(R"(step="1e-3")"),
                half = with(R"(step="5e-4")");
  const auto apart = [&](const History& h) {
    double most = 0.0;
    for (const char* const c : {"tip.position.1", "tip.position.2", "tip.position.3"})
      most = std::max(most, std::abs(last(h, c) - last(radau, c)));
    return most;
  };
  EXPECT_LT(apart(ida), 1e-5);
  EXPECT_LT(apart(half), 1e-4);
  EXPECT_NEAR(std::log2(apart(alpha) / apart(half)), 2.0, 0.3);
  EXPECT_NEAR(last(radau, "F.force.1"), last(ida, "F.force.1"), 1e-2);
  EXPECT_NEAR(last(radau, "e.total_energy"), 0.0, 1e-8);
}

// A certificate knows the mesh by forces that no strain gives: coarse is told from fine.
TEST(HeldStrains, MeshErrorsAreSeen) {
  const auto mesh = [](int elements, int order) {
    const RunReport r = run(read(section(slender) + straight(elements, order) + clamp +
                                 R"(<load name="P" at="b.end" force="0 -0.01 0"/><static/>
                                    <record name="tip" at="b.end" quantities="displacement"/>)"));
    const Check* const check = find(r.certificate, "mesh");
    return check == nullptr ? -1.0 : check->value;
  };
  // One element of order 1 has a constant moment: a quarter of the deflection is missed (mesh_error.hpp).
  EXPECT_NEAR(mesh(1, 1), 0.25, 1e-3);
  EXPECT_NEAR(mesh(4, 1), 0.25 / 16.0, 1e-3);
  EXPECT_LT(mesh(1, 3), 1e-6);
}

// Nothing bends a straight beam that cannot stretch between two supports: said, with the reason, by name.
TEST(HeldStrains, StraightBetweenSupports) {
  const std::string model = section(slender) + straight(2, 3) + clamp +
                            R"(<fixed name="other" between="ground b.end"/>
                               <load name="P" at="b@0.5" force="0 -1 0"/><static/>)";
  const auto checks = [](const std::string& inside) {
    const Scene scene = read(inside);
    return check_model(scene, compile(scene));
  };
  const CheckReport checked = checks(model);
  ASSERT_EQ(checked.redundant.size(), 1U);
  EXPECT_SAYS(checked.redundant[0], "beam 'b' element");
  EXPECT_SAYS(checked.redundant[0], "axial force");
  EXPECT_EQ(checked.mechanism.held_strains, 18);
  const RunReport r = run(read(model));
  EXPECT_NE(r.failure, "");
  EXPECT_TRUE(std::ranges::any_of(r.redundant, [](const std::string& note) {
    return note.find("without stretching a straight beam cannot bend there") != std::string::npos;
  }));
  // One support that gives way is enough.
  const RunReport loose = run(read(section(slender) + straight(2, 3) + clamp +
                                   R"(<prismatic name="other" between="ground b.end" axis="1 0 0"/>
                                      <load name="P" at="b@0.5" force="0 -1 0"/><static/>)"));
  EXPECT_EQ(loose.failure, "");
  EXPECT_EQ(checks(section(slender) + straight(2, 3) + clamp + "<static/>").redundant.size(), 0U);
}

// A path ends where rows that repeated others open, as load steps do: it went on with a beam that stretched, and with rods.
TEST(HeldStrains, PathsEndWhereRowsOpen) {
  for (
      const std::string& model :
      {section(slender) + straight(4, 3) + clamp +
           R"(<fixed name="other" between="ground b.end"/><load name="P" at="b@0.5" force="0 -1 0"/>)",
       std::string(R"xml(<body name="m" mass="1" inertia="1 1 1"/>
            <planar name="pl" between="ground m" axis="0 1 0"/>
            <distance name="d1" between="ground m" at_a="-1 0 0" at_b="0 0 0"/>
            <distance name="d2" between="ground m" at_a="1 0 0" at_b="0 0 0"/>
            <bushing name="k" between="ground m" stiffness="0 0 10" angular_stiffness="1 1 1"/>
            <load name="P" at="m" force="0 0 -1"/>)xml")}) {
    const RunReport r = run(read(model + R"(<path step="0.1" points="10"/>)"));
    EXPECT_NE(r.failure, "");
    EXPECT_LT(r.load_factor, 0.1);
    EXPECT_SAYS(r.failure, "repeated each other");
  }
}

TEST(HeldStrains, WhatIsRefused) {
  const auto beam_says = [](const std::string& attributes) {
    return refusal([&] {
      compile(read(section(slender) + straight(1, 3, attributes) + clamp + "<static/>"));
    });
  };
  EXPECT_SAYS(beam_says("kinematics=\"classical\""), "infinite stiffnesses, which kinematics=");
  EXPECT_SAYS(beam_says("form=\"paper\""), "infinite stiffnesses, which form=");
  EXPECT_SAYS(beam_says("rule=\"gauss_lobatto\""), "infinite stiffnesses, which rule=");
  EXPECT_EQ(beam_says(""), "no error");
  const std::string rest = straight(1, 3) + clamp + "<static/>";
  EXPECT_SAYS(
      message(section(R"(<stiffness EA="inf" GA2="inf" GA3="inf" GJ="inf" EI2="inf" EI3="inf"/>)") +
              rest),
      "all six are infinite: that is a rigid body");
  EXPECT_SAYS(
      message(section(R"(<stiffness EA="inf" GA2="1" GA3="1" GJ="1" EI2="1" EI3="1" D16="0.1"/>)") +
              rest),
      "EA is infinite and coupled");
  EXPECT_SAYS(
      message(section(R"(<stiffness EA="-inf" GA2="1" GA3="1" GJ="1" EI2="1" EI3="1"/>)") + rest),
      "EA");
  EXPECT_SAYS(message(section(R"(<stiffness EA="inf" GA2="1" GA3="1" GJ="1" EI2="1" EI3="1"/>
                                 <damping EA="inf"/>)") +
                      rest),
              "EA");
  EXPECT_SAYS(message(R"(<section name="s">
      <station at="0"><stiffness EA="inf" GA2="1" GA3="1" GJ="1" EI2="1" EI3="1"/></station>
      <station at="1"><stiffness EA="1" GA2="1" GA3="1" GJ="1" EI2="1" EI3="1"/></station></section>)" +
                      rest),
              "other stiffnesses are infinite than at the first station");
}

// Tables: what is finite varies, what is infinite does not matter; a tapered cantilever's slope by the closed form.
TEST(HeldStrains, AlongTables) {
  const History h = run_to_table(read(
      R"(<section name="s">
      <station at="0"><stiffness EA="inf" GA2="inf" GA3="inf" GJ="1" EI2="2" EI3="2"/></station>
      <station at="1"><stiffness EA="inf" GA2="inf" GA3="inf" GJ="1" EI2="1" EI3="1"/></station></section>)" +
      straight(4, 4) + clamp +
      R"(<load name="M" at="b.end" moment="0 0 0.5"/><static/>
         <record name="tip" at="b.end" quantities="rotation"/>)"));
  ASSERT_EQ(h.report.failure, "");
  EXPECT_NEAR(last(h, "tip.rotation.3"), 0.5 * std::log(2.0), 1e-6);
}

}  // namespace
}  // namespace mbd::test::test_held_strains
