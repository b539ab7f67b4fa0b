#include "tools/mbd/compare_command.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/pictures/compare.hpp"
#include "libmbd/pictures/plot.hpp"
#include "libmbd/text/files.hpp"
#include "tools/mbd/command_line.hpp"

namespace mbd {
namespace {

struct CompareArguments {
  std::string first, second;
  std::vector<std::string> names;
  std::string output;
  std::optional<double> tolerance;
};

int compare_results(const CompareArguments& arguments) {
  if (arguments.tolerance && !(*arguments.tolerance >= 0.0 && std::isfinite(*arguments.tolerance)))
    throw Error(fmt::format("--tolerance is {}, must be a finite number and not negative",
                            *arguments.tolerance));
  const History first = read_history(arguments.first), second = read_history(arguments.second);
  const Comparison comparison = compare(first, second, arguments.names);
  const std::filesystem::path file = arguments.output.empty()
                                         ? second.file.parent_path() / "compare.svg"
                                         : std::filesystem::path(arguments.output);
  plot::check_picture(file);
  for (const History* const history : {&first, &second})
    for (const std::string& note : history->notes) fmt::print("note: {}\n", note);
  fmt::print("{}", to_text(comparison, first, second));
  std::fflush(stdout);
  write_file(file, overlay_svg(comparison, first, second));
  fmt::print("wrote {}\n", file.string());
  if (!arguments.tolerance) return 0;
  std::size_t above = 0;
  for (const ColumnDifference& d : comparison.columns) above += d.above(*arguments.tolerance);
  fmt::print("{} of {} columns have a relative rms above {}\n", above, comparison.columns.size(),
             *arguments.tolerance);
  // What one run has and the other lacks is a difference too, unless the records were chosen.
  const std::size_t lacking =
      arguments.names.empty() ? comparison.only_first.size() + comparison.only_second.size() : 0;
  if (lacking > 0) fmt::print("{} columns are in one run only\n", lacking);
  const auto range = [](const History& h) {
    return std::pair(h.values[0].front(), h.values[0].back());
  };
  const auto [from1, to1] = range(first);
  const auto [from2, to2] = range(second);
  const double near =
      1e-9 * std::max({std::abs(from1), std::abs(to1), std::abs(from2), std::abs(to2)});
  const bool shorter = std::abs(from1 - from2) > near || std::abs(to1 - to2) > near;
  if (shorter)
    fmt::print("the runs differ in length: {:.6g} to {:.6g}, and {:.6g} to {:.6g}\n", from1, to1,
               from2, to2);
  return above > 0 || lacking > 0 || shorter ? 2 : 0;
}

}  // namespace

void add_compare_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<CompareArguments>();
  CLI::App* const command =
      app.add_subcommand("compare", "Norms of the differences of two runs, and a plot of both.");
  command->add_option("DIR1", arguments->first, "directory of a run's results, or a CSV file")
      ->required();
  command->add_option("DIR2", arguments->second, "the one compared with it")->required();
  command->add_option("RECORD", arguments->names,
                      "what to compare: records, quantities or columns; default: all");
  command
      ->add_option("-o,--out", arguments->output,
                   "picture; default: compare.svg beside the second history")
      ->type_name("FILE.svg");
  command
      ->add_option(
          "-t,--tolerance", arguments->tolerance,
          "exit with status 2 if the rms of a column's difference is above this part of the "
          "largest magnitude of its quantity in DIR1")
      ->type_name("T");
  set_examples(
      *command,
      "mbd compare results/four_bar results/four_bar_fine\n"
      "mbd compare results/four_bar results/four_bar_fine C.displacement --tolerance 1e-3",
      "Exit status: 0 all went well; 1 an error; 2 a column is above --tolerance, or missing;\n"
      "100 and more: wrong use of the command.");
  command->callback([arguments, &status] { status = compare_results(*arguments); });
}

}  // namespace mbd
