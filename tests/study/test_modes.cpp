// Modes at rest and in steady rotation, against closed forms, characteristic equations solved here, and two independent
// computations of the paper's shaft (ten digits).
// Errors are relative, of each eigenvalue alone, unless said otherwise.
#include "libmbd/study/modes/modes.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <sstream>

#include "libmbd/core/se3.hpp"
#include "libmbd/study/modes/campbell.hpp"
#include "libmbd/study/modes/linearize.hpp"
#include "libmbd/study/modes/modes_report.hpp"
#include "libmbd/study/modes/states_of_run.hpp"
#include "libmbd/study/trust/transform.hpp"
#include "libmbd/view/motion.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/landings.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/temporary_directory.hpp"

namespace mbd::test::test_modes {
namespace {

constexpr double pi = std::numbers::pi;

Scene shaft(bool gravity, bool eccentric, bool driven = true) {
  Scene scene = model_scene("shaft");
  scene.beams[0].elements = 12;
  scene.beams[0].order = 5;
  if (!gravity) scene.gravity.reset();
  if (!eccentric) scene.bodies[0].center.setZero();
  if (!driven) {
    scene.drives.clear();
    std::erase_if(scene.records, [](const RecordScene& record) { return record.name == "drive"; });
  }
  return scene;
}

std::vector<NamedMode> modes_of(const Scene& scene, int count,
                                std::optional<SteadyRotation> rotation = {}) {
  ModesOptions options;
  options.count = count;
  options.rotation = rotation;
  return study_modes(scene, options).modes;
}

void expect_frequencies(const std::vector<NamedMode>& modes, const std::vector<double>& wanted,
                        double tolerance) {
  ASSERT_GE(modes.size(), wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    EXPECT_NEAR(modes[i].eigenvalue.imag(), wanted[i], tolerance * wanted[i]) << i;
    EXPECT_LT(std::abs(modes[i].eigenvalue.real()), 1e-9 * wanted[i]) << i;
    EXPECT_LT(modes[i].residual, 1e-10) << i;
  }
}

// --- the paper's shaft ---

TEST(ModesOfTheShaft, AtRest) {
  expect_frequencies(
      modes_of(shaft(false, true), 6),
      {53.2367014677, 53.5955010753, 111.589043582, 387.813336821, 395.022218827, 680.199647208},
      1e-10);
  const std::vector<NamedMode> balanced = modes_of(shaft(false, false), 12);
  expect_frequencies(
      balanced, {53.5955010753, 53.5955010753, 111.113174815, 395.022218827, 395.022218827}, 1e-10);
  double axial = 1.0;
  for (const NamedMode& mode : balanced)
    axial = std::min(axial, std::abs(mode.eigenvalue.imag() / 933.374922073 - 1.0));
  EXPECT_LT(axial, 1e-9);
  expect_frequencies(modes_of(shaft(true, true), 3), {53.236403541, 53.595547560, 111.546064144},
                     1e-9);
  const std::vector<NamedMode> free = modes_of(shaft(false, true, false), 3);
  ASSERT_EQ(free.size(), 3U);
  EXPECT_TRUE(free[0].rigid);
  EXPECT_EQ(free[0].eigenvalue, 0.0);
  EXPECT_NEAR(free[1].eigenvalue.imag(), 53.59550108, 1e-7);
  EXPECT_NEAR(free[2].eigenvalue.imag(), 54.7700835, 1e-6);
}

// Mutations seen: V~ M left out of C (the gyroscopic term is wrong), the sign of `orbit`.
TEST(ModesOfTheShaft, Turning) {
  const std::vector<NamedMode> modes = modes_of(shaft(false, false), 6, SteadyRotation{50.0});
  std::vector<double> whirls;
  for (const NamedMode& mode : modes)
    if (const auto whirl = mode.whirl(50.0, ModeAxes::turning)) whirls.push_back(*whirl);
  ASSERT_GE(whirls.size(), 4U);
  EXPECT_NEAR(whirls[0], 53.59746628082, 1e-8);
  EXPECT_NEAR(whirls[1], -53.59353593462, 1e-8);
  EXPECT_NEAR(whirls[2], 410.710452112, 1e-7);
  EXPECT_NEAR(whirls[3], -379.095026534, 1e-7);
}

TEST(ModesOfTheShaft, OutOfBalance) {
  ModesOptions options;
  options.count = 3;
  options.rotation = SteadyRotation{40.0};
  for (const bool driven : {true, false}) {
    const ModesStudy study = study_modes(shaft(false, true, driven), options);
    double deflection = 0.0;
    for (const Pose<double>& H : study.poses)
      deflection = std::max(deflection, H.r.tail<2>().norm());
    EXPECT_NEAR(deflection, 0.0566905588912, 1e-11) << driven;
    if (driven)
      expect_frequencies(study.modes, {13.476624884, 93.147003758, 112.50751267}, 1e-9);
    else
      EXPECT_TRUE(study.modes[0].rigid);
  }
}

TEST(ModesOfTheShaft, DampedInTheMaterial) {
  Scene scene = shaft(false, false);
  scene.sections[0].damping.emplace();
  scene.sections[0].damping->stiffness_proportional = 1e-4;
  constexpr double critical = 53.5976076840911;
  const std::complex<double> wanted[] = {{-0.0287246288, 10.7190309307},
                                         {0.0287245050, 10.7190155338}};
  for (int i = 0; i < 2; ++i) {
    const double rate = (i == 0 ? 0.8 : 1.2) * critical;
    const NamedMode mode = modes_of(scene, 1, SteadyRotation{rate})[0];
    EXPECT_LT(std::abs(mode.eigenvalue - wanted[i]), 3e-9);
    // Above the critical speed it whirls forward in inertial axes, backward as seen from the shaft.
    EXPECT_GT(mode.whirl(rate, ModeAxes::turning).value(), 0.0);
    EXPECT_EQ(mode.orbit.value() > 0.0, i == 0);
  }
}

// --- beams ---

// Frequencies of a Timoshenko cantilever: zeros of the determinant of its transfer matrix.
double timoshenko_cantilever(double L, double EI, double GA, double m, double J, double low,
                             double high) {
  const auto determinant = [&](double w) {
    Eigen::Matrix4d A = Eigen::Matrix4d::Zero();  // [w, phi, M, V]' = A [w, phi, M, V]
    A(0, 1) = 1.0;
    A(0, 3) = 1.0 / GA;
    A(1, 2) = 1.0 / EI;
    A(2, 1) = -J * w * w;
    A(2, 3) = -1.0;
    A(3, 0) = -m * w * w;
    const Eigen::Matrix4d T = dense::exponential(A * L);
    return T(2, 2) * T(3, 3) - T(2, 3) * T(3, 2);
  };
  double a = low, b = high, fa = determinant(a);
  EXPECT_LT(fa * determinant(b), 0.0);
  for (int k = 0; k < 200 && b - a > 1e-15 * b; ++k) {
    const double c = 0.5 * (a + b), fc = determinant(c);
    (fc * fa > 0.0 ? a : b) = c;
    if (fc * fa > 0.0) fa = fc;
  }
  return 0.5 * (a + b);
}

Scene cantilever(int elements, int order) {
  return read(fmt::format(R"(
    <section name="s"><stiffness EA="1e4" GA2="3e3" GA3="4e3" GJ="80" EI2="100" EI3="150"/>
      <mass per_length="2" inertia="0.05 0.03 0.02"/></section>
    <beam name="b" section="s" from="0 0 0" to="1.5 0 0" normal="0 0 1" elements="{}" order="{}"/>
    <fixed name="F" between="ground b.start"/><static/>)",
                          elements, order));
}

// EI2 bends about b2, along b3, with GA3 and the inertia about b2.
TEST(Modes, OfATimoshenkoCantileverConverge) {
  const double first = timoshenko_cantilever(1.5, 100.0, 4e3, 2.0, 0.03, 5.0, 12.0);
  for (const int order : {1, 2, 3}) {
    std::vector<double> errors;
    for (const int elements : {4, 8, 16}) {
      const std::vector<NamedMode> modes = modes_of(cantilever(elements, order), 2);
      EXPECT_EQ(modes[0].name, "bending of beam \"b\" along b3");
      EXPECT_EQ(modes[1].name, "bending of beam \"b\" along b2");
      errors.push_back(std::abs(modes[0].eigenvalue.imag() / first - 1.0));
    }
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2.0 * order, 0.35) << order << ' ' << errors[0];
    EXPECT_NEAR(std::log2(errors[1] / errors[2]), 2.0 * order, 0.35) << order << ' ' << errors[1];
  }
  const double second = timoshenko_cantilever(1.5, 150.0, 3e3, 2.0, 0.02, 5.0, 15.0);
  expect_frequencies(modes_of(cantilever(12, 5), 2), {first, second}, 1e-11);
}

