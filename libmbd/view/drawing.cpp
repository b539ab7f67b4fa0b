#include "libmbd/view/drawing.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <map>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "elements/beam/mesh_error.hpp"
#include "libmbd/material/shaped_sections.hpp"
#include "libmbd/material/solid_shapes.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/places.hpp"
#include "libmbd/scene/reference_line.hpp"
#include "libmbd/scene/section_table.hpp"
#include "libmbd/view/outline.hpp"

namespace mbd {
namespace {

using Json = nlohmann::ordered_json;

constexpr int points_without_model = 13;  // of a line, where the scene does not compile
constexpr int most_stated_lines = 8;      // of an item in the model
constexpr double thickest = 0.5;          // section over the length of its beam
constexpr double slender = 30.0;          // length of a beam without extension over its section
constexpr int arrows_along = 7;           // of a distributed load

// A pose in a node.
struct At {
  int node = 0;
  Pose<double> frame{};
};

Json json(const Vec3& v) { return {v(0), v(1), v(2)}; }
Json json(const Pose<double>& H) {
  return {H.r(0), H.r(1), H.r(2), H.p.x(), H.p.y(), H.p.z(), H.p.w()};
}
Json json(const At& at) {
  Json all = {at.node};
  for (const Json& number : json(at.frame)) all.push_back(number);
  return all;
}

std::string in_words(const Place& place) {
  if (place.kind == Place::Kind::ground) return "ground";
  if (place.kind == Place::Kind::body) return place.name;
  if (place.parameter == 0.0) return place.name + ".start";
  if (place.parameter == 1.0) return place.name + ".end";
  return fmt::format("{}@{:g}", place.name, place.parameter);
}

std::string number(double value, std::string_view unit) {
  return unit.empty() ? fmt::format("{:.6g}", value) : fmt::format("{:.6g} {}", value, unit);
}
std::string number(const Vec3& v, std::string_view unit) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g}){}{}", v(0), v(1), v(2), unit.empty() ? "" : " ",
                     unit);
}

class Facts {
 public:
  Facts& operator()(const std::string& what, const std::string& value) {
    all_.push_back({what, value});
    return *this;
  }
  const Json& json() const { return all_; }

 private:
  Json all_ = Json::array();
};

class Drawing {
 public:
  Drawing(const Scene& scene, const Model* model) : scene_(scene), model_(model) {}

  Json make() {
    for (const RigidScene& rigid : scene_.rigids)
      for (const std::string& name : rigid.of) rigid_with_.try_emplace(name, rigid.name);
    for (const BeamScene& beam : scene_.beams) add_beam(beam);
    measure();
    if (model_ != nullptr) {
      for (const Model::PlaceFrame& p : model_->places)
        places_.try_emplace({p.place.kind, p.place.name, p.place.parameter}, p.node, p.frame);
      for (const Model::JointFrames& j : model_->joints) joints_.try_emplace(j.name, &j);
    }
    for (const BodyScene& body : scene_.bodies) add_body(body);
    for (const PointMassScene& mass : scene_.point_masses) add_mass(mass);
    for (const JointScene& joint : scene_.joints) add_joint(joint);
    for (const MotionScene& motion : scene_.motions) add_motion(motion);
    for (const SpringScene& spring : scene_.springs) add_spring(spring);
    for (const BushingScene& bushing : scene_.bushings) add_bushing(bushing);
    for (const LoadScene& load : scene_.loads) add_load(load);
    for (const DistributedLoadScene& load : scene_.distributed_loads) add_load(load);
    if (scene_.gravity) add_gravity(*scene_.gravity);
    for (const RecordScene& record : scene_.records) add_record(record);

    Json all = {{"name", scene_.name},
                {"file", scene_.file},
                {"key", scene_.transient ? "time" : "load_factor"},
                {"unit", scene_.transient ? "s" : ""},
                {"centre", json(centre_)},
                {"size", size_}};
    Json parameters = Json::array();
    for (const auto& [name, value] : scene_.parameters) parameters.push_back({name, value});
    all["parameters"] = parameters;
    // Reference poses of the nodes, the ground first.
    Json nodes = Json::array();
    if (model_ == nullptr)
      nodes.push_back(json(Pose<double>{}));
    else
      for (Index n = 0; n < model_->system->nodes(); ++n)
        nodes.push_back(json(model_->system->reference_pose(n)));
    all["nodes"] = nodes;
    Json joints = Json::array();  // of motion, in its order
    if (model_ != nullptr)
      for (const Model::JointFrames& j : model_->joints) joints.push_back(j.name);
    all["joints"] = joints;
    Json outlines = Json::object();
    for (const auto& [name, shaped] : shaped_)
      if (shaped) outlines[name] = shaped->outline;
    if (!outlines.empty()) all["outlines"] = std::move(outlines);
    all["parts"] = std::move(parts_);
    return all;
  }

