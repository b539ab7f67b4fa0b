#include "solvers/modes/instants_lu.hpp"

#include <algorithm>

#include "libmbd/core/stop.hpp"

namespace mbd {

template <class T>
InstantsLu<T>::InstantsLu(const BlockGraph& graph, Index instants) : instants_(instants) {
  const Elimination plan = eliminate(graph, PivotOrder::merged);
  Index first = 0;
  for (std::size_t p = 0; p < plan.pivots.size(); ++p) {
    Pivot& pivot = pivots_.emplace_back();
    pivot.size = instants * plan.pivots[p].size;
    pivot.first = first;
    first += pivot.size;
    for (std::size_t k = plan.begin[p]; k < plan.begin[p + 1]; ++k)
      pivot.below.push_back(static_cast<std::size_t>(plan.below[k]));
  }
  for (std::size_t b = 0; b < graph.blocks.size(); ++b) {
    const auto pivot = static_cast<std::size_t>(plan.pivot_of[b]);
    for (int k = 0; k < graph.blocks[b].size; ++k)
      unknowns_.push_back({pivot, plan.place_of[b] + k, plan.pivots[pivot].size});
  }
}

template <class T>
void InstantsLu<T>::set_zero() {
  for (Pivot& pivot : pivots_) {
    pivot.diagonal.setZero(pivot.size, pivot.size);
    pivot.L.resize(pivot.below.size());
    pivot.U.resize(pivot.below.size());
    for (std::size_t k = 0; k < pivot.below.size(); ++k) {
      const Index size = pivots_[pivot.below[k]].size;
      pivot.L[k].setZero(size, pivot.size);
      pivot.U[k].setZero(pivot.size, size);
    }
  }
}

template <class T>
typename InstantsLu<T>::Dense& InstantsLu<T>::block(std::size_t p, std::size_t q) {
  if (p == q) return pivots_[p].diagonal;
  Pivot& pivot = pivots_[std::min(p, q)];
  const auto place = static_cast<std::size_t>(
      std::ranges::lower_bound(pivot.below, std::max(p, q)) - pivot.below.begin());
  return p > q ? pivot.L[place] : pivot.U[place];
}

template <class T>
bool InstantsLu<T>::factor() {
  for (Pivot& pivot : pivots_) {
    stop::check();
    pivot.lu.compute(pivot.diagonal);
    if (!pivot.lu.matrixLU().allFinite()) return false;
    const auto upper = pivot.lu.matrixLU().template triangularView<Eigen::Upper>();
    const auto lower = pivot.lu.matrixLU().template triangularView<Eigen::UnitLower>();
    for (std::size_t k = 0; k < pivot.below.size(); ++k) {
      upper.template solveInPlace<Eigen::OnTheRight>(pivot.L[k]);
      pivot.U[k] = pivot.lu.permutationP() * pivot.U[k];
      lower.solveInPlace(pivot.U[k]);
    }
    for (std::size_t i = 0; i < pivot.below.size(); ++i)
      for (std::size_t j = 0; j < pivot.below.size(); ++j)
        block(pivot.below[i], pivot.below[j]).noalias() -= pivot.L[i] * pivot.U[j];
  }
  return true;
}

template <class T>
void InstantsLu<T>::reorder(const Dense& from, Dense& to, bool back) const {
  Index row = 0;
  for (Index i = 0; i < instants_; ++i)
    for (const Unknown& u : unknowns_) {
      const Index place = pivots_[u.pivot].first + i * u.size + u.place;
      if (back)
        to.row(row++) = from.row(place);
      else
        to.row(place) = from.row(row++);
    }
}

template <class T>
typename InstantsLu<T>::Dense InstantsLu<T>::solve(const Dense& b) const {
  Dense x(b.rows(), b.cols()), result(b.rows(), b.cols());
  reorder(b, x, false);
  const auto rows_of = [&](std::size_t p) {
    return x.middleRows(pivots_[p].first, pivots_[p].size);
  };
  for (std::size_t p = 0; p < pivots_.size(); ++p) {
    const Pivot& pivot = pivots_[p];
    auto part = rows_of(p);
    part = (pivot.lu.permutationP() * part).eval();
    pivot.lu.matrixLU().template triangularView<Eigen::UnitLower>().solveInPlace(part);
    for (std::size_t k = 0; k < pivot.below.size(); ++k)
      rows_of(pivot.below[k]).noalias() -= pivot.L[k] * part;
  }
  for (std::size_t p = pivots_.size(); p-- > 0;) {
    const Pivot& pivot = pivots_[p];
    auto part = rows_of(p);
    for (std::size_t k = 0; k < pivot.below.size(); ++k)
      part.noalias() -= pivot.U[k] * rows_of(pivot.below[k]);
    pivot.lu.matrixLU().template triangularView<Eigen::Upper>().solveInPlace(part);
  }
  reorder(x, result, true);
  return result;
}

template class InstantsLu<double>;
template class InstantsLu<std::complex<double>>;

}  // namespace mbd
