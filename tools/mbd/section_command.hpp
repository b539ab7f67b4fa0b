// mbd section: what the sections of a model are worth.
#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

void add_section_command(CLI::App& app, int& status);

}  // namespace mbd
