// Component modes (<reduction>): frequencies against Euler's beam and the model with its beams, statics in closed form, motion
// against the model with its beams with the order of what is left out, what is kept exactly, records within, and what is refused.
// Mutations seen: what modes add to static shapes, left out; rigid motion of the rest; damping of mass in the viscous part;
// the base's motion; sectional forces of exact strains; momenta of coupled nodes taken for those of masses (free_momenta.cpp);
// parts that nothing ties; the largest turn of the first node alone.
#include "solvers/modes/component_modes.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/compile/time_stepping.hpp"
#include "solvers/modes/eigenmodes.hpp"
#include "tests/support/certificates.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_component_modes {
namespace {

constexpr double L = 2.0, EI2 = 40.0, EI3 = 90.0, m = 0.8;

// Slender: shear and rotary inertia hardly count.
std::string section(double softness = 1.0, const std::string& more = "") {
  return fmt::format(
      R"(<section name="s"><stiffness EA="{0}" GA2="{1}" GA3="{1}" GJ="{2}" EI2="{3}" EI3="{4}"/>
        <mass per_length="{5}" inertia="2e-5 1e-5 1e-5"/>{6}</section>)",
      1e6 / softness, 4e5 / softness, 30.0 / softness, EI2 / softness, EI3 / softness, m, more);
}
const std::string beam =
    R"(<beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="6" order="4"/>)";

// Of its motions that are not rigid, by their size.
std::vector<std::complex<double>> eigenvalues(const Scene& scene, int count) {
  const Model model = compile(scene);
  SmallMotions motions(*model.system);
  motions.about(model.initial);
  const ModesFound found = find_modes(motions, {.count = count});
  EXPECT_EQ(found.failure, "");
  std::vector<std::complex<double>> all;
  for (const Mode& mode : found.modes)
    if (!mode.rigid) all.push_back(mode.eigenvalue);
  std::ranges::sort(all, {}, [](const auto& l) { return std::abs(l); });
  return all;
}

std::vector<double> frequencies(const Scene& scene, int count) {
  std::vector<double> all;
  for (const std::complex<double>& l : eigenvalues(scene, count)) all.push_back(std::abs(l));
  return all;
}

double of_euler(double beta, double EI) {
  return beta * beta * std::sqrt(EI / (m * L * L * L * L));
}

// Held at its root alone, its modes are those it was made of: to round-off those of the beam, which are Euler's.
TEST(ComponentModes, ClampedOnesAreThoseOfTheBeam) {
  const std::string held = section() + beam +
                           R"(<fixed name="f" between="ground b.start"/>
                              <transient duration="1" step="0.1"/>)";
  const auto full = frequencies(read(held), 8);
  const auto reduced = frequencies(read(held + R"(<reduction name="r" of="b" modes="8"/>)"), 8);
  ASSERT_EQ(full.size(), 8U);
  ASSERT_EQ(reduced.size(), 8U);
  for (std::size_t k = 0; k < 8; ++k) EXPECT_NEAR(reduced[k], full[k], 1e-8 * full[k]) << k;
  EXPECT_NEAR(reduced[0], of_euler(1.875104068712, EI2), 1e-3 * reduced[0]);
  EXPECT_NEAR(reduced[1], of_euler(1.875104068712, EI3), 1e-3 * reduced[1]);
  EXPECT_NEAR(reduced[2], of_euler(4.694091132974, EI2), 3e-3 * reduced[2]);
  // Far fewer unknowns: six at the root and some nodes within, of 25.
  EXPECT_LE(compile(read(held + R"(<reduction name="r" of="b" modes="8"/>)")).system->nodes(),
            1 + 1 + 4);
}

