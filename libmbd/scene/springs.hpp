// Springs and dampers of a scene, between places and along the free coordinates of joints. What is stated adds up.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "libmbd/scene/field.hpp"

namespace mbd {

// A spring, a damper or both along the line between two points.
struct SpringScene {
  Source source;
  std::string name;
  Place a, b;
  std::optional<Vec3> at_a, at_b;
  double stiffness = 0.0, damping = 0.0;
  std::optional<double> length;
  std::optional<LawScene> force, damping_force;  // tensions

  static constexpr field::ItemKind item{
      "spring", "A spring, a damper or both along the line between two points of two places.",
      "springs", field::of_springs, true};
  static void each_field(const auto& f) {
    using namespace field;
    using S = SpringScene;
    f(Field(&S::name, "name", "", required, "name, unique among springs", item_name));
    f(Field(&S::a, "between", "", required, "the two places a and b it acts on", first_place));
    f(Field(&S::b, "between", "", required, "", second_place));
    f(Field(&S::at_a, "at_a", "m", optional, "its point of a (default: that of the place)", point));
    f(Field(&S::at_b, "at_b", "m", optional, "its point of b (default: that of the place)", point));
    f(Field(&S::stiffness, "stiffness", "N/m", optional, "tension per extension x", not_negative));
    f(Field(&S::damping, "damping", "N.s/m", optional, "tension per rate v of the length",
            not_negative));
    f(Field(&S::length, "length", "m", optional,
            "free length, where x = 0 (default: that of the reference configuration)",
            not_negative));
    f(Field(&S::force, "force", "N", optional,
            "or (both add up) the tension at the extension x [m]"));
    f(Field(&S::damping_force, "damping_force", "N", optional,
            "or (both add up) the tension at the rate v [m/s]; 0 at v = 0", of_rate));
  }
};

// A law of one component of a bushing's motion parameters (elements/pair/bushing.hpp).
struct BushingLawScene {
  Source source;
  int component = 1;  // 1 … 3 along, 4 … 6 about the first, second and third axis
  LawScene force;     // or moment

  static constexpr field::ItemKind item{
      "law",
      "What one component of its motion adds to the stiffness: an expression, or a table of x and "
      "force in turn, in SI units, x rising."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = BushingLawScene;
    f(Field(&S::component, "component", "", required,
            "of the motion of b relative to a: 1 to 3 along, 4 to 6 about the axes",
            Range{1.0, 6.0}));
    f(Field(&S::force, "force", "N", optional, "of components 1 to 3: over the displacement x [m]",
            [](const S& law) { return law.component <= 3; }));
    f(Field(&S::force, "moment", "N.m", optional, "of components 4 to 6: over the rotation x [rad]",
            [](const S& law) { return law.component > 3; }));
  }
};

// An elastic, damped connection of two frames in all six directions.
struct BushingScene {
  Source source;
  std::string name;
  Place a, b;
  std::optional<Vec3> at;
  std::optional<Vec3> axis, second_axis;  // third and first axis of its frames
  Mat6 stiffness = Mat6::Zero(), damping = Mat6::Zero();
  std::vector<BushingLawScene> laws;  // added to the stiffness

