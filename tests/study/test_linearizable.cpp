// What has no small motions is refused by name: laws at their kinks, constraints that lose rank, drives that do not go with a
// steady rotation. What has them, next to these, is not.
// Frequencies against closed forms; errors are relative.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>

#include "libmbd/compile/model.hpp"
#include "libmbd/study/modes/campbell.hpp"
#include "libmbd/study/modes/floquet.hpp"
#include "libmbd/study/modes/linearize.hpp"
#include "libmbd/study/modes/modes.hpp"
#include "libmbd/study/modes/rotations.hpp"
#include "solvers/constraints/rank_loss.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_linearizable {
namespace {

constexpr double pi = std::numbers::pi;

std::vector<double> frequencies(const Scene& scene, const ModesOptions& options = {}) {
  std::vector<double> all;
  for (const NamedMode& mode : study_modes(scene, options).modes)
    all.push_back(mode.eigenvalue.imag());
  return all;
}

std::string notes(const Scene& scene) {
  std::string all;
  for (const std::string& note : study_modes(scene, {}).notes) all += note + '\n';
  return all;
}

// 2 kg.m2 about its hinge, 3 kg on its rail, a block on a bushing.
Scene hinged(const std::string& spring, const std::string& more = "") {
  return read(R"(<body name="arm" mass="1" inertia="1 1 2"/>
                 <revolute name="hinge" between="ground arm" axis="0 0 1"/>
                 <joint_spring name="k" joint="hinge" )" +
              spring + "/>" + more);
}
Scene sliding(const std::string& more) {
  return read(R"(<body name="cart" mass="3" inertia="1 1 1"/>
                 <prismatic name="rail" between="ground cart" axis="1 0 0"/>)" +
              more);
}
Scene mounted(const std::string& law) {
  return read(R"(<body name="block" mass="1" inertia="1 1 1"/>
                 <bushing name="mount" between="ground block" at="0 0 0" stiffness="10 10 10"
                          angular_stiffness="5 5 5"><law )" +
              law + "/></bushing>");
}

std::string at(double x, double y) { return fmt::format("{:.17g} {:.17g} 0", x, y); }

// Cranks AB and DC with a coupler BC, A at the origin, and a spring on the first; of any size, on any body.
struct Linkage {
  Vec3 B, C, D;
  double size = 1.0;
  Vec3 origin = Vec3::Zero();
  std::string base = "ground", prefix = "";
  std::string damping = "";  // attribute of the spring

  std::string text() const {
    const auto place = [&](const Vec3& r) {
      const Vec3 there = origin + size * r;
      return at(there(0), there(1));
    };
    const auto inertia = [&](double J) {
      return fmt::format("{0:.17g} {0:.17g} {0:.17g}", J * size * size);
    };
    return fmt::format(
        R"(<body name="{0}a" at="{1}" mass="1" inertia="{2}"/>
           <body name="{0}b" at="{3}" mass="2" inertia="{4}"/>
           <body name="{0}c" at="{5}" mass="1" inertia="{2}"/>
           <revolute name="{0}A" between="{6} {0}a" at="{7}" axis="0 0 1"/>
           <revolute name="{0}B" between="{0}a {0}b" at="{8}" axis="0 0 1"/>
           <revolute name="{0}C" between="{0}b {0}c" at="{9}" axis="0 0 1"/>
           <revolute name="{0}D" between="{0}c {6}" at="{10}" axis="0 0 1"/>
           <joint_spring name="{0}k" joint="{0}A" angular_stiffness="{11:.17g}" {12}/>)",
        prefix, place(0.5 * B), inertia(0.1), place(0.5 * (B + C)), inertia(0.4),
        place(0.5 * (C + D)), base, place(Vec3::Zero()), place(B), place(C), place(D),
        100.0 * size * size, damping);
  }
};

Scene linkage(const Vec3& B, const Vec3& C, const Vec3& D) {
  return read(Linkage{.B = B, .C = C, .D = D}.text());
}

// Cranks of 1 m between pins 4 m apart, with a coupler of 2 m flat between them or, longer, bent.
Scene trapezium(double height) {
  const double reach = std::sqrt(1.0 - height * height);
  return linkage({reach, height, 0.0}, {4.0 - reach, height, 0.0}, {4.0, 0.0, 0.0});
}

// Cranks of 1 m and a coupler of 2 m.
Linkage parallel_cranks(double angle) {
  const Vec3 crank(std::cos(angle), std::sin(angle), 0.0), base(2.0, 0.0, 0.0);
  return {.B = crank, .C = base + crank, .D = base};
}
Scene parallelogram(double angle) { return read(parallel_cranks(angle).text()); }

