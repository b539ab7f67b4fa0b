// Load stepping: solvers that agree, the line search, prescribed motions, failures that say why.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "solvers/linear/klu_solver.hpp"
#include "solvers/statics/statics.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_statics {
namespace {

using std::numbers::pi;

struct Solved {
  Model model;
  State state;
  StaticReport report;
};
Solved solve(const Scene& scene, StaticOptions options) {
  Solved s{compile(scene), {}, {}};
  s.state = s.model.initial;
  options.newton.tolerance = 1e-12;
  const std::unique_ptr<LinearSolver> solver = make_klu_solver();
  s.report = solve_statics(*s.model.system, *solver, options, s.state);
  return s;
}

// Largest difference of positions over the scene's size, and of rotations [rad].
double distance(const Solved& a, const Solved& b) {
  double largest = 0.0;
  for (std::size_t n = 0; n < a.state.pose.size(); ++n)
    largest = std::max(
        {largest, (a.state.pose[n].r - b.state.pose[n].r).norm() / a.model.system->length_scale(),
         a.state.pose[n].p.angularDistance(b.state.pose[n].p)});
  return largest;
}

TEST(StaticSolversSlow, KinsolAndNewtonFindTheSame) {
  for (const char* name : {"bend45", "portal_frame", "swept_cantilever", "four_bar_static"}) {
    const Scene scene = model_scene(name);
    const Solved newton = solve(scene, {.steps = 4, .newton = {}});
    const Solved kinsol = solve(scene, {.steps = 4, .newton = {}, .solver = StaticSolver::kinsol});
    ASSERT_TRUE(newton.report.converged) << name << ": " << newton.report.failure;
    ASSERT_TRUE(kinsol.report.converged) << name << ": " << kinsol.report.failure;
    EXPECT_LT(distance(newton, kinsol), 1e-11) << name;
    EXPECT_LT((newton.state.lambda - kinsol.state.lambda).cwiseAbs().maxCoeff(),
              1e-8 * newton.state.lambda.cwiseAbs().maxCoeff())
        << name;
    // KINSOL's own iterations stand in the report, beside the last one of Newton's.
    EXPECT_GT(kinsol.report.counters.iterations, kinsol.report.counters.steps);
  }
}

// The whole load at once, which Newton's method in displacements did not reach without a line search: the mixed one does.
TEST(LineSearch, IsNotNeededForTheWholeLoad) {
  const Scene scene = model_scene("bend45");
  const Solved with = solve(scene, {.steps = 1, .newton = {}});
  StaticOptions without{.steps = 1, .newton = {}};
  without.newton.line_search = false;
  const Solved plain = solve(scene, without), cut = solve(scene, {.steps = 8, .newton = {}});
  for (const Solved* s : {&with, &plain}) {
    ASSERT_TRUE(s->report.converged);
    EXPECT_EQ(s->report.counters.steps, 1);
    EXPECT_EQ(s->report.searched, 0);
    EXPECT_EQ(s->report.counters.retries, 0);
    EXPECT_LE(s->report.counters.iterations, 12);
    EXPECT_LT(distance(*s, cut), 1e-11);
  }
}

// Where increments lead straight to the solution the search costs nothing.
TEST(LineSearch, IsNotUsedWhereItIsNotNeeded) {
  const Scene scene = model_scene("portal_frame");
  const Solved with = solve(scene, {.steps = 2, .newton = {}});
  StaticOptions without{.steps = 2, .newton = {}};
  without.newton.line_search = false;
  const Solved plain = solve(scene, without);
  EXPECT_EQ(with.report.searched, 0);
  EXPECT_EQ(with.report.counters.iterations, plain.report.counters.iterations);
  EXPECT_EQ(with.report.counters.residuals, plain.report.counters.residuals);
}

constexpr const char* cantilever = R"(<mbd name="cantilever">
  <parameter name="EI" value="100"/><parameter name="size" value="1e-6"/>
  <section name="s"><stiffness EA="1e8" GA2="1e8" GA3="1e8" GJ="80" EI2="EI" EI3="EI"/></section>
  <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="4"/>
  <fixed name="clamp" between="ground b.start"/>
  %s
  <record name="tip" at="b.end" quantities="displacement rotation"/>
  %s
  <static steps="4"/></mbd>)";

