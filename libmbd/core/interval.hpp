// Interval arithmetic (Moore 1966): an operation on intervals holds all results of the operation on their numbers.
// Ends are moved outward by some units of round-off, which covers that of the operation and of <cmath>. What is not
// known, as 0 times infinity, is everything.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libmbd/core/expression.hpp"

namespace mbd::interval {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr Interval everything{-infinity, infinity};

// [lo, hi] with round-off.
inline Interval outward(double lo, double hi) {
  constexpr double units = 4.0 * std::numeric_limits<double>::epsilon();
  constexpr double least = std::numeric_limits<double>::denorm_min();
  constexpr double largest = std::numeric_limits<double>::max();
  if (std::isnan(lo) || std::isnan(hi)) return everything;
  if (lo > largest) lo = largest;  // an overflow
  if (hi < -largest) hi = -largest;
  return {lo - (units * std::abs(lo) + least), hi + (units * std::abs(hi) + least)};
}
inline Interval point(double x) { return {x, x}; }
inline bool is_zero(const Interval& x) { return x.lo == 0.0 && x.hi == 0.0; }
inline double magnitude(const Interval& x) { return std::max(std::abs(x.lo), std::abs(x.hi)); }

inline Interval operator-(const Interval& x) { return {-x.hi, -x.lo}; }
inline Interval operator+(const Interval& x, const Interval& y) {
  if (is_zero(x)) return y;
  if (is_zero(y)) return x;
  return outward(x.lo + y.lo, x.hi + y.hi);
}
inline Interval operator-(const Interval& x, const Interval& y) { return x + (-y); }
inline Interval operator*(const Interval& x, const Interval& y) {
  if (is_zero(x) || is_zero(y)) return {};  // of what is finite, or of no weight
  const double p[4] = {x.lo * y.lo, x.lo * y.hi, x.hi * y.lo, x.hi * y.hi};
  if (std::isnan(p[0] + p[1] + p[2] +
                 p[3]))  // a product of 0 and infinity, or infinities of either sign
    for (const double q : p)
      if (std::isnan(q)) return everything;
  return outward(std::min(std::min(p[0], p[1]), std::min(p[2], p[3])),
                 std::max(std::max(p[0], p[1]), std::max(p[2], p[3])));
}
inline Interval operator/(const Interval& x, const Interval& y) {
  if (y.lo <= 0.0 && y.hi >= 0.0) return everything;
  return x * outward(1.0 / y.hi, 1.0 / y.lo);
}
inline Interval operator*(double a, const Interval& x) { return point(a) * x; }

inline bool inside(const Interval& x, double lo, double hi) { return x.lo >= lo && x.hi <= hi; }
inline Interval clipped(const Interval& x, double lo, double hi) {
  return {std::clamp(x.lo, lo, hi), std::clamp(x.hi, lo, hi)};
}

inline Interval cos(const Interval& x) {
  constexpr double pi = std::numbers::pi, large = 1e15;
  if (!(x.hi - x.lo < 2.0 * pi) || magnitude(x) > large) return {-1.0, 1.0};
  // Multiples of pi inside, with round-off of x/pi on the side of more.
  const double slack = 8.0 * std::numeric_limits<double>::epsilon() * (1.0 + magnitude(x));
  const double first = std::ceil((x.lo - slack) / pi), last = std::floor((x.hi + slack) / pi);
  const Interval ends =
      outward(std::min(std::cos(x.lo), std::cos(x.hi)), std::max(std::cos(x.lo), std::cos(x.hi)));
  Interval result = clipped(ends, -1.0, 1.0);
  for (double k = first; k <= last; ++k)
    (std::fmod(k, 2.0) == 0.0 ? result.hi : result.lo) = std::fmod(k, 2.0) == 0.0 ? 1.0 : -1.0;
  return result;
}
inline Interval sin(const Interval& x) {
  constexpr double half = 0.5 * std::numbers::pi;
  return cos(x - outward(half, half));
}

// Of a rising function.
template <class F>
Interval rising(const Interval& x, const F& f) {
  return outward(f(x.lo), f(x.hi));
}

}  // namespace mbd::interval
