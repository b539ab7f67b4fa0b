// Eigenvalues and mode shapes of small motions (small_motions.hpp): u = Re(x exp(l t)),
//   (l^2 M + l C + K) x + B^T y = 0,   B x = 0.                                                      (1)
// Shift and invert, so that no mass matrix is inverted and multipliers (infinite eigenvalues of (1)) do not take part:
// with x in the null space of B, and w = l x, an operator T on motions,
//   C = 0:  T x = Q(s)^-1 M x,                  1/theta = s^2 - l^2                                  (2)
//   else:   T [x; w] = [x'; x + s x'],  Q(s) x' = -(M w + C x + s M x),   1/theta = l - s            (3)
// Its largest eigenvalues theta belong to the l nearest to s: krylov.hpp, which finds repeated ones as well.
// s = 0, or i times the frequency asked for; small and positive where motions are free, which makes Q(0) singular.
#pragma once

#include <complex>
#include <string>
#include <vector>

#include "solvers/linear/krylov.hpp"
#include "solvers/modes/small_motions.hpp"

namespace mbd {

// A residual beyond this is none of an eigenvalue: about 0 a motion that nothing answers, a free spin, is in each solution to any
// share, and need not be hidden itself.
inline constexpr double blurred = 1e-7;

struct Mode {
  // [1/s]: real part growth (negative: decay), imaginary part frequency [rad/s], not negative: of a conjugate pair one.
  std::complex<double> eigenvalue;
  VecXc
      shape;  // x: increments of the nodes but the ground, body axes [m, rad]; largest displacement or turn of one
  double residual = 0.0;  // |T x - theta x| / |theta x|, T at the shift
  bool rigid = false;     // nothing answers the motion: the eigenvalue is 0
  // Of the eigenvalue, relative: what round-off of the stiffness may have made of it, where that is a sum in which nearly all
  // cancels, as in the bending of a slender beam of very many nodes, times the condition if that is known; or the residual
  // where that is larger and no round-off. An estimate of its size; 0 of a rigid one.
  double round_off = 0.0;
  // Of the eigenvalue (condition.hpp), if it was asked for; 0 of a rigid one.
  double condition = 0.0;

  double frequency()
      const;  // |l|/(2 pi) of an oscillation [Hz], undamped; 0 of what does not oscillate
  double damping_ratio() const;  // -Re l/|l|; of a rigid mode 0
};

// Motions that nothing answers: looked for, and given the eigenvalue 0; or not, where one knows whether there are some, and
// what is near 0 is to be known to its last digit, as near a critical speed.
enum class FreeMotions { looked_for, none, some };

struct ModeOptions {
  int count = 10;     // conjugate pairs count as one
  double near = 0.0;  // [rad/s] modes nearest to this frequency
  // [rad/s] below the frequencies, if they are known about: scales (3), and is the shift where free motions hide modes from 0.
  double expected = 0.0;
  FreeMotions free_motions = FreeMotions::looked_for;
  bool conditions = false;  // of the eigenvalues: where something turns, a factorisation each
};

struct ModesFound {
  std::vector<Mode>
      modes;  // by distance from `near`, the nearest first; fewer than asked for where there are no more
  std::string failure;   // empty: none
  KrylovWork work = {};  // of all shifts that were tried
};

// The `count` eigenvalues nearest to a shift [1/s], or more; of conjugate pairs one. `expected` scales (3), a typical
// frequency [rad/s]. Free motions are not looked for.
ModesFound find_modes_near(MotionPencil& motions, std::complex<double> shift, double expected,
                           int count);

// Modes of what `motions` has been assembled about; its factors are used.
ModesFound find_modes(SmallMotions& motions, const ModeOptions& options);

// Of a dense matrix, all of them. Balanced first (Parlett and Reinsch 1969; James, Langou and Lowery 2014): [0, 1; -M^-1 K, …] has
// numbers of 1 beside some of 1e18. (Eigen's solver takes long to compile: once.)
VecXc eigenvalues_of(Eigen::MatrixXd matrix);

}  // namespace mbd
