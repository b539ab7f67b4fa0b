// mbd accuracy: what accuracy costs in time.
#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

void add_accuracy_command(CLI::App& app, int& status);

}  // namespace mbd
