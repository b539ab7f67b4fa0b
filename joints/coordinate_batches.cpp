#include "joints/coordinate_batches.hpp"

namespace mbd {

template class ElementBatch<joint::JointSpring<joint::Turning>>;
template class ElementBatch<joint::JointSpring<joint::Sliding>>;
template class ElementBatch<joint::JointDamper<joint::Turning>>;
template class ElementBatch<joint::JointDamper<joint::Sliding>>;
template class ElementBatch<joint::JointTorque<joint::Turning>>;
template class ElementBatch<joint::JointTorque<joint::Sliding>>;

}  // namespace mbd
