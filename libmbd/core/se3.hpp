// Rotations and rigid-body motions: exp, log, T, T^-1 on SO(3) and SE(3), on any scalar.
//
// Conventions (libmbd/NOTATION.md): a pose H = (p, r) takes section or body axes to
// inertial ones; six-vectors are [linear; angular], wrenches [force; moment], body frame; increments
// are H <- H exp(U). With x~ the cross-product matrix and V = [v; w],
//   V~ = [ w~ v~ ; 0 w~ ],   V~^T Q = Q^U V  with  Q = [n; m],  Q^U = [ 0 n~ ; n~ m~ ]          (1)
//   exp(U): R = exp(psi~),  r = T(-psi) u                                                      (2)
//   d exp(U) = exp(U) (T(U) dU)~;   T^-1(U) = I + U~/2 + a2 U~ U~                              (3)
//   T^-1 is a dual matrix A + eps B: it acts as [ A B ; 0 A ]
//
// Coefficients, with x = theta^2 (each has a series below a threshold at which the closed form has lost
// about a digit; a2' loses one and a2'' two just above it, at 140 degrees, the others a few ulp at most):
//   s(x)  = sin(theta/2)/theta      b(x) = (1 - cos theta)/theta^2 = 2 s^2
//   c(x)  = (theta - sin theta)/theta^3
//   a2(x) = (1 - (theta/2) cot(theta/2))/theta^2, its first and second derivative in x.
// Not used: rotation matrices as state (nine numbers that drift), Rodrigues vectors (singular at pi).
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "libmbd/core/pack.hpp"
#include "libmbd/core/types.hpp"

namespace mbd {

// x~: x~ y = x cross y.
template <class Derived>
MBD_INLINE Matrix3<typename Derived::Scalar> hat(const Eigen::MatrixBase<Derived>& x) {
  using S = typename Derived::Scalar;
  Matrix3<S> m;  // by coefficients: a comma initialiser is not free in a kernel
  m(0, 0) = m(1, 1) = m(2, 2) = S(0);
  m(2, 1) = x(0), m(1, 2) = -x(0);
  m(0, 2) = x(1), m(2, 0) = -x(1);
  m(1, 0) = x(2), m(0, 1) = -x(2);
  return m;
}

// Half the axial vector of M - M^T: axial(x~) = x.
template <class S>
Vector3<S> axial(const Matrix3<S>& M) {
  return S(0.5) * Vector3<S>(M(2, 1) - M(1, 2), M(0, 2) - M(2, 0), M(1, 0) - M(0, 1));
}

template <class S>
MBD_INLINE Vector3<S> linear(const Vector6<S>& x) {
  return x.template head<3>();
}
template <class S>
MBD_INLINE Vector3<S> angular(const Vector6<S>& x) {
  return x.template tail<3>();
}

template <class S>
MBD_INLINE Vector6<S> six(const Vector3<S>& linear, const Vector3<S>& angular) {
  Vector6<S> x;
  x.template head<3>() = linear;
  x.template tail<3>() = angular;
  return x;
}

// A pose, or a relative motion.
template <class S>
struct Pose {
  Quaternion<S> p = Quaternion<S>(S(1), S(0), S(0), S(0));  // unit quaternion
  Vector3<S> r = Vector3<S>::Zero();                        // [m]

  MBD_INLINE Matrix3<S> R() const {
    const S x = p.x(), y = p.y(), z = p.z(), w = p.w();
    const S x2 = x + x, y2 = y + y, z2 = z + z;
    const S xx = x2 * x, yy = y2 * y, zz = z2 * z;
    const S xy = x2 * y, xz = x2 * z, yz = y2 * z;
    const S wx = x2 * w, wy = y2 * w, wz = z2 * w;
    Matrix3<S> R;
    R(0, 0) = S(1) - (yy + zz), R(0, 1) = xy - wz, R(0, 2) = xz + wy;
    R(1, 0) = xy + wz, R(1, 1) = S(1) - (xx + zz), R(1, 2) = yz - wx;
    R(2, 0) = xz - wy, R(2, 1) = yz + wx, R(2, 2) = S(1) - (xx + yy);
    return R;
  }

