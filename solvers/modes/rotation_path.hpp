// Steady rotations over their rate: a rotor out of balance, or one that stiffens as it bends, may turn in several shapes at one
// rate, which folds of one path join, or nothing does.
//
// A point is x = (U, lambda, p), r(x) = 0 of steady_rotation.hpp, its parameter p an unknown: the rate W, or at one rate the share
// of a force F that pushes, r - p F = 0, whose path leads from one rotation to others, where p = 0 again. With K of (1) there, and
// f = dr/dp, the tangent t is along (-K^-1 f, 1), of length 1 in
//   |x|^2 = U^T M U + (c p)^2,                                                                        (1)
// M the weights of motion_weights(), the range of the parameter as long as 0.3 of the scene. A step predicts x + h t, and corrects
// in the plane across t (Keller 1977): dx = a + b dp, a = -K^-1 r, b = -K^-1 f, t^T dx = 0. What is singular at a fold is K and
// not the path; K itself is met to round-off only.
#pragma once

#include <functional>
#include <string>

#include "solvers/modes/steady_rotation.hpp"

namespace mbd {

struct RotationPoint {
  const State& state;
  double parameter = 0.0;  // W [rad/s], or p [-]
  double arc = 0.0;        // length of the path from its start, (1)
  bool is_fold = false;  // the parameter turns back here; such a point lies between two of the path
};

struct RotationPathOptions {
  double from = 0.0, to = 0.0;  // of the parameter, from < to; rates are not negative
  bool rising = true;           // sense of the parameter at the start
  double largest_step = 0.02;   // of the parameter, part of its range
  double most_moved = 0.3;      // in a step: mean over the nodes, of the scene's length or in rad
  int points = 500;             // at most
  int retries = 1000;           // steps cut, at most
  NewtonOptions newton = {};
  std::function<bool(const RotationPoint&)> accepted =
      {};  // in order, the start left out; false ends it
};

struct RotationPathReport {
  std::string end;  // why it ends, in words
  Counters counters;
};

// From a steady rotation at `start.rate`, which `state` is in. Leaves `motions` assembled about some point of it.
RotationPathReport follow_rotations(SmallMotions& motions, const SteadyRotation& start,
                                    const State& state, const RotationPathOptions& options);

// At the rate of `start`, pushed by a force on the motions, body axes of the nodes [N, N.m]. Folds are not located.
RotationPathReport follow_pushed_rotations(SmallMotions& motions, const SteadyRotation& start,
                                           const State& state, const VecX& force,
                                           const RotationPathOptions& options);

// Distance (1) of motion alone: mean over the nodes of displacements over the scene's length, and of turns [rad].
double distance_between(const SmallMotions& motions, const State& a, const State& b);

}  // namespace mbd
