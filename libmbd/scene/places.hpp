// The places of a scene, and where they divide its beams.
#pragma once

#include <string>
#include <string_view>
#include <type_traits>
#include <unordered_map>
#include <vector>

#include "libmbd/scene/scene.hpp"

namespace mbd {

// As models write it: "ground", "top", "bar2.end", "bar2@0.5".
std::string text_of(const Place& place);

// Calls look(place) for every place that an item is at or joins; of an item that is not const they may be changed.
template <class Item, class Look>
void each_place_of(Item& item, const Look& look) {
  field::each_value(item, [&look]<class Value>(Value& value, const field::About&) {
    if constexpr (std::is_same_v<std::remove_const_t<Value>, Place>) look(value);
  });
}

template <class SomeScene, class Look>
requires std::is_same_v<std::remove_const_t<SomeScene>, Scene>
void each_place(SomeScene& scene, const Look& look) {
  each_item(scene, [&look](auto& item) { each_place_of(item, look); });
}

// Of those that need a node: where something acts, moves or joins. Records look between nodes too.
template <class Look>
void each_node_place(const Scene& scene, const Look& look) {
  each_item(scene, [&look]<class Item>(const Item& item) {
    if constexpr (!std::is_same_v<Item, RecordScene>) each_place_of(item, look);
  });
}

// What lies along a part of a beam: from where to where, fractions of its reference length.
struct Part {
  double from = 0.0, to = 1.0;
};
inline double value_or(double value, double) { return value; }
inline double value_or(const std::optional<double>& value, double other) {
  return value.value_or(other);
}
template <class Along>
Part part_of(const Along& along) {
  return {value_or(along.from, 0.0), value_or(along.to, 1.0)};
}

// Calls f with the items of each kind that may lie along a beam.
template <class SomeScene, class F>
void each_kind_along(SomeScene& scene, const F& f) {
  each_kind(scene, [&f]<class Items>(Items& items) {
    if constexpr (requires(typename Items::value_type item) { item.beam; }) f(items);
  });
}

// The section that the beam names; nullptr: there is none.
const Section* section_of(const Scene& scene, const BeamScene& beam);

// The reduction that the beam or body of that name is part of, or that makes it rigid; nullptr: none.
const ReductionScene* reduction_with(const Scene& scene, std::string_view name);
const RigidScene* rigid_with(const Scene& scene, std::string_view name);

// How many elements the beam states, before its places add some.
int stated_elements(const Scene& scene, const BeamScene& beam);

// Where elements end, of many beams: the places of the scene, which must outlive it, are looked through once.
class ElementEnds {
 public:
  explicit ElementEnds(const Scene& scene);
  std::vector<double> of(const BeamScene& beam, int elements) const;  // as element_ends

 private:
  const Scene& scene_;
  std::unordered_map<std::string_view, std::vector<double>> places_;  // by beam
};

// Where elements of the beam end, as fractions of its reference length from 0 to 1: its ends, those of the equal parts
// of its mesh with `elements` for the number that it states, its places but those of records, and the ends of what lies
// along a part of it.
std::vector<double> element_ends(const Scene& scene, const BeamScene& beam, int elements);

}  // namespace mbd
