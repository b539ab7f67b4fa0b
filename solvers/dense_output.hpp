// The motion over a step by Hermite interpolation in local coordinates Q of each node, H = H_i exp(Q):
//   Q, Q' and, for a quintic, Q'' at both ends from H, V and Vdot,
//   Q' = T^-1(Q) V,   Q'' = T^-1(Q) Vdot + (d/dt T^-1(Q)) V,   and back  V = T(Q) Q',  Vdot = d/dt V.
// A cubic errs by h^4, a quintic by h^6 and by what its Vdot are wrong, times h^2: of order 5 with the
// accelerations of Radau IIA, which are of order 3. V is continuous from step to step in both.
#pragma once

#include <array>
#include <vector>

#include "solvers/stepper.hpp"

namespace mbd {

class HermiteStep final : public DenseStep {
 public:
  enum class Degree { cubic, quintic };

  HermiteStep(const System& system, Degree degree) : system_(system), degree_(degree) {}

  // Refers to both states until the next call: at() takes from `begin` what does not move. `Q` by node,
  // H_f = H_i exp(Q). Costs nothing until at() is called.
  void set(const State& begin, const State& end, std::span<const Vec6> Q);

  // Multipliers at two times inside the step, through which they are interpolated besides those at the end;
  // without them, linearly between both ends. Refers to them.
  void set_inner_multipliers(const std::array<double, 2>& times,
                             const std::array<const VecX*, 2>& values);

  double begin() const override { return begin_->t; }
  double end() const override { return end_->t; }
  void at(double t, State& out) const override;

 private:
  void prepare() const;

  const System& system_;
  Degree degree_;
  const State* begin_ = nullptr;
  const State* end_ = nullptr;
  std::span<const Vec6> Q_;
  std::array<double, 2> times_{};
  std::array<const VecX*, 2> inner_{};
  mutable bool prepared_ = false;
  mutable std::vector<std::array<Vec6, 5>> c_;  // by node: of s, s^2 … with s = (t - t_i)/h
};

}  // namespace mbd
