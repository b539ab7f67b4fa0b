#include "libmbd/study/accuracy/accuracy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <numeric>
#include <sstream>

#include "libmbd/compile/model.hpp"
#include "libmbd/language/quantities.hpp"
#include "libmbd/results/build_facts.hpp"
#include "libmbd/results/history.hpp"
#include "libmbd/scene/places.hpp"
#include "libmbd/scene/reference_line.hpp"
#include "libmbd/scene/section_table.hpp"
#include "libmbd/scene/transient.hpp"
#include "libmbd/study/accuracy/power_law.hpp"
#include "libmbd/text/files.hpp"
#include "libmbd/text/text.hpp"

namespace mbd {
namespace {

constexpr std::size_t most_quantities = 4;  // when none are named
constexpr int samples = 200;                // of a transient
constexpr double reference_share = 0.5;     // of the budget, for the reference
constexpr double unresolved =
    1e-2;  // of the scale: where the two ways differ by that, there is no reference
constexpr double least_resolved = 0.05;  // of the duration, for a reference
constexpr double agreed = 1e-11;         // of the scale: nothing is gained by more
constexpr double zero = 1e-8;            // of others in its unit: a quantity that is round-off
constexpr double near = 1e-9;            // of the last place: two places that are the same
constexpr double coarsest = 0.1;         // errors that are fitted are below,
constexpr double above_reference = 3.0;  // and above that many times the reference's own,
constexpr double falling = 1.3;          // and fall at least by that factor from point to point
constexpr double not_known = std::numeric_limits<double>::infinity();

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// ---- norms ------------------------------------------------------------------------------------------

// |a - b| of a quantity by place of b, in its unit; not_known where a has no such place.
std::vector<double> differences(const Findings& a, const Findings& b, const Quantity& quantity) {
  std::vector<double> all(b.at.size(), not_known);
  const double slack = b.at.empty() ? 0.0 : near * std::abs(b.at.back());
  std::size_t i = 0;
  for (std::size_t k = 0; k < b.at.size(); ++k) {
    while (i < a.at.size() && a.at[i] < b.at[k] - slack) ++i;
    if (i == a.at.size()) break;
    if (std::abs(a.at[i] - b.at[k]) > slack) continue;
    all[k] = distance(quantity, a, i, b, k);
  }
  return all;
}

// How many places lie up to `until`.
std::size_t places_until(const Findings& truth, double until) {
  const double slack = truth.at.empty() ? 0.0 : near * std::abs(truth.at.back());
  std::size_t n = 0;
  while (n < truth.at.size() && truth.at[n] <= until + slack) ++n;
  return n;
}

void set_scale(Quantity& quantity, const Findings& truth) {
  const Scale scale =
      scale_of(quantity, truth, places_until(truth, quantity.until), zero, Measure::value);
  quantity.scale = scale.value;
  quantity.is_zero = scale.is_zero;
}

QuantityError error_of(const Findings& found, const Findings& truth, const Quantity& quantity) {
  QuantityError error;
  const std::size_t n = places_until(truth, quantity.until);
  if (n == 0 || quantity.until == 0.0 || found.columns != truth.columns) return error;
  const std::vector<double> d = differences(found, truth, quantity);
  double sum = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    if (!std::isfinite(d[k])) return error;
    sum += d[k] * d[k];
    if (d[k] > error.largest) error.largest = d[k], error.at = truth.at[k];
  }
  error.known = true;
  error.rms = std::sqrt(sum / static_cast<double>(n)) / quantity.scale;
  error.largest /= quantity.scale;
  error.below_reference = error.rms <= above_reference * quantity.reference_rms;
  return error;
}

// ---- quantities -------------------------------------------------------------------------------------

std::vector<Components> quantities_of(const Scene& scene, const Findings& findings,
                                      std::vector<std::string> names) {
  std::vector<Components> all;
  const auto add = [&](const std::string& name, bool by_component) {
    add_components(all, findings, std::span(&name, 1), scene.file, by_component);
  };
  if (!names.empty()) {
    for (const std::string& name : names) {
      const bool one = std::find(findings.columns.begin(), findings.columns.end(), name) !=
                       findings.columns.end();
      add(name, one);
    }
    return all;
  }
  const auto known = [&](const std::string& name) {
    return std::find(findings.columns.begin(), findings.columns.end(), name) !=
           findings.columns.end();
  };
  if (scene.path) add("load_factor", true);
  for (const ExpectScene& expect : scene.expects)
    if (known(expect.quantity)) add(std::string(quantity_of(expect.quantity)), false);
  for (const PlotScene& plot : scene.plots)
    for (const std::string& y : plot.y)
      if (known(y)) add(std::string(quantity_of(y)), false);
  if (all.size() < most_quantities)
    for (const std::string& column : findings.columns) add(std::string(quantity_of(column)), false);
  if (all.size() > most_quantities) all.resize(most_quantities);
  return all;
}

// ---- trials -----------------------------------------------------------------------------------------

// Runs trials within the budget, and keeps them.
class Trials {
 public:
  Trials(const Scene& scene, const AccuracyOptions& options)
      : scene_(scene), options_(options), begun_(now()) {
    if (options.keep) make_directory(*options.keep);
  }

