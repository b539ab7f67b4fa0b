#include "libmbd/view/vtk.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "libmbd/core/error.hpp"
#include "libmbd/core/se3.hpp"
#include "libmbd/section/failure.hpp"
#include "libmbd/text/files.hpp"
#include "libmbd/text/text.hpp"
#include "libmbd/view/outline.hpp"

namespace mbd {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int round_sides = 12;  // of a tube
// VTK_LAGRANGE_CURVE, VTK_POLY_LINE, VTK_HEXAHEDRON, VTK_WEDGE
constexpr std::int64_t curve_cell = 68, polyline_cell = 4, hexahedron_cell = 12, wedge_cell = 13;

// Of six components.
using ComponentNames = std::array<std::string_view, 6>;
constexpr ComponentNames of_section{"11", "22", "33", "12", "23", "13"},
    of_ply{"LL", "TT", "NN", "TN", "LN", "LT"};

// --- files of VTK ---

// The arrays of a file: their XML, and what is appended.
class Arrays {
 public:
  template <class T>
  std::string operator()(std::string_view name, std::size_t components,
                         const std::vector<T>& numbers) {
    const char* const type = std::is_same_v<T, double>         ? "Float64"
                             : std::is_same_v<T, float>        ? "Float32"
                             : std::is_same_v<T, std::uint8_t> ? "UInt8"
                                                               : "Int64";
    std::string names;
    for (std::size_t i = 0; i < 6 && components == 6; ++i)
      names += fmt::format(R"( ComponentName{}="{}")", i,
                           (name == "ply_stress" ? of_ply : of_section)[i]);
    std::string xml = fmt::format(
        R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}"{} format="appended" offset="{}"/>)",
        type, name, components, names, appended_.size());
    append({reinterpret_cast<const Bytef*>(numbers.data()), numbers.size() * sizeof(T)});
    return xml + "\n";
  }
  const std::string& appended() const { return appended_; }

 private:
  void append(std::span<const Bytef> bytes) {
    // How many blocks, the size of one and of the last if it is shorter, the size of each compressed.
    std::vector<std::uint64_t> head = {bytes.empty() ? 0U : 1U, bytes.size(), 0};
    std::string packed;
    if (!bytes.empty()) {
      uLongf size = compressBound(static_cast<uLong>(bytes.size()));
      packed.resize(size);
      compress2(reinterpret_cast<Bytef*>(packed.data()), &size, bytes.data(),
                static_cast<uLong>(bytes.size()), 1);
      packed.resize(size);
      head.push_back(size);
    }
    appended_.append(reinterpret_cast<const char*>(head.data()), head.size() * sizeof head[0]);
    appended_ += packed;
  }

  std::string appended_;
};

// Points with their data, and cells: for PolyData and UnstructuredGrid.
struct Piece {
  std::vector<double> points, displacement;                       // by three
  std::vector<std::int64_t> part;                                 // of points
  std::vector<std::pair<std::string, std::vector<double>>> data;  // of points: by three, six or one
  std::vector<std::int64_t> vertices, lines, line_ends, polygons, polygon_ends;
  std::vector<std::int64_t> element, cell_part;  // of lines, in an UnstructuredGrid
  std::vector<std::uint8_t> types;               // of lines: then it is one
  bool is_coarse = false;                        // in single precision: surfaces

  std::size_t size() const { return part.size(); }
  std::vector<double>& numbers(const std::string& name) {
    for (auto& [known, numbers] : data)
      if (known == name) return numbers;
    return data.emplace_back(name, std::vector<double>()).second;
  }
  void put(const std::string& name, const Vec3& v) {
    std::vector<double>& to = numbers(name);
    to.insert(to.end(), v.data(), v.data() + 3);
  }
  void put(const std::string& name, double x) { numbers(name).push_back(x); }
  void put_six(const std::string& name, const Vec6& v) {
    std::vector<double>& to = numbers(name);
    to.insert(to.end(), v.data(), v.data() + 6);
  }
  void add_point(std::int64_t of, const Vec3& x, const Vec3& reference) {
    for (int k = 0; k < 3; ++k) {
      points.push_back(x(k));
      displacement.push_back(x(k) - reference(k));
    }
    part.push_back(of);
  }
  void put_axes(const Pose<double>& H) {
    const Mat3 R = H.R();
    for (int k = 0; k < 3; ++k) put(fmt::format("axis_{}", k + 1), Vec3(R.col(k)));
  }
};

