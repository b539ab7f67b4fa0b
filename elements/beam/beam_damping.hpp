// Viscous term of the spectral beam (Kelvin-Voigt): sectional forces S_i = C Edot_i at the quadrature points,
// besides those of the elastic term.
//
// Dissipation function (NOTATION.md 3 for the kinematics). R = 1/2 sum_i w_i J_i Edot_i^T C Edot_i. Of the
// kinematics of beam_motion.hpp, with V = [v; w] the body-frame velocities of the nodes,
//   Edot_i = Kdot_i = Bbar_i V = sum_p c_ip qdot_p,   qdot_p = T^-1(q_p) V_k - T^-1(-q_p) V_j           (1)
//   W_p = dR/dqdot_p = sum_i w_i J_i c_ip C Edot_i                                                      (2)
//   r   = dR/dV = sum_p { r_k += T^-1(q_p)^T W_p,  r_j -= T^-1(-q_p)^T W_p }                            (3)
//   dr/dV = sum_i w_i J_i Bbar_i^T C Bbar_i                                                             (4)
// The power of these forces is -r.V = -2 R <= 0, and none in a rigid motion, however fast. Poses enter twice:
//   dr/dU = sum_i w_i J_i Bbar_i^T C d(Edot_i)/dU + sum_p (geometric part at W_p, metrics.hpp (4))      (5)
// qdot = T^-1(q) zeta, zeta = V_k - y, y = Ad(g^-1) V_j, where dy = -z~ y = y~ z if g turns by
// z = U_k - Ad(g^-1) U_j. Of each metric T^-1(q) - T^-1(-q) = q~, and dq = T^-1(q) z: so
//   d(T^-1(q)) zeta = d(T^-1(-q)) zeta + dq~ zeta = { L(zeta) - zeta~ T^-1(q) } z                       (6)
//   d(qdot_p) = { L(zeta) - zeta~ T^-1(q) - T^-1(q) y~ } z                                              (7)
// with L(x) z = d(T^-1(-q)) x: as T^-1(-q) = A^T + eps B^T, the dual matrix of the blocks of metrics.hpp (3).
//
// Symbols: C viscous stiffness of the section [N.s, N.m.s, N.m2.s], symmetric, not negative; may vary from
// point to point. The rest as in beam_motion.hpp and beam_elastic.hpp.
// Damping ratio of a mode of frequency omega where C = beta D: beta omega/2. Source: the linear viscous solid
// of Kelvin and Voigt, section by section; as in Bauchau & Nemani, "Modeling viscoelastic behavior in flexible
// multibody systems", Multibody Syst. Dyn. 51 (2021), written with the rates of HB's strains (HB 19, 22).
// Used beside either form of the elastic term: the paper's form weighs its forces otherwise, but a viscous
// force weighed so would not have the power of a dissipation function.
// Not used: rates of strain by differences over a step (belong to no state, and not to every integrator); a
// kernel of elastic and viscous forces together (models without damping would pay for it).
#pragma once

#include <vector>

#include "elements/beam/beam_strips.hpp"
#include "elements/element.hpp"
#include "libmbd/core/batch.hpp"

namespace mbd::beam {

template <class Metric, int N>
struct Damping {
  using Z = Sizes<N>;
  static constexpr int nodes = Z::nodes;
  static constexpr int max_nodes = Z::max_nodes;
  static constexpr bool has_K = true;
  static constexpr bool has_D = true;
  static constexpr bool needs_rates = true;
  static constexpr bool may_be_offset = true;

  struct Shared {
    int order_ = 0;
    int points = 0;               // of the quadrature
    std::vector<Mat6> viscosity;  // C: [N; M] vs rates of [gamma; kappa]  [N.s, N.m.s, N.m2.s]

    int order() const { return N > 0 ? N : order_; }
  };
  // Constants of one element; `viscosity` and its stride as the stiffness of beam::Data.
  struct Data {
    std::array<double, Z::max_points * Z::max_pairs> c{};  // beam_motion.hpp (1)  [1/m]
    std::array<double, Z::max_points> wJ{};                // w_i J(xi_i)          [m]
    int viscosity = 0;
    int viscosity_stride = 0;
  };
  template <class S>
  using Output = ElementOutput<S, nodes, max_nodes>;

  static int node_count(const Shared& shared) { return shared.order() + 1; }

  // From what the elastic term has of the element.
  static Data make_data(const beam::Data<N>& kinematics, int viscosity, int viscosity_stride) {
    return {kinematics.c, kinematics.wJ, viscosity, viscosity_stride};
  }

  static const Mat6& C_at(const Shared& shared, const Data& data, int i) {
    return shared.viscosity[static_cast<std::size_t>(data.viscosity + i * data.viscosity_stride)];
  }

  template <Want want, class S>
  static S evaluate(const Shared& shared, const Data& data, const NodeState<S>* x,
                    const Environment&, RateWeights weights, Output<S>& out) {
    Work<S> work;
    residual(shared, data, x, work, out);
    if constexpr (want == Want::tangent) tangent(shared, data, x, S(weights.V), work, out);
    return work.motion.margin;
  }

  // -2 R [W].
  static double damping_power(const Shared& shared, const Data& data, const NodeState<double>* x,
                              const Environment&) {
    Work<double> work;
    rates(shared, data, x, work);
    double power = 0.0;
    for (int i = 0; i < shared.points; ++i) {
      const Vec6& rate = work.rate[static_cast<std::size_t>(i)];
      power -= data.wJ[static_cast<std::size_t>(i)] * rate.dot(times(C_at(shared, data, i), rate));
    }
    return power;
  }