  double left() const { return options_.budget - (now() - begun_); }
  double used() const { return now() - begun_; }
  std::size_t kept() const { return kept_; }  // runs of an earlier study
  bool interrupted() const { return options_.interrupted != nullptr && *options_.interrupted; }

  // One of an earlier study, or a new one of at most `limit` seconds.
  Trial operator()(const Setting& setting, double limit) {
    const std::string key =
        fmt::format("{}\n{} samples\n{}", options_.fingerprint, samples, words(setting));
    const std::filesystem::path file =
        options_.keep ? *options_.keep / fmt::format("{:016x}.txt", checksum(key)) : "";
    if (options_.keep)
      if (std::optional<Trial> kept = read(file, key)) {
        ++kept_;
        return *kept;
      }
    Trial trial;
    try {
      TrialOptions options{.samples = samples, .limit = std::max(limit, 0.05)};
      options.repeat_within = std::min(options.repeat_within, limit / 10.0);
      options.interrupted = options_.interrupted;
      options.wall = std::max(std::min(2.0 * limit, left()), 0.1);
      trial = run_trial(with(scene_, setting), options);
    } catch (const Error& error) {
      trial.failure = error.what();
    }
    if (options_.keep && !trial.stopped && !trial.lost && !interrupted())
      write_file(file, "# " + replaced(key) + "\n" + serialize(trial));
    return trial;
  }

  TrialPoint point(const Setting& setting, double limit) {
    return {setting, to_text(scene_, setting), (*this)(setting, limit), {}};
  }

 private:
  static std::string words(const Setting& setting) {
    std::string text;
    for (const Knob knob : knobs)
      text += fmt::format("{}={};", name_of(knob), value_of(setting, knob));
    return text;
  }
  static std::string replaced(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
  }
  static std::optional<Trial> read(const std::filesystem::path& file, const std::string& key) {
    std::ifstream in(file);
    std::string first;
    if (!std::getline(in, first) || first != "# " + replaced(key)) return std::nullopt;
    std::ostringstream rest;
    rest << in.rdbuf();
    return deserialize(rest.str());
  }

