// Paths of equilibria: limit points, bifurcations and their branches against closed forms and other
// calculations.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_paths {
namespace {

using std::numbers::pi;

constexpr PathMethod both_methods[] = {PathMethod::bordered, PathMethod::crisfield};
std::string text_of(PathMethod m) { return m == PathMethod::bordered ? "bordered" : "crisfield"; }

std::vector<SpecialPoint> points_of(const RunReport& report, PathEvent event) {
  std::vector<SpecialPoint> found;
  for (const SpecialPoint& p : report.special)
    if (p.event == event) found.push_back(p);
  return found;
}

double relative(double x, double reference) { return std::abs(x / reference - 1.0); }

// Scales an entry of the stiffness of every section.
Scene with_entry(Scene scene, Index i, double factor) {
  for (Section& section : scene.sections) section.stiffness(i, i) *= factor;
  return scene;
}

// --- corners ---

// A mass on a rail with a bilinear spring: k1 = 1 to 0.1, k2 after that, and a load of 0.4. Exact: x = 0.4 mu to 0.1, then 0.1 +
// (0.4 mu - 0.1)/k2. The path has a corner, by more than a right angle where k2 < 0. Mutations: steps that turn too far are never taken;
// the way on along the tangent only (k2 < 0).
TEST(PathCorners, KinksOfLaws) {
  for (const double k2 : {5.0, 100.0, 1e4, 0.2, 0.01, -0.2, -2.0, -10.0})
    for (const PathMethod method : both_methods) {
      Scene scene = read_model_text(fmt::format(
          R"(<mbd name="c"><body name="m" mass="1" inertia="1 1 1"/>
          <prismatic name="p" between="ground m" axis="1 0 0"/>
          <joint_spring name="s" joint="p" force="x > 0.1 ? 0.1+{}*(x-0.1) : x"/>
          <load at="m" force="0.4 0 0"/><path length="{}"/>
          <record name="p" joint="p" quantities="displacement"/></mbd>)",
          k2, k2 < 0.05 ? 2.0 : 0.3));
      scene.path->method = method;
      const History history = run_to_table(scene);
      ASSERT_TRUE(history.report.complete()) << k2 << history.report.failure;
      const auto& x = history.table["p.displacement"];
      const auto& mu = history.table["load_factor"];
      EXPECT_GT(x.back(), k2 > 1e3 ? 0.102 : 0.12) << k2;
      for (std::size_t i = 0; i < x.size(); ++i)
        EXPECT_NEAR(0.4 * mu[i], x[i] <= 0.1 ? x[i] : 0.1 + k2 * (x[i] - 0.1),
                    1e-9 * std::max(1.0, std::abs(k2)))
            << k2 << " " << x[i];
      EXPECT_TRUE(std::ranges::any_of(history.report.notes, [](const std::string& note) {
        return note.find("has a corner") != std::string::npos;
      })) << k2;
    }
}

