#include "libmbd/view/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <span>

#include "libmbd/core/error.hpp"
#include "libmbd/scene/shapes.hpp"
#include "libmbd/view/outline.hpp"

namespace mbd {
namespace {

using Json = nlohmann::json;
using Quat = Quaternion<double>;

constexpr std::size_t frames_for_bounds = 60, frames_for_range = 120;
constexpr std::size_t most_outlined = 20'000;  // points that a picture has to hold
constexpr std::size_t most_faces =
    150'000;  // of beams; of more nodes each second one is drawn, or fewer
constexpr double glyph = 0.014, thinnest = 0.0022;  // of the size of the model
constexpr int coils = 9, points_a_coil = 12;

constexpr Colour hex(unsigned rgb) {
  return {(rgb >> 16 & 255U) / 255.0, (rgb >> 8 & 255U) / 255.0, (rgb & 255U) / 255.0};
}
constexpr Colour beam_colour = hex(0x4f7fb5), body_colour = hex(0xc98a2b),
                 joint_colour = hex(0x3d8f5f), spring_colour = hex(0x8a5fb0),
                 load_colour = hex(0xc0392b), moment_colour = hex(0xa0398c),
                 mass_colour = hex(0x7a5230), motion_colour = hex(0x1f8fa3),
                 record_colour = hex(0xd1478c), gap_colour = hex(0xff2a1a);

Colour colour_from(const Json& code) {
  return hex(colour_code(code.get<std::string>()).value_or(0));
}

struct At {
  int node = 0;
  Pose<double> frame{};
};

Vec3 vector_of(const Json& all, std::size_t from = 0) {
  return {all.at(from).get<double>(), all.at(from + 1).get<double>(),
          all.at(from + 2).get<double>()};
}
Pose<double> pose_of(const Json& all, std::size_t from = 0) {
  const auto n = [&](std::size_t i) { return all.at(from + i).get<double>(); };
  return {Quat(n(6), n(3), n(4), n(5)), vector_of(all, from)};
}
At at_of(const Json& all) { return {all.at(0).get<int>(), pose_of(all, 1)}; }

struct Part {
  std::string kind, element, name;
  std::optional<At> at, a, b;
  std::string on_beam;  // in place of `at`
  double on_s = 0.0;
  Vec3 offset = Vec3::Zero();
  // beams
  std::vector<At> points;
  std::vector<double> s, stations;
  std::vector<std::array<double, 3>> sides;  // of all points, or of one; the third: 1 if round
  const SectionOutline* outline = nullptr;   // one of those of all parts
  bool rigid = false;
  std::size_t first_station = 0;
  std::vector<std::array<double, 21>>
      compliance;  // of the stations, or of all; upper halves by rows
  // bodies
  Pose<double> centre{};
  std::string shape;
  Vec3 box = Vec3::Zero();
  std::vector<Vec3> arms;  // to what joints join, body axes
  struct Form {
    std::string kind;
    Pose<double> pose{};  // body axes
    Vec3 sides = Vec3::Zero();
    std::vector<Vec3> points;  // of a mesh
    std::vector<std::array<std::size_t, 3>> triangles;
    std::optional<Colour> colour;
  };
  std::vector<Form> forms;  // stated
  double reach = 0.0;       // of them, from the reference point [m]
  std::optional<Colour> colour;
  // joints
  bool gap = false;
  // loads
  struct Arrow {
    std::string beam;
    double s = 0.0;
    Vec3 along = Vec3::Zero();
    bool follows = false, moment = false;
  };
  std::vector<Arrow> arrows;
};

struct Line {  // of a beam, at the points that are drawn
  std::vector<double> s;
  std::vector<Vec3> r;
  std::vector<Quat> q;
};

using Poses = std::vector<Pose<double>>;

// An instant: numbers of a row of the motion, poses by them, and those that are shown.
struct Now {
  std::vector<double> row;
  Poses exact, shown;
};

class Painter;

}  // namespace

struct Stage::Data {
  FigureOptions options;
  std::optional<Motion> motion;
  std::string name;
  bool is_time = true;
  Vec3 centre = Vec3::Zero(), up = Vec3::UnitZ();
  double size = 1.0;
  Poses reference;
  std::vector<Part> parts;
  std::map<std::string, const Part*, std::less<>> beams;
  std::map<std::string, SectionOutline, std::less<>> outlines;  // of sections
  SectionOutline round, rectangle;
  std::vector<double> keys{0.0};
  std::array<Vec3, 2> bounds{};
  std::vector<Vec3> outline;
  std::optional<Legend> legend;
  std::vector<std::vector<Vec3>> traced;  // by part, of all frames
  std::vector<double> units;              // of glyphs, by part [m]
  std::size_t outlined = 0;               // places that were looked at for the outline
  std::size_t for_outline = 1;            // of which each so-manyth is taken

  void read(const Json& drawing);

  // What all pictures have in common, in this order.
  void prepare();
  void thin_beams();
  void measure_glyphs();
  void find_arms(Part& body) const;
  void choose_colour();
  void look_at_frames();
  void include(const Vec3& x, double half, double in_bounds);
  void include(std::size_t part, const Poses& shown);
  void trace(const Poses& shown);
  void extend_legend(const Now& now);

