// Rates of motion in local coordinates: V = T(Q) Q' (se3.hpp, equation (3)).
#pragma once

#include "libmbd/core/se3.hpp"

namespace mbd {

// T(U) x without forming the matrix. The derivatives of b and c in x that its dual part needs are series
// where their closed forms (b' = (sin(theta)/theta - 2b)/(2x), c' = (b - 3c)/(2x)) cancel.
template <class S>
Vector6<S> T_times(const Vector6<S>& U, const Vector6<S>& x) {
  const Vector3<S> u = linear(U), psi = angular(U), v = linear(x), w = angular(x);
  const S y = psi.squaredNorm();
  static constexpr auto b_series = detail::factorial_series<13>(2);
  static constexpr auto c_series = detail::factorial_series<13>(3);
  static constexpr auto db_series = detail::differentiate(b_series);
  static constexpr auto dc_series = detail::differentiate(c_series);
  static constexpr auto b_short = detail::truncate<6>(b_series);
  static constexpr auto c_short = detail::truncate<6>(c_series);
  static constexpr auto db_short = detail::truncate<6>(db_series);
  static constexpr auto dc_short = detail::truncate<6>(dc_series);
  S b, c, db, dc;
  if (y < S(0.05)) {
    b = detail::horner(b_short, y), c = detail::horner(c_short, y);
    db = detail::horner(db_short, y), dc = detail::horner(dc_short, y);
  } else if (y < S(4.0)) {
    b = detail::horner(b_series, y), c = detail::horner(c_series, y);
    db = detail::horner(db_series, y), dc = detail::horner(dc_series, y);
  } else {
    S cosine, s;
    half_angle(y, cosine, s);
    b = S(2) * s * s, c = sine_remainder(y);
    db = (S(2) * s * cosine - S(2) * b) / (S(2) * y), dc = (b - S(3) * c) / (S(2) * y);
  }
  const S dual = S(2) * psi.dot(u);
  const Vector3<S> pw = psi.cross(w), first = psi.cross(v) + u.cross(w);
  const Vector3<S> ppw = psi.cross(pw);
  return six<S>(
      v - b * first + c * (psi.cross(first) + u.cross(pw)) - (db * dual) * pw + (dc * dual) * ppw,
      w - b * pw + c * ppw);
}

}  // namespace mbd
