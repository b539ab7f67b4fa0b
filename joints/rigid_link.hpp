// Rigid link: a massless rigid arm from one place to another.
//
//   The rows of the fixed joint, at b's own point by default:
//   x_b = 0 (three forces, b axes);   a3.b2 = a1.b3 = a2.b1 = 0 (moments about b1, b2, b3)
// Frame a sits at the end of an arm in its node, so nothing has to meet in the reference configuration.
#pragma once

#include "joints/fixed.hpp"

namespace mbd::joint {

struct RigidLink {
  static constexpr const char* name = "rigid_link";
  static constexpr const char* doc = "A rigid, massless arm between two places at any distance.";
  static constexpr auto rows = Fixed::rows;
  static constexpr Traits traits{.points = Points::one_away};
};

}  // namespace mbd::joint
