// From a <static> to the options of its solution.
#pragma once

#include "libmbd/scene/scene.hpp"
#include "solvers/statics/statics.hpp"

namespace mbd {

// `statics` of the scene, which decides whether stability is counted and whether loads have a potential.
StaticOptions static_options(const Scene& scene, const StaticScene& statics);

}  // namespace mbd
