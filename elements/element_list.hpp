// Lists of kinds of elements: what is to hold for every one of them goes through these (tests/elements/test_laws.cpp). They
// stand where their batches do: elements/node, elements/pair, joints/coordinate_batches.hpp. Of beams there is one kernel
// for each metric, form and order, listed where they are made (elements/beam).
#pragma once

#include "elements/element.hpp"

namespace mbd {

template <class... E>
struct ElementList {
  static_assert((Element<E> && ...));
};

}  // namespace mbd
