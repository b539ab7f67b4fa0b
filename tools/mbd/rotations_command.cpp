#include "tools/mbd/rotations_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/study/effects/ablation.hpp"
#include "libmbd/study/modes/rotations.hpp"
#include "libmbd/text/files.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/interrupt.hpp"
#include "tools/mbd/overrides.hpp"
#include "tools/mbd/rotation_options.hpp"

namespace mbd {
namespace {

struct RotationsArguments {
  std::string model, output, rates;
  RotationArguments rotation;
  std::vector<std::string> set, without, probes;
  int count = RotationsOptions{}.count, searches = RotationsOptions{}.searches,
      points = RotationsOptions{}.points;
  double largest_step = RotationsOptions{}.largest_step, far = RotationsOptions{}.far;
  bool quiet = false;
};

RotationsOptions options_of(const RotationsArguments& arguments, const Scene& scene) {
  RotationsOptions options;
  static_cast<RangeOfRates&>(options) = range_of(arguments.rotation, arguments.rates, scene);
  options.probes = arguments.probes;
  options.count = arguments.count;
  options.searches = arguments.searches;
  options.points = arguments.points;
  options.largest_step = arguments.largest_step;
  options.far = arguments.far;
  if (options.count < 1 || options.count > 1000)
    throw Error(fmt::format("--count {}: give 1 to 1000", options.count));
  if (options.searches < 0 || options.searches > 1000)
    throw Error(fmt::format("--search {}: give 0 to 1000", options.searches));
  if (options.points < 2 || options.points > 100000)
    throw Error(fmt::format("--points {}: give 2 to 100000", options.points));
  if (!(options.largest_step > 0.0) || !(options.largest_step <= 1.0))
    throw Error(fmt::format("--step {:g}: give more than 0, and at most 1", options.largest_step));
  if (!(options.far > 0.0) || !(options.far <= 100.0))
    throw Error(fmt::format("--far {:g}: give more than 0, and at most 100", options.far));
  return options;
}

int find_rotations(const RotationsArguments& arguments) {
  Scene scene = read_model(arguments.model, to_overrides(arguments.set));
  if (!arguments.without.empty()) scene = without(scene, arguments.without);
  RotationsOptions options = options_of(arguments, scene);
  const std::filesystem::path output =
      results_directory(arguments.output, arguments.model, "rotations");
  const bool shown = !arguments.quiet && isatty(STDERR_FILENO);
  if (shown)
    options.progress = [](std::size_t paths, double rate) {
      show_progress(fmt::format("path {}, {:.4g} rad/s", paths, rate));
    };
  options.interrupted = &InterruptHandler::flag();
  RotationsStudy study;
  {
    const InterruptHandler handler;
    study = study_rotations(scene, options);
  }
  if (shown) show_progress({});
  make_directory(output);
  write_file(output / "rotations.csv", to_csv(study));
  write_file(output / "rotations.svg", rotations_svg(study));
  if (!arguments.quiet)
    fmt::print("{}\nwritten to {}: rotations.svg, rotations.csv\n", to_text(study),
               output.string());
  return InterruptHandler::flag() ? interrupted_status : 0;
}

}  // namespace

void add_rotations_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<RotationsArguments>();
  CLI::App* const command = app.add_subcommand(
      "rotations", "Steady rotations over the rate, through folds, and others at the same rates.");
  command->add_option("MODEL", arguments->model, "model file (XML)")->required();
  command
      ->add_option("-r,--rates", arguments->rates,
                   "from which rate to which, in rad/s or with units (\"0:6000 rpm\")")
      ->type_name("FROM:TO")
      ->required();
  add_rotation_options(*command, arguments->rotation);
  command
      ->add_option("--search", arguments->searches,
                   "at how many rates others are sought than those that the first path leads to; "
                   "default: 9")
      ->type_name("N");
  command
      ->add_option(
          "--far", arguments->far,
          "how far from one they are sought: mean motion of the nodes, of the scene's size "
          "and in rad; default: 1")
      ->type_name("N");
  command
      ->add_option("-p,--points", arguments->points,
                   "how many points at most of a path, in each sense; default: 500")
      ->type_name("N");
  command
      ->add_option("--step", arguments->largest_step,
                   "largest step, part of the range of rates; default: 0.02")
      ->type_name("PART");
  command
      ->add_option("-n,--count", arguments->count,
                   "how many modes, the slowest, must not grow where it is stable; default: 8")
      ->type_name("N");
  command
      ->add_option("--probe", arguments->probes,
                   "place whose displacement is wanted; may be repeated")
      ->type_name("PLACE")
      ->allow_extra_args(false);
  add_set_option(*command, arguments->set);
  add_without_option(*command, arguments->without);
  command
      ->add_option("-o,--out", arguments->output,
                   "directory of picture and table; default: results/MODEL/rotations")
      ->type_name("DIR");
  command->add_flag("-q,--quiet", arguments->quiet, "print nothing but errors");
  set_examples(*command,
               "mbd rotations models/shaft.xml --rates 0:81 --without gravity --probe shaft@0.5\n"
               "mbd rotations models/shaft.xml --rates 40:70 --without gravity -s d=0.001",
               "Exit status: 0 all went well; 1 an error; 130 interrupted, with what was done "
               "written; 100 and\n"
               "more: wrong use of the command.");
  command->callback([arguments, &status] { status = find_rotations(*arguments); });
}

}  // namespace mbd
