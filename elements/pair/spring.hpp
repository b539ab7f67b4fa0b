// A spring between two points of two nodes, along the line that joins them (two_points.hpp).
//
// Energy:   E = k x^2/2 + F(x),   x = l - l0,   F the integral of the law f from 0 (law.hpp)         (1)
// Force:    T = k x + f(x) (tension is positive),   r = T h                                          (2)
// Tangent:  K = T' h h^T + T dh/dU,   T' = k + f'(x)                                                 (3)
// Symbols: l distance of the points, l0 free length [m], k stiffness [N/m], f law [N].
// Source: any text on multibody dynamics; (3) is the derivative of (2) as it stands.
// Limit: l = 0, where the line has no direction (two_points.hpp).
// Not used: a mass of the spring; damping, which is a term of its own (damper.hpp).
#pragma once

#include <vector>

#include "elements/pair/two_points.hpp"
#include "libmbd/core/batch.hpp"
#include "libmbd/core/law.hpp"

namespace mbd {

struct Spring {
  static constexpr const char* name = "spring";
  static constexpr int nodes = 2;
  static constexpr bool has_K = true;
  static constexpr bool has_D = false;
  static constexpr bool needs_rates = false;

  struct Shared {
    std::vector<Law> laws;
  };
  struct Data {
    two_points::Ends ends;
    double free_length = 0.0;  // l0           [m]
    Characteristic force;      // of l - l0    [N]
  };
  template <class S>
  using Output = two_points::Output<S>;

  static int node_count(const Shared&) { return 2; }

  template <Want want, class S>
  static S evaluate(const Shared& shared, const Data& data, const NodeState<S>* x,
                    const Environment&, RateWeights, Output<S>& out) {
    const two_points::Line<S> line(data.ends, x);
    LawValue at;
    const S T = residual(shared, data, line, at, out);
    if constexpr (want == Want::tangent) {
      line.geometric(T, out.K);
      out.K.noalias() += (S(at.df) * line.h) * line.h.transpose();
    }
    return line.margin(data.ends);
  }

  static Energies energies(const Shared& shared, const Data& data, const NodeState<double>* x,
                           const Environment&) {
    return {.strain = data.force.energy(shared.laws, extension(data, x))};
  }

  template <class Visit>
  static void each_law(const Shared& shared, const Data& data, const NodeState<double>* x,
                       const Environment&, const Visit& visit) {
    data.force.each_law(shared.laws, extension(data, x), ArgumentOf::length, visit);
  }

  // l - l0 [m] and T [N], for output.
  static double extension(const Data& data, const NodeState<double>* x) {
    return two_points::Line<double>(data.ends, x).l - data.free_length;
  }
  static double tension(const Shared& shared, const Data& data, const NodeState<double>* x) {
    return data.force(shared.laws, extension(data, x)).f;
  }

 private:
  // Not inlined: the same to the last bit with and without the tangent.
  template <class S>
  [[gnu::noinline]] static S residual(const Shared& shared, const Data& data,
                                      const two_points::Line<S>& line, LawValue& at,
                                      Output<S>& out) {
    const S extension = line.l - S(data.free_length);
    at = data.force(shared.laws, value_of(extension));
    const S T = lifted(at, extension);
    out.r = T * line.h;
    return T;
  }
};

}  // namespace mbd
