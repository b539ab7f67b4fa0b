#include "solvers/modes/condition.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
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

// Where Q is symmetric y = x; and of an eigenvalue that is found several times, with the shapes X orthonormal in the mass, what
// takes part of a change is at most |G^-1|, G = X^T (2 l M + C) X (its spectral projector).
void set_by_groups(SmallMotions& motions, std::vector<Mode>& modes) {
  constexpr double same = 1e-7;  // of the eigenvalue
  std::vector<char> is_set(modes.size(), 0);
  for (std::size_t first = 0; first < modes.size(); ++first) {
    if (modes[first].rigid || modes[first].eigenvalue == 0.0 || is_set[first] != 0) continue;
    const Complex l = modes[first].eigenvalue;
    std::vector<std::size_t> group;
    for (std::size_t k = first; k < modes.size(); ++k)
      if (!modes[k].rigid && std::abs(modes[k].eigenvalue - l) <= same * std::abs(l))
        group.push_back(k), is_set[k] = 1;
    Eigen::MatrixXcd X(motions.motions(), static_cast<Index>(group.size()));
    for (std::size_t k = 0; k < group.size(); ++k)
      X.col(static_cast<Index>(k)) = modes[group[k]].shape;
    const Eigen::LLT<Eigen::MatrixXcd> sizes(X.adjoint() * motions.mass_times(X));
    sizes.matrixU().solveInPlace<Eigen::OnTheRight>(X);
    const Eigen::MatrixXcd G =
        X.transpose() * (2.0 * l * motions.mass_times(X) + motions.rate_times(X));
    const double least = Eigen::JacobiSVD<Eigen::MatrixXcd>(G).singularValues().minCoeff();
    const double found = sizes.info() == Eigen::Success && least > 0.0
                             ? 2.0 * std::abs(l) / least
                             : std::numeric_limits<double>::infinity();
    // The last may go on behind those that were asked for: what part of its shapes say is at least the condition.
    constexpr double well = 1.01;
    const bool is_known = std::isfinite(found) && (group.back() + 1 < modes.size() || found < well);
    for (const std::size_t k : group)
      modes[k].condition = is_known ? found : condition_of(motions, modes[k]);
  }
}

}  // namespace

void set_conditions(SmallMotions& motions, std::vector<Mode>& modes) {
  const bool is_symmetric = motions.is_symmetric();
  if (is_symmetric && motions.is_damped_or_turns()) {
    set_by_groups(motions, modes);
    return;
  }
  for (Mode& mode : modes)
    if (!mode.rigid && mode.eigenvalue != 0.0)
      mode.condition = is_symmetric ? 1.0 : condition_of(motions, mode);
}

}  // namespace mbd
