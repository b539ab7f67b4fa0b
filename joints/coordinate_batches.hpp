// Batches of the terms on the free coordinate of a joint, each compiled once (elements/node/batches.hpp).
#pragma once

#include "elements/element_batch.hpp"
#include "elements/element_list.hpp"
#include "joints/joint_damper.hpp"
#include "joints/joint_spring.hpp"
#include "joints/joint_torque.hpp"

namespace mbd {

extern template class ElementBatch<joint::JointSpring<joint::Turning>>;
extern template class ElementBatch<joint::JointSpring<joint::Sliding>>;
extern template class ElementBatch<joint::JointDamper<joint::Turning>>;
extern template class ElementBatch<joint::JointDamper<joint::Sliding>>;
extern template class ElementBatch<joint::JointTorque<joint::Turning>>;
extern template class ElementBatch<joint::JointTorque<joint::Sliding>>;

using JointElements =
    ElementList<joint::JointSpring<joint::Turning>, joint::JointSpring<joint::Sliding>,
                joint::JointDamper<joint::Turning>, joint::JointDamper<joint::Sliding>,
                joint::JointTorque<joint::Turning>, joint::JointTorque<joint::Sliding>>;

}  // namespace mbd
