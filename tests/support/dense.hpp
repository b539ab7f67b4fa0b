// Dense linear algebra of the tests. Decompositions are compiled here once: each of them, for each size of a matrix, costs a
// compiler two to fifteen seconds in every file that has it.
#pragma once

#include <Eigen/Core>

#include "libmbd/core/types.hpp"

namespace mbd::test::dense {

// A x = b by LU with full pivoting.
Eigen::VectorXd solve(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
Eigen::VectorXcd solve(const Eigen::MatrixXcd& A, const Eigen::VectorXcd& b);
// The same of several right-hand sides, the columns of B.
Eigen::MatrixXd solve_columns(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
Eigen::MatrixXcd solve_columns(const Eigen::MatrixXcd& A, const Eigen::MatrixXcd& B);
Eigen::MatrixXd inverse(const Eigen::MatrixXd& A);
double determinant(const Eigen::MatrixXd& A);
// Of the determinant, where that is too large or small for a double, too: 1 or -1.
int determinant_sign(const Eigen::MatrixXd& A);
// 1/(|A| |A^-1|) in the 1-norm, as LU with partial pivoting estimates it.
double reciprocal_condition(const Eigen::MatrixXd& A);
// Of A x = b by QR with column pivoting.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
// exp A.
Eigen::MatrixXd exponential(const Eigen::MatrixXd& A);

// Falling.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& A);
// Of a symmetric matrix, rising.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& A);
// Of any square matrix, in no order; A vectors.col(i) = values(i) vectors.col(i).
struct EigenPairs {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;
};
EigenPairs eigenpairs(const Eigen::MatrixXd& A);
EigenPairs eigenpairs(const Eigen::MatrixXcd& A);
// Q of A = Q R.
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& A);
// A x = b of a symmetric, positive definite matrix, by LDL^T and without memory of its own.
Vec6 solve_definite(const Mat6& A, const Vec6& b);

}  // namespace mbd::test::dense
