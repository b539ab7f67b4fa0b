#include "tests/support/random.hpp"

namespace mbd::test {

Vec3 random_direction(Rng& rng) {
  std::normal_distribution<double> normal;
  const double x = normal(rng), y = normal(rng), z = normal(rng);
  return Vec3(x, y, z).normalized();
}

double random_angle(Rng& rng, double end) {
  if (uniform(rng, 0, 1) < 1.0 / 3) return end * (1.0 - log_uniform(rng, 1e-13, 0.5));
  return log_uniform(rng, 1e-12, end);
}

Quaternion<double> rotation(double angle, const Vec3& axis) {
  const Vec3 e = std::sin(0.5 * angle) * axis;
  return {std::cos(0.5 * angle), e(0), e(1), e(2)};
}

Pose<double> random_pose(Rng& rng, double distance) {
  return {rotation(uniform(rng, 0, 2 * std::numbers::pi), random_direction(rng)),
          random_vector<3>(rng, distance)};
}

Pose<double> random_relative(Rng& rng, double angle, double distance) {
  Pose<double> g{rotation(angle, random_direction(rng)), distance * random_direction(rng)};
  if (uniform(rng, 0, 1) < 0.5) g.p.coeffs() *= -1.0;
  return g;
}

Mat6 random_spd(Rng& rng, double scale, double length) {
  Mat6 A;
  for (Index i = 0; i < 36; ++i) A(i) = uniform(rng, -1, 1);
  const Eigen::MatrixXd Q = dense::orthonormal(A);
  Vec6 value, unit;
  for (Index i = 0; i < 6; ++i) value(i) = scale * log_uniform(rng, 0.1, 1);
  unit << 1, 1, 1, length, length, length;
  const Mat6 spd = unit.asDiagonal() * Q * value.asDiagonal() * Q.transpose() * unit.asDiagonal();
  return 0.5 * (spd + spd.transpose());
}

Worst::~Worst() {
  testing::Test::RecordProperty(name_, testing::PrintToString(worst_));
  EXPECT_GT(count_, 0) << name_ << " was never measured";
  EXPECT_LE(worst_, tolerance_) << name_ << (where_.empty() ? "" : ", worst at ") << where_;
}

bool Worst::add(double error, const std::string& where) {
  ++count_;
  if (error <= worst_ || std::isnan(worst_)) return false;
  worst_ = error;
  where_ = where;
  return true;
}

}  // namespace mbd::test
