// A compiled scene: a const System, the State it starts from, and the columns a run writes.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libmbd/core/state.hpp"
#include "libmbd/core/system.hpp"
#include "libmbd/front/scene.hpp"

namespace mbd {

// One number of a run at an accepted state, e.g. "C.displacement.3" [m].
struct Column {
  std::string name;
  std::string unit;
};

// Some neighbouring columns, and how to read them from a state (a, of the model's System).
struct Channel {
  std::vector<Column> columns;
  std::function<void(const State&, std::span<double>)> sample;
};

struct Model {
  std::unique_ptr<const System> system;
  State initial;  // reference configuration, initial velocities; not yet in equilibrium
  std::vector<Channel> channels;  // in the order of the scene's records
  // Who made each row of State::lambda: a joint, a drive or a motion, as messages call it.
  struct Maker {
    Source source;
    std::string label;  // `revolute "A"`
  };
  std::vector<Maker> makers;
};

// Checks the scene as a mechanism and builds it. Throws Error, naming file, line and item, for unknown
// or duplicate names, open joints (with the gap), sections that are not positive definite, free massless
// nodes in a transient, relative angles beyond the metric's range.
Model compile(const Scene& scene);

}  // namespace mbd
