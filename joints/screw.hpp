// Screw joint about e3: a cylindrical joint whose translation follows its rotation.
//
//   x_b.e1 = x_b.e2 = 0;   a3.b1 = a3.b2 = 0;   x_b.e3 - (pitch/2pi) theta = 0 (force along the axis)
// theta is the unwrapped angle (joint.hpp (7)), so the advance goes on over any number of turns. The force
// along the axis comes with the moment -(pitch/2pi) times it about the axis: no friction.
#pragma once

#include "joints/joint.hpp"

namespace mbd::joint {

struct Screw {
  static constexpr const char* name = "screw";
  static constexpr const char* doc =
      "Turning about the axis advances along it by the pitch a turn.";
  static constexpr std::tuple rows{position(1), position(2), direction(3, 1), direction(3, 2),
                                   advance()};
  static constexpr Traits traits{
      .axis = true,
      .angle = true,
      .displacement = true,
      .parameter = {"pitch", "m",
                    "advance of b relative to a per turn about the axis; "
                    "negative for a left-handed screw"}};
};

}  // namespace mbd::joint
