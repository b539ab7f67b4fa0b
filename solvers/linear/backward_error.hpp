// How well A x = b holds, by groups of rows (block_solver.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <vector>

#include "libmbd/core/types.hpp"
#include "solvers/linear/block_columns.hpp"

namespace mbd {

template <class T>
class BackwardError {
 public:
  // r := b - A x. The largest error of a group; 0 if there is nothing to judge by: b and x are zero.
  double operator()(const BlockColumns& columns, const T* A, const T* b, const T* x,
                    std::vector<T>& r) {
    const auto n = static_cast<std::size_t>(columns.n);
    r.assign(b, b + n);
    size_.resize(n);
    for (std::size_t i = 0; i < n; ++i) size_[i] = std::abs(b[i]);
    // What is at rest among what moves is known to the round-off of that.
    constexpr double small = 1e-4;
    std::array<double, 3> largest{};
    for_groups(columns, [&](std::size_t begin, std::size_t end, std::size_t kind) {
      for (std::size_t i = begin; i < end; ++i)
        largest[kind] = std::max(largest[kind], std::abs(x[i]));
    });
    // What constraints hold at rest is known to the round-off of what would move it.
    for (int c = 0; c < columns.blocks(); ++c) {
      const auto C = static_cast<std::size_t>(c);
      if (columns.kinds[C] == 0) continue;
      for (int i = 0; i < columns.size(c); ++i) {
        double size = 0.0;  // of the column of this motion, among nodes
        for (std::size_t e = columns.begin[C]; e < columns.begin[C + 1]; ++e) {
          if (columns.kinds[static_cast<std::size_t>(columns.entries[e].row)] == 0) continue;
          const T* const column = A + columns.entries[e].offset + i * columns.height[C];
          size = std::max(size, largest_of(column, columns.size(columns.entries[e].row)));
        }
        const double moves = magnitude(b[columns.first[C] + i]) / size;
        double& most = largest[columns.size(c) != 6 ? 2 : i < 3 ? 0 : 1];
        if (size > 0.0 && moves > most) most = moves;
      }
    }
    absolute_.resize(n);
    for_groups(columns, [&](std::size_t begin, std::size_t end, std::size_t kind) {
      for (std::size_t i = begin; i < end; ++i)
        absolute_[i] = std::abs(x[i]) + small * largest[kind];
    });
    for (int c = 0; c < columns.blocks(); ++c) {
      const auto C = static_cast<std::size_t>(c);
      const auto X = static_cast<std::size_t>(columns.first[C]);
      for (std::size_t e = columns.begin[C]; e < columns.begin[C + 1]; ++e) {
        const auto R = static_cast<std::size_t>(columns.entries[e].row);
        const auto first = static_cast<std::size_t>(columns.first[R]);
        const int rows = columns.size(columns.entries[e].row);
        const T* const block = A + columns.entries[e].offset;
        if (rows == 6)
          add<6>(block, columns.height[C], 6, columns.size(c), x + X, absolute_.data() + X,
                 r.data() + first, size_.data() + first);
        else
          add<0>(block, columns.height[C], rows, columns.size(c), x + X, absolute_.data() + X,
                 r.data() + first, size_.data() + first);
      }
    }
    return worst_of(columns, r);
  }

 private:
  double worst_of(const BlockColumns& columns, const std::vector<T>& r) const {
    double worst = 0.0;
    bool finite = true;
    for_groups(columns, [&](std::size_t begin, std::size_t end, std::size_t) {
      double error = 0.0, size = 0.0;
      for (std::size_t i = begin; i < end; ++i) {
        const double one = std::abs(r[i]);
        finite = finite && std::isfinite(one);
        error = std::max(error, one);
        size = std::max(size, size_[i]);
      }
      if (size > 0.0) worst = std::max(worst, error / size);
    });
    return finite ? worst : std::numeric_limits<double>::infinity();
  }

  template <int fixed>
  static void add(const T* block, Index ld, int rows, int columns, const T* x,
                  const double* absolute, T* r, double* size) {
    if constexpr (fixed == 6 && std::is_same_v<T, double>) {
      Vec6 sum = Eigen::Map<const Vec6>(r), sizes = Eigen::Map<const Vec6>(size);
      for (int j = 0; j < columns; ++j) {
        const Eigen::Map<const Vec6> column(block + j * ld);
        sum -= column * x[j];
        sizes += column.cwiseAbs() * absolute[j];
      }
      Eigen::Map<Vec6>(r).noalias() = sum;
      Eigen::Map<Vec6>(size).noalias() = sizes;
      return;
    }
    const int n = fixed > 0 ? fixed : rows;
    T sum[6];
    double sizes[6];
    for (int i = 0; i < n; ++i) {
      sum[i] = r[i];
      sizes[i] = size[i];
    }
    for (int j = 0; j < columns; ++j) {
      const T X = x[j];
      for (int i = 0; i < n; ++i) {
        sum[i] -= times(block[j * ld + i], X);
        sizes[i] += magnitude(block[j * ld + i]) * absolute[j];
      }
    }
    for (int i = 0; i < n; ++i) {
      r[i] = sum[i];
      size[i] = sizes[i];
    }
  }
  // Of the numbers from x on. Of six real ones three maxima go at once.
  static double largest_of(const T* x, int count) {
    if constexpr (std::is_same_v<T, double>)
      if (count == 6) {
        double pair[3];
        for (int k = 0; k < 3; ++k) pair[k] = std::max(std::abs(x[k]), std::abs(x[k + 3]));
        return std::max(pair[0], std::max(pair[1], pair[2]));
      }
    double size = 0.0;
    for (int k = 0; k < count; ++k) size = std::max(size, magnitude(x[k]));
    return size;
  }
  static double times(double a, double b) { return a * b; }
  static std::complex<double> times(std::complex<double> a, std::complex<double> b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
  }
  static double magnitude(double x) { return std::abs(x); }
  static double magnitude(std::complex<double> x) {
    return std::abs(x.real()) + std::abs(x.imag());
  }

  template <class Use>
  static void for_groups(const BlockColumns& columns, const Use& use) {
    for (int b = 0; b < columns.blocks(); ++b) {
      const auto B = static_cast<std::size_t>(b);
      const auto first = static_cast<std::size_t>(columns.first[B]),
                 end = static_cast<std::size_t>(columns.first[B + 1]);
      if (columns.kinds[B] != 0 && end - first == 6) {
        use(first, first + 3, 0);
        use(first + 3, end, 1);
      } else {
        use(first, end, 2);
      }
    }
  }

  std::vector<double> size_;      // |A| |x| + |b|
  std::vector<double> absolute_;  // |x|, and a little more
};

}  // namespace mbd
