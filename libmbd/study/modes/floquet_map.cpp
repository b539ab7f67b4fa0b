#include "libmbd/study/modes/floquet_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string_view>

#include "libmbd/core/stop.hpp"
#include "libmbd/pictures/plot.hpp"
#include "libmbd/text/tables.hpp"

namespace mbd {
namespace {

constexpr std::size_t failures_shown = 3;

double hertz(double rate) { return rate / (2.0 * std::numbers::pi); }

constexpr std::array<std::string_view, 5> verdicts{"stable", "neutral", "unstable", "failed",
                                                   "open"};

constexpr std::string_view undecided = "undecided";

std::string_view verdict_of(const FloquetMap::Point& point) {
  if (point.study && !point.study->undecided.empty() &&
      point.study->stability() == Stability::neutral)
    return undecided;
  if (point.study) return verdicts[static_cast<std::size_t>(point.study->stability())];
  return point.failure.empty() ? "open" : "failed";
}

// Parameters that take more than one value.
std::vector<std::size_t> varied(const SweepPlan& plan) {
  std::vector<std::size_t> all;
  for (std::size_t p = 0; p < plan.parameters.size(); ++p) {
    std::set<std::string> values;
    for (const std::vector<std::string>& point : plan.points) values.insert(point[p]);
    if (values.size() > 1) all.push_back(p);
  }
  return all;
}

std::string title_of(const SweepPlan& plan, std::size_t parameter) {
  const std::string unit = plan.unit(parameter);
  return plan.parameters[parameter] + (unit.empty() ? "" : " [" + unit + "]");
}

plot::Curve points_of(std::string label, int style) {
  plot::Curve curve;
  curve.label = std::move(label);
  curve.points_only = true;
  curve.style = style;
  return curve;
}

// [Hz] Up to where frequencies are drawn: what three of four points know. How high that is depends on the point, as
// harmonics of its period do.
double highest_drawn(const FloquetMap& map) {
  std::vector<double> highest;
  for (const FloquetMap::Point& point : map.points) {
    if (!point.study || point.study->modes.empty()) continue;
    highest.push_back(0.0);
    for (const NamedFloquetMode& mode : point.study->modes)
      highest.back() = std::max(highest.back(), hertz(mode.inertial));
  }
  if (highest.empty()) return 0.0;
  constexpr double margin = 1.2;
  const std::size_t quarter = highest.size() / 4;
  std::ranges::nth_element(highest, highest.begin() + static_cast<std::ptrdiff_t>(quarter));
  return margin * highest[quarter];
}

plot::Panel frequencies_over(const FloquetMap& map, const std::vector<double>& values) {
  plot::Panel panel;
  panel.title = "Frequencies of small motions, inertial axes";
  panel.y_label = "the lowest [Hz]";
  const double most = highest_drawn(map);
  plot::Curve modes = points_of("", 0), once;
  once.label = "once per period";
  once.pale = once.plain = true;
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    const std::optional<FloquetStudy>& study = map.points[i].study;
    if (!study) continue;
    for (const NamedFloquetMode& mode : study->modes)
      if (hertz(mode.inertial) <= most) modes.trace.add({values[i], hertz(mode.inertial)});
    if (1.0 / study->period <= most) once.trace.add({values[i], 1.0 / study->period});
  }
  panel.curves.push_back(std::move(modes));
  if (once.trace.points().size() > 1) panel.curves.push_back(std::move(once));
  return panel;
}

std::string over_one(const FloquetMap& map, std::size_t parameter,
                     const std::vector<double>& values) {
  plot::Panel growth, frequencies = frequencies_over(map, values);
  growth.title = "Growth of small motions over a period (above 0: unstable)";
  growth.y_label = "Re l T";
  plot::Curve largest;
  for (std::size_t i = 0; i < map.points.size(); ++i)
    if (const std::optional<FloquetStudy>& study = map.points[i].study)
      largest.trace.add({values[i], study->growth()});
  growth.x_label = frequencies.x_label = title_of(map.plan, parameter);
  growth.curves.push_back(std::move(largest));
  std::vector<plot::Panel> panels{std::move(frequencies)};
  // Of round-off a curve above 0 would say unstable.
  if (std::ranges::any_of(map.points, [](const FloquetMap::Point& point) {
        return point.study && point.study->stability() != Stability::neutral;
      }))
    panels.push_back(std::move(growth));
  plot::Layout layout;
  layout.title = map.model + ": small motions about the periodic motion";
  return plot::to_svg(panels, layout);
}

std::string over_two(const FloquetMap& map, const std::vector<std::size_t>& over,
                     const std::vector<double>& x, const std::vector<double>& y) {
  plot::Panel panel;
  panel.title = "Stability of the periodic motion";
  panel.x_label = title_of(map.plan, over[0]);
  panel.y_label = title_of(map.plan, over[1]);
  int style = 0;
  for (const std::string_view verdict : {"unstable", "neutral", "stable", "failed", "undecided"}) {
    plot::Curve curve = points_of(std::string(verdict), style++);
    for (std::size_t i = 0; i < map.points.size(); ++i)
      if (verdict_of(map.points[i]) == verdict) curve.trace.add({x[i], y[i]});
    curve.hollow.assign(curve.trace.points().size(), verdict != "unstable");
    if (!curve.trace.points().empty()) panel.curves.push_back(std::move(curve));
  }
  plot::Layout layout;
  layout.title = map.model;
  return plot::to_svg(std::vector{std::move(panel)}, layout);
}

}  // namespace

