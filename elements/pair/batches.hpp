// Batches of the terms between two nodes, each compiled once: with the kernels optimised as they must be, and not in every file that
// makes one.
#pragma once

#include "elements/element_batch.hpp"
#include "elements/element_list.hpp"
#include "elements/pair/bushing.hpp"
#include "elements/pair/bushing_damper.hpp"
#include "elements/pair/damper.hpp"
#include "elements/pair/spring.hpp"

namespace mbd {

extern template class ElementBatch<Spring>;
extern template class ElementBatch<Damper>;
extern template class ElementBatch<Bushing>;
extern template class ElementBatch<BushingDamper>;

using PairElements = ElementList<Spring, Damper, Bushing, BushingDamper>;

}  // namespace mbd
