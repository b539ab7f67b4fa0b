#include "libmbd/study/accuracy/accuracy_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "libmbd/study/accuracy/accuracy_words.hpp"
#include "libmbd/text/tables.hpp"
#include "libmbd/text/text.hpp"

namespace mbd::study_report {
namespace {

using namespace study;

std::string sentence_of(const AccuracyStudy& study, const Advice& advice) {
  const TrialPoint& point = study.points[advice.point];
  const Quantity& quantity = study.quantities[advice.quantity];
  const std::string until = until_text(study, quantity);
  return fmt::format("{}{} to {}: {}: {} s", quantity.name, until.empty() ? "" : " " + until,
                     number_text(advice.accuracy, 1), point.text, seconds_text(point.trial.cpu));
}

// --- text ---

void front_text(std::string& text, const AccuracyStudy& study, std::size_t quantity) {
  if (quantity >= study.fronts.size() || study.fronts[quantity].empty()) {
    text += "  no run has an error that is known\n";
    return;
  }
  std::vector<std::vector<std::string>> rows = {{"error", "CPU [s]", "cheapest for its error"}};
  for (const std::size_t point : study.fronts[quantity])
    rows.push_back({rms_text(study, point, quantity), seconds_text(study.points[point].trial.cpu),
                    study.points[point].text});
  table(text, rows);
}

void fits_text(std::string& text, const AccuracyStudy& study, std::size_t quantity) {
  std::vector<std::vector<std::string>> rows = {{"over", "order", "of"}};
  for (const OrderFit& fit : study.fits)
    if (fit.quantity == quantity)
      rows.push_back({std::string(name_of(fit.knob)), slope_text(fit), family_text(study, fit)});
  if (rows.size() > 1) table(text, rows);
}

void advice_text(std::string& text, const AccuracyStudy& study, std::size_t quantity,
                 const Scene* scene) {
  for (const Range& range : ranges_of(study, quantity)) {
    std::string words = sentence_of(study, {quantity, range.to, range.point});
    words[words.rfind(' ')] = '\t';  // seconds stay with their number
    text += wrapped("  ", words, 4);
    if (scene == nullptr) continue;
    std::string_view lines = "";
    const std::string all = snippet(*scene, study.points[range.point].setting);
    for (lines = all; !lines.empty();) {
      const std::size_t end = lines.find('\n');
      text += "      " + std::string(trimmed(lines.substr(0, end))) + "\n";
      lines.remove_prefix(end == std::string_view::npos ? lines.size() : end + 1);
    }
  }
}

std::string text_of(const AccuracyStudy& study, const Scene* scene) {
  std::string text =
      wrapped("", fmt::format("{}: error against CPU time", excerpt(study.model)), 2);
  paragraph(text, "runs",
            fmt::format("{}; {}\ts of {}\ts", tally_text(study), seconds_text(study.seconds),
                        seconds_text(study.budget)));
  paragraph(text, "reference", study.reference);
  paragraph(text, "norm", norm_text(study));
  for (std::size_t q = 0; q < study.quantities.size(); ++q) {
    const Quantity& quantity = study.quantities[q];
    text += "\n" + excerpt(quantity.name) + "\n";
    if (!(quantity.until > 0.0)) {
      text += wrapped("  ", "refinements do not approach each other: there is no reference", 2);
      continue;
    }
    text += wrapped("  ",
                    fmt::format("error of the reference itself: {} rms, {} largest",
                                reference_text(quantity, &Quantity::reference_rms),
                                reference_text(quantity, &Quantity::reference_largest)),
                    2);
    if (const std::string until = until_text(study, quantity); !until.empty())
      text += wrapped("  ", "refinements approach each other " + until + ", no further", 2);
    front_text(text, study, q);
    fits_text(text, study, q);
    advice_text(text, study, q, scene);
  }
  if (!study.notes.empty()) text += "\n";
  for (const std::string& note : study.notes) text += wrapped("note: ", note, 6);
  return text;
}

// --- CSV ---

std::string number(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

// --- JSON ---

using Json = nlohmann::ordered_json;

Json json(const Counters& c) {
  Json all = Json::object();
  for (const NamedCounter& n : named_counters) all[std::string(n.name)] = c.*n.counter;
  return all;
}

Json json(const Setting& setting) {
  Json all = Json::object();
  for (const Knob knob : knobs) {
    const std::string value = value_of(setting, knob);
    if (value.empty()) continue;
    const std::string name(name_of(knob));
    const std::optional<double> as_number = number_of(setting, knob);
    if (knob == Knob::order || knob == Knob::elements)
      all[name] = as_number ? Json(std::lround(*as_number)) : Json(value);
    else
      all[name] = as_number ? Json(*as_number) : Json(value);
  }
  return all;
}

Json json(const AccuracyStudy& study, const TrialPoint& point) {
  const Trial& trial = point.trial;
  Json all = {{"setting", json(point.setting)},
              {"text", point.text},
              {"state", trial.complete  ? "complete"
                        : trial.stopped ? "stopped"
                                        : "failed"},
              {"failure", trial.failure},
              {"cpu", trial.cpu},
              {"cpu_stepping", trial.cpu_stepping},
              {"repeats", trial.repeats},
              {"memory", trial.memory},
              {"nodes", trial.nodes},
              {"unknowns", trial.unknowns},
              {"multipliers", trial.multipliers},
              {"counters", json(trial.counters)}};
  Json errors = Json::array();
  for (std::size_t q = 0; q < point.errors.size() && q < study.quantities.size(); ++q) {
    const QuantityError& e = point.errors[q];
    Json one = {{"quantity", study.quantities[q].name}, {"known", e.known}};
    if (e.known) {
      one["rms"] = e.rms;
      one["largest"] = e.largest;
      one["at"] = e.at;
      one["below_reference"] = e.below_reference;
    }
    errors.push_back(std::move(one));
  }
  all["errors"] = std::move(errors);
  return all;
}

std::string csv_header(const AccuracyStudy& study) {
  std::string header = "run";
  for (const Knob knob : knobs) header += "," + std::string(name_of(knob));
  header +=
      ",text,state,failure,cpu,cpu_stepping,repeats,memory,nodes,unknowns,multipliers,steps,"
      "substeps,retries,"
      "rejected,tolerant,restarts,passed_kinks,iterations,residuals,tangents,factorizations,"
      "substeps_of_five_stages,substeps_of_seven_stages";
  for (const Quantity& q : study.quantities)
    for (const char* what : {"rms", "largest", "at", "below_reference", "front"})
      header += "," + csv_cell(q.name + "." + what);
  return header;
}

std::string csv_row(const AccuracyStudy& study, std::size_t i) {
  const TrialPoint& point = study.points[i];
  const Trial& trial = point.trial;
  const Counters& c = trial.counters;
  std::string line = std::to_string(i + 1);
  for (const Knob knob : knobs) line += "," + csv_cell(value_of(point.setting, knob));
  line += "," + csv_cell(point.text) + "," +
          (trial.complete  ? "complete"
           : trial.stopped ? "stopped"
                           : "failed") +
          "," + csv_cell(trial.failure);
  line += fmt::format(",{},{},{},{:.0f},{},{},{}", number(trial.cpu), number(trial.cpu_stepping),
                      trial.repeats, trial.memory, trial.nodes, trial.unknowns, trial.multipliers);
  for (const NamedCounter& n : named_counters) line += fmt::format(",{}", c.*n.counter);
  for (std::size_t q = 0; q < study.quantities.size(); ++q) {
    if (!known(study, i, q)) {
      line += ",,,,,0";
      continue;
    }
    const QuantityError& e = point.errors[q];
    line += fmt::format(",{},{},{},{:d},{:d}", number(e.rms), number(e.largest), number(e.at),
                        e.below_reference, on_front(study, i, q));
  }
  return line;
}

std::string csv_of(const AccuracyStudy& study) {
  std::string text;
  const auto comment = [&](const std::string& words) { text += "# " + one_line(words) + "\n"; };
  comment(study.model + ": error against CPU time");
  comment("file: " + study.file);
  comment("command: " + study.command);
  comment("date: " + study.date);
  comment("machine: " + study.machine);
  for (const auto& [name, value] : study.build) comment(name + ": " + value);
  comment("runs: " + tally_text(study));
  comment("reference: " + study.reference);
  comment("norm: " + norm_text(study));
  for (const Quantity& q : study.quantities) {
    const std::string until = until_text(study, q);
    comment(fmt::format(
        "quantity {}: divided by {:.9g} {}; error of the reference itself {} rms, "
        "{} largest{}",
        q.name, q.scale, q.unit.empty() ? "(no unit)" : q.unit,
        reference_text(q, &Quantity::reference_rms),
        reference_text(q, &Quantity::reference_largest), until.empty() ? "" : "; known " + until));
  }
  comment("units: step, cpu and cpu_stepping in s, memory in bytes, errors relative, at: " +
          place_label(study));
  for (const std::string& note : study.notes) comment("note: " + note);

  text += csv_header(study) + "\n";
  for (std::size_t i = 0; i < study.points.size(); ++i) text += csv_row(study, i) + "\n";
  return text;
}

std::string json_of(const AccuracyStudy& study) {
  Json all = Json::object();
  all["model"] = study.model;
  all["file"] = study.file;
  all["date"] = study.date;
  all["command"] = study.command;
  all["machine"] = study.machine;
  Json& build = all["build"] = Json::object();
  for (const auto& [name, value] : study.build) build[name] = value;
  all["place"] = study.place;
  all["places"] = study.places;
  all["end"] = study.end;
  all["norm"] = norm_text(study);
  Json ways = Json::array();
  for (const TrialPoint& way : study.ways) ways.push_back(json(study, way));
  all["reference"] = {{"made", study.reference},
                      {"ways", std::move(ways)},
                      {"columns", study.truth.columns},
                      {"units", study.truth.units}};
  Json quantities = Json::array();
  for (std::size_t q = 0; q < study.quantities.size(); ++q) {
    const Quantity& quantity = study.quantities[q];
    quantities.push_back(
        {{"name", quantity.name},
         {"unit", quantity.unit},
         {"columns", quantity.columns},
         {"scale", quantity.scale},
         {"reference_rms", quantity.reference_rms},
         {"reference_largest", quantity.reference_largest},
         {"until", quantity.until},
         {"front", q < study.fronts.size() ? Json(study.fronts[q]) : Json::array()}});
  }
  all["quantities"] = std::move(quantities);
  Json points = Json::array();
  for (const TrialPoint& point : study.points) points.push_back(json(study, point));
  all["points"] = std::move(points);
  Json fits = Json::array();
  for (const OrderFit& fit : study.fits)
    fits.push_back({{"quantity", study.quantities[fit.quantity].name},
                    {"knob", name_of(fit.knob)},
                    {"points", fit.points},
                    {"slope", fit.slope},
                    {"spread", fit.spread},
                    {"theory", fit.theory ? Json(*fit.theory) : Json()}});
  all["fits"] = std::move(fits);
  Json advice = Json::array();
  for (const Advice& a : study.advice)
    advice.push_back({{"quantity", study.quantities[a.quantity].name},
                      {"accuracy", a.accuracy},
                      {"point", a.point},
                      {"sentence", sentence_of(study, a)}});
  all["advice"] = std::move(advice);
  all["notes"] = study.notes;
  all["whole"] = study.whole();
  all["untried"] = study.untried;
  all["seconds"] = study.seconds;
  all["budget"] = study.budget;
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string markdown_of(const AccuracyStudy& study) {
  const auto plain = [](std::string_view words) { return markdown_escaped(words); };
  std::string text;
  for (std::size_t q = 0; q < study.quantities.size(); ++q) {
    const Quantity& quantity = study.quantities[q];
    if (!(quantity.until > 0.0)) {
      text += "- " + plain(quantity.name) +
              ": no accuracy can be told, refinements do not approach each other\n";
      continue;
    }
    const std::vector<Range> ranges = ranges_of(study, q);
    for (const Range& range : ranges)
      text += "- " + plain(sentence_of(study, {q, range.to, range.point})) + "\n";
    if (ranges.empty()) text += "- " + plain(quantity.name) + ": no power of ten was reached\n";
  }
  text += "\n" + plain(capital(tally_text(study))) + ", in " + seconds_text(study.seconds) +
          " s on " + plain(study.machine) + ". Reference: " + plain(study.reference) + "\n";
  for (const Quantity& quantity : study.quantities)
    if (quantity.until > 0.0)
      text += fmt::format("Its own error for {}: {}.\n", plain(quantity.name),
                          reference_text(quantity, &Quantity::reference_rms));
  for (const std::string& note : study.notes) text += "\nNote: " + plain(note) + "\n";
  return text;
}

}  // namespace
}  // namespace mbd::study_report

namespace mbd {

std::string to_text(const AccuracyStudy& study) { return study_report::text_of(study, nullptr); }
std::string to_text(const AccuracyStudy& study, const Scene& scene) {
  return study_report::text_of(study, &scene);
}

std::string to_csv(const AccuracyStudy& study) { return study_report::csv_of(study); }
std::string to_json(const AccuracyStudy& study) { return study_report::json_of(study); }
std::string to_markdown(const AccuracyStudy& study) { return study_report::markdown_of(study); }
std::string sentence(const AccuracyStudy& study, const Advice& advice) {
  return study_report::sentence_of(study, advice);
}

}  // namespace mbd
