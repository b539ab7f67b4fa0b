// Meshes of cells, images of the unit square that meet along whole sides, finer round the corners that are marked.
//
// How a side is divided follows from the marks at its two ends alone, so that cells which meet fit without more being said:
//   none: not at all;  one: at 1, r, r^2, ... r^n from the marked end;  two: in thirds, the outer ones so again.
// A cell without marks is one element. Round a marked corner lie n rings of two quadrilaterals, and one in the corner itself.
// Not used: gradings of whole cells in both directions, which run on through the cells beside, and cost the square of n.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "libmbd/section/mesh.hpp"
#include "libmbd/section/shapes.hpp"

namespace mbd::section {

struct Cell {
  std::function<Point(double xi, double eta)> map;      // right-handed, of [0, 1]^2
  std::function<double(double xi, double eta)> normal;  // of the ply, angle from b2 without jumps
  std::array<bool, 4> marked;                           // (0, 0), (1, 0), (1, 1), (0, 1)
  int material = 0;
  double angle = 0.0;
  std::string name;  // for messages
  int part = 0;      // what it belongs to
};

// Its elements have the order of `fineness`; there are as many rings as it has layers. Points within half of `near` [m] are
// one node.
Mesh mesh_of(const std::vector<Cell>& cells, const Fineness& fineness,
             const std::vector<MeshMaterial>& materials, double near);

inline constexpr double ring_ratio = 0.18;

}  // namespace mbd::section
