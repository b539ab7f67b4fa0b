// What eigenmodes.hpp finds eigenvalues of: Q(s) = [K + s C + s^2 M, B^T; B, 0], by its solutions alone.
#pragma once

#include <complex>

#include "libmbd/core/types.hpp"

namespace mbd {

using VecXc = Eigen::VectorXcd;

// Functions of several motions take them as columns.

class MotionPencil {
 public:
  virtual ~MotionPencil() = default;

  virtual Index motions() const = 0;        // in sixes: displacement [m], rotation [rad]
  virtual double length_scale() const = 0;  // displacements over it are compared with rotations [m]
  virtual bool is_damped_or_turns() const = 0;  // C is not zero

  // M X, C X: of motions alone.
  virtual Eigen::MatrixXd mass_times(const Eigen::MatrixXd& X) const = 0;
  virtual Eigen::MatrixXd rate_times(const Eigen::MatrixXd& X) const = 0;
  Eigen::MatrixXcd mass_times(const Eigen::MatrixXcd& X) const {
    return joined(mass_times(Eigen::MatrixXd(X.real())), mass_times(Eigen::MatrixXd(X.imag())));
  }
  Eigen::MatrixXcd rate_times(const Eigen::MatrixXcd& X) const {
    return joined(rate_times(Eigen::MatrixXd(X.real())), rate_times(Eigen::MatrixXd(X.imag())));
  }
  VecXc mass_times(const VecXc& x) const { return mass_times(Eigen::MatrixXcd(x)); }

  // Factors Q(s). False if it is singular.
  virtual bool factor(double s) = 0;
  virtual bool factor(std::complex<double> s) = 0;
  // What comes from factor() is that of its argument's type. X = Q^-1 [B; 0]: the motions alone.
  virtual void solve(Eigen::MatrixXd& B) const = 0;
  virtual void solve(Eigen::MatrixXcd& B) const = 0;

 private:
  static Eigen::MatrixXcd joined(const Eigen::MatrixXd& real, const Eigen::MatrixXd& imaginary) {
    Eigen::MatrixXcd all(real.rows(), real.cols());
    all.real() = real;
    all.imag() = imaginary;
    return all;
  }
};

}  // namespace mbd
