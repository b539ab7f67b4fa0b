// The option --set NAME=VALUE, for every command that reads a model.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "libmbd/front/reader.hpp"

namespace mbd {

// Adds it to a command; `set` must outlive the command.
void add_set_option(CLI::App& command, std::vector<std::string>& set);

// "name=value" of each. Throws Error for what is not written so.
Overrides to_overrides(const std::vector<std::string>& set);

}  // namespace mbd
