// What the accuracy of a section's D costs: mbd section --accuracy.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "libmbd/scene/scene.hpp"

namespace mbd {

// Of a section, or one station of it.
struct SectionAccuracy {
  std::string section;
  std::optional<double> at;  // of a station
  std::string from;          // its shape, and where it is stated

  // One mesh and the analysis on it. Errors are the largest of an entry ij of D over sqrt(Dii Djj).
  struct Trial {
    int order = 0,
        layers = 0;  // of elements; how often they shrink towards corners and ends of plies
    int elements = 0, unknowns = 0;
    double seconds = 0.0;  // of CPU time
    double error = 0.0;    // against the finest
    std::optional<double>
        believed;  // what the program estimates, where it would: from two meshes before
  };
  std::vector<Trial> trials;  // by their unknowns; the last is the finest, whose error is 0
  int not_tried = 0;          // for want of time
  // The trial that is the cheapest of those whose error is below 1e-2, 1e-3, ... 1e-6 and above three times what the
  // finest is believed to: places in `trials`, none where there is none.
  struct Goal {
    double error;
    std::optional<std::size_t> cheapest;
  };
  std::vector<Goal> goals;
};

// Of the section of that name, or (empty) of all that have a shape. First the program's own meshes, until the largest
// estimate is below 1e-8 or half of `budget` (seconds each) is used up; then others by order and layers, no dearer than
// the finest. Throws Error where there is no such section or none with a shape, and as analysed() does.
std::vector<SectionAccuracy> section_accuracy(const Scene& scene, const std::string& name,
                                              double budget);

std::string to_text(const SectionAccuracy& report);
std::string to_json(const std::vector<SectionAccuracy>& reports);
// A row for each trial: section, at, order, layers, elements, unknowns, seconds, error, believed.
std::string to_csv(const std::vector<SectionAccuracy>& reports);

}  // namespace mbd
