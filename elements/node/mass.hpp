// Inertia of what moves with a node: M the 6x6 mass matrix in the node's frame.
//
// Beams are integrated on their GLL points (NOTATION.md 3: with the N Gauss points a free bar has a
// singular mass matrix), so the inertia of a beam is a mass at each node, M_a = w_a J_a M, or where M varies the
// integral of M times the polynomial of the node (SectionTable::masses); a rigid body
// is a mass at its node too, M = Ad^T M_c Ad. One kernel serves both, and all that shares a node is
// added up once, at compile.
//
//   r = M Vdot - V~^T M V       dr/dVdot = M,   dr/dV = -( V~^T M + (M V)^U )                      (1)
//   kinetic energy 1/2 V^T M V; HB 39-40. Depends on no pose: body-frame variables.
// A stepper that balances momenta instead (generalized_alpha.hpp) sets State::momentum_rate = c and adds
// what the past contributes itself:
//   r = c M V,   dr/dV = c M                                                                        (2)
// A fluid at rest that moves with a node adds its M_a, any symmetric matrix, to M: (1) are Kirchhoff's equations then
// (Lamb, Hydrodynamics, 6th ed., 124), their moment v x (M_a v) among them (Munk's). Its weight is not in gravity.
//
// Variants. Without the gyroscopic moment of J, the inertia about the mass centre of all masses of the node (the fluid
// is left as it is):
//   r without w x J w in its moment,   dr/dV without w~ J - (J w)~                                  (3)
// Translation, the static moment and J dw/dt, in body axes, stay as they are. J of a sphere has no such moment; any
// other J then moves by J dw/dt = moment: a free body keeps w in its own axes instead of its angular momentum in
// inertial ones. Energy is kept, as w . (w x J w) = 0. It has no form (2): the balance of momenta is that of (1).
// There is none without J at all: rotations of nodes would be algebraic, and their initial accelerations not
// determined by mass and constraints (solvers/time/stepper.hpp).
//
// Not used: consistent mass with N + 1 Gauss points; it couples nodes in the tangent, and body-frame
// velocities interpolated between nodes do not conserve momentum exactly. GLL sums do.
#pragma once

#include "elements/element.hpp"
#include "libmbd/core/batch.hpp"

namespace mbd {

namespace inertia {

template <class Real>
struct FullOf {
  Matrix6<Real> M;  // [kg, kg.m, kg.m2], node frame
};
template <class Real>
struct NoGyroscopicOf {
  Matrix6<Real> M;  // as of FullOf
  Matrix3<Real> J;  // of all masses of the node, about their centre, node axes  [kg.m2]
};
using Full = FullOf<double>;
using NoGyroscopic = NoGyroscopicOf<double>;

}  // namespace inertia

template <bool gyroscopic>
struct Inertia {
  static constexpr const char* name = gyroscopic ? "inertia" : "inertia without gyroscopic moments";
  static constexpr int nodes = 1;
  static constexpr bool has_K = false;
  static constexpr bool has_D = true;
  static constexpr bool needs_rates = true;

  struct Shared {};
  using Data = std::conditional_t<gyroscopic, inertia::Full, inertia::NoGyroscopic>;
  template <class S>
  using Output = ElementOutput<S, 1>;

  static int node_count(const Shared&) { return 1; }

  static constexpr bool has_packs = true;
  struct Packed {
    using Shared = Inertia::Shared;
    using Data =
        std::conditional_t<gyroscopic, inertia::FullOf<Pack>, inertia::NoGyroscopicOf<Pack>>;
    template <class S>
    using Output = Inertia::Output<S>;
    template <Want>
    static Pack evaluate(const Shared&, const Data& data, const NodeState<Pack>* x,
                         const Environment& env, RateWeights, Output<Pack>& out) {
      Vector6<Pack> p;
      residual(data, x[0], env.momentum_rate, p, out);
      return Pack(1.0);
    }
  };
  static PackedElements<Inertia> packed(const Shared&, const std::vector<Data>& elements) {
    PackedElements<Inertia> result;
    each_pack(0, elements.size(), [&](const PackOf& pack) {
      typename Packed::Data data;
      pack_into(data.M, [&](int k) { return elements[pack[k]].M.data(); });
      if constexpr (!gyroscopic)
        pack_into(data.J, [&](int k) { return elements[pack[k]].J.data(); });
      result.data.push_back(data);
    });
    return result;
  }

