#include "libmbd/scene/places.hpp"

#include <algorithm>
#include <cmath>

#include "libmbd/scene/reference_line.hpp"

namespace mbd {

namespace {

// Where the parts end that `elements` divides.
std::vector<double> parts_of(const Scene& scene, const BeamScene& beam) {
  if (beam.mesh == Mesh::stations)
    if (const Section* const section = section_of(scene, beam);
        section != nullptr && section->stations.size() > 1) {
      std::vector<double> at;
      for (const Station& station : section->stations) at.push_back(station.at);
      return at;
    }
  return {0.0, 1.0};
}

}  // namespace

const Section* section_of(const Scene& scene, const BeamScene& beam) {
  for (const Section& section : scene.sections)
    if (section.name == beam.section) return &section;
  return nullptr;
}

int stated_elements(const Scene& scene, const BeamScene& beam) {
  return beam.elements * static_cast<int>(parts_of(scene, beam).size() - 1);
}

std::vector<double> element_ends(const Scene& scene, const BeamScene& beam, int elements) {
  std::vector<double> ends{0.0};
  const std::vector<double> parts = parts_of(scene, beam);
  for (std::size_t i = 1; i < parts.size(); ++i)
    for (int e = 1; e <= elements; ++e)
      ends.push_back(e == elements ? parts[i]
                                   : parts[i - 1] + (parts[i] - parts[i - 1]) * e / elements);
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
