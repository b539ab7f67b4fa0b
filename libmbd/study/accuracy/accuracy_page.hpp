// A study of accuracy as pictures.
#pragma once

#include <string>

#include "libmbd/scene/scene.hpp"
#include "libmbd/study/accuracy/accuracy.hpp"

namespace mbd {

// Error (rms) against CPU time of the whole run for each quantity, log-log: a curve per family, points below the
// reference's own error hollow, the front of the cheapest, the reference's own error as a level.
std::string accuracy_svg(const AccuracyStudy& study);

// Error against each knob that was varied by number, the others at their finest, with triangles of the fitted slopes.
std::string knobs_svg(const AccuracyStudy& study);

// One HTML page that needs nothing but itself: pictures, what to take for which accuracy with snippets (`scene` is the
// model as it was read), the table of all runs, the reference, the machine. Reads on a phone and in print.
std::string accuracy_page(const AccuracyStudy& study, const Scene& scene);

}  // namespace mbd
