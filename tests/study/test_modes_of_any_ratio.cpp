// Modes where a scene has motions of very different speeds, sizes or masses, damped as well, or bodies whose reference points
// are far from their joints: each is found, and none beside them.
// Frequencies against closed forms; errors are relative.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "libmbd/study/modes/modes.hpp"
#include "tests/support/read_text.hpp"

namespace mbd::test::test_modes_of_any_ratio {
namespace {

using Complex = std::complex<double>;

std::vector<Complex> elastic(const Scene& scene, const ModesOptions& options = {}) {
  std::vector<Complex> all;
  for (const NamedMode& mode : study_modes(scene, options).modes)
    if (std::abs(mode.eigenvalue) > 0.0) all.push_back(mode.eigenvalue);
  return all;
}

// Of J a'' + c a' + k a = 0.
Complex eigenvalue(double k, double c, double J) {
  return {-0.5 * c / J, std::sqrt(k / J - 0.25 * c * c / (J * J))};
}

void expect_near(const Complex& found, const Complex& want, double relative) {
  EXPECT_LE(std::abs(found - want), relative * std::abs(want)) << found << " for " << want;
}

std::string arm(int i, double x, double k, double c) {
  return fmt::format(R"(<body name="a{0}" at="{1} 0.21 0" mass="1" inertia="1 1 1"/>
      <revolute name="R{0}" between="ground a{0}" at="{2} 0 0" axis="0 0 1"/>
      <joint_spring name="k{0}" joint="R{0}" angular_stiffness="{3}" angular_damping="{4}"/>)",
                     i, x + 0.3, x, k, c);
}

// Two arms, of which the slow one is damped: J = 1 + 0.3^2 + 0.21^2. Mutation seen: what opens constraints a little is kept.
TEST(ModesOfAnyRatio, OfSpeeds) {
  const double J = 1.0 + 0.09 + 0.0441;
  for (const double ratio : {1e2, 1e4, 1e6}) {
    SCOPED_TRACE(ratio);
    const std::vector<Complex> found =
        elastic(read(arm(0, 0.0, 1.0, 0.05) + arm(1, 3.0, ratio * ratio, 0.0)));
    ASSERT_EQ(found.size(), 2U);
    expect_near(found[0], eigenvalue(1.0, 0.05, J), 1e-9);
    expect_near(found[1], eigenvalue(ratio * ratio, 0.0, J), 1e-9);
  }
}

// Five, all damped, and as many asked for near the slowest. Mutation seen: what opens constraints a little is dropped.
TEST(ModesOfAnyRatio, NearAFrequency) {
  std::string all;
  for (int i = 0; i < 5; ++i)
    all += arm(i, 3.0 * i, std::pow(10.0, 2 * i), 0.1 * std::pow(10.0, i));
  ModesOptions options;
  options.count = 5;
  for (const double near : {0.9, 90.0, 9000.0}) {
    options.near = near;
    EXPECT_EQ(elastic(read(all), options).size(), 5U) << near;
  }
}

// A small arm on a free base, both centres on the hinge: six rigid motions, and 1/J = 1/Ja + 1/Jb about the hinge. Mutation seen: nothing looked for where all found are rigid.
TEST(ModesOfAnyRatio, OfAFreeBaseWithASmallArm) {
  for (const double size : {1.0, 1e-2, 1e-4}) {
    SCOPED_TRACE(size);
    const double Ja = 0.1 * size * size, Jb = 3.0, J = Ja * Jb / (Ja + Jb), k = 10.0 * Ja,
                 c = 0.6 * Ja;
    const Scene scene = read(fmt::format(
        R"(<body name="base" mass="5" inertia="2 2.5 3"/>
           <body name="arm" at="0 0 0.2" mass="1" inertia="{0:.17g} {0:.17g} {0:.17g}"/>
           <revolute name="H" between="base arm" at="0 0 0.2" axis="0 0 1"/>
           <joint_spring name="k" joint="H" angular_stiffness="{1:.17g}"
                         angular_damping="{2:.17g}"/>)",
        Ja, k, c));
    const ModesStudy all = study_modes(scene, {});
    std::vector<Complex> found = elastic(scene);
    EXPECT_EQ(all.modes.size(), 7U);
    ASSERT_EQ(found.size(), 1U);
    expect_near(found[0], eigenvalue(k, c, J), 1e-8);
  }
}