// --- laws ---

// Mutations seen: both slopes taken from the right; dampers looked at at their lengths.
TEST(KinksOfLaws, AreRefusedByName) {
  const struct {
    Scene scene;
    const char *element, *where;
  } cases[] = {
      {hinged(R"(moment="x > 0 ? 100*x : 1000*x")"), "joint spring 'k'",
       "x = 0 rad the slope is 1000 from below and 100 from above"},
      {hinged(R"x(moment="500*abs(x)")x"), "joint spring 'k'",
       "x = 0 rad the slope is -500 from below and 500 from above"},
      {hinged(R"(angular_stiffness="10" moment="max(x, 0)*7")"), "joint spring 'k'",
       "x = 0 rad the slope is 0 from below and 7 from above"},
      {hinged(R"(angular_stiffness="10" damping_moment="v &lt; 0 ? 2*v : 20*v")"),
       "joint spring 'k'", "v = 0 rad/s the slope is 2 from below and 20 from above"},
      {sliding(R"(<joint_spring name="k" joint="rail" force="x > 0 ? 100*x : 1000*x"/>)"),
       "joint spring 'k'", "x = 0 m the slope is 1000 from below and 100 from above"},
      {sliding(
           R"(<joint_spring name="k" joint="rail" stiffness="5" damping_force="min(v, 0)*3"/>)"),
       "joint spring 'k'", "v = 0 m/s the slope is 3 from below and 0 from above"},
      {sliding(R"(<spring name="stop" between="ground cart" at_a="-2 0 0" length="2"
                          force="x &lt; 0 ? 1e5*x : 0"/>
                  <joint_spring name="k" joint="rail" stiffness="5"/>)"),
       "spring 'stop'", "x = 0 m the slope is 100000 from below and 0 from above"},
      {sliding(R"(<joint_spring name="k" joint="rail" stiffness="5"/>
                  <spring name="shock" between="ground cart" at_a="-2 0 0"
                          damping_force="v &lt; 0 ? 2*v : 20*v"/>)"),
       "spring 'shock'", "v = 0 m/s the slope is 2 from below and 20 from above"},
      {mounted(R"(component="2" force="x &lt; 0 ? 3*x : 4*x")"), "bushing 'mount'",
       "x = 0 m the slope is 3 from below and 4 from above"},
      {mounted(R"x(component="6" moment="abs(x)")x"), "bushing 'mount'",
       "x = 0 rad the slope is -1 from below and 1 from above"},
  };
  for (const auto& one : cases) {
    const auto& [scene, element, where] = one;
    for (const auto& what : {std::function<void()>([&] { study_modes(one.scene, {}); }),
                             std::function<void()>([&] { linearize(one.scene, {}); })}) {
      const std::string said = refusal(what);
      EXPECT_SAYS(said, element + std::string(" is at a kink of its law: at ") + where);
    }
  }
}

// Where the equilibrium is on one side, its slope counts, and the report says how far the kink is.
TEST(KinksOfLaws, BesideOneASlopeCounts) {
  const auto loaded = [&](const char* force) {
    return sliding(fmt::format(R"(<joint_spring name="k" joint="rail"
                                    force="x > 0.1 ? 10 + 400*(x - 0.1) : 100*x"/>
                                  <load at="cart" force="{} 0 0"/><static/>)",
                               force));
  };
  EXPECT_NEAR(frequencies(loaded("6")).front(), std::sqrt(100.0 / 3.0), 1e-9);
  EXPECT_NEAR(frequencies(loaded("14")).front(), std::sqrt(400.0 / 3.0), 1e-9);
  EXPECT_SAYS(notes(loaded("6")), "kink at x = 0.1 m, which is 0.04 m away");
  EXPECT_SAYS(notes(loaded("14")), "kink at x = 0.1 m, which is 0.01 m away");
  EXPECT_SAYS(refusal([&] { study_modes(loaded("10"), {}); }), "100 from below and 400 from above");
}

// Slopes that agree are no kink, whatever the curvature does.
TEST(KinksOfLaws, SmoothOnesAreNone) {
  for (const char* const law :
       {"50*x + 3*x*abs(x)", "x > 0 ? 50*x : 50*x + 4*x^3", "50*x + max(x, 0)^2"}) {
    const Scene scene = hinged(std::string("moment=\"") + law + '"');
    EXPECT_NEAR(frequencies(scene).front(), 5.0, 1e-9) << law;
    EXPECT_EQ(notes(scene), "") << law;
  }
  // Found by a reviewer: slopes of x^3 beside 0 were round-off of one another.
  for (const char* const moment : {"1e-16", "1e-12", "3e-11", "1e-10"}) {
    const Scene scene = hinged(R"(angular_stiffness="50" moment="3*x^3")",
                               fmt::format(R"(<load at="arm" moment="0 0 {}"/>)", moment));
    EXPECT_NEAR(frequencies(scene).front(), 5.0, 1e-9) << moment;
    EXPECT_EQ(notes(scene), "") << moment;
  }
}

