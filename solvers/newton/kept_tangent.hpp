// When the tangent of Newton's iterations is kept, over iterations and over steps: by the contraction that it was
// measured to have.
//
// With e_k the size of increment k, in tolerances, the contraction is
//   theta <- max(e_k/e_(k-1), memory theta, floor),
// and after increment e about e min(1, theta/(1 - theta)) is left. A contraction measured at small increments is partly
// luck: the floor and the memory keep it from being believed at once. Accepting after one increment, where nothing was
// measured, doubles theta.
// A tangent that has become old is replaced when that pays: with n steps since it was made, which took k_1 … k_n
// iterations, and a new one that costs as much as c of them, once k_n exceeds the mean cost (c + k_1 + … + k_n)/n.    (1)
// Not used: new tangents by a fixed schedule, which fails near change points; and after each step of some iterations more
// than the least, which a new tangent need not save (a chain of 1000 rods had one in nearly every step).
#pragma once

#include <algorithm>
#include <cstdint>

namespace mbd {

class KeptTangent {
 public:
  struct Policy {
    double floor;    // least contraction that is believed
    double memory;   // how fast a good contraction is believed
    double renew;    // worse: a new tangent inside the step
    double fresh;    // assumed of a new tangent
    int iterations;  // fewer are no reason for a new tangent at the next step
    int cost;        // c of (1); 0: that many always are
  };

  constexpr explicit KeptTangent(const Policy& policy)
      : floor_(policy.floor),
        memory_(policy.memory),
        renew_(policy.renew),
        fresh_(policy.fresh),
        iterations_(static_cast<std::int16_t>(policy.iterations)),
        cost_(static_cast<std::int16_t>(policy.cost)) {}

  void renewed() {
    theta_ = fresh_;
    steps_ = 0;
    sum_ = 0;
  }
  void measured(double increment, double before) {
    theta_ = std::max({increment / before, memory_ * theta_, floor_});
  }
  // Of an increment, how much is left after it.
  double share_left() const { return std::min(1.0, theta_ / (1.0 - std::min(theta_, 0.999))); }
  void accepted_after(int iterations) {
    if (iterations == 1) theta_ = std::min(2.0 * theta_, 0.9);
  }
  bool is_poor() const { return theta_ > renew_; }
  // Of a step: to be asked once for each.
  bool is_old_after(int iterations) {
    if (steps_ < most_steps) {
      ++steps_;
      sum_ = static_cast<std::int16_t>(sum_ + iterations);
    }
    return iterations >= iterations_ && (cost_ == 0 || iterations * steps_ > cost_ + sum_);
  }

 private:
  static constexpr int most_steps = 200;  // what came after is like what came before

  double floor_, memory_, renew_, fresh_, theta_ = 0.1;
  std::int16_t iterations_, cost_, steps_ = 0, sum_ = 0;
};

}  // namespace mbd
