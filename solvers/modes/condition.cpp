#include "solvers/modes/condition.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libmbd/core/stop.hpp"

namespace mbd {
namespace {

using Complex = std::complex<double>;

// y by inverse iteration. Of an eigenvalue with several shapes it is the one that belongs to x, as long as they are orthogonal
// in the mass: that is where it begins.
double condition_of(SmallMotions& motions, const Mode& mode) {
  constexpr double beside = 1e-8;  // of the eigenvalue: nearer than others, and not singular
  constexpr int times = 4;
  const Complex l = mode.eigenvalue;
  const auto& C = motions.rate_matrix();
  const Complex s = l + std::polar(beside * std::abs(l), 0.25 * std::numbers::pi);
  if (!motions.factor(s)) return std::numeric_limits<double>::infinity();
  const VecXc Mx = motions.mass_times(mode.shape);
  VecXc y, My, b = Mx.conjugate();
  for (int i = 0; i < times; ++i) {
    stop::check();
    y = motions.solve_transposed(b);
    y /= y.cwiseAbs().maxCoeff();
    My = motions.mass_times(y);
    b = 2.0 * l * My + C.transpose() * y;
  }
  const double sizes = std::sqrt(mode.shape.dot(Mx).real() * y.dot(My).real());
  const double slope = std::abs(b.cwiseProduct(mode.shape).sum());
  return 2.0 * std::abs(l) * sizes / std::max(slope, std::numeric_limits<double>::min());
}

}  // namespace

void set_conditions(SmallMotions& motions, std::vector<Mode>& modes) {
  const bool is_known = !motions.is_damped_or_turns() && motions.is_symmetric();
  for (Mode& mode : modes)
    if (!mode.rigid && mode.eigenvalue != 0.0)
      mode.condition = is_known ? 1.0 : condition_of(motions, mode);
}

}  // namespace mbd
