// A study of accuracy as text and data.
#pragma once

#include <string>

#include "libmbd/study/accuracy.hpp"

namespace mbd {

// For the terminal: what was done, the reference and its own error, for each quantity a table of the runs on the front
// (accuracy, CPU, setting), fitted orders, and what to take for each power of ten reached, with the snippet.
std::string to_text(const AccuracyStudy& study);

// A line for each trial: knobs, completeness, CPU times, memory, counters, rms and largest error of each quantity and
// whether they are below the reference's own. Comments (#) name model, machine, reference, norms and units.
std::string to_csv(const AccuracyStudy& study);

std::string to_json(const AccuracyStudy& study);  // everything but the rows of the runs

// "C.displacement to 1e-4: order 3, 2/4/2 elements, radau, tolerance 1e-05: 0.9 s".
std::string sentence(const AccuracyStudy& study, const Advice& advice);

}  // namespace mbd