// What a stop or a mark is of may lie in the corner itself. Mutation: crossings in a step around it are not looked for.
TEST(PathCorners, StopAtTheCorner) {
  const History history = run_to_table(read_model_text(
      R"(<mbd name="c"><body name="m" mass="1" inertia="1 1 1"/>
      <prismatic name="p" between="ground m" axis="1 0 0"/>
      <joint_spring name="s" joint="p" force="x > 0.1 ? 0.1+100*(x-0.1) : x"/>
      <load at="m" force="0.37 0 0"/><path><stop quantity="p.displacement" value="0.100000001"/></path>
      <record name="p" joint="p" quantities="displacement"/></mbd>)"));
  EXPECT_NEAR(history.table["p.displacement"].back(), 0.1, 1e-6);
  EXPECT_NEAR(history.table["load_factor"].back(), 0.1 / 0.37, 1e-4);
}

// The arc length is of motions alone: however the first step chose the load's share, it is the same where the path is. Mutation: the
// measure of steps, with the load in it.
TEST(PathLength, DoesNotDependOnTheFirstStep) {
  double first = 0.0;
  for (const double step : {0.1, 0.02, 0.005}) {
    Scene scene = model_scene("shallow_arch");
    scene.path->step = step;
    scene.path->max_step = 0.02;
    const History history = run_to_table(scene);
    ASSERT_TRUE(history.report.complete()) << history.report.failure;
    const double length = history.table["arc_length"].back();
    if (first == 0.0) first = length;
    EXPECT_NEAR(length / first, 1.0, 1e-3) << step;
  }
}

// A cantilever rolled up by a moment: its tip turns through half a turn, where the rotation vector jumps from pi to -pi. That is no
// crossing of 0, which is at a whole turn: M = 2 pi EI/L. Mutation: a change of sign is a crossing.
TEST(PathCrossings, ARotationVectorThatGoesRound) {
  const History history = run_to_table(read_model_text(
      R"(<mbd name="x"><section name="s">
      <stiffness EA="1e6" GA2="1e6" GA3="1e6" GJ="80" EI2="100" EI3="100"/></section>
      <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="6" order="4"/>
      <fixed name="w" between="ground b.start"/><load at="b.end" moment="0 650 0"/>
      <path><stop quantity="t.rotation.2" value="0"/></path>
      <record name="t" at="b.end" quantities="rotation"/></mbd>)"));
  ASSERT_TRUE(history.report.complete()) << history.report.failure;
  EXPECT_NEAR(history.table["load_factor"].back(), 2.0 * pi * 100 / 650, 1e-6);
  EXPECT_NEAR(history.table["t.rotation.2"].back(), 0.0, 1e-9);
}

// --- the deep arch (models/arch.xml) ---

constexpr double P1 = 0.897289134, P2 = -0.07304876;  // of the model's load of 1000

TEST(ArchPathSlow, LimitPointsAndTheBifurcationByBothMethods) {
  for (const PathMethod method : both_methods) {
    Scene scene = model_scene("arch", {{"branch", "0"}});
    scene.path->method = method;
    const History history = run_to_table(scene);
    ASSERT_TRUE(history.report.complete()) << history.report.failure;
    const auto limits = points_of(history.report, PathEvent::limit);
    const auto bifurcations = points_of(history.report, PathEvent::bifurcation);
    ASSERT_EQ(limits.size(), 2U) << text_of(method);
    ASSERT_EQ(bifurcations.size(), 1U) << text_of(method);
    EXPECT_NEAR(limits[0].load_factor, P1, 6e-10);  // half a digit of the reference
    EXPECT_NEAR(limits[1].load_factor, P2, 6e-9);
    EXPECT_LT(relative(bifurcations[0].load_factor, 0.2439292058), 5e-7);
    EXPECT_EQ(bifurcations[0].before, 0);
    EXPECT_EQ(bifurcations[0].after, 1);
    EXPECT_EQ(limits[0].before, 1);
    EXPECT_EQ(limits[0].after, 2);
    EXPECT_EQ(limits[1].before, 2);
    EXPECT_EQ(limits[1].after, 1);
  }
}

// 12 elements of order 3 in the paper's form: 897.565, 897.547, 897.536 (matrix, quaternion, geodesic); the
// paper prints 897.9 for all three. In a form without an energy nothing is counted.
TEST(ArchPathSlow, PaperMesh) {
  const double expected[] = {897.565, 897.547, 897.536};
  for (const Metric metric : all_metrics) {
    Scene scene = with(model_scene("arch", {{"branch", "0"}, {"elements", "12"}, {"order", "3"}}),
                       metric, Form::paper);
    const RunReport report = run(scene, {.output = {}, .observers = {}, .progress = {}});
    const auto limits = points_of(report, PathEvent::limit);
    ASSERT_GE(limits.size(), 1U) << name_of(metric);
    EXPECT_NEAR(1000.0 * limits[0].load_factor, expected[static_cast<int>(metric)], 5e-4)
        << name_of(metric);
    EXPECT_FALSE(limits[0].before);
    EXPECT_NE(report.notes.at(0).find("stability is not counted"), std::string::npos);
  }
}

// Every point of reference/arch_path.csv, P over (u1, u2): located as a mark of the same |u2| where that is
// unique, by interpolation of the nearest points elsewhere. Measure: distance in (P/1000, u1/100, u2/100) from
// each reference point to the path, a cubic through its four nearest points; divided by nothing. The path
// has points at most 0.02 apart.
TEST(ArchPathSlow, FollowsTheReference) {
  const auto arch = [](const char* elements) {
    Scene scene = model_scene("arch", {{"branch", "0"}, {"elements", elements}});
    scene.path->max_step = 0.01;
    scene.path->points = 2000;
    return scene;
  };
  const Table reference = reference_table("arch_path");
  const auto worst = [&](const Scene& s) {
    const History history = run_to_table(s);
    EXPECT_TRUE(history.report.complete()) << history.report.failure;
    const auto& P = history.table["load_factor"];
    const auto& u1 = history.table["crown.displacement.1"];
    const auto& u2 = history.table["crown.displacement.2"];
    // Chords that turn by 0.01 rad leave gaps of their length / 800: cubic Hermite between rows would
    // need tangents, so distances are to the parabola through three neighbours.
    double largest = 0.0;
    for (std::size_t k = 0; k < reference["P"].size(); ++k) {
      const Vec3 x(reference["P"][k] / 1000.0, reference["u1"][k] / 100.0,
                   reference["u2"][k] / 100.0);
      const auto point = [&](std::size_t i) { return Vec3(P[i], u1[i] / 100.0, u2[i] / 100.0); };
      if (x(2) < -1.55) continue;  // the model stops at u2 = -160
      std::size_t best = 1;
      for (std::size_t i = 1; i + 1 < P.size(); ++i)
        if ((point(i) - x).norm() < (point(best) - x).norm()) best = i;
      const Vec3 a = point(best - 1), b = point(best), c = point(best + 1);
      double nearest = 1e300;
      const double la = (b - a).norm(), lc = (c - b).norm();
      for (int i = 0; i <= 2000; ++i) {
        const double t = -la + (la + lc) * i / 2000.0;
        const Vec3 y = a * (t * (t - lc) / (la * (la + lc))) +
                       b * ((t + la) * (lc - t) / (la * lc)) +
                       c * (t * (t + la) / (lc * (la + lc)));
        nearest = std::min(nearest, (y - x).norm());
      }
      largest = std::max(largest, nearest);
    }
    return largest;
  };
  const double error = worst(arch("16"));
  EXPECT_LT(error, 3e-5);
  EXPECT_GT(worst(with_entry(arch("8"), 5, 1.1)), 100.0 * 3e-5);  // EI3 up by 10 %
}

TEST(ArchPathSlow, TenPercentAreSeen) {
  const auto loads = [](const Scene& scene) {
    const RunReport report = run(scene, {.output = {}, .observers = {}, .progress = {}});
    std::array<double, 2> found{};
    if (const auto p = points_of(report, PathEvent::limit); !p.empty()) found[0] = p[0].load_factor;
    if (const auto p = points_of(report, PathEvent::bifurcation); !p.empty())
      found[1] = p[0].load_factor;
    return found;
  };
  Scene scene = model_scene("arch", {{"branch", "0"}, {"elements", "8"}});
  scene.path->marks[1].value = -125.0;         // past the first limit point
  for (const Index entry : {0, 1, 3, 4, 5}) {  // EA, GA2, GJ, EI2, EI3
    const auto [limit, bifurcation] = loads(with_entry(scene, entry, 1.1));
    const bool in_plane = entry == 0 || entry == 1 || entry == 5;
    if (in_plane)
      EXPECT_GT(std::abs(limit - P1), 6e-9) << "D" << entry + 1;
    else
      EXPECT_GT(relative(bifurcation, 0.2439292058), 5e-6) << "D" << entry + 1;
  }
}

// The branch leaves the plane, to either side, and is stable there.
TEST(ArchPathSlow, BranchToEitherSide) {
  std::array<double, 2> out{};
  for (const int side : {1, -1}) {
    Scene scene = model_scene("arch", {{"branch", side > 0 ? "1" : "-1"}, {"elements", "8"}});
    scene.path->points = 40;
    const History history = run_to_table(scene);
    EXPECT_TRUE(history.report.complete()) << history.report.failure;
    const auto& branch = history.table["branch"];
    const auto& u3 = history.table["crown.displacement.3"];
    double& most = out[side > 0 ? 0 : 1];
    for (std::size_t i = 0; i < branch.size(); ++i)
      if (branch[i] == 0.0)
        EXPECT_LT(std::abs(u3[i]), 1e-5);
      else {
        if (std::abs(u3[i]) > std::abs(most)) most = u3[i];
        // The bifurcation itself is singular to round-off.
        const double negative = history.table["negative_eigenvalues"][i];
        EXPECT_EQ(negative, branch[i - 1] == 0.0 ? -1.0 : 0.0) << i;
      }
  }
  EXPECT_GT(std::abs(out[0]), 50.0);
  EXPECT_LT(out[0] * out[1], 0.0);
}

// --- Lee's frame (models/lee_frame.xml; digits by shooting, path_references.hpp) ---

// Coarse enough to be quick, where the digits do not matter.
Scene coarse_lee_frame(Overrides overrides = {}) {
  overrides.emplace_back("elements", "3");
  overrides.emplace_back("order", "4");
  return model_scene("lee_frame", overrides);
}

TEST(LeeFramePathSlow, LimitPointsByBothMethods) {
  for (const PathMethod method : both_methods) {
    // Off by 2e-11 for this mesh: the model's own, finer one takes half as long again.
    Scene scene = model_scene("lee_frame", {{"elements", "6"}});
    scene.path->method = method;
    const History history = run_to_table(scene);
    ASSERT_TRUE(history.report.complete()) << history.report.failure;
    const auto limits = points_of(history.report, PathEvent::limit);
    ASSERT_EQ(limits.size(), 2U) << text_of(method);
    EXPECT_LT(relative(20000.0 * limits[0].load_factor, 18556.72362), 1e-9);
    EXPECT_LT(relative(20000.0 * limits[1].load_factor, -9414.42451), 1e-9);
    const auto& event = history.table["event"];
    const auto at =
        static_cast<std::size_t>(std::find(event.begin(), event.end(), 1.0) - event.begin());
    // Mutation: the root of the rate of the load along the path, which round-off of resultants makes 5e-6 m off.
    EXPECT_NEAR(history.table["load.displacement.1"][at], 26.8805730, 6e-8);
    EXPECT_NEAR(history.table["load.displacement.2"][at], -48.7351434, 6e-8);
  }
  Scene stiffer = with_entry(coarse_lee_frame(), 5, 1.1);
  const auto limits =
      points_of(run(stiffer, {.output = {}, .observers = {}, .progress = {}}), PathEvent::limit);
  ASSERT_GE(limits.size(), 1U);
  EXPECT_GT(relative(20000.0 * limits[0].load_factor, 18556.72362), 0.01);
}

// The scale of the loads and of lengths is the user's choice: the same points, in the same number of steps.
TEST(LeeFramePathSlow, DoesNotDependOnTheUnitOfTheLoad) {
  const History reference = run_to_table(coarse_lee_frame());
  constexpr double unit = 1024.0;
  Scene scene = coarse_lee_frame({{"P", "20000/1024"}});
  scene.path->step *= unit;
  scene.path->marks[0].value *= unit;
  const History scaled = run_to_table(scene);
  const auto &a = reference.table["load_factor"], &b = scaled.table["load_factor"];
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(b[i] / unit, a[i], 1e-6) << i;
}

// --- Euler's column and its elastica ---

// Hinged at both ends, inextensible and stiff in shear to 1e-8 of itself. Bifurcations at n^2 P_E; on the
// branch from the first the load is P/P_E = (2 K(k)/pi)^2 with k = sin(alpha/2), alpha the rotation of the
// ends, and the ends come nearer to each other by 2 L (1 - E(k)/K(k)).
std::string column_path(const std::string& attributes, const std::string& marks) {
  return "<mbd name=\"column\"><parameter name=\"PE\" value=\"pi^2\"/><parameter name=\"stiff\" "
         "value=\"1e6\"/>"
         "<section name=\"s\"><stiffness EA=\"stiff\" GA2=\"stiff\" GA3=\"stiff\" GJ=\"100\" "
         "EI2=\"100\" "
         "EI3=\"1\"/></section><beam name=\"b\" section=\"s\" from=\"0 0 0\" to=\"1 0 0\" "
         "normal=\"0 0 1\" "
         "elements=\"8\" order=\"5\"/><revolute name=\"foot\" between=\"ground b.start\" axis=\"0 "
         "0 1\"/>"
         "<point_on_line name=\"head\" between=\"b.end ground\" axis=\"1 0 0\"/>"
         "<load at=\"b.end\" force=\"-PE 0 0\"/><path " +
         attributes + ">" + marks +
         "</path><record name=\"head\" at=\"b.end\" quantities=\"displacement rotation\"/></mbd>";
}

TEST(ColumnPath, BifurcationsOfTheStraightColumn) {
  const Scene scene = read_model_text(
      column_path("step=\"0.3\"", "<stop quantity=\"load_factor\" value=\"17\"/>"), "column.xml");
  const RunReport report = run(scene, {.output = {}, .observers = {}, .progress = {}});
  ASSERT_TRUE(report.complete()) << report.failure;
  const auto found = points_of(report, PathEvent::bifurcation);
  ASSERT_EQ(found.size(), 4U);
  for (int n = 1; n <= 4; ++n) {
    const SpecialPoint& p = found[static_cast<std::size_t>(n - 1)];
    // A column with EA = GA: stretch and shear act together like a force-dependent length, by P/EA.
    EXPECT_LT(relative(p.load_factor, n * n), 3.0 * n * n * pi * pi / 1e6) << n;
    EXPECT_EQ(p.before, n - 1);
    EXPECT_EQ(p.after, n);
  }
  EXPECT_EQ(points_of(report, PathEvent::limit).size(), 0U);
  // 10 % more bending stiffness
  const auto stiffer =
      points_of(run(with_entry(scene, 5, 1.1), {.output = {}, .observers = {}, .progress = {}}),
                PathEvent::bifurcation);
  EXPECT_NEAR(stiffer.at(0).load_factor, 1.1, 1e-4);
}

TEST(ColumnPath, BranchIsTheElastica) {
  for (const PathMethod method : both_methods) {
    Scene scene = read_model_text(column_path("branch=\"1\" points=\"120\"",
                                              "<stop quantity=\"load_factor\" value=\"1.5\"/>"),
                                  "column.xml");
    scene.path->method = method;
    const History history = run_to_table(scene);
    ASSERT_TRUE(history.report.complete()) << history.report.failure;
    double worst_load = 0.0, worst_travel = 0.0, most = 0.0;
    for (std::size_t i = 0; i < history.table["branch"].size(); ++i) {
      if (history.table["branch"][i] != 1.0) continue;
      const double alpha = std::abs(history.table["head.rotation.3"][i]);
      const double k = std::sin(0.5 * alpha), K = std::comp_ellint_1(k), E = std::comp_ellint_2(k);
      worst_load = std::max(worst_load,
                            relative(history.table["load_factor"][i], std::pow(2.0 * K / pi, 2)));
      worst_travel = std::max(
          worst_travel, std::abs(-history.table["head.displacement.1"][i] - 2.0 * (1.0 - E / K)));
      most = std::max(most, alpha);
    }
    EXPECT_GT(most, 1.5) << "bends far";
    EXPECT_LT(worst_load, 5e-5) << text_of(
        method);  // the strains of stretch and shear: P/EA = 1.5e-5
    EXPECT_LT(worst_travel, 5e-5);
  }
}

// --- directions, stops, marks, ends ---

TEST(PathDirections, BothWays) {
  const Scene scene =
      read_model_text(column_path("direction=\"both\"",
                                  "<stop quantity=\"load_factor\" value=\"0.5\"/>"
                                  "<stop quantity=\"load_factor\" value=\"-0.75\"/>"),
                      "column.xml");
  const History history = run_to_table(scene);
  ASSERT_TRUE(history.report.complete()) << history.report.failure;
  const auto& load = history.table["load_factor"];
  EXPECT_NEAR(*std::max_element(load.begin(), load.end()), 0.5, 1e-12);
  EXPECT_NEAR(*std::min_element(load.begin(), load.end()), -0.75, 1e-12);
  for (std::size_t i = 0; i < load.size(); ++i) {
    if (load[i] != 0.0) {
      EXPECT_EQ(history.table["branch"][i], load[i] < 0.0 ? -1.0 : 0.0);
    }
    EXPECT_GE(history.table["arc_length"][i] * load[i], 0.0);
  }
}

// Von Mises' truss of two springs, with a soft spring along its third axis to a point far away: its length is the scene's, and steps
// of a share of it passed over both limit points. Closed form: P = 2 k (l0 - l) y/l has its extremes at +-99.4992 of 1000/m.
// Mutation: no look at what tangents foretell.
TEST(PathSteps, DoNotLeapInAWideScene) {
  for (const double away : {10.0, 100.0, 1e4}) {
    const History history = run_to_table(read(fmt::format(R"x(
        <body name="m" at="0 0.3 0" mass="1" inertia="1 1 1"/>
        <motion name="rot" of="m" rotation="0 0 0"/>
        <spring name="l" between="ground m" at_a="-1 0 0" stiffness="1000"/>
        <spring name="r" between="ground m" at_a="1 0 0" stiffness="1000"/>
        <spring name="guy" between="ground m" at_a="0 0.3 {0}" stiffness="500"/>
        <load at="m" force="0 -100 0"/>
        <path><stop quantity="m.displacement.2" value="-0.66"/></path>
        <record name="m" at="m" quantities="displacement"/>)x",
                                                          away)));
    ASSERT_TRUE(history.report.complete()) << history.report.failure;
    const auto& special = history.report.special;
    std::vector<double> limits;
    for (const SpecialPoint& point : special)
      if (point.event == PathEvent::limit) limits.push_back(point.load_factor);
    ASSERT_EQ(limits.size(), 2U) << away;
    // The guy, of 500 N/m, bears (u/away)^2/2 of 500 u.
    const double u = away > 50.0 ? 0.0 : 0.5, guy = 5.0 * u * u * u / (2.0 * away * away);
    EXPECT_NEAR(limits[0], 0.0994992, 2e-6 + guy) << away;
    EXPECT_NEAR(limits[1], -0.0994992, 2e-6 + guy) << away;
  }
}

// A strip in a fork under end moments, which have no potential: of the determinant's sign alone. Two steps before its first
// bifurcation, M = pi/L sqrt(EI3 GJ), the path goes over both of its first two, and its stop lies between them. Mutation: the
// sign not looked at in the middle of a step.
TEST(PathSteps, SeeTwoChangesOfASign) {
  for (const double stop : {1.5, 2.6}) {
    const History history =
        run_to_table(read(fmt::format(R"x(
        <section name="s"><stiffness EA="4e10" GA2="1e10" GA3="1e10" GJ="650" EI2="4e6" EI3="900"/></section>
        <beam name="b" section="s" from="0 0 0" to="0 1.7 0" normal="0 0 1" elements="6" order="5"/>
        <body name="c" at="0 1.7 0" mass="1" inertia="1 1 1"/>
        <prismatic name="P" between="ground c" axis="0 1 0"/>
        <universal name="A" between="ground b.start" axis="1 0 0" second_axis="0 0 1"/>
        <universal name="B" between="c b.end" axis="1 0 0" second_axis="0 0 1"/>
        <load at="b.start" moment="{0} 0 0"/> <load at="b.end" moment="-{0} 0 0"/>
        <path step="0.3" length="2"><stop quantity="load_factor" value="{1}"/></path>
        <record name="t" at="b.end" quantities="displacement rotation"/>)x",
                                      std::numbers::pi / 1.7 * std::sqrt(900.0 * 650.0), stop)));
    ASSERT_TRUE(history.report.complete()) << history.report.failure;
    std::vector<double> found;
    for (const SpecialPoint& point : history.report.special)
      if (point.event == PathEvent::bifurcation) found.push_back(point.load_factor);
    ASSERT_EQ(found.size(), stop < 2.0 ? 1U : 2U) << stop;
    EXPECT_NEAR(found[0], 1.0, 5e-4);
    if (stop > 2.0) {
      EXPECT_NEAR(found[1], 2.0, 2e-3);
    }
  }
}

