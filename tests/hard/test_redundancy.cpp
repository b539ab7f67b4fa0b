// Case 1: constraints that repeat each other. Motions against closed forms and published numbers; reactions against
// the least-norm solution of equilibrium, made here from the geometry, and unique ones where beams make them so.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "libmbd/compile/model.hpp"
#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/study/trust/transform.hpp"
#include "solvers/constraints/initial.hpp"
#include "solvers/constraints/redundancy.hpp"
#include "tests/hard/hard_case.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/shell.hpp"

namespace mbd::test::test_redundancy {
namespace {

using hard::bounded;
using std::numbers::pi;

Scene hard_scene(const std::string& name, const Overrides& overrides = {}) {
  Scene scene = model_scene("hard/" + name, overrides);
  return scene;
}

Table table_of(const Scene& scene, RunReport* report = nullptr) {
  TableMaker maker(1);
  RunOptions options;
  options.observers = {&maker};
  const RunReport done = run(scene, options);
  EXPECT_TRUE(done.complete()) << done.failure;
  if (report != nullptr) *report = done;
  return maker.table;
}

Vec3 at(const Table& table, const std::string& name, std::size_t row) {
  return {table[name + ".1"][row], table[name + ".2"][row], table[name + ".3"][row]};
}

// What happens where no row is left idle: no start, a step without a solution, or multipliers that are round-off
// divided by round-off.
bool goes_wrong_without_idle_rows(const Scene& scene) {
  Model model = compile(scene);
  EXPECT_FALSE(model.initial.idle.empty());
  model.initial.idle.clear();
  const auto stepper = make_stepper(*model.system, *scene.transient);
  State state = model.initial;
  double weight = 0.0;
  for (const BodyScene& body : scene.bodies) weight += 9.81 * body.mass;
  StepReport report = stepper->start(state);
  for (int k = 0; k < 200 && report.converged; ++k) {
    report = stepper->step(state);
    if (!(state.lambda.cwiseAbs().maxCoeff() < 1e3 * weight)) return true;
  }
  return !report.converged || stepper->counters().tolerant > 10;
}

TEST(Redundancy, Bricard) {
  const Scene scene = hard_scene("bricard");
  RunReport report;
  const Table table = table_of(scene, &report);
  ASSERT_EQ(report.redundant.size(), 1u);
  EXPECT_EQ(report.redundant[0].substr(0, 13), "revolute \"P5\"");
  const auto error = [&](const Table& of) {
    double worst = 0.0;
    const std::pair<double, Vec3> known[] = {{1.0, {.5105014612, -1.6491675994, .1401231146}},
                                             {2.0, {-.9693403448, -1.2212468950, .7542780108}},
                                             {10.0, {.9999999638, -1.0002690127, .9997309511}}};
    for (const auto& [t, p] : known)
      worst = std::max(worst,
                       (at(of, "P3.position", static_cast<std::size_t>(std::lround(t / 0.05))) - p)
                           .cwiseAbs()
                           .maxCoeff());
    return worst;
  };
  EXPECT_LT(error(table), 1e-7);
  EXPECT_TRUE(goes_wrong_without_idle_rows(scene));
  Scene heavier = scene;  // one rod: the motion of equal ones does not depend on their mass
  heavier.bodies[2].mass *= 1.1;
  EXPECT_GT(error(table_of(heavier)), 1e-3);
  hard::record(
      {"1a", "Bricard's linkage, 30 constraints on 30 coordinates", "models/hard/bricard.xml",
       "IFToMM A04, minimal coordinates",
       bounded(error(table), 1e-7) + " m, worst coordinate of the third point at 1, 2 and 10 s",
       "no idle row: no start, or tolerant steps only, or multipliers beyond measure; one rod + 10 "
       "%"});
}

// Reactions of hinges on a line along e3 at z_i, each with three forces and two moments, of least norm in
// F^2 + (M/L)^2, that add up to the same force and moment.
std::vector<Vec6> least_norm(const std::vector<Vec6>& given, const std::vector<double>& z,
                             double L) {
  const auto n = static_cast<Index>(z.size());
  Eigen::MatrixXd G =
      Eigen::MatrixXd::Zero(5, 5 * n);  // total force and moment about the foot of the line
  VecX total = VecX::Zero(5);
  for (Index i = 0; i < n; ++i) {
    const double height = z[static_cast<std::size_t>(i)];
    G.block<3, 3>(0, 5 * i).setIdentity();
    G(3, 5 * i + 1) = -height;  // (0, 0, z) x F
    G(4, 5 * i) = height;
    G(3, 5 * i + 3) = G(4, 5 * i + 4) = L;  // moments over L
    VecX f(5);
    f << given[static_cast<std::size_t>(i)].head<4>(), given[static_cast<std::size_t>(i)](4);
    f.tail<2>() /= L;
    total += G.middleCols(5 * i, 5) * f;
  }
  const VecX x = G.completeOrthogonalDecomposition().solve(total);
  std::vector<Vec6> result(z.size(), Vec6::Zero());
  for (Index i = 0; i < n; ++i) {
    result[static_cast<std::size_t>(i)].head<3>() = x.segment<3>(5 * i);
    result[static_cast<std::size_t>(i)].segment<2>(3) = L * x.segment<2>(5 * i + 3);
  }
  return result;
}

// The note counts them all and names the first; the report has every one.
TEST(Redundancy, NoteOfManyIsACountAndTheFirst) {
  const Scene scene = read_model_text(R"(<mbd name="doors">
      <repeat count="40">
        <body name="door{i}" at="0 2*i 0" mass="20" center="0.5 0 0" inertia="1 1 1"/>
        <revolute name="low{i}" between="ground door{i}" at="0 2*i 0" axis="0 0 1"/>
        <revolute name="high{i}" between="ground door{i}" at="0 2*i 2" axis="0 0 1"/>
      </repeat>
      <transient duration="0.01" step="0.01"/></mbd>)",
                                      "doors.xml");
  RunReport report;
  (void)table_of(scene, &report);
  EXPECT_EQ(report.redundant.size(), 40u);
  ASSERT_FALSE(report.notes.empty());
  const std::string& note = report.notes.front();
  EXPECT_NE(note.find("200 of the constraints repeat others"), std::string::npos) << note;
  EXPECT_NE(note.find("and 36 more, all in report.json"), std::string::npos) << note;
  EXPECT_LT(note.size(), 1000u);
}

TEST(Redundancy, DoorOnThreeHinges) {
  const Scene scene = hard_scene("door");
  RunReport report;
  const Table table = table_of(scene, &report);
  EXPECT_EQ(report.redundant.size(), 2u);
  const double lean = 5.0 * pi / 180.0, b = 0.9, m = 20.0, g = 9.81;
  const Model model = compile(scene);
  const double L = 2.0;  // the largest distance of the scene: from the lowest hinge to the highest
  double worst = 0.0, balance = 0.0, energy = 0.0;
  for (std::size_t k = 0; k < table.columns[0].size(); ++k) {
    std::vector<Vec6> given;
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < 3; ++i) {
      Vec6 one;
      one << at(table, fmt::format("hinge{}.reaction_force", i), k),
          at(table, fmt::format("hinge{}.reaction_moment", i), k);
      given.push_back(one);
      sum += one.head<3>();
    }
    const std::vector<Vec6> least = least_norm(given, {0.0, 1.0, 2.0}, L);
    for (std::size_t i = 0; i < 3; ++i) {
      worst = std::max(worst, (least[i] - given[i]).cwiseAbs().maxCoeff() / (m * g));
      EXPECT_NEAR(given[i](5), 0.0, 1e-9 * m * g);
    }
    // Newton's law of the centre, in the plane of the motion: w^2 and its rate from energy.
    const double q = table["hinge0.angle"][k];  // from 0, falls to -pi/2 and on to -pi
    const double I = m * b * b / 3.0, G = m * g * std::sin(lean) * b / 2.0;
    const double w2 = 2.0 * G * -std::sin(q) / I, wdot = -G * std::cos(q) / I;
    const Vec3 e(std::cos(q), std::sin(q), 0.0), n(-std::sin(q), std::cos(q), 0.0);
    const Vec3 a = b / 2.0 * (wdot * n - w2 * e);
    const Vec3 f = m * (a - g * Vec3(0.0, -std::sin(lean), -std::cos(lean)));
    // Reactions are on the second part, the door, in axes of the joint: e3 up, e1 of the first part.
    balance = std::max(balance, std::abs(sum(2) - f(2)) / (m * g));
    balance = std::max(balance, std::abs(sum.head<2>().norm() - f.head<2>().norm()) / (m * g));
    energy = std::max(energy, std::abs(sum.norm()));
  }
  EXPECT_GT(energy, m * g * 0.9);
  EXPECT_LT(worst, 1e-9);
  EXPECT_LT(balance, 1e-5);
  EXPECT_TRUE(goes_wrong_without_idle_rows(scene));
  // The multipliers of the rows that are not idle, as they come: far from least norm.
  State state = model.initial;
  const auto stepper = make_stepper(*model.system, *scene.transient);
  ASSERT_TRUE(stepper->start(state).converged);
  EXPECT_GT((minimum_norm(*model.system, state) - state.lambda).cwiseAbs().maxCoeff(), 0.1 * m * g);
  hard::record({"1b", "door on three hinges, ten of fifteen constraints repeat others",
                "models/hard/door.xml",
                "motion: elliptic functions; reactions: least norm by a dense complete orthogonal "
                "decomposition",
                bounded(worst, 1e-9) +
                    " of the weight, reactions over two half swings; force of the centre " +
                    bounded(balance, 1e-5),
                "no idle row: no start, or tolerant steps only, or multipliers beyond measure; "
                "multipliers as they come: 0.1 of the weight off"});
}

