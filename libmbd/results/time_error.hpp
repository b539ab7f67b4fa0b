// How far a transient is off because of its steps: estimated by a second run of the same system in other steps.
//
// The second run takes fixed steps r = 1.75 times as long, or a little more, so that a whole number of them ends with the
// run (few of them end where steps of the run do, so that what falls between the steps of one is seen by the other), or
// ten times the tolerance. Where it does not come to its end it takes steps r times as short, or a tenth of the
// tolerance. With an error that goes with h^p, the difference d of the poses at equal times leaves in the run
//
//   d / |r^p - 1|,   r the ratio of the other's steps to its own                                        (1)
//
// p = 2 of generalized-alpha, 3 of Radau IIA (the least of its orders with three stages; with more of them (1) is too large
// rather than too small). Of tolerances, of which the error is proportional to no power that is sure, d/3 and 3/2 d.
// Displacements are measured by the farther of the scene's length L and the way that a node goes, rotations in radians; both
// over the largest motion of any node from the start, 1 at most:
//
//   error = max |d| / min(1, max over nodes and times of max(|u|/L, |psi|))                             (2)
//
// What is recorded may be far smaller than that (a spring's length, while all of it flies): lengths, places and angles that
// are recorded are measured by their own largest change as well, those that change by 1e-7 of the largest motion or more.
//
// Where instants of controllers or points of tables end nearly all steps, a larger tolerance, or steps that are longer, change
// few: the other run then goes in shorter steps. So it does where longer ones are hard to take (a long chain that whips): they
// are given up after as many iterations as the run took, and the estimate costs up to three times the run.
//
// Where a fixed step passes a kink of a law of the motion (a stop), its error is as large as chance has it, where in the step
// that is; the difference of both runs is taken then as it is, of shorter steps 3/2 of it, and may still be ten times too small.
//
// An estimate: of the first order of what steps do. Where both runs do not resolve what happens (a load shorter than
// all steps, vibrations that both damp away), both are wrong alike, and (1) does not tell.
//
// Not used: the local errors of the scheme, summed: they are no bound where the motion amplifies them, and far too large
// where it does not; a run in half the steps, which costs twice the run, not 0.4 to 0.9 of it.
#pragma once

#include <atomic>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "libmbd/core/system.hpp"
#include "libmbd/scene/transient.hpp"
#include "solvers/newton/report.hpp"

namespace mbd {

// Some neighbouring numbers that are recorded and follow from the motion: a vector, or one.
struct Watched {
  std::string name;  // "tip.displacement"
  bool is_length;    // else an angle
  std::size_t count;
  std::function<void(const State&, std::span<double>)> read;
};

struct TimeError {
  bool known = false;
  double relative = 0.0;      // (2)
  double displacement = 0.0;  // where and when (2) is largest [m]
  double rotation = 0.0;      // [rad]
  std::string node = {};      // "body 'bob'"
  double time = 0.0;          // [s]
  double until = 0.0;         // compared from the start up to there [s]
  int kinks = 0;  // of laws of the motion that fixed steps of the second run pass, inside them
  // The largest of those of what is recorded, over its own change; none is known: negative.
  double recorded = -1.0;
  std::string record = {};     // which, "tip.displacement"
  double recorded_time = 0.0;  // [s]
  std::string how = {};        // "steps 1.75 times as long"
  std::string why_not = {};    // if it is not known

  void scale(double by);  // all that is an error
};

class TimeErrorMeter {
 public:
  // Refers to both. What the run of `transient` does is told by sample().
  TimeErrorMeter(const System& system, const TransientScene& transient,
                 std::vector<Watched> watched = {});

  void start(const State& state);   // what the run starts from, before the stepper's start()
  void sample(const State& state);  // some accepted states, in the order of time

  // Makes the second run. `own`: the work of the run. `interrupted`: looked at after each step; true ends it.
  TimeError measure(const Counters& own, const std::atomic<bool>* interrupted = nullptr) const;

 private:
  struct Sample {
    double t;
    std::vector<Pose<double>> pose;
    std::vector<double> recorded;
  };
  std::vector<double> recorded_in(const State& state) const;
  double length() const;  // and the largest motion: what (2) divides by
  double motion() const;
  void compare(const State& at, const Sample& sample, double factor, TimeError& error) const;
  struct Work {
    double substeps = std::numeric_limits<double>::infinity();
    double iterations = std::numeric_limits<double>::infinity();
  };
  bool follow(const TransientScene& other, bool longer, double factor, const Work& most,
              const std::atomic<bool>* interrupted, TimeError& error) const;
  std::string turns_too_far(double spin, std::size_t node) const;

  const System& system_;
  const TransientScene transient_;  // its own: whoever asks may be gone when it measures
  State start_;
  std::vector<Sample> samples_;
  double farthest_ = 0.0;  // way of a node [m]
  double turned_ = 0.0;    // [rad]
  const std::vector<Watched> watched_;
  std::vector<double> recorded_at_start_, changes_;  // the second, of each of watched_
};

}  // namespace mbd