Scene cantilever_with(const std::string& what, const std::string& record,
                      const Overrides& overrides = {}) {
  std::string text = cantilever;
  for (const std::string& part : {what, record}) text.replace(text.find("%s"), 2, part);
  return read_model_text(text, "cantilever.xml", overrides);
}

// A prescribed tip displacement grows with the load factor; its force is 3 EI/L^3 of it, while it is small.
TEST(PrescribedMotion, GrowsWithTheLoad) {
  const std::string motion = "<motion name=\"push\" of=\"b.end\" displacement=\"0 0 size\"/>";
  const std::string record = "<record name=\"push\" joint=\"push\" quantities=\"reaction_force\"/>";
  // The other components of a motion are prescribed as well; a cantilever's tip moves along i1 by size^2.
  const History history = run_to_table(cantilever_with(motion, record));
  ASSERT_TRUE(history.report.complete()) << history.report.failure;
  const auto& load = history.table["load_factor"];
  ASSERT_GT(load.size(), 2U);
  for (std::size_t i = 0; i < load.size(); ++i)
    EXPECT_NEAR(history.table["tip.displacement.3"][i], 1e-6 * load[i], 1e-15) << i;
  const double force = std::abs(history.table["push.reaction_force.3"].back());
  EXPECT_NEAR(force, 300.0 * 1e-6, 1e-5 * 300.0 * 1e-6);
  const History stiffer = run_to_table(cantilever_with(motion, record, {{"EI", "110"}}));
  EXPECT_GT(std::abs(stiffer.table["push.reaction_force.3"].back()), 1.09 * force);
}

// A whole turn of the tip about its axis, prescribed: torsion GJ 2 pi/L in each step's share.
TEST(PrescribedMotion, TurnsByMoreThanPi) {
  const History history = run_to_table(
      cantilever_with("<cylindrical name=\"bearing\" between=\"ground b.end\" axis=\"1 0 0\"/>"
                      "<drive joint=\"bearing\" angle=\"2*pi\"/>",
                      "<record name=\"root\" at=\"b.start\" quantities=\"moment\"/>"
                      "<record name=\"bearing\" joint=\"bearing\" quantities=\"angle\"/>"));
  ASSERT_TRUE(history.report.complete()) << history.report.failure;
  const auto& load = history.table["load_factor"];
  for (std::size_t i = 0; i < load.size(); ++i) {
    EXPECT_NEAR(history.table["bearing.angle"][i], 2.0 * pi * load[i], 1e-12);
    EXPECT_NEAR(history.table["root.moment.1"][i], 80.0 * 2.0 * pi * load[i], 1e-9);
  }
}

// A drive turns a beam that nothing else holds, by whole turns and parts of them: in one load step a whole turn is none, and
// the next of less than half a turn goes the other way round. The tip is where a rigid rod's is.
// Mutation: load steps without most_ahead() (angle 0 after one turn, and after four).
TEST(PrescribedMotion, TurnsWhatIsFreeToTurn) {
  for (const std::string linear_solver : {"klu", "block"})
    for (const double turns : {0.3, 0.6, 1.0, 1.5, -1.0, 4.0}) {
      const History history = run_to_table(read_model_text(fmt::format(R"(<mbd name="turn">
            <section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="100"/></section>
            <beam name="b" from="0 0 0" to="1 0 0" section="s" normal="0 0 1" elements="2" order="3"/>
            <revolute name="hinge" between="ground b.start" at="0 0 0" axis="0 1 0"/>
            <drive joint="hinge" angle="2*pi*{}"/>
            <static linear_solver="{}"/>
            <record name="hinge" joint="hinge" quantities="angle"/>
            <record name="tip" at="b.end" quantities="position"/></mbd>)",
                                                                       turns, linear_solver),
                                                           "turn.xml"));
      ASSERT_TRUE(history.report.complete()) << history.report.failure;
      const double angle = 2.0 * pi * turns;
      EXPECT_NEAR(history.table["hinge.angle"].back(), angle, 1e-12) << turns << linear_solver;
      EXPECT_NEAR(history.table["tip.position.1"].back(), std::cos(angle), 1e-12) << turns;
      EXPECT_NEAR(history.table["tip.position.3"].back(), -std::sin(angle), 1e-12) << turns;
    }
}

