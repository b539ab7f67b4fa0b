// Damping proportional to mass: what moves is held back by alpha times its momentum, at rest being the
// inertial frame. P = sum over what is damped of alpha M, at its node.
//
//   r = P V,   dr/dV = P,   power -V^T P V                                                            (1)
//
// Symbols: P [kg/s, kg.m/s, kg.m2/s], V = [v; w] of the node, both in the node's frame.
// Damping ratio of a mode of frequency omega: alpha/(2 omega); a free body slows down by exp(-alpha t). The
// forces are external: they change the momenta, and rigid motion is damped too.
// Source: Rayleigh, The Theory of Sound, vol. 1, art. 81-82 (dissipation function proportional to the kinetic
// energy). Not used: alpha V~ P V or other terms of the rate of momentum, which damp nothing.
#pragma once

#include "elements/element.hpp"
#include "libmbd/core/batch.hpp"

namespace mbd {

struct MassDamping {
  static constexpr const char* name = "damping proportional to mass";
  static constexpr int nodes = 1;
  static constexpr bool has_K = false;
  static constexpr bool has_D = true;
  static constexpr bool needs_rates = true;

  struct Shared {};
  struct Data {
    Mat6 P;  // node frame
  };
  template <class S>
  using Output = ElementOutput<S, 1>;

  static int node_count(const Shared&) { return 1; }

  template <Want want, class S>
  static S evaluate(const Shared&, const Data& data, const NodeState<S>* x, const Environment&,
                    RateWeights w, Output<S>& out) {
    residual(data, x[0], out);
    if constexpr (want == Want::tangent) out.D = S(w.V) * data.P.cast<S>();
    return S(1);
  }

  static double damping_power(const Shared&, const Data& data, const NodeState<double>* x,
                              const Environment&) {
    return -x[0].V.dot(times(data.P, x[0].V));
  }

 private:
  // Not inlined: the same to the last bit with and without the tangent.
  template <class S>
  [[gnu::noinline]] static void residual(const Data& data, const NodeState<S>& x, Output<S>& out) {
    out.r = times<S>(data.P.cast<S>(), x.V);
  }
};

}  // namespace mbd
