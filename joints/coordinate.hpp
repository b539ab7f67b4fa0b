// The free coordinate of a joint, for springs, dampers and torques that act along it (frames as in joint.hpp).
//
//   dx = w.zeta,   zeta = [u; psi] the increment of g in b,   H = dw/dzeta
//   Turning:  x = theta, unwrapped,   w = [ 0 ; w of joint.hpp (7) ],   H = [ 0 0 ; 0 dw/dpsi ]           (1)
//   Sliding:  x = x_b.e3,             w = [ e3 ; e3 x x_b ],            H = [ 0 0 ; e3~  e3~ x_b~ ]       (2)
//   rate      xdot = w.z,   z = V_b - y the relative twist (two_frames.hpp (2)); at fixed V
//             dxdot = (H^T z - y~^T w).zeta                                                               (3)
// A force tau along x is the wrench f = tau w on b, with L = w dtau^T + tau H.
#pragma once

#include "elements/pair/two_frames.hpp"
#include "joints/joint.hpp"

namespace mbd::joint {

struct Turning {
  template <class S>
  static S value(const Pose<S>& g, double near) {
    return unwrapped_angle<S>(g.R(), near);
  }
  template <class S>
  static Vector6<S> gradient(const Pose<S>& g) {
    return six<S>(Vector3<S>::Zero(), angle_gradient<S>(g.R()));
  }
  template <class S>
  static Matrix6<S> curvature(const Pose<S>& g) {
    Matrix6<S> H = Matrix6<S>::Zero();
    H.template bottomRightCorner<3, 3>() = angle_curvature<S>(g.R());
    return H;
  }
};

struct Sliding {
  template <class S>
  static S value(const Pose<S>& g, double /*near*/) {
    return (g.R().transpose() * g.r)(2);
  }
  template <class S>
  static Vector6<S> gradient(const Pose<S>& g) {
    const Vector3<S> e3 = Vector3<S>::Unit(2), x_b = g.R().transpose() * g.r;
    return six<S>(e3, e3.cross(x_b));
  }
  template <class S>
  static Matrix6<S> curvature(const Pose<S>& g) {
    const Matrix3<S> e3 = hat(Vector3<S>(Vector3<S>::Unit(2)));
    const Vector3<S> x_b = g.R().transpose() * g.r;
    Matrix6<S> H = Matrix6<S>::Zero();
    H.template bottomLeftCorner<3, 3>() = e3;
    H.template bottomRightCorner<3, 3>() = e3 * hat(x_b);
    return H;
  }
};

// Where along which joint.
struct Axis {
  two_frames::Ends ends;
  Index angle = -1;  // followed angle of the joint; of Sliding not used

  double near(const Environment& env) const {
    return angle < 0 ? 0.0 : env.angles[static_cast<std::size_t>(angle)];
  }
};

}  // namespace mbd::joint
