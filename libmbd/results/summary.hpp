// What a run prints at its end.
#pragma once

#include <string>

#include "libmbd/results/report.hpp"

namespace mbd {

// For people, in lines of at most 80 columns (longer only where a path or a name is): how far the run
// came and in how many steps, what it cost, how well constraints and energy were kept, notes, expected
// numbers, and where the files are. Of a run that failed also why. Ends with a line break.
std::string summary(const RunReport& report);

}  // namespace mbd
