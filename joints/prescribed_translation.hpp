// A prescribed translation d(t) of b from where a says, d in the axes of a.
//
//   x_b = 0 (three forces, b axes),   frame a moving in its node with M(t) = (I, d(t))
#pragma once

#include "joints/joint.hpp"

namespace mbd::joint {

struct PrescribedTranslation {
  static constexpr const char* name = "prescribed translation";
  static constexpr const char* doc = "A prescribed motion of a point.";
  static constexpr std::tuple rows{position(1), position(2), position(3)};
  static constexpr Traits traits{.law = Law::translation};
};

}  // namespace mbd::joint
