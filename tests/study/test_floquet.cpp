// Floquet's exponents against Mathieu's boundaries of a shaken pendulum (published digits) and against monodromy matrices of
// closed equations of motion, integrated here: a two-bladed rotor on a soft tower. And against modes in steady rotation, where
// there is an axis system in which coefficients are constant.
#include "libmbd/study/modes/floquet.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "libmbd/language/reader.hpp"
#include "libmbd/study/modes/modes.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/monodromy.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_floquet {
namespace {

constexpr double pi = std::numbers::pi;
using Complex = std::complex<double>;

// A physical pendulum of equivalent length 1 m on a carriage that is shaken up and down, amplitude 0.25 m; `down` of its
// centre of mass below the hinge. In other units of mass, and leaning in a plane of its own.
Scene shaken_pendulum(double rate, bool down, double damping = 0.0) {
  return read_model_text(
      fmt::format(
          R"xml(<mbd name="shaken">
        <body name="carriage" mass="3000" inertia="1 1 1"/>
        <motion name="path" of="carriage" displacement="0 0 0.25*(cos({0:.17g}*t)-1)" rotation="0 0 0"/>
        <body name="arm" at="0 0 0" center="0 0 {1}" mass="400" inertia="100 100 1"/>
        <revolute name="hinge" between="carriage arm" axis="1 2 0"/>
        {2}
        <gravity acceleration="0 0 -9.81"/>
        <transient duration="1" step="1e-3"/>
        <record name="hinge" joint="hinge" quantities="angle"/></mbd>)xml",
          rate, down ? -0.5 : 0.5,
          damping > 0.0
              ? fmt::format(
                    "<joint_spring name=\"friction\" joint=\"hinge\" angular_damping=\"{:.17g}\"/>",
                    damping)
              : ""),
      "shaken.xml");
}

FloquetStudy floquet(const Scene& scene, double rate, int harmonics = 0) {
  FloquetOptions options;
  options.period = 2.0 * pi / rate;
  options.harmonics = harmonics;
  options.settle = 0;
  return study_floquet(scene, options);
}

// The boundaries to eight digits: exponents part as the root of the distance from them. Mutations seen: K without M Vdot~ (this
// one and friction fail), C l without 2 M D l (all fail).
TEST(Floquet, BoundariesOfMathieu) {
  struct Boundary {
    double rate;
    bool down;
    int unstable;  // 1: above, -1: below
  };
  for (const Boundary& b : {Boundary{17.9515639692, false, -1}, Boundary{5.1723029878, true, 1},
                            Boundary{9.1308973108, true, -1}})
    for (const int side : {-1, 1}) {
      const double rate = b.rate * (1.0 + side * 1e-8);
      const FloquetStudy study = floquet(shaken_pendulum(rate, b.down), rate);
      ASSERT_EQ(study.modes.size(), side == b.unstable ? 2U : 1U) << rate;  // a pair is one
      if (side == b.unstable)
        EXPECT_GT(study.growth(), 1e-5) << rate;
      else
        EXPECT_LT(std::abs(study.growth()), neutral_growth) << rate;
      EXPECT_LT(study.report.tail, 1e-10);
    }
}

// Two rigid blades with lag hinges on a hub that a soft tower lets move sideways only: in no axes are coefficients constant.
// In the plane, with blade i at psi_i = W t + i pi, q of the hub and z_i of the hinges,
//   (mh + 2 m) q'' + c q' + k q + m a sum (-sin(psi_i) z_i)'' = 0
//   (J + m a^2) z_i'' + cz z_i' + (kz + m e a W^2) z_i - m a sin(psi_i) q'' = 0.
struct TwoBlades {
  double hub = 11.0, rotor = 4.0, m = 2.5, J = 0.7, e = 0.3, a = 1.4, k = 900.0, c = 0.3, kz = 60.0,
         cz = 0.08;

