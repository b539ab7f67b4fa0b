// Redundant constraints of a compiled scene, told of the joints that made them.
#pragma once

#include <string>
#include <vector>

#include "libmbd/compile/model.hpp"

namespace mbd {

// Throws Error if what is prescribed cannot be reconciled with the constraints it depends on: a drive of what joints
// hold, or of a mechanism in a lock; two laws for one motion that differ in their accelerations at the start. What
// parts later is found by the run. `initial` satisfies the constraints.
void refuse_contradictions(const Scene& scene, const System& system, const State& initial,
                           const std::vector<Model::Maker>& makers, const Redundancy& redundancy);

// For reports: which joints repeat which, one sentence for each joint that is blamed; empty if none.
std::vector<std::string> repetitions(const Model& model);

}  // namespace mbd