// A door that leans in another direction, and hangs in another place, has the same reactions: the length that compares
// moments with forces is the scene's, whichever way that is turned. (With the diagonal of its box along the axes, 0.2 of
// the weight.)
TEST(Redundancy, LeastNormDoesNotDependOnTheFrame) {
  Scene scene = hard_scene("door");
  scene.bodies[0].center = Vec3(0.1, 0.2, 0.0);
  const auto reactions = [](const Scene& of) {
    const Model model = compile(of);
    State state = model.initial;
    const auto stepper = make_stepper(*model.system, *of.transient);
    EXPECT_TRUE(stepper->start(state).converged);
    const VecX lambda = minimum_norm(*model.system, state);
    VecX sizes(2 * 3);  // of force and moment of each hinge: their axes turn with the scene
    for (Index c = 0; c < 3; ++c) {
      const ConstraintInfo& info = model.system->constraints()[static_cast<std::size_t>(c)];
      double force = 0.0, moment = 0.0;
      for (Index i = 0; i < info.rows; ++i)
        (info.is_position[static_cast<std::size_t>(i)] ? force : moment) +=
            std::pow(lambda(info.first_row + i), 2);
      sizes(2 * c) = std::sqrt(force);
      sizes(2 * c + 1) = std::sqrt(moment);
    }
    return sizes;
  };
  const VecX here = reactions(scene);
  const double weight = 20.0 * 9.81;
  EXPECT_GT(here.minCoeff(), 1e-3 * weight);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Scene there = moved(scene, random_motion(seed, 3.0)).scene;
    EXPECT_LT((reactions(there) - here).cwiseAbs().maxCoeff(), 1e-9 * weight) << seed;
  }
}