// A cantilever with EI3 = 1 and EI2 = ratio of whose axial load at the tip a share eta follows: no potential. Divergence (closed form)
// at P = k^2 EI, (1 - eta) cos k = -eta, in either plane by itself.
std::string partly_following(double eta, double ratio, double P) {
  return fmt::format(
      R"(<section name="s"><stiffness EA="1e7" GA2="1e7" GA3="1e7" GJ="1" EI2="{1}" EI3="1"/></section>
         <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="3" order="5"/>
         <fixed name="c" between="ground b.start"/>
         <load at="b.end" force="{2} 0 0" follower_force="{3} 0 0"/>
         <path><stop quantity="load_factor" value="2"/></path>
         <record name="tip" at="b.end" quantities="displacement"/>)",
      eta, ratio, -(1.0 - eta) * P, -eta * P);
}

// All of them, with the steps that a path takes by itself, which reach over several at once: pairs that are near (none was found), and
// far (the first was found at 52 times its load).
// As it was, the sign of the determinant alone decides: none, and four of six.
TEST(PathWithoutPotential, FindsPairsOfBifurcations) {
  constexpr double eta = 0.3;
  const double k1 = std::acos(-eta / (1.0 - eta)), k2 = 2.0 * pi - k1, k3 = 2.0 * pi + k1;
  for (const auto& [ratio, P] : {std::pair{1.1, 10.14}, {1.3, 10.14}, {1.05, 20.0}}) {
    const History h = run_to_table(read(partly_following(eta, ratio, P)));
    ASSERT_TRUE(h.report.complete()) << h.report.failure;
    std::vector<double> exact;
    for (const double k : {k1, k2, k3})
      for (const double EI : {1.0, ratio})
        if (k * k * EI / P < 2.0) exact.push_back(k * k * EI / P);
    std::ranges::sort(exact);
    const auto found = points_of(h.report, PathEvent::bifurcation);
    ASSERT_EQ(found.size(), exact.size()) << ratio;
    for (std::size_t i = 0; i < exact.size(); ++i)
      EXPECT_LT(relative(found[i].load_factor, exact[i]), 1e-4) << ratio;
  }
}