// Free, held by nothing: Euler's free beam, with the ends as interfaces; from above, and nearer with more modes.
TEST(ComponentModes, FreeOnesConverge) {
  const std::string free =
      section() + beam +
      R"(<load name="l" at="b.start" force="0 0 0"/><load name="k" at="b.end" force="0 0 0"/>
                              <transient duration="1" step="0.1"/>)";
  const auto full = frequencies(read(free), 12);
  ASSERT_GE(full.size(), 6U);
  EXPECT_NEAR(full[0], of_euler(4.730040744863, EI2), 1e-3 * full[0]);
  double before = INFINITY;
  for (const int modes : {0, 6, 12, 24, 40}) {
    const auto reduced = frequencies(
        read(free + fmt::format(R"(<reduction name="r" of="b" modes="{}"/>)", modes)), 12);
    const double error = reduced[0] / full[0] - 1.0;
    EXPECT_GT(error, -1e-9) << modes;
    EXPECT_LT(error, 0.5 * before) << modes;
    before = error;
  }
  EXPECT_LT(before, 1e-6);
}

// A small load at the tip: deflection within, forces and moments in closed form, whatever the modes.
TEST(ComponentModes, StaticShapesAreExact) {
  constexpr double P = 1e-4;
  for (const int modes : {0, 5}) {
    const Scene scene = read(
        section() + beam +
        fmt::format(
            R"(<fixed name="f" between="ground b.start"/><reduction name="r" of="b" modes="{}"/>
                       <load name="l" at="b.end" force="0 {} 0"/><static/>
                       <record name="q" at="b@0.37" quantities="displacement force moment"/>
                       <record name="e" at="b.end" quantities="displacement"/>
                       <record name="f" joint="f" quantities="reaction_force reaction_moment"/>)",
            modes, P));
    const History history = run_to_table(scene);
    ASSERT_EQ(history.report.failure, "");
    const Table& t = history.table;
    const auto w = [&](double x) { return P * x * x * (3.0 * L - x) / (6.0 * EI3) + P * x / 4e5; };
    const double x = 0.37 * L;
    const auto last = [&](const char* name) { return t[name].back(); };
    EXPECT_NEAR(last("e.displacement.2"), w(L), 1e-8 * w(L));
    EXPECT_NEAR(last("q.displacement.2"), w(x), 1e-8 * w(L));
    EXPECT_NEAR(last("q.force.1"), 0.0, 1e-8);  // EA times round-off
    EXPECT_NEAR(last("q.force.2"), P, 1e-6 * P);
    EXPECT_NEAR(last("q.moment.3"), P * (L - x), 1e-6 * P * L);
    EXPECT_NEAR(last("f.reaction_force.2"), -P, 1e-10 * P);
    EXPECT_NEAR(last("f.reaction_moment.3"), -P * L, 1e-6 * P * L);
  }
}

// Its own weight: total at the support; the tip by all modes that weight excites, q L^4/(8 EI).
TEST(ComponentModes, WeightIsThatOfTheBeam) {
  const std::string text =
      section(0.01) + beam +
      R"(<fixed name="f" between="ground b.start"/><gravity acceleration="0 0 -9.81"/><static/>
         <record name="f" joint="f" quantities="reaction_force reaction_moment"/>
         <record name="e" at="b.end" quantities="displacement"/>)";
  const double weight = m * L * 9.81, tip = m * 9.81 * std::pow(L, 4) / (8.0 * EI2 / 0.01);
  double before = INFINITY;
  for (const int modes : {2, 6, 12}) {
    const History history =
        run_to_table(read(text + fmt::format(R"(<reduction name="r" of="b" modes="{}"/>)", modes)));
    const Table& t = history.table;
    EXPECT_NEAR(t["f.reaction_force.3"].back(), weight, 1e-9 * weight);
    EXPECT_NEAR(std::abs(t["f.reaction_moment.2"].back()), weight * 0.5 * L, 1e-4 * weight * L);
    const double error = std::abs(t["e.displacement.3"].back() / -tip - 1.0);
    EXPECT_LT(error, before);
    before = error;
  }
  EXPECT_LT(before, 1e-3);
}

