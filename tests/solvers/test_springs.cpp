// Springs, dampers, bushings, springs and torques of joints against closed forms: free and damped oscillations,
// Duffing's and a piecewise linear spring, the six modes of a bushing, its limit to a joint, motors on free
// rotors; all methods on one scene that has all of them, with its energy balance; limits of validity.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libmbd/language/reader.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_springs {
namespace {

double last(const History& history, const std::string& column) {
  EXPECT_TRUE(history.report.complete()) << history.report.failure;
  return history.table[column].back();
}

Scene integrated(Scene scene, TimeMethod method, double step) {
  TransientScene& t = *scene.transient;
  t.method = method;
  t.step = step;
  t.rho_infinity.reset();
  if (method == TimeMethod::generalized_alpha) t.rho_infinity = 0.9;
  return scene;
}

// --- convergence ---

TEST(Springs, OscillatorConvergesAtTheOrderOfTheMethod) {
  const double M = 2, k = 800, c = 8, v0 = 2, z = c / (2 * M), w = std::sqrt(k / M - z * z);
  const double exact = v0 / w * std::exp(-z) * std::sin(w);
  const auto error = [&](TimeMethod method, double step) {
    const History h = run_to_table(integrated(model_scene("damped_oscillator"), method, step));
    return std::abs(last(h, "damped.displacement") - exact);
  };
  const double alpha = error(TimeMethod::generalized_alpha, 1e-3),
               half = error(TimeMethod::generalized_alpha, 5e-4);
  EXPECT_NEAR(alpha / half, 4.0, 0.1);
  EXPECT_LE(half, 2e-6);
  const double radau = error(TimeMethod::radau, 1e-2), radau_half = error(TimeMethod::radau, 5e-3);
  EXPECT_NEAR(radau / radau_half, 32.0, 1.0);
  EXPECT_LE(radau_half, 5e-10);
}

// --- laws ---

// The spline through five points of Duffing's law is that law.
TEST(Springs, SmoothTableOfDuffingsLaw) {
  Scene scene = model_scene("damped_oscillator");
  TableScene table;
  table.interpolation = Interpolation::smooth;
  for (const double x : {-0.12, -0.05, 0.02, 0.07, 0.13})
    table.points.push_back({x, 800 * x + 80000 * x * x * x});
  const History want = run_to_table(scene);
  scene.springs[1].force = table;
  const History got = run_to_table(scene);
  EXPECT_NEAR(last(got, "hardening.displacement"), last(want, "hardening.displacement"), 1e-13);
  scene.springs[1].force =
      Expression::parse("800*x + 88000*x^3", {}, Variables::x);  // 10 % off in a coefficient
  EXPECT_GT(std::abs(last(run_to_table(scene), "hardening.displacement") -
                     last(want, "hardening.displacement")),
            1e-3);
}

// k1 to |x| = a and k2 beyond: from x = 0 at v0 the mass is back after
//   2 (asin(w1 a/v0)/w1 + atan(w2 v1/(k1 a/M))/w2),  v1 its speed at a.
TEST(Springs, PiecewiseLinearTable) {
  const double M = 2, k1 = 800, k2 = 3200, a = 0.03, v0 = 1, w1 = std::sqrt(k1 / M),
               w2 = std::sqrt(k2 / M);
  const double v1 = std::sqrt(v0 * v0 - w1 * w1 * a * a);
  const double half = 2 * (std::asin(w1 * a / v0) / w1 + std::atan(w2 * v1 * M / (k1 * a)) / w2);
  Scene scene = read_model_text(R"(<mbd name="bilinear">
      <body name="mass" at="1 0 0" mass="2" inertia="1 1 1" velocity="1 0 0"/>
      <prismatic name="rail" between="ground mass" axis="1 0 0"/>
      <spring name="s" between="ground mass" at_a="0 0 0">
        <table>-0.08 -184  -0.03 -24  0.03 24  0.08 184</table>
      </spring>
      <transient duration="1" method="radau" tolerance="1e-10"/>
      <record name="x" joint="rail" quantities="displacement speed"/>
      <record name="s" spring="s" quantities="tension length length_rate"/>
    </mbd>)");
  scene.transient->duration = half;
  const History h = run_to_table(scene);
  EXPECT_NEAR(last(h, "x.displacement"), 0.0, 2e-7);
  EXPECT_NEAR(last(h, "x.speed"), -v0, 2e-7);
  for (std::size_t i = 0; i < h.table["time"].size(); i += 97) {
    const double x = h.table["x.displacement"][i], t = h.table["s.tension"][i];
    EXPECT_NEAR(h.table["s.length"][i], 1.0 + x, 1e-12);
    EXPECT_NEAR(h.table["s.length_rate"][i], h.table["x.speed"][i], 1e-12);
    EXPECT_NEAR(t, std::abs(x) < a ? k1 * x : std::copysign(24 + k2 * (std::abs(x) - a), x), 1e-9);
  }
}

// --- bushings ---

// Each of the six damped modes of a body on a bushing, at small amplitudes: what couples them is of second order,
// 4e-6 of them here (forces of sliding on displaced arms).
TEST(Springs, SixModesOfABushing) {
  const Scene scene = read_model_text(R"(<mbd name="modes">
      <body name="b" at="0.3 -1 2" mass="2" inertia="0.02 0.03 0.04"
            velocity="1e-6 -2e-6 3e-6" angular_velocity="2e-6 1e-6 -3e-6"/>
      <bushing name="B" between="ground b" axis="0 0 1" second_axis="1 0 0" stiffness="800 1800 3200"
               angular_stiffness="8 27 64" damping="4 6 8" angular_damping="0.04 0.06 0.1"/>
      <transient duration="0.3" method="radau" step="2e-3"/>
      <record name="b" at="b" quantities="displacement rotation"/>
      <record name="B" spring="B" quantities="force moment"/>
    </mbd>)");
  const History h = run_to_table(scene);
  const double m[] = {2, 2, 2, 0.02, 0.03, 0.04}, k[] = {800, 1800, 3200, 8, 27, 64},
               c[] = {4, 6, 8, 0.04, 0.06, 0.1}, v[] = {1e-6, -2e-6, 3e-6, 2e-6, 1e-6, -3e-6};
  for (std::size_t i = 0; i < 6; ++i) {
    const double z = c[i] / (2 * m[i]), w = std::sqrt(k[i] / m[i] - z * z), t = 0.3;
    const double x = v[i] / w * std::exp(-z * t) * std::sin(w * t),
                 rate = v[i] * std::exp(-z * t) * (std::cos(w * t) - z / w * std::sin(w * t));
    const std::string n = "." + std::to_string(i % 3 + 1);
    EXPECT_NEAR(last(h, (i < 3 ? "b.displacement" : "b.rotation") + n), x,
                1e-5 * std::abs(v[i] / w))
        << i;
    EXPECT_NEAR(last(h, (i < 3 ? "B.force" : "B.moment") + n), -k[i] * x - c[i] * rate,
                2e-5 * std::abs(k[i] * v[i] / w))
        << i;
  }
}

// A pendulum on a bushing that turns freely about its axis: the stiffer the rest, the nearer to the joint, in
// proportion.
TEST(Springs, StiffBushingIsARevoluteJoint) {
  const auto angle = [](const std::string& support) {
    const Scene scene = read_model_text(R"(<mbd name="limit">
      <body name="rod" at="0 0 0" mass="1" center="0.5 0 0" inertia="0.01 0.1 0.1"/>)" +
                                        support +
                                        R"(<gravity acceleration="0 -9.81 0"/>
      <transient duration="0.5" method="radau" step="2.5e-3"/>
      <record name="rod" at="rod" quantities="rotation"/></mbd>)");
    return last(run_to_table(scene), "rod.rotation.3");
  };
  const auto bushing = [&](const std::string& k) {
    return angle("<bushing name=\"B\" between=\"ground rod\" stiffness=\"" + k + " " + k + " " + k +
                 "\" angular_stiffness=\"" + k + " " + k + " 0\" damping=\"" + k + "/1e3 " + k +
                 "/1e3 " + k + "/1e3\"/>");
  };
  const double joint = angle("<revolute name=\"r\" between=\"ground rod\" axis=\"0 0 1\"/>");
  const double soft = std::abs(bushing("1e5") - joint), stiff = std::abs(bushing("1e6") - joint);
  EXPECT_LE(stiff, 1e-4);
  EXPECT_NEAR(soft / stiff, 10.0, 2.0);
}

