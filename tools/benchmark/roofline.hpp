#pragma once

namespace mbd {

// Block LU and its solutions against what this processor can do: Roofline/peak and Roofline/memory, the products of fronts,
// and factorisations and solutions of a chain, a cantilever and frames.
void register_roofline();

}  // namespace mbd
