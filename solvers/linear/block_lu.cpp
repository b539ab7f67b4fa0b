#include "solvers/linear/block_lu.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "solvers/linear/block_kernels.hpp"
#include "solvers/linear/lanes.hpp"

namespace mbd {
namespace {

// Without exchange, diagonals may be reduced by this many times themselves; of a definite block it is once.
constexpr double most_growth = 1e3;

// Columns of a block that are kept in registers at a time, with `registers` each.
template <class T>
constexpr int columns_at_once(int registers) {
  return std::clamp(lane_registers / (registers * parts_of<T>), 1, most_rows);
}

using Update = BlockLuPlan::Update;

// D -= sum of L_p R_p^T over the updates, for `columns` columns of D. `stride`: rows of D, with padding; `other`: of R.
template <class T, int registers, int columns>
void update_columns(double* D, int stride, int other, const Update* update, const Update* end,
                    const double* left, const double* right) {
  constexpr int parts = parts_of<T>;
  Lanes<T> d[extent(columns)][extent(registers)];
  for (int c = 0; c < columns; ++c)
    for (int r = 0; r < registers; ++r)
      d[c][r].load(D + c * stride * parts + r * lane_count, stride);
  for (; update != end; ++update) {
    const double* L = left + std::size_t{update->left} * BlockLuPlan::register_rows * parts;
    const double* R = right + std::size_t{update->right} * BlockLuPlan::register_rows * parts;
    const auto one = [&](int k) __attribute__((always_inline)) {
      Lanes<T> l[extent(registers)];
      for (int r = 0; r < registers; ++r)
        l[r].load(L + k * stride * parts + r * lane_count, stride);
      for (int c = 0; c < columns; ++c)
        for (int r = 0; r < registers; ++r)
          d[c][r].subtract(l[r], R + k * other * parts + c, other);
    };
    if (update->inner == 6) {
#pragma GCC unroll 6
      for (int k = 0; k < 6; ++k) one(k);
    } else {
      for (int k = 0; k < update->inner; ++k) one(k);
    }
  }
  for (int c = 0; c < columns; ++c)
    for (int r = 0; r < registers; ++r)
      d[c][r].store(D + c * stride * parts + r * lane_count, stride);
}

using UpdateColumns = void (*)(double*, int, int, const Update*, const Update*, const double*,
                               const double*);

template <class T, int registers, int... c>
constexpr std::array<UpdateColumns, most_rows> table_of(std::integer_sequence<int, c...>) {
  std::array<UpdateColumns, most_rows> table{};
  ((table[static_cast<std::size_t>(c)] = update_columns<T, registers, c + 1>), ...);
  return table;
}

template <class T, int... r>
constexpr auto tables_of(std::integer_sequence<int, r...>) {
  return std::array{
      table_of<T, r + 1>(std::make_integer_sequence<int, columns_at_once<T>(r + 1)>())...};
}

template <class T>
constexpr auto update_tables = tables_of<T>(std::make_integer_sequence<int, most_registers>());

// D (rows x columns) as above, all its columns.
template <class T>
void update_block(double* D, int rows, int stride, int columns, int other, const Update* update,
                  const Update* end, const double* left, const double* right) {
  if (update == end) return;
  const int registers = registers_of(rows), at_once = columns_at_once<T>(registers);
  const auto& table = update_tables<T>[static_cast<std::size_t>(registers - 1)];
  for (int c = 0; c < columns; c += at_once)
    table[static_cast<std::size_t>(std::min(at_once, columns - c) - 1)](
        D + c * stride * parts_of<T>, stride, other, update, end, left, right + c);
}

// Of a block of n rows without exchanges; false if that loses too much.
template <class T, int n>
bool factor_definite(double* D, int stride, double* inverse) {
  constexpr int parts = parts_of<T>, registers = registers_of(n);
  Lanes<T> column[extent(n)][extent(registers)];
  Lane reduced[extent(registers)] = {};
#pragma GCC unroll 8
  for (int c = 0; c < n; ++c)
    for (int r = 0; r < registers; ++r)
      column[c][r].load(D + c * stride * parts + r * lane_count, stride);
  double before[extent(n)];
#pragma GCC unroll 8
  for (int i = 0; i < n; ++i) before[i] = size_of(column[i][i / lane_count].at(i % lane_count));
  bool good = true;
#pragma GCC unroll 8
  for (int k = 0; k < n; ++k) {
    const T pivot = column[k][k / lane_count].at(k % lane_count), one_over = inverse_of(pivot);
    put(inverse + k, stride, one_over);
    const double size = size_of(pivot);
    good = good && size > 1e-300 && size < 1e300;
    Lanes<T> l[extent(registers)];
    for (int r = 0; r < registers; ++r) {
      Lanes<T> quotient = column[k][r];
      quotient.multiply(one_over);
      const LaneMask below = LanesBetween(k + 1, n, r * lane_count).mask;
      l[r].clear();
      l[r].take(below, quotient);
      column[k][r].take(below, quotient);
      Lanes<T>::add_squares(reduced[r], l[r], size);
    }
#pragma GCC unroll 8
    for (int c = k + 1; c < n; ++c) {
      const T u = column[c][k / lane_count].at(k % lane_count);
      for (int r = 0; r < registers; ++r) column[c][r].subtract(l[r], u);
    }
  }
#pragma GCC unroll 8
  for (int i = 0; i < n; ++i)
    good = good && reduced[i / lane_count][i % lane_count] <= most_growth * before[i];
  if (!good) return false;
#pragma GCC unroll 8
  for (int c = 0; c < n; ++c)
    for (int r = 0; r < registers; ++r)
      column[c][r].store(D + c * stride * parts + r * lane_count, stride);
  return true;
}

template <class T>
bool factor_definite(double* D, int stride, int n, double* inverse) {
  switch (n) {
    case 1:
      return factor_definite<T, 1>(D, stride, inverse);
    case 2:
      return factor_definite<T, 2>(D, stride, inverse);
    case 3:
      return factor_definite<T, 3>(D, stride, inverse);
    case 4:
      return factor_definite<T, 4>(D, stride, inverse);
    case 5:
      return factor_definite<T, 5>(D, stride, inverse);
    case 6:
      return factor_definite<T, 6>(D, stride, inverse);
    default:
      return false;
  }
}

// A block of A into a padded one that it fills alone, or (turned) its transposed.
template <class T, int rows, int columns, bool turned>
void copy_block(const T* source, int ld, double* target, int stride) {
  constexpr int parts = parts_of<T>;
#if defined(__AVX512F__)
  // Columns in registers, with zeros behind their ends.
  const LaneMask there = LanesBetween(0, rows, 0).mask;
  Lanes<T> x[6];
  for (int c = 0; c < 6; ++c) {
    x[c].clear();
    if (c >= columns) continue;
    Lanes<T> column;
    if constexpr (parts == 1) {
      column.load(source + c * ld, 0);
    } else {
      Lane low, high{};
      const T* const from = source + c * ld;
      std::memcpy(&low, from, sizeof low);
      std::memcpy(&high, from + 4, sizeof(T) * (rows > 4 ? 2 : 0));
      column.re = __builtin_shufflevector(low, high, 0, 2, 4, 6, 8, 10, 12, 14);
      column.im = __builtin_shufflevector(low, high, 1, 3, 5, 7, 9, 11, 13, 15);
    }
    x[c].take(there, column);
  }
  if constexpr (turned) {
    Lane part[6];
    for (int c = 0; c < 6; ++c) part[c] = x[c].re;
    transpose(part);
    for (int c = 0; c < 6; ++c) x[c].re = part[c];
    if constexpr (parts == 2) {
      for (int c = 0; c < 6; ++c) part[c] = x[c].im;
      transpose(part);
      for (int c = 0; c < 6; ++c) x[c].im = part[c];
    }
  }
  for (int c = 0; c < (turned ? rows : columns); ++c)
    x[c].store(target + c * stride * parts, stride);
#else
  constexpr int target_rows = turned ? columns : rows, target_columns = turned ? rows : columns;
  for (int c = 0; c < target_columns; ++c) {
    double* const out = target + c * stride * parts;
    std::fill(out, out + stride * parts, 0.0);
    for (int r = 0; r < target_rows; ++r)
      put(out + r, stride, turned ? source[r * ld + c] : source[c * ld + r]);
  }
#endif
}

template <class T>
using CopyBlock = void (*)(const T*, int, double*, int);
template <class T, bool turned, int... k>
constexpr std::array<CopyBlock<T>, 36> copy_table_of(std::integer_sequence<int, k...>) {
  return {copy_block<T, k / 6 + 1, k % 6 + 1, turned>...};
}

template <class T, bool turned>
constexpr auto copy_table = copy_table_of<T, turned>(std::make_integer_sequence<int, 36>());

// With exchanges of rows; false if the block is singular.
template <class T>
bool factor_exchanging(double* D, int stride, int n, double* inverse, std::int8_t* exchanges) {
  constexpr int parts = parts_of<T>;
  std::array<std::array<T, most_rows>, most_rows> a;  // by columns
  for (int c = 0; c < n; ++c)
    for (int i = 0; i < n; ++i)
      a[static_cast<std::size_t>(c)][static_cast<std::size_t>(i)] =
          number(D + c * stride * parts + i, stride, T());
  const auto N = static_cast<std::size_t>(n);
  for (std::size_t i = 0; i < N; ++i) exchanges[i] = static_cast<std::int8_t>(i);
  for (std::size_t k = 0; k < N; ++k) {
    std::size_t best = k;
    double most = size_of(a[k][k]);
    for (std::size_t i = k + 1; i < N; ++i)
      if (const double x = size_of(a[k][i]); x > most) {
        most = x;
        best = i;
      }
    if (!(most > 1e-300 && most < 1e300)) return false;
    if (best != k) {
      for (std::size_t c = 0; c < N; ++c) std::swap(a[c][k], a[c][best]);
      std::swap(exchanges[k], exchanges[best]);
    }
    const T one_over = inverse_of(a[k][k]);
    put(inverse + k, stride, one_over);
    for (std::size_t i = k + 1; i < N; ++i) a[k][i] = product(a[k][i], one_over);
    for (std::size_t c = k + 1; c < N; ++c) {
      const T u = a[c][k];
      for (std::size_t i = k + 1; i < N; ++i) a[c][i] -= product(a[k][i], u);
    }
  }
  for (int c = 0; c < n; ++c)
    for (int i = 0; i < n; ++i)
      put(D + c * stride * parts + i, stride,
          a[static_cast<std::size_t>(c)][static_cast<std::size_t>(i)]);
  return true;
}

int stride_of(int rows) {
  return rows <= BlockLuPlan::register_rows ? BlockLuPlan::register_rows
                                            : 2 * BlockLuPlan::register_rows;
}

// Sorts items into bins, of which b has those from first[b]; `each(put)` calls put(bin, item) for all of them, twice:
// counted, then filled in.
template <class Item, class Each>
void sort_into(std::size_t bins, std::vector<std::size_t>& first, std::vector<Item>& items,
               const Each& each) {
  first.assign(bins + 1, 0);
  each([&](std::size_t bin, const Item&) { ++first[bin + 1]; });
  for (std::size_t b = 0; b < bins; ++b) first[b + 1] += first[b];
  items.resize(first[bins]);
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  each([&](std::size_t bin, const Item& item) { items[next[bin]++] = item; });
}

}  // namespace

BlockLuPlan::BlockLuPlan(const BlockColumns& A, const Elimination& elimination) : n(A.n) {
  std::vector<int> front_of(elimination.pivots.size(), -1);
  for (std::size_t f = 0; f < elimination.fronts.size(); ++f)
    std::fill(front_of.begin() + elimination.fronts[f].first,
              front_of.begin() + elimination.fronts[f].last, static_cast<int>(f));
  std::size_t targets = lay_out_pivots(elimination, front_of);
  fronts = FrontPlan(elimination, targets);
  targets += fronts.targets;
  lay_out_unknowns(A, elimination);
  sort_pieces(A, elimination, front_of, targets);
  sort_updates(front_of, targets);
}

std::size_t BlockLuPlan::lay_out_pivots(const Elimination& elimination,
                                        const std::vector<int>& front_of) {
  const std::size_t count = elimination.pivots.size();
  pivots.reserve(count + 1);
  std::size_t targets = 0;
  for (std::size_t p = 0; p < count; ++p) {
    // Of what is in fronts only the diagonals are here.
    const std::size_t begin = elimination.begin[p],
                      end = front_of[p] < 0 ? elimination.begin[p + 1] : begin;
    const int size = elimination.pivots[p].size, stride = stride_of(size);
    pivots.push_back({.size = size,
                      .stride = stride,
                      .diagonal = diagonals,
                      .below = off_diagonals,
                      .first_row = padded,
                      .first = rows.size(),
                      .last = rows.size() + end - begin,
                      .first_target = targets,
                      .merged = elimination.pivots[p].merged});
    for (std::size_t k = begin; k < end; ++k) {
      const int below = elimination.below[k];
      rows.push_back({off_diagonals, below});
      off_diagonals += static_cast<std::size_t>(
                           stride_of(elimination.pivots[static_cast<std::size_t>(below)].size)) *
                       static_cast<std::size_t>(size);
    }
    diagonals += static_cast<std::size_t>(stride) * static_cast<std::size_t>(size);
    padded += static_cast<std::size_t>(stride);
    targets += front_of[p] < 0 ? 1 + end - begin : 0;
  }
  pivots.push_back(
      {0, 0, diagonals, off_diagonals, padded, rows.size(), rows.size(), targets, false});
  return targets;
}

void BlockLuPlan::lay_out_unknowns(const BlockColumns& A, const Elimination& elimination) {
  runs.reserve(static_cast<std::size_t>(A.blocks()));
  for (int b = 0; b < A.blocks(); ++b) {
    const auto B = static_cast<std::size_t>(b);
    const Pivot& owner = pivots[static_cast<std::size_t>(elimination.pivot_of[B])];
    runs.push_back({owner.first_row, elimination.place_of[B], owner.stride, A.first[B], A.size(b)});
  }
}

std::size_t BlockLuPlan::part_of(int row, int column, const Elimination& elimination,
                                 const std::vector<int>& front_of) const {
  const int i = elimination.pivot_of[static_cast<std::size_t>(row)],
            j = elimination.pivot_of[static_cast<std::size_t>(column)];
  const auto& pivot = pivots[static_cast<std::size_t>(std::min(i, j))];
  if (const int front = front_of[static_cast<std::size_t>(std::min(i, j))]; front >= 0)
    return 2 * fronts.target(front, std::max(i, j), std::min(i, j)) + (i < j ? 1 : 0);
  if (i == j) return 2 * pivot.first_target;
  const auto found =
      std::lower_bound(rows.begin() + static_cast<std::ptrdiff_t>(pivot.first),
                       rows.begin() + static_cast<std::ptrdiff_t>(pivot.last), std::max(i, j),
                       [](const Row& one, int wanted) { return one.pivot < wanted; });
  const auto k = static_cast<std::size_t>(found - rows.begin());
  return 2 * (pivot.first_target + 1 + k - pivot.first) + (i < j ? 1 : 0);
}

void BlockLuPlan::sort_pieces(const BlockColumns& A, const Elimination& elimination,
                              const std::vector<int>& front_of, std::size_t targets) {
  sort_into(2 * targets, first_piece, pieces, [&](const auto& put) {
    for (int c = 0; c < A.blocks(); ++c) {
      const auto C = static_cast<std::size_t>(c);
      for (std::size_t e = A.begin[C]; e < A.begin[C + 1]; ++e) {
        const int r = A.entries[e].row;
        const auto R = static_cast<std::size_t>(r);
        const std::size_t part = part_of(r, c, elimination, front_of);
        const bool turned = part % 2 == 1;
        const auto row = static_cast<std::int8_t>(elimination.place_of[R]),
                   column = static_cast<std::int8_t>(elimination.place_of[C]);
        put(part, Piece{.source = A.entries[e].offset,
                        .ld = static_cast<int>(A.height[C]),
                        .row = A.first[R],
                        .column = A.first[C],
                        .rows = static_cast<std::int8_t>(A.size(r)),
                        .columns = static_cast<std::int8_t>(A.size(c)),
                        .place_row = turned ? column : row,
                        .place_column = turned ? row : column});
      }
    }
  });
}

// Of each pair of rows of a pivot one.
void BlockLuPlan::sort_updates(const std::vector<int>& front_of, std::size_t targets) {
  sort_into(targets, first_update, updates, [&](const auto& put) {
    for (std::size_t p = 0; p + 1 < pivots.size(); ++p)
      for (std::size_t b = pivots[p].first; b < pivots[p].last; ++b) {
        const auto& target = pivots[static_cast<std::size_t>(rows[b].pivot)];
        const int front = front_of[static_cast<std::size_t>(rows[b].pivot)];
        std::size_t k = target.first;
        for (std::size_t a = b; a < pivots[p].last; ++a) {
          std::size_t t = target.first_target;
          if (front >= 0) {
            t = fronts.target(front, rows[a].pivot, rows[b].pivot);
          } else if (a != b) {
            while (rows[k].pivot != rows[a].pivot) ++k;
            t += 1 + k - target.first;
          }
          put(t,
              Update{static_cast<std::uint32_t>(rows[a].offset / register_rows),
                     static_cast<std::uint32_t>(rows[b].offset / register_rows), pivots[p].size});
        }
      }
  });
}

template <class T>
BlockLu<T>::BlockLu(const BlockLuPlan& plan)
    : plan_(plan),
      diagonal_(scalars(plan.diagonals), 0.0),
      lower_(scalars(plan.off_diagonals), 0.0),
      upper_(scalars(plan.off_diagonals), 0.0),
      inverse_(scalars(plan.padded), 0.0),
      exchanges_(plan.padded, 0),
      exchanged_(plan.pivots.size(), 0),
      x_(scalars(plan.padded), 0.0),
      front_lower_(scalars(plan.fronts.numbers), 0.0),
      front_upper_(scalars(plan.fronts.numbers), 0.0),
      front_update_(scalars(plan.fronts.update_numbers), 0.0),
      front_x_(scalars(static_cast<std::size_t>(plan.fronts.largest)), 0.0) {
  product_.reserve(plan.fronts.widest_product, plan.fronts.deepest_product);
}

template <class T>
std::size_t BlockLu<T>::bytes() const {
  return sizeof(double) * (diagonal_.size() + lower_.size() + upper_.size() + inverse_.size() +
                           front_lower_.size() + front_upper_.size());
}

// A block of A's, or its transposed, as a block of the factors.
template <class T>
void BlockLu<T>::assemble(std::size_t target, double* D, int rows, int stride, int columns,
                          bool turned, const T* A, const double* scales) {
  using Piece = BlockLuPlan::Piece;
  constexpr int number_parts = parts_of<T>;
  const Piece* piece = plan_.pieces.data() + plan_.first_piece[2 * target + (turned ? 1 : 0)];
  const Piece* const end = plan_.pieces.data() + plan_.first_piece[2 * target + (turned ? 2 : 1)];
  const int step = stride * number_parts;
  if (end - piece == 1 && scales == nullptr && rows <= 6 && columns <= 6) {
    // In a matrix of whole blocks it fills this one.
    const auto k = static_cast<std::size_t>(6 * (piece->rows - 1) + piece->columns - 1);
    (turned ? copy_table<T, true> : copy_table<T, false>)[k](A + piece->source, piece->ld, D,
                                                             stride);
    return;
  }
  std::fill(D, D + step * columns, 0.0);
  for (; piece != end; ++piece) {
    const T* const source = A + piece->source;
    for (int c = 0; c < piece->columns; ++c)
      for (int r = 0; r < piece->rows; ++r) {
        T x = source[c * piece->ld + r];
        if (scales != nullptr) x *= scales[piece->row + r] * scales[piece->column + c];
        const int i = piece->place_row + (turned ? c : r),
                  j = piece->place_column + (turned ? r : c);
        put(D + j * step + i, stride, x);
      }
  }
}

namespace {

using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_rows, most_rows>;

// Where nearly all of a pivot has cancelled, round-off of either side is another, and signs of its eigenvalues are none of the factors.
void symmetrize(double* D, int stride, int n) {
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < j; ++i) {
      double &a = D[j * stride + i], &b = D[i * stride + j];
      a = b = 0.5 * (a + b);
    }
}

// Of a symmetric D by its eigenvalues, with rows and columns in units in which they are of one size.
void add_eigenvalues(const double* D, int stride, int n, PivotInertia& inertia) {
  Small A(n, n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) A(i, j) = D[j * stride + i];
  for (int pass = 0; pass < 3; ++pass)
    for (int i = 0; i < n; ++i) {
      const double size = std::sqrt(A.row(i).cwiseAbs().maxCoeff());
      if (!(size > 0.0)) continue;
      A.row(i) /= size;
      A.col(i) /= size;
    }
  const Eigen::SelfAdjointEigenSolver<Small> solver(A, Eigen::EigenvaluesOnly);
  for (int i = 0; i < n; ++i) {
    inertia.negative += solver.eigenvalues()(i) < 0.0 ? 1 : 0;
    inertia.least = std::min(inertia.least, std::abs(solver.eigenvalues()(i)));
  }
}

}  // namespace

