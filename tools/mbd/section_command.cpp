#include "tools/mbd/section_command.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/run/describe_section.hpp"
#include "libmbd/text/files.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/overrides.hpp"

namespace mbd {
namespace {

struct SectionArguments {
  std::string model, name, csv;
  std::vector<std::string> set;
  bool json = false;
};

void describe(const SectionArguments& arguments) {
  const Scene scene = read_model(arguments.model, to_overrides(arguments.set));
  const std::vector<SectionReport> reports = describe_sections(scene, arguments.name);
  if (!arguments.csv.empty()) write_file(arguments.csv, to_csv(reports));
  if (arguments.json) {
    fmt::print("{}", to_json(reports));
    return;
  }
  for (std::size_t i = 0; i < reports.size(); ++i)
    fmt::print("{}{}", i == 0 ? "" : "\n", to_text(reports[i]));
}

}  // namespace

void add_section_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<SectionArguments>();
  CLI::App* const command = app.add_subcommand(
      "section",
      "Stiffness D and mass M of sections, their centres and principal axes, and, of sections by "
      "shape and material, an error estimate of every entry; no run.");
  command->add_option("MODEL", arguments->model, "model file (XML)")->required();
  command->add_option("NAME", arguments->name, "of one section; default: all of them");
  add_set_option(*command, arguments->set);
  command->add_flag("--json", arguments->json, "the same as JSON");
  command->add_option("-o,--out", arguments->csv, "write the matrices to this file, as CSV")
      ->type_name("FILE");
  set_examples(*command,
               "mbd section models/shaft_tube.xml\n"
               "mbd section models/four_bar_boxes.xml box16 --json\n"
               "mbd section models/shaft_tube.xml tube --out tube.csv");
  command->callback([arguments, &status] {
    describe(*arguments);
    status = 0;
  });
}

}  // namespace mbd
