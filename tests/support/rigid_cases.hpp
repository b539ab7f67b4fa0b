// Models of rigid bodies whose motion and reactions rigid_motion.hpp gives, and the errors of reactions.
#pragma once

#include <string>
#include <vector>

#include "tests/support/rigid_motion.hpp"
#include "tests/support/stepping.hpp"

namespace mbd::test {

struct RigidCase {
  FixedPointBody body;
  FixedPointState start;
  std::string model, place, joint;
  double interval, duration;  // of the samples [s]
};

inline RigidCase heavy_top() {
  RigidCase c;
  c.body.mass = 15;
  c.body.center = {0, 1, 0};
  c.body.inertia = Eigen::Vector3d(.234375 + 15, .46875, .234375 + 15).asDiagonal();
  c.body.gravity = {0, 0, -9.81};
  c.start.w = {0, 150, -4.61538};
  c.model = "heavy_top", c.place = "top", c.joint = "O";
  c.interval = 1e-3, c.duration = 1;
  return c;
}

// A bob without inertia of its own; about the rod any will do, it does not turn that way.
inline RigidCase pendulum() {
  RigidCase c;
  c.body.mass = 1;
  c.body.center = {-1, 0, 0};
  c.body.inertia = Eigen::Vector3d(1, 1, 1).asDiagonal();
  c.body.gravity = {0, -9.81, 0};
  c.model = "pendulum", c.place = "bob", c.joint = "O";
  c.interval = 1e-2, c.duration = 2;
  return c;
}

struct RigidReference {
  // Inertial position and velocity of the mass centre, reaction in body axes.
  std::vector<std::vector<double>> position{3}, velocity{3}, force{3};
  std::vector<double> tension;
};

inline RigidReference reference_of(const RigidCase& c, int steps = 200) {
  using Eigen::Vector3d;
  RigidReference r;
  const int count = static_cast<int>(std::lround(c.duration / c.interval));
  for (const FixedPointState& s : integrate(c.body, c.start, c.interval, count, steps)) {
    const Vector3d x = position(c.body, s), v = s.p * s.w.cross(c.body.center),
                   f = reaction(c.body, s);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto I = static_cast<Eigen::Index>(i);
      r.position[i].push_back(x(I));
      r.velocity[i].push_back(v(I));
      r.force[i].push_back(f(I));
    }
    r.tension.push_back(-f.dot(c.body.center.normalized()));
  }
  return r;
}

// Component of a force, given in the joint's frame, along the direction it has when it is largest: that of
// the rod, which turns with the frame.
inline std::vector<double> along_largest(const Columns& force) {
  const auto at = [&force](std::size_t k) {
    return Vec3((*force[0])[k], (*force[1])[k], (*force[2])[k]);
  };
  Vec3 largest = Vec3::Zero();
  for (std::size_t k = 0; k < force[0]->size(); ++k)
    if (at(k).norm() > largest.norm()) largest = at(k);
  std::vector<double> component;
  for (std::size_t k = 0; k < force[0]->size(); ++k)
    component.push_back(at(k).dot(largest.normalized()));
  return component;
}

// Of the recorded reaction (joint_record), or of the pendulum's tension.
inline double reaction_error(const RigidCase& c, const RigidReference& reference, const Table& t) {
  const std::size_t n = reference.tension.size();
  const Columns force = components(t, "joint_" + c.joint + ".reaction_force");
  if (c.model != "pendulum") return relative_rms(force, columns_of(reference.force), 0, n);
  const std::vector<double> tension = along_largest(force);
  return relative_rms({&tension}, {&reference.tension}, 0, n);
}

}  // namespace mbd::test
