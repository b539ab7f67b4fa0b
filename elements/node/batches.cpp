#include "elements/node/batches.hpp"

namespace mbd {

template class ElementBatch<Mass>;
template class ElementBatch<MassNoGyroscopic>;
template class ElementBatch<MassDamping>;
template class ElementBatch<NodalGravity>;
template class ElementBatch<BaseMotion>;
template class ElementBatch<PointLoad>;
template class ElementBatch<FollowerLoad>;
template class ElementBatch<DeadForceArm>;
template class ElementBatch<LineDrag<false>>;
template class ElementBatch<LineDrag<true>>;
template class ElementBatch<LineDrag<false, true>>;
template class ElementBatch<LineDrag<true, true>>;
template class ElementBatch<PointDrag<false>>;
template class ElementBatch<PointDrag<true>>;

}  // namespace mbd