  Scene scene(double W) const {
    const double r = e + a;  // of the mass centres
    return read_model_text(
        fmt::format(R"xml(<mbd name="blades">
          <body name="hub" mass="{hub}" inertia="1 1 1"/>
          <prismatic name="tower" between="ground hub" axis="0 1 0"/>
          <joint_spring name="tower_spring" joint="tower" stiffness="{k}" damping="{c}"/>
          <body name="rotor" mass="{rotor}" inertia="2 1 1" angular_velocity="{W} 0 0"/>
          <revolute name="shaft" between="hub rotor" axis="1 0 0"/>
          <drive joint="shaft" rate="{W}"/>
          <body name="b1" at="0 {e} 0" center="0 {a} 0" mass="{m}" inertia="{J} 0.1 {J}"
                velocity="0 0 {v1}" angular_velocity="{W} 0 0"/>
          <body name="b2" at="0 -{e} 0" center="0 -{a} 0" mass="{m}" inertia="{J} 0.1 {J}"
                velocity="0 0 -{v1}" angular_velocity="{W} 0 0"/>
          <revolute name="lag1" between="rotor b1" axis="1 0 0"/>
          <revolute name="lag2" between="rotor b2" axis="1 0 0"/>
          <joint_spring name="lag1_spring" joint="lag1" angular_stiffness="{kz}" angular_damping="{cz}"/>
          <joint_spring name="lag2_spring" joint="lag2" angular_stiffness="{kz}" angular_damping="{cz}"/>
          <transient duration="1" step="1e-3"/>
          <record name="tower" joint="tower" quantities="displacement"/></mbd>)xml",
                    fmt::arg("hub", hub), fmt::arg("rotor", rotor), fmt::arg("m", m),
                    fmt::arg("J", J), fmt::arg("e", e), fmt::arg("a", a), fmt::arg("k", k),
                    fmt::arg("c", c), fmt::arg("kz", kz), fmt::arg("cz", cz), fmt::arg("W", W),
                    fmt::arg("v1", W * e), fmt::arg("r", r)),
        "blades.xml");
  }

  // Of [q z1 z2 q' z1' z2'] over a period.
  Eigen::MatrixXd monodromy(double W) const {
    const auto rates = [&](double t, const Eigen::MatrixXd& x) {
      Eigen::Matrix3d M = Eigen::Matrix3d::Zero(), C = M, K = M;
      M(0, 0) = hub + rotor + 2.0 * m;
      C(0, 0) = c;
      K(0, 0) = k;
      for (int i = 0; i < 2; ++i) {
        const double s = std::sin(W * t + i * pi), co = std::cos(W * t + i * pi);
        M(0, i + 1) = M(i + 1, 0) = -m * a * s;
        C(0, i + 1) = -2.0 * m * a * W * co;
        K(0, i + 1) = m * a * W * W * s;
        M(i + 1, i + 1) = J + m * a * a;
        C(i + 1, i + 1) = cz;
        K(i + 1, i + 1) = kz + m * e * a * W * W;
      }
      Eigen::MatrixXd dx(6, 6);
      dx.topRows(3) = x.bottomRows(3);
      dx.bottomRows(3) = -M.inverse() * (C * x.bottomRows(3) + K * x.topRows(3));
      return dx;
    };
    return monodromy_of(rates, 6, 2.0 * pi / W);
  }
};

// Largest distance of a multiplier from the nearest one of a monodromy matrix, conjugates alike.
double distance(const FloquetStudy& study, const Eigen::MatrixXd& monodromy) {
  const Eigen::VectorXcd wanted = dense::eigenpairs(monodromy).values;
  double worst = 0.0;
  for (const Complex& mu : wanted) {
    double nearest = 1e300;
    for (const NamedFloquetMode& mode : study.modes)
      nearest = std::min(
          {nearest, std::abs(mode.multiplier - mu), std::abs(std::conj(mode.multiplier) - mu)});
    worst = std::max(worst, nearest);
  }
  return worst;
}

// Below, within and above the range in which the blades' lag and the tower's motion destabilise each other.
TEST(Floquet, TwoBladesOnASoftTower) {
  const TwoBlades blades;
  bool was_unstable = false, was_stable = false;
  for (const double W : {2.0, 4.0, 9.0, 12.5, 13.0, 13.5, 20.0}) {
    const FloquetStudy study = floquet(blades.scene(W), W);
    const Eigen::MatrixXd x = blades.monodromy(W);
    EXPECT_LT(distance(study, x), 2e-9) << W;
    const double growth = std::log(dense::eigenpairs(x).values.cwiseAbs().maxCoeff());
    EXPECT_NEAR(study.growth(), growth, 1e-9) << W;
    (growth > 0.0 ? was_unstable : was_stable) = true;
  }
  EXPECT_TRUE(was_stable);
  EXPECT_TRUE(was_unstable);
}

