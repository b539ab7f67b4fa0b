// Steady rotations through folds and besides: a pendulum on a turning arm and a slider with a hardening spring, whose rotations
// are roots of one equation; the paper's shaft in time.
#include "libmbd/study/modes/rotations.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "libmbd/core/se3.hpp"
#include "libmbd/study/modes/campbell.hpp"
#include "libmbd/study/modes/states_of_run.hpp"
#include "libmbd/study/trust/transform.hpp"
#include "solvers/modes/rotation_path.hpp"
#include "solvers/statics/equilibrium.hpp"
#include "tests/support/program_test.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_rotations {
namespace {

constexpr double pi = std::numbers::pi;
using Function = std::function<double(double)>;

// Roots of f between a and b, to round-off, with a grid that is fine beside them.
std::vector<double> roots(const Function& f, double a, double b) {
  std::vector<double> all;
  constexpr int grid = 20000;
  for (int k = 0; k < grid; ++k) {
    double x0 = a + (b - a) * k / grid, x1 = a + (b - a) * (k + 1) / grid;
    if (!(f(x0) * f(x1) < 0.0)) continue;
    for (int i = 0; i < 80; ++i) {
      const double x = 0.5 * (x0 + x1);
      (f(x) * f(x0) > 0.0 ? x0 : x1) = x;
    }
    all.push_back(x0);
  }
  return all;
}

// A bob on a hinge at the distance e from the axis, weight along it: W^2 (e + l sin a) cos a = g sin a.
struct PendulumOnAnArm {
  double e = 0.1, l = 1.0, g = 9.81;

  Scene scene() const {
    return read(fmt::format(
        R"(<body name="hub" mass="1" inertia="1 1 1"/>
           <revolute name="axle" between="ground hub" axis="0 0 1"/><drive joint="axle" angle="0"/>
           <body name="bob" at="{0} 0 {1}" mass="2" inertia="0 0 0"/>
           <revolute name="hinge" between="hub bob" at="{0} 0 0" axis="0 1 0"/>
           <gravity acceleration="0 0 {2}"/><static/>)",
        e, -l, -g));
  }
  // Of the angle in turning axes, a'' = f.
  double f(double a, double W) const {
    return (W * W * (e + l * std::sin(a)) * std::cos(a) - g * std::sin(a)) / l;
  }
  double rise(double a, double W) const {  // df/da
    const double s = std::sin(a), c = std::cos(a);
    return (W * W * (l * c * c - (e + l * s) * s) - g * c) / l;
  }
  std::vector<double> angles(double W) const {
    return roots([&](double a) { return f(a, W); }, -pi, pi);
  }
  // The rate at which two rotations meet: W^2 of an angle is least there.
  double fold() const {
    const Function square = [this](double a) {
      return g * std::sin(a) / ((e + l * std::sin(a)) * std::cos(a));
    };
    const double h = 1e-5;  // of the derivative, whose root is wanted to 1e-9
    const std::vector<double> at = roots([&](double a) { return square(a + h) - square(a - h); },
                                         -1.3, -std::asin(e / l) - 0.01);
    EXPECT_EQ(at.size(), 1U);
    return std::sqrt(square(at.at(0)));
  }
};

RotationsOptions between(double from, double to, const Vec3& axis = Vec3::UnitZ()) {
  RotationsOptions options;
  options.rotation.axis = axis;
  options.from = from;
  options.to = to;
  return options;
}

std::vector<RotationOnPath> folds(const RotationsStudy& study) {
  std::vector<RotationOnPath> all;
  for (const PathOfRotations& path : study.paths)
    for (const RotationOnPath& point : path.points)
      if (point.is_fold) all.push_back(point);
  return all;
}

// Points at the last rate, which paths end at.
std::vector<RotationOnPath> at_end(const RotationsStudy& study) {
  std::vector<RotationOnPath> all;
  for (const PathOfRotations& path : study.paths)
    for (const RotationOnPath* point : {&path.points.front(), &path.points.back()})
      if (point->rate == study.to) all.push_back(*point);
  return all;
}

