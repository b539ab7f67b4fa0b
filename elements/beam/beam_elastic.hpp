// Elastic term of the spectral beam: sectional forces S_i = D E_i at the quadrature points, E_i = K_i - K0_i.
//
// Energy form (NOTATION.md 3). phi = 1/2 sum_i w_i J_i E_i^T D E_i. With (1) of beam_motion.hpp
//   W_p = dphi/dq_p and F of beam_strips.hpp (1)                                                   (1), (2)
//   dF  = sum_i w_i J_i Bbar_i^T D Bbar_i dU + sum_p (geometric stiffness of the pair, metrics.hpp (4)) (3)
// Self-equilibrated and objective to round-off, the gradient of phi, conserves a discrete energy.
// (3) is not symmetric, because body-frame increments do not commute; at equilibrium it is.
//
// Paper's form (HB 39, 41), a Petrov-Galerkin one; not the gradient of an energy:
//   F_a  = sum_i w_i [ l'_a S_i + J_i l_a K_i~^T S_i ]                                              (4)
//   dF_a = sum_i w_i [ l'_a D + J_i l_a (K_i~^T D + S_i^U) ] Bbar_i dU                              (5)
//
// Symbols: F nodal forces, node frames [N, N.m]; the rest as in beam_motion.hpp. D may vary from point to
// point. Not used: interpolating displacement and rotation apart (needs a rule for objectivity).
#pragma once

#include <algorithm>
#include <map>
#include <vector>

#include "elements/beam/beam_strips.hpp"
#include "elements/element.hpp"
#include "libmbd/core/batch.hpp"

namespace mbd::beam {

struct EnergyForm {
  static constexpr const char* name = "energy form";
};
struct PaperForm {
  static constexpr const char* name = "paper's form";
};

// Real: the type of the constants, as in beam_motion.hpp.
template <class Metric, class Form, int N, class Real = double>
struct Elastic {
  using Z = Sizes<N>;
  static constexpr int nodes = Z::nodes;
  static constexpr int max_nodes = Z::max_nodes;
  static constexpr bool has_K = true;
  static constexpr bool has_D = false;
  static constexpr bool needs_rates = false;
  static constexpr bool may_be_offset = true;
  static constexpr bool is_energy = std::is_same_v<Form, EnergyForm>;

  struct Shared {
    Table<N, Real> table;
    std::vector<Matrix6<Real>> stiffness;  // D: [N; M] vs [gamma; kappa]  [N, N.m, N.m2]
  };
  using Data = beam::Data<N, Real>;
  template <class S>
  using Output = ElementOutput<S, nodes, max_nodes>;
  // Real = Pack: constants of as many elements side by side as a pack has lanes.
  static constexpr bool has_packs = is_energy && std::is_same_v<Real, double>;
  using Packed = std::conditional_t<has_packs, Elastic<Metric, Form, N, Pack>, void>;

  static int node_count(const Shared& shared) { return shared.table.order() + 1; }

  static const Matrix6<Real>& D_at(const Shared& shared, const Data& data, int i) {
    return shared.stiffness[static_cast<std::size_t>(data.stiffness + i * data.stiffness_stride)];
  }

  // What residual and tangent share.
  template <class S>
  struct Work {
    Motion<Metric, N, S> motion;
    std::array<Vector6<S>, Z::max_points> force;  // S_i
    std::array<Vector6<S>, Z::max_points> full;   // K_i (paper's form only)
    std::array<Vector6<S>, Z::max_pairs> W;       // (energy form only)
  };

  template <Want want, class S>
  static S evaluate(const Shared& shared, const Data& data, const NodeState<S>* x,
                    const Environment&, RateWeights, Output<S>& out) {
    Work<S> work;
    residual(shared, data, x, work, out);
    if constexpr (want == Want::tangent) tangent(shared, data, work, out);
    return work.motion.margin;
  }

