#include "libmbd/study/trust/torture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "libmbd/compile/control.hpp"
#include "libmbd/run/run.hpp"
#include "libmbd/scene/transient.hpp"
#include "libmbd/study/trial/setting.hpp"
#include "libmbd/study/trust/transform.hpp"
#include "libmbd/text/files.hpp"
#include "libmbd/text/spelling.hpp"
#include "libmbd/text/text.hpp"

namespace mbd {
namespace {

constexpr int torture_samples = 100;
constexpr double share_of_base = 1.0 / 40.0;  // of the budget: about as many runs are made
constexpr double much_put_in = 0.1;           // put in, of what moved
constexpr long most_trial_steps = 200;        // of a trial of steps

// The rows of one run, to the last bit.
class BitRows : public Observer {
 public:
  void accepted(const Sample& sample) override {
    rows.insert(rows.end(), sample.row.begin(), sample.row.end());
  }
  std::vector<double> rows;
};

bool same_bit_rows(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

class TortureSession {
 public:
  TortureSession(const Scene& scene, const TortureOptions& options) : options_(options) {
    result_.model = scene.name;
    result_.file = scene.file;
    result_.date = utc_now("%Y-%m-%dT%H:%M:%SZ");
    scene_ = without_inertial_marks(scene);
    for (const std::string& kind : options.kinds)
      if (std::find(trial_kinds.begin(), trial_kinds.end(), kind) == trial_kinds.end()) {
        const std::vector<std::string_view> known(trial_kinds.begin(), trial_kinds.end());
        throw Error(fmt::format("--trials {}: there are no such trials{}", kind,
                                suggest(kind, known, "kinds of trials")));
      }
    if (scene.path && scene_.path->marks.size() != scene.path->marks.size())
      result_.notes.push_back(
          "marks and stops of the path on components along inertial axes are left out: the moved "
          "scene does not record them as one number");
    length_ = compile(scene_).system->length_scale();
  }

  Torture go() {
    if (!make_twins()) return std::move(result_);
    motions();
    units();
    orders();
    threads();
    steps();
    tolerances();
    load_steps();
    return std::move(result_);
  }

 private:
  bool wants(std::string_view kind) const {
    return options_.kinds.empty() ||
           std::find(options_.kinds.begin(), options_.kinds.end(), kind) != options_.kinds.end();
  }

  TrialOptions limits() const {
    TrialOptions limits;
    limits.samples = torture_samples;
    limits.repeats = 1;
    // Ten times the run as it is: others may need smaller steps.
    const double left = std::max(1.0, options_.budget - result_.cpu);
    limits.limit = base_cpu_ > 0.0    ? std::max(2.0, std::min(left, 10.0 * base_cpu_))
                   : scene_.transient ? std::max(1.0, options_.budget * share_of_base)
                                      : 0.25 * options_.budget;  // cannot be shortened
    limits.wall = 10.0 * limits.limit + 10.0;
    limits.interrupted = options_.interrupted;
    return limits;
  }

  bool stopped() {
    if (options_.interrupted != nullptr && *options_.interrupted) result_.interrupted = true;
    return result_.interrupted;
  }
  bool spent() {
    if (stopped()) return true;
    if (result_.cpu < options_.budget) return false;
    if (!said_)
      result_.notes.push_back(
          fmt::format("not all was tried: the {:g} s allowed are used up", options_.budget));
    said_ = true;
    return true;
  }
  void tell(const std::string& what) {
    if (options_.progress) options_.progress(result_.model + ": " + what);
  }

  // The runs that all others are compared with.
  bool make_twins() {
    tell("as it is");
    for (int attempt = 0; attempt < 4; ++attempt) {
      twins_ = std::make_unique<Twins>(scene_, limits());
      result_.cpu += twins_->cpu();
      const Trial& base = twins_->base();
      if (twins_->failure().empty()) {
        base_cpu_ = std::max(base.cpu, 1e-3);
        return true;
      }
      // Too long: as much of it as fits.
      if (!base.stopped || !scene_.transient || base.findings.at.empty() ||
          !(base.findings.at.back() > 0.0))
        break;
      const double duration = 0.7 * base.findings.at.back();
      result_.notes.push_back(
          fmt::format("shortened to {:.4g} s of {:.4g} s, so that about forty runs fit into {:g} s",
                      duration, scene_.transient->duration, options_.budget));
      scene_ = shortened(scene_, duration);
    }
    TortureTrial trial{.kind = "run", .name = "as it is"};
    trial.verdict = twins_->base().stopped ? Verdict::warn : Verdict::fail;
    trial.reason = twins_->failure();
    if (twins_->base().stopped) trial.reason += "; nothing was tried, give a larger --budget";
    trial.cpu = twins_->cpu();
    result_.trials.push_back(trial);
    return false;
  }

  // A run that must give the same.
  template <class Back>
  void compare(std::string_view kind, const std::string& name, const Scene& scene, const Back& back,
               const FarNoise& far = {}) {
    if (spent()) return;
    tell(fmt::format("{}, {}", kind, name));
    TortureTrial trial{.kind = std::string(kind), .name = name};
    Trial run = run_trial(scene, limits());
    trial.cpu = run.cpu;
    result_.cpu += run.cpu;
    if (!run.complete) {
      trial.verdict = Verdict::fail;
      trial.reason = "the run as it is comes to its end; this one: " + run.failure;
      result_.trials.push_back(trial);
      return;
    }
    std::vector<std::string> not_compared;
    const Sameness sameness = twins_->compare(back(std::move(run.findings), not_compared), far);
    trial.compared = sameness.comparable;
    trial.difference = sameness.difference;
    trial.bound = sameness.bound;
    trial.quantity = sameness.quantity;
    trial.until = sameness.until;
    const char* const place = scene_.transient ? "t ="
                              : scene_.path    ? "special point"
                                               : "load factor";
    if (!sameness.comparable) {
      trial.verdict = Verdict::warn;
      trial.reason =
          "not compared: what tolerances and round-off change is larger than 1e-3 from the "
          "beginning";
    } else if (!sameness.what.empty()) {
      // The size of a scene, in which the steps of a path are measured, is that of its box along the inertial axes.
      trial.verdict =
          scene_.path && sameness.difference <= sameness.bound ? Verdict::warn : Verdict::fail;
      trial.reason = sameness.what;
    } else if (!sameness.same()) {
      const bool singular = run.counters.tolerant > 0 || twins_->base().counters.tolerant > 0;
      trial.verdict =
          singular || sameness.difference <= 10.0 * sameness.bound ? Verdict::warn : Verdict::fail;
      trial.reason = fmt::format(
          "{} differs at {} {:.6g}{}", sameness.quantity, place, sameness.at,
          singular ? "; it passes singular configurations, where motion and velocities are known "
                     "to the root of the tolerance"
                   : "");
    } else if (!sameness.whole) {
      trial.reason = fmt::format(
          "compared up to {} {:.6g}: from there on tolerances and round-off change more than 1e-3",
          place, sameness.until);
    }
    for (const std::string& what : not_compared)
      trial.reason += (trial.reason.empty() ? "not compared: " : "; not compared: ") + what;
    result_.trials.push_back(trial);
  }

  // What looks at the motion along inertial axes and in SI units would have to be moved and rescaled with it.
  bool feeds_back(const char* what) {
    const std::string feedback = first_feedback(scene_);
    if (!feedback.empty())
      result_.notes.push_back(fmt::format("not run {}: {} has laws of sensors", what, feedback));
    return !feedback.empty();
  }

  void motions() {
    if (feeds_back("moved")) return;
    const auto back = [this](const RigidMotion& motion) {
      return [this, motion](Findings findings, std::vector<std::string>& not_compared) {
        return moved_back(std::move(findings), twins_->scene(), motion, not_compared);
      };
    };
    const auto carried = [](std::vector<std::string>& notes, const Transformed& t) -> const Scene& {
      for (const std::string& what : t.left_out)
        if (std::find(notes.begin(), notes.end(), what) == notes.end()) notes.push_back(what);
      return t.scene;
    };
    if (wants("motion"))
      for (std::uint64_t k = 0; k < 3; ++k) {
        const RigidMotion motion = random_motion(options_.seed + k, length_);
        compare("motion", fmt::format("seed {}", options_.seed + k),
                carried(result_.notes, moved(twins_->scene(), motion)), back(motion));
      }
    if (wants("far"))
      for (const double lengths : {1e3, 1e6}) {
        RigidMotion motion = random_motion(options_.seed, lengths * length_);
        motion.R.setIdentity();
        compare("far", fmt::format("{:g} lengths away", lengths),
                carried(result_.notes, moved(twins_->scene(), motion)), back(motion),
                {lengths * length_, length_, shortest_lever(scene_)});
      }
  }

  void units() {
    if (!wants("units") || feeds_back("in other units")) return;
    std::mt19937_64 random(options_.seed);
    const auto power = [&] { return std::pow(10.0, static_cast<double>(random() % 13) - 6.0); };
    std::vector<std::pair<std::string, UnitChange>> changes = {{"mm, t, s", {1e3, 1e-3, 1.0}}};
    for (int k = 0; k < 2; ++k) {
      UnitChange c;
      c.length = power();
      c.mass = power();
      c.time = power();
      changes.emplace_back(
          fmt::format("numbers of m x {:g}, kg x {:g}, s x {:g}", c.length, c.mass, c.time), c);
    }
    for (const auto& [name, change] : changes)
      compare("units", name, rescaled(twins_->scene(), change).scene,
              [this, change = change](Findings findings, std::vector<std::string>&) {
                return rescaled_back(std::move(findings), twins_->scene(), change);
              });
  }

  void orders() {
    if (!wants("order")) return;
    for (std::uint64_t k = 0; k < 2; ++k)
      compare("order", fmt::format("seed {}", options_.seed + k),
              reordered(twins_->scene(), options_.seed + k),
              [](Findings findings, std::vector<std::string>&) { return findings; });
  }

  void threads() {
    if (!wants("threads") || spent()) return;
    tell("threads");
    TortureTrial trial{.kind = "threads", .name = "two at once, and one alone"};
    trial.compared = true;
    Scene scene = twins_->scene();
    BitRows bits[3];
    std::string failure[3];
    double cpu[3] = {};
    const auto one = [&](std::size_t k) {
      try {
        const RunReport report = run(scene, {.output = {}, .observers = {&bits[k]}});
        failure[k] = report.failure;
        cpu[k] = base_cpu_;
      } catch (const std::exception& error) {
        failure[k] = error.what();
      }
    };
    std::thread first(one, 0), second(one, 1);
    first.join();
    second.join();
    one(2);
    trial.cpu = cpu[0] + cpu[1] + cpu[2];
    result_.cpu += trial.cpu;
    for (const std::string& what : failure)
      if (!what.empty()) {
        trial.verdict = Verdict::fail;
        trial.reason = what;
      }
    if (trial.verdict == Verdict::pass &&
        !(same_bit_rows(bits[0].rows, bits[1].rows) && same_bit_rows(bits[0].rows, bits[2].rows))) {
      trial.verdict = Verdict::fail;
      trial.reason = "results differ from run to run";
    }
    result_.trials.push_back(trial);
  }

  // Largest energy that came from nowhere, over the largest that moved; nothing: not known.
  static double energy_put_in(const Findings& f) {
    const auto column = [&](std::string_view name) {
      for (std::size_t c = 0; c < f.columns.size(); ++c)
        if (f.columns[c] == name) return c;
      return f.columns.size();
    };
    const std::size_t total = column("certify.total_energy"),
                      loads = column("certify.work_of_loads"),
                      drives = column("certify.work_of_drives"),
                      damping = column("certify.work_of_damping"),
                      kinetic = column("certify.kinetic_energy");
    if (damping >= f.columns.size() || f.rows.empty()) return 0.0;
    double most = 0.0, moved = 0.0;
    const std::vector<double>& first = f.rows.front();
    const auto balance = [&](const std::vector<double>& row) {
      return row[total] - row[loads] - row[drives] - row[damping];
    };
    for (const std::vector<double>& row : f.rows) {
      most = std::max(most, balance(row) - balance(first));
      moved = std::max({moved, row[kinetic], std::abs(row[total] - first[total]),
                        std::abs(row[loads]), std::abs(row[drives]), std::abs(row[damping])});
    }
    return moved > 0.0 ? most / moved : 0.0;
  }

  void steps() {
    if (!wants("steps") || !scene_.transient) return;
    const double duration = scene_.transient->duration;
    for (int k = -7; k <= -1 && !spent(); ++k) {
      const double h = duration * std::pow(10.0, k);
      Setting setting;
      setting.step = h;
      if (scene_.transient->method == TimeMethod::ida)
        setting.method = TimeMethod::generalized_alpha;
      TortureTrial trial{.kind = "steps", .name = fmt::format("step {:.3g} s", h)};
      tell(trial.name);
      Scene scene = with_probes(scene_);
      const long count = std::min(most_trial_steps, std::lround(std::pow(10.0, -k)));
      scene.transient->duration = static_cast<double>(count) * h;
      scene = with(scene, setting);
      TrialOptions limits = this->limits();
      limits.samples = static_cast<int>(count);
      limits.limit = std::max(limits.limit, 5.0);
      const Trial run = run_trial(scene, limits);
      trial.cpu = run.cpu;
      result_.cpu += run.cpu;
      const double put_in = energy_put_in(run.findings);
      if (run.lost || run.stopped) {
        trial.verdict = Verdict::fail;
        trial.reason = run.failure;
      } else if (!run.complete) {
        // A step that is too long may end a run, with its reason; one that is short has to do.
        trial.verdict = Verdict::warn;
        trial.reason = "ends: " + run.failure;
      } else if (put_in > much_put_in) {
        trial.verdict = Verdict::warn;
        trial.reason = fmt::format(
            "comes to its end, but energy of {:.2g} of what moved has come from "
            "nowhere: too large a step",
            put_in);
      } else {
        trial.reason = fmt::format("{} steps", run.counters.steps);
      }
      result_.trials.push_back(trial);
    }
  }

  Trial run_with(double tolerance, TortureTrial& trial) {
    Setting setting;
    setting.method = TimeMethod::radau;
    setting.tolerance = tolerance;
    tell(trial.name);
    TrialOptions limits = this->limits();
    limits.limit = std::max(limits.limit, 5.0);
    const Trial run = run_trial(with(with_probes(scene_), setting), limits);
    trial.cpu = run.cpu;
    result_.cpu += run.cpu;
    if (run.lost) {
      trial.verdict = Verdict::fail;
      trial.reason = run.failure;
    } else if (!run.complete) {
      trial.verdict = Verdict::warn;
      trial.reason = (run.stopped ? "" : "ends: ") + run.failure;
    }
    return run;
  }

  // The largest difference of a run to the best one, over the size of what differs, which `trial` names.
  static double difference(const Findings& run, const Findings& truth,
                           const std::vector<Components>& positions, TortureTrial& trial) {
    double error = 0.0;
    for (const Components& c : positions) {
      const double scale = scale_of(c, truth, truth.at.size(), 1e-6, Measure::value).value;
      for (std::size_t i = 0; i < std::min(truth.at.size(), run.at.size()); ++i) {
        const double e = distance(c, truth, i, run, i) / scale;
        if (e <= error) continue;
        error = e;
        trial.quantity = c.name;
      }
    }
    return error;
  }

  void tolerances() {
    if (!wants("tolerances") || !scene_.transient) return;
    std::vector<double> values;
    for (int k = -3; k >= -9; --k) values.push_back(std::pow(10.0, k));
    std::vector<TortureTrial> trials;
    std::vector<Trial> runs;
    for (const double value : values) {
      if (spent()) break;
      trials.push_back({.kind = "tolerances", .name = fmt::format("radau, tolerance {:g}", value)});
      runs.push_back(run_with(value, trials.back()));
    }
    // Against the finest that came to its end.
    std::size_t finest = runs.size();
    for (std::size_t k = 0; k < runs.size(); ++k)
      if (runs[k].complete) finest = k;
    if (finest < runs.size()) {
      const Findings& truth = runs[finest].findings;
      std::vector<Components> positions;
      add_components(positions, truth, {}, "the run");
      std::erase_if(positions,
                    [](const Components& c) { return c.unit != "m" && c.unit != "rad"; });
      double before = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < finest; ++k) {
        if (!runs[k].complete) continue;
        TortureTrial& trial = trials[k];
        const double error = difference(runs[k].findings, truth, positions, trial);
        trial.compared = true;
        trial.difference = error;
        trial.bound = 3.0 * before;  // steps change in jumps
        trial.until = truth.at.back();
        const double floor = 1e-6;  // where nothing is gained that a user would see
        if (!(error <= std::max(3.0 * before, floor))) {
          trial.verdict = Verdict::warn;
          trial.reason = fmt::format(
              "its difference to tolerance {:g} is larger than that of the tolerance before: "
              "chaos, or "
              "an oscillation that no run resolves",
              values[finest]);
        } else {
          trial.reason = fmt::format("difference to tolerance {:g}", values[finest]);
        }
        if (!std::isfinite(trial.bound)) trial.bound = 0.0;
        before = std::isfinite(before) ? std::min(before, error) : error;
      }
      trials[finest].reason = "the finest, with which the others are compared";
    }
    result_.trials.insert(result_.trials.end(), trials.begin(), trials.end());
  }

  void load_steps() {
    if (!wants("loads") || !scene_.statics || scene_.transient) return;
    for (const int count : {1, 3, 10}) {
      Scene scene = twins_->scene();
      scene.statics->steps = count;
      compare("loads", fmt::format("in {} step{} at first", count, count == 1 ? "" : "s"), scene,
              [](Findings findings, std::vector<std::string>&) { return findings; });
    }
  }

  const TortureOptions& options_;
  Scene scene_;
  double length_ = 1.0;
  Torture result_;
  std::unique_ptr<Twins> twins_;
  double base_cpu_ = 0.0;
  bool said_ = false;
};

std::string csv_text(std::string text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c == '\n' ? ' ' : c;
  }
  return quoted + "\"";
}

}  // namespace