// All four of them, one that stands on its head among them. Mutations seen: a tangent without the
// sense of the one before; pushes in one sense alone (which the slider below sees).
TEST(Rotations, OfAPendulumOnAnArm) {
  const PendulumOnAnArm pendulum;
  for (const double to : {5.0, 8.0}) {
    RotationsOptions options = between(0.0, to);
    options.probes = {"bob"};
    const RotationsStudy study = study_rotations(pendulum.scene(), options);
    const std::vector<RotationOnPath> turning_back = folds(study);
    ASSERT_EQ(turning_back.size(), 1U);
    EXPECT_NEAR(turning_back[0].rate, pendulum.fold(), 1e-8);
    std::vector<double> wanted = pendulum.angles(to);
    ASSERT_EQ(wanted.size(), 4U);
    for (const RotationOnPath& point : at_end(study)) {
      const Vec3& moved = point.probes.at(0);
      const double a = std::atan2(moved.x(), pendulum.l - moved.z());
      const auto known =
          std::ranges::find_if(wanted, [&](double angle) { return std::abs(angle - a) < 1e-9; });
      ASSERT_NE(known, wanted.end()) << a;
      wanted.erase(known);  // each once
      const double rise = pendulum.rise(a, to);
      EXPECT_EQ(point.unstable, rise > 0.0 ? 1 : 0) << a;
      EXPECT_NEAR(point.growth, rise > 0.0 ? std::sqrt(rise) : 0.0, 1e-7) << a;
      EXPECT_NEAR(point.displacement, 2.0 * pendulum.l * std::abs(std::sin(0.5 * a)), 1e-9);
    }
    EXPECT_TRUE(wanted.empty()) << "not found: " << wanted.front();
    // Every point is a rotation, not only those at the ends.
    for (const PathOfRotations& path : study.paths)
      for (const RotationOnPath& point : path.points) {
        const double a = std::atan2(point.probes[0].x(), pendulum.l - point.probes[0].z());
        EXPECT_LT(std::abs(pendulum.f(a, point.rate)), 1e-6) << point.rate;
      }
  }
}

// Elsewhere, in mm, and with what would be the axis by default across it.
TEST(Rotations, AreTheSameElsewhere) {
  const PendulumOnAnArm pendulum;
  const RigidMotion motion = random_motion(5, 3.0);
  RotationsOptions options = between(2.0, 6.0);
  const RotationsStudy here = study_rotations(pendulum.scene(), options);
  const Scene other =
      moved(rescaled(pendulum.scene(), {1e3, 1e-3, 1.0}).scene, {motion.R, 1e3 * motion.shift})
          .scene;
  options.rotation.axis = motion.R * Vec3::UnitZ();
  options.rotation.through = 1e3 * motion.shift;
  const RotationsStudy there = study_rotations(other, options);
  ASSERT_EQ(there.paths.size(), here.paths.size());
  ASSERT_EQ(folds(here).size(), 1U);
  ASSERT_EQ(folds(there).size(), 1U);
  EXPECT_NEAR(folds(there)[0].rate, folds(here)[0].rate, 1e-8);
  EXPECT_NEAR(folds(there)[0].displacement, 1e3 * folds(here)[0].displacement,
              0.1);  // flat in the rate
}

