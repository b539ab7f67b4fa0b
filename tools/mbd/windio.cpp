#include "tools/mbd/windio.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "libmbd/core/error.hpp"
#include "libmbd/language/schema.hpp"
#include "libmbd/scene/reference_line.hpp"
#include "libmbd/scene/scene.hpp"
#include "libmbd/scene/section_table.hpp"
#include "libmbd/text/text.hpp"

#if MBD_HAS_YAML
#include <yaml-cpp/yaml.h>
#endif

namespace mbd {

#if MBD_HAS_YAML
namespace {

// ---- the file ---------------------------------------------------------------------------------

// A node of the file with the way to it, for messages.
class Node {
 public:
  Node(YAML::Node node, std::string file, std::string path)
      : node_(std::move(node)), file_(std::move(file)), path_(std::move(path)) {}

  Source source() const { return {file_, node_.Mark().line + 1}; }
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(source(), (path_.empty() ? "this file" : path_) + " " + what);
  }

  std::optional<Node> find(std::string_view key) const {
    if (!node_.IsMap()) return {};
    const YAML::Node part = std::as_const(node_)[std::string(key)];
    if (!part.IsDefined() || part.IsNull()) return {};
    return Node(part, file_, path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key));
  }
  Node at(std::string_view key) const {
    if (const auto part = find(key)) return *part;
    fail(fmt::format("has no \"{}\"", key));
  }

  std::size_t size() const { return node_.IsSequence() ? node_.size() : 0; }
  Node at(std::size_t i) const {
    return Node(std::as_const(node_)[i], file_, fmt::format("{}[{}]", path_, i));
  }

  double number() const {
    double value = 0.0;
    if (!node_.IsScalar() || !YAML::convert<double>::decode(node_, value) || !std::isfinite(value))
      fail("must be a number");
    return value;
  }
  std::vector<double> numbers() const {
    if (size() == 0) fail("must be a list of numbers");
    std::vector<double> all(size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = at(i).number();
    return all;
  }
  std::vector<double> numbers(std::size_t count, std::string_view like) const {
    std::vector<double> all = numbers();
    if (all.size() != count)
      fail(fmt::format("has {} numbers, {} has {}", all.size(), like, count));
    return all;
  }

 private:
  YAML::Node node_;
  std::string file_, path_;
};

// At least two numbers that rise from 0 to 1.
std::vector<double> grid_of(const Node& node) {
  const Node grid = node.at("grid");
  std::vector<double> all = grid.numbers();
  if (all.size() < 2 || all.front() != 0.0 || all.back() != 1.0) grid.fail("must run from 0 to 1");
  for (std::size_t i = 1; i < all.size(); ++i)
    if (!(all[i] > all[i - 1]))
      grid.fail(fmt::format("must rise: {} follows {}", schema::shortest(all[i]),
                            schema::shortest(all[i - 1])));
  return all;
}

// ---- what is given over a grid ----------------------------------------------------------------

// The last point of a grid that is not behind x, which is not before the first.
std::size_t last_before(const std::vector<double>& grid, double x) {
  return static_cast<std::size_t>(std::ranges::upper_bound(grid, x) - grid.begin()) - 1;
}
// The interval that x lies in.
std::size_t interval_of(const std::vector<double>& grid, double x) {
  return std::min(last_before(grid, x), grid.size() - 2);
}

struct Distribution {
  std::vector<double> grid, values;

