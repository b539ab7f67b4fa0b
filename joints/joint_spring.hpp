// A spring on the free coordinate x of a joint (coordinate.hpp): the unwrapped angle, over any number of turns,
// or the displacement.
//
// Energy:   E = k y^2/2 + F(y),   y = x - x0,   F the integral of the law f from 0                        (1)
// Force:    tau = k y + f(y) along x on b (internal: against y), its opposite on a                        (2)
// Tangent:  L = tau' w w^T + tau H                                                                        (3)
// Symbols: k stiffness [N.m, N/m], x0 rest [rad, m], f law [N.m, N].
// Source: derivative of (1). Limit: that of the joint's angle (joint.hpp).
#pragma once

#include <vector>

#include "joints/coordinate.hpp"
#include "libmbd/core/batch.hpp"
#include "libmbd/core/law.hpp"

namespace mbd::joint {

template <class Coordinate>
struct JointSpring {
  static constexpr const char* name = std::is_same_v<Coordinate, Turning>
                                          ? "spring of joint angles"
                                          : "spring of joint displacements";
  static constexpr int nodes = 2;
  static constexpr bool has_K = true;
  static constexpr bool has_D = false;
  static constexpr bool needs_rates = false;

  struct Shared {
    std::vector<mbd::Law> laws;
  };
  struct Data {
    Axis axis;
    double rest = 0.0;     // x0         [rad, m]
    Characteristic force;  // of x - x0  [N.m, N]
  };
  template <class S>
  using Output = two_frames::Output<S>;

  static int node_count(const Shared&) { return 2; }

  template <Want want, class S>
  static S evaluate(const Shared& shared, const Data& data, const NodeState<S>* x,
                    const Environment& env, RateWeights, Output<S>& out) {
    const two_frames::Frames<S> frames(data.axis.ends, x);
    LawValue at;
    Vector6<S> w;
    const S tau = residual(shared, data, frames, env, at, w, out);
    if constexpr (want == Want::tangent) {
      const Matrix6<S> L = (S(at.df) * w) * w.transpose() + tau * Coordinate::curvature(frames.g);
      frames.tangent(tau * w, L, out.K);
    }
    return S(1);
  }

  static Energies energies(const Shared& shared, const Data& data, const NodeState<double>* x,
                           const Environment& env) {
    const double y = extension(data, x, data.axis.near(env));
    return {.strain = data.force.energy(shared.laws, y)};
  }

  template <class Visit>
  static void each_law(const Shared& shared, const Data& data, const NodeState<double>* x,
                       const Environment& env, const Visit& visit) {
    constexpr ArgumentOf of =
        std::is_same_v<Coordinate, Turning> ? ArgumentOf::angle : ArgumentOf::length;
    data.force.each_law(shared.laws, extension(data, x, data.axis.near(env)), of, visit);
  }

  // tau of (2) [N.m, N]: the spring exerts -tau on b.
  static double effort(const Shared& shared, const Data& data, const NodeState<double>* x,
                       double near) {
    return data.force(shared.laws, extension(data, x, near)).f;
  }

 private:
  // y of (1).
  static double extension(const Data& data, const NodeState<double>* x, double near) {
    return Coordinate::value(two_frames::Frames<double>(data.axis.ends, x).g, near) - data.rest;
  }

  // Not inlined: the same to the last bit with and without the tangent.
  template <class S>
  [[gnu::noinline]] static S residual(const Shared& shared, const Data& data,
                                      const two_frames::Frames<S>& frames, const Environment& env,
                                      LawValue& at, Vector6<S>& w, Output<S>& out) {
    const S y = Coordinate::value(frames.g, data.axis.near(env)) - S(data.rest);
    at = data.force(shared.laws, value_of(y));
    const S tau = lifted(at, y);
    w = Coordinate::gradient(frames.g);
    out.r.noalias() = frames.B.transpose() * Vector6<S>(tau * w);
    return tau;
  }
};

}  // namespace mbd::joint
