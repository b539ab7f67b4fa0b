// mbd linearize: the equations of motion of a model as matrices.
#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

void add_linearize_command(CLI::App& app, int& status);

}  // namespace mbd
