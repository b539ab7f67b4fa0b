// What a Scene must not say, whoever filled it: the reader or a C++ program.
#pragma once

#include "libmbd/scene/scene.hpp"

namespace mbd {

// Looks at each item by itself and at the names: numbers that are not finite or not in the range of the
// schema, names that are no names or taken, attributes that exclude or need each other. What takes the
// mechanism as a whole (unknown names, geometry, joints) is found by compile(), which calls this first.
// Throws Error with the item's source, the item, what is wrong and what to do about it.
void check_scene(const Scene& scene);

}  // namespace mbd
