// RowEchelon against dense linear algebra: the distance of each column from the span of those before it by a dense
// complete orthogonal decomposition, and the column made again of its combination. Matrices are random and sparse, with
// columns that others span, that are empty, that come twice, and with columns nearer to a span than the threshold.

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <random>
#include <vector>

#include "solvers/constraints/row_echelon.hpp"

namespace mbd::test::test_row_echelon {
namespace {

using Dense = Eigen::MatrixXd;
constexpr double threshold = 1e-8;

std::vector<Eigen::Triplet<double>> entries_of(const Dense& A) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Index j = 0; j < A.cols(); ++j)
    for (Index i = 0; i < A.rows(); ++i)
      if (A(i, j) != 0.0) entries.emplace_back(static_cast<int>(i), static_cast<int>(j), A(i, j));
  return entries;
}

double distance(const Dense& of, const VecX& column) {
  if (of.cols() == 0) return column.norm();
  Eigen::CompleteOrthogonalDecomposition<Dense> span(of.rows(), of.cols());
  span.setThreshold(1e-7);
  span.compute(of);
  return (column - of * VecX(span.solve(column))).norm();
}

// Columns of length one, some of them spanned by others.
Dense random_matrix(std::mt19937& random, Index rows, Index columns) {
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  std::uniform_int_distribution<int> kind(0, 9);
  Dense A = Dense::Zero(rows, columns);
  for (Index j = 0; j < columns; ++j) {
    std::uniform_int_distribution<Index> row(0, rows - 1);
    const int of = kind(random);
    if (of == 0) continue;  // empty
    if (of <= 3 && j > 2) {
      std::uniform_int_distribution<Index> other(0, j - 1);
      for (int k = 0; k < of; ++k) A.col(j) += value(random) * A.col(other(random));
      if (of == 3) A(row(random), j) += 1e-11 * value(random);  // nearer than the threshold
    } else {
      for (int k = 0; k < 3; ++k) A(row(random), j) = value(random);
    }
    if (const double length = A.col(j).norm(); length > 1e-3)
      A.col(j) /= length;
    else
      A.col(j).setZero();
  }
  return A;
}

TEST(RowEchelon, IsAsDenseAlgebra) {
  std::mt19937 random(20261123);
  long dependent = 0, independent = 0;
  for (int n = 0; n < 300; ++n) {
    const Dense A = random_matrix(random, 4 + n % 37, 3 + n % 41);
    const RowEchelon R(entries_of(A), A.rows(), A.cols(), threshold);
    Dense kept(A.rows(), 0);
    std::vector<Index> place;
    for (Index j = 0; j < A.cols(); ++j) {
      const double away = distance(kept, A.col(j));
      if (away > 1e-10 && away < 1e-6) break;  // neither
      ASSERT_EQ(R.is_independent(j), away > threshold) << n << " column " << j << ": " << away;
      if (R.is_independent(j)) {
        kept.conservativeResize(Eigen::NoChange, kept.cols() + 1);
        kept.col(kept.cols() - 1) = A.col(j);
        ++independent;
        continue;
      }
      ++dependent;
      VecX made = VecX::Zero(A.rows());
      double most = 1.0;
      for (const auto& [k, x] : R.combination(j)) {
        ASSERT_LT(k, j);
        ASSERT_TRUE(R.is_independent(k));
        made += x * A.col(k);
        most = std::max(most, std::abs(x));
      }
      ASSERT_LT((made - A.col(j)).norm(), 1e-9 * most) << n << " column " << j;
    }
  }
  EXPECT_GT(dependent, 500);
  EXPECT_GT(independent, 2000);
}

}  // namespace
}  // namespace mbd::test::test_row_echelon
