#include "tools/mbd/plot_command.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "libmbd/pictures/plot.hpp"
#include "libmbd/results/history.hpp"
#include "libmbd/text/files.hpp"
#include "tools/mbd/command_line.hpp"

namespace mbd {
namespace {

struct PlotArguments {
  std::string results;
  std::vector<std::string> names;
  std::string x, output, title;
};

int plot_results(const PlotArguments& arguments) {
  const History history = read_history(arguments.results);
  const std::size_t x = arguments.x.empty() ? 0 : choose_column(history, arguments.x);
  std::vector<std::size_t> chosen = choose_columns(history, arguments.names);
  if (arguments.names.empty()) std::erase(chosen, x);
  if (chosen.empty())
    throw Error(history.file.string() + ": there is nothing to plot over \"" + arguments.x +
                "\"; choose another column with --x, or add a <record> to the model");
  const std::filesystem::path file = arguments.output.empty()
                                         ? history.file.parent_path() / "plot.svg"
                                         : std::filesystem::path(arguments.output);
  plot::check_picture(file);
  write_file(file, plot::history_svg(history, chosen, x, arguments.title));
  for (const std::string& note : history.notes) fmt::print("note: {}\n", note);
  fmt::print("wrote {}\n", file.string());
  return 0;
}

}  // namespace

void add_plot_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<PlotArguments>();
  CLI::App* const command = app.add_subcommand("plot", "Draws what a run recorded, as SVG.");
  command
      ->add_option("DIR", arguments->results,
                   "directory of a run's results, or a CSV file with a line of column names")
      ->required();
  command->add_option("RECORD", arguments->names,
                      "what to draw: records (C), quantities (C.displacement) or columns "
                      "(C.displacement.3); default: all");
  command
      ->add_option("-x,--x", arguments->x,
                   "column for the horizontal axis; default: the first (time or load_factor)")
      ->type_name("COLUMN");
  command
      ->add_option("-o,--out", arguments->output, "picture; default: plot.svg beside the history")
      ->type_name("FILE.svg");
  command->add_option("-t,--title", arguments->title, "written above the picture");
  set_examples(*command,
               "mbd plot results/four_bar\n"
               "mbd plot results/four_bar C.displacement A.angle --out c.svg --title \"Joint C\"\n"
               "mbd plot results/four_bar C.displacement.3 --x A.angle");
  command->callback([arguments, &status] { status = plot_results(*arguments); });
}

}  // namespace mbd
