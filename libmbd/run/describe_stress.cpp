#include "libmbd/run/describe_stress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "libmbd/language/schema.hpp"
#include "libmbd/material/shaped_sections.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/text/spelling.hpp"
#include "libmbd/text/text.hpp"

namespace mbd {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 6> components{"LL", "TT", "NN", "TN", "LN", "LT"};

// What is looked at, at points of the material: none where it has no such strengths.
struct Measure {
  std::string_view name, unit;
  bool (*is_of)(const section::MeshMaterial&);
  double (*value)(const section::MeshMaterial&, const Vec6&);
};
bool has_strengths(const section::MeshMaterial& m) { return m.strengths.has_value(); }
bool yields(const section::MeshMaterial& m) { return m.yield.has_value(); }
bool any(const section::MeshMaterial&) { return true; }
template <section::Criterion criterion>
double index(const section::MeshMaterial& m, const Vec6& stress) {
  return section::failure_index(criterion, stress, *m.strengths);
}
template <Index i>
double size_of(const section::MeshMaterial&, const Vec6& stress) {
  return std::abs(stress(i));
}
constexpr std::array<Measure, 12> measures{
    {{"max_stress", "", has_strengths, index<section::Criterion::max_stress>},
     {"tsai_hill", "", has_strengths, index<section::Criterion::tsai_hill>},
     {"tsai_wu", "", has_strengths, index<section::Criterion::tsai_wu>},
     {"hashin", "", has_strengths, index<section::Criterion::hashin>},
     {"yield_index", "", yields,
      [](const section::MeshMaterial& m, const Vec6& s) {
        return section::von_mises(s) / *m.yield;
      }},
     {"von_mises", "Pa", any,
      [](const section::MeshMaterial&, const Vec6& s) { return section::von_mises(s); }},
     {"LL", "Pa", any, size_of<0>},
     {"TT", "Pa", any, size_of<1>},
     {"NN", "Pa", any, size_of<2>},
     {"TN", "Pa", any, size_of<3>},
     {"LN", "Pa", any, size_of<4>},
     {"LT", "Pa", any, size_of<5>}}};

struct Points {
  explicit Points(const section::StressField& f) : field(f) {
    f.each_node([this](int e, const section::Point& x, const section::Influence& influence) {
      element.push_back(e);
      at.push_back(x);
      stress.push_back(influence.stress);
    });
  }
  const section::MeshMaterial& material(std::size_t i) const {
    return field.mesh().material_of(element[i]);
  }
  // The largest of each measure, and where: no points for those that are of no material.
  struct Found {
    double value = -1.0;
    std::size_t point = 0;
  };
  std::array<Found, measures.size()> largest(const Vec6& resultants) const {
    std::array<Found, measures.size()> all{};
    for (std::size_t i = 0; i < stress.size(); ++i) {
      const Vec6 s = stress[i] * resultants;
      const section::MeshMaterial& m = material(i);
      for (std::size_t k = 0; k < measures.size(); ++k) {
        if (!measures[k].is_of(m)) continue;
        const double value = measures[k].value(m, s);
        if (value > all[k].value) all[k] = {value, i};
      }
    }
    return all;
  }

  const section::StressField& field;
  std::vector<int> element;
  std::vector<section::Point> at;
  std::vector<Mat6> stress;
};

std::string ply_of(const section::StressField& field, int e) {
  const section::Element& element = field.mesh().elements[static_cast<std::size_t>(e)];
  return element.name.empty() ? fmt::format("element {}", e + 1) : element.name;
}

std::string number(double x) { return x == 0.0 ? "0" : fmt::format("{:.6g}", x); }

std::string row_of(const Vec6& x) {
  std::string text;
  for (std::size_t i = 0; i < 6; ++i)
    text +=
        fmt::format("{}{} {}", i == 0 ? "" : ", ", components[i], number(x(static_cast<Index>(i))));
  return text;
}

Json json_of(const Vec6& x) {
  Json all = Json::object();
  for (std::size_t i = 0; i < 6; ++i) all[std::string(components[i])] = x(static_cast<Index>(i));
  return all;
}

}  // namespace

