#include "libmbd/run/run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <new>
#include <span>

#include "libmbd/compile/redundancy.hpp"
#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/core/stop.hpp"
#include "libmbd/material/scene_files.hpp"
#include "libmbd/material/solid_shapes.hpp"
#include "libmbd/pictures/plot.hpp"
#include "libmbd/pictures/shapes.hpp"
#include "libmbd/results/build_facts.hpp"
#include "libmbd/results/expect.hpp"
#include "libmbd/results/history.hpp"
#include "libmbd/results/load_sampling.hpp"
#include "libmbd/results/time_error.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/transient.hpp"
#include "libmbd/text/files.hpp"
#include "libmbd/text/text.hpp"
#include "libmbd/view/drawing.hpp"
#include "libmbd/view/motion.hpp"
#include "solvers/constraints/initial.hpp"
#include "solvers/constraints/mechanism.hpp"
#include "solvers/constraints/parts.hpp"
#include "solvers/constraints/redundancy.hpp"
#include "solvers/linear/block_solver.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/newton/increments.hpp"
#include "solvers/statics/path.hpp"
#include "solvers/statics/stability.hpp"
#include "solvers/statics/statics.hpp"

namespace mbd {
namespace {

// Of many sentences, those that fit into a note; the report has all.
std::string first_of(const std::vector<std::string>& sentences) {
  constexpr std::size_t most = 4;
  const auto shown = std::span(sentences).first(std::min(most, sentences.size()));
  return fmt::format("{}{}", fmt::join(shown, "; "),
                     sentences.size() > most
                         ? fmt::format("; and {} more, all in report.json", sentences.size() - most)
                         : "");
}

constexpr double much_energy = 0.1;   // of the largest kinetic energy, change or work: worth a note
constexpr double much_noise = 1e-3;   // of constraint forces: worth a note
constexpr long most_monitored = 200;  // states whose residuals and energies are looked at

constexpr const char* result_files[] = {"report.json", "history.csv",  "history.svg", "path.csv",
                                        "path.svg",    "shapes.svg",   "motion.bin",  "run.h5",
                                        "modes.csv",   "modes.json",   "mac.csv",     "mac.json",
                                        "view.html",   checkpoint_file};

Seconds& operator+=(Seconds& sum, const Seconds& more) {
  sum.wall += more.wall;
  sum.cpu += more.cpu;
  return sum;
}

class Stopwatch {
 public:
  // Since the last lap, or the construction.
  Seconds lap() {
    Seconds result{passed(), 0.0};
    settle(&result);
    return result;
  }
  // Adds what has passed to a sum. CPU time is asked for now and then only, which is a call of the system, and divided
  // among sums as wall time is.
  void lap(Seconds& sum) {
    const double wall = passed();
    sum.wall += wall;
    std::size_t i = 0;
    while (i < pending_.size() && pending_[i].sum != &sum && pending_[i].sum != nullptr) ++i;
    if (i == pending_.size()) {
      settle(nullptr);
      i = 0;
    }
    pending_[i].sum = &sum;
    pending_[i].wall += wall;
    unsettled_ += wall;
    if (unsettled_ > now_and_then) settle(nullptr);
  }

 private:
  static constexpr double now_and_then = 2e-3;  // [s]
  struct Pending {
    Seconds* sum = nullptr;
    double wall = 0.0;
  };

  double passed() {
    const auto wall = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(wall - wall_).count();
    wall_ = wall;
    return seconds;
  }
  // Divides CPU time since the last time, `last` among those who get some of it.
  void settle(Seconds* last) {
    const double cpu = used_cpu(), used = cpu - cpu_;
    const double wall = unsettled_ + (last != nullptr ? last->wall : 0.0);
    cpu_ = cpu;
    for (Pending& p : pending_) {
      if (p.sum != nullptr && wall > 0.0) p.sum->cpu += used * p.wall / wall;
      p = {};
    }
    if (last != nullptr) last->cpu = wall > 0.0 ? used * last->wall / wall : used;
    unsettled_ = 0.0;
  }

  std::chrono::steady_clock::time_point wall_ = std::chrono::steady_clock::now();
  double cpu_ = used_cpu();
  std::array<Pending, 3> pending_;
  double unsettled_ = 0.0;
};

// Constraint residuals of some states.
void monitor_constraints(const System& system, const State& state, RunReport& report) {
  const ConstraintResiduals now = constraint_residuals(system, state);
  const auto keep_worst = [&](WorstConstraint& worst, double value, Index row) {
    if (row >= 0 && (worst.where.empty() || value > worst.value))
      worst = {value, state.t, row_in_words(system, row)};
  };
  keep_worst(report.position, now.position, now.position_row);
  keep_worst(report.velocity, now.velocity, now.velocity_row);
}

// Energies of some states.
void monitor_energies(const System& system, const State& state, RunReport& report) {
  const Energies energies = system.energies(state);
  report.momentum_end = state.V.empty() ? Vec6(Vec6::Zero()) : system.momentum(state);
  report.work = state.work;
  report.kinetic_most = std::max(report.kinetic_most, energies.kinetic);
  if (report.sampled_states++ == 0) {
    report.energy_start = energies;
    report.momentum_start = report.momentum_end;
    report.energy_least = report.energy_most = energies.total();
  }
  report.energy_end = energies;
  report.energy_least = std::min(report.energy_least, energies.total());
  report.energy_most = std::max(report.energy_most, energies.total());
}

// Throws Error if no results can be written there. Leaves nothing behind.
void check_directory(const std::filesystem::path& directory) {
  namespace fs = std::filesystem;
  std::error_code code;
  std::vector<fs::path> missing;  // the deepest first
  for (fs::path path = fs::absolute(directory, code);
       !code && !path.empty() && !fs::exists(path, code) && path != path.root_path();
       path = path.parent_path())
    missing.push_back(path);
  const auto remove = [&] {
    for (const fs::path& path : missing) fs::remove(path, code);  // if empty
  };
  try {
    make_directory(directory);
  } catch (const Error&) {
    remove();
    throw;
  }
  remove();
}

// Times of frames of motion inside a transient: equal parts of it.
class FrameTimes {
 public:
  FrameTimes(int count, double end) : count_(count), end_(end) {}
  // [s]; infinity after the last before the end.
  double next() const {
    return k_ + 1 < count_ ? end_ * static_cast<double>(k_) / static_cast<double>(count_ - 1)
                           : std::numeric_limits<double>::infinity();
  }
  void advance() { ++k_; }