  template <Want want, class S>
  static S evaluate(const Shared&, const Data& data, const NodeState<S>* x, const Environment& env,
                    RateWeights w, Output<S>& out) {
    Vector6<S> p;
    residual(data, x[0], env.momentum_rate, p, out);
    if constexpr (want == Want::tangent) {
      const Matrix6<S> M = data.M.template cast<S>();
      if (env.momentum_rate != 0.0) {
        out.D = S(w.V * env.momentum_rate) * M;
        return S(1);
      }
      const Matrix6<S> G = twist_hat(x[0].V).transpose().lazyProduct(M) + wrench_hat(p);
      out.D = S(w.A) * M - S(w.V) * G;
      if constexpr (!gyroscopic) {
        const Matrix3<S> J = data.J.template cast<S>();
        const Vector3<S> omega = angular(x[0].V);
        out.D.template bottomRightCorner<3, 3>() -=
            S(w.V) * (hat(omega).lazyProduct(J) - hat(Vector3<S>(J * omega)));
      }
    }
    return S(1);
  }

  static Energies energies(const Shared&, const Data& data, const NodeState<double>* x,
                           const Environment&) {
    const Vec6 p = data.M * x[0].V;
    return {.kinetic = 0.5 * x[0].V.dot(p), .strain = 0.0, .potential = 0.0};
  }

  // M V, node frame [N.s, N.m.s].
  static Vec6 momentum(const Shared&, const Data& data, const NodeState<double>* x) {
    return data.M * x[0].V;
  }

 private:
  // Not inlined: the same to the last bit with and without the tangent. All it calls is, which a compiler
  // does not promise by itself (tools/instructions saw it stop when a variant of this kernel was added).
  template <class Constants, class S>
  [[gnu::noinline, gnu::flatten]] static void residual(const Constants& data, const NodeState<S>& x,
                                                       double rate, Vector6<S>& p, Output<S>& out) {
    const Matrix6<S> M = data.M.template cast<S>();
    p = times<S>(M, x.V);
    if (rate != 0.0)
      out.r = S(rate) * p;
    else
      out.r = times<S>(M, x.Vdot) - twist_hat_transpose_times(x.V, p);
    if constexpr (!gyroscopic) {
      const Vector3<S> omega = angular(x.V);
      out.r.template tail<3>() -= omega.cross(Vector3<S>(data.J.template cast<S>() * omega));
    }
  }
};

using Mass = Inertia<true>;
using MassNoGyroscopic = Inertia<false>;

// Inertia about the mass centre, of a mass matrix [ m I, -m c~ ; m c~, J - m c~ c~ ]; of no mass, that about the
// reference point.
inline Mat3 central_inertia(const Mat6& M) {
  const double m = M(0, 0);
  const Mat3 mC = M.bottomLeftCorner<3, 3>(), J = M.bottomRightCorner<3, 3>();
  return m > 0.0 ? Mat3(J + mC * mC / m) : J;
}

// Mass matrix about a reference point of a body of mass m, mass centre c and inertia J about it
// (all in the reference frame): [ m I, -m c~ ; m c~, J - m c~ c~ ].
inline Mat6 rigid_mass(double m, const Vec3& c, const Mat3& J) {
  const Mat3 C = hat(c);
  Mat6 M;
  M << m * Mat3::Identity(), -m * C, m * C, J - m * C * C;
  return M;
}

// The mass matrix seen from a frame in which the body's own frame is at H: Ad(H^-1)^T M Ad(H^-1).
inline Mat6 transformed_mass(const Mat6& M, const Pose<double>& H) {
  const Mat6 Ad = adjoint_inverse(H).matrix();
  return Ad.transpose() * M * Ad;
}

}  // namespace mbd
