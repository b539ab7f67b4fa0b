// Equations of motion as matrices: against transfer functions in closed form, eigenvalues of the paper's shaft (two independent
// computations, ten digits), and neighbouring motions of the integrator.

#include "libmbd/study/modes/linearize.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "libmbd/compile/time_stepping.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/shell.hpp"
#include "tests/support/stepping.hpp"

namespace mbd::test::test_linearize {
namespace {

using Complex = std::complex<double>;

// C (s E - A)^-1 B + D.
Eigen::MatrixXcd transfer(const Linearization& linear, Complex s) {
  const ReducedMotion& r = *linear.reduced;
  const Eigen::MatrixXcd system = s * r.E.cast<Complex>() - r.A.cast<Complex>();
  return linear.C.cast<Complex>() * dense::solve_columns(system, r.G.cast<Complex>()) +
         linear.D.cast<Complex>();
}

std::size_t place(const std::vector<Port>& all, const std::string& name) {
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].name == name) return i;
  ADD_FAILURE() << name;
  return 0;
}

// A pole upright on a cart of 2 kg, in the units of `mm`: bob of 1 kg with inertia, 0.7 m above; force on the cart in kN,
// torque of the hinge.
std::string cart_pole(const std::string& unit, double in_m) {
  return fmt::format(R"(<input name="push" unit="kN"/><input name="turn"/>
    <body name="cart" at="0 0 0 {0}" mass="2" inertia="1 1 1"/>
    <body name="bob" at="0 {1:.17g} 0 {0}" mass="1" inertia="0.05 0.05 0.05"/>
    <prismatic name="rail" between="ground cart" axis="1 0 0"/>
    <revolute name="hinge" between="cart bob" at="0 0 0" axis="0 0 1"/>
    <joint_spring name="js" joint="rail" stiffness="3" damping="0.4"/>
    <joint_torque joint="hinge" moment="turn"/>
    <load at="cart" force="push 0 0"/><gravity acceleration="0 -9.81 0"/>
    <record name="cart" at="cart" quantities="displacement velocity acceleration"/>
    <record name="bob" at="bob" quantities="acceleration"/>
    <record name="pole" joint="hinge" quantities="angle rate reaction_force"/>
    <transient duration="1" step="0.1"/>)",
                     unit, 0.7 / in_m);
}

// (M+m) x'' + c x' + k x + m L p'' = u,  (J + m L^2) p'' + m L x'' - m g L p = -w, with p clockwise, w the hinge's moment.
TEST(Linearize, CartPole) {
  for (const auto& [unit, in_m] : {std::pair{"m", 1.0}, {"mm", 1e-3}, {"km", 1e3}}) {
    SCOPED_TRACE(unit);
    const Linearization linear = linearize(read(cart_pole(unit, in_m)));
    ASSERT_TRUE(linear.reduced);
    EXPECT_EQ(linear.states.size(), 4U);
    EXPECT_EQ(linear.D.cols(), 2);
    for (const Complex s : {Complex(0.3, 0.0), Complex(0.0, 2.0), Complex(-1.0, 7.0)}) {
      const Eigen::MatrixXcd H = transfer(linear, s);
      Eigen::Matrix2cd system;
      constexpr double M = 2.0, m = 1.0, L = 0.7, J = 0.05, g = 9.81;
      system << (M + m) * s * s + 0.4 * s + 3.0, m * L * s * s, m * L * s * s,
          (J + m * L * L) * s * s - m * g * L;
      for (int input = 0; input < 2; ++input) {
        Eigen::Vector2cd force(input == 0 ? 1e3 : 0.0, input == 0 ? 0.0 : -1.0);
        const Eigen::Vector2cd xp = system.inverse() * force;
        const auto expect = [&](const char* name, Complex wanted) {
          const Complex is = H(static_cast<Index>(place(linear.ports.outputs, name)), input);
          EXPECT_LT(std::abs(is - wanted), 1e-7 * std::abs(wanted)) << name << s << is << wanted;
        };
        expect("cart.displacement.1", xp(0));
        expect("cart.velocity.1", s * xp(0));
        expect("cart.acceleration.1", s * s * xp(0));
        expect("bob.acceleration.1", s * s * (xp(0) + L * xp(1)));
        expect("pole.angle", -xp(1));
        expect("pole.rate", -s * xp(1));
      }
    }
    // The hinge carries the bob; joint axes turn with it, so its weight shows along them.
    double carried = 0.0;
    for (const char* name :
         {"pole.reaction_force.1", "pole.reaction_force.2", "pole.reaction_force.3"})
      carried = std::hypot(carried,
                           linear.outputs(static_cast<Index>(place(linear.ports.outputs, name))));
    EXPECT_NEAR(carried, 9.81, 1e-9);
  }
}

