// Sectional forces as unknowns, of beams in statics that are much stiffer than they bend (elements/beam/held_strains.hpp):
// tangents by differences at large motions, the same forces and energies as the stiffness has, rods and columns in closed form,
// iterations and steps that do not depend on stiffness.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/run/describe.hpp"
#include "tests/support/certificates.hpp"
#include "tests/support/increments.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_stiff_strains {
namespace {

constexpr double pi = std::numbers::pi;

double last(const History& history, const std::string& column) {
  return history.table[column].back();
}
CheckReport checked(const Scene& scene) { return check_model(scene, compile(scene)); }

// Curved beams of three metrics, with couplings of what is stiff with each other and with what is not, one with a strain held at
// zero beside them, one with nodes fixed in a body away from them.
std::string all_kinds(double EA, double GA) {
  return fmt::format(
      R"(<section name="s"><stiffness EA="{0}" GA2="3" GA3="{1}" GJ="1" EI2="2" EI3="3" D16="0.7" D35="0.4"/>
           <mass per_length="1" inertia="1e-2 1e-2 1e-2"/></section>
         <section name="u"><stiffness EA="40" GA2="{1}" GA3="30" GJ="2" EI2="1" EI3="3"/>
           <mass per_length="1" inertia="1e-2 1e-2 1e-2"/></section>
         <section name="v"><stiffness EA="{0}" GA2="inf" GA3="{1}" GJ="2" EI2="1" EI3="3" D13="{2}" D15="0.3"/>
           <mass per_length="1" inertia="1e-2 1e-2 1e-2"/></section>
         <arc name="a" section="s" from="1 0 0" center="0 0 0" axis="0 0 1" angle="1.2" normal="0 0 1"
              elements="2" order="3" metric="quaternion"/>
         <beam name="b" section="u" from="2 0 0" to="3 0.5 0" normal="0 0 1" order="5" metric="matrix"/>
         <beam name="c" section="s" from="4 0 0" to="4 0 1" normal="1 0 0" order="1"/>
         <beam name="d" section="v" from="5 0 0" to="5 1 0" normal="0 0 1" order="2"/>
         <body name="m" at="1.7 0.1 0.3" mass="1" inertia="1 2 3"/>
         <fixed name="f" between="m b.start"/>
         <fixed name="g" between="ground c.start"/>)",
      EA, GA, 0.6 * std::sqrt(EA * GA));
}
const std::string at_rest = "<static/>", in_time = "<transient duration=\"1\" step=\"0.1\"/>";
constexpr Index rows_of_kinds = 2 * 3 * 2 + 5 + 2 + 2 * 2, held_rows = 2;

// By differences of sixth order of the residual along random increments, poses and multipliers moved far. The compliances are
// not small beside the strains of these forces.
TEST(StiffStrains, TangentIsTheDerivative) {
  const Model model = compile(read(all_kinds(1e9, 2e9) + at_rest));
  const System& system = *model.system;
  ASSERT_EQ(system.multipliers(), rows_of_kinds + held_rows + 6);  // and those of the ground
  Rng rng(3);
  for (int trial = 0; trial < 5; ++trial) {
    State state = model.initial;
    move_at_random(state, rng, 0.3);
    for (double& l : state.lambda) l = uniform(rng, -5e8, 5e8);
    VecX r, alone;
    const Eigen::MatrixXd K = dense_tangent(system, state, r);
    system.residual(state, alone);
    EXPECT_EQ((r - alone).cwiseAbs().maxCoeff(), 0.0);
    VecX x = random_increment(system, rng);
    x.tail(system.multipliers()) *= 1e9;
    const VecX slope = slope_along(system, state, x);
    const Index motions = 6 * (system.nodes() - 1);
    EXPECT_LT((slope - K * x).head(motions).norm(), 1e-9 * slope.norm()) << trial;
    EXPECT_LT((slope - K * x).tail(system.multipliers()).norm(),
              1e-9 * slope.tail(system.multipliers()).norm())
        << trial;
  }
}

