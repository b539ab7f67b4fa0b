// A few numbers side by side, as wide as a register of the processor that is compiled for, and complex ones as real and
// imaginary parts apart. In memory a column has a stride of `rows` doubles; of complex ones, their imaginary parts follow
// after another such stride.
#pragma once

#include <complex>
#include <cstring>

#include "libmbd/core/pack.hpp"

namespace mbd {

// It is in a register here: the compiler does not read it from memory again for each product.
inline void hold(Lane& x) {
#if defined(__SSE2__)
  asm("" : "+v"(x));
#else
  static_cast<void>(x);
#endif
}

// Of the rows from `begin` to `end`, of which a register holds those from `first`. (No function returns it: without such
// registers that would depend on how they are passed.)
struct LanesBetween {
  LaneMask mask{};
  LanesBetween(int begin, int end, int first) {
    for (int k = 0; k < lane_count; ++k) mask[k] = first + k >= begin && first + k < end ? -1 : 0;
  }
};

template <class T>
struct Lanes;

template <>
struct Lanes<double> {
  Lane re;
  void load(const double* p, int) { std::memcpy(&re, p, sizeof re); }
  void store(double* p, int) const { std::memcpy(p, &re, sizeof re); }
  void clear() { re = Lane{}; }
  void fill(double s) { re = Lane{} + s; }
  double at(int k) const { return re[k]; }
  // Takes x where the mask is set.
  void take(const LaneMask& mask, const Lanes& x) { re = mask ? x.re : re; }
  void multiply(double s) { re *= s; }
  void subtract(const Lanes& x, double s) { re -= x.re * s; }
  // this += s |x|^2.
  static void add_squares(Lane& sum, const Lanes& x, double s) { sum += x.re * x.re * s; }
  // this += x s or this -= x s, with s at `p`, or x * s.
  void add(const Lanes& x, const double* p, int) { re += x.re * *p; }
  void subtract(const Lanes& x, const double* p, int) { re -= x.re * *p; }
  void multiply(const double* p, int) { re *= *p; }
  // this += x y, number by number.
  void add_product(const Lanes& x, const Lanes& y) { re += x.re * y.re; }
  double sum() const {
    double s[lane_count], result = 0.0;
    std::memcpy(s, &re, sizeof s);
    if constexpr (lane_count == 8)
      result = ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));
    else if constexpr (lane_count == 4)
      result = (s[0] + s[2]) + (s[1] + s[3]);
    else
      result = s[0] + s[1];
    return result;
  }
};

template <>
struct Lanes<std::complex<double>> {
  Lane re, im;
  void load(const double* p, int stride) {
    std::memcpy(&re, p, sizeof re);
    std::memcpy(&im, p + stride, sizeof im);
  }
  void store(double* p, int stride) const {
    std::memcpy(p, &re, sizeof re);
    std::memcpy(p + stride, &im, sizeof im);
  }
  void clear() { re = im = Lane{}; }
  void fill(std::complex<double> s) {
    re = Lane{} + s.real();
    im = Lane{} + s.imag();
  }
  std::complex<double> at(int k) const { return {re[k], im[k]}; }
  void take(const LaneMask& mask, const Lanes& x) {
    re = mask ? x.re : re;
    im = mask ? x.im : im;
  }
  void multiply(std::complex<double> s) {
    const Lane r = re * s.real() - im * s.imag();
    im = im * s.real() + re * s.imag();
    re = r;
  }
  void subtract(const Lanes& x, std::complex<double> s) {
    re -= x.re * s.real();
    im -= x.im * s.real();
    re += x.im * s.imag();
    im -= x.re * s.imag();
  }
  static void add_squares(Lane& sum, const Lanes& x, double s) {
    sum += x.re * x.re * s;
    sum += x.im * x.im * s;
  }
  void add(const Lanes& x, const double* p, int stride) {
    re += x.re * p[0];
    im += x.im * p[0];
    re -= x.im * p[stride];
    im += x.re * p[stride];
  }
  void subtract(const Lanes& x, const double* p, int stride) {
    re -= x.re * p[0];
    im -= x.im * p[0];
    re += x.im * p[stride];
    im -= x.re * p[stride];
  }
  void multiply(const double* p, int stride) {
    const Lane r = re * p[0] - im * p[stride];
    im = im * p[0] + re * p[stride];
    re = r;
  }
  void add_product(const Lanes& x, const Lanes& y) {
    re += x.re * y.re;
    re -= x.im * y.im;
    im += x.re * y.im;
    im += x.im * y.re;
  }
  std::complex<double> sum() const { return {Lanes<double>{re}.sum(), Lanes<double>{im}.sum()}; }
};

#if defined(__AVX512F__)
namespace lanes {
inline Lane even(const Lane& a, const Lane& b) {
  return __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
}
inline Lane odd(const Lane& a, const Lane& b) {
  return __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
}
}  // namespace lanes

// The sums of the numbers of each of n <= 8 registers, side by side.
template <int n>
Lane sums_of(const Lane* x) {
  Lane pairs[4] = {}, fours[2] = {};
  for (int k = 0; k < (n + 1) / 2; ++k) {
    const Lane a = x[2 * k], b = 2 * k + 1 < n ? x[2 * k + 1] : Lane{};
    pairs[k] = lanes::even(a, b) + lanes::odd(a, b);
  }
  for (int k = 0; k < (n + 3) / 4; ++k) {
    const Lane a = pairs[2 * k], b = pairs[2 * k + 1];
    fours[k] = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13) +
               __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
  }
  return __builtin_shufflevector(fours[0], fours[1], 0, 1, 2, 3, 8, 9, 10, 11) +
         __builtin_shufflevector(fours[0], fours[1], 4, 5, 6, 7, 12, 13, 14, 15);
}

// Rows to columns, of six registers with zeros in the last two rows.
inline void transpose(Lane* x) {
  using lanes::even;
  using lanes::odd;
  Lane t[6];
  for (int k = 0; k < 6; k += 2) {
    t[k] = even(x[k], x[k + 1]);
    t[k + 1] = odd(x[k], x[k + 1]);
  }
  for (int k = 0; k < 2; ++k) {
    const Lane low = __builtin_shufflevector(t[k], t[k + 2], 0, 1, 8, 9, 2, 3, 10, 11);
    const Lane high = __builtin_shufflevector(t[k], t[k + 2], 4, 5, 12, 13, 6, 7, 14, 15);
    x[k] = __builtin_shufflevector(low, t[k + 4], 0, 1, 2, 3, 8, 9, 14, 15);
    x[k + 2] = __builtin_shufflevector(low, t[k + 4], 4, 5, 6, 7, 10, 11, 14, 15);
    x[k + 4] = __builtin_shufflevector(high, t[k + 4], 0, 1, 2, 3, 12, 13, 14, 15);
  }
}
#endif

}  // namespace mbd