// Poles of the shaft, in turning axes.
TEST(Linearize, PolesOfTheShaft) {
  Scene scene = model_scene("shaft");
  scene.beams[0].elements = 6;
  scene.beams[0].order = 4;
  scene.gravity.reset();
  scene.bodies[0].center.setZero();
  const auto poles_of = [&](const ModesOptions& options) {
    const Linearization linear = linearize(scene, options);
    return dense::eigenpairs(dense::solve_columns(linear.reduced->E, linear.reduced->A)).values;
  };
  const auto nearest = [](const Eigen::VectorXcd& poles, double frequency) {
    double least = 1e300;
    for (const Complex& pole : poles)
      least = std::min(least, std::abs(pole - Complex(0.0, frequency)));
    return least;
  };
  const Eigen::VectorXcd rest = poles_of({});
  for (const double wanted : {53.5955010753, 111.113174815, 395.022218827})
    EXPECT_LT(nearest(rest, wanted), 1e-6 * wanted) << wanted;
  ModesOptions turning;
  turning.rotation = SteadyRotation{50.0};
  const Eigen::VectorXcd turns = poles_of(turning);
  for (const double wanted :
       {53.59746628082 - 50.0, 53.59353593462 + 50.0, 410.710452112 - 50.0, 379.095026534 + 50.0})
    EXPECT_LT(nearest(turns, wanted), 1e-6 * wanted) << wanted;
}

const std::string flexible = R"(<input name="u"/>
  <section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="60"/>
    <damping stiffness_proportional="2e-3"/><mass per_length="1.2" inertia="2e-3 1e-3 1e-3"/></section>
  <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="3"/>
  <beam name="c" section="s" from="2 0 0" to="2 1 0" normal="0 0 1" elements="2"/>
  <revolute name="r" between="ground b.start" axis="0 1 0"/>
  <joint_spring name="js" joint="r" angular_stiffness="200" angular_damping="3"/>
  <fixed name="corner" between="b.end c.start"/>
  <load at="c.end" follower_force="0 0 u"/><gravity acceleration="0 0 -9.81"/>
  <record name="tip" at="c.end" quantities="displacement velocity"/>
  <record name="root" joint="r" quantities="angle reaction_force"/>
  <record name="in" at="b@0.3" quantities="moment"/>
  <static/><transient duration="0.6" method="radau" tolerance="1e-10"/>)";