 private:
  using Key = std::tuple<Place::Kind, std::string, double>;

  // --- parts ---

  // The lines of a model that state an item: from where it begins to where its tag or element ends.
  std::string stated(const Source& source) {
    if (source.file.empty() || source.line <= 0) return {};
    auto [it, is_new] = files_.try_emplace(source.file);
    if (is_new) {
      errno = 0;
      std::ifstream stream(source.file, std::ios::binary);
      for (std::string line; std::getline(stream, line);) it->second.push_back(line);
      // Streams keep it to themselves.
      if (stream.bad() || (!stream.is_open() && errno == ENOMEM)) throw std::bad_alloc();
    }
    std::string text;
    const auto first = static_cast<std::size_t>(source.line - 1);
    for (std::size_t i = first; i < it->second.size() && i < first + most_stated_lines; ++i) {
      const std::string line(trimmed(it->second[i]));
      text += (text.empty() ? "" : "\n") + excerpt_of(line);
      if (line.ends_with("/>") || line.find("</") != std::string::npos) break;
      if (line.ends_with(">") && i > first) break;
    }
    return text;
  }
  static std::string excerpt_of(const std::string& line) {
    constexpr std::size_t longest = 400;
    return line.size() <= longest ? line : line.substr(0, longest) + " …";
  }

  template <class Item>
  Json& add(const Item& item, std::string_view kind, std::string name, Json facts, Json shape) {
    Json part = {{"kind", kind},
                 {"name", std::move(name)},
                 {"element", std::string(element_of(item))},
                 {"file", item.source.file},
                 {"line", item.source.line},
                 {"stated", stated(item.source)},
                 {"facts", std::move(facts)}};
    part.update(shape);
    parts_.push_back(std::move(part));
    return parts_.back();
  }

  // --- places ---

  struct Line {
    ReferenceLine line;
    std::vector<At> points;
    std::vector<double> s;
  };

  // The pose at s of a line, in the reference configuration.
  Pose<double> pose_on(const std::string& beam, double s) const {
    const auto it = lines_.find(beam);
    return it == lines_.end() ? Pose<double>{} : it->second.line.at(s);
  }

  Pose<double> reference_of(const Place& place) const {
    if (place.kind == Place::Kind::beam) return pose_on(place.name, place.parameter);
    if (place.kind == Place::Kind::body)
      for (const BodyScene& body : scene_.bodies)
        if (body.name == place.name)
          return body.attached_to ? reference_of(*body.attached_to)
                                  : make_pose(body.orientation, body.at);
    return {};
  }

  // Nothing where the place lies within an element, or the scene has no such place.
  std::optional<At> find(const Place& place) const {
    if (place.kind == Place::Kind::ground) return At{};
    if (model_ == nullptr) return At{0, reference_of(place)};
    if (const auto it = places_.find({place.kind, place.name, place.parameter});
        it != places_.end())
      return At{it->second.first, it->second.second};
    if (place.kind == Place::Kind::beam)
      if (const auto line = lines_.find(place.name); line != lines_.end())
        for (std::size_t i = 0; i < line->second.s.size(); ++i)
          if (std::abs(line->second.s[i] - place.parameter) < same_parameter)
            return line->second.points[i];
    return std::nullopt;
  }

  // What is at a point of space in the reference configuration, and moves with a place.
  At moving_with(const Place& place, const Pose<double>& reference) const {
    const int node = find(place).value_or(At{}).node;
    if (model_ == nullptr) return {0, reference};
    return {node, relative(model_->system->reference_pose(node), reference)};
  }

  // A place of a part: with a node, or on a line between its nodes.
  void put(Json& shape, const Place& place) const {
    if (const std::optional<At> at = find(place))
      shape["at"] = json(*at);
    else
      shape["on"] = {{"beam", place.name}, {"s", place.parameter}};
  }

