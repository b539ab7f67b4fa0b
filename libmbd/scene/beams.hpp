// Beams of a scene and their sections.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "libmbd/scene/field.hpp"
#include "libmbd/scene/materials.hpp"
#include "libmbd/scene/shapes.hpp"

namespace mbd {

// Units of D, [N1 Q2 Q3 M1 M2 M3] against [gamma; kappa], of what is viscous in its place, and of M, per length.
inline constexpr field::Blocks stiffness_units{"N", "N.m", "N.m2"};
inline constexpr field::Blocks viscosity_units{"N.s", "N.m.s", "N.m2.s"};
inline constexpr field::Blocks mass_units{"kg/m", "kg", "kg.m"};

// A section at one place of a beam.
struct Station {
  Source source;
  double at = 0.0;  // fraction of the reference length of the beam that has the section
  Mat6 stiffness = Mat6::Zero();  // as in Section, and below
  std::optional<Mat6> mass;
  std::optional<SectionShape> shape;
  std::optional<ShapeFound> found;

  static constexpr field::ItemKind item{
      "station", "The section at one place of the beam; two or more, from 0 to 1, in order."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = Station;
    f(Field(&S::at, "at", "", required, "fraction of the reference length of the beam",
            unit_interval));
    f(Field(&S::stiffness, stiffness_units));
    f(Field(&S::mass, mass_units));
    f(Parts(&S::shape));
  }
};

// Of a section: what resists rates of strain and velocities. Viscous sectional forces are
// (stiffness_proportional D + viscous) times the rates of strain, D where the section varies being that of
// the place; on all masses of the beam act -mass_proportional times their momenta, as in a medium at rest.
struct SectionDamping {
  Source source;
  double stiffness_proportional = 0.0;  // beta
  double mass_proportional = 0.0;       // alpha
  Mat6 viscous = Mat6::Zero();          // rows and columns as D, not negative

  static constexpr field::ItemKind item{
      "damping",
      "Resistance to rates of strain and to velocities, at least one kind, in a <transient>; "
      "without it a beam is elastic."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = SectionDamping;
    f(Field(&S::stiffness_proportional, "stiffness_proportional", "s", preset,
            "beta: viscous forces are beta D times rates of strain; damping ratio beta omega/2",
            not_negative));
    f(Field(&S::mass_proportional, "mass_proportional", "1/s", preset,
            "alpha: -alpha times the momentum of all masses of the beam, rigid motion too; damping "
            "ratio alpha/(2 omega)",
            not_negative));
    f(Field(&S::viscous, viscosity_units));
  }
};

struct Section {
  Source source;
  std::string name;
  Mat6 stiffness = Mat6::Zero();  // D
  std::optional<Mat6> mass;       // M per unit length about the reference line
  // What D and M were computed from, if they were, and how well.
  std::optional<SectionShape> shape;
  std::optional<ShapeFound> found;

  // Where there are any, D and M vary along the beam and those above are not used. Entry by entry: linear
  // between stations, or the interpolating spline of degree 3 (or less, with fewer than 4 stations). A kink
  // of the linear table is best placed where two elements meet (Mesh::stations): within one it costs the element
  // its order. Masses and stiffnesses of elements are integrals of the tables, kinks or not.
  std::vector<Station> stations;  // at least two, rising from 0 to 1; all with mass, or none
  Interpolation interpolation = Interpolation::linear;

  std::optional<SectionDamping> damping;

  static constexpr field::ItemKind item{
      "section", "Stiffness and mass of a cross-section, axes b1 (along the beam) b2 b3.",
      "sections", field::of_sections};
  static void each_field(const auto& f) {
    using namespace field;
    using S = Section;
    f(Field(&S::name, "name", "", required, "name beams refer to", item_name));
    f(Field(&S::interpolation, "interpolation", "", preset,
            "between stations, entry by entry: linear (kinks are best placed at ends of elements) "
            "or a cubic spline"));
    f(Field(&S::stiffness, stiffness_units));
    f(Field(&S::mass, mass_units));
    f(Parts(&S::shape));
    f(Parts(&S::stations));
    f(Parts(&S::damping));
  }
};

// A straight reference line.
struct Straight {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();