// Of a round column both planes lose stability at once, and no branch can be followed. As it was: none was found.
TEST(PathWithoutPotential, FindsTwoMotionsAtOnce) {
  const double k = std::acos(-0.3 / 0.7);
  Scene scene = read(partly_following(0.3, 1.0, 10.0));
  scene.path->branch = 1;
  const RunReport report = run(scene);
  const auto found = points_of(report, PathEvent::bifurcation);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_LT(relative(found[0].load_factor, k * k / 10.0), 1e-4);
  EXPECT_LT(relative(found[1].load_factor, std::pow(2.0 * pi - k, 2) / 10.0), 1e-4);
  for (const SpecialPoint& point : found)
    EXPECT_NE(point.motion.find("2 at once, one of them"), std::string::npos) << point.motion;
  EXPECT_NE(report.failure.find("2 branches or more"), std::string::npos) << report.failure;
}

// Half a ring under pressure, clamped and on a slide: in its plane at n^2 - 1 = 3, 8, 15 (of EI/R^3, Levy), and at 8 one more out of it
// gains stability when that one loses it. Seen to fail while negative eigenvalues were counted, of which there are as many.
TEST(PathWithoutPotential, ARingLosesOneAndGainsOne) {
  const RunReport report = run(read(R"(
      <section name="s"><stiffness EA="1e7" GA2="1e7" GA3="1e7" GJ="1" EI2="1" EI3="1"/></section>
      <arc name="b" section="s" from="1 0 0" center="0 0 0" axis="0 0 1" angle="pi" normal="0 0 1"
           elements="4" order="5"/>
      <fixed name="c" between="ground b.start"/>
      <prismatic name="d" between="ground b.end" axis="1 0 0"/>
      <distributed beam="b" follower_force="0 1 0"/>
      <path step="0.2" max_step="0.2" points="80"><stop quantity="load_factor" value="12"/></path>
      <record name="m" at="b@0.5" quantities="displacement"/>)"));
  ASSERT_TRUE(report.complete()) << report.failure;
  const auto found = points_of(report, PathEvent::bifurcation);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_LT(relative(found[0].load_factor, 3.0), 1e-4);
  EXPECT_LT(relative(found[1].load_factor, 8.0), 1e-4);
  EXPECT_NE(found[1].motion.find("2 at once"), std::string::npos) << found[1].motion;
}

// Of the straight column under more than its load a <static> says so; the certificate alone said "pass".
TEST(PathWithoutPotential, AStaticEquilibriumBeyondSaysSo) {
  for (const auto& [P, ways] : {std::pair{4.0, 0}, {4.2, 1}, {10.0, 2}}) {
    Scene scene = read(partly_following(0.3, 1.1, P));
    scene.path.reset();
    scene.statics.emplace();
    const RunReport report = run(scene);
    ASSERT_TRUE(report.complete()) << report.failure;
    EXPECT_EQ(std::ranges::any_of(report.notes,
                                  [ways = ways](const std::string& note) {
                                    return note.find(fmt::format("drive it on in {} of", ways)) !=
                                           std::string::npos;
                                  }),
              ways > 0)
        << P;
  }
}

// Beck's column flutters (20.05 EI/L^2) and has no other equilibrium: modes meet, and none goes through zero.
TEST(PathWithoutPotential, FlutterIsNoBifurcation) {
  const RunReport report = run(read(partly_following(1.0, 1.2, 30.0)));
  ASSERT_TRUE(report.complete()) << report.failure;
  EXPECT_TRUE(points_of(report, PathEvent::bifurcation).empty());
}

TEST(PathMarks, AreLocatedToRoundOff) {
  Scene scene = coarse_lee_frame();
  scene.path->marks = {{{}, "load.displacement.2", -20.0, false}, {{}, "load_factor", 0.25, true}};
  const History history = run_to_table(scene);
  const auto& event = history.table["event"];
  EXPECT_EQ(event.back(), 3.0);
  EXPECT_NEAR(history.table["load_factor"].back(), 0.25, 1e-13);
  scene.path->marks[1].value = 0.9;
  const History longer = run_to_table(scene);
  const auto& marks = longer.table["event"];
  const auto at =
      static_cast<std::size_t>(std::find(marks.begin(), marks.end(), 3.0) - marks.begin());
  EXPECT_NEAR(longer.table["load.displacement.2"].at(at), -20.0, 1e-10);
}

TEST(PathLength, AndPointsEndIt) {
  Scene scene = coarse_lee_frame();
  scene.path->marks.clear();
  scene.path->length = 0.4;
  const History history = run_to_table(scene);
  EXPECT_TRUE(history.report.complete());
  EXPECT_NEAR(history.table["arc_length"].back(), 0.4, 1e-12);
  scene.path->points = 7;
  EXPECT_EQ(run_to_table(scene).table["load_factor"].size(), 7U);
}

TEST(PathBranch, ThatThereIsNot) {
  Scene scene = coarse_lee_frame();
  scene.path->branch = 1;
  scene.path->points = 10;
  const History history = run_to_table(scene);
  EXPECT_NE(history.report.failure.find("there is no bifurcation 1"), std::string::npos)
      << history.report.failure;
  EXPECT_EQ(history.table["load_factor"].size(), 10U) << "the path itself is kept";
}

// Of the path's choices none changes the equilibria: sampled at marks, to 1e-9 of the displacement.
TEST(PathStepsSlow, DoNotChangeTheEquilibria) {
  double reference = 0.0;
  for (const double max_step : {0.1, 0.02, 1.0})
    for (const PathMethod method : both_methods) {
      Scene scene = coarse_lee_frame();
      scene.path->max_step = max_step;
      scene.path->method = method;
      scene.path->points = 2000;
      scene.path->marks = {{{}, "load.displacement.2", -60.0, true}};
      const History history = run_to_table(scene);
      ASSERT_TRUE(history.report.complete()) << history.report.failure;
      const double P = history.table["load_factor"].back();
      if (reference == 0.0) reference = P;
      EXPECT_LT(relative(P, reference), 1e-10) << max_step << " " << text_of(method);
    }
}

}  // namespace
}  // namespace mbd::test::test_paths
