// Models of rigid bodies whose motion and reactions rigid_motion.hpp gives.
#pragma once

#include <string>
#include <vector>

#include "tests/support/rigid_motion.hpp"

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

}  // namespace mbd::test
