// Loads on a node: forces and moments whose components are signals of time, times a weight w (1 for a
// point load; the length of the reference line that a node stands for when the load is distributed).
//
// Dead load, inertial directions:      r = -w [ R^T f ; R^T m ],   d(R^T f) = (R^T f)~ psi            (1)
// Follower load, axes of the node:     r = -w [ f ; m + c x f ],   dr = 0                             (2)
// Arm of a dead force that acts at c:  r = -w [ 0 ; c x R^T f ],   dr = -w [ 0 ; c~ (R^T f)~ psi ]    (3)
// A dead force at an offset is (1) and (3): most loads have none, and do not pay for it. A follower force
// at an offset is a constant wrench of the node's axes: it needs no tangent, wherever it acts.
//
// Power: dead  w (f . R v + m . R w), arm  w f . R (w x c), follower  w (R f . R (v + w x c) + R m . R w).
// Symbols: f force [N] (per length if distributed), m moment [N.m], c point of action from the node, node
// axes [m], psi rotation increment, node axes. Every load is multiplied by the load factor.
//
// A dead moment and a follower load have no potential (their work depends on the path), so none of these
// counts in the energies; load_power says what they do.
// Not used: consistent nodal forces of a distributed load with the rule of the elastic term; the rule on
// the nodes is exact to degree 2N - 1 too and keeps loads and masses on the same points.
#pragma once

#include <array>

#include "elements/element.hpp"
#include "libmbd/core/batch.hpp"

namespace mbd {

namespace load {

// Places of [f1 f2 f3 m1 m2 m3] in State::signals; -1 for zero.
using Signals = std::array<int, 6>;

inline double value(int signal, const Environment& env) {
  return signal < 0 ? 0.0 : env.load_factor * env.signals[static_cast<std::size_t>(signal)].f;
}
inline Vec3 force(const Signals& s, const Environment& env) {
  return {value(s[0], env), value(s[1], env), value(s[2], env)};
}
inline Vec3 moment(const Signals& s, const Environment& env) {
  return {value(s[3], env), value(s[4], env), value(s[5], env)};
}

}  // namespace load

// (1)
struct PointLoad {
  static constexpr const char* name = "dead load";
  static constexpr int nodes = 1;
  static constexpr bool has_K = true;
  static constexpr bool has_D = false;
  static constexpr bool needs_rates = false;
  static constexpr bool scales_with_load = true;

  struct Shared {};
  struct Data {
    load::Signals signals;  // inertial axes              [N, N.m; per m]
    double weight = 1.0;    // w                          [-; m]
  };
  template <class S>
  using Output = ElementOutput<S, 1>;

  static int node_count(const Shared&) { return 1; }

  template <Want want, class S>
  static S evaluate(const Shared&, const Data& data, const NodeState<S>* x, const Environment& env,
                    RateWeights, Output<S>& out) {
    residual(data, x[0], env, out);
    if constexpr (want == Want::tangent) {
      out.K << Matrix3<S>::Zero(), hat(out.r.template head<3>()), Matrix3<S>::Zero(),
          hat(out.r.template tail<3>());
    }
    return S(1);
  }

  static double load_power(const Shared&, const Data& data, const NodeState<double>* x,
                           const Environment& env) {
    const Vec3 v = x[0].H.p * linear(x[0].V), w = x[0].H.p * angular(x[0].V);
    return data.weight *
           (load::force(data.signals, env).dot(v) + load::moment(data.signals, env).dot(w));
  }

 private:
  // Not inlined: the same to the last bit with and without the tangent.
  template <class S>
  [[gnu::noinline]] static void residual(const Data& data, const NodeState<S>& x,
                                         const Environment& env, Output<S>& out) {
    const Quaternion<S> Rt = x.H.p.conjugate();
    const Vector3<S> f = Rt * Vector3<S>((data.weight * load::force(data.signals, env)).cast<S>());
    const Vector3<S> m = Rt * Vector3<S>((data.weight * load::moment(data.signals, env)).cast<S>());
    out.r = six<S>(-f, -m);
  }
};

// (2)
struct FollowerLoad {
  static constexpr const char* name = "follower load";
  static constexpr int nodes = 1;
  static constexpr bool has_K = false;
  static constexpr bool has_D = false;
  static constexpr bool needs_rates = false;
  static constexpr bool scales_with_load = true;

  struct Shared {};
  struct Data {
    load::Signals signals;       // node axes                  [N, N.m; per m]
    double weight = 1.0;         // w                          [-; m]
    Vec3 offset = Vec3::Zero();  // c                          [m]
  };
  template <class S>
  using Output = ElementOutput<S, 1>;

  static int node_count(const Shared&) { return 1; }

  template <Want want, class S>
  static S evaluate(const Shared&, const Data& data, const NodeState<S>*, const Environment& env,
                    RateWeights, Output<S>& out) {
    const Vec3 f = data.weight * load::force(data.signals, env);
    const Vec3 m = data.weight * load::moment(data.signals, env) + data.offset.cross(f);
    out.r = six<double>(-f, -m).cast<S>();
    return S(1);
  }

  static double load_power(const Shared&, const Data& data, const NodeState<double>* x,
                           const Environment& env) {
    const Quaternion<double>& R = x[0].H.p;
    const Vec3 f = R * load::force(data.signals, env), m = R * load::moment(data.signals, env),
               w = R * angular(x[0].V), v = R * linear(x[0].V) + w.cross(R * data.offset);
    return data.weight * (f.dot(v) + m.dot(w));
  }
};

// (3)
struct DeadForceArm {
  static constexpr const char* name = "arm of a dead force";
  static constexpr int nodes = 1;
  static constexpr bool has_K = true;
  static constexpr bool has_D = false;
  static constexpr bool needs_rates = false;
  static constexpr bool scales_with_load = true;

  struct Shared {};
  struct Data {
    load::Signals signals;       // inertial axes; the moments are not used  [N; per m]
    double weight = 1.0;         // w                                        [-; m]
    Vec3 offset = Vec3::Zero();  // c                                        [m]
  };
  template <class S>
  using Output = ElementOutput<S, 1>;

  static int node_count(const Shared&) { return 1; }

  template <Want want, class S>
  static S evaluate(const Shared&, const Data& data, const NodeState<S>* x, const Environment& env,
                    RateWeights, Output<S>& out) {
    Vector3<S> f;
    residual(data, x[0], env, f, out);
    if constexpr (want == Want::tangent) {
      const Vector3<S> c = data.offset.cast<S>();
      out.K << Matrix3<S>::Zero(), Matrix3<S>::Zero(), Matrix3<S>::Zero(),
          -hat(c).lazyProduct(hat(f));
    }
    return S(1);
  }

  static double load_power(const Shared&, const Data& data, const NodeState<double>* x,
                           const Environment& env) {
    const Vec3 w = x[0].H.p * angular(x[0].V), c = x[0].H.p * data.offset;
    return data.weight * load::force(data.signals, env).dot(w.cross(c));
  }

 private:
  // Not inlined: the same to the last bit with and without the tangent.
  template <class S>
  [[gnu::noinline]] static void residual(const Data& data, const NodeState<S>& x,
                                         const Environment& env, Vector3<S>& f, Output<S>& out) {
    f = x.H.p.conjugate() * Vector3<S>((data.weight * load::force(data.signals, env)).cast<S>());
    out.r = six<S>(Vector3<S>::Zero(), f.cross(Vector3<S>(data.offset.cast<S>())));
  }
};

}  // namespace mbd