std::string in_xml(const Piece& piece, std::optional<double> time) {
  const bool is_grid = !piece.types.empty();
  const char* const type = is_grid ? "UnstructuredGrid" : "PolyData";
  Arrays array;
  const auto real = [&](std::string_view name, const std::vector<double>& numbers) {
    const std::size_t width = piece.size() > 0 ? numbers.size() / piece.size() : 1;
    if (!piece.is_coarse) return array(name, width, numbers);
    return array(name, width, std::vector<float>(numbers.begin(), numbers.end()));
  };
  std::string xml = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"{0}\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<{0}>\n",
      type);
  if (time) {
    std::string line = array("TimeValue", 1, std::vector<double>{*time});
    line.insert(line.find(" format="), " NumberOfTuples=\"1\"");
    xml += "<FieldData>\n" + line + "</FieldData>\n";
  }
  const std::size_t lines = piece.line_ends.size(), polygons = piece.polygon_ends.size();
  if (is_grid)
    xml += fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", piece.size(), lines);
  else
    xml += fmt::format(
        "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" "
        "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
        piece.size(), piece.vertices.size(), lines, polygons);
  xml += "<PointData>\n" + real("displacement", piece.displacement) + array("part", 1, piece.part);
  for (const auto& [name, numbers] : piece.data) xml += real(name, numbers);
  xml += "</PointData>\n";
  if (is_grid)
    xml += "<CellData>\n" + array("part", 1, piece.cell_part) + array("element", 1, piece.element) +
           "</CellData>\n";
  xml += "<Points>\n" + real("Points", piece.points) + "</Points>\n";
  const auto cells = [&](const char* name, const std::vector<std::int64_t>& of_points,
                         const std::vector<std::int64_t>& ends, const std::string& more = "") {
    xml += fmt::format("<{0}>\n{1}{2}{3}</{0}>\n", name, array("connectivity", 1, of_points),
                       array("offsets", 1, ends), more);
  };
  if (is_grid) {
    cells("Cells", piece.lines, piece.line_ends, array("types", 1, piece.types));
  } else {
    std::vector<std::int64_t> ends(piece.vertices.size());
    for (std::size_t i = 0; i < ends.size(); ++i) ends[i] = static_cast<std::int64_t>(i) + 1;
    if (!piece.vertices.empty()) cells("Verts", piece.vertices, ends);
    if (lines > 0) cells("Lines", piece.lines, piece.line_ends);
    if (polygons > 0) cells("Polys", piece.polygons, piece.polygon_ends);
  }
  return xml + fmt::format("</Piece>\n</{}>\n<AppendedData encoding=\"raw\">\n_", type) +
         array.appended() + "\n</AppendedData>\n</VTKFile>\n";
}

// --- interpolation ---

// Weights at x of the values at the nodes.
std::vector<double> lagrange(std::span<const double> nodes, double x) {
  std::vector<double> weights(nodes.size(), 1.0);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t j = 0; j < nodes.size(); ++j)
      if (j != i) weights[i] *= (x - nodes[j]) / (nodes[i] - nodes[j]);
  return weights;
}

// --- what is drawn ---

Pose<double> pose_of(const Json& json, std::size_t at) {
  Pose<double> H;
  for (std::size_t k = 0; k < 3; ++k) H.r(static_cast<Index>(k)) = json.at(at + k).get<double>();
  H.p = Quaternion<double>(json.at(at + 6).get<double>(), json.at(at + 3).get<double>(),
                           json.at(at + 4).get<double>(), json.at(at + 5).get<double>());
  return H;
}

// A pose in a node.
struct At {
  std::size_t node = 0;
  Pose<double> frame{};
};
At at_of(const Json& json) { return {json.at(0).get<std::size_t>(), pose_of(json, 1)}; }

using Poses = std::vector<Pose<double>>;

