// Blades of windIO files (the ontology of wind turbines of IEA Wind Task 37) as models: reference axis, twist, and sectional
// stiffness and mass of every station.
//
// Both layouts are read:
//   1: components.blade.elastic_properties_mb.six_x_six with stiff_matrix and inertia_matrix of 21 numbers a station, row by row
//      of the upper triangle; reference_axis and twist beside them, or in outer_shape_bem; twist in radians;
//   2: components.blade.structure.elastic_properties with stiffness_matrix K11 … K66 and inertia_matrix mass, cm_x, cm_y, i_edge,
//      i_flap, i_plr, i_cp; reference_axis of the blade, twist of its outer_shape in degrees.
//
// Axes. windIO's (BeamDyn's) are x towards the suction side, y towards the trailing edge, z from root to tip; they are the model's
// inertial axes. A section's axes are b1 = z along the reference line, b2 = x, b3 = y, so that rows 1 … 6 of windIO's
// matrices, [Fx Fy Fz Mx My Mz], are rows 2 3 1 5 6 4 here, without a change of sign. Twist is about -z there and about b1 here: it
// changes sign.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace mbd {

struct WindioOptions {
  int elements = 10, order = 4;      // of the beam
  std::optional<bool> in_degrees{};  // twist; default: as the layout says
};

struct WindioBlade {
  std::string model;  // XML: the blade, clamped at its root, under its weight
  std::string summary;
};

// Throws Error with file and line for what is no windIO file of a blade: keys or numbers that are missing, grids that do not rise
// from 0 to 1, matrices that are not positive definite, a twist beyond a quarter turn.
WindioBlade read_windio(const std::filesystem::path& file, const WindioOptions& options);

}  // namespace mbd
