// The axis of a steady rotation, as commands take it.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "solvers/modes/steady_rotation.hpp"

namespace mbd {

struct RotationArguments {
  std::vector<double> axis{1.0, 0.0, 0.0}, through{0.0, 0.0, 0.0};
  std::vector<std::string> at_rest;  // parts that do not turn
};
void add_rotation_options(CLI::App& command, RotationArguments& arguments);

// At rate 0. Throws Error for an axis without direction.
SteadyRotation rotation_of(const RotationArguments& arguments);

}  // namespace mbd