 private:
  int count_, k_ = 1;
  double end_;
};

// One run under way: the model, who watches it, and the report that grows.
class Run {
 public:
  Run(const Scene& scene, const RunOptions& options) : scene_(scene), options_(options) {
    report_.model = scene.name;
    report_.file = scene.file;
    report_.id = options.id.empty() ? new_run_id() : options.id;
    report_.date = utc_now("%Y-%m-%dT%H:%M:%SZ");
    report_.parameters = scene.parameters;
    report_.statics = scene.statics;
    if (scene.transient) report_.transient = transient_of(scene);
    report_.path = scene.path;
    report_.notes = options.notes;
    report_.accuracy = options.accuracy;

    model_ = compile(scene);  // which checks the scene first
    if (scene.transient) rows_.emplace(scene);
    for (Observer* const observer : options.observers)
      if (auto* const of_motion = dynamic_cast<MotionObserver*>(observer))
        motion_observers_.push_back(of_motion);
    keeps_motion_ = scene.motion_output && (options.output || !motion_observers_.empty());
    if (keeps_motion_ && scene.motion_output->frames)
      frames_.emplace(*scene.motion_output->frames, rows_->end());
    columns_ = columns(model_);
    row_.resize(columns_.size());
    expectations_ = std::make_unique<Expectations>(scene, model_);
    marks_ = find_marks(scene, columns_);
    if (options.output) {
      lock(*options.output);
      const char* const name = scene.path ? "path.svg" : "history.svg";
      plot_ = std::make_unique<HistoryPlot>(*options.output / name, scene_, model_);
      check_directory(*options.output);
    }
    prepare_checkpoints();

    const System& system = *model_.system;
    report_.nodes = system.nodes();
    report_.unknowns = system.unknowns();
    report_.multipliers = system.multipliers();
    report_.redundant = repetitions(model_);
    if (!report_.redundant.empty())
      report_.notes.push_back(
          fmt::format("{} of the constraints repeat{} others ({}): the motion does not depend on "
                      "them, and reactions are those of least norm, sum of F^2 + (M/L)^2 with "
                      "L = {:.6g} m",
                      model_.redundant.size(), model_.redundant.size() == 1 ? "s" : "",
                      first_of(report_.redundant), system.reaction_length()));
    for (const RecordScene& record : scene.records)
      shares_reactions_ = shares_reactions_ || (record.joint && !report_.redundant.empty());
    if (keeps_motion_) shares_reactions_ = shares_reactions_ || !report_.redundant.empty();
    if (options.audit) {
      audit_.emplace(scene_, system, options.certify);
      audit_->set_load_sampling(load_sampling(scene_, model_));
    }
    for (const auto& batch : system.batches())
      report_.batches.push_back({std::string(batch->type()), batch->size(), batch->bytes()});
    report_.compile = watch_.lap();
  }

  RunReport go() {
    State state = model_.initial;
    try {
      if (scene_.statics && !from_) find_equilibrium(state);
      if (scene_.path) follow(state);
      if (scene_.transient) integrate(state);
    } catch (const Stopped&) {
      end_early(state, "interrupted", Failure::stopped);
    } catch (const OutOfMemory& error) {
      end_early(state, error.what(), Failure::memory);
    } catch (const std::bad_alloc&) {
      end_early(state,
                fmt::format("out of memory, with {} unknowns; take fewer elements, bodies or "
                            "rows, or more memory",
                            report_.unknowns),
                Failure::memory);
    } catch (const Error& error) {  // of a solver, say, in the middle of it
      if (report_.rows == 0) throw;
      end_early(state, error.what(), error.kind());
    }
    report_.t = state.t;
    report_.load_factor = state.load_factor;
    try {
      finish();
    } catch (
        const std::bad_alloc&) {  // once more: much has been given back, and less is left to do
      report_.failure = fmt::format(
          "out of memory at the end of the run, with {} rows; take fewer of them, or more memory",
          report_.rows);
      report_.kind = Failure::memory;
      finish();
    }
    return std::move(report_);
  }

 private:
  // --- checkpoints ---

