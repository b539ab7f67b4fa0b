// Parts of a System: nodes that its elements and joints tie together, without those that only the ground ties.
#pragma once

#include <functional>
#include <vector>

#include "libmbd/core/system.hpp"

namespace mbd {

struct ConnectedParts {
  std::vector<int> of_node;   // the part of each node; -1 for the ground
  std::vector<char> is_held;  // by part: an element, joint or motion ties it to the ground
  std::vector<int> first;     // by part: its first node

  int count() const { return static_cast<int>(first.size()); }
  bool any_free() const;  // a part that nothing holds
  bool all_free() const;
};

// `ties`: which batches count; all by default. What acts on single nodes (loads, gravity, drag) ties nothing.
ConnectedParts find_parts(const System& system, const std::function<bool(const Batch&)>& ties = {});

}  // namespace mbd
