// Drag and added mass against closed forms and scalar equations integrated on their own.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "libmbd/compile/drags.hpp"
#include "libmbd/run/describe.hpp"
#include "libmbd/study/trust/transform.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_fluid {
namespace {

using std::numbers::pi;

Scene scene_of(const std::string& contents) {
  return read_model_text("<mbd name=\"test\">" + contents + "</mbd>", "test.xml");
}

// The classical Runge-Kutta method, independent of the library: y' = f(y).
template <std::size_t n, class F>
std::array<double, n> integrate(std::array<double, n> y, double duration, int steps, const F& f) {
  const double h = duration / steps;
  const auto plus = [](std::array<double, n> a, double s, const std::array<double, n>& b) {
    for (std::size_t i = 0; i < n; ++i) a[i] += s * b[i];
    return a;
  };
  for (int k = 0; k < steps; ++k) {
    const auto a = f(y), b = f(plus(y, h / 2, a)), c = f(plus(y, h / 2, b)), d = f(plus(y, h, c));
    for (std::size_t i = 0; i < n; ++i) y[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
  }
  return y;
}

struct Method {
  const char* name;
  const char* attributes;
  double bound;
};
constexpr Method accurate[] = {{"radau", "method=\"radau\" tolerance=\"1e-8\"", 1e-8},
                               {"ida", "method=\"ida\" tolerance=\"1e-8\"", 1e-6}};

// --- drag ---

// The fall of models/terminal_velocity.xml over its whole course, and how its error goes with the step.
TEST(Drag, FallIsTheHyperbolicTangent) {
  const double g = 9.81, vt = std::sqrt(2 * g / (0.5 * 1000 * 0.47 * 9e-3));
  const auto error = [&](const char* step, double b) {
    const Scene scene = model_scene("terminal_velocity", {{"step", step}});
    const History h = run_to_table(scene);
    EXPECT_TRUE(h.report.complete());
    double worst = 0.0;
    for (std::size_t i = 0; i < h.table.rows(); ++i) {
      const double t = h.table["time"][i], v = vt / std::sqrt(b);
      worst =
          std::max(worst, std::abs(h.table["ball.velocity.3"][i] + v * std::tanh(g * t / v)) / vt);
    }
    return worst;
  };
  const double steps[] = {8e-3, 4e-3, 2e-3};
  const double errors[] = {error("8e-3", 1), error("4e-3", 1), error("2e-3", 1)};
  EXPECT_LT(errors[2], 1e-5);
  for (const double order : orders(steps, errors)) EXPECT_NEAR(order, 2.0, 0.1);
  EXPECT_GT(error("2e-3", 1.1), 1e-2) << "10 % more drag would pass";
}

constexpr const char* pendulum = R"(
  <body name="rod" at="0 0 0" center="0 0 -0.6" mass="1.5" inertia="0.05 0.05 0.002"/>
  <revolute name="hinge" between="ground rod" axis="0 1 0"/>
  <gravity acceleration="8 0 -5"/>
  <record name="hinge" joint="hinge" quantities="angle rate"/>
  <record name="all" quantities="total_energy work_of_damping"/>)";

// A pendulum with drag at an offset: I theta'' = gravity - b l^3 |theta'| theta'. And the energy that is lost is the
// work of damping.
TEST(Drag, PendulumDecaysAsItsScalarEquation) {
  const double I = 0.05 + 1.5 * 0.36, b = 0.5 * 800 * 0.9 * 4e-3, l = 0.8;
  const auto reference = [&](double k) {
    return integrate<2>({0.0, 0.0}, 4.0, 40000, [&](const std::array<double, 2>& y) {
      // the centre is at 0.6 (-sin, 0, -cos)
      const double moment = -1.5 * 0.6 * (8 * std::cos(y[0]) + 5 * std::sin(y[0]));
      return std::array<double, 2>{y[1], (moment - k * b * l * l * l * std::abs(y[1]) * y[1]) / I};
    });
  };
  const auto want = reference(1.0), mutated = reference(1.1);
  ASSERT_GT(std::abs(mutated[0] - want[0]), 1e-3);
  for (const Method& method : accurate) {
    const History h = run_to_table(scene_of(
        std::string(pendulum) + R"(<drag at="rod" density="800" area="4e-3" coefficient="0.9"
        offset="0 0 -0.8"/><transient duration="4" output="steps" )" +
        method.attributes + "/>"));
    ASSERT_TRUE(h.report.complete()) << h.report.failure;
    EXPECT_LT(std::abs(h.table["hinge.angle"].back() - want[0]), method.bound) << method.name;
    EXPECT_LT(std::abs(h.table["hinge.rate"].back() - want[1]), 5 * method.bound) << method.name;
    const auto& E = h.table["all.total_energy"];
    const auto& W = h.table["all.work_of_damping"];
    double worst = 0.0;
    for (std::size_t i = 0; i < E.size(); ++i)
      worst = std::max(worst, std::abs(E[i] - W[i] - E[0]));
    EXPECT_LT(W.back(), -3.0);
    EXPECT_LT(worst, 1e-6 * std::abs(W.back())) << method.name;
    EXPECT_EQ(h.report.certificate.verdict(), Verdict::pass);
  }
}