  // Of a picture.
  Now now(double instant) const;
  std::array<double, 3> sides(const Part& beam, double s) const;
  const SectionOutline& outline_of(const Part& beam) const {
    if (beam.outline != nullptr) return *beam.outline;
    const bool is_round = beam.sides.empty() || beam.sides[0][2] != 0.0;
    return is_round ? round : rectangle;
  }
  std::vector<Vec3> ring(const std::vector<OutlinePoint>& of, const Part& beam, const Line& line,
                         std::size_t k) const;
  void draw(std::size_t part, const Now& now, Painter& painter, Figure& figure) const;
  void draw_beam(const Part& part, const Now& now, Painter& painter) const;
  void draw_body(const Part& part, double unit, const Poses& poses, Painter& painter) const;
  static void draw_forms(const Part& part, const Pose<double>& H, Painter& painter);
  void draw_joint(const Part& part, double unit, const Poses& poses, Painter& painter) const;
  static void draw_spring(const Part& part, double unit, const Poses& poses, Painter& painter);
  void draw_load(const Part& part, int number, const Poses& poses, Figure& figure) const;
  void draw_motion(const Part& part, double unit, const Poses& poses, Painter& painter) const;
  void draw_trail(std::size_t part, double instant, const Poses& poses, Figure& figure) const;

  std::vector<double> row(std::size_t frame) const;
  std::vector<double> row(double instant) const;
  Poses poses(const std::vector<double>& row) const;
  Poses scaled(Poses exact) const;

  double unit() const { return glyph * size; }
  double unit_at(const Vec3& reference) const;
  static Pose<double> place(const Poses& poses, const At& at) {
    return poses[static_cast<std::size_t>(at.node)] * at.frame;
  }
  Line line(const Part& part, const Poses& poses, int pieces) const;
  std::vector<double> values(const Part& part, const Line& line, const Line& reference,
                             const std::vector<double>& row) const;
  Pose<double> on_beam(std::string_view beam, double s, const Poses& poses) const;
  Pose<double> pose(const Part& part, const Poses& poses) const {
    Pose<double> H = part.at ? place(poses, *part.at) : on_beam(part.on_beam, part.on_s, poses);
    H.r += H.p * part.offset;
    return H;
  }
  std::size_t pose_size() const { return 7 * (reference.size() - 1); }
};

namespace {

// Parts of the picture are added to it here.
class Painter {
 public:
  Painter(Figure& figure, int part, Colour colour, int round)
      : figure_(figure), part_(part), colour_(colour), round_(round) {}