// Bent by a load at its tip it differs from the beam by the square of its deflection, relative to that.
TEST(ComponentModes, StaticsDifferBySecondOrder) {
  const auto tip = [](double P, const std::string& more) {
    const Scene scene = read(section() + beam +
                             fmt::format(R"(<fixed name="f" between="ground b.start"/>
                                <load name="l" at="b.end" force="0 0 {}"/><static/>
                                <record name="e" at="b.end" quantities="displacement"/>{})",
                                         P, more));
    const History history = run_to_table(scene);
    EXPECT_EQ(history.report.failure, "");
    const Table& t = history.table;
    return Vec3(t["e.displacement.1"].back(), t["e.displacement.2"].back(),
                t["e.displacement.3"].back());
  };
  const std::string reduction = R"(<reduction name="r" of="b" modes="4"/>)";
  std::vector<double> errors;
  for (const double P : {6.0, 0.6}) {  // turns of 0.3, 0.03 rad
    const Vec3 full = tip(P, ""), reduced = tip(P, reduction);
    errors.push_back(std::abs(full(2) - reduced(2)) / full.norm());
  }
  EXPECT_LT(errors[0], 0.5 * 0.3 * 0.3);
  EXPECT_NEAR(std::log10(errors[0] / errors[1]), 2.0, 0.1);
}

// A pendulum of it falls as the beam does, but for what modes leave out.
TEST(ComponentModesSlow, LargeMotionsOfLittleDeformation) {
  const auto run_of = [](const std::string& more) {
    const Scene scene =
        read(section(0.1) + beam +
             fmt::format(R"(<revolute name="h" between="ground b.start" axis="0 1 0"/>
           <body name="w" attached_to="b.end" mass="0.2" inertia="1e-4 1e-4 1e-4"/>
           <gravity acceleration="0 0 -9.81"/><transient duration="1" method="radau" tolerance="1e-6" output="0.01"/>
           <record name="e" at="b.end" quantities="displacement"/>{})",
                         more));
    const History history = run_to_table(scene);
    EXPECT_EQ(history.report.failure, "");
    return history.table;
  };
  const Table full = run_of(""), reduced = run_of(R"(<reduction name="r" of="b" modes="16"/>)");
  double worst = 0.0, swing = 0.0;
  for (std::size_t k = 0; k < full["e.displacement.3"].size(); ++k) {
    const auto off = [&](const char* column) { return full[column][k] - reduced[column][k]; };
    worst = std::max(worst, std::hypot(off("e.displacement.1"), off("e.displacement.3")));
    swing = std::max(swing, std::abs(full["e.displacement.1"][k]));
  }
  EXPECT_GT(swing, 2.0);
  EXPECT_LT(worst, 1e-3 * swing);
}

const std::string arm = R"(
  <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="3" order="3"/>
  <beam name="c" section="s" from="2 0 0" to="2 1 0" normal="0 0 1" elements="2" order="3"/>
  <beam name="d" section="s" from="2 1 0" to="2 1.5 0.3" normal="1 0 0"/>
  <body name="w" attached_to="c@0.5" mass="0.7" inertia="0.01 0.02 0.015" center="0.1 0 0.05"/>
  <body name="k" at="2 1.6 0.4" mass="0.3" inertia="0.01 0.01 0.01"/>
  <rigid name="q" of="d k"/>
  <fixed name="bc" between="b.end c.start"/><fixed name="cd" between="c.end d.start"/>
  <point_mass at="b@0.5" mass="0.1" offset="0 0.02 0"/>)";

// Of beams, bodies, what is rigid and point masses: the modes, the mass and the motion of all of them.
TEST(ComponentModes, OfManyParts) {
  const std::string held = section() + arm + R"(<fixed name="f" between="ground b.start"/>
    <transient duration="1" step="0.1"/>)";
  const std::string reduction = R"(<reduction name="r" of="b c d w k" modes="6"/>)";
  const auto full = frequencies(read(held), 6), reduced = frequencies(read(held + reduction), 6);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(reduced[k], full[k], 1e-8 * full[k]) << k;
  EXPECT_NEAR(compile(read(held + reduction)).mass, compile(read(held)).mass, 1e-14);
}

