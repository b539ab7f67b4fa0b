#include "solvers/time/radau_tableau.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "libmbd/core/spectral.hpp"

namespace mbd {
namespace {

using Long = long double;
using LongMatrix = Eigen::Matrix<Long, Eigen::Dynamic, Eigen::Dynamic>;

// Of a matrix, for a single eigenvalue: across two rows of D - x I; its last component is 1.
template <class S>
Matrix<S, 3, 1> eigenvector(const Mat3& D, S x) {
  const Matrix<S, 3, 1> first(D(0, 0) - x, D(0, 1), D(0, 2)), second(D(1, 0), D(1, 1) - x, D(1, 2));
  // Not cross(), which conjugates.
  const Matrix<S, 3, 1> v(first(1) * second(2) - first(2) * second(1),
                          first(2) * second(0) - first(0) * second(2),
                          first(0) * second(1) - first(1) * second(0));
  return v / v(2);
}

// Three stages in closed form (table 5.6).
struct ThreeStages {
  Vec3 c, b, e;
  Mat3 D, T, T_inv;
  double gamma;
  std::complex<double> mu;

  ThreeStages() {
    const double q = std::sqrt(6.0);
    c << (4.0 - q) / 10.0, (4.0 + q) / 10.0, 1.0;
    Mat3 A;
    A << (88.0 - 7.0 * q) / 360.0, (296.0 - 169.0 * q) / 1800.0, (-2.0 + 3.0 * q) / 225.0,
        (296.0 + 169.0 * q) / 1800.0, (88.0 + 7.0 * q) / 360.0, (-2.0 - 3.0 * q) / 225.0,
        (16.0 - q) / 36.0, (16.0 + q) / 36.0, 1.0 / 9.0;
    b = A.row(2).transpose();
    D = A.inverse();
    e << -(13.0 + 7.0 * q) / 3.0, (-13.0 + 7.0 * q) / 3.0, -1.0 / 3.0;
    // Eigenvalues of D: roots of x^3 - 9 x^2 + 36 x - 60.
    const double third = std::cbrt(3.0), ninth = std::cbrt(9.0);
    gamma = 3.0 - third + ninth;
    mu = {3.0 + 0.5 * (third - ninth), 0.5 * std::sqrt(3.0) * (third + ninth)};
    T.col(0) = eigenvector<double>(D, gamma);
    const Matrix<std::complex<double>, 3, 1> v = eigenvector(D, mu);
    T.col(1) = v.real();
    T.col(2) = v.imag();
    T_inv = T.inverse();
  }
};
const ThreeStages& three_stages() {
  static const ThreeStages t;
  return t;
}

RadauTableau of_three() {
  const ThreeStages& three = three_stages();
  RadauTableau t{.stages = 3, .D = {}, .T = {}, .T_inv = {}};
  std::copy_n(three.c.data(), 3, t.c.begin());
  std::copy_n(three.b.data(), 3, t.b.begin());
  std::copy_n(three.e.data(), 3, t.e.begin());
  t.D.setZero();
  t.T.setZero();
  t.T_inv.setZero();
  t.D.topLeftCorner<3, 3>() = three.D;
  t.T.topLeftCorner<3, 3>() = three.T;
  t.T_inv.topLeftCorner<3, 3>() = three.T_inv;
  t.gamma = three.gamma;
  t.mu[0] = three.mu;
  return t;
}

// P_n - P_(n-1) at x in [-1, 1], and its derivative.
std::array<Long, 2> radau_polynomial(int n, Long x) {
  std::array<Long, 2> before{1.0L, 0.0L}, now{x, 1.0L};  // P_(k-1), P_k with derivatives
  for (int k = 1; k < n; ++k) {
    const Long a = (2.0L * static_cast<Long>(k) + 1.0L) / static_cast<Long>(k + 1),
               b = static_cast<Long>(k) / static_cast<Long>(k + 1);
    const std::array<Long, 2> next{a * x * now[0] - b * before[0],
                                   a * (now[0] + x * now[1]) - b * before[1]};
    before = now;
    now = next;
  }
  return {now[0] - before[0], now[1] - before[1]};
}

// The zeros on [0, 1], rising: one between each two zeros of P_s (between these P_s - P_(s-1) changes its sign), and 1.
template <std::size_t s>
std::array<Long, s> nodes() {
  const auto between = gauss_rule<Long>(static_cast<int>(s)).points;
  std::array<Long, s> c;
  for (std::size_t k = 0; k + 1 < s; ++k) {
    Long low = between[k], high = between[k + 1];
    const bool rises = radau_polynomial(s, high)[0] > 0.0L;
    for (int i = 0; i < 10; ++i) {
      const Long middle = 0.5L * (low + high);
      ((radau_polynomial(s, middle)[0] > 0.0L) == rises ? high : low) = middle;
    }
    Long x = 0.5L * (low + high);
    for (int i = 0; i < 6; ++i) {
      const auto [value, slope] = radau_polynomial(s, x);
      x -= value / slope;
    }
    c[k] = 0.5L * (x + 1.0L);
  }
  c[s - 1] = 1.0L;
  return c;
}

// Of the Lagrange polynomials through the nodes: derivatives at one of the nodes, and values at x.
template <std::size_t n>
std::array<Long, n> slopes(const std::array<Long, n>& at, std::size_t node) {
  std::array<Long, n> d{};
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < n; ++i) {
      if (i == k) continue;
      Long product = 1.0L / (at[k] - at[i]);
      for (std::size_t j = 0; j < n; ++j)
        if (j != k && j != i) product *= (at[node] - at[j]) / (at[k] - at[j]);
      d[k] += product;
    }
  return d;
}
template <std::size_t n>
std::array<Long, n> values(const std::array<Long, n>& at, Long x) {
  std::array<Long, n> l;
  for (std::size_t k = 0; k < n; ++k) {
    l[k] = 1.0L;
    for (std::size_t j = 0; j < n; ++j)
      if (j != k) l[k] *= (x - at[j]) / (at[k] - at[j]);
  }
  return l;
}

// Eigenvalues and vectors of D, in the order that RadauTableau has.
void uncouple(const LongMatrix& D, RadauTableau& t) {
  const Index s = D.rows();
  const Eigen::EigenSolver<LongMatrix> found(D);
  const auto& x = found.eigenvalues();
  const Eigen::Matrix<std::complex<Long>, Eigen::Dynamic, Eigen::Dynamic> vectors =
      found.eigenvectors();
  std::array<Index, RadauTableau::most_stages> order;
  Index count = 0;
  for (Index i = 0; i < s; ++i)
    if (x(i).imag() >= 0.0L) order[static_cast<std::size_t>(count++)] = i;
  // The real one has the smallest angle, and angles rise with imaginary parts.
  std::sort(order.begin(), order.begin() + count,
            [&](Index i, Index j) { return x(i).imag() < x(j).imag(); });
  std::reverse(order.begin() + 1, order.begin() + count);
  LongMatrix T(s, s);
  for (Index k = 0; k < count; ++k) {
    const Index i = order[static_cast<std::size_t>(k)];
    const Eigen::Matrix<std::complex<Long>, Eigen::Dynamic, 1> v =
        vectors.col(i) / vectors(s - 1, i);
    if (k == 0) {
      t.gamma = static_cast<double>(x(i).real());
      T.col(0) = v.real();
      continue;
    }
    t.mu[static_cast<std::size_t>(k - 1)] = {static_cast<double>(x(i).real()),
                                             static_cast<double>(x(i).imag())};
    T.col(2 * k - 1) = v.real();
    T.col(2 * k) = v.imag();
  }
  t.T.topLeftCorner(s, s) = T.cast<double>();
  t.T_inv.topLeftCorner(s, s) = LongMatrix(T.inverse()).cast<double>();
}

template <std::size_t s>
RadauTableau of() {
  RadauTableau t{.stages = s, .D = {}, .T = {}, .T_inv = {}};
  t.D.setZero();
  t.T.setZero();
  t.T_inv.setZero();
  const std::array<Long, s> c = nodes<s>();
  std::array<Long, s + 1> with_start{};
  std::copy(c.begin(), c.end(), with_start.begin() + 1);
  LongMatrix D(s, s);
  for (std::size_t j = 0; j < s; ++j) {
    const auto slope = slopes(with_start, j + 1);
    for (std::size_t l = 0; l < s; ++l)
      D(static_cast<Index>(j), static_cast<Index>(l)) = slope[l + 1];
  }
  const std::array<Long, s> at_start = values(c, 0.0L);
  const auto rule = gauss_rule<Long>(static_cast<int>(s));
  std::array<Long, s> b{}, e{};
  for (std::size_t i = 0; i < s; ++i) {
    const auto l = values(c, 0.5L * (rule.points[i] + 1.0L));
    for (std::size_t k = 0; k < s; ++k) b[k] += 0.5L * rule.weights[i] * l[k];
    for (std::size_t k = 0; k < s; ++k)
      e[k] -= at_start[i] * D(static_cast<Index>(i), static_cast<Index>(k));
  }
  for (std::size_t k = 0; k < s; ++k) {
    t.c[k] = static_cast<double>(c[k]);
    t.b[k] = static_cast<double>(b[k]);
    t.e[k] = static_cast<double>(e[k]);
  }
  t.D.topLeftCorner(s, s) = D.cast<double>();
  uncouple(D, t);
  return t;
}

}  // namespace

const RadauTableau& radau_tableau(std::size_t stages) {
  static const RadauTableau three = of_three();
  if (stages == 3) return three;
  static const RadauTableau five = of<5>(), seven = of<7>();
  return stages == 5 ? five : seven;
}

}  // namespace mbd
