// Modes as a table for the terminal, as CSV and as JSON with the shapes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "libmbd/study/modes/modes.hpp"

namespace mbd {

// Digits of a number that round-off, relative to it, leaves, within these bounds; 0: none is known, `most`.
int digits_left(double round_off, int most, int least = 1);

std::string to_text(const ModesStudy& study);

// One row a mode: eigenvalue [1/s], frequency [Hz], damping ratio, orbit, frequency in inertial axes [Hz], residual, name.
std::string to_csv(const ModesStudy& study);

// The same, and of each node its position [m] and orientation (quaternion w x y z) in equilibrium, and by mode its
// displacement [m] and rotation [rad], inertial axes, real and imaginary parts.
std::string to_json(const ModesStudy& study);

// Writes modes.csv and modes.json, and where there is a MAC table mac.csv and mac.json, in the place of those of an earlier
// study. Returns their names. Throws Error, with the file, where one cannot be written.
std::vector<std::string> write_modes(const ModesStudy& study,
                                     const std::filesystem::path& directory);

}  // namespace mbd