// Torsion and stretching of a clamped bar: (2k - 1) pi/2 sqrt(GJ/I)/L, sqrt(EA/m).
// Of a slender beam of very many nodes nearly all of the stiffness cancels in bending: what is said to be unknown covers what is
// wrong (against Euler's beam; shear and rotary inertia are 1e-5), and no more digits are printed. Mutation: share_lost = 0.
TEST(Modes, SayWhatRoundOffLeavesUnknown) {
  const auto of = [](int elements, int order) {
    ModesOptions options;
    options.count = 4;
    return study_modes(
        read(fmt::format(
            R"(<section name="s"><stiffness EA="1e9" GA2="3e8" GA3="3e8" GJ="1e6" EI2="1e6" EI3="2e6"/>
            <mass per_length="10" inertia="0.03 0.01 0.02"/></section>
            <beam name="b" section="s" from="0 0 0" to="100 0 0" normal="0 0 1" elements="{}" order="{}"/>
            <fixed name="f" between="ground b.start"/><static/>)",
            elements, order)),
        options);
  };
  const double truth = 3.516015268504 / 1e4 * std::sqrt(1e6 / 10);
  const ModesStudy fine = of(1112, 3), coarse = of(4, 5);
  const Mode &lost = fine.modes[0], &well = coarse.modes[0];
  EXPECT_GT(lost.round_off, 1e-5);
  EXPECT_LT(lost.round_off, 1e-2);
  EXPECT_LT(std::abs(lost.eigenvalue.imag() / truth - 1.0), lost.round_off + 1e-5);
  EXPECT_LT(well.round_off, 1e-7);
  EXPECT_LT(std::abs(well.eigenvalue.imag() / truth - 1.0), 1e-5);
  const std::string said = to_text(fine);
  EXPECT_NE(said.find("note: round-off leaves about"), std::string::npos) << said;
  EXPECT_NE(said.find("  0.0177 "), std::string::npos) << said;
  EXPECT_EQ(to_text(coarse).find("round-off"), std::string::npos);
}

// What is at rest at its round-off is not iterated further: products of the inverse and one vector, of which there are 182 here, and
// 382 of 3000 elements, where the slowest modes are hidden in round-off. (With Arnoldi's method of one vector and a tolerance below
// round-off they were 208, and 1309.) Mutation seen: where modes are hidden, the search of a shift begun at 1e-3 of the fastest (1049
// products). Not seen: at_rest = 0; vectors not weighed by the mass (residuals three times as large).
TEST(Modes, OfManyElementsCostFewSolutions) {
  struct Case {
    int elements, count;
    const char* damping;
    long products, restarts;
  };
  for (const Case& c : {Case{500, 50, "", 200, 0}, Case{3000, 50, "", 450, 2},
                        Case{500, 20, R"(<damping stiffness_proportional="1e-6"/>)", 300, 9}}) {
    ModesOptions options;
    options.count = c.count;
    const ModesStudy study = study_modes(
        read(fmt::format(
            R"(<section name="s"><stiffness EA="1e9" GA2="3e8" GA3="3e8" GJ="1e6" EI2="1e6" EI3="2e6"/>
            <mass per_length="10" inertia="0.03 0.01 0.02"/>{}</section>
            <beam name="b" section="s" from="0 0 0" to="100 0 0" normal="0 0 1" elements="{}" order="3"/>
            <fixed name="f" between="ground b.start"/><static/>)",
            c.damping, c.elements)),
        options);
    ASSERT_EQ(study.modes.size(), static_cast<std::size_t>(c.count));
    EXPECT_LE(study.work.products, c.products) << c.elements << c.damping;
    EXPECT_LE(study.work.restarts, c.restarts) << c.elements << c.damping;
    // Residuals are those of the inverse, which is known better than its eigenvalues.
    for (const NamedMode& mode : study.modes) EXPECT_LT(mode.residual, 1e-8) << mode.name;
  }
}

