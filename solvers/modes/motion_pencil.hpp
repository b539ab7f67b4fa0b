// What eigenmodes.hpp finds eigenvalues of: Q(s) = [K + s C + s^2 M, B^T; B, 0], by its solutions alone.
#pragma once

#include <complex>

#include "libmbd/core/types.hpp"

namespace mbd {

using VecXc = Eigen::VectorXcd;

class MotionPencil {
 public:
  virtual ~MotionPencil() = default;

  virtual Index motions() const = 0;        // in sixes: displacement [m], rotation [rad]
  virtual double length_scale() const = 0;  // displacements over it are compared with rotations [m]
  virtual bool is_damped_or_turns() const = 0;  // C is not zero

  // M x, C x: of motions alone.
  virtual VecX mass_times(const VecX& x) const = 0;
  virtual VecXc mass_times(const VecXc& x) const = 0;
  virtual VecX rate_times(const VecX& x) const = 0;
  virtual VecXc rate_times(const VecXc& x) const = 0;

  // Factors Q(s). False if it is singular.
  virtual bool factor(double s) = 0;
  virtual bool factor(std::complex<double> s) = 0;
  // What comes from factor() is that of its argument's type. x = Q^-1 [b; 0]: the motions alone.
  virtual void solve(VecX& b) const = 0;
  virtual void solve(VecXc& b) const = 0;
};

}  // namespace mbd
