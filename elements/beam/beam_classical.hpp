// Elastic term of the classical beam: displacement and rotation interpolated apart, the rotation by the
// normalised sum of unit quaternions. An alternative to elements/beam/beam_elastic.hpp on the same nodes,
// quadrature points and sections, to be compared with it.
//
// Kinematics, with l_k the Lagrange polynomials through the GLL nodes and s_k = sign(p_0 . p_k):
//   r = sum_k l_k r_k,   a = sum_k l_k s_k p_k,   p = a/|a|,   R = R(p)                              (1)
//   b = a'/J,   c = r'/J,   n = a.a
//   t = R^T c,   k = 2 Im(conj(a) b)/n,   E = [t; k] - K0                                           (2)
// K0 from the same formulas on the reference configuration. A rigid motion multiplies all p_k from the left,
// so a and b with them and E not at all: objective. b needs no correction for |a| != 1: the part of b along
// a is the scalar part of conj(a) b.
//
// Energy. phi = 1/2 sum_i w_i J_i E_i^T D E_i, a function of x = (a, b, c) at each point. In the frame of the
// point, for variations alpha = conj(a) da/n, beta = conj(a) db/n (quaternions [scalar; vector]),
// rho = R^T dc, and with conj(a) b/n = [b0; k/2], to second order:
//   dt = rho + 2 t x av  + 2 av x (av x t) + 2 a0 av x t - 2 av x rho                               (3)
//   dk = 2 bv - a0 k - 2 b0 av + k x av
//        - 2 a0 bv - 2 b0' av - 2 av x bv + 4 b0 a0 av + 2 a0 av x k + (a0^2 - av.av) k             (4)
//   (alpha = [a0; av], beta = [b0'; bv]). First order: dE = L [alpha; beta; rho]. With S = [N; M] = w J D E:
//   g = L^T S = { a0: -M.k;  av: 2 N x t - 2 b0 M - k x M;  b0': 0;  bv: 2 M;  rho: N }             (5)
//   h = L^T (w J D) L + the second-order parts of N.(3) + M.(4)                                     (6)
// Both are taken to inertial components, where nodes and points meet, by a, a and R.
//
// Nodes. da = sum_k l_k Q_k psi_k, db = sum_k (l'_k/J) Q_k psi_k, dc = sum_k (l'_k/J) R_k u_k, with
// Q_k psi = s_k p_k [0; psi]/2. With f_k, y_k = sum_i (l'_k/J) g_c, sum_i { l_k g_a + (l'_k/J) g_b }:
//   F_k = [ R_k^T f_k ; Q_k^T y_k ]                                                                 (7)
//   dF  = sum_i P_i^T h_i P_i dU + { [ f~ ; F~_psi/2 - (s_k p_k . y_k) I/4 ] psi_k },                (8)
// where P_i takes U to (da, db, dc), f = R_k^T f_k and F_psi = Q_k^T y_k: rotations of one node do not commute.
// The gradient of phi: self-equilibrated, and the tangent symmetric where the forces vanish.
//
// Validity. Signs do not depend on which node is the first while s_j s_k p_j . p_k > 0 for every pair, that is
// while no two nodes are turned by pi. As for the geodesic metric, the limit is 0.9 of that. With nodes turned
// at random a could still come near to 0: refused where n < 0.1.
//
// Symbols: S [N, N.m], F nodal forces in node frames [N, N.m], y [N.m], J [m]. Source: ours,
// for what HB compare with (section 9: a code in which "the displacement and rotation fields are treated
// separately"; how that one interpolates rotations is not printed, so this is not its copy). Not used:
// rotation vectors (singular, and objective only with a reference rotation of their own).
#pragma once

#include <array>
#include <numbers>
#include <vector>

#include "elements/beam/beam_motion.hpp"
#include "elements/element.hpp"
#include "libmbd/core/batch.hpp"