  const Scene& scene_;
  const AccuracyOptions& options_;
  double begun_;
  std::size_t kept_ = 0;
};

// ---- reference --------------------------------------------------------------------------------------

// Two settings of one resolution on different ways to the solution: other orders and meshes, the other form of the
// beams' forces, other methods or tolerances.
std::array<Setting, 2> ways_of(const Scene& scene, int level) {
  std::array<Setting, 2> ways;
  auto& [a, b] = ways;
  if (!scene.beams.empty()) {
    int order = 3;
    bool has_forms = true;  // that of the paper, too
    for (const BeamScene& beam : scene.beams) {
      order = std::max(order, beam.order);
      has_forms = has_forms && beam.kinematics == Kinematics::motion;
    }
    for (const Section& section : scene.sections)
      has_forms = has_forms && std::ranges::count(infinite_stiffnesses(section), true) == 0;
    const int elements = *setting_of(scene).elements;
    const int doubled = std::max(0, order + 1 + level - 8);  // where the order ends, meshes go on
    a.order = std::min(8, order + 1 + level);
    a.elements = elements << std::min(doubled, 8);
    b.order = std::max(2, *a.order - 1);
    b.elements = 2 * *a.elements;
    if (has_forms) b.form = scene.beams.front().form == Form::energy ? Form::paper : Form::energy;
  }
  if (scene.transient) {
    a.method = b.method = TimeMethod::radau;
    // Of one method errors are alike, and their difference is that of the coarser one: not the reference.
    b.tolerance = std::pow(10.0, -4 - level);
    a.tolerance = *b.tolerance / 10.0;
    if (scene.beams.empty()) {
      b.method = TimeMethod::ida;
      a.tolerance = 0.3 * *b.tolerance;
    }
  }
  return ways;
}

// Differences of two ways, into the quantities; and to what the first way gave when it was coarser, if there was such a
// run: its error has fallen to a tenth at most. Returns the largest relative rms.
double judge(std::vector<Quantity>& quantities, const Findings& truth, const Findings& other,
             const Findings& coarser) {
  double worst = 0.0;
  for (Quantity& quantity : quantities) {
    quantity.until = truth.at.back();
    set_scale(quantity, truth);
    const std::vector<double> d = differences(other, truth, quantity);
    std::size_t n = 0;
    while (n < d.size() && d[n] <= unresolved * quantity.scale) ++n;
    if (n < d.size()) {
      const double until = n == 0 ? 0.0 : truth.at[n - 1];
      quantity.until = until < least_resolved * truth.at.back() ? 0.0 : until;
      if (quantity.until == 0.0) {
        quantity.reference_rms = quantity.reference_largest = worst = not_known;
        continue;
      }
      set_scale(quantity, truth);
    }
    quantity.reference_rms = 0.0;
    const QuantityError error = error_of(other, truth, quantity);
    if (!error.known) throw Error("two runs of a scene found different columns");
    const QuantityError change = error_of(coarser, truth, quantity);
    quantity.reference_rms = std::max(error.rms, change.known ? change.rms / 10.0 : 0.0);
    quantity.reference_largest =
        std::max(error.largest, change.known ? change.largest / 10.0 : 0.0);
    worst = std::max(worst, quantity.reference_rms);
  }
  return worst;
}

// Of two references to the same quantities: whether this one reaches further, or is closer, all in all.
bool is_better(const std::vector<Quantity>& now, const std::vector<Quantity>& before) {
  double score = 0.0;  // powers of ten, each quantity one at most
  for (std::size_t q = 0; q < now.size(); ++q) {
    const Quantity &a = now[q], &b = before[q];
    if (std::abs(a.until - b.until) > near * std::max(a.until, b.until))
      score += a.until > b.until ? 1.0 : -1.0;
    else if (a.until > 0.0)
      score +=
          std::clamp(std::log10((b.reference_rms + 1e-17) / (a.reference_rms + 1e-17)), -1.0, 1.0);
  }
  return score > 0.0;
}

// "1e-06 up to 10.8 s, 0.001 up to the end" of the difference of the two ways, where it grows a lot.
std::string growth(const Findings& truth, const Findings& other, const Quantity& quantity) {
  const std::vector<double> d = differences(other, truth, quantity);
  const std::size_t n = places_until(truth, quantity.until);
  const double end = quantity.reference_largest;
  for (double bound = 1e-9; bound < end / 30.0; bound *= 10.0) {
    std::size_t k = 0;
    while (k < n && d[k] <= bound * quantity.scale) ++k;
    if (k == 0 || k < n / 10 || k == n) continue;
    if (bound * 100.0 < end / 30.0) bound = std::pow(10.0, std::ceil(std::log10(end)) - 3.0);
    k = 0;
    while (k < n && d[k] <= bound * quantity.scale) ++k;
    return fmt::format("{:.0e} up to {:.4g} s, and {:.1e} after that", bound, truth.at[k - 1], end);
  }
  return {};
}

// Complete, or a motion that came far enough before it was stopped.
bool is_usable(const Scene& scene, const Trial& trial) {
  return trial.complete || (trial.stopped && scene.transient && !trial.findings.at.empty() &&
                            trial.findings.at.back() >= least_resolved * scene.transient->duration);
}

void cut(Findings& findings, double end) {
  const std::size_t n = places_until(findings, end);
  findings.at.resize(n);
  if (!findings.branch.empty()) findings.branch.resize(n);
  findings.rows.resize(n);
}

// Two ways to run the model that refine it differently.
struct TwoWays {
  std::array<Setting, 2> ways;
  std::array<Trial, 2> done;
  double cost = 0.0;
  bool complete = true, partial = false;  // as far as both can be used; not to the end
};

TwoWays run_both(AccuracyStudy& study, const Scene& scene, Trials& trials,
                 const AccuracyOptions& options, double budget, int level,
                 const std::array<Setting, 2>& ways) {
  TwoWays both;
  both.ways = ways;
  for (std::size_t w = 0; w < 2 && both.complete; ++w) {
    Setting& way = both.ways[w];
    if (options.progress)
      options.progress(
          fmt::format("reference {}{}: {}", level + 1, w == 0 ? "a" : "b", to_text(scene, way)), 0,
          0, 0.0);
    const auto limit = [&] {
      return (budget - trials.used()) / (level == 0 && w == 0 ? 2.0 : 1.0);
    };
    TrialPoint point = trials.point(way, limit());
    if (!point.trial.complete && !point.trial.stopped && way.method == TimeMethod::ida) {
      // Where IDA does not get through.
      way.method = TimeMethod::radau;
      way.tolerance = 10.0 * *both.ways[0].tolerance;
      point = trials.point(way, limit());
    }
    both.complete = is_usable(scene, point.trial);
    both.partial = both.partial || !point.trial.complete;
    both.cost += point.trial.cpu * point.trial.repeats;
    both.done[w] = point.trial;
    study.ways.push_back(std::move(point));
  }
  return both;
}

// What the reference is good for, in notes. `other`: what it was compared with.
void note_limits(AccuracyStudy& study, const Scene& scene, const Findings& other) {
  if (scene.transient && study.truth.at.back() < scene.transient->duration * (1.0 - near))
    study.notes.push_back(fmt::format(
        "the budget allowed a reference up to {:.4g} s only: errors are those before; for more, "
        "give more budget",
        study.truth.at.back()));
  if (scene.transient && !anything_changes(study.truth)) {
    for (Quantity& quantity : study.quantities) quantity.until = 0.0;
    study.notes.push_back(
        "nothing that is recorded changes in the whole run: runs agree that may all have missed "
        "what "
        "should move it, and an error of 0 would say nothing");
    return;
  }
  for (const Quantity& quantity : study.quantities) {
    if (quantity.until == 0.0)
      study.notes.push_back(fmt::format(
          "{}: refinements do not approach each other{}; it has no reference", quantity.name,
          scene.transient ? ": its motion is chaotic, or rings faster than the runs resolve" : ""));
    else if (quantity.until < study.truth.at.back())
      study.notes.push_back(
          fmt::format("{}: from {:.4g} s on refinements differ by more than 1 %: the motion is "
                      "chaotic, or rings faster than "
                      "the runs resolve; errors are those before",
                      quantity.name, quantity.until));
    else if (scene.transient)
      if (const std::string text = growth(study.truth, other, quantity); !text.empty())
        study.notes.push_back(fmt::format("{}: the reference is good to {}", quantity.name, text));
  }
}

void make_reference(AccuracyStudy& study, const Scene& scene, Trials& trials,
                    const AccuracyOptions& options) {
  const double budget = reference_share * options.budget;
  double last_cost = 0.0, growth_of_cost = 2.0;
  int no_better = 0;  // levels in a row
  std::vector<Quantity> quantities = study.quantities;
  Findings other, coarser;
  std::array<Setting, 2> chosen;
  for (int level = 0; level < options.refinements; ++level) {
    const std::array<Setting, 2> ways = ways_of(scene, level);
    if (ways[0].elements && (*ways[0].order > 8 || *ways[0].elements > 64)) break;
    if (ways[0].tolerance && *ways[0].tolerance < 1e-13) break;
    const double left = budget - trials.used();
    const double expected = last_cost * growth_of_cost;
    if (level > 0 && expected > left) break;
    TwoWays both = run_both(study, scene, trials, options, budget, level, ways);
    std::array<Trial, 2>& done = both.done;
    if (!both.complete) {
      if (trials.interrupted() || study.ways.back().trial.stopped || !study.truth.at.empty()) break;
      continue;  // a coarse one that fails says nothing of the finer ones
    }
    if (last_cost > 0.0) growth_of_cost = std::max(1.5, 1.2 * both.cost / last_cost);
    last_cost = both.cost;
    if (both.partial && !study.truth.at.empty()) break;  // a whole one is worth more
    if (both.partial) {
      const double reached = std::min(done[0].findings.at.back(), done[1].findings.at.back());
      for (Trial& trial : done) cut(trial.findings, reached);
    }
    if (done[0].findings.at.size() != done[1].findings.at.size()) continue;  // of special points
    const double worst = judge(quantities, done[0].findings, done[1].findings, coarser);
    coarser = done[0].findings;
    if (study.truth.at.empty() || is_better(quantities, study.quantities)) {
      no_better = 0;
      study.quantities = quantities;
      study.truth = done[0].findings;
      other = done[1].findings;
      chosen = both.ways;
    } else if (++no_better == 2) {
      break;  // round-off, or chaos
    }
    if (worst < agreed || both.partial) break;
  }
  if (study.truth.at.empty())
    throw Error(
        scene.source,
        fmt::format("no reference could be made within {:.3g} s ({}); give more budget, or "
                    "a reference from a file",
                    budget, study.ways.empty() ? "no run" : study.ways.back().trial.failure));
  study.reference = fmt::format("{}; its own error is the difference to {}",
                                to_text(scene, chosen[0]), to_text(scene, chosen[1]));
  note_limits(study, scene, other);
}

// Of a file, those that the quantities need; 0 for the others.
std::vector<std::size_t> columns_of_file(const History& file, const std::string& path,
                                         const Findings& own,
                                         const std::vector<Quantity>& quantities) {
  std::vector<std::size_t> columns(own.columns.size(), 0);
  for (const Quantity& quantity : quantities)
    for (const std::size_t c : quantity.columns) {
      columns[c] = choose_column(file, own.columns[c]);
      const std::string& unit = file.columns[columns[c]].unit;
      if (!unit.empty() && unit != own.units[c])
        throw Error(fmt::format("{}: column {} is in {}, and the model's is in {}", path,
                                own.columns[c], unit, own.units[c]));
    }
  return columns;
}

// At a place within the file, which has a row there; or the cubic through four neighbours, and then it counts that.
std::vector<double> row_at(const History& file, const std::string& path,
                           const std::vector<std::size_t>& columns, double at, double slack,
                           std::size_t& interpolated) {
  const std::vector<double>& t = file.values[0];
  const auto after = std::lower_bound(t.begin(), t.end(), at - slack);
  auto k = static_cast<std::size_t>(after - t.begin());
  std::vector<double> row(columns.size(), 0.0);
  if (k < t.size() && std::abs(t[k] - at) <= slack) {
    for (std::size_t c = 0; c < row.size(); ++c)
      if (columns[c] > 0) row[c] = file.values[columns[c]][k];
    return row;
  }
  if (t.size() < 4)
    throw Error(fmt::format("{}: has no row at {}, and too few to interpolate", path, at));
  ++interpolated;
  k = std::clamp<std::size_t>(k, 2, t.size() - 2) - 2;
  for (std::size_t i = k; i < k + 4; ++i) {
    double weight = 1.0;
    for (std::size_t j = k; j < k + 4; ++j)
      if (j != i) weight *= (at - t[j]) / (t[i] - t[j]);
    for (std::size_t c = 0; c < row.size(); ++c)
      if (columns[c] > 0) row[c] += weight * file.values[columns[c]][i];
  }
  return row;
}

// From a file, at the places of the runs: its own rows where it has them, else the cubic through four neighbours.
void read_reference(AccuracyStudy& study, const Scene& scene, const Findings& own,
                    const std::filesystem::path& path) {
  const History file = read_history(path);
  study.truth.columns = own.columns;
  study.truth.units = own.units;
  study.truth.energy = own.energy;
  const std::vector<std::size_t> columns =
      columns_of_file(file, path.string(), own, study.quantities);
  const std::vector<double>& t = file.values[0];
  if (!std::is_sorted(t.begin(), t.end(), std::less_equal<>()))
    throw Error(fmt::format("{}: the first column must rise", path.string()));
  const double slack = near * std::abs(own.at.back());
  std::size_t interpolated = 0;
  for (const double at : own.at) {
    if (at < t.front() - slack || at > t.back() + slack) continue;
    study.truth.at.push_back(at);
    study.truth.rows.push_back(row_at(file, path.string(), columns, at, slack, interpolated));
  }
  if (study.truth.at.empty())
    throw Error(fmt::format("{}: none of its rows lies within the run", path.string()));
  for (Quantity& quantity : study.quantities) {
    quantity.until = study.truth.at.back();
    quantity.reference_known = false;
    set_scale(quantity, study.truth);
  }
  if (scene.transient && study.truth.at.back() < scene.transient->duration * (1.0 - near))
    study.notes.push_back(fmt::format(
        "the reference and the model's own run within the budget reach {:.4g} s: errors are "
        "those before",
        study.truth.at.back()));
  study.reference = fmt::format("the file {}, whose own error is not known", path.string());
  if (interpolated > 0)
    study.notes.push_back(
        fmt::format("{} of {} places lie between the rows of {}: interpolated by cubics",
                    interpolated, study.truth.at.size(), path.string()));
}

// ---- the grid ---------------------------------------------------------------------------------------

// Cost but for a factor: how work grows with the knobs.
double work_of(const Scene& scene, const Setting& setting) {
  double work = 1.0;
  if (!scene.beams.empty()) {
    const Setting own = setting_of(scene);
    const double order = setting.order.value_or(own.order.value_or(scene.beams.front().order));
    work *= setting.elements.value_or(*own.elements) * std::pow(order + 1.0, 1.5);
  }
  if (setting.step) work *= 1.0 / *setting.step;
  if (setting.tolerance)
    work *= std::pow(*setting.tolerance, setting.method == TimeMethod::radau ? -0.2 : -0.33);
  return work;
}

// Those that take fixed steps, follow tolerances, and each method, cost differently.
std::string kind_of(const Setting& setting) {
  return value_of(setting, Knob::method) + (setting.step        ? " step"
                                            : setting.tolerance ? " tolerance"
                                                                : "");
}

void try_settings(AccuracyStudy& study, const Scene& scene, Trials& trials,
                  const AccuracyOptions& options, const Trial& own,
                  const std::vector<Setting>& settings) {
  std::vector<std::size_t> order(settings.size());
  std::iota(order.begin(), order.end(), 0u);
  // Seconds per work of each kind, by the dearest of the last runs.
  std::map<std::string, double> rate;
  const auto learn = [&](const Setting& setting, const Trial& trial) {
    if (!trial.complete && !trial.stopped) return;  // of one that was stopped it is a lower bound
    const double seconds = trial.cpu / work_of(scene, setting);
    double& known = rate[kind_of(setting)];
    known = known > 0.0 ? std::max(seconds, 0.7 * known) : seconds;
  };
  learn(setting_of(scene), own);
  for (const TrialPoint& way : study.ways) learn(way.setting, way.trial);
  const auto cost = [&](const Setting& setting) {
    const auto found = rate.find(kind_of(setting));
    return work_of(scene, setting) * (found != rate.end() ? found->second : 0.0);
  };
  std::vector<TrialPoint> points(settings.size());
  std::vector<bool> tried(settings.size(), false);
  std::size_t done = 0;
  while (!order.empty() && !trials.interrupted()) {
    // The cheapest of what is left: so that what the budget does not allow are the dear ones.
    const auto next = std::min_element(
        order.begin(), order.end(),
        [&](std::size_t a, std::size_t b) { return cost(settings[a]) < cost(settings[b]); });
    const std::size_t i = *next;
    const double expected = cost(settings[i]);
    if (expected > trials.left() || trials.left() < 0.02 * options.budget) break;
    order.erase(next);
    double to_come = 0.0;
    for (const std::size_t k : order) to_come += cost(settings[k]);
    if (options.progress)
      options.progress(to_text(scene, settings[i]), done, settings.size(),
                       std::min(to_come + expected, trials.left()));
    // Not all of the budget for one whose cost is not known.
    points[i] = trials.point(
        settings[i], std::min(trials.left(), std::max(5.0 * expected, 0.2 * options.budget)));
    if (trials.interrupted()) break;
    tried[i] = true;
    ++done;
    learn(settings[i], points[i].trial);
  }
  for (std::size_t i = 0; i < settings.size(); ++i)
    if (tried[i]) study.points.push_back(std::move(points[i]));
  study.untried = settings.size() - study.points.size();
}

// ---- what it says -----------------------------------------------------------------------------------

void find_fronts(AccuracyStudy& study) {
  for (std::size_t q = 0; q < study.quantities.size(); ++q) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < study.points.size(); ++i)
      if (study.points[i].trial.complete && study.points[i].errors[q].known) order.push_back(i);
    const auto error = [&](std::size_t i) {
      return study.points[i].errors[q].rms + study.quantities[q].reference_rms;
    };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      const double at = study.points[a].trial.cpu, bt = study.points[b].trial.cpu;
      return at != bt ? at < bt : error(a) < error(b);
    });
    std::vector<std::size_t> front;
    for (const std::size_t i : order)
      if (front.empty() || error(i) < error(front.back())) front.push_back(i);
    // The cheapest setting for each power of ten that was reached.
    if (!front.empty()) {
      for (int power = 1; power <= 14; ++power) {
        const double accuracy = std::pow(10.0, -power);
        const auto found = std::find_if(front.begin(), front.end(),
                                        [&](std::size_t i) { return error(i) <= accuracy; });
        if (found == front.end()) break;
        study.advice.push_back({q, accuracy, *found});
      }
    }
    study.fronts.push_back(std::move(front));
  }
}

