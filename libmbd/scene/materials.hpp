// Materials of a scene, walls of their plies, and sections by their dimensions.
//
// What they come to, the D and M of a section, is computed when a model is read (libmbd/material/shaped_sections.hpp);
// angles and normals of plies are those of libmbd/section/material.hpp.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/core/types.hpp"
#include "libmbd/scene/field.hpp"

namespace mbd {

// From which side of a wall its plies are listed: the first is the innermost, or the outermost one.
enum class ListedFrom { inside, outside };
template <>
inline constexpr std::string_view words_of<ListedFrom> = "inside outside";

// Of a box: plies turn round its corners, or walls across b3 go through and those across b2 stand between them.
enum class BoxCorners { mitred, butt };
template <>
inline constexpr std::string_view words_of<BoxCorners> = "mitred butt";

// Linear elastic. Isotropic: young and poisson. Else along its axes L (fibres), T and N (across the ply); what is not
// given of N is as of T: EN = ET, GLN = GLT, nuLN = nuLT, GTN = ET/(2 (1 + nuTN)).
struct MaterialScene {
  Source source;
  std::string name;
  std::optional<double> young, poisson;
  std::optional<double> e_l, e_t, e_n, g_lt, g_ln, g_tn, nu_lt, nu_ln, nu_tn;
  std::optional<double> density;  // without one, sections of it have no mass
  std::optional<double> yield;    // of an isotropic one
  // Of one that is not: all of the first six, or none; those of N and of L and N are as of T where they are not given.
  std::optional<double> xt, xc, yt, yc, s_lt, s_tn, zt, zc, s_ln;

  static constexpr field::ItemKind item{
      "material",
      "A linear elastic material, of which sections are made: isotropic by E and nu; else along "
      "its "
      "axes, L along the fibres, N across the ply, T = N x L, by EL, ET, GLT, nuLT, nuTN, and what "
      "differs along N.",
      "materials", field::of_materials};
  static void each_field(const auto& f) {
    using namespace field;
    using S = MaterialScene;
    f(Field(&S::name, "name", "", required, "name plies and sections refer to", item_name));
    f(Field(&S::young, "E", "Pa", optional, "Young's modulus of an isotropic material", positive));
    f(Field(&S::poisson, "nu", pure_number, optional,
            "Poisson's ratio of an isotropic material, between -1 and 0.5"));
    f(Field(&S::e_l, "EL", "Pa", optional, "Young's modulus along L, the fibres", positive));
    f(Field(&S::e_t, "ET", "Pa", optional, "along T", positive));
    f(Field(&S::e_n, "EN", "Pa", optional, "along N (default: ET)", positive));
    f(Field(&S::g_lt, "GLT", "Pa", optional, "shear modulus in the ply", positive));
    f(Field(&S::g_ln, "GLN", "Pa", optional, "of L and N (default: GLT)", positive));
    f(Field(&S::g_tn, "GTN", "Pa", optional, "of T and N (default: ET/(2 (1 + nuTN)))", positive));
    f(Field(&S::nu_lt, "nuLT", pure_number, optional,
            "contraction along T by a stress along L; nuLT/EL = nuTL/ET"));
    f(Field(&S::nu_ln, "nuLN", pure_number, optional,
            "contraction along N by a stress along L (default: nuLT)"));
    f(Field(&S::nu_tn, "nuTN", pure_number, optional, "contraction along N by a stress along T"));
    f(Field(&S::density, "rho", "kg/m3", optional,
            "density; without one, sections of it have no mass", positive));
    f(Field(&S::yield, "yield", "Pa", optional,
            "yield stress of an isotropic material, for the quantity yield_index", positive));
    f(Field(&S::xt, "Xt", "Pa", optional, "strength along L, the fibres, in tension", positive));
    f(Field(&S::xc, "Xc", "Pa", optional, "along L in compression, as a positive number",
            positive));
    f(Field(&S::yt, "Yt", "Pa", optional, "along T in tension", positive));
    f(Field(&S::yc, "Yc", "Pa", optional, "along T in compression, positive", positive));
    f(Field(&S::s_lt, "SLT", "Pa", optional, "in shear in the ply", positive));
    f(Field(&S::s_tn, "STN", "Pa", optional, "in shear of T and N", positive));
    f(Field(&S::zt, "Zt", "Pa", optional, "along N in tension (default: Yt)", positive));
    f(Field(&S::zc, "Zc", "Pa", optional, "along N in compression (default: Yc)", positive));
    f(Field(&S::s_ln, "SLN", "Pa", optional, "in shear of L and N (default: SLT)", positive));
  }
};

struct PlyScene {
  Source source;
  std::string material;
  double thickness = 0.0;
  double angle = 0.0;