  void set(Colour colour, double opacity = 1.0) {
    colour_ = colour;
    opacity_ = opacity;
  }
  void face(std::initializer_list<Vec3> points) { face(std::span(points.begin(), points.size())); }
  void two_sided(std::initializer_list<Vec3> points) {  // of a surface that may be open
    face(points);
    figure_.faces.back().two_sided = true;
  }
  void face(std::span<const Vec3> points) {
    Figure::Face face;
    face.first = figure_.points.size();
    face.count = static_cast<int>(points.size());
    face.part = part_;
    face.colour = colour_;
    face.opacity = opacity_;
    figure_.points.insert(figure_.points.end(), points.begin(), points.end());
    figure_.faces.push_back(face);
  }
  void box(const Pose<double>& H, const Vec3& sides) {
    const auto corner = [&](int x, int y, int z) {
      return H * Vec3(0.5 * x * sides(0), 0.5 * y * sides(1), 0.5 * z * sides(2));
    };
    for (int axis = 0; axis < 3; ++axis)
      for (const int sign : {-1, 1}) {
        const auto at = [&](int u, int v) {
          std::array<int, 3> c{};
          c[static_cast<std::size_t>(axis)] = sign;
          c[static_cast<std::size_t>((axis + 1) % 3)] = sign * u;
          c[static_cast<std::size_t>((axis + 2) % 3)] = v;
          return corner(c[0], c[1], c[2]);
        };
        face({at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)});
      }
  }
  // Along the third axis.
  void cylinder(const Pose<double>& H, double radius, double length) {
    std::vector<Vec3> low, high;
    for (int i = 0; i < round_; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / round_;
      const double x = radius * std::cos(angle), y = radius * std::sin(angle);
      low.push_back(H * Vec3(x, y, -0.5 * length));
      high.push_back(H * Vec3(x, y, 0.5 * length));
    }
    for (std::size_t i = 0; i < low.size(); ++i) {
      const std::size_t j = (i + 1) % low.size();
      face({low[i], low[j], high[j], high[i]});
    }
    face(high);
    std::reverse(low.begin(), low.end());
    face(low);
  }
  void rod(const Vec3& a, const Vec3& b, double radius) {
    const double length = (b - a).norm();
    if (!(length > 0.0)) return;
    const Eigen::Quaterniond q =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), Eigen::Vector3d(b - a));
    cylinder({Quat(q.w(), q.x(), q.y(), q.z()), 0.5 * (a + b)}, radius, length);
  }
  void ball(const Pose<double>& H, double radius) {
    const int rows = std::max(4, round_ / 2);
    const auto at = [&](int i, int j) {
      const double theta = std::numbers::pi * i / rows, phi = 2.0 * std::numbers::pi * j / round_;
      return H * Vec3(radius * std::sin(theta) * std::cos(phi),
                      radius * std::sin(theta) * std::sin(phi), radius * std::cos(theta));
    };
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < round_; ++j) {
        if (i == 0)
          face({at(0, 0), at(1, j), at(1, j + 1)});
        else if (i + 1 == rows)
          face({at(i, j), at(rows, 0), at(i, j + 1)});
        else
          face({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
  }
  void line(const Vec3& a, const Vec3& b, double width) {
    figure_.lines.push_back({a, b, width, part_, colour_, false});
  }

 private:
  Figure& figure_;
  int part_;
  Colour colour_;
  int round_;
  double opacity_ = 1.0;
};

Colour colour_of(const std::string& kind) {
  static const std::map<std::string, Colour, std::less<>> table{
      {"beam", beam_colour},     {"body", body_colour},    {"joint", joint_colour},
      {"spring", spring_colour}, {"load", load_colour},    {"mass", mass_colour},
      {"motion", motion_colour}, {"record", record_colour}};
  const auto it = table.find(kind);
  return it == table.end() ? joint_colour : it->second;
}

// Linear between values at s.
std::vector<double> spread(std::span<const double> s, std::span<const double> values,
                           std::span<const double> fine) {
  std::vector<double> made;
  for (const double x : fine) {
    const std::size_t i =
        static_cast<std::size_t>(std::upper_bound(s.begin(), s.end(), x) - s.begin());
    if (i == 0)
      made.push_back(values.front());
    else if (i == s.size())
      made.push_back(values.back());
    else
      made.push_back(values[i - 1] +
                     (values[i] - values[i - 1]) * (x - s[i - 1]) / (s[i] - s[i - 1]));
  }
  return made;
}

struct Quantity {
  const char *name, *title;
};
constexpr Quantity table_of_quantities[] = {{"displacement", "displacement [m]"},
                                            {"velocity", "velocity [m/s]"},
                                            {"N", "axial force N [N]"},
                                            {"Q", "shear force |Q| [N]"},
                                            {"T", "torque M1 [N.m]"},
                                            {"M", "bending moment |M| [N.m]"},
                                            {"energy", "strain energy per length [J/m]"}};

// Half of S C S, of the compliance at a station.
double energy(const std::vector<std::array<double, 21>>& compliance, std::size_t station,
              const double* S) {
  const std::array<double, 21>& half = compliance[compliance.size() > 1 ? station : 0];
  double sum = 0.0;
  for (std::size_t i = 0, k = 0; i < 6; ++i)
    for (std::size_t j = i; j < 6; ++j) sum += (i == j ? 0.5 : 1.0) * half[k++] * S[i] * S[j];
  return sum;
}

Quat toward(const Quat& a, const Quat& b, double u) {
  const double sign = a.dot(b) < 0.0 ? -1.0 : 1.0;
  Quat q;
  q.coeffs() = (1.0 - u) * a.coeffs() + u * sign * b.coeffs();
  q.normalize();
  return q;
}

Part::Form form_of(const Json& of) {
  Part::Form form;
  form.kind = of.at("kind").get<std::string>();
  form.pose = pose_of(of.at("pose"));
  if (const auto it = of.find("colour"); it != of.end()) form.colour = colour_from(*it);
  if (const auto it = of.find("sides"); it != of.end()) form.sides = vector_of(*it);
  if (const auto it = of.find("points"); it != of.end())
    for (std::size_t i = 0; i + 2 < it->size(); i += 3) form.points.push_back(vector_of(*it, i));
  if (const auto it = of.find("triangles"); it != of.end())
    for (std::size_t i = 0; i + 2 < it->size(); i += 3)
      form.triangles.push_back({it->at(i).get<std::size_t>(), it->at(i + 1).get<std::size_t>(),
                                it->at(i + 2).get<std::size_t>()});
  return form;
}

// ---- parts from a drawing -----------------------------------------------------------------------

using Outlines = std::map<std::string, SectionOutline, std::less<>>;

template <class T>
void take(const Json& all, const char* key, T& value) {
  if (const auto it = all.find(key); it != all.end()) value = it->get<T>();
}

void read_beam(const Json& of, const Outlines& outlines, Part& part) {
  for (const Json& at : of.at("points")) part.points.push_back(at_of(at));
  part.s = of.at("s").get<std::vector<double>>();
  part.rigid = of.at("rigid").get<bool>();
  take(of, "sides", part.sides);
  take(of, "stations", part.stations);
  take(of, "compliance", part.compliance);
  if (const auto it = of.find("outline"); it != of.end())
    part.outline = &outlines.at(it->get<std::string>());
}

void read_body(const Json& of, Part& part) {
  part.centre = pose_of(of.at("centre"));
  part.shape = of.at("shape").get<std::string>();
  part.box = vector_of(of.at("box"));
  if (const auto it = of.find("forms"); it != of.end()) {
    for (const Json& form : *it) part.forms.push_back(form_of(form));
    part.reach = of.at("reach").get<double>();
  }
}

Part::Arrow arrow_from(const Json& of) {
  Part::Arrow arrow;
  take(of, "beam", arrow.beam);
  take(of, "s", arrow.s);
  arrow.along = vector_of(of.at("along"));
  arrow.follows = of.at("follows").get<bool>();
  arrow.moment = of.at("moment").get<bool>();
  return arrow;
}

// Parts of beams point into `outlines`.
Part part_from(const Json& of, const Outlines& outlines) {
  Part part;
  part.kind = of.at("kind").get<std::string>();
  part.element = of.at("element").get<std::string>();
  part.name = of.at("name").get<std::string>();
  for (const auto& [key, place] : {std::pair{"at", &part.at}, {"a", &part.a}, {"b", &part.b}})
    if (const auto it = of.find(key); it != of.end()) *place = at_of(*it);
  if (const auto it = of.find("on"); it != of.end()) {
    part.on_beam = it->at("beam").get<std::string>();
    part.on_s = it->at("s").get<double>();
  }
  if (const auto it = of.find("offset"); it != of.end()) part.offset = vector_of(*it);
  if (const auto it = of.find("colour"); it != of.end()) part.colour = colour_from(*it);
  if (part.kind == "beam") read_beam(of, outlines, part);
  if (part.kind == "body") read_body(of, part);
  if (part.kind == "joint") part.gap = of.contains("gap");
  if (part.kind == "load")
    for (const Json& arrow : of.at("arrows")) part.arrows.push_back(arrow_from(arrow));
  return part;
}

// The axis that points up where weight goes along `down`; nothing where there is none.
std::optional<Vec3> against(const Vec3& down) {
  Index most = 0;
  if (!(down.cwiseAbs().maxCoeff(&most) > 0.0)) return std::nullopt;
  Vec3 up = Vec3::Zero();
  up(most) = down(most) > 0.0 ? -1.0 : 1.0;
  return up;
}

}  // namespace

std::string code_of(const Colour& c) {
  const auto byte = [](double x) {
    return static_cast<int>(std::lround(255.0 * std::clamp(x, 0.0, 1.0)));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(c.r), byte(c.g), byte(c.b));
}

