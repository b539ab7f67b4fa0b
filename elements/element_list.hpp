// The kinds of elements whose nodes have places of their own, by how many nodes they touch: what is to hold for every one
// of them goes through these lists (tests/elements/test_laws.cpp). Beams, of which there is one kernel for each metric, form
// and order, are listed where they are made (elements/beam); terms on the coordinates of joints in joints/coordinate_batches.hpp.
#pragma once

#include "elements/node/batches.hpp"
#include "elements/pair/batches.hpp"

namespace mbd {

template <class... E>
struct ElementList {
  static_assert((Element<E> && ...));
};

using NodalElements =
    ElementList<Mass, MassNoGyroscopic, MassDamping, NodalGravity, BaseMotion, PointLoad,
                FollowerLoad, DeadForceArm, LineDrag<false>, LineDrag<true>, LineDrag<false, true>,
                LineDrag<true, true>, PointDrag<false>, PointDrag<true>>;
using PairElements = ElementList<Spring, Damper, Bushing, BushingDamper>;

}  // namespace mbd