Verdict Torture::verdict() const {
  Verdict worst = Verdict::pass;
  for (const TortureTrial& trial : trials) worst = std::max(worst, trial.verdict);
  return worst;
}

const TortureTrial* Torture::culprit() const {
  const Verdict worst = verdict();
  if (worst == Verdict::pass) return nullptr;
  return &*std::find_if(trials.begin(), trials.end(),
                        [&](const TortureTrial& trial) { return trial.verdict == worst; });
}

Torture torture(const Scene& scene, const TortureOptions& options) {
  return TortureSession(scene, options).go();
}

std::string to_text(const Torture& torture) {
  std::string text = fmt::format("{}: {}, {} trials, {:.3g} s of CPU time\n", torture.model,
                                 name_of(torture.verdict()), torture.trials.size(), torture.cpu);
  text += fmt::format("{:4}  {:10}  {:>10}  {:>8}  {}\n", "", "trial", "difference", "bound", "");
  for (const TortureTrial& trial : torture.trials) {
    const std::string numbers =
        trial.compared && !trial.quantity.empty()
            ? fmt::format("{:10.1e}  {:8}", trial.difference,
                          trial.bound > 0.0 ? fmt::format("{:.1e}", trial.bound) : "")
            : fmt::format("{:10}  {:8}", "", "");
    std::string words = trial.name;
    if (!trial.reason.empty()) words += ": " + trial.reason;
    text += wrapped(fmt::format("{:4}  {:10}  {}  ", name_of(trial.verdict), trial.kind, numbers),
                    words, 40);
  }
  for (const std::string& note : torture.notes) text += wrapped("note: ", note, 6);
  return text;
}

