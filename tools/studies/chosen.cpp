// Runs that choose their own settings (mbd run --accuracy): for every model in models/, what was requested, what the
// run believed of its error, its true error, and what choosing and running cost.
//
// True error: disagreement() of the chosen run with a reference, in the norm in which it was chosen. The reference is
// Radau with a hundredth of the finest tolerance chosen for the model, on twice as many elements of two orders more
// than the finest mesh chosen; where that takes too long, with a tenth on as many elements. Its own error is its
// difference to a run with ten times its tolerance (or twice its step) and one order less; a true error below three times that is marked.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/core/error.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/study/accuracy/choose.hpp"
#include "tools/studies/study.hpp"

namespace mbd::studies {
namespace {

constexpr double reference_limit = 3.0;  // times that of choosing
constexpr double within = 10.0;          // factor, estimate to true error

struct ModelCase {
  std::string name;
  double duration = 0.0;  // [s]; 0: the model's
};

// In the order of their cost. The last motion rings after 10.9 s: its first 6 s, and all of it.
const std::vector<ModelCase> models = {{"bend45"},
                                       {"composite"},
                                       {"elastica"},
                                       {"four_bar_static"},
                                       {"portal_frame"},
                                       {"princeton"},
                                       {"roll_up"},
                                       {"swept_cantilever"},
                                       {"pendulum"},
                                       {"heavy_top"},
                                       {"dzhanibekov"},
                                       {"double_pendulum"},
                                       {"windows"},
                                       {"chain"},
                                       {"shaft"},
                                       {"free_beam"},
                                       {"cart_pole"},
                                       {"shallow_arch"},
                                       {"right_angle_frame"},
                                       {"lee_frame"},
                                       {"arch"},
                                       {"slider_crank"},
                                       {"double_pendulum_beams"},
                                       {"every_joint"},
                                       {"rigid_frame"},
                                       {"damped_oscillator"},
                                       {"torsion_pendulum"},
                                       {"bushing"},
                                       {"terminal_velocity"},
                                       {"shaken_oscillator"},
                                       {"damped_beam"},
                                       {"submerged_beam"},
                                       {"internal_damping"},
                                       {"four_bar", 6.0},
                                       {"four_bar"}};

struct Row {
  double accuracy = 0.0;
  Choice choice;
  std::string setting;  // in words
  Trial run;
  std::optional<double> error;  // true
  bool below_reference = false;
};

// The scene's setting with knobs finer than the finest of the choices that claim something, or of all if none does.
Setting reference_setting(const Scene& scene, const std::vector<Row>& rows, bool modest) {
  Setting finest;
  const bool claims =
      std::any_of(rows.begin(), rows.end(), [](const Row& row) { return row.choice.met; });
  for (const Row& row : rows) {
    if (claims && !row.choice.met) continue;
    const Setting own = setting_of(with(scene, row.choice.setting));
    if (!scene.beams.empty()) {
      finest.order = std::max(finest.order.value_or(0), own.order.value_or(3));
      finest.elements = std::max(finest.elements.value_or(0), *own.elements);
    }
    if (own.step && !own.tolerance)
      finest.step = std::min(finest.step.value_or(*own.step), *own.step);
    else if (scene.transient)
      finest.tolerance = std::min(finest.tolerance.value_or(1e-5), own.tolerance.value_or(1e-5));
  }
  if (finest.order) {
    *finest.order = std::min(8, *finest.order + 2);
    if (!modest) *finest.elements *= 2;
  }
  // Fixed steps, where even the coarsest tolerance took too long: an eighth of the smallest, or a quarter.
  if (finest.step && !finest.tolerance) *finest.step /= modest ? 4.0 : 8.0;
  if (finest.tolerance) {
    finest.step.reset();
    finest.method = TimeMethod::radau;
    finest.tolerance = std::max(
        1e-13, std::stod(fmt::format("{:.6g}", *finest.tolerance * (modest ? 0.1 : 0.01))));
  }
  return finest;
}

std::string number(const std::optional<double>& value) {
  return value ? fmt::format("{:.1e}", *value) : "not known";
}

Scene scene_of(const ModelCase& model) {
  Scene scene =
      read_model(std::filesystem::path(MBD_SOURCE_DIR) / "models" / (model.name + ".xml"));
  if (model.duration > 0.0) {
    scene.transient->duration = model.duration;
    scene.expects.clear();
    scene.plots.clear();
  }
  return scene;
}

// The model run at settings of its own choice, one for each requested accuracy.
std::vector<Row> run_choices(const Scene& scene, const std::string& name,
                             const ChosenOptions& options) {
  std::vector<Row> rows;
  for (const double accuracy : options.accuracies) {
    Row row;
    row.accuracy = accuracy;
    row.choice = choose(scene, {.accuracy = accuracy, .limit = options.limit});
    for (const Pilot& pilot : row.choice.pilots)
      std::printf("    %-60s %8.2f s  %s %s %s %s\n", pilot.text.c_str(), pilot.cpu,
                  number(pilot.error).c_str(),
                  pilot.in_time ? fmt::format("time {:.1e}", *pilot.in_time).c_str() : "",
                  pilot.in_space ? fmt::format("space {:.1e}", *pilot.in_space).c_str() : "",
                  pilot.failure.c_str());
    row.setting = to_text(scene, row.choice.setting);
    row.run = run_trial(with(scene, row.choice.setting), {.limit = 4.0 * options.limit});
    std::printf("%s %.0e: %s; believed %s (%s), choosing %.2f s, run %.2f s %s\n", name.c_str(),
                accuracy, row.setting.c_str(), number(row.choice.error).c_str(),
                row.choice.worst.c_str(), row.choice.cpu, row.run.cpu, row.choice.reason.c_str());
    std::fflush(stdout);
    rows.push_back(std::move(row));
  }
  return rows;
}

struct Reference {
  std::string setting = "none";
  double error = std::numeric_limits<double>::infinity();
};

// The rows' true errors against the first reference that can be had in the time there is.
Reference judge(const Scene& scene, const ChosenOptions& options, std::vector<Row>& rows) {
  Reference reference;
  for (const bool modest : {false, true}) {
    Setting finest = reference_setting(scene, rows, modest);
    const Trial truth =
        run_trial(with(scene, finest), {.limit = reference_limit * options.limit, .repeats = 1});
    if (!truth.complete) {
      std::printf("  reference %s: %s\n", to_text(scene, finest).c_str(), truth.failure.c_str());
      continue;
    }
    reference.setting = to_text(scene, finest);
    if (finest.tolerance) *finest.tolerance *= 10.0;
    if (finest.step) *finest.step *= 2.0;
    if (finest.order) --*finest.order;
    const Trial less =
        run_trial(with(scene, finest), {.limit = reference_limit * options.limit, .repeats = 1});
    if (less.complete)
      reference.error = disagreement(less.findings, truth.findings, options.accuracies.back()).rms;
    for (Row& row : rows) {
      if (!row.run.complete) continue;
      row.error = disagreement(row.run.findings, truth.findings, row.accuracy).rms;
      row.below_reference = *row.error < 3.0 * reference.error;
    }
    break;
  }
  std::printf("  reference: %s, its own error %.1e; true errors", reference.setting.c_str(),
              reference.error);
  for (const Row& row : rows) std::printf(" %s", number(row.error).c_str());
  std::printf("\n");
  std::fflush(stdout);
  return reference;
}

// What came of all cases, as a table for eyes and one for programs.
class Tally {
 public:
  explicit Tally(double limit) : limit_(limit) {}

