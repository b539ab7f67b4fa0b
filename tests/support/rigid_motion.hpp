// Motions of rigid bodies about a fixed point by the classical equations, independent of the library:
//   J w' = m c x (R^T g) - w x J w,   p' = p (0, w) / 2,                                           (1)
// J about the fixed point, body axes; by Runge and Kutta's method of order 4 with small steps.
// Reaction at the fixed point, body axes: F = m (w' x c + w x (w x c) - R^T g).                    (2)
#pragma once

#include <Eigen/Dense>
#include <vector>

namespace mbd::test {

struct FixedPointBody {
  double mass = 0.0;  // [kg]
  Eigen::Vector3d center =
      Eigen::Vector3d::Zero();  // mass centre from the fixed point, body axes [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // J [kg.m2]
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  // inertial [m/s2]
};

struct FixedPointState {
  Eigen::Quaterniond p = Eigen::Quaterniond::Identity();
  Eigen::Vector3d w = Eigen::Vector3d::Zero();  // body axes [rad/s]
};

inline Eigen::Vector3d angular_acceleration(const FixedPointBody& b, const FixedPointState& s) {
  const Eigen::Vector3d g = s.p.conjugate() * b.gravity, L = b.inertia * s.w;
  return b.inertia.inverse() * (b.mass * b.center.cross(g) - s.w.cross(L));
}

inline Eigen::Vector3d position(const FixedPointBody& b, const FixedPointState& s) {
  return s.p * b.center;
}

inline Eigen::Vector3d reaction(const FixedPointBody& b, const FixedPointState& s) {
  const Eigen::Vector3d a =
      angular_acceleration(b, s).cross(b.center) + s.w.cross(s.w.cross(b.center));
  return b.mass * (a - s.p.conjugate() * b.gravity);
}

// States at 0, interval, 2 interval, …, count intervals; `steps` steps to each.
inline std::vector<FixedPointState> integrate(const FixedPointBody& body, FixedPointState s,
                                              double interval, int count, int steps) {
  using Eigen::Quaterniond, Eigen::Vector3d;
  struct Rate {
    Eigen::Vector4d p;
    Vector3d w;
  };
  const auto rate = [&body](const FixedPointState& x) {
    const Quaterniond d = x.p * Quaterniond(0.0, x.w(0), x.w(1), x.w(2));
    return Rate{0.5 * d.coeffs(), angular_acceleration(body, x)};
  };
  const auto moved = [](FixedPointState x, double h, const Rate& r) {
    x.p.coeffs() += h * r.p;
    x.w += h * r.w;
    return x;
  };
  std::vector<FixedPointState> result{s};
  const double h = interval / steps;
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < steps; ++k) {
      const Rate a = rate(s), b = rate(moved(s, h / 2, a)), c = rate(moved(s, h / 2, b)),
                 d = rate(moved(s, h, c));
      s.p.coeffs() += h / 6 * (a.p + 2 * b.p + 2 * c.p + d.p);
      s.w += h / 6 * (a.w + 2 * b.w + 2 * c.w + d.w);
      s.p.normalize();
    }
    result.push_back(s);
  }
  return result;
}

}  // namespace mbd::test