// The hanging pendulum with friction, against its closed equation.
TEST(Floquet, PendulumWithFriction) {
  constexpr double damping = 60.0, inertia = 100.0 + 400.0 * 0.25;
  for (const double W : {3.0, 7.0, 12.0}) {
    const auto rates = [&](double t, const Eigen::MatrixXd& x) {
      Eigen::MatrixXd dx(2, 2);
      dx.row(0) = x.row(1);
      dx.row(1) = -damping / inertia * x.row(1) -
                  400.0 * 0.5 / inertia * (9.81 - 0.25 * W * W * std::cos(W * t)) * x.row(0);
      return dx;
    };
    const Eigen::MatrixXd x = monodromy_of(rates, 2, 2.0 * pi / W);
    EXPECT_LT(distance(floquet(shaken_pendulum(W, true, damping), W), x), 2e-9) << W;
  }
}

// A driven pendulum of two swings of the same period, one of them a saddle: after two periods Newton's method goes there, and
// the run to the other one, on which both multipliers are exp(-c T/(2 I)) (calc: shooting by Dormand and Prince's method of order
// 8, 0.11973134 and 0.44453868 i). Mutation: what was found first is returned, "unstable, 2.175 in a period".
// At rest velocities are of round-off, in all harmonics alike: nothing of a motion is unresolved. An exponent: that of a
// mass that slides at an angle to its damped spring. Mutation: shares of harmonics of what rests.
TEST(Floquet, OfWhatRests) {
  const FloquetStudy study = floquet(read_model_text(R"(<mbd name="rests">
      <body name="a" at="0.3 0 0" mass="2" inertia="1 2 3"/>
      <prismatic name="p" between="ground a" at="0 0 0" axis="3 -4 12"/>
      <spring name="s" between="ground a" at_a="0 0 0" at_b="0.3 0 0" stiffness="50" damping="0.4"/>
      <transient duration="1" step="0.01"/></mbd>)",
                                                     "rests.xml"),
                                     2.0 * pi);
  EXPECT_EQ(study.report.tail, 0.0);
  EXPECT_TRUE(study.notes.empty());
  ASSERT_EQ(study.modes.size(), 1U);
  EXPECT_NEAR(study.growth(), -0.4 * (9.0 / 169.0) / 4.0, 1e-10);
}

TEST(Floquet, IsOfTheMotionThatTheRunLeadsTo) {
  constexpr double period = 2.0 * pi / 3.0, inertia = 0.02 + 0.25, damping = 0.2;
  const Scene scene = read_model_text(fmt::format(R"xml(<mbd name="duffing">
    <body name="m" center="0 0 -0.5" mass="1" inertia="0.02 0.02 0.02"/>
    <revolute name="p" between="ground m" axis="0 1 0"/>
    <joint_spring name="f" joint="p" angular_damping="0.2"/> <gravity acceleration="0 0 -9.81"/>
    <joint_torque joint="p" moment="2*cos(3*t)"/>
    <transient duration="{0:.17g}" step="{1:.17g}"/>
    <record name="p" joint="p" quantities="angle"/></mbd>)xml",
                                                  60.0 * period, period / 400.0),
                                      "m.xml", {});
  FloquetOptions options;
  options.period = period;
  const FloquetStudy study = study_floquet(scene, options);
  ASSERT_FALSE(study.modes.empty());  // of a pair of exponents one is shown
  for (const NamedFloquetMode& mode : study.modes) {
    EXPECT_NEAR(std::abs(mode.multiplier), std::exp(-0.5 * damping * period / inertia), 1e-7);
    EXPECT_NEAR(mode.multiplier.real(), 0.11973134, 1e-6);
    EXPECT_NEAR(std::abs(mode.multiplier.imag()), 0.44453868, 1e-6);
  }
  ASSERT_FALSE(study.notes.empty());
  EXPECT_NE(study.notes.back().find("another motion was found"), std::string::npos)
      << study.notes.back();
}

