// Static equilibrium by load stepping: one load factor over every load, from 0 to 1.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "libmbd/core/system.hpp"
#include "solvers/newton/report.hpp"

namespace mbd {

struct StaticOptions {
  int steps = 1;  // first load increment is 1/steps; halved on failure, grown when easy
  NewtonOptions newton;
  StaticSolver solver = StaticSolver::newton;
  // Shown each equilibrium found, in order of its load factor, the last at 1. False ends the solution
  // there.
  std::function<bool(const State&)> accepted = {};
};

struct StaticReport {
  bool converged = false;
  double load_factor = 0.0;  // reached
  Counters counters;
  int most_iterations = 0;  // in one accepted load step
  int searched = 0;         // load steps that the line search saved
  std::vector<std::string>
      neutral;          // motions of the last equilibrium that nothing answers, in words
  std::string failure;  // when not converged; empty if `accepted` ended it
};

// Moves `state` to equilibrium at state.t. On failure it is the last equilibrium found.
StaticReport solve_statics(const System& system, LinearSolver& solver, const StaticOptions& options,
                           State& state);

}  // namespace mbd
