// Step control: the size of an estimated error, and the step that it asks for.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "libmbd/core/choices.hpp"
#include "libmbd/core/system.hpp"

namespace mbd {

// What is tolerated of the error of the motion. Errors of positions are measured in lengths of the scene and
// rotations in radians, velocities in what moves fastest at the time; `relative` is of those. Limits in
// physical units, where given, take the place of the relative one for their kind.
//
// Errors of the motion alone. Where things are stiff, waves of small amplitude have velocities that matter: steps that resolve
// them are many times shorter than positions need, which an L-stable method gets right without. With `of` motion,
// velocities are not measured, and errors of positions and rotations are relative to the largest distance and turn since
// the start (at most a length of the scene and a radian), so that small motions are as accurate as large ones.
struct ErrorTolerances {
  double relative = 0.0;          // 0: no error control
  double position = 0.0;          // [m], 0: relative
  double rotation = 0.0;          // [rad]
  double velocity = 0.0;          // [m/s]
  double angular_velocity = 0.0;  // [rad/s]
  ErrorsOf of = ErrorsOf::velocities;
};

class ErrorNorm {
 public:
  // `duration` [s]: what moves slower than a length of the scene, or a radian, in that time is at rest.
  // Throws Error for a tolerance that is negative, not finite, or finer than round-off.
  ErrorNorm(const System& system, const ErrorTolerances& tolerances, double duration);

  // The velocities against which errors are measured: the largest of two states, or a speed [m/s] and a spin
  // [rad/s]. Of two states also what round-off of positions leaves of a step between them: less is not asked for.
  void measure(const State& begin, const State& end);
  void measure(double speed, double spin);

  // What is tolerated, all in physical units.
  ErrorTolerances limits() const;

  // Largest component of an error by node, in units of what is tolerated times `factor`; NaN if one is not
  // finite. An empty `eV` is not measured; of errors of motion, it does not count.
  double operator()(std::span<const Vec6> eU, std::span<const Vec6> eV, double factor) const;

  // Of the last call: the largest errors, and the row of the residual (System::name_of) where the norm was.
  double position() const { return position_; }  // [m]
  double rotation() const { return rotation_; }  // [rad]
  // Of velocities that do not count: largest error, of what moves fastest.
  double velocity_left() const { return velocity_left_; }
  Index worst_row() const { return worst_row_; }

  // Fraction of lengths and radians at which velocities, changed by `rate` [1/s] times the motion, are as
  // wrong as tolerated: Newton's increments of motion have to be that small. At most 1.
  double velocity_share(double rate) const;

  // What it has measured (archive.hpp).
  void archive(auto& a) {
    a(speed_, spin_, round_off_, step_, position_, rotation_, velocity_left_, worst_row_, start_,
      most_travel_, most_turn_, travel_, turn_);
  }

 private:
  void measure_travel(const State& begin, const State& end);

  ErrorTolerances tolerances_;
  double length_, duration_;
  double speed_ = 0.0, spin_ = 0.0;      // [m/s], [rad/s]
  double round_off_ = 0.0, step_ = 0.0;  // of positions [m], [s]
  // Of errors of motion: since the start, of accepted states [m], [rad], and with that under way.
  std::vector<Pose<double>> start_;
  double most_travel_ = 0.0, most_turn_ = 0.0, travel_ = 0.0, turn_ = 0.0;
  mutable double position_ = 0.0, rotation_ = 0.0, velocity_left_ = 0.0;
  mutable Index worst_row_ = -1;
};

// A first step [s] within which nothing moves or changes its velocity much; `span` [s] is the time to come.
double first_step(const System& system, const State& state, double span);

// Steps from errors e = (local error)/(what is allowed), which go with h^order. A new step is a new
// factorisation, and where something rings the error goes up and down with it: a step is shortened at once, but
// lengthened only by what all of the last few would have allowed.
class StepController {
 public:
  StepController(int order, double most) : order_(order), most_(most) {}
  void start(double h);
  void change_order(int order) { order_ = order; }
  double step() const { return h_; }  // [s] to be tried next
  void accepted(double h, double error);
  void rejected(double h, double error);
  void failed(double h);  // Newton's iterations did not converge

  void archive(auto& a) { a(order_, h_, allowed_, steady_, rising_); }

 private:
  int order_;
  double most_;
  double h_ = 0.0;
  double allowed_ = 0.0;  // smallest gain that the steps since the last change would have allowed
  int steady_ = 0;        // how many they are
  bool rising_ = true;    // at the start: no gain is too large, nor waited for
};

}  // namespace mbd
