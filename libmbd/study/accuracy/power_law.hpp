// How one positive number goes with another: y = constant x^slope.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace mbd {

struct PowerLaw {
  double slope = 0.0;
  double mean_ratio = 0.0;  // geometric mean of y/x
  double spread = 1.0;      // largest departure of a point from the law, as a factor
};

// By least squares of logarithms, of at least two points with different x.
inline PowerLaw fit_power_law(std::span<const std::array<double, 2>> points) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const auto& p : points) {
    const double u = std::log(p[0]), v = std::log(p[1]);
    n += 1, x += u, y += v, xx += u * u, xy += u * v;
  }
  PowerLaw law;
  law.slope = (n * xy - x * y) / (n * xx - x * x);
  law.mean_ratio = std::exp((y - x) / n);
  double off = 0.0;
  for (const auto& p : points)
    off = std::max(off, std::abs(std::log(p[1]) - y / n - law.slope * (std::log(p[0]) - x / n)));
  law.spread = std::exp(off);
  return law;
}

}  // namespace mbd
