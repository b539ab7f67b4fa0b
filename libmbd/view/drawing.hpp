// What there is to be seen of a scene, as JSON: parts with their shape, the node they move with, their numbers and the
// lines of the model that state them. The page (page.hpp) and motion.bin (motion.hpp) hold it.
//
// A place is [node, x, y, z, qx, qy, qz, qw]: a pose in a node, numbered as in the system, the ground being 0.
#pragma once

#include <string>

#include "libmbd/compile/model.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd {

// Of a scene and the model compiled from it.
std::string drawing(const Scene& scene, const Model& model);

// Of a scene that does not compile, for `why`: everything stands where it is stated, on the ground, and joints show the
// gaps between what they join.
std::string drawing(const Scene& scene, const std::string& why);

}  // namespace mbd