// Whether elements end where the record is, in all of the meshes or in none; nothing where it depends on the mesh.
std::optional<bool> ends_elements(const Scene& scene, const RecordScene* record,
                                  const std::vector<Setting>& meshes) {
  if (record == nullptr || !record->at || record->at->kind != Place::Kind::beam ||
      rigid_with(scene, record->at->name) != nullptr)
    return true;
  std::size_t ending = 0;
  for (const Setting& mesh : meshes) {
    const Scene meshed = with(scene, mesh);
    for (const BeamScene& beam : meshed.beams) {
      if (beam.name != record->at->name) continue;
      const std::vector<double> ends = element_ends(meshed, beam, beam.elements);
      ending += std::any_of(ends.begin(), ends.end(), [&](double s) {
        return std::abs(s - record->at->parameter) < same_parameter;
      });
    }
  }
  if (ending != 0 && ending != meshes.size()) return std::nullopt;
  return ending != 0;
}

// Section forces are derivatives of the motion between nodes, of order N, and motion there of order N + 1; joints'
// forces and accelerations are of the order of the stages in Radau's steps (radau.hpp), and do not go with a tolerance.
std::optional<double> theory_of(const Scene& scene, const std::vector<Setting>& settings, Knob knob,
                                const std::string& quantity) {
  using From = schema::Quantity::From;
  const Setting& setting = settings.front();
  const schema::Recorded recorded = schema::recorded_in(scene, quantity);
  const From from = recorded.quantity != nullptr ? recorded.quantity->from : From::pose;
  switch (knob) {
    case Knob::tolerance:
      if (from == From::acceleration || from == From::strain) return std::nullopt;
      return 1.0;
    case Knob::step:
      if (setting.method.value_or(scene.transient->method) == TimeMethod::radau) {
        // Fixed steps have three where the model leaves it to them.
        const auto stages =
            static_cast<double>(std::max<std::size_t>(3, radau_stages(*scene.transient)));
        return from == From::acceleration ? stages : 2.0 * stages - 1.0;
      }
      return 2.0;
    case Knob::elements:
      if (const std::optional<int> order =
              setting.order ? setting.order : setting_of(scene).order) {
        if (from == From::strain) return -*order;
        if (const auto ends = ends_elements(scene, recorded.record, settings))
          return *ends ? -2.0 * *order : -1.0 - *order;
      }
      return std::nullopt;
    default:
      return std::nullopt;
  }
}