// With the sectional forces that the strains ask for: residuals and energies of the same beams in a <transient>, where the
// stiffness stays in the elements; gaps are zero then.
TEST(StiffStrains, AreTheStiffness) {
  const Model one = compile(read(all_kinds(3e9, 1e9) + at_rest)),
              other = compile(read(all_kinds(3e9, 1e9) + in_time));
  const System& system = *one.system;
  ASSERT_EQ(system.multipliers() - other.system->multipliers(), rows_of_kinds);
  Rng rng(7);
  State state = one.initial;
  move_at_random(state, rng, 0.2);
  const auto gaps = [&] {
    VecX all;
    system.residual(state, all);
    return VecX(all.tail(system.multipliers()));
  };
  state.lambda.setZero();
  const VecX g0 = gaps();
  State same = other.initial;
  same.pose = state.pose;
  VecX own = state.lambda;
  Index next = 0;
  for (const ConstraintInfo& info : system.constraints()) {
    if (!info.gives) {
      for (Index i = 0; i < info.rows; ++i)
        own(info.first_row + i) = same.lambda(next++) = uniform(rng, -1.0, 1.0);
      continue;
    }
    Eigen::MatrixXd C(info.rows, info.rows);  // g is linear in S
    for (Index i = 0; i < info.rows; ++i) {
      state.lambda.setZero();
      state.lambda(info.first_row + i) = 1e9;
      C.col(i) = 1e-9 * (g0 - gaps()).segment(info.first_row, info.rows);
    }
    own.segment(info.first_row, info.rows) =
        C.ldlt().solve(VecX(g0.segment(info.first_row, info.rows)));
  }
  ASSERT_EQ(next, other.system->multipliers());
  state.lambda = own;
  VecX r, s;
  system.residual(state, r);
  other.system->residual(same, s);
  const Index nodes = 6 * system.nodes();
  EXPECT_GT(s.head(nodes).norm(), 1e7);
  EXPECT_LT((r.head(nodes) - s.head(nodes)).norm(), 1e-9 * s.head(nodes).norm());
  VecX left = gaps();
  for (const ConstraintInfo& info : system.constraints())
    if (!info.gives) left.segment(info.first_row, info.rows).setZero();
  EXPECT_LT(left.norm(), 1e-13 * g0.norm());
  EXPECT_NEAR(system.energies(state).strain / other.system->energies(same).strain, 1.0, 1e-9);
}

std::string straight(const std::string& stiffness, const std::string& more) {
  return "<section name=\"s\"><stiffness " + stiffness +
         "/></section><beam name=\"b\" section=\"s\" from=\"0 0 0\" to=\"2 0 0\" normal=\"0 0 1\" "
         "elements=\"4\" order=\"3\"/><fixed name=\"clamp\" between=\"ground b.start\"/>" +
         more + "<record name=\"end\" at=\"b.end\" quantities=\"displacement\"/>" +
         "<record name=\"root\" at=\"b.start\" quantities=\"force moment\"/>";
}

// A rod that is pulled: F, F L/EA and the energy F^2 L/(2 EA), of a strain of 1e-8.
TEST(StiffStrains, APulledRod) {
  const Scene scene =
      read(straight("EA=\"1e13\" GA2=\"1e12\" GA3=\"1e12\" GJ=\"1\" EI2=\"1\" EI3=\"1\"",
                    "<load at=\"b.end\" force=\"1e5 0 0\"/><static/>"));
  EXPECT_EQ(checked(scene).mechanism.stiff_strains, 4 * 3 * 3);
  EXPECT_SAYS(to_text(checked(scene)), std::string("(36 sectional"));
  const History h = run_to_table(scene);
  ASSERT_EQ(h.report.failure, "");
  EXPECT_NEAR(last(h, "end.displacement.1"), 2e-8, 1e-15);
  EXPECT_NEAR(last(h, "root.force.1"), 1e5, 1e-6);
  EXPECT_NEAR(h.report.energy_end.strain, 1e-3, 1e-12);
  EXPECT_LE(h.report.static_counters.iterations, 4);
}

// Between two clamps, where the tension is what round-off of places makes of it: the moment of linear theory, in as few iterations
// as linear problems take. Mutation seen: increments of reactions measured by the stiffness of bending alone (1761 iterations, and
// no equilibrium, at 1e9).
TEST(StiffStrains, BetweenTwoClamps) {
  for (const double EA : {3e8, 1e9, 1e10, 1e12}) {
    const std::string text = fmt::format(
        R"(<section name="s"><stiffness EA="{0}" GA2="{0}" GA3="{0}" GJ="1" EI2="1" EI3="1"/></section>
           <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="4" order="3"/>
           <fixed name="c" between="ground b.start"/><fixed name="d" between="b.end ground"/>
           <static/><record name="m" at="b@0.37" quantities="moment"/>)",
        EA);
    constexpr double q = 1e-5, s = 0.37;
    const History h =
        run_to_table(read(text + fmt::format(R"(<distributed beam="b" force="0 0 {}"/>)", -q)));
    ASSERT_EQ(h.report.failure, "") << EA;
    EXPECT_LE(h.report.static_counters.iterations, 6) << EA;
    EXPECT_NEAR(last(h, "m.moment.2"), -q * (0.5 * s * (1.0 - s) - 1.0 / 12.0), 1e-3 * q / 12.0)
        << EA;
    // One end aside by d: M = 6 EI d (2 s - 1) with the tension EA d^2 0.6 beside it small.
    const History moved = run_to_table(
        read(text.substr(0, text.find("<fixed name=\"d\"")) + text.substr(text.find("<static/>")) +
             R"(<motion name="move" of="b.end" displacement="0 0 -1e-8" rotation="0 0 0"/>)"));
    ASSERT_EQ(moved.report.failure, "") << EA;
    EXPECT_LE(moved.report.static_counters.iterations, 6) << EA;
    EXPECT_NEAR(std::abs(last(moved, "m.moment.2")), 6e-8 * 0.26, 0.02 * 6e-8 * 0.26) << EA;
  }
}

