#include "libmbd/study/effects/effects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "libmbd/results/build_facts.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/study/trial/setting.hpp"
#include "libmbd/text/text.hpp"

namespace mbd::effects_study {
namespace {

constexpr double zero = 1e-9;  // beside others of its unit, a quantity is this much round-off
constexpr std::size_t most_rounds = 5;  // of paired runs
constexpr double noise = 0.02;          // of a ratio of CPU times: less is no saving

// The rows of `found` in the columns of `like`; what is not there is not a number.
Findings aligned(const Findings& found, const Findings& like) {
  Findings result = found;
  result.columns = like.columns;
  result.units = like.units;
  std::vector<std::size_t> from;
  for (const std::string& name : like.columns)
    from.push_back(static_cast<std::size_t>(
        std::find(found.columns.begin(), found.columns.end(), name) - found.columns.begin()));
  for (std::vector<double>& row : result.rows) {
    std::vector<double> moved;
    for (const std::size_t c : from)
      moved.push_back(c < row.size() ? row[c] : std::numeric_limits<double>::quiet_NaN());
    row = std::move(moved);
  }
  return result;
}

Change change_of(const EffectQuantity& quantity, const Trial& whole, const Trial& other) {
  Change change;
  const Findings& a = whole.findings;
  if (!other.complete || other.findings.at.size() != a.at.size() || a.at.empty()) return change;
  const Findings b = aligned(other.findings, a);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.at.size(); ++i) {
    const double d = distance(quantity, a, i, b, i) / quantity.scale;
    if (!std::isfinite(d)) return change;
    sum += d * d;
    if (d > change.largest) {
      change.largest = d;
      change.at = a.at[i];
    }
  }
  change.known = true;
  change.rms = std::sqrt(sum / static_cast<double>(a.at.size()));
  return change;
}

// Half the steps, a tenth of the tolerance.
Scene finer(const Scene& scene) {
  Scene s = scene;
  if (s.transient->step)
    *s.transient->step *= 0.5;
  else
    s.transient->tolerance = std::max(1e-13, 0.1 * *s.transient->tolerance);
  return s;
}

double stepping(const Trial& trial) { return std::max(trial.cpu_stepping, 1e-6); }

double worst_of(const std::vector<Change>& changes) {
  double most = 0.0;
  for (const Change& change : changes)
    if (change.known) most = std::max(most, change.rms);
  return most;
}

class Study {
 public:
  Study(const Scene& scene, const EffectsOptions& options) : scene_(scene), options_(options) {}

  EffectsStudy make() {
    const auto begun = std::chrono::steady_clock::now();
    begin();
    one_by_one();
    count_instructions();
    look_for_cheapest();
    result_.interrupted = interrupted();
    result_.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    return std::move(result_);
  }

 private:
  bool interrupted() const { return options_.interrupted != nullptr && *options_.interrupted; }
  bool spent() const { return interrupted() || used_ >= options_.budget; }

  Trial run(const Scene& scene, const std::string& what, double limit = 1e30) {
    if (options_.progress) options_.progress(what, done_, all_);
    ++done_;
    const Trial trial =
        run_trial(scene, {.limit = limit, .repeats = 1, .interrupted = options_.interrupted});
    used_ += trial.cpu;
    return trial;
  }

  void begin() {
    result_.model = scene_.name;
    result_.file = scene_.file;
    result_.date = utc_now("%Y-%m-%d %H:%M UTC");
    result_.command = options_.command;
    result_.machine = machine();
    result_.build = to_lines(build_facts());
    result_.tolerance = options_.tolerance;
    const std::vector<Ablation> ablations = ablations_of(scene_);
    if (ablations.empty())
      throw Error(fmt::format("{}: it has no effect that could be left out", scene_.name));
    whole_ = scene_;
    result_.whole_end = scene_.transient ? scene_.transient->duration : 1.0;
    // Each effect once, and with others on the way to the cheapest: some three runs each, and more where there is time.
    const double share = options_.budget / (3.0 * static_cast<double>(ablations.size()) + 4.0);
    result_.whole = run(whole_, "the whole model", scene_.transient ? share : options_.budget);
    if (result_.whole.stopped && !interrupted()) shorten(share);
    const Trial& whole = result_.whole;
    if (!whole.complete)
      throw Error(fmt::format("{}: the model does not run: {}", scene_.name, whole.failure));
    result_.end = whole.findings.at.back();
    std::vector<Components> components;
    add_components(components, whole.findings, options_.quantities, scene_.file);
    if (components.empty())
      throw Error(fmt::format("{}: it records nothing to compare; give <record …/>", scene_.name));
    for (Components& c : components) {
      const Scale scale =
          scale_of(c, whole.findings, whole.findings.at.size(), zero, Measure::value);
      result_.quantities.push_back({std::move(c), scale.value, scale.is_zero, 0.0});
    }
    if (scene_.transient) {
      const Trial fine = run(finer(whole_), "the whole model, finer");
      for (EffectQuantity& q : result_.quantities)
        if (const Change change = change_of(q, whole, fine); change.known) q.own = change.rms;
    }
    for (const Ablation& ablation : ablations) result_.runs.push_back({ablation, {}, {}, {}, {}});
    limit_ = 5.0 * whole.cpu + 2.0;
  }