// Pushed into space by a pulse, of an impulse in closed form: it keeps its momenta to round-off from then on, by both
// integrators, and its energy to their tolerance.
TEST(ComponentModes, KeepsMomentaAndEnergy) {
  constexpr double force = 20.0, pulse = 0.05;
  for (const std::string method : {R"(method="radau" tolerance="1e-8")",
                                   R"(step="1e-4" rho_infinity="0.9" newton_tolerance="1e-12")"}) {
    const Scene scene = read(section(0.1) + arm +
                             fmt::format(R"x(<reduction name="r" of="b c d w k" modes="10"/>
           <load name="l" at="b.end" force="0 t&lt;{0}?{1}*sin(pi*t/{0})^2:0 t&lt;{0}?{1}*sin(pi*t/{0})^2:0"/>
           <transient duration="0.4" {2} output="0.01"/>
           <record name="all" quantities="linear_momentum angular_momentum total_energy"/>)x",
                                         pulse, force, method));
    const History history = run_to_table(scene);
    ASSERT_EQ(history.report.failure, "") << method;
    const Table& t = history.table;
    const std::size_t first = 6;  // after the pulse
    EXPECT_NEAR(t["all.linear_momentum.2"].back(), 0.5 * force * pulse, 1e-5 * force * pulse);
    EXPECT_NEAR(t["all.linear_momentum.3"].back(), 0.5 * force * pulse, 1e-5 * force * pulse);
    for (const std::string name : {"linear_momentum", "angular_momentum"}) {
      double size = 0.0, off = 0.0;
      for (const char* axis : {".1", ".2", ".3"}) {
        const auto& p = t["all." + name + axis];
        size = std::hypot(size, p[first]);
        for (std::size_t k = first; k < p.size(); ++k)
          off = std::max(off, std::abs(p[k] - p[first]));
      }
      EXPECT_LT(off, 1e-8 * size) << name << ", " << method;
    }
    const auto& E = t["all.total_energy"];
    for (std::size_t k = first; k < E.size(); ++k) EXPECT_NEAR(E[k], E[first], 1e-3 * E[first]);
  }
}

// Its momenta are not those of masses at nodes, which generalized-alpha would mend with one's own, also where, as between
// two ends in line, they look alike.
TEST(ComponentModes, AFreeOneBalancesMomenta) {
  const std::string free =
      section() + beam +
      R"(<load name="l" at="b.start" force="0 1 0"/><load name="k" at="b.end" force="0 2 0"/>
                              <transient duration="1" step="0.1"/>)";
  const auto balance = [](const std::string& text) {
    const Scene scene = read(text);
    const Model model = compile(scene);
    return std::pair(balance_of(*model.system, *scene.transient),
                     keeps_momenta(*model.system, *scene.transient));
  };
  EXPECT_EQ(balance(free), std::pair(Balance::acceleration, true));
  EXPECT_EQ(balance(free + R"(<reduction name="r" of="b" modes="0"/>)"),
            std::pair(Balance::momentum, false));
}

// What modes leave out of a bend is said, and judged, by every run: half the square of the largest turn, here of the first half.
TEST(ComponentModes, CertificateSaysWhatTheyLeaveOut) {
  const auto check_at = [](double P) {
    const Scene scene = read(section() + beam +
                             fmt::format(R"(<fixed name="f" between="ground b.start"/>
                                <load name="l" at="b.end" force="0 0 {}"/><static/>
                                <reduction name="r" of="b" modes="4" frame="b@0.5"/>
                                <record name="e" at="b@0.5" quantities="rotation"/>)",
                                         P));
    const History history = run_to_table(scene);
    const double turn = history.table["e.rotation.2"].back();
    const Check* const check = find(history.report.certificate, "component modes");
    EXPECT_NE(check, nullptr);
    if (check == nullptr) return Verdict::fail;
    EXPECT_GE(check->value, 0.5 * turn * turn * (1.0 - 1e-9));
    EXPECT_LE(check->value, 4.0 * turn * turn);
    EXPECT_SAYS(check->where, "reduction \"r\"");
    return check->verdict;
  };
  EXPECT_EQ(check_at(20.0), Verdict::fail);
  EXPECT_EQ(check_at(6.0), Verdict::warn);
  EXPECT_EQ(check_at(0.6), Verdict::pass);
}