// The longest run of points whose error falls as the knob is refined, between the coarsest that counts and where other
// errors show.
std::vector<std::size_t> falling_part(const AccuracyStudy& study, std::size_t q,
                                      const std::vector<std::size_t>& family) {
  std::vector<std::size_t> best, part;
  for (const std::size_t i : family) {
    const QuantityError& error = study.points[i].errors[q];
    const bool counts = study.points[i].trial.complete && error.known && error.rms < coarsest &&
                        error.rms > above_reference * study.quantities[q].reference_rms &&
                        error.rms > 1e-15;
    if (!counts ||
        (!part.empty() && error.rms * falling > study.points[part.back()].errors[q].rms)) {
      if (part.size() > best.size()) best = part;
      part.clear();
    }
    if (counts) part.push_back(i);
  }
  return part.size() > best.size() ? part : best;
}

PowerLaw law_through(const AccuracyStudy& study, Knob knob, std::size_t q,
                     const std::vector<std::size_t>& points) {
  std::vector<std::array<double, 2>> pairs;
  for (const std::size_t i : points)
    pairs.push_back({*number_of(study.points[i].setting, knob), study.points[i].errors[q].rms});
  return fit_power_law(pairs);
}

using Refinement = std::vector<std::size_t>;  // of points, as a knob is refined