  void prepare_checkpoints() {
    every_ = options_.checkpoint_every;
    if (!every_ && !options_.restart) return;
    const char* const option = options_.restart ? "--restart" : "--checkpoint-every";
    if (!scene_.transient)
      throw Error(scene_.source,
                  fmt::format("{}: there is no <transient>, whose steps go on; leave "
                              "it out",
                              option));
    if (scene_.transient->method == TimeMethod::ida)
      throw Error(scene_.transient->source,
                  fmt::format("{}: method=\"ida\" keeps a history that cannot be saved; take "
                              "generalized_alpha or radau",
                              option));
    if (scene_.motion_output)
      throw Error(scene_.motion_output->source,
                  fmt::format("{}: motion (<motion_output>, --motion, --view, --hdf5) is not kept "
                              "with checkpoints; leave one of them out",
                              option));
    if (!options_.output)
      throw Error(fmt::format("{}: checkpoints stand with the results; name a directory", option));
    words_ = model_in_words();
    if (!options_.restart) return;
    from_ = read_checkpoint(*options_.output);
    if (const std::string id = run_id_in(from_->history); !id.empty()) report_.id = id;
    const auto refuse = [&](const std::string& what) {
      return Error(fmt::format("{}: {}", (*options_.output / checkpoint_file).string(), what));
    };
    if (from_->columns != columns_in_words() || from_->output != output_in_words())
      throw refuse(
          "is of another model, or of other records or times of output; give those that the run "
          "was begun with, or begin it anew, without --restart");
    if (from_->model != words_)
      throw refuse(
          "the model's file or a parameter is not as it was when the run was begun; give those of "
          "then, or begin it anew, without --restart");
    if (every_ && *every_ != from_->every)
      throw refuse(
          "the run was begun with another --checkpoint-every, on which the last digits depend; "
          "leave it out");
    every_ = from_->every;
  }

  std::string columns_in_words() const {
    std::string text = scene_.name;
    for (const Column& column : columns_) text += " " + column.name + "[" + column.unit + "]";
    return text;
  }
  // Of a scene that a program made, its parameters alone.
  std::string model_in_words() const {
    std::string text;
    for (const auto& [name, value] : scene_.parameters)
      text += fmt::format("{}={:.17g} ", name, value);
    for (const std::string& file : files_of(scene_))
      text += fmt::format("{:016x} ", checksum_of_file(file));
    return text;
  }
  std::string output_in_words() const {
    const TransientScene& t = *scene_.transient;
    return fmt::format("{:.17g} {:.17g} {} {:.17g}", t.duration, row_interval(t).value_or(0.0),
                       t.output_steps, rows_->end());
  }

  // Rows of results as they were.
  void replay(const State& state) {
    write_file(*options_.output / "history.csv", from_->history);
    const History history = read_history(*options_.output / "history.csv");
    const std::size_t rows = history.rows();
    for (std::size_t i = 0; i < rows; ++i) {
      for (std::size_t c = 0; c < row_.size(); ++c) row_[c] = history.values[c][i];
      if (report_.rows == 0) begin();
      for (Observer* const observer : observers_) observer->accepted({model_, state, row_});
      ++report_.rows;
    }
  }

  void go_on_from(Stepper& stepper, State& state) {
    try {
      stepper.restore(from_->stepper, state);
    } catch (const Error& error) {
      throw Error(fmt::format("{}: {}; begin the run anew, without --restart",
                              (*options_.output / checkpoint_file).string(), error.what()));
    }
    const RunReport& r = from_->report;
    report_.sampled_states = r.sampled_states;
    report_.position = r.position;
    report_.velocity = r.velocity;
    report_.energy_start = r.energy_start;
    report_.energy_end = r.energy_end;
    report_.energy_least = r.energy_least;
    report_.energy_most = r.energy_most;
    report_.kinetic_most = r.kinetic_most;
    report_.work = r.work;
    report_.momentum_start = r.momentum_start;
    report_.momentum_end = r.momentum_end;
    report_.most_iterations = r.most_iterations;
    force_most_ = from_->force_most;
    replay(state);
    report_.notes.push_back(fmt::format(
        "went on from a checkpoint at t = {:.9g} s: what the certificate says of single "
        "steps, and costs, are of the steps since then",
        state.t));
  }

  long checkpoints_until(const State& state) const {
    if (every_->rows > 0) return report_.rows / every_->rows;
    const double part = scene_.transient->duration / CheckpointEvery::parts;
    return static_cast<long>(std::floor((state.t + rows_->slack()) / part));
  }

  // After a step, when everything that it has to give has been written.
  void keep(Stepper& stepper, const State& state, long step, double monitor_at) {
    if (!every_) return;
    const long due = checkpoints_until(state);
    if (kept_parts_ < 0) kept_parts_ = 0;
    if (due <= kept_parts_) return;
    kept_parts_ = due;
    Checkpoint of_stepper =
        stepper.save(state);  // also where it is not written: the same steps follow
    const auto now = std::chrono::steady_clock::now();
    if (every_->rows == 0 &&
        std::chrono::duration<double>(now - checkpoint_at_).count() < every_->seconds)
      return;
    checkpoint_at_ = now;
    history_->flush();
    RunCheckpoint whole;
    whole.columns = columns_in_words();
    whole.model = words_;
    whole.output = output_in_words();
    whole.every = *every_;
    std::ifstream history(*options_.output / "history.csv", std::ios::binary);
    whole.history.assign(std::istreambuf_iterator<char>(history), {});
    whole.stepper = std::move(of_stepper);
    whole.step = step;
    whole.monitor_at = monitor_at;
    whole.force_most = force_most_;
    whole.report = report_;
    write_checkpoint(*options_.output, whole);
  }

  // What is left of a step that did not come to its end is the last state that was accepted.
  void fail(const Error& error) {
    report_.failure = error.what();
    report_.kind = error.kind();
  }

  void end_early(State& state, const std::string& why, Failure kind) {
    stop::Scope::done();
    if (kept_) state = std::move(*kept_);
    if (report_.rows == 0) {
      discard_output();
      throw Error(fmt::format("{} at {}, before the first row of results; nothing has been written",
                              why, place_of(state)));
    }
    report_.failure = fmt::format("{} at {}", why, place_of(state));
    report_.kind = kind;
    monitor(state);
  }

