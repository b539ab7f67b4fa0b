// Where block LU of the symmetric part may work: in what another solver of the same matrix holds (inertia_solver.hpp).
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "libmbd/core/linear_solver.hpp"
#include "solvers/linear/block_columns.hpp"
#include "solvers/linear/inertia_solver.hpp"
#include "solvers/linear/judged_lu.hpp"

namespace mbd {

struct InertiaRoom {
  const BlockGraph* graph = nullptr;
  const BlockColumns* columns = nullptr;
  std::vector<double>* values = nullptr;
  std::span<const Slot> slots = {};
  // Pivots with multipliers merged. Both may be made anew.
  const std::unique_ptr<Prepared>* prepared = nullptr;
  const std::unique_ptr<Judged<double>>* judged = nullptr;
  std::function<void()> taken = {};  // called before values and factors are written over
};

// nullptr if not every block has a mirror image there.
std::unique_ptr<InertiaSolver> make_block_inertia_solver_in(const InertiaRoom& room);

}  // namespace mbd
