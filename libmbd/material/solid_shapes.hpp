// Shapes of bodies (libmbd/scene/shapes.hpp): their surfaces, and the mass that those with a density have.
#pragma once

#include "libmbd/scene/scene.hpp"

namespace mbd {

// In body axes; the inertia is about the mass centre.
struct MassProperties {
  double mass = 0.0;            // [kg]
  Vec3 center = Vec3::Zero();   // [m], from the reference point
  Mat3 inertia = Mat3::Zero();  // [kg m^2]
};

// Of what is enclosed by a surface, at density 1 and in its unit of length: volume, its centre, and
// inertia about that, in the axes of the points; by the divergence theorem,
// exact but for round-off. Parts that do not hang together count each as a solid, or as hollow within one that is turned the
// other way. Throws Error where the surface is not closed, its triangles are not turned alike, or one part lies within another
// that is turned alike.
MassProperties solid_of(const TriangleMesh& surface);

// What a body states and what its shapes add. Throws Error with the place of a mesh that is not to be read, or that has
// a density and does not enclose anything.
MassProperties mass_properties(const BodyScene& body);

// The surface of a shape's mesh, which `of` has. Throws Error with its place.
std::shared_ptr<const TriangleMesh> surface_of(const ShapeScene& shape, const std::string& of);

// Reads all meshes, so that what is wrong with one is known before a run. The reader of models does it; it need not be
// called for a scene that a program makes.
void read_meshes(Scene& scene);

}  // namespace mbd
