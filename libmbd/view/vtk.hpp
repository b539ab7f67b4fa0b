// What there is to be seen of a model, or of the motion of a run, as files of VTK: NAME.pvd, which ParaView opens, and a
// directory NAME with the files of its frames, zlib-compressed, of double precision (surfaces: single).
//
//   nodes     .vtp   every node but the ground: displacement, velocity [m/s], angular_velocity [rad/s] (inertial axes), its
//                    axes as vectors axis_1, axis_2, axis_3; node, as in the system
//   lines     .vtu   centre lines of beams: a Lagrange curve of the beam's order for each element, through its nodes (the
//                    polynomial through them, at the equidistant points that VTK has), rigid beams as polylines; force
//                    (N Q2 Q3), moment (M1 M2 M3), section axes, by the polynomial through the quadrature points of the
//                    element; s, fraction of the reference length; part, element
//   stations  .vtp   quadrature points: force, moment as they are, strain (axial and shear) and curvature [1/m], section axes;
//                    those two without beams that have viscous damping, whose resultants are not elastic alone
//   outlines  .vtp   sections swept along the nodes: round, or rectangles, with the radii of gyration of the section
//   stresses  .vtu   of beams of one section that has a shape: their elements, swept from node to node as hexahedra and wedges.
//                    stress [Pa], section axes [11 22 33 12 23 13]; von_mises [Pa]; where a material is not isotropic
//                    ply_stress [Pa], axes of its ply [LL TT NN TN LN LT]. By resultants as lines have them; between
//                    elements of the beam, and of the section, stresses jump
//   bodies    .vtp   the sphere, cylinder or box of their mass and inertias
//   joints    .vtp   those with multipliers, at their frame on b: axis_1 … axis_3, angle [rad], force [N] and moment [N.m] on
//                    b, inertial axes; gap [m] between its frames
//   springs   .vtp   springs and bushings as lines
//   places    .vtp   recorded places that have a node: displacement, axes
//
// Each has displacement [m] from the reference configuration and part: the number of the part in NAME/parts.csv, which says
// its kind and name. What a model has none of is left out; stresses too, of sections by matrices: they say nothing of them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "libmbd/view/motion.hpp"
#include "libmbd/view/section_stresses.hpp"

namespace mbd {

struct VtkFiles {
  std::filesystem::path collection;  // NAME.pvd
  std::size_t frames = 1, of = 1;    // written, of those that the motion has
  std::size_t files = 0;
};

// The reference configuration of a drawing (drawing.hpp). Throws Error if a file cannot be written.
VtkFiles write_vtk(const std::filesystem::path& directory, std::string_view drawing);

// A motion; of its frames at most so many, evenly chosen, with the first and the last. Stresses of those beams.
VtkFiles write_vtk(const std::filesystem::path& directory, const Motion& motion,
                   std::size_t most_frames, const StressesOfBeams& stresses = {});

}  // namespace mbd
