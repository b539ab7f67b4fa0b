#include "tests/support/dense.hpp"

#include <Eigen/Dense>

namespace mbd::test::dense {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

VectorXd solve(const MatrixXd& A, const VectorXd& b) { return A.fullPivLu().solve(b); }
VectorXcd solve(const MatrixXcd& A, const VectorXcd& b) { return A.fullPivLu().solve(b); }
MatrixXd inverse(const MatrixXd& A) { return A.fullPivLu().inverse(); }
double determinant(const MatrixXd& A) { return A.fullPivLu().determinant(); }
VectorXd singular_values(const MatrixXd& A) { return A.jacobiSvd().singularValues(); }
VectorXd eigenvalues(const MatrixXd& A) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
}
MatrixXd orthonormal(const MatrixXd& A) { return Eigen::HouseholderQR<MatrixXd>(A).householderQ(); }
Vec6 solve_definite(const Mat6& A, const Vec6& b) { return A.ldlt().solve(b); }

}  // namespace mbd::test::dense
