// Gauss-Lobatto-Legendre nodes, Gauss and GLL quadrature, Lagrange polynomials through the nodes and
// their derivatives, for any order N (formulation.md 3; HB appendix with the printed indices mended:
// nodes are -1, 1 and the zeros of P'_N, Gauss points the zeros of P_N). Computed in long double.
#pragma once

#include <vector>

#include "libmbd/core/types.hpp"

namespace mbd {

enum class Rule { gauss, gauss_lobatto };

// Points in ]-1, 1[ or [-1, 1] in rising order, and weights that sum to 2.
struct Quadrature {
  std::vector<double> points;
  std::vector<double> weights;
};
Quadrature gauss_rule(int points);          // exact to degree 2 points - 1; points >= 1
Quadrature gauss_lobatto_rule(int points);  // exact to degree 2 points - 3; points >= 2

// Tables of an element of order N whose nodes are the N + 1 GLL points.
struct SpectralTable {
  int order = 0;                 // N >= 1
  Quadrature nodes;              // GLL, N + 1
  Quadrature rule;               // N Gauss points, or the nodes themselves
  Eigen::MatrixXd d;             // d(j, k) = l'_k(node j)                    (N + 1 x N + 1)
  Eigen::MatrixXd l_at_points;   // l_k at quadrature point i: (i, k)         (points x N + 1)
  Eigen::MatrixXd dl_at_points;  // l'_k at quadrature point i: (i, k)        (points x N + 1)
};
SpectralTable spectral_table(int order, Rule rule);  // throws Error for order < 1

// All l_k(xi), and all l'_k(xi), of the Lagrange polynomials through given nodes (barycentric weights
// would lose digits at the nodes; products do not).
VecX lagrange(const std::vector<double>& nodes, double xi);
VecX lagrange_derivative(const std::vector<double>& nodes, double xi);

}  // namespace mbd