namespace mbd::beam {

// Limits of validity of the classical interpolation.
struct ClassicalRange {
  static constexpr double max_angle = 0.9 * std::numbers::pi;  // between two nodes [rad]
  static constexpr double min_n = 0.1;  // n = |a|^2; 1 between equal rotations
};

template <int N>
struct Classical {
  using Z = Sizes<N>;
  static constexpr int nodes = Z::nodes;
  static constexpr int max_nodes = Z::max_nodes;
  static constexpr bool has_K = true;
  static constexpr bool has_D = false;
  static constexpr bool needs_rates = false;
  static constexpr bool may_be_offset = true;

  struct Shared {
    Table<N> table;
    std::vector<Mat6> stiffness;  // D: [N; M] vs [gamma; kappa]  [N, N.m, N.m2]
  };
  // Constants of one element; stiffness and its stride as in beam::Data.
  struct Data {
    std::array<double, Z::max_points> wJ{};         // w_i J(xi_i)                [m]
    std::array<double, Z::max_points> inverse_J{};  // 1/J(xi_i)                  [1/m]
    std::array<Vec6, Z::max_points> K0;             // [t; k] of the reference    [-, 1/m]
    int stiffness = 0;
    int stiffness_stride = 0;
  };
  template <class S>
  using Output = ElementOutput<S, nodes, max_nodes>;

  static int node_count(const Shared& shared) { return shared.table.order() + 1; }

  static const Mat6& D_at(const Shared& shared, const Data& data, int i) {
    return shared.stiffness[static_cast<std::size_t>(data.stiffness + i * data.stiffness_stride)];
  }

  // From ds/dxi [m] and the reference pose at each node.
  static Data make_data(const Table<N>& table, std::span<const double> J,
                        std::span<const Pose<double>> reference, int stiffness,
                        int stiffness_stride) {
    Data data;
    data.stiffness = stiffness;
    data.stiffness_stride = stiffness_stride;
    Nodes<double> node;
    node.set(table.order(),
             [&](int k) -> const Pose<double>& { return reference[static_cast<std::size_t>(k)]; });
    for (int i = 0; i < table.points; ++i) {
      const auto I = static_cast<std::size_t>(i);
      double J_i = 0.0;
      for (int k = 0; k <= table.order(); ++k)
        J_i += table.l[at(i, k)] * J[static_cast<std::size_t>(k)];
      data.wJ[I] = table.w[I] * J_i;
      data.inverse_J[I] = 1.0 / J_i;
      data.K0[I] = Point<double>(table, data, i, node).K();
    }
    return data;
  }

  template <class S>
  using Vector4 = Matrix<S, 4, 1>;  // a quaternion [w; x; y; z]
  template <class S>
  using Matrix4 = Matrix<S, 4, 4>;
  template <class S>
  using Matrix43 = Matrix<S, 4, 3>;

  // The last three columns of the matrix of q -> x q: x [0; y] = product_of(x) y.
  template <class S>
  static Matrix43<S> product_of(const Vector4<S>& x) {
    Matrix43<S> m;
    m(0, 0) = -x(1), m(0, 1) = -x(2), m(0, 2) = -x(3);
    m(1, 0) = x(0), m(1, 1) = -x(3), m(1, 2) = x(2);
    m(2, 0) = x(3), m(2, 1) = x(0), m(2, 2) = -x(1);
    m(3, 0) = -x(2), m(3, 1) = x(1), m(3, 2) = x(0);
    return m;
  }

  // What the nodes give, inertial components; positions from that of node 0, rotations from its quaternion:
  // no loss far from the origin or near to the reference.
  template <class S>
  struct Nodes {
    std::array<Vector4<S>, Z::max_nodes> p;   // s_k p_k
    std::array<Vector4<S>, Z::max_nodes> dp;  // s_k p_k - p_0
    std::array<Vector3<S>, Z::max_nodes> dr;  // r_k - r_0
    std::array<Matrix3<S>, Z::max_nodes> R;
    S closest;  // min over pairs of cos(angle/2), negative beyond pi

