#include "libmbd/scene/places.hpp"

#include <algorithm>
#include <cmath>

#include "libmbd/scene/reference_line.hpp"

namespace mbd {

std::vector<double> element_ends(const Scene& scene, const BeamScene& beam, int elements) {
  std::vector<double> ends;
  for (int e = 0; e <= elements; ++e) ends.push_back(static_cast<double>(e) / elements);
  const auto add = [&](double s) {
    const auto same = [s](double end) { return std::abs(s - end) < same_parameter; };
    if (s >= 0.0 && s <= 1.0 && std::none_of(ends.begin(), ends.end(), same)) ends.push_back(s);
  };
  each_node_place(scene, [&](const Place& place) {
    if (place.kind == Place::Kind::beam && place.name == beam.name) add(place.parameter);
  });
  each_kind_along(scene, [&](const auto& items) {
    for (const auto& item : items) {
      if (item.beam != beam.name) continue;
      const Part part = part_of(item);
      add(part.from);
      add(part.to);
    }
  });
  std::sort(ends.begin(), ends.end());
  return ends;
}

}  // namespace mbd
