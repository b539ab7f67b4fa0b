// mbd export: a model, or the motion of a run, as files that other programs draw.
#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

void add_export_command(CLI::App& app, int& status);

}  // namespace mbd
