#include "solvers/constraints/parts.hpp"

#include <algorithm>

#include "libmbd/core/disjoint_sets.hpp"

namespace mbd {

bool ConnectedParts::any_free() const {
  return std::find(is_held.begin(), is_held.end(), 0) != is_held.end();
}
bool ConnectedParts::all_free() const {
  return std::find(is_held.begin(), is_held.end(), 1) == is_held.end();
}

ConnectedParts find_parts(const System& system, const std::function<bool(const Batch&)>& ties) {
  const auto nodes = static_cast<int>(system.nodes());
  DisjointSets tied(nodes);
  std::vector<char> grounded(static_cast<std::size_t>(nodes), 0);
  const auto first = system.first_contributions();
  const auto& contributions = system.graph().contributions;
  for (std::size_t b = 0; b < system.batches().size(); ++b) {
    if (ties && !ties(*system.batches()[b])) continue;
    for (std::size_t i = first[b]; i < first[b + 1]; ++i) {
      const int p = contributions[i].row + 1, q = contributions[i].column + 1;  // 0: the ground
      if (p >= nodes || q >= nodes || p == q) continue;                         // multipliers
      if (p == 0 || q == 0) {
        grounded[static_cast<std::size_t>(std::max(p, q))] = 1;
        continue;
      }
      tied.join(p, q);
    }
  }
  ConnectedParts parts;
  parts.of_node.assign(grounded.size(), -1);
  for (int n = 1; n < nodes; ++n) {
    const int r = tied.root(n);  // the least of its part
    int& part = parts.of_node[static_cast<std::size_t>(n)];
    if (r == n) {
      part = parts.count();
      parts.first.push_back(n);
      parts.is_held.push_back(0);
    } else {
      part = parts.of_node[static_cast<std::size_t>(r)];
    }
    parts.is_held[static_cast<std::size_t>(part)] |= grounded[static_cast<std::size_t>(n)];
  }
  return parts;
}

}  // namespace mbd