  // Stops and ropes that hold nothing where the scene begins, in words.
  static std::string untouched(const System& system, const State& state) {
    std::string words;
    for (const NearKink& one : system.near_kinks(state)) {
      const bool is_below = one.x < one.kink.at;
      if ((is_below ? one.kink.below : one.kink.above) == 0.0 &&
          (is_below ? one.kink.above : one.kink.below) != 0.0)
        words +=
            fmt::format(", begin beyond {:g}, where {} begins to act", one.kink.at, one.element);
    }
    return words;
  }

  // What goes wrong before the first accepted state: nothing has been written, nothing will be.
  // Looks for the reason in the scene: constraints that repeat each other, a structure that nothing holds,
  // a part without inertia; else the failure is told as it is.
  [[noreturn]] void fail_to_start(const std::string& failure) {
    const System& system = *model_.system;
    constexpr Index most_analysed = 50'000;  // rows: seconds
    const Mechanism mechanism = system.multipliers() <= most_analysed
                                    ? analyze_mechanism(system, model_.initial)
                                    : Mechanism{};
    const bool driven = failure.find("nothing holds the motion") != std::string::npos;
    if ((in_statics_ || scene_.path) && mechanism.freedoms() > 0)
      throw Error(
          scene_.statics ? scene_.statics->source : scene_.path->source,
          fmt::format(
              "{}: no equilibrium was found: its parts are free to move in {} way{}, and {}{}, or "
              "give a "
              "<transient>",
              scene_.statics ? "static" : "path", mechanism.freedoms(),
              mechanism.freedoms() == 1 ? "" : "s", failure,
              driven ? untouched(system, model_.initial)
                     : "; hold them by joints or springs, start nearer to an equilibrium"));
    const auto has_both = [](const MassProperties& is) {
      return is.mass > 0.0 && is.inertia.determinant() > 0.0;
    };
    for (const BodyScene& body : scene_.bodies)
      if (failure.find(fmt::format("body '{}',", body.name)) != std::string::npos &&
          !has_both(mass_properties(body)))
        throw Error(body.source, label(body) +
                                     ": its acceleration at the start is not determined: it lacks "
                                     "mass or inertia that no joint replaces; give it both");
    if (in_statics_) throw Error(scene_.statics->source, "static: " + failure);
    if (scene_.path) throw Error(scene_.path->source, "path: " + failure);
    throw Error(scene_.transient->source, "transient: " + failure);
  }

  // Before the first accepted state: from here on an earlier result is lost.
  void begin() {
    observers_.push_back(expectations_.get());
    try {
      if (options_.output) open_output(*options_.output);
    } catch (const Error&) {
      discard_output();
      throw;
    }
    observers_.insert(observers_.end(), options_.observers.begin(), options_.observers.end());
  }

  // What has been opened and holds no row.
  void discard_output() {
    observers_.clear();
    history_.reset();
    motion_.reset();
    std::error_code code;
    for (const std::filesystem::path& file : report_.results) std::filesystem::remove(file, code);
    report_.results.clear();
  }

  // One run writes into a directory at a time. Where there is none yet, there is nothing to lock.
  void lock(const std::filesystem::path& directory) {
    std::error_code code;
    if (lock_ || !std::filesystem::is_directory(directory, code)) return;
    refuse_inputs(directory);
    lock_.emplace(directory);
  }

  // What the run reads is not written over.
  void refuse_inputs(const std::filesystem::path& directory) const {
    const std::vector<std::string> inputs = files_of(scene_);
    std::error_code code;
    for (const char* const name : result_files)
      for (const std::string& input : inputs)
        if (std::filesystem::equivalent(directory / name, input, code))
          throw Error((directory / name).string() +
                      ": is the model, or a file it is made of, and results would take its place; "
                      "choose another directory with --out");
  }

  void open_output(const std::filesystem::path& directory) {
    make_directory(directory);
    lock(directory);
    const std::string name = scene_.path ? "path" : "history";
    // Of an earlier run, perhaps of another kind.
    std::error_code code;
    for (const char* const old : result_files)
      if (old != name + ".csv" && !(from_ && old == checkpoint_file))
        std::filesystem::remove(directory / old, code);
    report_.results = {directory / (name + ".csv"), directory / (name + ".svg")};
    history_ = std::make_unique<HistoryWriter>(directory / (name + ".csv"), scene_.name, columns_,
                                               report_.id);
    observers_.push_back(history_.get());
    observers_.push_back(plot_.get());
    if (scene_.motion_output) {
      report_.results.push_back(directory / "motion.bin");
      motion_ = std::make_unique<MotionWriter>(directory / "motion.bin", drawing(scene_, model_),
                                               motion_blocks(model_), report_.id);
    }
    if (scene_.path) {
      shapes_ =
          std::make_unique<ShapesPlot>(directory / "shapes.svg", scene_.name + ": deformed shapes");
      observers_.push_back(shapes_.get());
      report_.results.push_back(directory / "shapes.svg");
    }
    report_.results.push_back(directory / "report.json");
  }