const SectionShape& shape_of_section(const Scene& scene, std::string& name,
                                     std::optional<double> station) {
  std::vector<std::string_view> names;
  for (const Section& section : scene.sections) names.push_back(section.name);
  if (names.empty()) throw Error(scene.source, "the model has no <section>");
  if (name.empty() && names.size() > 1)
    throw Error(scene.source, fmt::format("of which section? There are {}", list(names)));
  if (name.empty()) name = names.front();
  const auto section = std::ranges::find(scene.sections, name, &Section::name);
  if (section == scene.sections.end())
    throw Error(scene.source, fmt::format("there is no section {}{}", in_quotes(excerpt(name)),
                                          suggest(name, names, "sections")));
  const auto fail = [&](const std::string& what) -> void {
    throw Error(section->source, fmt::format("{}: {}", label(*section), what));
  };
  const std::string matrices =
      "it is stated by matrices, which know no stresses; state it by material and shape";
  if (section->stations.empty()) {
    if (station) fail("it has no stations; leave --station out");
    if (!section->shape) fail(matrices);
    return *section->shape;
  }
  std::string places;
  for (const Station& x : section->stations) {
    places += (places.empty() ? "" : ", ") + schema::shortest(x.at);
    if (!station || std::abs(x.at - *station) > 1e-12) continue;
    if (!x.shape) fail(fmt::format("at station {}: {}", schema::shortest(x.at), matrices));
    return *x.shape;
  }
  fail("it varies; give one of its stations (--station): " + places);
  throw Error("unreachable");
}

std::vector<std::string_view> stress_quantities() {
  std::vector<std::string_view> names;
  for (const Measure& measure : measures) names.push_back(measure.name);
  return names;
}

std::string_view stress_quantity_unit(std::string_view quantity) {
  return std::ranges::find(measures, quantity, &Measure::name)->unit;
}

std::optional<double> stress_quantity(std::string_view quantity,
                                      const section::MeshMaterial& material, const Vec6& stress) {
  const auto component = std::ranges::find(components, quantity);
  if (component != components.end()) return stress(component - components.begin());
  const auto measure = std::ranges::find(measures, quantity, &Measure::name);
  if (!measure->is_of(material)) return std::nullopt;
  return measure->value(material, stress);
}

StressReport describe_stress(const Scene& scene, const std::string& section,
                             std::optional<double> station, std::span<const SectionLoad> loads) {
  StressReport report;
  report.section = section;
  const SectionShape& shape = shape_of_section(scene, report.section, station);
  const StressFields fields = stress_fields(scene, shape, label("section", report.section));
  const Points points(*fields.fine), before(*fields.before);
  report.loads = loads.size();
  std::array<Points::Found, measures.size()> worst{};
  std::array<std::size_t, measures.size()> load_of{};
  for (std::size_t l = 0; l < loads.size(); ++l) {
    const auto found = points.largest(loads[l].resultants);
    if (loads[l].at) report.times.push_back(*loads[l].at);
    std::vector<double>& row = report.history.emplace_back();
    for (std::size_t k = 0; k < measures.size(); ++k) {
      if (found[k].value < 0.0) continue;
      row.push_back(found[k].value);
      if (l > 0 && found[k].value <= worst[k].value) continue;
      worst[k] = found[k];
      load_of[k] = l;
    }
  }
  for (std::size_t k = 0; k < measures.size(); ++k) {
    if (worst[k].value < 0.0 || loads.empty()) continue;
    const SectionLoad& load = loads[load_of[k]];
    const std::size_t i = worst[k].point;
    report.largest.push_back({std::string(measures[k].name),
                              std::string(measures[k].unit),
                              worst[k].value,
                              {points.at[i](0), points.at[i](1)},
                              ply_of(*fields.fine, points.element[i]),
                              load,
                              points.stress[i] * load.resultants,
                              before.largest(load.resultants)[k].value});
  }
  return report;
}

PointStress describe_point(const Scene& scene, const std::string& section,
                           std::optional<double> station, const SectionLoad& load,
                           const std::array<double, 2>& point) {
  std::string name = section;
  const SectionShape& shape = shape_of_section(scene, name, station);
  const std::string of = label("section", name);
  const auto field = stress_field(scene, shape, of);
  section::StressField::At at;
  try {
    at = field->recover(section::Point(point[0], point[1]));
  } catch (const Error& error) {
    throw Error(shape.source, of + ": " + error.what());
  }
  PointStress result{point,
                     ply_of(*field, at.element),
                     at.influence.axes,
                     at.influence.stress * load.resultants,
                     at.influence.strain * load.resultants,
                     {}};
  const section::MeshMaterial& material = field->mesh().material_of(at.element);
  for (const Measure& measure : measures)
    if (measure.unit.empty() && measure.is_of(material))
      result.indices.emplace_back(measure.name, measure.value(material, result.stress));
  return result;
}