struct Beam {
  std::int64_t part;
  std::vector<At> points;
  std::vector<double> s, stations;
  std::size_t order = 1;  // 0: a rigid one, or one of component modes, a line through some nodes
  std::vector<std::array<double, 3>> sides;
  std::vector<Mat6> compliance;
  SectionOutline outline = {};
  std::shared_ptr<const SectionStresses> stresses = {};

  std::size_t elements() const { return order == 0 ? 1 : (points.size() - 1) / order; }
  std::size_t points_of_rule() const { return stations.size() / elements(); }
};
struct Body {
  std::int64_t part;
  At at;
  Pose<double> centre;
  std::string shape;
  Vec3 box;
  // Of a mesh, in the axes of `centre`.
  std::vector<Vec3> points = {};
  std::vector<std::int64_t> triangles = {};
};
struct Joint {
  std::int64_t part;
  At a, b;
  std::optional<std::size_t> number;  // in a motion
};
struct Line {
  std::int64_t part;
  At a, b;
};
struct Spot {
  std::int64_t part;
  At at;
};

struct Parts {
  std::string name, key;
  Poses reference;
  std::vector<Beam> beams;
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::vector<Line> springs;
  std::vector<Spot> places;
  std::string table;  // parts.csv
};

Mat6 symmetric(const Json& upper_half) {
  Mat6 A;
  std::size_t k = 0;
  for (Index i = 0; i < 6; ++i)
    for (Index j = i; j < 6; ++j) A(i, j) = A(j, i) = upper_half.at(k++).get<double>();
  return A;
}

Vec3 vector_of(const Json& all, std::size_t from = 0) {
  return {all.at(from).get<double>(), all.at(from + 1).get<double>(),
          all.at(from + 2).get<double>()};
}

// One that is stated, as a body of its own of the same part.
Body form_of(std::int64_t number, const At& at, const Json& form) {
  const Pose<double> pose = pose_of(form.at("pose"), 0);
  if (!form.contains("points"))
    return {number, at, pose, form.at("kind").get<std::string>(), vector_of(form.at("sides"))};
  Body body{number, at, pose, "mesh", Vec3::Zero()};
  body.triangles = form.at("triangles").get<std::vector<std::int64_t>>();
  for (std::size_t i = 0; i + 2 < form.at("points").size(); i += 3)
    body.points.push_back(vector_of(form.at("points"), i));
  return body;
}

Parts parts_of(const Json& drawing, const StressesOfBeams& stresses = {}) {
  Parts parts;
  parts.name = drawing.at("name").get<std::string>();
  parts.key = drawing.at("key").get<std::string>();
  for (const Json& node : drawing.at("nodes")) parts.reference.push_back(pose_of(node, 0));
  std::map<std::string, std::size_t> joints;
  for (const Json& name : drawing.at("joints"))
    joints.emplace(name.get<std::string>(), joints.size());
  parts.table = "part,kind,name\n";
  std::int64_t number = 0;
  for (const Json& part : drawing.at("parts")) {
    const auto kind = part.at("kind").get<std::string>(), name = part.at("name").get<std::string>();
    parts.table += fmt::format("{},{},{}\n", number, kind, name);
    if (kind == "beam") {
      Beam beam{number, {}, part.at("s").get<std::vector<double>>(), {}, 0, {}, {}};
      for (const Json& point : part.at("points")) beam.points.push_back(at_of(point));
      if (const auto known = stresses.find(name); known != stresses.end())
        beam.stresses = known->second;
      if (part.contains("stations")) {
        beam.stations = part.at("stations").get<std::vector<double>>();
        beam.order = part.value("order", std::size_t{0});
      }
      if (part.contains("sides"))
        beam.sides = part.at("sides").get<std::vector<std::array<double, 3>>>();
      beam.outline = rectangle_outline();
      if (part.contains("outline"))
        beam.outline =
            outline_from(drawing.at("outlines").at(part.at("outline").get<std::string>()).dump());
      else if (!beam.sides.empty() && beam.sides[0][2] != 0.0)
        beam.outline = round_outline(round_sides);
      if (part.contains("compliance"))
        for (const Json& half : part.at("compliance")) beam.compliance.push_back(symmetric(half));
      parts.beams.push_back(std::move(beam));
    } else if (kind == "body" && part.contains("at")) {
      const At at = at_of(part.at("at"));
      if (!part.contains("forms"))
        parts.bodies.push_back({number, at, pose_of(part.at("centre"), 0),
                                part.at("shape").get<std::string>(), vector_of(part.at("box"))});
      else
        for (const Json& form : part.at("forms")) parts.bodies.push_back(form_of(number, at, form));
    } else if (kind == "joint") {
      const auto known = joints.find(name);
      parts.joints.push_back(
          {number, at_of(part.at("a")), at_of(part.at("b")),
           known == joints.end() ? std::optional<std::size_t>() : known->second});
    } else if (kind == "spring") {
      parts.springs.push_back({number, at_of(part.at("a")), at_of(part.at("b"))});
    } else if (kind == "record" && part.contains("at")) {
      parts.places.push_back({number, at_of(part.at("at"))});
    }
    ++number;
  }
  return parts;
}

