// mbd effects: what each effect of a model costs and is worth, and the cheapest model within a tolerance.
#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

void add_effects_command(CLI::App& app, int& status);

}  // namespace mbd
