// mbd rotations: steady rotations of a rotor over their rate, through folds, and others at the same rates.
#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

void add_rotations_command(CLI::App& app, int& status);

}  // namespace mbd