// --- a frame ---

// A state: poses of nodes, and what else a frame of motion has; nothing of it at the reference configuration.
struct Frame {
  Poses poses;
  std::span<const double> twists, resultants, joints;
};

class Scenery {
 public:
  Scenery(const Parts& parts, const Frame& frame) : parts_(parts), frame_(frame) {}

  std::map<std::string, Piece> make() {
    std::map<std::string, Piece> pieces;
    add_nodes(pieces["nodes"]);
    for (std::size_t b = 0, at = 0; b < parts_.beams.size(); ++b) {
      const Beam& beam = parts_.beams[b];
      const std::size_t size = 6 * beam.stations.size();
      const auto of =
          frame_.resultants.empty() ? frame_.resultants : frame_.resultants.subspan(at, size);
      at += size;
      add_line(pieces["lines"], beam, of);
      if (!of.empty()) add_stations(pieces["stations"], beam, of);
      add_outline(pieces["outlines"], beam);
      if (!of.empty() && beam.stresses && beam.order > 0)
        add_stresses(pieces["stresses"], beam, of);
    }
    for (const Body& body : parts_.bodies) add_body(pieces["bodies"], body);
    for (const Joint& joint : parts_.joints) add_joint(pieces["joints"], joint);
    for (const Line& spring : parts_.springs) add_spring(pieces["springs"], spring);
    for (const Spot& place : parts_.places) {
      Piece& piece = pieces["places"];
      const Pose<double> H = now(place.at);
      add_vertex(piece, place.part, H.r, reference(place.at).r);
      piece.put_axes(H);
    }
    std::erase_if(pieces, [](const auto& piece) { return piece.second.size() == 0; });
    return pieces;
  }

 private:
  Pose<double> now(const At& at) const { return frame_.poses[at.node] * at.frame; }
  Pose<double> reference(const At& at) const { return parts_.reference[at.node] * at.frame; }

  static void add_vertex(Piece& piece, std::int64_t part, const Vec3& x, const Vec3& reference) {
    piece.vertices.push_back(static_cast<std::int64_t>(piece.size()));
    piece.add_point(part, x, reference);
  }

  void add_nodes(Piece& piece) const {
    for (std::size_t n = 1; n < frame_.poses.size(); ++n) {
      const Pose<double>& H = frame_.poses[n];
      add_vertex(piece, -1, H.r, parts_.reference[n].r);
      piece.put_axes(H);
      piece.put("node", static_cast<double>(n));
      if (frame_.twists.empty()) continue;
      const double* const v = frame_.twists.data() + 6 * (n - 1);
      piece.put("velocity", H.p * Vec3(v[0], v[1], v[2]));
      piece.put("angular_velocity", H.p * Vec3(v[3], v[4], v[5]));
    }
  }

  // Force and moment by weights of those at points of a rule.
  static Vec6 weighted(std::span<const double> resultants, std::size_t first,
                       std::span<const double> weights) {
    Vec6 sum = Vec6::Zero();
    for (std::size_t i = 0; i < weights.size(); ++i)
      sum += weights[i] *
             Eigen::Map<const Eigen::Matrix<double, 6, 1>>(resultants.data() + 6 * (first + i));
    return sum;
  }