// --- torques of joints ---

// Between two free bodies: they turn against each other, and neither momentum nor energy is lost or made.
TEST(Springs, ConstantMomentOnAFreeRotor) {
  const Scene scene = read_model_text(R"(<mbd name="rotor">
      <body name="stator" at="0 0 0" mass="5" inertia="2 2 2"/>
      <body name="rotor" at="0 0 0" mass="1" inertia="0.5 0.5 0.5"/>
      <revolute name="shaft" between="stator rotor" axis="0 0 1"/>
      <joint_torque joint="shaft" moment="3"/>
      <transient duration="2" step="0.02" rho_infinity="1"/>
      <record name="rotor" at="rotor" quantities="angular_velocity"/>
      <record name="stator" at="stator" quantities="angular_velocity"/>
      <record name="shaft" joint="shaft" quantities="angle"/>
      <record name="all" quantities="kinetic_energy work_of_loads angular_momentum"/>
    </mbd>)");
  const History h = run_to_table(scene);
  EXPECT_NEAR(last(h, "rotor.angular_velocity.3"), 3 * 2 / 0.5, 1e-11);
  EXPECT_NEAR(last(h, "stator.angular_velocity.3"), -3 * 2 / 2.0, 1e-11);
  EXPECT_NEAR(last(h, "shaft.angle"), 0.5 * (6.0 + 1.5) * 4, 1e-10);
  EXPECT_NEAR(last(h, "all.work_of_loads"), last(h, "all.kinetic_energy"), 1e-9);
  EXPECT_NEAR(last(h, "all.angular_momentum.3"), 0.0, 1e-12);
}

