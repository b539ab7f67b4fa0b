// The same mechanism in another place, in other units, or written down in another order; and what a run of it found,
// brought back. What physics does not depend on, a run must not depend on either, but for round-off and tolerances.
//
// All three carry everything of a scene but what only its own run can meet or draw: <expect> and <plot> are dropped.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/scene/scene.hpp"
#include "libmbd/study/trial/trial.hpp"

namespace mbd {

// x -> R x + shift, of everything: points, directions, gravity, dead loads, prescribed motions, velocities.
struct RigidMotion {
  Mat3 R = Mat3::Identity();  // a rotation
  Vec3 shift = Vec3::Zero();  // [m]
};

// Units of length, mass and time that are so many times smaller: numbers with dimensions become so many times
// larger. {1e3, 1e-3, 1} goes from m, kg, s to mm, t, s.
struct UnitChange {
  double length = 1.0, mass = 1.0, time = 1.0;

  // Of a number in `unit`, as columns and attributes have it: "N.m", "rad/s", "m/s2", "kg.m2", "".
  // Throws std::logic_error for what is none of these.
  double factor(std::string_view unit) const;
};

struct Transformed {
  Scene scene;
  std::vector<std::string> left_out;  // what of the scene could not be carried, by name
};

// Left out are marks and stops of a path on components along inertial axes, which the moved scene does not record
// as one number; without_inertial_marks() is the scene to compare with. A path that loses a stop has 40 points at most
// on each branch.
Transformed moved(const Scene& scene, const RigidMotion& motion);
Scene without_inertial_marks(const Scene& scene);

// The default tolerances are relative, so they need no change; those in physical units are carried.
Transformed rescaled(const Scene& scene, const UnitChange& units);

// Sections, parts, joints, drives, motions, loads, masses and drags in a random order.
Scene reordered(const Scene& scene, std::uint64_t seed);

// Masses, inertias, stiffnesses, loads, drag, gravity, places and initial velocities of bodies changed by up to `relative`
// of themselves (places: of the distances between them), at random: what a motion makes of round-off.
Scene perturbed(const Scene& scene, double relative, std::uint64_t seed);

// A random rotation, and a shift by `distance` [m] in a random direction.
RigidMotion random_motion(std::uint64_t seed, double distance);

// What a run of moved(scene) found, in the axes of `scene`. What cannot be is left out, and named in `not_compared`:
// potential energies where compile() refuses, angular momentum about the origin where linear momentum is not recorded
// in the same record.
Findings moved_back(Findings findings, const Scene& scene, const RigidMotion& motion,
                    std::vector<std::string>& not_compared);

// What a run of rescaled(scene) found, in the units of `scene`.
Findings rescaled_back(Findings findings, const Scene& scene, const UnitChange& units);

}  // namespace mbd
