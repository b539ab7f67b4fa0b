// Kinematics of a spectral beam element: what every beam term that depends on deformation shares.
//
// Model (NOTATION.md 3; HB 19, 20, 22). N + 1 nodes at the GLL points; q_jk the motion parameters of
// H_j^-1 H_k. Nodal curvatures K_j = (1/J_j) sum_k d_jk q_jk, interpolated to the quadrature points:
//   K_i = sum_j l_j(xi_i) K_j.
// Since q_kj = -q_jk this is a sum over pairs j < k with constant coefficients,
//   K_i = sum_p c_ip q_p,   c_ip = l_j(xi_i) d_jk / J_j - l_k(xi_i) d_kj / J_k,                     (1)
// and its variation, by dq = T^-1(q) U_k - T^-1(-q) U_j,
//   dK_i = Bbar_i dU,   Bbar_ik = sum_{p ending in k} c_ip T^-1(q_p) - sum_{p starting in k} c_ip T^-1(-q_p). (2)
// (2) is HB 22 with the diagonal written out; an element is thus a set of pairs, each a "spring" on q_p.
//
// Symbols: K, E = K - K0 [1/m in angular rows, - in linear]; J = ds/dxi [m]; frame: section (body).
// Constants are of type Real: double, or long double for reference solutions below its round-off.
// Not used: the interpolated field between nodes (HB 16-18), which the residual never needs.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <type_traits>

#include "elements/metrics.hpp"
#include "libmbd/core/spectral.hpp"

namespace mbd::beam {

inline constexpr int max_order = 8;

// Sizes of an element of order N; N = 0 stands for an order known at run time only.
template <int N>
struct Sizes {
  static constexpr int max_N = N > 0 ? N : max_order;
  static constexpr int max_nodes = max_N + 1;
  static constexpr int max_pairs = max_nodes * max_N / 2;
  static constexpr int max_points = max_N + 1;  // Gauss-Lobatto; Gauss has one fewer
  static constexpr int nodes = N > 0 ? N + 1 : Eigen::Dynamic;
};

// Constants of all elements of one order and rule.
template <int N, class Real = double>
struct Table {
  using Z = Sizes<N>;
  int order_ = 0;
  int points = 0;
  std::array<Real, Z::max_points> w{};                  // quadrature weights
  std::array<Real, Z::max_points * Z::max_nodes> l{};   // l_a(xi_i): [i * max_nodes + a]
  std::array<Real, Z::max_points * Z::max_nodes> dl{};  // l'_a(xi_i)

  int order() const { return N > 0 ? N : order_; }

