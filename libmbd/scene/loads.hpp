// Loads of a scene, what a fluid does to it, gravity, and the motion of its base.
#pragma once

#include <optional>
#include <string>

#include "libmbd/scene/field.hpp"

namespace mbd {

// At a place: dead, or following the axes of the section or body; offset in these.
struct LoadScene {
  Source source;
  std::string name;
  Place at;
  std::optional<LawVector> force, moment, follower_force, follower_moment;
  Vec3 offset = Vec3::Zero();

  static constexpr field::ItemKind item{
      "load", "A force and moment at a place.", "loads", field::of_loads, true, "loads at places"};
  static void each_field(const auto& f) {
    using namespace field;
    using S = LoadScene;
    f(Field(&S::name, "name", "", optional, "name, for messages", item_name));
    f(Field(&S::at, "at", "", required, "where it acts"));
    f(Field(&S::force, "force", "N", optional, "dead force, inertial axes", inertial));
    f(Field(&S::moment, "moment", "N.m", optional, "dead moment, inertial axes", inertial));
    f(Field(&S::follower_force, "follower_force", "N", optional,
            "force in the axes of the section or body"));
    f(Field(&S::follower_moment, "follower_moment", "N.m", optional,
            "moment in the axes of the section or body"));
    f(Field(&S::offset, "offset", "m", preset,
            "where the forces act, from the place, in the axes of the section or body"));
  }
};

// Along a beam, per unit of its reference length. s is the fraction of that length, 0 … 1. Where a load
// begins or ends is best said by `from` and `to`, which make ends of elements, not by a condition on s.
struct DistributedLoadScene {
  Source source;
  std::string name;
  std::string beam;
  double from = 0.0, to = 1.0;
  std::optional<FieldVector> force, moment, follower_force, follower_moment;

  static constexpr field::ItemKind item{
      "distributed",
      "Forces and moments per unit of reference length along a beam; expressions of s, the "
      "fraction of that length, and t.",
      "distributed loads",
      field::of_loads,
      true,
      "distributed loads"};
  static void each_field(const auto& f) {
    using namespace field;
    using S = DistributedLoadScene;
    f(Field(&S::name, "name", "", optional, "name, for messages", item_name));
    f(Field(&S::beam, "beam", "", required, "name of the beam"));
    f(Field(&S::from, "from", "", preset, "where it begins, fraction of the reference length",
            unit_interval));
    f(Field(&S::to, "to", "", preset, "where it ends", unit_interval));
    f(Field(&S::force, "force", "N/m", optional, "dead force per reference length, inertial axes",
            inertial));
    f(Field(&S::moment, "moment", "N", optional, "dead moment per reference length, inertial axes",
            inertial));
    f(Field(&S::follower_force, "follower_force", "N/m", optional,
            "force per reference length, section axes"));
    f(Field(&S::follower_moment, "follower_moment", "N", optional,
            "moment per reference length, section axes"));
  }
};

struct Gravity {
  Source source;
  Vec3 acceleration = Vec3::Zero();

  static constexpr field::ItemKind item{"gravity", "Uniform gravity on everything that has mass."};
  static void each_field(const auto& f) {
    using namespace field;
    f(Field(&Gravity::acceleration, "acceleration", "m/s2", required, "of free fall, inertial axes",
            inertial, varied));
  }
};

// The base, which is called the ground, is accelerated without turning: everything is relative to it
// (elements/node/base_motion.hpp). One of three laws.
struct BaseMotionScene {
  Source source;
  std::optional<LawVector> acceleration, velocity, displacement;

  static constexpr field::ItemKind item{
      "base_motion",
      "Accelerates the ground without turning it; everything else is relative to the ground."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = BaseMotionScene;
    f(Field(&S::acceleration, "acceleration", "m/s2", optional,
            "of the base, inertial axes (one of three)", inertial, varied));
    f(Field(&S::velocity, "velocity", "m/s", optional, "or its velocity, continuous", inertial,
            varied, prescribed));
    f(Field(&S::displacement, "displacement", "m", optional,
            "or its displacement, continuous with its rate", inertial, varied, prescribed));
  }
};

// Quadratic drag (elements/node/drag.hpp).
struct DragScene {
  Source source;
  std::string name;
  double density = 0.0;
  std::optional<LawVector> flow;
  // Along a beam.
  std::string beam;  // empty: at a place
  std::optional<double> from, to, diameter, normal_coefficient, tangential_coefficient;
  // At a place.
  std::optional<Place> at;
  std::optional<double> area, coefficient;
  std::optional<Vec3> offset;

