// The motion over a step by Hermite interpolation in local coordinates Q of each node, H = H_i exp(Q):
//   Q, Q' and, for a quintic, Q'' at both ends from H, V and Vdot,
//   Q' = T^-1(Q) V,   Q'' = T^-1(Q) Vdot + (d/dt T^-1(Q)) V,   and back  V = T(Q) Q',  Vdot = d/dt V.
// A cubic errs by h^4, a quintic by h^6 and by what its Vdot are wrong, times h^2: of order 5 with the
// accelerations of Radau IIA, which are of order 3. V is continuous from step to step in both.
//
// Work is the integral of the polynomial through the powers at both ends and, with a quintic, at two times inside: of
// order 2 and 4. Linear work would be of order 2 whatever the step's own is, and rough from output to output.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "libmbd/core/dual.hpp"
#include "libmbd/core/spectral.hpp"
#include "solvers/time/stepper.hpp"

namespace mbd {

// Work at the fraction s of a step of length h [s] from `begin` to `end`: what the polynomial through the powers at
// `nodes` (fractions; four at most) makes, and linear in s what is left of the step's own quadrature.
template <std::size_t n>
requires(n <= 4) Work
    work_inside(double s, double h, const std::array<double, n>& nodes,
                const std::array<Work, n>& powers, const Work& begin, const Work& end) {
  const auto integral = [&](double to) {  // by Gauss's rule of two points, exact for a cubic
    Work sum;
    for (const double x : {-1.0, 1.0}) {
      const auto w = lagrange<n>(nodes, 0.5 * to * (1.0 + x / std::sqrt(3.0)));
      for (std::size_t k = 0; k < n; ++k) sum += 0.5 * to * h * w[k] * powers[k];
    }
    return sum;
  };
  return begin + integral(s) + s * (end + -1.0 * (begin + integral(1.0)));
}

// What changes at a rate.
inline Vector6<Dual<double>> dual(const Vec6& value, const Vec6& rate) {
  Vector6<Dual<double>> x;
  for (Index i = 0; i < 6; ++i) x(i) = Dual<double>{value(i), rate(i)};
  return x;
}

// Of a state inside a step from `begin` what does not move, and room for what does.
void make_room(const State& begin, State& out);

// A step between two states, to which it refers until the next call of set_ends().
class StepBetween : public DenseStep {
 public:
  double begin() const override { return begin_->t; }
  double end() const override { return end_->t; }
  const State* first() const override { return begin_; }
  const State* last() const override { return end_; }

 protected:
  void set_ends(const State& begin, const State& end) {
    begin_ = &begin;
    end_ = &end;
  }
  const State* begin_ = nullptr;
  const State* end_ = nullptr;
};

class HermiteStep final : public StepBetween {
 public:
  enum class Degree { cubic, quintic };

  HermiteStep(const System& system, Degree degree) : system_(system), degree_(degree) {}

  // Refers to both states until the next call: at() takes from `begin` what does not move. `Q` by node,
  // H_f = H_i exp(Q). Costs nothing until at() is called.
  void set(const State& begin, const State& end, std::span<const Vec6> Q);

  // Two times inside the step, with multipliers, through which they are interpolated besides those at the end (without
  // them, linearly between both ends), and powers. Refers to the multipliers.
  void set_inside(const std::array<double, 2>& times, const std::array<const VecX*, 2>& multipliers,
                  const std::array<Work, 2>& powers);
  // Until the next call of set().
  void set_balance(const Balance& balance) { balance_ = balance; }

  void at(double t, State& out) const override;
  Balance balance() const override { return balance_; }

 private:
  void prepare() const;

  const System& system_;
  Degree degree_;
  std::span<const Vec6> Q_;
  Balance balance_;
  std::array<double, 2> times_{};
  std::array<const VecX*, 2> inner_{};
  std::array<Work, 2> inner_powers_{};
  mutable std::array<Work, 2> powers_{};  // at both ends
  mutable bool prepared_ = false;
  mutable std::vector<std::array<Vec6, 5>> c_;  // by node: of s, s^2 … with s = (t - t_i)/h
};

}  // namespace mbd