// Three bars to one point, of which one is too many: forces that only strains determine have the round-off of places over the
// strain, which the certificate says. N = P/(1 + sqrt(2)/2) of the middle one.
TEST(StiffStrains, RoundOffOfForcesIsSaid) {
  for (const double EA : {1e7, 1e10, 1e12}) {
    const History h = run_to_table(read(fmt::format(
        R"(<section name="s"><stiffness EA="{0}" GA2="{0}" GA3="{0}" GJ="1e-3" EI2="1e-3" EI3="1e-3"/></section>
           <beam name="a" section="s" from="0 0 0" to="1 0 0" normal="0 1 0" elements="2" order="3"/>
           <beam name="b" section="s" from="0 0 1" to="1 0 0" normal="0 1 0" elements="2" order="3"/>
           <beam name="c" section="s" from="0 0 -1" to="1 0 0" normal="0 1 0" elements="2" order="3"/>
           <fixed name="A" between="ground a.start"/><fixed name="B" between="ground b.start"/>
           <fixed name="C" between="ground c.start"/><fixed name="D" between="a.end b.end"/>
           <fixed name="E" between="a.end c.end"/><load at="a.end" force="1 0 0"/><static/>
           <record name="n" at="a@0.4" quantities="force"/>)",
        EA)));
    ASSERT_EQ(h.report.failure, "") << EA;
    EXPECT_LE(h.report.static_counters.iterations, 8) << EA;
    const double error = std::abs(last(h, "n.force.1") * (1.0 + 0.5 * std::sqrt(2.0)) - 1.0);
    const Check* const check = find(h.report.certificate, "round-off, sectional forces");
    ASSERT_NE(check, nullptr);
    EXPECT_LT(error, 20.0 * check->value + 1e-7) << EA;
    EXPECT_EQ(check->verdict, EA > 1e9 ? Verdict::warn : Verdict::pass)
        << EA << ' ' << check->value;
  }
}

// Euler's column in a plane and across it: loads (2 n - 1)^2 pi^2 EI/(4 L^2), with negative eigenvalues counted and nothing else
// found. With the stiffness in the elements the first loads at 1e5 are right to 1e-4 at best, and others are found. In units of
// the first; shear takes 2.5 of the load over EA from them.
TEST(StiffStrains, AColumn) {
  for (const double slenderness : {1e4, 1e5, 1e6, 1e8}) {
    const double EA = 0.25 * slenderness * slenderness;
    const History h = run_to_table(
        read(straight(fmt::format("EA=\"{}\" GA2=\"{}\" GA3=\"{}\" GJ=\"1\" EI2=\"3\" EI3=\"1\"",
                                  EA, 0.4 * EA, 0.4 * EA),
                      fmt::format("<load at=\"b.end\" force=\"{} 0 0\"/>"
                                  "<path><stop quantity=\"load_factor\" value=\"20\"/></path>",
                                  -pi * pi / 16.0))));
    ASSERT_TRUE(h.report.complete()) << slenderness << ": " << h.report.failure;
    std::vector<double> found;
    for (const SpecialPoint& point : h.report.special) {
      EXPECT_EQ(point.after.value_or(0) - point.before.value_or(0),
                point.event == PathEvent::bifurcation ? 1 : 0);
      if (point.event == PathEvent::bifurcation) found.push_back(point.load_factor);
    }
    ASSERT_EQ(found.size(), 3U) << slenderness;
    EXPECT_NEAR(found[0], 1.0, 2e-7) << slenderness;
    EXPECT_NEAR(found[1], 3.0, 1e-6) << slenderness;
    EXPECT_NEAR(found[2], 9.0, 1e-3) << slenderness;  // of the mesh
  }
}

// Paths over limit points: as many steps, and nearly as many iterations, however stiff.
TEST(StiffStrains, PathsDoNotDependOnStiffness) {
  for (const char* const model : {"lee_frame", "arch", "shallow_arch"}) {
    std::vector<long> steps;
    std::vector<double> iterations, limits;
    for (const double f : {1.0, 1e3, 1e6, 1e9}) {
      Scene scene = model_scene(model);
      for (Section& section : scene.sections) section.stiffness.diagonal().head<3>() *= f;
      scene.expects.clear();
      const RunReport report = run(scene, {.observers = {}, .estimate_error = false});
      ASSERT_TRUE(report.complete()) << model << " x " << f << ": " << report.failure;
      steps.push_back(report.static_counters.steps);
      iterations.push_back(static_cast<double>(report.static_counters.iterations));
      for (const SpecialPoint& point : report.special)
        if (point.event == PathEvent::limit) {
          limits.push_back(point.load_factor);
          break;
        }
    }
    const auto [few, many] = std::ranges::minmax(iterations);
    EXPECT_LE(many, 1.35 * few) << model;
    EXPECT_EQ(std::ranges::count(steps, steps[0]), 4) << model;
    ASSERT_EQ(limits.size(), 4U) << model;
    EXPECT_NEAR(limits[3], limits[2], 1e-7 * std::abs(limits[2])) << model;
    EXPECT_GT(std::abs(limits[1] - limits[2]), 0.0) << model;
  }
}

}  // namespace
}  // namespace mbd::test::test_stiff_strains
