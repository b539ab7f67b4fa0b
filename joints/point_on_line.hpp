// Point on a line: a's origin stays on the line along b3 through b's origin.
//
//   x_b.e1 = x_b.e2 = 0 (two forces across the line, b axes)
// It closes planar loops of revolute joints, with the line along their axes, without redundancy: the loop
// keeps its plane already. (A revolute joint there would hold three motions twice.)
#pragma once

#include "joints/joint.hpp"

namespace mbd::joint {

struct PointOnLine {
  static constexpr const char* name = "point_on_line";
  static constexpr const char* doc = "A point of a stays on a line of b.";
  static constexpr std::tuple rows{position(1), position(2)};
  static constexpr Traits traits{.axis = true};
};

}  // namespace mbd::joint
