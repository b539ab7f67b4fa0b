#include "tools/mbd/campbell_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/study/effects/ablation.hpp"
#include "libmbd/study/modes/campbell.hpp"
#include "libmbd/text/files.hpp"
#include "libmbd/view/run_file.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/interrupt.hpp"
#include "tools/mbd/overrides.hpp"
#include "tools/mbd/rotation_options.hpp"

namespace mbd {
namespace {

struct CampbellArguments {
  std::string model, output, rates;
  RotationArguments rotation;
  std::vector<std::string> set, without, unbalance, forces, probes;
  double order = 1.0;
  int points = 61, count = 8;
  bool hdf5 = false, quiet = false;
};

// Of PLACE=…; throws Error, saying what to give.
std::pair<std::string, std::string> place_and_value(const std::string& option,
                                                    const std::string& text, const char* give) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0)
    throw Error(fmt::format("--{} {}: give {}", option, text, give));
  return {text.substr(0, equals), text.substr(equals + 1)};
}

Unbalance unbalance_of(const std::string& text, const Scene& scene) {
  const auto [place, value] =
      place_and_value("unbalance", text, "a place and mass times distance, PLACE=VALUE");
  return {place, option_value("unbalance", value, "kg.m", scene)};
}

HarmonicForce force_of(const std::string& text, const Scene& scene) {
  const auto [place, values] =
      place_and_value("force", text, "a place and a force, PLACE=Y or PLACE=Y,Z");
  HarmonicForce force{place};
  const std::size_t comma = values.find(',');
  force.y = option_value("force", values.substr(0, comma), "N", scene);
  if (comma != std::string::npos)
    force.z = option_value("force", values.substr(comma + 1), "N", scene);
  return force;
}

CampbellOptions options_of(const CampbellArguments& arguments, const Scene& scene) {
  CampbellOptions options;
  static_cast<RangeOfRates&>(options) = range_of(arguments.rotation, arguments.rates, scene);
  options.points = arguments.points;
  options.count = arguments.count;
  for (const std::string& one : arguments.unbalance)
    options.unbalance.push_back(unbalance_of(one, scene));
  for (const std::string& one : arguments.forces) options.forces.push_back(force_of(one, scene));
  options.order = arguments.order;
  if (!(options.order > 0.0) || !std::isfinite(options.order))
    throw Error(fmt::format("--order {:g}: give a positive number", options.order));
  options.probes = arguments.probes;
  if (options.points < 2 || options.points > 100000)
    throw Error(fmt::format("--points {}: give 2 to 100000", options.points));
  if (options.count < 1 || options.count > 1000)
    throw Error(fmt::format("--count {}: give 1 to 1000", options.count));
  return options;
}

// Returns the names of the files, the picture first.
std::string write_files(const CampbellArguments& arguments, const Scene& scene,
                        const CampbellStudy& study, const std::filesystem::path& output) {
  make_directory(output);
  write_file(output / "campbell.csv", to_csv(study));
  write_file(output / "campbell.svg", campbell_svg(study));
  std::string names = "campbell.svg, campbell.csv";
  std::error_code code;
  std::filesystem::remove(output / "campbell.h5", code);  // of an earlier diagram
  if (arguments.hdf5) {
    write_campbell(output / "campbell.h5", study, scene);
    names += ", campbell.h5";
  }
  for (const auto& [responses, name] : {std::pair{&study.responses, "unbalance.csv"},
                                        std::pair{&study.force_responses, "force.csv"}}) {
    if (responses->empty()) continue;
    write_file(output / name, response_csv(*responses));
    names += std::string(", ") + name;
  }
  return names;
}

int draw_campbell(const CampbellArguments& arguments) {
  Scene scene = read_model(arguments.model, to_overrides(arguments.set));
  if (!arguments.without.empty()) scene = without(scene, arguments.without);
  CampbellOptions options = options_of(arguments, scene);
  if (arguments.hdf5) require_hdf5("campbell.h5");
  const std::filesystem::path output =
      results_directory(arguments.output, arguments.model, "campbell");
  const bool shown = !arguments.quiet && isatty(STDERR_FILENO);
  if (shown)
    options.progress = [](std::size_t done, std::size_t all) {
      show_progress(fmt::format("{} of {} rates", done, all));
    };
  options.interrupted = &InterruptHandler::flag();
  CampbellStudy study;
  {
    const InterruptHandler handler;
    study = study_campbell(scene, options);
  }
  if (shown) show_progress({});
  const std::string names = write_files(arguments, scene, study, output);
  if (!arguments.quiet)
    fmt::print("{}\nwritten to {}: {}\n", to_text(study), output.string(), names);
  return InterruptHandler::flag() ? interrupted_status : 0;
}

}  // namespace

void add_campbell_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<CampbellArguments>();
  CLI::App* const command = app.add_subcommand(
      "campbell",
      "Modes of what turns steadily over its rate, critical speeds, limits of stability.");
  command->add_option("MODEL", arguments->model, "model file (XML)")->required();
  command
      ->add_option("-r,--rates", arguments->rates,
                   "from which rate to which, in rad/s or with units (\"0:6000 rpm\")")
      ->type_name("FROM:TO")
      ->required();
  add_rotation_options(*command, arguments->rotation);
  command
      ->add_option("-p,--points", arguments->points,
                   "how many rates at least; between them steps are halved where modes change "
                   "quickly; default: 61")
      ->type_name("N");
  command->add_option("-n,--count", arguments->count, "how many modes; default: 8")->type_name("N");
  command
      ->add_option(
          "-u,--unbalance", arguments->unbalance,
          "mass times distance from the axis, in kg.m or with units, of a place that turns: "
          "its response at the same rates, linear, amplitude and phase; may be repeated, "
          "negative where it is opposite")
      ->type_name("PLACE=VALUE")
      ->allow_extra_args(false);
  command
      ->add_option("-f,--force", arguments->forces,
                   "amplitudes, in N or with units, of a force of fixed direction across the axis, "
                   "that goes as cos(n W t): its response at the same rates; may be repeated")
      ->type_name("PLACE=Y[,Z]")
      ->allow_extra_args(false);
  command->add_option("--order", arguments->order, "n of --force; default: 1")->type_name("N");
  command
      ->add_option("--probe", arguments->probes,
                   "where responses are wanted besides; may be repeated")
      ->type_name("PLACE")
      ->allow_extra_args(false);
  command->add_flag("--hdf5", arguments->hdf5,
                    "all of it as arrays in one HDF5 file too, campbell.h5");
  add_set_option(*command, arguments->set);
  add_without_option(*command, arguments->without);
  command
      ->add_option("-o,--out", arguments->output,
                   "directory of picture and table; default: results/MODEL/campbell")
      ->type_name("DIR");
  command->add_flag("-q,--quiet", arguments->quiet, "print nothing but errors");
  set_examples(*command,
               "mbd campbell models/shaft.xml --rates 0:81 --without gravity\n"
               "mbd campbell models/shaft.xml --rates \"0:600 rpm\" --without gravity --count 4\n"
               "mbd campbell models/shaft.xml --rates 0:80 --without gravity -s d=0 -u "
               "shaft@0.5=\"20 g.cm\"\n"
               "mbd campbell models/shaft.xml --rates 0:80 --without gravity -s d=0 -f "
               "shaft@0.5=\"2 N\" --order 2",
               "Exit status: 0 all went well; 1 an error; 130 interrupted, with what was done "
               "written; 100 and\n"
               "more: wrong use of the command.");
  command->callback([arguments, &status] { status = draw_campbell(*arguments); });
}

}  // namespace mbd
