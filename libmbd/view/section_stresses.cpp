#include "libmbd/view/section_stresses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libmbd/material/shaped_sections.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/places.hpp"
#include "libmbd/section/failure.hpp"
#include "libmbd/section/material.hpp"

namespace mbd {
namespace {

using Json = nlohmann::ordered_json;

constexpr int most_divisions = 4;
constexpr std::size_t usual_points = 20'000, most_points = 400'000;  // of a frame
constexpr std::size_t least_rim = 12, most_rim = 48;
constexpr double same_stiffness = 1e-6;

// Of an element that is divided n times: its points, and cells of them.
struct Divided {
  std::vector<std::array<double, 2>> points;  // xi, eta
  std::vector<std::vector<int>> cells;
};

Divided divided_square(int n) {
  Divided made;
  const auto at = [n](int k) { return 2.0 * k / n - 1.0; };
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) made.points.push_back({at(i), at(j)});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int p = i + (n + 1) * j;
      made.cells.push_back({p, p + 1, p + n + 2, p + n + 1});
    }
  return made;
}

Divided divided_triangle(int n) {
  Divided made;
  std::vector<int> first;  // of the rows
  for (int j = 0; j <= n; ++j) {
    first.push_back(static_cast<int>(made.points.size()));
    for (int i = 0; i + j <= n; ++i)
      made.points.push_back({static_cast<double>(i) / n, static_cast<double>(j) / n});
  }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i + j < n; ++i) {
      const int p = first[static_cast<std::size_t>(j)] + i,
                above = first[static_cast<std::size_t>(j) + 1] + i;
      made.cells.push_back({p, p + 1, above});
      if (i + j + 1 < n) made.cells.push_back({p + 1, above + 1, above});
    }
  return made;
}

Divided divided(const section::Element& element, int n) {
  return element.shape == section::Shape::triangle ? divided_triangle(n) : divided_square(n);
}

bool is_isotropic(const section::Stiffness& C) {
  section::Stiffness of = section::Stiffness::Zero();
  const double lambda = C(0, 1), G = C(3, 3);
  of.topLeftCorner<3, 3>().setConstant(lambda);
  for (Index i = 0; i < 3; ++i) of(i, i) += 2.0 * G, of(i + 3, i + 3) = G;
  return (C - of).cwiseAbs().maxCoeff() <= 1e-9 * C.cwiseAbs().maxCoeff();
}

// A beam of a motion, and its section in the model.
struct Stressed {
  std::string beam;
  const Section* section = nullptr;
  std::size_t rings = 0;  // elements have their ends each
  std::size_t intervals = 0;
  std::string outline;            // of its section, as the drawing has it
  std::array<double, 2> sides{};  // of that [m]
};

bool is_stressed(const Json& part) {
  return part.at("kind") == "beam" && part.contains("stations") && part.contains("stiffness");
}

// As the motion has it, in the upper half of `was`, by rows.
bool is_same(const Mat6& D, const Json& was) {
  std::size_t k = 0;
  for (Index i = 0; i < 6; ++i)
    for (Index j = i; j < 6; ++j)
      if (!(std::abs(D(i, j) - was.at(k++).get<double>()) <=
            same_stiffness * std::sqrt(D(i, i) * D(j, j))))
        return false;
  return true;
}

std::vector<Stressed> stressed_beams(const Scene& model, const Motion& motion) {
  std::vector<Stressed> all;
  const Json head = Json::parse(motion.head);
  for (const Json& part : head.at("drawing").at("parts")) {
    if (!is_stressed(part)) continue;
    const auto name = part.at("name").get<std::string>();
    const auto beam = std::ranges::find(model.beams, name, &BeamScene::name);
    const Section* const section = beam == model.beams.end() ? nullptr : section_of(model, *beam);
    if (section == nullptr || !section->shape || !is_same(section->stiffness, part.at("stiffness")))
      throw Error(beam == model.beams.end() ? model.source : beam->source,
                  label("beam", name) +
                      ": its section is not the one that was run; name the model as it was, or "
                      "run it again");
    const auto order = part.at("order").get<std::size_t>();
    const std::size_t intervals = part.at("s").size() - 1;
    Stressed& made = all.emplace_back();
    made = {name, section, intervals / order * (order + 1), intervals, "", {}};
    if (!part.contains("outline")) continue;  // its <shape> says what it is drawn as
    made.outline = head.at("drawing").at("outlines").at(section->name).dump();
    made.sides = {part.at("sides").at(0).at(0).get<double>(),
                  part.at("sides").at(0).at(1).get<double>()};
  }
  return all;
}

// Points between those of the rim, at equal distances, an odd number of them: where a side is longer than its share.
SectionOutline finer(const SectionOutline& outline, const std::array<double, 2>& sides,
                     std::size_t points) {
  const auto place = [&](std::size_t i) {
    return Eigen::Vector2d(outline.rim[i][0] * sides[0] / 2.0, outline.rim[i][1] * sides[1] / 2.0);
  };
  const std::size_t n = outline.rim.size();
  const auto next = [&](std::size_t i) { return static_cast<std::size_t>(outline.next[i]); };
  double around = 0.0;
  for (std::size_t i = 0; i < n; ++i) around += (place(next(i)) - place(i)).norm();
  SectionOutline made = outline;
  for (std::size_t i = 0; i < n; ++i) {
    const double share = (place(next(i)) - place(i)).norm() / around * static_cast<double>(points);
    const int pieces = share < 1.5 ? 1 : 2 * static_cast<int>(std::ceil(share / 2.0));
    std::size_t last = i;
    for (int k = 1; k < pieces; ++k) {
      const double u = static_cast<double>(k) / pieces;
      const OutlinePoint &a = outline.rim[i], &b = outline.rim[next(i)];
      made.next[last] = static_cast<int>(made.rim.size());
      last = made.rim.size();
      made.rim.push_back({(1 - u) * a[0] + u * b[0], (1 - u) * a[1] + u * b[1]});
      made.next.push_back(outline.next[i]);
    }
  }
  return made;
}

