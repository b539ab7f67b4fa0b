// A dead force and moment on a node: fixed inertial directions, components given by signals of time.
//
//   r = -[ R^T f ; R^T m ];   d(R^T f) = (R^T f)~ psi                                              (1)
// The force acts at the node's origin. The dead moment has no potential (its work depends on the path of
// rotation); it is applied as stated.
#pragma once

#include "elements/element.hpp"
#include "libmbd/core/batch.hpp"

namespace mbd {

struct PointLoad {
  static constexpr const char* name = "point load";
  static constexpr int nodes = 1;
  static constexpr bool has_K = true;
  static constexpr bool has_D = false;
  static constexpr bool needs_rates = false;

  struct Shared {};
  struct Data {
    std::array<int, 6> signals;  // of [f1 f2 f3 m1 m2 m3], inertial [N, N.m]; -1 for zero
  };
  template <class S>
  using Output = ElementOutput<S, 1>;

  static int node_count(const Shared&) { return 1; }

  template <Want want, class S>
  static S evaluate(const Shared&, const Data& data, const NodeState<S>* x, const Environment& env,
                    RateWeights, Output<S>& out) {
    Vector6<S> load;
    for (int i = 0; i < 6; ++i) {
      const int signal = data.signals[static_cast<std::size_t>(i)];
      load(i) =
          signal < 0 ? S(0) : S(env.load_factor * env.signals[static_cast<std::size_t>(signal)].f);
    }
    const Quaternion<S> Rt = x[0].H.p.conjugate();
    const Vector3<S> f = Rt * linear(load), m = Rt * angular(load);
    out.r = six<S>(-f, -m);
    if constexpr (want == Want::tangent) {
      out.K << Matrix3<S>::Zero(), -hat(f), Matrix3<S>::Zero(), -hat(m);
    }
    return S(1);
  }
};

}  // namespace mbd