TEST(Springs, ForceAlongASlider) {
  const Scene scene = read_model_text(R"(<mbd name="slider">
      <body name="cart" at="0 0 0" mass="4" inertia="1 1 1"/>
      <prismatic name="rail" between="ground cart" axis="1 1 0"/>
      <joint_torque joint="rail" force="6*t"/>
      <joint_spring name="drag" joint="rail" damping="0" stiffness="0" damping_force="8*v"/>
      <transient duration="1" method="radau" step="0.01"/>
      <record name="rail" joint="rail" quantities="displacement speed"/>
      <record name="drag" spring="drag" quantities="joint_force"/>
    </mbd>)");
  const History h = run_to_table(scene);
  // M v' + d v = 6 t
  const double tau = 4.0 / 8.0, v = 6.0 / 8.0 * (1.0 - tau * (1.0 - std::exp(-1.0 / tau)));
  EXPECT_NEAR(last(h, "rail.speed"), v, 1e-10);
  EXPECT_NEAR(last(h, "drag.joint_force"), -8 * v, 1e-9);
}

// A bar on a hinge, held at its tip by a spring to a point beside it, whichever end of the spring is on the bar: the moments of
// weight and spring about the hinge are in balance at the angle that bisection finds.
TEST(Springs, HoldABarByTheTip) {
  constexpr double m = 3, g = 9.81, k = 60, free = 1.2;
  const auto moment = [](double angle) {  // about +y; the tip is at (cos, 0, -sin)
    const Vec3 tip(std::cos(angle), 0, -std::sin(angle)), to = Vec3(0.3, 0, 1.5) - tip;
    const Vec3 force = k * (to.norm() - free) * to.normalized();
    return tip.cross(force)(1) + (0.5 * tip).cross(Vec3(0, 0, -m * g))(1);
  };
  double low = -0.5, high = 0.0;
  ASSERT_LT(moment(low) * moment(high), 0.0);
  while (high - low > 1e-14) {
    const double middle = 0.5 * (low + high);
    (moment(low) * moment(middle) > 0.0 ? low : high) = middle;
  }
  for (const char* const spring : {R"(between="bar ground" at_a="1 0 0" at_b="0.3 0 1.5")",
                                   R"(between="ground bar" at_a="0.3 0 1.5" at_b="1 0 0")"}) {
    const History h = run_to_table(
        read_model_text(std::string(R"(<mbd name="bar"><gravity acceleration="0 0 -9.81"/>
      <body name="bar" at="0 0 0" center="0.5 0 0" mass="3" inertia="1 1 1"/>
      <revolute name="hinge" between="ground bar" axis="0 1 0"/><spring name="s" )") +
                        spring + R"( stiffness="60" length="1.2"/><static/>
      <record name="hinge" joint="hinge" quantities="angle"/></mbd>)"));
    EXPECT_NEAR(last(h, "hinge.angle"), low, 1e-9) << spring;
  }
}

// A free length that is given, not the distance of the points: F = k (l - l0), in equilibrium and as it is let go. Mutation: the distance
// is taken for it (it lived before).
TEST(Springs, FreeLengthIsTheOneGiven) {
  const std::string model = R"(<mbd name="rest">
      <body name="cart" at="0.5 0 0" mass="2" inertia="1 1 1"/>
      <prismatic name="rail" between="ground cart" axis="1 0 0"/>
      <spring name="coil" between="ground cart" at_a="0 0 0" stiffness="100" length="0.3"/>)";
  const std::string records =
      R"(<record name="coil" spring="coil" quantities="tension length"/></mbd>)";
  const History hangs = run_to_table(
      read_model_text(model + R"(<load at="cart" force="8 0 0"/><static/>)" + records));
  EXPECT_NEAR(last(hangs, "coil.length"), 0.3 + 0.08, 1e-12);
  const History swings = run_to_table(read_model_text(
      model + R"(<transient duration="0.2" method="radau" step="0.01"/>)" + records));
  ASSERT_TRUE(swings.report.complete()) << swings.report.failure;
  EXPECT_NEAR(swings.table["coil.tension"].front(), 100.0 * (0.5 - 0.3), 1e-12);
  EXPECT_NEAR(last(swings, "coil.length"), 0.3 + 0.2 * std::cos(std::sqrt(50.0) * 0.2), 1e-8);
}