    template <class NodePose>
    MBD_INLINE void set(int order, const NodePose& pose) {
      closest = S(1);
      const Vector3<S> r0 = pose(0).r;
      for (int k = 0; k <= order; ++k) {
        const auto K = static_cast<std::size_t>(k);
        const Pose<S>& H = pose(k);
        p[K] = Vector4<S>(H.p.w(), H.p.x(), H.p.y(), H.p.z());
        const S sign = sign_of(S(p[0].dot(p[K])));
        p[K] *= sign;
        dp[K] = p[K] - p[0];
        dr[K] = H.r - r0;
        R[K] = H.R();
        for (std::size_t j = 0; j < K; ++j) {
          const S dot = p[j].dot(p[K]);
          closest = dot < closest ? dot : closest;
        }
      }
    }
  };

  // A quadrature point: (1), (2).
  template <class S>
  struct Point {
    Vector4<S> a;
    S n, b0;
    Matrix3<S> R;
    Vector3<S> t, k;

    Point() = default;
    Point(const Table<N>& table, const Data& data, int i, const Nodes<S>& node) {
      set(table, data, i, node);
    }
    MBD_INLINE void set(const Table<N>& table, const Data& data, int i, const Nodes<S>& node) {
      Vector4<S> b = Vector4<S>::Zero();
      Vector3<S> c = Vector3<S>::Zero();
      a = node.p[0];  // sum l_k = 1, sum l'_k = 0
      for (int m = 1; m <= table.order(); ++m) {
        const auto M = static_cast<std::size_t>(m);
        const S l = S(table.l[at(i, m)]), dl = S(table.dl[at(i, m)]);
        a += l * node.dp[M];
        b += dl * node.dp[M];
        c += dl * node.dr[M];
      }
      const S inverse_J = S(data.inverse_J[static_cast<std::size_t>(i)]);
      n = a.squaredNorm();
      const S inverse_n = S(1) / n;
      R = (S(2) * inverse_n) * (a.template tail<3>() * a.template tail<3>().transpose() +
                                a(0) * hat(Vector3<S>(a.template tail<3>())));
      R.diagonal().array() += inverse_n * (a(0) * a(0) - a.template tail<3>().squaredNorm());
      t = inverse_J * (R.transpose() * c);
      b0 = inverse_J * inverse_n * a.dot(b);
      k = (S(2) * inverse_J * inverse_n) * (product_of<S>(a).transpose() * b);
    }
    Vector6<S> K() const { return six<S>(t, k); }
  };

  // What residual and tangent share.
  template <class S>
  struct Work {
    Nodes<S> node;
    std::array<Point<S>, Z::max_points> point;
    std::array<Vector6<S>, Z::max_points> force;  // w_i J_i S_i
    std::array<Vector4<S>, Z::max_nodes> y;
    S smallest_n;
  };

  template <Want want, class S>
  static S evaluate(const Shared& shared, const Data& data, const NodeState<S>* x,
                    const Environment&, RateWeights, Output<S>& out) {
    Work<S> work;
    residual(shared, data, x, work, out);
    if constexpr (want == Want::tangent) tangent(shared, data, work, out);
    return margin(work);
  }

  // --- resultants as iterates (NOTATION.md 5) ---
  static int point_count(const Shared& shared) { return shared.table.points; }

  // (8) with S*_i in place of S_i in the second-order parts of (6), in F_psi, f and y.
  template <class S>
  static S evaluate_mixed(const Shared& shared, const Data& data, const NodeState<S>* x,
                          const Vector6<S>* given, Output<S>& out) {
    Work<S> work;
    residual(shared, data, x, work, out);
    const typename Output<S>::Vector r = out.r;
    set_forces(shared, data, given, work, out);
    tangent(shared, data, work, out);
    out.r = r;
    return margin(work);
  }

