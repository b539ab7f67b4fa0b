// What round-off of places leaves of sectional forces that are unknowns beside their strains (elements/beam/held_strains.hpp).
#pragma once

#include <optional>

#include "libmbd/core/system.hpp"

namespace mbd {

// Largest change of a multiplier [N, moments over the scene's length] when the strains of beams that give way by a compliance are
// off by the round-off of places, of either sign: forces that follow from equilibrium do not change, those that strains determine
// do. At an equilibrium; none where there are no such strains, or the tangent is singular.
std::optional<double> round_off_of_forces(const System& system, const State& state);

}  // namespace mbd