// Straight lines between points have kinks at these, splines none.
TEST(KinksOfLaws, OfTables) {
  const auto with_table = [](const char* interpolation) {
    return read(fmt::format(R"(<body name="arm" mass="1" inertia="1 1 2"/>
        <revolute name="hinge" between="ground arm" axis="0 0 1"/>
        <joint_spring name="k" joint="hinge">
          <table of="moment" interpolation="{}">-1 -100  0 0  1 50  2 60</table></joint_spring>)",
                            interpolation));
  };
  EXPECT_SAYS(refusal([&] { study_modes(with_table("linear"), {}); }),
              "the slope is 100 from below and 50 from above");
  EXPECT_EQ(refusal([&] { study_modes(with_table("smooth"), {}); }), "no error");
}

// Where slopes are level on both sides they are round-off. Mutation seen: slopes beside the larger of them alone.
TEST(KinksOfLaws, LevelOnesAreNone) {
  const std::string spline = R"(angular_stiffness="50"/>
      <joint_spring name="t" joint="hinge"><table of="moment" interpolation="smooth">)";
  const std::string end = "</table></joint_spring><static";
  for (const std::string& law :
       {std::string(R"x(angular_stiffness="50" moment="x > 0.1 ? 5 : 5*sin(pi/2*x/0.1)"/>
                        <load at="arm" moment="0 0 10"/><static)x"),
        std::string(R"x(angular_stiffness="50" moment="x > 0 ? 0 : 100*(cos(pi*(x+1))+1)")x"),
        spline + "-2 4 -1 1 0 0 1 1 2 4" + end,
        spline + "-0.3 0.7 -0.1 0.1 0 0 0.1 0.1 0.3 0.7" + end}) {
    const Scene scene = hinged(law);
    EXPECT_NEAR(frequencies(scene).front(), 5.0, 1e-9) << law;
    EXPECT_EQ(notes(scene), "") << law;
  }
}

// A kink of what no motion changes to the first order is none: components that a rail holds, a rope and a damper across it
// (y^2/4, of order y^3 in the force), what is fixed, what a drive holds. Mutation seen: none of them asked for.
TEST(KinksOfLaws, OfWhatNothingMovesAreNone) {
  const char* const rail = R"(<joint_spring name="k" joint="rail" stiffness="300"/>)";
  for (const std::string& more :
       {std::string(R"(<bushing name="mount" between="ground cart" at="0 0 0" stiffness="300 10 10"
                                angular_stiffness="5 5 5">
                         <law component="2" force="x &lt; 0 ? 30*x : 40*x"/></bushing>)"),
        std::string(rail) + R"(<spring name="rope" between="ground cart" at_a="0 2 0" length="2"
                                       force="x > 0 ? 1e5*x : 0"/>)",
        std::string(rail) + R"(<spring name="rope" between="ground cart" at_a="0 2 0"
                                       damping_force="v &lt; 0 ? 2*v : 20*v"/>)",
        std::string(rail) + R"(<body name="post" at="0 3 0" mass="1" inertia="1 1 1"/>
                               <fixed name="foot" between="ground post" at="0 3 0"/>
                               <spring name="prop" between="ground post" at_a="0 2 0" length="1"
                                       force="x > 0 ? 1e5*x : 0"/>)",
        std::string(rail) + R"x(<body name="other" mass="1" inertia="1 1 1"/>
                               <revolute name="H" between="ground other" axis="0 0 1"/>
                               <drive joint="H" angle="0"/>
                               <joint_spring name="held" joint="H" moment="5*abs(x)"/>)x"}) {
    SCOPED_TRACE(more);
    std::vector<double> found;
    EXPECT_EQ(refusal([&] { found = frequencies(sliding(more)); }), "no error");
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found.front(), 10.0, 1e-8);
  }
  // Along the rail it is one.
  EXPECT_SAYS(refusal([&] {
                frequencies(sliding(std::string(rail) +
                                    R"(<spring name="rope" between="ground cart" at_a="-2 0 0"
                                               length="2" force="x > 0 ? 1e5*x : 0"/>)"));
              }),
              "spring 'rope' is at a kink of its law");
}