// What a small input does to a bent structure, by the matrices (a series of exponentials, exact) and by the integrator. The
// remainder is of second order: four times less at half the input.
TEST(Linearize, SmallInputsOfABentStructure) {
  const Scene scene = read(flexible);
  const Model model = compile(scene);
  const Linearization linear = linearize(scene);
  const ReducedMotion& r = *linear.reduced;
  const dense::EigenPairs modes = dense::eigenpairs(dense::solve_columns(r.E, r.A));
  const VecX rates = dense::solve_columns(r.E, r.G).col(0);
  const Eigen::VectorXcd into = dense::solve(modes.vectors, rates.cast<Complex>());
  const auto linear_change = [&](double t, double u) {
    Eigen::VectorXcd x(into.size());
    for (Index i = 0; i < x.size(); ++i) {
      const Complex l = modes.values(i);
      x(i) = into(i) * (std::exp(l * t) - 1.0) / l * u;
    }
    return VecX(linear.C * (modes.vectors * x).real() + linear.D.col(0) * u);
  };
  constexpr const char* names[] = {"root.angle", "root.reaction_force.3", "in.moment.2",
                                   "in.moment.1"};
  double before = 0.0;
  std::array<double, 4> off_before{};
  for (const double u : {0.2, 0.1}) {
    std::array<double, 4> off{}, scale{};
    State state = start_of(scene, model);
    const auto stepper = make_stepper(*model.system, *scene.transient);
    state.inputs[0].hold(u, 0.0);
    ASSERT_TRUE(stepper->start(state).converged);
    double worst = 0.0, size = 0.0;
    for (const double t : {0.1, 0.35, 0.6}) {
      stepper->stop_at(t);
      while (state.t < t - 1e-9) ASSERT_TRUE(stepper->step(state).converged);
      VecX y(linear.outputs.size());
      outputs(model, state, {y.data(), static_cast<std::size_t>(y.size())});
      const VecX change = y - linear.outputs, wanted = linear_change(t, u);
      for (Index i = 0; i < 3; ++i) {  // of the tip
        worst = std::max(worst, std::abs(change(i) - wanted(i)));
        size = std::max(size, std::abs(wanted(i)));
      }
      for (std::size_t k = 0; k < 4; ++k) {
        const auto i = static_cast<Index>(place(linear.ports.outputs, names[k]));
        off[k] = std::max(off[k], std::abs(change(i) - wanted(i)));
        scale[k] = std::max(scale[k], std::abs(wanted(i)));
      }
    }
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_GT(scale[k], 1e-4) << names[k];
      if (before > 0.0) {
        EXPECT_NEAR(std::log2(off_before[k] / off[k]), 2.0, 0.2) << names[k];
      }
    }
    off_before = off;
    EXPECT_LT(worst, 0.02 * size);
    EXPECT_GT(size, 1e-3);
    if (before > 0.0) {
      EXPECT_NEAR(std::log2(before / worst), 2.0, 0.2);
    }
    before = worst;
  }
}