// Two bodies of 1 kg and 0.1 kg.m2 (by their size) on a hinge midway between them, free, their centres along it: six rigid motions
// and w^2 = 2 k/J, whatever the size. Mutation seen: shapes told apart in metres and radians.
TEST(ModesOfAnyRatio, OfFreeBodiesOfAnySize) {
  for (const double size : {1e-6, 1e-3, 1.0, 2e3, 1e5}) {
    for (const bool damped : {false, true}) {
      SCOPED_TRACE(fmt::format("{} {}", size, damped));
      const double J = 0.1 * size * size, k = 1e3 * J, c = damped ? 10.0 * J : 0.0;
      const Scene scene = read(fmt::format(
          R"(<body name="a" mass="1" inertia="{0:.17g} {0:.17g} {0:.17g}"/>
             <body name="b" at="0 0 {1:.17g}" mass="1" inertia="{0:.17g} {0:.17g} {0:.17g}"/>
             <revolute name="H" between="a b" at="0 0 {2:.17g}" axis="0 0 1"/>
             <joint_spring name="k" joint="H" angular_stiffness="{3:.17g}"
                           angular_damping="{4:.17g}"/>)",
          J, size, 0.5 * size, k, c));
      EXPECT_EQ(study_modes(scene, {}).modes.size(), 7U);
      const std::vector<Complex> found = elastic(scene);
      ASSERT_EQ(found.size(), 1U);
      expect_near(found[0], eigenvalue(k, c, 0.5 * J), 1e-8);
    }
  }
}

// A four-bar that nothing holds but its pins, in any pose, beside an arm: one free motion and 10 rad/s. Round-off, which makes its
// tangent regular, gives it no frequency. Mutation seen: no floor of round-off of the largest stiffness.
TEST(ModesOfAnyRatio, OfAFreeLinkage) {
  for (const double q : {0.3, 0.7, 1.1, 1.9}) {
    const double Bx = std::cos(q), By = std::sin(q), Dx = 2.2;
    // C, 1.7 m from B and 1.3 m from D.
    const double dx = Dx - Bx, dy = -By, d = std::hypot(dx, dy),
                 a = (d * d + 1.7 * 1.7 - 1.3 * 1.3) / (2.0 * d), h = std::sqrt(1.7 * 1.7 - a * a),
                 Cx = Bx + (a * dx - h * dy) / d, Cy = By + (a * dy + h * dx) / d;
    const Scene scene = read(fmt::format(
        R"(<body name="ab" at="{0:.17g} {1:.17g} 0" mass="1" inertia="0.1 0.1 0.1"/>
           <body name="bc" at="{2:.17g} {3:.17g} 0" mass="2" inertia="0.2 0.3 0.4"/>
           <body name="cd" at="{4:.17g} {5:.17g} 0" mass="1" inertia="0.1 0.1 0.1"/>
           <revolute name="A" between="ground ab" at="0 0 0" axis="0 0 1"/>
           <revolute name="B" between="ab bc" at="{6:.17g} {7:.17g} 0" axis="0 0 1"/>
           <revolute name="C" between="bc cd" at="{8:.17g} {9:.17g} 0" axis="0 0 1"/>
           <revolute name="D" between="cd ground" at="2.2 0 0" axis="0 0 1"/>
           <body name="q" at="5 0 0" mass="1" inertia="1 1 1"/>
           <revolute name="Q" between="ground q" at="5 0 0" axis="0 0 1"/>
           <joint_spring name="k" joint="Q" angular_stiffness="100"/>)",
        0.5 * Bx, 0.5 * By, 0.5 * (Bx + Cx), 0.5 * (By + Cy), 0.5 * (Cx + Dx), 0.5 * Cy, Bx, By, Cx,
        Cy));
    EXPECT_EQ(study_modes(scene, {}).modes.size(), 2U) << q;
    const std::vector<Complex> found = elastic(scene);
    ASSERT_EQ(found.size(), 1U) << q;
    expect_near(found[0], {0.0, 10.0}, 1e-9);
  }
}