  template <class T>
  Pose<T> cast() const {
    return {Quaternion<T>(T(p.w()), T(p.x()), T(p.y()), T(p.z())), r.template cast<T>()};
  }
};

// p x p^-1 of a unit quaternion, by components and inlined: Eigen's is a call.
template <class S>
MBD_INLINE Vector3<S> rotated(const Quaternion<S>& p, const Vector3<S>& x) {
  const S w = p.w(), a = p.x(), b = p.y(), c = p.z();
  const S u0 = b * x(2) - c * x(1), u1 = c * x(0) - a * x(2), u2 = a * x(1) - b * x(0);
  const S d0 = u0 + u0, d1 = u1 + u1, d2 = u2 + u2;
  return Vector3<S>(x(0) + w * d0 + (b * d2 - c * d1), x(1) + w * d1 + (c * d0 - a * d2),
                    x(2) + w * d2 + (a * d1 - b * d0));
}
template <class S>
MBD_INLINE Vector3<S> rotated_back(const Quaternion<S>& p, const Vector3<S>& x) {
  return rotated<S>(Quaternion<S>(p.w(), -p.x(), -p.y(), -p.z()), x);
}

template <class S>
MBD_INLINE Pose<S> operator*(const Pose<S>& a, const Pose<S>& b) {
  const S aw = a.p.w(), ax = a.p.x(), ay = a.p.y(), az = a.p.z();
  const S bw = b.p.w(), bx = b.p.x(), by = b.p.y(), bz = b.p.z();
  return {
      Quaternion<S>(aw * bw - ax * bx - ay * by - az * bz, aw * bx + ax * bw + ay * bz - az * by,
                    aw * by + ay * bw + az * bx - ax * bz, aw * bz + az * bw + ax * by - ay * bx),
      a.r + rotated<S>(a.p, b.r)};
}

// A point given in the frame of H, in the base frame.
template <class S>
MBD_INLINE Vector3<S> operator*(const Pose<S>& H, const Vector3<S>& x) {
  return H.r + rotated<S>(H.p, x);
}

template <class S>
Pose<S> inverse(const Pose<S>& a) {
  const Quaternion<S> p = a.p.conjugate();
  return {p, -(p * a.r)};
}

// p := a^-1 b of unit quaternions. Written by components and read so by the metrics: a copy as a vector
// would wait for the stores.
template <class S>
MBD_INLINE void set_relative_rotation(const Quaternion<S>& a, const Quaternion<S>& b,
                                      Quaternion<S>& p) {
  const S aw = a.w(), ax = a.x(), ay = a.y(), az = a.z();
  const S bw = b.w(), bx = b.x(), by = b.y(), bz = b.z();
  p.w() = aw * bw + ax * bx + ay * by + az * bz;
  p.x() = aw * bx - ax * bw - ay * bz + az * by;
  p.y() = aw * by - ay * bw - az * bx + ax * bz;
  p.z() = aw * bz - az * bw - ax * by + ay * bx;
}

// H_j^-1 H_k, with the difference of positions taken first: no loss far from the origin.
template <class S>
MBD_INLINE Pose<S> relative(const Pose<S>& Hj, const Pose<S>& Hk) {
  Pose<S> g;
  set_relative_rotation(Hj.p, Hk.p, g.p);
  g.r = rotated_back<S>(Hj.p, Vector3<S>(Hk.r - Hj.r));
  return g;
}

// A + eps B of 3x3 blocks; acts on six-vectors as [ A B ; 0 A ].
template <class S>
struct DualMatrix {
  Matrix3<S> A = Matrix3<S>::Identity();
  Matrix3<S> B = Matrix3<S>::Zero();

