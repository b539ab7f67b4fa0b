// Counts the negative eigenvalues of a symmetric system by a sparse LDL^T with 1x1 and 2x2 pivots (MUMPS,
// CeCILL-C), behind the block interface: Sylvester's law of inertia.
#pragma once

#include <memory>
#include <optional>

#include "libmbd/core/linear_solver.hpp"

namespace mbd {

class InertiaSolver : public LinearSolver {
 public:
  // Negative eigenvalues of the symmetric part of what was last factored; empty if the factorisation
  // failed, as it does within round-off of a singular matrix.
  virtual std::optional<Index> negative_eigenvalues() const = 0;

  // max |S_ij - S_ji| / max |S_ij| of what was last factored, over the node-node blocks.
  virtual double asymmetry() const = 0;
};

std::unique_ptr<InertiaSolver> make_inertia_solver();

// The same by the pivots of block LU (block_lu.hpp) of the symmetric part, an eighth of MUMPS' time and less. Where these are
// within 1e-11 of singular, or refinement of solutions by them hardly converges, it asks MUMPS.
std::unique_ptr<InertiaSolver> make_block_inertia_solver();
// The same in the room of `solver`, which has been analysed: slots are its own, and it has to be filled and factored again
// after this one was. Valid until it is analysed again. nullptr where that is not one of block LU with merged multipliers.
std::unique_ptr<InertiaSolver> make_block_inertia_solver_in(LinearSolver& solver);

}  // namespace mbd
