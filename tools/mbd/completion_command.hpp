#pragma once

#include <CLI/CLI.hpp>

namespace mbd {

// Adds "mbd completion SHELL" to the command: a script that completes mbd's commands, options and files. It is
// made from the commands of `app` when it is asked for, so it knows those that are added later.
void add_completion_command(CLI::App& app, int& status);

}  // namespace mbd
