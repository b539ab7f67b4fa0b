// What joints share: two frames fixed to two nodes, their relative pose, and rows built from it.
//
// Node P carries frame a, node Q frame b; both coincide in the reference configuration (unless the type
// says otherwise), with e3 along the joint's axis. g = H_a^-1 H_b = (R, x); x_b = R^T x is the position of
// b's origin from a's, in b. A constraint is a list of rows, each a function of g. With z = [u; psi] the
// increment of g in b, c_i = R^T a_i, p the type's parameter and s(t) a prescribed coordinate,
//   position i:        x_b . e_i                  d = e_i . (u + x_b x psi)                         (1)
//   direction (i, j):  a_i . b_j = R_ij           d = (e_j x c_i) . psi                             (2)
//   angle:             sin(theta - s), as (2) with a_i = -sin(s) e1 + cos(s) e2 and j = 1           (3)
//   displacement:      x_b . e3 - s               d as (1)                                          (4)
//   advance:           x_b . e3 - p theta/2pi     d as (1) less p w . psi/2pi                       (5)
//   distance:          (x.x - p^2)/2p             d = x_b . u / p                                   (6)
// The free angle is theta = atan2(a2.b1, a1.b1) + whole turns, the value nearest to that of the last
// accepted state: continuous within a step. With k = e1 . c3 = a3.b1,
//   d theta = w . psi,   w = (c3 - k e1)/(1 - k^2),
//   dw/dpsi = [ c3~ - e1 (e1 x c3)^T + 2k w (e1 x c3)^T ]/(1 - k^2)                                 (7)
// So dg = G z, the wrench on b is f = G^T lambda, and the geometric stiffness L = d(G^T lambda)/dz:
//   (1, 4, 5):  f = lambda [ e_i ; e_i x x_b ],   L = lambda [ 0 0 ; e_i~  e_i~ x_b~ ], in (5) less
//               f = lambda [ 0 ; p w/2pi ],       L = lambda [ 0 0 ; 0  (p/2pi) dw/dpsi ]
//   (2, 3):     f = lambda [ 0 ; e_j x c ],       L = lambda [ 0 0 ; 0  e_j~ c~ ]                   (8)
//   (6):        f = lambda [ x_b ; 0 ]/p,         L = lambda [ I  x_b~ ; 0 0 ]/p
// and z = Ad(b) U_Q - Ad(g^-1) Ad(a) U_P takes them to the nodes (metrics.hpp (4)).
//
// lambda: what b exerts on a through the joint (the joint exerts -lambda on b), resolved in b: force
// [N] for positions, displacements and distances (tension is positive), moment [N.m] for directions and
// angles (unit gradients on the solution). Rows are resolved in b, which moves with the joint, so the
// gradient keeps still while the mechanism turns.
// A prescribed motion is a constraint whose frame a moves in its node as the law says: H_a = H_P a M(t).
// Validity of (5), (7): a3 is not along b1, never so near the solution.
// Not used: the log of R (singular at pi, and shafts turn for ever); a_3 . b_3 = 1 (its gradient vanishes
// on the solution); theta - phi by atan2 in (3) (same gradient on the solution, not bilinear off it);
// |x| - p in (6) (the same on the solution, its stiffness needs more).
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "joints/traits.hpp"
#include "libmbd/core/dual.hpp"
#include "libmbd/core/metrics.hpp"
#include "libmbd/core/se3.hpp"

namespace mbd::joint {

struct Row {
  enum class Kind { position, direction, angle, displacement, advance, distance };
  Kind kind;
  int i = 0;  // axis of a (direction), or of b (position); 1, 2, 3
  int j = 0;  // axis of b (direction)