TEST(Modes, AreNamed) {
  const std::vector<NamedMode> modes = modes_of(cantilever(8, 5), 12);
  const double twist = 0.5 * pi / 1.5 * std::sqrt(80.0 / 0.05),
               stretch = 0.5 * pi / 1.5 * std::sqrt(1e4 / 2.0);
  int seen = 0;
  for (const NamedMode& mode : modes) {
    const bool twists = mode.name == "twist of beam \"b\"";
    if (!twists && mode.name != "stretching of beam \"b\"") continue;
    ++seen;
    const double first = twists ? twist : stretch;
    EXPECT_NEAR(std::fmod(mode.eigenvalue.imag() / first + 1e-6, 2.0), 1.0, 1e-4);
  }
  EXPECT_GE(seen, 3);
}

// A beam that nothing holds: six motions without an answer, then 4.730040744862704^2 of a slender one, twice.
TEST(Modes, OfAFreeBeam) {
  for (const int copies : {1, 2}) {
    std::string text =
        R"(<section name="s"><stiffness EA="1e8" GA2="1e8" GA3="1e8" GJ="1e3" EI2="10" EI3="10"/>
      <mass per_length="1" inertia="2e-9 1e-9 1e-9"/></section><static/>)";
    for (int c = 0; c < copies; ++c)
      text += fmt::format(
          R"(<beam name="b{0}" section="s" from="0 {0} 0" to="1 {0} 0" normal="0 0 1" elements="6" order="5"/>)",
          c);
    const std::vector<NamedMode> modes = modes_of(read(text), 10 * copies);
    int rigid = 0;
    for (const NamedMode& mode : modes) rigid += mode.rigid;
    EXPECT_EQ(rigid, 6 * copies);
    const double wanted = std::pow(4.730040744862704, 2) * std::sqrt(10.0);
    for (int i = 0; i < 2 * copies; ++i)
      EXPECT_NEAR(modes[static_cast<std::size_t>(6 * copies + i)].eigenvalue.imag(), wanted,
                  2e-6 * wanted);
  }
}

// What is held very softly is no free motion: a beam on springs a million times softer than its own bending.
TEST(Modes, OfASoftMountAreNotFree) {
  std::string text =
      R"(<section name="s"><stiffness EA="1e4" GA2="4e3" GA3="4e3" GJ="80" EI2="100" EI3="100"/>
      <mass per_length="2" inertia="0.02 0.01 0.01"/></section><static/>
    <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="4" order="4"/>
    <bushing name="k" between="ground b@0.5" stiffness="2e-4 2e-4 2e-4" angular_stiffness="1 1 1"/>)";
  const std::vector<NamedMode> modes = modes_of(read(text), 8);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(modes[static_cast<std::size_t>(i)].rigid);
    EXPECT_NEAR(modes[static_cast<std::size_t>(i)].eigenvalue.imag(), 1e-2, 1e-6) << i;
  }
}

// Star of n equal cantilevers: every eigenvalue 2n times. One start vector finds one of each.
TEST(Modes, RepeatedAreAllFound) {
  constexpr int n = 5;
  std::string text =
      R"(<section name="s"><stiffness EA="1e7" GA2="4e6" GA3="4e6" GJ="80" EI2="100" EI3="100"/>
      <mass per_length="2" inertia="2e-4 1e-4 1e-4"/></section><static/>)";
  for (int i = 0; i < n; ++i)
    text += fmt::format(
        R"(<beam name="b{0}" section="s" from="0 0 {0}" to="{1:.17g} {2:.17g} {0}" normal="0 0 1" elements="3" order="4"/>
           <fixed name="F{0}" between="ground b{0}.start"/>)",
        i, std::cos(i), std::sin(i));
  const std::vector<NamedMode> modes = modes_of(read(text), 4 * n);
  ASSERT_EQ(modes.size(), static_cast<std::size_t>(4 * n));
  for (int i = 0; i < 4 * n; ++i) {
    const double wanted = modes[i < 2 * n ? 0 : 2 * n].eigenvalue.imag();
    EXPECT_NEAR(modes[static_cast<std::size_t>(i)].eigenvalue.imag(), wanted, 1e-8 * wanted) << i;
  }
  EXPECT_GT(modes[2 * n].eigenvalue.imag(), 5.0 * modes[0].eigenvalue.imag());
  // Those of one frequency alone, five times as often as a block has vectors.
  for (const NamedMode& mode : modes_of(read(text), 2 * n))
    EXPECT_NEAR(mode.eigenvalue.imag(), modes[0].eigenvalue.imag(), 1e-8 * mode.eigenvalue.imag());
}

