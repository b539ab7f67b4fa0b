#include "solvers/constraints/free_motions.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "libmbd/core/se3.hpp"
#include "solvers/constraints/redundancy.hpp"

namespace mbd {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

}  // namespace

UnitMotions::UnitMotions(const System& system, const State& state)
    : system_(system), length_(tied_lengths(system, state)) {
  row_.setOnes(system.multipliers());
  VecX squares = VecX::Zero(row_.size());
  const Sparse B = gradient(state);
  for (int k = 0; k < B.outerSize(); ++k)
    for (Sparse::InnerIterator it(B, k); it; ++it) squares(it.row()) += it.value() * it.value();
  for (Index i = 0; i < row_.size(); ++i)
    if (squares(i) > 0.0) row_(i) = std::sqrt(squares(i));
}

Sparse UnitMotions::gradient(const State& state) const {
  ConstraintEntries entries = scaled_gradient(system_, state, length_);
  for (auto& e : entries)
    e = {e.row(), e.col(),
         e.value() * length_[static_cast<std::size_t>(e.col() / 6 + 1)] / row_(e.row())};
  Sparse B(system_.multipliers(), 6 * (system_.nodes() - 1));
  B.setFromTriplets(entries.begin(), entries.end());
  return B;
}

VecX UnitMotions::gaps(const State& state) const {
  State all = state;
  all.idle.clear();
  VecX g, rates;
  system_.constraints(all, g, rates);
  return g.cwiseQuotient(row_);
}

Sparse UnitMotions::of_unit_rows(const Sparse& n) const { return row_.asDiagonal() * n; }

Vec6 UnitMotions::of_node(const VecX& z, std::size_t node) const {
  Vec6 u = z.segment<6>(6 * static_cast<Index>(node - 1));
  u.head<3>() *= length_[node];
  return u;
}

State UnitMotions::moved(State state, const VecX& z, double by) const {
  for (std::size_t n = 1; n < state.pose.size(); ++n)
    state.pose[n] = state.pose[n] * exp_se3<double>(by * of_node(z, n));
  return state;
}

OntoFreeMotions::OntoFreeMotions(const Sparse& B, std::vector<Index> rows,
                                 const std::vector<Index>& idle)
    : motions_(B.cols()) {
  std::erase_if(rows, [&](Index row) { return std::ranges::binary_search(idle, row); });
  std::vector<int> place(static_cast<std::size_t>(B.rows()), -1);
  for (std::size_t i = 0; i < rows.size(); ++i)
    place[static_cast<std::size_t>(rows[i])] = static_cast<int>(motions_) + static_cast<int>(i);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < motions_; ++i) entries.emplace_back(i, i, 1.0);
  for (int k = 0; k < B.outerSize(); ++k)
    for (Sparse::InnerIterator it(B, k); it; ++it) {
      const int row = place[static_cast<std::size_t>(it.row())],
                column = static_cast<int>(it.col());
      if (row < 0) continue;
      entries.emplace_back(row, column, it.value());
      entries.emplace_back(column, row, it.value());
    }
  const Index size = motions_ + static_cast<Index>(rows.size());
  Sparse all(size, size);
  all.setFromTriplets(entries.begin(), entries.end());
  lu_.compute(all);
  rows_ = std::move(rows);
}

VecX OntoFreeMotions::closing(const VecX& gaps) const {
  VecX b = VecX::Zero(lu_.rows());
  for (std::size_t i = 0; i < rows_.size(); ++i)
    b(motions_ + static_cast<Index>(i)) = -gaps(rows_[i]);
  return lu_.solve(b).head(motions_);
}

Eigen::MatrixXd OntoFreeMotions::operator()(const Eigen::MatrixXd& motions) const {
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(lu_.rows(), motions.cols());
  b.topRows(motions_) = motions;
  return lu_.solve(b).topRows(motions_);
}

VecX OntoFreeMotions::random(unsigned seed) const {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  VecX z(motions_);
  for (double& entry : z) entry = number(random);
  VecX u = (*this)(z);
  constexpr double moves = 1e-8;  // less is round-off, of no direction
  if (!(u.norm() > moves * z.norm())) return {};
  u /= u.cwiseAbs().maxCoeff();
  return u;
}

VecX random_free_motion(const System& system, const State& state, const UnitMotions& units,
                        unsigned seed) {
  std::vector<Index> rows;
  for (const ConstraintInfo& info : system.constraints())
    for (Index i = 0; i < info.rows && !info.gives; ++i) rows.push_back(info.first_row + i);
  const OntoFreeMotions free(units.gradient(state), std::move(rows),
                             find_redundancy(system, state).idle);
  return free.ok() ? free.random(seed) : VecX::Ones(6 * (system.nodes() - 1));
}

}  // namespace mbd