TEST(StaticStability, IsSaid) {
  const auto notes = [](double P) {
    const std::string load = "<load at=\"b.end\" force=\"" + std::to_string(-P) + " 0 0\"/>";
    return run(cantilever_with(load, ""), {.output = {}, .observers = {}, .progress = {}});
  };
  const double euler = 100.0 * pi * pi / 4.0;  // of a cantilever
  const RunReport below = notes(0.99 * euler), above = notes(1.01 * euler);
  EXPECT_EQ(below.negative_eigenvalues, 0);
  EXPECT_TRUE(below.notes.empty());
  EXPECT_EQ(above.negative_eigenvalues, 2);
  ASSERT_EQ(above.notes.size(), 2U);
  EXPECT_NE(above.notes[0].find("negative eigenvalues 0 -> 2"), std::string::npos)
      << above.notes[0];
  EXPECT_NE(above.notes[1].find("unstable, in 2 ways"), std::string::npos) << above.notes[1];
  // A follower force has no potential.
  const RunReport follower =
      run(cantilever_with("<load at=\"b.end\" follower_force=\"-10 0 0\"/>", ""),
          {.output = {}, .observers = {}, .progress = {}});
  EXPECT_FALSE(follower.negative_eigenvalues);
}

// A column at 1.2 times Euler's load with a force across of q times that: it bends, or it is said that it would not stay where it
// is found. A thousandth of a millionth is no way out: the straight equilibrium is as unstable as without. Mutation: judged for
// q = 0 only.
TEST(StaticStability, AnImperfectionOfABillionthHidesNothing) {
  const double P = 1.2 * 100.0 * pi * pi / 4.0;
  for (const double q : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3})
    for (const int steps : {1, 3, 10}) {
      SCOPED_TRACE(fmt::format("q = {}, {} steps", q, steps));
      Scene scene = cantilever_with(
          fmt::format("<load at=\"b.end\" force=\"{} 0 {}\"/>"
                      "<record name=\"end\" at=\"b.end\" quantities=\"displacement\"/>",
                      -P, q * P),
          "");
      scene.statics->steps = steps;
      const History history = run_to_table(scene);
      ASSERT_TRUE(history.report.complete()) << history.report.failure;
      const bool bent = std::abs(history.table["end.displacement.3"].back()) > 0.5;
      EXPECT_TRUE(bent || q < 1e-6) << history.table["end.displacement.3"].back();
      if (bent) continue;
      EXPECT_GT(history.report.negative_eigenvalues.value_or(0), 0);
      EXPECT_NE(history.report.notes.back().find("the equilibrium is unstable"), std::string::npos);
    }
}

// The deep arch carries no more than P1 (models/arch.xml): load steps end there, and say why.
TEST(UnreachableLoadSlow, KeepsTheLastEquilibriumAndNamesTheReason) {
  Scene scene = model_scene("arch", {{"elements", "6"}});
  scene.path.reset();
  scene.statics = StaticScene{};
  for (const StaticSolver solver : {StaticSolver::newton, StaticSolver::kinsol}) {
    scene.statics->solver = solver;
    const History history = run_to_table(scene);
    EXPECT_FALSE(history.report.complete());
    const double reached = history.table["load_factor"].back();
    EXPECT_NEAR(reached, 0.897289134, 2e-4);
    EXPECT_LT(reached, 0.8973);
    const std::string& failure = history.report.failure;
    EXPECT_NE(failure.find("the structure gives way"), std::string::npos) << failure;
    EXPECT_NE(failure.find("beam 'arch' node"), std::string::npos) << failure;
    EXPECT_NE(failure.find("<path>"), std::string::npos) << failure;
  }
}

Scene hanging(const std::string& more) {
  return read_model_text(R"(<mbd name="m">
    <body name="bob" at="0 0 -2" mass="3" inertia="0.3 0.2 0.1"/>
    <spherical name="ball" between="ground bob" at="0 0 0"/>
    <gravity acceleration="0 0 -9.81"/> <static steps="2"/>)" +
                         more + "</mbd>");
}