  void add_line(Piece& piece, const Beam& beam, std::span<const double> resultants) const {
    const auto put = [&](double s, const Vec3& x, const Vec3& at_first, const Vec6& S) {
      piece.add_point(beam.part, x, at_first);
      piece.put("s", s);
      if (frame_.resultants.empty()) return;
      piece.put("force", Vec3(S.head<3>()));
      piece.put("moment", Vec3(S.tail<3>()));
    };
    const auto end_cell = [&](std::int64_t type, std::size_t element) {
      piece.line_ends.push_back(static_cast<std::int64_t>(piece.lines.size()));
      piece.types.push_back(static_cast<std::uint8_t>(type));
      piece.element.push_back(static_cast<std::int64_t>(element));
      piece.cell_part.push_back(beam.part);
    };
    if (beam.order == 0) {
      for (std::size_t i = 0; i < beam.points.size(); ++i) {
        piece.lines.push_back(static_cast<std::int64_t>(piece.size()));
        put(beam.s[i], now(beam.points[i]).r, reference(beam.points[i]).r, Vec6::Zero());
      }
      end_cell(polyline_cell, 0);
      return;
    }
    const std::size_t order = beam.order, rule = beam.points_of_rule();
    for (std::size_t e = 0; e < beam.elements(); ++e) {
      const auto nodes = std::span(beam.s).subspan(e * order, order + 1);
      const auto stations = std::span(beam.stations).subspan(e * rule, rule);
      const auto first = static_cast<std::int64_t>(piece.size());
      for (std::size_t k = 0; k <= order; ++k) {
        const double s = nodes.front() + (nodes.back() - nodes.front()) * static_cast<double>(k) /
                                             static_cast<double>(order);
        const std::vector<double> weights = lagrange(nodes, s);
        // Differences from the first node: no loss far from the origin.
        const Vec3 x0 = now(beam.points[e * order]).r, X0 = reference(beam.points[e * order]).r;
        Vec3 x = x0, X = X0;
        for (std::size_t i = 0; i <= order; ++i) {
          x += weights[i] * (now(beam.points[e * order + i]).r - x0);
          X += weights[i] * (reference(beam.points[e * order + i]).r - X0);
        }
        put(s, x, X,
            resultants.empty() ? Vec6(Vec6::Zero())
                               : weighted(resultants, e * rule, lagrange(stations, s)));
      }
      // Its ends first, as VTK has them.
      piece.lines.push_back(first);
      piece.lines.push_back(first + static_cast<std::int64_t>(order));
      for (std::size_t k = 1; k < order; ++k)
        piece.lines.push_back(first + static_cast<std::int64_t>(k));
      end_cell(curve_cell, e);
    }
  }

  void add_stations(Piece& piece, const Beam& beam, std::span<const double> resultants) const {
    if (beam.order == 0) return;
    const std::size_t order = beam.order, rule = beam.points_of_rule();
    for (std::size_t q = 0; q < beam.stations.size(); ++q) {
      const std::size_t e = q / rule;
      const std::vector<double> weights =
          lagrange(std::span(beam.s).subspan(e * order, order + 1), beam.stations[q]);
      const Vec3 x0 = now(beam.points[e * order]).r, X0 = reference(beam.points[e * order]).r;
      Vec3 x = x0, X = X0;
      for (std::size_t i = 0; i <= order; ++i) {
        x += weights[i] * (now(beam.points[e * order + i]).r - x0);
        X += weights[i] * (reference(beam.points[e * order + i]).r - X0);
      }
      add_vertex(piece, beam.part, x, X);
      const Vec6 S = weighted(resultants, q, std::vector<double>{1.0});
      piece.put("force", Vec3(S.head<3>()));
      piece.put("moment", Vec3(S.tail<3>()));
      piece.put("s", beam.stations[q]);
      if (!parts_have_compliance()) continue;
      Vec6 strain = Vec6::Constant(std::nan(""));
      if (!beam.compliance.empty())
        strain = beam.compliance[beam.compliance.size() > 1 ? q : 0] * S;
      piece.put("strain", Vec3(strain.head<3>()));
      piece.put("curvature", Vec3(strain.tail<3>()));
    }
  }

