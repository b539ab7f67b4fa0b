#include "libmbd/study/modes/modes_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>

#include "libmbd/text/files.hpp"
#include "libmbd/text/tables.hpp"

namespace mbd {
namespace {

using Json = nlohmann::ordered_json;

constexpr double round_off = 1e-7;  // growth beside frequency

std::string hertz(double rad_per_second, int digits = 10) {
  return fmt::format("{:.{}g}", rad_per_second / (2.0 * std::numbers::pi), digits);
}

double rate_of(const ModesStudy& study) { return study.rotation ? study.rotation->rate : 0.0; }

std::string whirl_words(const ModesStudy& study, const NamedMode& mode) {
  const std::optional<double> whirl = mode.whirl(rate_of(study), study.axes);
  if (!whirl) return mode.orbit ? "not round" : "";
  // What is unknown of the eigenvalue, beside the sum of it and the rate, in which nearly all may cancel.
  const double unknown = mode.round_off * std::abs(mode.eigenvalue) / std::abs(*whirl);
  if (!(unknown < 1.0)) return "0";
  return fmt::format("{:.{}g} {}", std::abs(*whirl) / (2.0 * std::numbers::pi),
                     digits_left(unknown, 7), *whirl < 0.0 ? "back" : "forw");
}

std::string damping(const NamedMode& mode) {
  if (mode.rigid) return "";
  if (!(mode.eigenvalue.imag() > 0.0))
    return fmt::format("{} {:.4g} 1/s", mode.eigenvalue.real() > 0.0 ? "grows" : "decays",
                       std::abs(mode.eigenvalue.real()));
  const double ratio = mode.damping_ratio();
  return std::abs(ratio) < round_off ? "0" : fmt::format("{:.4g} %", 100.0 * ratio);
}

// Without its last brace.
std::string open_object(const Json& object) {
  std::string text = object.dump(1);
  text.resize(text.size() - std::string_view("\n}").size());
  return text;
}

// A line a node, written as it is made: of 1e5 unknowns the tree of numbers is larger than all that found them.
void append_shape(const ModesStudy& study, const NamedMode& mode, std::string& text) {
  const auto out = std::back_inserter(text);
  for (std::size_t n = 0; n < study.nodes.size(); ++n) {
    const Eigen::Matrix3d R = study.poses[n].p.toRotationMatrix();
    text += n > 0 ? ",\n  [" : "\n  [";
    for (Index part = 0; part < 6; part += 3) {
      const Eigen::Vector3cd x = R * mode.shape.segment<3>(static_cast<Index>(6 * n) + part);
      for (Index k = 0; k < 3; ++k)
        fmt::format_to(out, "{}[{},{}]", part + k > 0 ? "," : "", x(k).real(), x(k).imag());
    }
    text += ']';
  }
}

// What of the settings is not the default, and who said so.
std::string asked_in_words(const ModesStudy& study) {
  std::string text;
  for (const AskedForModes& one : study.asked)
    text += fmt::format("{}{} {} ({})", text.empty() ? "asked for: " : ", ", one.name, one.value,
                        one.by_scene ? "<modes>" : "option");
  return text.empty() ? text : text + "\n";
}

}  // namespace

int digits_left(double round_off, int most, int least) {
  if (!(round_off > 0.0)) return most;
  return std::clamp(static_cast<int>(-std::log10(round_off)), least, most);
}

std::string to_text(const ModesStudy& study) {
  std::string text = fmt::format("{}: {} modes", study.model, study.modes.size());
  if (study.rotation)
    text += fmt::format(
        " about steady rotation at {:.10g} rad/s about ({:g} {:g} {:g}), as seen "
        "from what {}",
        study.rotation->rate, study.rotation->axis(0), study.rotation->axis(1),
        study.rotation->axis(2), study.axes == ModeAxes::turning ? "turns" : "rests");
  else if (study.time)
    text += fmt::format(" about the state of a run at {:.10g} s, as if it stayed as it is then",
                        *study.time);
  else
    text += " about equilibrium";
  constexpr double seen = 1e-12;
  if (study.displacement > seen)
    text += fmt::format("; displaced by up to {:.6g} m ({})", study.displacement, study.displaced);
  text += '\n' + asked_in_words(study) + '\n';
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> head{"", "Hz", "rad/s", "damping"};
  if (study.rotation) head.push_back("inertial Hz");
  head.push_back("what moves");
  rows.push_back(head);
  bool unstable = false;
  for (std::size_t i = 0; i < study.modes.size(); ++i) {
    const NamedMode& mode = study.modes[i];
    std::vector<std::string> row{std::to_string(i + 1)};
    if (mode.rigid) {
      row.insert(row.end(), {"0", "0"});
    } else if (mode.eigenvalue.imag() > 0.0) {
      row.insert(row.end(),
                 {hertz(mode.eigenvalue.imag(), digits_left(mode.round_off, 10)),
                  fmt::format("{:.{}g}", mode.eigenvalue.imag(), digits_left(mode.round_off, 12))});
    } else {
      row.insert(row.end(), {"0", "0"});
    }
    row.push_back(damping(mode));
    if (study.rotation) row.push_back(whirl_words(study, mode));
    row.push_back(mode.name);
    rows.push_back(std::move(row));
    unstable = unstable || mode.eigenvalue.real() >
                               std::max(round_off, mode.round_off) * std::abs(mode.eigenvalue);
  }
  study::table(text, rows);
  if (unstable) text += "\nnote: unstable: what grows leaves this state\n";
  for (const std::string& note : study.notes) text += "\nnote: " + note + "\n";
  if (study.mac) text += '\n' + to_text(*study.mac);
  return text;
}

std::vector<std::string> write_modes(const ModesStudy& study,
                                     const std::filesystem::path& directory) {
  make_directory(directory);
  std::error_code code;
  for (const char* const old : {"mac.csv", "mac.json"})
    std::filesystem::remove(directory / old, code);
  std::vector<std::string> names{"modes.csv", "modes.json"};
  write_file(directory / "modes.csv", to_csv(study));
  write_file(directory / "modes.json", to_json(study));
  if (!study.mac) return names;
  write_file(directory / "mac.csv", to_csv(*study.mac));
  write_file(directory / "mac.json", to_json(*study.mac));
  names.insert(names.end(), {"mac.csv", "mac.json"});
  return names;
}

std::string to_csv(const ModesStudy& study) {
  std::string text =
      "mode,re_eigenvalue,im_eigenvalue,frequency,damping_ratio,orbit,inertial_frequency,residual,"
      "round_off,condition,rigid,name\n"
      "# -,1/s,1/s,Hz,-,-,Hz,-,-,-,-,-\n";
  for (std::size_t i = 0; i < study.modes.size(); ++i) {
    const NamedMode& mode = study.modes[i];
    const std::optional<double> whirl = mode.whirl(rate_of(study), study.axes);
    text += fmt::format("{},{:.17g},{:.17g},{:.17g},{:.17g},{},{},{:.3g},{:.3g},{:.6g},{},{}\n",
                        i + 1, mode.eigenvalue.real(), mode.eigenvalue.imag(), mode.frequency(),
                        mode.damping_ratio(), mode.orbit ? fmt::format("{:.6f}", *mode.orbit) : "",
                        whirl ? fmt::format("{:.17g}", *whirl / (2.0 * std::numbers::pi)) : "",
                        mode.residual, mode.round_off, mode.condition, mode.rigid ? 1 : 0,
                        study::csv_cell(mode.name));
  }
  return text;
}

std::string to_json(const ModesStudy& study) {
  Json json = Json::object();
  json["model"] = study.model;
  json["file"] = study.file;
  if (study.rotation) {
    const SteadyRotation& r = *study.rotation;
    json["rotation"] = {{"rate", r.rate},
                        {"axes", study.axes == ModeAxes::turning ? "turning" : "resting"},
                        {"axis", {r.axis(0), r.axis(1), r.axis(2)}},
                        {"through", {r.through(0), r.through(1), r.through(2)}}};
  }
  if (study.time) json["time"] = *study.time;
  Json& asked = json["asked"] = Json::object();
  for (const AskedForModes& one : study.asked)
    asked[one.name] = {{"value", one.value}, {"by", one.by_scene ? "scene" : "option"}};
  json["largest_displacement"] = {{"value", study.displacement}, {"node", study.displaced}};
  json["notes"] = study.notes;
  Json& nodes = json["nodes"] = Json::array();
  for (std::size_t n = 0; n < study.nodes.size(); ++n) {
    const Pose<double>& H = study.poses[n];
    nodes.push_back({{"name", study.nodes[n]},
                     {"position", {H.r(0), H.r(1), H.r(2)}},
                     {"orientation", {H.p.w(), H.p.x(), H.p.y(), H.p.z()}}});
  }
  std::string text = open_object(json) + ",\n \"modes\": [";
  for (std::size_t i = 0; i < study.modes.size(); ++i) {
    const NamedMode& mode = study.modes[i];
    Json one = Json::object();
    one["name"] = mode.name;
    one["eigenvalue"] = {mode.eigenvalue.real(), mode.eigenvalue.imag()};
    one["frequency"] = mode.frequency();
    one["damping_ratio"] = mode.damping_ratio();
    one["residual"] = mode.residual;
    one["round_off"] = mode.round_off;
    one["condition"] = mode.condition;
    one["rigid"] = mode.rigid;
    if (mode.orbit) one["orbit"] = *mode.orbit;
    if (const auto whirl = mode.whirl(rate_of(study), study.axes))
      one["inertial_frequency"] = *whirl / (2.0 * std::numbers::pi);
    Json& parts = one["parts"] = Json::array();
    for (const auto& [part, share] : mode.parts)
      parts.push_back({{"name", part}, {"share", share}});
    text += (i > 0 ? ",\n" : "\n") + open_object(one) + ",\n \"shape\": [";
    append_shape(study, mode, text);
    text += "]}";
  }
  return text + "]\n}\n";
}

}  // namespace mbd