  // A length [m] and a force; otherwise a sine and a moment.
  constexpr bool is_length() const { return kind != Kind::direction && kind != Kind::angle; }
  // Its wrench has a force along b_i, at a's origin.
  constexpr bool is_along_axis() const { return is_length() && kind != Kind::distance; }
};
constexpr Row position(int i) { return {Row::Kind::position, i, 0}; }
constexpr Row direction(int i, int j) { return {Row::Kind::direction, i, j}; }
constexpr Row angle() { return {Row::Kind::angle, 0, 1}; }
constexpr Row displacement() { return {Row::Kind::displacement, 3, 0}; }
constexpr Row advance() { return {Row::Kind::advance, 3, 0}; }
constexpr Row distance() { return {Row::Kind::distance, 0, 0}; }

// The contract of a joint type: a name, a sentence for the manual, its rows and traits.
template <class J>
concept Joint = requires {
  { J::name } -> std::convertible_to<const char*>;
  { J::doc } -> std::convertible_to<const char*>;
  { J::rows.size() } -> std::convertible_to<std::size_t>;
  { J::traits } -> std::convertible_to<Traits>;
};

template <Joint J>
inline constexpr int rows_of = static_cast<int>(J::rows.size());

template <Joint J>
constexpr bool has_row(Row::Kind kind) {
  for (const Row& row : J::rows)
    if (row.kind == kind) return true;
  return false;
}

// What rows depend on besides g.
template <class S>
struct Given {
  S s = S(0.0);            // prescribed angle [rad] or displacement [m]
  double parameter = 0.0;  // of the type
  double near = 0.0;       // followed angle at the last accepted state [rad]
};

// a_i (direction), or the direction that stands for it in (3), resolved in b.
template <class S>
Vector3<S> direction_in_b(const Row& row, const Matrix3<S>& R, const S& s) {
  using std::cos, std::sin;
  if (row.kind == Row::Kind::direction) return R.row(row.i - 1).transpose();
  return (cos(s) * R.row(1) - sin(s) * R.row(0)).transpose();
}

// The angle about e3 nearest to `near`.
template <class S>
S unwrapped_angle(const Matrix3<S>& R, double near) {
  using std::atan2;
  constexpr double turn = 2.0 * std::numbers::pi;
  const S principal = atan2(R(1, 0), R(0, 0));
  return principal + S(turn * std::round((near - value_of(principal)) / turn));
}

// w of (7), and dw/dpsi.
template <class S>
Vector3<S> angle_gradient(const Matrix3<S>& R) {
  const Vector3<S> c3 = R.row(2).transpose();
  return (c3 - c3(0) * Vector3<S>::Unit(0)) / (S(1.0) - c3(0) * c3(0));
}
template <class S>
Matrix3<S> angle_curvature(const Matrix3<S>& R) {
  const Vector3<S> c3 = R.row(2).transpose(), e1 = Vector3<S>::Unit(0), dk = e1.cross(c3),
                   w = angle_gradient(R);
  return (hat(c3) + (S(2.0) * c3(0) * w - e1) * dk.transpose()) / (S(1.0) - c3(0) * c3(0));
}

inline double per_radian(double pitch) { return pitch / (2.0 * std::numbers::pi); }

// g of all rows.
template <Joint J, class S>
Matrix<S, rows_of<J>, 1> constraint(const Pose<S>& g, const Given<S>& given) {
  Matrix<S, rows_of<J>, 1> value;
  const Matrix3<S> R = g.R();
  const Vector3<S> x_b = R.transpose() * g.r;
  Index n = 0;
  for (const Row& row : J::rows) {
    S& v = value(n++);
    switch (row.kind) {
      case Row::Kind::position:
        v = x_b(row.i - 1);
        break;
      case Row::Kind::direction:
      case Row::Kind::angle:
        v = direction_in_b(row, R, given.s)(row.j - 1);
        break;
      case Row::Kind::displacement:
        v = x_b(2) - given.s;
        break;
      case Row::Kind::advance:
        v = x_b(2) - S(per_radian(given.parameter)) * unwrapped_angle(R, given.near);
        break;
      case Row::Kind::distance:
        v = (x_b.squaredNorm() - S(given.parameter * given.parameter)) / S(2.0 * given.parameter);
        break;
    }
  }
  return value;
}

// G: dg = G z.
template <Joint J, class S>
Matrix<S, rows_of<J>, 6> gradient(const Pose<S>& g, const Given<S>& given) {
  Matrix<S, rows_of<J>, 6> G;
  const Matrix3<S> R = g.R();
  const Vector3<S> x_b = R.transpose() * g.r;
  Index n = 0;
  for (const Row& row : J::rows) {
    Vector3<S> u = Vector3<S>::Zero(), psi;
    if (row.kind == Row::Kind::distance) {
      u = x_b / S(given.parameter);
      psi = Vector3<S>::Zero();
    } else if (row.is_along_axis()) {
      u = Vector3<S>::Unit(row.i - 1);
      psi = u.cross(x_b);
      if (row.kind == Row::Kind::advance) psi -= S(per_radian(given.parameter)) * angle_gradient(R);
    } else {
      psi = Vector3<S>(Vector3<S>::Unit(row.j - 1)).cross(direction_in_b(row, R, given.s));
    }
    G.row(n++) << u.transpose(), psi.transpose();
  }
  return G;
}

// f = G^T lambda, without forming G.
template <Joint J, class S>
Vector6<S> wrench(const Pose<S>& g, const Given<S>& given, const Matrix<S, rows_of<J>, 1>& lambda) {
  Vector3<S> force = Vector3<S>::Zero(), moment = Vector3<S>::Zero();
  const Matrix3<S> R = g.R();
  const Vector3<S> x_b = R.transpose() * g.r;
  Index n = 0;
  S tension(0.0);
  for (const Row& row : J::rows) {
    const S l = lambda(n++);
    if (row.kind == Row::Kind::distance) {
      tension += l / S(given.parameter);
    } else if (row.is_along_axis()) {
      force(row.i - 1) += l;
      if (row.kind == Row::Kind::advance)
        moment -= (l * S(per_radian(given.parameter))) * angle_gradient(R);
    } else {
      moment += l * Vector3<S>(Vector3<S>::Unit(row.j - 1)).cross(direction_in_b(row, R, given.s));
    }
  }
  moment += force.cross(x_b);
  if constexpr (has_row<J>(Row::Kind::distance)) force += tension * x_b;
  return six<S>(force, moment);
}

// L of (8).
template <Joint J, class S>
Matrix6<S> geometric_stiffness(const Pose<S>& g, const Given<S>& given,
                               const Matrix<S, rows_of<J>, 1>& lambda) {
  Vector3<S> force = Vector3<S>::Zero();
  Matrix3<S> turning = Matrix3<S>::Zero();
  const Matrix3<S> R = g.R();
  const Vector3<S> x_b = R.transpose() * g.r;
  Index n = 0;
  S tension(0.0);
  for (const Row& row : J::rows) {
    const S l = lambda(n++);
    if (row.kind == Row::Kind::distance) {
      tension += l / S(given.parameter);
    } else if (row.is_along_axis()) {
      force(row.i - 1) += l;
      if (row.kind == Row::Kind::advance)
        turning -= (l * S(per_radian(given.parameter))) * angle_curvature(R);
    } else {
      turning +=
          l * (hat(Vector3<S>(Vector3<S>::Unit(row.j - 1))) * hat(direction_in_b(row, R, given.s)));
    }
  }
  const Matrix3<S> f = hat(force);
  Matrix6<S> L;
  L << Matrix3<S>::Zero(), Matrix3<S>::Zero(), f, f * hat(x_b) + turning;
  if constexpr (has_row<J>(Row::Kind::distance)) {
    L.template topLeftCorner<3, 3>() = tension * Matrix3<S>::Identity();
    L.template topRightCorner<3, 3>() = tension * hat(x_b);
  }
  return L;
}

// metrics.hpp (4). The force of a distance depends on how far, so its L is full; the others' are not.
template <Joint J>
PairTangent<double> joint_tangent(const Pose<double>& g, const Vec6& f, const Mat6& L) {
  if constexpr (has_row<J>(Row::Kind::distance)) {
    const Mat6 Ad = adjoint_inverse(g).matrix();
    const Mat6 jk = -Ad.transpose() * (L - wrench_hat<double>(f));
    return {L, -L * Ad, jk, -jk * Ad};
  } else {
    return pair_tangent(g, f, L);
  }
}

// Direction and angle rows vanish half a turn from where they mean to hold as well: a step too large could end
// there. With rows on both of b1 and b2, a3.b3 > 0; with an angle, cos(theta - phi) > 0. Three directions vanish
// where axes change places too (a third of a turn about (1, 1, 1), tr R = 0): less than a quarter turn, tr R > 1.
template <Joint J>
bool on_branch(const Pose<double>& g, [[maybe_unused]] const Given<double>& given) {
  constexpr auto directions = [] {
    int n = 0;
    for (const Row& row : J::rows) n += row.kind == Row::Kind::direction ? 1 : 0;
    return n;
  }();
  constexpr bool has_angle = has_row<J>(Row::Kind::angle);
  if constexpr (directions < 2 && !has_angle) {
    return true;
  } else {
    const Mat3 R = g.R();
    if constexpr (has_angle) {
      if (!(std::cos(given.s) * R(0, 0) + std::sin(given.s) * R(1, 0) > 0.0)) return false;
    }
    if constexpr (directions == 2) return R(2, 2) > 0.0;
    if constexpr (directions == 3) return R.trace() > 1.0;
    return true;
  }
}

}  // namespace mbd::joint
