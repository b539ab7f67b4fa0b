// States that tests move at random, by all unknowns of a system.
#pragma once

#include "libmbd/core/system.hpp"
#include "solvers/statics/equilibrium.hpp"
#include "tests/support/dense_solver.hpp"
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

// The tangent of statics, and the residual r that goes with it.
inline Eigen::MatrixXd dense_tangent(const System& system, const State& state, VecX& r) {
  DenseSolver solver;
  solver.analyze(system.graph());
  system.linearize(state, {}, r, solver);
  return solver.matrix();
}

// The derivative of the residual along the increments x, by differences of sixth order.
inline VecX slope_along(const System& system, const State& state, const VecX& x) {
  const auto along = [&](double by) {
    VecX there;
    system.residual(moved_by(system, state, x, by), there);
    return VecX(there.tail(system.unknowns()));
  };
  constexpr double h = 5e-3;
  return (45.0 * (along(h) - along(-h)) - 9.0 * (along(2 * h) - along(-2 * h)) +
          (along(3 * h) - along(-3 * h))) /
         (60.0 * h);
}

}  // namespace mbd::test