  // Constants of all packs of a list of elements, of which lanes of one pack differ, packs seldom.
  static PackedElements<Elastic> packed(const Shared& shared,
                                        const std::vector<Data>& elements) requires has_packs {
    PackedElements<Elastic> result;
    result.shared.table = shared.table.template cast<Pack>();
    std::map<std::array<int, pack_count>, int> known;  // first and further D of lanes
    each_pack(0, elements.size(), [&](const PackOf& pack) {
      const auto of = [&](int k) -> const Data& { return elements[pack[k]]; };
      typename Packed::Data data;
      pack_into(data.c, [&](int k) { return of(k).c.data(); });
      pack_into(data.wJ, [&](int k) { return of(k).wJ.data(); });
      for (std::size_t i = 0; i < data.K0.size(); ++i)
        pack_into(data.K0[i], [&](int k) { return of(k).K0[i].data(); });
      bool varies = false;
      std::array<int, pack_count> first{};
      for (int k = 0; k < pack_count; ++k) {
        varies = varies || of(k).stiffness_stride != 0;
        first[static_cast<std::size_t>(k)] = of(k).stiffness;
      }
      const auto next = static_cast<int>(result.shared.stiffness.size());
      const bool is_new = varies || known.emplace(first, next).second;
      data.stiffness = is_new ? next : known.at(first);
      data.stiffness_stride = varies ? 1 : 0;
      for (int i = 0; is_new && i < (varies ? shared.table.points : 1); ++i) {
        Matrix6<Pack> D;
        pack_into(D, [&](int k) { return D_at(shared, of(k), i).data(); });
        result.shared.stiffness.push_back(D);
      }
      result.data.push_back(data);
    });
    return result;
  }

  // --- resultants as iterates (NOTATION.md 5) ---
  static int point_count(const Shared& shared) { return shared.table.points; }

  // (3) or (5) with S*_i in place of S_i where the geometry varies: in W_p, or in S_i^U.
  template <class S>
  static S evaluate_mixed(const Shared& shared, const Data& data, const NodeState<S>* x,
                          const Vector6<S>* given, Output<S>& out) {
    Work<S> work;
    residual(shared, data, x, work, out);
    const int points = shared.table.points, order = shared.table.order();
    if constexpr (is_energy) {
      for (int p = 0; p < order * (order + 1) / 2; ++p) {
        Vector6<S>& sum = work.W[static_cast<std::size_t>(p)];
        sum.setZero();
        for (int i = 0; i < points; ++i)
          sum += S(data.c[static_cast<std::size_t>(i * Z::max_pairs + p)] *
                   data.wJ[static_cast<std::size_t>(i)]) *
                 given[i];
      }
    } else {
      std::copy_n(given, points, work.force.begin());
    }
    tangent(shared, data, work, out);
    return work.motion.margin;
  }

  // S_i = D (E_i + Bbar_i dU), by dq = T^-1(q) U_k - T^-1(-q) U_j.
  template <class S>
  static void linearized_resultants(const Shared& shared, const Data& data, const NodeState<S>* x,
                                    const Vector6<S>* dU, Vector6<S>* resultants) {
    const int order = shared.table.order();
    Motion<Metric, N, S> motion;
    motion.set(order, [x](int k) -> const Pose<S>& { return x[k].H; });
    std::size_t p = 0;
    for (int j = 0; j < order; ++j)
      for (int k = j + 1; k <= order; ++k, ++p) {
        const DualMatrix<S> T = motion.pair[p].T_inverse();
        motion.q[p] += T * dU[k] - T.transposed_parts() * dU[j];
      }
    for (int i = 0; i < shared.table.points; ++i)
      resultants[i] = times<S>(D_at(shared, data, i).template cast<S>(),
                               strain(data, i, order * (order + 1) / 2, motion));
  }

  // --- resultants as iterates with a tangent that is kept, in time (NOTATION.md 5) ---
  // Of elements side by side, numbers of type S one after the other: of a tangent T^-1(q_p) by pairs (A, B) and, in the
  // paper's form, K_i by points; of an iterate S_i and D E_i by points.
  static std::size_t kept_count(const Shared& shared) {
    const int order = shared.table.order();
    return static_cast<std::size_t>(kept_of_pairs(order) +
                                    (is_energy ? 0 : 6 * shared.table.points));
  }