// Found by a reviewer. A motion of 500 Hz that grows is beyond the harmonics of 1 Hz: the verdict says up to which frequency it
// holds. Mutation: without its words.
TEST(Floquet, SaysForWhichMotionsItHolds) {
  const FloquetStudy study = floquet(read_model_text(R"(<mbd name="hidden">
      <body name="slow" mass="2" inertia="1 1 1"/>
      <prismatic name="rail" between="ground slow" axis="1 0 0"/>
      <joint_spring name="k" joint="rail" stiffness="50" damping="0.4"/>
      <load at="slow" force="cos(6*t) 0 0"/>
      <body name="fast" at="0 1 0" mass="1" inertia="1 1 1"/>
      <prismatic name="rail2" between="ground fast" axis="1 0 0"/>
      <joint_spring name="k2" joint="rail2" stiffness="(1000*pi)^2" damping_force="-20*pi*v"/>
      <transient duration="1" step="1e-4"/></mbd>)",
                                                     "hidden.xml"),
                                     6.0);
  EXPECT_EQ(study.stability(), Stability::stable);
  EXPECT_NE(to_text(study).find("stable, of motions up to 7.639 Hz (8 harmonics)"),
            std::string::npos)
      << to_text(study);
}

// Found by a reviewer. A pendulum whose weight jumps to and fro (Meissner's equation): multipliers are the eigenvalues of two matrix
// exponentials, and of the first order of the instants here: no verdict where they are nearer to 1 than that.
// Mutations: jumps that are not looked at; a verdict all the same.
TEST(Floquet, DoesNotDecideWhatJumpsLeaveOpen) {
  const auto of = [](double c) {
    return floquet(read_model_text(fmt::format(R"(<mbd name="meissner">
      <body name="bob" at="0 0 -1" mass="1" inertia="1e-9 1e-9 1e-9"/>
      <revolute name="hinge" between="ground bob" at="0 0 0" axis="0 1 0"/>
      <joint_spring name="d" joint="hinge" angular_damping="{}"/>
      <gravity acceleration="0 0 -9.81"/>
      <load at="bob" force="0 0 t&lt;0.5?8:t&lt;1?-8:t&lt;1.5?8:t&lt;2?-8:t&lt;2.5?8:-8"/>
      <transient duration="3" step="1e-3"/></mbd>)",
                                               c),
                                   "meissner.xml"),
                   2.0 * pi);
  };
  // Largest multiplier of x'' + c x' + (9.81 - f) x = 0 over f = 8, then -8, half a second each.
  const auto exact = [](double c) {
    const auto half = [c](double k) {
      Eigen::MatrixXd a(2, 2);
      a << 0.0, 1.0, -k, -c;
      return dense::exponential(0.5 * a);
    };
    return dense::eigenpairs(Eigen::MatrixXd(half(17.81) * half(1.81)))
        .values.cwiseAbs()
        .maxCoeff();
  };
  const FloquetStudy open = of(1.598), wide = of(0.2);
  EXPECT_LT(exact(1.598), 1.0);
  EXPECT_EQ(open.stability(), Stability::neutral);
  EXPECT_NE(to_text(open).find("not decided"), std::string::npos) << to_text(open);
  EXPECT_EQ(wide.stability(), Stability::unstable);
  EXPECT_NEAR(wide.growth(), std::log(exact(0.2)), wide.uncertain);
  EXPECT_NE(to_text(wide).find("a law jumps at 0.5 s"), std::string::npos) << to_text(wide);
}

// Mutation: without the note.
TEST(Floquet, SaysThatControllersAreHeld) {
  const FloquetStudy study = floquet(read_model_text(R"(<mbd name="held">
      <body name="m" mass="1" inertia="1 1 1"/>
      <prismatic name="rail" between="ground m" axis="1 0 0"/>
      <joint_spring name="k" joint="rail" stiffness="100" damping="0.2"/>
      <controller name="c" period="0.05"><output name="u" value="3*rail.speed"/></controller>
      <load at="m" force="u+cos(2*pi*t) 0 0"/>
      <transient duration="20" step="1e-3"/></mbd>)",
                                                     "held.xml"),
                                     2.0 * pi);
  EXPECT_NE(to_text(study).find("outputs of controllers are held"), std::string::npos)
      << to_text(study);
}

