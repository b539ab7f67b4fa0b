// A study of effects as text, data and pictures.
#pragma once

#include <string>

#include "libmbd/study/effects/effects.hpp"

namespace mbd {

// For the terminal: the whole model, a table of the effects (largest change and of which quantity, CPU time saved, what was
// left out), the cheapest model within the tolerance with its snippet.
std::string to_text(const EffectsStudy& study);

// "shear flexibility (stiffened 1000 times): 4 % of the time, changes tip.displacement by 2e-6".
std::string sentence(const EffectsStudy& study, const EffectRun& run);

// A line for each effect: completeness, CPU ratios (median, least, most), instructions, steps, unknowns, memory, and of
// each quantity rms and largest change. Comments (#) name model, machine, norm, tolerance and the cheapest model. What is
// not known is empty; cells with commas or quotes are in quotes.
std::string to_csv(const EffectsStudy& study);

std::string to_json(const EffectsStudy& study);

// For models/README.md, without a heading: table of the effects, the cheapest model, notes.
std::string to_markdown(const EffectsStudy& study);

// A bar for each effect: what it changes (logarithmic, with the tolerance), and the share of CPU time it takes.
std::string effects_svg(const EffectsStudy& study);

// One HTML page that needs nothing but itself: the picture, the table of all quantities, the cheapest model, the machine.
std::string effects_page(const EffectsStudy& study);

}  // namespace mbd