  Vector6<S> operator*(const Vector6<S>& x) const {
    return six<S>(A * linear(x) + B * angular(x), A * angular(x));
  }
  // [ A B ; 0 A ]^T W, for wrenches.
  Vector6<S> transpose_times(const Vector6<S>& W) const {
    return six<S>(A.transpose() * linear(W),
                  B.transpose() * linear(W) + A.transpose() * angular(W));
  }
  DualMatrix transposed_parts() const { return {A.transpose(), B.transpose()}; }
  Matrix6<S> matrix() const {
    Matrix6<S> m;
    m.template topLeftCorner<3, 3>() = A;
    m.template topRightCorner<3, 3>() = B;
    m.template bottomLeftCorner<3, 3>().setZero();
    m.template bottomRightCorner<3, 3>() = A;
    return m;
  }
};

// The adjoint of g = (R, r): takes a twist in g's frame to the base frame, as R + eps r~R.
template <class S>
DualMatrix<S> adjoint(const Pose<S>& g) {
  const Matrix3<S> R = g.R();
  return {R, hat(g.r) * R};
}
// The adjoint of g^-1: R^T - eps R^T r~.
template <class S>
MBD_INLINE DualMatrix<S> adjoint_inverse(const Pose<S>& g) {
  const Matrix3<S> Rt = g.R().transpose();
  return {Rt, -Rt * hat(g.r)};
}

// A wrench at the origin of H in its axes, as one at the base frame's origin in the base's axes, and back.
template <class S>
MBD_INLINE Vector6<S> inertial_wrench(const Pose<S>& H, const Vector6<S>& W) {
  const Vector3<S> n = rotated<S>(H.p, linear(W)), m = rotated<S>(H.p, angular(W));
  return six<S>(n, m + H.r.cross(n));
}
template <class S>
MBD_INLINE Vector6<S> body_wrench(const Pose<S>& H, const Vector6<S>& W) {
  const Vector3<S> n = linear(W), m = angular(W) - H.r.cross(n);
  return six<S>(rotated_back<S>(H.p, n), rotated_back<S>(H.p, m));
}

// A twist of the base frame, which H moves with, as one at the origin of H in its axes: Ad(H^-1) V.
template <class S>
MBD_INLINE Vector6<S> body_twist(const Pose<S>& H, const Vector6<S>& V) {
  const Vector3<S> w = angular(V);
  return six<S>(rotated_back<S>(H.p, Vector3<S>(linear(V) + w.cross(H.r))),
                rotated_back<S>(H.p, w));
}

// M x as a sum of columns: inlined, in vector registers.
template <class S>
MBD_INLINE Vector6<S> times(const Matrix6<S>& M, const Vector6<S>& x) {
  return M.col(0) * x(0) + M.col(1) * x(1) + M.col(2) * x(2) + M.col(3) * x(3) + M.col(4) * x(4) +
         M.col(5) * x(5);
}

// V~ (6x6).
template <class S>
Matrix6<S> twist_hat(const Vector6<S>& V) {
  return DualMatrix<S>{hat(angular(V)), hat(linear(V))}.matrix();
}
// Q^U (6x6), equation (1).
template <class S>
Matrix6<S> wrench_hat(const Vector6<S>& Q) {
  Matrix6<S> m;
  const Matrix3<S> n = hat(linear(Q));
  m.template topLeftCorner<3, 3>().setZero();
  m.template topRightCorner<3, 3>() = n;
  m.template bottomLeftCorner<3, 3>() = n;
  m.template bottomRightCorner<3, 3>() = hat(angular(Q));
  return m;
}
// V~^T Q without forming V~.
template <class S>
MBD_INLINE Vector6<S> twist_hat_transpose_times(const Vector6<S>& V, const Vector6<S>& Q) {
  const Vector3<S> v = linear(V), w = angular(V), n = linear(Q), m = angular(Q);
  return six<S>(n.cross(w), n.cross(v) + m.cross(w));
}

namespace detail {

template <class S, std::size_t n>
MBD_INLINE S horner(const std::array<double, n>& coefficients, const S& x) {
  S y = S(coefficients[n - 1]);
  for (std::size_t i = n - 1; i-- > 0;) y = y * x + S(coefficients[i]);
  return y;
}

// Power series with terms sign^i / (2i + first)!, long enough for x < 4 (relative 1e-17).
template <std::size_t n>
constexpr std::array<double, n> factorial_series(int first) {
  std::array<double, n> c{};
  long double f = 1.0L;
  for (int k = 2; k <= first; ++k) f *= k;
  for (std::size_t i = 0; i < n; ++i) {
    c[i] = static_cast<double>((i % 2 == 0 ? 1.0L : -1.0L) / f);
    const int k = first + 2 * static_cast<int>(i);
    f *= static_cast<long double>(k + 1) * static_cast<long double>(k + 2);
  }
  return c;
}

// a2(x) = sum_n 2 zeta(2n) / (2 pi)^(2n) x^(n-1); radius 4 pi^2.
inline constexpr std::size_t a2_terms = 24;
constexpr std::array<double, a2_terms> a2_series() {
  std::array<double, a2_terms> c{};
  constexpr long double pi2 =
      4.0L * std::numbers::pi_v<long double> * std::numbers::pi_v<long double>;
  // zeta(2), zeta(4), zeta(6), zeta(8) in closed form; direct sums converge for the others.
  constexpr long double pi = std::numbers::pi_v<long double>;
  long double power = 1.0L;
  for (std::size_t i = 0; i < a2_terms; ++i) {
    const int m = 2 * static_cast<int>(i + 1);
    power /= pi2;
    long double zeta = 0.0L;
    if (m == 2)
      zeta = pi * pi / 6.0L;
    else if (m == 4)
      zeta = pi * pi * pi * pi / 90.0L;
    else if (m == 6)
      zeta = pi * pi * pi * pi * pi * pi / 945.0L;
    else if (m == 8)
      zeta = pi * pi * pi * pi * pi * pi * pi * pi / 9450.0L;
    else {
      for (int k = 80; k >= 1; --k) {
        long double t = 1.0L;
        for (int j = 0; j < m; ++j) t /= static_cast<long double>(k);
        zeta += t;
      }
    }
    c[i] = static_cast<double>(2.0L * zeta * power);
  }
  return c;
}
template <std::size_t n>
constexpr std::array<double, n - 1> differentiate(const std::array<double, n>& c) {
  std::array<double, n - 1> d{};
  for (std::size_t i = 1; i < n; ++i) d[i - 1] = static_cast<double>(i) * c[i];
  return d;
}
template <std::size_t m, std::size_t n>
constexpr std::array<double, m> truncate(const std::array<double, n>& c) {
  std::array<double, m> d{};
  for (std::size_t i = 0; i < m; ++i) d[i] = c[i];
  return d;
}

// The series below, long and short.
inline constexpr auto half_sine = factorial_series<9>(1);
inline constexpr auto half_cosine = factorial_series<9>(0);
inline constexpr auto remainder = factorial_series<13>(3);
inline constexpr auto short_remainder = truncate<6>(remainder);
inline constexpr auto a2 = a2_series();
inline constexpr auto da2 = differentiate(a2);
inline constexpr auto dda2 = differentiate(da2);
inline constexpr auto short_a2 = truncate<8>(a2);
inline constexpr auto short_da2 = truncate<8>(da2);
inline constexpr auto short_dda2 = truncate<8>(dda2);
inline constexpr auto cosine_remainder = factorial_series<13>(2);
inline constexpr auto d_cosine_remainder = differentiate(cosine_remainder);
inline constexpr auto d_remainder = differentiate(remainder);
inline constexpr auto short_cosine_remainder = truncate<6>(cosine_remainder);
inline constexpr auto short_d_cosine_remainder = truncate<6>(d_cosine_remainder);
inline constexpr auto short_d_remainder = truncate<6>(d_remainder);
// 2 asin(s)/s = 2 sum (2n)!/(4^n n!^2 (2n+1)) s^2n, for |e| < 0.24 (28 degrees)
inline constexpr auto arcsine = [] {
  std::array<double, 13> c{};
  long double f = 2.0L;
  for (std::size_t n = 0; n < c.size(); ++n) {
    c[n] = static_cast<double>(f / static_cast<long double>(2 * n + 1));
    f *= static_cast<long double>(2 * n + 1) / static_cast<long double>(2 * n + 2);
  }
  return c;
}();
inline constexpr auto short_arcsine = truncate<8>(arcsine);

}  // namespace detail

// cos(theta/2) and s = sin(theta/2)/theta.
template <class S>
MBD_INLINE void half_angle(const S& x, S& cosine, S& s) {
  // sin(y)/y and cos(y) with y = theta/2: series in y^2 = x/4.
  const auto series = [](const auto& square) {
    using N = std::decay_t<decltype(square)>;
    const N y2 = N(0.25) * square;
    return std::array<N, 2>{detail::horner(detail::half_cosine, y2),
                            N(0.5) * detail::horner(detail::half_sine, y2)};
  };
  const auto closed = [](const auto& square) {
    using std::cos, std::sin, std::sqrt;
    using N = std::decay_t<decltype(square)>;
    const N theta = sqrt(square);
    return std::array<N, 2>{cos(N(0.5) * theta), sin(N(0.5) * theta) / theta};
  };
  const auto both = by_size<2>(x, 1.0, series, 0.0, series, closed);
  cosine = both[0];
  s = both[1];
}

// c(x) = (theta - sin theta)/theta^3.
template <class S>
MBD_INLINE S sine_remainder(const S& x) {
  return by_size<1>(
      x, 0.05, [](const auto& y) { return std::array{detail::horner(detail::short_remainder, y)}; },
      4.0, [](const auto& y) { return std::array{detail::horner(detail::remainder, y)}; },
      [](const auto& y) {
        using std::sin, std::sqrt;
        using N = std::decay_t<decltype(y)>;
        const N theta = sqrt(y);
        return std::array<N, 1>{(theta - sin(theta)) / (y * theta)};
      })[0];
}

// a2(x) and its first two derivatives in x.
template <class S>
struct A2 {
  S a, da, dda;
};
namespace detail {
// h = y cot y, y = theta/2:  a2 = (1 - h)/x,  h' = (4h/x - 1/sin^2 y)/8.
template <class S>
std::array<S, 3> a2_closed(const S& x) {
  using std::cos, std::sin, std::sqrt;
  const S y = S(0.5) * sqrt(x);
  const S sine = sin(y);
  const S h = y * cos(y) / sine;
  const S inverse_s2 = S(1) / (sine * sine);
  const S a = (S(1) - h) / x;
  const S dh = (S(4) * h / x - inverse_s2) / S(8);
  const S da = (-dh - a) / x;
  const S ddh = (S(4) * dh / x - S(4) * h / (x * x) + h * inverse_s2 / x) / S(8);
  return {a, da, (-ddh - S(2) * da) / x};
}
}  // namespace detail

template <class S>
MBD_INLINE A2<S> a2_coefficients(const S& x, bool derivatives = true) {
  const auto of = [derivatives](const auto& y, const auto& a, const auto& da, const auto& dda) {
    using N = std::decay_t<decltype(y)>;
    std::array<N, 3> r{detail::horner(a, y), N(0), N(0)};
    if (derivatives) {
      r[1] = detail::horner(da, y);
      r[2] = detail::horner(dda, y);
    }
    return r;
  };
  const auto r = by_size<3>(
      x, 0.3,
      [&](const auto& y) { return of(y, detail::short_a2, detail::short_da2, detail::short_dda2); },
      6.0, [&](const auto& y) { return of(y, detail::a2, detail::da2, detail::dda2); },
      [](const auto& y) { return detail::a2_closed(y); });
  return {r[0], r[1], r[2]};
}

// --- SO(3) ---

// exp(psi~) as a unit quaternion.
template <class S>
Quaternion<S> exp_so3(const Vector3<S>& psi) {
  S cosine, s;
  half_angle(S(psi.squaredNorm()), cosine, s);
  return Quaternion<S>(cosine, s * psi(0), s * psi(1), s * psi(2));
}

// Rotation vector of length <= pi. Either sign of p gives the same.
template <class S>
Vector3<S> log_so3(const Quaternion<S>& p) {
  const S sign = sign_of(S(p.w()));
  const Vector3<S> e(sign * p.x(), sign * p.y(), sign * p.z());
  const S e0 = sign * p.w();
  const S s2 = e.squaredNorm();
  const S factor = by_size<1>(
      s2, 0.0075,
      [](const auto& x) { return std::array{detail::horner(detail::short_arcsine, x)}; }, 0.0585,
      [](const auto& x) { return std::array{detail::horner(detail::arcsine, x)}; },
      [](const auto& x, const auto& w) {
        using std::atan2, std::sqrt;
        using N = std::decay_t<decltype(x)>;
        const N sine = sqrt(x);
        return std::array<N, 1>{N(2) * atan2(sine, w) / sine};
      },
      e0)[0];
  return factor * e;
}

// --- SE(3) ---

// T^-1(U), equation (3).
template <class S>
DualMatrix<S> T_inverse(const Vector6<S>& U) {
  const Vector3<S> u = linear(U), psi = angular(U);
  const A2<S> k = a2_coefficients(S(psi.squaredNorm()));
  const Matrix3<S> P = hat(psi), L = hat(u);
  const Matrix3<S> PP = P * P;
  const S da = S(2) * k.da * psi.dot(u);  // dual part of a2
  return {Matrix3<S>::Identity() + S(0.5) * P + k.a * PP,
          S(0.5) * L + k.a * (L * P + P * L) + da * PP};
}

// T^-1(U) x without forming the matrix.
template <class S>
MBD_INLINE Vector6<S> T_inverse_times(const Vector6<S>& U, const Vector6<S>& x) {
  const Vector3<S> u = linear(U), psi = angular(U), v = linear(x), w = angular(x);
  const A2<S> k = a2_coefficients(S(psi.squaredNorm()));
  const Vector3<S> pw = psi.cross(w), first = psi.cross(v) + u.cross(w);
  const Vector3<S> ppw = psi.cross(pw);
  return six<S>(v + S(0.5) * first + k.a * (psi.cross(first) + u.cross(pw)) +
                    (S(2) * k.da * psi.dot(u)) * ppw,
                w + S(0.5) * pw + k.a * ppw);
}

// T(U) x without forming the matrix. The derivatives of b and c in x that its dual part needs are series
// where their closed forms (b' = (sin(theta)/theta - 2b)/(2x), c' = (b - 3c)/(2x)) cancel.
template <class S>
Vector6<S> T_times(const Vector6<S>& U, const Vector6<S>& x) {
  const Vector3<S> u = linear(U), psi = angular(U), v = linear(x), w = angular(x);
  const S y = psi.squaredNorm();
  const auto of = [](const auto& z, const auto& first_b, const auto& first_c, const auto& first_db,
                     const auto& first_dc) {
    return std::array{detail::horner(first_b, z), detail::horner(first_c, z),
                      detail::horner(first_db, z), detail::horner(first_dc, z)};
  };
  const auto [b, c, db, dc] = by_size<4>(
      y, 0.05,
      [&](const auto& z) {
        return of(z, detail::short_cosine_remainder, detail::short_remainder,
                  detail::short_d_cosine_remainder, detail::short_d_remainder);
      },
      4.0,
      [&](const auto& z) {
        return of(z, detail::cosine_remainder, detail::remainder, detail::d_cosine_remainder,
                  detail::d_remainder);
      },
      [](const auto& z) {
        using N = std::decay_t<decltype(z)>;
        N cosine, s;
        half_angle(z, cosine, s);
        const N b_of = N(2) * s * s, c_of = sine_remainder(z);
        return std::array<N, 4>{b_of, c_of, (N(2) * s * cosine - N(2) * b_of) / (N(2) * z),
                                (b_of - N(3) * c_of) / (N(2) * z)};
      });
  const S dual = S(2) * psi.dot(u);
  const Vector3<S> pw = psi.cross(w), first = psi.cross(v) + u.cross(w);
  const Vector3<S> ppw = psi.cross(pw);
  return six<S>(
      v - b * first + c * (psi.cross(first) + u.cross(pw)) - (db * dual) * pw + (dc * dual) * ppw,
      w - b * pw + c * ppw);
}

// T(U) = I - b U~ + c U~ U~, the dual inverse of T^-1.
template <class S>
DualMatrix<S> T_of(const Vector6<S>& U) {
  const Vector3<S> psi = angular(U);
  const S x = psi.squaredNorm();
  S cosine, s;
  half_angle(x, cosine, s);
  const S b = S(2) * s * s;
  const S c = sine_remainder(x);
  // B = -A (T^-1)_B A: avoids the derivatives of b and c, which cancel at small angles.
  const Matrix3<S> P = hat(psi);
  const Matrix3<S> A = Matrix3<S>::Identity() - b * P + c * (P * P);
  return {A, -A * T_inverse(U).B * A};
}

// exp(U), equation (2).
template <class S>
MBD_INLINE Pose<S> exp_se3(const Vector6<S>& U) {
  const Vector3<S> u = linear(U), psi = angular(U);
  const S x = psi.squaredNorm();
  S cosine, s;
  half_angle(x, cosine, s);
  const Vector3<S> pu = psi.cross(u);
  return {Quaternion<S>(cosine, s * psi(0), s * psi(1), s * psi(2)),
          u + (S(2) * s * s) * pu + sine_remainder(x) * psi.cross(pu)};
}

// log(g) with rotation of length <= pi.
template <class S>
Vector6<S> log_se3(const Pose<S>& g) {
  const Vector3<S> psi = log_so3(g.p);
  const S a = a2_coefficients(S(psi.squaredNorm()), false).a;
  const Vector3<S> pr = psi.cross(g.r);
  return six<S>(g.r - S(0.5) * pr + a * psi.cross(pr), psi);
}

// --- lists of poses and six-vectors, a pack at a time ---

// of(k): a pose of lane k.
template <class Of>
MBD_INLINE Pose<Pack> pack_of_poses(const Of& of) {
  Pose<Pack> H;
  pack_into(H.p.coeffs(), [&](int k) { return of(k).p.coeffs().data(); });
  pack_into(H.r, [&](int k) { return of(k).r.data(); });
  return H;
}
MBD_INLINE Pose<Pack> packed(std::span<const Pose<double>> poses, const PackOf& pack) {
  return pack_of_poses([&](int k) -> const Pose<double>& { return poses[pack[k]]; });
}
MBD_INLINE Vector6<Pack> packed(std::span<const Vector6<double>> list, const PackOf& pack) {
  Vector6<Pack> x;
  pack_into(x, [&](int k) { return list[pack[k]].data(); });
  return x;
}
MBD_INLINE void unpack(const Pose<Pack>& H, const PackOf& pack, std::span<Pose<double>> poses) {
  for (int k = 0; k < pack.count(); ++k) {
    Pose<double>& to = poses[pack[k]];
    for (Index i = 0; i < 4; ++i) to.p.coeffs()(i) = H.p.coeffs()(i)[k];
    for (Index i = 0; i < 3; ++i) to.r(i) = H.r(i)[k];
  }
}
MBD_INLINE void unpack(const Vector6<Pack>& x, const PackOf& pack,
                       std::span<Vector6<double>> list) {
  for (int k = 0; k < pack.count(); ++k)
    for (Index i = 0; i < 6; ++i) list[pack[k]](i) = x(i)[k];
}

// Rescales to a unit quaternion (first-order formula: p is one already but for round-off).
inline void renormalize(Pose<double>& H) { H.p.coeffs() *= 1.5 - 0.5 * H.p.squaredNorm(); }

}  // namespace mbd