TEST(Redundancy, TwoOfTheSame) {
  const std::string text = R"xml(<mbd name="twice">
    <body name="bob" at="1 0 0" mass="1" inertia="0.1 0.1 0.1"/>
    <revolute name="one" between="ground bob" at="0 0 0" axis="0 0 1"/>
    {}
    <gravity acceleration="0 -9.81 -3"/>
    <transient duration="2" method="{}" {} output="0.1"/>
    <record name="bob" at="bob" quantities="position"/>
    <record name="one" joint="one" quantities="reaction_force reaction_moment"/></mbd>)xml";
  const std::string other =
      R"xml(<revolute name="two" between="ground bob" at="0 0 0" axis="0 0 1"/>
    <record name="two" joint="two" quantities="reaction_force reaction_moment"/>)xml";
  double motion = 0.0, reactions = 0.0;
  for (const auto& [method, step] : {std::pair{"radau", "tolerance=\"1e-8\""},
                                     {"generalized_alpha", "step=\"1e-3\""},
                                     {"ida", "tolerance=\"1e-7\""}}) {
    const Table single =
        table_of(read_model_text(fmt::format(fmt::runtime(text), "", method, step), "single.xml"));
    const Table twice = table_of(
        read_model_text(fmt::format(fmt::runtime(text), other, method, step), "twice.xml"));
    for (std::size_t k = 0; k < single.columns[0].size(); ++k) {
      motion =
          std::max(motion, (at(single, "bob.position", k) - at(twice, "bob.position", k)).norm());
      for (const char* const what : {"reaction_force", "reaction_moment"})
        for (const char* const joint : {"one.", "two."})
          reactions = std::max(reactions, (at(single, std::string("one.") + what, k) / 2.0 -
                                           at(twice, std::string(joint) + what, k))
                                              .norm());
    }
  }
  EXPECT_LT(motion, 1e-9);
  EXPECT_LT(reactions, 1e-5);
  hard::record(
      {"1c", "two identical hinges; Radau, generalized-alpha, IDA", "in C++",
       "the run with one of them",
       bounded(motion, 1e-9) + " m; halves of the reactions " + bounded(reactions, 1e-5) + " N",
       "no idle row: does not start (1a, 1b)"});
}

