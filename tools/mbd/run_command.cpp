#include "tools/mbd/run_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/results/expect.hpp"
#include "libmbd/results/history.hpp"
#include "libmbd/results/summary.hpp"
#include "libmbd/run/run.hpp"
#include "libmbd/study/accuracy/choose.hpp"
#include "libmbd/study/effects/ablation.hpp"
#include "libmbd/study/modes/modes.hpp"
#include "libmbd/study/modes/modes_report.hpp"
#include "libmbd/study/trust/certify.hpp"
#include "libmbd/text/files.hpp"
#include "libmbd/view/run_file.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/interrupt.hpp"
#include "tools/mbd/overrides.hpp"
#include "tools/mbd/rotation_options.hpp"
#include "tools/mbd/view_command.hpp"

namespace mbd {
namespace {

struct RunArguments {
  std::string model;
  std::string output;
  std::vector<std::string> set, plugins;
  std::vector<std::string> without;   // effects
  std::string accuracy;               // empty: the model's own settings
  std::vector<std::string> accurate;  // quantities; none: all that are recorded
  double choose_within = 600.0;
  TransientOptions transient;
  bool certify = false;
  bool no_estimate = false;
  std::string checkpoint_every;
  bool restart = false;
  double certify_within = 60.0;
  bool quiet = false;
  bool motion = false;
  bool hdf5 = false;
  std::string frames;
  bool view = false;
};

std::string clock_time(double seconds) {
  const long s = std::lround(seconds);
  return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60)
                  : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

// One line on a terminal, rewritten a few times a second and wiped at the end.
class ProgressLine {
 public:
  void show(const Progress& p) {
    using namespace std::chrono;
    const auto now = steady_clock::now();
    if (now - shown_ < milliseconds(200)) return;
    shown_ = now;
    const double elapsed = duration<double>(now - begun_).count();
    const std::string of = p.steps > 0 ? fmt::format(" of {}", p.steps) : "";
    const double left = elapsed * (p.duration - p.t) / p.t;
    complain(fmt::format("\r\033[Kt = {:.6g} of {:.6g} s, step {}{}, {} iteration{}, {} left", p.t,
                         p.duration, p.step, of, p.iterations, p.iterations == 1 ? "" : "s",
                         clock_time(left)));
    dirty_ = true;
  }
  ~ProgressLine() {
    if (dirty_) show_progress({});
  }

