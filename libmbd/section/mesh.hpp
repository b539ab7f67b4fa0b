// A mesh of a cross-section: plain data.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/section/failure.hpp"
#include "libmbd/section/material.hpp"

namespace mbd::section {

using Point = Eigen::Matrix<double, 2, 1, Eigen::DontAlign>;  // x2, x3 [m], along b2 and b3

// What an element is, with its nodes in this order, counter-clockwise seen against b1 (b2 to the right, b3 up):
//   grid         order p >= 1: (p + 1)^2 Gauss-Lobatto nodes, node i + (p + 1) j at (xi_i, eta_j) in [-1, 1]^2
//   serendipity  order 2: four corners from (-1, -1), then the middles of the sides from that between the first two
//   triangle     order p >= 1: three corners, nodes of the sides from corner to corner (at the Gauss-Lobatto nodes of
//                order p; of order 2 their middles), and those inside
enum class Shape { grid, serendipity, triangle };

struct Element {
  Shape shape = Shape::grid;
  int order = 1;
  std::vector<int> nodes;
  int material = 0;    // place in Mesh::materials
  double angle = 0.0;  // theta of the ply [rad]
  // Angle of the ply's normal from b2 [rad], at each node (interpolated between, without jumps of 2 pi), or one for all.
  std::vector<double> normals{1.5707963267948966};
  std::string name;  // for messages: what of, such as "ply 2 of the top wall"; may be empty
};

struct MeshMaterial {
  Stiffness stiffness;                      // in its axes L T N
  double density = 0.0;                     // kg/m^3, not negative
  std::string name;                         // for messages
  std::optional<Strengths> strengths = {};  // along L T N
  std::optional<double> yield = {};         // of an isotropic one [Pa]
};

struct Mesh {
  std::vector<Point> nodes;
  std::vector<Element> elements;
  std::vector<MeshMaterial> materials;

  const MeshMaterial& material_of(int element) const {
    return materials[static_cast<std::size_t>(
        elements[static_cast<std::size_t>(element)].material)];
  }
};

}  // namespace mbd::section
