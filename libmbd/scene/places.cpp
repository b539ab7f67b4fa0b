#include "libmbd/scene/places.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libmbd/scene/reference_line.hpp"

namespace mbd {

std::string text_of(const Place& place) {
  if (place.kind == Place::Kind::ground) return "ground";
  if (place.kind == Place::Kind::body) return place.name;
  if (place.parameter == 0.0) return place.name + ".start";
  if (place.parameter == 1.0) return place.name + ".end";
  return fmt::format("{}@{}", place.name, place.parameter);
}

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

namespace {

template <class Groups>
auto group_with(const Groups& groups, std::string_view name) {
  const auto it = std::ranges::find_if(groups, [name](const auto& group) {
    return std::ranges::find(group.of, name) != group.of.end();
  });
  return it == groups.end() ? nullptr : &*it;
}

}  // namespace

const ReductionScene* reduction_with(const Scene& scene, std::string_view name) {
  return group_with(scene.reductions, name);
}

const RigidScene* rigid_with(const Scene& scene, std::string_view name) {
  return group_with(scene.rigids, name);
}

int stated_elements(const Scene& scene, const BeamScene& beam) {
  return beam.elements * static_cast<int>(parts_of(scene, beam).size() - 1);
}

ElementEnds::ElementEnds(const Scene& scene) : scene_(scene) {
  each_node_place(scene, [&](const Place& place) {
    if (place.kind == Place::Kind::beam) places_[place.name].push_back(place.parameter);
  });
  each_kind_along(scene, [&](const auto& items) {
    for (const auto& item : items) {
      const Part part = part_of(item);
      std::vector<double>& places = places_[item.beam];
      places.push_back(part.from);
      places.push_back(part.to);
    }
  });
}

std::vector<double> ElementEnds::of(const BeamScene& beam, int elements) const {
  std::vector<double> ends{0.0};
  const std::vector<double> parts = parts_of(scene_, beam);
  for (std::size_t i = 1; i < parts.size(); ++i)
    for (int e = 1; e <= elements; ++e)
      ends.push_back(e == elements ? parts[i]
                                   : parts[i - 1] + (parts[i] - parts[i - 1]) * e / elements);
  if (const auto own = places_.find(beam.name); own != places_.end())
    for (const double s : own->second) {
      const auto same = [s](double end) { return std::abs(s - end) < same_parameter; };
      if (s >= 0.0 && s <= 1.0 && std::none_of(ends.begin(), ends.end(), same)) ends.push_back(s);
    }
  std::sort(ends.begin(), ends.end());
  return ends;
}

std::vector<double> element_ends(const Scene& scene, const BeamScene& beam, int elements) {
  return ElementEnds(scene).of(beam, elements);
}

}  // namespace mbd