  double slope(std::size_t i) const {
    return (values[i + 1] - values[i]) / (grid[i + 1] - grid[i]);
  }
  // Derivative at a point by Fritsch and Butland (1984): none where the data turn, so that there is no overshoot.
  double derivative(std::size_t i) const {
    if (i == 0) return end_derivative(0, 1);
    if (i + 1 == grid.size()) return end_derivative(i - 1, i >= 2 ? i - 2 : i - 1);
    const double before = slope(i - 1), after = slope(i);
    if (before * after <= 0.0) return 0.0;
    const double h0 = grid[i] - grid[i - 1], h1 = grid[i + 1] - grid[i];
    return 3.0 * (h0 + h1) / ((2.0 * h1 + h0) / before + (h1 + 2.0 * h0) / after);
  }
  // That of the parabola through three points, limited to keep the shape.
  double end_derivative(std::size_t first, std::size_t next) const {
    if (grid.size() == 2) return slope(0);
    const double h0 = grid[first + 1] - grid[first], h1 = grid[next + 1] - grid[next];
    const double s0 = slope(first), s1 = slope(next);
    const double d = ((2.0 * h0 + h1) * s0 - h0 * s1) / (h0 + h1);
    if (d * s0 <= 0.0) return 0.0;
    return s0 * s1 <= 0.0 && std::abs(d) > std::abs(3.0 * s0) ? 3.0 * s0 : d;
  }
  // Piecewise cubic and monotone between the points, as windIO recommends for what is smooth.
  double smooth(double x) const {
    const std::size_t i = interval_of(grid, x);
    const double h = grid[i + 1] - grid[i], t = (x - grid[i]) / h;
    const double a = h * derivative(i), b = h * derivative(i + 1);
    return values[i] + t * (a + t * ((3.0 * (values[i + 1] - values[i]) - 2.0 * a - b) +
                                     t * (a + b - 2.0 * (values[i + 1] - values[i]))));
  }
};

Distribution distribution(const Node& node) {
  Distribution d{grid_of(node), {}};
  d.values = node.at("values").numbers(d.grid.size(), "its grid");
  return d;
}

// ---- the blade --------------------------------------------------------------------------------

// Row and column i of [N1 Q2 Q3 M1 M2 M3] are these of windIO's [Fx Fy Fz Mx My Mz].
constexpr std::array<Index, 6> from_windio{2, 0, 1, 5, 3, 4};

Mat6 in_section_axes(const Mat6& windio) {
  Mat6 M;
  for (Index i = 0; i < 6; ++i)
    for (Index j = 0; j < 6; ++j)
      M(i, j) = windio(from_windio[static_cast<std::size_t>(i)],
                       from_windio[static_cast<std::size_t>(j)]);
  return M;
}

// Matrices over a grid, in the axes of windIO; between its points linear, entry by entry.
struct Matrices {
  std::vector<double> grid;
  std::vector<Mat6> values;
  std::vector<Source> sources;

