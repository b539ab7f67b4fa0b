// Dense linear algebra of the tests. Decompositions are compiled here once: each of them costs a compiler two to
// eight seconds in every file that has it.
#pragma once

#include <Eigen/Core>

#include "libmbd/core/types.hpp"

namespace mbd::test::dense {

// A x = b by LU with full pivoting.
Eigen::VectorXd solve(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
Eigen::VectorXcd solve(const Eigen::MatrixXcd& A, const Eigen::VectorXcd& b);
Eigen::MatrixXd inverse(const Eigen::MatrixXd& A);
double determinant(const Eigen::MatrixXd& A);

// Falling.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& A);
// Of a symmetric matrix, rising.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& A);
// Q of A = Q R.
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& A);
// A x = b of a symmetric, positive definite matrix, by LDL^T and without memory of its own.
Vec6 solve_definite(const Mat6& A, const Vec6& b);

}  // namespace mbd::test::dense