  // Rings of the section's points at the nodes of each element, and cells between them.
  void add_stresses(Piece& piece, const Beam& beam, std::span<const double> resultants) const {
    piece.is_coarse = true;
    const SectionStresses& section = *beam.stresses;
    const std::size_t order = beam.order, rule = beam.points_of_rule();
    const auto corners = std::ssize(section.points);
    for (std::size_t e = 0; e < beam.elements(); ++e) {
      const auto stations = std::span(beam.stations).subspan(e * rule, rule);
      for (std::size_t k = 0; k <= order; ++k) {
        const auto first = static_cast<std::int64_t>(piece.size());
        const std::size_t node = e * order + k;
        add_ring(piece, beam, node,
                 weighted(resultants, e * rule, lagrange(stations, beam.s[node])));
        if (k == 0) continue;
        for (const std::vector<int>& cell : section.cells)
          add_solid(piece, beam, e, cell, first - corners, first);
      }
    }
  }

  void add_ring(Piece& piece, const Beam& beam, std::size_t node, const Vec6& S) const {
    const SectionStresses& section = *beam.stresses;
    const Pose<double> H = now(beam.points[node]), H0 = reference(beam.points[node]);
    for (std::size_t i = 0; i < section.points.size(); ++i) {
      const Vec3 local(0.0, section.points[i][0], section.points[i][1]);
      piece.add_point(beam.part, H * local, H0 * local);
      piece.put("s", beam.s[node]);
      const Vec6 stress = section.stress[i] * S;
      piece.put_six("stress", stress);
      piece.put("von_mises", section::von_mises(stress));
      if (!section.ply.empty()) piece.put_six("ply_stress", section.ply[i] * S);
    }
  }

  // A cell of a section from ring to ring. A wedge has its first triangle the other way round: so VTK has it.
  static void add_solid(Piece& piece, const Beam& beam, std::size_t element, std::vector<int> cell,
                        std::int64_t from, std::int64_t to) {
    if (cell.size() == 3) std::swap(cell[1], cell[2]);
    for (const std::int64_t ring : {from, to})
      for (const int corner : cell) piece.lines.push_back(ring + corner);
    piece.line_ends.push_back(static_cast<std::int64_t>(piece.lines.size()));
    piece.types.push_back(
        static_cast<std::uint8_t>(cell.size() == 3 ? wedge_cell : hexahedron_cell));
    piece.element.push_back(static_cast<std::int64_t>(element));
    piece.cell_part.push_back(beam.part);
  }

  bool parts_have_compliance() const {
    return std::any_of(parts_.beams.begin(), parts_.beams.end(),
                       [](const Beam& beam) { return !beam.compliance.empty(); });
  }

  // Closed curves of section axes 2 and 3 [m], swept along the frames of the nodes.
  void add_outline(Piece& piece, const Beam& beam) const {
    if (beam.sides.empty()) return;
    piece.is_coarse = true;
    const auto first = static_cast<std::int64_t>(piece.size());
    const auto add = [&](std::size_t i, const OutlinePoint& x) {
      const auto& sides = beam.sides[std::min(i, beam.sides.size() - 1)];
      const Vec3 local(0.0, 0.5 * sides[0] * x[0], 0.5 * sides[1] * x[1]);
      piece.add_point(beam.part, now(beam.points[i]) * local, reference(beam.points[i]) * local);
      piece.put("s", beam.s[i]);
    };
    const SectionOutline& outline = beam.outline;
    for (std::size_t i = 0; i < beam.points.size(); ++i)
      for (const OutlinePoint& x : outline.rim) add(i, x);
    const auto rings = static_cast<std::int64_t>(beam.points.size());
    const std::int64_t corners = std::ssize(outline.rim);
    for (std::int64_t i = 0; i + 1 < rings; ++i)
      for (std::int64_t c = 0; c < corners; ++c) {
        const std::int64_t p = first + i * corners,
                           next = outline.next[static_cast<std::size_t>(c)];
        add_polygon(piece, {p + c, p + next, p + corners + next, p + corners + c});
      }
    for (const std::int64_t i : {std::int64_t(0), rings - 1})
      for (const std::vector<OutlinePoint>& of : outline.caps) {
        std::vector<std::int64_t> cap(of.size());
        const bool is_rim = of == outline.rim;
        std::iota(cap.begin(), cap.end(),
                  is_rim ? first + i * corners : static_cast<std::int64_t>(piece.size()));
        if (!is_rim)
          for (const OutlinePoint& x : of) add(static_cast<std::size_t>(i), x);
        if (i == 0) std::reverse(cap.begin(), cap.end());
        add_polygon(piece, cap);
      }
  }