// --- all of them ---

constexpr const char* everything = R"xml(<mbd name="everything">
  <body name="hub" at="0 0 0" mass="20" center="0.1 0 0" inertia="0.5 1.5 1.5"/>
  <bushing name="mount" between="ground hub" at="0 0 0.2" axis="0 1 1" second_axis="1 0 0"
           stiffness="2e4 3e4 4e4" angular_stiffness="400 300 500" damping="60 80 60"
           angular_damping="2 3 1">
    <law component="3" force="1e7*x^3"/>
    <law component="6" interpolation="smooth">-1 -900  -0.2 -30  0 0  0.3 60  1 700</law>
  </bushing>
  <body name="tip" at="1.2 0 0" mass="0.5" inertia="0.01 0.02 0.03" velocity="1 0.2 0.2"
        angular_velocity="5 0 1"/>
  <spring name="cord" between="ground tip" at_a="0.5 0.3 0" at_b="1.1 0.1 0" stiffness="300" damping="4" length="0.3"
          damping_force="3*v*abs(v)" force="x > 0 ? 2000*x^2 : 0"/>
  <cylindrical name="axle" between="hub tip" at="1 0 0" axis="1 0 0.2"/>
  <joint_spring name="turn" joint="axle" angular_stiffness="2" angular_damping="0.05" rest_angle="0.4"/>
  <joint_spring name="slide" joint="axle" stiffness="500" damping="2" damping_force="v^3"/>
  <joint_torque joint="axle" moment="4*sin(20*t)" force="3*(1-cos(15*t))"/>
  <gravity acceleration="0 0 -9.81"/>
  <transient duration="0.4" step="1e-3"/>
  <record name="tip" at="tip" quantities="position rotation velocity"/>
  <record name="axle" joint="axle" quantities="angle displacement"/>
  <record name="all" quantities="total_energy work_of_loads work_of_damping"/>
</mbd>)xml";

// start + works = end, and the same motion by every method.
TEST(Springs, AllMethodsOnAllTerms) {
  const std::string columns[] = {"tip.position.1",   "tip.position.2",    "tip.position.3",
                                 "axle.angle",       "axle.displacement", "all.work_of_damping",
                                 "all.work_of_loads"};
  const auto balance = [](const History& h) {
    const auto& energy = h.table["all.total_energy"];
    return std::abs(energy.back() - energy.front() - last(h, "all.work_of_loads") -
                    last(h, "all.work_of_damping"));
  };
  const Scene scene = read_model_text(everything);
  const auto with = [&](TimeMethod method, double step, double tolerance,
                        std::optional<Balance> of = {}) {
    Scene one = scene;
    one.transient->method = method;
    one.transient->balance = of;
    if (method == TimeMethod::generalized_alpha) one.transient->rho_infinity = 0.9;
    if (step > 0)
      one.transient->step = step;
    else
      one.transient->step.reset(), one.transient->tolerance = tolerance;
    return run_to_table(one);
  };
  const History best = with(TimeMethod::radau, 1e-3, 0);
  EXPECT_LT(last(best, "all.work_of_damping"), -1.0);
  EXPECT_LE(balance(best), 1e-5);
  const auto difference = [&](const History& h) {
    double most = 0;
    for (const std::string& column : columns)
      most = std::max(most, std::abs(last(h, column) - last(best, column)));
    return most;
  };
  const History half = with(TimeMethod::radau, 2e-3, 0);
  EXPECT_LE(difference(half), 1e-5);
  for (const Balance of : {Balance::acceleration, Balance::momentum}) {
    const History coarse = with(TimeMethod::generalized_alpha, 1e-3, 0, of),
                  fine = with(TimeMethod::generalized_alpha, 5e-4, 0, of);
    EXPECT_LE(difference(fine), 2e-2);
    EXPECT_NEAR(difference(coarse) / difference(fine), 4.0, 1.0);
    EXPECT_LE(balance(fine), 2e-2);
  }
  const History ida = with(TimeMethod::ida, 0, 1e-7);
  EXPECT_LE(difference(ida), 1e-4);
  EXPECT_LE(balance(ida), 1e-4);
  RecordProperty("radau", testing::PrintToString(difference(half)));
  RecordProperty("radau_balance", testing::PrintToString(balance(best)));
  RecordProperty("ida", testing::PrintToString(difference(ida)));
}

