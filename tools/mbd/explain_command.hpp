#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

// Adds "mbd explain MODEL …" to the command; running it sets `status`.
void add_explain_command(CLI::App& app, int& status);

}  // namespace mbd