  void measure() {
    Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
    const auto include = [&](const Vec3& x) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    };
    for (const auto& [name, line] : lines_)
      for (int i = 0; i <= 8; ++i) include(line.line.at(i / 8.0).r);
    for (const BodyScene& body : scene_.bodies) {
      const Pose<double> H = reference_of({Place::Kind::body, body.name, 0.0});
      include(H.r);
      include(H * mass_properties(body).center);
      for (const ShapeScene& shape : body.shapes)
        for (const Vec3& corner : corners_of(shape)) include(H * corner);
    }
    for (const JointScene& joint : scene_.joints)
      for (const std::optional<Vec3>& at : {joint.at, joint.at_a, joint.at_b})
        if (at) include(*at);
    if (!(low(0) <= high(0))) low = high = Vec3::Zero();
    centre_ = 0.5 * (low + high);
    size_ = (high - low).norm();
    if (!(size_ > 0.0)) size_ = model_ != nullptr ? model_->system->length_scale() : 1.0;
  }

  // --- beams ---

  // Sides of a rectangle (or the diameter of a circle, twice) with these radii of gyration.
  static std::array<double, 3> outline(const Mat6& D, double length) {
    const double r2 = std::sqrt(std::max(D(5, 5) / D(0, 0), 0.0)),
                 r3 = std::sqrt(std::max(D(4, 4) / D(0, 0), 0.0));
    const bool is_round = std::abs(r2 - r3) < 0.01 * std::max(r2, r3);
    const double factor = is_round ? 4.0 : std::sqrt(12.0);
    const auto side = [&](double r) { return std::min(factor * r, thickest * length); };
    return {side(r2), side(r3), is_round ? 1.0 : 0.0};
  }

  using Sides = std::array<double, 3>;  // along b2, b3; 1 if round

  // Linear from the start of a beam to its end.
  static Json sides_along(const std::vector<double>& s, const Sides& start, const Sides& end) {
    Json all = Json::array();
    for (const double x : s) {
      all.push_back(
          Sides{(1 - x) * start[0] + x * end[0], (1 - x) * start[1] + x * end[1], start[2]});
      if (start == end) break;
    }
    return all;
  }

  // The outline of a section that is stated by its shape, of all its stations where it has some: that of the first,
  // and the sides of each. Nothing where one has no shape, or another than the first.
  struct Shaped {
    Json outline;
    std::vector<std::pair<double, Sides>> sides;  // by their place
  };
  const std::optional<Shaped>& shaped(const Section& section) {
    const auto [it, is_new] = shaped_.try_emplace(section.name);
    std::vector<std::pair<double, const SectionShape*>> shapes;
    if (section.shape) shapes.emplace_back(0.0, &*section.shape);
    for (const Station& station : section.stations)
      shapes.emplace_back(station.at, station.shape ? &*station.shape : nullptr);
    if (!is_new || shapes.empty() ||
        std::ranges::any_of(shapes, [](const auto& at) { return at.second == nullptr; }))
      return it->second;
    constexpr section::Fineness smooth{.order = 4, .layers = 1};
    Shaped made;
    SectionOutline first;
    for (const auto& [at, stated] : shapes) {
      std::array<double, 2> sides{};
      const SectionOutline of =
          outline_of(mesher_of(scene_, *stated, "section " + section.name)(smooth), sides);
      if (made.sides.empty()) {
        made.outline = Json::parse(outline_text(of));
        first = of;
      }
      if (!are_alike(first, of)) return it->second;
      made.sides.push_back({at, {sides[0], sides[1], 0.0}});
    }
    it->second = std::move(made);
    return it->second;
  }

  // What a beam is drawn as: what its <shape> says, or the shape of its section, or what its stiffness suggests. In
  // words.
  std::string add_sides(const BeamScene& beam, const Section& section, const SectionTable& table,
                        const Line& made, Json& shape) {
    if (beam.shape && !beam.shape->colour.empty()) shape["colour"] = code_of(beam.shape->colour);
    if (beam.shape && beam.shape->has_outline()) {
      const bool is_round = beam.shape->ellipse.has_value();
      const std::array<double, 2> start = is_round ? *beam.shape->ellipse : *beam.shape->rectangle,
                                  end = beam.shape->to.value_or(start);
      shape["sides"] = sides_along(made.s, {start[0], start[1], is_round ? 1.0 : 0.0},
                                   {end[0], end[1], is_round ? 1.0 : 0.0});
      return "as its <shape> states";
    }
    if (const std::optional<Shaped>& known = shaped(section)) {
      shape["outline"] = section.name;
      Json sides = Json::array();
      for (const double s : made.s) {
        std::size_t k = 1;
        while (k + 1 < known->sides.size() && known->sides[k].first < s) ++k;
        if (known->sides.size() == 1) {
          sides.push_back(known->sides[0].second);
          break;
        }
        const auto& [from, a] = known->sides[k - 1];
        const auto& [to, b] = known->sides[k];
        const double u = std::clamp((s - from) / (to - from), 0.0, 1.0);
        sides.push_back(Sides{(1 - u) * a[0] + u * b[0], (1 - u) * a[1] + u * b[1], 0.0});
      }
      shape["sides"] = sides;
      return "with the outline of its section";
    }
    Json sides = Json::array();
    for (const double s : made.s) {
      sides.push_back(outline(table.stiffness(s), made.line.length));
      if (table.is_uniform()) break;
    }
    shape["sides"] = sides;
    return outline(table.stiffness(0.0), 1e300)[2] != 0.0
               ? "round, with the section's radius of gyration"
               : "as a rectangle with the section's radii of gyration";
  }

  // By rows.
  static Json upper_half(const Mat6& A) {
    Json all = Json::array();
    for (Index i = 0; i < 6; ++i)
      for (Index j = i; j < 6; ++j) all.push_back(A(i, j));
    return all;
  }

  const Model::Line* line_of(const std::string& beam) const {
    if (model_ != nullptr)
      for (const Model::Line& line : model_->lines)
        if (line.name == beam) return &line;
    return nullptr;
  }

  // The nodes of its elements, or points of its reference line where it has none.
  Line placed(const BeamScene& beam, const Model::Line* line, const std::string* rigid) const {
    Line made{make_reference_line(beam), {}, {}};
    if (line != nullptr) {
      for (std::size_t i = 0; i < line->size(); ++i)
        made.points.push_back({line->nodes[i], line->frames[i]});
      made.s = line->s;
      return made;
    }
    const int node = rigid != nullptr && model_ != nullptr ? node_of_rigid(*rigid) : 0;
    for (int i = 0; i < points_without_model; ++i) {
      const double s = i / (points_without_model - 1.0);
      const Pose<double> H = made.line.at(s);
      made.s.push_back(s);
      made.points.push_back(
          {node, node == 0 ? H : relative(model_->system->reference_pose(node), H)});
    }
    return made;
  }

  // What its section makes it look like, and what pictures of strains need.
  void add_section(const BeamScene& beam, const Section& section, const Model::Line* line,
                   const Line& made, Json& shape, Facts& facts) {
    // What is infinite is drawn as a slender beam.
    const SectionTable table(section, made.line.length / slender);
    const std::string drawn = add_sides(beam, section, table, made, shape);
    // Strains are the compliance times the resultants at the stations, where those are elastic alone.
    if (line != nullptr && !section.damping) {
      Json compliance = Json::array();
      for (const double s : line->stations) {
        compliance.push_back(upper_half(beam::compliance_of(table.stiffness(s), table.held())));
        if (table.is_uniform()) break;
      }
      shape["compliance"] = compliance;
    }
    const Mat6 D = table.stiffness(0.0);
    // By it files for ParaView know, later, that a model has the section that was run.
    if (line != nullptr && section.shape) shape["stiffness"] = upper_half(D);
    const std::string where = table.is_uniform() ? "" : " at the start";
    const auto stiffness = [&](Index c) {
      return table.held()[static_cast<std::size_t>(c)] ? std::string("infinite")
                                                       : number(D(c, c), c < 3 ? "N" : "N.m2");
    };
    facts("EA" + where, stiffness(0))("GA2, GA3" + where, stiffness(1) + ", " + stiffness(2));
    facts("GJ" + where, stiffness(3));
    facts("EI2, EI3" + where, stiffness(4) + ", " + stiffness(5));
    if (table.has_mass()) facts("mass per length" + where, number(table.mass(0.0)(0, 0), "kg/m"));
    facts("drawn", drawn);
  }

  void add_beam(const BeamScene& beam) {
    const auto rigid = rigid_with_.find(beam.name);
    const bool is_rigid = rigid != rigid_with_.end();
    const ReductionScene* const reduction = reduction_with(scene_, beam.name);
    const Model::Line* const line = line_of(beam.name);
    Line made = placed(beam, line, is_rigid ? &rigid->second : nullptr);
    Json shape = Json::object();
    if (line != nullptr) {
      shape["stations"] = line->stations;
      // Of component modes there are some nodes, and those of no elements.
      if (reduction == nullptr) shape["order"] = beam.order;
    }
    Json points = Json::array();
    for (const At& at : made.points) points.push_back(json(at));
    shape["points"] = points;
    shape["s"] = made.s;
    shape["length"] = made.line.length;
    shape["rigid"] = is_rigid;
    Facts facts;
    facts("length", number(made.line.length, "m"));
    if (reduction != nullptr)
      facts("component modes", "part of " + label(*reduction));
    else if (!is_rigid)
      facts("elements", fmt::format("{} of order {}, {} nodes", stated_elements(scene_, beam),
                                    beam.order, made.s.size()));
    else
      facts("rigid", "part of " + rigid->second);
    if (const Section* const section = section_of(scene_, beam)) {
      facts("section", section->name);
      try {
        add_section(beam, *section, line, made, shape, facts);
      } catch (const Error&) {  // a table that is wrong: the line alone
      }
    }
    add(beam, "beam", beam.name, facts.json(), shape);
    lines_.emplace(beam.name, std::move(made));
  }

  int node_of_rigid(const std::string& name) const {
    // Of any of its parts that has a place.
    for (const RigidScene& rigid : scene_.rigids) {
      if (rigid.name != name) continue;
      for (const Model::PlaceFrame& p : model_->places)
        if (std::find(rigid.of.begin(), rigid.of.end(), p.place.name) != rigid.of.end())
          return p.node;
    }
    for (Index n = 1; n < model_->system->nodes(); ++n)
      if (model_->system->node_name(n) == "rigid '" + name + "'") return static_cast<int>(n);
    return 0;
  }

  // --- bodies ---

  static Vec3 sides_of(const ShapeScene& shape) {
    if (shape.box) return *shape.box;
    if (shape.cylinder) return {(*shape.cylinder)[0], (*shape.cylinder)[0], (*shape.cylinder)[1]};
    return Vec3::Constant(shape.sphere.value_or(0.0));
  }

  // What a form reaches to, in body axes.
  static std::vector<Vec3> corners_of(const ShapeScene& shape) {
    std::vector<Vec3> all;
    if (!shape.has_form()) return all;
    const auto put = [&](const Vec3& x) { all.emplace_back(shape.at + shape.orientation * x); };
    if (!shape.mesh.empty())
      for (const Vec3& x : surface_of(shape, "shape")->points) put(shape.unit.value_or(1.0) * x);
    else
      for (int i = 0; i < 8; ++i)
        put(0.5 * sides_of(shape).cwiseProduct(
                      Vec3((i & 1) - 0.5, (i >> 1 & 1) - 0.5, (i >> 2 & 1) - 0.5) * 2.0));
    return all;
  }

  static std::string code_of(const std::string& colour) {
    return fmt::format("#{:06x}", colour_code(colour).value_or(0));
  }

  static Json form(const ShapeScene& shape) {
    Json all = {{"kind", shape.box        ? "box"
                         : shape.cylinder ? "cylinder"
                         : shape.sphere   ? "sphere"
                                          : "mesh"},
                {"pose", json(make_pose(shape.orientation, shape.at))}};
    if (!shape.colour.empty()) all["colour"] = code_of(shape.colour);
    if (shape.mesh.empty()) {
      all["sides"] = json(sides_of(shape));
      return all;
    }
    // As many digits as files of meshes have.
    const auto digits = [](double x) { return std::stod(fmt::format("{:.7g}", x)); };
    const auto surface = surface_of(shape, "shape");
    Json points = Json::array(), triangles = Json::array();
    for (const Vec3& x : surface->points)
      for (Index i = 0; i < 3; ++i) points.push_back(digits(shape.unit.value_or(1.0) * x(i)));
    for (const auto& t : surface->triangles)
      for (const std::uint32_t corner : t) triangles.push_back(corner);
    all["points"] = std::move(points);
    all["triangles"] = std::move(triangles);
    return all;
  }

  // The solid of uniform density with this mass and these principal inertias, with its sides (of a cylinder, along the
  // third axis: twice its diameter, and its length): a sphere where all are equal, a cylinder where two are, or else a
  // box. No side where there is no mass, and the side 0 where no solid is so flat.
  static std::tuple<const char*, Vec3, Mat3> solid_of(double mass, const Vec3& I, Mat3 axes) {
    constexpr double same = 1e-6;
    if (!(mass > 0.0)) return {"box", Vec3::Zero(), Mat3::Identity()};
    if (axes.determinant() < 0.0) axes.col(2) = -axes.col(2);
    const auto is_same = [&](int i, int j) { return std::abs(I(i) - I(j)) <= same * I.maxCoeff(); };
    if (is_same(0, 2)) return {"sphere", Vec3::Constant(2.0 * std::sqrt(2.5 * I(0) / mass)), axes};
    if (is_same(0, 1) || is_same(1, 2)) {
      const int along = is_same(0, 1) ? 2 : 0;
      const double r2 = 2.0 * I(along) / mass, d = 2.0 * std::sqrt(r2),
                   h = std::sqrt(std::max(12.0 * I(1) / mass - 3.0 * r2, 0.0));
      Mat3 turned = axes;  // its axis the third
      if (along == 0) turned << axes.col(1), axes.col(2), axes.col(0);
      return {"cylinder", {d, d, h}, turned};
    }
    Vec3 sides;
    for (int i = 0; i < 3; ++i)
      sides(i) = std::sqrt(std::max(6.0 * (I.sum() - 2.0 * I(i)) / mass, 0.0));
    return {"box", sides, axes};
  }

  void add_body(const BodyScene& body) {
    Json shape = Json::object();
    put(shape, {Place::Kind::body, body.name, 0.0});
    Facts facts;
    const MassProperties is = mass_properties(body);
    facts("mass", number(is.mass, "kg"));
    facts("mass centre", number(is.center, "m, body axes"));
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal{Eigen::Matrix3d(is.inertia)};
    const Vec3 I = principal.eigenvalues();
    facts("principal inertias", number(I, "kg.m2"));
    if (const auto rigid = rigid_with_.find(body.name); rigid != rigid_with_.end())
      facts("rigid", "part of " + rigid->second);
    if (body.attached_to) facts("attached to", in_words(*body.attached_to));
    Json forms = Json::array();
    for (const ShapeScene& stated : body.shapes) {
      if (stated.has_form()) forms.push_back(form(stated));
      if (!stated.has_form()) shape["colour"] = code_of(stated.colour);
    }
    const auto [solid, suggested, axes] = solid_of(is.mass, I, principal.eigenvectors());
    const Vec3 sides = forms.empty() ? suggested : Vec3(Vec3::Zero());
    shape["centre"] = json(make_pose(axes, is.center));
    shape["shape"] = solid;
    shape["box"] = json(sides);
    if (!forms.empty()) {
      double reach = 0.0;
      for (const ShapeScene& stated : body.shapes)
        for (const Vec3& corner : corners_of(stated)) reach = std::max(reach, corner.norm());
      shape["reach"] = reach;
      shape["forms"] = std::move(forms);
    }
    if (sides.maxCoeff() > 0.0)
      facts("drawn", fmt::format("as the {} of this mass and these inertias", solid));
    add(body, "body", body.name, facts.json(), shape);
  }

  void add_mass(const PointMassScene& mass) {
    Json shape = Json::object();
    put(shape, mass.at);
    shape["offset"] = json(mass.offset);
    add(mass, "mass", mass.name,
        Facts()("mass", number(mass.mass, "kg"))("at", in_words(mass.at)).json(), shape);
  }

  // --- joints ---

  void add_joint(const JointScene& joint) {
    Facts facts;
    facts("joins", in_words(joint.a) + " and " + in_words(joint.b));
    if (joint.axis) facts("axis", number(joint.axis->normalized(), "at the start"));
    for (const DriveScene& drive : scene_.drives)
      if (drive.joint == joint.name)
        for (const auto& [what, law] : {std::pair{"driven rate [rad/s]", &drive.rate},
                                        {"driven angle [rad]", &drive.angle},
                                        {"driven speed [m/s]", &drive.speed},
                                        {"driven displacement [m]", &drive.displacement}})
          if (*law) facts(what, (*law)->text());
    Json shape = Json::object();
    if (const auto it = joints_.find(joint.name); it != joints_.end()) {
      const Model::JointFrames& f = *it->second;
      shape["a"] = json(At{f.node_a, f.a});
      shape["b"] = json(At{f.node_b, f.b});
    } else {
      // Without multipliers, or without a model: where it is stated.
      const bool a_is_beam = joint.a.kind == Place::Kind::beam,
                 b_is_beam = joint.b.kind == Place::Kind::beam;
      const Vec3 place_a = reference_of(joint.a).r, place_b = reference_of(joint.b).r;
      const Vec3 other = joint.at                              ? *joint.at
                         : joint.b.kind != Place::Kind::ground ? place_b
                                                               : place_a;
      const Vec3 point_a = joint.at_a ? *joint.at_a : a_is_beam ? place_a : other;
      const Vec3 point_b = joint.at_b  ? *joint.at_b
                           : b_is_beam ? place_b
                                       : (joint.at    ? *joint.at
                                          : a_is_beam ? place_a
                                                      : other);
      const Mat3 R = joint.axis && joint.axis->norm() > 0.0
                         ? Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(),
                                                              Eigen::Vector3d(*joint.axis))
                               .toRotationMatrix()
                         : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
      shape["a"] = json(moving_with(joint.a, make_pose(R, point_a)));
      shape["b"] = json(moving_with(joint.b, make_pose(R, point_b)));
      const double gap = (point_a - point_b).norm();
      if (!joint.at_a && !joint.at_b && gap > 1e-9 * size_) {
        shape["gap"] = gap;
        facts("GAP", number(gap, "m"));
      }
      if (model_ != nullptr) facts("multipliers", "none: what it joins is one node, or rigid");
    }
    shape["axis"] = joint.axis.has_value();
    add(joint, "joint", joint.name, facts.json(), shape);
  }

  void add_motion(const MotionScene& motion) {
    Json shape = Json::object();
    put(shape, motion.of);
    add(motion, "motion", motion.name, Facts()("of", in_words(motion.of)).json(), shape);
  }

  // --- springs ---

  void add_spring(const SpringScene& spring) {
    Json shape = Json::object();
    const auto end = [&](const Place& place, const std::optional<Vec3>& point) {
      const Pose<double> H = reference_of(place);
      return json(moving_with(place, point ? make_pose(Mat3::Identity(), *point) : H));
    };
    shape["a"] = end(spring.a, spring.at_a);
    shape["b"] = end(spring.b, spring.at_b);
    Facts facts;
    facts("between", in_words(spring.a) + " and " + in_words(spring.b));
    if (spring.stiffness > 0.0) facts("stiffness", number(spring.stiffness, "N/m"));
    if (spring.damping > 0.0) facts("damping", number(spring.damping, "N.s/m"));
    add(spring, "spring", spring.name, facts.json(), shape);
  }

  void add_bushing(const BushingScene& bushing) {
    Json shape = Json::object();
    const Place& of = bushing.b.kind == Place::Kind::ground ? bushing.a : bushing.b;
    const Vec3 point = bushing.at ? *bushing.at : reference_of(of).r;
    shape["a"] = json(moving_with(bushing.a, make_pose(Mat3::Identity(), point)));
    shape["b"] = json(moving_with(bushing.b, make_pose(Mat3::Identity(), point)));
    add(bushing, "spring", bushing.name,
        Facts()("between", in_words(bushing.a) + " and " + in_words(bushing.b)).json(), shape);
  }

  // --- loads ---

  // The direction in which a law is largest, of some times of the run; zero: it is.
  Vec3 direction(const LawVector& law) const {
    constexpr int times = 64;
    const double duration = scene_.transient ? scene_.transient->duration : 0.0;
    Vec3 most = Vec3::Zero();
    for (int i = 0; i <= (duration > 0.0 ? times : 0); ++i) {
      const double t = duration * i / times;
      Vec3 value;
      for (std::size_t k = 0; k < 3; ++k) value(static_cast<Index>(k)) = law[k](t).v;
      if (value.allFinite() && value.norm() > (1.0 + 1e-9) * most.norm()) most = value;
    }
    return most.norm() > 0.0 ? Vec3(most.normalized()) : most;
  }

  template <class Laws>
  static std::string text_of(const Laws& law) {
    return "(" + law[0].text() + ", " + law[1].text() + ", " + law[2].text() + ")";
  }

  void add_load(const LoadScene& load) {
    Json shape = Json::object();
    put(shape, load.at);
    shape["offset"] = json(load.offset);
    Facts facts;
    facts("at", in_words(load.at));
    Json arrows = Json::array();
    const auto arrow = [&](const std::optional<LawVector>& law, const char* what, bool follows,
                           bool is_moment) {
      if (!law) return;
      facts(what, text_of(*law));
      arrows.push_back(
          {{"along", json(direction(*law))}, {"follows", follows}, {"moment", is_moment}});
    };
    arrow(load.force, "force [N], inertial axes", false, false);
    arrow(load.moment, "moment [N.m], inertial axes", false, true);
    arrow(load.follower_force, "force [N], axes of the place", true, false);
    arrow(load.follower_moment, "moment [N.m], axes of the place", true, true);
    shape["arrows"] = arrows;
    add(load, "load", load.name, facts.json(), shape);
  }

  void add_load(const DistributedLoadScene& load) {
    Facts facts;
    facts("along", fmt::format("{} from {:g} to {:g}", load.beam, load.from, load.to));
    Json arrows = Json::array();
    const auto arrow = [&](const std::optional<FieldVector>& law, const char* what, bool follows,
                           bool is_moment) {
      if (!law) return;
      facts(what, text_of(*law));
      std::vector<std::pair<double, Vec3>> values;
      for (int i = 0; i < arrows_along; ++i) {
        const double s = load.from + (load.to - load.from) * i / (arrows_along - 1.0);
        try {
          const LawVector at{(*law)[0].at(s), (*law)[1].at(s), (*law)[2].at(s)};
          values.emplace_back(s, direction(at));
        } catch (const Error&) {  // outside the domain of a function: no arrow there
        }
      }
      for (const auto& [s, along] : values)
        arrows.push_back({{"beam", load.beam},
                          {"s", s},
                          {"along", json(along)},
                          {"follows", follows},
                          {"moment", is_moment}});
    };
    arrow(load.force, "force per length [N/m], inertial axes", false, false);
    arrow(load.moment, "moment per length [N], inertial axes", false, true);
    arrow(load.follower_force, "force per length [N/m], section axes", true, false);
    arrow(load.follower_moment, "moment per length [N], section axes", true, true);
    add(load, "load", load.name, facts.json(), {{"arrows", arrows}});
  }

  void add_gravity(const Gravity& gravity) {
    add(gravity, "gravity", "gravity",
        Facts()("acceleration", number(gravity.acceleration, "m/s2")).json(),
        {{"along", json(gravity.acceleration)}});
  }

  void add_record(const RecordScene& record) {
    if (!record.at) return;
    Json shape = Json::object();
    put(shape, *record.at);
    const Pose<double> H = reference_of(*record.at);
    shape["from"] = json(H.r);
    std::string quantities;
    for (const std::string& q : record.quantities)
      quantities += (quantities.empty() ? "" : ", ") + q;
    add(record, "record", record.name,
        Facts()("at", in_words(*record.at))("records", quantities).json(), shape);
  }

  const Scene& scene_;
  const Model* model_;
  std::map<std::string, std::string> rigid_with_;
  std::map<std::string, Line> lines_;
  std::map<std::string, std::optional<Shaped>> shaped_;  // by section
  std::map<Key, std::pair<int, Pose<double>>> places_;
  std::map<std::string, const Model::JointFrames*> joints_;
  std::map<std::string, std::vector<std::string>> files_;
  Json parts_ = Json::array();
  Vec3 centre_ = Vec3::Zero();
  double size_ = 1.0;
};

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string drawing(const Scene& scene, const Model& model) {
  return text_of(Drawing(scene, &model).make());
}

std::string drawing(const Scene& scene, const std::string& why) {
  Json all = Drawing(scene, nullptr).make();
  all["fault"] = why;
  return text_of(all);
}

}  // namespace mbd
