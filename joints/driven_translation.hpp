// A prescribed displacement d(t) of b relative to a along e3, added to a joint with a displacement.
//
//   x_b.e3 - d(t) = 0       (force along e3)
#pragma once

#include "joints/joint.hpp"

namespace mbd::joint {

struct DrivenTranslation {
  static constexpr const char* name = "driven translation";
  static constexpr const char* doc = "A prescribed displacement.";
  static constexpr std::tuple rows{displacement()};
  static constexpr Traits traits{.axis = true, .law = Law::coordinate};
};

}  // namespace mbd::joint