std::vector<std::string> picture_quantities() {
  std::vector<std::string> names;
  for (const Quantity& q : table_of_quantities) names.emplace_back(q.name);
  return names;
}

// ---- what is read -------------------------------------------------------------------------------

void Stage::Data::read(const Json& drawing) {
  if (const auto all = drawing.find("outlines"); all != drawing.end())
    for (const auto& [section, of] : all->items())
      outlines.emplace(section, outline_from(of.dump()));
  name = drawing.at("name").get<std::string>();
  is_time = drawing.at("key") == "time";
  centre = vector_of(drawing.at("centre"));
  size = drawing.at("size").get<double>();
  for (const Json& node : drawing.at("nodes")) {
    reference.push_back(pose_of(node));
    reference.back().r -= centre;
  }
  std::size_t stations = 0;
  for (const Json& of : drawing.at("parts")) {
    parts.push_back(part_from(of, outlines));
    parts.back().first_station = stations;
    stations += parts.back().stations.size();
    if (parts.back().kind == "gravity") up = against(vector_of(of.at("along"))).value_or(up);
  }
}

std::vector<double> Stage::Data::row(std::size_t frame) const {
  if (!motion) return {};
  std::vector<double> numbers = read_motion_rows(*motion, std::span(&frame, 1));
  for (std::size_t i = 0; i < motion->blocks.pose; ++i)
    if (i % 7 < 3) numbers[1 + i] -= centre(static_cast<Index>(i % 7));
  return numbers;
}

std::vector<double> Stage::Data::row(double instant) const {
  const auto k = static_cast<std::size_t>(instant);
  const double u = instant - static_cast<double>(k);
  std::vector<double> a = row(k);
  if (!(u > 0.0) || k + 1 >= keys.size()) return a;
  const std::vector<double> b = row(k + 1);
  blend_rows(a, b, u, motion->blocks);
  return a;
}

Poses Stage::Data::poses(const std::vector<double>& row) const {
  Poses all = reference;
  if (row.empty()) return all;
  for (std::size_t n = 1; n < all.size(); ++n) {
    const double* const x = row.data() + 1 + 7 * (n - 1);
    all[n] = {Quat(x[6], x[3], x[4], x[5]), Vec3(x[0], x[1], x[2])};
  }
  return all;
}

Poses Stage::Data::scaled(Poses exact) const {
  if (options.scale == 1.0) return exact;
  for (std::size_t n = 1; n < exact.size(); ++n) {
    const Pose<double>& from = reference[n];
    Quat d = from.p.conjugate() * exact[n].p;
    if (d.w() < 0.0) d.coeffs() = -d.coeffs();
    const double sine = d.vec().norm(), half = options.scale * std::atan2(sine, d.w());
    const Vec3 axis = (sine > 1e-12 ? std::sin(half) / sine : options.scale) * d.vec();
    exact[n].p = from.p * Quat(std::cos(half), axis(0), axis(1), axis(2));
    exact[n].r = from.r + options.scale * (exact[n].r - from.r);
  }
  return exact;
}

Line Stage::Data::line(const Part& part, const Poses& poses, int pieces) const {
  Line made;
  for (std::size_t i = 0; i < part.points.size(); ++i) {
    const Pose<double> B = place(poses, part.points[i]);
    if (i > 0) {
      const Pose<double> A = place(poses, part.points[i - 1]);
      const double length =
          (place(reference, part.points[i]).r - place(reference, part.points[i - 1]).r).norm();
      const Vec3 a = length * (A.p * Vec3(Vec3::UnitX())), b = length * (B.p * Vec3(Vec3::UnitX()));
      for (int k = 1; k < pieces; ++k) {
        const double u = static_cast<double>(k) / pieces, t = 1.0 - u;
        made.s.push_back(part.s[i - 1] + u * (part.s[i] - part.s[i - 1]));
        made.r.emplace_back(t * t * (1.0 + 2.0 * u) * A.r + u * u * (1.0 + 2.0 * t) * B.r +
                            u * t * (t * a - u * b));
        made.q.push_back(toward(A.p, B.p, u));
      }
    }
    made.s.push_back(part.s[i]);
    made.r.push_back(B.r);
    made.q.push_back(B.p);
  }
  return made;
}

Pose<double> Stage::Data::on_beam(std::string_view beam, double s, const Poses& poses) const {
  const auto it = beams.find(beam);
  if (it == beams.end() || it->second->points.empty()) return {};
  const Line all = line(*it->second, poses, 6);
  std::size_t i = 0;
  while (i + 2 < all.s.size() && all.s[i + 1] < s) ++i;
  if (all.s.size() < 2) return {all.q[0], all.r[0]};
  const double u = std::clamp((s - all.s[i]) / (all.s[i + 1] - all.s[i]), 0.0, 1.0);
  return {toward(all.q[i], all.q[i + 1], u), Vec3((1.0 - u) * all.r[i] + u * all.r[i + 1])};
}

std::vector<double> Stage::Data::values(const Part& part, const Line& now, const Line& before,
                                        const std::vector<double>& row) const {
  std::vector<double> made;
  if (options.colour == "displacement") {
    for (std::size_t i = 0; i < now.r.size(); ++i) made.push_back((now.r[i] - before.r[i]).norm());
    return made;
  }
  const double* const twists = row.data() + 1 + motion->blocks.pose;
  if (options.colour == "velocity") {
    for (const At& at : part.points) {
      if (at.node == 0) {
        made.push_back(0.0);
        continue;
      }
      const double* const V = twists + 6 * (at.node - 1);
      const Vec3 v(V[0], V[1], V[2]), w(V[3], V[4], V[5]);
      made.push_back((v + w.cross(at.frame.r)).norm());
    }
    return spread(part.s, made, now.s);
  }
  if (part.stations.empty() || (options.colour == "energy" && part.compliance.empty())) return {};
  const double* x = twists + motion->blocks.twist + 6 * part.first_station;
  for (std::size_t i = 0; i < part.stations.size(); ++i, x += 6)
    made.push_back(options.colour == "N"        ? x[0]
                   : options.colour == "Q"      ? std::hypot(x[1], x[2])
                   : options.colour == "T"      ? x[3]
                   : options.colour == "energy" ? energy(part.compliance, i, x)
                                                : std::hypot(x[4], x[5]));
  return spread(part.stations, made, now.s);
}