std::string to_text(const StressReport& report) {
  std::string text = fmt::format("{}: ", label("section", report.section));
  text += report.loads == 1 ? "largest over the section\n"
                            : fmt::format("largest over the section and {} rows of {}\n",
                                          report.loads, report.at_name);
  bool singular = false;
  for (const StressReport::Largest& x : report.largest) {
    text += fmt::format("{:<12}{:>12} {:<3}at x2 = {}, x3 = {} m, {}", x.quantity, number(x.value),
                        x.unit, number(x.point[0]), number(x.point[1]), x.where);
    if (x.load.at) text += fmt::format(", {} {}", report.at_name, number(*x.load.at));
    // What is nothing beside the other stresses is round-off of them.
    if (x.unit.empty() || x.value > 1e-6 * x.stress.cwiseAbs().maxCoeff()) {
      constexpr double much = 0.05;
      const double change = x.value > 0.0 ? (x.value - x.before) / x.value : 0.0;
      // What is singular grows with each mesh; errors of a mesh where there is no stress become less.
      text += change > -much ? fmt::format(" ({:+.1e} of it since the mesh before)", change)
                             : fmt::format(" (with the mesh before {}: of the mesh, not resolved)",
                                           number(x.before));
      singular = singular || change > much;
    }
    text += "\n";
  }
  if (singular)
    text +=
        "Where 5 % and more has come since the mesh before, stresses are singular, as they are at "
        "sharp corners and\n"
        "where plies end at a free edge: such a value says nothing by itself; take stresses at a "
        "distance (--point).\n";
  return text;
}

std::string to_text(const PointStress& p) {
  std::string text =
      fmt::format("at x2 = {}, x3 = {} m, {}\n", number(p.point[0]), number(p.point[1]), p.where);
  text += fmt::format("{:<19}{} Pa\n", "stress", row_of(p.stress));
  text += fmt::format("{:<19}{}\n", "strain", row_of(p.strain));
  const auto cosine = [](double x) { return number(std::abs(x) < 1e-15 ? 0.0 : x); };
  for (const auto& [i, name] : {std::pair{0, "L"}, {1, "T"}, {2, "N"}})
    text += fmt::format("{:<19}{} {} {} along b1 b2 b3\n", name, cosine(p.axes(0, i)),
                        cosine(p.axes(1, i)), cosine(p.axes(2, i)));
  for (const auto& [name, value] : p.indices)
    text += fmt::format("{:<19}{}\n", name, number(value));
  return text;
}

std::string to_json(const StressReport& report) {
  Json all{{"section", report.section}, {"loads", report.loads}};
  Json list = Json::array();
  for (const StressReport::Largest& x : report.largest) {
    Json one{{"quantity", x.quantity}, {"value", x.value}};
    if (!x.unit.empty()) one["unit"] = x.unit;
    one["point"] = x.point;
    one["where"] = x.where;
    if (x.load.at) one[report.at_name] = *x.load.at;
    one["stress"] = json_of(x.stress);
    one["mesh_before"] = x.before;
    list.push_back(std::move(one));
  }
  all["largest"] = std::move(list);
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_json(const PointStress& p) {
  Json all{{"point", p.point}, {"where", p.where}};
  all["stress"] = json_of(p.stress);
  all["strain"] = json_of(p.strain);
  for (const auto& [i, name] : {std::pair<Index, const char*>{0, "L"}, {1, "T"}, {2, "N"}})
    all["axes"][name] = {p.axes(0, i), p.axes(1, i), p.axes(2, i)};
  for (const auto& [name, value] : p.indices) all[name] = value;
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_csv(const StressReport& report) {
  std::string text = report.at_name.empty() ? "load" : report.at_name;
  for (const StressReport::Largest& x : report.largest) text += "," + x.quantity;
  text += "\n";
  for (std::size_t l = 0; l < report.history.size(); ++l) {
    text += report.times.empty() ? std::to_string(l + 1) : schema::shortest(report.times[l]);
    for (const double value : report.history[l]) text += "," + schema::shortest(value);
    text += "\n";
  }
  return text;
}

}  // namespace mbd