// A frequency asked for is found from the middle of the spectrum.
// Asked for more modes than there are: those that are there, and no others, which open joints. Two masses on springs with dampers,
// and a third that turns on a damped hinge, against the companion matrix. Mutation: those that open joints are kept (it finds
// some that grow, "unstable").
TEST(Modes, AreNoMoreThanThereAre) {
  for (const double c : {0.5, 60.0})  // rings, and creeps
    for (const char* const axis : {"1 0 0", "3 -4 12"}) {
      Vec3 e;
      std::istringstream(axis) >> e(0) >> e(1) >> e(2);
      const Vec3 end = e.normalized();
      const auto words = [](const Vec3& x) { return fmt::format("{} {} {}", x(0), x(1), x(2)); };
      const Scene scene = scene_of(fmt::format(
          R"(<body name="a" at="0 0 0" mass="1" inertia="1 2 3"/>
             <body name="b" at="{1}" mass="5e-3" inertia="1e-6 1e-6 1e-6"/>
             <body name="d" at="0 0 9" mass="2" inertia="0.7 0.7 0.7"/>
             <prismatic name="p" between="ground a" at="0 0 0" axis="{0}"/>
             <prismatic name="q" between="ground b" at="{1}" axis="{0}"/>
             <revolute name="h" between="ground d" at="0 0 9" axis="{0}"/>
             <spring name="s" between="ground a" at_a="{2}" at_b="0 0 0" stiffness="100" damping="{3}"/>
             <spring name="t" between="a b" at_a="0 0 0" at_b="{1}" stiffness="200" damping="0.2"/>
             <joint_spring name="u" joint="h" angular_stiffness="3" angular_damping="0.1"/>
             <static/>)",
          axis, words(end), words(-end), c));
      Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
      A.topRightCorner<3, 3>().setIdentity();
      A.row(3) << -300.0, 200.0, 0.0, -(c + 0.2), 0.2, 0.0;
      A.row(4) << 200.0 / 5e-3, -200.0 / 5e-3, 0.0, 0.2 / 5e-3, -0.2 / 5e-3, 0.0;
      A.row(5) << 0.0, 0.0, -3.0 / 0.7, 0.0, 0.0, -0.1 / 0.7;
      std::vector<std::complex<double>> expected;
      for (const std::complex<double> l : dense::eigenpairs(Eigen::MatrixXd(A)).values)
        if (l.imag() >= 0.0) expected.push_back(l);
      const std::vector<NamedMode> modes = modes_of(scene, 30);
      ASSERT_EQ(modes.size(), expected.size()) << c << " along " << axis;
      for (const std::complex<double> l : expected)
        EXPECT_TRUE(std::any_of(modes.begin(), modes.end(),
                                [&](const NamedMode& mode) {
                                  return std::abs(mode.eigenvalue - l) < 1e-7 * std::abs(l);
                                }))
            << l.real() << " + i " << l.imag();
    }
}

// Arms of 2 kg.m2 on springs of 1e-3 … 1e13 N.m, and one that is free: asked for ten modes, all five are given. The old search
// gave three: the others were taken for infinite beside the slowest.
TEST(Modes, FarApartAreAllFound) {
  const double stiffness[] = {1e-3, 1e4, 1e9, 1e13};
  for (const char* const damper :
       {"", R"(<joint_spring name="d" joint="h0" angular_damping="1e-9"/>)"}) {
    std::string scene = R"(<body name="free" mass="1" inertia="1 1 2"/>
                           <revolute name="h" between="ground free" axis="0 0 1"/>)";
    for (int i = 0; i < 4; ++i)
      scene += fmt::format(R"(<body name="b{0}" mass="1" inertia="1 1 2"/>
                              <revolute name="h{0}" between="ground b{0}" axis="0 0 1"/>
                              <joint_spring name="k{0}" joint="h{0}" angular_stiffness="{1}"/>)",
                           i, stiffness[i]);
    const std::vector<NamedMode> modes = modes_of(read(scene + damper), 10);
    ASSERT_EQ(modes.size(), 5U) << damper;
    EXPECT_TRUE(modes[0].rigid) << damper;
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_NEAR(modes[i + 1].eigenvalue.imag() / std::sqrt(0.5 * stiffness[i]), 1.0, 1e-7)
          << i << damper;
  }
}

TEST(Modes, NearAFrequency) {
  const std::vector<NamedMode> all = modes_of(cantilever(8, 4), 12);
  ModesOptions options;
  options.count = 2;
  options.near = 1.01 * all[5].eigenvalue.imag();
  EXPECT_NEAR(
      study_modes(cantilever(8, 4), options).modes[0].eigenvalue.imag() / all[5].eigenvalue.imag(),
      1.0, 1e-10);
  Scene damped = cantilever(8, 4);
  damped.sections[0].damping.emplace();
  damped.sections[0].damping->stiffness_proportional = 1e-4;
  const std::vector<NamedMode> slow = modes_of(damped, 12);
  const std::vector<NamedMode> near = study_modes(damped, options).modes;
  EXPECT_LT(std::abs(near[0].eigenvalue - slow[5].eigenvalue), 1e-9 * options.near);
  ASSERT_EQ(near.size(), 2U);
  EXPECT_GT(std::abs(near[1].eigenvalue - near[0].eigenvalue), 1e-3 * options.near);
  // Viscous forces beta D: l^2 + beta w^2 l + w^2 = 0 of each.
  const double w = all[5].eigenvalue.imag();
  const std::complex<double> wanted =
      -0.5e-4 * w * w + std::complex<double>(0.0, w * std::sqrt(1.0 - 0.25e-8 * w * w));
  EXPECT_LT(std::abs(near[0].eigenvalue - wanted), 1e-8 * w);
}

// --- rotation ---

