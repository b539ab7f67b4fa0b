// The largest eigenpairs of an operator T that is known by its products alone: Krylov's subspaces of blocks, restarted thick
// (Krylov-Schur: Stewart, SIAM J. Matrix Anal. Appl. 23 (2002) 601). With a basis V, orthonormal in <x, y> = x^T W y,
//   T V = V H + F B,   F: what the next block adds to V                                              (1)
// an eigenpair (theta, y) of H is one of T to |B y|/|theta|. A restart keeps the span of the y of largest theta, in which (1)
// holds again. T need not be symmetric; where it is so in W, so is H but for round-off.
//
// A block of four start vectors finds four of a repeated eigenvalue, and lets factors be read once for four solutions. Of more
// there is found by starting again beside what is known, until nothing larger turns up. What a restart does not improve any
// more is at its round-off, which of the smaller theta is a larger share, and is accepted.
//
// Not used: Spectra's GenEigsSolver, which has neither blocks nor a test for round-off. It spent 30 restarts on each of four
// tolerances before it took what was there after the third, and a vector of T V at a time is orthogonalised at the speed of
// memory.
#pragma once

#include <complex>
#include <string>
#include <vector>

#include "libmbd/core/types.hpp"

namespace mbd {

class WeightedOperator {
 public:
  virtual ~WeightedOperator() = default;
  virtual Index size() const = 0;
  virtual Eigen::MatrixXd times(const Eigen::MatrixXd& X) const = 0;  // T X
  virtual Eigen::MatrixXd weigh(const Eigen::MatrixXd& X) const = 0;  // W X
};

struct KrylovWork {
  long products = 0;  // of T and one vector
  long restarts = 0;
  long starts = 0;

  KrylovWork& operator+=(const KrylovWork& other) {
    products += other.products;
    restarts += other.restarts;
    starts += other.starts;
    return *this;
  }
};

// Of the largest eigenvalue; what is smaller is round-off of 0.
inline constexpr double least_share = 1e-13;

struct EigenPairs {
  Eigen::VectorXcd values;  // the largest first
  Eigen::MatrixXcd vectors;
  std::vector<double> residuals;  // |T x - theta x|/|theta x|
  std::string failure;            // empty: none
};

// The `wanted` eigenvalues of largest size, or more; all of them where T is small. Repeated ones as often as they are there.
// Adds to `work`.
EigenPairs largest_eigenpairs(const WeightedOperator& T, Index wanted, KrylovWork& work);

}  // namespace mbd