  Mat6 at(double x) const {
    const std::size_t i = interval_of(grid, x);
    const double t = (x - grid[i]) / (grid[i + 1] - grid[i]);
    return (1.0 - t) * values[i] + t * values[i + 1];
  }
  Source source(double x) const { return sources[last_before(grid, x)]; }
};

struct Blade {
  Distribution x, y, z, twist;  // [m, rad], twist about -z
  Matrices stiffness, mass;
  std::vector<double> mu;  // stiffness-proportional damping [s] of the six strains, if any
};

// Upper triangle, row by row.
Mat6 symmetric(const std::vector<double>& triangle) {
  Mat6 M;
  std::size_t k = 0;
  for (Index i = 0; i < 6; ++i)
    for (Index j = i; j < 6; ++j) M(i, j) = M(j, i) = triangle[k++];
  return M;
}

// Throws Error unless M, in the axes of windIO, is a mass at a point of the section with moments of inertia.
void check_mass(const Mat6& M, const Node& row) {
  const double m = M(0, 0), x = M(1, 5) / m, y = -M(0, 5) / m;
  if (!(m > 0.0)) row.fail("has no mass: its first number must be positive");
  Mat6 expected = M;
  expected.topLeftCorner<3, 3>() = m * Mat3::Identity();
  expected.topRightCorner<3, 3>() << 0, 0, -m * y, 0, 0, m * x, m * y, -m * x, 0;
  for (Index i = 0; i < 3; ++i)
    for (Index j = i; j < 6; ++j) {
      // Beside the mass times a length of the section: its radius of gyration, or where its centre lies.
      const double size = j < 3 ? m : std::sqrt(m * M.diagonal().tail<3>().cwiseAbs().maxCoeff());
      if (!(std::abs(M(i, j) - expected(i, j)) <= 1e-6 * size))
        row.fail(
            fmt::format("is no mass of a section: entry {}{} is {}, and by its mass and the place "
                        "of its centre it should "
                        "be {}",
                        i + 1, j + 1, schema::shortest(M(i, j)), schema::shortest(expected(i, j))));
    }
}

Matrices triangles(const Node& node, bool of_mass) {
  Matrices m;
  m.grid = grid_of(node);
  const Node rows = node.at("values");
  if (rows.size() != m.grid.size())
    rows.fail(fmt::format("has {} rows, its grid {} points", rows.size(), m.grid.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Node row = rows.at(i);
    m.values.push_back(symmetric(row.numbers(21, "the upper triangle of a matrix")));
    m.sources.push_back(row.source());
    if (of_mass) check_mass(m.values.back(), row);
  }
  return m;
}

// K11 … K66.
Matrices by_entries(const Node& node) {
  Matrices m;
  m.grid = grid_of(node);
  m.values.assign(m.grid.size(), Mat6::Zero());
  m.sources.assign(m.grid.size(), node.source());
  for (Index i = 0; i < 6; ++i)
    for (Index j = i; j < 6; ++j) {
      const auto entry =
          node.at(fmt::format("K{}{}", i + 1, j + 1)).numbers(m.grid.size(), "its grid");
      for (std::size_t k = 0; k < entry.size(); ++k)
        m.values[k](i, j) = m.values[k](j, i) = entry[k];
    }
  return m;
}

// By mass, its centre and moments of inertia about the axes of the section.
Matrices by_inertia(const Node& node) {
  Matrices all;
  all.grid = grid_of(node);
  all.sources.assign(all.grid.size(), node.source());
  const auto of = [&](const char* key) {
    return node.at(key).numbers(all.grid.size(), "its grid");
  };
  const auto mass = of("mass"), x = of("cm_x"), y = of("cm_y"), edge = of("i_edge"),
             flap = of("i_flap"), polar = of("i_plr"), product = of("i_cp");
  for (std::size_t k = 0; k < mass.size(); ++k) {
    const double m = mass[k], mx = m * x[k], my = m * y[k];
    all.values.push_back(symmetric({m,       0,           0,   0, 0,  -my,  //
                                    m,       0,           0,   0, mx,       //
                                    m,       my,          -mx, 0,           //
                                    edge[k], -product[k], 0,                //
                                    flap[k], 0,                             //
                                    polar[k]}));
  }
  return all;
}

// In radians.
Distribution twist_of(const Node& node, bool degrees, bool asked) {
  Distribution twist = distribution(node);
  for (double& value : twist.values) value *= degrees ? std::numbers::pi / 180.0 : 1.0;
  for (const double value : twist.values)
    if (std::abs(value) > std::numbers::pi / 2)
      node.fail(fmt::format(
          "reaches {:.4g} degrees, taken as {}{}", value * 180.0 / std::numbers::pi,
          degrees ? "degrees" : "radians",
          asked ? ""
                : fmt::format(" as this layout of windIO says; are they {}? Give "
                              "--twist-unit {}",
                              degrees ? "radians" : "degrees", degrees ? "rad" : "deg")));
  return twist;
}

Blade blade_of(const Node& file, const WindioOptions& options) {
  const Node node = file.at("components").at("blade");
  Blade blade;
  const auto axis = [&](const Node& at) {
    blade.x = distribution(at.at("x"));
    blade.y = distribution(at.at("y"));
    blade.z = distribution(at.at("z"));
  };
  const bool asked = options.in_degrees.has_value();
  if (const auto old = node.find("elastic_properties_mb")) {
    const Node six = old->at("six_x_six");
    const auto beside = [&](const char* key) {
      const auto own = six.find(key);
      return own ? *own : node.at("outer_shape_bem").at(key);
    };
    axis(beside("reference_axis"));
    blade.twist = twist_of(beside("twist"), options.in_degrees.value_or(false), asked);
    blade.stiffness = triangles(six.at("stiff_matrix"), false);
    blade.mass = triangles(six.at("inertia_matrix"), true);
    return blade;
  }
  const auto structure = node.find("structure");
  const auto elastic =
      structure ? structure->find("elastic_properties") : node.find("elastic_properties");
  if (!elastic)
    node.fail(
        "has neither elastic_properties_mb (layout 1) nor structure.elastic_properties (layout 2): "
        "stiffness and mass of its sections are needed, layers are not read");
  axis(node.at("reference_axis"));
  blade.twist =
      twist_of(node.at("outer_shape").at("twist"), options.in_degrees.value_or(true), asked);
  blade.stiffness = by_entries(elastic->at("stiffness_matrix"));
  blade.mass = by_inertia(elastic->at("inertia_matrix"));
  if (const auto damping = elastic->find("structural_damping"))
    blade.mu = damping->at("mu").numbers(6, "the strains of a beam");
  return blade;
}

// ---- the model --------------------------------------------------------------------------------

// The spline of the model goes through points alone: between those that are far apart it would leave the monotone curves of
// the file, and overshoot.
void divide(std::vector<double>& grid) {
  constexpr double longest = 0.02;
  std::vector<double> all{grid.front()};
  for (std::size_t i = 0; i + 1 < grid.size(); ++i) {
    const double h = grid[i + 1] - grid[i];
    const int parts = std::max(1, static_cast<int>(std::ceil(h / longest - 1e-6)));
    for (int k = 1; k < parts; ++k) all.push_back(grid[i] + h * k / parts);
    all.push_back(grid[i + 1]);
  }
  grid = std::move(all);
}

// The curve with a point at every place where something is given, and between those that are far apart.
struct Line {
  std::vector<double> grid;
  BeamScene beam;
};

Line line_of(const Blade& blade, const WindioOptions& options, const Source& source) {
  std::set<double> all;
  for (const auto* const grid : {&blade.x.grid, &blade.y.grid, &blade.z.grid, &blade.twist.grid,
                                 &blade.stiffness.grid, &blade.mass.grid})
    all.insert(grid->begin(), grid->end());
  Line line;
  Curve curve;
  for (const double at : all) {
    // Grids that differ by round-off are one.
    if (!line.grid.empty() && at - line.grid.back() < 1e-6) {
      if (at == 1.0) line.grid.back() = 1.0;
      continue;
    }
    line.grid.push_back(at);
  }
  divide(line.grid);
  for (const double at : line.grid)
    curve.points.push_back({source,
                            {blade.x.smooth(at), blade.y.smooth(at), blade.z.smooth(at)},
                            {},
                            -blade.twist.smooth(at)});
  curve.degree = static_cast<int>(std::min<std::size_t>(3, curve.points.size() - 1));
  line.beam.source = source;
  line.beam.name = "blade";
  line.beam.section = "blade";
  line.beam.line = std::move(curve);
  line.beam.normal = Vec3::UnitY();
  line.beam.elements = options.elements;
  line.beam.order = options.order;
  return line;
}

// Fractions of the length at the points of the curve, where the line comes nearest to them.
std::vector<double> fractions(const Line& line, const ReferenceLine& reference) {
  const auto& points = std::get<Curve>(line.beam.line).points;
  std::vector<double> all{0.0};
  double s = 0.0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    s = std::min(1.0, s + (points[i].at - points[i - 1].at).norm() / reference.length);
    for (int iteration = 0; iteration < 50; ++iteration) {
      const Pose<double> pose = reference.at(s);
      const double step = pose.R().col(0).dot(points[i].at - pose.r) / reference.length;
      s = std::clamp(s + step, 0.0, 1.0);
      if (std::abs(step) < 1e-14) break;
    }
    all.push_back(s);
  }
  all.push_back(1.0);
  return all;
}

std::string text_of(const Mat6& M, const char* indent) {
  std::string text;
  for (Index i = 0; i < 6; ++i) {
    text += indent;
    for (Index j = 0; j < 6; ++j) text += (j > 0 ? " " : "") + schema::shortest(M(i, j));
    text += "\n";
  }
  return text;
}

// Of M = [m I, -m c~; m c~, J].
std::string mass_of(const Mat6& M) {
  const double m = M(0, 0);
  std::string inertia;
  for (const auto& [i, j] : {std::pair<Index, Index>{3, 3}, {4, 4}, {5, 5}, {3, 4}, {3, 5}, {4, 5}})
    inertia += (inertia.empty() ? "" : " ") + schema::shortest(M(i, j));
  return fmt::format("<mass per_length=\"{}\" center=\"{} {}\" inertia=\"{}\"/>",
                     schema::shortest(m), schema::shortest(M(3, 2) / m),
                     schema::shortest(0.0 - M(3, 1) / m), inertia);
}

Section section_of(const Blade& blade, const Line& line, const std::vector<double>& s) {
  Section section;
  section.name = "blade";
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double at = line.grid[i];
    const auto given = [at](const std::vector<double>& grid) {
      return std::ranges::any_of(grid, [at](double x) { return std::abs(x - at) < 1e-6; });
    };
    if (!given(blade.stiffness.grid) && !given(blade.mass.grid)) continue;
    Station station;
    station.source = blade.stiffness.source(at);
    station.at = s[i];
    station.stiffness = in_section_axes(blade.stiffness.at(at));
    station.mass = in_section_axes(blade.mass.at(at));
    section.stations.push_back(std::move(station));
  }
  return section;
}

