// The places of a scene, and where they divide its beams.
#pragma once

#include <type_traits>
#include <vector>

#include "libmbd/scene/scene.hpp"

namespace mbd {

// Calls look(place) for every place that an item is at or joins; of a Scene that is not const they may be changed.
template <class SomeScene, class Look>
requires std::is_same_v<std::remove_const_t<SomeScene>, Scene>
void each_place(SomeScene& scene, const Look& look) {
  const auto some = [&](auto& place) {
    if (place) look(*place);
  };
  const auto pairs = [&](auto& items) {
    for (auto& item : items) look(item.a), look(item.b);
  };
  for (auto& body : scene.bodies) some(body.attached_to);
  pairs(scene.joints);
  for (auto& motion : scene.motions) look(motion.of);
  for (auto& load : scene.loads) look(load.at);
  for (auto& mass : scene.point_masses) look(mass.at);
  pairs(scene.springs);
  pairs(scene.bushings);
  for (auto& drag : scene.drags) some(drag.at);
  for (auto& mass : scene.added_masses) some(mass.at);
  for (auto& record : scene.records) some(record.at);
}

// What lies along a part of a beam: from where to where, fractions of its reference length.
struct Part {
  double from = 0.0, to = 1.0;
};
inline Part part_of(const DistributedLoadScene& load) { return {load.from, load.to}; }
inline Part part_of(const DragScene& drag) {
  return {drag.from.value_or(0.0), drag.to.value_or(1.0)};
}
inline Part part_of(const AddedMassScene& mass) {
  return {mass.from.value_or(0.0), mass.to.value_or(1.0)};
}

// Where elements of the beam end, as fractions of its reference length from 0 to 1: its ends, those of `elements` equal
// parts, its places, and the ends of what lies along a part of it.
std::vector<double> element_ends(const Scene& scene, const BeamScene& beam, int elements);

}  // namespace mbd