  void find_equilibrium(State& state) {
    in_statics_ = true;
    StaticOptions options = static_options(scene_, *scene_.statics);
    options.accepted = [this](const State& step) {
      kept_ = step;
      if (scene_.transient) return !interrupted(step);
      report_.equilibrium += watch_.lap();
      const bool going =
          (report_.rows > 0 || accept_reference()) && accept(step, true) && !interrupted(step);
      watch_.lap(report_.output);
      return going;
    };
    const std::unique_ptr<LinearSolver> solver =
        make_linear_solver(scene_.statics->linear_solver, PivotOrder::merged);
    const StaticReport result = solve_statics(*model_.system, *solver, options, state);
    report_.static_linear = solver->facts();
    report_.static_counters = result.counters;
    report_.most_static_iterations = result.most_iterations;
    report_.searched_steps = result.searched;
    report_.equilibrium += watch_.lap();
    if (!result.converged && report_.complete()) {
      if (report_.rows == 0) fail_to_start(result.failure);
      report_.failure = "static equilibrium: " + result.failure;
    }
    note_neutral(result.neutral, "of the equilibrium");
    report_.notes.insert(report_.notes.end(), result.passed.begin(), result.passed.end());
    if (result.converged) judge_stability(result);
    if (scene_.transient) note_jumps();
    in_statics_ = false;
  }

  // A law has the value of later times where it jumps, so that what is meant to be let go at t = 0 was let go before.
  void note_jumps() {
    const System& system = *model_.system;
    for (std::size_t i = 0; i < system.signals().size(); ++i)
      for (const Jump& jump : system.signals()[i].jumps())
        if (jump.t == 0.0 && jump.derivative == 0)
          report_.notes.push_back(fmt::format(
              "{} jumps at t = 0, and the equilibrium is that after it, in which nothing moves; "
              "if the motion is meant to begin with the jump, let it be a little later "
              "(t > 1e-9)",
              system.signal_name(i)));
  }

  void note_neutral(const std::vector<std::string>& motions, const std::string& of) {
    if (motions.empty()) return;
    report_.notes.push_back(fmt::format(
        "nothing answers {} {} ({}): it is left where it is, and any other is an equilibrium too; "
        "a "
        "joint or a spring would hold it",
        motions.size() == 1 ? std::string("one motion") : fmt::format("{} motions", motions.size()),
        of, fmt::join(motions, "; ")));
  }

  // Of the equilibrium of a <static>, by its negative eigenvalues, if they were counted.
  void judge_stability(const StaticReport& result) {
    if (!has_potential(scene_)) {
      const Index ways = result.diverging.value_or(0);
      report_.notes.push_back(
          (ways > 0 ? fmt::format("the equilibrium is unstable: forces drive it on in {} of the "
                                  "motions nearest to that (divergence); it would not stay there; "
                                  "otherwise its stability is not judged: ",
                                  ways)
           : result.diverging ? std::string("the stability of the equilibrium is not judged but "
                                            "for divergence, of which there is none: ")
                              : std::string("the stability of the equilibrium is not judged: ")) +
          without_potential(scene_));
      return;
    }
    report_.negative_eigenvalues = result.negative;
    report_.equilibrium += watch_.lap();
    if (report_.negative_eigenvalues.value_or(0) > 0)
      report_.notes.push_back(fmt::format(
          "the equilibrium is unstable, in {} way{}: it would not stay there; where <path> in "
          "place "
          "of <static> can start from no load, it shows where stability is lost",
          *report_.negative_eigenvalues, *report_.negative_eigenvalues == 1 ? "" : "s"));
  }

  void follow(State& state) {
    const PathScene& scene = *scene_.path;
    PathOptions options;
    options.method = scene.method;
    options.direction = scene.direction;
    options.step = scene.step;
    options.max_step = scene.max_step;
    options.points = scene.points;
    if (scene.length) options.length = *scene.length;
    options.branch = scene.branch;
    options.newton.tolerance = scene.tolerance;
    options.has_potential = has_potential(scene_);
    std::vector<double> row(columns_.size());
    for (std::size_t i = 0; i < marks_.size(); ++i)
      options.crossings.push_back(
          {[this, &row, column = marks_[i], value = scene.marks[i].value](const State& at) {
             sample_row(model_, at, row);
             return row[column] - value;
           },
           scene.marks[i].stops});
    options.accepted = [this](const PathPoint& point) {
      kept_ = point.state;
      report_.equilibrium += watch_.lap();
      *model_.path = {point.arc_length, point.branch, point.event, point.negative.value_or(-1)};
      const bool going = accept(point.state, true) && !interrupted(point.state);
      watch_.lap(report_.output);
      return going;
    };
    if (!options.has_potential)
      report_.notes.push_back(
          "stability is not counted: " + without_potential(scene_) +
          "; bifurcations are looked for among the motions that are nearest to losing stability");
    const std::unique_ptr<LinearSolver> solver = make_klu_solver();
    const PathReport result = follow_path(*model_.system, *solver, options, state);
    report_.static_counters = result.counters;
    report_.most_static_iterations = result.most_iterations;
    report_.special = result.special;
    note_neutral(result.neutral, "of the equilibria");
    report_.path_end = result.end;
    report_.notes.insert(report_.notes.end(), result.notes.begin(), result.notes.end());
    report_.path_load = {result.least_load, result.most_load};
    report_.equilibrium += watch_.lap();
    if (!result.complete && report_.complete()) {
      if (report_.rows == 0) fail_to_start(result.failure);
      report_.failure = "path: " + result.failure;
    }
  }

  // Row 0 of load steps. It need not satisfy prescribed motions, which do not grow with the load.
  bool accept_reference() {
    State reference = model_.initial;
    reference.load_factor = 0.0;
    if (!accept(reference, false)) return false;
    monitor_energies(*model_.system, reference, report_);
    return true;
  }

  // Which steps of a motion are monitored: some of the fixed ones, or the first that ends after each of equal times.
  struct Monitoring {
    long steps;  // 0: not fixed
    double pause, next = pause;