// Glyphs stand out of the beams they are at.
double Stage::Data::unit_at(const Vec3& x) const {
  double girth = 0.0;
  for (const Part& part : parts) {
    if (part.kind != "beam" || part.sides.empty()) continue;
    for (std::size_t i = 0; i < part.points.size(); ++i)
      if ((place(reference, part.points[i]).r - x).norm() < 1e-3 * size) {
        const auto& side = part.sides[part.sides.size() == 1 ? 0 : i];
        girth = std::max(girth, std::min(side[0], side[1]));
      }
  }
  return std::max(unit(), std::min(0.7 * girth, 0.06 * size));
}

// Of many nodes, some.
void Stage::Data::thin_beams() {
  std::size_t intervals = 0, sides = 0;
  for (const Part& part : parts)
    if (part.kind == "beam") {
      intervals += part.points.size();
      sides +=
          part.points.size() * (part.outline == nullptr ? static_cast<std::size_t>(options.round)
                                                        : part.outline->rim.size());
    }
  if (sides * static_cast<std::size_t>(options.pieces) > most_faces) {
    options.pieces = 1;
    options.round = std::min(options.round, 8);
    for (Part& part : parts) part.outline = nullptr;
  }
  const std::size_t every = intervals * static_cast<std::size_t>(options.round) / most_faces + 1;
  if (every == 1 || options.pieces != 1) return;
  const auto thin = [every](auto& list) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < list.size(); ++i)
      if (i % every == 0 || i + 1 == list.size()) list[kept++] = list[i];
    list.resize(kept);
  };
  for (Part& part : parts) {
    if (part.kind != "beam") continue;
    if (part.sides.size() == part.s.size()) thin(part.sides);
    thin(part.points);
    thin(part.s);
  }
}

void Stage::Data::measure_glyphs() {
  for (const Part& part : parts) {
    const std::optional<At>& at = part.b ? part.b : part.at;
    const bool is_glyph = part.kind == "joint" || part.kind == "mass" || part.kind == "motion";
    units.push_back(is_glyph && at ? unit_at(place(reference, *at).r) : unit());
  }
}

// What joins at a body.
void Stage::Data::find_arms(Part& body) const {
  const Pose<double> own = place(reference, *body.at);
  for (const Part& other : parts) {
    const bool is_at = other.kind == "load" || other.kind == "mass";
    for (const std::optional<At>* at : {&other.a, &other.b, &other.at}) {
      if (!*at || (at == &other.at && !is_at) || (*at)->node != body.at->node) continue;
      const Vec3 arm = own.p.conjugate() * Vec3(place(reference, **at).r - own.r);
      if (std::none_of(body.arms.begin(), body.arms.end(),
                       [&](const Vec3& x) { return (x - arm).norm() < 1e-6 * size; }))
        body.arms.push_back(arm);
    }
  }
  // A link: what it joins is to be seen.
  const double largest = (body.arms.size() > 1 ? 0.12 : body.arms.empty() ? 1.0 : 0.25) * size;
  if (body.box.maxCoeff() > largest) body.box *= largest / body.box.maxCoeff();
}

void Stage::Data::choose_colour() {
  if (options.colour.empty()) return;
  const auto known = std::find_if(std::begin(table_of_quantities), std::end(table_of_quantities),
                                  [&](const Quantity& q) { return options.colour == q.name; });
  const std::string names = fmt::format("{}", fmt::join(picture_quantities(), ", "));
  if (known == std::end(table_of_quantities))
    throw Error(fmt::format("colour {}: no such quantity; there are {}", options.colour, names));
  if (!motion)
    throw Error(fmt::format("colour {}: a model has no {} before it runs; run it with --motion",
                            options.colour, options.colour));
  if (options.colour == "velocity" && motion->blocks.twist == 0)
    throw Error("colour velocity: nothing moves in time in these results; take displacement");
  const bool of_resultants = options.colour.size() == 1 || options.colour == "energy";
  if (of_resultants && motion->blocks.resultant == 0)
    throw Error(fmt::format("colour {}: no beam of this model is flexible; take displacement",
                            options.colour));
  if (options.colour == "energy" &&
      std::ranges::all_of(parts, [](const Part& part) { return part.compliance.empty(); }))
    throw Error(
        "colour energy: all sections are damped, and their resultants are not elastic alone; take "
        "another");
  legend = Legend{known->title, 1e300, -1e300};
}

// A place with what stands out about it, `half` on each side in the outline.
void Stage::Data::include(const Vec3& x, double half, double in_bounds) {
  bounds[0] = bounds[0].cwiseMin(Vec3(x - Vec3::Constant(in_bounds)));
  bounds[1] = bounds[1].cwiseMax(Vec3(x + Vec3::Constant(in_bounds)));
  if (outlined++ % for_outline != 0) return;
  for (const double sign : {-1.0, 1.0})
    for (int axis = 0; axis < 3; ++axis)
      outline.emplace_back(x + sign * half * Vec3(Vec3::Unit(axis)));
}

