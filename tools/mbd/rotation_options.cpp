#include "tools/mbd/rotation_options.hpp"

#include <cmath>

#include "libmbd/core/error.hpp"

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

}  // namespace mbd