TEST(Redundancy, ParallelogramOfRigidLinks) {
  const Scene scene = hard_scene("parallelogram");
  RunReport report;
  const Table table = table_of(scene, &report);
  double motion = 0.0, torque = 0.0;
  for (std::size_t k = 1; k < table.columns[0].size(); ++k) {
    const double q = pi / 2.0 + 2.0 * pi * table.columns[0][k];
    motion = std::max(
        motion,
        (at(table, "coupler.position", k) - Vec3(1.0 + std::cos(q), std::sin(q), 0.0)).norm());
    // Near the change points, where links are in line, torque goes through inertia of what round-off leaves.
    if (std::abs(std::sin(q)) > 0.2)
      torque =
          std::max(torque, std::abs(table["A.reaction_moment.3"][k] - 29.43 * std::cos(q)) / 29.43);
  }
  EXPECT_LT(motion, 1e-4);
  EXPECT_LT(torque, 1e-2);
  EXPECT_TRUE(goes_wrong_without_idle_rows(scene));
  Scene heavier = scene;
  heavier.bodies[1].mass *= 1.1;
  const Table other = table_of(heavier);
  EXPECT_GT(std::abs(other["A.reaction_moment.3"][20] - table["A.reaction_moment.3"][20]), 1.0);
  hard::record(
      {"1d", "parallelogram of rigid links through its change points, driven, 5 turns",
       "models/hard/parallelogram.xml", "closed form",
       bounded(motion, 1e-4) +
           " m, all steps (a gap of 1e-11 m is an angle of 3e-6 where links are in line); torque " +
           bounded(torque, 1e-2) + " of its largest, but for 12 degrees about the change points",
       "no idle row: no start, or tolerant steps only, or multipliers beyond measure; coupler + 10 "
       "%: torque 6 % off"});
}