std::string refusal(const std::string& text) {
  try {
    compile(read(text));
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

// A column under an axial force, from pulls of five times its critical load to half of that: what its geometric stiffness, only
// about right, makes of a deflection is said. True: w = F (tan(k L)/k - L)/P, k^2 = P/EI, of pulls with tanh.
// Mutations seen: no part of the stiffness; the force not turned (an unsymmetric part counted twice); its sign.
TEST(ComponentModes, CertificateSaysWhatForcesMakeOfTheStiffness) {
  const double critical = EI2 * std::pow(3.141592653589793 / (2.0 * L), 2);
  for (const char* modes : {"0", "7"})
    for (const double part : {-5.0, -1.0, -0.2, 0.05, 0.2, 0.5}) {
      SCOPED_TRACE(fmt::format("{} modes, {} of the critical load", modes, part));
      const double P = part * critical, F = 1e-3 * EI2 / (L * L), k = std::sqrt(std::abs(P) / EI2);
      const double w =
          F * (P > 0.0 ? std::tan(k * L) / k - L : L - std::tanh(k * L) / k) / std::abs(P);
      const Scene scene = read(section() + beam +
                               fmt::format(R"(<fixed name="f" between="ground b.start"/>
                  <load name="l" at="b.end" force="{:.17g} 0 {:.17g}"/><static/>
                  <reduction name="r" of="b" modes="{}"/>
                  <record name="e" at="b.end" quantities="displacement"/>)",
                                           -P, F, modes));
      const History history = run_to_table(scene);
      ASSERT_EQ(history.report.failure, "");
      const double error = std::abs(history.table["e.displacement.3"].back() / w - 1.0);
      const Check* const check = find(history.report.certificate, "component modes");
      ASSERT_NE(check, nullptr);
      EXPECT_GT(check->value, 0.5 * error);
      EXPECT_LT(check->value, 5.0 * error + 1e-3);
    }
}

// Near its critical load it fails; and what no check covers is named.
TEST(ComponentModes, CertificateFailsWhereItBuckles) {
  const Scene scene = read(section() + beam +
                           R"(<fixed name="f" between="ground b.start"/>
                  <load name="l" at="b.end" force="-24 0 0.01"/><static/>
                  <reduction name="r" of="b"/><record name="e" at="b@0.5" quantities="moment"/>)");
  const History history = run_to_table(scene);  // 0.97 of the critical load
  const Check* const check = find(history.report.certificate, "component modes");
  ASSERT_NE(check, nullptr);
  EXPECT_EQ(check->verdict, Verdict::fail);
  const auto left = history.report.certificate.not_covered();
  EXPECT_TRUE(std::ranges::any_of(left, [](const std::string& what) {
    return what.find("stresses within a <reduction>") != std::string::npos;
  }));
}

// The modes of a round tube come in pairs: one of a pair would bend it aside under its weight.
// Mutation seen: as many as are asked for.
TEST(ComponentModes, PairsOfEqualModesStayTogether) {
  for (int modes = 1; modes <= 8; ++modes) {
    const Scene scene = read(fmt::format(
        R"(<section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="30" EI2="40" EI3="40"/>
          <mass per_length="0.8" inertia="2e-5 1e-5 1e-5"/></section>{}
        <fixed name="f" between="ground b.start"/><gravity acceleration="0 0.02 -0.03"/><static/>
        <reduction name="r" of="b" modes="{}"/><record name="e" at="b@0.3" quantities="force displacement"/>)",
        beam, modes));
    const History history = run_to_table(scene);
    const Table& t = history.table;
    // Two parts of three along b2: across the weight, of it.
    for (const std::string quantity : {"force", "displacement"}) {
      const double y = t["e." + quantity + ".2"].back(), z = t["e." + quantity + ".3"].back();
      EXPECT_LT(std::abs(3.0 * y + 2.0 * z), 1e-6 * std::hypot(3.0 * y, 2.0 * z)) << modes;
    }
  }
}