// Mutations seen: intervals not divided; infinite slopes compared by their ratio.
TEST(KinksOfLaws, ThatNoConditionTellsOf) {
  const auto at_half = [](const std::string& moment, double load) {
    return hinged(fmt::format(R"(angular_stiffness="50" moment="{}"/>
                                 <load at="arm" moment="0 0 {}"/><static)",
                              moment, load));
  };
  const auto said = [&](const std::string& moment) {
    return refusal([&] { study_modes(at_half(moment, 25.0), {}); });
  };
  for (const char* const law : {"20*sqrt((x-0.5)^2)", "20*pow((x-0.5)^2, 0.5)"})
    EXPECT_SAYS(said(law),
                "at a kink of its law: at x = 0.5 rad the slope is -20 from below and 20");
  EXPECT_SAYS(said("(x-0.5)*20*atan2(0, x-0.5)/pi"), "the slope is 20 from below and 0 from above");
  EXPECT_SAYS(said("0.5 > x ? 0 : 200*(x-0.5)^0.5"),
              "the slope is 0 from below and inf from above");
  // Beside it the slope counts; what is steep, or of high curvature, has none.
  EXPECT_NEAR(frequencies(at_half("20*sqrt((x-0.5)^2)", 30.0)).front(), std::sqrt(35.0),
              1e-8);  // x = 0.571
  for (const char* const law : {"20*(sin(pi*x)-1)", "1e-3*tanh(1e5*(x-0.5))", "exp(40*(x-0.5))-1"})
    EXPECT_EQ(said(law), "no error") << law;
}

// What one rope lets go another takes up: that is linear, but each law has one slope in small motions (300 N/m twice), and is
// refused with what to do. Mutation seen: not refused (w^2 = 200 for 100).
TEST(KinksOfLaws, ThatMakeUpForEachOther) {
  const auto ropes = [](const char* right) {
    const char* const rope = R"(<spring name="{}" between="ground cart" at_a="{} 0 0" length="2"
                                        force="x > 0 ? {}*x : 0"/>)";
    return sliding(fmt::format(fmt::runtime(rope), "left", "-2", "300") +
                   fmt::format(fmt::runtime(rope), "right", "2", right));
  };
  EXPECT_SAYS(refusal([&] { study_modes(ropes("300"), {}); }), "give them as one law");
  EXPECT_SAYS(refusal([&] { study_modes(ropes("301"), {}); }), "are not linear");
  EXPECT_NEAR(
      frequencies(sliding(R"(<joint_spring name="k" joint="rail" stiffness="300"/>)")).front(),
      10.0, 1e-9);
}

// Kinks of laws of sensors: conditions are refused when they are read, these by their slopes. Moments of 50 N.m/rad and a law
// over 2 kg.m2; what no motion changes is none. Mutations seen: the changes of readings not asked for; slopes along one motion only; slopes
// that are small beside nothing.
TEST(KinksOfLaws, OfSensors) {
  const auto with = [](const char* moment) {
    return read(fmt::format(R"(<body name="arm" mass="1" inertia="1 1 2"/>
        <revolute name="hinge" between="ground arm" axis="0 0 1"/>
        <joint_spring name="k" joint="hinge" angular_stiffness="50"/>
        <joint_torque name="T" joint="hinge" moment="{}"/>)",
                            moment));
  };
  const struct {
    const char *moment, *where;
  } kinks[] = {
      {"-20*sqrt(hinge.angle^2)", "is 20 from below and -20 from above"},
      {"-20*sqrt(hinge.rate^2)", "at hinge.rate = 0 (SI) the slope is 20 from below"},
      {"-14*hinge.angle*atan2(0, hinge.angle)/pi", "is -14 from below and 0 from above"},
      {"-3*hinge.rate - 20*pow((hinge.angle + hinge.rate)^2, 0.5)", "along motions the slope is"},
      // Of each reading alone these are smooth; along any line the last but one is straight.
      {"-20*(sqrt((hinge.angle+hinge.rate)^2) - sqrt((hinge.angle-hinge.rate)^2))",
       "along motions the slope is"},
      {"-3*hinge.angle*hinge.rate/sqrt(hinge.angle^2+hinge.rate^2)", "along motions the slope is"},
      {"-3*hinge.angle^3/(hinge.angle^2+hinge.rate^2)", "do not add up"},
      {"-3*atan2(0, hinge.rate)", "it jumps from"},
  };
  for (const auto& [moment, where] : kinks) {
    const Scene scene = with(moment);
    for (const auto& what : {std::function<void()>([&] { study_modes(scene, {}); }),
                             std::function<void()>([&] { linearize(scene, {}); })}) {
      const std::string said = refusal(what);
      EXPECT_SAYS(said, "joint_torque \"T\"");
      EXPECT_SAYS(said, where);
    }
  }
  const struct {
    const char* moment;
    double stiffness;
  } smooth[] = {{"-14*hinge.angle", 64.0},
                {"-14*hinge.angle^3", 50.0},
                {"-20*hinge.angle*sqrt(hinge.angle^2 + hinge.rate^2)", 50.0},
                {"-14*sqrt((hinge.angle - 0.1)^2)", 36.0},
                {"-14*sqrt(arm.displacement.1^2)", 50.0},
                {"-14*(sqrt(hinge.angle^2 + 1e-12) - 1e-6)", 50.0}};
  for (const auto& [moment, stiffness] : smooth) {
    const Scene scene = with(moment);
    std::vector<double> found;
    EXPECT_EQ(refusal([&] { found = frequencies(scene); }), "no error") << moment;
    ASSERT_EQ(found.size(), 1U) << moment;
    EXPECT_NEAR(found.front(), std::sqrt(stiffness / 2.0), 1e-8) << moment;
  }
}

