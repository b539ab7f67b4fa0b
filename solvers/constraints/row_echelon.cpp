#include "solvers/constraints/row_echelon.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "libmbd/core/stop.hpp"

namespace mbd {

RowEchelon::RowEchelon(const std::vector<Eigen::Triplet<double>>& entries, Index rows,
                       Index columns, double threshold)
    : rows_(static_cast<std::size_t>(columns)), columns_(rows_.size()) {
  Eigen::SparseMatrix<double, Eigen::RowMajor> A(rows, columns);
  A.setFromTriplets(entries.begin(), entries.end());
  // Those that begin first, first: they meet the fewest others.
  std::vector<Row> waiting;
  for (Index i = 0; i < rows; ++i) {
    Row row;
    for (decltype(A)::InnerIterator it(A, i); it; ++it)
      if (it.value() != 0.0) row.emplace_back(it.col(), it.value());
    if (!row.empty()) waiting.push_back(std::move(row));
  }
  std::stable_sort(waiting.begin(), waiting.end(),
                   [](const Row& a, const Row& b) { return a.front().first < b.front().first; });
  for (Row& row : waiting) merge(std::move(row));

  for (std::size_t k = 0; k < rows_.size(); ++k) {
    if (rows_[k].empty()) continue;
    if (std::abs(rows_[k].front().second) <= threshold) {
      Row rest(rows_[k].begin() + 1, rows_[k].end());
      rows_[k].clear();
      merge(std::move(rest));
      continue;
    }
    for (const auto& [column, value] : rows_[k])
      columns_[static_cast<std::size_t>(column)].emplace_back(static_cast<Index>(k), value);
  }
}

void RowEchelon::merge(Row row) {
  stop::check();
  Row upper, lower;
  while (!row.empty()) {
    Row& with = rows_[static_cast<std::size_t>(row.front().first)];
    if (with.empty()) {
      with = std::move(row);
      return;
    }
    const double length = std::hypot(with.front().second, row.front().second);
    const double c = with.front().second / length, s = row.front().second / length;
    upper.clear();
    lower.clear();
    upper.emplace_back(row.front().first, length);
    const auto add = [&](Index column, double a, double b) {
      upper.emplace_back(column, c * a + s * b);
      // What is nothing to the last bit is left out, or zeros would fill what has no entries.
      if (const double below = c * b - s * a; below != 0.0) lower.emplace_back(column, below);
    };
    auto a = with.begin() + 1, b = row.begin() + 1;
    while (a != with.end() || b != row.end())
      if (b == row.end() || (a != with.end() && a->first < b->first)) {
        add(a->first, a->second, 0.0);
        ++a;
      } else if (a == with.end() || b->first < a->first) {
        add(b->first, 0.0, b->second);
        ++b;
      } else {
        add(a->first, a->second, b->second);
        ++a;
        ++b;
      }
    with.swap(upper);
    row.swap(lower);
  }
}

std::vector<std::pair<Index, double>> RowEchelon::combination(Index column) const {
  // R_11 x = R_column, from the last row up; only rows that something reaches are looked at.
  std::map<Index, double, std::greater<>> open;
  for (const auto& [row, value] : columns_[static_cast<std::size_t>(column)])
    open.emplace(row, value);
  std::vector<std::pair<Index, double>> result;
  while (!open.empty()) {
    const auto [k, rest] = *open.begin();
    open.erase(open.begin());
    const Row& of = columns_[static_cast<std::size_t>(k)];
    const double x = rest / of.back().second;  // the last of a column is its diagonal
    if (x == 0.0) continue;
    result.emplace_back(k, x);
    for (auto it = of.begin(); it + 1 != of.end(); ++it) open[it->first] -= x * it->second;
  }
  std::reverse(result.begin(), result.end());
  return result;
}

}  // namespace mbd