// Statics: what damps is not there, and costs nothing.
TEST(Springs, DampersAreAbsentWithoutATransient) {
  const auto types = [](const Scene& scene) {
    const Model model = compile(scene);
    std::string all;
    for (const auto& batch : model.system->batches()) all += std::string(batch->type()) + ";";
    return all;
  };
  Scene scene = read_model_text(everything);
  const std::string moving = types(scene);
  for (const char* const type :
       {"spring;", "damper;", "bushing;", "bushing damper;", "spring of joint angles;",
        "spring of joint displacements;", "damper of joint angles;",
        "damper of joint displacements;", "moment of joints;", "force of joints;"})
    EXPECT_NE(moving.find(type), std::string::npos) << type << " in " << moving;
  scene.transient.reset();
  scene.statics.emplace();
  for (BodyScene& body : scene.bodies) body.velocity.setZero(), body.angular_velocity.setZero();
  EXPECT_EQ(types(scene).find("damper"), std::string::npos) << types(scene);
  scene.springs.clear();
  scene.bushings.clear();
  scene.joint_springs.clear();
  scene.joint_torques.clear();
  const std::string none = types(scene);
  for (const char* const word : {"spring", "bushing", "moment of", "force of"})
    EXPECT_EQ(none.find(word), std::string::npos) << none;
}

// --- limits ---

TEST(Springs, FailByNameWhereTheyHaveNoDirectionOrRange) {
  // Thrown at the other end of its spring, along a rail: it gets there.
  const auto failure = [](const std::string& parts) {
    return run(read_model_text("<mbd name=\"limit\">" + parts +
                               "<record name=\"b\" at=\"b\" quantities=\"position\"/></mbd>"))
        .failure;
  };
  const std::string spring = failure(R"(
      <body name="b" at="1 0 0" mass="1" inertia="1 1 1" velocity="-1 0 0"/>
      <prismatic name="rail" between="ground b" axis="1 0 0"/>
      <spring name="cord" between="ground b" at_a="0 0 0" stiffness="1e-9"/>
      <transient duration="2" step="0.125" rho_infinity="1"/>)");
  EXPECT_NE(spring.find("spring 'cord' has no length left"), std::string::npos) << spring;
  const std::string bushing = failure(R"(
      <body name="b" mass="1" inertia="1 1 1" angular_velocity="0 0 10"/>
      <bushing name="mount" between="ground b" stiffness="1 1 1" angular_stiffness="1 1 1"/>
      <transient duration="2" step="0.01"/>)");
  EXPECT_NE(bushing.find("bushing 'mount' is turned beyond its range"), std::string::npos)
      << bushing;
}

// A moment per angle may be written as what it is.
TEST(Springs, StiffnessesPerAngleMaySaySo) {
  const auto of = [](const std::string& k, const std::string& c) {
    return read_model_text(R"(<mbd name="u"><body name="b" mass="1" inertia="1 1 1"/>
      <revolute name="r" between="ground b" axis="0 0 1"/>
      <joint_spring name="s" joint="r" angular_stiffness=")" +
                           k + R"(" angular_damping=")" + c +
                           R"("/><transient duration="1" step="0.1"/></mbd>)")
        .joint_springs[0];
  };
  constexpr double deg = std::numbers::pi / 180.0;
  EXPECT_NEAR(of("2 N.m/deg", "0").stiffness, 2.0 / deg, 1e-12);
  EXPECT_NEAR(of("2 kN.mm/rad", "3 N.m.s/rad").stiffness, 2.0, 1e-15);
  EXPECT_NEAR(of("2 N.m", "3 N.m.s/rad").damping, 3.0, 1e-15);
  EXPECT_THROW(of("2 N/rad", "0"), Error);
}

}  // namespace
}  // namespace mbd::test::test_springs
