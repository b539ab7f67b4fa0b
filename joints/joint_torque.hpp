// A moment about, or a force along, the axis of a joint as a function of time: tau(t) along its free coordinate x
// (coordinate.hpp) on b, and the opposite on a. What a motor without a prescribed motion exerts.
//
// Force:    r = -B^T (tau w),   tau = load factor * signal(t)                                             (1)
// Tangent:  L = -tau H                                                                                    (2)
// Power:    tau xdot                                                                                      (3)
// Symbols: tau [N.m, N]; w, H, B of coordinate.hpp and two_frames.hpp.
// At fixed t it has the potential -tau x (of the unwrapped angle).
// Source: virtual work. Limit: that of the joint's angle (joint.hpp).
#pragma once

#include "joints/coordinate.hpp"
#include "libmbd/core/batch.hpp"

namespace mbd::joint {

template <class Coordinate>
struct JointTorque {
  static constexpr const char* name =
      std::is_same_v<Coordinate, Turning> ? "moment of joints" : "force of joints";
  static constexpr int nodes = 2;
  static constexpr bool has_K = true;
  static constexpr bool has_D = false;
  static constexpr bool needs_rates = false;
  static constexpr bool scales_with_load = true;

  struct Shared {};
  struct Data {
    two_frames::Ends ends;
    int signal = -1;  // its place in State::signals  [N.m, N]
  };
  template <class S>
  using Output = two_frames::Output<S>;

  static int node_count(const Shared&) { return 2; }

  template <Want want, class S>
  static S evaluate(const Shared&, const Data& data, const NodeState<S>* x, const Environment& env,
                    RateWeights, Output<S>& out) {
    const two_frames::Frames<S> frames(data.ends, x);
    const S tau(value(data, env));
    Vector6<S> f;
    residual(tau, frames, f, out);
    if constexpr (want == Want::tangent) {
      const Matrix6<S> L = -tau * Coordinate::curvature(frames.g);
      frames.tangent(f, L, out.K);
    }
    return S(1);
  }

  static double load_power(const Shared&, const Data& data, const NodeState<double>* x,
                           const Environment& env) {
    const two_frames::Frames<double> frames(data.ends, x);
    return value(data, env) * Coordinate::gradient(frames.g).dot(frames.twist(x));
  }

 private:
  static double value(const Data& data, const Environment& env) {
    return env.load_factor * env.signals[static_cast<std::size_t>(data.signal)].f;
  }
  // Not inlined: the same to the last bit with and without the tangent.
  template <class S>
  [[gnu::noinline]] static void residual(const S& tau, const two_frames::Frames<S>& frames,
                                         Vector6<S>& f, Output<S>& out) {
    f = -tau * Coordinate::gradient(frames.g);
    out.r.noalias() = frames.B.transpose() * f;
  }
};

}  // namespace mbd::joint