// An unround flexible shaft on bearings that are alike in all directions: in turning axes its coefficients are constant, and
// exponents are the eigenvalues there, but for multiples of i W. Frequencies of the largest harmonics are those of the modes.
TEST(FloquetSlow, UnroundShaftHasItsEigenvalues) {
  const double W = 30.0;
  const Scene scene = read_model_text(fmt::format(R"xml(<mbd name="flat">
        <section name="s"><stiffness EA="4e6" GA2="1e6" GA3="1.3e6" GJ="300" EI2="150" EI3="420"/>
          <damping stiffness_proportional="2e-4"/>
          <mass per_length="1.5" inertia="1.1e-3 4e-4 7e-4"/></section>
        <beam name="s" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="4" order="3"/>
        <revolute name="motor" between="ground s.start" axis="1 0 0"/>
        <cylindrical name="bearing" between="ground s.end" axis="1 0 0"/>
        <drive joint="motor" rate="t >= 1 ? {0} : {0}*t*t*(3-2*t)"/>
        <transient duration="1" step="1e-3"/>
        <record name="m" joint="motor" quantities="angle"/></mbd>)xml",
                                                  W),
                                      "flat.xml");
  FloquetOptions options;
  options.period = 2.0 * pi / W;
  options.settle = 6;  // the motor has run up
  options.harmonics = 10;
  options.count = 100;
  const FloquetStudy study = study_floquet(scene, options);
  ModesOptions modes_options;
  modes_options.count = 4;
  modes_options.rotation = SteadyRotation{W};
  const std::vector<NamedMode> modes = study_modes(scene, modes_options).modes;
  for (const NamedMode& mode : modes) {
    if (mode.eigenvalue.imag() > 8.0 * W) continue;  // beyond what ten harmonics hold
    const Complex mu = std::exp(mode.eigenvalue * options.period);
    double nearest = 1e300, frequency = 1e300;
    for (const NamedFloquetMode& found : study.modes) {
      const double off =
          std::min(std::abs(found.multiplier - mu), std::abs(std::conj(found.multiplier) - mu));
      if (off < nearest) nearest = off, frequency = found.frequency;
    }
    EXPECT_LT(nearest, 1e-8) << mode.eigenvalue;
    EXPECT_NEAR(frequency, mode.eigenvalue.imag(), 1e-6 * W) << mode.eigenvalue;
  }
}

// An unround shaft with a disk out of balance, under its weight: from the steady rotation that it has without weight the same
// motion is found as from a run, at the drive's angle, without integrating.
TEST(FloquetSlow, FromTheSteadyRotation) {
  const double W = 20.0;
  const Scene scene = read_model_text(fmt::format(R"xml(<mbd name="heavy">
        <section name="s"><stiffness EA="4e6" GA2="1e6" GA3="1.3e6" GJ="300" EI2="350" EI3="420"/>
          <damping stiffness_proportional="2e-3"/>
          <mass per_length="1.5" inertia="1.1e-3 4e-4 7e-4"/></section>
        <beam name="s" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2" order="3"/>
        <body name="disk" attached_to="s@0.5" mass="2" center="0 0.003 0" inertia="0.02 0.01 0.01"/>
        <revolute name="motor" between="ground s.start" axis="1 0 0"/>
        <cylindrical name="bearing" between="ground s.end" axis="1 0 0"/>
        <drive joint="motor" rate="t >= 0.95 ? {0} : {0}*(t/0.95)^2*(3-2*t/0.95)"/>
        <gravity acceleration="0 -4 -9"/><transient duration="1" step="1e-3"/>
        <record name="m" joint="motor" quantities="angle"/></mbd>)xml",
                                                  W),
                                      "heavy.xml");
  FloquetOptions options;
  options.period = 2.0 * pi / W;
  options.settle = 8;
  options.harmonics = 14;
  const FloquetStudy by_run = study_floquet(scene, options);
  options.rotation = SteadyRotation{};
  const FloquetStudy by_rotation = study_floquet(scene, options);
  ASSERT_EQ(by_rotation.modes.size(), by_run.modes.size());
  ASSERT_GE(by_run.modes.size(), 2U);
  EXPECT_LT(by_run.report.tail, 1e-8);
  for (std::size_t i = 0; i < by_run.modes.size(); ++i) {
    EXPECT_LT(std::abs(by_rotation.modes[i].exponent - by_run.modes[i].exponent), 1e-6 * W) << i;
    EXPECT_NEAR(by_rotation.modes[i].inertial, by_run.modes[i].inertial, 1e-6 * W);
  }
}

