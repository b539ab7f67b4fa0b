// A force as a function of one variable: of a displacement x or of its rate v. What nonlinear springs,
// bushings and dampers are made of, besides their constant coefficients.
//
// A law is an expression (expression.hpp) or a table, and has
//   f(x),  f'(x),  F(x) = integral of f from 0 to x                                                 (1)
// Expression: f and f' exact; F by Gauss quadrature (20 points on intervals between the breakpoints, halved
// until two halves agree with the whole to 1e-13), exact to round-off where f is smooth.
// Table: piecewise cubic c0 + c1 s + c2 s^2 + c3 s^3, s = x - knot, integrated as it stands; beyond the
// first and the last knot linear with the slope there. Linear interpolation and splines are both of this
// form.
//
// Symbols: x [m, rad] or v [m/s, rad/s]; f [N, N.m]; F [J] (of a law of v: [W], not used).
// At a kink f' is the one on the right. Laws are continuous (libmbd/scene/laws.hpp refuses others): a jump would
// leave equilibria and steps without a solution.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "libmbd/core/dual.hpp"
#include "libmbd/core/expression.hpp"

namespace mbd {

struct LawValue {
  double f = 0.0;   // [N, N.m]
  double df = 0.0;  // df/dx
};

// Where the slope of a law jumps, and its limits from both sides.
struct Kink {
  double at = 0.0;                  // [m, rad, m/s, rad/s]
  double below = 0.0, above = 0.0;  // df/dx
};

// A kink at x, to 1e-9 of it, where only slopes are known: they jump as much in however short an interval around it. Of values
// in place of slopes, a jump.
std::optional<Kink> hidden_kink(const std::function<double(double)>& slope, double x);

// Immutable; evaluation is const, thread safe and allocates nothing.
class Law {
 public:
  // Of the variable that the expression was parsed with.
  static Law of(Expression f) { return Law(std::move(f)); }

  // Cubics with these values and slopes at the knots; x rising, two at least.
  struct Knot {
    double x, f, df;
  };
  static Law smooth(std::span<const Knot> knots);
  // Straight lines between them; the slopes are not used.
  static Law linear(std::span<const Knot> knots);

  LawValue operator()(double x) const;
  double integral(double x) const;  // F of (1)

  const Expression* expression() const { return std::get_if<Expression>(&law_); }  // or nullptr
  std::vector<double> knots() const;                                               // of a table

  // The kink nearest to x. Slopes that differ by round-off (1e-9 of the larger) are none.
  std::optional<Kink> nearest_kink(double x) const;

 private:
  // From the knot at `from` (the first piece: up to it) on.
  struct Piece {
    double from;
    double c[4];
    double before;  // integral from the first knot to this one
  };
  using Table = std::vector<Piece>;

  explicit Law(std::variant<Expression, Table> law) : law_(std::move(law)) {}
  static const Piece& piece_at(const Table& table, double x);
  static double antiderivative(const Table& table, double x);

  std::variant<Expression, Table> law_;
};

// f(x) on any scalar, to first order in its derivatives.
template <class S>
S lifted(const LawValue& at, const S& x) {
  return S(at.f) + S(at.df) * (x - S(value_of(x)));
}

// What a law is of.
enum class ArgumentOf { length, angle, speed, angular_speed };

// A coefficient and, where there is one, a law: what a spring or damper does along one coordinate.
struct Characteristic {
  double coefficient = 0.0;  // k or c  [N/m, N.m, N.s/m, N.m.s]
  int law = -1;              // its place among the batch's laws; -1: none

  LawValue operator()(std::span<const Law> laws, double x) const {
    LawValue value{coefficient * x, coefficient};
    if (law >= 0) {
      const LawValue more = laws[static_cast<std::size_t>(law)](x);
      value.f += more.f;
      value.df += more.df;
    }
    return value;
  }
  // Calls visit(law, x, of) where there is one.
  template <class Visit>
  void each_law(std::span<const Law> laws, double x, ArgumentOf of, const Visit& visit) const {
    if (law >= 0) visit(laws[static_cast<std::size_t>(law)], x, of);
  }
  double energy(std::span<const Law> laws, double x) const {
    return 0.5 * coefficient * x * x +
           (law < 0 ? 0.0 : laws[static_cast<std::size_t>(law)].integral(x));
  }
};

}  // namespace mbd
