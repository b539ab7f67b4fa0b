// Which columns of a sparse matrix those before them span, and by what: R of its QR decomposition, without Q.
//
// Rows are merged into R one after another by Givens rotations (George and Heath 1980): R is never fuller than the
// Cholesky factor of A^T A in the same order of columns, and what a row becomes on its way has the pattern of the rows
// it meets. Of the constraints of a chain, a tree or a ladder R is a band, and time and memory go with their number; a
// Householder vector of such a chain grows with each joint instead (measured: 0.07, 0.5 and 4.6 s for 250, 500 and 1000
// bodies by Eigen's SparseQR, which is left-looking).
//
// A column k of length one is set aside when |R_kk|, its distance from the span of those before it, is not above a
// threshold; what else row k of R holds is then merged into the rows below, as if it had just come.
//
// Not used: A^T A itself (squares distances: 1e-8 would be round-off); LU (pivots are not distances).
#pragma once

#include <Eigen/SparseCore>
#include <cstddef>
#include <utility>
#include <vector>

#include "libmbd/core/types.hpp"

namespace mbd {

class RowEchelon {
 public:
  // Of the entries (row, column, value) of A; those of one place are added up. Columns have length one or are empty.
  RowEchelon(const std::vector<Eigen::Triplet<double>>& entries, Index rows, Index columns,
             double threshold);

  bool is_independent(Index column) const {
    return !rows_[static_cast<std::size_t>(column)].empty();
  }

  // Of a column that is set aside: x of A_column = sum_k x_k A_k, by independent columns before it, rising; those
  // that have no part are left out.
  std::vector<std::pair<Index, double>> combination(Index column) const;

 private:
  using Row =
      std::vector<std::pair<Index, double>>;  // column, value; rising, the first is not zero

  void merge(Row row);

  std::vector<Row> rows_;     // of R, by its first column; empty where a column is set aside
  std::vector<Row> columns_;  // the same entries of independent rows by column: row, value; rising
};

}  // namespace mbd
