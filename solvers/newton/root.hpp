// The root of a function of one number, where each value costs the solution of equations.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

namespace mbd {

// Root of a continuous f in [a, b] with f(a) f(b) <= 0 (Illinois, with bisection where it stalls). f may fail
// (empty): then that point is taken for the end beyond the root.
template <class F>
double find_root(const F& f, double a, double fa, double b, double fb, double tolerance) {
  double width = b - a;
  for (int k = 0; k < 80 && std::abs(b - a) > tolerance && fa != 0.0; ++k) {
    double x = b - fb * (b - a) / (fb - fa);
    const double low = std::min(a, b), high = std::max(a, b);
    if (!(x > low && x < high) || (k % 8 == 7 && std::abs(b - a) > 0.1 * width)) x = 0.5 * (a + b);
    if (k % 8 == 7) width = std::abs(b - a);
    const std::optional<double> fx = f(x);
    if (!fx) {
      b = x;
      continue;
    }
    if (*fx == 0.0) return x;
    if ((*fx < 0.0) != (fb < 0.0)) {
      a = b;
      fa = fb;
    } else {
      fa *= 0.5;
    }
    b = x;
    fb = *fx;
  }
  return std::abs(fa) < std::abs(fb) ? a : b;
}

}  // namespace mbd
