#include "tools/mbd/overrides.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "libmbd/compile/plugin.hpp"
#include "libmbd/language/schema.hpp"
#include "libmbd/language/units.hpp"
#include "libmbd/scene/transient.hpp"

namespace mbd {
namespace {

const schema::Attribute& attribute(std::string_view name) {
  return *schema::find_attribute(*schema::find_element("transient"), name);
}

std::vector<std::string> choices_of(std::string_view name) {
  const auto words = schema::words(attribute(name).choices);
  return {words.begin(), words.end()};
}

// The value of an option for the attribute of <transient> of the same name.
double number(std::string_view name, const std::string& text, const Scene& scene) {
  const double value = option_value(name, text, attribute(name).unit, scene);
  if (const std::string fault = schema::fault(attribute(name), value); !fault.empty())
    throw Error(fmt::format("--{} {}: {}", name, text, fault));
  return value;
}

}  // namespace

Overrides with(Overrides overrides, const Overrides& more) {
  overrides.insert(overrides.end(), more.begin(), more.end());
  return overrides;
}

double option_value(std::string_view name, const std::string& text, std::string_view unit,
                    const Scene& scene) {
  Parameters parameters;
  for (const auto& [parameter, value] : scene.parameters) parameters[parameter] = value;
  const NumberAndUnit parts = split_unit(text);
  try {
    const double value = Expression::parse(parts.number, parameters, Variables::none).value();
    return parts.unit.empty() ? value : value * unit_factor(parts.unit, unit);
  } catch (const Error& error) {
    throw Error(fmt::format("--{} {}: {}", name, text, error.what()));
  }
}

void add_set_option(CLI::App& command, std::vector<std::string>& set) {
  command
      .add_option("-s,--set", set, "give a parameter of the model another value; may be repeated")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
}

void add_plugin_option(CLI::App& command, std::vector<std::string>& plugins) {
  command
      .add_option(
          "--plugin", plugins,
          "load forces that the model's <extension>s ask for from this shared object "
          "(libmbd/plugin.h), which it runs: only files you trust; may be given more than once")
      ->type_name("FILE")
      ->allow_extra_args(false);
}

Scene read_model(const std::string& file, const Overrides& overrides,
                 const std::vector<std::string>& plugins) {
  Scene scene = read_model(file, overrides);
  for (const std::string& plugin : plugins) use_plugin(scene, plugin);
  return scene;
}

void add_without_option(CLI::App& command, std::vector<std::string>& without) {
  command
      .add_option("--without", without,
                  "leave out an effect, as `mbd effects` calls it: gravity, rigid:bar1 (makes it "
                  "rigid), shear, …; may be given more than once")
      ->type_name("EFFECT");
}

Overrides to_overrides(const std::vector<std::string>& set) {
  Overrides overrides;
  for (const std::string& text : set) {
    const std::size_t equals = text.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
      throw Error("--set " + text + ": write --set name=value, without blanks around =");
    overrides.emplace_back(text.substr(0, equals), text.substr(equals + 1));
  }
  return overrides;
}

void add_transient_options(CLI::App& command, TransientOptions& options) {
  command
      .add_option("-m,--method", options.method,
                  "integrate by this method: generalized_alpha, radau or ida")
      ->check(CLI::IsMember(choices_of("method")));
  command
      .add_option("--stages", options.stages,
                  "of radau: how many stages a step has, 3, 5 or 7 (of order 5, 9, 13), or auto")
      ->check(CLI::IsMember(choices_of("stages")));
  command
      .add_option("--step", options.step,
                  "in fixed steps of H seconds, or of a number with a unit, in place of those of "
                  "the model or of its tolerance")
      ->check(not_empty, "", "")
      ->type_name("H");
  command
      .add_option(
          "-t,--tolerance", options.tolerance,
          "in steps that keep the estimated relative error below T, in place of fixed ones; "
          "rows of results stay at the times of the model's own steps")
      ->check(not_empty, "", "")
      ->type_name("T");
  command
      .add_option("--output", options.output,
                  "write a row of results every DT seconds, or (steps) where each step ends")
      ->check(not_empty, "", "")
      ->type_name("DT");
}

std::vector<std::string> apply(const TransientOptions& options, Scene& scene) {
  const auto& [method, step, tolerance, output, stages] = options;
  if (method.empty() && step.empty() && tolerance.empty() && output.empty() && stages.empty())
    return {};
  if (!scene.transient)
    throw Error(fmt::format("--{}: the model has no <transient>; leave it out, or add one to {}",
                            !method.empty()      ? "method"
                            : !step.empty()      ? "step"
                            : !tolerance.empty() ? "tolerance"
                            : !output.empty()    ? "output"
                                                 : "stages",
                            scene.file));
  if (!step.empty() && !tolerance.empty())
    throw Error("--step and --tolerance: steps are fixed or follow a tolerance; give one of them");
  TransientScene& transient = *scene.transient;
  SteppingChange change;
  if (!step.empty()) change.step = number("step", step, scene);
  if (!tolerance.empty()) change.tolerance = number("tolerance", tolerance, scene);
  const auto place_among = [](const char* name, const std::string& word) {
    const std::vector<std::string> known = choices_of(name);
    const auto at = std::find(known.begin(), known.end(), word);
    if (at == known.end())
      throw Error(fmt::format("--{} {}: give {}", name, word, fmt::join(known, ", ")));
    return at - known.begin();
  };
  if (!method.empty()) {
    change.method = static_cast<TimeMethod>(place_among("method", method));
    if (change.method == TimeMethod::ida && !change.tolerance && (change.step || transient.step))
      throw Error("--method ida has no fixed steps; add --tolerance");
  }
  if (!stages.empty()) {
    change.stages = static_cast<StageCount>(place_among("stages", stages));
    if (change.method.value_or(transient.method) != TimeMethod::radau)
      throw Error("--stages belongs to radau; add --method radau");
    if (change.stages == StageCount::automatic && !change.tolerance &&
        (change.step || transient.step))
      throw Error(
          "--stages auto follows the errors of steps, and fixed steps have none; give a number, or "
          "--tolerance");
  }
  const std::vector<std::string> notes = change_stepping(transient, change);
  if (!output.empty()) {
    transient.output_steps = output == "steps";
    transient.output.reset();
    if (!transient.output_steps) transient.output = number("output", output, scene);
  }
  return notes;
}

std::string not_empty(const std::string& text) {
  return text.empty() ? std::string("is empty; give a value") : std::string();
}

}  // namespace mbd