  // S_i = D (E_i + L [alpha; beta; rho]), the first order of (3), (4).
  template <class S>
  static void linearized_resultants(const Shared& shared, const Data& data, const NodeState<S>* x,
                                    const Vector6<S>* dU, Vector6<S>* resultants) {
    const Table<N>& table = shared.table;
    Nodes<S> node;
    node.set(table.order(), [x](int k) -> const Pose<S>& { return x[k].H; });
    for (int i = 0; i < table.points; ++i) {
      const Point<S> point(table, data, i, node);
      Vector4<S> da = Vector4<S>::Zero(), db = da;
      Vector3<S> dc = Vector3<S>::Zero();
      const S inverse_J = S(data.inverse_J[static_cast<std::size_t>(i)]);
      for (int k = 0; k <= table.order(); ++k) {
        const auto K = static_cast<std::size_t>(k);
        const Vector4<S> dp = S(0.5) * (product_of<S>(node.p[K]) * angular(dU[k]));
        const S dl = inverse_J * S(table.dl[at(i, k)]);
        da += S(table.l[at(i, k)]) * dp;
        db += dl * dp;
        dc += dl * (node.R[K] * linear(dU[k]));
      }
      const S inverse_n = S(1) / point.n, a0 = inverse_n * point.a.dot(da);
      const Matrix43<S> Xv = inverse_n * product_of<S>(point.a);
      const Vector3<S> av = Xv.transpose() * da, bv = Xv.transpose() * db;
      const Vector3<S> dt = point.R.transpose() * dc + S(2) * point.t.cross(av);
      const Vector3<S> dk = S(2) * bv - a0 * point.k - S(2) * point.b0 * av + point.k.cross(av);
      resultants[i] = times<S>(D_at(shared, data, i).template cast<S>(),
                               Vector6<S>(strain(data, i, point) + six<S>(dt, dk)));
    }
  }

  template <class S>
  static S energy(const Shared& shared, const Data& data, const NodeState<S>* x) {
    Nodes<S> node;
    node.set(shared.table.order(), [x](int k) -> const Pose<S>& { return x[k].H; });
    S phi = S(0);
    for (int i = 0; i < shared.table.points; ++i) {
      const Vector6<S> E = strain(data, i, Point<S>(shared.table, data, i, node));
      const Vector6<S> DE = D_at(shared, data, i).template cast<S>() * E;
      phi += S(0.5 * data.wJ[static_cast<std::size_t>(i)]) * E.dot(DE);
    }
    return phi;
  }
  static Energies energies(const Shared& shared, const Data& data, const NodeState<double>* x,
                           const Environment&) {
    return {.kinetic = 0.0, .strain = energy<double>(shared, data, x), .potential = 0.0};
  }

  // Sectional forces [N1 Q2 Q3 M1 M2 M3] at the quadrature points, section frame.
  static void resultants(const Shared& shared, const Data& data, const NodeState<double>* x,
                         Vec6* S) {
    Nodes<double> node;
    node.set(shared.table.order(), [x](int k) -> const Pose<double>& { return x[k].H; });
    for (int i = 0; i < shared.table.points; ++i)
      S[i] = D_at(shared, data, i) * strain(data, i, Point<double>(shared.table, data, i, node));
  }

 private:
  template <class S>
  static S margin(const Work<S>& work) {
    static const double limit = std::cos(0.5 * ClassicalRange::max_angle);
    const S by_angle = work.node.closest - S(limit),
            by_n = work.smallest_n - S(ClassicalRange::min_n);
    return by_n < by_angle ? by_n : by_angle;
  }

  static std::size_t at(int i, int k) { return static_cast<std::size_t>(i * Z::max_nodes + k); }

  template <class S>
  static Vector6<S> strain(const Data& data, int i, const Point<S>& point) {
    return point.K() - data.K0[static_cast<std::size_t>(i)].template cast<S>();
  }

