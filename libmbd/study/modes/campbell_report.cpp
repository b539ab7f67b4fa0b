#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libmbd/pictures/plot.hpp"
#include "libmbd/study/modes/campbell.hpp"
#include "libmbd/text/tables.hpp"

namespace mbd {
namespace {

const char* words_of_kind(SpecialSpeed::Kind kind) {
  switch (kind) {
    case SpecialSpeed::Kind::critical:
      return "critical speed";
    case SpecialSpeed::Kind::unstable_above:
      return "unstable above";
    case SpecialSpeed::Kind::stable_above:
      return "stable above";
  }
  return "";
}

// Whether eigenvalues have a real part that is not round-off.
bool grows_or_decays(const CampbellStudy& study) {
  constexpr double round_off = 1e-8;
  double most = 0.0, frequency = 0.0;
  for (const CampbellBranch& branch : study.branches)
    for (const CampbellPoint& p : branch.points) {
      most = std::max(most, std::abs(p.eigenvalue.real()));
      frequency = std::max(frequency, std::abs(p.eigenvalue));
    }
  return most > round_off * frequency;
}

}  // namespace

std::string to_text(const CampbellStudy& study) {
  std::string text = fmt::format(
      "{}: {} modes over {} rates, {:.6g} to {:.6g} rad/s about ({:g} {:g} {:g}), found in axes "
      "that {}\n\n",
      study.model, study.branches.size(), study.rates.size(), study.rates.front(),
      study.rates.back(), study.rotation.axis(0), study.rotation.axis(1), study.rotation.axis(2),
      study.axes == ModeAxes::turning ? "turn" : "rest");
  std::vector<std::vector<std::string>> rows{{"", "inertial rad/s, first", "last", "what moves"}};
  const auto frequency = [](const CampbellPoint& p) {
    return p.inertial    ? fmt::format("{:.7g} {}", std::abs(*p.inertial),
                                    *p.inertial < 0.0 ? "backward" : "forward")
           : p.has_orbit ? std::string("not round")
                         : fmt::format("{:.7g}", std::abs(p.eigenvalue.imag()));
  };
  for (std::size_t b = 0; b < study.branches.size(); ++b) {
    const CampbellBranch& branch = study.branches[b];
    rows.push_back({std::to_string(b + 1), frequency(branch.points.front()),
                    frequency(branch.points.back()), branch.name});
  }
  study::table(text, rows);
  text += '\n';
  for (const SpecialSpeed& special : study.special)
    text += fmt::format("{}: {:.13g} rad/s ({:.8g} rpm), mode {}\n", words_of_kind(special.kind),
                        special.rate, special.rate * 30.0 / std::numbers::pi, special.branch + 1);
  if (study.special.empty()) text += "no critical speed in this range\n";
  for (const std::string& note : study.notes) text += "note: " + note + "\n";
  return text;
}

std::string to_csv(const CampbellStudy& study) {
  std::string text =
      "rate,mode,re_eigenvalue,im_eigenvalue,inertial_frequency,orbit,overlap,name\n"
      "# rad/s,-,1/s,rad/s,rad/s,-,-,-\n";
  for (std::size_t b = 0; b < study.branches.size(); ++b)
    for (const CampbellPoint& p : study.branches[b].points)
      text += fmt::format("{:.17g},{},{:.17g},{:.17g},{},{:.6f},{:.6f},{}\n", p.rate, b + 1,
                          p.eigenvalue.real(), p.eigenvalue.imag(),
                          p.inertial ? fmt::format("{:.17g}", *p.inertial) : "", p.orbit, p.overlap,
                          study::csv_cell(study.branches[b].name));
  return text;
}

std::string campbell_svg(const CampbellStudy& study) {
  plot::Panel frequencies;
  frequencies.title = "Frequencies in inertial axes";
  frequencies.x_label = "rate of rotation [rad/s]";
  frequencies.y_label = "frequency [rad/s]";
  plot::Panel turning;
  turning.title = "Frequencies as seen from what turns";
  turning.x_label = frequencies.x_label;
  turning.y_label = frequencies.y_label;
  double top = 0.0;
  for (std::size_t b = 0; b < study.branches.size(); ++b) {
    const CampbellBranch& branch = study.branches[b];
    plot::Curve curve, seen;
    curve.style = seen.style = static_cast<int>(b);
    curve.plain = seen.plain = true;
    const auto& last = branch.points.back().inertial;
    curve.label = fmt::format("{}: {}{}", b + 1, branch.name,
                              !last         ? ""
                              : *last < 0.0 ? ", backward"
                                            : ", forward");
    seen.label = std::to_string(b + 1);
    for (const CampbellPoint& p : branch.points) {
      seen.trace.add({p.rate, std::abs(p.eigenvalue.imag())});
      if (!p.inertial && p.has_orbit) continue;
      const double y = p.inertial ? std::abs(*p.inertial) : std::abs(p.eigenvalue.imag());
      curve.trace.add({p.rate, y});
      top = std::max(top, y);
    }
    frequencies.curves.push_back(std::move(curve));
    turning.curves.push_back(std::move(seen));
  }
  plot::Curve once;
  once.label = "once per turn";
  once.pale = true;
  const double end = std::min(study.rates.back(), top);
  once.trace.add({0.0, 0.0});
  once.trace.add({end, end});
  frequencies.curves.push_back(std::move(once));
  plot::Curve critical;
  critical.label = "critical speeds";
  critical.points_only = true;
  for (const SpecialSpeed& special : study.special)
    if (special.kind == SpecialSpeed::Kind::critical)
      critical.trace.add({special.rate, special.rate});
  if (!critical.trace.points().empty()) frequencies.curves.push_back(std::move(critical));

  std::vector<plot::Panel> panels{std::move(frequencies)};
  if (study.axes == ModeAxes::turning) panels.push_back(std::move(turning));
  if (grows_or_decays(study)) {
    plot::Panel growth;
    growth.title = "Growth of small motions (above 0: unstable)";
    growth.x_label = "rate of rotation [rad/s]";
    growth.y_label = "Re [1/s]";
    for (std::size_t b = 0; b < study.branches.size(); ++b) {
      plot::Curve curve;
      curve.style = static_cast<int>(b);
      curve.plain = true;
      curve.label = std::to_string(b + 1);
      for (const CampbellPoint& p : study.branches[b].points)
        curve.trace.add({p.rate, p.eigenvalue.real()});
      growth.curves.push_back(std::move(curve));
    }
    panels.push_back(std::move(growth));
  }
  double most = 0.0;
  for (const double moved : study.displacements) most = std::max(most, moved);
  if (most > 0.0) {
    plot::Panel moved;
    moved.title = "Largest displacement of the steady rotation";
    moved.x_label = "rate of rotation [rad/s]";
    moved.y_label = "displacement [m]";
    plot::Curve curve;
    curve.plain = true;
    for (std::size_t i = 0; i < study.rates.size(); ++i)
      curve.trace.add({study.rates[i], study.displacements[i]});
    moved.curves.push_back(std::move(curve));
    panels.push_back(std::move(moved));
  }
  plot::Layout layout;
  layout.title = study.model + ": Campbell diagram";
  return plot::to_svg(panels, layout);
}

}  // namespace mbd