// A body that a flow takes along from rest: m v' = b (U - v)^2, so U - v = U/(1 + b U t/m); the flow gives it its
// energy, which is booked in damping.
TEST(Drag, FlowTakesABodyAlong) {
  const double U = 3.0, b = 0.5 * 1000 * 1.1 * 0.02, m = 40.0;
  for (const Method& method : accurate) {
    const History h =
        run_to_table(scene_of(std::string(R"(<body name="b" at="0 0 0" mass="40" inertia="1 1 1"/>
        <drag at="b" density="1000" area="0.02" coefficient="1.1" flow="0 3 0"/>
        <record name="b" at="b" quantities="velocity"/>
        <record name="all" quantities="kinetic_energy work_of_damping linear_momentum"/>
        <transient duration="5" )") +
                              method.attributes + "/>"));
    ASSERT_TRUE(h.report.complete()) << h.report.failure;
    double worst = 0.0, balance = 0.0;
    for (std::size_t i = 0; i < h.table.rows(); ++i) {
      const double t = h.table["time"][i];
      worst = std::max(worst, std::abs(h.table["b.velocity.2"][i] - U + U / (1 + b * U * t / m)));
      balance = std::max(
          balance, std::abs(h.table["all.kinetic_energy"][i] - h.table["all.work_of_damping"][i]));
    }
    EXPECT_LT(worst, 10 * method.bound) << method.name;
    EXPECT_LT(balance, 1e-2) << method.name;  // of 118 J
    EXPECT_GT(h.table["all.work_of_damping"].back(), 100.0);
    EXPECT_EQ(h.report.certificate.verdict(), Verdict::pass);
  }
}

constexpr const char* oblique_pipe = R"(
  <section name="s"><stiffness EA="1e11" GA2="1e11" GA3="1e11" GJ="1e11" EI2="1e11" EI3="1e11"/></section>
  <beam name="b" section="s" from="0 0 0" to="3*cos(0.7) 3*sin(0.7) 0" normal="0 0 1" elements="2"/>
  <fixed name="foot" between="ground b.start"/>
  <record name="foot" joint="foot" quantities="reaction_force reaction_moment"/>
  <static/>)";

