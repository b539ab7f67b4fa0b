#include "libmbd/front/places.hpp"

#include <algorithm>
#include <cmath>

#include "libmbd/front/reference_line.hpp"

namespace mbd {

std::vector<double> element_ends(const Scene& scene, const BeamScene& beam, int elements) {
  std::vector<double> ends;
  for (int e = 0; e <= elements; ++e) ends.push_back(static_cast<double>(e) / elements);
  const auto add = [&](double s) {
    const auto same = [s](double end) { return std::abs(s - end) < same_parameter; };
    if (s >= 0.0 && s <= 1.0 && std::none_of(ends.begin(), ends.end(), same)) ends.push_back(s);
  };
  each_place(scene, [&](const Place& place) {
    if (place.kind == Place::Kind::beam && place.name == beam.name) add(place.parameter);
  });
  const auto add_part = [&](const std::string& along, double from, double to) {
    if (along == beam.name) add(from), add(to);
  };
  for (const DistributedLoadScene& l : scene.distributed_loads) add_part(l.beam, l.from, l.to);
  for (const DragScene& d : scene.drags) add_part(d.beam, d.from.value_or(0.0), d.to.value_or(1.0));
  for (const AddedMassScene& m : scene.added_masses)
    add_part(m.beam, m.from.value_or(0.0), m.to.value_or(1.0));
  std::sort(ends.begin(), ends.end());
  return ends;
}

}  // namespace mbd