  // B^T S + B0^T (D E - S), in the paper's form its weights in place of B^T; sets D E.
  template <class S>
  [[gnu::noinline, gnu::flatten]] static S residual_kept(const Shared& shared, const Data& data,
                                                         const NodeState<S>* x, const double* kept,
                                                         const double* given, double* linear,
                                                         Output<S>& out) {
    const int order = shared.table.order(), points = shared.table.points;
    Work<S> work;
    work.motion.set(order, [x](int k) -> const Pose<S>& { return x[k].H; });
    std::array<Vector6<S>, Z::max_points> rest;  // D E - S
    for (int i = 0; i < points; ++i) {
      const auto I = static_cast<std::size_t>(i);
      const Vector6<S> K = curvature<N, S>(data, i, order * (order + 1) / 2, work.motion.q);
      const Vector6<S> E = K - data.K0[I].template cast<S>();
      const Vector6<S> DE = times<S>(D_at(shared, data, i).template cast<S>(), E);
      put(DE, linear, i);
      work.force[I] = taken<Vector6<S>>(given, i);
      rest[I] = DE - work.force[I];
      if constexpr (!is_energy) work.full[I] = K;
    }
    if constexpr (is_energy) {
      std::array<Vector6<S>, Z::max_points> weighted;
      for (int i = 0; i < points; ++i) {
        const auto I = static_cast<std::size_t>(i);
        weighted[I] = S(data.wJ[I]) * work.force[I];
        rest[I] *= S(data.wJ[I]);
      }
      assemble_pairs<N, S>(data, order, points, work.motion, weighted, work.W, out);
      add_kept_pairs<N, S>(data, order, points, kept, rest, out);
    } else {
      assemble_paper(shared.table, data, work.force, work.full, out);
      const typename Output<S>::Vector first = out.r;
      for (int i = 0; i < points; ++i)
        work.full[static_cast<std::size_t>(i)] = taken<Vector6<S>>(kept + kept_of_pairs(order), i);
      assemble_paper(shared.table, data, rest, work.full, out);
      out.r += first;
    }
    return work.motion.margin;
  }

  // Of a tangent at x: sets what is kept of it, unless there is no place for it, and D E.
  template <class S>
  static void keep(const Shared& shared, const Data& data, const NodeState<S>* x, double* kept,
                   double* linear) {
    const int order = shared.table.order(), pairs = order * (order + 1) / 2;
    Motion<Metric, N, S> motion;
    motion.set(order, [x](int k) -> const Pose<S>& { return x[k].H; });
    for (int p = 0; kept != nullptr && p < pairs; ++p) {
      const DualMatrix<S> T = motion.pair[static_cast<std::size_t>(p)].T_inverse();
      put(T.A, kept, 2 * p);
      put(T.B, kept, 2 * p + 1);
    }
    for (int i = 0; i < shared.table.points; ++i) {
      const Vector6<S> K = curvature<N, S>(data, i, pairs, motion.q);
      const Vector6<S> E = K - data.K0[static_cast<std::size_t>(i)].template cast<S>();
      const Vector6<S> DE = times<S>(D_at(shared, data, i).template cast<S>(), E);
      put(DE, linear, i);
      if (!is_energy && kept != nullptr) put(K, kept + kept_of_pairs(order), i);
    }
  }

  // S = D E + D B0 dU.
  template <class S>
  [[gnu::noinline, gnu::flatten]] static void advance(const Shared& shared, const Data& data,
                                                      const double* kept, const Vector6<S>* dU,
                                                      const double* linear, double* resultants) {
    const int order = shared.table.order(), pairs = order * (order + 1) / 2;
    std::array<Vector6<S>, Z::max_pairs> dq;
    int p = 0;
    for (int j = 0; j < order; ++j)
      for (int k = j + 1; k <= order; ++k, ++p) {
        const DualMatrix<S> T{taken<Matrix3<S>>(kept, 2 * p), taken<Matrix3<S>>(kept, 2 * p + 1)};
        dq[static_cast<std::size_t>(p)] = T * dU[k] - T.transposed_parts() * dU[j];
      }
    for (int i = 0; i < shared.table.points; ++i) {
      const Vector6<S> dE = curvature<N, S>(data, i, pairs, dq);
      const Vector6<S> dS = times<S>(D_at(shared, data, i).template cast<S>(), dE);
      put(Vector6<S>(taken<Vector6<S>>(linear, i) + dS), resultants, i);
    }
  }

