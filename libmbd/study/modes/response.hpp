// Response of what turns steadily, in the linearised equations of small motions (small_motions.hpp), to unbalance: masses m
// at distances e from the axis, as forces F W^2 that turn with it, F = m e:
//   resting axes:  (K + i W C - W^2 M) u + B^T dlambda = F W^2,   u(t) = Re(u exp(i W t))             (1)
//   turning axes:  K u + B^T dlambda = F W^2, F real                                                 (2)
// Across the axis, w = y + i z in inertial axes e2, e3 at right angles to it, an orbit is an ellipse
//   w(t) = forward exp(i W t) + backward exp(-i W t),                                                (3)
// the unbalance being at exp(i W t): the phase by which a forward whirl is behind it is -arg(forward), 0 far below a critical
// speed and half a turn far above. Of a scene with an eccentric mass the steady rotation itself, which is not linearised, is
// moved by it; U comes on top of that.
//
// And to forces (y e2 + z e3) cos(w t) of fixed direction, w = n W:
//   resting axes:  (K + i w C - w^2 M) u + B^T dlambda = F                                            (4)
//   turning axes:  half of it turns at w - W there, half at -(w + W); each moves a point along an ellipse
//                  a exp(i v t) + b exp(-i v t), v one of these, so that in inertial axes             (5)
//                  w(t) = a1 exp(i w t) + b1 exp(i (2 W - w) t) + a2 exp(-i w t) + b2 exp(i (2 W + w) t)
// with b = 0 of round shafts.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/study/modes/modes.hpp"

namespace mbd {

struct Unbalance {
  std::string place;    // "disk", "shaft@0.5": named_places()
  double moment = 0.0;  // U [kg.m] along e2; negative: opposite
};

// A force along e2 and e3 that goes as cos(w t).
struct HarmonicForce {
  std::string place;
  double y = 0.0, z = 0.0;  // [N]
};

// (3) of a place [m], of a force with w in place of W.
struct Orbit {
  double rate = 0.0;  // W [rad/s]
  std::complex<double> forward, backward;
  double besides = 0.0;  // |b1| + |b2| of (5), at other frequencies

  double major() const { return std::abs(forward) + std::abs(backward); }  // half axes
  double minor() const { return std::abs(std::abs(forward) - std::abs(backward)); }
  // [rad] -pi/2 to 3/2 pi, of the forward part behind the unbalance, or behind exp(i w t).
  double lag() const;
};

// e2: the inertial axis that follows the one along which the axis of rotation is longest (of i1 it is i2, of i3 i1), what of
// it is across. e3 = axis x e2.
Vec3 first_across(const Vec3& axis);

// Orbits of the places, in their order, at the rotation that `motions` has been turned to; what is assembled in `motions` is
// changed by it. Nothing where the equations are singular: undamped, at a critical speed. Throws Error for places that are not
// there, or an unbalance of what does not turn.
std::optional<std::vector<Orbit>> response_to_unbalance(MotionsOfScene& motions,
                                                        const SteadyRotation& rotation,
                                                        const std::vector<Unbalance>& unbalance,
                                                        const std::vector<std::string>& places);

// The same of forces of that order n > 0.
std::optional<std::vector<Orbit>> response_to_forces(MotionsOfScene& motions,
                                                     const SteadyRotation& rotation,
                                                     const std::vector<HarmonicForce>& forces,
                                                     double order,
                                                     const std::vector<std::string>& places);

}  // namespace mbd