  // So much of it as its first run came to within its share of the time.
  void shorten(double share) {
    const std::vector<double>& at = result_.whole.findings.at;
    const double reached = at.empty() ? 0.0 : at.back();
    double& duration = whole_.transient->duration;
    double part = 0.8 * reached;
    if (whole_.transient->step)
      part = std::floor(part / *whole_.transient->step) * *whole_.transient->step;
    if (!(part > 0.0))
      throw Error(
          fmt::format("{}: {:.3g} s of CPU time a run are not enough to begin; give a "
                      "larger --budget",
                      scene_.name, share));
    duration = part;
    result_.notes.push_back(fmt::format(
        "effects are compared up to t = {:.4g} s of {:.4g} s, for the budget; the cheapest model "
        "is verified over the whole",
        part, scene_.transient->duration));
    result_.whole = run(whole_, "the first part of the model");
  }

  // Whole, other, whole, other, …: each other between two of the whole.
  void one_by_one() {
    const double round = result_.whole.cpu * (2.0 * static_cast<double>(result_.runs.size()) + 1.0);
    const double left = 0.5 * (options_.budget - used_);
    const auto rounds =
        static_cast<std::size_t>(std::clamp(left / round, 1.0, static_cast<double>(most_rounds)));
    all_ = done_ + rounds * (2 * result_.runs.size() + 1);
    for (std::size_t r = 0; r < rounds; ++r) {
      double before = stepping(run(whole_, "the whole model"));
      for (EffectRun& one : result_.runs) {
        if (r > 0 && !one.complete()) continue;
        if (interrupted()) return;
        one.trial = without_run({one.ablation.key}, "without " + one.ablation.effect);
        if (one.trial.complete) {
          const double after = stepping(run(whole_, "the whole model"));
          one.cpu.ratios.push_back(2.0 * stepping(one.trial) / (before + after));
          before = after;
        }
        if (r > 0) continue;
        for (const EffectQuantity& q : result_.quantities)
          one.changes.push_back(change_of(q, result_.whole, one.trial));
      }
    }
  }

  void count_instructions() {
    if (!options_.instructions) return;
    const auto tell = [&](const std::string& what) {
      if (options_.progress) options_.progress("instructions " + what, 0, 0);
    };
    tell("of the whole model");
    result_.instructions = options_.instructions({});
    for (EffectRun& one : result_.runs) {
      if (!one.complete() || interrupted()) continue;
      tell("without " + one.ablation.effect);
      one.instructions = options_.instructions({one.ablation.key}) / *result_.instructions;
    }
  }

  Trial without_run(const std::vector<std::string>& keys, const std::string& what) {
    try {
      return run(without(whole_, keys), what, limit_);
    } catch (const Error& error) {
      Trial failed;
      failed.failure = error.what();
      return failed;
    }
  }

  std::vector<std::string> keys_of(const std::vector<std::size_t>& left_out) const {
    std::vector<std::string> keys;
    for (const std::size_t i : left_out) keys.push_back(result_.runs[i].ablation.key);
    return keys;
  }

  // Greedily: of the effects that may be left out by themselves, the dearest first; each stays out if all quantities
  // still keep the tolerance, and the time falls.
  void look_for_cheapest() {
    std::vector<std::size_t> candidates;
    for (std::size_t i = 0; i < result_.runs.size(); ++i) {
      const EffectRun& one = result_.runs[i];
      if (one.complete() && one.keeps_all() && one.worst() <= options_.tolerance &&
          one.saves_time())
        candidates.push_back(i);
    }
    std::sort(candidates.begin(), candidates.end(), [&](std::size_t a, std::size_t b) {
      return result_.runs[a].cpu.median() < result_.runs[b].cpu.median();
    });
    CheapestModel& cheapest = result_.cheapest;
    all_ = done_ + 2 * candidates.size() + 2;
    Trial now = result_.whole;
    for (const std::size_t candidate : candidates) {
      if (spent()) {
        result_.notes.push_back(
            "the budget ended before every effect that may be left out was tried together with the "
            "others");
        break;
      }
      std::vector<std::size_t> tried = cheapest.left_out;
      tried.push_back(candidate);
      const std::string what = fmt::format("without {} effects", tried.size());
      if (tried.size() > 1) {
        const Trial other = without_run(keys_of(tried), what);
        if (!other.complete || !within(changes_of(result_.whole, other))) continue;
        const double before = stepping(without_run(keys_of(cheapest.left_out), what));
        if (!(stepping(other) < (1.0 - noise) * before)) continue;
      }
      cheapest.left_out = std::move(tried);
    }
    leave_idle();
    verify();
  }

