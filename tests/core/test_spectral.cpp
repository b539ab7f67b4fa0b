#include "libmbd/core/spectral.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "libmbd/core/error.hpp"
#include "tests/support/random.hpp"

namespace mbd::test::test_spectral {
namespace {

using test::eps;
using test::Worst;
using Real = long double;

// The integral of x^n over [-1, 1] by a rule, less the exact one.
Real moment_error(const Quadrature& q, int n) {
  Real sum = 0;
  for (std::size_t i = 0; i < q.points.size(); ++i)
    sum += Real(q.weights[i]) * std::pow(Real(q.points[i]), Real(n));
  return sum - (n % 2 == 0 ? Real(2) / Real(n + 1) : Real(0));
}

// What a Gauss rule of n points misses of x^2n (with the sign turned): 2^(2n+1) n!^4 / ((2n+1) (2n)!^2).
Real gauss_defect(int n) {
  Real f = Real(2) / Real(2 * n + 1);
  for (int k = 1; k <= n; ++k) f *= Real(4) * Real(k) * Real(k) / (Real(n + k) * Real(n + k));
  return f;
}

// Coefficients c of a random polynomial, and its value and slope at x.
struct Polynomial {
  std::vector<Real> c;
  Polynomial(test::Rng& rng, int degree) {
    for (int i = 0; i <= degree; ++i) c.push_back(test::uniform(rng, -1, 1));
  }
  Real operator()(Real x) const {
    Real y = 0;
    for (std::size_t i = c.size(); i-- > 0;) y = y * x + c[i];
    return y;
  }
  Real slope(Real x) const {
    Real y = 0;
    for (std::size_t i = c.size(); i-- > 1;) y = y * x + Real(i) * c[i];
    return y;
  }
};

// Tables in long double: exact to its round-off, where rounded numbers are not, and those of double are they,
// rounded.
TEST(Spectral, LongDoubleTables) {
  constexpr Real tiny = 1e-18L;
  const auto rounded = [](const auto& x) { return x.template cast<double>().eval(); };
  for (int n = 1; n <= 8; ++n) {
    for (const Rule rule : {Rule::gauss, Rule::gauss_lobatto}) {
      const auto t = spectral_table<Real>(n, rule);
      const SpectralTable d = spectral_table(n, rule);
      EXPECT_EQ(rounded(t.d), d.d);
      EXPECT_EQ(rounded(t.l_at_points), d.l_at_points);
      EXPECT_EQ(rounded(t.dl_at_points), d.dl_at_points);
      const int exact = 2 * n - 1;  // degree, of n Gauss points and of n + 1 Lobatto points alike
      Real worst = 0, worst_rounded = 0;
      for (int degree = 0; degree <= exact; ++degree) {
        Real sum = degree % 2 == 0 ? -2 / Real(degree + 1) : 0, sum_rounded = sum;
        for (std::size_t i = 0; i < t.rule.points.size(); ++i) {
          EXPECT_EQ(static_cast<double>(t.rule.points[i]), d.rule.points[i]);
          EXPECT_EQ(static_cast<double>(t.rule.weights[i]), d.rule.weights[i]);
          sum += t.rule.weights[i] * std::pow(t.rule.points[i], Real(degree));
          sum_rounded += Real(d.rule.weights[i]) * std::pow(Real(d.rule.points[i]), Real(degree));
        }
        worst = std::max(worst, std::abs(sum));
        worst_rounded = std::max(worst_rounded, std::abs(sum_rounded));
      }
      EXPECT_LT(worst, tiny) << n;
      if (n > 2) {
        EXPECT_GT(worst_rounded, tiny) << n;
      }
      for (Index i = 0; i < t.l_at_points.rows(); ++i) {
        EXPECT_LT(std::abs(t.l_at_points.row(i).sum() - 1), tiny);
        EXPECT_LT(std::abs(t.dl_at_points.row(i).sum()), 100 * tiny);
      }
    }
  }
}

TEST(Spectral, PointsRiseAreSymmetricAndWeightsSumToTwo) {
  for (int n = 1; n <= 13; ++n) {
    for (const bool lobatto : {false, true}) {
      if (lobatto && n < 2) continue;
      const Quadrature q = lobatto ? gauss_lobatto_rule(n) : gauss_rule(n);
      ASSERT_EQ(q.points.size(), static_cast<std::size_t>(n));
      ASSERT_EQ(q.weights.size(), static_cast<std::size_t>(n));
      Real sum = 0;
      for (std::size_t i = 0; i < q.points.size(); ++i) {
        EXPECT_GT(q.weights[i], 0.0);
        EXPECT_EQ(q.points[i], -q.points[q.points.size() - 1 - i]);
        EXPECT_EQ(q.weights[i], q.weights[q.points.size() - 1 - i]);
        if (i > 0) {
          EXPECT_GT(q.points[i], q.points[i - 1]);
        }
        sum += q.weights[i];
      }
      EXPECT_NEAR(static_cast<double>(sum), 2.0, 2 * eps) << n;
      EXPECT_EQ(q.points.back() == 1.0, lobatto);
    }
  }
}

// Points are the roots they claim to be, to the last bit or so.
TEST(Spectral, PointsAreRootsOfLegendrePolynomials) {
  Worst gauss("gauss", 2 * eps), lobatto("lobatto", 2 * eps);
  for (int n = 1; n <= 12; ++n) {
    const auto N = static_cast<unsigned>(n);
    for (const double x : gauss_rule(n).points) {
      const Real slope =
          n * (x * std::legendre(N, Real(x)) - std::legendre(N - 1, Real(x))) / (Real(x) * x - 1);
      gauss.add(static_cast<double>(std::abs(std::legendre(N, Real(x)) / slope)));
    }
    for (const double x : gauss_lobatto_rule(n + 1).points) {
      if (std::abs(x) == 1.0) continue;
      const Real p = std::legendre(N, Real(x));
      const Real slope = n * (x * p - std::legendre(N - 1, Real(x))) / (Real(x) * x - 1);
      const Real bend = (2 * x * slope - Real(n) * (n + 1) * p) / (1 - Real(x) * x);
      lobatto.add(static_cast<double>(std::abs(slope / bend)));
    }
  }
}

TEST(Spectral, RulesAreExactToTheirDegreeAndNoFurther) {
  Worst gauss("gauss", 4 * eps), lobatto("lobatto", 4 * eps);
  for (int n = 1; n <= 12; ++n) {
    const Quadrature g = gauss_rule(n);
    for (int degree = 0; degree <= 2 * n - 1; ++degree)
      gauss.add(static_cast<double>(std::abs(moment_error(g, degree))));
    EXPECT_NEAR(static_cast<double>(moment_error(g, 2 * n) / -gauss_defect(n)), 1.0, 1e-5) << n;

    const Quadrature l = gauss_lobatto_rule(n + 1);
    for (int degree = 0; degree <= 2 * n - 1; ++degree)
      lobatto.add(static_cast<double>(std::abs(moment_error(l, degree))));
    // N + 1 GLL points overestimate x^2N by (N + 1)/N times what N Gauss points miss.
    EXPECT_NEAR(static_cast<double>(moment_error(l, 2 * n) / gauss_defect(n)), (n + 1.0) / n, 1e-5)
        << n;
  }
}

TEST(Spectral, TabulatedNodesAndWeights) {
  const auto near = [](const std::vector<double>& got, const std::vector<double>& want) {
    ASSERT_EQ(got.size(), want.size());
    for (std::size_t i = 0; i < got.size(); ++i) EXPECT_NEAR(got[i], want[i], eps);
  };
  const double r5 = std::sqrt(0.2), r37 = std::sqrt(3.0 / 7.0);
  near(gauss_lobatto_rule(2).weights, {1, 1});
  near(gauss_lobatto_rule(3).points, {-1, 0, 1});
  near(gauss_lobatto_rule(3).weights, {1.0 / 3, 4.0 / 3, 1.0 / 3});
  near(gauss_lobatto_rule(4).points, {-1, -r5, r5, 1});
  near(gauss_lobatto_rule(4).weights, {1.0 / 6, 5.0 / 6, 5.0 / 6, 1.0 / 6});
  near(gauss_lobatto_rule(5).points, {-1, -r37, 0, r37, 1});
  near(gauss_lobatto_rule(5).weights, {0.1, 49.0 / 90, 32.0 / 45, 49.0 / 90, 0.1});
  // Abramowitz & Stegun, tables 25.6 and 25.4
  near(gauss_lobatto_rule(6).points, {-1, -0.76505532392946469, -0.28523151648064510,
                                      0.28523151648064510, 0.76505532392946469, 1});
  near(gauss_rule(1).points, {0});
  near(gauss_rule(1).weights, {2});
  near(gauss_rule(2).points, {-1 / std::sqrt(3.0), 1 / std::sqrt(3.0)});
  near(gauss_rule(3).points, {-std::sqrt(0.6), 0, std::sqrt(0.6)});
  near(gauss_rule(3).weights, {5.0 / 9, 8.0 / 9, 5.0 / 9});
  near(gauss_rule(4).points,
       {-0.86113631159405258, -0.33998104358485626, 0.33998104358485626, 0.86113631159405258});
  near(gauss_rule(4).weights,
       {0.34785484513745386, 0.65214515486254614, 0.65214515486254614, 0.34785484513745386});
}

// HB (52): d_jk = P_N(xi_j) / (P_N(xi_k) (xi_j - xi_k)), with -+ N (N + 1)/4 in the corners and zero
// elsewhere on the diagonal.
TEST(Spectral, DerivativeMatrixHasItsClosedForm) {
  Worst relative("relative", 8 * eps);
  for (int n = 1; n <= 12; ++n) {
    const SpectralTable t = spectral_table(n, Rule::gauss);
    const std::vector<double>& x = t.nodes.points;
    for (Index j = 0; j <= n; ++j) {
      for (Index k = 0; k <= n; ++k) {
        const Real xj = x[static_cast<std::size_t>(j)], xk = x[static_cast<std::size_t>(k)];
        if (j != k) {
          const auto N = static_cast<unsigned>(n);
          const Real want = std::legendre(N, xj) / std::legendre(N, xk) / (xj - xk);
          relative.add(static_cast<double>(std::abs(Real(t.d(j, k)) / want - 1)));
        } else {
          const double want = j == 0 ? -0.25 * n * (n + 1) : j == n ? 0.25 * n * (n + 1) : 0.0;
          relative.add(std::abs(t.d(j, k) - want) / (n * n));
        }
      }
    }
  }
}

TEST(Spectral, TablesReproducePolynomials) {
  test::Rng rng(1);
  Worst value("value", 8 * eps), slope("slope", 16 * eps), unity("unity", 4 * eps);
  for (int n = 1; n <= 12; ++n) {
    for (const Rule rule : {Rule::gauss, Rule::gauss_lobatto}) {
      const SpectralTable t = spectral_table(n, rule);
      EXPECT_EQ(t.order, n);
      ASSERT_EQ(t.rule.points.size(), static_cast<std::size_t>(rule == Rule::gauss ? n : n + 1));
      ASSERT_EQ(t.nodes.points.size(), static_cast<std::size_t>(n + 1));
      const Polynomial f(rng, n);
      VecX at_nodes(n + 1), slopes(n + 1);
      for (Index k = 0; k <= n; ++k) {
        at_nodes(k) = static_cast<double>(f(t.nodes.points[static_cast<std::size_t>(k)]));
        slopes(k) = static_cast<double>(f.slope(t.nodes.points[static_cast<std::size_t>(k)]));
      }
      const double magnitude = at_nodes.cwiseAbs().maxCoeff() + 1;
      slope.add((t.d * at_nodes - slopes).cwiseAbs().maxCoeff() / (magnitude * n * n));
      unity.add(t.d.rowwise().sum().cwiseAbs().maxCoeff() / (n * n));
      unity.add(t.dl_at_points.rowwise().sum().cwiseAbs().maxCoeff() / (n * n));
      for (Index i = 0; i < t.l_at_points.rows(); ++i) {
        const double xi = t.rule.points[static_cast<std::size_t>(i)];
        unity.add(std::abs(t.l_at_points.row(i).sum() - 1));
        value.add(std::abs(t.l_at_points.row(i).dot(at_nodes) - static_cast<double>(f(xi))) /
                  magnitude);
        slope.add(std::abs(t.dl_at_points.row(i).dot(at_nodes) - static_cast<double>(f.slope(xi))) /
                  (magnitude * n * n));
      }
      for (int sample = 0; sample < 20; ++sample) {
        const double xi = sample == 0 ? -1 : sample == 1 ? 1 : test::uniform(rng, -1, 1);
        const VecX l = lagrange(t.nodes.points, xi), dl = lagrange_derivative(t.nodes.points, xi);
        unity.add(std::abs(l.sum() - 1));
        value.add(std::abs(l.dot(at_nodes) - static_cast<double>(f(xi))) / magnitude);
        slope.add(std::abs(dl.dot(at_nodes) - static_cast<double>(f.slope(xi))) /
                  (magnitude * n * n));
      }
    }
  }
}

TEST(Spectral, LagrangePolynomialsAreOneAtTheirNodeAndZeroAtOthers) {
  for (int n = 1; n <= 12; ++n) {
    const SpectralTable t = spectral_table(n, Rule::gauss_lobatto);
    EXPECT_EQ(t.rule.points, t.nodes.points);
    EXPECT_EQ(t.rule.weights, t.nodes.weights);
    EXPECT_TRUE(t.l_at_points == Eigen::MatrixXd::Identity(n + 1, n + 1)) << n;
    EXPECT_TRUE(t.dl_at_points == t.d) << n;
    for (int k = 0; k <= n; ++k)
      EXPECT_TRUE(lagrange(t.nodes.points, t.nodes.points[static_cast<std::size_t>(k)]) ==
                  VecX::Unit(n + 1, k));
  }
}

// Summation by parts, which makes the collocated rule conservative: W D + D^T W = diag(-1, 0 … 0, 1).
TEST(Spectral, DerivativeMatrixSumsByParts) {
  Worst error("error", 8 * eps);
  for (int n = 1; n <= 12; ++n) {
    const SpectralTable t = spectral_table(n, Rule::gauss_lobatto);
    const Eigen::Map<const VecX> w(t.nodes.weights.data(), n + 1);
    Eigen::MatrixXd Q = w.asDiagonal() * t.d;
    Q += Q.transpose().eval();
    Q(0, 0) += 1;
    Q(n, n) -= 1;
    error.add(Q.cwiseAbs().maxCoeff());
  }
}

TEST(Spectral, RefusesOrdersThatDoNotExist) {
  EXPECT_THROW(spectral_table(0, Rule::gauss), Error);
  EXPECT_THROW(spectral_table(-1, Rule::gauss_lobatto), Error);
  EXPECT_THROW(gauss_rule(0), Error);
  EXPECT_THROW(gauss_lobatto_rule(1), Error);
}

}  // namespace
}  // namespace mbd::test::test_spectral
