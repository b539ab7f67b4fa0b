// Quadratic drag of a fluid on a node.
//
// u is the velocity of what is dragged against the fluid, node axes; U the velocity of the fluid far away,
// inertial axes. On a beam, per length (the independence principle: what flows along a cylinder does not
// change the force across it; Morison et al. 1950; Hoerner, Fluid-Dynamic Drag, 1965, 3-11):
//
//   u = v - R^T U,  u_t = e1 . u,  u_n = u - u_t e1
//   f = -( a_n |u_n| u_n + a_t |u_t| u_t e1 ),  a_n = 1/2 rho C_n d,  a_t = 1/2 rho C_t pi d           (1)
//   r = w [ g(u) ; 0 ],  g = -f,   G = dg/du = a_n ( |u_n| P + u_n u_n^T / |u_n| ) + 2 a_t |u_t| e1 e1^T,
//   P = I - e1 e1^T;   du = dv - (R^T U)~ psi                                                           (2)
// On a body, with the same coefficient in all directions, at c:
//
//   u = v + w x c - R^T U,   g = b |u| u,   b = 1/2 rho C A,   r = [ g ; c x g ]                        (3)
//   G = b ( |u| I + u u^T / |u| ),   du = dv - c~ dw - (R^T U)~ psi                                     (4)
// At u = 0 the force is 0 and so is G, its limit: (1) and (3) are once continuously differentiable.
//
// Symbols: v, w linear and angular velocity of the node, node axes [m/s, rad/s], e1 the first of them (b1, along
// the beam), rho density of the fluid [kg/m3], d diameter [m], A area [m2], C_n C_t C coefficients [-], w_a
// length that the node stands for [m], psi rotation increment, node axes.
//
// The force is multiplied by the load factor: in load steps and along paths, where nothing moves, a flow is a
// load like others. It is 1 in transients.
// Power: f . v of the force on what it acts on, in damping_power. In still fluid it is never positive. In a flow it
// may be: there a part of it, f . R^T U, is what the flow delivers.
// A flow has no potential; nor has any drag.
//
// On a rigid beam, whose points have all one node: at c, in axes turned by R_f, u and g of (1) are R_f^T (v + w x c - R^T U)
// and R_f g, and the rest is as in (3) and (4) with R_f G R_f^T.
//
// Still fluid has a kernel of its own: no pose, no K, no signals. Not used: a coefficient that depends on the
// Reynolds number (coefficients are constants; make one run each); lift and vortices; a drag of bodies with
// six coefficients, about whose axes sources do not agree; a limit |u| + eps in the derivative, which
// has one without.
#pragma once

#include <array>

#include "elements/element.hpp"
#include "libmbd/core/batch.hpp"

namespace mbd {

namespace drag {

// Velocity of the fluid: places of its components in State::signals, -1 for zero. Nothing in still fluid.
struct Flow {
  std::array<int, 3> signals{-1, -1, -1};  // inertial axes [m/s]

  Vec3 velocity(const Environment& env) const {
    const auto component = [&](int i) {
      return i < 0 ? 0.0 : env.signals[static_cast<std::size_t>(i)].f;
    };
    return {component(signals[0]), component(signals[1]), component(signals[2])};
  }
};
struct NoFlow {};

// Of a section, in its node's.
struct Frame {
  Mat3 R;  // R_f, columns: axes of the section in node axes
  Vec3 c;  // node axes [m]
};
struct NoFrame {};

template <bool flowing>
using FlowOf = std::conditional_t<flowing, Flow, NoFlow>;
template <bool placed>
using FrameOf = std::conditional_t<placed, Frame, NoFrame>;

// R^T U.
template <class S>
Vector3<S> seen(const Flow& flow, const Pose<S>& H, const Environment& env) {
  return H.p.conjugate() * Vector3<S>(flow.velocity(env).template cast<S>());
}

template <class S>
S speed(const Vector3<S>& u) {
  using std::sqrt;
  const S square = u.squaredNorm();
  return square > S(0) ? sqrt(square) : S(0);  // of a dual number, the limit of |u| u
}

// |u| I + u u^T / |u|
template <class S>
Matrix3<S> slope(const Vector3<S>& u, const S& speed) {
  if (!(speed > S(0))) return Matrix3<S>::Zero();
  return speed * Matrix3<S>::Identity() + (u / speed) * u.transpose();
}

}  // namespace drag

// (1)
template <bool flowing, bool placed = false>
struct LineDrag {
  static constexpr const char* name =
      placed ? (flowing ? "drag of rigid beams in a flow" : "drag of rigid beams")
             : (flowing ? "drag of beams in a flow" : "drag of beams");
  static constexpr int nodes = 1;
  static constexpr bool has_K = flowing;
  static constexpr bool has_D = true;
  static constexpr bool needs_rates = true;
  static constexpr bool scales_with_load = true;

  struct Shared {};
  struct Data {
    double across;  // w_a a_n                              [kg/m]
    double along;   // w_a a_t                              [kg/m]
    [[no_unique_address]] drag::FlowOf<flowing> flow;
    [[no_unique_address]] drag::FrameOf<placed> frame;
  };
  template <class S>
  using Output = ElementOutput<S, 1>;

  static int node_count(const Shared&) { return 1; }

