// A System at a State as a mechanism: how many ways it can move, and which constraints say the same twice.
//
// Small motions dU of the nodes (body frames) satisfy B dU = 0, with B the gradient of the constraints
// (NOTATION.md 3). Rows are taken one by one, joints first, then drives and motions, each in the order of the
// scene: redundancy.hpp says when one is redundant. So the later of two joints is blamed.
//
// Not used: the singular values of B, which tell the rank but not which joint is to blame.
#pragma once

#include <vector>

#include "libmbd/core/system.hpp"
#include "solvers/constraints/redundancy.hpp"

namespace mbd {

struct Mechanism {
  Index constraints = 0;                // rows, drives and motions included
  Index held_strains = 0;               // rows within beams
  Index stiff_strains = 0;              // the same, with compliances: they tie nothing
  std::vector<RedundantRow> redundant;  // rows, of the system as it is, beams flexible

  // With every beam as a rigid body:
  // Beams joined at nodes and bodies on their nodes are one part; springs, dampers and bushings join nothing.
  Index rigid_parts = 0;
  Index joint_freedoms = 0;                   // ways to move that the joints leave
  Index prescribed = 0;                       // of these, taken by drives and motions
  std::vector<RedundantRow> rigid_redundant;  // rows; those in `redundant` among them

  Index freedoms() const { return joint_freedoms - prescribed; }
};

// `state` must satisfy the constraints; its multipliers do not matter.
Mechanism analyze_mechanism(const System& system, const State& state);

}  // namespace mbd
