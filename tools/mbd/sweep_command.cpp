#include "tools/mbd/sweep_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/study/sweep/sweep.hpp"
#include "libmbd/text/files.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/fingerprint.hpp"
#include "tools/mbd/interrupt.hpp"
#include "tools/mbd/overrides.hpp"

namespace mbd {
namespace {

struct SweepArguments {
  std::string model, output, points;
  std::vector<std::string> vary, quantities, set;
  std::size_t latin = 0;
  std::uint64_t seed = 1;
  int jobs = 0;  // 0: as many as there are processors
  bool quiet = false;
};

SweepPlan plan_of(const SweepArguments& arguments) {
  if (!arguments.points.empty()) {
    if (!arguments.vary.empty() || arguments.latin > 0)
      throw Error("--points " + arguments.points +
                  ": the file has all points; leave out --vary and --latin");
    return file_plan(arguments.points);
  }
  if (arguments.latin > 0) return latin_plan(arguments.vary, arguments.latin, arguments.seed);
  return grid_plan(arguments.vary);
}

int sweep_model(const SweepArguments& arguments) {
  const SweepPlan plan = plan_of(arguments);
  const Overrides set = to_overrides(arguments.set);
  std::vector<std::string> files{arguments.model};
  const ReadSweptModel read = [&](const Overrides& values) {
    Overrides all = set;
    all.insert(all.end(), values.begin(), values.end());
    return read_model(arguments.model, all);
  };
  try {
    const Scene scene = read({});
    files.insert(files.end(), scene.includes.begin(), scene.includes.end());
  } catch (const Error&) {  // the sweep says it, if its points do not mend it
  }
  SweepOptions options;
  options.quantities = arguments.quantities;
  options.jobs = arguments.jobs > 0
                     ? arguments.jobs
                     : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const std::filesystem::path output =
      results_directory(arguments.output, arguments.model, "sweep");
  options.keep = output;
  options.fingerprint = fingerprint(files, arguments.set);
  options.command = "mbd sweep " + arguments.model + given("--vary", arguments.vary) +
                    given("--quantity", arguments.quantities) + given("--set", arguments.set);
  if (!arguments.points.empty()) options.command += " --points " + arguments.points;
  if (arguments.latin > 0)
    options.command += fmt::format(" --latin {} --seed {}", arguments.latin, arguments.seed);
  const bool shown = !arguments.quiet && isatty(STDERR_FILENO);
  if (shown)
    options.progress = [](std::size_t done, std::size_t all) {
      show_progress(fmt::format("{} of {} points", done, all));
    };
  options.interrupted = &InterruptHandler::flag();
  SweepStudy study;
  {
    const InterruptHandler handler;
    study = study_sweep(read, plan, options);
  }
  if (shown) show_progress({});
  write_file(output / "sweep.csv", to_csv(study));
  if (!arguments.quiet)
    fmt::print("{}\nwritten to {}: sweep.csv{}\n", to_text(study), output.string(),
               study.whole() ? "" : "; the same command goes on from here");
  return InterruptHandler::flag() ? interrupted_status : 0;
}

}  // namespace

void add_sweep_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<SweepArguments>();
  CLI::App* const command = app.add_subcommand(
      "sweep", "Runs a model over many values of its parameters, several at once: one table.");
  command->add_option("MODEL", arguments->model, "model file (XML)")->required();
  command
      ->add_option("-v,--vary", arguments->vary,
                   "a parameter and its values: rpm=10:60:1 (from, to, step), d=1,2,5, with a unit "
                   "at the end if there is one; of several, all combinations")
      ->type_name("NAME=VALUES …");
  command
      ->add_option("-l,--latin", arguments->latin,
                   "a Latin hypercube of N points in the ranges of --vary (rpm=10:60)")
      ->type_name("N");
  command->add_option("--seed", arguments->seed, "of the Latin hypercube; default: 1")
      ->type_name("NUMBER");
  command
      ->add_option("-p,--points", arguments->points,
                   "a CSV file with a line of names and a row for each point, in place of --vary")
      ->type_name("FILE.csv");
  command
      ->add_option(
          "-Q,--quantity", arguments->quantities,
          "what is kept: columns, quantities or records, at the end; with @minimum, "
          "@maximum, @largest (of absolute values), @mean or @rms over the rows of results; "
          "default: all that is recorded, at the end")
      ->type_name("NAME …");
  command
      ->add_option("-j,--jobs", arguments->jobs,
                   "runs at once, each a process; default: as many as there are processors")
      ->check(CLI::Range(1, 4096))
      ->type_name("N");
  command
      ->add_option("-o,--out", arguments->output,
                   "directory of the table; rows that an interrupted or killed sweep of the same "
                   "model has left there are not run again; default: results/MODEL/sweep")
      ->type_name("DIR");
  add_set_option(*command, arguments->set);
  command->add_flag("-q,--quiet", arguments->quiet, "print nothing but errors");
  set_examples(
      *command,
      "mbd sweep models/princeton.xml --vary angle=0:90:15 --quantity tip.displacement\n"
      "mbd sweep models/internal_damping.xml --vary ratio=0.5:1.5:0.1 -Q M.displacement@largest\n"
      "mbd sweep models/princeton.xml --vary angle=0:90 P=1:10 --latin 100 --jobs 4\n"
      "mbd sweep models/princeton.xml --points points.csv",
      "Exit status: 0 all went well; 1 an error (points that fail are rows, and none); 130\n"
      "interrupted, with what was done written; 100 and more: wrong use of the command.");
  command->callback([arguments, &status] { status = sweep_model(*arguments); });
}

}  // namespace mbd
