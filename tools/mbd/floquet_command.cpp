#include "tools/mbd/floquet_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/study/effects/ablation.hpp"
#include "libmbd/study/modes/floquet_map.hpp"
#include "libmbd/text/files.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/interrupt.hpp"
#include "tools/mbd/overrides.hpp"
#include "tools/mbd/rotation_options.hpp"

namespace mbd {
namespace {

struct FloquetArguments {
  std::string model, output, period, rate;
  std::vector<std::string> set, without, vary;
  int settle = 2, harmonics = 0, count = 10;
  bool from_rotation = false, motion = false, quiet = false;
  RotationArguments rotation;
};

void check(const FloquetArguments& arguments) {
  if (arguments.period.empty() == arguments.rate.empty())
    throw Error("give --period or --rate, one of them");
  if (arguments.settle < 0 || arguments.settle > 1000000)
    throw Error(fmt::format("--settle {}: give 0 to 1000000", arguments.settle));
  if (arguments.harmonics < 0 || arguments.harmonics > 1000)
    throw Error(
        fmt::format("--harmonics {}: give 0 (as many as it takes) to 1000", arguments.harmonics));
  if (arguments.count < 1 || arguments.count > 10000)
    throw Error(fmt::format("--count {}: give 1 to 10000", arguments.count));
  if (arguments.motion && !arguments.vary.empty())
    throw Error("--motion is of one motion; leave out --vary, or give --set");
}

double period_of(const FloquetArguments& arguments, const Scene& scene) {
  const double period =
      arguments.rate.empty()
          ? option_value("period", arguments.period, "s", scene)
          : 2.0 * std::numbers::pi / option_value("rate", arguments.rate, "rad/s", scene);
  if (!(period > 0.0))
    throw Error(arguments.rate.empty()
                    ? "--period " + arguments.period + ": give a time that is positive"
                    : "--rate " + arguments.rate + ": give a rate that is positive");
  return period;
}

int map_periods(const FloquetArguments& arguments, const FloquetOptions& options,
                const ReadSweptModel& read, const std::filesystem::path& output) {
  FloquetMapOptions all;
  all.floquet = options;
  all.period = [&](const Scene& scene) { return period_of(arguments, scene); };
  const bool shown = !arguments.quiet && isatty(STDERR_FILENO);
  if (shown)
    all.progress = [](std::size_t done, std::size_t points) {
      show_progress(fmt::format("{} of {} points", done, points));
    };
  FloquetMap map;
  {
    const InterruptHandler handler;
    map = map_floquet(read, grid_plan(arguments.vary), all);
  }
  if (shown) show_progress({});
  make_directory(output);
  write_file(output / "floquet.csv", to_csv(map));
  const std::optional<std::string> picture = floquet_svg(map);
  if (picture) write_file(output / "floquet.svg", *picture);
  if (!arguments.quiet)
    fmt::print("{}\nwritten to {}: floquet.csv{}\n", to_text(map), output.string(),
               picture ? ", floquet.svg" : "");
  return InterruptHandler::flag() ? interrupted_status : 0;
}

int judge_period(const FloquetArguments& arguments) {
  check(arguments);
  const Overrides set = to_overrides(arguments.set);
  const ReadSweptModel read = [&](const Overrides& values) {
    const Scene scene = read_model(arguments.model, with(set, values));
    return arguments.without.empty() ? scene : without(scene, arguments.without);
  };
  FloquetOptions options;
  options.settle = arguments.settle;
  if (arguments.from_rotation) {
    options.rotation = rotation_of(arguments.rotation);
    options.at_rest = arguments.rotation.at_rest;
  }
  options.harmonics = arguments.harmonics;
  options.count = arguments.count;
  options.interrupted = &InterruptHandler::flag();
  const std::filesystem::path output =
      results_directory(arguments.output, arguments.model, "floquet");
  if (!arguments.vary.empty()) return map_periods(arguments, options, read, output);
  const Scene scene = read({});
  options.period = period_of(arguments, scene);
  FloquetStudy study;
  {
    const InterruptHandler handler;
    if (arguments.motion) make_directory(output);
    study = study_floquet(scene, options,
                          arguments.motion ? output / "motion.bin" : std::filesystem::path());
  }
  make_directory(output);
  write_file(output / "floquet.csv", to_csv(study));
  if (!arguments.quiet)
    fmt::print("{}\nwritten to {}: floquet.csv{}\n", to_text(study), output.string(),
               arguments.motion ? fmt::format(", motion.bin: mbd view {}", output.string()) : "");
  return 0;
}

}  // namespace

void add_floquet_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<FloquetArguments>();
  CLI::App* const command = app.add_subcommand(
      "floquet", "A motion that repeats, and whether it is stable: Floquet's multipliers.");
  command->add_option("MODEL", arguments->model, "model file (XML)")->required();
  command
      ->add_option("-T,--period", arguments->period,
                   "of loads, drives and motion, in s or with a unit (\"20 ms\")")
      ->type_name("T");
  command
      ->add_option(
          "-r,--rate", arguments->rate,
          "the same as a rate, 2 pi over the period, in rad/s or with a unit (\"300 rpm\")")
      ->type_name("RATE");
  command
      ->add_option("--settle", arguments->settle,
                   "periods that are integrated before a periodic motion is looked for; default: 2")
      ->type_name("N");
  command->add_flag("--from-rotation", arguments->from_rotation,
                    "look for it from the steady rotation that the model has without gravity, not "
                    "from a run; after the periods of --settle the drive must have run up");
  add_rotation_options(*command, arguments->rotation);
  command
      ->add_option("--harmonics", arguments->harmonics,
                   "of the period; default: as many as the motion needs, 8 to 64")
      ->type_name("N");
  command->add_option("-n,--count", arguments->count, "exponents shown; default: 10")
      ->type_name("N");
  command
      ->add_option("--vary", arguments->vary,
                   "values of parameters, FROM:TO:STEP or a list: a map of stability and "
                   "frequencies over them, drawn for one and two; rate and period may depend on "
                   "them")
      ->type_name("NAME=VALUES");
  add_set_option(*command, arguments->set);
  add_without_option(*command, arguments->without);
  command
      ->add_option("-o,--out", arguments->output,
                   "directory of the table; default: results/MODEL/floquet")
      ->type_name("DIR");
  command->add_flag("-m,--motion", arguments->motion, "write the periodic motion, for mbd view");
  command->add_flag("-q,--quiet", arguments->quiet, "print nothing but errors");
  set_examples(*command,
               "mbd floquet rotor.xml --rate \"1200 rpm\"\n"
               "mbd floquet pendulum.xml --period 0.35 --harmonics 24 --motion\n"
               "mbd floquet rotor.xml --rate W --vary \"W=100:1200:50 rpm\" \"gap=0,1,2 mm\"");
  command->callback([arguments, &status] { status = judge_period(*arguments); });
}

}  // namespace mbd