// Flapping of a slender beam clamped in a hub that turns: Wright et al., J. Appl. Mech. 49 (1982), hub radius 0,
// frequencies and rates in sqrt(EI/(m L^4)); four decimals are given.
TEST(ModesOfRotors, FlappingBeamOfWright) {
  const double rates[] = {0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 12.0};
  const double first[] = {3.5160, 3.6816, 4.1373, 4.7973, 5.5850, 7.3604, 13.1702},
               second[] = {22.0345, 22.1810, 22.6149, 23.3203, 24.2734, 26.8091, 37.6031};
  // In the plane of rotation it is far stiffer.
  const Scene scene = read(R"(
    <section name="s"><stiffness EA="1e6" GA2="1e7" GA3="1e7" GJ="1e3" EI2="1" EI3="1e4"/>
      <mass per_length="1" inertia="2e-9 1e-9 1e-9"/></section>
    <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="8" order="5"/>
    <revolute name="R" between="ground b.start" axis="0 0 1"/><drive joint="R" angle="0"/><static/>)");
  for (int i = 0; i < 7; ++i) {
    const std::vector<NamedMode> modes =
        modes_of(scene, 12, SteadyRotation{rates[i], Vec3::UnitZ()});
    std::vector<double> flaps;
    for (const NamedMode& mode : modes)
      if (mode.name == "bending of beam \"b\" along b3") flaps.push_back(mode.eigenvalue.imag());
    ASSERT_GE(flaps.size(), 2U);
    // Stretching and shear change it by 1e-5.
    EXPECT_NEAR(flaps[0], first[i], 5e-5 + 2e-5 * first[i]) << i;
    EXPECT_NEAR(flaps[1], second[i], 5e-5 + 2e-5 * second[i]) << i;
  }
}

// A simply supported shaft with rotary inertia and gyroscopic moments, k = n pi/L:
//   (m + J k^2) w^2 -+ 2 J k^2 W w - EI k^4 = 0 (polar inertia 2 J); shear changes it by EI k^2/(2 GA), 2e-6.
// Turning the other way, and joints stated the other way round, change nothing. Nothing drives it: its spin is a free motion, in
// which solutions about 0 drown (shifted by it, they made torsion grow by 34/s, and all else right to 1 % only), and torsion that
// of a free rod, w = n pi/L sqrt(GJ/2J).
TEST(ModesOfRotors, SimplySupportedShaft) {
  constexpr double m = 3.0, J = 0.02, EI = 200.0, GJ = 100.0, L = 1.3;
  for (const bool swapped : {false, true}) {
    const Scene scene = read(fmt::format(R"(
      <section name="s"><stiffness EA="1e8" GA2="1e9" GA3="1e9" GJ="100" EI2="200" EI3="200"/>
        <mass per_length="3" inertia="0.04 0.02 0.02"/></section>
      <beam name="b" section="s" from="0 1 0" to="0 1 1.3" normal="1 0 0" elements="8" order="5"/>
      <spherical name="A" between="{}"/><spherical name="B" between="{}"/><static/>)",
                                         swapped ? "b.start ground" : "ground b.start",
                                         swapped ? "b.end ground" : "ground b.end"));
    for (const double rate : {40.0, -40.0}) {
      const std::vector<NamedMode> modes =
          modes_of(scene, 8, SteadyRotation{rate, Vec3::UnitZ(), Vec3(0.0, 1.0, 0.3)});
      for (int n = 1; n <= 2; ++n)
        for (const double sense : {1.0, -1.0}) {
          const double k = n * pi / L, a = m + J * k * k, g = J * k * k * 40.0;
          const double wanted = sense * (sense * g + std::sqrt(g * g + a * EI * k * k * k * k)) / a;
          double nearest = 1.0;
          for (const NamedMode& mode : modes)
            if (const auto whirl = mode.whirl(rate, ModeAxes::turning))
              nearest = std::min(nearest, std::abs(*whirl / wanted - 1.0));
          EXPECT_LT(nearest, 3e-6) << n << ' ' << sense << ' ' << rate << ' ' << wanted;
        }
      int rigid = 0, twists = 0;
      for (const NamedMode& mode : modes) {
        EXPECT_LT(mode.residual, 1e-10) << mode.name;
        EXPECT_LT(std::abs(mode.eigenvalue.real()), 1e-8) << mode.name;
        rigid += mode.rigid ? 1 : 0;
        if (mode.name == "twist of beam \"b\"") {
          ++twists;
          EXPECT_NEAR(mode.eigenvalue.imag(), twists * pi / L * std::sqrt(GJ / (2.0 * J)), 1e-6);
        }
      }
      EXPECT_EQ(rigid, 1);
      EXPECT_EQ(twists, 2);
    }
  }
}