template <class T>
bool BlockLu<T>::factor_pivot(std::size_t j, PivotInertia* inertia) {
  const auto& pivot = plan_.pivots[j];
  double* const D = diagonal_.data() + scalars(pivot.diagonal);
  if constexpr (parts_of<T> == 1)
    if (inertia != nullptr) symmetrize(D, pivot.stride, pivot.size);
  double* const inverse = inverse_.data() + scalars(pivot.first_row);
  exchanged_[j] = 0;
  if (!pivot.merged && factor_definite<T>(D, pivot.stride, pivot.size, inverse)) {
    if (inertia != nullptr)
      for (int i = 0; i < pivot.size; ++i) inertia->negative += inverse[i] < 0.0 ? 1 : 0;
    return true;
  }
  if constexpr (parts_of<T> == 1)
    if (inertia != nullptr) add_eigenvalues(D, pivot.stride, pivot.size, *inertia);
  std::int8_t* const exchanges = exchanges_.data() + pivot.first_row;
  if (!factor_exchanging<T>(D, pivot.stride, pivot.size, inverse, exchanges)) return false;
  for (int i = 0; i < pivot.size; ++i)
    if (exchanges[i] != i) exchanged_[j] = 1;
  return true;
}

// `before`: the diagonal of A.
template <class T>
void BlockLu<T>::add_least(std::size_t j, const double* before, PivotInertia& inertia) const {
  const auto& pivot = plan_.pivots[j];
  if (pivot.merged || exchanged_[j] != 0) return;
  const double* const inverse = inverse_.data() + scalars(pivot.first_row);
  for (int i = 0; i < pivot.size; ++i)
    inertia.least = std::min(inertia.least, 1.0 / (std::abs(inverse[i]) * before[i]));
}