// The angles of both cranks of a parallelogram, one against the other, add up to nothing in any motion: no kink; w^2 = k/J.
TEST(KinksOfLaws, OfSensorsThatCancel) {
  const auto with = [](const char* sign) {
    return read(
        parallel_cranks(0.7).text() +
        fmt::format(R"x(<joint_torque joint="A" moment="-20*sqrt((A.angle{}D.angle)^2)"/>)x",
                    sign));
  };
  EXPECT_NEAR(frequencies(with("+")).front(), std::sqrt(100.0 / 2.7), 1e-7);
  EXPECT_SAYS(refusal([&] { study_modes(with("-"), {}); }), "is at a kink of its law");
}

// What answers to an input is refused by `mbd linearize` where it has no slope by it.
TEST(KinksOfLaws, OfInputs) {
  const auto with = [](const char* moment, double u) {
    return read(fmt::format(R"(<input name="u" value="{}"/>
        <body name="arm" mass="1" inertia="1 1 2"/>
        <revolute name="hinge" between="ground arm" axis="0 0 1"/>
        <joint_spring name="k" joint="hinge" angular_stiffness="50"/>
        <joint_torque name="T" joint="hinge" moment="{}"/>)",
                            u, moment));
  };
  EXPECT_SAYS(refusal([&] { linearize(with("20*sqrt(u^2)", 0.0), {}); }),
              "at the input u = 0 (SI) it is -20 from below and 20 from above");
  EXPECT_SAYS(refusal([&] { linearize(with("20*atan2(0, u)", 0.0), {}); }), "is at a jump");
  for (const char* const smooth : {"20*u^3", "20*u*sqrt(u^2)", "20*sqrt((u-1)^2)", "sin(t)"})
    EXPECT_EQ(refusal([&] { linearize(with(smooth, 0.0), {}); }), "no error") << smooth;
}

// At rest a slider touches its stop; an arm that turns takes it off: w^2 = k/m - W^2.
TEST(KinksOfLaws, AreLeftByTurning) {
  const Scene scene = read(R"x(
    <body name="arm" mass="1" inertia="1 1 1"/>
    <body name="slider" at="0.5 0 0" mass="2" inertia="1 1 1"/>
    <revolute name="hub" between="ground arm" at="0 0 0" axis="0 0 1"/>
    <prismatic name="rail" between="arm slider" at="0.5 0 0" axis="1 0 0"/>
    <joint_spring name="k" joint="rail" force="x &lt; 0 ? 1e4*x : 800*x"/>
    <drive joint="hub" rate="6*(1 - exp(-40*t))"/>
    <transient duration="2" step="1e-3"/>)x");
  EXPECT_SAYS(refusal([&] { study_modes(scene, {}); }), "10000 from below and 800 from above");
  ModesOptions turning;
  turning.rotation = SteadyRotation{6.0, Vec3::UnitZ()};
  EXPECT_NEAR(frequencies(scene, turning).front(), std::sqrt(400.0 - 36.0), 1e-8);
}

// A motion that stays at a kink has no Floquet exponents; one that goes through has.
TEST(KinksOfLaws, OfPeriodicMotions) {
  FloquetOptions options;
  options.period = 1.0;
  const auto scene = [](const char* force) {
    return sliding(fmt::format(
        R"(<joint_spring name="k" joint="rail" damping="3" force="x > 0 ? 300*x : 250*x"/>
           <load at="cart" force="{} 0 0"/><transient duration="1" step="1e-3"/>)",
        force));
  };
  EXPECT_SAYS(refusal([&] { study_floquet(scene("0*t"), options); }),
              "250 from below and 300 from above");
  EXPECT_EQ(refusal([&] { study_floquet(scene("5*sin(2*pi*t)"), options); }), "no error");
}