// About a motion: two trajectories that differ by little. Of each row, the error over the sum of what is added.
TEST(Linearize, NeighbouringMotions) {
  const std::string model_text = R"(<input name="u" value="2"/>
      <section name="s"><stiffness EA="1e5" GA2="4e4" GA3="4e4" GJ="80" EI2="100" EI3="60"/>
        <damping stiffness_proportional="1e-3"/><mass per_length="1.2" inertia="2e-3 1e-3 1e-3"/></section>
      <body name="hub" mass="2" inertia="0.3 0.2 0.4" at="0 0 0" center="0.1 0.02 0.03"/>
      <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2"/>
      <spherical name="p" between="ground hub" at="0 0 0"/><fixed name="f" between="hub b.start"/>
      <load at="b.end" force="0 u 1"/><gravity acceleration="0 0 -9.81"/>
      <record name="tip" at="b.end" quantities="displacement"/>
      <transient duration="1" method="radau" tolerance="1e-11"/>)";
  const Scene scene = read(model_text);
  const Model model = compile(scene);
  const System& system = *model.system;
  const auto state_with = [&](double u) {
    const auto stepper = make_stepper(system, *scene.transient);
    State state = model.initial;
    state.inputs[0].hold(u, 0.0);
    EXPECT_TRUE(stepper->start(state).converged);
    stepper->stop_at(0.4);
    while (state.t < 0.4 - 1e-9) EXPECT_TRUE(stepper->step(state).converged);
    // Accelerations and multipliers that belong to it.
    const auto again = make_stepper(system, *scene.transient);
    EXPECT_TRUE(again->start(state).converged);
    return state;
  };
  constexpr double du = 1e-4;
  const State ahead = state_with(2.0 + du), at = state_with(2.0), behind = state_with(2.0 - du);
  const Linearization linear = linearize(model, at);
  EXPECT_FALSE(linear.reduced);
  EXPECT_EQ(linear.notes.size(), 1U);
  const Index n = linear.motion.M.rows();
  VecX u(n), rate(n), acceleration(n);
  double fastest = 0.0;
  for (std::size_t k = 1; k < at.pose.size(); ++k) {
    const Index i = 6 * static_cast<Index>(k - 1);
    const Mat6 V_hat = twist_hat<double>(at.V[k]), A_hat = twist_hat<double>(at.Vdot[k]);
    const Vec6 d = (log_se3<double>(relative(at.pose[k], ahead.pose[k])) -
                    log_se3<double>(relative(at.pose[k], behind.pose[k]))) /
                   (2.0 * du);
    const Vec6 dV = (ahead.V[k] - behind.V[k]) / (2.0 * du),
               dA = (ahead.Vdot[k] - behind.Vdot[k]) / (2.0 * du);
    u.segment<6>(i) = d;
    rate.segment<6>(i) = dV - V_hat * d;
    acceleration.segment<6>(i) = dA - V_hat * Vec6(rate.segment<6>(i)) - A_hat * d;
    fastest = std::max(fastest, at.V[k].norm());
  }
  EXPECT_GT(fastest, 1.0);
  const VecX multipliers = (ahead.lambda - behind.lambda) / (2.0 * du);
  const VecX terms[] = {linear.motion.M * acceleration, linear.motion.C * rate, linear.motion.K * u,
                        linear.motion.B.transpose() * multipliers, -linear.motion.F.col(0)};
  VecX sum = VecX::Zero(n);
  double size = 0.0;
  for (const VecX& term : terms) {
    sum += term;
    size = std::max(size, term.cwiseAbs().maxCoeff());
  }
  EXPECT_LT(sum.cwiseAbs().maxCoeff(), 1e-5 * size);
  EXPECT_LT(VecX(linear.motion.B * u).cwiseAbs().maxCoeff(), 1e-6 * u.cwiseAbs().maxCoeff());
}