// D -= what pivots outside fronts take from a block of one.
template <class T>
void BlockLu<T>::update_of_front(std::size_t target, double* D, int rows, int stride, int columns,
                                 int other, bool turned) const {
  const Update* const updates = plan_.updates.data();
  update_block<T>(D, rows, stride, columns, other, updates + plan_.first_update[target],
                  updates + plan_.first_update[target + 1], turned ? upper_.data() : lower_.data(),
                  turned ? lower_.data() : upper_.data());
}

template <class T>
bool BlockLu<T>::factor(const T* A, const double* scales, PivotInertia* inertia) {
  constexpr int number_parts = parts_of<T>;
  scales_ = scales;
  const Update* const updates = plan_.updates.data();
  const double *const lower = lower_.data(), *const upper = upper_.data();
  std::fill(front_lower_.begin(), front_lower_.end(), 0.0);
  std::fill(front_upper_.begin(), front_upper_.end(), 0.0);
  std::size_t front = 0;
  for (std::size_t j = 0; j + 1 < plan_.pivots.size(); ++j) {
    if (plan_.fronts.begins(front, j)) {
      if (!factor_front(front, A, scales, inertia)) return false;
      j = static_cast<std::size_t>(plan_.fronts.all[front++].last) - 1;
      continue;
    }
    const auto& pivot = plan_.pivots[j];
    std::size_t target = pivot.first_target;
    const std::size_t* first = plan_.first_update.data() + target;
    double* const D = diagonal_.data() + scalars(pivot.diagonal);
    assemble(target, D, pivot.size, pivot.stride, pivot.size, false, A, scales);
    double before[most_rows];
    if (inertia != nullptr)
      for (int i = 0; i < pivot.size; ++i) before[i] = std::abs(D[i * pivot.stride + i]);
    if (first[0] != first[1])
      update_block<T>(D, pivot.size, pivot.stride, pivot.size, pivot.stride, updates + first[0],
                      updates + first[1], lower, upper);
    if (!factor_pivot(j, inertia)) return false;
    const double* const inverse = inverse_.data() + scalars(pivot.first_row);
    if (inertia != nullptr) add_least(j, before, *inertia);
    const std::int8_t* const exchanges = exchanges_.data() + pivot.first_row;
    for (std::size_t k = pivot.first; k < pivot.last; ++k) {
      ++first;
      ++target;
      const auto& other = plan_.pivots[static_cast<std::size_t>(plan_.rows[k].pivot)];
      double* const L = lower_.data() + scalars(plan_.rows[k].offset);
      double* const U = upper_.data() + scalars(plan_.rows[k].offset);
      assemble(target, U, other.size, other.stride, pivot.size, true, A, scales);
      assemble(target, L, other.size, other.stride, pivot.size, false, A, scales);
      if (first[0] != first[1]) {
        update_block<T>(L, other.size, other.stride, pivot.size, pivot.stride, updates + first[0],
                        updates + first[1], lower, upper);
        update_block<T>(U, other.size, other.stride, pivot.size, pivot.stride, updates + first[0],
                        updates + first[1], upper, lower);
      }
      divide_block<T, true>(L, other.size, other.stride, pivot.size, D, pivot.stride, inverse);
      if (exchanged_[j] != 0) {
        double copy[extent(number_parts * 2 * BlockLuPlan::register_rows * most_rows)];
        const int step = other.stride * number_parts;
        std::copy(U, U + step * pivot.size, copy);
        for (int c = 0; c < pivot.size; ++c)
          std::copy(copy + exchanges[c] * step, copy + (exchanges[c] + 1) * step, U + c * step);
      }
      divide_block<T, false>(U, other.size, other.stride, pivot.size, D, pivot.stride, inverse);
    }
    invert_triangles<T>(D, pivot.stride, pivot.size, inverse);
  }
  return true;
}