void Stage::Data::include(std::size_t index, const Poses& shown) {
  const Part& part = parts[index];
  for (std::size_t k = 0; k < part.points.size(); ++k) {
    double half = 0.0;
    if (!part.sides.empty()) {
      const auto& side = part.sides[part.sides.size() == 1 ? 0 : k];
      half = 0.5 * std::max(side[0], side[1]);
    }
    include(place(shown, part.points[k]).r, half, 0.0);
  }
  const double half = part.kind == "body"    ? std::max(0.5 * part.box.maxCoeff(), part.reach)
                      : part.kind == "joint" ? 3.0 * units[index]
                                             : units[index];
  for (const std::optional<At>* at : {&part.at, &part.a, &part.b})
    if (*at) include(place(shown, **at).r, half, part.kind == "body" ? half : 0.0);
}

void Stage::Data::trace(const Poses& shown) {
  for (std::size_t i = 0; i < parts.size(); ++i)
    if ((parts[i].kind == "record" || parts[i].kind == "body") &&
        (parts[i].at || !parts[i].on_beam.empty()))
      traced[i].push_back(pose(parts[i], shown).r);
}

void Stage::Data::extend_legend(const Now& now) {
  for (const Part& part : parts) {
    if (part.kind != "beam") continue;
    for (const double value : values(part, line(part, now.exact, options.pieces),
                                     line(part, reference, options.pieces), now.row)) {
      legend->low = std::min(legend->low, value);
      legend->high = std::max(legend->high, value);
    }
  }
}

// Room and colours for all frames.
void Stage::Data::look_at_frames() {
  bounds = {Vec3::Constant(1e300), Vec3::Constant(-1e300)};
  std::size_t all_points = 0;
  for (const Part& part : parts) all_points += 1 + part.points.size();
  for_outline = 1 + all_points * frames_for_bounds / most_outlined;
  traced.resize(parts.size());
  const std::size_t frames = keys.size(),
                    for_bounds = std::max<std::size_t>(1, frames / frames_for_bounds),
                    for_range = std::max<std::size_t>(1, frames / frames_for_range);
  for (std::size_t f = 0; f < frames; ++f) {
    const bool is_last = f + 1 == frames, in_bounds = f % for_bounds == 0 || is_last,
               in_range = legend && (f % for_range == 0 || is_last);
    if (!in_bounds && !in_range && !options.trails) continue;
    const Now then = now(static_cast<double>(f));
    if (options.trails) trace(then.shown);
    if (in_bounds)
      for (std::size_t i = 0; i < parts.size(); ++i) include(i, then.shown);
    if (in_range) extend_legend(then);
  }
  if (!(bounds[0](0) <= bounds[1](0))) include(Vec3::Zero(), 0.0, 0.0);
  if (legend) {
    if (!(legend->low <= legend->high)) legend->low = legend->high = 0.0;
    if (std::abs(legend->low) < 1e-9 * std::abs(legend->high)) legend->low = 0.0;
  }
}

void Stage::Data::prepare() {
  thin_beams();
  round = round_outline(options.round);
  rectangle = rectangle_outline();
  for (const Part& part : parts)
    if (part.kind == "beam") beams.try_emplace(part.name, &part);
  measure_glyphs();
  for (Part& part : parts)
    if (part.kind == "body" && part.at && part.at->node != 0) find_arms(part);
  choose_colour();
  look_at_frames();
}

Stage::Stage(std::string_view drawing, const FigureOptions& options)
    : data_(std::make_unique<Data>()) {
  data_->options = options;
  data_->read(Json::parse(drawing));
  data_->prepare();
}

Stage::Stage(const Motion& motion, const FigureOptions& options) : data_(std::make_unique<Data>()) {
  data_->options = options;
  data_->motion = motion;
  data_->read(Json::parse(motion.head).at("drawing"));
  data_->keys = read_motion_keys(motion);
  data_->prepare();
}

Stage::~Stage() = default;
Stage::Stage(Stage&&) noexcept = default;

// ---- what is asked ------------------------------------------------------------------------------

std::size_t Stage::frames() const { return data_->keys.size(); }
const std::vector<double>& Stage::keys() const { return data_->keys; }
bool Stage::is_time() const { return data_->is_time; }
const std::string& Stage::name() const { return data_->name; }
double Stage::size() const { return data_->size; }
Vec3 Stage::centre() const { return data_->centre; }
Vec3 Stage::up() const { return data_->up; }
std::array<Vec3, 2> Stage::bounds() const { return data_->bounds; }
const std::vector<Vec3>& Stage::outline() const { return data_->outline; }
const Stage::Legend* Stage::legend() const { return data_->legend ? &*data_->legend : nullptr; }
std::string Stage::part_name(int part) const {
  return part < 0 ? std::string() : data_->parts[static_cast<std::size_t>(part)].name;
}

double Stage::instant(double key) const {
  const std::vector<double>& keys = data_->keys;
  if (!data_->motion)
    throw Error(
        fmt::format("{:.9g}: a model has no time before it runs; run it with --motion", key));
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (keys[k] == key) return static_cast<double>(k);
    if (k + 1 == keys.size()) break;
    const auto [low, high] = std::minmax(keys[k], keys[k + 1]);
    if (key > low && key < high)
      return static_cast<double>(k) + (key - keys[k]) / (keys[k + 1] - keys[k]);
  }
  const auto [low, high] = std::minmax_element(keys.begin(), keys.end());
  throw Error(fmt::format("{:.9g}: the motion has {} from {:.9g} to {:.9g}{}", key,
                          data_->is_time ? "times" : "load factors", *low, *high,
                          data_->is_time ? " s" : ""));
}

double Stage::key(double instant) const {
  const std::vector<double>& keys = data_->keys;
  const auto k = static_cast<std::size_t>(instant);
  if (k + 1 >= keys.size()) return keys.back();
  return keys[k] + (instant - static_cast<double>(k)) * (keys[k + 1] - keys[k]);
}