// Parallel axes and bars that bend: nothing is redundant, nothing leaves the plane.
TEST(Redundancy, FlexibleFourBarHasUniqueReactions) {
  Scene scene = model_scene("four_bar", {{"tilt", "0"}, {"step", "9e-3"}});
  scene.transient->duration = 5.4;
  for (Section& section : scene.sections)  // bars that do not twist when stretched
    section.stiffness = Mat6(section.stiffness.diagonal().asDiagonal());
  RecordScene record;
  record.name = "D";
  record.joint = "D";
  record.quantities = {"reaction_force", "reaction_moment"};
  scene.records.push_back(record);
  RunReport report;
  const Table table = table_of(scene, &report);
  EXPECT_TRUE(report.redundant.empty());
  double out = 0.0, size = 0.0;
  for (std::size_t k = 0; k < table.columns[0].size(); ++k) {
    const Vec3 f = at(table, "D.reaction_force", k);
    out = std::max({out, std::abs(f(2)), std::abs(at(table, "D.reaction_moment", k)(0)) / 0.12});
    size = std::max(size, f.head<2>().norm());
  }
  EXPECT_LT(out, 1e-6 * size);
  const Scene rigid = hard_scene("parallelogram");
  EXPECT_FALSE(compile(rigid).redundant.empty());
  hard::record({"1e", "four-bar with parallel axes and flexible bars",
                "models/four_bar.xml, tilt=0, sections without coupling",
                "symmetry: no force or moment out of the plane",
                bounded(out / size, 1e-6) + " of the largest reaction in the plane, 0 to 5.4 s",
                "rigid bars: three rows are redundant"});
}

TEST(Redundancy, ContradictionsAreErrorsThatNameThePair) {
  // Two drives that agree at the start with their rates and accelerations, then part.
  const std::string text = R"xml(<mbd name="pair">
    <body name="bob" at="1 0 0" mass="1" inertia="0.1 0.1 0.1"/>
    <revolute name="one" between="ground bob" at="0 0 0" axis="0 0 1"/>
    <revolute name="two" between="ground bob" at="0 0 0" axis="0 0 1"/>
    <drive joint="one" angle="t^3"/>
    <drive joint="two" angle="{}*t^3"/>
    <transient duration="1" {} output="0.1"/>
    <record name="bob" at="bob" quantities="position"/></mbd>)xml";
  int refused = 0;
  for (const char* const how :
       {"method=\"radau\" tolerance=\"1e-6\"", "step=\"0.01\"", "method=\"radau\" step=\"0.01\"",
        "method=\"ida\" tolerance=\"1e-6\""}) {
    const RunReport same =
        run(read_model_text(fmt::format(fmt::runtime(text), 1, how), "same.xml"), {});
    EXPECT_TRUE(same.complete()) << how << ": " << same.failure;
    const RunReport report =
        run(read_model_text(fmt::format(fmt::runtime(text), 1.5, how), "pair.xml"), {});
    EXPECT_FALSE(report.complete()) << how;
    EXPECT_NE(report.failure.find("contradict"), std::string::npos)
        << how << ": " << report.failure;
    EXPECT_NE(report.failure.find("drive of 'two'"), std::string::npos) << report.failure;
    EXPECT_NE(report.failure.find("drive of 'one'"), std::string::npos) << report.failure;
    EXPECT_GE(report.rows, 1) << how;
    refused += report.complete() ? 0 : 1;
  }
  hard::record({"1f", "two drives of one joint whose laws part after the start; four integrators",
                "in C++", "the failure names both",
                fmt::format("{} of 4 end with the reason, rows kept", refused),
                "equal laws: run to the end"});
}

}  // namespace
}  // namespace mbd::test::test_redundancy
