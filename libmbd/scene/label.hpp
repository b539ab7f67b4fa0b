// What messages call an item of a scene: its element and, if it has one, its name.
#pragma once

#include <string>
#include <string_view>

#include "libmbd/scene/scene.hpp"
#include "libmbd/text/text.hpp"

namespace mbd {

// `beam "b1"`, or `gravity` of what has no name.
std::string label(std::string_view element, std::string_view name = {});

// "rod.xml:12: what", as messages begin.
std::string said(const Source& source, const std::string& what);

// "beam", "arc" or "curve"; of a joint its kind.
template <class Item>
std::string_view element_of(const Item&) {
  return Item::item.element;
}
inline std::string_view element_of(const BeamScene& beam) {
  return std::visit([](const auto& line) { return element_of(line); }, beam.line);
}
inline std::string_view element_of(const JointScene& joint) { return joint.kind; }
inline std::string_view element_of(const SectionShape& shape) {
  return SectionShape::kinds[static_cast<std::size_t>(shape.kind)];
}
inline std::string_view element_of(const PathMarkScene& mark) {
  return mark.stops ? "stop" : "mark";
}

template <class Item>
requires(!std::is_convertible_v<Item, std::string_view>) std::string label(const Item& item) {
  if constexpr (requires { item.name; })
    return label(element_of(item), item.name);
  else
    return label(element_of(item));
}

}  // namespace mbd