// The independence principle on an oblique pipe that does not bend, of which a part is in the flow.
TEST(Drag, ForceOfAFlowOnAnObliquePipe) {
  const History h = run_to_table(
      scene_of(std::string(oblique_pipe) +
               R"(<drag beam="b" from="1/3" density="1025" diameter="0.1" normal_coefficient="1.2"
      tangential_coefficient="0.05" flow="2 0 0"/>)"));
  ASSERT_TRUE(h.report.complete()) << h.report.failure;
  const double across = 0.5 * 1025 * 1.2 * 0.1, along = 0.5 * 1025 * 0.05 * pi * 0.1;
  const double c = std::cos(0.7), s = std::sin(0.7);
  const double N = 2.0 * along * 4 * c * c, Q = 2.0 * across * 4 * s * s;  // 2 m of it
  // the joint holds b against them; reactions in its own axes, the inertial ones
  EXPECT_NEAR(h.table["foot.reaction_force.1"].back(), -(N * c + Q * s), 1e-6 * Q);
  EXPECT_NEAR(h.table["foot.reaction_force.2"].back(), -(N * s - Q * c), 1e-6 * Q);
  EXPECT_NEAR(h.table["foot.reaction_moment.3"].back(), 2.0 * Q, 1e-6 * Q);
  EXPECT_GT(std::abs(0.1 * (N * s - Q * c)), 1e-3 * Q);
}

// In statics the force of a flow is a load: Newton's iterations, KINSOL's and a path of equilibria end at one shape.
TEST(Drag, FlowIsALoadOfStaticsAndPaths) {
  const std::string pipe = R"(
      <section name="s"><stiffness EA="1e5" GA2="4e4" GA3="4e4" GJ="30" EI2="40" EI3="40"/></section>
      <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2"/>
      <fixed name="foot" between="ground b.start"/>
      <drag beam="b" density="1000" diameter="0.03" normal_coefficient="1.1"
            tangential_coefficient="0.02" flow="1 0 3"/>
      <drag at="b.end" density="1000" area="3e-3" coefficient="1.2" offset="0 0.1 0" flow="1 0 3"/>
      <record name="tip" at="b.end" quantities="displacement rotation"/>)";
  const auto end = [&](const std::string& analysis) {
    const History h = run_to_table(scene_of(pipe + analysis));
    EXPECT_TRUE(h.report.complete()) << h.report.failure;
    Vec3 u;
    for (Index i = 0; i < 3; ++i)
      u(i) = h.table["tip.displacement." + std::to_string(i + 1)].back();
    return u;
  };
  const Vec3 want = end("<static/>");
  EXPECT_GT(want.norm(), 0.3);
  EXPECT_LT((end("<static solver=\"kinsol\"/>") - want).norm(), 1e-10);
  const std::string to_the_end = "<path><stop quantity=\"load_factor\" value=\"1\"/></path>";
  EXPECT_LT((end(to_the_end) - want).norm(), 1e-9);
  EXPECT_FALSE(has_potential(scene_of(pipe + to_the_end)));
}

// A fluid at rest drags nothing in statics: no term, and no rates.
TEST(Drag, IsAbsentFromStaticsWithoutFlow) {
  const Scene scene = scene_of(std::string(oblique_pipe) +
                               R"(<drag beam="b" density="1025" diameter="0.1"
      normal_coefficient="1.2" tangential_coefficient="0.05"/>)");
  Scene without = scene;
  without.drags.clear();
  const Model a = compile(scene), b = compile(without);
  EXPECT_EQ(a.system->batches().size(), b.system->batches().size());
  EXPECT_EQ(a.system->signals().size(), b.system->signals().size());
  EXPECT_TRUE(a.initial.V.empty());
  EXPECT_TRUE(has_potential(scene));
  const Explanation e = explain_model(scene, a);
  const auto said = [&](const std::string& what) {
    return std::any_of(e.absent.begin(), e.absent.end(),
                       [&](const Absence& x) { return x.what == what; });
  };
  EXPECT_TRUE(said("drag of a fluid at rest"));
  EXPECT_FALSE(said("drag of a fluid"));
}

// --- added mass ---

constexpr const char* swinging = R"(
  <body name="rod" at="0 0 -0.6" mass="1.5" inertia="0.05 0.05 0.002"/>
  <revolute name="hinge" between="ground rod" at="0 0 0" axis="0 1 0"/>
  <gravity acceleration="8 0 -5"/>
  <record name="hinge" joint="hinge" quantities="angle rate"/>)";

