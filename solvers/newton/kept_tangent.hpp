// When the tangent of Newton's iterations is kept, over iterations and over steps: by the contraction that it was
// measured to have.
//
// With e_k the size of increment k, in tolerances, the contraction is
//   theta <- max(e_k/e_(k-1), memory theta, floor),
// and after increment e about e min(1, theta/(1 - theta)) is left. A contraction measured at small increments is partly
// luck: the floor and the memory keep it from being believed at once. Accepting after one increment, where nothing was
// measured, doubles theta.
// Not used: new tangents by a fixed schedule, which fails near change points.
#pragma once

#include <algorithm>

namespace mbd {

class KeptTangent {
 public:
  static constexpr int never = 1 << 20;
  struct Policy {
    double floor;      // least contraction that is believed
    double memory;     // how fast a good contraction is believed
    double renew;      // worse: a new tangent inside the step
    double fresh;      // assumed of a new tangent
    int iterations;    // this many: a new tangent at the next step,
    int more = never;  // or so many more than with the last new one
  };

  constexpr explicit KeptTangent(const Policy& policy) : policy_(policy) {}

  void renewed() { theta_ = policy_.fresh; }
  void measured(double increment, double before) {
    theta_ = std::max({increment / before, policy_.memory * theta_, policy_.floor});
  }
  // Of an increment, how much is left after it.
  double share_left() const { return std::min(1.0, theta_ / (1.0 - std::min(theta_, 0.999))); }
  // A step, in which the tangent was new or not.
  void accepted_after(int iterations, bool was_new = false) {
    if (iterations == 1) theta_ = std::min(2.0 * theta_, 0.9);
    if (was_new) least_ = iterations;
  }
  bool is_poor() const { return theta_ > policy_.renew; }
  bool is_old_after(int iterations) const {
    return iterations >= policy_.iterations || iterations >= least_ + policy_.more;
  }

 private:
  Policy policy_;
  double theta_ = 0.1;
  int least_ = 0;  // iterations of the step that it was new in
};

}  // namespace mbd
