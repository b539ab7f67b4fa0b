// Relative motion parameters q(g), g = H_j^-1 H_k = (R, r), of the three metrics, scaled so that
// T^-1(0) = I (NOTATION.md 2; HB 5-9), and what a function of them needs for force and tangent.
//
// Symbols: z = [u; psi] body-frame increment of g (g <- g exp(z)); W = [n; m] a wrench conjugate to q.
//   dq = T^-1(q) z,   z = U_k - Ad(g^-1) U_j,   T^-1(q) Ad(g^-1) = T^-1(-q) = A^T + eps B^T        (1)
//   a pair with potential phi(q), W = dphi/dq, pushes with   F_k = T^-1(q)^T W,  F_j = -T^-1(-q)^T W  (2)
//   Lin = d(T^-1(q)^T W)/dz at fixed W = [ 0 Lp(n) ; Lp(n) Ld(n) + Lp(m) ]                          (3)
//         with Lp(x) = d(A^T x)/dpsi and Ld its dual part
// Each metric is a struct with a nested Pair<S>, made of g, that has
//   q(), T_inverse(), forces(W), e0 = cos(angle/2), and linearize(T, n, m, P, Q), which
//   makes the blocks of (3), P = Lp(n) and Q = Ld(n) + Lp(m), given T = T_inverse().
//
// Validity: T^-1 of the matrix metric is singular at a relative angle of pi/2, of the others at pi; all
// are refused beyond 0.9 of that.
#pragma once

#include "libmbd/core/choices.hpp"
#include "libmbd/core/se3.hpp"

namespace mbd {

// Equation (2): force and moment on k, and minus those on j. Three-vectors, because joining two of them
// and reading the six at once waits for the stores.
template <class S>
struct PairForces {
  Vector3<S> force_k, moment_k, minus_force_j, minus_moment_j;

  Vector6<S> on_k() const { return six(force_k, moment_k); }
  Vector6<S> minus_on_j() const { return six(minus_force_j, minus_moment_j); }
};

// matrix: q = [ (tr R I - R) r / 2 ; axial R ];  A = (tr R I - R^T)/2, B = (tr X I - X^T)/2, X = r~R.
struct MatrixMetric {
  static constexpr const char* name = "matrix";
  static constexpr double max_angle = 0.9 * 0.5 * std::numbers::pi;  // [rad]

  template <class S>
  struct Pair {
    S e0;
    Matrix3<S> R, X;
    S trR, trX;
    Vector3<S> r;

    Pair() = default;
    MBD_INLINE explicit Pair(const Pose<S>& g)
        : e0(sign_of(S(g.p.w())) * g.p.w()),
          R(g.R()),
          X(hat(g.r) * R),
          trR(R.trace()),
          trX(X.trace()),
          r(g.r) {}

    MBD_INLINE Vector6<S> q() const { return six<S>(S(0.5) * (trR * r - R * r), axial(R)); }

    MBD_INLINE DualMatrix<S> T_inverse() const {
      DualMatrix<S> T{S(-0.5) * R.transpose(), S(-0.5) * X.transpose()};
      T.A.diagonal().array() += S(0.5) * trR;
      T.B.diagonal().array() += S(0.5) * trX;
      return T;
    }
    MBD_INLINE PairForces<S> forces(const Vector6<S>& W) const {
      const Vector3<S> n = linear(W), m = angular(W);
      return {S(0.5) * (trR * n - R * n), S(0.5) * (trX * n - X * n + trR * m - R * m),
              S(0.5) * (trR * n - R.transpose() * n),
              S(0.5) * (trX * n - X.transpose() * n + trR * m - R.transpose() * m)};
    }
    // A^T x = (tr R x - R x)/2 with dR = R psi~, d tr R = -2 axial(R).psi; dX likewise.
    MBD_INLINE void linearize(const DualMatrix<S>&, const Vector3<S>& n, const Vector3<S>& m,
                              Matrix3<S>& P, Matrix3<S>& Q) const {
      const Vector3<S> a = axial(R);
      const Matrix3<S> N = hat(n), M = hat(m);
      P = S(0.5) * R.lazyProduct(N) - n * a.transpose();
      Q = S(0.5) * (X.lazyProduct(N) + R.lazyProduct(M)) - n * axial(X).transpose() -
          m * a.transpose();
    }
  };
};

// quaternion: q = 2 [ ed ; e ] with the dual quaternion (e0 + eps e0d, e + eps ed), ed = (e0 r + r x e)/2,
// e0d = -r.e/2;  T^-1 = e0 I + e~, dual throughout.
struct QuaternionMetric {
  static constexpr const char* name = "quaternion";
  static constexpr double max_angle = 0.9 * std::numbers::pi;

  template <class S>
  struct Pair {
    S e0, e0d;
    Vector3<S> e, ed;

