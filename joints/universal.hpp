// Universal (Cardan, Hooke's) joint: the cross turns about e3 in a and about e1 in b.
//
//   x_b = 0 (three forces, b axes);   a3.b1 = 0 (the axes stay perpendicular; moment along b1 x a3)
// Validity: any angles; where the shafts are at right angles one of them cannot turn.
#pragma once

#include "joints/joint.hpp"

namespace mbd::joint {

struct Universal {
  static constexpr const char* name = "universal";
  static constexpr const char* doc =
      "Two rotations are left free, about an axis fixed in a and one fixed in b.";
  static constexpr std::tuple rows{position(1), position(2), position(3), direction(3, 1)};
  static constexpr Traits traits{.axis = true, .second_axis = true};
};

}  // namespace mbd::joint
