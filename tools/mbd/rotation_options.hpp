// What small motions are about, as commands take it: equilibrium, a steady rotation, or the state of a run; and which modes
// of them. Options mean what the attributes of <modes> of the same names mean (ModesScene), and have their words.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/study/modes/modes.hpp"
#include "solvers/modes/steady_rotation.hpp"

namespace mbd {

struct RotationArguments {
  std::vector<double> axis = {}, through = {};  // none: not given
  std::vector<std::string> at_rest = {};        // parts that do not turn
};
void add_rotation_options(CLI::App& command, RotationArguments& arguments);

// At rate 0. Throws Error for an axis without direction.
SteadyRotation rotation_of(const RotationArguments& arguments);

// About that rotation, --rates FROM:TO; a unit of the second alone is that of both. Throws Error, with what to give, as
// rotation_of() does and unless they rise and are not negative.
RangeOfRates range_of(const RotationArguments& arguments, const std::string& rates,
                      const Scene& scene);

// --rate, --at and the options of a rotation. Texts are expressions of the model's parameters; empty: not given.
struct AboutArguments {
  std::string rate = {}, time = {};
  RotationArguments rotation = {};
};
void add_about_options(CLI::App& command, AboutArguments& arguments);

// Those, and nothing of what the scene asks for. Throws Error for both, and for values that cannot be.
ModesOptions about(const AboutArguments& arguments, const Scene& scene);

struct ModesArguments {
  std::optional<int> count = {};
  std::string near = {};
  AboutArguments about = {};
  bool mac = false;
};
void add_modes_options(CLI::App& command, ModesArguments& arguments);

// What <modes> of the scene asks for, and in its place what is given here: --at in the place of a rate, --rate in that of a time.
// Throws Error for values that cannot be.
ModesOptions modes_options(const ModesArguments& arguments, const Scene& scene);

// Modes to compare with those of these arguments: of a modes.json, of a directory with one, or of a model file, found as
// `arguments` say and otherwise as it asks for them. Throws Error for one that cannot be read.
ShapesOfModes modes_to_compare(const std::filesystem::path& other, const ModesArguments& arguments);
// Of a scene, found likewise.
ShapesOfModes modes_to_compare(const Scene& scene, const ModesArguments& arguments);

}  // namespace mbd
