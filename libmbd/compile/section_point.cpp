#include "libmbd/compile/section_point.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "libmbd/material/shaped_sections.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/text/text.hpp"

namespace mbd {
namespace {

[[noreturn]] void fail(const RecordScene& record, const std::string& what) {
  throw Error(record.source, fmt::format("{}: section_point: {}", label(record), what));
}

// The shape of the section at the place.
const SectionShape& shape_at(const RecordScene& record, const Section& section) {
  if (section.shape) return *section.shape;
  const std::string of = label(section);
  if (section.stations.empty())
    fail(record,
         of + " is stated by matrices, which know no stresses; state it by material and shape");
  const double s = record.at->parameter;
  const auto station = std::ranges::find_if(
      section.stations, [s](const Station& x) { return std::abs(x.at - s) < 1e-12; });
  if (station == section.stations.end())
    fail(record,
         fmt::format("{} varies, and between stations it has no shape; record at one of its "
                     "stations",
                     of));
  if (!station->shape)
    fail(record, of + " is stated by matrices at this station, which know no stresses");
  return *station->shape;
}

}  // namespace

std::shared_ptr<const schema::SectionPointReading> SectionPoints::of(const Scene& scene,
                                                                     const RecordScene& record,
                                                                     const BeamScene& beam) {
  const auto section = std::ranges::find(scene.sections, beam.section, &Section::name);
  const SectionShape& shape = shape_at(record, *section);
  auto& field = fields_[&shape];
  if (!field) field = stress_field(scene, shape, label(*section));
  section::StressField::At at;
  try {
    at = field->recover(section::Point((*record.section_point)[0], (*record.section_point)[1]));
  } catch (const Error& error) {
    fail(record, error.what());
  }
  const section::MeshMaterial& material = field->mesh().material_of(at.element);
  auto reading = std::make_shared<schema::SectionPointReading>();
  reading->strain = at.influence.strain;
  reading->stress = at.influence.stress;
  for (const std::string& name : record.quantities) {
    using Of = schema::Quantity::Of;
    const Of of = schema::find_quantity(schema::place_quantities(), name)->of;
    if (of == Of::section_point_of_plies && !material.strengths)
      fail(record, fmt::format("{} needs strengths Xt Xc Yt Yc SLT STN of material {}{}", name,
                               in_quotes(material.name),
                               material.yield ? ", which is isotropic: record yield_index" : ""));
    if (of == Of::section_point_that_yields && !material.yield)
      fail(record, fmt::format("{} needs the yield stress of material {}, an isotropic one", name,
                               in_quotes(material.name)));
  }
  if (material.strengths) reading->strengths = *material.strengths;
  if (material.yield) reading->yield = *material.yield;
  return reading;
}

}  // namespace mbd
