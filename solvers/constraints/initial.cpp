#include "solvers/constraints/initial.hpp"

#include <fmt/format.h>

#include <cmath>

#include "libmbd/core/error.hpp"
#include "solvers/newton/increments.hpp"

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
  if (state.V.empty()) {
    VecX r;
    system.residual(state, r);
    worst.position = largest(r.tail(system.multipliers()), worst.position_row);
  } else {
    VecX g, gdot;
    system.constraints(state, g, gdot);
    worst.position = largest(g, worst.position_row);
    worst.velocity = largest(gdot, worst.velocity_row);
  }
  return worst;
}

std::optional<OpenConstraint> find_open_constraint(const System& system, const State& state,
                                                   double slow) {
  VecX r, g, gdot, rest;
  system.residual(state, r);
  g = r.tail(system.multipliers());
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
  Index worst = -1;
  if (!(largest_violation(system, g, &worst) <= open_tolerance))
    return open(worst, "the joint is open by", std::abs(g(worst)), " at the start",
                "mend the geometry");
  if (state.V.empty()) return std::nullopt;
  system.constraint_rates(state, gdot, rest);
  if (!(largest_violation(system, gdot, &worst) <=
        open_tolerance * std::max(slow, fastest(system, state))))
    return open(
        worst, "the initial velocities open the joint at", std::abs(gdot(worst)), "/s",
        "give bodies the velocity and angular_velocity that the joints and drives ask for, or let "
        "drives start from rest");
  return std::nullopt;
}

void check_initial_state(const System& system, const State& state, double slow) {
  if (const auto open = find_open_constraint(system, state, slow))
    throw Error(system.name_of(6 * system.nodes() + open->multiplier) + ": " + open->what);
}

}  // namespace mbd