  // out.K = d(B^T R)/dU at fixed R, the resultants S - D E.
  static void geometric_stiffness(const Shared& shared, const Data& data,
                                  const NodeState<double>* x, const Vec6* difference,
                                  Output<double>& out) {
    const int order = shared.table.order(), points = shared.table.points;
    const int rows = 6 * (order + 1);
    Work<double> work;
    residual(shared, data, x, work, out);
    if constexpr (is_energy) {
      std::array<DualMatrix<double>, Z::max_pairs> T;
      for (std::size_t p = 0; p < static_cast<std::size_t>(order * (order + 1) / 2); ++p) {
        T[p] = work.motion.pair[p].T_inverse();
        work.W[p].setZero();
        for (std::size_t i = 0; i < static_cast<std::size_t>(points); ++i)
          work.W[p] += data.c[i * Z::max_pairs + p] * data.wJ[i] * difference[i];
      }
      out.K.setZero(rows, rows);
      add_geometric_stiffness<N, double>(order, work.motion, T, work.W, out.K);
    } else {  // the tangent is linear in S
      tangent(shared, data, work, out);
      const typename Output<double>::Square of_DE = out.K;
      for (std::size_t i = 0; i < static_cast<std::size_t>(points); ++i)
        work.force[i] += difference[i];
      tangent(shared, data, work, out);
      out.K -= of_DE;
    }
    out.r.setZero();
  }

  template <class S>
  static S energy(const Shared& shared, const Data& data, const NodeState<S>* x) {
    const int order = shared.table.order();
    Motion<Metric, N, S> motion;
    motion.set(order, [x](int k) -> const Pose<S>& { return x[k].H; });
    S phi = S(0);
    for (int i = 0; i < shared.table.points; ++i) {
      const Vector6<S> E = strain(data, i, order * (order + 1) / 2, motion);
      const Vector6<S> DE = D_at(shared, data, i).template cast<S>() * E;
      phi += S(0.5 * data.wJ[static_cast<std::size_t>(i)]) * E.dot(DE);
    }
    return phi;
  }
  static Energies energies(const Shared& shared, const Data& data, const NodeState<double>* x,
                           const Environment&) {
    return {.kinetic = 0.0, .strain = energy<double>(shared, data, x), .potential = 0.0};
  }

  // Sectional forces [N1 Q2 Q3 M1 M2 M3] at the quadrature points, section frame. Of all: the motion between nodes is theirs.
  static void resultants(const Shared& shared, const Data& data, const NodeState<double>* x,
                         Vec6* S) {
    const int order = shared.table.order();
    Motion<Metric, N, double> motion;
    motion.set(order, [x](int k) -> const Pose<double>& { return x[k].H; });
    for (int i = 0; i < shared.table.points; ++i)
      S[i] = D_at(shared, data, i) * strain(data, i, order * (order + 1) / 2, motion);
  }

 private:
  static constexpr int kept_of_pairs(int order) { return 18 * (order * (order + 1) / 2); }

  // Not inlined, so that the residual is the same machine code, and the same to the last bit, with and
  // without the tangent.
  template <class S>
  [[gnu::noinline, gnu::flatten]] static void residual(const Shared& shared, const Data& data,
                                                       const NodeState<S>* x, Work<S>& work,
                                                       Output<S>& out) {
    const int order = shared.table.order();
    const int pairs = order * (order + 1) / 2;
    const int points = shared.table.points;
    work.motion.set(order, [x](int k) -> const Pose<S>& { return x[k].H; });
    for (int i = 0; i < points; ++i) {
      const auto I = static_cast<std::size_t>(i);
      const Vector6<S> K = curvature<N, S>(data, i, pairs, work.motion.q);
      const Vector6<S> E = K - data.K0[I].template cast<S>();
      work.force[I] = times<S>(D_at(shared, data, i).template cast<S>(), E);
      if constexpr (!is_energy) work.full[I] = K;
    }
    if constexpr (is_energy) {
      std::array<Vector6<S>, Z::max_points> weighted;
      for (int i = 0; i < points; ++i) {
        const auto I = static_cast<std::size_t>(i);
        weighted[I] = S(data.wJ[I]) * work.force[I];
      }
      assemble_pairs<N, S>(data, order, points, work.motion, weighted, work.W, out);
    } else {
      assemble_paper(shared.table, data, work.force, work.full, out);
    }
  }