// What is not alike in all directions is refused, and said.
TEST(ModesOfRotors, WhatDoesNotTurnIsRefused) {
  const auto message_of = [](const std::string& more,
                             const SteadyRotation& rotation) -> std::string {
    const std::string rotor = R"(
      <section name="s"><stiffness EA="1e6" GA2="1e6" GA3="1e6" GJ="100" EI2="200" EI3="200"/>
        <mass per_length="3" inertia="0.04 0.02 0.02"/></section>
      <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2" order="4"/><static/>)";
    try {
      modes_of(read(rotor + more), 2, rotation);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  const std::string held = R"(<revolute name="A" between="ground b.start" axis="1 0 0"/>)";
  const SteadyRotation about{5.0};
  EXPECT_EQ(message_of(held, about), "no error");
  EXPECT_SAYS(message_of(held + R"(<gravity acceleration="0 0 -1"/>)", about), "inertial axes");
  EXPECT_EQ(message_of(held + R"(<gravity acceleration="-1 0 0"/>)", about), "no error");
  EXPECT_SAYS(message_of(held, SteadyRotation{5.0, Vec3::UnitZ()}), "does not let it turn");
  EXPECT_SAYS(message_of(held, SteadyRotation{5.0, Vec3::UnitX(), Vec3(0.0, 0.1, 0.0)}),
              "does not let it turn");
  // A bushing turns with what it holds at one side: it is no bearing. One that is alike in all directions was taken for one that
  // turns along at half the rate.
  for (const char* stiffness : {"10 50 51", "10 50 50"})
    EXPECT_SAYS(
        message_of(
            held + fmt::format(
                       R"(<bushing name="k" between="ground b.end" at="1 0 0" stiffness="{}"/>)",
                       stiffness),
            about),
        "bushing 'k' does not let it turn about the axis, its range");
  EXPECT_SAYS(message_of(R"(<fixed name="A" between="ground b.start"/>)", about), "does not let");
}

// A rigid disk on a shaft without flexibility, in two housings on springs: with stiffness k2, k3 of each, at +-a,
//   translation: sqrt(2 k2/m), sqrt(2 k3/m);  tilting: (T w^2 - 2 k2 a^2)(T w^2 - 2 k3 a^2) = (P W w)^2.
// Unequal springs need resting axes; equal ones are the same in both. Mutation seen: (2W - V)~ taken as W~.
TEST(ModesOfRotors, RigidRotorOnBearings) {
  constexpr double m = 20.0, T = 0.9, P = 0.5, a = 0.4, W = 150.0;
  for (const double k3 : {3e5, 5e5}) {
    constexpr double k2 = 3e5;
    std::string text = R"(
      <body name="disk" at="0 0 0" mass="20" inertia="0.5 0.9 0.9"/>)";
    for (const auto& [name, x] : {std::pair{"A", -a}, std::pair{"B", a}})
      text += fmt::format(R"(
      <body name="{0}" at="{1} 0 0" mass="1e-6" inertia="1e-9 1e-9 1e-9"/>
      <bushing name="k{0}" between="ground {0}" at="{1} 0 0" stiffness="1e6 {2} {3}" angular_stiffness="1e4 1e4 1e4"/>
      <{4} name="J{0}" between="{0} disk" at="{1} 0 0"/>)",
                          name, x, k2, k3, "spherical");
    ModesOptions options;
    options.count = 6;
    options.rotation = SteadyRotation{W};
    options.at_rest = {"A", "B"};
    const ModesStudy study = study_modes(read(text + "<static/>"), options);
    EXPECT_EQ(study.axes, k3 == k2 ? ModeAxes::turning : ModeAxes::resting);
    const double A = 2.0 * k2 * a * a, B = 2.0 * k3 * a * a;
    const double p = A * T + B * T + P * P * W * W, root = std::sqrt(p * p - 4.0 * T * T * A * B);
    std::vector<double> wanted{std::sqrt(2.0 * k2 / m), std::sqrt(2.0 * k3 / m),
                               std::sqrt((p - root) / (2.0 * T * T)),
                               std::sqrt((p + root) / (2.0 * T * T))};
    if (study.axes == ModeAxes::turning) continue;
    for (const double w : wanted) {
      double nearest = 1.0;
      for (const NamedMode& mode : study.modes)
        nearest = std::min(nearest, std::abs(mode.eigenvalue.imag() / w - 1.0));
      EXPECT_LT(nearest, 1e-6) << w << ' ' << k3;
    }
  }
}

// --- stability ---

// Beck's column: flutter at 20.05 EI/L^2 of a follower force; below, all oscillates.
TEST(Modes, OfBecksColumn) {
  for (const double load : {20.0, 20.1}) {
    const Scene scene = read(fmt::format(R"(
      <section name="s"><stiffness EA="1e7" GA2="1e7" GA3="1e7" GJ="10" EI2="1" EI3="3"/>
        <mass per_length="1" inertia="2e-8 1e-8 1e-8"/></section>
      <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="6" order="5"/>
      <fixed name="F" between="ground b.start"/>
      <load name="f" at="b.end" follower_force="{} 0 0"/><static/>)",
                                         -load));
    double growth = 0.0;
    for (const NamedMode& mode : modes_of(scene, 4))
      growth = std::max(growth, mode.eigenvalue.real());
    EXPECT_EQ(growth > 0.1, load > 20.05) << load << ' ' << growth;
  }
}

// A column above Euler's load: one motion grows, at sqrt(w0^2 (P/Pe - 1)) of the pinned one.
TEST(Modes, OfWhatBucklesGrow) {
  const Scene scene = read(R"(
    <section name="s"><stiffness EA="1e8" GA2="1e8" GA3="1e8" GJ="10" EI2="1" EI3="5"/>
      <mass per_length="1" inertia="2e-9 1e-9 1e-9"/></section>
    <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="6" order="5"/>
    <revolute name="A" between="ground b.start" axis="0 1 0"/>
    <body name="slider" at="1 0 0" mass="1e-3" inertia="1e-6 1e-6 1e-6"/>
    <prismatic name="S" between="ground slider" axis="1 0 0"/>
    <revolute name="B" between="slider b.end" axis="0 1 0"/>
    <load name="f" at="slider" force="-11 0 0"/><static/>)");
  const double w0 = pi * pi, euler = pi * pi;
  double growth = 0.0;
  for (const NamedMode& mode : modes_of(scene, 3))
    growth = std::max(growth, mode.eigenvalue.real());
  EXPECT_NEAR(growth, w0 * std::sqrt(11.0 / euler - 1.0), 1e-5 * w0);
}

// --- tables ---

TEST(Modes, AreWritten) {
  ModesOptions options;
  options.count = 3;
  const ModesStudy study = study_modes(cantilever(2, 3), options);
  const std::string csv = to_csv(study), json = to_json(study), text = to_text(study);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
  EXPECT_SAYS(csv, "frequency");
  EXPECT_SAYS(json, "\"shape\"");
  EXPECT_SAYS(text, "bending of beam \"b\" along b3");
}

// The motion of a mode: a period of its shape about equilibrium, to first order in the amplitude.
TEST(Modes, AreWrittenAsMotion) {
  const TemporaryDirectory scratch;
  ModesOptions options;
  options.count = 2;
  const ModesStudy study = study_modes(cantilever(2, 3), options, scratch.path());
  const Motion motion = read_motion(scratch.path() / "mode_2" / "motion.bin");
  ASSERT_EQ(motion.rows, 49U);
  const std::size_t rows[] = {0, 12, 24, 48};
  const std::vector<double> numbers = read_motion_rows(motion, rows);
  const std::size_t size = motion.blocks.size(),
                    tip = motion.blocks.key + 7 * (study.nodes.size() - 1);
  const auto y = [&](std::size_t row) { return numbers[row * size + tip + 1]; };
  const NamedMode& mode = study.modes[1];
  EXPECT_NEAR(y(0), 0.05 * mode.shape(mode.shape.size() - 5).real(), 1e-3);
  EXPECT_GT(std::abs(y(0)), 0.03 * 1.5);
  EXPECT_NEAR(y(1), 0.0, 1e-12);
  EXPECT_NEAR(y(2), -y(0), 1e-12);
  EXPECT_NEAR(y(3), y(0), 1e-12);
  EXPECT_NEAR(numbers[3 * size], 2.0 * pi / study.modes[1].eigenvalue.imag(), 1e-12);
}

