// What small motions are about, as commands take it: equilibrium, a steady rotation, or the state of a run.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "libmbd/study/modes/modes.hpp"
#include "solvers/modes/steady_rotation.hpp"

namespace mbd {

struct RotationArguments {
  std::vector<double> axis{1.0, 0.0, 0.0}, through{0.0, 0.0, 0.0};
  std::vector<std::string> at_rest;  // parts that do not turn
};
void add_rotation_options(CLI::App& command, RotationArguments& arguments);

// At rate 0. Throws Error for an axis without direction.
SteadyRotation rotation_of(const RotationArguments& arguments);

// --rate, --at and the options of a rotation.
struct AboutArguments {
  std::string rate, time;
  RotationArguments rotation;
};
void add_about_options(CLI::App& command, AboutArguments& arguments);
// Throws Error for both, and for values that cannot be.
void apply(const AboutArguments& arguments, const Scene& scene, ModesOptions& options);

}  // namespace mbd