  // Viscous part of [N1 Q2 Q3 M1 M2 M3] at the quadrature points, section frame.
  static void resultants(const Shared& shared, const Data& data, const NodeState<double>* x,
                         Vec6* S) {
    Work<double> work;
    rates(shared, data, x, work);
    for (int i = 0; i < shared.points; ++i)
      S[i] = C_at(shared, data, i) * work.rate[static_cast<std::size_t>(i)];
  }

 private:
  // What residual and tangent share.
  template <class S>
  struct Work {
    Motion<Metric, N, S> motion;
    std::array<DualMatrix<S>, Z::max_pairs> T;   // T^-1(q_p)
    std::array<Vector6<S>, Z::max_points> rate;  // Edot_i
    std::array<Vector6<S>, Z::max_pairs> W;
  };

  // (1)
  template <class S>
  static void rates(const Shared& shared, const Data& data, const NodeState<S>* x, Work<S>& work) {
    const int order = shared.order();
    work.motion.set(order, [x](int k) -> const Pose<S>& { return x[k].H; });
    std::array<Vector6<S>, Z::max_pairs> qdot;
    std::size_t p = 0;
    for (int j = 0; j < order; ++j) {
      for (int k = j + 1; k <= order; ++k, ++p) {
        const DualMatrix<S> T = work.T[p] = work.motion.pair[p].T_inverse();
        qdot[p] = T * x[k].V - T.transposed_parts() * x[j].V;
      }
    }
    for (int i = 0; i < shared.points; ++i) {
      Vector6<S>& rate = work.rate[static_cast<std::size_t>(i)];
      rate.setZero();
      for (p = 0; p < static_cast<std::size_t>(order * (order + 1) / 2); ++p)
        rate += S(data.c[static_cast<std::size_t>(i * Z::max_pairs) + p]) * qdot[p];
    }
  }

  // (2), (3). Not inlined: the same to the last bit with and without the tangent.
  template <class S>
  [[gnu::noinline, gnu::flatten]] static void residual(const Shared& shared, const Data& data,
                                                       const NodeState<S>* x, Work<S>& work,
                                                       Output<S>& out) {
    const int order = shared.order();
    rates(shared, data, x, work);
    std::array<Vector6<S>, Z::max_points> weighted;
    for (int i = 0; i < shared.points; ++i) {
      const auto I = static_cast<std::size_t>(i);
      weighted[I] =
          S(data.wJ[I]) * times<S>(C_at(shared, data, i).template cast<S>(), work.rate[I]);
    }
    assemble_pairs<N, S>(data, order, shared.points, work.motion, weighted, work.W, out);
  }

  template <class S>
  static DualMatrix<S> tilde(const Vector6<S>& V) {
    return {hat(angular(V)), hat(linear(V))};
  }
  template <class S>
  static DualMatrix<S> product(const DualMatrix<S>& a, const DualMatrix<S>& b) {
    return {a.A.lazyProduct(b.A), a.A.lazyProduct(b.B) + a.B.lazyProduct(b.A)};
  }

  // (4), (5)
  template <class S>
  [[gnu::noinline, gnu::flatten]] static void tangent(const Shared& shared, const Data& data,
                                                      const NodeState<S>* x, S weight,
                                                      const Work<S>& work, Output<S>& out) {
    const auto& [motion, T, rate, W] = work;
    const int order = shared.order(), points = shared.points;
    const int rows = 6 * (order + 1);
    using All = Strips<N, S>;
    const int last = All::last(rows);
    typename All::All by_V, by_U, X;  // Bbar_i, d(Edot_i)/dU, w J Bbar^T C
    All::clear(by_V, points, last);
    All::clear(by_U, points, last);
    std::size_t p = 0;
    for (int j = 0; j < order; ++j) {
      for (int k = j + 1; k <= order; ++k, ++p) {
        const DualMatrix<S> Ad = adjoint_inverse(motion.g[p]);
        const Vector6<S> y = Ad * x[j].V;
        const Vector6<S> zeta = x[k].V - y;
        DualMatrix<S> G;  // (7)
        motion.pair[p].linearize(T[p], angular(zeta), linear(zeta), G.A, G.B);
        const DualMatrix<S> odd = product(tilde(zeta), T[p]), turned = product(T[p], tilde(y));
        G.A -= odd.A + turned.A;
        G.B -= odd.B + turned.B;
        // All transposed; of node j T is T[p] with its parts transposed.
        const DualMatrix<S> T_k = T[p].transposed_parts(), G_k = G.transposed_parts(),
                            G_j = product(G, Ad).transposed_parts();
        for (int i = 0; i < points; ++i) {
          const auto I = static_cast<std::size_t>(i);
          const S c = S(data.c[static_cast<std::size_t>(i * Z::max_pairs) + p]);
          All::add(by_V[I], k, c, T_k.A, T_k.B);
          All::add(by_V[I], j, -c, T[p].A, T[p].B);
          All::add(by_U[I], k, c, G_k.A, G_k.B);
          All::add(by_U[I], j, -c, G_j.A, G_j.B);
        }
      }
    }
    for (int i = 0; i < points; ++i) {
      const auto I = static_cast<std::size_t>(i);
      const Matrix6<S> wC = S(data.wJ[I]) * C_at(shared, data, i).template cast<S>();
      All::multiply(by_V[I], wC, last, X[I]);
    }
    All::product_sum(X, by_V, points, rows, weight, out.D);
    All::product_sum(X, by_U, points, rows, S(1), out.K);
    add_geometric_stiffness<N, S>(order, motion, T, W, out.K);
  }
};

}  // namespace mbd::beam
