// Eigenpairs K x = tau W x of a tangent that need not be symmetric, tau nearest to 0, on the motions that constraints leave; and
// how many of them go through zero from one equilibrium of a path to another.
//
// Where forces have no potential negative eigenvalues cannot be counted by factors, and the sign of a determinant knows only whether
// their number is odd. So the modes nearest to zero of both equilibria are matched by their shapes, W of motion_weights
// (stability.hpp); a real one whose eigenvalue has another sign has gone through zero. Two that meet and become a complex pair, as
// where a column begins to flutter, have not. What cannot be matched is said, and wants a shorter step.
#pragma once

#include <optional>
#include <span>

#include "solvers/statics/stability.hpp"

namespace mbd {

struct NearestModes {
  Eigen::VectorXcd values;   // tau [N.m], the nearest first
  Eigen::MatrixXcd shapes;   // x^H W x = 1, multipliers left out
  int determinant_sign = 0;  // of the tangent with its constraints; 0: not known

  Index negative() const;  // real ones below zero
};

// Of an equilibrium; arguments as of critical_mode(). Empty if the tangent cannot be factored, or none is found.
std::optional<NearestModes> nearest_modes(const System& system, LinearSolver& solver,
                                          const State& state, std::span<const Vec6> resultants,
                                          const Holds& holds);

// How many go through zero, to either side, from one to the other; empty where that cannot be told. (Not by how many more are
// negative: where one loses stability another may gain it.)
std::optional<Index> through_zero(const VecX& weights, const NearestModes& from,
                                  const NearestModes& to);

}  // namespace mbd
