// Stresses at a point of a section that is recorded: what a record's section_point means in its beam's section.
#pragma once

#include <map>
#include <memory>

#include "libmbd/language/quantities.hpp"
#include "libmbd/section/stress.hpp"

namespace mbd {

class SectionPoints {
 public:
  // Throws Error in the name of the record where its section has no shape or varies, the point lies outside or between
  // plies, or the material there has no strengths that a quantity needs. A section is analysed once more, for all records of it.
  std::shared_ptr<const schema::SectionPointReading> of(const Scene& scene,
                                                        const RecordScene& record,
                                                        const BeamScene& beam);

 private:
  std::map<const SectionShape*, std::shared_ptr<const section::StressField>> fields_;
};

}  // namespace mbd
