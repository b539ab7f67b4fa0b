// What elastic and viscous terms of beams do alike with the pairs and quadrature points of an element.
//
// Residual. Of forces S_i at the quadrature points, weighted by w_i J_i, and the motion parameters q_p of the pairs:
//   W_p = sum_i c_ip w_i J_i S_i,   F = sum_p { F_k += T^-1(q_p)^T W_p,  F_j -= T^-1(-q_p)^T W_p }    (1)
// Tangent. K = sum_i X_i B_i of strips B_i, 6 rows by the unknowns of the element, and the geometric stiffness of the
// pairs (metrics.hpp (4)).                                                                            (2)
//
// Strips are kept transposed, so that columns are contiguous, and worked on by `lanes` rows at a time: all of them, or
// eight where the compiler does not know how many there are (the last of which may be none of the element's).
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <type_traits>

#include "elements/beam/beam_motion.hpp"
#include "elements/element.hpp"

namespace mbd::beam {

template <int N, class S>
struct Strips {
  using Z = Sizes<N>;
  static constexpr int lanes = N > 0 ? 6 * Z::max_nodes : 8;
  static constexpr int padded(int rows) { return (rows + lanes - 1) / lanes * lanes; }
  static constexpr int most = padded(6 * Z::max_nodes);
  using Strip =
      Eigen::Matrix<S, most, 6, Eigen::ColMajor | Eigen::DontAlign>;  // of one point, transposed
  using All = std::array<Strip, Z::max_points>;
  using Lanes = Matrix<S, lanes, 1>;

  // Rows to work on in an element of so many unknowns.
  static int last(int rows) { return N > 0 ? most : padded(rows); }

  static void clear(All& strips, int points, int last) {
    for (int i = 0; i < points; ++i)
      for (int q = 0; q < 6; ++q)
        for (int r = 0; r < last; r += lanes)
          block_at<lanes, 1>(strips[static_cast<std::size_t>(i)], r, q).setZero();
  }

  // Adds c [A B; 0 A] as the block of a node, from A^T and B^T.
  MBD_INLINE static void add(Strip& strip, int node, S c, const Matrix3<S>& At,
                             const Matrix3<S>& Bt) {
    block_at<3, 3>(strip, 6 * node, 0) += c * At;
    block_at<3, 3>(strip, 6 * node + 3, 0) += c * Bt;
    block_at<3, 3>(strip, 6 * node + 3, 3) += c * At;
  }

  // Rows of the columns of a strip from row r, each times a weight.
  template <class Weights>
  MBD_INLINE static Lanes combined(const Strip& strip, int r, const Weights& w) {
    const auto column = [&](int q) { return block_at<lanes, 1>(strip, r, q); };
    return column(0) * w(0) + column(1) * w(1) + column(2) * w(2) + column(3) * w(3) +
           column(4) * w(4) + column(5) * w(5);
  }

  // to = strip C.
  MBD_INLINE static void multiply(const Strip& strip, const Matrix6<S>& C, int last, Strip& to) {
    for (int r = 0; r < last; r += lanes)
      for (int q = 0; q < 6; ++q) block_at<lanes, 1>(to, r, q) = combined(strip, r, C.col(q));
  }

  // sum = sum_i X_i B_i, symmetric, of strips B_i that add() has filled: a node's first three columns have no angular
  // part. By parts of three columns, in registers, of the lower triangle.
  static constexpr bool by_parts =
      std::is_same_v<S, double> && N > 0 && most % lane_count == 0 && !is_pack<S>;
  template <class Square>
  MBD_INLINE static void symmetric_sum(const All& X, const All& B, int points, int rows,
                                       Square& sum) {
    if constexpr (by_parts) {
      sum.resize(rows, rows);
      for (int c = 0; c < most; c += 3) {
        const int first = c / 6 * 6 / lane_count * lane_count;
        for (int r = first; r < most;) {
          const auto part = [&]<int registers>() {
            if (c % 6 == 0)
              add_part<registers, 3>(X, B, points, r, c, sum.data());
            else
              add_part<registers, 6>(X, B, points, r, c, sum.data());
            r += registers * lane_count;
          };
          if (r + 3 * lane_count <= most)
            part.template operator()<3>();
          else
            part.template operator()<1>();
        }
      }
      for (int c = 6; c < most; ++c)
        for (int r = 0; r < c / 6 * 6; ++r) sum(r, c) = sum(c, r);
    } else {
      product_sum(X, B, points, rows, S(1), sum);
    }
  }

  // Three columns of it from c, of some rows from r; terms: of B.
  template <int registers, int terms>
  [[gnu::noinline]] static void add_part(const All& X, const All& B, int points, int r, int c,
                                         double* sum) {
    Lane part[3][static_cast<std::size_t>(registers)] = {};
    for (int i = 0; i < points; ++i) {
      const double* const x = X[static_cast<std::size_t>(i)].data() + r;
      const double* const b = B[static_cast<std::size_t>(i)].data() + c;
#pragma GCC unroll 6
      for (int q = 0; q < terms; ++q) {
        Lane column[static_cast<std::size_t>(registers)];
        std::memcpy(column, x + q * most, sizeof column);
        for (int k = 0; k < 3; ++k)
          for (int n = 0; n < registers; ++n) part[k][n] += column[n] * b[q * most + k];
      }
    }
    for (int k = 0; k < 3; ++k) std::memcpy(sum + r + (c + k) * most, part[k], sizeof part[k]);
  }