// Joints that repeat each other.
TEST(Linearize, RedundantConstraints) {
  const Linearization linear = linearize(read(R"(<input name="u"/>
    <body name="door" mass="3" inertia="1 1 1" at="0.5 0 0"/>
    <revolute name="upper" between="ground door" at="0 0 1" axis="0 0 1"/>
    <revolute name="lower" between="ground door" at="0 0 -1" axis="0 0 1"/>
    <joint_spring name="js" joint="upper" angular_stiffness="7"/>
    <load at="door" force="0 u 0"/>
    <record name="upper" joint="upper" quantities="angle reaction_force"/>
    <record name="lower" joint="lower" quantities="reaction_force"/><transient duration="1" step="0.1"/>)"));
  ASSERT_EQ(linear.states.size(), 2U);
  const Complex s(0.0, 1.3);
  const Eigen::MatrixXcd H = transfer(linear, s);
  // (1 + 3 0.5^2) p'' + 7 p = 0.5 u; the hinges share 3 y'' - u between them.
  const Complex p = 0.5 / (1.75 * s * s + 7.0);
  EXPECT_LT(std::abs(H(0, 0) - p), 1e-8 * std::abs(p));
  Complex sum = 0.0;
  for (Index i = 1; i < 7; ++i) sum += H(i, 0) * H(i, 0);
  const Complex each = 0.5 * (3.0 * s * s * 0.5 * p - 1.0);
  EXPECT_LT(std::abs(std::sqrt(sum / 2.0) - each) * std::abs(std::sqrt(sum / 2.0) + each),
            1e-7 * std::norm(each));
}

// Found by a reviewer: of a model without joints, and with records, it broke down. Displacements are the states.
TEST(Linearize, WithoutJoints) {
  const Linearization linear = linearize(read(R"(<body name="b" mass="2" inertia="1 2 3"/>
      <bushing name="k" between="ground b" stiffness="18 50 98" angular_stiffness="1 2 3"/>
      <record name="b" at="b" quantities="displacement"/><static/>)"),
                                         {}, true);
  ASSERT_TRUE(linear.reduced);
  EXPECT_EQ(linear.states.size(), 12U);
  EXPECT_LT((linear.C.leftCols(3) - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  EXPECT_EQ(linear.growth, 0.0);
}

// Found by a reviewer: where one output is nothing but round-off (the moment about the axis of a hinge) the others were taken from
// differences that agree by chance over steps that are nearly nothing, 2e-4 off. A velocity is the rate of its position.
// Mutation: steps go on for all while one output is not known.
TEST(Linearize, OutputsBesideOneThatIsZero) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto vector = [&](double size) {
    const double x = size * normal(random), y = size * normal(random);
    return fmt::format("{:.17g} {:.17g} {:.17g}", x, y, size * normal(random));
  };
  for (int k = 0; k < 40; ++k) {
    const Linearization linear = linearize(read(fmt::format(
        R"(<body name="A" mass="1.3" at="{} 0 0" center="{}" inertia="0.02 0.03 0.025"/>
        <revolute name="j" between="ground A" at="0 0 0" axis="{}"/>
        <joint_spring name="s" joint="j" angular_stiffness="{}"/><gravity acceleration="{}"/><static/>
        <record name="A" at="A" quantities="position velocity"/>
        <record name="j" joint="j" quantities="reaction_moment"/>)",
        0.2 + 0.04 * k, vector(0.1), vector(1.0), 5 + k, vector(6.0))));
    ASSERT_TRUE(linear.reduced);
    for (int i = 1; i <= 3; ++i) {
      const auto row = [&](const char* quantity) {
        return static_cast<Index>(place(linear.ports.outputs, fmt::format("A.{}.{}", quantity, i)));
      };
      const double rate = linear.C(row("velocity"), 1);
      EXPECT_NEAR(linear.C(row("position"), 0), rate, 1e-8 * (1.0 + std::abs(rate))) << k;
    }
    EXPECT_TRUE(linear.notes.empty()) << linear.notes.front();
  }
}

// Found by a reviewer: stable structures were "unstable: something grows as exp(1.86e+17 t)", by round-off of a matrix whose numbers are
// 1 and 1e18. An upright pendulum grows by sqrt(g/l), beside what is a million times faster too; Beck's column by its follower force.
// Killed: poles of the matrix as it is.
TEST(Linearize, SaysWhatGrowsAndNothingElse) {
  for (const char* const model : {"slider_crank", "shaft", "four_bar"})
    EXPECT_EQ(linearize(model_scene(model), {}, true).growth, 0.0) << model;
  const auto cantilever = [](const std::string& more) {
    return linearize(read(R"(<material name="si" E="160 GPa" nu="0" rho="2330"/>
      <section name="s"><rectangle width="2 um" height="1 um" material="si"/></section>
      <beam name="a" section="s" from="0 0 0" to="60 80 0 um" normal="0 0 1" elements="3" order="5"/>
      <fixed name="k" between="ground a.start"/>)" +
                          more),
                     {}, true);
  };
  EXPECT_EQ(cantilever("").growth, 0.0);
  const std::string pendulum = R"(
      <body name="p" mass="1" at="0 1 0" inertia="0 0 0"/><gravity acceleration="0 {} 0"/>
      <revolute name="h" between="ground p" at="0 0 0" axis="0 0 1"/>)";
  EXPECT_NEAR(cantilever(fmt::format(fmt::runtime(pendulum), -9.81)).growth.value(),
              std::sqrt(9.81), 1e-6);
  EXPECT_EQ(cantilever(fmt::format(fmt::runtime(pendulum), 9.81)).growth, 0.0);
  // 20.05 EI / L^2.
  const auto beck = [](double load) {
    return linearize(
               read(fmt::format(
                   R"(<section name="s"><stiffness EA="1e7" GA2="inf" GA3="inf" GJ="1e3" EI2="1" EI3="1e3"/>
      <mass per_length="1" inertia="2e-9 1e-9 1e-9"/></section>
      <beam name="a" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="6" order="5"/>
      <fixed name="k" between="ground a.start"/><load at="a.end" follower_force="{} 0 0"/>)",
                   -load)),
               {}, true)
        .growth;
  };
  EXPECT_EQ(beck(19.9), 0.0);
  EXPECT_GT(beck(20.2), 0.1);
}

