#include "tools/mbd/overrides.hpp"

namespace mbd {

void add_set_option(CLI::App& command, std::vector<std::string>& set) {
  command
      .add_option("-s,--set", set, "give a parameter of the model another value; may be repeated")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
}

Overrides to_overrides(const std::vector<std::string>& set) {
  Overrides overrides;
  for (const std::string& text : set) {
    const std::size_t equals = text.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
      throw Error("--set " + text + ": write --set name=value, without blanks around =");
    overrides.emplace_back(text.substr(0, equals), text.substr(equals + 1));
  }
  return overrides;
}

}  // namespace mbd
