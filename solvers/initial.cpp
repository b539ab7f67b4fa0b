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
  const auto open = [&](Index row, std::string_view what, double size, std::string_view unit,
                        std::string_view remedy) {
    for (const ConstraintInfo& info : system.constraints())
      if (row >= info.first_row && row < info.first_row + info.rows) {
        const auto i = static_cast<std::size_t>(row - info.first_row);
        return OpenConstraint{row, info.row_names[i],
                              fmt::format("{} {:.6g} {}{}; {}", what, size,
                                          info.is_position[i] ? "m" : "rad", unit, remedy)};
      }
    return OpenConstraint{row, "", ""};
  };
  if (!(worst.position <= tolerance))
    return open(worst.position_row, "the joint is open by", worst.position, " at the start",
                "mend the geometry");
  double fastest = 1.0;
  for (const Vec6& V : state.V) fastest = std::max(fastest, V.cwiseAbs().maxCoeff());
  if (!(worst.velocity <= tolerance * fastest))
    return open(
        worst.velocity_row, "the initial velocities open the joint at", worst.velocity, "/s",
        "give bodies the velocity and angular_velocity that the joints and drives ask for, or let "
        "drives start from rest");
  return std::nullopt;
}

void check_initial_state(const System& system, const State& state) {
  if (const auto open = find_open_constraint(system, state))
    throw Error(system.name_of(6 * system.nodes() + open->multiplier) + ": " + open->what);
}

}  // namespace mbd