  void add(const ModelCase& model, const std::string& name, const Row& row,
           const Reference& reference) {
    const Choice& choice = row.choice;
    if (const std::string verdict = judged(row); !verdict.empty())
      misses_ += fmt::format("- {}, {:.0e} ({}): {}\n", name, row.accuracy, choice.worst, verdict);
    csv_ << model.name << model.duration << row.accuracy << limit_ << long{choice.met};
    csv_ << (choice.error ? fmt::format("{:.4g}", *choice.error) : "")
         << (row.error ? fmt::format("{:.4g}", *row.error) : "") << long{row.below_reference}
         << reference.error << choice.worst << '"' + row.setting + '"'
         << static_cast<long>(choice.pilots.size()) << choice.cpu << row.run.cpu
         << '"' + reference.setting + '"' << '"' + choice.reason + '"';
    csv_.end_row();
    table_ += fmt::format("| {} | {:.0e}{} | {} | {}{} | {:.2g} | {:g} | {:.2g} | {} |\n", name,
                          row.accuracy, choice.met ? "" : ", not met", number(choice.error),
                          row.below_reference ? "≤ " : "", number(row.error), choice.cpu, limit_,
                          row.run.cpu, row.setting);
  }

  std::string verdict() const {
    return fmt::format(
        "\n{} cases: requested accuracy met (and true) in {}; claimed and not kept in {}; the "
        "estimate "
        "within a factor of {:g} of the true error in {} of {} that the reference can judge.\n",
        cases_, met_, dishonest_, within, honest_, judged_);
  }

