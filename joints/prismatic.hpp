// Prismatic joint along e3: one translation left free.
//
//   x_b.e1 = x_b.e2 = 0 (two forces across the axis);   a3.b2 = a1.b3 = a2.b1 = 0 (moments about b1, b2, b3)
// The displacement is x_b.e3.
#pragma once

#include "joints/joint.hpp"

namespace mbd::joint {

struct Prismatic {
  static constexpr const char* name = "prismatic";
  static constexpr const char* doc = "One translation is left free, along the axis.";
  static constexpr std::tuple rows{position(1), position(2), direction(3, 2), direction(1, 3),
                                   direction(2, 1)};
  static constexpr Traits traits{.axis = true, .displacement = true};
};

}  // namespace mbd::joint
