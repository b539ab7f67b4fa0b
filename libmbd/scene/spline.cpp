#include "libmbd/scene/spline.hpp"

#include <unsupported/Eigen/Splines>

namespace mbd {

using Basis = Eigen::Spline<double, 1>;

Spline::Spline(const Eigen::MatrixXd& values, const VecX& at, int degree) : degree_(degree) {
  const Eigen::Array<double, 1, Eigen::Dynamic> u = at.transpose().array();
  Eigen::KnotAveraging(u, degree_, knots_);
  const Index n = values.cols();
  // Row i of A holds the basis functions at u_i that are not zero there, control point j standing at place
  // j - i + degree: a band. A is totally positive, so elimination without exchange of rows is stable (de Boor and Pinkus
  // 1977), and time and memory go with n.
  const Index reach = degree_, width = 2 * reach + 1;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(width, n);  // a column for each row of the matrix
  A(reach, 0) = A(reach, n - 1) = 1.0;
  for (Index i = 1; i + 1 < n; ++i) {
    const Index first = Basis::Span(u(i), degree_, knots_) - degree_ - i + reach;
    A.col(i).segment(first, degree_ + 1) =
        Basis::BasisFunctions(u(i), degree_, knots_).matrix().transpose();
  }
  control_ = values;
  for (Index k = 0; k < n; ++k)
    for (Index i = k + 1; i < std::min(n, k + reach + 1); ++i) {
      const double factor = A(k - i + reach, i) / A(reach, k);
      if (factor == 0.0) continue;
      for (Index j = k; j < std::min(n, k + reach + 1); ++j)
        A(j - i + reach, i) -= factor * A(j - k + reach, k);
      control_.col(i) -= factor * control_.col(k);
    }
  for (Index k = n; k-- > 0;) {
    for (Index j = k + 1; j < std::min(n, k + reach + 1); ++j)
      control_.col(k) -= A(j - k + reach, k) * control_.col(j);
    control_.col(k) /= A(reach, k);
  }
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
