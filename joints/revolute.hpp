// Revolute joint about e3: one rotation left free.
//
//   x_b = 0 (three forces, b axes);   a3.b1 = a3.b2 = 0 (moments about b2 and -b1)
// The free angle is theta = atan2(a2.b1, a1.b1), unwrapped by State::angles.
#pragma once

#include "joints/joint.hpp"

namespace mbd::joint {

struct Revolute {
  static constexpr const char* name = "revolute";
  static constexpr const char* doc = "One rotation is left free, about the axis.";
  static constexpr std::tuple rows{position(1), position(2), position(3), direction(3, 1),
                                   direction(3, 2)};
  static constexpr Traits traits{.axis = true, .angle = true};
};

}  // namespace mbd::joint
