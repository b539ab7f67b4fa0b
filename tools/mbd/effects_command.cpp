#include "tools/mbd/effects_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/study/effects/effects.hpp"
#include "libmbd/study/effects/effects_report.hpp"
#include "libmbd/study/trial/instructions.hpp"
#include "libmbd/text/files.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/interrupt.hpp"
#include "tools/mbd/overrides.hpp"

namespace mbd {
namespace {

struct EffectsArguments {
  std::string model, output;
  std::vector<std::string> set, quantities;
  double tolerance = 1e-2, budget = 120.0;
  bool instructions = false, quiet = false;
};

std::string command_of(const EffectsArguments& arguments) {
  return "mbd effects " + arguments.model + given("--set", arguments.set) +
         given("--quantity", arguments.quantities) +
         fmt::format(" --tolerance {:g} --budget {:g}", arguments.tolerance, arguments.budget);
}

int study_model(const EffectsArguments& arguments) {
  if (!(arguments.budget >= 1.0) || !(arguments.budget <= 1e6))
    throw Error(fmt::format("--budget {:g}: give seconds, 1 to 1e6", arguments.budget));
  if (!(arguments.tolerance > 0.0) || !(arguments.tolerance <= 1.0))
    throw Error(fmt::format("--tolerance {:g}: give a relative change, above 0 and up to 1",
                            arguments.tolerance));
  const Scene scene = read_model(arguments.model, to_overrides(arguments.set));
  const std::filesystem::path output =
      results_directory(arguments.output, arguments.model, "effects");
  make_directory(output);
  const bool shown = !arguments.quiet && isatty(STDERR_FILENO);
  EffectsOptions options;
  options.quantities = arguments.quantities;
  options.tolerance = arguments.tolerance;
  options.budget = arguments.budget;
  options.command = command_of(arguments);
  if (shown)
    options.progress = [](const std::string& what, std::size_t done, std::size_t all) {
      const std::string count = all > 0 ? fmt::format("{} of {}: ", done + 1, all) : "";
      show_progress(count + what);
    };
  if (arguments.instructions)
    options.instructions = [&](const std::vector<std::string>& keys) {
      const std::filesystem::path scratch = output / "counted";
      std::vector<std::string> command = {std::filesystem::read_symlink("/proc/self/exe").string(),
                                          "run",
                                          arguments.model,
                                          "--quiet",
                                          "--out",
                                          scratch.string()};
      for (const std::string& one : arguments.set) command.insert(command.end(), {"--set", one});
      for (const std::string& key : keys) command.insert(command.end(), {"--without", key});
      const double count = count_instructions(command);
      std::filesystem::remove_all(scratch);
      return count;
    };
  options.interrupted = &InterruptHandler::flag();
  EffectsStudy study;
  {
    const InterruptHandler handler;
    study = study_effects(scene, options);
  }
  if (shown) show_progress({});
  write_file(output / "effects.csv", to_csv(study));
  write_file(output / "effects.json", to_json(study));
  write_file(output / "effects.svg", effects_svg(study));
  write_file(output / "effects.md", to_markdown(study));
  write_file(output / "effects.html", effects_page(study));
  if (!arguments.quiet) {
    fmt::print("{}", to_text(study));
    fmt::print(
        "\nwritten to {}: effects.html (open it in a browser), effects.svg, effects.csv, "
        "effects.json, effects.md\n",
        output.string());
  }
  return InterruptHandler::flag() ? interrupted_status : 0;
}

}  // namespace

void add_effects_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<EffectsArguments>();
  CLI::App* const command =
      app.add_subcommand("effects", "What each effect of a model costs and what it is worth.");
  command->add_option("MODEL", arguments->model, "model file (XML)")->required();
  command
      ->add_option("-Q,--quantity", arguments->quantities,
                   "what must not change: columns, quantities or records; default: all that the "
                   "model records")
      ->type_name("NAME …");
  command
      ->add_option("-t,--tolerance", arguments->tolerance,
                   "of the cheapest model: rms change of each quantity over its largest value; "
                   "default: 0.01")
      ->type_name("E");
  command
      ->add_option("-b,--budget", arguments->budget,
                   "CPU seconds for it all, of which the last check of the cheapest model may take "
                   "more; of a long transient the beginning is compared; default: 120")
      ->type_name("SECONDS");
  command
      ->add_option("-o,--out", arguments->output,
                   "directory of the page, picture and data; default: results/MODEL/effects")
      ->type_name("DIR");
  command->add_flag(
      "-i,--instructions", arguments->instructions,
      "count the instructions of each run, by valgrind: no noise, but 50 times slower");
  add_set_option(*command, arguments->set);
  command->add_flag("-q,--quiet", arguments->quiet, "print nothing but errors");
  set_examples(*command,
               "mbd effects models/shaft.xml\n"
               "mbd effects models/four_bar.xml --tolerance 1e-3 --budget 600\n"
               "mbd effects models/slider_crank.xml --quantity tip.displacement",
               "Exit status: 0 all went well; 1 an error; 130 interrupted, with what was done "
               "written; 100 and\n"
               "more: wrong use of the command. Effects without which a model fails are data, not "
               "errors.");
  command->callback([arguments, &status] { status = study_model(*arguments); });
}

}  // namespace mbd