// A mechanism in no equilibrium, and a scene without mass, are refused.
TEST(Modes, NeedAnEquilibriumAndMass) {
  EXPECT_THROW(modes_of(model_scene("chain"), 2), Error);
  EXPECT_THROW(modes_of(read(R"(
      <section name="s"><stiffness EA="1e6" GA2="1e6" GA3="1e6" GJ="100" EI2="200" EI3="200"/></section>
      <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2" order="4"/>
      <fixed name="F" between="ground b.start"/><static/>)"),
                        2),
               Error);
}

// --- about a state of a run ---

// A pendulum of equivalent length l let go at 60 degrees: its angle obeys u'' + g/l cos(angle) u = 0 at every moment, whatever
// its speed; it passes the lowest point after a quarter of its period, an elliptic integral, and stands at the same height on
// the other side after half of it. Mutation: about() for frozen_at() (accelerations left out).
TEST(ModesOnTheWay, OfAPendulum) {
  constexpr double l = 0.8, g = 9.81;
  const Scene scene = read(R"(
    <body name="arm" at="0 0 0" orientation="0 -60*deg 0" center="0 0 -0.4" mass="3" inertia="0.48 0.48 0.01"/>
    <revolute name="hinge" between="ground arm" axis="0 1 0"/>
    <gravity acceleration="0 0 -9.81"/>)");
  const double quarter = std::sqrt(l / g) * std::comp_ellint_1(std::sin(pi / 6.0));
  const std::pair<double, double> cases[] = {
      {0.0, 0.5}, {quarter, 1.0}, {2.0 * quarter, 0.5}, {5.0 * quarter, 1.0}};
  for (const auto& [time, cosine] : cases) {
    ModesOptions options;
    options.count = 1;
    options.time = time;
    const ModesStudy study = study_modes(scene, options);
    ASSERT_EQ(study.modes.size(), 1U);
    EXPECT_NEAR(study.modes[0].eigenvalue.imag(), std::sqrt(g / l * cosine), 1e-6) << time;
    EXPECT_LT(std::abs(study.modes[0].eigenvalue.real()), 1e-6) << time;
  }
}

// A run that would go on for ever is not begun. Mutation: the time is not looked at (the test would hang).
TEST(ModesOnTheWay, NotAfterTheEnd) {
  const Scene scene = read(R"(
    <body name="arm" at="0 0 0" center="0 0 -0.4" mass="3" inertia="0.48 0.48 0.01"/>
    <revolute name="hinge" between="ground arm" axis="0 1 0"/>
    <gravity acceleration="0 0 -9.81"/><transient duration="2" step="0.01"/>)");
  ModesOptions options;
  options.count = 1;
  options.time = 2.0;
  EXPECT_NEAR(study_modes(scene, options).modes.at(0).eigenvalue.imag(), std::sqrt(9.81 / 0.8),
              1e-6);
  options.time = 1e9;
  try {
    study_modes(scene, options);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    const std::string said = error.what();
    EXPECT_NE(said.find("transient: ends at 2 s"), std::string::npos) << said;
  }
}

// --- the four-bar, stopped ---

// Held by its drive at five angles of its crank, bent by a load: let go, displaced along a mode, it moves as cos(w t) along that,
// by an integrator that knows no modes. Of its mass: (u(t) M x)/(u(0) M x) at quarters of the period; 1e-4 of the frequency
// would be 1.6e-4 of it at the first.
TEST(ModesSlow, OfTheFourBarStoppedAtFiveAngles) {
  for (const double angle : {0.3, 1.2, 2.5, 3.9, 5.3}) {
    Scene scene = model_scene("four_bar");
    const Vec3 A = Vec3::Zero(), D(0.24, 0.0, 0.0),
               crank(0.12 * std::cos(angle), 0.12 * std::sin(angle), 0.0);
    scene.beams[0].line = Straight{A, A + crank};
    scene.beams[1].line = Straight{A + crank, D + crank};
    scene.beams[2].line = Straight{D + crank, D};
    scene.drives[0].rate.reset();
    scene.drives[0].angle = Expression::parse("0", {}, Variables::time);
    scene.loads = read(R"(<body name="b" mass="1" inertia="1 1 1"/>
                          <load at="b" force="900 -600 400"/>)")
                      .loads;
    scene.loads[0].at = {Place::Kind::beam, "bar2", 1.0};
    scene.statics.emplace();
    scene.transient.reset();
    MotionsOfScene motions(scene);
    const std::vector<NamedMode> modes = motions.modes({.count = 3});
    ASSERT_GE(modes.size(), 3U);
    const State& rest = motions.state();
    for (std::size_t i = 0; i < 3; ++i) {
      const double w = modes[i].eigenvalue.imag(), period = 2.0 * pi / w;
      const VecX shape = modes[i].shape.real(),
                 momentum = motions.motions().mass_times(Eigen::MatrixXd(shape)).col(0);
      State start = rest;
      constexpr double small = 1e-4;
      for (std::size_t n = 1; n < start.pose.size(); ++n)
        start.pose[n] =
            rest.pose[n] *
            exp_se3<double>(Vec6(small * shape.segment<6>(6 * static_cast<Index>(n - 1))));
      Scene run = scene_of_run(scene, period);
      run.transient->tolerance = 1e-9;
      const Model model = compile(run);
      EXPECT_EQ(make_consistent(*model.system, start), "");
      const std::vector<State> states =
          states_of_run(run, model, start, {0.25 * period, 0.5 * period, period}, "test");
      const auto along = [&](const State& state) {
        double sum = 0.0;
        for (std::size_t n = 1; n < state.pose.size(); ++n)
          sum += momentum.segment<6>(6 * static_cast<Index>(n - 1))
                     .dot(log_se3(relative(rest.pose[n], state.pose[n])));
        return sum / (small * momentum.dot(shape));
      };
      const double wanted[] = {0.0, -1.0, 1.0};
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(along(states[k]), wanted[k], 1e-4) << angle << ' ' << i << ' ' << k;
    }
  }
}

