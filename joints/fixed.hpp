// Fixed joint: frames a and b coincide.
//
//   x_b = 0 (three forces, b axes);   a3.b2 = a1.b3 = a2.b1 = 0 (moments about b1, b2, b3)
// On the solution the gradient of the three directions is the identity in psi. Not used: the axial vector
// of R as one row of three, which has the same gradient but couples the rows.
#pragma once

#include "joints/joint.hpp"

namespace mbd::joint {

struct Fixed {
  static constexpr const char* name = "fixed";
  static constexpr const char* doc = "Nothing is left free.";
  static constexpr std::tuple rows{position(1),     position(2),     position(3),
                                   direction(3, 2), direction(1, 3), direction(2, 1)};
  static constexpr Traits traits{};
};

}  // namespace mbd::joint
