#include "tools/mbd/rotation_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <memory>

#include "libmbd/core/error.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/language/schema.hpp"
#include "libmbd/language/units.hpp"
#include "tools/mbd/overrides.hpp"

namespace mbd {
namespace {

const schema::Attribute& attribute_of_modes(std::string_view name) {
  return *schema::find_attribute(*schema::find_element("modes"), name);
}

// What the attribute of <modes> of this name is, for --help.
std::string words_of_option(std::string_view name) {
  const schema::Attribute& a = attribute_of_modes(name);
  std::string text(a.doc);
  if (!a.unit.empty())
    text += a.kind == schema::Kind::number ? fmt::format(", in {} or with a unit", a.unit)
                                           : fmt::format(", in {}", a.unit);
  if (a.fallback != schema::optional && a.choices.empty())
    text += fmt::format("; default: {}", a.fallback);
  return text;
}

Vec3 vector_of(const std::vector<double>& numbers) { return {numbers[0], numbers[1], numbers[2]}; }

void check_rotation(const RotationArguments& arguments) {
  if (!arguments.axis.empty())
    if (const double length = vector_of(arguments.axis).norm();
        !(length > 0.0) || !std::isfinite(length))
      throw Error("--axis: give a direction that is not zero");
  if (!arguments.through.empty() && !vector_of(arguments.through).allFinite())
    throw Error("--through: give a point");
}

// The value of an option for the attribute of <modes> of this name.
double number_of(std::string_view name, const std::string& text, const Scene& scene) {
  const schema::Attribute& a = attribute_of_modes(name);
  const double value = option_value(name, text, a.unit, scene);
  if (const std::string fault = schema::fault(a, value); !fault.empty())
    throw Error(fmt::format("--{} {}: {}", name, text, fault));
  return value;
}

// What is given in place of what was asked for.
void apply_about(const AboutArguments& arguments, const Scene& scene, ModesScene& modes) {
  const auto& [rate, time, rotation] = arguments;
  if (!rate.empty() && !time.empty()) throw Error("give --rate or --at, one of them");
  check_rotation(rotation);
  if (!time.empty()) {
    modes.rate.reset();
    modes.axis.reset();
    modes.through.reset();
    modes.at_rest.clear();
    modes.at = number_of("at", time, scene);
  }
  if (!rate.empty()) {
    modes.at.reset();
    modes.rate = number_of("rate", rate, scene);
  }
  if (!rotation.axis.empty()) modes.axis = vector_of(rotation.axis);
  if (!rotation.through.empty()) modes.through = vector_of(rotation.through);
  if (!rotation.at_rest.empty()) modes.at_rest = rotation.at_rest;
  if (!modes.rate &&
      (!rotation.axis.empty() || !rotation.through.empty() || !rotation.at_rest.empty()))
    throw Error(
        "--axis, --through and --at-rest are of a steady rotation; give its --rate, or leave "
        "them out");
}

std::string value_in_words(const auto& value) {
  using T = std::decay_t<decltype(value)>;
  if constexpr (std::is_same_v<T, bool>)
    return value ? "on" : "off";
  else if constexpr (std::is_same_v<T, Vec3>)
    return fmt::format("{:g} {:g} {:g}", value(0), value(1), value(2));
  else if constexpr (std::is_same_v<T, std::vector<std::string>>)
    return fmt::format("{}", fmt::join(value, " "));
  else
    return schema::shortest(static_cast<double>(value));
}

// What of them is not the default, and whether an option or the scene says so.
std::vector<AskedForModes> asked_for(const ModesScene& modes, const ModesScene& by_scene) {
  std::vector<AskedForModes> all;
  const ModesScene still;
  ModesScene::each_field([&](const auto& field) {
    const auto &value = modes.*field.member, &scenes = by_scene.*field.member;
    if (value == still.*field.member && value == scenes) return;
    std::string words;
    field::each_in(value, [&](const auto& one) { words = value_in_words(one); });
    const schema::Attribute& a = field.about.attribute;
    if (!a.unit.empty() && !words.empty()) words += fmt::format(" {}", a.unit);
    all.push_back({std::string(a.name), words.empty() ? "none" : words, value == scenes});
  });
  return all;
}

}  // namespace

void add_rotation_options(CLI::App& command, RotationArguments& arguments) {
  command.add_option("--axis", arguments.axis, words_of_option("axis"))
      ->expected(3)
      ->type_name("X Y Z");
  command.add_option("--through", arguments.through, words_of_option("through"))
      ->expected(3)
      ->type_name("X Y Z");
  command
      .add_option("--at-rest", arguments.at_rest, words_of_option("at_rest") + "; may be repeated")
      ->type_name("NAME")
      ->allow_extra_args(false);
}

RangeOfRates range_of(const RotationArguments& arguments, const std::string& rates,
                      const Scene& scene) {
  const std::size_t colon = rates.find(':');
  if (colon == std::string::npos) throw Error("--rates " + rates + ": give two rates, FROM:TO");
  // "480:580 rpm": one unit for both.
  std::string first = rates.substr(0, colon);
  const std::string last = rates.substr(colon + 1);
  if (split_unit(first).unit.empty()) first += fmt::format(" {}", split_unit(last).unit);
  const RangeOfRates range{rotation_of(arguments), arguments.at_rest,
                           option_value("rates", first, "rad/s", scene),
                           option_value("rates", last, "rad/s", scene)};
  require_rising(range, "--rates " + rates);
  return range;
}

SteadyRotation rotation_of(const RotationArguments& arguments) {
  check_rotation(arguments);
  ModesScene modes;
  if (!arguments.axis.empty()) modes.axis = vector_of(arguments.axis);
  if (!arguments.through.empty()) modes.through = vector_of(arguments.through);
  return {0.0, modes.direction(), modes.point_of_axis(), {}};
}

void add_about_options(CLI::App& command, AboutArguments& arguments) {
  command.add_option("-r,--rate", arguments.rate, words_of_option("rate"))
      ->check(not_empty, "", "")
      ->type_name("RATE");
  command.add_option("--at", arguments.time, words_of_option("at"))
      ->check(not_empty, "", "")
      ->type_name("TIME");
  add_rotation_options(command, arguments.rotation);
}

ModesOptions about(const AboutArguments& arguments, const Scene& scene) {
  ModesScene modes;
  apply_about(arguments, scene, modes);
  return modes_options(modes);
}

void add_modes_options(CLI::App& command, ModesArguments& arguments) {
  command.add_option("-n,--count", arguments.count, words_of_option("count"))->type_name("N");
  command.add_option("--near", arguments.near, words_of_option("near"))
      ->check(not_empty, "", "")
      ->type_name("F");
  add_about_options(command, arguments.about);
  command.add_flag("--mac", arguments.mac, words_of_option("mac"));
}

ModesOptions modes_options(const ModesArguments& arguments, const Scene& scene) {
  const ModesScene by_scene = scene.modes.value_or(ModesScene{});
  ModesScene modes = by_scene;
  if (arguments.count)
    modes.count = static_cast<int>(number_of("count", std::to_string(*arguments.count), scene));
  if (!arguments.near.empty()) modes.near = number_of("near", arguments.near, scene);
  modes.mac = modes.mac || arguments.mac;
  apply_about(arguments.about, scene, modes);
  ModesOptions options = modes_options(modes);
  options.asked = asked_for(modes, by_scene);
  return options;
}

ShapesOfModes modes_to_compare(const std::filesystem::path& other,
                               const ModesArguments& arguments) {
  std::error_code code;
  if (other.extension() == ".json" || std::filesystem::is_directory(other, code))
    return read_modes(other);
  return modes_to_compare(read_model(other.string()), arguments);
}

ShapesOfModes modes_to_compare(const Scene& scene, const ModesArguments& arguments) {
  ModesOptions options = modes_options(arguments, scene);
  options.mac = false;
  return shapes_of(study_modes(scene, options));
}

}  // namespace mbd
