// Planar joint: b slides on the plane through a's origin with normal e3, and turns about the normal.
//
//   x_b.e3 = 0 (force along the normal);   a3.b1 = a3.b2 = 0 (moments about b2 and -b1)
// The free angle is theta = atan2(a2.b1, a1.b1), as of a revolute joint.
#pragma once

#include "joints/joint.hpp"

namespace mbd::joint {

struct Planar {
  static constexpr const char* name = "planar";
  static constexpr const char* doc = "Two translations and one rotation are left free, in a plane.";
  static constexpr std::tuple rows{position(3), direction(3, 1), direction(3, 2)};
  static constexpr Traits traits{.axis = true, .angle = true};
};

}  // namespace mbd::joint