  static constexpr field::ItemKind item{"ply", "A ply of a layup."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = PlyScene;
    f(Field(&S::material, "material", "", required, "name of its material"));
    f(Field(&S::thickness, "thickness", "m", required, "its thickness", positive));
    f(Field(&S::angle, "angle", "rad", preset,
            "theta, of its L from b1: L = cos(theta) b1 + sin(theta) (n x b1), right-handed about "
            "the outward normal n of the wall"));
  }
};

struct LayupScene {
  Source source;
  std::string name;
  ListedFrom listed = ListedFrom::inside;
  std::vector<PlyScene> plies;  // at least one

  static constexpr field::ItemKind item{"layup", "The plies of a wall, one after the other.",
                                        "layups", field::of_layups};
  static void each_field(const auto& f) {
    using namespace field;
    using S = LayupScene;
    f(Field(&S::name, "name", "", required, "name sections refer to", item_name));
    f(Field(&S::listed, "listed", "", preset,
            "from the inside, the first ply is the innermost one; or from the outside. Angles are "
            "about the outward normal in both cases"));
    f(Parts(&S::plies));
  }
};

// What the elements of a physical surface of a mesh consist of.
struct MeshRegionScene {
  Source source;
  std::string name, material;
  double angle = 0.0;
  double normal = 1.5707963267948966;

  static constexpr field::ItemKind item{
      "region", "What the elements of a physical surface of a mesh consist of."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = MeshRegionScene;
    f(Field(&S::name, "name", "", required,
            "of the physical surface in the file, or its number where it has no name"));
    f(Field(&S::material, "material", "", required, "name of its material"));
    f(Field(&S::angle, "angle", "rad", preset, "theta, of its L from b1, as of a ply"));
    f(Field(&S::normal, "normal", "rad", preset,
            "direction of its N: angle from b2 towards b3, before the section is turned"));
  }
};

// A part of the contour of an airfoil, and a web between two places of it: plies, or a material and its thickness.
struct AirfoilSectorScene {
  Source source;
  std::optional<double> from, to;           // of the contour's length, or
  std::optional<int> from_point, to_point;  // numbers of points; neither: 0, 1
  std::string layup, material;
  std::optional<double> thickness;
  double angle = 0.0;
  bool bare = false;

  static constexpr field::ItemKind item{
      "sector",
      "A part of the contour of an airfoil, in the order of its points: its plies lie inside the "
      "contour, their normals point outward. Sectors cover the contour, none twice."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = AirfoilSectorScene;
    f(Field(&S::from, "from", pure_number, optional,
            "where it begins: fraction of the length of the contour, from its first point on "
            "(default: 0)",
            unit_interval));
    f(Field(&S::to, "to", pure_number, optional,
            "where it ends (default: 1); if that is not beyond from, it goes through the first "
            "point",
            unit_interval));
    f(Field(&S::from_point, "from_point", "", optional,
            "in place of from: the number of a point, 1 for the first", at_least_one));
    f(Field(&S::to_point, "to_point", "", optional, "in place of to: the number of a point",
            at_least_one));
    f(Field(&S::layup, "layup", "", optional, "name of its layup"));
    f(Field(&S::material, "material", "", optional, "name of its material, in place of plies"));
    f(Field(&S::thickness, "thickness", "m", optional, "where it is of one material", positive));
    f(Field(&S::angle, "angle", "rad", preset,
            "theta of a material that is given by itself, as of a ply"));
    f(Field(&S::bare, "bare", "", preset, "on: there is no wall, the section is open"));
  }
};

struct AirfoilWebScene {
  Source source;
  std::optional<double> from, to;
  std::optional<int> from_point, to_point;
  std::string layup, material;
  std::optional<double> thickness;
  double angle = 0.0;