  // (5) of point i, inertial, into f and y of the nodes.
  template <class S>
  MBD_INLINE static void add_forces(const Table<N>& table, const Data& data, int i,
                                    const Vector6<S>& force, Work<S>& work,
                                    std::array<Vector3<S>, Z::max_nodes>& f) {
    const auto I = static_cast<std::size_t>(i);
    const Point<S>& at_i = work.point[I];
    const Vector3<S> n = linear(force), m = angular(force);
    const Matrix43<S> av = product_of<S>(at_i.a) * (S(1) / at_i.n);
    const S inverse_J = S(data.inverse_J[I]);
    const Vector3<S> g_v = S(2) * (n.cross(at_i.t) - at_i.b0 * m) - at_i.k.cross(m);
    const Vector4<S> g_a = av * g_v - (m.dot(at_i.k) / at_i.n) * at_i.a;
    const Vector4<S> g_b = (S(2) * inverse_J) * (av * m);
    const Vector3<S> g_c = inverse_J * (at_i.R * n);
    for (int k = 0; k <= table.order(); ++k) {
      const auto K = static_cast<std::size_t>(k);
      const S l = S(table.l[at(i, k)]), dl = S(table.dl[at(i, k)]);
      f[K] += dl * g_c;
      work.y[K] += l * g_a + dl * g_b;
    }
  }

  // Not inlined, so that the residual is the same machine code, and the same to the last bit, with and
  // without the tangent.
  template <class S>
  [[gnu::noinline, gnu::flatten]] static void residual(const Shared& shared, const Data& data,
                                                       const NodeState<S>* x, Work<S>& work,
                                                       Output<S>& out) {
    const Table<N>& table = shared.table;
    const int order = table.order();
    Nodes<S>& node = work.node;
    node.set(order, [x](int k) -> const Pose<S>& { return x[k].H; });
    work.smallest_n = S(1);
    std::array<Vector3<S>, Z::max_nodes> f;
    for (int m = 0; m <= order; ++m) {
      f[static_cast<std::size_t>(m)].setZero();
      work.y[static_cast<std::size_t>(m)].setZero();
    }
    for (int i = 0; i < table.points; ++i) {
      const auto I = static_cast<std::size_t>(i);
      work.point[I].set(table, data, i, node);
      const Point<S>& at_i = work.point[I];
      work.smallest_n = at_i.n < work.smallest_n ? at_i.n : work.smallest_n;
      const Vector6<S> force =
          S(data.wJ[I]) * times<S>(D_at(shared, data, i).template cast<S>(), strain(data, i, at_i));
      work.force[I] = force;
      add_forces(table, data, i, force, work, f);
    }
    set_node_forces(order, work, f, out);
  }

  // (7)
  template <class S>
  MBD_INLINE static void set_node_forces(int order, const Work<S>& work,
                                         const std::array<Vector3<S>, Z::max_nodes>& f,
                                         Output<S>& out) {
    const Nodes<S>& node = work.node;
    out.r.resize(6 * (order + 1));
    for (int k = 0; k <= order; ++k) {
      const auto K = static_cast<std::size_t>(k);
      rows_at<3>(out.r, 6 * k).noalias() = node.R[K].transpose() * f[K];
      rows_at<3>(out.r, 6 * k + 3).noalias() =
          S(0.5) * (product_of<S>(node.p[K]).transpose() * work.y[K]);
    }
  }

  // What is left of a residual for other forces S_i at its points: the nodal forces and y of a tangent.
  template <class S>
  static void set_forces(const Shared& shared, const Data& data, const Vector6<S>* given,
                         Work<S>& work, Output<S>& out) {
    const int order = shared.table.order();
    std::array<Vector3<S>, Z::max_nodes> f;
    for (int m = 0; m <= order; ++m) {
      f[static_cast<std::size_t>(m)].setZero();
      work.y[static_cast<std::size_t>(m)].setZero();
    }
    for (int i = 0; i < shared.table.points; ++i) {
      const auto I = static_cast<std::size_t>(i);
      work.force[I] = S(data.wJ[I]) * given[i];
      add_forces(shared.table, data, i, work.force[I], work, f);
    }
    set_node_forces(order, work, f, out);
  }

  // h of (6) for one point, inertial components: symmetric, without the blocks that are zero.
  template <class S>
  struct Curvature {
    Matrix4<S> aa, ab, bb;
    Matrix43<S> ac, bc;
    Matrix3<S> cc;
  };

