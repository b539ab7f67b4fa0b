#include "libmbd/results/expect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libmbd/scene/label.hpp"
#include "libmbd/scene/transient.hpp"
#include "libmbd/text/spelling.hpp"

namespace mbd {
namespace {

constexpr double same_time = 1e-9;  // of a time to a sample time, relative to the duration

std::string describe(const ExpectScene& expect, bool timed) {
  switch (expect.of) {
    case ExpectScene::Of::minimum:
      return "min " + expect.quantity;
    case ExpectScene::Of::maximum:
      return "max " + expect.quantity;
    case ExpectScene::Of::limit:
      return fmt::format("{} at limit point {}", expect.quantity, expect.number);
    case ExpectScene::Of::bifurcation:
      return fmt::format("{} at bifurcation {}", expect.quantity, expect.number);
    case ExpectScene::Of::mark:
      return fmt::format("{} at mark {}", expect.quantity, expect.number);
    case ExpectScene::Of::value_at:
      break;
  }
  return timed ? fmt::format("{} at {}", expect.quantity, expect.at) : expect.quantity;
}

PathEvent event_of(ExpectScene::Of of) {
  return of == ExpectScene::Of::limit         ? PathEvent::limit
         : of == ExpectScene::Of::bifurcation ? PathEvent::bifurcation
         : of == ExpectScene::Of::mark        ? PathEvent::crossing
                                              : PathEvent::none;
}

void check_time(const ExpectScene& expect, const Scene& scene) {
  if (!scene.transient) {
    if (expect.at != 0.0)
      throw Error(expect.source, fmt::format("expect: at is {}, but without a <transient> an "
                                             "equilibrium has no time, only 0; leave it out",
                                             expect.at));
    return;
  }
  const TransientScene& transient = *scene.transient;
  const double duration = transient.duration;
  if (expect.at > duration * (1.0 + same_time))
    throw Error(expect.source,
                fmt::format("expect: at is {}, after the end of the run; it must be at most {} s",
                            expect.at, duration));
  const std::optional<double> interval = row_interval(transient);
  if (!interval || std::abs(expect.at - duration) <= same_time * duration) return;
  if (std::abs(std::round(expect.at / *interval) * *interval - expect.at) <= same_time * duration)
    return;
  const double below = std::floor(expect.at / *interval) * *interval;
  const double above = std::min(std::ceil(expect.at / *interval) * *interval, duration);
  throw Error(
      expect.source,
      transient.step && !transient.output
          ? fmt::format(
                "expect: at is {}, must be a whole number of steps of {:.12g} s; the nearest "
                "are {:.12g} and {:.12g}",
                expect.at, *interval, below, above)
          : fmt::format(
                "expect: at is {}, between rows of results, which are written every {:.12g} s; "
                "the nearest are at {:.12g} and {:.12g}; with output=\"steps\" it may be any time",
                expect.at, *interval, below, above));
}

}  // namespace

Expectations::Expectations(const Scene& scene, const Model& model) {
  const std::vector<Column> known = columns(model);
  nearness_ = scene.transient ? same_time * scene.transient->duration : 0.0;
  for (const ExpectScene& expect : scene.expects) {
    const std::size_t column = find_column(known, expect.quantity, expect.source, "expect");
    if (expect.of == ExpectScene::Of::value_at) check_time(expect, scene);
    if (const PathEvent event = event_of(expect.of); event != PathEvent::none && !scene.path)
      throw Error(expect.source,
                  "expect: limit points, bifurcations and marks are those of a <path>, "
                  "which the model has not; write of=\"value\"");
    // Without a transient the value is that of the last row, at the whole load.
    Watch& watch = watches_.emplace_back();
    watch.column = column;
    watch.of = expect.of;
    watch.at = scene.transient ? expect.at : 1.0;
    watch.number = expect.number;
    results_.push_back({expect.source, describe(expect, scene.transient.has_value()), expect.value,
                        std::nullopt, expect.tolerance, expect.reference});
  }
}

void Expectations::accepted(const Sample& sample) {
  for (std::size_t i = 0; i < watches_.size(); ++i) {
    Watch& watch = watches_[i];
    const double value = sample.row[watch.column];
    std::optional<double>& got = results_[i].got;
    switch (watch.of) {
      case ExpectScene::Of::value_at:
        if (const double off = std::abs(sample.row[0] - watch.at);
            sample.model.path || (off <= nearness_ && off <= watch.off)) {
          got = value;
          watch.off = off;
        }
        break;
      case ExpectScene::Of::limit:
      case ExpectScene::Of::bifurcation:
      case ExpectScene::Of::mark:
        if (sample.model.path->event == event_of(watch.of) && ++watch.met == watch.number)
          got = value;
        break;
      case ExpectScene::Of::minimum:
        got = std::min(got.value_or(value), value);
        break;
      case ExpectScene::Of::maximum:
        got = std::max(got.value_or(value), value);
        break;
    }
  }
}

std::size_t find_column(std::span<const Column> columns, const std::string& name,
                        const Source& source, const std::string& who) {
  std::vector<std::string_view> known;
  for (const Column& column : columns) {
    if (column.name == name) return known.size();
    known.emplace_back(column.name);
  }
  throw Error(source, who + ": \"" + excerpt(name) + "\" is not a column of the results" +
                          suggest(name, known, "columns") + "; a <record> makes more of them");
}

std::vector<std::size_t> find_marks(const Scene& scene, std::span<const Column> columns) {
  std::vector<std::size_t> found;
  if (!scene.path) return found;
  for (const PathMarkScene& mark : scene.path->marks) {
    const std::string who = mark.stops ? "stop" : "mark";
    for (const char* own : {"arc_length", "branch", "event", "negative_eigenvalues"})
      if (mark.quantity == own)
        throw Error(mark.source, who + ": \"" + own +
                                     "\" says where on the path a point is, and is no mark; the "
                                     "attributes length and points of <path> end it");
    found.push_back(find_column(columns, mark.quantity, mark.source, who));
  }
  return found;
}

void check_outputs(const Scene& scene, const Model& model) {
  const Expectations expectations(scene, model);
  const std::vector<Column> known = columns(model);
  find_marks(scene, known);
  for (const PlotScene& plot : scene.plots) {
    if (!plot.x.empty()) find_column(known, plot.x, plot.source, "plot");
    for (const std::string& name : plot.y) find_column(known, name, plot.source, "plot");
  }
}

}  // namespace mbd
