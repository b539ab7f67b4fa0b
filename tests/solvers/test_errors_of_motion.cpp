// Steps that are held by the errors of positions and rotations alone: what they cost and keep on stiff scenes, on small
// motions, and where a recorded quantity would see what they leave.
//
// Tried in the library, and killed: errors relative to the scene's length; the turn of rejected steps counted; velocities counted
// after all; the default without a look at velocities, at forces, at energies; NaN of velocities that do not count let through.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/run/describe.hpp"
#include "solvers/time/error_control.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_errors_of_motion {
namespace {

// ---- norm

TEST(ErrorsOfMotion, AreRelativeToTheLargestMotionSoFar) {
  const Model model = compile(read(R"(
    <body name="a" mass="1" inertia="1 1 1"/><body name="b" at="4 0 0" mass="1" inertia="1 1 1"/>
    <transient duration="2" step="0.01"/>)"));
  const double L = model.system->length_scale();
  ErrorNorm norm(*model.system, {.relative = 1e-3, .of = ErrorsOf::motion}, 10.0);
  State begin = model.initial, end = begin;
  begin.V[1] << 5, 0, 0, 0, 0, 0;
  end.pose[1].r.x() += 0.01 * L;
  end.pose[2].p = Eigen::Quaterniond(Eigen::AngleAxisd(0.02, Vec3::UnitZ()));
  std::vector<Vec6> U(3, Vec6::Zero()), V(3, Vec6::Zero());
  norm.measure(begin, end);
  U[2](1) = 1e-3 * 0.01 * L;
  EXPECT_NEAR(norm(U, V, 1.0), 1.0, 1e-13);
  U[1](4) = 2e-3 * 0.02;  // of a turn, whose chord is taken
  EXPECT_NEAR(norm(U, V, 1.0), 2.0, 1e-4);
  V[1](0) = 0.5;  // of 5 m/s: does not count
  EXPECT_NEAR(norm(U, V, 1.0), 2.0, 1e-4);
  EXPECT_NEAR(norm.velocity_left(), 0.1, 1e-14);
  // A step that was rejected is no motion; one that was accepted stays.
  norm.measure(begin, begin);
  norm.measure(begin, begin);
  EXPECT_NEAR(norm.limits().position, 1e-3 * 1e-6 * L, 1e-18);
  norm.measure(end, end);
  norm.measure(begin, begin);
  EXPECT_NEAR(norm.limits().position, 1e-3 * 0.01 * L, 1e-15);
  // At most a length of the scene and a radian.
  end.pose[1].r.x() += 50.0 * L;
  end.pose[2].p = Eigen::Quaterniond(Eigen::AngleAxisd(3.0, Vec3::UnitZ()));
  norm.measure(begin, end);
  EXPECT_NEAR(norm.limits().position, 1e-3 * L, 1e-15);
  EXPECT_NEAR(norm.limits().rotation, 1e-3, 1e-15);
  V[2](4) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(norm(U, V, 1.0)));
}

// ---- which of them steps are held by

ErrorsOf default_of(const std::string& records, const std::string& transient = "") {
  return errors_of(read(
      fmt::format(R"(
    <section name="s"> <stiffness EA="1e6" GA2="1e6" GA3="1e6" GJ="80" EI2="100" EI3="100"/>
      <mass per_length="1" inertia="2e-4 1e-4 1e-4"/></section>
    <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1"/>
    <revolute name="A" between="ground b.start" axis="0 1 0"/>
    <spring name="k" between="ground b.end" at_a="1 0 1" stiffness="10"/>
    <transient duration="1" {}/> {})",
                  transient.empty() ? R"(method="radau" tolerance="1e-3")" : transient, records)));
}

TEST(ErrorsOfMotion, AreTheDefaultWhereNothingRecordedSeesVelocities) {
  const std::string place = R"(<record name="p" at="b.end" quantities="{}"/>)",
                    joint = R"(<record name="j" joint="A" quantities="{}"/>)",
                    spring = R"(<record name="k" spring="k" quantities="{}"/>)",
                    all = R"(<record name="a" quantities="{}"/>)";
  const auto of = [](const std::string& record, const std::string& quantities) {
    return default_of(fmt::format(fmt::runtime(record), quantities));
  };
  EXPECT_EQ(of(place, "position displacement rotation displacement_local"), ErrorsOf::motion);
  EXPECT_EQ(of(joint, "angle"), ErrorsOf::motion);
  EXPECT_EQ(of(spring, "length"), ErrorsOf::motion);
  for (const char* seen : {"velocity", "acceleration", "angular_velocity", "position velocity",
                           "displacement force", "moment"})
    EXPECT_EQ(of(place, seen), ErrorsOf::velocities) << seen;
  for (const char* seen : {"rate", "reaction_force", "angle reaction_moment"})
    EXPECT_EQ(of(joint, seen), ErrorsOf::velocities) << seen;
  EXPECT_EQ(of(spring, "tension"), ErrorsOf::velocities);
  for (const char* seen : {"kinetic_energy", "strain_energy", "linear_momentum"})
    EXPECT_EQ(of(all, seen), ErrorsOf::velocities) << seen;
  EXPECT_EQ(default_of(""), ErrorsOf::velocities);  // who asks for nothing may look at anything
  const std::string positions = fmt::format(fmt::runtime(place), "position");
  EXPECT_EQ(default_of(positions, R"(method="radau" tolerance="1e-3" errors="velocities")"),
            ErrorsOf::velocities);
  EXPECT_EQ(default_of(positions, R"(method="radau" tolerance="1e-3" velocity_tolerance="1")"),
            ErrorsOf::velocities);
  EXPECT_EQ(default_of(positions, R"(method="radau" step="1e-3")"), ErrorsOf::velocities);
  EXPECT_EQ(default_of(positions, R"(method="ida" tolerance="1e-3")"), ErrorsOf::velocities);
  EXPECT_EQ(default_of(fmt::format(fmt::runtime(place), "velocity"),
                       R"(method="radau" tolerance="1e-3" errors="motion")"),
            ErrorsOf::motion);
}

