#include "solvers/constraints/rank_loss.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <string>
#include <vector>

#include "solvers/constraints/free_motions.hpp"
#include "solvers/constraints/redundancy.hpp"

namespace mbd {
namespace {

constexpr double little = 1e-4;  // rad, and of a mechanism's size: of the difference
// What n^T dB[u] is where it is of the size of n, B and u: motions of a door on two hinges change nothing.
constexpr double of_size = 0.1;
constexpr double none = 1e-5;  // of n^T dB[u]: what errors of n and of the difference leave of (1)

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
  const UnitMotions units(system, state);
  const OntoFreeMotions projection(units.gradient(state), rows_in_loops(system), redundancy.idle);
  if (!projection.ok()) return "constraints depend on each other to nearly the first order";
  Eigen::MatrixXd n = units.of_unit_rows(redundancy.null);
  n.colwise().normalize();
  const VecX u = projection.random();
  if (u.size() == 0) return {};
  const auto at = [&](double by) {
    return Eigen::MatrixXd(units.gradient(units.moved(state, u, by)).transpose() * n);
  };
  const Eigen::MatrixXd change = (0.5 / little) * (at(little) - at(-little)),
                        free = projection(change);
  const double size = std::max(of_size, change.colwise().norm().maxCoeff());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> squares(free.transpose() * free);
  const Index most = n.cols() - 1;
  if (!(squares.eigenvalues()(most) > none * none * size * size)) return {};
  return fmt::format("the constraints of {} lose rank in this configuration",
                     joints_of(system, n * squares.eigenvectors().col(most)));
}

}  // namespace mbd