// Hill's equation x'' = -(d + e cos w t + pulses) x - c x' by a law of sensors.
Scene hill(const std::string& more, double w = 1.0) {
  return read_model_text(fmt::format(R"xml(<mbd name="hill"><parameter name="w" value="{}"/>
        <body name="b" mass="1" inertia="1 1 1" angular_velocity="0 0 1e-3"/>
        <revolute name="h" between="ground b" axis="0 0 1"/>
        <joint_torque joint="h" moment="-(0.25+{})*h.angle-0.05*h.rate"/>
        <transient duration="1" step="0.01"/><record name="h" joint="h" quantities="angle"/></mbd>)xml",
                                     w, more),
                         "hill.xml");
}

// Laws of sensors must repeat as others: of half the period of this one a false "stable" was found (multipliers over 2 pi are
// -2.117 and -0.345, by integration of the equation).
TEST(Floquet, LawsOfSensorsMustRepeat) {
  const Scene scene = hill("0.3*cos(w*t)");
  EXPECT_NEAR(std::exp(floquet(scene, 1.0).growth()), 2.11694, 1e-4);
  try {
    floquet(scene, 2.0);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("does not repeat with the period"), std::string::npos)
        << error.what();
  }
}

// Pulses between the instants are not seen: with as many as see them there is a verdict, otherwise none.
TEST(Floquet, PulsesBetweenInstants) {
  const auto pulsed = [](double sharp) {
    return hill(fmt::format("0)*h.angle+5*exp({}*(cos(w*(t-0.924))-1))-(0", sharp));
  };
  const FloquetStudy seen = floquet(pulsed(50.0), 1.0);
  EXPECT_EQ(seen.undecided, "");
  const FloquetStudy unseen = floquet(pulsed(2e5), 1.0);
  EXPECT_NE(unseen.stability(), Stability::stable);
  EXPECT_NE(unseen.undecided.find("between them it is not seen"), std::string::npos)
      << unseen.undecided;
  EXPECT_NE(to_text(unseen).find("not decided"), std::string::npos);
}

TEST(Floquet, RefusesByName) {
  const auto said = [](const Scene& scene, double period, int settle = 0) -> std::string {
    try {
      FloquetOptions options;
      options.period = period;
      options.settle = settle;
      study_floquet(scene, options);
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing";
  };
  const Scene pendulum = shaken_pendulum(5.0, true);
  EXPECT_NE(said(pendulum, 1.0).find("does not repeat with the period 1 s"), std::string::npos)
      << said(pendulum, 1.0);
  EXPECT_NE(said(pendulum, -1.0).find("period must be a positive number"), std::string::npos);
  // A free body has a periodic motion for every place and time. Round-off decides whether one is found: then it is neutral.
  const Scene free = read_model_text(
      R"xml(<mbd name="free"><body name="b" mass="1" inertia="1 1 1" angular_velocity="0 0 6.283185307179586"/>
         <transient duration="1" step="0.01"/><record name="b" at="b" quantities="position"/></mbd>)xml",
      "free.xml");
  if (const std::string message = said(free, 1.0); message == "nothing")
    EXPECT_LT(std::abs(floquet(free, 2.0 * pi).growth()), neutral_growth);
  else
    EXPECT_NE(message.find("one of many"), std::string::npos) << message;
}

}  // namespace
}  // namespace mbd::test::test_floquet