// Outputs of a mechanism of a millimetre are the same beside a body 10 km away. Length of a spring: (y - b)/l; tension of a law, its
// derivative. Mutation: steps a fixed part of the scene.
TEST(Linearize, OutputsMuchSmallerThanTheScene) {
  for (const double X : {0.0, 1.0, 100.0, 1e4}) {
    SCOPED_TRACE(X);
    const Linearization linear = linearize(read(fmt::format(
        R"(<body name="p" mass="0.02" inertia="1e-7 1e-6 1e-6"/>
        <prismatic name="r" between="ground p" axis="0 1 0"/>
        <spring name="s" between="ground p" at_a="1e-3 0.5e-3 0" stiffness="500" length="0.9e-3"/>
        <spring name="n" between="ground p" at_a="0 -5e-3 0" force="1e3*x+1e9*x^3" length="4.9e-3"/>
        <body name="station" at="{} 0 0" mass="1" inertia="1 1 1"/>
        <revolute name="t" between="ground station" axis="0 0 1"/>
        <joint_spring name="tk" joint="t" angular_stiffness="1"/>
        <static/><transient duration="0.05" step="1e-3"/>
        <record name="r" joint="r" quantities="displacement"/>
        <record name="s" spring="s" quantities="length"/>
        <record name="n" spring="n" quantities="length tension"/>)",
        X)));
    ASSERT_TRUE(linear.reduced);
    const auto value = [&](const char* name) {
      return linear.outputs(static_cast<Index>(place(linear.ports.outputs, name)));
    };
    const Index y = static_cast<Index>(place(linear.ports.outputs, "r.displacement"));
    Index column = 0;
    linear.C.row(y).cwiseAbs().maxCoeff(&column);
    const auto rate = [&](const char* name) {
      return linear.C(static_cast<Index>(place(linear.ports.outputs, name)), column) /
             linear.C(y, column);
    };
    const double up = value("r.displacement") - 0.5e-3, x = value("n.length") - 4.9e-3;
    EXPECT_NEAR(rate("s.length"), up / value("s.length"), 1e-8);
    EXPECT_NEAR(rate("n.length"), 1.0, 1e-8);
    EXPECT_NEAR(rate("n.tension"), 1e3 + 3e9 * x * x, 1e-5);
    EXPECT_TRUE(linear.notes.empty()) << linear.notes.front();
  }
}

// The stress of von Mises by the chain rule from the stresses, of loads so small that it bends within any step that is a part of
// the scene. Mutation: steps of 1e-5 of the scene (a tip load of 0.1 N is 75 % wrong).
TEST(Linearize, StressOfVonMisesNearZero) {
  for (const double P : {0.01, 0.1, 1.0, 10.0, 100.0}) {
    SCOPED_TRACE(P);
    const Linearization linear = linearize(read(fmt::format(
        R"(<input name="P" unit="N" value="{}"/>
        <material name="st" E="200 GPa" nu="0.3" rho="7800 kg/m3"/>
        <section name="s"><rectangle width="10 mm" height="4 mm" material="st"/></section>
        <beam name="b" section="s" from="0 0 0" to="0.3 0 0" normal="0 0 1" elements="1"/>
        <fixed name="F" between="ground b.start"/><load at="b.end" force="0 0 P"/>
        <static/><transient duration="0.02" step="1e-4"/>
        <record name="m" at="b@0.3" section_point="3mm 1mm"
                quantities="von_mises ply_stress ply_shear_stress"/>)",
        P)));
    const MatX gain = transfer(linear, 0.0).real();
    const VecX s = linear.outputs.segment(1, 6), ds = gain.col(0).segment(1, 6);
    double change = 0.0;  // of the square of the stress of von Mises
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      change += (s(i) - s(j)) * (ds(i) - ds(j)) + 6.0 * s(3 + i) * ds(3 + i);
    }
    // The steps go with P, and what round-off leaves over them; of a row stiff directions cancel four digits.
    EXPECT_NEAR(gain(0, 0) / (change / (2.0 * linear.outputs(0))), 1.0, 1e-5 / std::min(P, 1.0));
  }
}