// On a ball joint gravity holds two rotations; the spin is neutral, said so, and left alone.
TEST(NeutralMotions, APendulumOnABallJointHangs) {
  const Scene scene = hanging(R"(<load at="bob" force="9 -12 0"/>
      <record name="bob" at="bob" quantities="position"/> <record name="ball" joint="ball" quantities="reaction_force"/>)");
  const Solved s = solve(scene, {.steps = 2, .newton = {}});
  ASSERT_TRUE(s.report.converged) << s.report.failure;
  // Along the sum of its weight and the load, 2 m from the ball.
  const Vec3 force(9, -12, -3 * 9.81);
  EXPECT_LT((s.state.pose[1].r - 2.0 * force.normalized()).norm(), 1e-10);
  ASSERT_EQ(s.report.neutral.size(), 1u);
  EXPECT_EQ(s.report.neutral[0], "body 'bob' turns about its axis 3");
  // The least turn from where it hung: without spin about its own axis, the shortest way there.
  const Vec3 axis = Vec3(0, 0, -1).cross(force).normalized();
  const double angle = std::acos(-force(2) / force.norm());
  const Eigen::AngleAxisd turned(Mat3(s.state.pose[1].R()));
  EXPECT_NEAR(turned.angle(), angle, 1e-6);
  EXPECT_NEAR(std::abs(turned.axis().dot(axis)), 1.0, 1e-6);
  const RunReport report = run(scene);
  ASSERT_TRUE(report.complete()) << report.failure;
  EXPECT_TRUE(std::any_of(report.notes.begin(), report.notes.end(), [](const std::string& note) {
    return note.find("turns about its axis 3") != std::string::npos;
  }));
  EXPECT_EQ(report.negative_eigenvalues.value_or(0), 0);  // stable but for the spin
}

// Two on each other: two spins. On top of its joint it is unstable, spin or not.
TEST(NeutralMotions, AreCountedApartFromStability) {
  const Solved two = solve(hanging(R"(<body name="low" at="0 0 -5" mass="1" inertia="0.1 0.1 0.1"/>
      <spherical name="b2" between="bob low" at="0 0 -3"/> <load at="low" force="1 0 0"/>)"),
                           {.steps = 2, .newton = {}});
  ASSERT_TRUE(two.report.converged) << two.report.failure;
  EXPECT_EQ(two.report.neutral.size(), 2u);
  // Below the joint at 1 m of bob's axis beyond its centre: tan of each link's angle is the force below over the weight.
  const double g = 9.81;
  const Vec3 low = two.state.pose[2].r;
  const double t2 = std::atan2(1.0, 1.0 * g);
  const double t1 = std::atan2(1.0 * 3.0, (3.0 * 2.0 + 1.0 * 3.0) * g);
  EXPECT_NEAR(low(0), 3 * std::sin(t1) + 2 * std::sin(t2), 1e-9);
  EXPECT_NEAR(low(2), -3 * std::cos(t1) - 2 * std::cos(t2), 1e-9);
  Scene standing = hanging("");
  standing.gravity->acceleration *= -1.0;
  const RunReport up = run(standing);
  ASSERT_TRUE(up.complete()) << up.failure;
  EXPECT_EQ(up.negative_eigenvalues, 2);
}

