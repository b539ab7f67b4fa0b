// LU of a matrix of small blocks along an elimination (elimination.hpp), for real or complex numbers:
//   A = P^T L U,  per pivot j:  D_j = P_j^T L_jj U_jj,  L_ij = D_ij U_jj^-1,  U_ji = L_jj^-1 P_j D_ji,
// with D what elimination has left of A. Rows are exchanged within a pivot only, where its own unknowns ask for it. Left-
// looking: each block is computed once, from A and the factors before it, in registers.
//
// Where many pivots have the same blocks below, they are in fronts (fronts.hpp): dense matrices, by products of matrices.
//
// L_ij and the transposed of U_ji lie alike, by columns, each column in a register or two: both are computed, and used, by the
// same few loops.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "solvers/linear/block_columns.hpp"
#include "solvers/linear/dense_product.hpp"
#include "solvers/linear/elimination.hpp"
#include "solvers/linear/fronts.hpp"

namespace mbd {

// What does not depend on values.
struct BlockLuPlan {
  static constexpr int register_rows = 8;  // rows are padded to a multiple

  struct Pivot {
    int size, stride;         // rows, and rows with padding: 8 or 16
    std::size_t diagonal;     // of D_j, in doubles
    std::size_t below;        // of the first L_ij
    std::size_t first_row;    // in a padded vector
    std::size_t first, last;  // in `rows`
    std::size_t
        first_target;  // D_j; then L_ij and U_ji in the order of `rows`; in a front: not used
    bool merged;
  };
  struct Row {
    std::size_t offset;  // of L_ij, in doubles
    int pivot;
  };
  // A block of A, and its place in one of the factors.
  struct Piece {
    Index source;
    int ld;
    int row, column;  // unknowns of A
    std::int8_t rows, columns;
    std::int8_t place_row, place_column;
  };
  // D_ij -= L_ip U_pj: places of L_ip and L_jp in units of registers, columns of both.
  struct Update {
    std::uint32_t left, right;
    std::int32_t inner;
  };
  std::vector<Pivot> pivots;  // and one more, for the ends
  std::vector<Row> rows;
  std::vector<Piece> pieces;
  std::vector<std::size_t> first_piece;   // by target, twice: of D_ij, of D_ji
  std::vector<std::size_t> first_update;  // by target
  std::vector<Update> updates;
  // The unknowns of a block in a padded vector.
  struct Run {
    std::size_t pivot;  // its first row
    int row, stride;    // within it; its rows
    int first, count;   // unknowns
  };
  std::vector<Run> runs;
  FrontPlan fronts;
  std::size_t padded = 0, diagonals = 0, off_diagonals = 0;  // sizes
  int n = 0;

  BlockLuPlan(const BlockColumns& A, const Elimination& elimination);

 private:
  // `front_of`: by pivot, or -1. Returns the number of targets outside of fronts.
  std::size_t lay_out_pivots(const Elimination& elimination, const std::vector<int>& front_of);
  void lay_out_unknowns(const BlockColumns& A, const Elimination& elimination);
  // Where a block of A belongs: twice its target, and one more for the transposed part.
  std::size_t part_of(int row, int column, const Elimination& elimination,
                      const std::vector<int>& front_of) const;
  void sort_pieces(const BlockColumns& A, const Elimination& elimination,
                   const std::vector<int>& front_of, std::size_t targets);
  void sort_updates(const std::vector<int>& front_of, std::size_t targets);
};

// Of a symmetric matrix, by its pivots: Sylvester's law of inertia (Haynsworth 1968).
struct PivotInertia {
  Index negative = 0;
  // Least eigenvalue of a pivot (of those without exchanges, least diagonal of U), as part of what A has on the diagonal or
  // the pivot has in that row.
  double least = 1.0;
};

template <class T>
class BlockLu {
 public:
  // Refers to the plan.
  explicit BlockLu(const BlockLuPlan& plan);

  // Of diag(scales) A diag(scales), A as BlockColumns lays it out; no scales: of A. False if a pivot is zero or not finite.
  // With `inertia` A is real and symmetric.
  bool factor(const T* A, const double* scales, PivotInertia* inertia = nullptr);

  // x := A^-1 x, x := A^-T x, in the order of A.
  void solve(T* x) const;
  void solve_transposed(T* x) const;

  int determinant_sign() const;  // of a real one

  std::size_t bytes() const;

 private:
  static constexpr std::size_t parts = sizeof(T) / sizeof(double);  // of a number

  void assemble(std::size_t target, double* D, int rows, int stride, int columns, bool turned,
                const T* A, const double* scales);
  bool factor_pivot(std::size_t j, PivotInertia* inertia);
  void add_least(std::size_t j, const double* before, PivotInertia& inertia) const;
  void update_of_front(std::size_t target, double* D, int rows, int stride, int columns, int other,
                       bool turned) const;
  // fronts.cpp
  bool factor_front(std::size_t f, const T* A, const double* scales, PivotInertia* inertia);
  void assemble_front(std::size_t f, const T* A, const double* scales, double* before);
  bool factor_in_front(std::size_t f, std::size_t group, std::size_t member, const double* before,
                       PivotInertia* inertia);
  void update_above(std::size_t f);
  void gather(std::size_t f) const;
  void scatter(std::size_t f, bool below) const;
  void forward_front(std::size_t f, bool transposed) const;
  void backward_front(std::size_t f, bool transposed) const;
  void to_padded(const T* x) const;
  void from_padded(T* x) const;
  template <bool transposed>
  void forward() const;
  template <bool transposed>
  void backward() const;
  std::size_t scalars(std::size_t doubles) const { return doubles * parts; }

  const BlockLuPlan& plan_;
  const double* scales_ = nullptr;
  std::vector<double> diagonal_, lower_, upper_;   // D, L, U^T
  std::vector<double> inverse_;                    // of the diagonal of U, padded
  std::vector<std::int8_t> exchanges_;             // row of D_j that is the k-th of P_j D_j
  std::vector<char> exchanged_;                    // by pivot: it is not the identity
  mutable std::vector<double> x_;                  // padded
  std::vector<double> front_lower_, front_upper_;  // L and U^T of fronts
  std::vector<double> front_update_;               // what a front takes from others
  mutable std::vector<double> front_x_;            // rows of a front
  DenseProduct product_;
};

extern template class BlockLu<double>;
extern template class BlockLu<std::complex<double>>;

}  // namespace mbd
