// A prescribed rotation phi(t) of b relative to a about e3, added to a joint with an angle.
//
//   sin(theta - phi) = -sin(phi) a1.b1 + cos(phi) a2.b1 = 0       (moment about e3)
// Needs no unwrapped angle: it holds modulo pi, and a state on the other branch is refused. phi, its rate and its
// acceleration come from a signal; a rate law is integrated to position first (signal.hpp).
#pragma once

#include "joints/joint.hpp"

namespace mbd::joint {

struct DrivenRotation {
  static constexpr const char* name = "driven rotation";
  static constexpr const char* doc = "A prescribed angle.";
  static constexpr std::tuple rows{angle()};
  static constexpr Traits traits{.axis = true, .law = Law::coordinate};
};

}  // namespace mbd::joint
