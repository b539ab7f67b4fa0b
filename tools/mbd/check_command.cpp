#include "tools/mbd/check_command.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/run/describe.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/overrides.hpp"

namespace mbd {
namespace {

struct CheckArguments {
  std::vector<std::string> models;
  std::vector<std::string> set, plugins;
  bool json = false;
};

// One message for each model that is wrong; the others are checked all the same.
int check_models(const CheckArguments& arguments) {
  const Overrides overrides = to_overrides(arguments.set);
  int status = 0;
  bool first = true;
  for (const std::string& file : arguments.models) {
    try {
      const Scene scene = read_model(file, overrides, arguments.plugins);
      const Model model = compile(scene);
      const CheckReport report = check_model(scene, model);
      const std::string text = arguments.json ? to_json(report) : to_text(report);
      fmt::print("{}{}", first || arguments.json ? "" : "\n", text);
      first = false;
    } catch (const std::exception& error) {
      std::fflush(stdout);
      complain(fmt::format("mbd: {}\n", error.what()));
      status = 1;
    }
  }
  return status;
}

}  // namespace

void add_check_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<CheckArguments>();
  CLI::App* const command = app.add_subcommand(
      "check", "Reads and compiles models and says what they are; runs and writes nothing.");
  command->add_option("MODEL", arguments->models, "model files (XML)")->required();
  add_set_option(*command, arguments->set);
  add_plugin_option(*command, arguments->plugins);
  command->add_flag("--json", arguments->json, "the same as JSON, one object for each model");
  set_examples(*command,
               "mbd check models/four_bar.xml\n"
               "mbd check models/*.xml\n"
               "mbd check models/chain.xml --set N=100");
  command->callback([arguments, &status] { status = check_models(*arguments); });
}

}  // namespace mbd
