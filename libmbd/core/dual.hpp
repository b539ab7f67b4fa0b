// Forward-mode dual numbers a + eps b, eps^2 = 0: exact directional derivatives of anything written on a
// scalar type. Nest them for second derivatives. Used where a directional derivative is wanted once
// (rates of constraints) and by the tests as the independent derivative of every kernel.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace mbd {

template <class T>
struct Dual {
  T v{};  // value
  T d{};  // derivative

  constexpr Dual() = default;
  constexpr Dual(const T& value) : v(value) {}  // NOLINT: constants are duals without derivative
  constexpr Dual(const T& value, const T& derivative) : v(value), d(derivative) {}
  template <class A>
  requires(std::is_arithmetic_v<A> && !std::is_same_v<A, T>) constexpr Dual(A value)
      : v(static_cast<T>(value)) {}  // NOLINT

  constexpr Dual& operator+=(const Dual& o) { return *this = *this + o; }
  constexpr Dual& operator-=(const Dual& o) { return *this = *this - o; }
  constexpr Dual& operator*=(const Dual& o) { return *this = *this * o; }
  constexpr Dual& operator/=(const Dual& o) { return *this = *this / o; }

  friend constexpr Dual operator-(const Dual& a) { return {-a.v, -a.d}; }
  friend constexpr Dual operator+(const Dual& a, const Dual& b) { return {a.v + b.v, a.d + b.d}; }
  friend constexpr Dual operator-(const Dual& a, const Dual& b) { return {a.v - b.v, a.d - b.d}; }
  friend constexpr Dual operator*(const Dual& a, const Dual& b) {
    return {a.v * b.v, a.d * b.v + a.v * b.d};
  }
  friend constexpr Dual operator/(const Dual& a, const Dual& b) {
    const T q = a.v / b.v;
    return {q, (a.d - q * b.d) / b.v};
  }

  // Comparisons look at the value: a branch is chosen as for the plain scalar.
  friend constexpr bool operator<(const Dual& a, const Dual& b) { return a.v < b.v; }
  friend constexpr bool operator>(const Dual& a, const Dual& b) { return a.v > b.v; }
  friend constexpr bool operator<=(const Dual& a, const Dual& b) { return a.v <= b.v; }
  friend constexpr bool operator>=(const Dual& a, const Dual& b) { return a.v >= b.v; }
  friend constexpr bool operator==(const Dual& a, const Dual& b) { return a.v == b.v; }
  friend constexpr bool operator!=(const Dual& a, const Dual& b) { return a.v != b.v; }
};

template <class T>
Dual<T> sqrt(const Dual<T>& a) {
  using std::sqrt;
  const T s = sqrt(a.v);
  return {s, a.d / (s + s)};
}
template <class T>
Dual<T> sin(const Dual<T>& a) {
  using std::cos, std::sin;
  return {sin(a.v), a.d * cos(a.v)};
}
template <class T>
Dual<T> cos(const Dual<T>& a) {
  using std::cos, std::sin;
  return {cos(a.v), -(a.d * sin(a.v))};
}
template <class T>
Dual<T> atan2(const Dual<T>& y, const Dual<T>& x) {
  using std::atan2;
  return {atan2(y.v, x.v), (x.v * y.d - y.v * x.d) / (x.v * x.v + y.v * y.v)};
}
template <class T>
Dual<T> abs(const Dual<T>& a) {
  return a.v < T(0) ? -a : a;
}

// The plain number in a scalar.
inline double value_of(double x) { return x; }
template <class T>
double value_of(const Dual<T>& x) {
  return value_of(x.v);
}

}  // namespace mbd

template <class T>
struct Eigen::NumTraits<mbd::Dual<T>> : Eigen::NumTraits<T> {
  using Real = mbd::Dual<T>;
  using NonInteger = mbd::Dual<T>;
  using Nested = mbd::Dual<T>;
  using Literal = mbd::Dual<T>;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 2,
    AddCost = 2,
    MulCost = 6
  };
};
