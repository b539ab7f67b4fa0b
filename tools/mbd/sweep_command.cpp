#include "tools/mbd/sweep_command.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/material/scene_files.hpp"
#include "libmbd/study/sweep/sweep.hpp"
#include "libmbd/text/files.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/fingerprint.hpp"
#include "tools/mbd/interrupt.hpp"
#include "tools/mbd/overrides.hpp"
#include "tools/mbd/shares.hpp"

namespace mbd {
namespace {

struct SweepArguments {
  std::string model, output, points;
  std::vector<std::string> vary, quantities, set;
  std::size_t latin = 0;
  std::uint64_t seed = 1;
  int jobs = 0;  // 0: as many as there are processors, of ranks and tasks one
  std::string share, on;
  std::size_t tasks = 0;  // 0: one for each point, most_tasks at most
  std::vector<std::string> sbatch;
  bool no_wait = false, quiet = false;
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

// More would wait for the scheduler rather than for results.
constexpr std::size_t most_tasks = 100;

// What each process of this sweep is told, but for its share.
std::vector<std::string> task_words(const SweepArguments& arguments,
                                    const std::filesystem::path& output, int jobs) {
  std::error_code code;
  std::vector<std::string> words = {std::filesystem::read_symlink("/proc/self/exe", code).string(),
                                    "sweep", arguments.model};
  const auto add = [&words](const char* option, const std::vector<std::string>& values) {
    for (const std::string& value : values) words.insert(words.end(), {option, value});
  };
  add("--vary", arguments.vary);
  add("--quantity", arguments.quantities);
  add("--set", arguments.set);
  if (!arguments.points.empty()) add("--points", {arguments.points});
  if (arguments.latin > 0) {
    add("--latin", {std::to_string(arguments.latin)});
    add("--seed", {std::to_string(arguments.seed)});
  }
  add("--out", {output.string()});
  add("--jobs", {std::to_string(jobs)});
  words.emplace_back("--quiet");
  return words;
}

// Lets Slurm run it: an array whose tasks are shares. How they ended, if some ended early.
std::optional<std::string> run_on_slurm(SweepTable& table, const SweepArguments& arguments,
                                        const std::filesystem::path& output,
                                        const SweepOptions& options) {
  SlurmJob job;
  job.tasks =
      std::min(arguments.tasks > 0 ? arguments.tasks : most_tasks, table.study().rows.size());
  std::set<std::size_t> numbers;
  for (const std::size_t point : table.open()) numbers.insert(point % job.tasks + 1);
  if (numbers.empty()) return std::nullopt;
  job.numbers.assign(numbers.begin(), numbers.end());
  job.jobs = std::max(arguments.jobs, 1);
  job.command = task_words(arguments, output, job.jobs);
  job.logs = output;
  job.options = arguments.sbatch;
  const std::string id = submit(job);
  if (!arguments.quiet) {
    fmt::print("job {} of Slurm: {} tasks{}\n", id, job.numbers.size(),
               arguments.no_wait ? "; the last of them writes the table" : "");
    std::fflush(stdout);
  }
  if (arguments.no_wait) return std::nullopt;
  std::string ends = wait_for(id, [&] {
    table.look_again();
    const std::size_t open = table.open().size(), all = table.study().rows.size();
    if (options.progress) options.progress(all - open, all);
    return open == 0 || InterruptHandler::flag();
  });
  if (InterruptHandler::flag()) cancel(id);
  if (table.study().whole() || InterruptHandler::flag()) return std::nullopt;
  return ends;
}

// In what mpirun or srun has started; a share that is stated is none.
std::optional<Rank> rank_here(const SweepArguments& arguments) {
  if (!arguments.share.empty()) return std::nullopt;
  return rank_of([](const char* name) { return std::getenv(name); });
}

// That this process may run on, as taskset, a container or Slurm has it: not all that there are.
int processors() {
  cpu_set_t set;
  if (::sched_getaffinity(0, sizeof set, &set) == 0) return std::max(1, CPU_COUNT(&set));
  return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

SweepOptions options_of(const SweepArguments& arguments, const std::optional<Rank>& rank) {
  SweepOptions options;
  options.quantities = arguments.quantities;
  options.jobs = arguments.jobs > 0 ? arguments.jobs : rank ? 1 : processors();
  if (rank) options.share = {rank->index + 1, rank->count};
  if (!arguments.share.empty()) options.share = share_of(arguments.share);
  options.command = "mbd sweep " + arguments.model + given("--vary", arguments.vary) +
                    given("--quantity", arguments.quantities) + given("--set", arguments.set);
  if (!arguments.points.empty()) options.command += " --points " + arguments.points;
  if (arguments.latin > 0)
    options.command += fmt::format(" --latin {} --seed {}", arguments.latin, arguments.seed);
  return options;
}

int sweep_model(const SweepArguments& arguments) {
  const bool on_slurm = arguments.on == "slurm";
  const std::optional<Rank> rank = rank_here(arguments);
  if (on_slurm && (rank || !arguments.share.empty()))
    throw Error("--on slurm: makes shares itself; leave out --share, mpirun and srun");
  if (!on_slurm && (arguments.tasks > 0 || arguments.no_wait || !arguments.sbatch.empty()))
    throw Error("--tasks, --sbatch and --no-wait are of --on slurm");
  const SweepPlan plan = plan_of(arguments);
  const Overrides set = to_overrides(arguments.set);
  std::vector<std::string> files{arguments.model};
  const ReadSweptModel read = [&](const Overrides& values) {
    return read_model(arguments.model, with(set, values));
  };
  try {
    files = files_of(read({}));
  } catch (const Error&) {  // the sweep says it, if its points do not mend it
  }
  const std::filesystem::path output =
      results_directory(arguments.output, arguments.model, "sweep");
  SweepOptions options = options_of(arguments, rank);
  options.keep = output;
  options.fingerprint = fingerprint(files, arguments.set);
  const bool shown = !arguments.quiet && !rank && isatty(STDERR_FILENO);
  if (shown)
    options.progress = [](std::size_t done, std::size_t all) {
      show_progress(fmt::format("{} of {} points", done, all));
    };
  options.interrupted = &InterruptHandler::flag();
  SweepTable table(read, plan, options);
  std::optional<std::string> ended_early;
  {
    const InterruptHandler handler;
    if (on_slurm)
      ended_early = run_on_slurm(table, arguments, output, options);
    else
      table.run(read, options);
  }
  if (shown) show_progress({});
  const SweepStudy& study = table.study();
  // Of shares, the last to end has all rows and writes them; if two end at once, both write the same.
  const bool written = study.share.of == 1 ? !arguments.no_wait || study.whole() : study.whole();
  if (written) write_file(output / "sweep.csv", to_csv(study));
  if (!arguments.quiet)
    fmt::print("{}\n{}\n", to_text(study),
               written ? fmt::format("written to {}: sweep.csv{}", output.string(),
                                     study.whole() ? "" : "; the same command goes on from here")
                       : fmt::format("rows are kept in {}; the last share to end writes the table",
                                     output.string()));
  if (InterruptHandler::flag()) return interrupted_status;
  if (ended_early)
    throw Error(fmt::format(
        "--on slurm: {} points have no row: their tasks ended early{}, "
        "{}/slurm-*.log may say why; the same command goes on from here",
        study.count(SweepRow::Status::open),
        ended_early->empty() ? "" : fmt::format(" ({})", *ended_early), output.string()));
  return 0;
}

// More than one machine.
void add_machine_options(CLI::App& command, SweepArguments& arguments) {
  command
      .add_option(
          "--share", arguments.share,
          "only points I, I+N, … of the sweep, as one of N processes with the same --out: the last "
          "to end "
          "writes the table; default: what mpirun or srun say, which start a share in each rank")
      ->type_name("I/N");
  command.add_option("--on", arguments.on, "where it runs; default: here")
      ->check(CLI::IsMember({"slurm"}))
      ->type_name("slurm");
  command
      .add_option("--tasks", arguments.tasks,
                  "of Slurm, each a share of the sweep; default: one for each point, 100 at most")
      ->check(CLI::Range(std::size_t{1}, most_points))
      ->type_name("N");
  command
      .add_option("--sbatch", arguments.sbatch,
                  "options for sbatch, as in --sbatch=--partition=long; those of all jobs are "
                  "better set in "
                  "SBATCH_PARTITION, SBATCH_TIMELIMIT …")
      ->type_name("OPTION …");
  command.add_flag("--no-wait", arguments.no_wait,
                   "submit to Slurm and end: the last task writes the table");
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
      ->add_option(
          "-j,--jobs", arguments->jobs,
          "runs at once, each a process; default: as many as there are processors, of a task of "
          "Slurm or a rank of MPI 1")
      ->check(CLI::Range(1, 4096))
      ->type_name("N");
  command
      ->add_option("-o,--out", arguments->output,
                   "directory of the table; rows that an interrupted or killed sweep of the same "
                   "model has left there are not run again; default: results/MODEL/sweep")
      ->type_name("DIR");
  add_machine_options(*command, *arguments);
  add_set_option(*command, arguments->set);
  command->add_flag("-q,--quiet", arguments->quiet, "print nothing but errors");
  set_examples(
      *command,
      "mbd sweep models/princeton.xml --vary angle=0:90:15 --quantity tip.displacement\n"
      "mbd sweep models/internal_damping.xml --vary ratio=0.5:1.5:0.1 -Q M.displacement@largest\n"
      "mbd sweep models/princeton.xml --vary angle=0:90 P=1:10 --latin 100 --jobs 4\n"
      "mbd sweep models/princeton.xml --points points.csv\n"
      "mbd sweep models/princeton.xml --vary angle=0:90:15 --on slurm --tasks 4\n"
      "mpirun -n 4 mbd sweep models/princeton.xml --vary angle=0:90:15",
      "Exit status: 0 all went well; 1 an error (points that fail are rows, and none); 130\n"
      "interrupted, with what was done written; 100 and more: wrong use of the command.");
  command->callback([arguments, &status] { status = sweep_model(*arguments); });
}

}  // namespace mbd
