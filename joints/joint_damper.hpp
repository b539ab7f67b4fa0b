// A damper on the free coordinate x of a joint (coordinate.hpp).
//
// Force:    tau = c xdot + f(xdot) along x on b (internal: against xdot), its opposite on a               (1)
// Power:    -tau xdot                                                                                     (2)
// Tangent:  df/dz = tau' w w^T,   L = w tau' (H^T z - y~^T w)^T + tau H                                   (3)
// Symbols: c damping [N.m.s, N.s/m], f law of the rate [N.m, N]; z, y relative twist and that of a.
// Source: derivative of (1). Limit: that of the joint's angle (joint.hpp).
#pragma once

#include <vector>

#include "joints/coordinate.hpp"
#include "libmbd/core/law.hpp"

namespace mbd::joint {

template <class Coordinate>
struct JointDamper {
  static constexpr const char* name = std::is_same_v<Coordinate, Turning>
                                          ? "damper of joint angles"
                                          : "damper of joint displacements";
  static constexpr int nodes = 2;
  static constexpr bool has_K = true;
  static constexpr bool has_D = true;
  static constexpr bool needs_rates = true;

  struct Shared {
    std::vector<mbd::Law> laws;
  };
  struct Data {
    Axis axis;
    Characteristic force;  // of xdot  [N.m, N]
  };
  template <class S>
  using Output = two_frames::Output<S>;

  static int node_count(const Shared&) { return 2; }

  template <Want want, class S>
  static S evaluate(const Shared& shared, const Data& data, const NodeState<S>* x,
                    const Environment&, RateWeights weights, Output<S>& out) {
    const two_frames::Frames<S> frames(data.axis.ends, x);
    LawValue at;
    Vector6<S> w;
    const S tau = residual(shared, data, frames, x, at, w, out);
    if constexpr (want == Want::tangent) {
      const Matrix6<S> H = Coordinate::curvature(frames.g);
      const Vector6<S> z = frames.twist(x), y = frames.twist_of_a(x);
      const Vector6<S> gradient = H.transpose() * z - twist_hat<S>(y).transpose() * w;
      const Vector6<S> along = S(at.df) * w;
      const Matrix6<S> L = along * gradient.transpose() + tau * H;
      frames.tangent(tau * w, L, out.K);
      const Matrix6<S> rates = along * w.transpose();
      frames.rate_tangent(S(weights.V), rates, out.D);
    }
    return S(1);
  }

  static double damping_power(const Shared& shared, const Data& data, const NodeState<double>* x,
                              const Environment&) {
    const double rate = rate_of(data, x);
    return -data.force(shared.laws, rate).f * rate;
  }

  template <class Visit>
  static void each_law(const Shared& shared, const Data& data, const NodeState<double>* x,
                       const Environment&, const Visit& visit) {
    constexpr ArgumentOf of =
        std::is_same_v<Coordinate, Turning> ? ArgumentOf::angular_speed : ArgumentOf::speed;
    data.force.each_law(shared.laws, rate_of(data, x), of, visit);
  }

  // tau of (1) [N.m, N]: the damper exerts -tau on b.
  static double effort(const Shared& shared, const Data& data, const NodeState<double>* x,
                       double /*near*/) {
    return data.force(shared.laws, rate_of(data, x)).f;
  }

 private:
  // xdot.
  static double rate_of(const Data& data, const NodeState<double>* x) {
    const two_frames::Frames<double> frames(data.axis.ends, x);
    return Coordinate::gradient(frames.g).dot(frames.twist(x));
  }

  // Not inlined: the same to the last bit with and without the tangent.
  template <class S>
  [[gnu::noinline]] static S residual(const Shared& shared, const Data& data,
                                      const two_frames::Frames<S>& frames, const NodeState<S>* x,
                                      LawValue& at, Vector6<S>& w, Output<S>& out) {
    w = Coordinate::gradient(frames.g);
    const S rate = w.dot(frames.twist(x));
    at = data.force(shared.laws, value_of(rate));
    const S tau = lifted(at, rate);
    out.r.noalias() = frames.B.transpose() * Vector6<S>(tau * w);
    return tau;
  }
};

}  // namespace mbd::joint
