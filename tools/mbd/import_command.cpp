#include "tools/mbd/import_command.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "libmbd/language/reader.hpp"
#include "libmbd/text/files.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/windio.hpp"

namespace mbd {
namespace {

namespace fs = std::filesystem;

struct ImportArguments {
  std::string format, file, out, twist_unit;
  WindioOptions options;
};

void import_file(ImportArguments arguments) {
  if (!arguments.twist_unit.empty()) arguments.options.in_degrees = arguments.twist_unit == "deg";
  std::error_code code;
  if (!arguments.out.empty() && fs::equivalent(arguments.out, arguments.file, code))
    throw Error(arguments.out + " is the file that is read; give another name to --out");
  const WindioBlade blade = read_windio(arguments.file, arguments.options);
  read_model_text(blade.model, "the model of " + arguments.file);
  if (arguments.out.empty()) {
    complain(blade.summary);
    fmt::print("{}", blade.model);
    return;
  }
  write_file(arguments.out, blade.model);
  fmt::print("{}written to {}\n", blade.summary, arguments.out);
}

}  // namespace

void add_import_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<ImportArguments>();
  CLI::App* const command =
      app.add_subcommand("import",
                         "A blade of a windIO file as a model: its reference axis, twist, and "
                         "stiffness and mass of its stations, clamped at "
                         "the root under its weight. What it weighs and how long it is goes to "
                         "standard error, or, with --out, is printed.");
  command->add_option("FORMAT", arguments->format, "of the file")
      ->required()
      ->check(CLI::IsMember({"windio"}));
  command
      ->add_option("FILE", arguments->file,
                   "windIO file (YAML) of layout 1 (elastic_properties_mb) or 2")
      ->required()
      ->type_name("FILE");
  command->add_option("-o,--out", arguments->out, "write the model to this file; default: print it")
      ->type_name("FILE");
  command->add_option("--elements", arguments->options.elements, "spectral elements of the beam")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--order", arguments->options.order, "their order")
      ->check(CLI::Range(1, 8))
      ->capture_default_str();
  command
      ->add_option("--twist-unit", arguments->twist_unit,
                   "of the file's twist; default: rad in layout 1, deg in layout 2")
      ->check(CLI::IsMember({"rad", "deg"}));
  set_examples(*command,
               "mbd import windio IEA-15-240-RWT.yaml --out blade.xml\n"
               "mbd import windio turbine.yaml --elements 20 --twist-unit deg > blade.xml");
  command->callback([arguments, &status] {
    import_file(*arguments);
    status = 0;
  });
}

}  // namespace mbd
