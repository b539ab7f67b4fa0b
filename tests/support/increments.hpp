// States that tests move at random, by all unknowns of a system.
#pragma once

#include "libmbd/core/system.hpp"
#include "solvers/statics/equilibrium.hpp"
#include "tests/support/random.hpp"

namespace mbd::test {

// Every node but the ground by a motion of up to `size` in each component [m, rad].
inline void move_at_random(State& state, Rng& rng, double size) {
  for (std::size_t n = 1; n < state.pose.size(); ++n) {
    Pose<double>& H = state.pose[n];
    H = H * exp_se3<double>(random_vector<6>(rng, size));
    renormalize(H);
  }
}

// `by` times the increments x of all unknowns.
inline State moved_by(const System& system, State state, const VecX& x, double by) {
  retract(system, state, x, by);
  return state;
}

inline VecX random_increment(const System& system, Rng& rng) {
  VecX x(system.unknowns());
  for (Index i = 0; i < x.size(); ++i) x(i) = uniform(rng, -1.0, 1.0);
  return x;
}

}  // namespace mbd::test
