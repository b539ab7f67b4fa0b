#include "tools/mbd/explain_command.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/run/describe.hpp"
#include "tools/mbd/command_line.hpp"
#include "tools/mbd/overrides.hpp"

namespace mbd {
namespace {

struct ExplainArguments {
  std::string model;
  std::vector<std::string> set, plugins;
  bool json = false;
};

void explain(const ExplainArguments& arguments) {
  const Scene scene = read_model(arguments.model, to_overrides(arguments.set), arguments.plugins);
  const Explanation explanation = explain_model(scene, compile(scene));
  fmt::print("{}", arguments.json ? to_json(explanation) : to_text(explanation));
}

}  // namespace

void add_explain_command(CLI::App& app, int& status) {
  const auto arguments = std::make_shared<ExplainArguments>();
  CLI::App* const command = app.add_subcommand(
      "explain", "Says what is simulated, term by term, and what is absent and why; no run.");
  command->add_option("MODEL", arguments->model, "model file (XML)")->required();
  add_set_option(*command, arguments->set);
  add_plugin_option(*command, arguments->plugins);
  command->add_flag("--json", arguments->json, "the same as JSON");
  set_examples(*command,
               "mbd explain models/four_bar.xml\n"
               "mbd explain models/chain.xml --set N=100 --json");
  command->callback([arguments, &status] {
    explain(*arguments);
    status = 0;
  });
}

}  // namespace mbd
