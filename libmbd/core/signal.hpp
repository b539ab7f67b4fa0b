// Scalar functions of time that drive joints and loads.
//
// A signal gives f, ḟ, f̈. It is a constant, an expression in t, or a rate law
//
//   (1)  f(t) = f0 + ∫_{t_begin}^{t} r(s) ds,     ḟ = r,     f̈ = ṙ,
//
// for which r and ṙ are exact (expression.hpp) and only f is approximated: between breakpoints of
// r, on panels [m − h, m + h] halved until the Chebyshev expansion of r to degree 24 is resolved,
//
//   (2)  r = Σ a_k T_k(x),  x = (t − m)/h,        (3)  ∫ r dt = h Σ b_k T_k(x),
//   (4)  b_1 = a_0 − a_2/2,  b_k = (a_{k−1} − a_{k+1})/(2k) for k > 1,  b_0: (3) is 0 at x = −1,
//
// summed by Clenshaw's recurrence. So f has no state, does not depend on the integrator's step,
// and costs a binary search and one short recurrence.
//
// Accuracy: |error| ≤ 1e-15 max(1, |f|). Sampling and evaluation are in long double, because the
// rounding of r in double would, with a large phase (sin(100 t) at 1000 s: 1e-11), exceed this.
// Where long double rounds too coarsely as well, its measured rounding error bounds the accuracy.
// Panels are also halved until none is longer than 100 cells of r (law_cells.hpp), so that a pulse, however
// short, is not taken for nothing between the points where r is sampled.
//
// Not used: integrating r along with the motion (f would inherit the error of the time steps, and
// statics has none); double arithmetic with compensated sums (the error of r and of x remains).
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "libmbd/core/expression.hpp"

namespace mbd {

struct SignalValue {
  double f;      // value
  double fdot;   // first time derivative   [1/s]
  double fddot;  // second time derivative  [1/s²]
};

// A time at which a signal is not twice continuously differentiable.
struct Jump {
  double t;        // [s]
  int derivative;  // the lowest derivative that jumps: 0 f, 1 ḟ, 2 f̈
  double size;     // its right limit minus its left limit; not finite if one of them is not
};

// A function of time. Immutable, cheap to copy; evaluation is const, thread safe and allocates
// nothing.
class Signal {
 public:
  static Signal constant(double f);

  static Signal from_expression(Expression f);

  // Equation (1) on [t_begin, t_end] (finite, t_begin < t_end) [s]. Throws Error if the interval or
  // f0 is unusable, if the rate depends on inputs, and, naming the time, if the rate is not finite or cannot be resolved on panels
  // of 1e-10 of the interval (a pole, an undeclared jump, a frequency beyond 1e5 panels).
  static Signal from_rate(Expression rate, double f0, double t_begin, double t_end);

  // Value and derivatives at t [s]; at a breakpoint, the limit from `side`. Values that are not
  // finite are returned as they are: whoever steps checks them. A rate law throws Error outside its
  // interval, of which 16 rounding units at either end are forgiven to accumulated step times.
  // `inputs`: those of the model, in its order (input.hpp).
  SignalValue operator()(double t, Side side = Side::right,
                         std::span<const InputValue> inputs = {}) const;

  // The jumps in ascending time, inside the interval for a rate law. A breakpoint counts if a limit
  // is not finite or the difference exceeds 1e-10 of the signal's magnitude on the adjacent pieces, and if the
  // expression depends on inputs: the value may jump there, by how much (`size`) is not known.
  std::vector<Jump> jumps() const;

  // Where the expression switches, in ascending time, inside the interval for a rate law: jumps(), and times at which it may be
  // that higher derivatives jump.
  std::vector<double> breakpoints() const;

  // A jump of f or of its first derivative between t_begin and t_end at which the expression does not switch:
  // asin(sin(t)), sqrt((t-1)^2), atan2. Found where an interval, halved to 1e-9 of the whole, keeps a change of
  // the derivative by more than 1e-4 of its largest value (smaller ones, and narrower pulses than 1/200 of a
  // piece, can be missed). Of a rate law there is none: its integration would have failed. Inputs are not looked at.
  std::optional<Jump> undeclared_jump(double t_begin, double t_end) const;

  bool is_constant() const;
  bool has_inputs() const;
  bool has_sensors() const;  // its values are then of System::signals_at

  // The expression that the signal is, or that its rate is (`is_rate`); nullptr: a constant.
  const Expression* expression(bool& is_rate) const;

 private:
  class RateLaw;
  using Law = std::variant<double, Expression, std::shared_ptr<const RateLaw>>;

  explicit Signal(Law law) : law_(std::move(law)) {}
  std::array<double, 2> interval() const;

  Law law_;
};

}  // namespace mbd