  template <Want want, class S>
  static S evaluate(const Shared&, const Data& data, const NodeState<S>* x, const Environment& env,
                    RateWeights w, Output<S>& out) {
    Vector3<S> b, u;
    residual(data, x[0], env, b, u, out);
    if constexpr (want == Want::tangent) {
      using std::abs;
      const Vector3<S> across(S(0), u(1), u(2));
      Matrix3<S> G = drag::slope<S>(across, drag::speed<S>(across));
      G.row(0).setZero();
      G.col(0).setZero();
      G *= S(env.load_factor * data.across);
      G(0, 0) = S(2.0 * env.load_factor * data.along) * abs(u(0));
      out.D.setZero();
      if constexpr (flowing) out.K.setZero();
      if constexpr (placed) {
        const Matrix3<S> R = data.frame.R.template cast<S>(),
                         c = hat(Vector3<S>(data.frame.c.template cast<S>()));
        const Matrix3<S> RG = R.lazyProduct(G);
        G = RG.lazyProduct(R.transpose());
        const Matrix3<S> cG = c.lazyProduct(G);
        out.D << S(w.V) * G, S(-w.V) * G.lazyProduct(c), S(w.V) * cG, S(-w.V) * cG.lazyProduct(c);
        if constexpr (flowing) out.K.template bottomRightCorner<3, 3>() = -cG.lazyProduct(hat(b));
      } else {
        out.D.template topLeftCorner<3, 3>() = S(w.V) * G;
      }
      if constexpr (flowing) out.K.template topRightCorner<3, 3>() = -G.lazyProduct(hat(b));
    }
    return S(1);
  }

  static double damping_power(const Shared& shared, const Data& data, const NodeState<double>* x,
                              const Environment& env) {
    Output<double> out;
    evaluate<Want::residual>(shared, data, x, env, RateWeights{}, out);
    return -out.r.dot(x[0].V);
  }

 private:
  // Not inlined: the same to the last bit with and without the tangent.
  template <class S>
  [[gnu::noinline]] static void residual(const Data& data, const NodeState<S>& x,
                                         const Environment& env, Vector3<S>& b, Vector3<S>& u,
                                         Output<S>& out) {
    using std::abs;
    u = linear(x.V);
    if constexpr (placed) u += angular(x.V).cross(Vector3<S>(data.frame.c.template cast<S>()));
    if constexpr (flowing) {
      b = drag::seen(data.flow, x.H, env);
      u -= b;
    }
    if constexpr (placed) u = Vector3<S>(data.frame.R.transpose().template cast<S>() * u);
    const S n = S(env.load_factor * data.across) * drag::speed<S>(Vector3<S>(S(0), u(1), u(2)));
    const S t = S(env.load_factor * data.along) * abs(u(0));
    Vector3<S> g(t * u(0), n * u(1), n * u(2)), moment = Vector3<S>::Zero();
    if constexpr (placed) {
      g = Vector3<S>(data.frame.R.template cast<S>() * g);
      moment = Vector3<S>(data.frame.c.template cast<S>()).cross(g);
    }
    out.r = six<S>(g, moment);
  }
};

// (3)
template <bool flowing>
struct PointDrag {
  static constexpr const char* name = flowing ? "drag of bodies in a flow" : "drag of bodies";
  static constexpr int nodes = 1;
  static constexpr bool has_K = flowing;
  static constexpr bool has_D = true;
  static constexpr bool needs_rates = true;
  static constexpr bool scales_with_load = true;

  struct Shared {};
  struct Data {
    double b;     //                                        [kg/m]
    Vec3 offset;  // c, node axes                           [m]
    [[no_unique_address]] drag::FlowOf<flowing> flow;
  };
  template <class S>
  using Output = ElementOutput<S, 1>;

  static int node_count(const Shared&) { return 1; }

  template <Want want, class S>
  static S evaluate(const Shared&, const Data& data, const NodeState<S>* x, const Environment& env,
                    RateWeights w, Output<S>& out) {
    Vector3<S> b, u;
    residual(data, x[0], env, b, u, out);
    if constexpr (want == Want::tangent) {
      const Matrix3<S> G = S(env.load_factor * data.b) * drag::slope<S>(u, drag::speed<S>(u));
      const Matrix3<S> c = hat(Vector3<S>(data.offset.template cast<S>()));
      const Matrix3<S> cG = c.lazyProduct(G);
      out.D << S(w.V) * G, S(-w.V) * G.lazyProduct(c), S(w.V) * cG, S(-w.V) * cG.lazyProduct(c);
      if constexpr (flowing) {
        const Matrix3<S> bh = hat(b);
        out.K << Matrix3<S>::Zero(), -G.lazyProduct(bh), Matrix3<S>::Zero(), -cG.lazyProduct(bh);
      }
    }
    return S(1);
  }

  static double damping_power(const Shared& shared, const Data& data, const NodeState<double>* x,
                              const Environment& env) {
    Output<double> out;
    evaluate<Want::residual>(shared, data, x, env, RateWeights{}, out);
    return -out.r.dot(x[0].V);
  }

 private:
  // Not inlined: the same to the last bit with and without the tangent.
  template <class S>
  [[gnu::noinline]] static void residual(const Data& data, const NodeState<S>& x,
                                         const Environment& env, Vector3<S>& b, Vector3<S>& u,
                                         Output<S>& out) {
    const Vector3<S> c = data.offset.template cast<S>();
    u = linear(x.V) + angular(x.V).cross(c);
    if constexpr (flowing) {
      b = drag::seen(data.flow, x.H, env);
      u -= b;
    }
    const Vector3<S> g = S(env.load_factor * data.b) * drag::speed<S>(u) * u;
    out.r = six<S>(g, c.cross(g));
  }
};

}  // namespace mbd