// ---- what they cost and keep

Scene adaptive(Scene scene, double tolerance, std::optional<ErrorsOf> errors, double output) {
  TransientScene& t = *scene.transient;
  t.method = TimeMethod::radau;
  t.step.reset();
  t.rho_infinity.reset();
  t.tolerance = tolerance;
  t.errors = errors;
  t.output = output;
  scene.expects.clear();
  return scene;
}

// Largest distance of the points that the columns name, over the largest distance from the first one.
double error_of(const Table& is, const Table& reference, const std::vector<std::string>& columns) {
  EXPECT_EQ(is.rows(), reference.rows());
  double worst = 0.0, motion = 0.0;
  for (std::size_t k = 0; k < std::min(is.rows(), reference.rows()); ++k) {
    double e = 0.0, u = 0.0;
    for (const std::string& name : columns) {
      e += std::pow(is[name][k] - reference[name][k], 2);
      u += std::pow(reference[name][k] - reference[name][0], 2);
    }
    worst = std::max(worst, e);
    motion = std::max(motion, u);
  }
  return std::sqrt(worst / motion);
}

// Two stiff rods, whose axial waves have velocities of 1e-4 of the fastest. The reference goes in fixed steps, and is itself
// within 2e-4 of two rigid rods (models/double_pendulum_beams.xml).
TEST(ErrorsOfMotionSlow, OfStiffRodsNeedAFractionOfTheSteps) {
  Scene scene = model_scene("double_pendulum_beams");
  scene.records.resize(1);  // of the tip
  scene.records.front().quantities = {"position"};
  Scene fine = scene;
  fine.transient->method = TimeMethod::radau;
  fine.transient->rho_infinity.reset();
  fine.transient->step = 1e-4;
  fine.transient->output = 0.02;
  const Table reference = run_to_table(fine).table;
  const std::vector<std::string> tip = {"tip.position.1", "tip.position.2", "tip.position.3"};
  long steps = 0;
  for (const double tolerance : {1e-3, 1e-4, 1e-5, 1e-6}) {
    const History is = run_to_table(adaptive(scene, tolerance, {}, 0.02));
    ASSERT_TRUE(is.report.complete()) << is.report.failure;
    EXPECT_EQ(is.report.transient->errors, ErrorsOf::motion);
    EXPECT_LT(error_of(is.table, reference, tip), tolerance) << tolerance;
    EXPECT_GT(is.report.step_sizes.velocity_left, 0.0);
    if (tolerance == 1e-5) steps = is.report.transient_counters.steps;
  }
  const History all = run_to_table(adaptive(scene, 1e-5, ErrorsOf::velocities, 0.02));
  ASSERT_TRUE(all.report.complete()) << all.report.failure;
  EXPECT_LT(5 * steps, all.report.transient_counters.steps) << steps;
}

// In a scene of 100 m a mass swings by a tenth of a millimetre: x = a sin(w t). The error is that of the amplitude, and
// falls with the tolerance.
TEST(ErrorsOfMotion, OfSmallMotionsAreAsSmall) {
  const double a = 1e-4, w = 20.0;
  for (const double tolerance : {1e-3, 1e-4, 1e-6}) {
    const Scene scene = read(fmt::format(R"(
      <body name="m" at="0.5 0 0" mass="2" inertia="1 1 1" velocity="{} 0 0"/>
      <prismatic name="rail" between="ground m" axis="1 0 0"/>
      <spring name="k" between="ground m" at_a="0 0 0" stiffness="800"/>
      <body name="far" at="100 0 0" mass="1" inertia="1 1 1"/>
      <prismatic name="other" between="ground far" axis="1 0 0"/>
      <transient duration="2" method="radau" tolerance="{}" output="0.01"/>
      <record name="x" joint="rail" quantities="displacement"/>)",
                                         a * w, tolerance));
    const History is = run_to_table(scene);
    ASSERT_TRUE(is.report.complete()) << is.report.failure;
    double worst = 0.0;
    for (std::size_t k = 0; k < is.table.rows(); ++k)
      worst = std::max(
          worst, std::abs(is.table["x.displacement"][k] - a * std::sin(w * is.table["time"][k])));
    EXPECT_LT(worst / a, tolerance) << tolerance;
    EXPECT_GT(worst / a, 1e-3 * tolerance) << tolerance;
  }
}

