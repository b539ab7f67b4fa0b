// A section with its stresses or its warping as colours.
#pragma once

#include <optional>
#include <string>

#include "libmbd/run/describe_stress.hpp"

namespace mbd {

// SVG of a section that is stated by material, under resultants; b2 to the right, b3 up, one scale. `quantity` is one of
// stress_quantities(), components with their sign, or warping: displacement along b1 [m]. Cells of elements have the value
// at their middle; material without the quantity is grey. Throws Error as describe_stress(), and for other quantities.
std::string section_picture(const Scene& scene, const std::string& section,
                            std::optional<double> station, const SectionLoad& load,
                            const std::string& quantity);

}  // namespace mbd
