// In which order the blocks of a matrix are eliminated, and what that fills: minimum degree (Amestoy, Davis & Duff 1996,
// approximate external degrees, weighted by the sizes of blocks) on the quotient graph of its blocks, symmetrically.
//
// A multiplier has no pivot of its own: it is eliminated after all its nodes (nodes_first), whose mass then gives it one,
//   0 - B M^-1 B^T,
// or it shares the pivot of one of its nodes (merged), as long as that has at most six rows of multipliers; what finds no
// such node comes after its nodes. The first asks for nodes with mass or stiffness of their own, however much has been
// eliminated before, the second for joints that hold what hangs on them.
#pragma once

#include <vector>

#include "libmbd/core/linear_solver.hpp"

namespace mbd {

enum class PivotOrder { nodes_first, merged };

struct Elimination {
  struct Pivot {
    int first_member = 0, members = 0;  // in `members`: the blocks of this pivot
    int size = 0;                       // unknowns
    bool merged = false;                // a node and multipliers
  };
  std::vector<Pivot> pivots;  // in the order of elimination
  std::vector<int> members;
  std::vector<int> pivot_of;  // by block
  std::vector<int> place_of;  // by block: its first unknown within the pivot
  // Of each pivot p: what remains to be eliminated and is coupled with it, rising; below[begin[p]] to below[begin[p + 1]].
  std::vector<std::size_t> begin;
  std::vector<int> below;
  double flops = 0.0;  // of a factorisation
};

Elimination eliminate(const BlockGraph& graph, PivotOrder order);

}  // namespace mbd
