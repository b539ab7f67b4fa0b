#include "tools/mbd/torture_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/study/trust/torture.hpp"
#include "libmbd/text/files.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/interrupt.hpp"
#include "tools/mbd/overrides.hpp"

namespace mbd {
namespace {

constexpr int some_fail = 2;

struct TortureArguments {
  std::vector<std::string> models, set, trials;
  std::string output;
  double budget = 60.0;
  std::uint64_t seed = 1;
  bool quiet = false;
};

int torture_models(const TortureArguments& arguments) {
  if (!(arguments.budget >= 1.0) || !(arguments.budget <= 1e6))
    throw Error(fmt::format("--budget {:g}: give seconds, 1 to 1e6", arguments.budget));
  const Overrides overrides = to_overrides(arguments.set);
  const std::filesystem::path output = arguments.output.empty()
                                           ? std::filesystem::path("results") / "torture"
                                           : std::filesystem::path(arguments.output);
  make_directory(output);
  const bool shown = !arguments.quiet && isatty(STDERR_FILENO);
  TortureOptions options{
      .kinds = arguments.trials, .budget = arguments.budget, .seed = arguments.seed};
  if (shown) options.progress = show_progress;
  options.interrupted = &InterruptHandler::flag();
  const InterruptHandler handler;
  std::vector<Torture> all;
  int status = 0;
  for (const std::string& file : arguments.models) {
    try {
      all.push_back(torture(read_model(file, overrides), options));
    } catch (const Error& error) {
      std::fflush(stdout);
      complain(fmt::format("{}mbd: {}\n", shown ? "\r\033[K" : "", error.what()));
      status = 1;
      continue;
    }
    if (shown) show_progress({});
    const Torture& one = all.back();
    write_file(output / (std::filesystem::path(file).stem().string() + ".json"), to_json(one));
    write_file(output / "torture.csv", to_csv(all));
    if (!arguments.quiet) fmt::print("{}{}", all.size() > 1 ? "\n" : "", to_text(one));
    std::fflush(stdout);
    if (const TortureTrial* const culprit = one.culprit();
        culprit != nullptr && culprit->verdict == Verdict::fail) {
      if (arguments.quiet)
        complain(fmt::format("mbd: {}: {}, {}: {}\n", file, culprit->kind, culprit->name,
                             culprit->reason));
      if (status == 0) status = some_fail;
    }
    if (one.interrupted) return interrupted_status;
  }
  if (!arguments.quiet && !all.empty())
    fmt::print("\nwritten to {}: torture.csv, and a .json of each model\n", output.string());
  return status;
}

}  // namespace

void add_torture_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<TortureArguments>();
  CLI::App* const command = app.add_subcommand(
      "torture",
      "Trials of models: moved, in other units and orders, at other steps and tolerances.");
  command->add_option("MODEL", arguments->models, "model files (XML)")->required();
  std::string kinds;
  for (const std::string_view kind : trial_kinds)
    kinds += (kinds.empty() ? "" : ", ") + std::string(kind);
  command
      ->add_option("-t,--trials", arguments->trials,
                   "which: " + kinds + "; default: all that the model has")
      ->type_name("NAME …");
  command
      ->add_option("-b,--budget", arguments->budget,
                   "CPU seconds for each model, of which long ones run a part; default: 60")
      ->type_name("SECONDS");
  command->add_option("--seed", arguments->seed, "of random motions, units and orders; default: 1")
      ->type_name("N");
  command
      ->add_option(
          "-o,--out", arguments->output,
          "directory of torture.csv and of a .json for each model; default: results/torture")
      ->type_name("DIR");
  add_set_option(*command, arguments->set);
  command->add_flag("-q,--quiet", arguments->quiet, "print nothing but errors and failures");
  set_examples(*command,
               "mbd torture models/four_bar.xml\n"
               "mbd torture models/*.xml --budget 20 --out torture\n"
               "mbd torture models/shaft.xml --trials motion units\n"
               "mbd torture models/chain.xml --set N=20 --trials steps",
               "Exit status: 0 all went well; 1 an error; 2 a trial that fails; 130\n"
               "interrupted, with what was done written; 100 and more: wrong use of the command.");
  command->callback([arguments, &status] { status = torture_models(*arguments); });
}

}  // namespace mbd