  static constexpr field::ItemKind item{
      "web",
      "A straight wall between two places of the contour of an airfoil. Its plies lie about the "
      "line between these, their normal to the right of who goes from the first to the second (b2 "
      "to the right, b3 up); it stands on the inner surfaces of the walls. On a border of two "
      "sectors it stands on the thicker one (of alike ones on that which is listed first), which "
      "then reaches to the far edge of its foot."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = AirfoilWebScene;
    f(Field(&S::from, "from", pure_number, optional,
            "its first end: fraction of the length of the contour, from its first point on",
            unit_interval));
    f(Field(&S::to, "to", pure_number, optional, "its second end", unit_interval));
    f(Field(&S::from_point, "from_point", "", optional,
            "in place of from: the number of a point, 1 for the first", at_least_one));
    f(Field(&S::to_point, "to_point", "", optional, "in place of to: the number of a point",
            at_least_one));
    f(Field(&S::layup, "layup", "", optional,
            "name of its layup; from the inside, the first ply is the one its normal points away "
            "from"));
    f(Field(&S::material, "material", "", optional, "name of its material, in place of plies"));
    f(Field(&S::thickness, "thickness", "m", optional, "where it is of one material", positive));
    f(Field(&S::angle, "angle", "rad", preset,
            "theta of a material that is given by itself, as of a ply"));
  }
};

// The points of the outer surface of an airfoil, in units of the airfoil.
struct AirfoilPoints {
  Source source;
  std::vector<std::array<double, 2>> all;
};

// A section by its dimensions, which gives D, and M unless a <mass> stands beside it. Its centre lies at (x2, x3) and it is turned about it.
struct SectionShape {
  enum class Kind { tube, bar, rectangle, box, I, C, mesh, airfoil };
  static constexpr std::string_view kinds[] = {"tube", "bar", "rectangle", "box",
                                               "I",    "C",   "mesh",      "airfoil"};
  static constexpr std::string_view docs[] = {
      "A tube: its plies lie round it, their normals point outward.",
      "A solid round bar of one material, whose N is b3.",
      "A solid rectangle of plies across b3, listed from below; their normal is b3.",
      "A box with walls all round; the normals of its plies point outward.",
      "An I: flanges across b3 at top and bottom go through, normals away from the middle; the web "
      "stands between them, its normal b2.",
      "A C: as an I, with the web at the side of -b2, its outer face at x2 = 0, its normal -b2.",
      "A mesh of triangles and quadrilaterals in a file of Gmsh (.msh of format 2.2 or 4.1): x and "
      "y of the file are x2 "
      "and x3. Orders of the elements are raised until the tolerance is met; the mesh itself "
      "stays.",
      "An aerofoil, or any section of walls along a closed curve, with webs between them. <points> "
      "are those of its outer surface, x2 and x3 in turn, all round from any of them, either way; "
      "between corners they are joined by smooth curves (cubic splines). Plies lie inside, at "
      "constant distances from the curve."};

  Source source;
  Kind kind = Kind::tube;
  double radius = 0.0, width = 0.0, height = 0.0;
  std::optional<double> own_height;  // of a rectangle
  std::string layup, flange, web;    // or
  std::string material;              // and its thickness
  std::optional<double> thickness, flange_thickness, web_thickness;
  double angle = 0.0;
  BoxCorners corners = BoxCorners::mitred;
  double x2 = 0.0, x3 = 0.0, turn = 0.0;
  Vec3 curvature = Vec3::Zero();
  double tolerance = 1e-5, mesh_tolerance = 1e-3, airfoil_tolerance = 1e-4;
  std::string file;   // of a mesh: beside the model, or an absolute path
  double unit = 1.0;  // and of an airfoil: length of one unit of its points
  std::vector<MeshRegionScene> regions;
  double corner_angle = 1.0471975511965976;  // 60 deg
  std::optional<AirfoilPoints> points;       // of an airfoil, which has them
  std::vector<AirfoilSectorScene> sectors;   // at least one
  std::vector<AirfoilWebScene> webs;

  static bool is_tube(const SectionShape& s) { return s.kind == Kind::tube; }
  static bool is_bar(const SectionShape& s) { return s.kind == Kind::bar; }
  static bool is_round(const SectionShape& s) { return is_tube(s) || is_bar(s); }
  static bool is_wide(const SectionShape& s) { return !is_round(s) && !has_parts(s); }
  static bool is_rectangle(const SectionShape& s) { return s.kind == Kind::rectangle; }
  static bool is_high(const SectionShape& s) { return is_wide(s) && !is_rectangle(s); }
  static bool is_box(const SectionShape& s) { return s.kind == Kind::box; }
  static bool is_flanged(const SectionShape& s) { return s.kind == Kind::I || s.kind == Kind::C; }
  static bool has_layup(const SectionShape& s) {
    return !is_flanged(s) && !is_bar(s) && !has_parts(s);
  }
  static bool is_wall(const SectionShape& s) { return is_tube(s) || is_box(s); }
  static bool is_mesh(const SectionShape& s) { return s.kind == Kind::mesh; }
  static bool is_airfoil(const SectionShape& s) { return s.kind == Kind::airfoil; }
  static bool has_parts(const SectionShape& s) { return is_mesh(s) || is_airfoil(s); }
  static bool has_corners(const SectionShape& s) { return is_box(s) || is_airfoil(s); }
  static bool is_simple(const SectionShape& s) { return !has_parts(s); }
  static bool may_be_plies(const SectionShape& s) { return is_simple(s) && !is_bar(s); }