// --- constraints ---

// w^2 = k/J, J of both cranks about their pins and of the coupler's mass at their end. Flat it has two motions to the first
// order; they are not to the second. Mutation seen: n^T dB[u] compared without what B^T answers (all are refused).
TEST(RankLoss, AFlatLinkageIsRefused) {
  const double inertia = 2.0 * (0.1 + 0.25) + 2.0;
  for (const double angle : {0.01, 0.7, pi / 2, 2.0}) {
    const std::vector<double> found = frequencies(parallelogram(angle));
    ASSERT_EQ(found.size(), 1U) << angle;
    EXPECT_NEAR(found.front(), std::sqrt(100.0 / inertia), 1e-7) << angle;
  }
  for (const double angle : {0.0, pi}) {
    const Scene flat = parallelogram(angle);
    for (const auto& what : {std::function<void()>([&] { study_modes(flat, {}); }),
                             std::function<void()>([&] { linearize(flat, {}); })}) {
      const std::string said = refusal(what);
      EXPECT_SAYS(said, "lose rank in this configuration");
      EXPECT_SAYS(said, "revolute 'B'");
    }
  }
  EXPECT_SAYS(refusal([] { study_modes(trapezium(0.0), {}); }), "lose rank");
  EXPECT_EQ(refusal([] { study_modes(trapezium(0.6), {}); }), "no error");
}

// A linkage and an arm far away, or a linkage that is small, each as if it were alone: no modes are invented, damped or not, and a
// flat linkage is refused. Mutations seen: openings of constraints by the size of the scene; ranks by lengths of the scene (the smallest is refused).
TEST(RankLoss, BesideWhatIsFarAway) {
  const double alone = 100.0 / (2.0 * (0.1 + 0.25) + 2.0);  // w^2
  const auto beside = [](double angle, double size, double far, const char* damping) {
    Linkage small = parallel_cranks(angle);
    small.size = size;
    small.damping = damping;
    return read(small.text() +
                fmt::format(R"(<body name="far" at="{0} 0 0" mass="1" inertia="1 1 1"/>
                               <revolute name="F" between="ground far" at="{0} 0 0" axis="0 0 1"/>
                               <joint_spring name="kf" joint="F" angular_stiffness="7"/>)",
                            far));
  };
  for (const auto& [size, far] :
       {std::pair{1.0, 10.0}, {1.0, 3e5}, {1.0, 1e7}, {1e-3, 1.0}, {1e-6, 1.0}, {1e-9, 1.0}}) {
    SCOPED_TRACE(fmt::format("{} beside {}", size, far));
    EXPECT_SAYS(refusal([&] { study_modes(beside(0.0, size, far, ""), {}); }), "lose rank");
    const std::vector<double> found = frequencies(beside(0.7, size, far, ""));
    ASSERT_EQ(found.size(), 2U);
    EXPECT_NEAR(found[0], std::sqrt(7.0), 1e-7);
    EXPECT_NEAR(found[1], std::sqrt(alone), 1e-7 + 1e-15 / size);  // round-off of places
  }
  // c = 10 J: a decay of 5/s.
  const std::vector<double> damped = frequencies(beside(0.7, 1.0, 1e6, R"(angular_damping="27")"));
  ASSERT_EQ(damped.size(), 2U);
  EXPECT_NEAR(damped[0], std::sqrt(7.0), 1e-7);
  EXPECT_NEAR(damped[1], std::sqrt(alone - 25.0), 1e-6);
}

// A small linkage on the coupler of a large one: as of displacements u of the large crank's end and v of the small one's beside it,
// 2 T = 6.7 u'^2 + 2.7 v'^2 + 6 cos(0.2) u' v', 2 V = 100 (u^2 + v^2), whatever its size. Mutation seen: as above.
TEST(RankLoss, OfALinkageInsideALargerOne) {
  const double c = 3.0 * std::cos(0.2), trace = 9.4, det = 6.7 * 2.7 - c * c,
               root = std::sqrt(0.25 * trace * trace - det);
  for (const double size : {1e-2, 1e-4, 1e-6}) {
    SCOPED_TRACE(size);
    const auto both = [&](double angle) {
      const Linkage large = parallel_cranks(0.9);
      Linkage small = parallel_cranks(angle);
      small.size = size;
      small.origin = large.B;
      small.base = "b";
      small.prefix = "small_";
      return read(large.text() + small.text());
    };
    const std::vector<double> found = frequencies(both(0.7));
    ASSERT_EQ(found.size(), 2U);
    EXPECT_NEAR(found[0], std::sqrt(100.0 / (0.5 * trace + root)), 1e-6);
    EXPECT_NEAR(found[1], std::sqrt(100.0 / (0.5 * trace - root)), 1e-6);
    EXPECT_SAYS(refusal([&] { study_modes(both(0.0), {}); }), "lose rank");
  }
}

