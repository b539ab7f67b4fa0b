// Random numbers, frames and matrices for tests, and the worst of many errors.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "libmbd/core/se3.hpp"
#include "tests/support/dense.hpp"

namespace mbd::test {

using Rng = std::mt19937_64;

inline constexpr double eps = std::numeric_limits<double>::epsilon();

inline double uniform(Rng& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}
inline double log_uniform(Rng& rng, double low, double high) {
  return std::min(high, std::exp(uniform(rng, std::log(low), std::log(high))));
}

template <int rows>
Matrix<double, rows, 1> random_vector(Rng& rng, double bound = 1.0) {
  Matrix<double, rows, 1> x;
  for (Index i = 0; i < rows; ++i) x(i) = uniform(rng, -bound, bound);
  return x;
}

Vec3 random_direction(Rng& rng);

// Angles log-uniform in [1e-12, end]; one in three close below the end instead.
double random_angle(Rng& rng, double end);

Quaternion<double> rotation(double angle, const Vec3& axis);

Pose<double> random_pose(Rng& rng, double distance = 1.0);

// The relative pose of a pair: given angle, either sign of the quaternion.
Pose<double> random_relative(Rng& rng, double angle, double distance);

// Symmetric, positive definite, full: eigenvalues within [0.1, 1] * scale when angular rows and columns
// are divided by the length.
Mat6 random_spd(Rng& rng, double scale, double length);

// The largest of many errors, checked once at the end of the scope; NaN is the largest of all.
class Worst {
 public:
  Worst(std::string name, double tolerance) : name_(std::move(name)), tolerance_(tolerance) {}
  Worst(const Worst&) = delete;
  Worst& operator=(const Worst&) = delete;
  ~Worst();

  // Returns whether this is the worst so far.
  bool add(double error, const std::string& where = {});
  double worst() const { return worst_; }

 private:
  std::string name_;
  double tolerance_;
  double worst_ = 0.0;
  long count_ = 0;
  std::string where_;
};

// f'(0) and f''(0) by central differences of order 8.
template <class F>
auto first_difference(const F& f, double h) {
  return ((672.0 * (f(h) - f(-h)) - 168.0 * (f(2 * h) - f(-2 * h)) + 32.0 * (f(3 * h) - f(-3 * h)) -
           3.0 * (f(4 * h) - f(-4 * h))) /
          (840.0 * h))
      .eval();
}
template <class F>
auto second_difference(const F& f, double h) {
  return ((-14350.0 * f(0.0) + 8064.0 * (f(h) + f(-h)) - 1008.0 * (f(2 * h) + f(-2 * h)) +
           128.0 * (f(3 * h) + f(-3 * h)) - 9.0 * (f(4 * h) + f(-4 * h))) /
          (5040.0 * h * h))
      .eval();
}

}  // namespace mbd::test
