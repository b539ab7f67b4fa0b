// Gauss-Lobatto-Legendre nodes, Gauss and GLL quadrature, Lagrange polynomials through the nodes and
// their derivatives, for any order N (NOTATION.md 3; HB appendix with the printed indices mended:
// nodes are -1, 1 and the zeros of P'_N, Gauss points the zeros of P_N). Computed in long double and
// rounded to T: double, or long double for reference solutions below the round-off of double.
#pragma once

#include <array>
#include <vector>

#include "libmbd/core/choices.hpp"
#include "libmbd/core/types.hpp"

namespace mbd {

// Points in ]-1, 1[ or [-1, 1] in rising order, and weights that sum to 2.
template <class T>
struct BasicQuadrature {
  std::vector<T> points;
  std::vector<T> weights;
};
using Quadrature = BasicQuadrature<double>;
template <class T = double>
BasicQuadrature<T> gauss_rule(int points);  // exact to degree 2 points - 1; points >= 1
template <class T = double>
BasicQuadrature<T> gauss_lobatto_rule(int points);  // exact to degree 2 points - 3; points >= 2

// Tables of an element of order N whose nodes are the N + 1 GLL points.
template <class T>
struct BasicSpectralTable {
  using MatrixX = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  int order = 0;             // N >= 1
  BasicQuadrature<T> nodes;  // GLL, N + 1
  BasicQuadrature<T> rule;   // N Gauss points, or the nodes themselves
  MatrixX d;                 // d(j, k) = l'_k(node j)                    (N + 1 x N + 1)
  MatrixX l_at_points;       // l_k at quadrature point i: (i, k)         (points x N + 1)
  MatrixX dl_at_points;      // l'_k at quadrature point i: (i, k)        (points x N + 1)
};
using SpectralTable = BasicSpectralTable<double>;
template <class T = double>
BasicSpectralTable<T> spectral_table(int order, Rule rule);  // throws Error for order < 1

// All l_k(xi), and all l'_k(xi), of the Lagrange polynomials through given nodes (barycentric weights
// would lose digits at the nodes; products do not).
VecX lagrange(const std::vector<double>& nodes, double xi);
// For steps in time: in double, without memory of its own.
template <std::size_t n>
std::array<double, n> lagrange(const std::array<double, n>& nodes, double t) {
  std::array<double, n> l;
  for (std::size_t k = 0; k < n; ++k) {
    l[k] = 1.0;
    for (std::size_t j = 0; j < n; ++j)
      if (j != k) l[k] *= (t - nodes[j]) / (nodes[k] - nodes[j]);
  }
  return l;
}
VecX lagrange_derivative(const std::vector<double>& nodes, double xi);

}  // namespace mbd