  static constexpr field::ItemKind item{"bushing",
                                        "An elastic connection of two frames, which coincide in "
                                        "the reference configuration, in all six directions.",
                                        "bushings", field::of_springs, true};
  static void each_field(const auto& f) {
    using namespace field;
    using S = BushingScene;
    f(Field(&S::name, "name", "", required, "name, unique among springs", item_name));
    f(Field(&S::a, "between", "", required, "the two places a and b it connects", first_place));
    f(Field(&S::b, "between", "", required, "", second_place));
    f(Field(&S::at, "at", "m", optional,
            "its point (default: that of b, or of a when b is the ground)", point));
    f(Field(&S::axis, "axis", "", optional, "its third axis (default: inertial axes)"));
    f(Field(&S::second_axis, "second_axis", "", optional,
            "its first axis, perpendicular to the third (default: any)"));
    f(Field(&S::stiffness, Blocks{"N/m", "N", "N.m"}));
    f(Field(&S::damping, Blocks{"N.s/m", "N.s", "N.m.s"}));
    f(Extra("stiffness", Kind::numbers, "N/m", optional, "along its three axes", not_negative));
    f(Extra("angular_stiffness", Kind::numbers, "N.m", optional, "about its three axes, per rad",
            not_negative));
    f(Extra("damping", Kind::numbers, "N.s/m", optional, "along its three axes", not_negative));
    f(Extra("angular_damping", Kind::numbers, "N.m.s", optional, "about its three axes, per rad",
            not_negative));
    f(Parts(&S::laws));
  }
};

// A spring, a damper or both on the free coordinate of a joint, which has other names of each.
struct JointSpringScene {
  Source source;
  std::string name;
  std::string joint;
  enum class Coordinate { angle, displacement } coordinate = Coordinate::angle;
  double stiffness = 0.0, damping = 0.0;
  double rest = 0.0;                             // coordinate where the spring exerts nothing
  std::optional<LawScene> force, damping_force;  // or moments

  static constexpr field::ItemKind item{
      "joint_spring",
      "A spring, a damper or both on the free coordinate of a joint: its angle, over any number of "
      "turns, or its displacement.",
      "joint springs", field::of_springs, true};
  static void each_field(const auto& f) {
    using namespace field;
    using S = JointSpringScene;
    constexpr auto turns = [](const S& s) { return s.coordinate == Coordinate::angle; };
    constexpr auto slides = [](const S& s) { return s.coordinate == Coordinate::displacement; };
    f(Field(&S::name, "name", "", required, "name, unique among springs", item_name));
    f(Field(&S::joint, "joint", "", required, "name of a joint with an angle or a displacement"));
    f(Field(&S::stiffness, "angular_stiffness", "N.m", optional,
            "moment per angle of b relative to a, against it", not_negative, turns));
    f(Field(&S::damping, "angular_damping", "N.m.s", optional, "moment per rate of the angle",
            not_negative, turns));
    f(Field(&S::rest, "rest_angle", "rad", optional, "angle without moment (default 0)", turns));
    f(Field(&S::force, "moment", "N.m", optional,
            "or (both add up) the moment at x [rad], the angle less rest_angle, against it",
            turns));
    f(Field(&S::damping_force, "damping_moment", "N.m", optional,
            "or (both add up) the moment at the rate v [rad/s]; 0 at v = 0", of_rate, turns));
    f(Field(&S::stiffness, "stiffness", "N/m", optional,
            "or force per displacement of b relative to a along the axis, against it", not_negative,
            slides));
    f(Field(&S::damping, "damping", "N.s/m", optional, "force per speed", not_negative, slides));
    f(Field(&S::rest, "rest_displacement", "m", optional, "displacement without force (default 0)",
            slides));
    f(Field(
        &S::force, "force", "N", optional,
        "or (both add up) the force at x [m], the displacement less rest_displacement, against it",
        slides));
    f(Field(&S::damping_force, "damping_force", "N", optional,
            "or (both add up) the force at the speed v [m/s]; 0 at v = 0", of_rate, slides));
  }
};

// What acts along the free coordinates of a joint on b, and its opposite on a.
struct JointTorqueScene {
  Source source;
  std::string name;
  std::string joint;
  std::optional<Expression> moment, force;

  static constexpr field::ItemKind item{
      "joint_torque",
      "A moment about or a force along the axis of a joint, of time; the joint turns freely.",
      "joint torques",
      field::of_loads,
      true,
      "moments and forces along the axes of joints"};
  static void each_field(const auto& f) {
    using namespace field;
    using S = JointTorqueScene;
    f(Field(&S::name, "name", "", optional, "name, for messages", item_name));
    f(Field(&S::joint, "joint", "", required, "name of a joint with an angle or a displacement"));
    f(Field(&S::moment, "moment", "N.m", optional, "on b about the axis, and its opposite on a"));
    f(Field(&S::force, "force", "N", optional, "on b along the axis, and its opposite on a"));
  }
};

}  // namespace mbd
