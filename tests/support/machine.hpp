// How slow this machine is, for the clocks that guard against hanging: no test states anything of speed.
#pragma once

#include <cmath>

namespace mbd::test {

// CPU time of some fixed arithmetic over that of a quick machine, as this program is built; at least 1. Measured once.
double machine_factor();

// A guard of that many seconds on a quick machine: at least twenty times what is guarded needs there. More on a slow one.
inline double guard(double seconds) { return seconds * machine_factor(); }
inline int whole_guard(double seconds) { return static_cast<int>(std::ceil(guard(seconds))); }

// Of a study or a trial that a test lets end by itself [s]: less than any budget that may be given, and never used up.
inline constexpr double no_limit = 1e6;

}  // namespace mbd::test
