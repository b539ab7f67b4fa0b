#include "libmbd/study/accuracy/accuracy_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <string_view>

#include "libmbd/pictures/page.hpp"
#include "libmbd/pictures/plot.hpp"
#include "libmbd/study/accuracy/accuracy_words.hpp"

namespace mbd::study_page {
namespace {

using namespace study;
using Json = nlohmann::ordered_json;

// --- pictures ---

// Of plot.hpp's styles: as many families can be told from each other.
constexpr std::size_t styles = 6;

// Where the error is drawn. One that is exactly zero is drawn as large as the reference's own.
std::optional<double> height_of(const AccuracyStudy& study, std::size_t point, std::size_t q) {
  if (!known(study, point, q)) return std::nullopt;
  const double rms = study.points[point].errors[q].rms;
  const double height = rms > 0.0 ? rms : study.quantities[q].reference_rms;
  if (!(height > 0.0) || !std::isfinite(height)) return std::nullopt;
  return height;
}

// Which families have a style and a name: all, if there are not more than styles; else those with the most `merit`.
// Entries: the style, or -1.
std::vector<int> styles_of(const std::vector<double>& merit) {
  std::vector<std::size_t> order(merit.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (merit.size() > styles) {
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return merit[a] > merit[b]; });
    order.resize(styles);
    std::erase_if(order, [&](std::size_t i) { return !(merit[i] > 0.0); });
    std::sort(order.begin(), order.end());
  }
  std::vector<int> result(merit.size(), -1);
  for (std::size_t i = 0; i < order.size(); ++i) result[order[i]] = static_cast<int>(i);
  return result;
}

std::string title_of(const AccuracyStudy& study, const Quantity& quantity) {
  const std::string until = until_text(study, quantity);
  return quantity.name + (until.empty() ? "" : ", " + until);
}

// Adds a curve of each family; those without a style pale, with one name for all.
void add_families(plot::Panel& panel, const AccuracyStudy& study, std::size_t q,
                  const std::vector<Family>& families, const std::vector<int>& style,
                  const std::function<std::optional<double>(std::size_t)>& x) {
  bool named = false;
  for (std::size_t f = 0; f < families.size(); ++f) {
    plot::Curve curve;
    curve.pale = style[f] < 0;
    curve.style = style[f];
    for (const std::size_t point : families[f].points) {
      const std::optional<double> height = height_of(study, point, q), at = x(point);
      if (!height || !at) continue;
      curve.trace.add({*at, *height});
      curve.hollow.push_back(study.points[point].errors[q].below_reference);
    }
    if (curve.hollow.empty()) continue;
    if (!curve.pale) curve.label = families[f].label.empty() ? "runs" : families[f].label;
    if (curve.pale && !named) {
      curve.label = "other settings";
      named = true;
    }
    panel.curves.push_back(std::move(curve));
  }
}

// The reference's own error is drawn where it does not press the curves together.
void add_level(plot::Panel& panel, const Quantity& quantity) {
  constexpr double nearest = 30.0;
  double least = std::numeric_limits<double>::infinity();
  for (const plot::Curve& curve : panel.curves)
    for (const plot::Point& p : curve.trace.points()) least = std::min(least, p[1]);
  if (quantity.reference_rms > 0.0 && quantity.reference_rms * nearest >= least)
    panel.levels.push_back(
        {quantity.reference_rms, "reference's own error " + bound_text(quantity.reference_rms)});
}

bool resolved(const Quantity& quantity) { return quantity.until > 0.0; }

// Error over CPU time, a panel for each quantity that has errors; and which quantity each is of.
std::vector<plot::Panel> cost_panels(const AccuracyStudy& study, std::vector<std::size_t>& of) {
  const std::vector<Family> families = families_of(study);
  std::vector<double> merit(families.size());
  for (std::size_t f = 0; f < families.size(); ++f)
    for (std::size_t q = 0; q < study.quantities.size(); ++q)
      for (const std::size_t point : families[f].points)
        merit[f] += on_front(study, point, q) ? 1.0 : 0.0;
  const std::vector<int> style = styles_of(merit);
  std::vector<plot::Panel> panels;
  for (std::size_t q = 0; q < study.quantities.size(); ++q) {
    if (!resolved(study.quantities[q])) continue;
    plot::Panel panel{.title = title_of(study, study.quantities[q]),
                      .x_label = "CPU time of the whole run [s]",
                      .y_label = "error (rms)",
                      .x_log = true,
                      .y_log = true};
    add_families(panel, study, q, families, style, [&](std::size_t point) -> std::optional<double> {
      const double cpu = study.points[point].trial.cpu;
      return cpu > 0.0 ? std::optional(cpu) : std::nullopt;
    });
    if (panel.curves.empty()) continue;
    plot::Curve front;
    front.label = "cheapest for its error";
    front.style = 0;
    front.wide = front.plain = true;
    if (q < study.fronts.size())
      for (const std::size_t point : study.fronts[q])
        if (const std::optional<double> height = height_of(study, point, q))
          front.trace.add({study.points[point].trial.cpu, *height});
    if (front.trace.points().size() > 1) panel.curves.push_back(std::move(front));
    std::stable_partition(panel.curves.begin(), panel.curves.end(),
                          [](const plot::Curve& c) { return !c.pale; });
    add_level(panel, study.quantities[q]);
    panels.push_back(std::move(panel));
    of.push_back(q);
  }
  return panels;
}

// A triangle below the fitted line, between two neighbouring points near its middle. The picture spans `width` and
// `decades` powers of ten.
std::optional<plot::Slope> slope_of(const AccuracyStudy& study, const OrderFit& fit, double width,
                                    double decades) {
  std::vector<double> x;
  double log_x = 0.0, log_y = 0.0;
  for (const std::size_t point : fit.points) {
    const std::optional<double> at = number_of(study.points[point].setting, fit.knob);
    const std::optional<double> height = height_of(study, point, fit.quantity);
    if (!at || !height) return std::nullopt;
    x.push_back(*at);
    log_x += std::log10(*at);
    log_y += std::log10(*height);
  }
  std::sort(x.begin(), x.end());
  x.erase(std::unique(x.begin(), x.end()), x.end());
  if (x.size() < 2 || !std::isfinite(fit.slope)) return std::nullopt;
  const auto n = static_cast<double>(fit.points.size());
  const double below = 0.05 * decades;
  const auto line = [&](double at) {
    return std::pow(10.0, (log_y - fit.slope * log_x) / n + fit.slope * std::log10(at) - below);
  };
  const std::size_t i = (x.size() - 2) / 2;
  // Its width: half of what lies between the points, or less.
  const double middle = std::sqrt(x[i] * x[i + 1]);
  const double ratio = std::min(std::sqrt(x[i + 1] / x[i]), std::pow(10.0, 0.15 * width));
  std::string text = fmt::format("{:.2f}", fit.slope);
  if (fit.theory) text += fmt::format(" ({:g})", *fit.theory);
  for (std::size_t at = text.find('-'); at != std::string::npos; at = text.find('-', at))
    text.replace(at, 1, "−");
  const double left = middle / std::sqrt(ratio), right = middle * std::sqrt(ratio);
  return plot::Slope{{left, line(left)}, {right, line(right)}, std::move(text)};
}

// One triangle for each theoretical order, three at most: more would hide the curves.
void add_slopes(plot::Panel& panel, const AccuracyStudy& study, Knob knob, std::size_t q,
                const std::vector<Family>& families, const std::vector<int>& style) {
  constexpr std::size_t most = 3;
  constexpr double infinite = std::numeric_limits<double>::infinity();
  plot::Point least = {infinite, infinite}, greatest = {0.0, 0.0};
  for (const plot::Curve& curve : panel.curves)
    for (const plot::Point& p : curve.trace.points())
      for (const std::size_t axis : {0u, 1u}) {
        least[axis] = std::min(least[axis], p[axis]);
        greatest[axis] = std::max(greatest[axis], p[axis]);
      }
  const double width = std::log10(greatest[0] / least[0]);
  const double decades = std::log10(greatest[1] / least[1]);
  std::vector<double> shown;
  for (const OrderFit& fit : study.fits) {
    if (fit.knob != knob || fit.quantity != q || shown.size() == most) continue;
    bool drawn = false;
    for (std::size_t f = 0; f < families.size(); ++f) {
      const std::vector<std::size_t>& all = families[f].points;
      drawn = drawn || (style[f] >= 0 &&
                        std::all_of(fit.points.begin(), fit.points.end(), [&](std::size_t p) {
                          return std::find(all.begin(), all.end(), p) != all.end();
                        }));
    }
    const double order = fit.theory.value_or(std::round(fit.slope));
    if (!drawn || std::find(shown.begin(), shown.end(), order) != shown.end()) continue;
    if (std::optional<plot::Slope> slope = slope_of(study, fit, width, decades)) {
      panel.slopes.push_back(std::move(*slope));
      shown.push_back(order);
    }
  }
}

std::vector<plot::Panel> knob_panels(const AccuracyStudy& study) {
  std::vector<plot::Panel> panels;
  for (const Knob knob : numeric_knobs(study))
    for (std::size_t q = 0; q < study.quantities.size(); ++q) {
      if (!resolved(study.quantities[q])) continue;
      const std::string name(name_of(knob));
      const bool rises = knob == Knob::step || knob == Knob::tolerance;  // the error with it
      plot::Panel panel{.title = study.quantities[q].name + " over " + name,
                        .x_label = knob == Knob::step       ? "step [s]"
                                   : knob == Knob::elements ? "elements"
                                                            : name,
                        .y_label = "error (rms)",
                        .x_log = knob != Knob::order,
                        .y_log = true};
      const std::vector<Family> families = families_over(study, knob, q);
      std::vector<double> merit;  // the more a curve shows, the more it is worth a name
      for (const Family& family : families)
        merit.push_back(static_cast<double>(
            std::count_if(family.points.begin(), family.points.end(),
                          [&](std::size_t p) { return height_of(study, p, q).has_value(); })));
      const std::vector<int> style = styles_of(merit);
      add_families(panel, study, q, families, style,
                   [&](std::size_t point) { return number_of(study.points[point].setting, knob); });
      if (panel.curves.empty()) continue;
      add_level(panel, study.quantities[q]);
      add_slopes(panel, study, knob, q, families, style);
      if (!rises) {
        std::set<double> values;
        for (const TrialPoint& point : study.points)
          if (const std::optional<double> value = number_of(point.setting, knob))
            values.insert(*value);
        panel.x_ticks.assign(values.begin(), values.end());
      }
      panels.push_back(std::move(panel));
    }
  return panels;
}

// What a picture does not show.
std::string missing_text(const AccuracyStudy& study) {
  const Tally tally = tally_of(study);
  std::string text = "Hollow: not well above the reference's own error.";
  if (tally.stopped + tally.failed > 0)
    text += fmt::format(" Not shown: runs that were stopped ({}) or failed ({}).", tally.stopped,
                        tally.failed);
  return text;
}

constexpr std::string_view slopes_text =
    "Triangles: fitted order (in theory, where the solution is smooth).";

std::string cost_svg(const AccuracyStudy& study) {
  std::vector<std::size_t> of;
  return plot::to_svg(cost_panels(study, of), {.note = missing_text(study),
                                               .title = study.model + ": error against CPU time"});
}

std::string knob_svg(const AccuracyStudy& study) {
  return plot::to_svg(
      knob_panels(study),
      {.note = fmt::format("{} {}", slopes_text, missing_text(study)),
       .title = study.model + ": error against each setting, the others at their finest"});
}

// --- page ---

// The picture of one panel for a page, with what it is for those who do not see it.
std::string figure(const plot::Panel& panel, const std::string& ids, const std::string& label) {
  return plot::to_svg({&panel, 1}, {.ids = ids, .label = label});
}

std::string times_text(double ratio) {
  if (!std::isfinite(ratio)) return "-";
  return ratio >= 9.95 ? fmt::format("{:.0f}", ratio) : fmt::format("{:.1f}", ratio);
}

std::string setting_text(const TrialPoint& point) {
  return point.text.empty() ? "as the model is" : point.text;
}

// After the name of the quantity: " to 1e-2: 0.12 s of CPU time (order 2 …); to 1e-4: 0.9 s, 7.5 times as long
// (order 3 …)." The coarsest, that nearest to 1e-4, and the finest.
std::string answer(const AccuracyStudy& study, std::size_t q) {
  const Quantity& quantity = study.quantities[q];
  if (!resolved(quantity))
    return ": no accuracy can be told, since refinements do not approach each other.";
  const std::vector<Range> ranges = ranges_of(study, q);
  if (ranges.empty()) return ": no power of ten was reached.";
  const auto from_usual = [](const Range& r) { return std::abs(std::log10(r.to) + 4.0); };
  const auto usual =
      static_cast<std::size_t>(std::min_element(ranges.begin(), ranges.end(),
                                                [&](const Range& a, const Range& b) {
                                                  return from_usual(a) < from_usual(b);
                                                }) -
                               ranges.begin());
  const std::string until = until_text(study, quantity);
  std::string text = until.empty() ? "" : " (" + until + ")";
  const double first = study.points[ranges.front().point].trial.cpu;
  for (const std::size_t i : std::set<std::size_t>{0, usual, ranges.size() - 1}) {
    const TrialPoint& point = study.points[ranges[i].point];
    text += fmt::format("{} to {}: {} s", i == 0 ? "" : ";", number_text(ranges[i].to, 1),
                        seconds_text(point.trial.cpu));
    text += i == 0 ? " of CPU time"
                   : fmt::format(", {} times as long", times_text(point.trial.cpu / first));
    text += fmt::format(" ({})", setting_text(point));
  }
  return text + ".";
}

Json answers(const AccuracyStudy& study) {
  Json all = Json::array();
  for (std::size_t q = 0; q < study.quantities.size(); ++q)
    all.push_back({{"quantity", study.quantities[q].name}, {"text", answer(study, q)}});
  return all;
}

// What to take for which accuracy: for each quantity its rows, or why there are none.
Json choices(const AccuracyStudy& study, const Scene& scene) {
  Json all = Json::array();
  for (std::size_t q = 0; q < study.quantities.size(); ++q) {
    const std::vector<Range> ranges = ranges_of(study, q);
    Json rows = Json::array();
    for (const Range& range : ranges) {
      const TrialPoint& point = study.points[range.point];
      const std::string change = snippet(scene, point.setting);
      const double least = study.points[ranges.front().point].trial.cpu;
      rows.push_back({{"to", text_of(range)},
                      {"error", rms_text(study, range.point, q)},
                      {"cpu", seconds_text(point.trial.cpu)},
                      {"ratio", times_text(point.trial.cpu / least)},
                      {"run", range.point + 1},
                      {"setting", setting_text(point)},
                      {"change", change.empty() ? "the model as it is" : change}});
    }
    if (ranges.empty())
      all.push_back({{"quantity", study.quantities[q].name},
                     {"why", resolved(study.quantities[q])
                                 ? "No run reached a power of ten."
                                 : "Refinements do not approach each other: there is nothing to "
                                   "measure errors by."},
                     {"rows", rows}});
    else
      all.push_back({{"quantity", title_of(study, study.quantities[q])}, {"rows", rows}});
  }
  return all;
}

void add_pictures(Json& data, const AccuracyStudy& study) {
  std::vector<std::size_t> of;
  const std::vector<plot::Panel> cost = cost_panels(study, of), over = knob_panels(study);
  Json costs = Json::array(), knobs = Json::array();
  for (std::size_t i = 0; i < cost.size(); ++i)
    costs.push_back(figure(cost[i], fmt::format("cost-{}-", i),
                           "Error against CPU time: " + study.quantities[of[i]].name));
  bool slopes = false;
  for (std::size_t i = 0; i < over.size(); ++i) {
    knobs.push_back(figure(over[i], fmt::format("knob-{}-", i), "Error: " + over[i].title));
    slopes = slopes || !over[i].slopes.empty();
  }
  data["cost"] = std::move(costs);
  data["knobs"] = std::move(knobs);
  data["slopes"] = slopes;
  data["missing"] = missing_text(study);
}

Json orders(const AccuracyStudy& study) {
  std::vector<OrderFit> fits = study.fits;
  std::stable_sort(fits.begin(), fits.end(), [](const OrderFit& one, const OrderFit& other) {
    return one.quantity < other.quantity;
  });
  Json all = Json::array();
  for (const OrderFit& fit : fits)
    all.push_back({{"quantity", study.quantities[fit.quantity].name},
                   {"over", name_of(fit.knob)},
                   {"order", fmt::format("{:.2f}", fit.slope)},
                   {"theory", fit.theory ? fmt::format("{:g}", *fit.theory) : "-"},
                   {"departure", fmt::format("{:.2f}", fit.spread)},
                   {"points", fit.points.size()},
                   {"of", family_text(study, fit)}});
  return all;
}

Json reference(const AccuracyStudy& study) {
  Json errors = Json::array(), ways = Json::array();
  for (const Quantity& q : study.quantities) {
    const std::string until = until_text(study, q);
    const bool has = resolved(q);
    errors.push_back({{"quantity", q.name},
                      {"rms", has ? reference_text(q, &Quantity::reference_rms) : "-"},
                      {"largest", has ? reference_text(q, &Quantity::reference_largest) : "-"},
                      {"scale", has ? fmt::format("{:.4g} {}", q.scale, q.unit) : "-"},
                      {"known", until.empty() ? "to the end" : until}});
  }
  for (const TrialPoint& way : study.ways)
    ways.push_back({{"setting", way.text},
                    {"cpu", seconds_text(way.trial.cpu)},
                    {"state", state_text(way.trial)}});
  return {{"text", study.reference}, {"errors", std::move(errors)}, {"ways", std::move(ways)}};
}

Json caveats(const AccuracyStudy& study) {
  Json all = Json::array();
  for (const Quantity& q : study.quantities) {
    const std::string until = until_text(study, q);
    if (until.empty()) continue;
    all.push_back(fmt::format(
        "{}: successive refinements approach each other {}{}; its errors are {}.", q.name, until,
        resolved(q) ? ", no further" : "", resolved(q) ? "those up to there" : "not known"));
  }
  if (study.untried > 0)
    all.push_back(
        fmt::format("{} settings were not tried, for want of time or because the study was "
                    "interrupted.",
                    study.untried));
  for (const std::string& note : study.notes) all.push_back(note);
  return all;
}

// Runs that did not come to the end.
Json ends(const AccuracyStudy& study) {
  Json all = Json::array();
  for (std::size_t i = 0; i < study.points.size(); ++i)
    if (const Trial& trial = study.points[i].trial; !trial.complete)
      all.push_back({{"run", i + 1},
                     {"setting", setting_text(study.points[i])},
                     {"cpu", seconds_text(trial.cpu)},
                     {"state", state_text(trial)}});
  return all;
}

Json run(const AccuracyStudy& study, std::size_t i, const std::vector<std::size_t>& shown) {
  const Trial& trial = study.points[i].trial;
  bool front = false;
  for (std::size_t q = 0; q < study.quantities.size(); ++q) front = front || on_front(study, i, q);
  Json errors = Json::array();
  for (const std::size_t q : shown)
    errors.push_back({{"rms", rms_text(study, i, q)},
                      {"largest", largest_text(study, i, q)},
                      {"front", on_front(study, i, q)}});
  return {{"run", i + 1},
          {"front", front},
          {"setting", setting_text(study.points[i])},
          {"state", trial.complete  ? "complete"
                    : trial.stopped ? "stopped"
                                    : "failed"},
          {"cpu", seconds_text(trial.cpu)},
          {"stepping", seconds_text(trial.cpu_stepping)},
          {"errors", std::move(errors)},
          {"steps", trial.counters.steps},
          {"residuals", trial.counters.residuals},
          {"tangents", trial.counters.tangents},
          {"factorizations", trial.counters.factorizations},
          {"unknowns", trial.unknowns},
          {"memory", fmt::format("{:.0f}", trial.memory * 1e-6)}};
}

void add_runs(Json& data, const AccuracyStudy& study) {
  std::vector<std::size_t> shown;  // quantities
  Json names = Json::array(), all = Json::array();
  for (std::size_t q = 0; q < study.quantities.size(); ++q)
    if (resolved(study.quantities[q])) {
      shown.push_back(q);
      names.push_back(study.quantities[q].name);
    }
  for (std::size_t i = 0; i < study.points.size(); ++i) all.push_back(run(study, i, shown));
  data["quantities"] = std::move(names);
  data["runs"] = std::move(all);
  data["tally"] = tally_text(study);
}

Json facts(const AccuracyStudy& study) {
  Json all = Json::array();
  const auto fact = [&](const std::string& name, const std::string& value) {
    all.push_back(Json::array({name, value}));
  };
  fact("model", study.file);
  fact("date", study.date);
  fact("machine", study.machine);
  for (const auto& [name, value] : study.build) fact(name, value);
  fact("wall time",
       fmt::format("{} s of {} s", seconds_text(study.seconds), seconds_text(study.budget)));
  return all;
}

// What the page shows (libmbd/pictures/page/accuracy.html).
Json data_of(const AccuracyStudy& study, const Scene& scene) {
  Json data = Json::object();
  data["by"] = fmt::format("{}, {}. {}, in {} s.", study.file, study.date, tally_text(study),
                           seconds_text(study.seconds));
  data["answers"] = answers(study);
  data["choices"] = choices(study, scene);
  data["norm"] = norm_text(study);
  add_pictures(data, study);
  data["orders"] = orders(study);
  data["reference"] = reference(study);
  data["caveats"] = caveats(study);
  data["ends"] = ends(study);
  data["has_caveats"] = !data["caveats"].empty() || !data["ends"].empty();
  add_runs(data, study);
  data["facts"] = facts(study);
  data["command"] = study.command;
  return data;
}

std::string page(const AccuracyStudy& study, const Scene& scene) {
  return filled_page(page_files().accuracy, page_files().accuracy_script,
                     study.model + ": error against CPU time",
                     data_of(study, scene).dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace
}  // namespace mbd::study_page

namespace mbd {

std::string accuracy_svg(const AccuracyStudy& study) { return study_page::cost_svg(study); }
std::string knobs_svg(const AccuracyStudy& study) { return study_page::knob_svg(study); }
std::string accuracy_page(const AccuracyStudy& study, const Scene& scene) {
  return study_page::page(study, scene);
}

}  // namespace mbd
