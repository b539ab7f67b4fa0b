#include "tests/support/machine.hpp"

#include <algorithm>
#include <array>
#include <ctime>

namespace mbd::test {
namespace {

double used_cpu() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Products of a small matrix with vectors, each of which needs the one before.
double work() {
  constexpr std::size_t n = 24;
  std::array<std::array<double, n>, n> a{};
  std::array<double, n> x{}, y{};
  for (std::size_t i = 0; i < n; ++i) {
    x[i] = 1.0;
    for (std::size_t j = 0; j < n; ++j) a[i][j] = 1.0 / static_cast<double>(i + j + 1);
  }
  for (int k = 0; k < 20'000; ++k) {
    double largest = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      double sum = 0.0;
      for (std::size_t j = 0; j < n; ++j) sum += a[i][j] * x[j];
      y[i] = sum;
      largest = std::max(largest, sum);
    }
    for (std::size_t i = 0; i < n; ++i) x[i] = y[i] / largest;
  }
  return x[n - 1];
}

double measure() {
  constexpr double quick = 0.004;  // [s] on a machine of speed 1 (tools/calibrate), release build
  double least = 1e300;
  volatile double result = 0.0;  // so that the work is done
  for (int k = 0; k < 3; ++k) {
    const double begun = used_cpu();
    result = result + work();
    least = std::min(least, used_cpu() - begun);
  }
  return std::max(1.0, least / quick);
}

}  // namespace

double machine_factor() {
  static const double factor = measure();
  return factor;
}

}  // namespace mbd::test
