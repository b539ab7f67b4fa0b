#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

// Adds "mbd plot DIR …" to the command; running it sets `status`.
void add_plot_command(CLI::App& app, int& status);

}  // namespace mbd