std::string damping_of(const Blade& blade, std::string& notes) {
  if (blade.mu.empty() || std::ranges::all_of(blade.mu, [](double x) { return x == 0.0; }))
    return "";
  if (std::ranges::all_of(blade.mu, [&](double x) { return x == blade.mu.front(); }))
    return fmt::format("    <damping stiffness_proportional=\"{}\"/>\n",
                       schema::shortest(blade.mu.front()));
  notes +=
      "note: its structural damping differs between the six strains, which a <damping> in "
      "proportion to stiffness cannot "
      "say: it is left out\n";
  return "";
}

// Mass, first moment and what else tells whether the right blade was read.
std::string summary_of(const Blade& blade, const Section& section, double length) {
  double mass = 0.0, moment = 0.0;
  const auto& stations = section.stations;
  for (std::size_t i = 1; i < stations.size(); ++i) {  // linear in between
    const double h = (stations[i].at - stations[i - 1].at) * length,
                 a = (*stations[i - 1].mass)(0, 0), b = (*stations[i].mass)(0, 0);
    mass += h * (a + b) / 2;
    moment += h * (stations[i - 1].at * length * (a + b) / 2 + h * (a + 2 * b) / 6);
  }
  const auto [least, most] = std::ranges::minmax(blade.twist.values);
  constexpr double degree = std::numbers::pi / 180.0;
  return fmt::format(
      "blade of {:.6g} m along its reference line, {} stations\n"
      "mass {:.6g} kg, first moment about the root {:.6g} kg.m along the line\n"
      "twist {:.4g} … {:.4g} deg, tip at x = {:.5g} (suction side), y = {:.5g} (trailing edge), z "
      "= {:.6g} m\n",
      length, stations.size(), mass, moment, least / degree, most / degree, blade.x.values.back(),
      blade.y.values.back(), blade.z.values.back());
}