// A pendulum in water swings slower, by sqrt of all inertia over that of the masses; its weight stays.
TEST(AddedMass, PendulumHasMoreInertiaAndNoMoreWeight) {
  const auto reference = [&](double added) {
    const double I = 0.05 + 0.01 + (1.5 + added) * 0.36;
    return integrate<2>({0.0, 0.0}, 3.0, 30000, [&](const std::array<double, 2>& y) {
      return std::array<double, 2>{y[1],
                                   -1.5 * 0.6 * (8 * std::cos(y[0]) + 5 * std::sin(y[0])) / I};
    });
  };
  const auto want = reference(0.9), mutated = reference(0.99);
  ASSERT_GT(std::abs(mutated[0] - want[0]), 1e-2);
  for (const Method& method : accurate) {
    const History h = run_to_table(
        scene_of(std::string(swinging) +
                 R"(<added_mass at="rod" matrix="0.9 0.2 0.9 0 0.01 0"/><transient duration="3" )" +
                 method.attributes + "/>"));
    ASSERT_TRUE(h.report.complete()) << h.report.failure;
    EXPECT_LT(std::abs(h.table["hinge.angle"].back() - want[0]), method.bound) << method.name;
    EXPECT_LT(std::abs(h.table["hinge.rate"].back() - want[1]), 5 * method.bound) << method.name;
    EXPECT_EQ(h.report.certificate.verdict(), Verdict::pass);
  }
}

// It costs nothing beside a mass: the same batches of the same size, and the mass of the scene is not changed.
TEST(AddedMass, IsNoTermOfItsOwn) {
  const Scene scene = model_scene("submerged_beam");
  Scene without = scene;
  without.added_masses.clear();
  const Model a = compile(scene), b = compile(without);
  ASSERT_EQ(a.system->batches().size(), b.system->batches().size());
  for (std::size_t i = 0; i < a.system->batches().size(); ++i) {
    EXPECT_EQ(a.system->batches()[i]->type(), b.system->batches()[i]->type());
    EXPECT_EQ(a.system->batches()[i]->bytes(), b.system->batches()[i]->bytes());
  }
  EXPECT_EQ(a.mass, b.mass);
  EXPECT_NEAR(a.mass, 300.0, 1e-9);
  EXPECT_EQ(check_model(scene, a).mass, a.mass);
}

// Six numbers are the diagonal, 21 the upper triangle row by row.
TEST(AddedMass, MatrixIsReadByRows) {
  const auto matrix = [](const std::string& numbers) {
    return *scene_of("<added_mass at=\"b\" matrix=\"" + numbers + "\"/>").added_masses[0].matrix;
  };
  Mat6 want = (Vec6() << 1, 2, 3, 4, 5, 6).finished().asDiagonal();
  EXPECT_EQ(matrix("1 2 3 4 5 6"), want);
  for (Index i = 0, n = 1; i < 6; ++i)
    for (Index j = i; j < 6; ++j, ++n) want(i, j) = want(j, i) = static_cast<double>(n);
  EXPECT_EQ(matrix("1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21"), want);
}

