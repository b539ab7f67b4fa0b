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

#include <cmath>
#include <tuple>
#include <type_traits>

#include "joints/rows.hpp"
#include "joints/traits.hpp"

namespace mbd::joint {

// The contract of a joint type: a name, a sentence for the manual, a tuple of its rows and its traits.
template <class J>
concept Joint = requires {
  { J::name } -> std::convertible_to<const char*>;
  { J::doc } -> std::convertible_to<const char*>;
  { std::tuple_size_v<std::remove_const_t<decltype(J::rows)>> } -> std::convertible_to<std::size_t>;
  { J::traits } -> std::convertible_to<Traits>;
};

template <Joint J>
inline constexpr int rows_of =
    static_cast<int>(std::tuple_size_v<std::remove_const_t<decltype(J::rows)>>);

// Calls f(row, n) for each row, n = 0, 1 ….
template <Joint J, class F>
constexpr void each_row(F&& f) {
  std::apply([&f, n = Index{0}](const auto&... row) mutable { (f(row, n++), ...); }, J::rows);
}

// How many rows are of a kind.
template <Joint J, class R>
constexpr int count_of() {
  int n = 0;
  each_row<J>(
      [&](const auto& row, Index) { n += std::is_same_v<std::decay_t<decltype(row)>, R> ? 1 : 0; });
  return n;
}
template <Joint J>
constexpr bool has_tension() {
  bool any = false;
  each_row<J>([&](const auto& row, Index) { any = any || row.is_tension; });
  return any;
}

// g of all rows.
template <Joint J, class S>
Matrix<S, rows_of<J>, 1> constraint(const Pose<S>& g, const Given<S>& given) {
  Matrix<S, rows_of<J>, 1> value;
  const RowPlace<S> at(g, given);
  each_row<J>([&](const auto& row, Index n) { value(n) = row.value(at); });
  return value;
}

// G: dg = G z.
template <Joint J, class S>
Matrix<S, rows_of<J>, 6> gradient(const Pose<S>& g, const Given<S>& given) {
  Matrix<S, rows_of<J>, 6> G;
  const RowPlace<S> at(g, given);
  each_row<J>([&](const auto& row, Index n) {
    Vector3<S> u, psi;
    row.gradient(at, u, psi);
    G.row(n) << u.transpose(), psi.transpose();
  });
  return G;
}

// f = G^T lambda, without forming G.
template <Joint J, class S>
Vector6<S> wrench(const Pose<S>& g, const Given<S>& given, const Matrix<S, rows_of<J>, 1>& lambda) {
  const RowPlace<S> at(g, given);
  WrenchSum<S> f;
  each_row<J>([&](const auto& row, Index n) { row.add_wrench(at, lambda(n), f); });
  f.moment += f.force.cross(at.x_b);
  if constexpr (has_tension<J>()) f.force += f.tension * at.x_b;
  return six<S>(f.force, f.moment);
}

// The second derivative of g along a motion with gdot = G z, as far as it comes from z alone: z^T L_n z of each row n (8).
template <Joint J, class S>
Matrix<S, rows_of<J>, 1> curvature_along(const Pose<S>& g, const Given<S>& given,
                                         const Vector6<S>& z) {
  Matrix<S, rows_of<J>, 1> value;
  const RowPlace<S> at(g, given);
  const Vector3<S> u = linear(z), psi = angular(z), moved = u + at.x_b.cross(psi);
  each_row<J>([&](const auto& row, Index n) {
    StiffnessSum<S> sum;
    row.add_stiffness(at, S(1.0), sum);
    value(n) = psi.dot(Vector3<S>(sum.force.cross(moved) + sum.turning * psi));
    if constexpr (has_tension<J>()) value(n) += sum.tension * u.dot(moved);
  });
  return value;
}

// L of (8).
template <Joint J, class S>
Matrix6<S> geometric_stiffness(const Pose<S>& g, const Given<S>& given,
                               const Matrix<S, rows_of<J>, 1>& lambda) {
  const RowPlace<S> at(g, given);
  StiffnessSum<S> sum;
  each_row<J>([&](const auto& row, Index n) { row.add_stiffness(at, lambda(n), sum); });
  const Matrix3<S> f = hat(sum.force);
  Matrix6<S> L;
  L << Matrix3<S>::Zero(), Matrix3<S>::Zero(), f, f * hat(at.x_b) + sum.turning;
  if constexpr (has_tension<J>()) {
    L.template topLeftCorner<3, 3>() = sum.tension * Matrix3<S>::Identity();
    L.template topRightCorner<3, 3>() = sum.tension * hat(at.x_b);
  }
  return L;
}

// metrics.hpp (4). The force of a distance depends on how far, so its L is full; the others' are not.
inline PairTangent<double> joint_tangent(const Pose<double>& g, const Vec6& f, const Mat6& L,
                                         bool full) {
  if (!full) return pair_tangent(g, f, L);
  const Mat6 Ad = adjoint_inverse(g).matrix();
  const Mat6 jk = -Ad.transpose() * (L - wrench_hat<double>(f));
  return {L, -L * Ad, jk, -jk * Ad};
}

// Direction and angle rows vanish half a turn from where they mean to hold as well: a step too large could end
// there. With rows on both of b1 and b2, a3.b3 > 0; with an angle, cos(theta - phi) > 0. Three directions vanish
// where axes change places too (a third of a turn about (1, 1, 1), tr R = 0): less than a quarter turn, tr R > 1.
template <Joint J, class S>
bool on_branch(const Pose<S>& g, [[maybe_unused]] const Given<S>& given) {
  constexpr int directions = count_of<J, row::Direction>();
  constexpr bool has_angle = count_of<J, row::Angle>() > 0;
  if constexpr (directions < 2 && !has_angle) {
    return true;
  } else {
    const Matrix3<S> R = g.R();
    if constexpr (has_angle) {
      if (!(std::cos(given.s) * R(0, 0) + std::sin(given.s) * R(1, 0) > 0.0)) return false;
    }
    if constexpr (directions == 2) return smallest_of(R(2, 2)) > 0.0;
    if constexpr (directions == 3) return smallest_of(S(R.trace())) > 1.0;
    return true;
  }
}

}  // namespace mbd::joint
