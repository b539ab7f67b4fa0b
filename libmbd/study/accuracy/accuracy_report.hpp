// A study of accuracy as text and data.
#pragma once

#include <string>

#include "libmbd/study/accuracy/accuracy.hpp"

namespace mbd {

// For the terminal: what was done, the reference and its own error, for each quantity a table of the runs on the front
// (error, CPU, setting), fitted orders, and what to take for each power of ten reached; with the scene, as it was
// read, also the snippets.
std::string to_text(const AccuracyStudy& study);
std::string to_text(const AccuracyStudy& study, const Scene& scene);

// A line for each trial: knobs, completeness, CPU times, memory, counters, rms and largest error of each quantity,
// whether they are below the reference's own, and whether the trial is on the front. Comments (#) name model, machine,
// reference, norms and units. What is not known is empty; cells with commas, quotes or line breaks are in quotes.
std::string to_csv(const AccuracyStudy& study);

std::string to_json(const AccuracyStudy& study);  // everything but the rows of the runs

// For models/README.md, without a heading: what was done in a line, the sentences as a list, the reference, notes.
std::string to_markdown(const AccuracyStudy& study);

// "C.displacement to 1e-4: order 3, 2/4/2 elements, radau, tolerance 1e-05: 0.9 s"; where its errors are known only to
// some time, "C.displacement up to time 7 s of 36 s to 1e-4: …".
std::string sentence(const AccuracyStudy& study, const Advice& advice);

}  // namespace mbd
