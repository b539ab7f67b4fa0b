// What joints share: two frames fixed to two nodes, their relative pose, and rows built from it.
//
// Node P carries frame a, node Q frame b; both coincide in the reference configuration, with e3 along the
// joint's axis. g = H_a^-1 H_b = (R, x); x_b = R^T x is the position of b's origin from a's, in b. A
// constraint is a list of rows, each a function of g. With z = [u; psi] the increment of g in b,
//   position i:        x_b . e_i          d = e_i . (u + x_b x psi)                                 (1)
//   direction (i, j):  a_i . b_j = R_ij    d = e_j . (c x psi),  c = R^T a_i                         (2)
//   angle phi(t):      (2) with a_i = -sin(phi) e1 + cos(phi) e2 and j = 1: sin(theta - phi) = 0     (3)
// so dg = G z, the wrench on b is f = G^T lambda, and the geometric stiffness L = d(G^T lambda)/dz:
//   position:   f = lambda [ e_i ; e_i x x_b ],   L = lambda [ 0 0 ; e_i~  e_i~ x_b~ ]
//   direction:  f = lambda [ 0 ; e_j x c ],       L = lambda [ 0 0 ; 0  e_j~ c~ ]                    (4)
// and z = Ad(b) U_Q - Ad(g^-1) Ad(a) U_P takes them to the nodes (metrics.hpp (4)).
//
// lambda: what b exerts on a through the joint (the joint exerts -lambda on b), resolved in b: force
// [N] for positions, moment [N.m] for
// directions and angles (unit gradients on the solution). Rows are resolved in b, which moves with the
// joint, so the gradient keeps still while the mechanism turns (speed.md).
// Not used: the log of R (singular at pi, and shafts turn for ever); a_3 . b_3 = 1 (its gradient vanishes
// on the solution); theta - phi by atan2 in (3) (same gradient on the solution, not bilinear off it).
#pragma once

#include <array>

#include "libmbd/core/metrics.hpp"
#include "libmbd/core/se3.hpp"

namespace mbd::joint {

struct Row {
  enum class Kind { position, direction, angle };
  Kind kind;
  int i = 0;  // axis of a (direction), or of b (position); 1, 2, 3
  int j = 0;  // axis of b (direction)
};
constexpr Row position(int i) { return {Row::Kind::position, i, 0}; }
constexpr Row direction(int i, int j) { return {Row::Kind::direction, i, j}; }
constexpr Row angle() { return {Row::Kind::angle, 0, 1}; }

// The contract of a joint type: a name, its rows, whether it has an axis and a free angle about it.
template <class J>
concept Joint = requires {
  { J::name } -> std::convertible_to<const char*>;
  { J::rows.size() } -> std::convertible_to<std::size_t>;
  { J::has_axis } -> std::convertible_to<bool>;
  { J::has_angle } -> std::convertible_to<bool>;
};

// Row-dependent parts of (2) and (3): the direction c in b, and the axis of b it is held against.
template <class S>
Vector3<S> direction_in_b(const Row& row, const Matrix3<S>& R, const S& phi) {
  using std::cos, std::sin;
  if (row.kind == Row::Kind::direction) return R.row(row.i - 1).transpose();
  return (cos(phi) * R.row(1) - sin(phi) * R.row(0)).transpose();
}

// g of all rows; phi is the driven angle (ignored by rows that have none).
template <Joint J, class S>
Matrix<S, static_cast<int>(J::rows.size()), 1> constraint(const Pose<S>& g, const S& phi) {
  Matrix<S, static_cast<int>(J::rows.size()), 1> value;
  const Matrix3<S> R = g.R();
  const Vector3<S> x_b = R.transpose() * g.r;
  for (std::size_t n = 0; n < J::rows.size(); ++n) {
    const Row row = J::rows[n];
    value(static_cast<Index>(n)) =
        row.kind == Row::Kind::position ? x_b(row.i - 1) : direction_in_b(row, R, phi)(row.j - 1);
  }
  return value;
}

// G: dg = G z.
template <Joint J, class S>
Matrix<S, static_cast<int>(J::rows.size()), 6> gradient(const Pose<S>& g, const S& phi) {
  Matrix<S, static_cast<int>(J::rows.size()), 6> G;
  const Matrix3<S> R = g.R();
  const Vector3<S> x_b = R.transpose() * g.r;
  for (std::size_t n = 0; n < J::rows.size(); ++n) {
    const Row row = J::rows[n];
    const auto k = static_cast<Index>(n);
    if (row.kind == Row::Kind::position) {
      const Vector3<S> e = Vector3<S>::Unit(row.i - 1);
      G.row(k) << e.transpose(), e.cross(x_b).transpose();
    } else {
      const Vector3<S> e = Vector3<S>::Unit(row.j - 1);
      G.row(k) << Vector3<S>::Zero().transpose(), e.cross(direction_in_b(row, R, phi)).transpose();
    }
  }
  return G;
}

// f = G^T lambda, without forming G.
template <Joint J, class S>
Vector6<S> wrench(const Pose<S>& g, const S& phi,
                  const Matrix<S, static_cast<int>(J::rows.size()), 1>& lambda) {
  Vector3<S> force = Vector3<S>::Zero(), moment = Vector3<S>::Zero();
  const Matrix3<S> R = g.R();
  for (std::size_t n = 0; n < J::rows.size(); ++n) {
    const Row row = J::rows[n];
    const S l = lambda(static_cast<Index>(n));
    if (row.kind == Row::Kind::position) {
      force(row.i - 1) += l;
    } else {
      moment += l * Vector3<S>(Vector3<S>::Unit(row.j - 1)).cross(direction_in_b(row, R, phi));
    }
  }
  const Vector3<S> x_b = R.transpose() * g.r;
  return six<S>(force, moment + force.cross(x_b));
}

// L of (4).
template <Joint J, class S>
Matrix6<S> geometric_stiffness(const Pose<S>& g, const S& phi,
                               const Matrix<S, static_cast<int>(J::rows.size()), 1>& lambda) {
  Vector3<S> force = Vector3<S>::Zero();
  Matrix3<S> turning = Matrix3<S>::Zero();
  const Matrix3<S> R = g.R();
  for (std::size_t n = 0; n < J::rows.size(); ++n) {
    const Row row = J::rows[n];
    const S l = lambda(static_cast<Index>(n));
    if (row.kind == Row::Kind::position) {
      force(row.i - 1) += l;
    } else {
      turning +=
          l * (hat(Vector3<S>(Vector3<S>::Unit(row.j - 1))) * hat(direction_in_b(row, R, phi)));
    }
  }
  const Matrix3<S> f = hat(force);
  const Vector3<S> x_b = R.transpose() * g.r;
  Matrix6<S> L;
  L << Matrix3<S>::Zero(), Matrix3<S>::Zero(), f, f * hat(x_b) + turning;
  return L;
}

}  // namespace mbd::joint