  static void add_polygon(Piece& piece, const std::vector<std::int64_t>& corners) {
    piece.polygons.insert(piece.polygons.end(), corners.begin(), corners.end());
    piece.polygon_ends.push_back(static_cast<std::int64_t>(piece.polygons.size()));
  }

  void add_mesh(Piece& piece, const Body& body) const {
    piece.is_coarse = true;
    const auto first = static_cast<std::int64_t>(piece.size());
    const Pose<double> H = now(body.at) * body.centre, H0 = reference(body.at) * body.centre;
    for (const Vec3& x : body.points) piece.add_point(body.part, H * x, H0 * x);
    for (std::size_t i = 0; i + 2 < body.triangles.size(); i += 3)
      add_polygon(piece, {first + body.triangles[i], first + body.triangles[i + 1],
                          first + body.triangles[i + 2]});
  }

  // A surface of revolution about the third axis, or the box: rings of corners, closed at both ends.
  void add_body(Piece& piece, const Body& body) const {
    if (!body.triangles.empty()) add_mesh(piece, body);
    if (!(body.box.maxCoeff() > 0.0)) return;
    piece.is_coarse = true;
    struct Ring {
      double radius, height;  // of half the sides
    };
    std::vector<Ring> rings = {{1.0, -1.0}, {1.0, 1.0}};
    int corners = round_sides;
    double turn = 0.0, reach = 1.0;
    if (body.shape == "sphere") {
      constexpr int bands = 8;
      rings.clear();
      for (int i = 1; i < bands; ++i) {
        const double angle = std::numbers::pi * i / bands;
        rings.push_back({std::sin(angle), -std::cos(angle)});
      }
    } else if (body.shape == "box") {
      corners = 4;
      turn = 0.5;
      reach = std::numbers::sqrt2;
    }
    const Pose<double> H = now(body.at) * body.centre, H0 = reference(body.at) * body.centre;
    const auto first = static_cast<std::int64_t>(piece.size());
    for (const Ring& ring : rings)
      for (int c = 0; c < corners; ++c) {
        const double angle = 2.0 * std::numbers::pi * (c + turn) / corners;
        const Vec3 local = 0.5 * Vec3(body.box(0) * reach * ring.radius * std::cos(angle),
                                      body.box(1) * reach * ring.radius * std::sin(angle),
                                      body.box(2) * ring.height);
        piece.add_point(body.part, H * local, H0 * local);
      }
    const auto count = static_cast<std::int64_t>(rings.size());
    for (std::int64_t i = 0; i + 1 < count; ++i)
      for (int c = 0; c < corners; ++c) {
        const std::int64_t p = first + i * corners, next = (c + 1) % corners;
        add_polygon(piece, {p + c, p + next, p + corners + next, p + corners + c});
      }
    for (const std::int64_t i : {std::int64_t(0), count - 1}) {
      std::vector<std::int64_t> cap;
      for (int c = 0; c < corners; ++c) cap.push_back(first + i * corners + c);
      if (i == 0) std::reverse(cap.begin(), cap.end());
      add_polygon(piece, cap);
    }
  }

  void add_joint(Piece& piece, const Joint& joint) const {
    const Pose<double> a = now(joint.a), b = now(joint.b);
    add_vertex(piece, joint.part, b.r, reference(joint.b).r);
    piece.put_axes(b);
    piece.put("gap", (b.r - a.r).norm());
    if (frame_.joints.empty()) return;
    const double* const of = joint.number ? frame_.joints.data() + 7 * *joint.number : nullptr;
    const double nothing = std::nan("");
    piece.put("angle", of ? of[0] : nothing);
    piece.put("force", of ? Vec3(b.p * Vec3(of[1], of[2], of[3])) : Vec3(Vec3::Constant(nothing)));
    piece.put("moment", of ? Vec3(b.p * Vec3(of[4], of[5], of[6])) : Vec3(Vec3::Constant(nothing)));
  }

