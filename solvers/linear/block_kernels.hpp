// What block_lu.cpp and fronts.cpp do alike with the numbers of a pivot.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>

#include "solvers/linear/block_lu.hpp"
#include "solvers/linear/lanes.hpp"

namespace mbd {

inline constexpr int most_rows = 12;  // of a pivot: a node and six rows of multipliers
inline constexpr int most_registers = 2 * BlockLuPlan::register_rows / lane_count;  // of a column
constexpr std::size_t extent(int n) { return static_cast<std::size_t>(n); }         // of an array
constexpr int registers_of(int rows) { return (rows + lane_count - 1) / lane_count; }

template <class T>
constexpr int parts_of = static_cast<int>(sizeof(T) / sizeof(double));

// X := X U^-1 (of_upper), or X L^-T. L and U in D, by columns; inverse of U's diagonal. `size`: columns of X, or at compile
// time as `fixed`.
template <class T, int registers, int fixed, bool of_upper>
void divide(double* X, int stride, int size, const double* D, int other, const double* inverse) {
  constexpr int parts = parts_of<T>;
  const int n = fixed > 0 ? fixed : size;
  Lanes<T> x[extent(fixed > 0 ? fixed : most_rows)][extent(registers)];
#pragma GCC unroll 6
  for (int c = 0; c < n; ++c) {
    for (int r = 0; r < registers; ++r)
      x[c][r].load(X + c * stride * parts + r * lane_count, stride);
#pragma GCC unroll 6
    for (int q = 0; q < c; ++q) {
      const double* const factor = of_upper ? D + c * other * parts + q : D + q * other * parts + c;
      for (int r = 0; r < registers; ++r) x[c][r].subtract(x[q][r], factor, other);
    }
    for (int r = 0; r < registers; ++r) {
      if (of_upper) x[c][r].multiply(inverse + c, other);
      x[c][r].store(X + c * stride * parts + r * lane_count, stride);
    }
  }
}

template <class T, bool of_upper>
void divide_block(double* X, int rows, int stride, int size, const double* D, int other,
                  const double* inverse) {
  const int registers = registers_of(rows);
  if (size == 6 && registers == registers_of(6)) {
    divide<T, registers_of(6), 6, of_upper>(X, stride, size, D, other, inverse);
  } else if (size == 3 && registers == registers_of(6)) {
    divide<T, registers_of(6), 3, of_upper>(X, stride, size, D, other, inverse);
  } else if (size == 6) {
    int r = 0;
    for (; r + 2 <= registers; r += 2)
      divide<T, 2, 6, of_upper>(X + r * lane_count, stride, size, D, other, inverse);
    if (r < registers)
      divide<T, 1, 6, of_upper>(X + r * lane_count, stride, size, D, other, inverse);
  } else {
    for (int r = 0; r < registers; ++r)
      divide<T, 1, 0, of_upper>(X + r * lane_count, stride, size, D, other, inverse);
  }
}

inline double number(const double* p, int, double) { return *p; }
inline std::complex<double> number(const double* p, int stride, std::complex<double>) {
  return {p[0], p[stride]};
}
inline void put(double* p, int, double x) { *p = x; }
inline void put(double* p, int stride, std::complex<double> x) {
  p[0] = x.real();
  p[stride] = x.imag();
}
inline double size_of(double x) { return std::abs(x); }
inline double size_of(std::complex<double> x) { return std::abs(x.real()) + std::abs(x.imag()); }
// Without the care for infinities that the library takes.
inline double product(double x, double y) { return x * y; }
inline std::complex<double> product(std::complex<double> x, std::complex<double> y) {
  return {x.real() * y.real() - x.imag() * y.imag(), x.real() * y.imag() + x.imag() * y.real()};
}
inline double inverse_of(double x) { return 1.0 / x; }
inline std::complex<double> inverse_of(std::complex<double> x) {
  const double square = x.real() * x.real() + x.imag() * x.imag();
  return {x.real() / square, -x.imag() / square};
}

// L and U of a diagonal block become their inverses, so that a solution is products: in a row of substitutions each would
// wait for the one before it.
template <class T>
void invert_triangles(double* D, int stride, int n, const double* inverse) {
  constexpr int parts = parts_of<T>;
  const auto at = [&](int i, int j) { return number(D + j * stride * parts + i, stride, T()); };
  const auto one_over = [&](int i) { return number(inverse + i, stride, T()); };
  for (int c = 0; c + 1 < n; ++c)
    for (int i = c + 1; i < n; ++i) {
      T sum = -at(i, c);
      for (int k = c + 1; k < i; ++k) sum -= product(at(i, k), at(k, c));
      put(D + c * stride * parts + i, stride, sum);
    }
  for (int c = n - 1; c >= 0; --c) {
    put(D + c * stride * parts + c, stride, one_over(c));
    for (int i = c - 1; i >= 0; --i) {
      T sum = T(0.0);
      for (int k = i + 1; k <= c; ++k) sum -= product(at(i, k), at(k, c));
      put(D + c * stride * parts + i, stride, product(sum, one_over(i)));
    }
  }
}

// The triangles of D, which are L^-1 and U^-1: x := L^-1 x and so on, x of n numbers.
template <class T>
struct Triangles {
  const double* D;
  int stride, size;

  T at(int i, int j) const { return number(D + j * stride * parts_of<T> + i, stride, T()); }
  void lower(T* x) const {
    for (int i = size - 1; i > 0; --i)
      for (int k = 0; k < i; ++k) x[i] += product(at(i, k), x[k]);
  }
  void upper(T* x) const {
    for (int i = 0; i < size; ++i) {
      x[i] = product(at(i, i), x[i]);
      for (int k = i + 1; k < size; ++k) x[i] += product(at(i, k), x[k]);
    }
  }
  void upper_transposed(T* x) const {
    for (int i = size - 1; i >= 0; --i) {
      x[i] = product(at(i, i), x[i]);
      for (int k = 0; k < i; ++k) x[i] += product(at(k, i), x[k]);
    }
  }
  void lower_transposed(T* x) const {
    for (int i = 0; i < size; ++i)
      for (int k = i + 1; k < size; ++k) x[i] += product(at(k, i), x[k]);
  }
};

}  // namespace mbd