    Pair() = default;
    MBD_INLINE explicit Pair(const Pose<S>& g) {
      const S sign = sign_of(S(g.p.w()));
      e0 = sign * g.p.w();
      e = Vector3<S>(sign * g.p.x(), sign * g.p.y(), sign * g.p.z());
      e0d = S(-0.5) * g.r.dot(e);
      ed = S(0.5) * (e0 * g.r + g.r.cross(e));
    }
    MBD_INLINE Vector6<S> q() const { return six<S>(S(2) * ed, S(2) * e); }

    MBD_INLINE DualMatrix<S> T_inverse() const {
      DualMatrix<S> T{hat(e), hat(ed)};
      T.A.diagonal().array() += e0;
      T.B.diagonal().array() += e0d;
      return T;
    }
    MBD_INLINE PairForces<S> forces(const Vector6<S>& W) const {
      const Vector3<S> n = linear(W), m = angular(W);
      const Vector3<S> sn = e0 * n, cn = e.cross(n);
      const Vector3<S> sm = e0d * n + e0 * m, cm = ed.cross(n) + e.cross(m);
      return {sn - cn, sm - cm, sn + cn, sm + cm};
    }
    // d(e0 x - e x x): de0 = -e.psi/2, de = (e0 psi + e x psi)/2
    MBD_INLINE void linearize(const DualMatrix<S>&, const Vector3<S>& n, const Vector3<S>& m,
                              Matrix3<S>& P, Matrix3<S>& Q) const {
      P = S(0.5) * (e0 * hat(n) + product(n, e));
      Q = S(0.5) * (e0d * hat(n) + product(n, ed) + e0 * hat(m) + product(m, e));
    }

   private:
    // x~ a~ - x a^T = a x^T - (a.x) I - x a^T
    static Matrix3<S> product(const Vector3<S>& x, const Vector3<S>& a) {
      Matrix3<S> m = a * x.transpose() - x * a.transpose();
      m.diagonal().array() -= a.dot(x);
      return m;
    }
  };
};

// geodesic: q = log g = [ rho ; theta ];  T^-1 = I + q~/2 + a2 q~q~, dual throughout.
struct GeodesicMetric {
  static constexpr const char* name = "geodesic";
  static constexpr double max_angle = 0.9 * std::numbers::pi;

  template <class S>
  struct Pair {
    S e0;
    Vector3<S> theta, rho;
    A2<S> k;
    S tr;  // theta . rho

    Pair() = default;
    MBD_INLINE explicit Pair(const Pose<S>& g)
        : e0(sign_of(S(g.p.w())) * g.p.w()),
          theta(log_so3(g.p)),
          k(a2_coefficients(S(theta.squaredNorm()))) {
      const Vector3<S> c = theta.cross(g.r);
      rho = g.r - S(0.5) * c + k.a * theta.cross(c);
      tr = theta.dot(rho);
    }
    MBD_INLINE Vector6<S> q() const { return six<S>(rho, theta); }

    MBD_INLINE DualMatrix<S> T_inverse() const {
      const Matrix3<S> P = hat(theta), L = hat(rho);
      const Matrix3<S> PP = P * P;
      return {Matrix3<S>::Identity() + S(0.5) * P + k.a * PP,
              S(0.5) * L + k.a * (L * P + P * L) + (S(2) * k.da * tr) * PP};
    }
    MBD_INLINE PairForces<S> forces(const Vector6<S>& W) const {
      const Vector3<S> n = linear(W), m = angular(W);
      const Vector3<S> tn = theta.cross(n), tm = theta.cross(m), rn = rho.cross(n);
      const Vector3<S> ttn = theta.cross(tn);
      const Vector3<S> even = n + k.a * ttn;
      const Vector3<S> even_d =
          m + k.a * (theta.cross(tm + rn) + rho.cross(tn)) + (S(2) * k.da * tr) * ttn;
      const Vector3<S> odd = S(0.5) * tn, odd_d = S(0.5) * (rn + tm);
      return {even - odd, even_d - odd_d, even + odd, even_d + odd_d};
    }
    // A^T x = x - theta x x/2 + a2 theta x (theta x x), d theta = A psi: Lp(x) = M(x) A, and the same
    // with dual parts, Ld(x) = Md(x) A + M(x) B.
    MBD_INLINE void linearize(const DualMatrix<S>& T, const Vector3<S>& n, const Vector3<S>& m,
                              Matrix3<S>& P, Matrix3<S>& Q) const {
      const Matrix3<S> Mn = M(n);
      const Matrix3<S> sum = Md(n) + M(m);
      P = Mn.lazyProduct(T.A);
      Q = sum.lazyProduct(T.A) + Mn.lazyProduct(T.B);
    }

