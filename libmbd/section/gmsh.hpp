// Meshes in files of Gmsh: format 2.2 and 4.1, text or binary (of this machine's order of bytes), surfaces of triangles with 3 or 6
// nodes and quadrilaterals with 4, 8 or 9. x and y of the file are x2 and x3; points, lines and parametric coordinates are
// not looked at.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "libmbd/section/shapes.hpp"

namespace mbd::section {

struct GmshMesh {
  // Counter-clockwise; nodes in Gmsh's order, corners first.
  struct Cell {
    int corners = 3;  // or 4
    std::vector<int> nodes;
    int group = 0;
    long tag = 0;  // its number in the file
  };
  std::vector<Point> nodes;  // [m]
  std::vector<Cell> cells;
  // Physical surfaces of the cells: their names, or numbers where they have none; "" of cells of no physical surface.
  std::vector<std::string> groups;

  // All that a mesh is made of, as numbers.
  void each_number(const std::function<void(double)>& f) const;
};

// `unit`: length of one unit of the file [m]. Throws Error, with line or byte, for what is no such file; with element and
// place for elements that are no such surfaces, leave the plane, overlap, or whose sides do not fit; for parts that
// are not joined, and sides that lie upon each other without being one.
GmshMesh read_gmsh(const std::filesystem::path& file, double unit = 1.0);

// What the cells of a group consist of.
struct MeshPart {
  int material = 0;
  double angle = 0.0;                  // theta of the ply [rad]
  double normal = 1.5707963267948966;  // its angle from b2 [rad]
};

// Elements of the order that is asked for, 1 to 8, in the shape that the file's have. `parts`: one for each group.
Mesher mesher_of(GmshMesh mesh, std::vector<MeshPart> parts, std::vector<MeshMaterial> materials);

}  // namespace mbd::section
