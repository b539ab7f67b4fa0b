// Distance: a massless rigid rod of length L, with ball joints at its ends, from a's point to b's.
//
//   (x.x - L^2)/(2L) = 0     L the distance in the reference configuration
// The multiplier is the axial force of the rod, tension positive: the gradient is the unit vector along it.
// The three rotations and two translations of b across the rod are left free.
#pragma once

#include "joints/joint.hpp"

namespace mbd::joint {

struct Distance {
  static constexpr const char* name = "distance";
  static constexpr const char* doc = "A massless rod with ball joints at its ends.";
  static constexpr std::tuple rows{distance()};
  static constexpr Traits traits{.points = Points::two};
};

}  // namespace mbd::joint