  template <class S>
  MBD_INLINE static Curvature<S> second_derivative(const Point<S>& point, const Matrix6<S>& D,
                                                   const Vector6<S>& force) {
    const Vector3<S> n = linear(force), m = angular(force);
    const Vector3<S>& t = point.t;
    const Vector3<S>& k = point.k;
    const S two = S(2), b0 = point.b0;
    const Matrix3<S> Dn = D.template topLeftCorner<3, 3>(), C = D.template topRightCorner<3, 3>(),
                     Dm = D.template bottomRightCorner<3, 3>();
    // L of a0 and av: dt and dk of (3), (4)
    const Matrix3<S> dt = two * hat(t);
    Matrix3<S> dk = hat(k);
    dk.diagonal().array() -= two * b0;
    // rows of D L: forces on t and k per a0 and av
    const Vector3<S> n0 = -(C * k), m0 = -(Dm * k);
    const Matrix3<S> nv = Dn.lazyProduct(dt) + C.lazyProduct(dk),
                     mv = C.transpose().lazyProduct(dt) + Dm.lazyProduct(dk);
    const S mk = m.dot(k);
    Matrix4<S> aa;
    aa(0, 0) = two * mk - k.dot(m0);
    const Vector3<S> a0v = two * (t.cross(n) + k.cross(m)) + (S(4) * b0) * m - mv.transpose() * k;
    aa.template block<1, 3>(0, 1) = a0v.transpose();
    aa.template block<3, 1>(1, 0) = a0v;
    Matrix3<S> vv = dt.transpose().lazyProduct(nv) + dk.transpose().lazyProduct(mv) +
                    two * (n * t.transpose() + t * n.transpose());
    vv.diagonal().array() -= S(4) * n.dot(t) + two * mk;
    aa.template block<3, 3>(1, 1) = vv;

    Matrix4<S> ab;
    ab(0, 0) = S(0);
    ab.template block<1, 3>(0, 1) = two * (m0 - m).transpose();
    ab.template block<3, 1>(1, 0) = -two * m;
    ab.template block<3, 3>(1, 1) = two * (mv.transpose() + hat(m));

    Matrix43<S> ac;
    ac.row(0) = n0.transpose();
    ac.template bottomRows<3>() = nv.transpose() + two * hat(n);

    // alpha = X^T da with X y = a y/n, and R
    Matrix4<S> X;
    const S inverse_n = S(1) / point.n;
    X.col(0) = inverse_n * point.a;
    X.template rightCols<3>() = inverse_n * product_of<S>(point.a);
    const Matrix43<S> Xv = X.template rightCols<3>();
    const Matrix3<S> Rt = point.R.transpose();
    Curvature<S> h;
    h.aa = X.lazyProduct(aa).eval().lazyProduct(X.transpose());
    h.ab = X.lazyProduct(ab).eval().lazyProduct(X.transpose());
    h.bb = Xv.lazyProduct(S(4) * Dm).eval().lazyProduct(Xv.transpose());
    h.ac = X.lazyProduct(ac).eval().lazyProduct(Rt);
    h.bc = Xv.lazyProduct(two * C.transpose()).eval().lazyProduct(Rt);
    h.cc = point.R.lazyProduct(Dn).eval().lazyProduct(Rt);
    return h;
  }

  // The part of (8) that forces make where they act: on their own axes, which turn.
  template <class S>
  static void add_turning_of_forces(const Work<S>& work, int order, Output<S>& out) {
    for (int k = 0; k <= order; ++k) {
      const auto K = static_cast<std::size_t>(k);
      const Vector3<S> n = rows_at<3>(out.r, 6 * k), m = rows_at<3>(out.r, 6 * k + 3);
      block_at<3, 3>(out.K, 6 * k, 6 * k + 3) += hat(n);
      block_at<3, 3>(out.K, 6 * k + 3, 6 * k + 3) += S(0.5) * hat(m);
      out.K.diagonal().template segment<3>(6 * k + 3).array() -=
          S(0.25) * work.node.p[K].dot(work.y[K]);
    }
  }

