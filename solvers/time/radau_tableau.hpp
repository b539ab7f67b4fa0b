// The constants of Radau IIA with 3, 5 or 7 stages, of order 5, 9, 13 (Hairer & Wanner II, IV.5; J. Comput. Appl. Math.
// 111 (1999)): collocation at the zeros c_1 … c_s = 1 of P_s - P_(s-1), Legendre's polynomials on [0, 1].
#pragma once

#include <array>
#include <complex>
#include <cstddef>

#include "libmbd/core/types.hpp"

namespace mbd {

struct RadauTableau {
  static constexpr std::size_t most_stages = 7;
  static constexpr Index most = most_stages;

  std::size_t stages;
  std::array<double, most_stages> c{}, b{};  // nodes, weights
  // (1/h) sum e_l q_l is what the derivative of the polynomial through 0 and q_1 … q_s lacks of zero at the start: the
  // error that is estimated.
  std::array<double, most_stages> e{};
  // The inverse of the tableau's A: derivatives at the nodes of the polynomials through 0 and them. And what uncouples
  // the stages: D = T diag(gamma, blocks of mu) T^-1, with the real and the imaginary part of mu's eigenvector, whose last
  // components are 1 and 0, as columns 1 + 2k, 2 + 2k.
  Eigen::Matrix<double, most, most> D, T, T_inv;
  double gamma = 0.0;
  std::array<std::complex<double>, most_stages / 2>
      mu{};  // by falling size; (stages - 1)/2 of them

  int order() const { return 2 * static_cast<int>(stages) - 1; }
  std::size_t pairs() const { return stages / 2; }
};

// Of 3, 5 or 7 stages: to round-off.
const RadauTableau& radau_tableau(std::size_t stages);

}  // namespace mbd