    bool includes(long step, double t, bool at_end) {
      const long every = (steps + most_monitored - 1) / most_monitored;
      if (steps > 0 || !(t >= next)) return at_end || (steps > 0 && step % every == 0);
      next = pause * (std::floor(t / pause) + 1.0);
      return true;
    }
  };

  void integrate(State& state) {
    kept_.reset();  // steps leave the state alone until they are done
    const TransientScene& transient = *report_.transient;
    check_initial_state(*model_.system, state, 1.0 / transient.duration);
    if (transient.rho_infinity == 1.0)
      report_.notes.push_back(
          "rho_infinity = 1 damps nothing: with constraints the integrator is only weakly stable "
          "and may diverge in long runs; 0.9 is safer");
    const TransientScene asked = transient;  // say_balance() writes what is chosen into that
    const std::unique_ptr<Stepper> stepper = make_stepper(*model_.system, asked);
    say_balance();
    begin_time_error(asked, state);
    const long steps = transient.step ? number_of_steps(transient) : 0;
    Monitoring monitoring{steps, transient.duration / static_cast<double>(most_monitored)};
    bool going = true;

    State inside = state;  // where steps are interpolated
    const bool rows_inside = steps == 0 || rows_->inside_steps();
    stepper->on_substep([&](const DenseStep& step) {
      if (audit_) audit_->piece(step);
      if (frames_) write_inside(step, *frames_, inside, going, [&] { return write_frame(inside); });
      if (rows_inside) write_inside(step, *rows_, inside, going, [&] { return write_row(inside); });
    });

    if (from_) {
      going = false;  // rows that restoring shows have been written
      resume(*stepper, state);
      monitoring.next = from_->monitor_at;
      going = true;
    } else {
      going = start(*stepper, state);
    }
    report_.output += watch_.lap();
    take_steps(*stepper, state, monitoring, going);
    if (!report_.complete() && report_.rows > 0) monitor(state);
    report_.integration += watch_.lap();
    report_.transient_counters = stepper->counters();
    report_.transient_linear = stepper->linear_facts();
    report_.step_sizes = stepper->sizes();
    if (report_.rows > 0) judge_round_off(*stepper);
  }

  void begin_time_error(const TransientScene& asked, const State& state) {
    if (!options_.estimate_error) return;
    if (every_) {
      report_.notes.push_back(
          "the error of steps in time is not estimated: the run has checkpoints");
      return;
    }
    time_error_.emplace(*model_.system, asked, watched());
    time_error_->start(state);
  }

  // Places, lengths and angles that are recorded. Not rotations, whose vectors go round.
  std::vector<Watched> watched() const {
    std::vector<Watched> all;
    for (const Channel& channel : model_.channels) {
      std::string name = channel.columns.front().name;
      const std::string& unit = channel.columns.front().unit;
      if (channel.columns.size() > 1) name.resize(name.rfind('.'));
      const schema::Recorded of = schema::recorded_in(scene_, name);
      if (of.quantity == nullptr || !follows_from_motion(*of.quantity)) continue;
      if (unit == "m" || (unit == "rad" && channel.columns.size() == 1))
        all.push_back({name, unit == "m", channel.columns.size(), channel.sample});
    }
    return all;
  }

  // The first row of a motion. False ends the run.
  bool start(Stepper& stepper, State& state) {
    const StepReport step = stepper.start(state);
    if (!step.converged) fail_to_start(step.failure);
    judge_laws(stepper.laws());
    watch_.lap(report_.integration);
    return accept(state, true) && write_frame(state);
  }

  // Where the checkpoint was made.
  void resume(Stepper& stepper, State& state) {
    go_on_from(stepper, state);
    judge_laws(stepper.laws());
    pass_rows(nominal_time(from_->step, state));
    kept_parts_ = checkpoints_until(state);
  }

  // Of a step's end: a fixed step may end beside its time, at a breakpoint.
  double nominal_time(long step, const State& state) const {
    const TransientScene& transient = *report_.transient;
    return transient.step ? static_cast<double>(step) * *transient.step : state.t;
  }

  // Whether there was one up to t.
  bool pass_rows(double t) {
    const bool due = rows_->next() <= t + rows_->slack();
    while (rows_->next() <= t + rows_->slack()) rows_->advance();
    return due;
  }

  void take_steps(Stepper& stepper, State& state, Monitoring& monitoring, bool& going) {
    const long steps = monitoring.steps;
    bool at_end = false;
    for (long n = from_ ? from_->step + 1 : 1; going && !at_end; ++n) {
      StepReport step;
      try {
        step = stepper.step(state);
      } catch (const Stopped&) {
        stop::Scope::done();
        report_.failure = "interrupted at " + place_of(state);
        report_.kind = Failure::stopped;
        break;
      }
      if (!going) break;  // a row inside the step ended it
      if (!step.converged) {
        report_.failure = steps > 0 ? fmt::format("step {} of {}, {}", n, steps, step.failure)
                                    : fmt::format("after {} steps, {}", n - 1, step.failure);
        report_.kind = step.kind;
        break;
      }
      if (audit_) audit_->step(step, state);
      report_.most_iterations = std::max(report_.most_iterations, step.iterations);
      watch_.lap(report_.integration);
      at_end = steps > 0 ? n == steps : state.t > rows_->end() - rows_->slack();
      const double t = nominal_time(n, state);
      const bool due = pass_rows(t);
      const bool monitored = monitoring.includes(n, state.t, at_end);
      if (due || at_end || rows_->at_steps())
        going = accept(state, monitored);
      else if (monitored)
        going = monitor_finite(state);
      if (frames_ && going && (at_end || frames_->next() <= t + rows_->slack())) {
        while (frames_->next() <= t + rows_->slack()) frames_->advance();
        going = write_frame(state);
      }
      if (options_.progress)
        options_.progress({state.t, report_.transient->duration, n, steps, step.iterations});
      watch_.lap(report_.output);
      if (going && !at_end) {
        going = !interrupted(state);
        if (going) keep(stepper, state, n, monitoring.next);
      }
    }
  }

