// Scalar sparse LU (KLU with AMD ordering, LGPL) behind the block interface.
#pragma once

#include <memory>

#include "libmbd/core/linear_solver.hpp"

namespace mbd {

std::unique_ptr<LinearSolver> make_klu_solver();

}  // namespace mbd
