// A component of the motion of a place, of frame F in its node, as a sensor. H = H_node F = (R, r) its pose, u = A dU its
// increment, [v; w] = A V its velocities in its own axes, A = Ad(F^-1), e a unit vector:
//   position       e.r          by U  A^T [R^T e; 0]                                                      (1)
//   velocity       e.R v        by U  A^T [0; v x R^T e],  by V  A^T [R^T e; 0]                           (2)
//   rotation rate  e.R w        by U  A^T [0; w x R^T e],  by V  A^T [0; R^T e]                           (3)
//   own axes       e.v, e.w     by V  A^T [e; 0], A^T [0; e]                                              (4)
#pragma once

#include <vector>

#include "libmbd/core/system.hpp"

namespace mbd {

class PlaceSensor final : public Sensor {
 public:
  enum class Of { position, velocity, angular_velocity, velocity_local, angular_velocity_local };
  // `from`: what is taken off a position, that of the reference configuration for a displacement [m].
  PlaceSensor(Of of, int node, const Pose<double>& frame, int component, double from)
      : of_(of),
        node_(node),
        frame_(frame),
        e_(Vec3::Unit(component)),
        from_(from),
        A_(adjoint_inverse(frame).matrix()) {}

  double value(const State& state) const override {
    const Pose<double> H = state.pose[static_cast<std::size_t>(node_)] * frame_;
    const Vec6 V = own_velocity(state);
    switch (of_) {
      case Of::position:
        return e_.dot(H.r) - from_;
      case Of::velocity:
        return e_.dot(H.R() * V.head<3>());
      case Of::angular_velocity:
        return e_.dot(H.R() * V.tail<3>());
      case Of::velocity_local:
        return e_.dot(V.head<3>());
      case Of::angular_velocity_local:
        break;
    }
    return e_.dot(V.tail<3>());
  }

  std::vector<int> nodes() const override { return {node_}; }

  void derive(const State& state, std::span<Vec6> by_motion,
              std::span<Vec6> by_velocity) const override {
    const Pose<double> H = state.pose[static_cast<std::size_t>(node_)] * frame_;
    const Vec6 V = own_velocity(state);
    const Vec3 e = H.R().transpose() * e_, v = V.head<3>(), w = V.tail<3>(), none = Vec3::Zero();
    Vec6 u = Vec6::Zero(), rate = Vec6::Zero();
    switch (of_) {
      case Of::position:
        u << e, none;
        break;
      case Of::velocity:
        u << none, v.cross(e);
        rate << e, none;
        break;
      case Of::angular_velocity:
        u << none, w.cross(e);
        rate << none, e;
        break;
      case Of::velocity_local:
        rate << e_, none;
        break;
      case Of::angular_velocity_local:
        rate << none, e_;
        break;
    }
    by_motion[0] = A_.transpose() * u;
    by_velocity[0] = A_.transpose() * rate;
  }

 private:
  Vec6 own_velocity(const State& state) const {
    return state.V.empty() ? Vec6(Vec6::Zero())
                           : Vec6(A_ * state.V[static_cast<std::size_t>(node_)]);
  }

  Of of_;
  int node_;
  Pose<double> frame_;
  Vec3 e_;
  double from_;
  Mat6 A_;
};

}  // namespace mbd