  static constexpr field::ItemKind item{"beam", "A straight beam."};
  static void each_field(const auto& f) {
    using namespace field;
    f(Field(&Straight::from, "from", "m", required, "start of the reference line", point));
    f(Field(&Straight::to, "to", "m", required, "end of the reference line", point));
  }
};

// A circular reference line: `from` turned about the line through `center` along `axis`.
struct Arc {
  Vec3 from = Vec3::Zero(), center = Vec3::Zero();
  Vec3 axis = Vec3::UnitZ();  // need not be a unit vector, must be perpendicular to from - center
  double angle = 0.0;

  static constexpr field::ItemKind item{
      "arc", "A beam along a circular arc: `from`, turned about the centre."};
  static void each_field(const auto& f) {
    using namespace field;
    f(Field(&Arc::from, "from", "m", required, "start of the reference line", point));
    f(Field(&Arc::center, "center", "m", required, "centre of the circle", point));
    f(Field(&Arc::axis, "axis", "", required, "the line runs right-handed about it", inertial));
    f(Field(&Arc::angle, "angle", "rad", required, "subtended angle", positive));
  }
};

// A smooth reference line through points (reference_line.hpp). b3 lies in the plane of the tangent and the
// normal, both interpolated, turned by the twist about the tangent. Two points: a straight line.
struct CurvePoint {
  Source source;
  Vec3 at = Vec3::Zero();
  std::optional<Vec3> normal;  // default: that of the beam
  double twist = 0.0;

  static constexpr field::ItemKind item{"point", "A point of a curve."};
  static void each_field(const auto& f) {
    using namespace field;
    using S = CurvePoint;
    f(Field(&S::at, "at", "m", required, "position", point));
    f(Field(&S::normal, "normal", "", optional, "b3 there (default: the normal of the curve)",
            inertial));
    f(Field(&S::twist, "twist", "rad", preset,
            "turns the section, right-handed about the tangent"));
  }
};

struct Curve {
  std::vector<CurvePoint> points;  // at least two
  int degree = 0;                  // of the spline; 0: min(points - 1, 2 order + 1)

  static constexpr field::ItemKind item{"curve", "A beam along a smooth curve through points."};
  static void each_field(const auto& f) {
    using namespace field;
    f(Field(
        &Curve::degree, "degree", "", optional,
        "of the spline (default: 2 order + 1, or what the points allow; lower it for rough points)",
        Range{1.0, 1e3}));
    f(Parts(&Curve::points));
  }
};

struct BeamScene {
  Source source;
  std::string name;
  std::string section;
  std::variant<Straight, Arc, Curve> line;
  Vec3 normal = Vec3::UnitZ();  // made perpendicular to the tangent; b2 = b3 x b1
  int elements =
      1;  // before boundaries are added at attachments; of Mesh::stations between each two stations
  Mesh mesh = Mesh::equal;
  int order = 3;
  Kinematics kinematics = Kinematics::motion;
  Metric metric = Metric::geodesic;  // of motion; so is the form
  Rule rule = Rule::gauss;
  Form form = Form::energy;
  std::optional<ShapeScene> shape;

  static constexpr field::ItemKind item{"", "", "beams", field::of_parts};
  static void each_field(const auto& f) {
    using namespace field;
    using S = BeamScene;
    f(Field(&S::name, "name", "", required, "name, unique among beams and bodies", item_name));
    f(Field(&S::section, "section", "", required, "name of its section"));
    f(Parts(&S::line));
    f(Field(&S::normal, "normal", "", required,
            "b3 at the start (of a curve: everywhere); its part along the reference line does not "
            "matter",
            inertial));
    f(Field(&S::elements, "elements", "", preset,
            "spectral elements of equal length, of the beam or (mesh) of each of its parts",
            at_least_one));
    f(Field(&S::mesh, "mesh", "", preset,
            "what `elements` divides: the beam, or each part between two stations of its section, "
            "where kinks of its tables are then ends of elements"));
    f(Field(&S::order, "order", "", preset, "order N: N + 1 nodes an element", Range{1.0, 8.0}));
    f(Field(&S::kinematics, "kinematics", "", preset,
            "what is interpolated: the motion, or (classical) displacement and rotation apart, "
            "without metric and form"));
    f(Field(&S::metric, "metric", "", preset, "interpolation of motion"));
    f(Field(&S::rule, "rule", "", preset, "quadrature; gauss_lobatto locks"));
    f(Field(&S::form, "form", "", preset,
            "elastic force: gradient of a discrete energy, or the paper's"));
    f(Parts(&S::shape));
  }
};

}  // namespace mbd