 private:
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now(), shown_ = begun_;
  bool dirty_ = false;
};

std::optional<double> finite_number(const std::string& text) {
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

// Not a number, and one out of range, get the same answer.
double requested_accuracy(const std::string& text) {
  const std::optional<double> value = finite_number(text);
  if (!value || *value < finest_accuracy || *value > coarsest_accuracy)
    throw Error(
        fmt::format("--accuracy {}: write a number between {:g} and {:g}, the rms error of what is "
                    "recorded over "
                    "its largest value",
                    text, finest_accuracy, coarsest_accuracy));
  return *value;
}

void refuse_both(const TransientOptions& given) {
  for (const auto& [name, value] :
       {std::pair<const char*, const std::string&>{"method", given.method},
        {"stages", given.stages},
        {"step", given.step},
        {"tolerance", given.tolerance}})
    if (!value.empty())
      throw Error(
          fmt::format("--accuracy and --{}: the accuracy chooses method, steps and tolerance; "
                      "leave out one of both",
                      name));
}

// Gives the scene the settings that keep the accuracy, by pilot runs.
void choose_settings(const RunArguments& arguments, Scene& scene, RunOptions& options) {
  const bool terminal = !arguments.quiet && isatty(STDERR_FILENO);
  int count = 0;
  const Choice choice =
      choose(scene, {.accuracy = requested_accuracy(arguments.accuracy),
                     .quantities = arguments.accurate,
                     .limit = arguments.choose_within,
                     .progress = [&](const std::string& what) {
                       if (terminal) show_progress(fmt::format("pilot {}: {}", ++count, what));
                     }});
  if (terminal) show_progress({});
  options.accuracy = summary_of(choice);
  options.notes.insert(options.notes.end(), choice.notes.begin(), choice.notes.end());
  if (!arguments.quiet) {
    fmt::print("accuracy {:g}: {} pilot run{}, {:.3g} s of CPU time\n", choice.accuracy,
               choice.pilots.size(), choice.pilots.size() == 1 ? "" : "s", choice.cpu);
    for (const Pilot& pilot : choice.pilots)
      fmt::print("{} {:8.3g} s  {:<22}  {}\n", pilot.text == options.accuracy->setting ? '>' : ' ',
                 pilot.cpu,
                 pilot.cut_off            ? "cut off: too dear"
                 : !pilot.failure.empty() ? "failed"
                 : pilot.error            ? fmt::format("believed error {:.1e}", *pilot.error)
                                          : "",
                 pilot.text);
    const std::string permanent = snippet(scene, choice.setting);
    if (permanent.empty())
      fmt::print("{}\n\n", choice.met ? "The model's own settings do."
                                      : "It runs with the model's own settings.");
    else
      fmt::print("To make it permanent, write into the model:\n{}\n", permanent);
    std::fflush(stdout);
  }
  scene = with(scene, choice.setting);
}

// Adds what other runs of the scene say, to the report that has been written too.
void certify_run(const RunArguments& arguments, const Scene& scene,
                 const std::filesystem::path& output, RunReport& report) {
  const bool terminal = !arguments.quiet && isatty(STDERR_FILENO);
  certify(scene,
          {.within = arguments.certify_within,
           .progress =
               [&](const std::string& what) {
                 if (terminal) show_progress("certificate: " + what);
               }},
          report);
  if (terminal) show_progress({});
  write_file(output / "report.json", to_json(report));
}

// What --motion, --frames, --hdf5 and --view ask for.
void keep_motion(const RunArguments& arguments, Scene& scene) {
  if (arguments.view) require_pages();
  if (arguments.hdf5) require_hdf5();
  if (!arguments.motion && !arguments.view && !arguments.hdf5 && arguments.frames.empty()) return;
  if (!scene.motion_output) scene.motion_output.emplace();
  if (arguments.frames.empty()) return;
  scene.motion_output->frames = frames_option(arguments.frames);
  if (!scene.transient)
    throw Error(
        fmt::format("--frames {}: frames are at equal times, and the model has no "
                    "<transient>; leave it out, every row of load steps is a frame",
                    arguments.frames));
}

// What can't be had at once.
void refuse_contradictions(const RunArguments& arguments) {
  if (arguments.accuracy.empty()) {
    if (!arguments.accurate.empty())
      throw Error("--for " + arguments.accurate.front() +
                  ": says whose error --accuracy bounds; give --accuracy too");
    return;
  }
  refuse_both(arguments.transient);
  if (arguments.restart || !arguments.checkpoint_every.empty())
    throw Error(
        "--accuracy and checkpoints: pilot runs choose settings anew at each start; write those "
        "that --accuracy prints into the model");
}

// The scene becomes what is run.
RunOptions prepare(const RunArguments& arguments, Scene& scene) {
  RunOptions options;
  options.notes = apply(arguments.transient, scene);
  keep_motion(arguments, scene);
  if (!arguments.accuracy.empty()) choose_settings(arguments, scene, options);
  options.output = results_directory(arguments.output, arguments.model);
  options.certify = arguments.certify;
  options.estimate_error = !arguments.no_estimate;
  options.restart = arguments.restart;
  if (!arguments.checkpoint_every.empty())
    options.checkpoint_every = checkpoint_every(arguments.checkpoint_every);
  options.id = new_run_id();
  return options;
}

RunReport run_seen(const RunArguments& arguments, const Scene& scene, RunOptions options) {
  ProgressLine line;
  if (!arguments.quiet && isatty(STDERR_FILENO))
    options.progress = [&line](const Progress& progress) { line.show(progress); };
  const InterruptHandler handler;
  options.interrupted = &InterruptHandler::flag();
  return run(scene, options);
}

// What scripts must not miss, also of a quiet run. Returns the exit status.
int judge(const RunReport& report, const std::string& name, bool quiet) {
  if (!report.complete()) {
    complain(fmt::format("mbd: {}: {}\n", name, report.failure));
    return 1;
  }
  for (const ExpectResult& result : report.expects)
    if (!result.pass() && quiet)
      complain(fmt::format("mbd: {}:{}: expected {} = {} +- {}, got {}\n", result.source.file,
                           result.source.line, result.what, result.expected, result.tolerance,
                           result.got ? fmt::format("{}", *result.got) : "nothing"));
  const bool fails = report.certificate.verdict() == Verdict::fail;
  if (fails) {
    const Check& culprit = *report.certificate.culprit();
    complain(fmt::format(
        "mbd: {}: the certificate fails: {} {}{}{}{}\n", name, culprit.name,
        culprit.value_in_words(),
        culprit.has_value() ? fmt::format(" (at most {:.2g})", culprit.fail) : std::string(),
        culprit.where.empty() ? "" : ", ", culprit.where));
  }
  const bool inaccurate = report.accuracy && !report.accuracy->met;
  if (inaccurate)
    complain(fmt::format("mbd: {}: the accuracy {:g} is not met (believed: {}): {}\n", name,
                         report.accuracy->requested,
                         report.accuracy->believed
                             ? fmt::format("{:.1e}", *report.accuracy->believed)
                             : std::string("not known"),
                         report.accuracy->reason));
  if (fails) return 1;
  return report.as_expected() && !inaccurate ? 0 : 2;
}

// What <modes> of the scene asks for, beside the results of its run. Returns what there is to print, or throws Error.
std::string write_modes_of(const Scene& scene, const std::filesystem::path& output,
                           RunReport& report) {
  const ModesStudy study = study_modes(scene, modes_options(ModesArguments{}, scene));
  for (const std::string& name : write_modes(study, output))
    report.results.push_back(output / name);
  return to_text(study);
}

int run_model(const RunArguments& arguments) {
  Scene scene = read_model(arguments.model, to_overrides(arguments.set), arguments.plugins);
  if (!arguments.without.empty()) scene = without(scene, arguments.without);
  if (scene.modes && scene.modes->at)
    require_state_at(scene, *scene.modes->at);  // not after an hour
  refuse_contradictions(arguments);
  RunOptions options = prepare(arguments, scene);
  std::optional<RunFile> run_file;
  if (arguments.hdf5)
    options.observers.push_back(&run_file.emplace(*options.output / "run.h5", scene, options.id));
  RunReport report = run_seen(arguments, scene, options);
  if (arguments.certify && report.complete())
    certify_run(arguments, scene, *options.output, report);
  if (run_file) {
    try {
      run_file->close(to_json(report));
      report.results.push_back(*options.output / "run.h5");
    } catch (const Error& error) {
      if (report.complete()) report.failure = error.what();
    }
  }
  if (arguments.view) {
    const std::filesystem::path page = *options.output / "view.html";
    write_view(*options.output, page, {});
    report.results.push_back(page);
  }
  std::string modes, failure_of_modes;
  if (scene.modes && report.complete()) {
    try {
      modes = write_modes_of(scene, *options.output, report);
    } catch (const Error& error) {
      failure_of_modes = error.what();
    }
  }
  if (!arguments.quiet) fmt::print("{}{}{}", summary(report), modes.empty() ? "" : "\n", modes);
  const int status = judge(report, scene.name, arguments.quiet);
  if (failure_of_modes.empty()) return status;
  complain(fmt::format("mbd: {}: its run went well, its <modes> did not: {}\n", scene.name,
                       failure_of_modes));
  return 1;
}

std::string positive_seconds(const std::string& text) {
  return finite_number(text).value_or(0.0) > 0.0 ? std::string()
                                                 : text + " is not a positive number of seconds";
}

void add_accuracy_options(CLI::App& command, RunArguments& arguments) {
  command
      .add_option(
          "--accuracy", arguments.accuracy,
          "choose order, elements, method and tolerance, by pilot runs, so that the rms error "
          "of each recorded quantity is below E of its largest value; status 2 if none do")
      ->check(not_empty, "", "")
      ->type_name("E");
  command
      .add_option("--for", arguments.accurate,
                  "with --accuracy: of this quantity, record or column only, as `mbd plot` names "
                  "them; may be given more than once. What else is recorded may be less accurate")
      ->check(not_empty, "", "")
      ->type_name("QUANTITY");
  command
      .add_option("--choose-within", arguments.choose_within,
                  "with --accuracy: the CPU time that pilot runs may take; default: 600 s")
      ->check(positive_seconds, "", "")
      ->type_name("SECONDS");
}

void add_certificate_options(CLI::App& command, RunArguments& arguments) {
  command.add_flag(
      "--certify", arguments.certify,
      "all checks of the certificate: also momenta, condition, round-off, and other runs of the "
      "model, moved, listed in another order and at half the step");
  command
      .add_option("--certify-within", arguments.certify_within,
                  "with --certify: the CPU time of those runs; default: 60 s")
      ->check(positive_seconds, "", "")
      ->type_name("SECONDS");
  command.add_flag("--no-estimate", arguments.no_estimate,
                   "without the second run, in longer steps, that estimates the error of steps in "
                   "time, and costs 0.4 to 0.9 of the run as a rule, at most some three times it");
}

void add_checkpoint_options(CLI::App& command, RunArguments& arguments) {
  command
      .add_option("--checkpoint-every", arguments.checkpoint_every,
                  "write the whole of the run into checkpoint.bin that often, from which --restart "
                  "goes on: a time on the clock (10min, 30s) or rows of results (100rows). Not of "
                  "method ida, nor with --motion")
      ->check(not_empty, "", "")
      ->type_name("TIME");
  command.add_flag(
      "--restart", arguments.restart,
      "go on from checkpoint.bin in the directory of results: history.csv becomes that "
      "of a run with the same --checkpoint-every that was not killed, to the last bit");
}

void add_motion_options(CLI::App& command, RunArguments& arguments) {
  command.add_flag("--motion", arguments.motion,
                   "keep the motion of all nodes in motion.bin, for `mbd view`: a frame with each "
                   "row of history.csv, or what <motion_output> says");
  command
      .add_option("--frames", arguments.frames,
                  "--motion with N frames at equal times of a <transient>")
      ->check(not_empty, "", "")
      ->type_name("N");
  command.add_flag("--hdf5", arguments.hdf5,
                   "--motion, and the whole run in one HDF5 file, run.h5: history, motion, "
                   "parameters, model and report, readable while the run goes on");
  command.add_flag("--view", arguments.view,
                   "--motion, and the page view.html that shows it in a browser");
}

}  // namespace

void add_run_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<RunArguments>();
  CLI::App* const command = app.add_subcommand("run", "Simulates a model and writes its results.");
  command->add_option("MODEL", arguments->model, "model file (XML)")->required();
  command
      ->add_option(
          "-o,--out", arguments->output,
          "directory for history.csv, history.svg and report.json; default: results/ and the "
          "model file's name without .xml")
      ->check(
          [](const std::string& d) {
            return d.empty() ? std::string("is empty; name a directory") : std::string();
          },
          "", "")
      ->type_name("DIR");
  add_set_option(*command, arguments->set);
  add_plugin_option(*command, arguments->plugins);
  add_transient_options(*command, arguments->transient);
  add_accuracy_options(*command, *arguments);
  add_without_option(*command, arguments->without);
  add_certificate_options(*command, *arguments);
  add_checkpoint_options(*command, *arguments);
  add_motion_options(*command, *arguments);
  command->add_flag("-q,--quiet", arguments->quiet, "print nothing but errors");
  set_examples(*command,
               "mbd run models/four_bar.xml\n"
               "mbd run models/four_bar.xml --out four_bar_fine --set step=4.5e-3\n"
               "mbd run models/chain.xml --set N=100 --quiet\n"
               "mbd run models/shaft.xml --method radau --tolerance 1e-8\n"
               "mbd run models/shaft.xml --step \"0.5 ms\" --output 0.01\n"
               "mbd run models/pendulum.xml --method radau --tolerance 1e-10 --output steps\n"
               "mbd run models/shaft.xml --accuracy 1e-4\n"
               "mbd run models/four_bar.xml --accuracy 1e-3 --for C.displacement\n"
               "mbd run models/four_bar.xml --certify\n"
               "mbd run models/four_bar.xml --view --frames 500\n"
               "mbd run models/four_bar.xml --hdf5 --frames 401");
  command->callback([arguments, &status] { status = run_model(*arguments); });
}

}  // namespace mbd
