// What beams and bodies look like, and the mass of bodies that are stated by their form.
#pragma once

#include <array>
#include <charconv>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/scene/field.hpp"

namespace mbd {

// A surface of triangles, counter-clockwise as seen from outside.
struct TriangleMesh {
  std::vector<Vec3> points;  // in the units of its file, axes of the shape
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct NamedColour {
  std::string_view name;
  unsigned code;  // 0xrrggbb
};
// Of CSS 2.1.
inline constexpr NamedColour named_colours[] = {
    {"black", 0x000000},  {"silver", 0xc0c0c0}, {"gray", 0x808080},   {"white", 0xffffff},
    {"maroon", 0x800000}, {"red", 0xff0000},    {"purple", 0x800080}, {"fuchsia", 0xff00ff},
    {"green", 0x008000},  {"lime", 0x00ff00},   {"olive", 0x808000},  {"yellow", 0xffff00},
    {"navy", 0x000080},   {"blue", 0x0000ff},   {"teal", 0x008080},   {"aqua", 0x00ffff},
    {"orange", 0xffa500}};

// 0xrrggbb of a name, or of #rrggbb; nothing for other words.
inline std::optional<unsigned> colour_code(std::string_view text) {
  for (const NamedColour& colour : named_colours)
    if (colour.name == text) return colour.code;
  unsigned code = 0;
  if (text.size() != 7 || text[0] != '#') return std::nullopt;
  const auto [end, fault] = std::from_chars(text.data() + 1, text.data() + 7, code, 16);
  if (fault != std::errc() || end != text.data() + 7) return std::nullopt;
  return code;
}

// One form of a body, or what a beam is drawn as. What each attribute asks for is checked in check_scene.cpp.
struct ShapeScene {
  Source source;
  // Of a body, one of:
  std::optional<Vec3> box;
  std::optional<std::array<double, 2>> cylinder;  // diameter and length
  std::optional<double> sphere;
  std::string mesh;  // a file beside the model, or an absolute path
  double unit = 1.0;
  Vec3 at = Vec3::Zero();
  Mat3 orientation = Mat3::Identity();
  std::optional<double> density;
  // Of a beam, one of; a second pair is at its end:
  std::optional<std::array<double, 2>> rectangle, ellipse, to;
  std::string colour;
  // Of the mesh: read with the model, or when it is first needed.
  std::shared_ptr<const TriangleMesh> surface;

  bool has_form() const { return box || cylinder || sphere || !mesh.empty(); }
  bool has_outline() const { return rectangle || ellipse; }

  static constexpr field::ItemKind item{
      "shape",
      "What a body or a beam looks like, for the eye: pages, pictures and files for ParaView. Of a "
      "body with a density it is also its mass."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = ShapeScene;
    f(Field(&S::box, "box", "m", optional, "of a body: its sides along the axes of the shape",
            positive));
    f(Field(&S::cylinder, "cylinder", "m", optional,
            "of a body: diameter and length, which lies along the third axis", positive));
    f(Field(&S::sphere, "sphere", "m", optional, "of a body: diameter", positive));
    f(Field(&S::mesh, "mesh", "", optional,
            "of a body: a file of triangles, .stl, .obj, .gltf or .glb; a relative path is from "
            "the model's directory. The file's origin and axes are those of the shape"));
    f(Field(&S::unit, "unit", "m", preset, "length of one unit of the mesh's file, such as 1 mm",
            positive));
    f(Field(&S::at, "at", "m", optional,
            "middle of the form (of a mesh: its origin) from the reference point, body axes "
            "(default 0 0 0)"));
    f(Field(&S::orientation, "orientation", "rad", optional,
            "axes of the shape in the body's: rotation vector, or (without unit) matrix row by row",
            rotation));
    f(Field(&S::density, "density", "kg/m3", optional,
            "of a body: the form is solid and adds its mass and inertia to those stated",
            positive));
    f(Field(&S::rectangle, "rectangle", "m", optional,
            "of a beam: sides along b2 and b3, in place of those that its stiffness suggests",
            positive));
    f(Field(&S::ellipse, "ellipse", "m", optional, "of a beam: diameters along b2 and b3",
            positive));
    f(Field(&S::to, "to", "m", optional,
            "of a beam: sides or diameters at its end (default: as at the start)", positive));
    f(Field(&S::colour, "colour", "", optional,
            "#rrggbb, or one of the 17 names of CSS: black silver gray white maroon red purple "
            "fuchsia green lime olive yellow navy blue teal aqua orange. A shape that states "
            "nothing else colours what is drawn without it"));
  }
};

}  // namespace mbd
