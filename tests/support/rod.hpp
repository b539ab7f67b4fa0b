// The differential equations of a geometrically exact rod, integrated in arc length: independent of the
// library's elements. Inertial components n, m of force and moment, section frame (R, r):
//   r' = R t,  R' = R k~,  [t; k] = K0 + D^-1 [R^T n; R^T m]                                         (1)
//   n' = -(f + R f_b),  m' = -r' x n - (c + R c_b)                                                   (2)
// f, c: dead force and moment per length, inertial; f_b, c_b: follower ones, section axes. By the method of
// Runge and Kutta of order 4 with small steps; boundary values by Newton's iteration on the unknown start.
#pragma once

#include <Eigen/Geometry>
#include <functional>

#include "tests/support/dense.hpp"

namespace mbd::test {

using RodVector = Eigen::Matrix<double, 6, 1>;
using RodMatrix = Eigen::Matrix<double, 6, 6>;

struct Rod {
  double length = 1.0;
  std::function<RodMatrix(double)> D;                    // of s
  std::function<RodVector(double)> K0;                   // [1 0 0; k0]
  std::function<RodVector(double)> dead, follower = {};  // [force; moment] per length
};

struct RodState {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d r = Eigen::Vector3d::Zero(), n = Eigen::Vector3d::Zero(),
                  m = Eigen::Vector3d::Zero();
  RodVector sectional() const {
    RodVector S;
    S << R.transpose() * n, R.transpose() * m;
    return S;
  }
};

// From s = 0 to the end, or from the end to 0.
RodState integrate(const Rod& rod, RodState x, int steps, bool backward = false);

// x with f(x) = 0, from a start that Newton's iteration can use; derivatives by central differences.
Eigen::VectorXd root(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& f,
                     Eigen::VectorXd x, const Eigen::VectorXd& scale);

}  // namespace mbd::test
