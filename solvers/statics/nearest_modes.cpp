#include "solvers/statics/nearest_modes.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "libmbd/core/stop.hpp"
#include "solvers/linear/krylov.hpp"

namespace mbd {
namespace {

constexpr Index wanted = 12;
constexpr double is_real = 1e-6;  // imaginary part, of the size
constexpr double alike = 0.25;    // |x^H W y|^2 of one mode at two equilibria
constexpr double far_enough =
    0.3;  // of the farthest found: a mode beyond may be missing at the other

// K^-1 W of motions.
class Inverse final : public WeightedOperator {
 public:
  Inverse(const System& system, const LinearSolver& solver)
      : solver_(solver), w_(motion_weights(system)), motions_(6 * (system.nodes() - 1)) {}

  Index size() const override { return motions_; }
  Eigen::MatrixXd weigh(const Eigen::MatrixXd& X) const override {
    return w_.head(motions_).asDiagonal() * X;
  }
  Eigen::MatrixXd times(const Eigen::MatrixXd& X) const override {
    stop::check();
    Eigen::MatrixXd Y(motions_, X.cols());
    VecX y(w_.size());
    for (Index k = 0; k < X.cols(); ++k) {
      y.setZero();
      y.head(motions_) = w_.head(motions_).cwiseProduct(X.col(k));
      solver_.solve({y.data(), static_cast<std::size_t>(y.size())});
      Y.col(k) = y.head(motions_);
    }
    return Y;
  }

 private:
  const LinearSolver& solver_;
  VecX w_;
  Index motions_;
};

bool is_negative(const std::complex<double>& value) { return value.real() < 0.0; }
bool is_real_value(const std::complex<double>& value) {
  return std::abs(value.imag()) <= is_real * std::abs(value);
}

}  // namespace

Index NearestModes::negative() const {
  Index count = 0;
  for (Index k = 0; k < values.size(); ++k)
    count += is_real_value(values(k)) && is_negative(values(k)) ? 1 : 0;
  return count;
}

std::optional<NearestModes> nearest_modes(const System& system, LinearSolver& solver,
                                          const State& state, std::span<const Vec6> resultants,
                                          const Holds& holds) {
  VecX r;
  system.linearize_mixed(state, resultants, r, solver);
  add_holds(system, solver.slots(), holds);
  if (solver.factor() != FactorStatus::ok) return std::nullopt;
  const Inverse inverse(system, solver);
  KrylovWork work;
  const EigenPairs pairs = largest_eigenpairs(inverse, wanted, work);
  NearestModes modes;
  modes.determinant_sign = solver.determinant_sign();
  std::vector<Index> kept;
  const auto found = std::min<Index>(pairs.values.size(), 2 * wanted);
  for (Index k = 0; k < found; ++k)
    if (std::abs(pairs.values(k)) > least_share * std::abs(pairs.values(0))) kept.push_back(k);
  if (kept.empty() || !pairs.vectors.allFinite()) return std::nullopt;
  modes.values.resize(std::ssize(kept));
  modes.shapes.resize(inverse.size(), std::ssize(kept));
  const VecX w = motion_weights(system).head(inverse.size());
  for (Index k = 0; k < std::ssize(kept); ++k) {
    const Index of = kept[static_cast<std::size_t>(k)];
    modes.values(k) = 1.0 / pairs.values(of);
    const Eigen::VectorXcd x = pairs.vectors.col(of);
    modes.shapes.col(k) = x / std::sqrt(x.cwiseAbs2().dot(w));
  }
  return modes;
}

std::optional<Index> through_zero(const VecX& weights, const NearestModes& from,
                                  const NearestModes& to) {
  const VecX w = weights.head(from.shapes.rows());
  const Eigen::MatrixXd overlap = (from.shapes.adjoint() * w.asDiagonal() * to.shapes).cwiseAbs2();
  std::vector<std::tuple<double, Index, Index>> pairs;
  for (Index i = 0; i < overlap.rows(); ++i)
    for (Index j = 0; j < overlap.cols(); ++j)
      if (overlap(i, j) > alike) pairs.emplace_back(-overlap(i, j), i, j);
  std::ranges::sort(pairs);
  std::vector<char> has_from(static_cast<std::size_t>(overlap.rows()), 0),
      has_to(static_cast<std::size_t>(overlap.cols()), 0);
  Index count = 0;
  for (const auto& [size, i, j] : pairs) {
    char &first = has_from[static_cast<std::size_t>(i)],
         &second = has_to[static_cast<std::size_t>(j)];
    if (first != 0 || second != 0) continue;
    first = second = 1;
    const std::complex<double> a = from.values(i), b = to.values(j);
    if (is_negative(a) == is_negative(b)) continue;
    if (is_real_value(a) != is_real_value(b)) return std::nullopt;
    if (is_real_value(a)) ++count;
  }
  // One of the nearest without its like.
  const double reach = far_enough * std::min(std::abs(from.values(from.values.size() - 1)),
                                             std::abs(to.values(to.values.size() - 1)));
  const auto is_lost = [reach](const Eigen::VectorXcd& values, const std::vector<char>& has) {
    for (Index k = 0; k < values.size(); ++k)
      if (has[static_cast<std::size_t>(k)] == 0 && std::abs(values(k)) < reach) return true;
    return false;
  };
  if (is_lost(from.values, has_from) || is_lost(to.values, has_to)) return std::nullopt;
  const bool is_odd = count % 2 == 1, changes = from.determinant_sign * to.determinant_sign < 0;
  if (from.determinant_sign != 0 && to.determinant_sign != 0 && is_odd != changes)
    return std::nullopt;
  return count;
}

}  // namespace mbd