// A five-bar with a spring at one pin: one free motion, and 6.621 rad/s (a reviewer's linearisation by null spaces in numpy, four
// digits). Mutation seen: what does not answer its own forces is seen about 0 (pairs of 1e-8 rad/s, "unstable").
TEST(ModesOfAnyRatio, OfAFiveBar) {
  const Scene scene = read(
      R"(<body name="l0" at="0.34835335467358275 0.35867804544976145 0.0" mass="1.0" inertia="0.1 0.12 0.15000000000000002"/>
<body name="l1" at="0.13838602652245569 0.9370786776541621 0.0" mass="1.0" inertia="0.1 0.12 0.15000000000000002"/>
<body name="l2" at="-0.8183029536214136 1.120708333092076 0.0" mass="1.0" inertia="0.1 0.12 0.15000000000000002"/>
<body name="l3" at="-1.3083356254702867 0.5423077008876751 0.0" mass="1.0" inertia="0.1 0.12 0.15000000000000002"/>
<revolute name="R0" between="ground l0" at="0.0 0.0 0.0" axis="0.0 0.0 1.0"/>
<revolute name="R1" between="l0 l1" at="0.6967067093471655 0.7173560908995229 0.0" axis="0.0 0.0 1.0"/>
<revolute name="R2" between="l1 l2" at="-0.41993465630225413 1.1568012644088013 0.0" axis="0.0 0.0 1.0"/>
<revolute name="R3" between="l2 l3" at="-1.216671250940573 1.0846154017753507 0.0" axis="0.0 0.0 1.0"/>
<revolute name="R4" between="l3 ground" at="-1.4000000000000004 -4.440892098500626e-16 0.0" axis="0.0 0.0 1.0"/>
<joint_spring name="kR0" joint="R0" angular_stiffness="100.0" angular_damping="0"/>)");
  EXPECT_EQ(study_modes(scene, {}).modes.size(), 2U);
  const std::vector<Complex> found = elastic(scene);
  ASSERT_EQ(found.size(), 1U);
  expect_near(found[0], {0.0, 6.621}, 1e-4);
}

// A slider-crank whose bodies all have their reference point far off, as drawing programs give them: the mode is that of the same
// bodies at their centres, and nothing beside it. Mutation seen: what solves the equations badly is kept (modes of 3e4/s from 1e5
// on).
TEST(ModesOfAnyRatio, OfReferencePointsFarAway) {
  const auto crank = [](double x, double y) {
    const auto body = [&](const char* name, double cx, double cy, double mass, double inertia) {
      return fmt::format(
          R"(<body name="{0}" at="{1:.17g} {2:.17g} 0" center="{3:.17g} {4:.17g} 0" mass="{5}"
                   inertia="{6} {6} {6}"/>)",
          name, x, y, cx - x, cy - y, mass, inertia);
    };
    const double angle = 0.7, Bx = std::cos(angle), By = std::sin(angle),
                 Sx = Bx + std::sqrt(9.0 - By * By);
    return read(body("a", 0.5 * Bx, 0.5 * By, 1, 0.1) +
                body("b", 0.5 * (Bx + Sx), 0.5 * By, 1, 0.9) + body("s", Sx, 0, 2, 0.1) +
                fmt::format(R"(<revolute name="O" between="ground a" at="0 0 0" axis="0 0 1"/>
                    <revolute name="B" between="a b" at="{:.17g} {:.17g} 0" axis="0 0 1"/>
                    <revolute name="S" between="b s" at="{:.17g} 0 0" axis="0 0 1"/>
                    <prismatic name="G" between="ground s" at="{:.17g} 0 0" axis="1 0 0"/>
                    <joint_spring name="k" joint="O" angular_stiffness="100"/>)",
                            Bx, By, Sx, Sx));
  };
  // Of the crank's angle q: with phi' = -cos(q) q'/(3 cos(phi)) of the rod, velocities of centres by q'.
  const double q = 0.7, s = std::sin(q) / 3.0, rod = -std::cos(q) / (3.0 * std::sqrt(1.0 - s * s)),
               vx = -std::sin(q) + 3.0 * s * rod, ux = -std::sin(q) + 1.5 * s * rod,
               uy = std::cos(q) + 1.5 * std::sqrt(1.0 - s * s) * rod,
               J = 0.1 + 0.25 + 0.9 * rod * rod + ux * ux + uy * uy + 2.0 * vx * vx;
  for (const double far : {0.0, 1e3, 1e5, 1e6}) {
    SCOPED_TRACE(far);
    const std::vector<Complex> found = elastic(crank(far, 0.3 * far));
    ASSERT_EQ(found.size(), 1U);
    expect_near(found[0], {0.0, std::sqrt(100.0 / J)}, 1e-9 + 1e-16 * far * far);
  }
}

}  // namespace
}  // namespace mbd::test::test_modes_of_any_ratio