  void add_spring(Piece& piece, const Line& spring) const {
    for (const At& at : {spring.a, spring.b}) {
      piece.lines.push_back(static_cast<std::int64_t>(piece.size()));
      piece.add_point(spring.part, now(at).r, reference(at).r);
    }
    piece.line_ends.push_back(static_cast<std::int64_t>(piece.lines.size()));
  }

  const Parts& parts_;
  const Frame& frame_;
};

// --- all files ---

// A name of files from that of a model.
std::string file_name(const std::string& name) {
  std::string safe;
  for (const char c : name)
    safe += (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                    c == '-' || c == '_'
                ? c
                : '_';
  return safe.empty() ? "model" : safe;
}

class Collection {
 public:
  Collection(const fs::path& directory, const Parts& parts)
      : directory_(directory), name_(file_name(parts.name)) {
    make_directory(directory);
    make_directory(directory / name_);
    write_file(directory / name_ / "parts.csv", parts.table);
  }

  void add(const Parts& parts, const Frame& frame, std::optional<double> key) {
    for (const auto& [kind, piece] : Scenery(parts, frame).make()) {
      const std::string file =
          fmt::format("{}/{}_{:06}.{}", name_, kind, frames_, piece.types.empty() ? "vtp" : "vtu");
      write_file(directory_ / file, in_xml(piece, key));
      ++files_;
      const auto number = numbers_.emplace(kind, numbers_.size()).first->second;
      list_ += fmt::format("<DataSet timestep=\"{}\" part=\"{}\" name=\"{}\" file=\"{}\"/>\n",
                           key.value_or(0.0), number, kind, file);
    }
    ++frames_;
  }

  VtkFiles finish(std::size_t of) const {
    const fs::path file = directory_ / (name_ + ".pvd");
    write_file(file,
               "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
               "byte_order=\"LittleEndian\">\n<Collection>\n" +
                   list_ + "</Collection>\n</VTKFile>\n");
    return {file, frames_, of, files_ + 2};
  }

 private:
  fs::path directory_;
  std::string name_, list_;
  std::map<std::string, std::size_t> numbers_;
  std::size_t frames_ = 0, files_ = 0;
};

}  // namespace

VtkFiles write_vtk(const fs::path& directory, std::string_view drawing) {
  const Parts parts = parts_of(Json::parse(drawing));
  Collection files(directory, parts);
  files.add(parts, {parts.reference, {}, {}, {}}, {});
  return files.finish(1);
}

VtkFiles write_vtk(const fs::path& directory, const Motion& motion, std::size_t most_frames,
                   const StressesOfBeams& stresses) {
  const Parts parts = parts_of(Json::parse(motion.head).at("drawing"), stresses);
  const MotionBlocks& blocks = motion.blocks;
  std::size_t stations = 0;
  for (const Beam& beam : parts.beams) stations += beam.stations.size();
  if (blocks.pose != 7 * (parts.reference.size() - 1) || blocks.resultant != 6 * stations)
    throw Error(motion.file.string() +
                ": does not hold what it draws; run the model again with --motion");
  Collection files(directory, parts);
  for (const std::size_t row : evenly_chosen(motion.rows, most_frames)) {
    const std::vector<double> numbers = read_motion_rows(motion, std::span(&row, 1));
    const auto block = [&](std::size_t begin, std::size_t size) {
      return std::span(numbers).subspan(begin, size);
    };
    Frame frame{{parts.reference.front()},
                block(blocks.key + blocks.pose, blocks.twist),
                block(blocks.key + blocks.pose + blocks.twist, blocks.resultant),
                block(blocks.key + blocks.pose + blocks.twist + blocks.resultant, blocks.joint)};
    for (std::size_t n = 0; n + 1 < parts.reference.size(); ++n) {
      const double* const h = numbers.data() + blocks.key + 7 * n;
      Pose<double> H;
      H.r = Vec3(h[0], h[1], h[2]);
      H.p = Quaternion<double>(h[6], h[3], h[4], h[5]);
      frame.poses.push_back(H);
    }
    files.add(parts, frame, numbers.front());
  }
  return files.finish(motion.rows);
}

}  // namespace mbd
