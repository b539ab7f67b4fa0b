// T(U) x without its matrix: against the series that defines T, against T_of(), and its derivatives.
#include "libmbd/core/se3.hpp"

#include <gtest/gtest.h>

#include "libmbd/core/dual.hpp"
#include "tests/support/random.hpp"

namespace mbd::test::test_se3_rates {
namespace {

using test::eps;
using test::Rng;
using test::Worst;
using Real = long double;
using D1 = Dual<double>;

template <class S>
Matrix6<S> ad(const Vector6<S>& U) {
  Matrix6<S> A = Matrix6<S>::Zero();
  A.template topLeftCorner<3, 3>() = A.template bottomRightCorner<3, 3>() = hat(angular(U));
  A.template topRightCorner<3, 3>() = hat(linear(U));
  return A;
}

Real magnitude(Real x) { return std::abs(x); }
Real magnitude(const Dual<Real>& x) { return std::max(std::abs(x.v), std::abs(x.d)); }

// T(U) x = sum (-U~)^k x / (k + 1)!: the definition, in long double; with duals, its derivative. Up to terms of 1e-24 of the sum,
// linear and angular parts by themselves: what follows is less than all of them.
template <class S>
Vector6<S> series(const Vector6<S>& U, const Vector6<S>& x) {
  const Matrix6<S> A = ad(U);
  Vector6<S> sum = x, term = x;
  const auto largest = [](const Vector6<S>& of, Index part) {
    Real most = 0.0L;
    for (Index i = part; i < part + 3; ++i) most = std::max(most, magnitude(of(i)));
    return most;
  };
  for (int k = 1; k < 80; ++k) {
    term = (-(A * term) / S(k + 1)).eval();
    sum += term;
    if (largest(term, 0) <= 1e-24L * largest(sum, 0) &&
        largest(term, 3) <= 1e-24L * largest(sum, 3))
      break;
  }
  return sum;
}

// Angles log-uniform in [1e-12, 3] and around the thresholds of the series, 0.05 and 4 in theta^2.
template <class F>
void sample(const F& f) {
  Rng rng(11);
  for (int i = 0; i < 20000; ++i) {
    double angle = test::log_uniform(rng, 1e-12, 3.0);
    if (i % 4 == 1) angle = std::sqrt(0.05) * (1.0 + test::uniform(rng, -1e-3, 1e-3));
    if (i % 4 == 2) angle = 2.0 * (1.0 + test::uniform(rng, -1e-3, 1e-3));
    const double length = test::log_uniform(rng, 1e-6, 1e3);
    const Vec6 U =
        six<double>(length * test::random_direction(rng), angle * test::random_direction(rng));
    Vec6 x = test::random_vector<6>(rng);
    x.head<3>() *= length;
    f(U, x, length, angle);
  }
}

// Largest component of an error, of linear parts in lengths.
template <class V>
double size(const V& e, double length) {
  return static_cast<double>(std::max(e.template head<3>().cwiseAbs().maxCoeff() / length,
                                      e.template tail<3>().cwiseAbs().maxCoeff()));
}

TEST(TTimes, IsTheSeries) {
  Worst worst("T x in ulp", 4.0), matrix("T_of() x in ulp", 5.0);
  sample([&](const Vec6& U, const Vec6& x, double length, double angle) {
    const Vector6<Real> want = series<Real>(U.cast<Real>(), x.cast<Real>());
    const Vec6 got = T_times<double>(U, x);
    worst.add(size((got.cast<Real>() - want).eval(), length) / eps,
              "angle " + testing::PrintToString(angle));
    matrix.add(size((got - T_of<double>(U) * x).eval(), length) / eps,
               "angle " + testing::PrintToString(angle));
  });
}

// Coefficients are rounded to double.
TEST(TTimes, OfLongDoubles) {
  Worst worst("T x of long doubles in ulp of double", 1.0);
  sample([&](const Vec6& U, const Vec6& x, double length, double angle) {
    const Vector6<Real> u = U.cast<Real>(), y = x.cast<Real>();
    worst.add(size((T_times<Real>(u, y) - series<Real>(u, y)).eval(), length) / eps,
              "angle " + testing::PrintToString(angle));
  });
}

// d/dt (T(U) x) with U' and x': the series in duals of long doubles.
TEST(TTimes, OfDualsIsTheRate) {
  using DL = Dual<Real>;
  Rng rng(12);
  Worst values("value in ulp", 4.0), rates("rate in ulp", 8.0);
  sample([&](const Vec6& U, const Vec6& x, double length, double angle) {
    Vec6 dU = test::random_vector<6>(rng), dx = test::random_vector<6>(rng);
    dU.head<3>() *= length;
    dx.head<3>() *= length;
    Vector6<D1> u, y;
    Vector6<DL> U_long, y_long;
    for (Index i = 0; i < 6; ++i) {
      u(i) = D1{U(i), dU(i)};
      y(i) = D1{x(i), dx(i)};
      U_long(i) = DL{Real(U(i)), Real(dU(i))};
      y_long(i) = DL{Real(x(i)), Real(dx(i))};
    }
    const Vector6<DL> want = series<DL>(U_long, y_long);
    const Vector6<D1> got = T_times<D1>(u, y);
    Vector6<Real> value, rate;
    for (Index i = 0; i < 6; ++i) {
      value(i) = Real(got(i).v) - want(i).v;
      rate(i) = Real(got(i).d) - want(i).d;
    }
    const std::string where = "angle " + testing::PrintToString(angle);
    values.add(size(value, length) / eps, where);
    rates.add(size(rate, length) / eps, where);
  });
}

// And back: T^-1(U) (T(U) x) = x.
TEST(TTimes, IsUndoneByTheInverse) {
  Worst worst("T^-1 T x in ulp", 6.0);
  sample([&](const Vec6& U, const Vec6& x, double length, double angle) {
    worst.add(size((T_inverse_times<double>(U, T_times<double>(U, x)) - x).eval(), length) / eps,
              "angle " + testing::PrintToString(angle));
  });
}

TEST(TTimes, OfZeroIsTheIdentity) {
  const Vec6 x = Vec6::LinSpaced(1.0, 6.0);
  EXPECT_TRUE((T_times<double>(Vec6::Zero(), x).array() == x.array()).all());
}

}  // namespace
}  // namespace mbd::test::test_se3_rates
