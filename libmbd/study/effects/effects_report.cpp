#include "libmbd/study/effects/effects_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libmbd/pictures/page.hpp"
#include "libmbd/study/accuracy/accuracy_words.hpp"
#include "libmbd/text/svg.hpp"
#include "libmbd/text/tables.hpp"
#include "libmbd/text/text.hpp"

namespace mbd::effects_report {
namespace {

using namespace study;
using Json = nlohmann::ordered_json;

// What an effect takes of the time, in per cent: "4", "-12" of one that is cheaper to simulate than to leave out.
std::string percent(double ratio) {
  const double share = 100.0 * (1.0 - ratio);
  return fmt::format("{:.0f}", std::abs(share) < 0.5 ? 0.0 : share);
}

std::string share_text(const Paired& cpu) {
  if (cpu.ratios.empty()) return "-";
  return cpu.ratios.size() == 1 ? percent(cpu.median()) + " %"
                                : fmt::format("{} % ({} to {})", percent(cpu.median()),
                                              percent(cpu.most()), percent(cpu.least()));
}

std::string instructions_text(const EffectRun& run) {
  return run.instructions ? fmt::format("{:.1f} %", 100.0 * (1.0 - *run.instructions)) : "-";
}

// "2e-6"; "3e-7*" below what the whole model's own steps contribute.
std::string change_text(const EffectsStudy& study, std::size_t quantity, const Change& change) {
  if (!change.known) return "gone";
  const double own = study.quantities[quantity].own;
  return number_text(change.rms) + (change.rms < own ? "*" : "");
}

std::string worst_text(const EffectsStudy& study, const EffectRun& run) {
  return change_text(study, run.culprit(), run.changes[run.culprit()]);
}

// Quantities that no longer exist: "M.force and M.moment are gone".
std::string gone_text(const EffectsStudy& study, const EffectRun& run) {
  std::string text;
  for (std::size_t q = 0; q < run.changes.size(); ++q)
    if (!run.changes[q].known) text += (text.empty() ? "" : ", ") + study.quantities[q].name;
  return text.empty() ? text : "; without " + text;
}

std::string sentence_of(const EffectsStudy& study, const EffectRun& run) {
  const std::string name = run.ablation.effect;
  if (!run.complete()) return name + ": without it the model does not run: " + run.trial.failure;
  const std::string share =
      run.cpu.ratios.empty() ? "" : percent(run.cpu.median()) + " % of the time, ";
  const std::size_t q = run.culprit();
  if (!run.changes[q].known) return name + ": " + share + "nothing recorded is left";
  return fmt::format("{}: {}changes {} by {}{}", name, share, study.quantities[q].name,
                     worst_text(study, run), gone_text(study, run));
}

std::string norm_text(const EffectsStudy& study) {
  return fmt::format(
      "change: root mean square over {} places of the length of the difference, over the largest "
      "length of the whole model's quantity",
      study.whole.findings.at.size());
}

std::string own_text(const EffectsStudy& study) {
  double most = 0.0;
  for (const EffectQuantity& q : study.quantities) most = std::max(most, q.own);
  return most > 0.0 ? fmt::format(
                          "the whole model's own steps contribute up to {} (half the step or a "
                          "tenth of the tolerance); *: a change below that of its quantity",
                          bound_text(most))
                    : std::string();
}

std::string cheapest_text(const EffectsStudy& study) {
  const CheapestModel& c = study.cheapest;
  const std::string tolerance = number_text(study.tolerance, 1);
  if (c.left_out.empty())
    return fmt::format("within {} nothing that saves time may be left out", tolerance);
  std::string text = fmt::format("within {}: without {} of {} effects", tolerance,
                                 c.left_out.size(), study.runs.size());
  if (!c.verified) return text + ", not verified";
  return text +
         fmt::format(": {} of the time ({} times as fast), changes at most {}; verified over {}",
                     number_text(c.cpu.median()), number_text(1.0 / c.cpu.median()),
                     number_text(c.worst()),
                     study.end < study.whole_end ? "the whole of it" : "the run");
}

std::string snippet_of(const EffectsStudy& study) {
  std::string text;
  for (const std::size_t i : study.cheapest.left_out) text += study.runs[i].ablation.change + "\n";
  return text;
}

std::string command_of_cheapest(const EffectsStudy& study) {
  std::string text = "mbd run " + study.file;
  for (const std::size_t i : study.cheapest.left_out)
    text += " --without " + study.runs[i].ablation.key;
  return text;
}

std::string whole_text(const EffectsStudy& study) {
  const Trial& whole = study.whole;
  return fmt::format("{} s of CPU time a run, {} steps, {} unknowns, {} effects",
                     seconds_text(whole.cpu_stepping), whole.counters.steps, whole.unknowns,
                     study.runs.size());
}

std::string text_of(const EffectsStudy& study) {
  std::string text =
      wrapped("", fmt::format("{}: what each effect costs and is worth", excerpt(study.model)), 2);
  paragraph(text, "whole", whole_text(study));
  paragraph(text, "norm", norm_text(study));
  if (const std::string own = own_text(study); !own.empty()) paragraph(text, "own", own);
  for (const std::string& note : study.notes) paragraph(text, "note", note);
  std::vector<std::vector<std::string>> rows = {
      {"change", "of", "time", "instructions", "without"}};
  for (const EffectRun& run : study.runs) {
    if (!run.complete()) {
      rows.push_back({"-", "-", "-", "-",
                      run.ablation.effect + ": does not run: " + excerpt(run.trial.failure)});
      continue;
    }
    rows.push_back({worst_text(study, run), study.quantities[run.culprit()].name,
                    share_text(run.cpu), instructions_text(run),
                    run.ablation.effect + gone_text(study, run)});
  }
  if (!study.instructions)
    for (auto& row : rows) row.erase(row.begin() + 3);
  text += "\n";
  table(text, rows);
  text += "\n";
  paragraph(text, "cheapest", cheapest_text(study));
  if (!study.cheapest.left_out.empty()) {
    std::string all = snippet_of(study);
    for (std::string_view lines = all; !lines.empty();) {
      const std::size_t end = lines.find('\n');
      text += "    " + std::string(lines.substr(0, end)) + "\n";
      lines.remove_prefix(end == std::string_view::npos ? lines.size() : end + 1);
    }
    text += "  " + command_of_cheapest(study) + "\n";
  }
  return text;
}

std::string optional_number(bool known, double value) {
  return known ? fmt::format("{}", value) : std::string();
}

std::string csv_of(const EffectsStudy& study) {
  std::string text = fmt::format(
      "# {}\n# file: {}\n# date: {}\n# machine: {}\n# {}\n# time: CPU of stepping, other over "
      "whole in "
      "turn\n# tolerance: {}\n# cheapest: {}\n",
      one_line(study.model), one_line(study.file), study.date, one_line(study.machine),
      norm_text(study), study.tolerance, one_line(cheapest_text(study)));
  text +=
      "without,effect,complete,failure,time,time_least,time_most,instructions,steps,iterations,"
      "factorizations,unknowns,memory_bytes,in_cheapest";
  for (const EffectQuantity& q : study.quantities)
    text += "," + csv_cell(q.name + ".rms") + "," + csv_cell(q.name + ".largest");
  text += "\n";
  for (std::size_t i = 0; i < study.runs.size(); ++i) {
    const EffectRun& run = study.runs[i];
    const bool timed = !run.cpu.ratios.empty();
    const Counters& c = run.trial.counters;
    text +=
        csv_cell(run.ablation.key) + "," + csv_cell(run.ablation.effect) + "," +
        (run.complete() ? "1" : "0") + "," + csv_cell(one_line(run.trial.failure)) + "," +
        optional_number(timed, run.cpu.median()) + "," + optional_number(timed, run.cpu.least()) +
        "," + optional_number(timed, run.cpu.most()) + "," +
        optional_number(run.instructions.has_value(), run.instructions.value_or(0.0)) +
        fmt::format(",{},{},{},{},{:.0f},{}", c.steps, c.iterations, c.factorizations,
                    run.trial.unknowns, run.trial.memory,
                    std::count(study.cheapest.left_out.begin(), study.cheapest.left_out.end(), i));
    for (std::size_t q = 0; q < study.quantities.size(); ++q) {
      const Change change = q < run.changes.size() ? run.changes[q] : Change{};
      text += "," + optional_number(change.known, change.rms) + "," +
              optional_number(change.known, change.largest);
    }
    text += "\n";
  }
  return text;
}

Json json(const EffectsStudy& study, const std::vector<Change>& changes) {
  Json all = Json::array();
  for (std::size_t q = 0; q < changes.size(); ++q)
    all.push_back({{"quantity", study.quantities[q].name},
                   {"rms", changes[q].known ? Json(changes[q].rms) : Json()},
                   {"largest", changes[q].known ? Json(changes[q].largest) : Json()},
                   {"at", changes[q].known ? Json(changes[q].at) : Json()}});
  return all;
}

std::string json_of(const EffectsStudy& study) {
  Json all = Json::object();
  all["model"] = study.model;
  all["file"] = study.file;
  all["date"] = study.date;
  all["command"] = study.command;
  all["machine"] = study.machine;
  for (const auto& [name, value] : study.build) all["build"][name] = value;
  all["norm"] = norm_text(study);
  all["tolerance"] = study.tolerance;
  all["compared_up_to"] = study.end;
  all["end"] = study.whole_end;
  Json quantities = Json::array();
  for (const EffectQuantity& q : study.quantities)
    quantities.push_back({{"name", q.name},
                          {"unit", q.unit},
                          {"scale", q.scale},
                          {"is_zero", q.is_zero},
                          {"own_error", q.own}});
  all["quantities"] = std::move(quantities);
  all["whole"] = {{"cpu", study.whole.cpu_stepping},
                  {"steps", study.whole.counters.steps},
                  {"unknowns", study.whole.unknowns}};
  Json effects = Json::array();
  for (const EffectRun& run : study.runs)
    effects.push_back({{"without", run.ablation.key},
                       {"effect", run.ablation.effect},
                       {"change_of_model", run.ablation.change},
                       {"complete", run.complete()},
                       {"failure", run.trial.failure},
                       {"time_ratios", run.cpu.ratios},
                       {"instructions", run.instructions ? Json(*run.instructions) : Json()},
                       {"steps", run.trial.counters.steps},
                       {"unknowns", run.trial.unknowns},
                       {"changes", json(study, run.changes)},
                       {"sentence", sentence_of(study, run)}});
  all["effects"] = std::move(effects);
  Json keys = Json::array();
  for (const std::size_t i : study.cheapest.left_out) keys.push_back(study.runs[i].ablation.key);
  all["cheapest"] = {{"without", std::move(keys)},
                     {"verified", study.cheapest.verified},
                     {"time_ratios", study.cheapest.cpu.ratios},
                     {"changes", json(study, study.cheapest.changes)},
                     {"snippet", snippet_of(study)}};
  all["notes"] = study.notes;
  all["interrupted"] = study.interrupted;
  all["seconds"] = study.seconds;
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string markdown_of(const EffectsStudy& study) {
  const auto plain = [](std::string_view words) { return markdown_escaped(words); };
  const bool counted = study.instructions.has_value();
  std::string text = counted ? "| without | largest change | of | time | instructions |\n"
                               "|---|--:|---|--:|--:|\n"
                             : "| without | largest change | of | time |\n|---|--:|---|--:|\n";
  for (const EffectRun& run : study.runs)
    text +=
        run.complete()
            ? fmt::format("| {} | {} | {} | {} |{}\n",
                          plain(run.ablation.effect + gone_text(study, run)),
                          worst_text(study, run), plain(study.quantities[run.culprit()].name),
                          share_text(run.cpu), counted ? " " + instructions_text(run) + " |" : "")
            : fmt::format("| {} | does not run: {} | | |{}\n", plain(run.ablation.effect),
                          plain(excerpt(run.trial.failure)), counted ? " |" : "");
  text += "\n" + plain(capital(cheapest_text(study))) + ".\n";
  if (!study.cheapest.left_out.empty())
    text += "\n```\n" + snippet_of(study) + command_of_cheapest(study) + "\n```\n";
  text += "\n" + plain(capital(norm_text(study))) +
          "; time: share of the CPU time of stepping, in "
          "turn with the whole model, median (least to most). " +
          plain(capital(whole_text(study))) + ", on " + plain(study.machine) + ".\n";
  if (const std::string own = own_text(study); !own.empty())
    text += "\n" + plain(capital(own)) + ".\n";
  for (const std::string& note : study.notes) text += "\nNote: " + plain(note) + ".\n";
  return text;
}

// --- pictures ---

constexpr double both_wide = 720.0, row = 30.0, letter = 13.0, left = 16.0, bars = 300.0;

struct Axis {
  double low, high;  // powers of ten
  double at(double value) const {
    const double x = (std::log10(std::max(value, std::pow(10.0, low))) - low) / (high - low);
    return bars * std::clamp(x, 0.0, 1.0);
  }
};

Axis axis_of(const EffectsStudy& study) {
  double least = study.tolerance, most = study.tolerance;
  for (const EffectRun& run : study.runs)
    if (run.complete() && run.worst() > 0.0) {
      least = std::min(least, run.worst());
      most = std::max(most, run.worst());
    }
  return {std::max(std::floor(std::log10(least)) - 1.0, std::log10(most) - 14.0),
          std::ceil(std::log10(most) + 0.01)};
}

// A time beyond this share of the whole model's has its bar cut: one that is many times what three quarters of the effects
// stay below would flatten all others. Otherwise the largest.
double largest_share(const EffectsStudy& study) {
  constexpr double least = 0.1, times_of_most = 2.5;
  constexpr std::size_t few = 4;
  std::vector<double> shares;
  for (const EffectRun& run : study.runs)
    if (run.complete() && !run.cpu.ratios.empty())
      shares.push_back(std::abs(1.0 - run.cpu.median()));
  if (shares.empty()) return least;
  std::sort(shares.begin(), shares.end());
  const double most = shares[(shares.size() - 1) * 3 / 4];
  return std::max(
      least, shares.size() < few ? shares.back() : std::min(shares.back(), times_of_most * most));
}

enum class Columns { both, changes, times };

// Columns of bars, a line of text above each; black and grey, so that it can be printed.
class Picture {
 public:
  Picture(const EffectsStudy& study, bool with_title, Columns columns)
      : study_(study),
        columns_(columns),
        second_(changes_ ? left + bars + 40.0 : left),
        top_(with_title ? 74.0 : 48.0),
        height_(top_ + (row + 12.0) * static_cast<double>(study.runs.size()) + 52.0) {
    if (with_title)
      write(left, 24.0, study.model + ": what each effect changes and costs",
            "font-weight=\"bold\"");
  }

  std::string draw() {
    draw_axes();
    for (std::size_t i = 0; i < study_.runs.size(); ++i)
      draw_effect(i, top_ + static_cast<double>(i) * (row + 12.0));
    write(left, height_ - 10.0, note(), small);
    return svg::document(
        {.width = columns_ == Columns::both ? both_wide : left + bars + 60.0,
         .height = height_,
         .letters = letter,
         .more = fmt::format(
             "width=\"100%\" role=\"img\" fill=\"#111\" aria-label=\"{}: what each effect {}\"",
             xml_escaped(study_.model),
             columns_ == Columns::both      ? "changes and costs"
             : columns_ == Columns::changes ? "changes"
                                            : "costs")},
        text_);
  }

 private:
  static constexpr std::string_view small = "font-size=\"11\"";

  void write(double x, double y, std::string_view words, std::string_view more = "") {
    text_ += svg::text(x, y, words, more);
  }

  void line(double x, double y, double to, std::string_view dashes) {
    text_ += svg::line(x, y, x, to, fmt::format("stroke=\"#111\" stroke-dasharray=\"{}\"", dashes));
  }
  void bar(const EffectRun& run, double x, double y, double size, bool filled,
           std::string_view number) {
    text_ += svg::rectangle(x, y + 18.0, std::max(size, 0.5), 14.0,
                            fmt::format("fill=\"{}\" stroke=\"#111\"", filled ? "#777" : "#fff"),
                            fmt::format("{}: {}", run.ablation.effect, number));
  }

  void draw_axes() {
    const double bottom = height_ - 50.0;
    if (changes_) {
      write(left, top_ - 20.0, "largest change");
      const double low = axis_.low, high = axis_.high;
      for (double p = low; p <= high + 0.5; p += high - low > 6.0 ? 2.0 : 1.0)
        write(left + bars * (p - low) / (high - low), bottom + 16.0, fmt::format("1e{:.0f}", p),
              p == low ? small : "text-anchor=\"middle\" font-size=\"11\"");
      line(left + axis_.at(study_.tolerance), top_ - 10.0, bottom, "4 3");
    }
    if (times_) {
      write(second_, top_ - 20.0, "CPU time it takes, % of the whole model's");
      line(zero_, top_ - 10.0, bottom, "none");
    }
  }

  void draw_effect(std::size_t i, double y) {
    const EffectRun& run = study_.runs[i];
    const std::vector<std::size_t>& out = study_.cheapest.left_out;
    const bool is_out = std::count(out.begin(), out.end(), i) > 0;
    write(left, y + 12.0, run.ablation.effect + (is_out ? " (left out of the cheapest model)" : ""),
          "stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\"");
    if (!run.complete()) {
      write(left, y + 30.0, "without it the model does not run", "fill=\"#555\"");
      return;
    }
    if (changes_) {
      const std::string worst = worst_text(study_, run);
      bar(run, left, y, axis_.at(run.worst()), run.worst() > study_.tolerance, worst);
      write(left + axis_.at(run.worst()) + 5.0, y + 30.0, worst, small);
    }
    if (!times_ || run.cpu.ratios.empty()) return;
    const double share = 1.0 - run.cpu.median(),
                 drawn = std::clamp(share, -most_share_, most_share_);
    bar(run, zero_ + std::min(0.0, drawn * unit_), y, std::abs(drawn * unit_), share > 0.0,
        share_text(run.cpu));
    if (drawn != share) break_bar(zero_ + 0.88 * drawn * unit_ - 4.0, y + 35.0);
    write(share >= 0.0 ? zero_ - 5.0 : zero_ + 5.0, y + 30.0, percent(run.cpu.median()),
          share >= 0.0 ? "font-size=\"11\" text-anchor=\"end\"" : small);
  }

  // Near its end.
  void break_bar(double x, double y) {
    is_cut_ = true;
    text_ += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}l4 -20l5 0l-4 20z\" fill=\"#fff\"/>\n"
        "<path d=\"M{0:.1f} {1:.1f}l4 -20m5 0l-4 20\" stroke=\"#111\" fill=\"none\"/>\n",
        x, y);
  }