template <class T>
void BlockLu<T>::to_padded(const T* x) const {
  for (const auto& run : plan_.runs) {
    double* const out = x_.data() + scalars(run.pivot) + run.row;
    for (int i = 0; i < run.count; ++i)
      put(out + i, run.stride,
          scales_ != nullptr ? scales_[run.first + i] * x[run.first + i] : x[run.first + i]);
  }
}

template <class T>
void BlockLu<T>::from_padded(T* x) const {
  for (const auto& run : plan_.runs) {
    const double* const in = x_.data() + scalars(run.pivot) + run.row;
    for (int i = 0; i < run.count; ++i) {
      const T value = number(in + i, run.stride, T());
      x[run.first + i] = scales_ != nullptr ? scales_[run.first + i] * value : value;
    }
  }
}

namespace {

// y_i -= M_ij x_j for all blocks M_ij below a pivot, n columns wide, whose x is at X.
template <class T, int n>
void subtract_below(const BlockLuPlan& plan, const BlockLuPlan::Pivot& pivot, const double* below,
                    const double* X, double* vector) {
  constexpr int parts = parts_of<T>;
  const int columns = n > 0 ? n : pivot.size;
  for (std::size_t k = pivot.first; k < pivot.last; ++k) {
    const auto& other = plan.pivots[static_cast<std::size_t>(plan.rows[k].pivot)];
    const double* const M = below + plan.rows[k].offset * parts;
    double* const Y = vector + other.first_row * parts;
    const int step = other.stride * parts;
    for (int r = 0; r < other.size; r += lane_count) {
      Lanes<T> y, column;
      y.load(Y + r, other.stride);
#pragma GCC unroll 6
      for (int c = 0; c < columns; ++c) {
        column.load(M + c * step + r, other.stride);
        y.subtract(column, X + c, pivot.stride);
      }
      y.store(Y + r, other.stride);
    }
  }
}

// Sums of M_ij^T y_i over what is below a pivot, n columns wide, number by number.
template <class T, int n>
void add_below(const BlockLuPlan& plan, const BlockLuPlan::Pivot& pivot, const double* below,
               const double* vector, Lanes<T>* sums) {
  constexpr int parts = parts_of<T>;
  const int columns = n > 0 ? n : pivot.size;
#pragma GCC unroll 6
  for (int c = 0; c < columns; ++c) sums[c].clear();
  for (std::size_t k = pivot.first; k < pivot.last; ++k) {
    const auto& other = plan.pivots[static_cast<std::size_t>(plan.rows[k].pivot)];
    const double* const M = below + plan.rows[k].offset * parts;
    const double* const Y = vector + other.first_row * parts;
    const int step = other.stride * parts;
    for (int r = 0; r < other.size; r += lane_count) {
      Lanes<T> y, column;
      y.load(Y + r, other.stride);
#pragma GCC unroll 6
      for (int c = 0; c < columns; ++c) {
        column.load(M + c * step + r, other.stride);
        sums[c].add_product(column, y);
      }
    }
  }
}

// A pivot of n rows without exchanges, in registers: x := L^-1 x and what is below, or x := U^-1 (x - what is below).
template <class T, int n>
void forward_pivot(const BlockLuPlan& plan, const BlockLuPlan::Pivot& pivot, const double* D,
                   const double* below, double* vector) {
  constexpr int parts = parts_of<T>, registers = registers_of(n);
  double* const X = vector + pivot.first_row * parts;
  Lanes<T> x[extent(registers)];
  for (int r = 0; r < registers; ++r) x[r].load(X + r * lane_count, pivot.stride);
#pragma GCC unroll 6
  for (int k = 0; k + 1 < n; ++k)
    for (int r = 0; r < registers; ++r) {
      Lanes<T> column, l;
      column.load(D + k * pivot.stride * parts + r * lane_count, pivot.stride);
      l.clear();
      l.take(LanesBetween(k + 1, n, r * lane_count).mask, column);
      x[r].add(l, X + k, pivot.stride);
    }
  for (int r = 0; r < registers; ++r) x[r].store(X + r * lane_count, pivot.stride);
  subtract_below<T, n>(plan, pivot, below, X, vector);
}

template <class T, int n>
void backward_pivot(const BlockLuPlan& plan, const BlockLuPlan::Pivot& pivot, const double* D,
                    const double* below, double* vector) {
  constexpr int parts = parts_of<T>, registers = registers_of(n);
  double* const X = vector + pivot.first_row * parts;
  Lanes<T> x[extent(registers)];
  for (int r = 0; r < registers; ++r) x[r].load(X + r * lane_count, pivot.stride);
  if (pivot.first < pivot.last) {
    Lanes<T> sums[extent(n)];
    add_below<T, n>(plan, pivot, below, vector, sums);
#if defined(__AVX512F__)
    Lane part[extent(n)];
    for (int c = 0; c < n; ++c) part[c] = sums[c].re;
    x[0].re -= sums_of<n>(part);
    if constexpr (parts == 2) {
      for (int c = 0; c < n; ++c) part[c] = sums[c].im;
      x[0].im -= sums_of<n>(part);
    }
#else
    double sum[static_cast<std::size_t>(parts * registers * lane_count)] = {};
    for (int c = 0; c < n; ++c) put(sum + c, registers * lane_count, sums[c].sum());
    for (int r = 0; r < registers; ++r) {
      Lanes<T> part;
      part.load(sum + r * lane_count, registers * lane_count);
      x[r].subtract(part, T(1.0));
    }
#endif
  }
  for (int r = 0; r < registers; ++r) x[r].store(X + r * lane_count, pivot.stride);
  for (int r = 0; r < registers; ++r) x[r].clear();
#pragma GCC unroll 6
  for (int k = 0; k < n; ++k)
    for (int r = 0; r < registers; ++r) {
      Lanes<T> column, u;
      column.load(D + k * pivot.stride * parts + r * lane_count, pivot.stride);
      u.clear();
      u.take(LanesBetween(0, k + 1, r * lane_count).mask, column);
      x[r].add(u, X + k, pivot.stride);
    }
  for (int r = 0; r < registers; ++r) x[r].store(X + r * lane_count, pivot.stride);
}

template <class T>
using OnePivot = void (*)(const BlockLuPlan&, const BlockLuPlan::Pivot&, const double*,
                          const double*, double*);
template <class T>
constexpr std::array<OnePivot<T>, 6> forward_pivots{forward_pivot<T, 1>, forward_pivot<T, 2>,
                                                    forward_pivot<T, 3>, forward_pivot<T, 4>,
                                                    forward_pivot<T, 5>, forward_pivot<T, 6>};
template <class T>
constexpr std::array<OnePivot<T>, 6> backward_pivots{backward_pivot<T, 1>, backward_pivot<T, 2>,
                                                     backward_pivot<T, 3>, backward_pivot<T, 4>,
                                                     backward_pivot<T, 5>, backward_pivot<T, 6>};

}  // namespace

