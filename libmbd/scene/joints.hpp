// Joints of a scene, and what is prescribed of them and of places.
#pragma once

#include <optional>
#include <string>

#include "libmbd/scene/field.hpp"

namespace mbd {

// Its element is its kind; which of the attributes after `between` it has, the joint's type says (joints/traits.hpp).
struct JointScene {
  Source source;
  std::string kind;  // a name of joints/joint_list.hpp
  std::string name;
  Place a, b;
  std::optional<Vec3> at, at_a, at_b;
  std::optional<Vec3> axis, second_axis;
  std::optional<double> parameter;  // of a screw: its pitch [m per turn]

  static constexpr field::ItemKind item{"", "", "joints", field::of_parts};
  static void each_field(const auto& f) {
    using namespace field;
    using S = JointScene;
    f(Field(&S::name, "name", "", required, "name, unique among joints", item_name));
    f(Field(&S::a, "between", "", required, "the two places a and b it joins", first_place));
    f(Field(&S::b, "between", "", required, "", second_place));
    f(Field(&S::at, "at", "m", optional,
            "its point (default: that of b, or of a when b is the ground)", point));
    f(Field(&S::at_a, "at_a", "m", optional, "its point of a (default: that of the place)", point));
    f(Field(&S::at_b, "at_b", "m", optional, "its point of b (default: that of the place)", point));
    f(Field(&S::axis, "axis", "", required,
            "direction of its axis; angles turn right-handed about it", inertial));
    f(Field(
        &S::second_axis, "second_axis", "", required,
        "direction of its second axis, fixed in b, perpendicular to the first, which is fixed in a",
        inertial));
  }
};

// One law of b relative to a, about or along the axis.
struct DriveScene {
  Source source;
  std::string joint;
  std::optional<Expression> rate, angle, speed, displacement;

  static constexpr field::ItemKind item{
      "drive", "Prescribes the angle or the displacement of a joint.", "drives"};
  static void each_field(const auto& f) {
    using namespace field;
    using S = DriveScene;
    f(Field(&S::joint, "joint", "", required, "name of a joint with an angle or a displacement"));
    f(Field(&S::rate, "rate", "rad/s", optional,
            "rotation rate of b relative to a; the angle starts at 0", prescribed));
    f(Field(&S::angle, "angle", "rad", optional,
            "or the rotation of b relative to a, 0 at the start", prescribed));
    f(Field(&S::speed, "speed", "m/s", optional,
            "or the speed of b relative to a along the axis; the displacement starts at 0",
            prescribed));
    f(Field(&S::displacement, "displacement", "m", optional,
            "or the displacement of b relative to a along the axis, 0 at the start", prescribed));
  }
};

// The motion of a place from its reference configuration. What is not given is free: displacement or velocity, and
// rotation (a rotation vector of any length) or an axis and one of angle and rate.
struct MotionScene {
  Source source;
  std::string name;
  Place of;
  std::optional<LawVector> displacement, velocity, rotation;
  std::optional<Vec3> axis;
  std::optional<Expression> angle, rate;

  static constexpr field::ItemKind item{
      "motion",  "Prescribes the motion of a place; what is not given is free.",
      "motions", field::of_parts,
      false,     "prescribed motions of places"};
  static void each_field(const auto& f) {
    using namespace field;
    using S = MotionScene;
    f(Field(&S::name, "name", "", required, "name, unique among joints and motions", item_name));
    f(Field(&S::of, "of", "", required, "the place that moves"));
    f(Field(&S::displacement, "displacement", "m", optional,
            "from the reference configuration, inertial axes, 0 at the start", inertial,
            prescribed));
    f(Field(&S::velocity, "velocity", "m/s", optional, "or its rate; the displacement starts at 0",
            inertial, prescribed));
    f(Field(&S::rotation, "rotation", "rad", optional,
            "rotation vector from the reference configuration, inertial axes, of any length",
            inertial, prescribed));
    f(Field(&S::axis, "axis", "", optional, "or an inertial axis, and one of angle and rate",
            inertial));
    f(Field(&S::angle, "angle", "rad", optional, "rotation about the axis, 0 at the start",
            prescribed));
    f(Field(&S::rate, "rate", "rad/s", optional, "or its rate; the angle starts at 0", prescribed));
  }
};

}  // namespace mbd