  // sum = factor sum_i X_i B_i, (rows x rows), with the sum in registers.
  template <class Square>
  MBD_INLINE static void product_sum(const All& X, const All& B, int points, int rows, S factor,
                                     Square& sum) {
    const int end = last(rows);
    sum.resize(rows, rows);
    Matrix<S, most, 1> column;
    for (Index c = 0; c < rows; ++c) {
      for (int r = 0; r < end; r += lanes) {
        Lanes part = Lanes::Zero();
        for (int i = 0; i < points; ++i) {
          const auto I = static_cast<std::size_t>(i);
          part += combined(X[I], r, B[I].row(c));
        }
        rows_at<lanes>(column, r) = factor * part;
      }
      std::copy_n(column.data(), rows, sum.data() + c * rows);
    }
  }
};

// (1) from the weighted forces, and W of each pair.
template <int N, class S, class Data, class Motion, class Output>
MBD_INLINE void assemble_pairs(const Data& data, int order, int points, const Motion& motion,
                               const std::array<Vector6<S>, Sizes<N>::max_points>& weighted,
                               std::array<Vector6<S>, Sizes<N>::max_pairs>& W, Output& out) {
  for (int p = 0; p < order * (order + 1) / 2; ++p) {
    Vector6<S>& sum = W[static_cast<std::size_t>(p)];
    sum.setZero();
    for (int i = 0; i < points; ++i)
      sum += S(data.c[static_cast<std::size_t>(i * Sizes<N>::max_pairs + p)]) *
             weighted[static_cast<std::size_t>(i)];
  }
  out.r.setZero(6 * (order + 1));
  std::size_t p = 0;
  for (int j = 0; j < order; ++j) {
    for (int k = j + 1; k <= order; ++k, ++p) {
      const PairForces<S> f = motion.pair[p].forces(W[p]);
      rows_at<3>(out.r, 6 * k) += f.force_k;
      rows_at<3>(out.r, 6 * k + 3) += f.moment_k;
      rows_at<3>(out.r, 6 * j) -= f.minus_force_j;
      rows_at<3>(out.r, 6 * j + 3) -= f.minus_moment_j;
    }
  }
}

// Matrix `n` of a row of them, numbers or packs one after the other.
template <class M>
MBD_INLINE M taken(const double* from, int n) {
  using S = typename M::Scalar;
  M m;
  std::memcpy(static_cast<void*>(m.data()),
              from + static_cast<std::size_t>(n) * sizeof(M) / sizeof(double), sizeof(M));
  static_assert(sizeof(M) == sizeof(S) * static_cast<std::size_t>(M::SizeAtCompileTime));
  return m;
}
template <class M>
MBD_INLINE void put(const M& m, double* to, int n) {
  std::memcpy(to + static_cast<std::size_t>(n) * sizeof(M) / sizeof(double),
              static_cast<const void*>(m.data()), sizeof(M));
}

// Adds (1) of weighted forces with T^-1(q_p) that are kept, in a row (A, B) by pairs.
template <int N, class S, class Data, class Output>
MBD_INLINE void add_kept_pairs(const Data& data, int order, int points, const double* kept,
                               const std::array<Vector6<S>, Sizes<N>::max_points>& weighted,
                               Output& out) {
  int p = 0;
  for (int j = 0; j < order; ++j) {
    for (int k = j + 1; k <= order; ++k, ++p) {
      Vector6<S> W = Vector6<S>::Zero();
      for (int i = 0; i < points; ++i)
        W += S(data.c[static_cast<std::size_t>(i * Sizes<N>::max_pairs + p)]) *
             weighted[static_cast<std::size_t>(i)];
      const Vector3<S> n = linear(W), m = angular(W);
      const auto A = taken<Matrix3<S>>(kept, 2 * p), B = taken<Matrix3<S>>(kept, 2 * p + 1);
      rows_at<3>(out.r, 6 * k) += A.transpose() * n;
      rows_at<3>(out.r, 6 * k + 3) += B.transpose() * n + A.transpose() * m;
      rows_at<3>(out.r, 6 * j) -= A * n;
      rows_at<3>(out.r, 6 * j + 3) -= B * n + A * m;
    }
  }
}

// The geometric part of (2).
template <int N, class S, class Motion, class Square>
MBD_INLINE void add_geometric_stiffness(int order, const Motion& motion,
                                        const std::array<DualMatrix<S>, Sizes<N>::max_pairs>& T,
                                        const std::array<Vector6<S>, Sizes<N>::max_pairs>& W,
                                        Square& K) {
  std::size_t p = 0;
  for (int j = 0; j < order; ++j) {
    for (int k = j + 1; k <= order; ++k, ++p) {
      const PairTangent<S> t = pair_tangent(motion.g[p], motion.pair[p].forces(W[p]).on_k(),
                                            linearized_force(motion.pair[p], T[p], W[p]));
      block_at<6, 6>(K, 6 * k, 6 * k) += t.kk;
      block_at<6, 6>(K, 6 * k, 6 * j) += t.kj;
      block_at<6, 6>(K, 6 * j, 6 * k) += t.jk;
      block_at<6, 6>(K, 6 * j, 6 * j) += t.jj;
    }
  }
}

}  // namespace mbd::beam