  static constexpr field::ItemKind item{
      "drag", "Quadratic drag of a fluid, still or flowing, along a beam or at a place.", "drags",
      field::of_loads, true};
  static void each_field(const auto& f) {
    using namespace field;
    using S = DragScene;
    f(Field(&S::name, "name", "", optional, "name, for messages", item_name));
    f(Field(&S::density, "density", "kg/m3", required, "of the fluid", positive));
    f(Field(&S::flow, "flow", "m/s", optional,
            "velocity of the fluid, inertial axes; without it the fluid is still", inertial,
            varied));
    f(Field(&S::beam, "beam", "", optional, "name of the beam (one of beam, at)"));
    f(Field(&S::from, "from", "", optional,
            "of a beam: where it begins, fraction of the reference length (default 0)",
            unit_interval, along_beam));
    f(Field(&S::to, "to", "", optional, "of a beam: where it ends (default 1)", unit_interval,
            along_beam));
    f(Field(&S::diameter, "diameter", "m", optional, "of a beam, which needs it", positive,
            along_beam, needed));
    f(Field(&S::normal_coefficient, "normal_coefficient", "", optional,
            "of a beam, which needs it: C of 1/2 density C diameter |u| u per length, u across the "
            "beam",
            not_negative, along_beam, needed));
    f(Field(&S::tangential_coefficient, "tangential_coefficient", "", optional,
            "of a beam, which needs it: C of 1/2 density C pi diameter |u| u per length, u along "
            "the beam",
            not_negative, along_beam, needed));
    f(Field(&S::at, "at", "", optional, "or what it acts on (one of beam, at)"));
    f(Field(&S::area, "area", "m2", optional, "at a place, which needs it", positive, at_place,
            needed));
    f(Field(&S::coefficient, "coefficient", "", optional,
            "at a place, which needs it: C of 1/2 density C area |u| u, the same in all directions",
            not_negative, at_place, needed));
    f(Field(&S::offset, "offset", "m", optional,
            "at a place: where it acts, from there, axes of the section or body (default 0 0 0)",
            at_place));
  }
};

// Inertia of the fluid that moves with a beam, or with a body at a place (NOTATION.md): of inertia, not of gravity.
// Of a beam, across it and per length: density pi diameter^2 / 4 times coefficient.
struct AddedMassScene {
  Source source;
  std::string name;
  // Of a beam.
  std::string beam;  // empty: at a place
  std::optional<double> from, to, density, diameter, coefficient;
  // At a place: M of [v; w], its axes.
  std::optional<Place> at;
  std::optional<Mat6> matrix;

  static constexpr field::ItemKind item{"added_mass",
                                        "Inertia of a fluid that a beam or a body sets in motion: "
                                        "of a fluid at rest, without its weight.",
                                        "added masses", field::of_loads, true};
  static void each_field(const auto& f) {
    using namespace field;
    using S = AddedMassScene;
    f(Field(&S::name, "name", "", optional, "name, for messages", item_name));
    f(Field(&S::beam, "beam", "", optional, "name of the beam (one of beam, at)"));
    f(Field(&S::from, "from", "", optional,
            "of a beam: where it begins, fraction of the reference length (default 0)",
            unit_interval, along_beam));
    f(Field(&S::to, "to", "", optional, "of a beam: where it ends (default 1)", unit_interval,
            along_beam));
    f(Field(&S::density, "density", "kg/m3", optional, "of a beam, which needs it: of the fluid",
            positive, along_beam, needed));
    f(Field(&S::diameter, "diameter", "m", optional, "of a beam, which needs it", positive,
            along_beam, needed));
    f(Field(&S::coefficient, "coefficient", "", optional,
            "of a beam, which needs it: C of density C pi diameter^2/4 per length, across the "
            "beam; along it there is none",
            not_negative, along_beam, needed));
    f(Field(&S::at, "at", "", optional, "or what it moves with (one of beam, at)"));
    f(Field(&S::matrix, "matrix", "", optional,
            "at a place, which needs it, in SI units: m11 m22 m33 [kg] J11 J22 J33 [kg.m2], or the "
            "upper triangle row by row (21 numbers), of velocities v1 v2 v3 and angular velocities "
            "w1 w2 w3 in the axes of the section or body",
            Blocks{"kg", "kg.m", "kg.m2"}, at_place, needed));
  }
};

}  // namespace mbd