  // Of a point, with 1/J of l'/J taken in once for all nodes.
  template <class S>
  static Curvature<S> scaled_derivative(const Shared& shared, const Data& data, const Work<S>& work,
                                        int i) {
    const auto I = static_cast<std::size_t>(i);
    const Matrix6<S> D = S(data.wJ[I]) * D_at(shared, data, i).template cast<S>();
    Curvature<S> h = second_derivative(work.point[I], D, work.force[I]);
    const S inverse_J = S(data.inverse_J[I]), square = inverse_J * inverse_J;
    h.ab *= inverse_J;
    h.ac *= inverse_J;
    h.bb *= square;
    h.bc *= square;
    h.cc *= square;
    return h;
  }

  // (8)
  template <class S>
  [[gnu::noinline, gnu::flatten]] static void tangent(const Shared& shared, const Data& data,
                                                      const Work<S>& work, Output<S>& out) {
    const Table<N>& table = shared.table;
    const int order = table.order();
    const Nodes<S>& node = work.node;
    std::array<Matrix43<S>, Z::max_nodes> Q;
    // Of a column k: sum_i of l_j h_a + (l'_j/J) h_b, and of (l'_j/J) h_c.
    std::array<Matrix<S, 4, 6>, Z::max_nodes> turn;
    std::array<Matrix<S, 3, 6>, Z::max_nodes> move;
    std::array<Curvature<S>, Z::max_points> h;
    for (int k = 0; k <= order; ++k) {
      const auto K = static_cast<std::size_t>(k);
      Q[K] = S(0.5) * product_of<S>(node.p[K]);
    }
    for (int i = 0; i < table.points; ++i)
      h[static_cast<std::size_t>(i)] = scaled_derivative(shared, data, work, i);
    out.K.resize(6 * (order + 1), 6 * (order + 1));
    for (int k = 0; k <= order; ++k) {
      const auto K = static_cast<std::size_t>(k);
      for (int j = 0; j <= k; ++j) {
        turn[static_cast<std::size_t>(j)].setZero();
        move[static_cast<std::size_t>(j)].setZero();
      }
      for (int i = 0; i < table.points; ++i) {
        const Curvature<S>& hi = h[static_cast<std::size_t>(i)];
        const S l = S(table.l[at(i, k)]), dl = S(table.dl[at(i, k)]);
        Matrix<S, 4, 6> a, b;  // h P of node k
        Matrix<S, 3, 6> c;
        a.template leftCols<3>() = (dl * hi.ac).lazyProduct(node.R[K]);
        a.template rightCols<3>() = (l * hi.aa + dl * hi.ab).eval().lazyProduct(Q[K]);
        b.template leftCols<3>() = (dl * hi.bc).lazyProduct(node.R[K]);
        b.template rightCols<3>() = (l * hi.ab.transpose() + dl * hi.bb).eval().lazyProduct(Q[K]);
        c.template leftCols<3>() = (dl * hi.cc).lazyProduct(node.R[K]);
        c.template rightCols<3>() = (l * hi.ac + dl * hi.bc).transpose().eval().lazyProduct(Q[K]);
        for (int j = 0; j <= k; ++j) {
          const auto J = static_cast<std::size_t>(j);
          const S lj = S(table.l[at(i, j)]), dlj = S(table.dl[at(i, j)]);
          turn[J] += lj * a + dlj * b;
          move[J] += dlj * c;
        }
      }
      for (int j = 0; j <= k; ++j) {
        const auto J = static_cast<std::size_t>(j);
        Matrix6<S> block;
        block.template topRows<3>().noalias() = node.R[J].transpose().lazyProduct(move[J]);
        block.template bottomRows<3>().noalias() = Q[J].transpose().lazyProduct(turn[J]);
        block_at<6, 6>(out.K, 6 * j, 6 * k) = block;
        if (j < k) block_at<6, 6>(out.K, 6 * k, 6 * j) = block.transpose();
      }
    }
    add_turning_of_forces(work, order, out);
  }
};

}  // namespace mbd::beam