// Where nothing is stiff at all: a wheel on its axle, with and without its weight along that; a body in space; and what is held
// beside them. They stay where they are. Mutations: no spring where nothing is stiff; start vectors that span a plane.
TEST(NeutralMotions, WhereNothingIsStiff) {
  const std::string wheel = R"(<body name="w" at="0.5 0 0" mass="1" inertia="0.01 0.1 0.1"/>
      <revolute name="axle" between="ground w" at="0 0 0" axis="0 0 1"/>)";
  const std::string held = R"(<body name="h" at="2 0 0" mass="1" inertia="1 1 1"/>
      <prismatic name="p" between="ground h" axis="0 0 1"/>
      <spring name="s" between="ground h" at_a="2 0 -1" at_b="2 0 0" stiffness="100"/>)";
  const std::string weight = R"(<gravity acceleration="0 0 -9.81"/>)";
  for (const auto& [items, motions] :
       {std::pair{wheel, 1U},
        {wheel + weight, 1U},
        {wheel + weight + held, 1U},
        {std::string(R"(<body name="a" at="3 4 5" mass="2" inertia="1 2 2"/>)"), 6U}}) {
    const Scene scene = read_model_text("<mbd name=\"m\"><static/>" + items + "</mbd>");
    const Solved s = solve(scene, {.steps = 1, .newton = {}});
    ASSERT_TRUE(s.report.converged) << items << s.report.failure;
    EXPECT_EQ(s.report.neutral.size(), motions)
        << items << ::testing::PrintToString(s.report.neutral);
    const Model model = compile(scene);
    EXPECT_LT((s.state.pose[1].r - model.initial.pose[1].r).norm(), 1e-12) << items;
  }
  // Along any axis, where gaps are round-off: five in a row.
  std::string row;
  for (int k = 0; k < 5; ++k)
    row += fmt::format(R"(<body name="b{0}" at="{0} 0.2 -1" mass="1" inertia="1 2 2"/>
        <revolute name="j{0}" between="{1} b{0}" at="{0}.3 0 0" axis="{2} -0.5 0.7"/>)",
                       k, k == 0 ? "ground" : fmt::format("b{}", k - 1), 0.3 + 0.1 * k);
  const Scene chain = read_model_text("<mbd name=\"m\"><static/>" + row + "</mbd>");
  const Solved still = solve(chain, {.steps = 1, .newton = {}});
  ASSERT_TRUE(still.report.converged) << still.report.failure;
  EXPECT_EQ(still.report.neutral.size(), 5U);
  EXPECT_EQ(run(chain).certificate.verdict(), Verdict::pass);
  // Of its weight across the axle the motion is driven, and that is why there is none.
  const Scene falls = read_model_text("<mbd name=\"m\"><static/>" + wheel +
                                      R"(<gravity acceleration="0 -9.81 0"/></mbd>)");
  EXPECT_NE(solve(falls, {.steps = 1, .newton = {}}).report.failure.find("which loads drive"),
            std::string::npos);
}

// What loads drive and nothing holds is named.
TEST(NeutralMotions, AreRefusedWhereLoadsDriveThem) {
  for (const auto& [more, motion] :
       {std::pair{R"(<load at="bob" moment="0 0 0.5"/>)", "body 'bob' turns about its axis 3"},
        {R"(<body name="free" at="5 0 0" mass="1" inertia="1 1 1"/>)",
         "body 'free' moves along its axis 3"}}) {
    try {
      run(hanging(more));
      FAIL() << more;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(motion), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("nothing holds"), std::string::npos) << error.what();
    }
  }
  // A spring holds it, however soft.
  const Solved held = solve(hanging(R"(<load at="bob" moment="0 0 0.5"/>
      <bushing name="soft" between="ground bob" at="0 0 0" stiffness="0 0 0" angular_stiffness="0 0 2"/>)"),
                            {.steps = 2, .newton = {}});
  ASSERT_TRUE(held.report.converged) << held.report.failure;
  EXPECT_TRUE(held.report.neutral.empty());
  EXPECT_NEAR(Eigen::AngleAxisd(Mat3(held.state.pose[1].R())).angle(), 0.25, 1e-9);
}

// Bending of a fine mesh is as soft beside its elements' stretching as round-off, and strains none of them by much: it is no
// neutral motion. A force of 1 mN on 10 m bends by F L^3/3 EI + F L/GA, to what large rotations and round-off leave.
// Mutation: neighbouring nodes are compared in place of all with the first: "nothing holds the motion".
TEST(NeutralMotions, AreNotTheBendingOfAFineMesh) {
  const History history = run_to_table(read_model_text(R"(<mbd name="fine">
      <section name="s"><stiffness EA="1e7" GA2="4e6" GA3="4e6" GJ="3e3" EI2="4e3" EI3="4e3"/></section>
      <beam name="b" section="s" from="0 0 0" to="10 0 0" normal="0 0 1" elements="1500" order="2"/>
      <fixed name="root" between="ground b.start"/><load at="b.end" force="0 0 1e-3"/><static/>
      <record name="tip" at="b.end" quantities="displacement"/></mbd>)"));
  ASSERT_TRUE(history.report.complete()) << history.report.failure;
  const double exact = 1e-3 * 1000.0 / (3.0 * 4e3) + 1e-3 * 10.0 / 4e6;
  EXPECT_NEAR(history.table["tip.displacement.3"].back() / exact, 1.0, 1e-6);
}

}  // namespace
}  // namespace mbd::test::test_statics
