#include "solvers/modes/small_motions.hpp"

#include <algorithm>
#include <unordered_set>
#include <vector>

#include "libmbd/core/se3.hpp"
#include "solvers/newton/increments.hpp"

namespace mbd {

namespace {

using Block = Eigen::Map<Eigen::Matrix<double, 6, 6>, 0, Eigen::OuterStride<>>;

}  // namespace

SmallMotions::SmallMotions(const System& system)
    : system_(system), pencil_(make_klu_pencil_solver()), motions_(6 * (system.nodes() - 1)) {
  pencil_->analyze(system.graph());
}

bool SmallMotions::about(const State& state, std::span<const Vec6> axes) {
  state_ = state;
  state_.Vdot.assign(state_.V.size(), Vec6::Zero());
  return assemble(axes);
}

bool SmallMotions::frozen_at(const State& state) {
  state_ = state;
  return assemble({});
}

bool SmallMotions::assemble(std::span<const Vec6> axes) {
  std::vector<Mat6> W_hat(state_.V.size(), Mat6::Zero());
  for (std::size_t n = 1; n < W_hat.size(); ++n)
    W_hat[n] = twist_hat<double>(axes.empty() ? state_.V[n] : axes[n]);
  pencil_->set_zero();
  const bool in_range = system_.linearize_powers(
      state_, W_hat, r_, {pencil_->slots(0), pencil_->slots(1), pencil_->slots(2)});
  if (!axes.empty()) turn_axes(W_hat);
  accelerate();
  stiffness_ = largest_stiffness(system_, pencil_->slots(0));
  mass_ = largest_stiffness(system_, pencil_->slots(2));
  M_ = nonzeros(2);
  C_ = nonzeros(1);
  has_rates_ = largest_stiffness(system_, pencil_->slots(1)) > 0.0;
  scale_ = stiffness_ > 0.0 ? 1.0 / stiffness_ : 1.0;
  return in_range;
}

// What is done with the blocks of K, C, M between nodes, each once, and the nodes of its rows and columns.
template <class Change>
void SmallMotions::each_block(const Change& change) const {
  std::unordered_set<const double*> seen;  // contributions share places
  const auto& contributions = system_.graph().contributions;
  const auto nodes = static_cast<int>(motions_ / 6);
  for (std::size_t i = 0; i < contributions.size(); ++i) {
    const auto [row, column] = contributions[i];
    if (row < 0 || column < 0 || row >= nodes || column >= nodes) continue;
    if (!seen.insert(pencil_->slots(2)[i].data).second) continue;
    const auto block = [&](int power) {
      const Slot slot = pencil_->slots(power)[i];
      return Block(slot.data, Eigen::OuterStride<>(slot.ld));
    };
    change(block, row + 1, column + 1);
  }
}

// C -= M (V - W)~, K -= M (V - W)~ W~.
void SmallMotions::turn_axes(std::span<const Mat6> W_hat) {
  each_block([&](const auto& block, int, int column) {
    const auto n = static_cast<std::size_t>(column);
    const Eigen::Matrix<double, 6, 6> W = W_hat[n],
                                      ahead = block(2) * (twist_hat<double>(state_.V[n]) - W);
    block(1) -= ahead;
    block(0) -= ahead * W;
  });
}

// K += M Vdot~.
void SmallMotions::accelerate() {
  if (std::all_of(state_.Vdot.begin(), state_.Vdot.end(),
                  [](const Vec6& A) { return A.isZero(0.0); }))
    return;
  each_block([&](const auto& block, int, int column) {
    const Eigen::Matrix<double, 6, 6> A =
        twist_hat<double>(state_.Vdot[static_cast<std::size_t>(column)]);
    block(0) += block(2) * A;
  });
}

Eigen::SparseMatrix<double> SmallMotions::nonzeros(int power) const {
  std::vector<Eigen::Triplet<double>> entries;
  each_block([&](const auto& block, int row, int column) {
    const Block values = block(power);
    for (Index k = 0; k < 6; ++k)
      for (Index j = 0; j < 6; ++j)
        if (values(j, k) != 0.0)
          entries.emplace_back(6 * (row - 1) + j, 6 * (column - 1) + k, values(j, k));
  });
  Eigen::SparseMatrix<double> matrix(motions_, motions_);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

bool SmallMotions::is_symmetric() const {
  constexpr double round_off = 1e-9;  // and what is left of equilibrium by its iterations
  const auto is = [](const Eigen::SparseMatrix<double>& A) {
    const Eigen::SparseMatrix<double> skew = A - Eigen::SparseMatrix<double>(A.transpose());
    const VecX size = A.diagonal().cwiseAbs().cwiseSqrt();
    for (Index column = 0; column < skew.outerSize(); ++column)
      for (Eigen::SparseMatrix<double>::InnerIterator it(skew, column); it; ++it)
        if (std::abs(it.value()) > round_off * size(it.row()) * size(column)) return false;
    return true;
  };
  return is(nonzeros(0)) && is(C_);
}

Eigen::SparseMatrix<double> SmallMotions::constraint_gradient() const {
  std::vector<Eigen::Triplet<double>> entries;
  std::unordered_set<const double*> seen;
  const auto& contributions = system_.graph().contributions;
  const auto nodes = static_cast<int>(motions_ / 6);
  for (std::size_t i = 0; i < contributions.size(); ++i) {
    const auto [row, column] = contributions[i];
    if (row < nodes || column < 0 || column >= nodes) continue;
    const Slot slot = pencil_->slots(0)[i];
    if (!seen.insert(slot.data).second) continue;
    const ConstraintInfo& of = system_.constraints()[static_cast<std::size_t>(row - nodes)];
    for (Index k = 0; k < 6; ++k)
      for (Index j = 0; j < of.rows; ++j)
        if (const double value = slot.data[k * slot.ld + j]; value != 0.0)
          entries.emplace_back(of.first_row + j, 6 * Index{column} + k, value);
  }
  Eigen::SparseMatrix<double> matrix(unknowns() - motions_, motions_);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

VecX SmallMotions::opening(const VecX& x) const {
  VecX all = VecX::Zero(unknowns()), sum = all;
  all.head(motions_) = x;
  pencil_->multiply(0, {all.data(), static_cast<std::size_t>(all.size())},
                    {sum.data(), static_cast<std::size_t>(sum.size())});
  return sum.tail(unknowns() - motions_);
}

void SmallMotions::hold(Index motion) {
  const auto block = static_cast<int>(motion / 6);
  const double length = motion % 6 < 3 ? 1.0 : system_.length_scale();
  const auto& contributions = system_.graph().contributions;
  for (std::size_t i = 0; i < contributions.size(); ++i) {
    if (contributions[i].row != block || contributions[i].column != block) continue;
    const Slot slot = pencil_->slots(0)[i];
    slot.data[(motion % 6) * (slot.ld + 1)] += stiffness_ * length * length;
    return;
  }
}

// About 0 what moves freely leaves a pivot of round-off: with the same pivots solutions about 970/s had five digits.
bool SmallMotions::factor(double s) {
  pencil_->forget_pivots();
  return pencil_->factor_real(scale_, s) == FactorStatus::ok;
}
bool SmallMotions::factor(std::complex<double> s) {
  pencil_->forget_pivots();
  return pencil_->factor_complex(scale_, s) == FactorStatus::ok;
}

template <class Columns>
void SmallMotions::solve_columns(Columns& B) const {
  Columns all = Columns::Zero(unknowns(), B.cols());
  all.topRows(motions_) = scale_ * B;
  pencil_->solve_columns({all.data(), static_cast<std::size_t>(all.size())}, all.cols());
  B = all.topRows(motions_);
}
template void SmallMotions::solve_columns(Eigen::MatrixXd&) const;
template void SmallMotions::solve_columns(Eigen::MatrixXcd&) const;

// E = S Q, S of the rows of motions: Q^-T = S E^-T.
VecXc SmallMotions::solve_transposed(const VecXc& b) const {
  VecXc all = VecXc::Zero(unknowns());
  all.head(motions_) = b;
  pencil_->solve_transposed({all.data(), static_cast<std::size_t>(all.size())});
  return scale_ * all.head(motions_);
}

void SmallMotions::solve_all(VecX& b) const {
  b.head(motions_) *= scale_;
  pencil_->solve({b.data(), static_cast<std::size_t>(b.size())});
  b.tail(b.size() - motions_) /= scale_;
}

}  // namespace mbd
