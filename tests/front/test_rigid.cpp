// Beams and bodies that are declared rigid, alone and as a group: mass properties in closed form, equality with a
// body of the same ones, and the limit of ever stiffer beams.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "elements/node/mass.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_rigid {
namespace {

constexpr double pi = std::numbers::pi;

Scene scene_of(const std::string& items) {
  return read_model_text("<mbd name=\"m\">" + items + "</mbd>", "m.xml");
}

const std::string section =
    R"(<section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="100" EI2="200" EI3="150"/>
       <mass per_length="2" inertia="0.004 0.002 0.002" center="0.01 0.02"/></section>)";
const std::string straight =
    R"(<beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2" order="1"/>)";

// Largest difference of a column over its largest value.
double difference(const Table& a, const Table& b, const std::string& column) {
  double most = 0.0, size = 0.0;
  for (std::size_t k = 0; k < a[column].size(); ++k) {
    most = std::max(most, std::abs(a[column][k] - b[column][k]));
    size = std::max(size, std::abs(b[column][k]));
  }
  return most / size;
}

// A swinging rigid beam is a body with m = mu L, centre (L/2, c2, c3), and about it J11 = L J11', J22 = L J22' + m L^2/12,
// where J' is the inertia per length about the section's mass centre.
TEST(Rigid, BeamIsTheBodyWithItsMass) {
  const double L = 1.0, mu = 2.0, c2 = 0.01, c3 = 0.02;
  const Mat3 about_line = Vec3(0.004, 0.002, 0.002).asDiagonal();
  const Vec3 c(0.0, c2, c3);
  const Mat3 own = about_line + mu * hat(c) * hat(c);
  const std::string rest =
      R"(<gravity acceleration="0 1 -9.81"/> <transient duration="1" method="radau" tolerance="1e-10"/>
         <record name="J" joint="J" quantities="angle reaction_force reaction_moment"/>)";
  const Scene beam =
      scene_of(section + straight + R"(<rigid name="r" of="b"/>)" +
               R"(<revolute name="J" between="ground b.start" axis="0 1 0.3"/>)" + rest);
  Scene body = scene_of(R"(<body name="b" mass="2" inertia="1 1 1"/>)"
                        R"(<revolute name="J" between="ground b" at="0 0 0" axis="0 1 0.3"/>)" +
                        rest);
  const auto set = [&](double mass) {
    BodyScene& b = body.bodies[0];
    b.mass = mass;
    b.center = Vec3(0.5 * L, c2, c3);
    b.inertia = L * own;
    b.inertia(1, 1) += mu * L * L * L / 12.0;
    b.inertia(2, 2) += mu * L * L * L / 12.0;
  };
  set(mu * L);
  const Table of_beam = run_to_table(beam).table, of_body = run_to_table(body).table;
  // Same mass to round-off, same steps: the motion too, as far as round-off grows.
  for (const char* const column : {"J.angle", "J.reaction_force.3", "J.reaction_moment.1"})
    EXPECT_LT(difference(of_beam, of_body, column), 1e-9) << column;
  set(1.1 * mu * L);
  EXPECT_GT(difference(of_beam, run_to_table(body).table, "J.reaction_force.3"), 1e-3)
      << "a tenth more mass is seen";
}

// A quarter of a circle: mass mu R pi/2, centre of the line (2/pi)(1, 1) R from the centre of the circle.
TEST(Rigid, ArcHasTheMassOfTheArc) {
  const double R = 0.7, mu = 2.0, g = 9.81;
  const Scene scene = scene_of(
      R"(<section name="s"><stiffness EA="1" GA2="1" GA3="1" GJ="1" EI2="1" EI3="1"/>
         <mass per_length="2" inertia="1e-3 1e-3 1e-3"/></section>
         <arc name="a" section="s" from="0.7 0 0" center="0 0 0" axis="0 0 1" angle="90*deg" normal="0 0 1"/>
         <rigid name="r" of="a"/> <fixed name="F" between="ground a.start"/>
         <gravity acceleration="0 0 -9.81"/> <static/>
         <record name="F" joint="F" quantities="reaction_force reaction_moment"/>)");
  const Model model = compile(scene);
  EXPECT_EQ(model.system->unknowns(), 12) << "one node and a fixed joint";
  const Table t = run_to_table(scene).table;
  const double weight = mu * R * pi / 2.0 * g;
  const Vec3 arm = Vec3(2.0 * R / pi, 2.0 * R / pi, 0.0) - Vec3(R, 0.0, 0.0);
  const Vec3 moment = -arm.cross(Vec3(0.0, 0.0, -weight));
  EXPECT_NEAR(std::abs(t["F.reaction_force.3"].back()), weight, 1e-12 * weight);
  for (int i = 0; i < 2; ++i)
    EXPECT_NEAR(std::abs(t["F.reaction_moment." + std::to_string(i + 1)].back()),
                std::abs(moment(i)), 1e-12 * weight)
        << i;
}