// A slider at e from the axis on a spring k s + q s^3: m W^2 (e + s) = k s + q s^3, three rotations beyond a fold.
TEST(Rotations, OfASliderOnAHardeningSpring) {
  const double m = 2.0, e = 0.01, k = 50.0, q = 4000.0, to = 9.0;
  const Scene scene = read(fmt::format(
      R"(<body name="arm" mass="1" inertia="1 1 1"/><revolute name="axle" between="ground arm" axis="1 0 0"/>
         <drive joint="axle" angle="0"/>
         <body name="bead" at="0 {} 0" mass="{}" inertia="1e-3 1e-3 1e-3"/>
         <prismatic name="slot" between="arm bead" axis="0 1 0"/>
         <joint_spring name="s" joint="slot" force="{}*x + {}*x^3"/><static/>)",
      e, m, k, q));
  RotationsOptions options = between(0.0, to, Vec3::UnitX());
  options.probes = {"bead"};
  const RotationsStudy study = study_rotations(scene, options);
  // With W^2 = (k s + q s^3)/(m (e + s)), dW^2/ds = 0: (k + 3 q s^2)(e + s) = k s + q s^3.
  const std::vector<double> at = roots(
      [&](double s) { return (k + 3.0 * q * s * s) * (e + s) - k * s - q * s * s * s; }, -1.0, 1.0);
  ASSERT_EQ(at.size(), 1U);
  ASSERT_EQ(folds(study).size(), 1U);
  EXPECT_NEAR(folds(study)[0].rate,
              std::sqrt((k * at[0] + q * std::pow(at[0], 3)) / (m * (e + at[0]))), 1e-8);
  std::vector<double> wanted =
      roots([&](double s) { return m * to * to * (e + s) - k * s - q * s * s * s; }, -1.0, 1.0);
  ASSERT_EQ(wanted.size(), 3U);
  const std::vector<RotationOnPath> found = at_end(study);
  ASSERT_EQ(found.size(), 3U);
  for (const double s : wanted)
    EXPECT_TRUE(std::ranges::any_of(found, [&](const RotationOnPath& point) {
      return std::abs(point.probes[0].y() - s) < 1e-9;
    })) << s;
  // Bent outward, against it, and self-centred in between, which the spring does not hold.
  for (const RotationOnPath& point : found) {
    const double s = point.probes[0].y();
    EXPECT_EQ(point.unstable, m * to * to > k + 3.0 * q * s * s ? 1 : 0) << s;
  }
}

// ---- the paper's shaft ------------------------------------------------------------------------------------------

Scene shaft(const std::string& d, double steady = 0.0) {
  Scene scene = model_scene("shaft", {{"d", d}, {"steady", fmt::format("{}", steady)}});
  scene.beams[0].elements = 4;
  scene.gravity.reset();
  return scene;
}

// Beside the critical speed of the balanced shaft, 53.5976, a small unbalance d opens the fork by d^(2/3).
TEST(Rotations, ForkOfTheShaftOpensWithItsUnbalance) {
  const auto opening = [](const std::string& d, double to) {
    RotationsOptions options = between(50.0, to, Vec3::UnitX());
    options.searches = 1;  // at the last rate
    options.count = 2;
    const std::vector<RotationOnPath> found = folds(study_rotations(shaft(d), options));
    EXPECT_EQ(found.size(), 1U);
    return found.empty() ? 0.0 : found[0].rate - 53.5976;
  };
  const double small = opening("1e-3", 55.0), large = opening("8e-3", 56.0);
  EXPECT_GT(small, 0.1);
  EXPECT_NEAR(large / small, 4.0, 0.1);
}

// In balance it may bend anywhere: rotations that differ in nothing else are no paths. Mutation seen: all of them taken (40 paths).
TEST(Rotations, OfARoundRotorInBalanceAreLeftOut) {
  RotationsOptions options = between(50.0, 60.0, Vec3::UnitX());
  options.searches = 1;
  options.count = 2;
  const RotationsStudy study = study_rotations(shaft("0"), options);
  ASSERT_EQ(study.paths.size(), 1U);
  EXPECT_LT(study.paths[0].points.back().displacement, 1e-9);
  ASSERT_FALSE(study.notes.empty());
  EXPECT_SAYS(study.notes.back(), "where their bend points");
}