// Watt's linkage, whose coupler's middle is on a line that it leaves with the fifth power of the way (0.4 m^-4): it is locked, and
// of the first and of the second order as free as without the line. Without it w^2 = 100/2.7, and off the middle nothing moves to
// the first order beside the line either. Mutation seen: rows looked at where the mechanism is, alone.
TEST(RankLoss, OfAHigherOrder) {
  const std::string linkage = R"(
      <body name="a" at="-0.5 0.3 0" mass="1" inertia="0.1 0.1 0.1"/>
      <body name="c" at="0.5 -0.3 0" mass="1" inertia="0.1 0.1 0.1"/>
      <body name="b" at="0 0 0" mass="2" inertia="0.1 0.1 0.1"/>
      <revolute name="A" between="ground a" at="-1 0.3 0" axis="0 0 1"/>
      <revolute name="B" between="a b" at="0 0.3 0" axis="0 0 1"/>
      <revolute name="C" between="b c" at="0 -0.3 0" axis="0 0 1"/>
      <revolute name="D" between="c ground" at="1 -0.3 0" axis="0 0 1"/>
      <joint_spring name="k" joint="A" angular_stiffness="100"/>)";
  const std::string line =
      R"(<point_on_line name="G" between="b ground" at="0 0 0" axis="0 1 0"/>)";
  EXPECT_NEAR(frequencies(read(linkage)).front(), std::sqrt(100.0 / 2.7), 1e-8);
  EXPECT_SAYS(refusal([&] { study_modes(read(linkage + line), {}); }),
              "lose rank in this configuration (to a higher order: point_on_line 'G'");
}

// Rods that repeat each other, a millionth of the plate that hangs on them: w^2 = k/m along the ground, whatever their length.
// Mutation seen: n^T dB[u] beside its own size, not that of what cancels in it.
TEST(RankLoss, OfAPlateOnShortRods) {
  for (const double rod : {1.0, 1e-3, 1e-6}) {
    std::string rods;
    for (const double x : {-0.5, 0.0, 0.5})
      rods += fmt::format(R"(<distance name="d{0:.0f}" between="ground plate" at_a="{1} {2} 0"
                                       at_b="{1} 0 0"/>)",
                          2.0 * (x + 1.0), x, rod);
    const Scene scene = read(R"(<body name="plate" mass="2" inertia="1 1 1"/>
        <planar name="P" between="ground plate" at="0 0 0" axis="0 0 1"/>
        <bushing name="k" between="ground plate" at="0 0 0" stiffness="200 0 0"
                 angular_stiffness="0 0 0"/>)" +
                             rods);
    std::vector<double> found;
    EXPECT_EQ(refusal([&] { found = frequencies(scene); }), "no error") << rod;
    ASSERT_EQ(found.size(), 1U) << rod;
    EXPECT_NEAR(found.front(), 10.0, 1e-6) << rod;
  }
}

// What nothing moves loses nothing: a block that two hinges hold along two axes, and an arm beside it that swings.
TEST(RankLoss, OfWhatIsHeldThroughout) {
  const std::string held = R"(<body name="block" at="1 1 0" mass="1" inertia="1 1 1"/>
      <revolute name="X" between="ground block" at="1 0 0" axis="1 0 0"/>
      <revolute name="Y" between="ground block" at="0 1 0" axis="0 1 0"/>)";
  const Model model = compile(read(held + R"(<static/>)"));
  EXPECT_EQ(model.redundant.size(), 4U);
  EXPECT_EQ(rank_loss(*model.system, model.initial), "");
  const Scene both = read(held + R"(<body name="arm" at="5 0 0" mass="1" inertia="1 1 2"/>
      <revolute name="hinge" between="ground arm" at="5 0 0" axis="0 0 1"/>
      <joint_spring name="k" joint="hinge" angular_stiffness="8"/>)");
  EXPECT_NEAR(frequencies(both).front(), 2.0, 1e-9);
}