// Errors of positions and angles go with the tolerance, as they do where velocities count: within 10 of it, the largest of
// all rows over the largest motion; references are a hundred times as fine.
TEST(ErrorsOfMotionSlow, GoWithTheToleranceOnOtherModels) {
  struct Case {
    const char* model;
    double duration, output;
    std::vector<std::string> columns;
  };
  const std::vector<Case> cases = {
      {"pendulum", 10.0, 0.05, {"bob.position.1", "bob.position.2", "bob.position.3"}},
      {"double_pendulum", 2.0, 0.02, {"tip.position.1", "tip.position.2", "tip.position.3"}},
      {"windows", 10.0, 0.05, {"last.position.1", "last.position.2", "last.position.3"}},
      {"shaft", 1.0, 0.01, {"M.displacement.1", "M.displacement.2", "M.displacement.3"}},
      {"hard/truss_snaps",
       20.0,
       0.02,
       {"M.displacement.1", "M.displacement.2", "M.displacement.3"}},
      {"heavy_top", 1.0, 0.01, {"top.position.1", "top.position.2", "top.position.3"}}};
  for (const Case& of : cases) {
    Scene scene = model_scene(of.model);
    scene.transient->duration = of.duration;
    const Table reference =
        run_to_table(adaptive(scene, 1e-8, ErrorsOf::velocities, of.output)).table;
    for (const double tolerance : {1e-3, 1e-4, 1e-6}) {
      const History is = run_to_table(adaptive(scene, tolerance, ErrorsOf::motion, of.output));
      ASSERT_TRUE(is.report.complete()) << of.model << ": " << is.report.failure;
      EXPECT_LT(error_of(is.table, reference, of.columns), 10.0 * tolerance)
          << of.model << " " << tolerance;
    }
  }
}

// What is recorded decides: with the tip's velocity beside it the run is that of errors="velocities", to the last bit.
TEST(ErrorsOfMotion, GiveWayToAVelocityThatIsRecorded) {
  Scene scene = model_scene("double_pendulum");
  scene.records.resize(1);  // position and velocity of the tip
  const Table is = run_to_table(adaptive(scene, 1e-4, {}, 0.02)).table,
              all = run_to_table(adaptive(scene, 1e-4, ErrorsOf::velocities, 0.02)).table;
  EXPECT_EQ(is.columns, all.columns);
  scene.records.front().quantities = {"position"};
  const Table other = run_to_table(adaptive(scene, 1e-4, {}, 0.02)).table;
  EXPECT_NE(other["tip.position.1"], all["tip.position.1"]);
}

TEST(ErrorsOfMotion, AreSaidBeforeARun) {
  const auto plan = [](const Scene& of) {
    std::string text = to_text(check_model(of, compile(of)));
    for (std::size_t at; (at = text.find("\n     ")) != std::string::npos;)
      text.replace(at, text.find_first_not_of(" \n", at) - at, " ");
    return text;
  };
  Scene scene = adaptive(model_scene("double_pendulum"), 1e-4, {}, 0.02);
  EXPECT_EQ(plan(scene).find("errors of motion"), std::string::npos);
  scene.records.resize(1);
  scene.records.front().quantities = {"position"};
  EXPECT_SAYS(plan(scene), "errors of motion alone");
}

TEST(ErrorsOfMotion, AreRefusedWhereThereAreNone) {
  const auto said = [](const std::string& transient) {
    return message(fmt::format(
        R"(<body name="a" mass="1" inertia="1 1 1"/><transient duration="1" {}/>)", transient));
  };
  EXPECT_SAYS(said(R"(step="0.1" method="radau" errors="motion")"),
              R"(errors belongs to "tolerance")");
  EXPECT_SAYS(said(R"(tolerance="1e-3" errors="motion")"), R"(or give method="radau")");
  EXPECT_SAYS(said(R"(tolerance="1e-3" method="ida" errors="velocities")"),
              "holds those of velocities as well");
  EXPECT_SAYS(said(R"(tolerance="1e-3" method="radau" errors="motion" velocity_tolerance="1")"),
              "holds no velocities");
  EXPECT_SAYS(said(R"(tolerance="1e-3" method="radau" errors="some")"), "motion");
}

}  // namespace
}  // namespace mbd::test::test_errors_of_motion
