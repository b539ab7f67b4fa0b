// Configurations at which constraints lose rank: a linkage stretched flat, a bar between two pins, joints that would
// open to the second order only.
//
// Let n^T B = 0 at a state (redundancy.hpp), B the gradient of the constraints. If the rank of B is the same all around,
// n goes along with the configuration, and for all motions u, v with B u = B v = 0
//   0 = d(n^T B)[u] v + (dn[u])^T B v = n^T (dB[u]) v.                                              (1)
// Where rank is lost some n of the span breaks (1): what B leaves free to the first order is not what the constraints leave
// free, and motions near the state are not linear (Mueller, "Higher derivatives of the kinematic mapping and some
// applications", Mechanism and Machine Theory 76, 2014). u is a random motion, dB a central difference along it.
// What is compared is n^T dB[u], without what B^T answers, with the sum |n|^T |dB[u]| that it is left of: 1e-11 of it was
// seen of linkages that keep their rank, plates on rods a millionth of their length among them, 0.1 of those that lose it. Of a
// small linkage inside a larger one it is less by their ratio.
// Ranks that are lost to a higher order are looked for by going on along u, a tenth of a mechanism's size or as far as the rows
// that are kept close easily: idle rows open there, as the square of the way at least, if they are no repetition.
// Not seen: by that 1e-9 of a size, and what is 1e8 times smaller than the linkage that it is a part of.
#pragma once

#include <string>

#include "libmbd/core/system.hpp"

namespace mbd {

// Which constraints lose rank at a state that satisfies them, in words; empty if none do. Throws Error as
// find_redundancy() does.
std::string rank_loss(const System& system, const State& state);

}  // namespace mbd
