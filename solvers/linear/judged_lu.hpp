// Block LU with what goes with it: its plan, units of multipliers, and a judgement of its solutions (block_solver.hpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "solvers/linear/backward_error.hpp"
#include "solvers/linear/block_lu.hpp"

namespace mbd {

// Multipliers in units in which their columns are as large as the diagonals of their nodes, so that pivots that they share
// are compared in one unit. Powers of two: nothing is rounded.
class MultiplierScales {
 public:
  explicit MultiplierScales(const BlockColumns& columns)
      : most_(static_cast<std::size_t>(columns.n)), weighted_(most_.size()) {
    for (int c = 0; c < columns.blocks(); ++c) {
      const auto C = static_cast<std::size_t>(c);
      if (columns.kinds[C] == 0) continue;
      Index diagonal = -1;
      for (std::size_t e = columns.begin[C]; e < columns.begin[C + 1]; ++e)
        if (columns.entries[e].row == c) diagonal = columns.entries[e].offset;
      for (std::size_t e = columns.begin[C]; diagonal >= 0 && e < columns.begin[C + 1]; ++e) {
        const int row = columns.entries[e].row;
        if (columns.kinds[static_cast<std::size_t>(row)] == 0)
          gradients_.push_back({columns.first[static_cast<std::size_t>(row)], columns.size(row),
                                columns.size(c), columns.entries[e].offset, diagonal,
                                columns.height[C]});
      }
    }
  }

  // Into `scales`: of all unknowns, 1 but of multipliers.
  template <class T>
  void of(const T* A, std::vector<double>& scales) {
    scales.resize(most_.size(), 1.0);
    for (const Gradient& g : gradients_)
      for (int i = 0; i < g.rows; ++i) {
        const auto row = static_cast<std::size_t>(g.first_row + i);
        most_[row] = weighted_[row] = 0.0;
      }
    for (const Gradient& g : gradients_)
      for (int j = 0; j < g.columns; ++j) {
        const double K = std::abs(A[g.diagonal + j * (g.height + 1)]);
        for (int i = 0; i < g.rows; ++i) {
          const auto row = static_cast<std::size_t>(g.first_row + i);
          const double B = std::abs(A[g.offset + j * g.height + i]);
          most_[row] = std::max(most_[row], B);
          weighted_[row] = std::max(weighted_[row], B * K);
        }
      }
    for (const Gradient& g : gradients_)
      for (int i = 0; i < g.rows; ++i) {
        const auto row = static_cast<std::size_t>(g.first_row + i);
        const double scale = weighted_[row] / (most_[row] * most_[row]);
        scales[row] =
            scale > 1e-200 && scale < 1e200 ? std::exp2(std::round(std::log2(scale))) : 1.0;
      }
  }

 private:
  struct Gradient {
    int first_row, rows, columns;
    Index offset, diagonal, height;
  };
  std::vector<Gradient> gradients_;
  std::vector<double> most_, weighted_;
};

template <class T>
class Judged;

// A plan with what it needs to be carried out.
struct Prepared {
  Prepared(const BlockGraph& graph, const BlockColumns& columns, PivotOrder order)
      : Prepared(columns, eliminate(graph, order), order) {}
  template <class T>
  bool factor(Judged<T>& of, const T* A, PivotInertia* inertia = nullptr) {
    if (scales) scales->of(A, of.scales);
    return of.lu.factor(A, scales ? of.scales.data() : nullptr, inertia);
  }
  BlockLuPlan plan;
  bool dissected = false;  // the order is METIS'
  std::optional<MultiplierScales> scales;

 private:
  Prepared(const BlockColumns& columns, const Elimination& elimination, PivotOrder order)
      : plan(columns, elimination), dissected(elimination.dissected) {
    if (order == PivotOrder::merged) scales.emplace(columns);
  }
};

// Up to which backward error a solution is refined, and how often. What is further off, or stays so, KLU is asked for.
struct Refinement {
  double refinable;
  int most;
};
// In time, what is further off is near a singular matrix: with all errors refined, windows went through its change points
// unnoticed, at twice the error; with none, four_bar pays both solvers.
inline constexpr Refinement refinement_in_time{1e-9, 1};
// Of equilibria, where multipliers are merged from the start: pivots of sectional forces that hardly give way (held_strains.hpp) are
// no better than their couplings with the node that they share, and KLU takes 50 times as long for a frame of 1012 beams.
inline constexpr Refinement refinement_in_statics{1e-3, 6};

// Solutions by one factorisation: the first is judged, and how often it was refined, others are too.
template <class T>
class Judged {
 public:
  Judged(const BlockLuPlan& plan, const BlockColumns& columns,
         const Refinement& refinement = refinement_in_time)
      : lu(plan), columns_(columns), refinement_(refinement) {}

  void begin() {
    judged_ = false;
    refinements_ = 0;
  }

  // False: x is left as it was, it cannot be found. A nullptr: nothing to judge by.
  bool solve(std::span<T> x, const T* A, long& refined) {
    if (A == nullptr || (judged_ && refinements_ == 0)) {
      lu.solve(x.data());
      return true;
    }
    b_.assign(x.begin(), x.end());
    lu.solve(x.data());
    for (int k = 0;; ++k) {
      const double error = error_(columns_, A, b_.data(), x.data(), r_);
      if (error <= accurate) {
        // A solution of nothing says nothing.
        judged_ = judged_ || error > 0.0;
        refinements_ = std::max(refinements_, k);
        return true;
      }
      if (k == refinement_.most || !(error < refinement_.refinable)) break;
      ++refined;
      lu.solve(r_.data());
      for (std::size_t i = 0; i < x.size(); ++i) x[i] += r_[i];
    }
    std::copy(b_.begin(), b_.end(), x.begin());
    return false;
  }

  // About the spectral radius of 1 - F^-1 A, F the product of the factors: by how much a refinement shrinks the error of a vector,
  // the third time. Below 1 no matrix between A and F is singular, and their eigenvalues have the same signs.
  double contraction(const T* A) {
    constexpr int passes = 3;
    const std::size_t n = static_cast<std::size_t>(columns_.n);
    std::vector<T> v(n);
    for (std::size_t i = 0; i < n; ++i) v[i] = std::sin(1.0 + 2.7 * static_cast<double>(i % 1009));
    b_.assign(n, T(0.0));
    double before = 1.0, now = 1.0;
    for (int k = 0; k < passes; ++k) {
      error_(columns_, A, b_.data(), v.data(), r_);
      lu.solve(r_.data());
      before = now;
      now = 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        v[i] += r_[i];
        now = std::max(now, std::abs(v[i]));
      }
      if (!(now > 0.0)) return now;  // 0, or not a number
    }
    return now / before;
  }

  // By the last factorisation.
  bool is_judged() const { return judged_; }
  bool was_refined() const { return refinements_ > 0; }

  BlockLu<T> lu;
  std::vector<double> scales;  // of its factors, which refer to them

 private:
  static constexpr double accurate = 1e-10;  // backward error

  const BlockColumns& columns_;
  const Refinement refinement_;
  BackwardError<T> error_;
  std::vector<T> b_, r_;
  bool judged_ = false;
  int refinements_ = 0;
};

}  // namespace mbd
