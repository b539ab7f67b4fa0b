#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

// Adds "mbd check MODEL… …" to the command; running it sets `status`.
void add_check_command(CLI::App& app, int& status);

}  // namespace mbd