// Six wheels and a rod, of which four cranks repeat others: w^2 = k/(6 J + m).
TEST(RankLoss, OfARodOnSixWheels) {
  const auto train = [](double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    std::string all = fmt::format(R"(<body name="rod" at="{}" mass="1" inertia="1 1 1"/>
        <joint_spring name="k" joint="P0" angular_stiffness="50"/>)",
                                  at(5 + c, s));
    for (int i = 0; i < 6; ++i)
      all += fmt::format(R"(<body name="w{0}" at="{1}" mass="1" inertia="0.1 0.2 0.3"/>
          <revolute name="P{0}" between="ground w{0}" at="{1}" axis="0 0 1"/>
          <revolute name="Q{0}" between="w{0} rod" at="{2}" axis="0 0 1"/>)",
                         i, at(2.0 * i, 0), at(2.0 * i + c, s));
    return read(all);
  };
  EXPECT_NEAR(frequencies(train(0.7)).front(), std::sqrt(50.0 / 2.8), 1e-8);
  EXPECT_SAYS(refusal([&] { study_modes(train(0.0), {}); }), "lose rank");
}

// Constraints that repeat each other wherever the mechanism is lose nothing.
TEST(RankLoss, RepeatedConstraintsHaveNone) {
  for (const char* const name :
       {"hard/bricard", "hard/parallelogram", "hard/door", "hard/turning_joints", "windows",
        "four_bar", "rigid_frame", "slider_crank", "every_joint", "hard/dead_centre"}) {
    const Model model = compile(model_scene(name));
    EXPECT_EQ(rank_loss(*model.system, model.initial), "") << name;
  }
}

// A slider-crank of equal lengths at its dead centre: it may go on as a crank, or turn about its pin as one body.
TEST(RankLoss, AtADeadCentre) {
  const auto lost_at = [](const char* angle) {
    const Model model = compile(model_scene("hard/dead_centre", {{"q0", angle}}));
    return rank_loss(*model.system, model.initial);
  };
  EXPECT_SAYS(lost_at("pi/2"), "lose rank");
  EXPECT_EQ(lost_at("pi/2 + 1e-3"), "");
}

// --- drives ---

std::string refusal_of_rotor(const std::string& rate, const std::string& more) {
  ModesOptions options;
  options.rotation = SteadyRotation{40.0};
  const std::string rotor = R"(<body name="rotor" mass="2" inertia="2 1 1"/>
      <body name="blade" at="0 0 1" mass="1" inertia="0.1 0.1 0.1"/>
      <revolute name="hub" between="ground rotor" axis="1 0 0"/>
      <revolute name="pitch" between="rotor blade" at="0 0 0.5" axis="0 0 1"/>
      <transient duration="10" step="1e-2"/><drive joint="hub" rate=")";
  return refusal([&] { study_modes(read(rotor + rate + "\"/>" + more), options); });
}

// Mutation seen: the rates of the whole run compared.
TEST(UnsteadyDrives, AreRefusedByName) {
  const std::string spring = R"(<joint_spring name="k" joint="pitch" angular_stiffness="30"/>)";
  for (const char* const steady : {"t &lt; 1 ? 50*t : 50", "50*tanh(4*t)", "min(5*t, 40)",
                                   "t &lt; 10.5 ? 50*tanh(4*t) : 50 + sin(t - 10.5)^2"})
    EXPECT_EQ(refusal_of_rotor(steady, spring), "no error") << steady;
  for (const char* const unsteady :
       {"50*sin(t)", "5*t", "50*tanh(4*t) + 0.1*sin(2*pi*10*t)", "500*t/(10 + t)"}) {
    const std::string said = refusal_of_rotor(unsteady, spring);
    EXPECT_SAYS(said, "\"hub\"");
    EXPECT_SAYS(said, "has no constant rate at the end of the run");
  }
  const std::string pitching =
      refusal_of_rotor("50*tanh(4*t)", R"x(<drive joint="pitch" angle="0.1*sin(3*t)^2"/>)x");
  EXPECT_SAYS(pitching, "\"pitch\"");
  EXPECT_SAYS(pitching, "changes no shape");
  EXPECT_EQ(refusal_of_rotor("50*tanh(4*t)", R"(<drive joint="pitch" angle="0"/>)"), "no error");
}

TEST(UnsteadyDrives, AreRefusedByStudiesOverTheRate) {
  Scene scene = model_scene("shaft");
  scene.gravity.reset();
  scene.drives[0].rate = Expression::parse("20*t", {}, Variables::time);
  CampbellOptions campbell;
  campbell.from = 10.0;
  campbell.to = 20.0;
  EXPECT_SAYS(refusal([&] { study_campbell(scene, campbell); }), "no constant rate");
  RotationsOptions rotations;
  rotations.from = 10.0;
  rotations.to = 20.0;
  EXPECT_SAYS(refusal([&] { study_rotations(scene, rotations); }), "no constant rate");
}

}  // namespace
}  // namespace mbd::test::test_linearizable