// By all other knobs, in groups of those that differ in numbers only.
std::map<std::string, std::vector<Refinement>> families_of(const AccuracyStudy& study, Knob knob) {
  std::map<std::string, std::vector<Refinement>> groups;
  std::map<std::string, Refinement> families;
  for (std::size_t i = 0; i < study.points.size(); ++i) {
    if (!number_of(study.points[i].setting, knob)) continue;
    std::string key;
    for (const Knob other : knobs)
      if (other != knob) key += value_of(study.points[i].setting, other) + ";";
    families[key].push_back(i);
  }
  for (auto& [key, family] : families) {
    const Setting& setting = study.points[family.front()].setting;
    std::string group;
    for (const Knob other : {Knob::metric, Knob::rule, Knob::form, Knob::method, Knob::errors})
      group += value_of(setting, other) + ";";
    if (knob == Knob::elements) group += value_of(setting, Knob::order);
    std::sort(family.begin(), family.end(), [&](std::size_t a, std::size_t b) {
      const double x = *number_of(study.points[a].setting, knob),
                   y = *number_of(study.points[b].setting, knob);
      return knob == Knob::elements ? x < y : x > y;
    });
    groups[group].push_back(family);
  }
  return groups;
}

struct Fall {
  Refinement points;
  double fall;  // logarithm
  PowerLaw law;
};

