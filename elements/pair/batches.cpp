#include "elements/pair/batches.hpp"

namespace mbd {

template class ElementBatch<Spring>;
template class ElementBatch<Damper>;
template class ElementBatch<Bushing>;
template class ElementBatch<BushingDamper>;

}  // namespace mbd
