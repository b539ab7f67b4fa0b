// Orders of elimination by nested dissection: METIS 5 (Karypis & Kumar 1998, Apache-2.0).
#pragma once

#include <vector>

namespace mbd {

// Symmetric, each vertex with its neighbours at neighbours[begin[v]] to neighbours[begin[v + 1]].
struct QuotientGraph {
  std::vector<int> names;  // of the vertices, for whom they belong to
  std::vector<int> weights;
  std::vector<int> begin, neighbours;
};

// The names of the vertices in the order of elimination. Empty where METIS is not installed, or finds none. The same in
// every run; of two threads one waits.
std::vector<int> dissect(const QuotientGraph& graph);

}  // namespace mbd
