// Redundant constraints of a compiled scene, told of the joint that made them.
#pragma once

#include "libmbd/front/model.hpp"
#include "solvers/mechanism.hpp"

namespace mbd {

// Redundant constraints cannot be solved yet: throws Error that names the first joint which holds what others
// hold already, those others, and how many rows more there are. Does nothing if there are none.
void refuse_redundant(const Model& model, const Mechanism& mechanism);

}  // namespace mbd
