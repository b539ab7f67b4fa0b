// Truncated Taylor arithmetic: a quantity with its first and second time derivative.
//
// Model. x = (v, d, dd) stands for x(t), ẋ(t), ẍ(t). For a smooth function f of x
//
//   (1)  (f∘x)˙ = f'(x) ẋ                (2)  (f∘x)¨ = f''(x) ẋ² + f'(x) ẍ
//
// and for products and quotients the rules of Leibniz, the quotient q = x/y from x = q y:
//
//   (3)  (x y)¨ = ẍ y + 2 ẋ ẏ + x ÿ      (4)  q̇ = (ẋ − q ẏ)/y,  q̈ = (ẍ − 2 q̇ ẏ − q ÿ)/y.
//
// Exact to rounding; there is no step size as there is with finite differences. Outside a domain,
// and where a derivative is infinite (sqrt at 0), the result is not finite, as in <cmath>.
// Functions with kinks or jumps (abs, min, max, floor) are not here: at the kink their derivative
// depends on the side from which it is approached, which the value alone does not tell. Expression
// (expression.hpp) resolves them.
//
// The scalar is double in production, long double where a rate law is integrated once (signal.cpp).
#pragma once

#include <cmath>
#include <numbers>

namespace mbd {

template <class S>
struct Taylor {
  S v;   // value
  S d;   // first time derivative   [1/s]
  S dd;  // second time derivative  [1/s²]
};

using Taylor2 = Taylor<double>;

// f∘x by (1) and (2), from f, f', f'' at x.v.
template <class S>
Taylor<S> compose(const Taylor<S>& x, S f, S df, S ddf) {
  return {f, df * x.d, ddf * x.d * x.d + df * x.dd};
}

template <class S>
Taylor<S> operator-(const Taylor<S>& x) {
  return {-x.v, -x.d, -x.dd};
}

template <class S>
Taylor<S> operator+(const Taylor<S>& x, const Taylor<S>& y) {
  return {x.v + y.v, x.d + y.d, x.dd + y.dd};
}

template <class S>
Taylor<S> operator-(const Taylor<S>& x, const Taylor<S>& y) {
  return {x.v - y.v, x.d - y.d, x.dd - y.dd};
}

template <class S>
Taylor<S> operator*(const Taylor<S>& x, const Taylor<S>& y) {
  return {x.v * y.v, x.d * y.v + x.v * y.d, x.dd * y.v + S(2) * x.d * y.d + x.v * y.dd};
}

template <class S>
Taylor<S> operator/(const Taylor<S>& x, const Taylor<S>& y) {
  const S q = x.v / y.v;
  const S dq = (x.d - q * y.d) / y.v;
  return {q, dq, (x.dd - S(2) * dq * y.d - q * y.dd) / y.v};
}

template <class S>
Taylor<S> sin(const Taylor<S>& x) {
  const S s = std::sin(x.v);
  return compose(x, s, std::cos(x.v), -s);
}

template <class S>
Taylor<S> cos(const Taylor<S>& x) {
  const S c = std::cos(x.v);
  return compose(x, c, -std::sin(x.v), -c);
}

template <class S>
Taylor<S> tan(const Taylor<S>& x) {
  const S y = std::tan(x.v);
  const S dy = S(1) + y * y;
  return compose(x, y, dy, S(2) * y * dy);
}

template <class S>
Taylor<S> asin(const Taylor<S>& x) {
  const S dy = S(1) / std::sqrt((S(1) - x.v) * (S(1) + x.v));
  return compose(x, std::asin(x.v), dy, x.v * dy * dy * dy);
}

template <class S>
Taylor<S> acos(const Taylor<S>& x) {
  const S dy = S(-1) / std::sqrt((S(1) - x.v) * (S(1) + x.v));
  return compose(x, std::acos(x.v), dy, x.v * dy * dy * dy);
}

template <class S>
Taylor<S> atan(const Taylor<S>& x) {
  const S dy = S(1) / (S(1) + x.v * x.v);
  return compose(x, std::atan(x.v), dy, S(-2) * x.v * dy * dy);
}

// The angle of the point (x, y). With r² = x² + y²: r² θ̇ = x ẏ − y ẋ, and the derivative of that.
// The value jumps by 2π where the point crosses the negative x axis; the derivatives do not.
template <class S>
Taylor<S> atan2(const Taylor<S>& y, const Taylor<S>& x) {
  const S r2 = x.v * x.v + y.v * y.v;
  const S d = (x.v * y.d - y.v * x.d) / r2;
  const S dd = (x.v * y.dd - y.v * x.dd - S(2) * d * (x.v * x.d + y.v * y.d)) / r2;
  return {std::atan2(y.v, x.v), d, dd};
}

template <class S>
Taylor<S> sinh(const Taylor<S>& x) {
  const S s = std::sinh(x.v);
  return compose(x, s, std::cosh(x.v), s);
}

template <class S>
Taylor<S> cosh(const Taylor<S>& x) {
  const S c = std::cosh(x.v);
  return compose(x, c, std::sinh(x.v), c);
}

// The derivative is 1/cosh², not 1 − tanh², which cancels for large arguments.
template <class S>
Taylor<S> tanh(const Taylor<S>& x) {
  const S y = std::tanh(x.v);
  const S c = std::cosh(x.v);
  const S dy = S(1) / c / c;
  return compose(x, y, dy, S(-2) * y * dy);
}

template <class S>
Taylor<S> exp(const Taylor<S>& x) {
  const S y = std::exp(x.v);
  return compose(x, y, y, y);
}

// Natural logarithm.
template <class S>
Taylor<S> log(const Taylor<S>& x) {
  const S dy = S(1) / x.v;
  return compose(x, std::log(x.v), dy, -dy * dy);
}

template <class S>
Taylor<S> log10(const Taylor<S>& x) {
  const S dy = S(1) / x.v;
  constexpr S m = std::numbers::log10e_v<S>;
  return compose(x, std::log10(x.v), m * dy, -m * dy * dy);
}

template <class S>
Taylor<S> sqrt(const Taylor<S>& x) {
  const S y = std::sqrt(x.v);
  const S dy = S(1) / (S(2) * y);
  return compose(x, y, dy, -dy / (S(2) * x.v));
}

// Constant exponent: any base for integer p, positive bases otherwise. The factors p and p − 1 are
// tested so that the derivatives of x and x² at x = 0 are not 0·∞.
template <class S>
Taylor<S> pow(const Taylor<S>& x, S p) {
  const S dy = p == S(0) ? S(0) : p * std::pow(x.v, p - S(1));
  const S ddy = p == S(0) || p == S(1) ? S(0) : p * (p - S(1)) * std::pow(x.v, p - S(2));
  return compose(x, std::pow(x.v, p), dy, ddy);
}

// Varying exponent, positive base: z = exp(w), w = y log x, so ż = z ẇ and z̈ = z (ẇ² + ẅ).
template <class S>
Taylor<S> pow(const Taylor<S>& x, const Taylor<S>& y) {
  const Taylor<S> w = y * log(x);
  const S z = std::pow(x.v, y.v);
  return {z, z * w.d, z * (w.d * w.d + w.dd)};
}

}  // namespace mbd
