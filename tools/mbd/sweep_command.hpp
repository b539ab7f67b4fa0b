// mbd sweep: a model run over many values of its parameters, as one table.
#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

void add_sweep_command(CLI::App& app, int& status);

}  // namespace mbd
