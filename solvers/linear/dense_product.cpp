#include "solvers/linear/dense_product.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "solvers/linear/lanes.hpp"

namespace mbd {
namespace {

// A tile of C is tile_registers by tile_columns registers; a strip of A or B is as many rows wide, and deep_columns long.
#if defined(__AVX512F__)
constexpr int tile_registers = 3, tile_columns = 8;
#else
constexpr int tile_registers = 3, tile_columns = 4;
#endif
constexpr int tile_rows = tile_registers * lane_count;
constexpr Index deep_columns = 128;  // a strip of A stays in the first cache
constexpr Index worth_copying = 16;  // columns of C, from which on strips of A are copied

// Of one tile: A by columns a_step apart, B by strips of tile_columns.
template <int registers, int columns>
void tile(double* C, Index ldc, const double* A, Index a_step, const double* B, Index k,
          bool fresh) {
  Lane c[static_cast<std::size_t>(columns)][static_cast<std::size_t>(registers)] = {};
  for (Index p = 0; p < k; ++p) {
    Lane a[static_cast<std::size_t>(registers)];
#pragma GCC unroll 3
    for (int r = 0; r < registers; ++r) {
      std::memcpy(&a[r], A + r * lane_count, sizeof a[r]);
      hold(a[r]);  // else its products wait for memory, not for the arithmetic
    }
#pragma GCC unroll 8
    for (int j = 0; j < columns; ++j)
#pragma GCC unroll 3
      for (int r = 0; r < registers; ++r) c[j][r] -= a[r] * B[j];
    A += a_step;
    B += tile_columns;
  }
#pragma GCC unroll 8
  for (int j = 0; j < columns; ++j)
#pragma GCC unroll 3
    for (int r = 0; r < registers; ++r) {
      double* const at = C + j * ldc + r * lane_count;
      if (!fresh) {
        Lane before;
        std::memcpy(&before, at, sizeof before);
        c[j][r] += before;
      }
      std::memcpy(at, &c[j][r], sizeof c[j][r]);
    }
}

using Tile = void (*)(double*, Index, const double*, Index, const double*, Index, bool);
template <int registers, int... c>
constexpr std::array<Tile, tile_columns> row_of_tiles(std::integer_sequence<int, c...>) {
  return {tile<registers, c + 1>...};
}
template <int... r>
constexpr auto all_tiles(std::integer_sequence<int, r...>) {
  return std::array{row_of_tiles<r + 1>(std::make_integer_sequence<int, tile_columns>())...};
}
constexpr auto tiles = all_tiles(std::make_integer_sequence<int, tile_registers>());

Index strips(Index n) { return (n + tile_columns - 1) / tile_columns; }

}  // namespace

void DenseProduct::reserve(Index n, Index k) {
  const Index deep = std::min(k, deep_columns);
  a_.resize(std::max(a_.size(), static_cast<std::size_t>(tile_rows * deep)));
  b_.resize(std::max(b_.size(), static_cast<std::size_t>(strips(n) * tile_columns * deep)));
}

void DenseProduct::subtract(const DenseView& C, const DenseView& A, const DenseView& B, Index m,
                            Index n, Index k, bool fresh, double sign) {
  if (m == 0 || n == 0 || (k == 0 && !fresh)) return;
  reserve(n, k);
  for (Index first = 0; first < k || first == 0; first += deep_columns) {
    const Index deep = std::min(deep_columns, k - first);
    const bool begins = fresh && first == 0;
    double* to = b_.data();
    for (Index j = 0; j < n; j += tile_columns)
      for (Index p = 0; p < deep; ++p)
        for (Index i = 0; i < tile_columns; ++i)
          *to++ = j + i < n ? sign * *B.at(j + i, first + p) : 0.0;
    for (Index row = 0; row < m; row += tile_rows) {
      const auto registers =
          static_cast<int>((std::min<Index>(tile_rows, m - row) + lane_count - 1) / lane_count);
      const double* a = A.at(row, first);
      Index step = A.ld;
      if (n >= worth_copying) {
        double* strip = a_.data();
        for (Index p = 0; p < deep; ++p, strip += tile_rows)
          std::memcpy(strip, a + p * A.ld,
                      static_cast<std::size_t>(registers * lane_count) * sizeof(double));
        a = a_.data();
        step = tile_rows;
      }
      for (Index j = 0; j < n; j += tile_columns)
        tiles[static_cast<std::size_t>(registers - 1)]
             [static_cast<std::size_t>(std::min<Index>(tile_columns, n - j) - 1)](
                 C.at(row, j), C.ld, a, step, b_.data() + j * deep, deep, begins);
    }
  }
}

}  // namespace mbd