// What is said of rotations holds in time: in each of its three shapes the shaft turns on as it is, by an integrator that knows
// nothing of steady rotations; half way between two it does not.
TEST(Rotations, StayAsTheyAreInTime) {
  const double W = 60.0, begin = 4.0 * pi / W;
  Scene scene = shaft("0.05");
  // At rest at first, as a model has to be; it is looked at after the first turn.
  scene.drives[0].rate =
      Expression::parse("t >= pi/15 ? 60 : 60*(15*t/pi)^2*(3 - 30*t/pi)", {}, Variables::time);
  scene.statics.emplace();
  MotionsOfScene rotor(scene);
  const SteadyRotation rotation{W};
  rotor.turn(rotation);
  const System& system = *rotor.model().system;
  // From one state so far on the way to another.
  const auto on_the_way = [&](const State& a, double share, const auto& pose_of_b) {
    State state = a;
    for (std::size_t n = 1; n < a.pose.size(); ++n)
      state.pose[n] =
          a.pose[n] * exp_se3<double>(Vec6(share * log_se3(relative(a.pose[n], pose_of_b(n)))));
    return state;
  };
  // In balance with itself, hardly bent; pushed along its bend and against it, where the force vanishes it is bent far.
  const State bent = rotor.state();
  std::vector<State> all{bent};
  VecX bend = VecX::Zero(rotor.motions().motions());
  for (std::size_t n = 1; n < bent.pose.size(); ++n)
    bend.segment<6>(6 * static_cast<Index>(n - 1)) =
        log_se3(relative(system.reference_pose(static_cast<Index>(n)), bent.pose[n]));
  const VecX force = W * W * rotor.motions().mass_times(Eigen::MatrixXd(bend)).col(0);
  for (const bool rising : {false, true}) {
    RotationPathOptions along;
    along.from = -20.0;
    along.to = 20.0;
    along.largest_step = 0.005;
    along.rising = rising;
    double share = 0.0;
    along.accepted = [&](const RotationPoint& point) {
      const bool is_met = share * point.parameter < 0.0;
      if (is_met) all.push_back(point.state);
      share = point.parameter;
      return !is_met;
    };
    follow_pushed_rotations(rotor.motions(), rotation, bent, force, along);
  }
  ASSERT_EQ(all.size(), 3U);
  Counters counters;
  std::string failure;
  for (State& one : all)
    EXPECT_TRUE(solve_steady_rotation(rotor.motions(), rotation, {}, one, counters, failure))
        << failure;
  const double apart = distance_between(rotor.motions(), bent, all[1]);
  EXPECT_GT(apart, 0.1);
  EXPECT_GT(distance_between(rotor.motions(), all[2], all[1]), apart);

  const double duration = begin + 4.0 * 2.0 * pi / W;
  const Scene run = scene_of_run(scene, duration);
  const Model model = compile(run);
  // After four turns poses are what they were.
  const auto drift = [&](State start) {
    model.system->set_time(start, begin);
    for (double& angle : start.angles) angle += 2.0 * pi;
    turn_steadily(rotation, start);
    EXPECT_EQ(make_consistent(*model.system, start), "");
    const State end = states_of_run(run, model, start, {duration}, "test").front();
    return distance_between(rotor.motions(), start, end) / apart;
  };
  for (const State& one : all) EXPECT_LT(drift(one), 1e-3);
  EXPECT_GT(drift(on_the_way(all[1], 0.5, [&](std::size_t n) { return bent.pose[n]; })), 0.1);
}

// ---- uses and misuses -------------------------------------------------------------------------------------------