// A cantilever whose outer half is rigid, under every kind of load on that half, is the limit of one whose outer half
// is ever stiffer: differences fall as 1/stiffness.
TEST(Rigid, IsTheLimitOfStiffness) {
  const auto scene = [](double stiffer, bool rigid) {
    return scene_of(
        fmt::format(
            R"(<parameter name="k" value="{}"/>
  <section name="soft"><stiffness EA="1e5" GA2="4e4" GA3="4e4" GJ="80" EI2="100" EI3="60"/><mass per_length="1" inertia="1e-3 1e-3 1e-3"/></section>
  <section name="hard"><stiffness EA="1e5*k" GA2="4e4*k" GA3="4e4*k" GJ="80*k" EI2="100*k" EI3="60*k"/>
    <mass per_length="1.5" inertia="1e-3 1e-3 1e-3" center="0.01 0.02"/></section>)",
            stiffer) +
        R"(<beam name="a" section="soft" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2" order="4"/>
  <arc name="b" section="hard" from="1 0 0" center="1 0.8 0" axis="0 0 1" angle="60*deg" normal="0 0 1" elements="2" order="4"/>
  <body name="tip" attached_to="b.end" mass="0.4" center="0.02 0.1 0" inertia="0.01 0.01 0.01"/>
  <point_mass at="b@0.5" mass="0.7" offset="0 0.05 0.02"/>
  <fixed name="root" between="ground a.start"/> <fixed name="knee" between="a.end b.start"/>
  <load at="b.end" force="2 -4 3" offset="0 0.1 0.2"/> <load at="b@0.5" follower_force="0 3 1" follower_moment="0.3 0.2 0.1"/>
  <load at="tip" moment="0.2 0 0.4"/>
  <distributed beam="b" from="0.25" to="0.75" force="0 s 2" follower_force="1 3*s 0" follower_moment="0.1 0 0"/>
  <gravity acceleration="0 0 -9.81"/> <static/>
  <record name="T" at="b.end" quantities="displacement displacement_local rotation"/>
  <record name="R" joint="root" quantities="reaction_force reaction_moment"/>)" +
        (rigid ? R"(<rigid name="r" of="b"/>)" : ""));
  };
  const Table limit = run_to_table(scene(1.0, true)).table;
  const Table far = run_to_table(scene(1e3, false)).table,
              stiffest = run_to_table(scene(1e5, false)).table;
  for (std::size_t c = 1; c < limit.names.size(); ++c) {
    const double size = std::abs(limit.columns[c].back());
    const double first = std::abs(far.columns[c].back() - limit.columns[c].back()) / size;
    const double second = std::abs(stiffest.columns[c].back() - limit.columns[c].back()) / size;
    EXPECT_LT(second, 3e-4) << limit.names[c];
    EXPECT_LT(second, 0.02 * first + 1e-9) << limit.names[c];
  }
}

const std::string frame =
    R"(<beam name="left" section="s" from="0 0 0" to="0 0 1" normal="0 1 0"/>
       <beam name="top" section="s" from="0 0 1" to="1 0 1" normal="0 1 0"/>
       <body name="hub" at="1 0 1" mass="3" inertia="0.1 0.2 0.3" angular_velocity="0 0 2"/>
       <body name="free" at="1 0 2" mass="1" inertia="0.1 0.1 0.1" velocity="0 -1 0"/>
       <revolute name="corner" between="left.end top.start" axis="0 1 0"/>
       <spherical name="out" between="top@0.5 free" at="0.5 0 1"/>)";

TEST(Rigid, GroupIsOneBodyAndKeepsItsJointsToOthers) {
  const Scene scene = scene_of(
      section + frame +
      R"(<rigid name="frame" of="hub left top"/> <transient duration="0.5" method="radau" tolerance="1e-8"/>
         <record name="A" at="left.start" quantities="position velocity"/>
         <record name="B" at="top@0.25" quantities="position velocity acceleration angular_velocity"/>
         <record name="E" quantities="total_energy linear_momentum"/>)");
  const Model model = compile(scene);
  EXPECT_EQ(model.system->unknowns(), 2 * 6 + 3)
      << "two bodies and a ball; the corner does nothing";
  const Table t = run_to_table(scene, 1).table;
  const auto vec = [&](const std::string& name, std::size_t k) {
    return Vec3(t[name + ".1"][k], t[name + ".2"][k], t[name + ".3"][k]);
  };
  // The places move as one body: |B - A| stays, and v_B = v_A + w x (B - A).
  for (std::size_t k = 0; k < t.columns[0].size(); ++k) {
    const Vec3 arm = vec("B.position", k) - vec("A.position", k);
    EXPECT_NEAR(arm.norm(), std::hypot(0.25, 1.0), 1e-13);
    EXPECT_LT(
        (vec("B.velocity", k) - vec("A.velocity", k) - vec("B.angular_velocity", k).cross(arm))
            .norm(),
        1e-13);
    EXPECT_NEAR(t["E.total_energy"][k], t["E.total_energy"][0], 1e-6 * t["E.total_energy"][0]);
  }
  // The hub turns about its own point: all places begin with w x r.
  EXPECT_LT((vec("A.velocity", 0) - Vec3(0, 0, 2).cross(Vec3(-1, 0, -1))).norm(), 1e-15);
  // The recorded acceleration is the derivative of the velocity: to the second order of central differences.
  const std::vector<double>& time = t.columns[0];
  const std::size_t k = time.size() / 2;
  const Vec3 slope =
      (vec("B.velocity", k + 1) - vec("B.velocity", k - 1)) / (time[k + 1] - time[k - 1]);
  EXPECT_LT((vec("B.acceleration", k) - slope).norm(), 1e-4 * slope.norm());
}

