#include "libmbd/core/spectral.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "libmbd/core/error.hpp"

namespace mbd {
namespace {

using Real = long double;

// P_n and P'_n at x (|x| < 1 for the derivative).
struct Legendre {
  Real p, dp;
};
Legendre legendre(int n, Real x) {
  Real previous = 1, p = x;
  if (n == 0) return {1, 0};
  for (int k = 2; k <= n; ++k) {
    const Real next = ((2 * k - 1) * x * p - (k - 1) * previous) / k;
    previous = p;
    p = next;
  }
  return {p, n * (previous - x * p) / (1 - x * x)};
}

// The n-th of `count` zeros of f from a close start, by Newton's method.
template <class F>
Real newton(F f, Real x) {
  for (int i = 0; i < 50; ++i) {
    const auto [value, slope] = f(x);
    const Real dx = value / slope;
    x -= dx;
    if (std::abs(dx) < Real(1e-19)) break;
  }
  return x;
}

std::vector<Real> gauss_points(int n) {
  std::vector<Real> x(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    const Real start =
        -std::cos(std::numbers::pi_v<Real> * (Real(i) + Real(0.75)) / (Real(n) + Real(0.5)));
    x[static_cast<std::size_t>(i)] = newton(
        [n](Real y) {
          const Legendre l = legendre(n, y);
          return std::pair{l.p, l.dp};
        },
        start);
  }
  if (n % 2 == 1) x[static_cast<std::size_t>(n / 2)] = 0;
  return x;
}

std::vector<Real> lobatto_points(int count) {
  const int n = count - 1;
  std::vector<Real> x(static_cast<std::size_t>(count));
  x.front() = -1;
  x.back() = 1;
  for (int i = 1; i < n; ++i) {
    const Real start = -std::cos(std::numbers::pi_v<Real> * Real(i) / Real(n));
    x[static_cast<std::size_t>(i)] = newton(
        [n](Real y) {  // P'_n, with (1 - y^2) P'' = 2 y P' - n (n + 1) P
          const Legendre l = legendre(n, y);
          return std::pair{l.dp, (2 * y * l.dp - n * (n + 1) * l.p) / (1 - y * y)};
        },
        start);
  }
  if (count % 2 == 1) x[static_cast<std::size_t>(n / 2)] = 0;
  return x;
}

template <class T>
using VectorX = Eigen::Matrix<T, Eigen::Dynamic, 1>;

template <class Out, class T>
VectorX<Out> lagrange_values(const std::vector<T>& nodes, Real xi) {
  VectorX<Out> l(static_cast<Index>(nodes.size()));
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    Real product = 1;
    for (std::size_t j = 0; j < nodes.size(); ++j)
      if (j != k) product *= (xi - nodes[j]) / (Real(nodes[k]) - nodes[j]);
    l(static_cast<Index>(k)) = static_cast<Out>(product);
  }
  return l;
}

template <class Out, class T>
VectorX<Out> lagrange_slopes(const std::vector<T>& nodes, Real xi) {
  VectorX<Out> l(static_cast<Index>(nodes.size()));
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    Real sum = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (i == k) continue;
      Real product = 1 / (Real(nodes[k]) - nodes[i]);
      for (std::size_t j = 0; j < nodes.size(); ++j)
        if (j != k && j != i) product *= (xi - nodes[j]) / (Real(nodes[k]) - nodes[j]);
      sum += product;
    }
    l(static_cast<Index>(k)) = static_cast<Out>(sum);
  }
  return l;
}

template <class T>
std::vector<T> rounded(const std::vector<Real>& x) {
  return {x.begin(), x.end()};
}

}  // namespace

template <class T>
BasicQuadrature<T> gauss_rule(int points) {
  if (points < 1) throw Error("a Gauss rule has at least one point, not " + std::to_string(points));
  const std::vector<Real> x = gauss_points(points);
  BasicQuadrature<T> q{rounded<T>(x), {}};
  for (const Real xi : x) {
    const Real dp = legendre(points, xi).dp;
    q.weights.push_back(static_cast<T>(2 / ((1 - xi * xi) * dp * dp)));
  }
  return q;
}

template <class T>
BasicQuadrature<T> gauss_lobatto_rule(int points) {
  if (points < 2) {
    throw Error("a Gauss-Lobatto rule has at least two points, not " + std::to_string(points));
  }
  const std::vector<Real> x = lobatto_points(points);
  BasicQuadrature<T> q{rounded<T>(x), {}};
  for (const Real xi : x) {
    const Real p = std::abs(xi) == 1 ? Real(1) : legendre(points - 1, xi).p;
    q.weights.push_back(static_cast<T>(2 / (Real(points) * Real(points - 1) * p * p)));
  }
  return q;
}

template <class T>
BasicSpectralTable<T> spectral_table(int order, Rule rule) {
  if (order < 1) throw Error("the order of an element is at least 1, not " + std::to_string(order));
  BasicSpectralTable<T> table;
  table.order = order;
  table.nodes = gauss_lobatto_rule<T>(order + 1);
  table.rule = rule == Rule::gauss ? gauss_rule<T>(order) : table.nodes;
  const std::vector<Real> nodes = lobatto_points(order + 1);
  const std::vector<Real> points = rule == Rule::gauss ? gauss_points(order) : nodes;
  table.d.resize(order + 1, order + 1);
  for (std::size_t j = 0; j < nodes.size(); ++j)
    table.d.row(static_cast<Index>(j)) = lagrange_slopes<T>(nodes, nodes[j]);
  table.l_at_points.resize(static_cast<Index>(points.size()), order + 1);
  table.dl_at_points.resize(static_cast<Index>(points.size()), order + 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    table.l_at_points.row(static_cast<Index>(i)) = lagrange_values<T>(nodes, points[i]);
    table.dl_at_points.row(static_cast<Index>(i)) = lagrange_slopes<T>(nodes, points[i]);
  }
  return table;
}

template BasicQuadrature<double> gauss_rule<double>(int);
template BasicQuadrature<long double> gauss_rule<long double>(int);
template BasicQuadrature<double> gauss_lobatto_rule<double>(int);
template BasicQuadrature<long double> gauss_lobatto_rule<long double>(int);
template BasicSpectralTable<double> spectral_table<double>(int, Rule);
template BasicSpectralTable<long double> spectral_table<long double>(int, Rule);

VecX lagrange(const std::vector<double>& nodes, double xi) {
  return lagrange_values<double>(nodes, xi);
}
VecX lagrange_derivative(const std::vector<double>& nodes, double xi) {
  return lagrange_slopes<double>(nodes, xi);
}

}  // namespace mbd
