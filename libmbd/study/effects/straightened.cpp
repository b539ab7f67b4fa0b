#include "libmbd/study/effects/straightened.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libmbd/compile/model.hpp"
#include "libmbd/scene/places.hpp"
#include "libmbd/scene/reference_line.hpp"
#include "libmbd/scene/section_table.hpp"

namespace mbd {
namespace {

bool is_taken(const Scene& scene, const std::string& name) {
  bool taken = false;
  each_item(scene, [&]<class T>(const T& item) {
    if constexpr (T::item.names == field::of_sections || T::item.names == field::of_parts)
      taken = taken || item.name == name;
  });
  return taken;
}

// Of the section between two places: linear tables stay what they are.
Section piece_of(const Section& section, double from, double to) {
  const SectionTable table(section);
  Section piece = section;
  piece.stations.clear();
  const auto add = [&](double s) {
    Station station;
    station.source = section.source;
    station.at = (s - from) / (to - from);
    station.stiffness = table.stiffness(s);
    for (Index c = 0; c < 6; ++c)
      if (table.held()[static_cast<std::size_t>(c)])
        station.stiffness(c, c) = std::numeric_limits<double>::infinity();
    if (table.has_mass()) station.mass = table.mass(s);
    piece.stations.push_back(std::move(station));
  };
  add(from);
  for (const Station& station : section.stations)
    if (station.at > from + same_parameter && station.at < to - same_parameter) add(station.at);
  add(to);
  return piece;
}

// Of pieces between `ends`: what lies along the beam from one end to another, piece by piece.
template <class Along>
void divide(std::vector<Along>& items, const std::string& beam, const std::vector<double>& ends,
            const std::vector<std::string>& names) {
  std::vector<Along> divided;
  for (Along& item : items) {
    if (item.beam != beam) {
      divided.push_back(std::move(item));
      continue;
    }
    const Part part = part_of(item);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const double middle = 0.5 * (ends[i] + ends[i + 1]);
      if (middle < part.from || middle > part.to) continue;
      Along piece = item;
      piece.beam = names[i];
      piece.from = 0.0;
      piece.to = 1.0;
      if (!item.name.empty()) piece.name = fmt::format("{}_{}", item.name, i + 1);
      field::each_value(piece, [&](auto& value, const field::About&) {
        if constexpr (std::is_same_v<decltype(value), FieldVector&>)
          for (FieldExpression& one : value) one = one.on_part(ends[i], ends[i + 1]);
      });
      divided.push_back(std::move(piece));
    }
  }
  items = std::move(divided);
}

}  // namespace

std::string free_name(const Scene& scene, std::string name) {
  while (is_taken(scene, name)) name += "_";
  return name;
}

bool can_be_straightened(const Scene& scene, const BeamScene& beam) {
  if (std::holds_alternative<Straight>(beam.line) || rigid_with(scene, beam.name) != nullptr ||
      reduction_with(scene, beam.name) != nullptr)
    return false;
  const Section* const section = section_of(scene, beam);
  if (section == nullptr || beam.elements < 1) return false;
  if (!section->stations.empty() && section->interpolation == Interpolation::smooth) return false;
  const ReferenceLine line = make_reference_line(beam);
  const auto start = line.at(0.0).p;
  constexpr int samples = 16;  // of a curve that may be straight
  for (int i = 1; i <= samples; ++i)
    if (start.angularDistance(line.at(static_cast<double>(i) / samples).p) > 1e-9) return true;
  return false;
}

std::vector<std::string> names_of_pieces(const Scene& scene, const BeamScene& beam) {
  const std::size_t pieces = element_ends(scene, beam, beam.elements).size() - 1;
  std::vector<std::string> names;
  for (std::size_t i = 1; i <= pieces; ++i)
    names.push_back(free_name(scene, fmt::format("{}_{}", beam.name, i)));
  return names;
}

void straighten(Scene& scene, const std::string& name) {
  const auto it = std::find_if(scene.beams.begin(), scene.beams.end(),
                               [&](const BeamScene& b) { return b.name == name; });
  const BeamScene beam = *it;
  const std::vector<double> ends = element_ends(scene, beam, beam.elements);
  const std::vector<std::string> names = names_of_pieces(scene, beam);
  const ReferenceLine line = make_reference_line(beam);
  const Section section = *section_of(scene, beam);

  std::vector<BeamScene> pieces;
  for (std::size_t i = 0; i < names.size(); ++i) {
    BeamScene piece = beam;
    piece.name = names[i];
    piece.line = Straight{line.at(ends[i]).r, line.at(ends[i + 1]).r};
    piece.normal = line.at(0.5 * (ends[i] + ends[i + 1])).R().col(2);
    piece.elements = 1;
    piece.mesh = Mesh::equal;
    if (!section.stations.empty()) {
      scene.sections.push_back(piece_of(section, ends[i], ends[i + 1]));
      scene.sections.back().name = piece.section =
          free_name(scene, fmt::format("{}_{}", section.name, names[i]));
    }
    pieces.push_back(std::move(piece));
  }
  scene.beams.insert(scene.beams.erase(scene.beams.begin() + (it - scene.beams.begin())),
                     pieces.begin(), pieces.end());

  each_place(scene, [&](Place& place) {
    if (place.kind != Place::Kind::beam || place.name != name) return;
    std::size_t end = 0;  // the nearest, which is the place but of records
    for (std::size_t i = 1; i < ends.size(); ++i)
      if (std::abs(ends[i] - place.parameter) < std::abs(ends[end] - place.parameter)) end = i;
    if (std::abs(ends[end] - place.parameter) < same_parameter) {
      place.name = names[end == 0 ? 0 : end - 1];
      place.parameter = end == 0 ? 0.0 : 1.0;
      return;
    }
    const std::size_t piece = ends[end] < place.parameter ? end : end - 1;
    place.name = names[piece];
    place.parameter = (place.parameter - ends[piece]) / (ends[piece + 1] - ends[piece]);
  });
  each_kind_along(scene, [&](auto& items) { divide(items, name, ends, names); });
  if (scene.modes)
    if (auto& at_rest = scene.modes->at_rest; std::erase(at_rest, name) > 0)
      at_rest.insert(at_rest.end(), names.begin(), names.end());
  for (std::size_t i = 0; i + 1 < names.size(); ++i) {
    JointScene joint;
    joint.source = beam.source;
    joint.kind = "fixed";
    joint.name = free_name(scene, fmt::format("{}_to_{}", names[i], i + 2));
    joint.a = {Place::Kind::beam, names[i], 1.0};
    joint.b = {Place::Kind::beam, names[i + 1], 0.0};
    scene.joints.push_back(std::move(joint));
  }
}

}  // namespace mbd
