#include "tools/mbd/check_command.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "libmbd/front/describe.hpp"
#include "libmbd/front/reader.hpp"
#include "tools/mbd/overrides.hpp"

namespace mbd {
namespace {

struct CheckArguments {
  std::vector<std::string> models;
  std::vector<std::string> set;
};

// One message for each model that is wrong; the others are checked all the same.
int check_models(const CheckArguments& arguments) {
  const Overrides overrides = to_overrides(arguments.set);
  int status = 0;
  bool first = true;
  for (const std::string& file : arguments.models) {
    try {
      const Scene scene = read_model(file, overrides);
      const std::string text = to_text(check_model(scene, compile(scene)));
      fmt::print("{}{}", first ? "" : "\n", text);
      first = false;
    } catch (const std::exception& error) {
      std::fflush(stdout);
      fmt::print(stderr, "mbd: {}\n", error.what());
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
  command->footer(
      "Examples:\n"
      "  mbd check models/four_bar.xml\n"
      "  mbd check models/*.xml\n"
      "  mbd check models/chain.xml --set N=100\n"
      "Exit status: 0 nothing is wrong (notes may say where to look); 1 a model is wrong: one\n"
      "message for each.");
  command->callback([arguments, &status] { status = check_models(*arguments); });
}

}  // namespace mbd
