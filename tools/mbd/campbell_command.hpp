// mbd campbell: modes of a rotor over its rate of rotation, and its critical speeds.
#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

void add_campbell_command(CLI::App& app, int& status);

}  // namespace mbd
