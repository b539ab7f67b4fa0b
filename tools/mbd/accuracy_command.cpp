#include "tools/mbd/accuracy_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/material/scene_files.hpp"
#include "libmbd/study/accuracy/accuracy.hpp"
#include "libmbd/study/accuracy/accuracy_page.hpp"
#include "libmbd/study/accuracy/accuracy_report.hpp"
#include "libmbd/text/files.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/fingerprint.hpp"
#include "tools/mbd/interrupt.hpp"
#include "tools/mbd/overrides.hpp"

namespace mbd {
namespace {

struct AccuracyArguments {
  std::string model, output, reference = "auto";
  std::vector<std::string> set, quantities, vary;
  double budget = 120.0;
  int refinements = AccuracyOptions().refinements;
  bool quiet = false;
};

std::string command_of(const AccuracyArguments& arguments) {
  std::string text = "mbd accuracy " + arguments.model;
  text += given("--set", arguments.set) + given("--quantity", arguments.quantities) +
          given("--vary", arguments.vary);
  if (arguments.reference != "auto") text += " --reference " + arguments.reference;
  text += fmt::format(" --budget {:g}", arguments.budget);
  if (arguments.refinements != AccuracyOptions().refinements)
    text += fmt::format(" --refinements {}", arguments.refinements);
  return text;
}

int study_model(const AccuracyArguments& arguments) {
  if (!(arguments.budget >= 1.0) || !(arguments.budget <= 1e6))
    throw Error(fmt::format("--budget {:g}: give seconds, 1 to 1e6", arguments.budget));
  if (const int most = AccuracyOptions().refinements;
      arguments.refinements < 1 || arguments.refinements > most)
    throw Error(
        fmt::format("--refinements {}: give a number, 1 to {}", arguments.refinements, most));
  const Scene scene = read_model(arguments.model, to_overrides(arguments.set));
  AccuracyOptions options;
  options.quantities = arguments.quantities;
  for (const std::string& one : arguments.vary) add_variation(options.variations, one);
  if (arguments.reference != "auto") options.reference = arguments.reference;
  options.budget = arguments.budget;
  options.refinements = arguments.refinements;
  const std::filesystem::path output =
      results_directory(arguments.output, arguments.model, "accuracy");
  make_directory(output);
  options.keep = output / "trials";
  options.fingerprint = fingerprint(files_of(scene), arguments.set);
  options.command = command_of(arguments);
  const bool shown = !arguments.quiet && isatty(STDERR_FILENO);
  if (shown)
    options.progress = [](const std::string& what, std::size_t done, std::size_t all, double eta) {
      const std::string count =
          all > 0 ? fmt::format("{} of {}, about {:.0f} s left: ", done + 1, all, eta) : "";
      show_progress(count + what);
    };
  options.interrupted = &InterruptHandler::flag();
  AccuracyStudy study;
  {
    const InterruptHandler handler;
    study = study_accuracy(scene, options);
  }
  if (shown) show_progress({});
  write_file(output / "accuracy.csv", to_csv(study));
  write_file(output / "accuracy.json", to_json(study));
  write_file(output / "accuracy.svg", accuracy_svg(study));
  write_file(output / "knobs.svg", knobs_svg(study));
  write_file(output / "advice.md", to_markdown(study));
  write_file(output / "accuracy.html", accuracy_page(study, scene));
  if (!arguments.quiet) {
    fmt::print("{}", to_text(study, scene));
    fmt::print(
        "\nwritten to {}: accuracy.html (open it in a browser), accuracy.svg, knobs.svg, "
        "accuracy.csv, "
        "accuracy.json, advice.md\n",
        output.string());
  }
  return InterruptHandler::flag() ? interrupted_status : 0;
}

}  // namespace

void add_accuracy_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<AccuracyArguments>();
  CLI::App* const command = app.add_subcommand(
      "accuracy", "What accuracy costs in time: errors and CPU seconds of many settings.");
  command->add_option("MODEL", arguments->model, "model file (XML)")->required();
  command
      ->add_option(
          "-Q,--quantity", arguments->quantities,
          "whose error: columns, quantities or records; default: what the model expects, plots or "
          "records, at most 4")
      ->type_name("NAME …");
  command
      ->add_option(
          "-v,--vary", arguments->vary,
          "values of a knob: order, elements (of the beams that have the fewest; others in "
          "proportion), metric, rule, form, method, step, tolerance, errors; as lists (1,2,4), "
          "ranges "
          "(2:6, 1e-2:1e-8) or all; default: those that suit the model")
      ->type_name("KNOB=VALUES …");
  command
      ->add_option(
          "-r,--reference", arguments->reference,
          "auto (made here, by two different ways), or a CSV with the columns of history.csv")
      ->type_name("FILE.csv");
  command
      ->add_option("-b,--budget", arguments->budget,
                   "seconds for it all; half of them at most for the reference; default: 120")
      ->type_name("SECONDS");
  command
      ->add_option("--refinements", arguments->refinements,
                   "of the reference, at most; with a budget that is not used up, what is tried is "
                   "then the same on every machine; default: 12, or as many as the budget allows")
      ->type_name("NUMBER");
  command
      ->add_option(
          "-o,--out", arguments->output,
          "directory of the page, pictures and data; what is there of an interrupted study of the "
          "same model is gone on with; default: results/MODEL/accuracy")
      ->type_name("DIR");
  add_set_option(*command, arguments->set);
  command->add_flag("-q,--quiet", arguments->quiet, "print nothing but errors");
  set_examples(*command,
               "mbd accuracy models/shaft.xml\n"
               "mbd accuracy models/four_bar.xml --quantity C.displacement.3 --budget 600\n"
               "mbd accuracy models/bend45.xml --vary order=1:6 elements=1,2,4,8,16 metric=all\n"
               "mbd accuracy models/shaft.xml --vary method=radau tolerance=1e-2:1e-8 order=4\n"
               "mbd accuracy models/four_bar.xml --reference fine/history.csv",
               "Exit status: 0 all went well; 1 an error; 130 interrupted, with what was done "
               "written; 100 and\n"
               "more: wrong use of the command. Settings that fail are data, not errors.");
  command->callback([arguments, &status] { status = study_model(*arguments); });
}

}  // namespace mbd
