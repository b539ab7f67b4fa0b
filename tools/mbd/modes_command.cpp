#include "tools/mbd/modes_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/study/effects/ablation.hpp"
#include "libmbd/study/modes/modes.hpp"
#include "libmbd/study/modes/modes_report.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/overrides.hpp"
#include "tools/mbd/rotation_options.hpp"

namespace mbd {
namespace {

struct ModesCommand {
  std::string model, output, compared;
  ModesArguments modes;
  std::vector<std::string> set, without;
  bool motion = false, quiet = false;
};

int find_modes_of(const ModesCommand& arguments) {
  Scene scene = read_model(arguments.model, to_overrides(arguments.set));
  if (!arguments.without.empty()) scene = without(scene, arguments.without);
  ModesOptions options = modes_options(arguments.modes, scene);
  if (!arguments.compared.empty())
    options.compared = std::make_shared<const ShapesOfModes>(
        modes_to_compare(arguments.compared, arguments.modes));
  const std::filesystem::path output =
      results_directory(arguments.output, arguments.model, "modes");
  const ModesStudy study =
      study_modes(scene, options, arguments.motion ? output : std::filesystem::path());
  const std::vector<std::string> written = write_modes(study, output);
  if (!arguments.quiet)
    fmt::print("{}\nwritten to {}: {}{}\n", to_text(study), output.string(),
               fmt::join(written, ", "),
               arguments.motion
                   ? fmt::format(", mode_1 … (motion): mbd view {}", (output / "mode_1").string())
                   : "");
  return 0;
}

}  // namespace

void add_modes_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<ModesCommand>();
  CLI::App* const command = app.add_subcommand(
      "modes",
      "Frequencies, damping and shapes of small motions about equilibrium, a steady rotation, or a "
      "state of a run. What is not given here is as <modes> of the model says.");
  command->add_option("MODEL", arguments->model, "model file (XML)")->required();
  add_modes_options(*command, arguments->modes);
  command
      ->add_option("--compare", arguments->compared,
                   "how alike they are to other modes, in mac.csv and mac.json: of another model, "
                   "found as these options say, or of a modes.json (or the directory of one), at "
                   "the nodes that have the same names, weighted by the mass of MODEL")
      ->check(not_empty, "", "")
      ->type_name("OTHER");
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
               "mbd modes models/four_bar.xml --count 4 --at 6.5\n"
               "mbd modes models/shaft.xml --without gravity -s d=0 --compare models/shaft.xml");
  command->callback([arguments, &status] { status = find_modes_of(*arguments); });
}

}  // namespace mbd
