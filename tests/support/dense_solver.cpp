#include "tests/support/dense_solver.hpp"

#include <Eigen/LU>

namespace mbd::test {

struct DenseSolver::Factors {
  Eigen::FullPivLU<Eigen::MatrixXd> lu;
};

FactorStatus DenseSolver::factor() {
  const auto inverse = [](double x) { return x > 0.0 ? 1.0 / x : 1.0; };
  rows_ = S_.cwiseAbs().rowwise().maxCoeff().unaryExpr(inverse);
  columns_ =
      (rows_.asDiagonal() * S_).cwiseAbs().colwise().maxCoeff().transpose().unaryExpr(inverse);
  const auto factors = std::make_shared<Factors>();
  factors->lu.compute(rows_.asDiagonal() * S_ * columns_.asDiagonal());
  lu_ = factors;
  return factors->lu.isInvertible() ? FactorStatus::ok : FactorStatus::singular;
}

Index DenseSolver::singular_row() const {
  if (lu_->lu.isInvertible()) return -1;
  Index row = 0;
  lu_->lu.kernel().col(0).cwiseAbs().maxCoeff(&row);
  return row;
}

void DenseSolver::solve(std::span<double> x) const {
  Eigen::Map<VecX> v(x.data(), static_cast<Index>(x.size()));
  v = columns_.cwiseProduct(VecX(lu_->lu.solve(rows_.cwiseProduct(VecX(v)))));
}

double DenseSolver::reciprocal_condition() const { return lu_->lu.rcond(); }

}  // namespace mbd::test
