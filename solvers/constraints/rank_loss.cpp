#include "solvers/constraints/rank_loss.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseLU>
#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "libmbd/core/se3.hpp"
#include "solvers/constraints/redundancy.hpp"

namespace mbd {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr double little = 1e-4;  // rad, and of the scene's length: of the difference
// What n^T dB[u] is where it is of the size of n, B and u: motions of a door on two hinges change nothing.
constexpr double of_size = 0.1;
constexpr double none = 1e-5;  // of n^T dB[u]: what errors of n and of the difference leave of (1)

// Onto the motions that a full set of rows leaves free.
class Projection {
 public:
  explicit Projection(const Sparse& B) : motions_(B.cols()) {
    std::vector<Eigen::Triplet<double>> entries;
    for (Index i = 0; i < motions_; ++i)
      entries.emplace_back(static_cast<int>(i), static_cast<int>(i), 1.0);
    for (int k = 0; k < B.outerSize(); ++k)
      for (Sparse::InnerIterator it(B, k); it; ++it) {
        const auto row = static_cast<int>(motions_ + it.row()), column = static_cast<int>(it.col());
        entries.emplace_back(row, column, it.value());
        entries.emplace_back(column, row, it.value());
      }
    Sparse all(motions_ + B.rows(), motions_ + B.rows());
    all.setFromTriplets(entries.begin(), entries.end());
    lu_.compute(all);
  }
  bool ok() const { return lu_.info() == Eigen::Success; }
  Eigen::MatrixXd operator()(const Eigen::MatrixXd& X) const {
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(lu_.rows(), X.cols());
    b.topRows(motions_) = X;
    return lu_.solve(b).topRows(motions_);
  }

 private:
  Index motions_;
  Eigen::SparseLU<Sparse, Eigen::COLAMDOrdering<int>> lu_;
};

// All rows of B, over motions in one unit.
Sparse gradient(const System& system, const State& state) {
  const ConstraintEntries entries = scaled_gradient(system, state);
  Sparse B(system.multipliers(), 6 * (system.nodes() - 1));
  B.setFromTriplets(entries.begin(), entries.end());
  return B;
}

// The rows among them that are independent, and may depend on others elsewhere.
Sparse independent_rows(const System& system, const Sparse& B, const std::vector<Index>& idle) {
  std::vector<Index> place(static_cast<std::size_t>(B.rows()), -1);
  Index count = 0;
  for (const Index row : rows_in_loops(system))
    if (!std::binary_search(idle.begin(), idle.end(), row))
      place[static_cast<std::size_t>(row)] = count++;
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < B.outerSize(); ++k)
    for (Sparse::InnerIterator it(B, k); it; ++it)
      if (const Index row = place[static_cast<std::size_t>(it.row())]; row >= 0)
        entries.emplace_back(static_cast<int>(row), static_cast<int>(it.col()), it.value());
  Sparse result(count, B.cols());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

State moved(const System& system, State state, const VecX& z, double by) {
  const double L = system.length_scale();
  for (std::size_t n = 1; n < state.pose.size(); ++n) {
    Vec6 u = by * z.segment<6>(6 * static_cast<Index>(n - 1));
    u.tail<3>() /= L;
    state.pose[n] = state.pose[n] * exp_se3<double>(u);
  }
  return state;
}

// "revolute 'A', revolute 'B' and 3 more": those whose rows count among all, in the order of the scene.
std::string joints_of(const System& system, const VecX& rows) {
  constexpr double involved = 1e-3;
  constexpr std::size_t most = 6;
  const double least = involved * rows.cwiseAbs().maxCoeff();
  std::vector<std::string> names;
  for (const ConstraintInfo& info : system.constraints())
    if (rows.segment(info.first_row, info.rows).cwiseAbs().maxCoeff() > least)
      names.push_back(info.name);
  const std::size_t more = names.size() > most ? names.size() - most : 0;
  names.resize(names.size() - more);
  const std::string text = fmt::format("{}", fmt::join(names, ", "));
  return more > 0 ? fmt::format("{} and {} more", text, more) : text;
}

}  // namespace

std::string rank_loss(const System& system, const State& state) {
  const Redundancy redundancy = find_redundancy(system, state);
  if (redundancy.idle.empty()) return {};
  const Sparse B = gradient(system, state);
  const Projection projection(independent_rows(system, B, redundancy.idle));
  if (!projection.ok()) return "constraints depend on each other to nearly the first order";
  Eigen::MatrixXd n = redundancy.null;
  n.colwise().normalize();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  VecX z(B.cols());
  for (double& entry : z) entry = number(random);
  VecX u = projection(z);
  constexpr double moves = 1e-8;  // less is round-off, of no direction
  if (!(u.norm() > moves * z.norm())) return {};
  u /= u.cwiseAbs().maxCoeff();
  const double by = little * system.length_scale();
  const Eigen::MatrixXd ahead = gradient(system, moved(system, state, u, by)).transpose() * n,
                        behind = gradient(system, moved(system, state, u, -by)).transpose() * n;
  const Eigen::MatrixXd change = (0.5 / little) * (ahead - behind), free = projection(change);
  const double size = std::max(of_size, change.colwise().norm().maxCoeff());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> squares(free.transpose() * free);
  const Index most = n.cols() - 1;
  if (!(squares.eigenvalues()(most) > none * none * size * size)) return {};
  return fmt::format("the constraints of {} lose rank in this configuration",
                     joints_of(system, n * squares.eigenvectors().col(most)));
}

}  // namespace mbd
