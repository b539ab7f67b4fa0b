// Cylindrical joint about and along e3: one rotation and one translation left free.
//
//   x_b.e1 = x_b.e2 = 0 (two forces across the axis, b axes);   a3.b1 = a3.b2 = 0
// Resolved in b: with b3 = a3, x_b.e1 and x_b.e2 are the distances from the axis.
#pragma once

#include "joints/joint.hpp"

namespace mbd::joint {

struct Cylindrical {
  static constexpr const char* name = "cylindrical";
  static constexpr const char* doc =
      "One rotation and one translation are left free, about and along the axis.";
  static constexpr std::tuple rows{position(1), position(2), direction(3, 1), direction(3, 2)};
  static constexpr Traits traits{.axis = true, .angle = true, .displacement = true};
};

}  // namespace mbd::joint
