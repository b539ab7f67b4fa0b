// C -= A B^T of dense matrices by columns, at a good part of what the processor can do: tiles of C in registers, A and B
// copied into strips that stay in its caches.
#pragma once

#include <cstddef>
#include <vector>

#include "libmbd/core/types.hpp"

namespace mbd {

// Doubles, by columns that are `ld` apart.
struct DenseView {
  double* data = nullptr;
  Index ld = 0;
  double* at(Index row, Index column) const { return data + row + column * ld; }
};

class DenseProduct {
 public:
  // Room for products with at most k columns in A and B and n rows in B, so that none allocates.
  void reserve(Index n, Index k);

  // C (m x n) -= sign A (m x k) B (n x k)^T; or C := -sign A B^T (`fresh`). Rows are taken by whole registers: up to
  // row_slack - 1 rows behind the last of A are read, and those of C written.
  void subtract(const DenseView& C, const DenseView& A, const DenseView& B, Index m, Index n,
                Index k, bool fresh = false, double sign = 1.0);
  static constexpr Index row_slack = 8;

 private:
  std::vector<double> a_, b_;
};

}  // namespace mbd