std::string model_of(const Section& section, const Line& line, const std::string& name,
                     const std::string& damping) {
  const BeamScene& beam = line.beam;
  const Curve& curve = std::get<Curve>(beam.line);
  std::string text = fmt::format(
      "<mbd name=\"blade\">\n"
      "  <!-- The blade of {}, a windIO file. Inertial axes are windIO's: x towards the suction "
      "side, y towards the\n"
      "       trailing edge, z from root to tip. Axes of sections: b1 along the line, b2 = x, b3 = "
      "y; twist is about b1, so of\n"
      "       the other sign than there. It is clamped at its root and bent by its weight, "
      "pressure side down;\n"
      "       its frequencies without weight: mbd modes, with set g=0. -->\n"
      "  <parameter name=\"g\" value=\"9.80665\"/>\n"
      "  <section name=\"blade\">\n",
      xml_escaped(name));
  for (const Station& station : section.stations)
    text += fmt::format(
        "    <station at=\"{}\">\n      <stiffness>\n{}      </stiffness>\n      {}\n    "
        "</station>\n",
        schema::shortest(station.at), text_of(station.stiffness, "        "),
        mass_of(*station.mass));
  text += damping;
  text += fmt::format(
      "  </section>\n  <curve name=\"blade\" section=\"blade\" normal=\"0 1 0\" degree=\"{}\" "
      "elements=\"{}\" order=\"{}\">\n",
      curve.degree, beam.elements, beam.order);
  for (const CurvePoint& point : curve.points)
    text += fmt::format("    <point at=\"{} {} {}\" twist=\"{}\"/>\n",
                        schema::shortest(point.at.x()), schema::shortest(point.at.y()),
                        schema::shortest(point.at.z()), schema::shortest(point.twist));
  return text +
         "  </curve>\n"
         "  <fixed name=\"root\" between=\"ground blade.start\"/>\n"
         "  <gravity acceleration=\"-g 0 0\"/>\n"
         "  <static/>\n"
         "  <record name=\"tip\" at=\"blade.end\" quantities=\"displacement rotation\"/>\n"
         "  <record name=\"root\" at=\"blade.start\" quantities=\"force moment\"/>\n"
         "</mbd>\n";
}

}  // namespace

WindioBlade read_windio(const std::filesystem::path& file, const WindioOptions& options) {
  const std::string name = file.string();
  YAML::Node yaml;
  try {
    yaml = YAML::LoadFile(name);
  } catch (const YAML::BadFile&) {
    throw Error(Source{name, 0}, "cannot be read");
  } catch (const YAML::Exception& error) {
    throw Error(Source{name, error.mark.line + 1}, "is no YAML: " + error.msg);
  }
  const Node top(yaml, name, "");
  const Blade blade = blade_of(top, options);
  const Line line = line_of(blade, options, Source{name, 0});
  const ReferenceLine reference = make_reference_line(line.beam);
  const Section section = section_of(blade, line, fractions(line, reference));
  check_section(section);
  std::string notes;
  const std::string damping = damping_of(blade, notes);
  return {model_of(section, line, file.filename().string(), damping),
          summary_of(blade, section, reference.length) + notes};
}

#else

WindioBlade read_windio(const std::filesystem::path&, const WindioOptions&) {
  throw Error(
      "this mbd was built without yaml-cpp, which reads windIO files; install it (Debian: "
      "libyaml-cpp-dev) and build again");
}

#endif

}  // namespace mbd