// What bodies of it begin with is the motion of all of it: momenta of a rigid body, and no strain.
// Mutation seen: the velocity of the body's node alone.
TEST(ComponentModes, BeginsToMoveAsARigidBody) {
  const std::string parts =
      section() + beam +
      R"(<body name="c" at="0 0 0" orientation="0.3 0.4 0" mass="0.5" inertia="1e-2 2e-2 2e-2" {}/>
         <body name="d" at="2 0 0.5" mass="0.7" inertia="1e-2 2e-2 2e-2" {}/>
         <fixed name="g" between="c b.start" at="0 0 0"/><fixed name="h" between="b.end d" at="2 0 0"/>
         <reduction name="r" of="b c d" modes="{}"/><transient duration="0.02" step="1e-3"/>
         <record name="all" quantities="linear_momentum angular_momentum strain_energy kinetic_energy"/>)";
  // d turns about its z axis by 3 rad/s and moves by (1 2 3); c, 2 m before and 0.5 m below it, by (1 -4 3).
  const Mat3 R = Eigen::AngleAxisd(0.5, Vec3(0.6, 0.8, 0.0)).toRotationMatrix();
  const Vec3 w = R.transpose() * Vec3(0.0, 0.0, 3.0);
  const std::string of_c = fmt::format(
      R"(velocity="1 -4 3" angular_velocity="{:.17g} {:.17g} {:.17g}")", w(0), w(1), w(2));
  const std::string of_d = R"(velocity="1 2 3" angular_velocity="0 0 3")";
  const double mass = 0.5 + 0.7 + m * L;
  for (const char* modes : {"0", "6"})
    for (const auto& [c, d] : {std::pair(of_c, of_d), {of_c, ""}, {"", of_d}}) {
      const History history = run_to_table(read(fmt::format(fmt::runtime(parts), c, d, modes)));
      const Table& t = history.table;
      ASSERT_EQ(history.report.failure, "");
      // Centre of mass: on the way from d to c by 2 m, bodies and the beam's middle.
      const double y = 2.0 - 3.0 * (0.5 * 2.0 + m * L * 1.0) / mass;
      EXPECT_NEAR(t["all.linear_momentum.1"][0], mass, 1e-9);
      EXPECT_NEAR(t["all.linear_momentum.2"][0], mass * y, 1e-9);
      EXPECT_NEAR(t["all.linear_momentum.3"][0], 3.0 * mass, 1e-9);
      EXPECT_LT(std::abs(t["all.strain_energy"][0]), 1e-15);
    }
  EXPECT_SAYS(refusal(fmt::format(fmt::runtime(parts), of_c, R"(velocity="1 2 3")", "4")),
              "moves otherwise");
}

// A part that hangs turned in space, of another frame and with a base that shakes: the reaction is the mass times g - a.
TEST(ComponentModes, BaseMotionAndWeightActOnIt) {
  const Scene scene = read(
      section() +
      R"(<arc name="b" section="s" from="1 2 0" center="1 1 0" axis="1 0 0.2" angle="1.2" normal="1 0 0.2" elements="3"/>
         <fixed name="f" between="ground b.start"/><gravity acceleration="1 2 -9"/>
         <base_motion acceleration="3+0*t -1 0.5"/><reduction name="r" of="b" modes="4"/>
         <static/><record name="f" joint="f" quantities="reaction_force"/>)");
  const double mass = compile(scene).mass;
  EXPECT_NEAR(mass, 1.2 * m, 1e-9);
  const History history = run_to_table(scene);
  ASSERT_EQ(history.report.failure, "");
  const Vec3 want = -mass * (Vec3(1, 2, -9) - Vec3(3, -1, 0.5));
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(history.table["f.reaction_force." + std::to_string(i + 1)].back(), want(i),
                1e-9 * want.norm());
}