// Of the element that a point of an outline lies in, or else of the nearest node: outlines of curved edges are those of
// coarser meshes.
section::Influence influence_near(const section::StressField& field, const section::Point& point) {
  if (const auto found = field.find(point); !found.empty()) return field.at(found.front());
  section::Influence nearest;
  double distance = 1e300;
  field.each_node([&](int, const section::Point& at, const section::Influence& influence) {
    if (const double d = (at - point).norm(); d < distance) distance = d, nearest = influence;
  });
  return nearest;
}

bool has_plies(const section::StressField& field) {
  return !std::ranges::all_of(field.mesh().materials, [](const section::MeshMaterial& material) {
    return is_isotropic(material.stiffness);
  });
}

OutlineStresses outline_stresses(const section::StressField& field, const Stressed& beam,
                                 std::size_t points) {
  OutlineStresses made;
  made.outline = finer(outline_from(beam.outline), beam.sides, points);
  const bool plies = has_plies(field);
  for (const OutlinePoint& at : made.outline.rim) {
    const section::Influence influence = influence_near(
        field, section::Point(at[0] * beam.sides[0] / 2.0, at[1] * beam.sides[1] / 2.0));
    made.von_mises.push_back(influence.stress.transpose() * section::von_mises_form() *
                             influence.stress);
    if (plies) made.fibres.push_back(influence.stress.row(0).transpose());
  }
  return made;
}

}  // namespace

SectionStresses section_stresses(const section::StressField& field, int n, bool ply) {
  SectionStresses made;
  constexpr std::array<Index, 6> order{0, 1, 2, 5, 3, 4};  // of [11 22 33 23 13 12]
  const std::vector<section::Element>& elements = field.mesh().elements;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const auto first = static_cast<int>(made.points.size());
    const Divided of = divided(elements[e], n);
    for (const auto& [xi, eta] : of.points) {
      const section::ElementPoint at{static_cast<int>(e), xi, eta};
      const section::Influence influence = field.at(at);
      const section::Point x = field.position(at);
      made.points.push_back({x(0), x(1)});
      const Mat6 along_section =
          section::strain_turned(influence.axes).transpose() * influence.stress;
      Mat6& stress = made.stress.emplace_back();
      for (Index i = 0; i < 6; ++i)
        stress.row(i) = along_section.row(order[static_cast<std::size_t>(i)]);
      if (ply) made.ply.push_back(influence.stress);
    }
    for (std::vector<int> cell : of.cells) {
      for (int& corner : cell) corner += first;
      made.cells.push_back(std::move(cell));
    }
  }
  return made;
}

bool has_section_stresses(const Motion& motion) {
  if (motion.blocks.resultant == 0) return false;
  const Json head = Json::parse(motion.head);
  return std::ranges::any_of(head.at("drawing").at("parts"), is_stressed);
}

StressesOfBeams stresses_of_beams(const Scene& model, const Motion& motion) {
  const std::vector<Stressed> beams = stressed_beams(model, motion);
  std::map<const Section*, std::shared_ptr<const section::StressField>> fields;
  bool plies = false;
  for (const Stressed& beam : beams) {
    auto& field = fields[beam.section];
    if (field) continue;
    field = stress_field(model, *beam.section->shape, label(*beam.section));
    plies = plies || has_plies(*field);
  }
  const auto points = [&](int n) {
    std::size_t sum = 0;
    for (const Stressed& beam : beams)
      for (const section::Element& element : fields[beam.section]->mesh().elements)
        sum += beam.rings * divided(element, n).points.size();
    return sum;
  };
  int n = most_divisions;
  while (n > 1 && points(n) > usual_points) --n;
  if (const std::size_t all = points(n); all > most_points)
    throw Error(
        model.source,
        fmt::format("its sections would have {} points in each frame, more than {}; coarser "
                    "meshes of the sections, or fewer elements of the beams, give fewer",
                    all, most_points));
  std::map<const Section*, std::shared_ptr<const SectionStresses>> made;
  for (const auto& [section, field] : fields)
    made[section] = std::make_shared<SectionStresses>(section_stresses(*field, n, plies));
  StressesOfBeams result;
  for (const Stressed& beam : beams) result[beam.beam] = made[beam.section];
  return result;
}

StressesOfOutlines stresses_of_outlines(const Scene& model, const Motion& motion) {
  const std::vector<Stressed> beams = stressed_beams(model, motion);
  std::size_t intervals = 1;
  for (const Stressed& beam : beams) intervals += beam.intervals;
  const std::size_t points = std::clamp(usual_points / (12 * intervals), least_rim, most_rim);
  StressesOfOutlines made;
  for (const Stressed& beam : beams)
    if (const std::string& name = beam.section->name; !beam.outline.empty() && !made.contains(name))
      made[name] = outline_stresses(
          *stress_field(model, *beam.section->shape, label(*beam.section)), beam, points);
  return made;
}

}  // namespace mbd
