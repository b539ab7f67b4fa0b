// Batches of the terms on one node, each compiled once: with the kernels optimised as they must be, and not in every file that
// makes one.
#pragma once

#include "elements/element_batch.hpp"
#include "elements/element_list.hpp"
#include "elements/node/base_motion.hpp"
#include "elements/node/drag.hpp"
#include "elements/node/gravity.hpp"
#include "elements/node/mass.hpp"
#include "elements/node/mass_damping.hpp"
#include "elements/node/point_load.hpp"

namespace mbd {

extern template class ElementBatch<Mass>;
extern template class ElementBatch<MassNoGyroscopic>;
extern template class ElementBatch<MassDamping>;
extern template class ElementBatch<NodalGravity>;
extern template class ElementBatch<BaseMotion>;
extern template class ElementBatch<PointLoad>;
extern template class ElementBatch<FollowerLoad>;
extern template class ElementBatch<DeadForceArm>;
extern template class ElementBatch<LineDrag<false>>;
extern template class ElementBatch<LineDrag<true>>;
extern template class ElementBatch<LineDrag<false, true>>;
extern template class ElementBatch<LineDrag<true, true>>;
extern template class ElementBatch<PointDrag<false>>;
extern template class ElementBatch<PointDrag<true>>;

using NodalElements =
    ElementList<Mass, MassNoGyroscopic, MassDamping, NodalGravity, BaseMotion, PointLoad,
                FollowerLoad, DeadForceArm, LineDrag<false>, LineDrag<true>, LineDrag<false, true>,
                LineDrag<true, true>, PointDrag<false>, PointDrag<true>>;

}  // namespace mbd
