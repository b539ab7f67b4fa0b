// In which order the blocks of a matrix are eliminated, and what that fills: minimum degree (Amestoy, Davis & Duff 1996,
// approximate external degrees, weighted by the sizes of blocks) on the quotient graph of its blocks, symmetrically. Where
// that takes many flops, what is left when the insides of beams and chains are gone is also ordered by nested dissection
// (dissection.hpp), and the order with fewer flops is taken: of plane frames of 4e4 beams it saves a sixth, of space frames
// of 2.6e4 two fifths, of smaller ones little.
//
// In large systems pivots that have nearly the same blocks below make a front: a dense matrix (fronts.hpp). What lies
// above a front is in fronts too.
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
  // Pivots first to last - 1 of one front, rising. Below each of them are all that follow in it, and what is below the last.
  struct Front {
    int first = 0, last = 0;
  };
  std::vector<Front> fronts;
  double flops = 0.0;        // of a factorisation
  double front_flops = 0.0;  // of these, in fronts
  bool dissected = false;    // the order is that of METIS
};

// From where on what is for large systems is worth it, by measurement (ENGINE.md); others for tests.
struct EliminationChoices {
  double dissection_flops =
      4e9;  // of the order by degree: METIS takes as long as a tenth of such a factorisation
  double front_flops = 1e8;  // of the order taken
  int front_width = 48;      // unknowns
};

Elimination eliminate(const BlockGraph& graph, PivotOrder order,
                      const EliminationChoices& choices = {});

}  // namespace mbd