// x_j := L_jj^-1 P_j x_j (or U_jj^-T x_j), and what lies below changes by L_ij x_j (U_ji^T x_j).
template <class T>
template <bool transposed>
void BlockLu<T>::forward() const {
  const double* const below = transposed ? upper_.data() : lower_.data();
  std::size_t front = 0;
  for (std::size_t j = 0; j + 1 < plan_.pivots.size(); ++j) {
    if (plan_.fronts.begins(front, j)) {
      forward_front(front, transposed);
      j = static_cast<std::size_t>(plan_.fronts.all[front++].last) - 1;
      continue;
    }
    const auto& pivot = plan_.pivots[j];
    const double* const D = diagonal_.data() + scalars(pivot.diagonal);
    const int n = pivot.size, stride = pivot.stride;
    if (!transposed && exchanged_[j] == 0 && n <= 6) {
      forward_pivots<T>[static_cast<std::size_t>(n - 1)](plan_, pivot, D, below, x_.data());
      continue;
    }
    double* const X = x_.data() + scalars(pivot.first_row);
    const std::int8_t* const exchanges = exchanges_.data() + pivot.first_row;
    std::array<T, most_rows> x;
    for (int i = 0; i < n; ++i)
      x[static_cast<std::size_t>(i)] =
          number(X + (!transposed && exchanged_[j] != 0 ? exchanges[i] : i), stride, T());
    const Triangles<T> triangles{D, stride, n};
    if constexpr (transposed)
      triangles.upper_transposed(x.data());
    else
      triangles.lower(x.data());
    for (int i = 0; i < n; ++i) put(X + i, stride, x[static_cast<std::size_t>(i)]);
    subtract_below<T, 0>(plan_, pivot, below, X, x_.data());
  }
}

