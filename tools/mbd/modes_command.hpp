// mbd modes: frequencies, damping and shapes of small motions of a model.
#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

void add_modes_command(CLI::App& app, int& status);

}  // namespace mbd
