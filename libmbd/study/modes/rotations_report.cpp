#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "libmbd/pictures/plot.hpp"
#include "libmbd/study/modes/rotations.hpp"
#include "libmbd/text/tables.hpp"

namespace mbd {
namespace {

bool none_grows(const RotationOnPath& point) { return point.unstable && *point.unstable == 0; }

// "stable from 0 to 56.1 rad/s, unstable from 56.1 back to 53, stable to 81 rad/s".
std::string stability_of(const PathOfRotations& path) {
  std::string text;
  const auto& points = path.points;
  for (std::size_t k = 0; k < points.size();) {
    std::size_t end = k;
    while (end + 1 < points.size() && none_grows(points[end + 1]) == none_grows(points[k])) ++end;
    text += fmt::format("{}{} from {:.6g} to {:.6g} rad/s", text.empty() ? "" : ", then ",
                        none_grows(points[k]) ? "stable"
                        : points[k].unstable  ? "unstable"
                                              : "not judged",
                        points[k].rate, points[end].rate);
    k = end + 1;
  }
  return text;
}

std::string path_in_words(const PathOfRotations& path, std::size_t number) {
  const auto most = std::ranges::max_element(path.points, {}, &RotationOnPath::displacement);
  std::string text = fmt::format("path {}, found at {:.6g} rad/s: {} points, {}\n", number,
                                 path.found_at, path.points.size(), stability_of(path));
  text += fmt::format("  at most {:.6g} m from the reference configuration, {} at {:.6g} rad/s\n",
                      most->displacement, most->displaced, most->rate);
  for (const RotationOnPath& point : path.points)
    if (point.is_fold)
      text += fmt::format("  turns back at {:.9g} rad/s, {:.6g} m away\n", point.rate,
                          point.displacement);
  for (const std::string& end : path.ends) text += "  ends: " + end + '\n';
  return text;
}

plot::Panel over_rate(std::string title) {
  plot::Panel made;
  made.title = std::move(title);
  made.x_label = "rate of rotation [rad/s]";
  made.y_label = "[m]";
  return made;
}

// Stable and unstable parts of all paths, and folds.
template <class Value>
plot::Panel of_paths(const RotationsStudy& study, plot::Panel made, const Value& value) {
  for (const bool stable : {true, false}) {
    bool is_named = false;
    for (const PathOfRotations& path : study.paths) {
      plot::Curve curve;
      const auto draw = [&] {
        if (curve.trace.points().empty()) return;
        curve.plain = true;
        curve.style = stable ? 0 : 1;
        curve.label = is_named ? "" : stable ? "stable" : "unstable";
        is_named = true;
        made.curves.push_back(std::move(curve));
        curve = {};
      };
      for (std::size_t k = 0; k < path.points.size(); ++k) {
        const RotationOnPath& point = path.points[k];
        if (none_grows(point) != stable) {
          draw();
          continue;
        }
        // From the middle between two of different kinds, so that a path has no gaps.
        if (k > 0 && curve.trace.points().empty())
          curve.trace.add({path.points[k - 1].rate, value(path.points[k - 1])});
        curve.trace.add({point.rate, value(point)});
      }
      draw();
    }
  }
  plot::Curve folds;
  folds.label = "folds";
  folds.points_only = true;
  folds.style = 2;
  for (const PathOfRotations& path : study.paths)
    for (const RotationOnPath& point : path.points)
      if (point.is_fold) folds.trace.add({point.rate, value(point)});
  if (!folds.trace.points().empty()) made.curves.push_back(std::move(folds));
  return made;
}

}  // namespace

std::string to_text(const RotationsStudy& study) {
  std::string text = fmt::format(
      "{}: {} path{} of steady rotations from {:.6g} to {:.6g} rad/s; stable: none of the {} "
      "slowest "
      "modes grows\n",
      study.model, study.paths.size(), study.paths.size() == 1 ? "" : "s", study.from, study.to,
      study.count);
  for (std::size_t k = 0; k < study.paths.size(); ++k) text += path_in_words(study.paths[k], k + 1);
  text +=
      study.searched.empty()
          ? std::string("others were not sought\n")
          : fmt::format("others were sought at {} rates; that there are no more is not proven\n",
                        study.searched.size());
  for (const std::string& note : study.notes) text += "note: " + note + '\n';
  return text;
}

std::string to_csv(const RotationsStudy& study) {
  std::string text = "path,rate,arc_length,fold,displacement,growth,unstable",
              units = "# -,rad/s,-,-,m,1/s,-";
  for (const std::string& probe : study.probes)
    for (const char* const axis : {"1", "2", "3"}) {
      text += ',' + study::csv_cell(fmt::format("{}.displacement.{}", probe, axis));
      units += ",m";
    }
  text += '\n' + units + '\n';
  for (std::size_t k = 0; k < study.paths.size(); ++k)
    for (const RotationOnPath& point : study.paths[k].points) {
      text += fmt::format("{},{:.17g},{:.9g},{},{:.17g},{},{}", k + 1, point.rate, point.arc,
                          point.is_fold ? 1 : 0, point.displacement,
                          point.unstable ? fmt::format("{:.9g}", point.growth) : "",
                          point.unstable ? std::to_string(*point.unstable) : "");
      for (const Vec3& probe : point.probes)
        text += fmt::format(",{:.17g},{:.17g},{:.17g}", probe.x(), probe.y(), probe.z());
      text += '\n';
    }
  return text;
}

std::string rotations_svg(const RotationsStudy& study) {
  std::vector<plot::Panel> panels{
      of_paths(study, over_rate("Largest displacement"),
               [](const RotationOnPath& point) { return point.displacement; })};
  for (std::size_t k = 0; k < study.probes.size(); ++k)
    panels.push_back(of_paths(study, over_rate("Displacement of " + study.probes[k]),
                              [k](const RotationOnPath& point) { return point.probes[k].norm(); }));
  plot::Layout layout;
  layout.title = study.model + ": steady rotations";
  return plot::to_svg(panels, layout);
}

}  // namespace mbd
