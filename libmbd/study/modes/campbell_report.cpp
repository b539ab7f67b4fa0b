#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "libmbd/pictures/plot.hpp"
#include "libmbd/study/modes/campbell.hpp"
#include "libmbd/study/modes/modes_report.hpp"
#include "libmbd/text/tables.hpp"

namespace mbd {
namespace {

std::string words_of_kind(SpecialSpeed::Kind kind) {
  std::string words = word_of(kind);
  std::ranges::replace(words, '_', ' ');
  return kind == SpecialSpeed::Kind::critical ? words + " speed" : words;
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

constexpr double degree = std::numbers::pi / 180.0;

std::string words_of_response(const CampbellStudy& study, const CampbellStudy::Response& response,
                              const std::string& to) {
  const auto most = std::ranges::max_element(response.orbits, {}, &Orbit::major);
  if (most == response.orbits.end())
    return fmt::format("no response to {} of {}", to, response.place);
  const double besides = std::ranges::max(response.orbits, {}, &Orbit::besides).besides;
  const bool is_between = std::ranges::find(study.rates, most->rate) == study.rates.end();
  if (is_between && !grows_or_decays(study))
    return fmt::format(
        "response to {} of {}: without bound at {:.6g} rad/s, a resonance that nothing damps", to,
        response.place, most->rate);
  return fmt::format(
      "response to {} of {}: at most {:.6g} m, at {:.6g} rad/s, {:.1f} degrees behind it{}", to,
      response.place, most->major(), most->rate, most->lag() / degree,
      besides > 0.0 ? fmt::format(", and up to {:.2g} m at other frequencies", besides) : "");
}

// "forces at 2 times the rate".
std::string forces_of(const CampbellStudy& study) {
  return study.order == 1.0 ? std::string("forces at the rate")
                            : fmt::format("forces at {:g} times the rate", study.order);
}

}  // namespace

const char* word_of(SpecialSpeed::Kind kind) {
  switch (kind) {
    case SpecialSpeed::Kind::critical:
      return "critical";
    case SpecialSpeed::Kind::unstable_above:
      return "unstable_above";
    case SpecialSpeed::Kind::stable_above:
      return "stable_above";
  }
  return "";
}

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
    text += fmt::format("{}: {:.{}g} rad/s ({:.{}g} rpm), mode {}\n", words_of_kind(special.kind),
                        special.rate, digits_left(special.round_off, 13, 3),
                        special.rate * 30.0 / std::numbers::pi,
                        digits_left(special.round_off, 8, 3), special.branch + 1);
  if (study.special.empty())
    text += fmt::format("no critical speed was found from {:.6g} to {:.6g} rad/s\n",
                        study.rates.front(), study.rates.back());
  for (const CampbellStudy::Response& response : study.responses)
    text += words_of_response(study, response, "unbalance") + '\n';
  for (const CampbellStudy::Response& response : study.force_responses)
    text += words_of_response(study, response, forces_of(study)) + '\n';
  for (const std::string& note : study.notes) text += "note: " + note + "\n";
  return text;
}

std::string to_csv(const CampbellStudy& study) {
  std::string text =
      "rate,mode,re_eigenvalue,im_eigenvalue,inertial_frequency,orbit,overlap,round_off,name\n"
      "# rad/s,-,1/s,rad/s,rad/s,-,-,-,-\n";
  for (std::size_t b = 0; b < study.branches.size(); ++b)
    for (const CampbellPoint& p : study.branches[b].points)
      text += fmt::format("{:.17g},{},{:.17g},{:.17g},{},{:.6f},{:.6f},{:.3g},{}\n", p.rate, b + 1,
                          p.eigenvalue.real(), p.eigenvalue.imag(),
                          p.inertial ? fmt::format("{:.17g}", *p.inertial) : "", p.orbit, p.overlap,
                          p.round_off, study::csv_cell(study.branches[b].name));
  return text;
}

std::string response_csv(const std::vector<CampbellStudy::Response>& responses) {
  std::string text =
      "rate,place,major,minor,lag,re_forward,im_forward,re_backward,im_backward,besides\n"
      "# rad/s,-,m,m,deg,m,m,m,m,m\n";
  for (const CampbellStudy::Response& response : responses)
    for (const Orbit& o : response.orbits)
      text += fmt::format(
          "{:.17g},{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n", o.rate,
          study::csv_cell(response.place), o.major(), o.minor(), o.lag() / degree, o.forward.real(),
          o.forward.imag(), o.backward.real(), o.backward.imag(), o.besides);
  return text;
}

namespace {

plot::Panel panel(std::string title, const char* y_label) {
  plot::Panel made;
  made.title = std::move(title);
  made.x_label = "rate of rotation [rad/s]";
  made.y_label = y_label;
  return made;
}

plot::Curve branch_curve(std::size_t branch, std::string label) {
  plot::Curve curve;
  curve.style = static_cast<int>(branch);
  curve.plain = true;
  curve.label = std::move(label);
  return curve;
}

std::string label_of(std::size_t number, const CampbellBranch& branch) {
  const auto& last = branch.points.back().inertial;
  return fmt::format("{}: {}{}", number, branch.name,
                     !last         ? ""
                     : *last < 0.0 ? ", backward"
                                   : ", forward");
}

// With the line of one turn, on which speeds are critical.
plot::Panel inertial_frequencies(const CampbellStudy& study) {
  plot::Panel made = panel("Frequencies in inertial axes", "frequency [rad/s]");
  double top = 0.0;
  for (std::size_t b = 0; b < study.branches.size(); ++b) {
    plot::Curve curve = branch_curve(b, label_of(b + 1, study.branches[b]));
    for (const CampbellPoint& p : study.branches[b].points) {
      if (!p.inertial && p.has_orbit) continue;
      const double y = p.inertial ? std::abs(*p.inertial) : std::abs(p.eigenvalue.imag());
      curve.trace.add({p.rate, y});
      top = std::max(top, y);
    }
    made.curves.push_back(std::move(curve));
  }
  plot::Curve once;
  once.label = "once per turn";
  once.pale = true;
  const double end = std::min(study.rates.back(), top);
  once.trace.add({0.0, 0.0});
  once.trace.add({end, end});
  made.curves.push_back(std::move(once));
  plot::Curve critical;
  critical.label = "critical speeds";
  critical.points_only = true;
  for (const SpecialSpeed& special : study.special)
    if (special.kind == SpecialSpeed::Kind::critical)
      critical.trace.add({special.rate, special.rate});
  if (!critical.trace.points().empty()) made.curves.push_back(std::move(critical));
  return made;
}

// `value` of all points of each branch.
template <class Value>
plot::Panel of_branches(const CampbellStudy& study, plot::Panel made, const Value& value) {
  for (std::size_t b = 0; b < study.branches.size(); ++b) {
    plot::Curve curve = branch_curve(b, std::to_string(b + 1));
    for (const CampbellPoint& p : study.branches[b].points)
      curve.trace.add({p.rate, value(p.eigenvalue)});
    made.curves.push_back(std::move(curve));
  }
  return made;
}

plot::Panel displacements(const CampbellStudy& study) {
  plot::Panel made = panel("Largest displacement of the steady rotation", "displacement [m]");
  plot::Curve curve;
  curve.plain = true;
  for (std::size_t i = 0; i < study.rates.size(); ++i)
    curve.trace.add({study.rates[i], study.displacements[i]});
  made.curves.push_back(std::move(curve));
  return made;
}

// `value` of all orbits of each place.
template <class Value>
plot::Panel of_responses(const std::vector<CampbellStudy::Response>& responses, plot::Panel made,
                         const Value& value) {
  for (const CampbellStudy::Response& response : responses) {
    plot::Curve curve;
    curve.plain = true;
    curve.label = response.place;
    for (const Orbit& orbit : response.orbits) curve.trace.add({orbit.rate, value(orbit)});
    made.curves.push_back(std::move(curve));
  }
  return made;
}

void add_responses(const std::vector<CampbellStudy::Response>& responses, const std::string& title,
                   std::vector<plot::Panel>& panels) {
  if (responses.empty()) return;
  plot::Panel size = panel(title + ": half the long axis of the orbit", "[m]");
  size.y_log = true;
  panels.push_back(
      of_responses(responses, std::move(size), [](const Orbit& o) { return o.major(); }));
  panels.push_back(of_responses(responses, panel(title + ": how far it is behind", "[deg]"),
                                [](const Orbit& o) { return o.lag() / degree; }));
}

}  // namespace

std::string campbell_svg(const CampbellStudy& study) {
  using Eigenvalue = const std::complex<double>&;
  std::vector<plot::Panel> panels{inertial_frequencies(study)};
  if (study.axes == ModeAxes::turning)
    panels.push_back(of_branches(study,
                                 panel("Frequencies as seen from what turns", "frequency [rad/s]"),
                                 [](Eigenvalue x) { return std::abs(x.imag()); }));
  if (grows_or_decays(study))
    panels.push_back(of_branches(study,
                                 panel("Growth of small motions (above 0: unstable)", "Re [1/s]"),
                                 [](Eigenvalue x) { return x.real(); }));
  if (std::any_of(study.displacements.begin(), study.displacements.end(),
                  [](double moved) { return moved > 0.0; }))
    panels.push_back(displacements(study));
  add_responses(study.responses, "Response to unbalance", panels);
  add_responses(study.force_responses, "Response to " + forces_of(study), panels);
  plot::Layout layout;
  layout.title = study.model + ": Campbell diagram";
  return plot::to_svg(panels, layout);
}

}  // namespace mbd