// x_j less what lies below gives, by U_ji x_i (L_ij^T x_i); then U_jj^-1 (P_j^T L_jj^-T).
template <class T>
template <bool transposed>
void BlockLu<T>::backward() const {
  const double* const below = transposed ? lower_.data() : upper_.data();
  std::size_t front = plan_.fronts.all.size();
  for (std::size_t j = plan_.pivots.size() - 1; j-- > 0;) {
    if (plan_.fronts.ends(front, j)) {
      backward_front(--front, transposed);
      j = static_cast<std::size_t>(plan_.fronts.all[front].first);
      continue;
    }
    const auto& pivot = plan_.pivots[j];
    const double* const D = diagonal_.data() + scalars(pivot.diagonal);
    const int n = pivot.size, stride = pivot.stride;
    if (!transposed && n <= 6) {
      backward_pivots<T>[static_cast<std::size_t>(n - 1)](plan_, pivot, D, below, x_.data());
      continue;
    }
    double* const X = x_.data() + scalars(pivot.first_row);
    std::array<T, most_rows> x;
    Lanes<T> sums[most_rows];
    add_below<T, 0>(plan_, pivot, below, x_.data(), sums);
    for (int i = 0; i < n; ++i)
      x[static_cast<std::size_t>(i)] = number(X + i, stride, T()) - sums[i].sum();
    const Triangles<T> triangles{D, stride, n};
    if constexpr (transposed)
      triangles.lower_transposed(x.data());
    else
      triangles.upper(x.data());
    const std::int8_t* const exchanges = exchanges_.data() + pivot.first_row;
    for (int i = 0; i < n; ++i)
      put(X + (transposed && exchanged_[j] != 0 ? exchanges[i] : i), stride,
          x[static_cast<std::size_t>(i)]);
  }
}

template <class T>
void BlockLu<T>::solve(T* x) const {
  to_padded(x);
  forward<false>();
  backward<false>();
  from_padded(x);
}

template <class T>
void BlockLu<T>::solve_transposed(T* x) const {
  to_padded(x);
  forward<true>();
  backward<true>();
  from_padded(x);
}

template <class T>
int BlockLu<T>::determinant_sign() const {
  bool negative = false;
  for (std::size_t j = 0; j + 1 < plan_.pivots.size(); ++j) {
    const auto& pivot = plan_.pivots[j];
    const double* const inverse = inverse_.data() + scalars(pivot.first_row);
    for (int i = 0; i < pivot.size; ++i) negative = negative != (inverse[i] < 0.0);
    if (exchanged_[j] == 0) continue;
    const std::int8_t* const exchanges = exchanges_.data() + pivot.first_row;
    for (int i = 0; i < pivot.size; ++i)
      for (int k = i + 1; k < pivot.size; ++k) negative = negative != (exchanges[k] < exchanges[i]);
  }
  return negative ? -1 : 1;
}

template class BlockLu<double>;
template class BlockLu<std::complex<double>>;

}  // namespace mbd