  // Says what laws of time the steps may pass over.
  void judge_laws(const LawSteps& of_steps) {
    const TransientScene& transient = *scene_.transient;
    if (transient.step) {
      report_.laws = LawSteps(*model_.system, 0.0, transient.duration).facts_for(*transient.step);
      if (report_.laws.reach > 1.0)
        report_.notes.push_back(fmt::format(
            "{} changes near t = {:.6g} s faster than steps of {:g} s resolve: what it does there "
            "can be missed; take steps of {:.2g} s at most, or a tolerance, whose steps do not "
            "pass over it",
            report_.laws.which, report_.laws.at, *transient.step, report_.laws.longest_step));
    } else {
      report_.laws = of_steps.facts();
      if (report_.laws.longest_step > 0.0) report_.laws.reach = 1.0;
    }
    for (const std::string& law : report_.laws.unresolved)
      report_.notes.push_back(law + ": the motion after that is not to be relied on");
  }

  // Says it if steps are so short that round-off of positions drowns constraint forces.
  void judge_round_off(Stepper& stepper) {
    report_.round_off = stepper.round_off();
    if (!report_.round_off) return;
    const RoundOff& floor = *report_.round_off;
    const double length = model_.system->length_scale();
    const double force = std::max(floor.force, floor.moment / length),
                 scale = std::max(force_most_, report_.kinetic_most / length);
    if (scale > 0.0 && force > much_noise * scale)
      report_.notes.push_back(fmt::format(
          "steps as short as the last are lost in the round-off of positions: velocities are known "
          "to about "
          "{:.1g} m/s, constraint forces to about {:.1g} N (of {:.1g} N) and moments to about "
          "{:.1g} N.m; take "
          "larger steps{}",
          floor.velocity, floor.force, force_most_, floor.moment,
          report_.transient->method == TimeMethod::radau ? "" : ", or method=\"radau\""));
  }

  // Rows, or frames of motion, at times of their own that lie inside a step. What lies at the end of the step is left to
  // the state there, after a restart if there is one; what lies at the end of a piece, to the beginning of the next.
  template <class Times, class Write>
  void write_inside(const DenseStep& step, Times& times, State& inside, bool& going,
                    const Write& write) {
    const double before = step.end() - rows_->slack();
    if (!going || !(times.next() < before)) return;
    watch_.lap(report_.integration);
    for (; going && times.next() < before; times.advance()) {
      step.at(std::clamp(times.next(), step.begin(), step.end()), inside);
      going = write();
    }
    watch_.lap(report_.output);
  }

  // False ends the run.
  bool write_frame(const State& state) {
    if (!frames_ || !keeps_motion_) return true;
    if (shares_reactions_) share(state);
    try {
      keep_frame(shares_reactions_ ? shared_ : state);
    } catch (const Error& error) {
      fail(error);
      return false;
    }
    return true;
  }

  void keep_frame(const State& state) {
    frame_.resize(motion_blocks(model_).size());
    motion_row(model_, state, frame_);
    if (motion_) motion_->write(frame_);
    for (MotionObserver* const observer : motion_observers_) observer->frame(frame_);
  }

  // Reactions that constraints share between them: those of least norm.
  void share(const State& state) {
    shared_ = state;
    shared_.lambda = minimum_norm(*model_.system, state);
  }

  // Shows a state to the observers. False ends the run.
  bool accept(const State& state, bool monitored) {
    return write_row(state) && (!monitored || monitor_finite(state));
  }

  bool write_row(const State& state) {
    if (shares_reactions_) share(state);
    if (const Index bad = sample_row(model_, shares_reactions_ ? shared_ : state, row_); bad >= 0) {
      const std::string name = columns_[static_cast<std::size_t>(bad)].name;
      std::string failure =
          fmt::format("column {} of the results is not finite at {}", name, place_of(state));
      if (const std::string unusable = model_.system->unusable_signal(state); !unusable.empty())
        failure += ": " + unusable;
      if (report_.rows == 0) fail_to_start(failure);
      report_.failure = failure;
      report_.kind = Failure::range;
      return false;
    }
    if (report_.rows == 0) begin();
    try {
      for (Observer* const observer : observers_) observer->accepted({model_, state, row_});
      if (keeps_motion_ && !frames_) keep_frame(shares_reactions_ ? shared_ : state);
    } catch (const Error& error) {
      fail(error);
      return false;
    }
    ++report_.rows;
    return true;
  }

  bool monitor_finite(const State& state) {
    monitor(state);
    if (std::isfinite(report_.energy_end.total() + report_.work.total())) return true;
    report_.failure = fmt::format("the energy is not finite at {}; look at the loads and drives",
                                  place_of(state));
    report_.kind = Failure::range;
    return false;
  }

  std::string place_of(const State& state) const {
    return scene_.transient ? fmt::format("t = {:.9g} s", state.t)
                            : fmt::format("load factor {:.9g}", state.load_factor);
  }

  // Whether the user has had enough; that is a failure of the run. Before the first row nothing is left of it.
  bool interrupted(const State& state) {
    if (options_.interrupted == nullptr || !*options_.interrupted) return false;
    if (report_.rows == 0)
      throw Error(fmt::format("interrupted at load factor {:.9g}, before the start of the motion",
                              state.load_factor));
    report_.failure = "interrupted at " + place_of(state);
    report_.kind = Failure::stopped;
    return true;
  }