Colour Stage::shade(
    double share) {  // dark blue over green to yellow, even in lightness, as in the page
  constexpr Colour stops[] = {{0.17, 0.12, 0.42}, {0.19, 0.33, 0.60}, {0.13, 0.51, 0.60},
                              {0.22, 0.66, 0.48}, {0.55, 0.79, 0.31}, {0.97, 0.89, 0.20}};
  constexpr std::size_t last = std::size(stops) - 1;
  const double u = std::clamp(share, 0.0, 1.0) * static_cast<double>(last);
  const std::size_t i = std::min(last - 1, static_cast<std::size_t>(u));
  const double f = u - static_cast<double>(i);
  const Colour &a = stops[i], &b = stops[i + 1];
  return {a.r + f * (b.r - a.r), a.g + f * (b.g - a.g), a.b + f * (b.b - a.b)};
}

// ---- what is drawn ------------------------------------------------------------------------------

Now Stage::Data::now(double instant) const {
  Now made{row(instant), {}, {}};
  made.exact = poses(made.row);
  made.shown = scaled(made.exact);
  return made;
}

// Widths along b2 and b3 at a place of a beam, and whether it is round.
std::array<double, 3> Stage::Data::sides(const Part& beam, double s) const {
  std::array<double, 3> side{0.0, 0.0, 1.0};
  if (beam.sides.size() == 1) side = beam.sides[0];
  if (beam.sides.size() > 1) {
    std::size_t i = 0;
    while (i + 2 < beam.s.size() && beam.s[i + 1] < s) ++i;
    const double u = (s - beam.s[i]) / (beam.s[i + 1] - beam.s[i]);
    for (std::size_t j = 0; j < 2; ++j)
      side[j] = beam.sides[i][j] + u * (beam.sides[i + 1][j] - beam.sides[i][j]);
    side[2] = beam.sides[0][2];
  }
  side[0] = std::max(side[0], thinnest * size);
  side[1] = std::max(side[1], thinnest * size);
  return side;
}

// Points of an outline at a place of a beam.
std::vector<Vec3> Stage::Data::ring(const std::vector<OutlinePoint>& of, const Part& beam,
                                    const Line& line, std::size_t k) const {
  const std::array<double, 3> side = sides(beam, line.s[k]);
  std::vector<Vec3> points;
  for (const auto& [y, z] : of)
    points.emplace_back(line.r[k] + line.q[k] * Vec3(0.0, 0.5 * side[0] * y, 0.5 * side[1] * z));
  return points;
}

void Stage::Data::draw_beam(const Part& part, const Now& now, Painter& painter) const {
  const Line line = this->line(part, now.shown, options.pieces);
  std::vector<double> values;
  if (legend && (options.colour.size() > 1 || !part.stations.empty()))
    values = this->values(part,
                          options.scale == 1.0 ? line : this->line(part, now.exact, options.pieces),
                          this->line(part, reference, options.pieces), now.row);
  if (part.rigid) painter.set(body_colour);
  if (part.colour) painter.set(*part.colour);
  const auto tint = [&](double value) {
    const Legend& l = *legend;
    painter.set(shade(l.high > l.low ? (value - l.low) / (l.high - l.low) : 0.0));
  };
  const SectionOutline& curve = outline_of(part);
  std::vector<Vec3> before = ring(curve.rim, part, line, 0);
  if (!values.empty()) tint(values.front());
  for (const std::vector<OutlinePoint>& cap : curve.caps) {
    std::vector<Vec3> points = ring(cap, part, line, 0);
    std::ranges::reverse(points);
    painter.face(points);
  }
  for (std::size_t k = 1; k < line.r.size(); ++k) {
    std::vector<Vec3> here = ring(curve.rim, part, line, k);
    if (!values.empty()) tint(0.5 * (values[k - 1] + values[k]));
    for (std::size_t i = 0; i < here.size(); ++i) {
      const auto j = static_cast<std::size_t>(curve.next[i]);
      painter.face({before[i], before[j], here[j], here[i]});
    }
    before = std::move(here);
  }
  if (!values.empty()) tint(values.back());
  for (const std::vector<OutlinePoint>& cap : curve.caps)
    painter.face(ring(cap, part, line, line.r.size() - 1));
}

void Stage::Data::draw_body(const Part& part, double unit, const Poses& poses,
                            Painter& painter) const {
  const Pose<double> H = pose(part, poses), C = H * part.centre;
  if (!part.forms.empty()) {
    draw_forms(part, H, painter);
    return;
  }
  const Colour colour = part.colour.value_or(body_colour);
  painter.set(colour);
  painter.ball(H, 0.6 * unit);
  const double most = part.box.maxCoeff();
  if (most > 0.02 * unit) {
    painter.set(colour, part.arms.empty() ? 1.0 : 0.75);
    Vec3 side = part.box.cwiseMax(std::max(0.04 * most, 0.4 * unit)).cwiseMin(1.5 * size);
    if (part.shape == "box")
      painter.box(C, side);
    else if (part.shape == "sphere")
      painter.ball(C, 0.5 * side(0));
    else
      painter.cylinder(C, 0.5 * side(0), side(2));
    painter.set(colour);
  } else {
    painter.ball(C, 1.5 * unit);
  }
  std::vector<Vec3> ends = part.arms;
  ends.emplace_back(Vec3::Zero());
  for (const Vec3& end : ends)
    if ((end - part.centre.r).norm() > unit) painter.rod(H * part.centre.r, H * end, 0.42 * unit);
}

void Stage::Data::draw_forms(const Part& part, const Pose<double>& H, Painter& painter) {
  for (const Part::Form& form : part.forms) {
    const Pose<double> F = H * form.pose;
    painter.set(form.colour.value_or(part.colour.value_or(body_colour)));
    if (form.kind == "box")
      painter.box(F, form.sides);
    else if (form.kind == "cylinder")
      painter.cylinder(F, 0.5 * form.sides(0), form.sides(2));
    else if (form.kind == "sphere")
      painter.ball(F, 0.5 * form.sides(0));
    for (const auto& [a, b, c] : form.triangles)
      painter.two_sided({F * form.points[a], F * form.points[b], F * form.points[c]});
  }
}