// A rotation vector grows by the angle beyond half a turn too, where the one that is written is another for the same rotation.
// Mutation: differences of the vectors as they are written.
TEST(Linearize, RotationVectorsAtHalfATurn) {
  for (const double angle : {170.0, 179.9999, 180.0001, 190.0}) {
    const Linearization linear = linearize(read(fmt::format(
        R"(<body name="p" center="0.5 0 0" mass="2" inertia="0.01 0.2 0.2"/>
        <revolute name="j" between="ground p" at="0 0 0" axis="0 1 0"/>
        <joint_spring name="s" joint="j" angular_stiffness="400" rest_angle="{}*deg"/>
        <static steps="10"/><transient duration="0.5" step="1e-3"/>
        <record name="j" joint="j" quantities="angle"/>
        <record name="p" at="p" quantities="rotation"/>)",
        angle)));
    Index column = 0;
    linear.C.row(0).cwiseAbs().maxCoeff(&column);
    EXPECT_NEAR(linear.C(2, column) / linear.C(0, column), 1.0, 1e-6) << angle;
  }
}

// A mass on a radial spring in a slot that turns at W: x'' + c x' + (k - m W^2) x = f, f along the slot.
std::string in_a_slot(const std::string& load) {
  return R"(<input name="f"/><body name="hub" mass="1" inertia="0.1 0.1 0.2"
        angular_velocity="0 0 2"/>
    <revolute name="R" between="ground hub" axis="0 0 1"/><drive joint="R" rate="2"/>
    <body name="m" at="1 0 0" mass="1" inertia="0.1 0.1 0.1" velocity="0 2 0"
        angular_velocity="0 0 2"/>
    <prismatic name="S" between="hub m" axis="1 0 0"/>
    <joint_spring name="k" joint="S" stiffness="40" damping="1" rest_displacement="-0.1"/>
    <load at="m" )" +
         load + R"(/><transient duration="20" step="0.01"/>
    <record name="S" joint="S" quantities="displacement speed"/>
    <record name="m" at="m" quantities="position velocity rotation displacement"/>
    <record name="all" quantities="work_of_drives work_of_loads"/>)";
}

// Mutations: forces of inputs not looked at; outputs in inertial axes as they are.
TEST(Linearize, InputsAndOutputsOfWhatTurns) {
  ModesOptions turning;
  turning.rotation = SteadyRotation{2.0, Vec3::UnitZ()};
  try {
    linearize(read(in_a_slot("force=\"f 0 0\"")), turning);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_SAYS(std::string(error.what()), "\"f\" is a force in inertial axes on what turns");
  }
  const Linearization linear = linearize(read(in_a_slot("follower_force=\"f 0 0\"")), turning);
  for (const Complex s : {Complex(0.0, 0.0), Complex(0.0, 3.0)}) {
    const Complex is =
        transfer(linear, s)(static_cast<Index>(place(linear.ports.outputs, "S.displacement")), 0);
    EXPECT_LT(std::abs(is - 1.0 / (s * s + s + 36.0)), 1e-7);
  }
  // Where it is, in axes that turn with it: constant, and moved by what the slot lets it; from where it was, it is not constant.
  const std::size_t position = place(linear.ports.outputs, "m.position.1");
  EXPECT_EQ(linear.ports.outputs[position].frame, "axes that turn, at t = 0 inertial");
  EXPECT_LT(std::abs(transfer(linear, 0.0)(static_cast<Index>(position), 0) - 1.0 / 36.0), 1e-7);
  EXPECT_EQ(linear.C.rows(), static_cast<Index>(linear.ports.outputs.size()));
  EXPECT_EQ(linear.ports.outputs.size(), 8U);
  const std::string said = to_text(linear);
  EXPECT_SAYS(said, "m.rotation.3");
  EXPECT_SAYS(said, "m.displacement.1");
  EXPECT_SAYS(said, "all.work_of_drives, all.work_of_loads: integrals over time");
}