std::string to_csv(const std::vector<Torture>& all) {
  std::string text =
      "model,trial,name,verdict,difference,bound,quantity,until,cpu_seconds,reason\n";
  for (const Torture& one : all)
    for (const TortureTrial& t : one.trials)
      text +=
          fmt::format("{},{},{},{},{},{},{},{},{:.3g},{}\n", one.model, t.kind, csv_text(t.name),
                      name_of(t.verdict), t.compared ? fmt::format("{:.3g}", t.difference) : "",
                      t.compared ? fmt::format("{:.3g}", t.bound) : "", t.quantity,
                      t.compared ? fmt::format("{:.6g}", t.until) : "", t.cpu, csv_text(t.reason));
  return text;
}

std::string to_json(const Torture& torture) {
  using Json = nlohmann::ordered_json;
  Json trials = Json::array();
  for (const TortureTrial& t : torture.trials)
    trials.push_back({{"trial", t.kind},
                      {"name", t.name},
                      {"verdict", name_of(t.verdict)},
                      {"reason", t.reason},
                      {"difference", t.compared ? Json(t.difference) : Json()},
                      {"bound", t.compared ? Json(t.bound) : Json()},
                      {"quantity", t.quantity},
                      {"compared_until", t.compared ? Json(t.until) : Json()},
                      {"cpu", t.cpu}});
  const TortureTrial* const culprit = torture.culprit();
  const Json all = {
      {"model", torture.model},
      {"file", torture.file},
      {"version", version()},
      {"date", torture.date},
      {"verdict", name_of(torture.verdict())},
      {"culprit", culprit != nullptr ? Json(culprit->kind + ", " + culprit->name) : Json()},
      {"notes", torture.notes},
      {"cpu", torture.cpu},
      {"trials", trials}};
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace mbd