  static constexpr field::ItemKind item{"", "A section by its dimensions."};
  // Where it lies, and how well it is to be known: of every kind.
  static void each_field_of_all(const auto& f) {
    using namespace field;
    using S = SectionShape;
    f(Field(&S::x2, "x2", "m", preset,
            "where its centre lies along b2 (of a C: its outer face and half its height; of a mesh "
            "or an airfoil: the origin of its points)"));
    f(Field(&S::x3, "x3", "m", preset, "where its centre lies along b3"));
    f(Field(&S::turn, "turn", "rad", preset, "turns it about its centre, from b2 towards b3"));
    f(Field(&S::curvature, "curvature", "1/m", preset,
            "k1 k2 k3 of the stress-free reference line along b1 b2 b3: its twist and curvatures, "
            "which D and M take into account. They are not taken from the beam"));
    f(Field(&S::tolerance, "tolerance", pure_number, preset,
            "the mesh is refined until every entry ij of D changes less, over sqrt(Dii Djj)",
            Range{1e-10, 0.1}, is_simple));
    f(Field(&S::airfoil_tolerance, "tolerance", pure_number, preset,
            "the mesh is refined until every entry ij of D changes less, over sqrt(Dii Djj)",
            Range{1e-10, 0.1}, is_airfoil));
    f(Field(&S::mesh_tolerance, "tolerance", pure_number, preset,
            "the order of the elements is raised until every entry ij of D changes less, over "
            "sqrt(Dii Djj)",
            Range{1e-10, 0.1}, is_mesh));
  }
  static void each_field(const auto& f) {
    using namespace field;
    using S = SectionShape;
    f(Field(&S::radius, "radius", "m", required, "outer radius", positive, is_round));
    f(Field(&S::width, "width", "m", required, "outer width, along b2", positive, is_wide));
    f(Field(&S::height, "height", "m", required, "outer height, along b3", positive, is_high));
    f(Field(&S::own_height, "height", "m", optional,
            "along b3, of one material; with a layup it is the thickness of that", positive,
            is_rectangle));
    f(Field(&S::layup, "layup", "", optional, "name of its layup", has_layup));
    f(Field(&S::flange, "flange", "", optional, "name of the layup of its flanges", is_flanged));
    f(Field(&S::web, "web", "", optional, "name of the layup of its web", is_flanged));
    f(Field(&S::material, "material", "", required, "name of its material", is_bar));
    f(Field(&S::material, "material", "", optional, "name of its material, in place of plies",
            may_be_plies));
    f(Field(&S::file, "file", "", required,
            "the .msh file; a relative path is from the model's directory", is_mesh));
    f(Field(&S::unit, "unit", "m", preset, "length of one unit of the file, such as 1 mm", positive,
            is_mesh));
    f(Field(&S::material, "material", "", optional,
            "of elements of no <region>, their angle 0 and their N b3", is_mesh));
    f(Field(&S::thickness, "thickness", "m", optional, "of its wall, where that is of one material",
            positive, is_wall));
    f(Field(&S::flange_thickness, "flange_thickness", "m", optional,
            "of its flanges, where it is of one material", positive, is_flanged));
    f(Field(&S::web_thickness, "web_thickness", "m", optional,
            "of its web, where it is of one material", positive, is_flanged));
    f(Field(&S::angle, "angle", "rad", preset,
            "theta of a material that is given by itself, as of a ply", is_simple));
    f(Field(&S::unit, "unit", "m", preset,
            "length of one unit of its points: such as 1 mm, or the chord", positive, is_airfoil));
    f(Field(&S::corner_angle, "corner_angle", "rad", preset,
            "where the line from point to point turns by more there are corners; 0: straight lines "
            "between all points",
            Range{0.0, 3.141592653589793}, is_airfoil));
    f(Field(
        &S::corners, "corners", "", preset,
        "mitred: plies turn round them; butt: walls of a box across b3 go through, those "
        "across b2 stand between them; of an airfoil, the wall of the sector that is listed first "
        "goes through, in one sector the wall before the corner (corners that point inward are "
        "mitred)",
        has_corners));
    each_field_of_all(f);
    f(Parts(&S::regions));
    f(Parts(&S::sectors));
    f(Parts(&S::webs));
  }
};

// What was found of a section's shape, besides D and M.
struct ShapeFound {
  Mat6 error = Mat6::Zero();  // estimated, of each entry ij of D over sqrt(Dii Djj)
  int elements = 0, unknowns = 0, order = 0;
  bool mass = false;  // M was computed too: it was not stated, and materials have densities
};

}  // namespace mbd
