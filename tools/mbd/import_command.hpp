// mbd import: files of other programs as models.
#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

void add_import_command(CLI::App& app, int& status);

}  // namespace mbd