void Stage::Data::draw_joint(const Part& part, double unit, const Poses& poses,
                             Painter& painter) const {
  const Pose<double> B = place(poses, *part.b), A = place(poses, *part.a);
  const auto axis = [&](double length) { painter.cylinder(B, 0.28 * unit, length * unit); };
  const std::string& kind = part.element;
  if (kind == "revolute")
    painter.cylinder(B, unit, 2.2 * unit), axis(6.0);
  else if (kind == "cylindrical" || kind == "screw")
    painter.cylinder(B, 0.8 * unit, 3.4 * unit), axis(8.0);
  else if (kind == "prismatic")
    painter.box(B, {1.6 * unit, 1.6 * unit, 3.2 * unit}), axis(8.0);
  else if (kind == "universal")
    axis(5.0), painter.ball(B, 0.8 * unit);
  else if (kind == "planar")
    painter.cylinder(B, 2.4 * unit, 0.3 * unit), axis(4.0);
  else if (kind == "point_on_line")
    axis(14.0), painter.ball(B, 0.8 * unit);
  else if (kind == "fixed")
    painter.box(B, Vec3::Constant(1.5 * unit));
  else
    painter.ball(B, 1.1 * unit);
  if (part.gap) painter.set(gap_colour), painter.ball(A, 0.9 * unit);
  if ((A.r - B.r).norm() > 1e-9 * size) painter.rod(A.r, B.r, 0.3 * unit);
}

void Stage::Data::draw_spring(const Part& part, double unit, const Poses& poses, Painter& painter) {
  const Pose<double> A = place(poses, *part.a), B = place(poses, *part.b);
  const Vec3 along = B.r - A.r;
  const double length = along.norm();
  const Vec3 u = length > 0.0 ? Vec3(along / length) : Vec3(Vec3::UnitZ());
  const Vec3 v = u.cross(Vec3(std::abs(u(2)) < 0.9 ? Vec3::UnitZ() : Vec3::UnitX())).normalized(),
             w = u.cross(v);
  const int last = coils * points_a_coil + 2;
  Vec3 before = A.r;
  for (int i = 1; i <= last; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / points_a_coil, radius = i < last ? unit : 0.0,
                 share = static_cast<double>(i) / last;
    const Vec3 now = A.r + share * along + radius * (std::cos(angle) * v + std::sin(angle) * w);
    painter.line(before, now, 1.5);
    before = now;
  }
  painter.ball(A, 0.7 * unit);
  painter.ball(B, 0.7 * unit);
}

void Stage::Data::draw_load(const Part& part, int number, const Poses& poses,
                            Figure& figure) const {
  for (const Part::Arrow& arrow : part.arrows) {
    if (!(arrow.along.norm() > 0.0)) continue;
    const bool on_beam = !arrow.beam.empty();
    const Pose<double> H = on_beam ? this->on_beam(arrow.beam, arrow.s, poses) : pose(part, poses);
    const Vec3 direction = arrow.follows ? Vec3(H.p * arrow.along) : arrow.along;
    figure.arrows.push_back({H.r, H.r + (on_beam ? 0.06 : 0.12) * size * direction,
                             arrow.moment ? 2 : 1, number,
                             arrow.moment ? moment_colour : load_colour});
  }
}

void Stage::Data::draw_motion(const Part& part, double unit, const Poses& poses,
                              Painter& painter) const {
  const Pose<double> H = pose(part, poses);
  constexpr int sides = 24;
  const auto at = [&](int i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    return H * Vec3(1.6 * unit * std::cos(angle), 1.6 * unit * std::sin(angle), 0.0);
  };
  for (int i = 0; i < sides; ++i) painter.line(at(i), at(i + 1), 2.5);
}

void Stage::Data::draw_trail(std::size_t index, double instant, const Poses& poses,
                             Figure& figure) const {
  Figure::Trail trail;
  trail.part = static_cast<int>(index);
  trail.colour = colour_of(parts[index].kind);
  const auto until = static_cast<std::ptrdiff_t>(instant) + 1;
  trail.points.assign(traced[index].begin(), traced[index].begin() + until);
  trail.now = pose(parts[index], poses).r;
  if (instant > std::floor(instant)) trail.points.push_back(trail.now);
  figure.trails.push_back(std::move(trail));
}

void Stage::Data::draw(std::size_t index, const Now& now, Painter& painter, Figure& figure) const {
  const Part& part = parts[index];
  const double unit = units[index];
  const bool placed = part.at || !part.on_beam.empty();
  if (part.kind == "beam")
    draw_beam(part, now, painter);
  else if (part.kind == "body")
    draw_body(part, unit, now.shown, painter);
  else if (part.kind == "joint" && part.a && part.b)
    draw_joint(part, unit, now.shown, painter);
  else if (part.kind == "spring" && part.a && part.b)
    draw_spring(part, unit, now.shown, painter);
  else if (part.kind == "load")
    draw_load(part, static_cast<int>(index), now.shown, figure);
  else if (part.kind == "mass" && placed)
    painter.ball(pose(part, now.shown), 1.2 * unit);
  else if (part.kind == "motion" && placed)
    draw_motion(part, unit, now.shown, painter);
}

Figure Stage::figure(double instant) const {
  const Now now = data_->now(instant);
  Figure figure;
  for (std::size_t part = 0; part < data_->parts.size(); ++part) {
    Painter painter(figure, static_cast<int>(part), colour_of(data_->parts[part].kind),
                    data_->options.round);
    data_->draw(part, now, painter, figure);
    if (!data_->traced[part].empty()) data_->draw_trail(part, instant, now.shown, figure);
  }
  return figure;
}

}  // namespace mbd
