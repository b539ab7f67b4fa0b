// Monodromy matrices of equations whose coefficients are periodic, independent of the library.
#pragma once

#include <Eigen/Core>

namespace mbd::test {

// Solutions of x' = rates(t, x) after a period, from the unit vectors on: by Runge and Kutta's method of order 4.
template <class Rates>
Eigen::MatrixXd monodromy_of(const Rates& rates, Eigen::Index size, double period) {
  constexpr int steps = 20000;
  const double h = period / steps;
  Eigen::MatrixXd x = Eigen::MatrixXd::Identity(size, size);
  for (int i = 0; i < steps; ++i) {
    const double t = i * h;
    const Eigen::MatrixXd k1 = rates(t, x), k2 = rates(t + h / 2, x + h / 2 * k1),
                          k3 = rates(t + h / 2, x + h / 2 * k2), k4 = rates(t + h, x + h * k3);
    x += h / 6 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return x;
}

}  // namespace mbd::test
