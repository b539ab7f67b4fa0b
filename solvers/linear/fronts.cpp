#include "solvers/linear/fronts.hpp"

#include <algorithm>
#include <cstring>

#include "solvers/linear/block_kernels.hpp"
#include "solvers/linear/block_lu.hpp"

namespace mbd {
namespace {

constexpr Index block_columns = 48;      // of a front that are updated together by those before
constexpr Index columns_at_a_time = 96;  // of a front above that are updated together

std::size_t to_size(Index i) { return static_cast<std::size_t>(i); }

Index padded_rows(Index rows) {
  constexpr Index slack = DenseProduct::row_slack;
  return (rows + slack - 1) / slack * slack + slack;
}

}  // namespace

FrontPlan::FrontPlan(const Elimination& elimination, std::size_t first_target) {
  for (const auto& [first, last] : elimination.fronts) {
    Front front{};
    front.first = first;
    front.last = last;
    front.first_member = members.size();
    front.own_members = to_size(last - first);
    front.first_target = first_target + targets;
    front.numbers = numbers;
    const auto add = [&](int pivot) {
      const int size = elimination.pivots[to_size(pivot)].size;
      members.push_back({pivot, front.rows, size});
      front.rows += size;
    };
    for (int p = first; p < last; ++p) add(p);
    front.width = front.rows;
    for (std::size_t k = elimination.begin[to_size(last - 1)]; k < elimination.begin[to_size(last)];
         ++k)
      add(elimination.below[k]);
    front.last_member = members.size();
    front.ld = padded_rows(front.rows);
    targets += front.own_members * (front.last_member - front.first_member);
    numbers += to_size(front.ld * front.width);
    largest = std::max(largest, front.ld);
    deepest_product = std::max(deepest_product, front.width);
    all.push_back(front);
  }
  add_groups(elimination);
  widest_product = all.empty() ? 0 : block_columns + 12;
  for (const Group& group : groups)
    widest_product = std::max(widest_product, group.end - group.begin);
}

// By the fronts that the rows below belong to, in pieces of columns_at_a_time.
void FrontPlan::add_groups(const Elimination& elimination) {
  std::vector<std::size_t> front_of(elimination.pivots.size(), all.size());
  for (std::size_t f = 0; f < all.size(); ++f)
    std::fill(front_of.begin() + all[f].first, front_of.begin() + all[f].last, f);
  for (std::size_t f = 0; f < all.size(); ++f) {
    Front& front = all[f];
    front.first_group = groups.size();
    for (std::size_t m = front.first_member + front.own_members; m < front.last_member;) {
      const std::size_t above = front_of[to_size(members[m].pivot)], first = m;
      Group group{above, members[m].row, members[m].row, runs.size(), 0};
      for (; m < front.last_member && front_of[to_size(members[m].pivot)] == above &&
             group.end - group.begin < columns_at_a_time;
           ++m)
        group.end = members[m].row + members[m].size;
      // Both lists rise: where each row is in the front above.
      std::size_t k = all[above].first_member;
      for (std::size_t i = first; i < front.last_member; ++i) {
        while (members[k].pivot != members[i].pivot) ++k;
        const Index from = members[i].row - group.begin, to = members[k].row;
        if (i > first && runs.back().from + runs.back().count == from &&
            runs.back().to + runs.back().count == to)
          runs.back().count += members[i].size;
        else
          runs.push_back({from, to, members[i].size});
      }
      group.last_run = runs.size();
      groups.push_back(group);
      update_numbers = std::max(update_numbers, to_size(padded_rows(front.rows - group.begin) *
                                                        (group.end - group.begin)));
    }
    front.last_group = groups.size();
  }
}

std::size_t FrontPlan::place(const Front& front, int pivot) const {
  if (pivot < front.last) return to_size(pivot - front.first);
  const auto begin = members.begin() + static_cast<std::ptrdiff_t>(front.first_member);
  const auto found =
      std::lower_bound(begin + static_cast<std::ptrdiff_t>(front.own_members),
                       members.begin() + static_cast<std::ptrdiff_t>(front.last_member), pivot,
                       [](const Member& member, int wanted) { return member.pivot < wanted; });
  return to_size(found - begin);
}

std::size_t FrontPlan::target(int f, int row, int column) const {
  const Front& front = all[to_size(f)];
  return front.first_target + place(front, column) * (front.last_member - front.first_member) +
         place(front, row);
}

namespace {

// A matrix of real or complex numbers: of these, real and imaginary parts of a column follow one another.
template <class T>
struct FrontNumbers {
  static constexpr Index parts = parts_of<T>;
  double* data;
  Index ld;
  double* at(Index row, Index column) const { return data + column * ld * parts + row; }
  DenseView part(Index row, Index column, Index which) const {
    return {at(row, column) + which * ld, ld * parts};
  }
};

// Of C from (row, column) on, m x n: C -= A B^T, or C := -A B^T.
template <class T>
struct FrontProduct {
  DenseProduct& product;
  Index m, n, k;
  bool fresh = false;
  void operator()(const FrontNumbers<T>& C, Index c_row, Index c_column, const FrontNumbers<T>& A,
                  Index a_row, const FrontNumbers<T>& B, Index b_row) const {
    const auto one = [&](Index c, Index a, Index b, bool first, double sign) {
      product.subtract(C.part(c_row, c_column, c), A.part(a_row, 0, a), B.part(b_row, 0, b), m, n,
                       k, first, sign);
    };
    one(0, 0, 0, fresh, 1.0);
    if constexpr (parts_of<T> == 2) {
      one(0, 1, 1, false, -1.0);
      one(1, 0, 1, fresh, 1.0);
      one(1, 1, 0, false, 1.0);
    }
  }
};

// Rows and columns as runs say, from a product to a front.
template <class T>
void add_scattered(const FrontPlan& plan, const FrontPlan::Group& group,
                   const FrontNumbers<T>& from, const FrontNumbers<T>& to) {
  const Index columns = group.end - group.begin;
  for (std::size_t c = group.first_run; c < group.last_run; ++c) {
    const auto& [first, target, count] = plan.runs[c];
    for (Index j = first; j < std::min(first + count, columns); ++j)
      for (std::size_t r = c; r < group.last_run; ++r) {
        const auto& run = plan.runs[r];
        for (Index part = 0; part < parts_of<T>; ++part) {
          const double* const source = from.at(run.from, j) + part * from.ld;
          double* const sink = to.at(run.to, target + j - first) + part * to.ld;
          for (Index i = 0; i < run.count; ++i) sink[i] += source[i];
        }
      }
  }
}

template <class T>
FrontNumbers<T> matrix_of(std::vector<double>& all, const FrontPlan::Front& front) {
  return {all.data() + front.numbers * to_size(parts_of<T>), front.ld};
}
template <class T>
FrontNumbers<T> matrix_of(const std::vector<double>& all, const FrontPlan::Front& front) {
  return {const_cast<double*>(all.data()) + front.numbers * to_size(parts_of<T>), front.ld};
}

// The part of a matrix from one of its columns on.
template <class T>
FrontNumbers<T> from_column(const FrontNumbers<T>& matrix, Index column) {
  return {matrix.at(0, column), matrix.ld};
}

}  // namespace

// Blocks of A, and what pivots outside fronts take from them, in addition to what other fronts took. `before`: the
// diagonal of A.
template <class T>
void BlockLu<T>::assemble_front(std::size_t f, const T* A, const double* scales, double* before) {
  const auto& front = plan_.fronts.all[f];
  const auto L = matrix_of<T>(front_lower_, front), U = matrix_of<T>(front_upper_, front);
  const std::size_t count = front.last_member - front.first_member;
  const auto* const members = plan_.fronts.members.data() + front.first_member;
  double block[parts * 2 * BlockLuPlan::register_rows * most_rows];
  for (std::size_t c = 0; c < front.own_members; ++c)
    for (std::size_t r = c; r < count; ++r) {
      const std::size_t target = front.first_target + c * count + r;
      const bool updated = plan_.first_update[target] != plan_.first_update[target + 1];
      if (!updated && plan_.first_piece[2 * target] == plan_.first_piece[2 * target + 2]) continue;
      const int rows = members[r].size, columns = members[c].size;
      const int stride = plan_.pivots[to_size(members[r].pivot)].stride,
                other = plan_.pivots[to_size(members[c].pivot)].stride;
      for (const bool turned : {false, true}) {
        if (turned && r == c) continue;
        assemble(target, block, rows, stride, columns, turned, A, scales);
        if (r == c && before != nullptr)
          for (int i = 0; i < rows; ++i)
            before[members[c].row + i] = std::abs(block[i * stride + i]);
        if (updated) update_of_front(target, block, rows, stride, columns, other, turned);
        const FrontNumbers<T>& to = turned ? U : L;
        for (int j = 0; j < columns; ++j)
          for (Index part = 0; part < parts_of<T>; ++part) {
            const double* const source = block + (j * parts_of<T> + part) * stride;
            double* const sink = to.at(members[r].row, members[c].row + j) + part * to.ld;
            for (int i = 0; i < rows; ++i) sink[i] += source[i];
          }
      }
    }
}

// Pivot `member`, its group of columns updated by what was before `group`, a row of the front.
template <class T>
bool BlockLu<T>::factor_in_front(std::size_t f, std::size_t group, std::size_t m,
                                 const double* before, PivotInertia* inertia) {
  const auto& front = plan_.fronts.all[f];
  const auto L = matrix_of<T>(front_lower_, front), U = matrix_of<T>(front_upper_, front);
  const auto& member = plan_.fronts.members[front.first_member + m];
  const auto j = to_size(member.pivot);
  const auto& pivot = plan_.pivots[j];
  const Index row = member.row, next = row + member.size, start = static_cast<Index>(group);
  const auto in_group_L = from_column(L, start), in_group_U = from_column(U, start);
  FrontProduct<T>{product_, front.rows - row, member.size, row - start}(L, row, row, in_group_L,
                                                                        row, in_group_U, row);
  FrontProduct<T>{product_, front.rows - next, member.size, row - start}(U, next, row, in_group_U,
                                                                         next, in_group_L, row);
  double* const D = diagonal_.data() + scalars(pivot.diagonal);
  for (int c = 0; c < member.size; ++c)
    for (Index part = 0; part < parts_of<T>; ++part) {
      double* const to = D + (c * parts_of<T> + part) * pivot.stride;
      std::fill(to, to + pivot.stride, 0.0);
      std::copy_n(L.at(row, row + c) + part * L.ld, member.size, to);
    }
  if (!factor_pivot(j, inertia)) return false;
  if (inertia != nullptr) add_least(j, before + row, *inertia);
  const double* const inverse = inverse_.data() + scalars(pivot.first_row);
  const int rows = static_cast<int>(front.rows - next), ld = static_cast<int>(front.ld);
  divide_block<T, true>(L.at(next, row), rows, ld, member.size, D, pivot.stride, inverse);
  if (exchanged_[j] != 0) {
    const std::int8_t* const exchanges = exchanges_.data() + pivot.first_row;
    T line[most_rows];
    for (Index i = next; i < front.rows; ++i) {
      for (int c = 0; c < member.size; ++c) line[c] = number(U.at(i, row + c), ld, T());
      for (int c = 0; c < member.size; ++c) put(U.at(i, row + c), ld, line[exchanges[c]]);
    }
  }
  divide_block<T, false>(U.at(next, row), rows, ld, member.size, D, pivot.stride, inverse);
  invert_triangles<T>(D, pivot.stride, member.size, inverse);
  return true;
}

template <class T>
bool BlockLu<T>::factor_front(std::size_t f, const T* A, const double* scales,
                              PivotInertia* inertia) {
  const auto& front = plan_.fronts.all[f];
  const auto* const members = plan_.fronts.members.data() + front.first_member;
  double* const before = inertia != nullptr ? front_x_.data() : nullptr;
  assemble_front(f, A, scales, before);
  const auto L = matrix_of<T>(front_lower_, front), U = matrix_of<T>(front_upper_, front);
  for (std::size_t m = 0; m < front.own_members;) {
    const Index start = members[m].row;
    std::size_t end = m;
    while (end < front.own_members && members[end].row + members[end].size - start <= block_columns)
      ++end;
    const Index columns = members[end - 1].row + members[end - 1].size - start;
    const FrontProduct<T> product{product_, front.rows - start, columns, start};
    product(L, start, start, L, start, U, start);
    product(U, start, start, U, start, L, start);
    for (; m < end; ++m)
      if (!factor_in_front(f, to_size(start), m, before, inertia)) return false;
  }
  update_above(f);
  return true;
}

template <class T>
void BlockLu<T>::update_above(std::size_t f) {
  const auto& plan = plan_.fronts;
  const auto& front = plan.all[f];
  const auto L = matrix_of<T>(front_lower_, front), U = matrix_of<T>(front_upper_, front);
  for (std::size_t g = front.first_group; g < front.last_group; ++g) {
    const auto& group = plan.groups[g];
    const auto& above = plan.all[group.front];
    const FrontNumbers<T> update{front_update_.data(), padded_rows(front.rows - group.begin)};
    const FrontProduct<T> product{product_, front.rows - group.begin, group.end - group.begin,
                                  front.width, true};
    product(update, 0, 0, L, group.begin, U, group.begin);
    add_scattered(plan, group, update, matrix_of<T>(front_lower_, above));
    product(update, 0, 0, U, group.begin, L, group.begin);
    add_scattered(plan, group, update, matrix_of<T>(front_upper_, above));
  }
}

// Rows of a front side by side, and back.
template <class T>
void BlockLu<T>::gather(std::size_t f) const {
  const auto& front = plan_.fronts.all[f];
  for (std::size_t m = front.first_member; m < front.last_member; ++m) {
    const auto& member = plan_.fronts.members[m];
    const auto& pivot = plan_.pivots[to_size(member.pivot)];
    for (Index part = 0; part < parts_of<T>; ++part)
      std::copy_n(x_.data() + scalars(pivot.first_row) + part * pivot.stride, member.size,
                  front_x_.data() + part * front.ld + member.row);
  }
  for (Index part = 0; part < parts_of<T>; ++part)
    std::fill(front_x_.begin() + part * front.ld + front.rows,
              front_x_.begin() + (part + 1) * front.ld, 0.0);
}

template <class T>
void BlockLu<T>::scatter(std::size_t f, bool below) const {
  const auto& front = plan_.fronts.all[f];
  const std::size_t end = below ? front.last_member : front.first_member + front.own_members;
  for (std::size_t m = front.first_member; m < end; ++m) {
    const auto& member = plan_.fronts.members[m];
    const auto& pivot = plan_.pivots[to_size(member.pivot)];
    for (Index part = 0; part < parts_of<T>; ++part)
      std::copy_n(front_x_.data() + part * front.ld + member.row, member.size,
                  x_.data() + scalars(pivot.first_row) + part * pivot.stride);
  }
}

template <class T>
void BlockLu<T>::forward_front(std::size_t f, bool transposed) const {
  const auto& front = plan_.fronts.all[f];
  const auto M = matrix_of<T>(transposed ? front_upper_ : front_lower_, front);
  gather(f);
  const int ld = static_cast<int>(front.ld);
  double* const x = front_x_.data();
  for (std::size_t m = front.first_member; m < front.first_member + front.own_members; ++m) {
    const auto& member = plan_.fronts.members[m];
    const auto j = to_size(member.pivot);
    const auto& pivot = plan_.pivots[j];
    const std::int8_t* const exchanges = exchanges_.data() + pivot.first_row;
    T own[most_rows];
    for (int i = 0; i < member.size; ++i)
      own[i] =
          number(x + member.row + (!transposed && exchanged_[j] != 0 ? exchanges[i] : i), ld, T());
    const Triangles<T> triangles{diagonal_.data() + scalars(pivot.diagonal), pivot.stride,
                                 member.size};
    if (transposed)
      triangles.upper_transposed(own);
    else
      triangles.lower(own);
    for (int i = 0; i < member.size; ++i) put(x + member.row + i, ld, own[i]);
    for (Index r = member.row + member.size; r < front.rows; r += lane_count) {
      Lanes<T> y, column;
      y.load(x + r, ld);
      for (int c = 0; c < member.size; ++c) {
        column.load(M.at(r, member.row + c), ld);
        y.subtract(column, own[c]);
      }
      y.store(x + r, ld);
    }
  }
  scatter(f, true);
}

template <class T>
void BlockLu<T>::backward_front(std::size_t f, bool transposed) const {
  const auto& front = plan_.fronts.all[f];
  const auto M = matrix_of<T>(transposed ? front_lower_ : front_upper_, front);
  gather(f);
  const int ld = static_cast<int>(front.ld);
  double* const x = front_x_.data();
  for (std::size_t m = front.first_member + front.own_members; m-- > front.first_member;) {
    const auto& member = plan_.fronts.members[m];
    const auto j = to_size(member.pivot);
    const auto& pivot = plan_.pivots[j];
    Lanes<T> sums[most_rows];
    for (int c = 0; c < member.size; ++c) sums[c].clear();
    for (Index r = member.row + member.size; r < front.rows; r += lane_count) {
      Lanes<T> y, column;
      y.load(x + r, ld);
      for (int c = 0; c < member.size; ++c) {
        column.load(M.at(r, member.row + c), ld);
        sums[c].add_product(column, y);
      }
    }
    T own[most_rows];
    for (int i = 0; i < member.size; ++i)
      own[i] = number(x + member.row + i, ld, T()) - sums[i].sum();
    const Triangles<T> triangles{diagonal_.data() + scalars(pivot.diagonal), pivot.stride,
                                 member.size};
    if (transposed)
      triangles.lower_transposed(own);
    else
      triangles.upper(own);
    const std::int8_t* const exchanges = exchanges_.data() + pivot.first_row;
    for (int i = 0; i < member.size; ++i)
      put(x + member.row + (transposed && exchanged_[j] != 0 ? exchanges[i] : i), ld, own[i]);
  }
  scatter(f, false);
}

// The class is instantiated in block_lu.cpp: of these members it has not seen the bodies.
template void BlockLu<double>::assemble_front(std::size_t, const double*, const double*, double*);
template bool BlockLu<double>::factor_in_front(std::size_t, std::size_t, std::size_t, const double*,
                                               PivotInertia*);
template bool BlockLu<double>::factor_front(std::size_t, const double*, const double*,
                                            PivotInertia*);
template void BlockLu<double>::update_above(std::size_t);
template void BlockLu<double>::gather(std::size_t) const;
template void BlockLu<double>::scatter(std::size_t, bool) const;
template void BlockLu<double>::forward_front(std::size_t, bool) const;
template void BlockLu<double>::backward_front(std::size_t, bool) const;
using Complex = std::complex<double>;
template void BlockLu<Complex>::assemble_front(std::size_t, const Complex*, const double*, double*);
template bool BlockLu<Complex>::factor_in_front(std::size_t, std::size_t, std::size_t,
                                                const double*, PivotInertia*);
template bool BlockLu<Complex>::factor_front(std::size_t, const Complex*, const double*,
                                             PivotInertia*);
template void BlockLu<Complex>::update_above(std::size_t);
template void BlockLu<Complex>::gather(std::size_t) const;
template void BlockLu<Complex>::scatter(std::size_t, bool) const;
template void BlockLu<Complex>::forward_front(std::size_t, bool) const;
template void BlockLu<Complex>::backward_front(std::size_t, bool) const;

}  // namespace mbd
