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

void check_initial_state(const System& system, const State& state) {
  const ConstraintResiduals worst = constraint_residuals(system, state);
  const double tolerance = open_tolerance * std::max(1.0, system.length_scale());
  if (!(worst.position <= tolerance)) {
    throw Error(
        fmt::format("{}: the joint is open by {:.6g} (m or rad) at the start; mend the geometry",
                    system.name_of(6 * system.nodes() + worst.position_row), worst.position));
  }
  if (!(worst.velocity <= tolerance * std::max(1.0, [&] {
                            double fastest = 0.0;
                            for (const Vec6& V : state.V)
                              fastest = std::max(fastest, V.cwiseAbs().maxCoeff());
                            return fastest;
                          }()))) {
    throw Error(fmt::format(
        "{}: the initial velocities open the joint at {:.6g} (m/s or rad/s); give velocities "
        "that agree with the joints and drives",
        system.name_of(6 * system.nodes() + worst.velocity_row), worst.velocity));
  }
}

}  // namespace mbd
