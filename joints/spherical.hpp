// Spherical joint: the origins of a and b coincide, three rotations left free.
//
//   x_b = 0 (three forces, b axes)
#pragma once

#include "joints/joint.hpp"

namespace mbd::joint {

struct Spherical {
  static constexpr const char* name = "spherical";
  static constexpr const char* doc = "Three rotations are left free.";
  static constexpr std::tuple rows{position(1), position(2), position(3)};
  static constexpr Traits traits{};
};

}  // namespace mbd::joint