  void write_to(const std::filesystem::path& directory) const {
    write(directory, "chosen.csv", csv_.text());
    write(
        directory, "chosen.md",
        "`mbd_study chosen`: rms of the worst recorded quantity over its largest value, requested, "
        "believed and true (against Radau with a hundredth of the finest tolerance chosen, on "
        "twice "
        "the elements of two orders more; where that took too long a tenth, and as many; ≤: not "
        "told "
        "from the error of that reference). CPU times.\n\n" +
            table_ + verdict() + (misses_.empty() ? "" : "\nMisses:\n\n" + misses_));
  }

 private:
  // Counts a case; in words, what is to be held against it.
  std::string judged(const Row& row) {
    const Choice& choice = row.choice;
    ++cases_;
    const bool kept = choice.met && row.error && *row.error <= row.accuracy;
    met_ += kept ? 1 : 0;
    std::string verdict;
    if (choice.met && !row.error) verdict = "claimed; no reference in the time there is";
    if (choice.met && row.error && !kept) {
      ++dishonest_;
      verdict = "claimed, and not kept";
    }

    // Below the reference's own error, and where all is round-off, nothing can be told from the ratio.
    if (choice.error && row.error && *row.error > 0.0) {
      const double ratio = *choice.error / *row.error;
      const bool judgeable = !(row.below_reference && ratio > 1.0) && *choice.error > 1e-11;
      judged_ += judgeable ? 1 : 0;
      const bool close = ratio < within && ratio > 1.0 / within;
      honest_ += judgeable && close ? 1 : 0;
      if (judgeable && !close)
        verdict += fmt::format("{}believed {:.2g} times the true error",
                               verdict.empty() ? "" : "; ", ratio);
    }
    if (!choice.met) verdict += (verdict.empty() ? "" : "; ") + choice.reason;
    return verdict;
  }

  double limit_;
  Csv csv_{
      "# rms of the worst recorded quantity over its largest value; CPU seconds; limit: of "
      "choosing\n"
      "model,duration,requested,limit,met,believed,true,true_below_reference,reference_error,"
      "quantity,"
      "setting,pilots,cpu_choosing,cpu_run,reference,reason"};
  std::string table_ =
      "| model | requested | believed | true | choosing [s] | of at most [s] | run [s] | "
      "setting |\n"
      "|---|---|---|---|---|---|---|---|\n";
  std::string misses_;
  int cases_ = 0, met_ = 0, honest_ = 0, judged_ = 0, dishonest_ = 0;
};

}  // namespace

void chosen(const std::filesystem::path& directory, const ChosenOptions& options) {
  Tally tally(options.limit);
  for (const ModelCase& model : models) {
    if (!options.models.empty() &&
        std::find(options.models.begin(), options.models.end(), model.name) == options.models.end())
      continue;
    const Scene scene = scene_of(model);
    const std::string name =
        model.duration > 0.0 ? fmt::format("{}, {:g} s", model.name, model.duration) : model.name;
    std::vector<Row> rows = run_choices(scene, name, options);
    const Reference reference = judge(scene, options, rows);
    for (const Row& row : rows) tally.add(model, name, row, reference);
    tally.write_to(directory);  // after each model: what there is survives an interruption
    if (&model == &models.back()) std::fputs(tally.verdict().c_str(), stdout);
  }
}

}  // namespace mbd::studies
