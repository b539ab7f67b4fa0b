#include "solvers/initial.hpp"

#include <fmt/format.h>

#include <cmath>

#include "libmbd/core/error.hpp"

namespace mbd {
namespace {

// Gaps of a stated geometry are round-off of what was written; larger ones are mistakes.
constexpr double open_tolerance = 1e-8;  // of the scene's length, or rad

double largest(const VecX& x, Index& row) {
  row = -1;
  double size = 0.0;
  for (Index i = 0; i < x.size(); ++i) {
    if (std::isnan(x(i))) {
      row = i;
      return x(i);
    }
    if (std::abs(x(i)) > size) {
      size = std::abs(x(i));
      row = i;
    }
  }
  return size;
}

}  // namespace

ConstraintResiduals constraint_residuals(const System& system, const State& state) {
  ConstraintResiduals worst;
  VecX r;
  system.residual(state, r);
  worst.position = largest(r.tail(system.multipliers()), worst.position_row);
  if (!state.V.empty()) {
    VecX gdot, rest;
    system.constraint_rates(state, gdot, rest);
    worst.velocity = largest(gdot, worst.velocity_row);
  }
  return worst;
}

std::optional<OpenConstraint> find_open_constraint(const System& system, const State& state) {
  const ConstraintResiduals worst = constraint_residuals(system, state);
  const double tolerance = open_tolerance * std::max(1.0, system.length_scale());
  const auto is_length = [&](Index row) {
    for (const ConstraintInfo& info : system.constraints())
      if (row >= info.first_row && row < info.first_row + info.rows)
        return static_cast<bool>(info.is_position[static_cast<std::size_t>(row - info.first_row)]);
    return false;
  };
  const auto name = [&](Index row) { return system.name_of(6 * system.nodes() + row); };
  if (!(worst.position <= tolerance)) {
    const Index row = worst.position_row;
    return OpenConstraint{
        row, fmt::format("{}: the joint is open by {:.6g} {} at the start; mend the geometry",
                         name(row), worst.position, is_length(row) ? "m" : "rad")};
  }
  double fastest = 1.0;
  for (const Vec6& V : state.V) fastest = std::max(fastest, V.cwiseAbs().maxCoeff());
  if (!(worst.velocity <= tolerance * fastest)) {
    const Index row = worst.velocity_row;
    return OpenConstraint{
        row,
        fmt::format("{}: the initial velocities open the joint at {:.6g} {}/s; give velocities "
                    "that agree with the joints and drives",
                    name(row), worst.velocity, is_length(row) ? "m" : "rad")};
  }
  return std::nullopt;
}

void check_initial_state(const System& system, const State& state) {
  if (const auto open = find_open_constraint(system, state)) throw Error(open->what);
}

}  // namespace mbd