   private:
    static Matrix3<S> cubic(const Vector3<S>& a, const Vector3<S>& x) {  // d(a x (a x x))/da
      Matrix3<S> m = a * x.transpose() - S(2) * (x * a.transpose());
      m.diagonal().array() += a.dot(x);
      return m;
    }
    Matrix3<S> M(const Vector3<S>& x) const {
      const Vector3<S> ttx = theta.cross(theta.cross(x));
      return S(0.5) * hat(x) + k.a * cubic(theta, x) + (S(2) * k.da) * (ttx * theta.transpose());
    }
    Matrix3<S> Md(const Vector3<S>& x) const {
      const Vector3<S> tx = theta.cross(x);
      const Vector3<S> ttx = theta.cross(tx);
      const Vector3<S> dttx = rho.cross(tx) + theta.cross(rho.cross(x));
      const S a_d = S(2) * k.da * tr, da_d = S(2) * k.dda * tr;
      return k.a * cubic(rho, x) + a_d * cubic(theta, x) +
             S(2) *
                 ((da_d * ttx + k.da * dttx) * theta.transpose() + k.da * (ttx * rho.transpose()));
    }
  };
};

// Lin of equation (3), given T = pair.T_inverse().
template <class P, class S>
MBD_INLINE Matrix6<S> linearized_force(const P& pair, const DualMatrix<S>& T, const Vector6<S>& W) {
  Matrix3<S> p, q;
  pair.linearize(T, linear(W), angular(W), p, q);
  Matrix6<S> L;
  L.template topLeftCorner<3, 3>().setZero();
  L.template topRightCorner<3, 3>() = p;
  L.template bottomLeftCorner<3, 3>() = p;
  L.template bottomRightCorner<3, 3>() = q;
  return L;
}
template <class P, class S>
Matrix6<S> linearized_force(const P& pair, const Vector6<S>& W) {
  return linearized_force(pair, pair.T_inverse(), W);
}

// Tangent of a pair of nodes j, k acted on through their relative motion. With f the wrench on k,
// -Ad(g^-1)^T f the one on j, and L = df/dz (all of it):
//   dF_k = L (U_k - Ad U_j),   dF_j = -Ad^T (L - f^U) (U_k - Ad U_j),   Ad = Ad(g^-1)            (4)
// L has the shape [ 0 a ; b c ] for every pair of a beam and every joint: forces depend on where, not on
// how far. With Ad = R^T + eps X the products keep to 3x3 blocks.
template <class S>
struct PairTangent {
  Matrix6<S> kk, kj, jk, jj;
};
template <class S>
MBD_INLINE PairTangent<S> pair_tangent(const Pose<S>& g, const Vector6<S>& f, const Matrix6<S>& L) {
  const DualMatrix<S> Ad = adjoint_inverse(g);
  const Matrix3<S> a = L.template topRightCorner<3, 3>(), b = L.template bottomLeftCorner<3, 3>(),
                   c = L.template bottomRightCorner<3, 3>();
  const Matrix3<S> n = hat(linear(f));
  const Matrix3<S> a1 = a - n, b1 = b - n, c1 = c - hat(angular(f));
  const Matrix3<S> Rt = Ad.A, X = Ad.B;
  const Matrix3<S> R = Rt.transpose(), Xt = X.transpose();
  PairTangent<S> t;
  t.kk = L;
  // -[ 0 a ; b c ] [ Rt X ; 0 Rt ]
  t.kj.template topLeftCorner<3, 3>().setZero();
  t.kj.template topRightCorner<3, 3>().noalias() = -(a.lazyProduct(Rt));
  t.kj.template bottomLeftCorner<3, 3>().noalias() = -(b.lazyProduct(Rt));
  t.kj.template bottomRightCorner<3, 3>().noalias() = -(b.lazyProduct(X) + c.lazyProduct(Rt));
  // -[ R 0 ; Xt R ] [ 0 a1 ; b1 c1 ]
  const Matrix3<S> jk12 = -(R.lazyProduct(a1)), jk21 = -(R.lazyProduct(b1)),
                   jk22 = -(Xt.lazyProduct(a1) + R.lazyProduct(c1));
  t.jk.template topLeftCorner<3, 3>().setZero();
  t.jk.template topRightCorner<3, 3>() = jk12;
  t.jk.template bottomLeftCorner<3, 3>() = jk21;
  t.jk.template bottomRightCorner<3, 3>() = jk22;
  // -jk [ Rt X ; 0 Rt ]
  t.jj.template topLeftCorner<3, 3>().setZero();
  t.jj.template topRightCorner<3, 3>().noalias() = -(jk12.lazyProduct(Rt));
  t.jj.template bottomLeftCorner<3, 3>().noalias() = -(jk21.lazyProduct(Rt));
  t.jj.template bottomRightCorner<3, 3>().noalias() = -(jk21.lazyProduct(X) + jk22.lazyProduct(Rt));
  return t;
}

}  // namespace mbd
