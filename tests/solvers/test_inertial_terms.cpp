// A moving base, and inertia without its gyroscopic moment, against closed forms and against the same motion said
// otherwise.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "libmbd/run/describe.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_inertial_terms {
namespace {

Scene scene_of(const std::string& contents) {
  return read_model_text("<mbd name=\"test\">" + contents + "</mbd>", "test.xml");
}

Vec3 vector(const Table& table, const std::string& name, std::size_t row) {
  return {table[name + ".1"].at(row), table[name + ".2"].at(row), table[name + ".3"].at(row)};
}

// Largest distance between two runs in a quantity of three components, over all rows.
double distance(const Table& a, const Table& b, const std::string& name) {
  double worst = a.rows() == b.rows() ? 0.0 : INFINITY;
  for (std::size_t i = 0; i < std::min(a.rows(), b.rows()); ++i)
    worst = std::max(worst, (vector(a, name, i) - vector(b, name, i)).norm());
  return worst;
}

std::string message_of(const std::string& contents) {
  try {
    compile(scene_of(contents));
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

// --- base motion ---

constexpr const char* mast = R"(
  <section name="s"><stiffness EA="1e5" GA2="4e4" GA3="4e4" GJ="30" EI2="40" EI3="40"/>
    <mass per_length="1.5" inertia="2e-3 1e-3 1e-3" center="0.01 0.02"/></section>
  <beam name="b" section="s" from="0 0 0" to="0 0 1" normal="1 0 0" elements="1" order="4"/>
  <body name="tip" attached_to="b.end" mass="0.3" inertia="1e-3 1e-3 1e-3" center="0.1 0 0"/>
  <gravity acceleration="0 0 -9.81"/>
  <record name="tip" at="tip" quantities="displacement rotation"/>
  <record name="foot" joint="foot" quantities="reaction_force"/>
  <record name="all" quantities="total_energy work_of_loads"/>)";
const std::string held = std::string(mast) + R"(<fixed name="foot" between="ground b.start"/>)";
const std::string transient = R"(<transient duration="0.4" tolerance="1e-6" method="radau"/>)";

// The same mast on a support that <motion> drives: what is relative is the same, and so are the reactions. And laws of
// displacement, velocity and acceleration are one.
TEST(BaseMotion, IsAMovingSupportSeenFromIt) {
  const History driven = run_to_table(scene_of(
      std::string(mast) +
      R"xml(<motion name="foot" of="b.start" displacement="0.05*(1-cos(9*t)) 0 0.02*(1-cos(12*t))"
      rotation="0 0 0"/>)xml" +
      transient));
  ASSERT_TRUE(driven.report.complete()) << driven.report.failure;
  const auto run = [&](const std::string& law) {
    const History h = run_to_table(scene_of(held + "<base_motion " + law + "/>" + transient));
    EXPECT_TRUE(h.report.complete()) << h.report.failure;
    EXPECT_EQ(h.report.certificate.verdict(), Verdict::pass);
    EXPECT_LT(std::abs(h.report.dissipated()), 1e-7 * h.report.energy_moved());
    return h.table;
  };
  const auto error = [&](const Table& table, double scale) {
    double u = 0.0, f = 0.0, size = 0.0;
    for (std::size_t i = 0; i < table.rows(); ++i) {
      const double t = table["time"][i];
      const Vec3 d(0.05 * (1 - std::cos(9 * t)), 0, 0.02 * (1 - std::cos(12 * t)));
      u = std::max(u, (vector(driven.table, "tip.displacement", i) - scale * d -
                       vector(table, "tip.displacement", i))
                          .norm());
      size = std::max(size, vector(table, "foot.reaction_force", i).norm());
      if (i > 0)
        f = std::max(f, (vector(driven.table, "foot.reaction_force", i) -
                         vector(table, "foot.reaction_force", i))
                            .norm());
    }
    return std::pair(u, f / size);
  };
  const Table table = run(R"xml(displacement="0.05*(1-cos(9*t)) 0 0.02*(1-cos(12*t))")xml");
  const auto [u, f] = error(table, 1.0);
  EXPECT_LT(u, 1e-9);
  EXPECT_LT(f, 1e-4);
  EXPECT_GT(error(table, 1.1).first, 1e-3);
  for (const char* law : {R"xml(velocity="0.45*sin(9*t) 0 0.24*sin(12*t)")xml",
                          R"xml(acceleration="4.05*cos(9*t) 0 2.88*cos(12*t)")xml"}) {
    EXPECT_LT(distance(run(law), table, "tip.displacement"), 1e-10) << law;
  }
  EXPECT_GT(distance(run(R"xml(acceleration="4.455*cos(9*t) 0 2.88*cos(12*t)")xml"), table,
                     "tip.displacement"),
            1e-4)
      << "10 % more would pass";
}

// Constant acceleration is gravity: in statics, raised in load steps, and in a transient after it.
TEST(BaseMotion, OfConstantAccelerationIsGravity) {
  const std::string rest = "<static steps=\"3\"/>" + transient;
  const History base =
      run_to_table(scene_of(held + R"(<base_motion acceleration="0 3 -2"/>)" + rest));
  Scene scene = scene_of(held + rest);
  scene.gravity->acceleration = Vec3(0, -3, -7.81);
  const History gravity = run_to_table(scene);
  ASSERT_TRUE(base.report.complete()) << base.report.failure;
  EXPECT_GT(vector(base.table, "tip.displacement", 0).norm(), 1e-2);
  EXPECT_LT(distance(base.table, gravity.table, "tip.displacement"), 1e-9);
  // no potential energy, but work of loads
  EXPECT_GT(base.report.batches.size(), gravity.report.batches.size());

  // One law that is not constant, at its value of t = 0, scaled with the load.
  Scene path = scene_of(held + R"(<base_motion acceleration="0 3*cos(t) -2"/><static steps="4"/>)");
  const History stepped = run_to_table(path);
  ASSERT_TRUE(stepped.report.complete());
  EXPECT_LT((vector(stepped.table, "tip.displacement", stepped.table.rows() - 1) -
             vector(gravity.table, "tip.displacement", 0))
                .norm(),
            1e-9);
}

TEST(BaseMotion, MistakesAreSaid) {
  const std::string some = held + R"(<transient duration="2" step="1e-3"/>)";
  EXPECT_NE(message_of(some + "\n<base_motion velocity=\"1>t?0:1 0 0\"/>")
                .find("test.xml:10: base_motion: velocity 1 \"1>t?0:1\": it jumps by 1 at t = 1 s"),
            std::string::npos)
      << message_of(some + "\n<base_motion velocity=\"1>t?0:1 0 0\"/>");
  EXPECT_NE(message_of(some + "<base_motion displacement=\"0 1>t?t:1 0\"/>").find("its rate jumps"),
            std::string::npos);
  EXPECT_NE(message_of(some + "<base_motion displacement=\"0 0 sqrt(t)\"/>").find("its rate jumps"),
            std::string::npos);
  EXPECT_NE(message_of(some + "<base_motion displacement=\"0 0 t^1.5\"/>").find("finite"),
            std::string::npos);
  // a jump of the acceleration is none: a new start
  EXPECT_EQ(message_of(some + "<base_motion acceleration=\"1>t?0:1 0 0\"/>"), "no error");
  const Model model = compile(scene_of(some + "<base_motion velocity=\"1>t?0:t-1 0 0\"/>"));
  ASSERT_FALSE(model.system->breakpoints().empty());
  EXPECT_TRUE(model.system->breakpoints().front().restart);
}

// A base that does not accelerate has no term.
TEST(BaseMotion, AtRestIsAbsent) {
  const Model none = compile(scene_of(held + transient));
  for (const char* law :
       {R"(acceleration="0 0 0")", R"(velocity="1 2 3")", R"(displacement="1 0 0")"}) {
    const Scene scene = scene_of(held + "<base_motion " + law + "/>" + transient);
    const Model model = compile(scene);
    EXPECT_EQ(model.system->batches().size(), none.system->batches().size());
    EXPECT_EQ(model.system->signals().size(), none.system->signals().size());
    EXPECT_NE(to_text(explain_model(scene, model)).find("its acceleration is zero"),
              std::string::npos);
  }
}

// --- inertia without the gyroscopic moment ---

// A heavy symmetric top, inertia A A C about its centre. Without the moment, A stands in the place of C: to the last
// digits the motion of a top with a sphere's J. The moment is what precesses it: steadily, with a fast spin s,
// at m g l/(C s), and without it at m g l/(A s).
Scene top(double A, double C, double spin, double turn, InertiaTerms terms) {
  Scene scene = scene_of(R"(<body name="top" at="0.5 0 0" mass="2" inertia="1 1 1"/>
      <spherical name="O" between="ground top" at="0 0 0"/>
      <gravity acceleration="0 0 -9.81"/>
      <record name="top" at="top" quantities="position angular_velocity_local"/>
      <record name="all" quantities="total_energy angular_momentum linear_momentum"/>
      <transient duration="1" method="radau" tolerance="1e-9"/>)");
  BodyScene& body = scene.bodies[0];
  body.inertia = Vec3(C, A, A).asDiagonal();
  body.angular_velocity = Vec3(spin, 0, turn);
  body.velocity = Vec3(0, 0.5 * turn, 0);
  scene.transient->inertia = terms;
  return scene;
}

TEST(NoGyroscopic, OfASymmetricTopIsThatOfASphere) {
  const History without = run_to_table(top(0.03, 0.05, 60.0, 1.0, InertiaTerms::no_gyroscopic));
  const History sphere = run_to_table(top(0.03, 0.03, 60.0, 1.0, InertiaTerms::full));
  const History full = run_to_table(top(0.03, 0.05, 60.0, 1.0, InertiaTerms::full));
  ASSERT_TRUE(without.report.complete() && sphere.report.complete() && full.report.complete());
  EXPECT_LT(distance(without.table, sphere.table, "top.position"), 1e-11);
  EXPECT_GT(distance(without.table, full.table, "top.position"), 0.1);
  // Energy is kept; the certificate finds nothing wrong in either.
  const auto& E = without.table["all.total_energy"];
  EXPECT_LT(std::abs(E.back() - E.front()), 1e-8 * E.front());
  EXPECT_EQ(without.report.certificate.verdict(), Verdict::pass);
}

TEST(NoGyroscopic, PrecessionIsThatOfTheTransverseInertia) {
  const double A = 0.03, C = 0.05, s = 300.0, load = 2 * 9.81 * 0.5;
  // Axis horizontal: steady precession is exact, (J s) W = m g l, J the inertia in the gyroscopic moment.
  for (const auto& [terms, J] :
       {std::pair{InertiaTerms::full, C}, std::pair{InertiaTerms::no_gyroscopic, A}}) {
    const double W = load / (J * s);
    const History h = run_to_table(top(A, C, s, W, terms));
    ASSERT_TRUE(h.report.complete()) << h.report.failure;
    const Vec3 x = vector(h.table, "top.position", h.table.rows() - 1);
    EXPECT_LT((x - 0.5 * Vec3(std::cos(W), std::sin(W), 0)).norm(), 1e-9);
    EXPECT_GT(std::abs(std::sin(1.1 * W) - std::sin(W)), 1e-3);
  }
}

// For a sphere both are one, whatever moves it.
TEST(NoGyroscopic, IsTheSameForASphere) {
  const History a = run_to_table(top(0.03, 0.03, 60.0, 1.0, InertiaTerms::full));
  const History b = run_to_table(top(0.03, 0.03, 60.0, 1.0, InertiaTerms::no_gyroscopic));
  EXPECT_LT(distance(a.table, b.table, "top.position"), 1e-11);
}

// A free body keeps its angular velocity in its own axes: no tumbling. Energy and linear momentum are kept, angular
// momentum is not, and the certificate does not take that for an error.
TEST(NoGyroscopic, FreeBodyDoesNotTumble) {
  Scene scene = scene_of(R"(<body name="b" mass="2" inertia="1 2 3" velocity="1 0 0"
      center="0.1 0.2 0.3" angular_velocity="0.1 3 0.01"/>
      <record name="b" at="b" quantities="angular_velocity_local"/>
      <record name="all" quantities="total_energy linear_momentum angular_momentum"/>
      <transient duration="10" step="5e-3" rho_infinity="1" inertia="no_gyroscopic"/>)");
  for (const TimeMethod method :
       {TimeMethod::generalized_alpha, TimeMethod::radau, TimeMethod::ida}) {
    if (method != TimeMethod::generalized_alpha) {
      scene.transient->rho_infinity.reset();
      scene.transient->step.reset();
      scene.transient->tolerance = 1e-7;
    }
    scene.transient->method = method;
    TableMaker maker(1);
    const RunReport report =
        run(scene, {.output = {}, .observers = {&maker}, .certify = true, .progress = {}});
    ASSERT_TRUE(report.complete()) << report.failure;
    const std::size_t last = maker.table.rows() - 1;
    EXPECT_LT((vector(maker.table, "b.angular_velocity_local", last) - Vec3(0.1, 3, 0.01)).norm(),
              1e-12);
    const auto changed = [&](const std::string& name) {
      return (vector(maker.table, name, last) - vector(maker.table, name, 0)).norm() /
             vector(maker.table, name, 0).norm();
    };
    EXPECT_LT(changed("all.linear_momentum"), 1e-3);
    EXPECT_GT(changed("all.angular_momentum"), 1e-2);
    EXPECT_LT(std::abs(report.dissipated()), 1e-4 * report.energy_start.total());
    EXPECT_EQ(report.certificate.verdict(), Verdict::pass);
    for (const Check& check : report.certificate.checks) EXPECT_NE(check.name, "angular momentum");
  }
  // Fully, it tumbles; and its momentum is judged.
  scene.transient->inertia = InertiaTerms::full;
  const History full = run_to_table(scene);
  EXPECT_GT(
      (vector(full.table, "b.angular_velocity_local", full.table.rows() - 1) - Vec3(0.1, 3, 0.01))
          .norm(),
      0.1);
  bool judged = false;
  for (const Check& check : full.report.certificate.checks)
    judged = judged || check.name == "angular momentum";
  EXPECT_TRUE(judged);
}

TEST(NoGyroscopic, IsNotForABalanceOfMomenta) {
  const std::string body = R"(<body name="b" mass="2" inertia="1 2 3"/>)";
  EXPECT_NE(message_of(body + "\n<transient duration=\"1\" step=\"0.1\" balance=\"momentum\" "
                              "inertia=\"no_gyroscopic\"/>")
                .find("test.xml:2: transient: balance=\"momentum\" balances the whole of inertia"),
            std::string::npos);
  const Scene scene =
      scene_of(body + R"(<transient duration="1" step="0.1" inertia="no_gyroscopic"/>)");
  EXPECT_NE(to_text(explain_model(scene, compile(scene))).find("gyroscopic moments: <transient>"),
            std::string::npos);
}

}  // namespace
}  // namespace mbd::test::test_inertial_terms
