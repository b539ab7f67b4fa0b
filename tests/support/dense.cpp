#include "tests/support/dense.hpp"

#include <Eigen/Dense>
#include <unsupported/Eigen/MatrixFunctions>

namespace mbd::test::dense {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

VectorXd solve(const MatrixXd& A, const VectorXd& b) { return A.fullPivLu().solve(b); }
VectorXcd solve(const MatrixXcd& A, const VectorXcd& b) { return A.fullPivLu().solve(b); }
MatrixXd solve_columns(const MatrixXd& A, const MatrixXd& B) { return A.fullPivLu().solve(B); }
MatrixXcd solve_columns(const MatrixXcd& A, const MatrixXcd& B) { return A.fullPivLu().solve(B); }
MatrixXd inverse(const MatrixXd& A) { return A.fullPivLu().inverse(); }
double determinant(const MatrixXd& A) { return A.fullPivLu().determinant(); }
int determinant_sign(const MatrixXd& A) {
  const Eigen::FullPivLU<MatrixXd> lu(A);
  const auto sign = [](double x) { return x > 0.0 ? 1 : -1; };
  int product =
      sign(static_cast<double>(lu.permutationP().determinant() * lu.permutationQ().determinant()));
  for (Eigen::Index i = 0; i < A.rows(); ++i) product *= sign(lu.matrixLU()(i, i));
  return product;
}
double reciprocal_condition(const MatrixXd& A) { return Eigen::PartialPivLU<MatrixXd>(A).rcond(); }
VectorXd least_squares(const MatrixXd& A, const VectorXd& b) {
  return A.colPivHouseholderQr().solve(b);
}
MatrixXd exponential(const MatrixXd& A) { return A.exp(); }
VectorXd singular_values(const MatrixXd& A) { return A.jacobiSvd().singularValues(); }
VectorXd eigenvalues(const MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}
EigenPairs eigenpairs(const MatrixXd& A) {
  const Eigen::EigenSolver<MatrixXd> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}
EigenPairs eigenpairs(const MatrixXcd& A) {
  const Eigen::ComplexEigenSolver<MatrixXcd> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}
MatrixXd orthonormal(const MatrixXd& A) { return Eigen::HouseholderQR<MatrixXd>(A).householderQ(); }
Vec6 solve_definite(const Mat6& A, const Vec6& b) { return A.ldlt().solve(b); }

}  // namespace mbd::test::dense
