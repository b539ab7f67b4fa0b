// A damper between two points of two nodes, along the line that joins them (two_points.hpp).
//
// Power:    -T l' (negative where T opposes the motion)                                              (1)
// Force:    T = c l' + f(l') (tension is positive),   r = T h                                        (2)
// Tangent:  D = V T' h h^T,   K = T' h g^T + T dh/dU,   g = dl'/dU at fixed V,   T' = c + f'(l')     (3)
// Symbols: l' rate of the distance [m/s], c damping [N.s/m], f law of the rate [N], V weight of dV.
// Source: as spring.hpp. Limit: l = 0.
// Not used: friction, a force that jumps with the sign of the rate: a law must be continuous.
#pragma once

#include <vector>

#include "elements/pair/two_points.hpp"
#include "libmbd/core/law.hpp"

namespace mbd {

struct Damper {
  static constexpr const char* name = "damper";
  static constexpr int nodes = 2;
  static constexpr bool has_K = true;
  static constexpr bool has_D = true;
  static constexpr bool needs_rates = true;

  struct Shared {
    std::vector<Law> laws;
  };
  struct Data {
    two_points::Ends ends;
    Characteristic force;  // of l'  [N]
  };
  template <class S>
  using Output = two_points::Output<S>;

  static int node_count(const Shared&) { return 2; }

  template <Want want, class S>
  static S evaluate(const Shared& shared, const Data& data, const NodeState<S>* x,
                    const Environment&, RateWeights weights, Output<S>& out) {
    const two_points::Line<S> line(data.ends, x);
    LawValue at;
    const S T = residual(shared, data, line, x, at, out);
    if constexpr (want == Want::tangent) {
      line.geometric(T, out.K);
      const Matrix<S, 12, 1> along = S(at.df) * line.h;
      out.K.noalias() += along * line.rate_gradient(x).transpose();
      out.D.noalias() = (S(weights.V) * along) * line.h.transpose();
    }
    return line.margin(data.ends);
  }

  static double damping_power(const Shared& shared, const Data& data, const NodeState<double>* x,
                              const Environment&) {
    const double rate = rate_of(data, x);
    return -data.force(shared.laws, rate).f * rate;
  }

  template <class Visit>
  static void each_law(const Shared& shared, const Data& data, const NodeState<double>* x,
                       const Environment&, const Visit& visit) {
    data.force.each_law(shared.laws, rate_of(data, x), ArgumentOf::speed, visit);
  }

  // T [N], for output.
  static double tension(const Shared& shared, const Data& data, const NodeState<double>* x) {
    return data.force(shared.laws, rate_of(data, x)).f;
  }

 private:
  // l'.
  static double rate_of(const Data& data, const NodeState<double>* x) {
    return two_points::Line<double>(data.ends, x).rate(x);
  }

  // Not inlined: the same to the last bit with and without the tangent.
  template <class S>
  [[gnu::noinline]] static S residual(const Shared& shared, const Data& data,
                                      const two_points::Line<S>& line, const NodeState<S>* x,
                                      LawValue& at, Output<S>& out) {
    const S rate = line.rate(x);
    at = data.force(shared.laws, value_of(rate));
    const S T = lifted(at, rate);
    out.r = T * line.h;
    return T;
  }
};

}  // namespace mbd
