#include "libmbd/run/section_accuracy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "libmbd/language/schema.hpp"
#include "libmbd/material/shaped_sections.hpp"
#include "libmbd/results/build_facts.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/reading_limits.hpp"
#include "libmbd/text/spelling.hpp"
#include "libmbd/text/tables.hpp"

namespace mbd {
namespace {

using Json = nlohmann::ordered_json;
using Trial = SectionAccuracy::Trial;

struct Tried {
  Trial trial;
  Mat6 D;
};

Mat6 scale_of(const Mat6& D) {
  const Vec6 root = D.diagonal().cwiseSqrt();
  return root * root.transpose();
}
double largest(const Mat6& of, const Mat6& scale) {
  return (of.array() / scale.array()).abs().maxCoeff();
}

Tried attempt(const section::Mesher& mesher, const Vec3& curvature,
              const section::Fineness& fineness) {
  const double start = used_cpu();
  const section::Mesh mesh = mesher(fineness);
  Tried made{{fineness.order, fineness.layers, static_cast<int>(mesh.elements.size()),
              3 * static_cast<int>(mesh.nodes.size()), 0.0, 0.0, std::nullopt},
             section::analyse(mesh, curvature).stiffness};
  made.trial.seconds = used_cpu() - start;
  return made;
}

// As the program refines, and what it would say of the error.
std::vector<Tried> as_the_program(const section::Mesher& mesher, const Vec3& curvature,
                                  bool of_one_mesh, double until) {
  constexpr double enough = 1e-8;
  std::vector<Tried> all;
  Mat6 before = Mat6::Zero(), change = before;
  const std::size_t first = of_one_mesh ? 1 : 2;  // with an estimate
  for (const section::Fineness& fineness : section::levels_of(of_one_mesh)) {
    if (all.size() > first) {
      // Four times the time of the mesh before is what the next one may cost.
      if (used_cpu() + 4.0 * all.back().trial.seconds > until) break;
      const auto unknowns = 3 * static_cast<int>(mesher(fineness).nodes.size());
      if (unknowns > reading_limits().section_unknowns) break;
    }
    all.push_back(attempt(mesher, curvature, fineness));
    const Mat6 now = (all.back().D - before).cwiseAbs();
    if (all.size() > first) {
      const Mat6 error = section::error_of(all.back().D, now, all.size() > 2 ? change : now);
      all.back().trial.believed = largest(error, scale_of(all.back().D));
      if (*all.back().trial.believed < enough) break;
    }
    before = all.back().D;
    change = now;
  }
  return all;
}

void set_goals(SectionAccuracy& report) {
  const double known = 3.0 * report.trials.back().believed.value_or(0.0);
  for (int power = 2; power <= 6; ++power) {
    SectionAccuracy::Goal goal{std::pow(10.0, -power), std::nullopt};
    for (std::size_t i = 0; i < report.trials.size(); ++i) {
      const Trial& trial = report.trials[i];
      // What the finest cannot tell is not said of others; of itself it is what is believed.
      const double error = std::max(trial.error, i + 1 == report.trials.size() ? known / 3.0 : 0.0);
      if (!(error <= goal.error) || known > goal.error) continue;
      if (!goal.cheapest || trial.seconds < report.trials[*goal.cheapest].seconds)
        goal.cheapest = i;
    }
    report.goals.push_back(goal);
  }
}

SectionAccuracy accuracy_of(const Scene& scene, const std::string& name, const SectionShape& shape,
                            double budget) {
  SectionAccuracy report;
  report.section = name;
  report.from = std::string(element_of(shape));
  if (shape.source.line > 0)
    report.from += fmt::format(", {}:{}", shape.source.file, shape.source.line);
  const section::Mesher mesher = mesher_of(scene, shape, label("section", name));
  const bool of_one_mesh = SectionShape::is_mesh(shape);
  const double start = used_cpu();
  std::vector<Tried> all =
      as_the_program(mesher, shape.curvature, of_one_mesh, start + 0.5 * budget);
  const Tried finest = all.back();
  all.pop_back();
  std::vector<section::Fineness> others;
  for (int order = 1; order <= 8 && !of_one_mesh; ++order)
    for (int layers = 1; layers <= 6; ++layers)
      if (std::ranges::none_of(all, [&](const Tried& t) {
            return t.trial.order == order && t.trial.layers == layers;
          }))
        others.push_back({order, layers});
  std::vector<std::pair<int, section::Fineness>> by_size;
  for (const section::Fineness& fineness : others)
    by_size.emplace_back(3 * static_cast<int>(mesher(fineness).nodes.size()), fineness);
  std::ranges::stable_sort(by_size, {}, [](const auto& x) { return x.first; });
  for (const auto& [unknowns, fineness] : by_size) {
    if (unknowns >= finest.trial.unknowns) continue;
    if (used_cpu() - start > budget)
      ++report.not_tried;
    else
      all.push_back(attempt(mesher, shape.curvature, fineness));
  }
  std::ranges::stable_sort(all, {}, [](const Tried& t) { return t.trial.unknowns; });
  all.push_back(finest);
  const Mat6 scale = scale_of(finest.D);
  for (const Tried& tried : all) {
    report.trials.push_back(tried.trial);
    report.trials.back().error = largest(tried.D - finest.D, scale);
  }
  set_goals(report);
  return report;
}

std::string name_of(const Trial& t) {
  return fmt::format("order {}, layers {}", t.order, t.layers);
}

}  // namespace

std::vector<SectionAccuracy> section_accuracy(const Scene& scene, const std::string& name,
                                              double budget) {
  std::vector<SectionAccuracy> reports;
  std::vector<std::string_view> names;
  bool found = false;
  for (const Section& section : scene.sections) {
    names.push_back(section.name);
    if (!name.empty() && section.name != name) continue;
    found = true;
    if (section.shape) reports.push_back(accuracy_of(scene, section.name, *section.shape, budget));
    for (const Station& station : section.stations) {
      if (!station.shape) continue;
      reports.push_back(accuracy_of(scene, section.name, *station.shape, budget));
      reports.back().at = station.at;
    }
  }
  if (!found && !name.empty())
    throw Error(scene.source, fmt::format("there is no section {}{}", in_quotes(excerpt(name)),
                                          suggest(name, names, "sections")));
  if (reports.empty())
    throw Error(scene.source,
                name.empty()
                    ? std::string("the model has no section by shape and material, whose D is "
                                  "computed")
                    : fmt::format("section {} is given by its matrices; accuracy is of sections by "
                                  "shape and material, whose D is computed",
                                  in_quotes(name)));
  return reports;
}

std::string to_text(const SectionAccuracy& r) {
  std::string text = label("section", r.section);
  if (r.at) text += fmt::format(", station at {}", schema::shortest(*r.at));
  const Trial& finest = r.trials.back();
  text += fmt::format(": {}\nLargest error of an entry ij of D, over sqrt(Dii Djj), against {}",
                      r.from, name_of(finest));
  text += finest.believed ? fmt::format(", which is believed to be {:.0e} off\n", *finest.believed)
                          : std::string("\n");
  std::vector<std::vector<std::string>> rows{
      {"order", "layers", "elements", "unknowns", "seconds", "error", "believed"}};
  for (std::size_t i = 0; i < r.trials.size(); ++i) {
    const Trial& t = r.trials[i];
    rows.push_back({std::to_string(t.order), std::to_string(t.layers), std::to_string(t.elements),
                    std::to_string(t.unknowns), fmt::format("{:.2g}", t.seconds),
                    i + 1 == r.trials.size() ? "-" : fmt::format("{:.1e}", t.error),
                    t.believed ? fmt::format("{:.0e}", *t.believed) : "-"});
  }
  study::table(text, rows);
  text += "The cheapest for\n";
  for (const SectionAccuracy::Goal& goal : r.goals) {
    text += fmt::format("  {:.0e}: ", goal.error);
    if (!goal.cheapest) {
      text += "none here\n";
      continue;
    }
    const Trial& t = r.trials[*goal.cheapest];
    text += fmt::format("{}, {} unknowns, {:.2g} s\n", name_of(t), t.unknowns, t.seconds);
  }
  if (r.not_tried > 0)
    text += fmt::format("{} more were not tried for want of time; give a larger --budget\n",
                        r.not_tried);
  return text;
}

std::string to_json(const std::vector<SectionAccuracy>& reports) {
  Json all = Json::array();
  const auto json_of = [](const Trial& t) {
    Json one{{"order", t.order},       {"layers", t.layers},   {"elements", t.elements},
             {"unknowns", t.unknowns}, {"seconds", t.seconds}, {"error", t.error}};
    if (t.believed) one["believed"] = *t.believed;
    return one;
  };
  for (const SectionAccuracy& r : reports) {
    Json one{{"section", r.section}};
    if (r.at) one["at"] = *r.at;
    one["from"] = r.from;
    one["trials"] = Json::array();
    for (const Trial& t : r.trials) one["trials"].push_back(json_of(t));
    one["cheapest"] = Json::array();
    for (const SectionAccuracy::Goal& goal : r.goals) {
      Json of{{"for", goal.error}};
      if (goal.cheapest) of["trial"] = *goal.cheapest;
      one["cheapest"].push_back(std::move(of));
    }
    one["not_tried"] = r.not_tried;
    all.push_back(std::move(one));
  }
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_csv(const std::vector<SectionAccuracy>& reports) {
  std::string text = "section,at,order,layers,elements,unknowns,seconds,error,believed\n";
  for (const SectionAccuracy& r : reports)
    for (const Trial& t : r.trials)
      text += fmt::format("{},{},{},{},{},{},{},{},{}\n", study::csv_cell(r.section),
                          r.at ? schema::shortest(*r.at) : "", t.order, t.layers, t.elements,
                          t.unknowns, schema::shortest(t.seconds), schema::shortest(t.error),
                          t.believed ? schema::shortest(*t.believed) : "");
  return text;
}

}  // namespace mbd
