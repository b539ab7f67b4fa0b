// What is rigid in a scene: bodies, point masses, and beams and bodies made one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "libmbd/scene/field.hpp"
#include "libmbd/scene/shapes.hpp"

namespace mbd {

struct BodyScene {
  Source source;
  std::string name;
  std::optional<Place> attached_to;     // fixed to this place's node; otherwise a free body
  Vec3 at = Vec3::Zero();               // of a free body; so are orientation and velocities
  Mat3 orientation = Mat3::Identity();  // columns: body axes in inertial axes
  double mass = 0.0;
  Vec3 center = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();
  Vec3 velocity = Vec3::Zero(), angular_velocity = Vec3::Zero();
  std::vector<ShapeScene> shapes;  // whose mass comes besides (libmbd/material/solid_shapes.hpp)

  static constexpr field::ItemKind item{"body", "A rigid body, free or fixed to a place.", "bodies",
                                        field::of_parts};
  static void each_field(const auto& f) {
    using namespace field;
    using S = BodyScene;
    constexpr auto free = [](const S& body) { return !body.attached_to; };
    f(Field(&S::name, "name", "", required, "name, unique among beams and bodies", item_name));
    f(Field(&S::attached_to, "attached_to", "", optional,
            "the place it is fixed to; its axes are those of the place"));
    f(Field(&S::at, "at", "m", optional, "reference point of a free body (default 0 0 0)", point,
            free));
    f(Field(&S::orientation, "orientation", "rad", optional,
            "of a free body: rotation vector, or (without unit) matrix row by row", rotation,
            free));
    f(Field(&S::mass, "mass", "kg", optional,
            "mass; only a body whose <shape> has a density, or on the ground, may leave it out",
            not_negative));
    f(Field(&S::center, "center", "m", preset, "mass centre from the reference point, body axes",
            varied));
    f(Field(&S::inertia, "inertia", "kg.m2", optional,
            "matrix xx yy zz [xy xz yz] about the mass centre, body axes; left out with the mass"));
    f(Field(&S::velocity, "velocity", "m/s", optional,
            "of the reference point of a free body at the start, inertial axes (default 0 0 0)",
            inertial, varied, free));
    f(Field(&S::angular_velocity, "angular_velocity", "rad/s", optional,
            "of a free body at the start, body axes (default 0 0 0)", varied, free));
    f(Parts(&S::shapes));
  }
};

// Beams and free bodies that together are one rigid body: one node, with the mass of them all. Its frame is that of the
// first: of a body, or of a beam's start. What joins two of them among themselves does nothing.
struct RigidScene {
  Source source;
  std::string name;
  std::vector<std::string> of;  // at least one; none of them in another

  static constexpr field::ItemKind item{
      "rigid",
      "Makes one rigid body of beams and free bodies: one node with the mass of them all. Places "
      "of its beams stay places; joints between two of them do nothing.",
      "rigid groups", field::of_parts};
  static void each_field(const auto& f) {
    using namespace field;
    using S = RigidScene;
    f(Field(&S::name, "name", "", required, "name, unique among beams, bodies and rigid ones",
            item_name));
    f(Field(&S::of, "of", "", required,
            "names of beams and free bodies; its frame is the first one's"));
  }
};

// Beams and bodies whose small deformations are component modes (Craig-Bampton): one element with the nodes at which others hold
// them or act on them, and a few within (solvers/modes/component_modes.hpp). Motions of the whole may be large. Left out of the
// scene, its parts are what they are else.
struct ReductionScene {
  Source source;
  std::string name;
  std::vector<std::string> of;  // at least one; none of them in another
  int modes = 12;
  std::optional<Place> frame;

  static constexpr field::ItemKind item{
      "reduction",
      "Makes one element of component modes (Craig-Bampton) of beams and bodies, with what is "
      "fixed between them: static shapes of the places where something acts, and the slowest modes "
      "with these held. For parts that deform little, whatever their motion; what tension or "
      "compression change of their stiffness is only about right (the certificate says what that "
      "makes). Without it they are the beams they are.",
      "reductions", field::of_parts, true};
  static void each_field(const auto& f) {
    using namespace field;
    using S = ReductionScene;
    f(Field(&S::name, "name", "", required, "name, unique among beams, bodies and rigid ones",
            item_name));
    f(Field(&S::of, "of", "", required,
            "names of beams and bodies; of a <rigid>, all of its parts"));
    f(Field(&S::modes, "modes", "", preset,
            "how many modes with its places held; 0: static shapes alone", Range{0.0, 1e3}));
    f(Field(&S::frame, "frame", "", optional,
            "place of it whose frame floats with it (default: of the places where something acts "
            "the first by name)"));
  }
};

struct PointMassScene {
  Source source;
  std::string name;
  Place at;
  double mass = 0.0;
  Vec3 offset = Vec3::Zero();

  static constexpr field::ItemKind item{
      "point_mass", "A mass without inertia of its own that moves with a place.", "point masses",
      field::of_loads, true};
  static void each_field(const auto& f) {
    using namespace field;
    using S = PointMassScene;
    f(Field(&S::name, "name", "", optional, "name, for messages", item_name));
    f(Field(&S::at, "at", "", required, "what it moves with"));
    f(Field(&S::mass, "mass", "kg", required, "mass", not_negative));
    f(Field(&S::offset, "offset", "m", preset, "from the place, axes of the section or body"));
  }
};

}  // namespace mbd
