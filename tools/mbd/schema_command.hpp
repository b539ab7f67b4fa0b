#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

// Adds "mbd schema [ELEMENT]" to the command: what a model file may say.
void add_schema_command(CLI::App& app, int& status);

}  // namespace mbd
