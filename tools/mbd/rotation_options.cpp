#include "tools/mbd/rotation_options.hpp"

#include <cmath>

#include "libmbd/core/error.hpp"
#include "tools/mbd/overrides.hpp"

namespace mbd {

void add_rotation_options(CLI::App& command, RotationArguments& arguments) {
  command.add_option("--axis", arguments.axis, "axis of the rotation, inertial; default: 1 0 0")
      ->expected(3)
      ->type_name("X Y Z");
  command.add_option("--through", arguments.through, "a point of it, in m; default: 0 0 0")
      ->expected(3)
      ->type_name("X Y Z");
  command
      .add_option("--at-rest", arguments.at_rest,
                  "a body or flexible beam that does not turn, as the housing of a bearing; may be "
                  "repeated")
      ->type_name("NAME")
      ->allow_extra_args(false);
}

SteadyRotation rotation_of(const RotationArguments& arguments) {
  const Vec3 axis(arguments.axis[0], arguments.axis[1], arguments.axis[2]),
      through(arguments.through[0], arguments.through[1], arguments.through[2]);
  if (!(axis.norm() > 0.0) || !std::isfinite(axis.norm()))
    throw Error("--axis: give a direction that is not zero");
  if (!through.allFinite()) throw Error("--through: give a point");
  return {0.0, axis / axis.norm(), through, {}};
}

void add_about_options(CLI::App& command, AboutArguments& arguments) {
  command
      .add_option("-r,--rate", arguments.rate,
                  "about steady rotation of the whole at this rate, in rad/s or with a unit "
                  "(\"300 rpm\")")
      ->type_name("RATE");
  command
      .add_option("--at", arguments.time,
                  "about the state of a run at this time, in s or with a unit: what small motions "
                  "are at that moment")
      ->type_name("TIME");
  add_rotation_options(command, arguments.rotation);
}

void apply(const AboutArguments& arguments, const Scene& scene, ModesOptions& options) {
  if (!arguments.rate.empty()) {
    options.rotation = rotation_of(arguments.rotation);
    options.at_rest = arguments.rotation.at_rest;
    options.rotation->rate = option_value("rate", arguments.rate, "rad/s", scene);
  }
  if (arguments.time.empty()) return;
  options.time = option_value("at", arguments.time, "s", scene);
  if (options.rotation) throw Error("give --rate or --at, one of them");
  if (!(*options.time >= 0.0))
    throw Error("--at " + arguments.time + ": give a time that is not negative");
}

}  // namespace mbd