// --- other axes, units and orders ---

// Eigenvalues do not know of them, at rest and turning.
TEST(ModesSlow, AreTheSameElsewhereAndInOtherUnits) {
  for (const char* const name : {"shaft", "swept_cantilever", "four_bar"}) {
    Scene scene = model_scene(name);
    const bool turns = std::string(name) == "shaft";
    if (turns) scene.gravity.reset();
    std::optional<SteadyRotation> rotation, elsewhere;
    const RigidMotion motion = random_motion(7, 5.0);
    if (turns) {
      rotation = SteadyRotation{40.0};
      elsewhere = SteadyRotation{40.0, motion.R * Vec3::UnitX(), motion.shift, {}};
    }
    const std::vector<NamedMode> here = modes_of(scene, 5, rotation);
    ASSERT_EQ(here.size(), 5U) << name;
    const auto compare = [&](const char* what, const std::vector<NamedMode>& other) {
      ASSERT_EQ(other.size(), here.size()) << name << ' ' << what;
      for (std::size_t i = 0; i < here.size(); ++i)
        EXPECT_LT(std::abs(other[i].eigenvalue - here[i].eigenvalue),
                  1e-7 * std::abs(here[i].eigenvalue))
            << name << ' ' << what << ' ' << i;
    };
    compare("elsewhere", modes_of(moved(scene, motion).scene, 5, elsewhere));
    compare("in mm and t", modes_of(rescaled(scene, {1e3, 1e-3, 1.0}).scene, 5, rotation));
    compare("in another order", modes_of(reordered(scene, 3), 5, rotation));
  }
}

// Found by a reviewer: of 20 EI/L^2 the first frequency of a cantilever as component modes is 2.3 times too low (3.958 for 9.161 rad/s,
// 10 digits, no note), of a spinning blade the third 15 %. Mutation: only what they are wrong by of deflections.
TEST(ModesOfReductions, SayWhereForcesMakeThemWrong) {
  const std::string held = R"(<fixed name="k" between="ground a.start"/>)";
  const auto scene = [&](double pull, bool reduced, const std::string& at_root = "") {
    return read(fmt::format(
        R"(<section name="s"><stiffness EA="1e6" GA2="1e6" GA3="1e6" GJ="10" EI2="1" EI3="2"/>
      <mass per_length="1" inertia="2e-5 1e-5 1e-5"/></section>
      <beam name="a" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="4"/>
      {}<load at="a.end" force="{} 0 0"/>{})",
        at_root.empty() ? held : at_root, pull,
        reduced ? R"(<reduction name="R" of="a" modes="12"/>)" : ""));
  };
  ModesOptions options;
  options.count = 2;
  const auto study_of = [&](const Scene& of) { return study_modes(of, options); };
  const auto all_notes = [](const std::vector<std::string>& notes) {
    std::string text;
    for (const std::string& note : notes) text += note + "\n";
    return text;
  };
  for (const double pull : {-1.5, -0.5, 0.02, 0.5, 2.0, 20.0}) {
    const ModesStudy reduced = study_of(scene(pull, true));
    const double wrong = std::abs(reduced.modes[0].eigenvalue.imag() /
                                      study_of(scene(pull, false)).modes[0].eigenvalue.imag() -
                                  1.0);
    const std::string notes = all_notes(reduced.notes);
    EXPECT_EQ(notes.find("component modes of reduction") != std::string::npos, std::abs(pull) > 0.1)
        << wrong << notes;
    if (pull < 0.1 && pull > 0.0) {
      EXPECT_LT(wrong, 1e-3);
    }
    if (pull > 10.0) {
      EXPECT_GT(wrong, 0.5);
      EXPECT_SAYS(notes, "wrong by any amount");
      EXPECT_SAYS(all_notes(linearize(scene(pull, true)).notes), "wrong by any amount");
    }
  }
  CampbellOptions turning;
  turning.rotation.axis = Vec3::UnitZ();
  turning.to = 20.0;
  turning.points = 3;
  turning.count = 2;
  const std::string turns =
      R"(<revolute name="k" between="ground a.start" axis="0 0 1"/><drive joint="k" rate="0"/>)";
  EXPECT_SAYS(all_notes(study_campbell(scene(0.0, true, turns), turning).notes),
              "rad/s component modes of reduction \"R\" are wrong by any amount");
}

// In inertial axes what nearly all cancels with the rate has the digits that are left, and no others.
TEST(ModesInWords, InertialFrequenciesHaveTheirDigits) {
  const auto words = [](double round_off) {
    ModesStudy study;
    study.model = "m";
    study.rotation = SteadyRotation{.rate = 5.0, .axis = Vec3::UnitX()};
    NamedMode mode;
    mode.eigenvalue = {0.0, 5.001};
    mode.orbit = -1.0;
    mode.round_off = round_off;
    mode.name = "what moves";
    study.modes.push_back(mode);
    return to_text(study);
  };
  EXPECT_SAYS(words(1e-14), " 0.0001591549 back");
  EXPECT_SAYS(words(1e-6), " 0.00016 back");
  EXPECT_SAYS(words(1e-3), " 0  what moves");
}

}  // namespace
}  // namespace mbd::test::test_modes
