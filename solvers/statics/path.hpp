// Follows the path of equilibria of a System over its load factor through limit and bifurcation points.
//
// A point is x = (U, lambda, mu): motion, multipliers, load factor, r(x) = 0. Its tangent t solves
//   [ S  p ; n^T W  c^2 n_mu ] t = [ 0 ; 1 ],   S = dr/d(U, lambda),  p = dr/dmu,                    (1)
// n the tangent before it; |t|^2 = t^T W t + c^2 t_mu^2 = 1. W measures motions (stability.hpp), c makes
// load and motion weigh the same in the first tangent. A step predicts x + h t and corrects
//   bordered   by mixed Newton (equilibrium.hpp) in the hyperplane t^T W dx + c^2 t_mu dmu = 0, with the matrix of (1), n = t:
//              regular at limit points (the prediction also bends as the tangent did over the last step)
//   crisfield  on the cylinder of radius |h t| in displacements (Crisfield 1981): rotations, multipliers and
//              load do not count; of its two intersections the one that goes on
// Steps grow with fast contraction and small turning of the tangent, and are cut otherwise.
//
// Limit points are roots of t_mu, crossings roots of what they ask, both along the corrected path between two
// points. Singular points that are no limit points show as a change of the number of negative eigenvalues
// (stability.hpp) or, without a potential, as modes that go through zero (nearest_modes.hpp); they are roots of the
// eigenvalue of S nearest to zero, whose shape is the mode. A branch starts in the direction of the mode, made
// W-orthogonal to the tangent.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/core/system.hpp"
#include "solvers/newton/report.hpp"

namespace mbd {

// A point where `excess` changes its sign is located and shown; with `stops` the path ends there.
struct PathCrossing {
  std::function<double(const State&)> excess;
  bool stops = false;
};

struct PathPoint {
  const State& state;
  double arc_length =
      0.0;  // sum of the motions of steps (W) from the start, or of a branch from its bifurcation;
            // negative backward [-]
  int branch = 0;  // 0 from the start forward, -1 backward, 1 from a bifurcation
  PathEvent event = PathEvent::none;
  std::optional<Index> negative;  // eigenvalues; empty if not counted
};

struct SpecialPoint {
  PathEvent event = PathEvent::none;
  int number = 0;  // of its kind, from 1, in the order found
  int branch = 0;
  double load_factor = 0.0, arc_length = 0.0;
  std::optional<Index> before, after;  // negative eigenvalues on both sides
  std::string motion;                  // the largest of the mode, in words
  VecX mode;                           // of a bifurcation; of a limit point the tangent
};

struct PathOptions {
  PathMethod method = PathMethod::bordered;
  PathDirection direction = PathDirection::forward;
  double step = 0.05;                                       // first step, of the load factor
  double max_step = 0.1;                                    // of the measure |h|
  int points = 200;                                         // most on each branch
  double length = std::numeric_limits<double>::infinity();  // most arc length of each branch
  bool has_potential = true;                                // counts negative eigenvalues
  int branch = 0;  // number of the bifurcation whose branch is followed too; negative: other side
  std::vector<PathCrossing> crossings = {};
  NewtonOptions newton = {.tolerance = 1e-12};
  std::function<bool(const PathPoint&)> accepted = {};  // in order; false ends everything
};

struct PathReport {
  bool complete = false;
  std::string failure;  // when not complete
  std::string end;      // why each branch ends, in words
  Counters counters;
  int most_iterations = 0;
  double least_load = 0.0, most_load = 0.0;
  std::vector<std::string> notes;    // what was not located
  std::vector<std::string> neutral;  // motions that nothing answers, held on the way, in words
  double asymmetry = 0.0;            // largest of the tangent at counted points, relative
  std::vector<SpecialPoint> special;
};

// `state` is the reference state; it becomes the last point found. `solver` must know another().
PathReport follow_path(const System& system, LinearSolver& solver, const PathOptions& options,
                       State& state);

}  // namespace mbd
