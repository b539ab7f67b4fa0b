// Letters drawn with a pen, for pictures in pixels: no font has to be installed.
#pragma once

#include <array>
#include <string_view>
#include <vector>

namespace mbd {

struct Lettering {
  std::vector<std::vector<std::array<double, 2>>>
      strokes;  // x to the right, y down, from the first letter's base line
  double width = 0.0;
};

// A line of text whose capitals are `height` high. What is not ASCII is a question mark.
Lettering lettering(std::string_view text, double height);

}  // namespace mbd