  template <class S>
  static Vector6<S> strain(const Data& data, int i, int pairs, const Motion<Metric, N, S>& motion) {
    return curvature<N, S>(data, i, pairs, motion.q) -
           data.K0[static_cast<std::size_t>(i)].template cast<S>();
  }

  // (4)
  template <class S>
  static void assemble_paper(const Table<N, Real>& table, const Data& data,
                             const std::array<Vector6<S>, Z::max_points>& force,
                             const std::array<Vector6<S>, Z::max_points>& full, Output<S>& out) {
    const int order = table.order();
    out.r.setZero(6 * (order + 1));
    for (int i = 0; i < table.points; ++i) {
      const auto I = static_cast<std::size_t>(i);
      const Vector6<S> along = S(table.w[I]) * force[I];
      const Vector6<S> turned = S(data.wJ[I]) * twist_hat_transpose_times(full[I], force[I]);
      for (int a = 0; a <= order; ++a) {
        const auto ia = static_cast<std::size_t>(i * Z::max_nodes + a);
        rows_at<6>(out.r, 6 * a) += S(table.dl[ia]) * along + S(table.l[ia]) * turned;
      }
    }
  }

  // (3) or (5)
  template <class S>
  [[gnu::noinline, gnu::flatten]] static void tangent(const Shared& shared, const Data& data,
                                                      const Work<S>& work, Output<S>& out) {
    const auto& [motion, force, full, W] = work;
    const int order = shared.table.order();
    const int rows = 6 * (order + 1);
    const int points = shared.table.points;
    using All = Strips<N, S>;
    const int last = All::last(rows);
    typename All::All Bbar, X;
    std::array<DualMatrix<S>, Z::max_pairs> T;
    All::clear(Bbar, points, last);
    std::size_t p = 0;
    for (int j = 0; j < order; ++j) {
      for (int k = j + 1; k <= order; ++k, ++p) {
        T[p] = motion.pair[p].T_inverse();
        const Matrix3<S> At = T[p].A.transpose(), Bt = T[p].B.transpose();
        for (int i = 0; i < points; ++i) {
          const auto I = static_cast<std::size_t>(i);
          const S c = S(data.c[static_cast<std::size_t>(i * Z::max_pairs) + p]);
          All::add(Bbar[I], k, c, At, Bt);
          All::add(Bbar[I], j, -c, T[p].A, T[p].B);
        }
      }
    }
    for (int i = 0; i < points; ++i) {
      const auto I = static_cast<std::size_t>(i);
      const Matrix6<S> D = D_at(shared, data, i).template cast<S>();
      if constexpr (is_energy) {
        const Matrix6<S> wD = S(data.wJ[I]) * D.transpose();
        All::multiply(Bbar[I], wD, last, X[I]);
      } else {
        // row blocks: w l'_a D Bbar + w J l_a (K~^T D + S^U) Bbar
        const Matrix6<S> turned =
            S(data.wJ[I]) * (twist_hat(full[I]).transpose().lazyProduct(D) + wrench_hat(force[I]));
        const Matrix6<S> along = S(shared.table.w[I]) * D;
        for (int q = 0; q < 6; ++q) block_at<All::lanes, 1>(X[I], last - All::lanes, q).setZero();
        for (int a = 0; a <= order; ++a) {
          const auto ia = static_cast<std::size_t>(i * Z::max_nodes + a);
          block_at<6, 6>(X[I], 6 * a, 0) =
              S(shared.table.dl[ia]) * along + S(shared.table.l[ia]) * turned;
        }
      }
    }
    if constexpr (is_energy)
      All::symmetric_sum(X, Bbar, points, rows, out.K);
    else
      All::product_sum(X, Bbar, points, rows, S(1), out.K);
    if constexpr (is_energy) add_geometric_stiffness<N, S>(order, motion, T, W, out.K);
  }
};

}  // namespace mbd::beam