// Kirchhoff's equations of a body in a fluid at rest, p' = p x w, L' = L x w + p x v, integrated on their own;
// the impulse is kept, by all methods; a matrix that couples as well.
TEST(AddedMass, BodyTumblesAsKirchhoffSays) {
  Mat6 A = Mat6::Zero();
  A.diagonal() << 0.4, 2.1, 1.3, 0.02, 0.05, 0.3;
  A(0, 4) = A(4, 0) = 0.1;
  A(1, 5) = A(5, 1) = 0.15;
  const auto reference = [&](double k) {
    Mat6 M = k * A;
    M.diagonal() += (Vec6() << 1.2, 1.2, 1.2, 0.1, 0.2, 0.25).finished();
    const Mat6 inverse = dense::inverse(M);
    std::array<double, 6> y{};
    Eigen::Map<Vec6>(y.data()) = M * (Vec6() << 1.0, 0.4, -0.2, 0.5, 0.3, 2.0).finished();
    y = integrate<6>(y, 5.0, 20000, [&](const std::array<double, 6>& z) {
      const Vec6 P = Eigen::Map<const Vec6>(z.data()), V = inverse * P;
      std::array<double, 6> rate{};
      Eigen::Map<Vec6>(rate.data()) = six<double>(
          linear(P).cross(angular(V)), angular(P).cross(angular(V)) + linear(P).cross(linear(V)));
      return rate;
    });
    return Vec6(inverse * Eigen::Map<const Vec6>(y.data()));
  };
  const Vec6 want = reference(1.0);
  ASSERT_GT((reference(1.1) - want).norm(), 1e-2);
  Scene scene = scene_of(R"(<body name="b" mass="1.2" inertia="0.1 0.2 0.25" velocity="1 0.4 -0.2"
      angular_velocity="0.5 0.3 2"/><added_mass at="b" matrix="1 1 1 1 1 1"/>
      <record name="b" at="b" quantities="velocity_local angular_velocity_local"/>
      <record name="all" quantities="linear_momentum angular_momentum total_energy"/>
      <transient duration="5" tolerance="1e-9" method="radau"/>)");
  scene.added_masses[0].matrix = A;
  const auto look = [&](const char* name, double bound, double kept) {
    const History h = run_to_table(scene);
    ASSERT_TRUE(h.report.complete()) << h.report.failure;
    Vec6 V, drift, size;
    double energy = 0.0;
    for (Index i = 0; i < 6; ++i) {
      const std::string n = "." + std::to_string(i % 3 + 1);
      V(i) = h.table[(i < 3 ? "b.velocity_local" : "b.angular_velocity_local") + n].back();
      const auto& p = h.table[(i < 3 ? "all.linear_momentum" : "all.angular_momentum") + n];
      drift(i) = p.back() - p.front();
      size(i) = p.front();
    }
    energy = h.table["all.total_energy"].back() / h.table["all.total_energy"].front() - 1.0;
    EXPECT_LT((V - want).norm(), bound) << name;
    EXPECT_LT(drift.norm(), kept * size.norm()) << name;
    EXPECT_LT(std::abs(energy), bound) << name;
    EXPECT_EQ(h.report.certificate.verdict(), Verdict::pass) << name;
  };
  look("radau", 1e-8, 1e-8);
  scene.transient->method = TimeMethod::ida;
  look("ida", 1e-6, 1e-7);
  scene.transient->method = TimeMethod::generalized_alpha;
  scene.transient->tolerance.reset();
  scene.transient->step = 5e-4;
  scene.transient->rho_infinity = 1.0;
  look("generalized_alpha", 2e-5, 1e-5);
  scene.transient->balance = Balance::momentum;
  scene.transient->newton_tolerance = 1e-13;
  scene.transient->step = 5e-3;
  look("generalized_alpha, momenta", 2e-3, 1e-11);
}

// --- all of them ---

// A flexible arm that swings in a current, with added mass, on a base that shakes: generalized-alpha with both balances,
// Radau and IDA meet, and what the arm does is the same in another place, in other units, and written in another
// order.
constexpr const char* arm = R"xml(
  <section name="s"><stiffness EA="1e5" GA2="4e4" GA3="4e4" GJ="30" EI2="40" EI3="40"/>
    <mass per_length="1.5" inertia="2e-3 1e-3 1e-3"/></section>
  <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2" order="3"/>
  <revolute name="hinge" between="ground b.start" axis="0 1 0"/>
  <body name="tip" attached_to="b.end" mass="0.3" inertia="1e-3 1e-3 1e-3"/>
  <drag name="water" beam="b" from="0.25" density="1000" diameter="0.03" normal_coefficient="1.1"
        tangential_coefficient="0.02" flow="0.5 0.3*sin(3*t) 0"/>
  <drag name="plate" at="tip" density="1000" area="3e-3" coefficient="1.2" offset="0.05 0 0"/>
  <added_mass name="around" beam="b" to="0.75" density="1000" diameter="0.03" coefficient="1"/>
  <added_mass name="shoe" at="tip" matrix="0.1 0.2 0.3 1e-3 2e-3 3e-3"/>
  <base_motion velocity="0.2*sin(4*t) 0 0.1*(1-cos(5*t))"/>
  <gravity acceleration="0 0 -9.81"/>
  <record name="tip" at="tip" quantities="displacement rotation"/>
  <record name="all" quantities="total_energy work_of_loads work_of_damping"/>)xml";