  std::string note() const {
    std::string note;
    if (changes_) note = "Dashed: the tolerance; white bars are within it. ";
    if (columns_ == Columns::both)
      note = "Dashed: the tolerance; white bars on the left are within it. ";
    if (columns_ == Columns::both)
      note += "On the right what is left of zero costs time to leave out.";
    if (columns_ == Columns::times) note = "Left of zero: to leave it out costs time.";
    if (is_cut_) note += " Broken: longer.";
    return note;
  }
  const EffectsStudy& study_;
  Columns columns_;
  bool changes_ = columns_ != Columns::times, times_ = columns_ != Columns::changes;
  double second_, top_, height_;  // of the second column, of the first bar; of all
  Axis axis_ = axis_of(study_);
  double most_share_ = largest_share(study_), zero_ = second_ + 0.5 * bars,
         unit_ = 0.5 * bars / most_share_;
  bool is_cut_ = false;  // one of the bars
  std::string text_;
};

std::string svg_of(const EffectsStudy& study, bool with_title, Columns columns = Columns::both) {
  return Picture(study, with_title, columns).draw();
}

// A row of the table of all quantities.
Json row_of(const EffectsStudy& study, const EffectRun& run) {
  Json changes = Json::array();
  for (std::size_t q = 0; q < run.changes.size(); ++q)
    changes.push_back(change_text(study, q, run.changes[q]));
  return {{"effect", run.ablation.effect},
          {"failure", run.complete() ? Json() : Json(excerpt(run.trial.failure))},
          {"time", share_text(run.cpu)},
          {"steps", run.trial.counters.steps},
          {"unknowns", run.trial.unknowns},
          {"changes", std::move(changes)}};
}

Json facts_of(const EffectsStudy& study) {
  Json all = Json::array();
  const auto fact = [&](const std::string& name, const std::string& value) {
    all.push_back(Json::array({name, value}));
  };
  fact("model", study.file);
  fact("date", study.date);
  fact("machine", study.machine);
  for (const auto& [name, value] : study.build) fact(name, value);
  fact("wall time", seconds_text(study.seconds) + " s");
  return all;
}

// What the page shows is libmbd/pictures/page/effects.html, filled with this.
std::string page_of(const EffectsStudy& study) {
  Json data = Json::object();
  data["by"] = fmt::format("{}, {}. {}.", study.file, study.date, capital(whole_text(study)));
  data["cheapest"] = cheapest_text(study);
  data["change"] =
      study.cheapest.left_out.empty() ? "" : snippet_of(study) + command_of_cheapest(study);
  data["bars"] = {svg_of(study, false, Columns::changes), svg_of(study, false, Columns::times)};
  const std::string own = own_text(study);
  data["norm"] = capital(norm_text(study)) + "." + (own.empty() ? "" : " " + capital(own) + ".");
  data["quantities"] = Json::array();
  for (const EffectQuantity& q : study.quantities) data["quantities"].push_back(q.name);
  data["effects"] = Json::array();
  for (const EffectRun& run : study.runs) data["effects"].push_back(row_of(study, run));
  data["notes"] = study.notes;
  data["facts"] = facts_of(study);
  data["command"] = study.command;
  return filled_page(page_files().effects, page_files().effects_script,
                     study.model + ": what each effect costs and is worth",
                     data.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace
}  // namespace mbd::effects_report

namespace mbd {

std::string to_text(const EffectsStudy& study) { return effects_report::text_of(study); }
std::string sentence(const EffectsStudy& study, const EffectRun& run) {
  return effects_report::sentence_of(study, run);
}

std::string to_csv(const EffectsStudy& study) { return effects_report::csv_of(study); }
std::string to_json(const EffectsStudy& study) { return effects_report::json_of(study); }
std::string to_markdown(const EffectsStudy& study) { return effects_report::markdown_of(study); }
std::string effects_svg(const EffectsStudy& study) { return effects_report::svg_of(study, true); }
std::string effects_page(const EffectsStudy& study) { return effects_report::page_of(study); }

}  // namespace mbd