// Of the families whose errors fall far, the straightest: a fall may also be the chance of errors that cancel.
std::optional<Fall> straightest_fall(const AccuracyStudy& study, Knob knob, std::size_t q,
                                     const std::vector<Refinement>& families) {
  std::vector<Fall> candidates;
  double most = 0.0;
  for (const Refinement& family : families) {
    const Refinement part = falling_part(study, q, family);
    if (part.size() < 3) continue;
    candidates.push_back({part,
                          std::log(study.points[part.front()].errors[q].rms /
                                   study.points[part.back()].errors[q].rms),
                          law_through(study, knob, q, part)});
    most = std::max(most, candidates.back().fall);
  }
  const Fall* best = nullptr;
  for (const Fall& one : candidates)
    if (one.fall > 0.6 * most && (best == nullptr || one.law.spread < best->law.spread))
      best = &one;
  return best != nullptr ? std::optional(*best) : std::nullopt;
}

void fit_orders(AccuracyStudy& study, const Scene& scene) {
  for (const Knob knob : {Knob::elements, Knob::step, Knob::tolerance}) {
    const auto groups = families_of(study, knob);
    for (std::size_t q = 0; q < study.quantities.size(); ++q)
      for (const auto& [group, families] : groups) {
        const std::optional<Fall> best = straightest_fall(study, knob, q, families);
        if (!best) continue;
        OrderFit fit;
        fit.knob = knob;
        fit.quantity = q;
        fit.points = best->points;
        fit.slope = best->law.slope;
        fit.spread = best->law.spread;
        std::vector<Setting> settings;
        for (const std::size_t p : fit.points) settings.push_back(study.points[p].setting);
        fit.theory = theory_of(scene, settings, knob, study.quantities[q].name);
        study.fits.push_back(std::move(fit));
      }
  }
}

