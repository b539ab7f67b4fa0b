// Inertial force of an accelerated base on what moves with a node: mass m and static moment m c in the node's frame.
//
// The base, the ground of the scene, moves by d(t) against an inertial frame, without turning. Positions and velocities
// are those against the base; the axes are inertial. Then Newton's law for a particle, m (a + d'') = f, is that of
// a base at rest with one more force, -m d'':
//
//   force  f = -m R^T d'',  moment  m c x (-R^T d'')
//   r = [ m b ; (m c) x b ],  b = R^T d'';   db = b~ psi                                              (1)
// like gravity of -d'' (gravity.hpp), which changes with time. Joints to the ground and motions are against the
// base, and need no term.
//
// d'' is a signal, or the derivative of one: of a law of d or d' it is exact (signal.hpp). Multiplied by the load
// factor, as gravity is: a static equilibrium is one of the accelerated base at t = 0. Power: -r . V, in the moving
// frame. Its work depends on the way, as d'' depends on time: no potential.
// Symbols: psi rotation increment, node axes [rad]; d'' [m/s2].
//
// Not used: a rotating base (centrifugal, Coriolis and Euler forces); to turn a base, drive a body by <motion>. Force on
// added mass: the fluid moves with the base.
#pragma once

#include <array>

#include "elements/element.hpp"
#include "libmbd/core/batch.hpp"

namespace mbd {

struct BaseMotion {
  static constexpr const char* name = "base motion";
  static constexpr int nodes = 1;
  static constexpr bool has_K = true;
  static constexpr bool has_D = false;
  static constexpr bool needs_rates = false;
  static constexpr bool scales_with_load = true;

  enum class Law { acceleration, velocity, displacement };
  struct Shared {
    Law law = Law::acceleration;
    std::array<int, 3> signals{-1, -1,
                               -1};  // places in State::signals; -1 for zero  [m/s2, m/s, m]
  };
  struct Data {
    double m;  // [kg]
    Vec3 mc;   // [kg.m], node frame
  };
  template <class S>
  using Output = ElementOutput<S, 1>;

  static int node_count(const Shared&) { return 1; }

  template <Want want, class S>
  static S evaluate(const Shared& shared, const Data& data, const NodeState<S>* x,
                    const Environment& env, RateWeights, Output<S>& out) {
    Vector3<S> b;
    residual(shared, data, x[0], env, b, out);
    if constexpr (want == Want::tangent) {
      const Matrix3<S> bh = hat(b);
      out.K << Matrix3<S>::Zero(), S(data.m) * bh, Matrix3<S>::Zero(),
          hat(Vector3<S>(data.mc.template cast<S>())).lazyProduct(bh);
    }
    return S(1);
  }

  static double load_power(const Shared& shared, const Data& data, const NodeState<double>* x,
                           const Environment& env) {
    const Vec3 w = angular(x[0].V);
    return -(x[0].H.p.conjugate() * acceleration(shared, env))
                .dot(data.m * linear(x[0].V) + w.cross(data.mc));
  }

  // d'' at the whole load [m/s2]; `signals` as in State.
  static Vec3 acceleration_of_base(const Shared& shared, std::span<const SignalValue> signals) {
    const auto component = [&](int i) {
      if (i < 0) return 0.0;
      const SignalValue& s = signals[static_cast<std::size_t>(i)];
      return shared.law == Law::acceleration ? s.f : shared.law == Law::velocity ? s.fdot : s.fddot;
    };
    return {component(shared.signals[0]), component(shared.signals[1]),
            component(shared.signals[2])};
  }

 private:
  static Vec3 acceleration(const Shared& shared, const Environment& env) {
    return env.load_factor * acceleration_of_base(shared, env.signals);
  }
  // Not inlined: the same to the last bit with and without the tangent.
  template <class S>
  [[gnu::noinline]] static void residual(const Shared& shared, const Data& data,
                                         const NodeState<S>& x, const Environment& env,
                                         Vector3<S>& b, Output<S>& out) {
    b = x.H.p.conjugate() * Vector3<S>(acceleration(shared, env).template cast<S>());
    const Vector3<S> mc = data.mc.template cast<S>();
    out.r = six<S>(S(data.m) * b, mc.cross(b));
  }
};

}  // namespace mbd
