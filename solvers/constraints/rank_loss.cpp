#include "solvers/constraints/rank_loss.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "solvers/constraints/free_motions.hpp"
#include "solvers/constraints/redundancy.hpp"

namespace mbd {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

// What n^T dB[u] is where it is of the size of n, B and u: motions of a door on two hinges change nothing.
constexpr double of_size = 0.1;
constexpr double none = 1e-9;  // of n^T dB[u]: what errors of n and of the difference leave of (1)

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

// dB[u], by unit motions and rows. Central differences, without the third order of the motion, over a step that is short beside
// the links: beside a plate these may be rods of any length.
Sparse change_along(const UnitMotions& units, const State& state, const VecX& u) {
  constexpr double longest = 1e-3, shortest = 1e-8;  // rad, and of a mechanism's size
  constexpr double smooth = 1e-4;                    // share of the third order
  const auto difference = [&](double by) {
    return Sparse((0.5 / by) * (units.gradient(units.moved(state, u, by)) -
                                units.gradient(units.moved(state, u, -by))));
  };
  Sparse best;
  double least = std::numeric_limits<double>::infinity();
  for (double by = longest; by >= 0.99 * shortest && least > smooth; by *= 0.1) {
    const Sparse far = difference(by), near = difference(0.5 * by);
    const double share = (far - near).norm() / std::max(of_size, near.norm());
    if (!(share < least)) continue;
    least = share;
    best = (4.0 * near - far) / 3.0;
  }
  return best;
}

// The state after the motion `by` times u, with the rows that are kept closed again, by less than a third of the motion; none if
// they do not close so.
std::optional<State> went_along(const UnitMotions& units, const OntoFreeMotions& projection,
                                const State& state, const VecX& u, double by) {
  constexpr int most = 40;
  constexpr double closed = 1e-13, small = 0.3;
  State there = units.moved(state, u, by);
  double corrected = 0.0, last = std::numeric_limits<double>::infinity();
  for (int i = 0; i < most; ++i) {
    const VecX z = projection.closing(units.gaps(there));
    const double size = z.cwiseAbs().maxCoeff();
    if (!(size > closed)) return there;
    if (i > 2 && !(size < last) && size < 1e3 * closed) return there;  // round-off
    corrected += size;
    last = size;
    if (!(corrected < small * by)) return std::nullopt;
    there = units.moved(std::move(there), z, 1.0);
  }
  return std::nullopt;
}

// The idle row that opens most as the mechanism goes on: rank that is lost to an order that (1) does not see, as where a point of
// a linkage runs along a line for a moment. -1: none opens.
Index opens_on_the_way(const UnitMotions& units, const OntoFreeMotions& projection,
                       const State& state, const VecX& u, const std::vector<Index>& idle) {
  constexpr double longest = 0.1, shortest = 1e-7;  // unit motions
  constexpr double open = 1e-9, grows = 3.0;        // as a square or more, by half the way
  for (double by = longest; by >= shortest; by *= 0.1) {
    const std::optional<State> there = went_along(units, projection, state, u, by),
                               half = went_along(units, projection, state, u, 0.5 * by);
    if (!there || !half) continue;
    const VecX gaps = units.gaps(*there).cwiseAbs(), before = units.gaps(*half).cwiseAbs();
    Index worst = -1;
    double most = open;
    for (const Index row : idle)
      if (gaps(row) > most && gaps(row) > grows * before(row)) {
        most = gaps(row);
        worst = row;
      }
    return worst;
  }
  return -1;
}

}  // namespace

std::string rank_loss(const System& system, const State& state) {
  const Redundancy redundancy = find_redundancy(system, state);
  if (redundancy.idle.empty()) return {};
  const UnitMotions units(system, state);
  const OntoFreeMotions projection(units.gradient(state), rows_in_loops(system), redundancy.idle);
  if (!projection.ok()) return "constraints depend on each other to nearly the first order";
  Eigen::MatrixXd n = units.of_unit_rows(redundancy.null);
  n.colwise().normalize();
  const VecX u = projection.random(5);
  if (u.size() == 0) return {};
  const Sparse dB = change_along(units, state, u);
  const Eigen::MatrixXd free = projection(dB.transpose() * n),
                        sums = Sparse(dB.cwiseAbs()).transpose() * n.cwiseAbs();
  const double size = std::max(of_size, sums.colwise().norm().maxCoeff());  // of what cancels
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> squares(free.transpose() * free);
  const Index most = n.cols() - 1;
  if (!(squares.eigenvalues()(most) > none * none * size * size)) {
    const Index row = opens_on_the_way(units, projection, state, u, redundancy.idle);
    if (row < 0) return {};
    for (Index k = 0; k < n.cols(); ++k)
      if (std::abs(n(row, k)) > 0.0)
        return fmt::format(
            "the constraints of {} lose rank in this configuration (to a higher order: {} opens as "
            "the others move on)",
            joints_of(system, n.col(k)), row_in_words(system, row));
    return {};
  }
  return fmt::format("the constraints of {} lose rank in this configuration",
                     joints_of(system, n * squares.eigenvectors().col(most)));
}

}  // namespace mbd
