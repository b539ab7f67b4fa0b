#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

// Adds "mbd compare DIR1 DIR2 …" to the command; running it sets `status`.
void add_compare_command(CLI::App& app, int& status);

}  // namespace mbd
