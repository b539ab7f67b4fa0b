// mbd torture: trials of invariance, steps and tolerances on any model.
#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

void add_torture_command(CLI::App& app, int& status);

}  // namespace mbd