// Two bodies, turned against each other and against the group's frame, are the one body with their mass, whose frame is
// that of the second: with what acts there, what flows around it, how it begins, and all that is recorded there. Mutations that
// fail: velocities, added mass, drag or local records taken at the node as if it were the body.
TEST(Rigid, GroupIsTheBodyWithItsMassInEveryTerm) {
  const std::string q =
      R"(<body name="Q" at="0.2 0.7 -0.4" orientation="-0.6 1.1 0.3" mass="3" center="0.1 0.2 -0.1"
          inertia="0.5 0.4 0.3 0.02 -0.03 0.04" velocity="0.3 -1.2 0.8" angular_velocity="1.5 -2 0.7"/>)";
  const std::string rest =
      R"(<added_mass at="Q" matrix="2 0.1 0.2 0.3 -0.1 0.05  3 0.1 -0.2 0.2 0.1  4 0.1 -0.3 0.2  0.9 0.1 0.05  0.8 0.1  0.7"/>
         <drag at="Q" density="900" area="0.01" coefficient="1.1" offset="0.3 -0.2 0.1" flow="1 0.5*t 0"/>
         <load at="Q" force="2 0 1" follower_moment="0 0.5 0.2" offset="0 0.1 0.3"/>
         <gravity acceleration="0 0 -9.81"/>
         <spring name="S" between="ground Q" at_a="0 0 2" stiffness="40" damping="3"/>
         <transient duration="1" method="radau" stages="3" tolerance="1e-10"/>
         <record name="Q" at="Q" quantities="position displacement displacement_local rotation velocity velocity_local
            angular_velocity angular_velocity_local acceleration"/>
         <record name="E" quantities="kinetic_energy linear_momentum angular_momentum"/>)";
  const Scene group = scene_of(
      R"(<body name="P" at="1 -0.5 0.3" orientation="0.4 -0.2 0.9" mass="2" center="-0.2 0.1 0.3"
          inertia="0.3 0.2 0.4 0.01 0.02 -0.03"/>)" +
      q + R"(<rigid name="r" of="P Q"/>)" + rest);
  Scene single = scene_of(q + rest);
  const BodyScene &P = group.bodies[0], &Q = group.bodies[1];
  const Mat3 turn = Q.orientation.transpose() * P.orientation;  // from P's axes to Q's
  const Vec3 cP = Q.orientation.transpose() * (P.at - Q.at) + turn * P.center;
  BodyScene& both = single.bodies[0];
  both.mass = P.mass + Q.mass;
  both.center = (P.mass * cP + Q.mass * Q.center) / both.mass;
  const auto about = [](const Mat3& inertia, double m, const Vec3& arm) -> Mat3 {
    return inertia + m * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
  };
  both.inertia = about(turn * P.inertia * turn.transpose(), P.mass, cP - both.center) +
                 about(Q.inertia, Q.mass, Q.center - both.center);
  const Table a = run_to_table(group, 1).table, b = run_to_table(single, 1).table;
  ASSERT_EQ(a.names, b.names);
  ASSERT_EQ(a.rows(), b.rows());
  for (const std::string& column : a.names) EXPECT_LT(difference(a, b, column), 1e-7) << column;
}

TEST(Rigid, WhatDoesNotExistInItIsRefused) {
  const auto message = [](const std::string& items) -> std::string {
    try {
      compile(scene_of(section + frame + R"(<rigid name="frame" of="hub left top"/>
                       <transient duration="1" step="0.1"/>)" +
                       items));
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_EQ(message(""), "none");
  EXPECT_NE(message(R"(<record name="x" at="top@0.5" quantities="force"/>)").find("is rigid"),
            std::string::npos);
  EXPECT_NE(message(R"(<drive joint="corner" rate="t"/>)").find("leave the drive out"),
            std::string::npos);
  EXPECT_NE(message(R"(<record name="x" joint="corner" quantities="reaction_force"/>)")
                .find("lies within rigid \"frame\""),
            std::string::npos);
}

}  // namespace
}  // namespace mbd::test::test_rigid
