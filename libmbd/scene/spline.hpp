// Interpolating B-spline of vectors of any size (knots and basis functions from Eigen's Splines, whose own
// curves have a fixed size and are slow to compile for each).
#pragma once

#include <vector>

#include "libmbd/core/types.hpp"

namespace mbd {

class Spline {
 public:
  // Column i of `values` at parameter at(i); these rise from 0 to 1. Knots are means of `degree` neighbouring
  // parameters; 1 <= degree < number of values.
  Spline(const Eigen::MatrixXd& values, const VecX& at, int degree);

  VecX value(double u) const;
  VecX derivative(double u) const;
  const std::vector<double>& breaks() const { return breaks_; }  // distinct knots, 0 … 1

 private:
  Eigen::Index degree_;
  Eigen::Array<double, 1, Eigen::Dynamic> knots_;
  Eigen::MatrixXd control_;
  std::vector<double> breaks_;
};

}  // namespace mbd
