// Closed curves that are swept along beams, and what closes them at the ends.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "libmbd/section/mesh.hpp"

namespace mbd {

// A place of a section over half its sides: (x2, x3)/(side/2).
using OutlinePoint = std::array<double, 2>;

struct SectionOutline {
  std::vector<OutlinePoint> rim;
  std::vector<int>
      next;  // of each point of the rim, counter-clockwise about what is solid (seen against b1)
  std::vector<std::vector<OutlinePoint>> caps;  // convex, and the same way round
};

SectionOutline round_outline(int corners);
SectionOutline rectangle_outline();

// Of a mesh: its rims without points that lie on a line with their neighbours, and its elements. `sides` becomes the
// widths [m] along b2 and b3 of what it is over.
SectionOutline outline_of(const section::Mesh& mesh, std::array<double, 2>& sides);

// Whether one may be drawn in place of the other, over its own sides: points of one order that lie near each other. Walls may be
// thicker, but not much.
bool are_alike(const SectionOutline& a, const SectionOutline& b);

// As drawings have it: {"rim": [y, z, …], "next": […], "caps": [[y, z, …], …]}.
std::string outline_text(const SectionOutline& outline);
SectionOutline outline_from(const std::string& text);

}  // namespace mbd