// Decay of a beam with damping of both kinds: the eigenvalues of the model with the beam.
TEST(ComponentModes, DampingIsThatOfTheBeam) {
  for (const std::string damping :
       {R"(<damping stiffness_proportional="2e-3"/>)", R"(<damping mass_proportional="0.7"/>)",
        R"(<damping stiffness_proportional="1e-3" mass_proportional="0.4"/>)"}) {
    const std::string held = section(1.0, damping) + beam +
                             R"(<fixed name="f" between="ground b.start"/>
                                <transient duration="1" step="0.1"/>)";
    const auto full = eigenvalues(read(held), 4),
               reduced = eigenvalues(read(held + R"(<reduction name="r" of="b" modes="6"/>)"), 4);
    ASSERT_EQ(full.size(), reduced.size());
    for (std::size_t k = 0; k < full.size(); ++k) {
      EXPECT_LT(full[k].real(), -0.03);
      EXPECT_LT(std::abs(reduced[k] - full[k]), 1e-7 * std::abs(full[k])) << k;
    }
  }
}

// Another frame, another second order; nothing at small motions.
TEST(ComponentModes, FrameMayBeChosen) {
  const std::string held = section() + beam + R"(<fixed name="f" between="ground b.start"/>
    <load name="l" at="b.end" force="0 0 0"/><load name="k" at="b@0.5" force="0 0 0"/><transient duration="1" step="0.1"/>)";
  const auto one = frequencies(read(held + R"(<reduction name="r" of="b" modes="6"/>)"), 6);
  const auto other =
      frequencies(read(held + R"(<reduction name="r" of="b" modes="6" frame="b.end"/>)"), 6);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(other[k], one[k], 1e-8 * one[k]);
}

TEST(ComponentModes, RefusesByName) {
  const std::string held = section() + beam + R"(<fixed name="f" between="ground b.start"/>
    <transient duration="1" step="0.1"/>)";
  const auto with = [&](const std::string& more) { return refusal(held + more); };
  EXPECT_SAYS(with(R"(<reduction name="r" of="x"/>)"), "there is no beam or body \"x\"");
  EXPECT_SAYS(with(R"(<reduction name="r" of="b"/><reduction name="q" of="b"/>)"),
              "\"b\" is part of reduction \"r\" already");
  EXPECT_SAYS(with(R"(<reduction name="r" of="b" frame="ground"/>)"),
              "frame is none of its places");
  EXPECT_SAYS(with(R"(<reduction name="r" of="b" modes="1000"/>)"), "ask for fewer");
  EXPECT_SAYS(with(R"(<reduction name="r" of="b"/><distributed name="q" beam="b" force="0 0 1"/>)"),
              "acts along beam \"b\", which is part of reduction \"r\"");
  EXPECT_SAYS(with(R"(<beam name="c" section="s" from="5 0 0" to="7 0 0" normal="0 0 1"/>
                      <load name="l" at="c.end" force="0 0 0"/><reduction name="r" of="b c"/>)"),
              "move freely against the others");
  EXPECT_SAYS(
      with(
          R"(<body name="w" attached_to="b.end" mass="1" inertia="1 1 1"/><reduction name="r" of="w"/>)"),
      "what it is attached to is not");
  EXPECT_SAYS(
      with(
          R"(<body name="w" at="1 1 1" mass="1" inertia="1 1 1"/><rigid name="q" of="b w"/><reduction name="r" of="b"/>)"),
      "are not in the same reduction");
  EXPECT_SAYS(
      refusal(
          R"(<section name="s"><stiffness EA="1" GA2="1" GA3="1" GJ="1" EI2="1" EI3="1"/></section>)" +
          beam +
          R"(<fixed name="f" between="ground b.start"/><static/><reduction name="r" of="b"/>)"),
      "has no mass, which component modes need");
}

}  // namespace
}  // namespace mbd::test::test_component_modes
