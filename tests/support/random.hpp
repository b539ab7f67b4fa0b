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

inline Vec3 random_direction(Rng& rng) {
  std::normal_distribution<double> normal;
  const double x = normal(rng), y = normal(rng), z = normal(rng);
  return Vec3(x, y, z).normalized();
}

// Angles log-uniform in [1e-12, end]; one in three close below the end instead.
inline double random_angle(Rng& rng, double end) {
  if (uniform(rng, 0, 1) < 1.0 / 3) return end * (1.0 - log_uniform(rng, 1e-13, 0.5));
  return log_uniform(rng, 1e-12, end);
}

inline Quaternion<double> rotation(double angle, const Vec3& axis) {
  const Vec3 e = std::sin(0.5 * angle) * axis;
  return {std::cos(0.5 * angle), e(0), e(1), e(2)};
}

inline Pose<double> random_pose(Rng& rng, double distance = 1.0) {
  return {rotation(uniform(rng, 0, 2 * std::numbers::pi), random_direction(rng)),
          random_vector<3>(rng, distance)};
}

// The relative pose of a pair: given angle, either sign of the quaternion.
inline Pose<double> random_relative(Rng& rng, double angle, double distance) {
  Pose<double> g{rotation(angle, random_direction(rng)), distance * random_direction(rng)};
  if (uniform(rng, 0, 1) < 0.5) g.p.coeffs() *= -1.0;
  return g;
}

// Symmetric, positive definite, full: eigenvalues within [0.1, 1] * scale when angular rows and columns
// are divided by the length.
inline Mat6 random_spd(Rng& rng, double scale, double length) {
  Mat6 A;
  for (Index i = 0; i < 36; ++i) A(i) = uniform(rng, -1, 1);
  const Eigen::MatrixXd Q = dense::orthonormal(A);
  Vec6 value, unit;
  for (Index i = 0; i < 6; ++i) value(i) = scale * log_uniform(rng, 0.1, 1);
  unit << 1, 1, 1, length, length, length;
  const Mat6 spd = unit.asDiagonal() * Q * value.asDiagonal() * Q.transpose() * unit.asDiagonal();
  return 0.5 * (spd + spd.transpose());
}

// The largest of many errors, checked once at the end of the scope; NaN is the largest of all.
class Worst {
 public:
  Worst(std::string name, double tolerance) : name_(std::move(name)), tolerance_(tolerance) {}
  Worst(const Worst&) = delete;
  Worst& operator=(const Worst&) = delete;
  ~Worst() {
    testing::Test::RecordProperty(name_, testing::PrintToString(worst_));
    EXPECT_GT(count_, 0) << name_ << " was never measured";
    EXPECT_LE(worst_, tolerance_) << name_ << (where_.empty() ? "" : ", worst at ") << where_;
  }

  // Returns whether this is the worst so far.
  bool add(double error, const std::string& where = {}) {
    ++count_;
    if (error <= worst_ || std::isnan(worst_)) return false;
    worst_ = error;
    where_ = where;
    return true;
  }
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