FloquetMap map_floquet(const ReadSweptModel& read, SweepPlan plan,
                       const FloquetMapOptions& options) {
  FloquetMap map;
  map.plan = std::move(plan);
  map.points.resize(map.plan.points.size());
  const auto is_told = [&] {
    return options.floquet.interrupted != nullptr && *options.floquet.interrupted;
  };
  for (std::size_t i = 0; i < map.points.size() && !is_told(); ++i) {
    Overrides values;
    for (std::size_t p = 0; p < map.plan.parameters.size(); ++p)
      values.push_back({map.plan.parameters[p], map.plan.points[i][p]});
    try {
      const Scene scene = read(values);
      map.model = scene.name;
      FloquetOptions one = options.floquet;
      one.period = options.period(scene);
      map.points[i].study = study_floquet(scene, one);
    } catch (const Stopped&) {
      break;
    } catch (const Error& error) {
      if (is_told()) break;
      map.points[i].failure = error.what();
    }
    if (options.progress) options.progress(i + 1, map.points.size());
  }
  if (std::ranges::none_of(map.points, [](const auto& point) { return point.study.has_value(); }))
    for (const FloquetMap::Point& point : map.points)
      if (!point.failure.empty()) throw Error(point.failure);
  return map;
}

std::string to_text(const FloquetMap& map) {
  std::size_t worst = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    if (map.points[i].study && map.points[i].study->growth() > most) {
      most = map.points[i].study->growth();
      worst = i;
    }
  }
  const auto where = [&](std::size_t i) {
    std::string text;
    for (std::size_t p = 0; p < map.plan.parameters.size(); ++p)
      text +=
          fmt::format("{}{}={}", p > 0 ? " " : "", map.plan.parameters[p], map.plan.points[i][p]);
    return text;
  };
  std::string text = fmt::format("{}: periodic motion at {} points:", map.model, map.points.size());
  for (const std::string_view verdict : verdicts)
    if (const auto count = std::ranges::count(map.points, verdict, verdict_of); count > 0)
      text += fmt::format(" {} {}", count, verdict);
  text += "\n";
  if (std::isfinite(most))
    text += fmt::format("largest growth over a period: {:.6g}, at {}\n", most, where(worst));
  std::size_t shown = 0;
  for (std::size_t i = 0; i < map.points.size() && shown < failures_shown; ++i)
    if (!map.points[i].failure.empty()) {
      text += fmt::format("failed at {}: {}\n", where(i), map.points[i].failure);
      ++shown;
    }
  return text;
}

std::string to_csv(const FloquetMap& map) {
  std::string text = "point", units = "# -";
  for (std::size_t p = 0; p < map.plan.parameters.size(); ++p) {
    text += "," + study::csv_cell(map.plan.parameters[p]);
    units += ",-";
  }
  text +=
      ",verdict,period,growth,mode,re_exponent,im_exponent,frequency,inertial_frequency,tail,"
      "moves_most,message\n" +
      units + ",-,s,-,-,1/s,1/s,Hz,Hz,-,-,-\n";
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    const FloquetMap::Point& point = map.points[i];
    std::string begins = std::to_string(i + 1);
    for (const std::string& value : map.plan.points[i]) begins += "," + study::csv_cell(value);
    begins += fmt::format(",{}", verdict_of(point));
    if (!point.study) {
      text += begins + ",,,,,,,,,," + study::csv_cell(point.failure) + "\n";
      continue;
    }
    begins += fmt::format(",{:.17g},{:.17g}", point.study->period, point.study->growth());
    for (std::size_t k = 0; k < point.study->modes.size(); ++k) {
      const NamedFloquetMode& mode = point.study->modes[k];
      text += fmt::format("{},{},{:.17g},{:.17g},{:.17g},{:.17g},{:.3g},{},\n", begins, k + 1,
                          mode.exponent.real(), mode.exponent.imag(), hertz(mode.frequency),
                          hertz(mode.inertial), mode.tail, study::csv_cell(mode.most));
    }
  }
  return text;
}

std::optional<std::string> floquet_svg(const FloquetMap& map) {
  const std::vector<std::size_t> over = varied(map.plan);
  if (over.empty() || over.size() > 2) return std::nullopt;
  const auto x = map.plan.numbers(over.front()), y = map.plan.numbers(over.back());
  if (!x || !y) return std::nullopt;
  return over.size() == 1 ? over_one(map, over[0], *x) : over_two(map, over, *x, *y);
}

}  // namespace mbd