  template <class To>
  Table<N, To> cast() const {
    Table<N, To> to;
    to.order_ = order_;
    to.points = points;
    std::copy(w.begin(), w.end(), to.w.begin());
    std::copy(l.begin(), l.end(), to.l.begin());
    std::copy(dl.begin(), dl.end(), to.dl.begin());
    return to;
  }
};

template <int N, class Real>
Table<N, Real> make_table(const BasicSpectralTable<Real>& t) {
  using Z = Sizes<N>;
  Table<N, Real> table;
  table.order_ = t.order;
  table.points = static_cast<int>(t.rule.points.size());
  for (int i = 0; i < table.points; ++i) {
    table.w[static_cast<std::size_t>(i)] = t.rule.weights[static_cast<std::size_t>(i)];
    for (int a = 0; a <= t.order; ++a) {
      table.l[static_cast<std::size_t>(i * Z::max_nodes + a)] = t.l_at_points(i, a);
      table.dl[static_cast<std::size_t>(i * Z::max_nodes + a)] = t.dl_at_points(i, a);
    }
  }
  return table;
}

// Constants of one element. `stiffness` is the place of the sectional stiffness of its first quadrature
// point in the batch's list, `stiffness_stride` 0 for a uniform element and 1 for one D a point.
template <int N, class Real = double>
struct Data {
  using Z = Sizes<N>;
  std::array<Real, Z::max_points * Z::max_pairs>
      c{};                                      // equation (1): [i * max_pairs + p]      [1/m]
  std::array<Real, Z::max_points> wJ{};         // w_i J(xi_i)                            [m]
  std::array<Vector6<Real>, Z::max_points> K0;  // curvature of the reference             [-, 1/m]
  int stiffness = 0;
  int stiffness_stride = 0;
};

// Coefficients (1) from the nodal Jacobians J_j [m]; K0 from the same formula on the reference poses.
template <class Metric, int N, class Real>
Data<N, Real> make_data(const BasicSpectralTable<Real>& t,
                        std::type_identity_t<std::span<const Real>> J,
                        std::type_identity_t<std::span<const Pose<Real>>> reference, int stiffness,
                        int stiffness_stride) {
  using Z = Sizes<N>;
  Data<N, Real> data;
  data.stiffness = stiffness;
  data.stiffness_stride = stiffness_stride;
  const auto at = [](Index i) { return static_cast<std::size_t>(i); };
  for (Index i = 0; i < t.l_at_points.rows(); ++i) {
    Real J_i = Real(0);
    for (Index j = 0; j <= t.order; ++j) J_i += t.l_at_points(i, j) * J[at(j)];
    data.wJ[at(i)] = t.rule.weights[at(i)] * J_i;
    Vector6<Real> K0 = Vector6<Real>::Zero();
    Index p = 0;
    for (Index j = 0; j < t.order; ++j) {
      for (Index k = j + 1; k <= t.order; ++k, ++p) {
        const Real c =
            t.l_at_points(i, j) * t.d(j, k) / J[at(j)] - t.l_at_points(i, k) * t.d(k, j) / J[at(k)];
        data.c[at(i * Z::max_pairs + p)] = c;
        K0 +=
            c *
            typename Metric::template Pair<Real>(relative(reference[at(j)], reference[at(k)])).q();
      }
    }
    data.K0[at(i)] = K0;
  }
  return data;
}

// The pairs of one element at given node poses, in the order of (1).
template <class Metric, int N, class S>
struct Motion {
  using Z = Sizes<N>;
  using Pair = typename Metric::template Pair<S>;
  std::array<Pose<S>, Z::max_pairs> g;
  std::array<Pair, Z::max_pairs> pair;
  std::array<Vector6<S>, Z::max_pairs> q;
  S margin;  // min over pairs of cos(angle/2) - cos(max_angle/2)

  // node(k) returns the pose of node k.
  template <class NodePose>
  MBD_INLINE void set(int order, const NodePose& node) {
    S smallest = S(1);
    std::size_t i = 0;
    for (int j = 0; j < order; ++j) {
      const Pose<S>& Hj = node(j);
      const Matrix3<S> Rj = Hj.R();
      for (int k = j + 1; k <= order; ++k, ++i) {
        const Pose<S>& Hk = node(k);
        const Vector3<S> chord = Hk.r - Hj.r;
        set_relative_rotation(Hj.p, Hk.p, g[i].p);
        g[i].r.noalias() = Rj.transpose() * chord;
        pair[i] = Pair(g[i]);
        q[i] = pair[i].q();
        smallest = smaller_of<S>(smallest, pair[i].e0);
      }
    }
    margin = smallest - S(limit());
  }

  static double limit() {
    static const double value = std::cos(0.5 * Metric::max_angle);
    return value;
  }
};

// Full curvature K_i at quadrature point i, less K0 if asked: the strain E_i.
template <int N, class S, class Real>
Vector6<S> curvature(const Data<N, Real>& data, int i, int pairs,
                     const std::array<Vector6<S>, Sizes<N>::max_pairs>& q) {
  Vector6<S> K = Vector6<S>::Zero();
  for (int p = 0; p < pairs; ++p)
    K += S(data.c[static_cast<std::size_t>(i * Sizes<N>::max_pairs + p)]) *
         q[static_cast<std::size_t>(p)];
  return K;
}

}  // namespace mbd::beam