// The model as it is, within a quarter of the budget.
Trial own_run(Trials& trials, const AccuracyOptions& options) {
  if (options.progress) options.progress("the model as it is", 0, 0, 0.0);
  Trial own = trials({}, 0.25 * options.budget);
  if (own.findings.at.empty() || (!own.complete && !own.stopped)) {
    if (trials.interrupted()) throw Error("interrupted before the first run was done");
    throw Error(fmt::format("the model does not run with its own settings: {}", own.failure));
  }
  return own;
}

void find_quantities(AccuracyStudy& study, const Scene& scene, const Trial& own,
                     const AccuracyOptions& options) {
  for (Components& components : quantities_of(scene, own.findings, options.quantities)) {
    study.quantities.emplace_back();
    static_cast<Components&>(study.quantities.back()) = std::move(components);
  }
  if (study.quantities.empty())
    throw Error(scene.source,
                "the model records nothing whose error could be measured; give it a <record>");
}

void find_truth(AccuracyStudy& study, const Scene& scene, Trials& trials, const Trial& own,
                const AccuracyOptions& options) {
  if (options.reference && scene.path)
    throw Error(
        "--reference: files hold times or load factors, and the accuracy of a <path> is that of "
        "its special points; "
        "leave it out");
  if (options.reference)
    read_reference(study, scene, own.findings, *options.reference);
  else
    make_reference(study, scene, trials, options);
  for (const Quantity& quantity : study.quantities)
    if (quantity.is_zero && quantity.until > 0.0)
      study.notes.push_back(fmt::format(
          "{} is zero but for round-off: its errors are relative to the largest number in its "
          "unit that the model records{}",
          quantity.name, quantity.unit == "J" ? ", or kinetic or strain energy" : ""));
  study.places = study.truth.at.size();
  study.end = study.truth.at.back();
}

void measure_errors(AccuracyStudy& study, const Scene& scene) {
  for (std::vector<TrialPoint>* const list : {&study.points, &study.ways})
    for (TrialPoint& point : *list) {
      if (scene.path && point.trial.complete &&
          point.trial.findings.at.size() != study.truth.at.size()) {
        point.trial.complete = false;
        point.trial.failure = fmt::format("found {} special points, and not {}",
                                          point.trial.findings.at.size(), study.truth.at.size());
      }
      for (const Quantity& quantity : study.quantities)
        point.errors.push_back(error_of(point.trial.findings, study.truth, quantity));
    }
}

// What was left out, and what was not run again.
void note_trials(AccuracyStudy& study, const Trials& trials, std::size_t settings, double budget) {
  if (trials.interrupted())
    study.notes.push_back(
        fmt::format("interrupted: {} of {} settings were not tried", study.untried, settings));
  else if (!study.whole())
    study.notes.push_back(fmt::format(
        "{} of {} settings, the dearest, were not tried: the budget of {:g} s did not allow them",
        study.untried, settings, budget));
  if (trials.kept() > 0)
    study.notes.push_back(
        fmt::format("{} runs are those of an earlier study, which was kept", trials.kept()));
}

}  // namespace

AccuracyStudy study_accuracy(const Scene& scene, const AccuracyOptions& options) {
  AccuracyStudy study;
  study.model = scene.name;
  study.file = scene.file;
  study.date = utc_now("%Y-%m-%d");
  study.command = options.command;
  study.machine = machine();
  study.build = to_lines(build_facts());
  study.budget = options.budget;
  study.place = scene.transient ? "time"
                : scene.path    ? "number of the special point"
                                : "load factor";

  const std::vector<Setting> settings = settings_of(default_variations(scene, options.variations));
  if (settings.empty())
    throw Error(
        "--vary: nothing is left to try: generalized_alpha and radau take fixed steps, ida "
        "tolerances only");
  // Knobs that the scene does not have are the user's mistake, not a trial that fails.
  for (const Setting& setting : settings) with(scene, setting);

  Trials trials(scene, options);
  const Trial own = own_run(trials, options);
  find_quantities(study, scene, own, options);
  find_truth(study, scene, trials, own, options);
  try_settings(study, scene, trials, options, own, settings);
  measure_errors(study, scene);
  find_fronts(study);
  fit_orders(study, scene);
  note_trials(study, trials, settings.size(), options.budget);
  study.seconds = trials.used();
  return study;
}

}  // namespace mbd
