#include "libmbd/section/material.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "libmbd/core/error.hpp"

namespace mbd::section {

EngineeringConstants isotropic(double young, double poisson) {
  const double g = young / (2.0 * (1.0 + poisson));
  return {young, young, young, g, g, g, poisson, poisson, poisson};
}

EngineeringConstants transversely_isotropic(double e_l, double e_t, double g_lt, double nu_lt,
                                            double nu_tn) {
  return {e_l, e_t, e_t, g_lt, g_lt, e_t / (2.0 * (1.0 + nu_tn)), nu_lt, nu_lt, nu_tn};
}

Stiffness stiffness_of(const EngineeringConstants& c) {
  const std::array<std::pair<std::string_view, double>, 6> moduli{
      {{"EL", c.e1}, {"ET", c.e2}, {"EN", c.e3}, {"GLT", c.g12}, {"GLN", c.g13}, {"GTN", c.g23}}};
  for (const auto& [name, value] : moduli)
    if (!(value > 0.0) || !std::isfinite(value))
      throw Error(fmt::format("{} = {:g} is not positive and finite", name, value));
  const auto contraction = [](std::string_view name, double nu, double ei, double ej) {
    if (!(std::abs(nu) < std::sqrt(ei / ej)))
      throw Error(
          fmt::format("the material is not positive definite: |nu{}| = {:g} is not below "
                      "sqrt(E{}/E{}) = {:g}",
                      name, std::abs(nu), name[0], name[1], std::sqrt(ei / ej)));
  };
  contraction("LT", c.nu12, c.e1, c.e2);
  contraction("LN", c.nu13, c.e1, c.e3);
  contraction("TN", c.nu23, c.e2, c.e3);
  Mat3 s;  // of normal stresses, scaled to a unit diagonal
  const double s12 = -c.nu12 * std::sqrt(c.e2 / c.e1), s13 = -c.nu13 * std::sqrt(c.e3 / c.e1),
               s23 = -c.nu23 * std::sqrt(c.e3 / c.e2);
  s << 1.0, s12, s13, s12, 1.0, s23, s13, s23, 1.0;
  const double determinant = 1.0 - s12 * s12 - s13 * s13 - s23 * s23 + 2.0 * s12 * s13 * s23;
  if (!(determinant > 1e-12))
    throw Error(
        fmt::format("the material is not positive definite: 1 - nuLT nuTL - nuLN nuNL - nuTN nuNT "
                    "- 2 nuLT nuTN nuNL = {:g} is not positive; the Poisson's ratios are too large",
                    determinant));
  const Vec3 root(std::sqrt(c.e1), std::sqrt(c.e2), std::sqrt(c.e3));
  Stiffness stiffness = Stiffness::Zero();
  stiffness.topLeftCorner<3, 3>() = root.asDiagonal() * s.inverse() * root.asDiagonal();
  stiffness(3, 3) = c.g23;
  stiffness(4, 4) = c.g13;
  stiffness(5, 5) = c.g12;
  return stiffness;
}

Mat3 ply_axes(double theta, double a) {
  const Vec3 n(0.0, std::cos(a), std::sin(a));
  const Vec3 across = n.cross(Vec3::UnitX());
  Mat3 axes;
  axes.col(0) = std::cos(theta) * Vec3::UnitX() + std::sin(theta) * across;
  axes.col(2) = n;
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

Mat6 strain_turned(const Mat3& axes) {
  constexpr std::array<std::array<int, 2>, 6> pairs{
      {{{0, 0}}, {{1, 1}}, {{2, 2}}, {{1, 2}}, {{0, 2}}, {{0, 1}}}};
  Mat6 turn;  // e'_ij = q_ki q_lj e_kl
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < 6; ++c) {
      const auto [i, j] = pairs[static_cast<std::size_t>(r)];
      const auto [k, l] = pairs[static_cast<std::size_t>(c)];
      const double both = axes(k, i) * axes(l, j) + (k != l ? axes(l, i) * axes(k, j) : 0.0);
      turn(r, c) = both * (r < 3 ? 1.0 : 2.0) * (c < 3 ? 1.0 : 0.5);
    }
  }
  return turn;
}

Stiffness in_section_axes(const Stiffness& material, double theta, double a) {
  const Mat6 turn = strain_turned(ply_axes(theta, a));
  return turn.transpose() * material * turn;
}

}  // namespace mbd::section
