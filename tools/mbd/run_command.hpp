#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

// Adds "mbd run MODEL …" to the command; running it sets `status`.
void add_run_command(CLI::App& app, int& status);

}  // namespace mbd