  void monitor(const State& state) {
    monitor_constraints(*model_.system, state, report_);
    monitor_energies(*model_.system, state, report_);
    force_most_ = std::max(force_most_, largest_force(*model_.system, state.lambda));
    if (audit_) audit_->sample(state);
    if (time_error_ && scene_.transient) time_error_->sample(state);
  }

  // Of generalized_alpha: which balance was chosen, and what it loses.
  void say_balance() {
    TransientScene& transient = *report_.transient;
    if (transient.method != TimeMethod::generalized_alpha) return;
    const bool chosen = !transient.balance.has_value();
    const bool keeps = keeps_momenta(*model_.system, transient);
    transient.balance = balance_of(*model_.system, transient);
    const ConnectedParts parts = find_parts(*model_.system);
    if (!chosen || keeps || transient.balance == Balance::momentum || !parts.any_free()) return;
    const auto part = static_cast<std::size_t>(
        std::find(parts.is_held.begin(), parts.is_held.end(), 0) - parts.is_held.begin());
    report_.notes.push_back(fmt::format(
        "nothing ties the part with {} to the ground, and its momenta drift by an error of the "
        "balance of accelerations, which {}; {}",
        model_.system->node_name(static_cast<Index>(parts.first[part])),
        transient.inertia != InertiaTerms::full ? "inertia without gyroscopic moments asks for"
                                                : "is the default as it has added mass and other "
                                                  "parts are held: it damps less what turns",
        transient.inertia != InertiaTerms::full ? "its certificate measures it"
                                                : "balance=\"momentum\" keeps them to round-off"));
  }

  void estimate_time_error() {
    if (!time_error_ || !report_.complete()) return;
    report_.time_error = time_error_->measure(report_.transient_counters, options_.interrupted);
    report_.estimate = watch_.lap();
  }

  // Says it if the integrator has made much of the energy, or lost much.
  void check_energy() {
    if (!report_.transient || report_.sampled_states < 2) return;
    const double size = report_.energy_moved();
    if (std::abs(report_.dissipated()) > much_energy * size)
      report_.notes.push_back(fmt::format(
          "the integrator {} {:.3g} J, {:.0f} % of the energy that moved; if it is not meant to "
          "damp that much, take {}",
          report_.dissipated() > 0.0 ? "took out" : "put in", std::abs(report_.dissipated()),
          100.0 * std::abs(report_.dissipated()) / size,
          report_.transient->tolerance ? "a smaller tolerance" : "smaller steps"));
  }

  void finish() {
    if (!report_.complete() && report_.kind == Failure::none) report_.kind = Failure::convergence;
    check_energy();
    estimate_time_error();
    if (audit_) report_.certificate = audit_->certificate(report_);
    report_.expects = expectations_->results();
    for (Observer* const observer : observers_) {
      try {
        observer->finished(report_);
      } catch (const Error& error) {
        if (report_.complete()) fail(error);
      }
    }
    report_.output += watch_.lap();
    if (!options_.output) return;
    const auto attempt = [this](const auto& what) {
      try {
        what();
      } catch (const Error& error) {
        if (report_.complete()) fail(error);
      }
    };
    attempt([this] {
      if (motion_) motion_->close();
    });
    attempt([this] { write_file(*options_.output / "report.json", to_json(report_)); });
    std::error_code code;
    if (report_.complete()) std::filesystem::remove(*options_.output / checkpoint_file, code);
    std::erase_if(report_.results, [](const auto& file) { return !std::filesystem::exists(file); });
  }

  const Scene& scene_;
  const RunOptions& options_;
  std::optional<DirectoryLock> lock_;
  std::optional<State> kept_;  // the last that statics accepted
  std::optional<CheckpointEvery> every_;
  std::string words_;                  // of the model, for checkpoints
  std::optional<RunCheckpoint> from_;  // of a run that goes on
  long kept_parts_ = -1;               // instants of checkpoints so far
  std::chrono::steady_clock::time_point checkpoint_at_ = std::chrono::steady_clock::now();
  Stopwatch watch_;
  RunReport report_;
  std::optional<RowTimes> rows_;  // of a transient
  bool in_statics_ = false;
  double force_most_ =
      0.0;  // largest multiplier of the monitored states, moments over the scene's length [N]
  Model model_;
  std::optional<Audit> audit_;
  std::optional<TimeErrorMeter> time_error_;
  std::vector<Column> columns_;
  std::vector<double> row_;
  bool shares_reactions_ = false;  // constraints repeat each other, and reactions are recorded
  State shared_;
  std::vector<std::size_t> marks_;  // column of each mark of a path
  std::unique_ptr<Expectations> expectations_;
  std::unique_ptr<HistoryWriter> history_;
  std::unique_ptr<HistoryPlot> plot_;
  std::unique_ptr<ShapesPlot> shapes_;
  std::unique_ptr<MotionWriter> motion_;
  std::vector<MotionObserver*> motion_observers_;
  std::vector<double> frame_;  // a motion_row()
  bool keeps_motion_ = false;
  std::optional<FrameTimes> frames_;  // of motion, at times of their own
  std::vector<Observer*> observers_;
};

}  // namespace

RunReport run(const Scene& scene, const RunOptions& options) {
  const stop::Scope scope(options.interrupted);
  std::optional<Run> whole;
  try {
    whole.emplace(scene, options);
  } catch (const Stopped&) {
    throw Error("interrupted while the model was compiled; nothing has been written");
  }
  return whole->go();
}

}  // namespace mbd
