#include "tools/mbd/modes_command.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/study/effects/ablation.hpp"
#include "libmbd/study/modes/modes.hpp"
#include "libmbd/study/modes/modes_report.hpp"
#include "libmbd/text/files.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/overrides.hpp"
#include "tools/mbd/rotation_options.hpp"

namespace mbd {
namespace {

struct ModesArguments {
  std::string model, output, near;
  AboutArguments about;
  std::vector<std::string> set, without;
  int count = 10;
  bool motion = false, quiet = false;
};

int find_modes_of(const ModesArguments& arguments) {
  if (arguments.count < 1 || arguments.count > 10000)
    throw Error(fmt::format("--count {}: give 1 to 10000", arguments.count));
  Scene scene = read_model(arguments.model, to_overrides(arguments.set));
  if (!arguments.without.empty()) scene = without(scene, arguments.without);
  ModesOptions options;
  options.count = arguments.count;
  if (!arguments.near.empty()) {
    constexpr double turn = 2.0 * std::numbers::pi;
    options.near = turn * option_value("near", arguments.near, "Hz", scene);
    if (!(options.near >= 0.0))
      throw Error("--near " + arguments.near + ": give a frequency that is not negative");
  }
  apply(arguments.about, scene, options);
  const std::filesystem::path output =
      results_directory(arguments.output, arguments.model, "modes");
  const ModesStudy study =
      study_modes(scene, options, arguments.motion ? output : std::filesystem::path());
  make_directory(output);
  write_file(output / "modes.csv", to_csv(study));
  write_file(output / "modes.json", to_json(study));
  if (!arguments.quiet)
    fmt::print("{}\nwritten to {}: modes.csv, modes.json (shapes){}\n", to_text(study),
               output.string(),
               arguments.motion
                   ? fmt::format(", mode_1 … (motion): mbd view {}", (output / "mode_1").string())
                   : "");
  return 0;
}

}  // namespace

void add_modes_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<ModesArguments>();
  CLI::App* const command = app.add_subcommand(
      "modes",
      "Frequencies, damping and shapes of small motions about equilibrium, a steady rotation, or a "
      "state of a run.");
  command->add_option("MODEL", arguments->model, "model file (XML)")->required();
  command->add_option("-n,--count", arguments->count, "how many; default: 10")->type_name("N");
  command
      ->add_option("--near", arguments->near,
                   "those nearest to this frequency, in Hz or with a unit; default: 0")
      ->type_name("F");
  add_about_options(*command, arguments->about);
  add_set_option(*command, arguments->set);
  add_without_option(*command, arguments->without);
  command
      ->add_option("-o,--out", arguments->output,
                   "directory of the tables; default: results/MODEL/modes")
      ->type_name("DIR");
  command->add_flag("-m,--motion", arguments->motion,
                    "write a period of each mode, for mbd view, into directories mode_1 …");
  command->add_flag("-q,--quiet", arguments->quiet, "print nothing but errors");
  set_examples(*command,
               "mbd modes models/swept_cantilever.xml\n"
               "mbd modes models/shaft.xml --rate 50 --axis 1 0 0 --without gravity\n"
               "mbd modes models/four_bar.xml --count 4 --near 100\n"
               "mbd modes models/four_bar.xml --count 4 --at 6.5");
  command->callback([arguments, &status] { status = find_modes_of(*arguments); });
}

}  // namespace mbd