TEST(Rotations, RefuseByName) {
  const auto refused = [](const Scene& scene, const RotationsOptions& options) -> std::string {
    try {
      study_rotations(scene, options);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  const Scene scene = PendulumOnAnArm().scene();
  EXPECT_SAYS(refused(scene, between(5.0, 2.0)), "rates: give two that rise");
  EXPECT_SAYS(refused(scene, between(-1.0, 2.0)), "rates: give two that rise");
  EXPECT_SAYS(refused(scene, between(0.0, 2.0, Vec3::UnitX())),
              "does not let it turn about the axis");
  RotationsOptions options = between(0.0, 2.0);
  options.probes = {"bop"};
  EXPECT_SAYS(refused(scene, options), "bob");
  options = between(0.0, 2.0);
  options.rotation.axis = Vec3::UnitX();
  EXPECT_SAYS(refused(model_scene("shaft"), options), "leave that out (--without)");
}

// A disk out of balance on soft bearings moves their housing round: what is at rest is none. From rest on it looks as if it
// were: forces of unbalance show with the rate. Mutation seen: coefficients looked at once (a Campbell diagram up to 13 rad/s).
TEST(Rotations, WhatUnbalanceMovesDoesNotRest) {
  const Scene scene = read(R"(
      <body name="housing" mass="1" inertia="1e-3 1e-3 1e-3"/>
      <body name="disk" mass="20" center="0 0.001 0" inertia="0.4 0.2 0.2"/>
      <bushing name="bearing" between="ground housing" stiffness="1e6 2e5 2e5"
               angular_stiffness="1e6 1e6 1e6" damping="1e3 40 40"/>
      <revolute name="R" between="housing disk" axis="1 0 0"/><static/>)");
  RotationsOptions options = between(0.0, 200.0, Vec3::UnitX());
  options.at_rest = {"housing"};
  EXPECT_THROW(study_rotations(scene, options), Error);
  CampbellOptions diagram;
  diagram.to = 200.0;
  diagram.at_rest = {"housing"};
  try {
    study_campbell(scene, diagram);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_SAYS(std::string(error.what()), "no small motions with constant coefficients at");
  }
}

TEST(Rotations, InterruptedEndWithWhatThereIs) {
  std::atomic<bool> stop = false;
  RotationsOptions options = between(0.0, 8.0);
  options.interrupted = &stop;
  std::size_t points = 0;
  options.progress = [&](std::size_t, double) { stop = ++points >= 10; };
  const RotationsStudy study = study_rotations(PendulumOnAnArm().scene(), options);
  ASSERT_EQ(study.paths.size(), 1U);
  EXPECT_GE(study.paths[0].points.size(), 10U);
  ASSERT_FALSE(study.notes.empty());
  EXPECT_SAYS(study.notes.back(), "interrupted");
}

using RotationsOfTheProgram = ProgramTest;

TEST_F(RotationsOfTheProgram, AreWritten) {
  const std::string model =
      quote((std::filesystem::path(MBD_SOURCE_DIR) / "models/shaft.xml").string());
  const Output made = mbd("rotations " + model +
                          " --rates \"480:580 rpm\" --without gravity "
                          "--search 1 --count 2 --probe disk -o d");
  ASSERT_EQ(made.status, 0) << made.text;
  EXPECT_SAYS(made.text, "2 paths of steady rotations from 50.2655 to 60.7375 rad/s");
  EXPECT_SAYS(made.text, "turns back at 56.9");
  const Table table = read_csv(file("d/rotations.csv"));
  ASSERT_GT(table.rows(), 20U);
  for (std::size_t k = 0; k < table.rows(); ++k) {
    const double moved =
        std::hypot(table["disk.displacement.1"][k],
                   std::hypot(table["disk.displacement.2"][k], table["disk.displacement.3"][k]));
    EXPECT_LE(moved, table["displacement"][k] * (1.0 + 1e-12));
    EXPECT_GE(table["rate"][k], 50.2654);
    EXPECT_LE(table["rate"][k], 60.7376);
  }
  EXPECT_SAYS(here("cat d/rotations.svg").text, "folds");
  for (const auto& [words, said] :
       {std::pair{"--rates 5", "FROM:TO"}, std::pair{"--rates 9:5", "rise"},
        std::pair{"--rates 0:5 --step 0", "--step 0: give more than 0"},
        std::pair{"--rates 0:5 --far 0", "--far 0: give more than 0"},
        std::pair{"--rates 0:5 --search -1", "give 0 to 1000"},
        std::pair{"--rates 0:5 --points 1", "give 2 to 100000"},
        std::pair{"--rates 0:5 --count 0", "give 1 to 1000"}}) {
    const Output refused = mbd("rotations " + model + ' ' + words + " -o no");
    EXPECT_EQ(refused.status, 1) << words;
    EXPECT_SAYS(refused.text, said);
    EXPECT_FALSE(std::filesystem::exists(file("no")));
  }
}

}  // namespace
}  // namespace mbd::test::test_rotations
