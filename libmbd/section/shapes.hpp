// Sections by their dimensions, and meshes of them that are graded towards corners and ends of plies.
//
// A layup lists its plies from the inner surface of a wall to the outer one (of a rectangle: along b3), each with the
// angle theta about the outward normal (material.hpp). Where the normal of a wall of a tube or box points outward, a
// listing from the outside is reversed() first.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "libmbd/section/analysis.hpp"
#include "libmbd/section/mesh.hpp"

namespace mbd::section {

struct Ply {
  int material = 0;        // place in the list of materials
  double thickness = 0.0;  // [m]
  double angle = 0.0;      // theta [rad]
};
using Layup = std::vector<Ply>;

double thickness_of(const Layup& layup);
Layup reversed(Layup layup);

// How fine a mesh is: order of its elements, and how many times their size shrinks towards places where stresses may be
// singular.
struct Fineness {
  int order = 2;
  int layers = 1;
};

// A section that can be meshed as finely as one likes. Its meshes have the same outline.
using Mesher = std::function<Mesh(const Fineness&)>;

// Each throws Error where dimensions are not positive or plies do not fit, naming what and the limit.
// All are centred on x2 = x3 = 0 but where it is said.
Mesher tube(double outer_radius, const Layup& layup, const std::vector<MeshMaterial>& materials);
Mesher bar(double radius, int material, double angle, const std::vector<MeshMaterial>& materials);
// Plies lie across b3, the first at the bottom; their normal is b3. `width` along b2; the height is that of the layup.
Mesher rectangle(double width, const Layup& layup, const std::vector<MeshMaterial>& materials);

// Corners of a box: mitred, plies turn round them; butt, the walls across b3 go through and those across b2 stand
// between them.
enum class Corners { mitred, butt };
// Outer width along b2 and height along b3; normals point outward.
Mesher box(double width, double height, const Layup& layup, Corners corners,
           const std::vector<MeshMaterial>& materials);
// Flanges of that width across b3 at top and bottom, normals outward (away from the middle), go through; the web stands
// between them on b3, its normal b2: first ply of its layup on the side of -b2.
Mesher i_section(double width, double height, const Layup& flange, const Layup& web,
                 const std::vector<MeshMaterial>& materials);
// The same with the web at -b2, its outer face at x2 = 0 and its normal -b2; flanges end at x2 = width.
Mesher c_section(double width, double height, const Layup& flange, const Layup& web,
                 const std::vector<MeshMaterial>& materials);

// D and the others of a section to a tolerance: meshes are made finer in order and grading together until D changes
// less.
struct Converged {
  Analysis analysis;  // of the finest mesh
  Mat6 error =
      Mat6::Constant(std::numeric_limits<double>::infinity());  // estimated, of each entry of D
  bool reached = false;  // whether every error is below the tolerance
  Fineness fineness;
  int elements = 0, unknowns = 0;
};

// `tolerance` is of an entry ij over sqrt(D_ii D_jj). The estimate e of a diagonal entry, over it, is 0.7 of its last change,
// which bounds the rest of a series whose ratios are 0.41 or less from here on; where its ratio to the change before (or
// that of the largest change to the largest before) is above 0.5, twice the larger change; no less than a tenth of the
// largest e. An entry ij has sqrt(e_i e_j), round-off where it is zero by symmetry; none has less than round-off, 1e-11.
// Ends, not reached, before a mesh of more than `most_unknowns`; an error of infinity: before there was an estimate.
Converged converge(const Mesher& mesher, const Vec3& curvature = Vec3::Zero(),
                   double tolerance = 1e-6, int most_unknowns = 200'000);

// The meshes of converge(), coarse to fine, or (of_one_mesh) those of converge_orders().
std::vector<Fineness> levels_of(bool of_one_mesh);

// The estimate of converge(), of each entry of D: `now` is |D - that of the mesh before|, `before` the same one mesh earlier.
Mat6 error_of(const Mat6& d, const Mat6& now, const Mat6& before);

// The same with orders 1, 2, 3, ... (8 at most) of the elements of one mesh, of which `mesher` heeds the order only. The first two
// orders know twice their change.
Converged converge_orders(const Mesher& mesher, const Vec3& curvature, double tolerance,
                          int most_unknowns);

}  // namespace mbd::section
