// Stresses over sections that are stated by material, at points of their plane, to be swept along beams (vtk.hpp), and at
// points of their outlines (page.hpp).
#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "libmbd/scene/scene.hpp"
#include "libmbd/section/stress.hpp"
#include "libmbd/view/motion.hpp"
#include "libmbd/view/outline.hpp"

namespace mbd {

// Elements of a section divided into cells. Each element has points of its own, since stresses jump between plies.
struct SectionStresses {
  std::vector<std::array<double, 2>> points;  // x2, x3 [m]
  std::vector<Mat6> stress;  // [11 22 33 12 23 13], section axes, of unit [N Q2 Q3 M1 M2 M3]
  std::vector<Mat6> ply;     // [LL TT NN TN LN LT], axes of plies; empty where all is isotropic
  std::vector<std::vector<int>> cells;  // corners, counter-clockwise seen against b1
};

// Elements divided n times each way; `ply`: with the stresses in axes of plies.
SectionStresses section_stresses(const section::StressField& field, int n, bool ply);

// By the name of the beam.
using StressesOfBeams = std::map<std::string, std::shared_ptr<const SectionStresses>>;

// Whether the motion has beams whose stresses can be told: flexible ones, of one section that has a shape.
bool has_section_stresses(const Motion& motion);

// Of these beams, by the model that was run. Throws Error where their sections in the model are not those of the motion, and
// where there would be too many points.
StressesOfBeams stresses_of_beams(const Scene& model, const Motion& motion);

// Stresses on the surface of beams, at the points of a finer outline, by resultants S = [N Q2 Q3 M1 M2 M3].
struct OutlineStresses {
  // Up to some 48 points, fewer where there are many beams; its caps are not told of.
  SectionOutline outline;
  // sqrt(S.A S) is von Mises' stress [1/m^4, 1/m^5, 1/m^6].
  std::vector<Mat6> von_mises;
  // b.S is the stress along them [1/m^2, 1/m^3]; empty where all is isotropic.
  std::vector<Vec6> fibres;
};

// By the name of the section.
using StressesOfOutlines = std::map<std::string, OutlineStresses>;

// Of the same beams, and throws the same. Where elements meet at a point, that of one of them.
StressesOfOutlines stresses_of_outlines(const Scene& model, const Motion& motion);

}  // namespace mbd