TEST(Fluid, MethodsAgree) {
  const auto end = [](const std::string& attributes) {
    const History h = run_to_table(
        scene_of(std::string(arm) + "<transient duration=\"0.5\" " + attributes + "/>"));
    EXPECT_TRUE(h.report.complete()) << h.report.failure;
    EXPECT_EQ(h.report.certificate.verdict(), Verdict::pass) << attributes;
    EXPECT_LT(std::abs(h.report.dissipated()), 1e-5 * h.report.energy_moved()) << attributes;
    return Vec3(h.table["tip.displacement.1"].back(), h.table["tip.displacement.2"].back(),
                h.table["tip.displacement.3"].back());
  };
  const Vec3 want = end(R"(method="radau" tolerance="1e-5")");
  EXPECT_GT(want.norm(), 0.1);
  EXPECT_LT((end(R"(method="ida" tolerance="1e-5")") - want).norm(), 1e-6);
  EXPECT_LT((end(R"(step="5e-4" rho_infinity="0.9")") - want).norm(), 1e-5);
  EXPECT_LT((end(R"(step="5e-4" rho_infinity="0.9" balance="momentum")") - want).norm(), 1e-5);
}

TEST(Fluid, SceneIsTheSameInOtherWords) {
  const Scene scene = scene_of(std::string(arm) +
                               R"(<transient duration="0.4" step="2e-3" rho_infinity="0.8"
                               newton_tolerance="1e-11"/>)");
  const auto end = [](const Scene& s) {
    const History h = run_to_table(s);
    EXPECT_TRUE(h.report.complete()) << h.report.failure;
    Vec3 u;
    for (Index i = 0; i < 3; ++i)
      u(i) = h.table["tip.displacement." + std::to_string(i + 1)].back();
    return u;
  };
  const Vec3 want = end(scene);
  const RigidMotion motion = random_motion(3, 2.0);
  EXPECT_LT((motion.R.transpose() * end(moved(scene, motion).scene) - want).norm(), 1e-11);
  EXPECT_LT((end(rescaled(scene, {1e3, 1e-3, 1.0}).scene) / 1e3 - want).norm(), 1e-11);
  EXPECT_LT((end(rescaled(scene, {0.5, 7.0, 20.0}).scene) / 0.5 - want).norm(), 1e-11);
  EXPECT_LT((end(reordered(scene, 5)) - want).norm(), 1e-11);
  EXPECT_GT((end(perturbed(scene, 1e-3, 5)) - want).norm(), 1e-6);
}

// What explain and check say of it.
TEST(Fluid, IsNamedAndCounted) {
  const Scene scene = scene_of(std::string(arm) + "<transient duration=\"1\" step=\"1e-3\"/>");
  const Model model = compile(scene);
  const std::string check = to_text(check_model(scene, model)),
                    explain = to_text(explain_model(scene, model));
  EXPECT_NE(check.find("2 drags, 2 added"), std::string::npos) << check;
  for (const char* what : {"drag of beams in a flow", "drag of bodies", "base motion",
                           "drag of a fluid: ", "added mass of a fluid: ", "motion of the base"})
    EXPECT_NE(explain.find(what), std::string::npos) << what << "\n" << explain;
}

}  // namespace
}  // namespace mbd::test::test_fluid
