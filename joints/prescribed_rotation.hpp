// A prescribed rotation of b relative to a, by the rotation vector r(t) in the axes of a, of any length.
//
//   a3.b2 = a1.b3 = a2.b1 = 0 (moments about b1, b2, b3),   frame a moving with M(t) = (exp(r~(t)), 0)
#pragma once

#include "joints/joint.hpp"

namespace mbd::joint {

struct PrescribedRotation {
  static constexpr const char* name = "prescribed rotation";
  static constexpr const char* doc = "A prescribed rotation.";
  static constexpr std::tuple rows{direction(3, 2), direction(1, 3), direction(2, 1)};
  static constexpr Traits traits{.law = Law::rotation};
};

}  // namespace mbd::joint
