#include "libmbd/results/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string_view>
#include <vector>

#include "libmbd/scene/label.hpp"
#include "libmbd/scene/transient.hpp"

namespace mbd {
namespace {

constexpr std::size_t margin = 15;  // of what stands right of the names of lines
constexpr char glue = '\t';         // a blank at which no line is broken

// Appends a line that begins with `name`, broken at blanks; what stands right of it is indented.
void line(std::string& text, std::string_view name, std::string_view words, std::size_t indent) {
  std::string head(name);
  if (!name.empty() && letters(name) < indent) head.append(indent - letters(name), ' ');
  text += wrapped(std::move(head), words, indent);
}

void item(std::string& text, std::string_view name, std::string_view words) {
  line(text, name, words, margin);
}

std::string plural(long n, std::string_view one, std::string_view many = {}) {
  const std::string several = many.empty() ? std::string(one) + "s" : std::string(many);
  return fmt::format("{}{}{}", n, glue, n == 1 ? one : several);
}

// "36 s simulated", "0.52 s of 36 s", "equilibrium at load factor 1".
std::string way(const RunReport& report) {
  if (report.path)
    return fmt::format("{}load factors from {:.9g} to {:.9g}",
                       report.complete() ? "a path of equilibria over " : "", report.path_load[0],
                       report.path_load[1]);
  if (!report.transient)
    return fmt::format("{}load factor {:.9g}", report.complete() ? "equilibrium at " : "",
                       report.load_factor);
  if (report.complete()) return fmt::format("{:.9g} s simulated", report.t);
  return fmt::format("{:.9g} s of {:.9g} s", report.t, report.transient->duration);
}

std::string steps(const Counters& c, std::string_view one, std::string_view many) {
  std::string text = plural(c.steps, one, many);
  const auto more = [&](long n, std::string_view single, std::string_view several) {
    if (n > 0) text += ", " + plural(n, single, several);
  };
  more(c.substeps == c.steps ? 0 : c.substeps, "substep", "substeps");
  if (c.of_five_stages > 0) text += fmt::format(", {}\tof\tfive\tstages", c.of_five_stages);
  if (c.of_seven_stages > 0) text += fmt::format(", {}\tof\tseven\tstages", c.of_seven_stages);
  if (c.rejected > 0) text += fmt::format(", {}\trejected", c.rejected);
  more(c.retries, "retry", "retries");
  more(c.restarts, "restart", "restarts");
  more(c.tolerant, "rank-tolerant\tstep", "rank-tolerant\tsteps");
  return text;
}

void solver(std::string& text, std::string_view name, const std::string& steps, const Counters& c,
            int most, const LinearFacts& linear = {}) {
  std::string words = steps + "; " + plural(c.iterations, "iteration");
  if (c.iterations > c.steps * most)  // of a path: others locate its special points
    words += fmt::format("\t(at\tmost\t{}\ta\tstep)", most);
  else if (c.steps > 0)
    words += fmt::format("\t({:.3g}\ta\tstep, at\tmost\t{})",
                         static_cast<double>(c.iterations) / static_cast<double>(c.steps), most);
  words += "; " + plural(c.tangents, "tangent") + ", " + plural(c.factorizations, "factorisation");
  if (linear.fallbacks > 0) words += fmt::format(",\t{}\tof\tthem\tby\tKLU", linear.fallbacks);
  item(text, name, words);
}

// "radau, tolerance 1e-08".
std::string method(const TransientScene& transient) {
  const std::string_view name = name_of(transient.method);
  if (transient.tolerance) return fmt::format("{}, tolerance\t{:g}", name, *transient.tolerance);
  return fmt::format("{}, step\t{:g}\ts", name, transient.step.value_or(0.0));
}

void step_sizes(std::string& text, const RunReport& report) {
  const StepSizes& sizes = report.step_sizes;
  if (!report.transient->tolerance || report.transient_counters.steps == 0) return;
  std::string words;
  // All steps may have been cut, by a breakpoint or the end.
  if (sizes.least > 0.0) words = fmt::format("from\t{:.2g}\ts ", sizes.least);
  words += fmt::format("to\t{:.2g}\ts; ", sizes.most);
  if (report.transient->method == TimeMethod::ida)
    words += "what it estimates of errors is not given";
  else
    words += fmt::format(
        "estimated errors: {:.2g} of what is allowed in a step, at most; in all, "
        "{:.1e}\tm and\t{:.1e}\trad",
        sizes.worst_error, sizes.position_error, sizes.rotation_error);
  if (report.transient->errors == ErrorsOf::motion)
    words += fmt::format("; of velocities up to {:.1e} of the fastest, which are not held",
                         sizes.velocity_left);
  item(text, "step sizes", words);
}

void laws(std::string& text, const LawFacts& facts) {
  if (facts.laws == 0) return;
  std::string words = fmt::format("{};", facts.laws);
  if (facts.longest_step > 0.0)
    words += fmt::format(" steps of\t{:.2g}\ts resolve them, which is needed near t =\t{:.6g}\ts",
                         facts.longest_step, facts.at);
  else
    words += " none changes within the run so fast that steps could pass over it";
  if (!facts.unresolved.empty())
    words += fmt::format("; NOT\tRESOLVED: {}", facts.unresolved.size());
  item(text, "laws of time", words);
}

void accuracy(std::string& text, const ChosenAccuracy& chosen) {
  const std::string of =
      chosen.quantities.empty() ? "" : fmt::format(" of {}", fmt::join(chosen.quantities, ", "));
  std::string words = fmt::format("requested\t{:.1e}{}; ", chosen.requested, of) +
                      (chosen.believed ? fmt::format("believed\t{:.1e}, rms of {}",
                                                     *chosen.believed, chosen.quantity)
                                       : std::string("believed: not known"));
  if (!chosen.met) words += "; NOT\tMET: " + chosen.reason;
  item(text, "accuracy", words);
}

void seconds(std::string& text, const RunReport& report) {
  struct Part {
    std::string_view name;
    Seconds seconds;
    bool done;
  };
  const Part parts[] = {{"compile", report.compile, true},
                        {report.path ? "path" : "static", report.equilibrium,
                         report.statics.has_value() || report.path.has_value()},
                        {"transient", report.integration, report.transient.has_value()},
                        {"output", report.output, true},
                        {"error estimate", report.estimate, report.time_error.has_value()}};
  const auto show = [&](std::string_view name, double Seconds::*clock) {
    double sum = 0.0;
    std::string words;
    for (const Part& part : parts) {
      if (!part.done) continue;
      sum += part.seconds.*clock;
      words +=
          fmt::format("{}{}\t{:.2g}", words.empty() ? "" : ", ", part.name, part.seconds.*clock);
    }
    item(text, name, fmt::format("{:.3g} s: {}", sum, words));
  };
  show("wall time", &Seconds::wall);
  show("CPU time", &Seconds::cpu);
}

void constraints(std::string& text, const RunReport& report) {
  const auto show = [&](std::string_view name, const WorstConstraint& worst,
                        std::string_view units) {
    if (worst.where.empty()) return;
    std::string words = fmt::format("{:.2g}\t{}, {}", worst.value, units, worst.where);
    if (report.transient) words += fmt::format(", at\t{:.9g}\ts", worst.time);
    item(text, name, words);
  };
  if (report.position.where.empty() && report.velocity.where.empty()) return;
  text += "largest residual of a constraint\n";
  show("  position", report.position, "m\tor\trad");
  if (report.transient) show("  velocity", report.velocity, "m/s\tor\trad/s");
}

// Numbers with their names, right-aligned: what went in = what is there.
void energy(std::string& text, const RunReport& report) {
  if (report.sampled_states == 0) return;
  struct Line {
    std::string_view sign;
    std::string number, name;
  };
  std::vector<Line> lines;
  const auto add = [&](std::string_view sign, double value, std::string_view name) {
    lines.push_back({sign, fmt::format("{:.6g}", value), std::string(name)});
  };
  const Work& work = report.work;
  if (report.transient) {
    add("", report.energy_start.total(), "at the start");
    if (work.loads != 0.0) add("+", work.loads, "work of loads");
    if (work.drives != 0.0) add("+", work.drives, "work of drives");
    if (work.damping < 0.0) add("-", -work.damping, "taken out by damping");
    if (work.damping > 0.0) add("+", work.damping, "put in by dampers");
    const double out = report.dissipated(), moved = report.energy_moved();
    const std::string part = moved > 0.0 ? fmt::format(", {:.2g} % of the energy that moved",
                                                       100.0 * std::abs(out) / moved)
                                         : std::string();
    const std::string size = fmt::format("{:.3g}", std::abs(out));
    if (out < 0.0) lines.push_back({"+", size, "put in by the integrator" + part});
    add("=", report.energy_end.total(), "at the end");
    if (out >= 0.0) lines.push_back({"+", size, "taken out by the integrator" + part});
  } else {
    add("", report.energy_end.strain, "strain");
    if (report.energy_end.potential != 0.0) add("", report.energy_end.potential, "potential");
  }
  std::size_t longest = 0;
  for (const Line& line : lines) longest = std::max(longest, line.number.size());
  text += "energy [J]\n";
  for (const Line& line : lines) {
    std::string row =
        fmt::format("  {:1} {:>{}}  {}\n", line.sign, line.number, longest, line.name);
    constexpr std::string_view article = "of the energy";
    if (const std::size_t at = row.find(article); at != row.npos && row.size() > 81)
      row.replace(at, article.size(), "of energy");
    text += row;
  }
}

// One line, or, of a run that was certified, one for each check and the reasons of those that do not pass.
void certificate(std::string& text, const Certificate& certificate) {
  if (certificate.checks.empty()) return;
  std::string words(name_of(certificate.verdict()));
  std::size_t others = 0;
  for (const Check& check : certificate.checks) others += check.verdict != Verdict::pass ? 1 : 0;
  if (const Check* const culprit = certificate.culprit()) {
    words += fmt::format(": {} {}", culprit->name, culprit->value_in_words());
    if (!culprit->where.empty()) words += ", " + culprit->where;
    if (others > 1) words += fmt::format("; {}\tmore", others - 1);
  } else {
    words += fmt::format(", {}", plural(std::ssize(certificate.checks), "check"));
  }
  const auto listed = [](const std::vector<std::string>& phrases) {
    std::string list;
    for (std::size_t i = 0; i < phrases.size(); ++i)
      list += (i == 0 ? "" : i + 1 == phrases.size() ? " and " : ", ") + phrases[i];
    return list;
  };
  const auto check_named = [&](std::string_view name) {
    return std::find_if(certificate.checks.begin(), certificate.checks.end(),
                        [name](const Check& check) { return check.name == name; });
  };
  if (const auto time = check_named("error in time");
      time != certificate.checks.end() && certificate.culprit() != &*time)
    words += time->has_value()
                 ? fmt::format("; error in time about {:.1g} of the motion", time->value)
                 : std::string("; error in time not known");
  item(text, "certificate", words);
  const std::vector<std::string> covers = certificate.covers();
  item(text, "  covers",
       fmt::format("{}; not {}", covers.empty() ? "its checks in report.json" : listed(covers),
                   listed(certificate.not_covered())));
  if (!certificate.certified) return;
  for (const Check& check : certificate.checks) {
    std::string about = fmt::format("{}: {}", check.name, check.value_in_words());
    if (!check.where.empty()) about += ", " + check.where;
    if (check.verdict != Verdict::pass && check.has_value()) about += "; " + check.why;
    line(text, fmt::format("  {}", name_of(check.verdict)), about, 8);
  }
}

// As wide as what stands in it. Where that is too wide, what was expected is left out, which `got` and
// `error` tell; then a quantity too long stands on a line of its own.
void expectations(std::string& text, const RunReport& report) {
  if (report.expects.empty()) return;
  constexpr std::size_t quantity = 1, expected = 2;
  std::size_t met = 0;
  using Row = std::array<std::string, 6>;
  std::vector<Row> rows = {{"", "quantity", "expected", "got", "error", "allowed"}};
  for (const ExpectResult& result : report.expects) {
    if (result.pass()) ++met;
    rows.push_back({result.pass() ? "ok" : "FAIL", result.what,
                    fmt::format("{:.9g}", result.expected),
                    result.got ? fmt::format("{:.9g}", *result.got) : "not reached",
                    result.got ? fmt::format("{:.1e}", *result.got - result.expected) : "",
                    fmt::format("{:.1e}", result.tolerance)});
  }
  constexpr std::size_t gap = 2;
  std::array<std::size_t, 6> size{};
  for (const Row& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) size[i] = std::max(size[i], letters(row[i]));
  std::size_t total = size[0];
  for (std::size_t i = quantity; i < size.size(); ++i) total += gap + size[i];
  const bool all = total <= line_width;
  if (!all) total -= gap + size[expected];
  if (total > line_width) size[quantity] -= std::min(size[quantity], total - line_width);

  line(text, "",
       fmt::format("{} of {} met", met, plural(std::ssize(report.expects), "expectation")), 0);
  for (const Row& row : rows) {
    text.append(row[0]).append(size[0] + gap - letters(row[0]), ' ').append(row[quantity]);
    std::size_t column = letters(row[quantity]);
    if (column > size[quantity]) {
      text.append("\n").append(size[0] + gap, ' ');
      column = 0;
    }
    text.append(size[quantity] - column, ' ');
    for (std::size_t i = expected; i < row.size(); ++i)
      if (i != expected || all) text.append(gap + size[i] - letters(row[i]), ' ').append(row[i]);
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  }
}

void special_points(std::string& text, const RunReport& report) {
  for (const SpecialPoint& point : report.special) {
    std::string words = fmt::format("load factor {:.10g}", point.load_factor);
    if (point.branch != 0) words += fmt::format(", branch {}", point.branch);
    if (point.before && point.after)
      words += fmt::format(", negative eigenvalues {} -> {}", *point.before, *point.after);
    if (point.event == PathEvent::bifurcation) words += ", mode: " + point.motion + " most";
    item(text, fmt::format("{} {}", name_of(point.event), point.number), words);
  }
  if (!report.path_end.empty()) item(text, "end", report.path_end);
}

void files(std::string& text, const RunReport& report) {
  if (report.results.empty()) return;
  const std::filesystem::path directory = report.results.front().parent_path();
  text += "results in " + (directory.empty() ? "." : directory.string()) + "\n";
  for (const std::filesystem::path& file : report.results) {
    const std::string name = file.filename().string();
    std::string what;
    if (name == "history.csv" || name == "path.csv")
      what = fmt::format("{}: {} and what is recorded", plural(report.rows, "row"),
                         report.transient ? "time" : "load factor");
    else if (name == "shapes.svg")
      what = "deformed shapes";
    else if (name == "history.svg" || name == "path.svg")
      what = "its plots, for a browser";
    else if (name == "motion.bin")
      what = "the motion of all nodes, for mbd view";
    else if (name == "run.h5")
      what = "the whole run in one file, for h5py and the like";
    else if (name == "view.html")
      what = "the motion as a page, for a browser";
    else if (name == "modes.csv" || name == "modes.json")
      what = name == "modes.csv" ? "modes of small motions" : "the same, with shapes";
    else if (name == "mac.csv" || name == "mac.json")
      what = "how alike the modes are";
    else if (name == "report.json")
      what = "settings, counts, costs and checks of this run";
    item(text, "  " + name, what);
  }
}

}  // namespace

std::string summary(const RunReport& report) {
  std::string text;
  const std::string name = excerpt(report.model);
  if (report.complete()) {
    line(text, "", fmt::format("{}: {}", name, way(report)), 2);
  } else {
    line(text, "", fmt::format("{}: FAILED at {}: {}", name, way(report), report.failure), 2);
    if (!report.results.empty()) text += "The results up to there are kept.\n";
  }
  if (report.statics)
    solver(text, "static", steps(report.static_counters, "load step", "load steps"),
           report.static_counters, report.most_static_iterations, report.static_linear);
  if (report.path) {
    solver(text, "path", steps(report.static_counters, "step", "steps"), report.static_counters,
           report.most_static_iterations);
    special_points(text, report);
  }
  if (report.transient) {
    solver(text, "transient",
           method(*report.transient) + "; " + steps(report.transient_counters, "step", "steps"),
           report.transient_counters, report.most_iterations, report.transient_linear);
    step_sizes(text, report);
    laws(text, report.laws);
  }
  if (report.accuracy) accuracy(text, *report.accuracy);
  seconds(text, report);
  constraints(text, report);
  energy(text, report);
  certificate(text, report.certificate);
  for (const std::string& note : report.notes) line(text, "note:", note, 6);
  expectations(text, report);
  files(text, report);
  return text;
}

}  // namespace mbd
