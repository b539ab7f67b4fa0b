// mbd floquet MODEL: a motion that repeats, and whether it is stable.
#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

void add_floquet_command(CLI::App& app, int& status);

}  // namespace mbd
