#include "libmbd/scene/spline.hpp"

#include <unsupported/Eigen/Splines>

namespace mbd {

using Basis = Eigen::Spline<double, 1>;

Spline::Spline(const Eigen::MatrixXd& values, const VecX& at, int degree) : degree_(degree) {
  const Eigen::Array<double, 1, Eigen::Dynamic> u = at.transpose().array();
  Eigen::KnotAveraging(u, degree_, knots_);
  const Index n = values.cols();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  A(0, 0) = A(n - 1, n - 1) = 1.0;
  for (Index i = 1; i + 1 < n; ++i)
    A.row(i).segment(Basis::Span(u(i), degree_, knots_) - degree_, degree_ + 1) =
        Basis::BasisFunctions(u(i), degree_, knots_).matrix();
  control_ = A.householderQr().solve(values.transpose()).transpose();
  for (const double knot : knots_)
    if (breaks_.empty() || knot > breaks_.back()) breaks_.push_back(knot);
}

VecX Spline::value(double u) const {
  const Index span = Basis::Span(u, degree_, knots_);
  return control_.middleCols(span - degree_, degree_ + 1) *
         Basis::BasisFunctions(u, degree_, knots_).matrix().transpose();
}

VecX Spline::derivative(double u) const {
  const Index span = Basis::Span(u, degree_, knots_);
  return control_.middleCols(span - degree_, degree_ + 1) *
         Basis::BasisFunctionDerivatives(u, 1, degree_, knots_).row(1).matrix().transpose();
}

}  // namespace mbd