  // What was left out first and is no effect without the others: shear flexibility where all beams have become rigid.
  void leave_idle() {
    std::vector<std::size_t>& left_out = result_.cheapest.left_out;
    for (std::size_t i = 0; i < left_out.size();) {
      std::vector<std::size_t> others = left_out;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      const std::vector<Ablation> rest = ablations_of(without(scene_, keys_of(others)));
      const std::string& key = result_.runs[left_out[i]].ablation.key;
      if (std::any_of(rest.begin(), rest.end(), [&](const Ablation& a) { return a.key == key; }))
        ++i;
      else
        left_out = std::move(others);
    }
  }

  std::vector<Change> changes_of(const Trial& whole, const Trial& other) const {
    std::vector<Change> changes;
    for (const EffectQuantity& q : result_.quantities)
      changes.push_back(change_of(q, whole, other));
    return changes;
  }

  bool within(const std::vector<Change>& changes) const {
    return std::all_of(changes.begin(), changes.end(),
                       [&](const Change& c) { return c.known && c.rms <= options_.tolerance; });
  }

  // Over the whole scene; what fails is taken back one by one, the last first.
  void verify() {
    CheapestModel& cheapest = result_.cheapest;
    if (cheapest.left_out.empty()) return;
    const bool part = result_.end < result_.whole_end;
    whole_ = scene_;
    limit_ = 1e30;
    Trial whole = part ? run(whole_, "the whole model, to its end") : result_.whole;
    while (!cheapest.left_out.empty() && !interrupted()) {
      const Trial other = without_run(keys_of(cheapest.left_out), "the cheapest model");
      cheapest.changes = changes_of(whole, other);
      if (other.complete && within(cheapest.changes)) {
        double before = stepping(run(whole_, "the whole model, to its end"));
        cheapest.cpu.ratios.push_back(stepping(other) / before);
        if (whole.cpu < 5.0)
          for (int pair = 0; pair < 2 && !interrupted(); ++pair) {
            const double cpu =
                stepping(without_run(keys_of(cheapest.left_out), "the cheapest model"));
            const double after = stepping(run(whole_, "the whole model, to its end"));
            cheapest.cpu.ratios.push_back(2.0 * cpu / (before + after));
            before = after;
          }
        if (cheapest.cpu.median() < 1.0 - noise) {
          cheapest.verified = true;
          return;
        }
        result_.notes.push_back(fmt::format(
            "without {} the model kept the tolerance, but took {:.2g} of the time when it was "
            "verified: it is not left out",
            result_.runs[cheapest.left_out.back()].ablation.effect, cheapest.cpu.median()));
        cheapest.cpu.ratios.clear();
        cheapest.left_out.pop_back();
        continue;
      }
      result_.notes.push_back(fmt::format(
          "without {} too the model does not keep the tolerance to its end ({})",
          result_.runs[cheapest.left_out.back()].ablation.effect,
          other.complete ? fmt::format("{:.2g}", worst_of(cheapest.changes)) : other.failure));
      cheapest.left_out.pop_back();
    }
    cheapest.changes.clear();
  }

  const Scene& scene_;
  const EffectsOptions& options_;
  Scene whole_;  // shortened for the budget
  EffectsStudy result_;
  double used_ = 0.0, limit_ = 1e30;  // CPU time [s]
  std::size_t done_ = 0, all_ = 0;
};

}  // namespace
}  // namespace mbd::effects_study

namespace mbd {

double Paired::median() const {
  if (ratios.empty()) return 1.0;
  std::vector<double> sorted = ratios;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  return 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]);
}
double Paired::least() const {
  return ratios.empty() ? 1.0 : *std::min_element(ratios.begin(), ratios.end());
}
double Paired::most() const {
  return ratios.empty() ? 1.0 : *std::max_element(ratios.begin(), ratios.end());
}

bool EffectRun::saves_time() const {
  return !cpu.ratios.empty() && cpu.most() < 1.0 - effects_study::noise;
}
bool EffectRun::keeps_all() const {
  return std::all_of(changes.begin(), changes.end(), [](const Change& c) { return c.known; });
}
double EffectRun::worst() const { return effects_study::worst_of(changes); }
std::size_t EffectRun::culprit() const {
  return static_cast<std::size_t>(std::max_element(changes.begin(), changes.end(),
                                                   [](const Change& a, const Change& b) {
                                                     return (a.known ? a.rms : -1.0) <
                                                            (b.known ? b.rms : -1.0);
                                                   }) -
                                  changes.begin());
}
double CheapestModel::worst() const { return effects_study::worst_of(changes); }

EffectsStudy study_effects(const Scene& scene, const EffectsOptions& options) {
  if (!(options.tolerance > 0.0))
    throw Error(fmt::format("the tolerance {:g} must be positive", options.tolerance));
  return effects_study::Study(scene, options).make();
}

}  // namespace mbd