TEST(Linearize, SaysWhatItCannot) {
  const auto said = [](const std::string& inside, const ModesOptions& options = {}) -> std::string {
    try {
      linearize(read(inside), options);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_SAYS(said(R"(<input name="u"/><body name="w" mass="1" inertia="1 1 1"/>
      <revolute name="r" between="ground w" axis="0 0 1"/><drive joint="r" angle="u"/>
      <transient duration="1" step="0.1"/>)"),
              "\"u\" prescribes a motion");
  // So do motions of the base, also where at the start nothing moves. Mutation: B = 0 of them.
  for (const char* law :
       {"displacement=\"u 0 0\"", "velocity=\"0 u 0\"", "displacement=\"u*t 0 0\""})
    EXPECT_SAYS(said(fmt::format(R"(<input name="u"/><body name="w" mass="1" inertia="1 1 1"/>
        <prismatic name="r" between="ground w" axis="1 0 0"/>
        <joint_spring name="k" joint="r" stiffness="3"/><base_motion {}/>
        <transient duration="1" step="0.1"/>)",
                                 law)),
                "\"u\" prescribes a motion");
  EXPECT_SAYS(said(R"(<input name="u"/><body name="w" mass="1" inertia="1 1 1"/>
        <prismatic name="r" between="ground w" axis="1 0 0"/>
        <joint_spring name="k" joint="r" stiffness="3"/><base_motion acceleration="u 0 0"/>
        <transient duration="1" step="0.1"/>)"),
              "no error");
  EXPECT_SAYS(
      said(
          R"(<body name="w" mass="1" inertia="0 0 0"/><body name="v" mass="1" inertia="1 1 1" at="1 0 0"/>
      <spherical name="k" between="v w" at="0 0 0"/>
      <bushing name="h" between="ground v" at="1 0 0" stiffness="5 5 5" angular_stiffness="2 2 2"/>
      <bushing name="i" between="ground w" stiffness="5 5 5" angular_stiffness="2 2 2"/>
      <transient duration="1" step="0.1"/>)"),
      "no inertia in some motion");
}

// linear.json and the matrices, read again.
TEST(Linearize, Files) {
  const Linearization linear = linearize(read(flexible));
  const TemporaryDirectory directory;
  write_linearization(linear, directory.path());
  const auto all = nlohmann::json::parse(read_text(directory.path() / "linear.json"));
  EXPECT_EQ(all.at("states").size(), linear.states.size());
  EXPECT_EQ(all.at("A").size(), linear.states.size());
  EXPECT_EQ(all.at("B").at(7).size(), 1U);
  EXPECT_EQ(all.at("A").at(9).at(2).get<double>(), linear.reduced->A(9, 2));
  EXPECT_EQ(all.at("outputs").at(3).at("name"), "tip.velocity.1");
  EXPECT_EQ(all.at("outputs").at(3).at("frame"), "inertial axes");
  std::istringstream stream(read_text(directory.path() / "K.mtx"));
  std::string head;
  std::getline(stream, head);
  EXPECT_EQ(head, "%%MatrixMarket matrix coordinate real general");
  Index rows = 0, columns = 0, entries = 0, i = 0, j = 0;
  double value = 0.0;
  stream >> rows >> columns >> entries;
  Eigen::SparseMatrix<double> K(rows, columns);
  while (stream >> i >> j >> value) {
    K.coeffRef(i - 1, j - 1) = value;
    --entries;
  }
  EXPECT_EQ(entries, 0);
  EXPECT_EQ((K - linear.motion.K).norm(), 0.0);
  EXPECT_SAYS(to_text(linear), "1 inputs, 13 outputs");
}

}  // namespace
}  // namespace mbd::test::test_linearize
