// How far a small change of the forces moves an eigenvalue l of Q(l) x = 0 (motion_pencil.hpp): where they change by e |l|^2 M x,
// or by others of that size in the norm of the mass, l changes by at most
//   |dl|/|l| = e kappa/2,   kappa = 2 |l| |x|_M |y|_M / |y^T (2 l M + C) x|,   Q(l)^T y = 0                       (1)
// (Tisseur, "Backward error and condition of polynomial eigenvalue problems", Lin. Alg. Appl. 309, 2000, in that norm): 1
// where nothing damps, turns or follows, 1/sqrt(1 - zeta^2) of an oscillator with damping, unbounded where two eigenvalues
// become one, as at the onset of flutter or at critical damping. Changes of what has no mass are not seen by it.
#pragma once

#include <vector>

#include "solvers/modes/eigenmodes.hpp"

namespace mbd {

// Sets them: one factorisation each where something turns or follows, or where the last may be repeated by some that were
// not found. The factors of `motions` are used.
void set_conditions(SmallMotions& motions, std::vector<Mode>& modes);

}  // namespace mbd
