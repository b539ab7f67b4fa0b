#include "libmbd/core/se3.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "elements/metrics.hpp"
#include "libmbd/core/dual.hpp"
#include "tests/support/random.hpp"

namespace {

using namespace mbd;
using test::eps;
using test::random_angle;
using test::Rng;
using test::Worst;
using Real = long double;
using D1 = Dual<double>;
using Eigen::MatrixXd;
using Mat4L = Matrix<Real, 4, 4>;

constexpr double pi = std::numbers::pi;

// --- references in long double: power series of matrices, no formula of the code ---

template <int n>
Matrix<Real, n, n> exponential(Matrix<Real, n, n> X) {
  int squarings = 0;
  for (; X.cwiseAbs().maxCoeff() > 0.1L; ++squarings) X *= 0.5L;
  // expm1 by its series, squared as (1 + e)^2 - 1: small angles keep their digits
  Matrix<Real, n, n> sum = Matrix<Real, n, n>::Zero(), term = Matrix<Real, n, n>::Identity();
  for (int k = 1; k < 24; ++k) {
    term = (term * X / Real(k)).eval();
    sum += term;
  }
  for (; squarings > 0; --squarings) sum = (2 * sum + sum * sum).eval();
  return Matrix<Real, n, n>::Identity() + sum;
}

Mat4L hat4(const Vector6<Real>& U) {
  Mat4L X = Mat4L::Zero();
  X << 0, -U(5), U(4), U(0), U(5), 0, -U(3), U(1), -U(4), U(3), 0, U(2), 0, 0, 0, 0;
  return X;
}

Matrix6<Real> ad(const Vector6<Real>& U) {
  const Mat4L X = hat4(U);
  Matrix3<Real> L;
  L << 0, -U(2), U(1), U(2), 0, -U(0), -U(1), U(0), 0;
  Matrix6<Real> A = Matrix6<Real>::Zero();
  A.topLeftCorner<3, 3>() = A.bottomRightCorner<3, 3>() = X.topLeftCorner<3, 3>();
  A.topRightCorner<3, 3>() = L;
  return A;
}

// T(U) = sum (-U~)^k/(k + 1)!, the definition of (3): exp(-U) d exp(U) = (T dU)~.
Matrix6<Real> tangent_map(const Vector6<Real>& U) {
  const Matrix6<Real> A = ad(U);
  Matrix6<Real> sum = Matrix6<Real>::Identity(), term = sum;
  for (int k = 1; k < 80; ++k) {
    term = (-(term * A) / Real(k + 1)).eval();
    sum += term;
  }
  return sum;
}

// The worst of the rotation and the length-scaled linear parts.
double pose_error(const Pose<double>& g, const Mat4L& want, double length) {
  const Matrix<Real, 3, 3> R = want.topLeftCorner<3, 3>();
  const Vector3<Real> r = want.topRightCorner<3, 1>();
  return static_cast<double>(std::max((g.R().cast<Real>() - R).cwiseAbs().maxCoeff(),
                                      (g.r.cast<Real>() - r).norm() / Real(length)));
}
double dual_matrix_error(const DualMatrix<double>& T, const Matrix6<Real>& want, double length) {
  const Matrix6<Real> error = T.matrix().cast<Real>() - want;
  const Real scale = want.topLeftCorner<3, 3>().cwiseAbs().maxCoeff();
  const Real dual =
      std::max(Real(length) * scale, want.topRightCorner<3, 3>().cwiseAbs().maxCoeff());
  return static_cast<double>(
      std::max({error.topLeftCorner<3, 3>().cwiseAbs().maxCoeff() / scale,
                error.topRightCorner<3, 3>().cwiseAbs().maxCoeff() / dual,
                error.bottomRightCorner<3, 3>().cwiseAbs().maxCoeff() / scale,
                Real(T.matrix().bottomLeftCorner<3, 3>().cwiseAbs().maxCoeff())}));
}

Vec6 random_increment(Rng& rng, double angle, double& length) {
  length = test::log_uniform(rng, 1e-6, 1e3);
  return six<double>(length * test::random_direction(rng), angle * test::random_direction(rng));
}

std::string at(double x) { return testing::PrintToString(x); }

// a dual pose H exp(eps U), written out
Pose<D1> seeded(const Pose<double>& H, const Vec6& U) {
  const Quaternion<double> w(0.0, 0.5 * U(3), 0.5 * U(4), 0.5 * U(5));
  const Quaternion<double> dp = H.p * w;
  const Vec3 dr = H.p * Vec3(linear(U));
  Pose<D1> G;
  G.p = Quaternion<D1>(D1(H.p.w(), dp.w()), D1(H.p.x(), dp.x()), D1(H.p.y(), dp.y()),
                       D1(H.p.z(), dp.z()));
  for (Index i = 0; i < 3; ++i) G.r(i) = D1(H.r(i), dr(i));
  return G;
}
template <class Derived>
auto derivative(const Eigen::MatrixBase<Derived>& x) {
  return x.unaryExpr([](const D1& a) { return a.d; }).template cast<double>().eval();
}
template <class Derived>
auto value(const Eigen::MatrixBase<Derived>& x) {
  return x.unaryExpr([](const D1& a) { return a.v; }).template cast<double>().eval();
}

// Angles around the thresholds of the series, in theta^2.
const double thresholds[] = {0.05, 0.3, 1.0, 4.0, 6.0};
template <class F>
void sample_squares(double end, const F& f) {
  Rng rng(7);
  f(0.0);
  for (int i = 0; i < 3000; ++i) f(test::log_uniform(rng, 1e-24, end));
  for (int i = 0; i < 3000; ++i) f(test::uniform(rng, 0, end));
  for (const double x : thresholds) {
    f(std::nextafter(x, 0.0));
    f(x);
    f(std::nextafter(x, 10.0));
  }
}

// --- coefficients ---

// sum_k 2/(4 pi^2 k^2 - x) with its derivatives; the first four powers of x in closed form.
A2<Real> a2_reference(Real x) {
  constexpr Real P = 4 * std::numbers::pi_v<Real> * std::numbers::pi_v<Real>;
  A2<Real> f{1 / 12.0L + x * (1 / 720.0L + x * (1 / 30240.0L + x / 1209600.0L)),
             1 / 720.0L + x * (2 / 30240.0L + x * 3 / 1209600.0L),
             2 / 30240.0L + x * 6 / 1209600.0L};
  for (int k = 150; k >= 1; --k) {
    const Real c = P * Real(k) * Real(k), s = 2 / (c * c * c * c), y = 1 / (c - x);
    const Real x2 = x * x, x3 = x2 * x, x4 = x2 * x2;
    f.a += s * x4 * y;
    f.da += s * (4 * x3 * y + x4 * y * y);
    f.dda += s * (12 * x2 * y + 8 * x3 * y * y + 2 * x4 * y * y * y);
  }
  return f;
}

TEST(So3, CoefficientA2AndItsDerivatives) {
  // Just above x = 6 the closed forms of the derivatives have lost one and two digits.
  Worst a("a2", 4 * eps), da("da2", 24 * eps), dda("dda2", 160 * eps);
  sample_squares(0.99 * 4 * pi * pi, [&](double x) {
    const A2<Real> want = a2_reference(x);
    const A2<double> got = a2_coefficients(x);
    const double amplification =
        1 / (1 - x / (4 * pi * pi));  // of the rounding of theta near the pole
    const auto error = [&](double g, Real w) {
      return static_cast<double>(std::abs(Real(g) / w - 1)) / amplification;
    };
    a.add(error(got.a, want.a), at(x));
    da.add(error(got.da, want.da), at(x));
    dda.add(error(got.dda, want.dda), at(x));
    EXPECT_EQ(a2_coefficients(x, false).a, got.a);
  });
}

TEST(So3, CoefficientSineRemainder) {
  Worst error("error", 4 * eps);
  sample_squares(9 * pi * pi, [&](double x) {
    Real sum = 0, term = 1;  // (theta - sin theta)/theta^3 = sum (-x)^n/(2n + 3)!
    const Real theta = std::sqrt(Real(x));
    if (x > 1.0) {
      sum = (theta - std::sin(theta)) / (theta * theta * theta);
    } else {
      term /= 6;
      for (int n = 0; n < 20; ++n) {
        sum += term;
        term *= -Real(x) / (Real(2 * n + 4) * Real(2 * n + 5));
      }
    }
    error.add(static_cast<double>(std::abs(Real(sine_remainder(x)) / sum - 1)), at(x));
  });
}

TEST(So3, CoefficientsOfTheHalfAngle) {
  Worst sine("sine", 4 * eps), cosine("cosine", 4 * eps);
  sample_squares(9 * pi * pi, [&](double x) {
    const Real y = std::sqrt(Real(x)) / 2;
    double c, s;
    half_angle(x, c, s);
    const Real want = x > 0 ? std::sin(y) / (2 * y) : 0.5L;
    const Real relative = x <= pi * pi ? std::abs(want) : 0.5L / (1 + y);  // zero at 2 pi
    sine.add(static_cast<double>(std::abs(Real(s) - want) / relative), at(x));
    cosine.add(static_cast<double>(std::abs(Real(c) - std::cos(y))), at(x));
  });
}

// --- exp, log ---

TEST(So3, ExponentialAgainstMatrixExponential) {
  Rng rng(1);
  Worst matrix("matrix", 8 * eps), unit("unit", 4 * eps), vector("vector", 4 * eps);
  for (int i = 0; i < 3000; ++i) {
    const double angle = random_angle(rng, i % 10 == 0 ? 3 * pi : pi);
    const Vec3 psi = angle * test::random_direction(rng);
    const Quaternion<double> p = exp_so3(psi);
    matrix.add(pose_error({p, Vec3::Zero()},
                          exponential<4>(hat4(six<double>(Vec3::Zero(), psi).cast<Real>())), 1),
               at(angle));
    unit.add(std::abs(p.coeffs().squaredNorm() - 1), at(angle));
    // componentwise in the sense of norms: small angles are not lost beside the 1
    const Real half = psi.cast<Real>().norm() / 2;
    const Vector3<Real> want = psi.cast<Real>() * (std::sin(half) / (2 * half));
    if (angle <= pi)
      vector.add(static_cast<double>((p.vec().cast<Real>() - want).norm() / want.norm()),
                 at(angle));
  }
}

TEST(So3, LogarithmInvertsExponential) {
  Rng rng(2);
  Worst relative("relative", 8 * eps), other_sign("other_sign", 0.0), back("back", 8 * eps);
  for (int i = 0; i < 5000; ++i) {
    // the threshold of its series is a half-angle of asin(sqrt(0.0585))
    double angle = i % 5 == 0 ? 2 * std::asin(std::sqrt(0.0585)) * (1 + 1e-15 * (i % 7 - 3))
                              : random_angle(rng, pi);
    angle = std::min(angle, pi * (1 - 4e-16));
    const Vec3 psi = angle * test::random_direction(rng);
    Quaternion<double> p = exp_so3(psi);
    const Vec3 log = log_so3(p);
    EXPECT_LE(log.norm(), pi * (1 + 2 * eps));
    // within rounding of pi the axis may come out either way
    const double error =
        std::min((log - psi).norm(), angle > pi * (1 - 4 * eps) ? (log + psi).norm() : INFINITY);
    relative.add(error / angle, at(angle));
    const Quaternion<double> again = exp_so3(log);
    back.add(std::min((again.coeffs() - p.coeffs()).norm(), (again.coeffs() + p.coeffs()).norm()),
             at(angle));
    p.coeffs() *= -1.0;
    if (p.w() != 0.0) other_sign.add((log_so3(p) - log).norm(), at(angle));
  }
  EXPECT_EQ(log_so3(Quaternion<double>(1, 0, 0, 0)).norm(), 0.0);
  EXPECT_NEAR(log_so3(Quaternion<double>(0, 0, 1, 0))(1), pi, 2 * eps * pi);
  EXPECT_TRUE(exp_so3<double>(Vec3::Zero()).coeffs() == Eigen::Vector4d::UnitW());
}

TEST(Se3, ExponentialAgainstMatrixExponential) {
  Rng rng(3);
  Worst error("error", 8 * eps);
  for (int i = 0; i < 3000; ++i) {
    double length;
    const Vec6 U = random_increment(rng, random_angle(rng, i % 10 == 0 ? 3 * pi : pi), length);
    error.add(pose_error(exp_se3(U), exponential<4>(hat4(U.cast<Real>())), length),
              at(angular(U).norm()));
  }
}

TEST(Se3, LogarithmInvertsExponential) {
  Rng rng(4);
  Worst angle_error("angular", 8 * eps), linear_error("linear", 32 * eps);
  for (int i = 0; i < 3000; ++i) {
    double length;
    const double angle = std::min(random_angle(rng, pi), pi * (1 - 8 * eps));
    const Vec6 U = random_increment(rng, angle, length);
    const Vec6 log = log_se3(exp_se3(U));
    angle_error.add((angular(log) - angular(U)).norm() / angle, at(angle));
    linear_error.add((linear(log) - linear(U)).norm() / length, at(angle));
  }
}

TEST(Se3, TangentMapsAgainstTheirSeries) {
  Rng rng(5);
  Worst T("T", 16 * eps), T_inv("T_inverse", 16 * eps), product("product", 16 * eps);
  for (int i = 0; i < 3000; ++i) {
    double length;
    const double angle = random_angle(rng, i % 10 == 0 ? 1.5 * pi : pi);
    const Vec6 U = random_increment(rng, angle, length);
    const Matrix6<Real> want = tangent_map(U.cast<Real>());
    Vector6<Real> unit;  // inverted in the scaled norm, so that no digits go to the length
    unit << Real(length), Real(length), Real(length), 1, 1, 1;
    const Matrix6<Real> scaled = unit.cwiseInverse().asDiagonal() * want * unit.asDiagonal();
    const Matrix6<Real> inverse = unit.asDiagonal() *
                                  Eigen::Matrix<Real, 6, 6>(scaled).fullPivLu().inverse() *
                                  unit.cwiseInverse().asDiagonal();
    // beyond pi, rounding of the angle is amplified towards the pole at 2 pi
    const double amplification = angle > pi ? 4.0 : 1.0;
    T.add(dual_matrix_error(T_of(U), want, length) / amplification, at(angle));
    T_inv.add(dual_matrix_error(T_inverse(U), inverse, length) / amplification, at(angle));
    Vec6 x = test::random_vector<6>(rng);
    x.head<3>() *= length;
    const Vec6 times = T_inverse_times(U, x) - T_inverse(U) * x;
    T_inv.add(std::max(times.head<3>().norm() / length, times.tail<3>().norm()) / 4, at(angle));
    const Mat6 I = T_inverse(U).matrix() * T_of(U).matrix();
    product.add(dual_matrix_error({I.topLeftCorner<3, 3>(), I.topRightCorner<3, 3>()},
                                  Matrix6<Real>::Identity(), length) /
                    amplification,
                at(angle));
  }
  EXPECT_TRUE(T_of<double>(Vec6::Zero()).matrix() == Mat6::Identity());
  EXPECT_TRUE(T_inverse<double>(Vec6::Zero()).matrix() == Mat6::Identity());
}

// d exp(U) = exp(U) (T(U) dU)~, the left side by dual numbers.
TEST(Se3, DerivativeOfExponential) {
  Rng rng(6);
  Worst exponential_error("exp", 32 * eps), logarithm_error("log", 64 * eps);
  for (int i = 0; i < 3000; ++i) {
    double length;
    const double angle = std::min(random_angle(rng, pi), pi * (1 - 1e-12));
    const Vec6 U = random_increment(rng, angle, length);
    Vec6 dU = test::random_vector<6>(rng);
    dU.head<3>() *= length;
    const Vec6 want = T_of(U) * dU;

    Vector6<D1> X;
    for (Index k = 0; k < 6; ++k) X(k) = D1(U(k), dU(k));
    const Pose<D1> H = exp_se3(X);
    const Pose<double> H0 = exp_se3(U);
    const Mat3 W = H0.R().transpose() * derivative(H.R());
    const Vec3 v = H0.R().transpose() * derivative(H.r);
    exponential_error.add((W - hat(angular(want))).cwiseAbs().maxCoeff(), at(angle));
    exponential_error.add((v - linear(want)).norm() / length, at(angle));

    // and log the other way round: d log = T^-1 z
    const Vec6 z = dU, dlog = derivative(log_se3(seeded(H0, z))), dlog_want = T_inverse(U) * z;
    const double growth = std::max(1.0, dlog_want.tail<3>().norm());
    logarithm_error.add((dlog - dlog_want).tail<3>().norm() / growth, at(angle));
    logarithm_error.add((dlog - dlog_want).head<3>().norm() / (growth * length), at(angle));
  }
}

// One coefficient 10 % off, and the comparison above sees it at once.
TEST(Se3, TangentMapFailsUnderMutation) {
  double length;
  Rng rng(8);
  const Vec6 U = random_increment(rng, 0.3, length);
  DualMatrix<double> T = T_of(U);
  const Mat3 P = hat(angular(U));
  T.A += 0.1 * sine_remainder(angular(U).squaredNorm()) * P * P;
  EXPECT_GT(dual_matrix_error(T, tangent_map(U.cast<Real>()), length), 1e-4);
}

TEST(Se3, PosesComposeAsMatrices) {
  Rng rng(9);
  Worst error("error", 8 * eps), far("far", 16 * eps);
  const auto matrix = [](const Pose<double>& H) {
    Matrix<double, 4, 4> M = Matrix<double, 4, 4>::Identity();
    M.topLeftCorner<3, 3>() = H.R();
    M.topRightCorner<3, 1>() = H.r;
    return M;
  };
  for (int i = 0; i < 300; ++i) {
    const Pose<double> a = test::random_pose(rng), b = test::random_pose(rng);
    const Vec3 x = test::random_vector<3>(rng);
    error.add((matrix(a * b) - matrix(a) * matrix(b)).cwiseAbs().maxCoeff());
    error.add(
        (matrix(inverse(a)) * matrix(a) - Matrix<double, 4, 4>::Identity()).cwiseAbs().maxCoeff());
    error.add((matrix(relative(a, b)) - matrix(inverse(a) * b)).cwiseAbs().maxCoeff());
    error.add((a * x - (a.r + a.R() * x)).norm());
    error.add((a.R() - a.p.toRotationMatrix()).cwiseAbs().maxCoeff());
    // far from the origin the relative position is as good as the stored ones
    Pose<double> c = a, d = b;
    const Vec3 shift = Vec3::Constant(1 << 20);
    c.r += shift;
    d.r += shift;
    const Pose<double> near{d.p, d.r - shift}, near_c{c.p, c.r - shift};
    far.add((relative(c, d).r - relative(near_c, near).r).norm());

    Pose<double> e = a;
    e.p.coeffs() *= 1 + 1e-6;
    renormalize(e);
    EXPECT_NEAR(e.p.norm(), 1.0, 1e-11);
  }
}

// H exp((Ad U)) = exp(U) seen from the base: Ad(g) U is the twist of g exp(U) g^-1.
TEST(Se3, AdjointsAndHats) {
  Rng rng(10);
  Worst error("error", 32 * eps);
  for (int i = 0; i < 300; ++i) {
    const Pose<double> g = test::random_pose(rng);
    const Vec6 U = test::random_vector<6>(rng), V = test::random_vector<6>(rng),
               Q = test::random_vector<6>(rng);
    const Pose<double> moved = g * exp_se3(U) * inverse(g), want = exp_se3<double>(adjoint(g) * U);
    error.add((moved.R() - want.R()).cwiseAbs().maxCoeff());
    error.add((moved.r - want.r).norm());
    error.add((adjoint(g).matrix() * adjoint_inverse(g).matrix() - Mat6::Identity())
                  .cwiseAbs()
                  .maxCoeff());
    error.add((adjoint_inverse(g).matrix() - adjoint(inverse(g)).matrix()).cwiseAbs().maxCoeff());
    error.add((adjoint(g) * U - adjoint(g).matrix() * U).norm());
    error.add((adjoint(g).transpose_times(Q) - adjoint(g).matrix().transpose() * Q).norm());
    error.add((twist_hat(V) - ad(V.cast<Real>()).cast<double>()).cwiseAbs().maxCoeff());
    error.add((wrench_hat(Q) * V - twist_hat(V).transpose() * Q).norm());
    error.add((twist_hat_transpose_times(V, Q) - twist_hat(V).transpose() * Q).norm());
    error.add((axial(hat(linear(U))) - linear(U)).norm());
  }
}

// --- metrics ---

template <class M>
struct Se3Metric : testing::Test {
  // Relative poses at angles up to 0.9 of the metric's range, lengths over many decades.
  template <class F>
  static void sample(int count, const F& f) {
    Rng rng(11);
    for (int i = 0; i < count; ++i) {
      const double angle = random_angle(rng, M::max_angle),
                   length = test::log_uniform(rng, 1e-6, 1e3);
      f(rng, test::random_relative(rng, angle, length), angle, length);
    }
  }
};
using Metrics = testing::Types<MatrixMetric, QuaternionMetric, GeodesicMetric>;
TYPED_TEST_SUITE(Se3Metric, Metrics);

template <class M>
using Pair = typename M::template Pair<double>;

double twist_error(const Vec6& got, const Vec6& want, double length, double scale = 1.0) {
  const Vec6 error = got - want;
  return std::max(error.head<3>().norm() / length, error.tail<3>().norm()) / scale;
}

TYPED_TEST(Se3Metric, ParametersAgainstLongDouble) {
  EXPECT_NEAR(TypeParam::max_angle, (std::is_same_v<TypeParam, MatrixMetric> ? 0.45 : 0.9) * pi,
              1e-15);
  Worst angular_error("angular", 16 * eps), linear_error("linear", 16 * eps), e0("e0", 4 * eps);
  this->sample(2000, [&](Rng&, const Pose<double>& g, double angle, double length) {
    const Pair<TypeParam> pair(g);
    const Vec6 q = pair.q();
    // the exact pose of the rounded quaternion
    const auto c = g.p.coeffs().template cast<Real>().normalized().eval();
    const Real w = std::abs(c(3));
    const Vector3<Real> e = c.template head<3>() * Real(c(3) < 0 ? -1 : 1),
                        r = g.r.template cast<Real>();
    e0.add(static_cast<double>(std::abs(Real(pair.e0) - w)), at(angle));
    Matrix3<Real> E;
    E << 0, -e(2), e(1), e(2), 0, -e(0), -e(1), e(0), 0;
    const Matrix3<Real> R = Matrix3<Real>::Identity() + 2 * w * E + 2 * E * E;
    if constexpr (std::is_same_v<TypeParam, MatrixMetric>) {
      const Vector3<Real> want_angular = 2 * w * e;  // axial R, sin(angle)
      const Vector3<Real> want_linear = (R.trace() * r - R * r) / 2;
      angular_error.add(static_cast<double>((q.tail<3>().cast<Real>() - want_angular).norm() /
                                            want_angular.norm()),
                        at(angle));
      linear_error.add(
          static_cast<double>((q.head<3>().cast<Real>() - want_linear).norm()) / length, at(angle));
    } else if constexpr (std::is_same_v<TypeParam, QuaternionMetric>) {
      const Vector3<Real> want_linear = w * r + r.cross(e);
      angular_error.add(
          static_cast<double>((q.tail<3>().cast<Real>() - 2 * e).norm() / (2 * e.norm())),
          at(angle));
      linear_error.add(
          static_cast<double>((q.head<3>().cast<Real>() - want_linear).norm()) / length, at(angle));
    } else {  // exp(q) must be g
      const Mat4L got = exponential<4>(hat4(q.cast<Real>()));
      linear_error.add(static_cast<double>((got.topRightCorner<3, 1>() - r).norm()) / length,
                       at(angle));
      const Vector3<Real> want_angular = 2 * std::atan2(e.norm(), w) / e.norm() * e;
      angular_error.add(static_cast<double>((q.tail<3>().cast<Real>() - want_angular).norm() /
                                            want_angular.norm()),
                        at(angle));
    }
  });
}

// dq = T^-1(q) U_k - T^-1(-q) U_j;  T^-1(q) - T^-1(-q) = q~;  q_kj = -q_jk;
// T^-1(q) Ad(g^-1) = T^-1(-q), the parts of T^-1(q) transposed.
TYPED_TEST(Se3Metric, Identities) {
  Worst dq("dq", 64 * eps), hat_q("hat_q", 16 * eps), odd("odd", 16 * eps),
      adjoint_law("adjoint", 32 * eps), transposed("transposed", 32 * eps);
  using DualPair = typename TypeParam::template Pair<D1>;
  this->sample(2000, [&](Rng& rng, const Pose<double>& g, double angle, double length) {
    const Pair<TypeParam> pair(g), reverse(inverse(g));
    const Vec6 q = pair.q();
    const DualMatrix<double> T = pair.T_inverse(), Tm = reverse.T_inverse();
    odd.add(twist_error(reverse.q(), -q, length), at(angle));
    transposed.add(
        dual_matrix_error(Tm, T.transposed_parts().matrix().template cast<Real>(), length),
        at(angle));
    const Mat6 skew = twist_hat(q);
    hat_q.add((T.A - Tm.A - skew.topLeftCorner<3, 3>()).cwiseAbs().maxCoeff(), at(angle));
    hat_q.add((T.B - Tm.B - skew.topRightCorner<3, 3>()).cwiseAbs().maxCoeff() / length, at(angle));
    const Mat6 carried = T.matrix() * adjoint_inverse(g).matrix();
    adjoint_law.add(dual_matrix_error(Tm, carried.template cast<Real>(), length), at(angle));

    const Pose<double> Hj = test::random_pose(rng, length), Hk = Hj * g;
    Vec6 Uj = test::random_vector<6>(rng), Uk = test::random_vector<6>(rng);
    Uj.head<3>() *= length;
    Uk.head<3>() *= length;
    const DualPair moved(relative(seeded(Hj, Uj), seeded(Hk, Uk)));
    dq.add(twist_error(derivative(moved.q()), T * Uk - Tm * Uj, length), at(angle));
    EXPECT_LT(twist_error(value(moved.q()), q, length), 16 * eps);
  });
}

template <class S>
void split(const PairForces<S>& forces, Vector6<S>& on_k, Vector6<S>& minus_on_j) {
  on_k = forces.on_k();
  minus_on_j = forces.minus_on_j();
}

// F_k = T^-1(q)^T W, F_j = -T^-1(-q)^T W; d F_k/dz at fixed W by dual numbers.
TYPED_TEST(Se3Metric, ForcesAndTheirLinearization) {
  using DualPair = typename TypeParam::template Pair<D1>;
  Worst force("force", 16 * eps), tangent("tangent", 64 * eps);
  this->sample(1000, [&](Rng& rng, const Pose<double>& g, double angle, double length) {
    Vec6 W = test::random_vector<6>(rng);
    W.head<3>() /= length;  // moments of order 1
    const Pair<TypeParam> pair(g);
    Vec6 Fk, minus_Fj;
    split(pair.forces(W), Fk, minus_Fj);
    const DualMatrix<double> T = pair.T_inverse();
    force.add(twist_error(Fk, T.transpose_times(W), 1 / length), at(angle));
    force.add(twist_error(minus_Fj, T.transposed_parts().transpose_times(W), 1 / length),
              at(angle));

    const Mat6 L = linearized_force(pair, W);
    const Vector6<D1> WD = W.template cast<D1>();
    Mat6 want;
    for (Index c = 0; c < 6; ++c) {
      Vector6<D1> F, other;
      split(DualPair(seeded(g, Vec6::Unit(c))).forces(WD), F, other);
      want.col(c) = derivative(F);
    }
    Vec6 unit;  // force times length, per length or angle
    unit << length, length, length, 1, 1, 1;
    const Mat6 error = unit.asDiagonal() * (L - want) * unit.asDiagonal();
    const double scale = (unit.asDiagonal() * want * unit.asDiagonal()).cwiseAbs().maxCoeff();
    tangent.add(error.cwiseAbs().maxCoeff() / scale, at(angle));
  });
}

// The forces of a pair are f on k and -Ad(g^-1)^T f on j; four blocks of tangent by dual numbers.
TYPED_TEST(Se3Metric, PairTangent) {
  using DualPair = typename TypeParam::template Pair<D1>;
  Worst error("error", 64 * eps);
  double smallest_mutation = INFINITY;
  this->sample(1000, [&](Rng& rng, const Pose<double>& g, double angle, double length) {
    Vec6 W = test::random_vector<6>(rng), unit;
    unit << length, length, length, 1, 1, 1;
    W.head<3>() /= length;
    const Pair<TypeParam> pair(g);
    Vec6 Fk, minus_Fj;
    split(pair.forces(W), Fk, minus_Fj);
    const Mat6 L = linearized_force(pair, W);
    const PairTangent<double> t = pair_tangent(g, Fk, L);

    const Pose<double> Hj = test::random_pose(rng, length), Hk = Hj * g;
    MatrixXd got(12, 12),
        want(12, 12);  // run-time sizes: GCC 12 warns of its own AVX-512 headers otherwise
    got << t.jj, t.jk, t.kj, t.kk;
    for (Index c = 0; c < 12; ++c) {
      const Vec6 Uj = c < 6 ? Vec6(Vec6::Unit(c)) : Vec6(Vec6::Zero());
      const Vec6 Uk = c < 6 ? Vec6(Vec6::Zero()) : Vec6(Vec6::Unit(c - 6));
      Vector6<D1> F, minus;
      split(DualPair(relative(seeded(Hj, Uj), seeded(Hk, Uk))).forces(W.template cast<D1>()), F,
            minus);
      want.col(c) << -derivative(minus), derivative(F);
    }
    VecX both(12);
    both << unit, unit;
    const auto scaled = [&](const MatrixXd& m) {
      return (both.asDiagonal() * m * both.asDiagonal()).cwiseAbs().maxCoeff();
    };
    error.add(scaled(got - want) / scaled(want), at(angle));
    // without f^U, the change of Ad: not the tangent
    got.topLeftCorner<6, 6>() =
        adjoint_inverse(g).matrix().transpose() * L * adjoint_inverse(g).matrix();
    smallest_mutation = std::min(smallest_mutation, scaled(got - want) / scaled(want));
  });
  EXPECT_GT(smallest_mutation, 1e-3) << "the geometric term may be dropped unnoticed";
}

}  // namespace
