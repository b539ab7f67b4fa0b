// Uniform gravity on what moves with a node: mass m and static moment m c in the node's frame.
//
//   potential  -m g.(r + R c);  force on the node  f = m R^T g,  moment  m c x R^T g
//   r = -[ m b ; (m c) x b ],  b = R^T g;   db = b~ psi                                            (1)
// g is inertial [m/s2] and scaled by the load factor.
#pragma once

#include "elements/element.hpp"
#include "libmbd/core/batch.hpp"

namespace mbd {

struct NodalGravity {
  static constexpr const char* name = "gravity";
  static constexpr int nodes = 1;
  static constexpr bool has_K = true;
  static constexpr bool has_D = false;
  static constexpr bool needs_rates = false;
  static constexpr bool scales_with_load = true;

  struct Shared {
    Vec3 g;  // [m/s2], inertial
  };
  struct Data {
    double m;  // [kg]
    Vec3 mc;   // [kg.m], node frame
  };
  template <class S>
  using Output = ElementOutput<S, 1>;

  static int node_count(const Shared&) { return 1; }

  static constexpr bool has_packs = true;
  struct Packed {
    using Shared = NodalGravity::Shared;
    struct Data {
      Pack m;
      Vector3<Pack> mc;
    };
    template <class S>
    using Output = NodalGravity::Output<S>;
    template <Want>
    static Pack evaluate(const Shared& shared, const Data& data, const NodeState<Pack>* x,
                         const Environment& env, RateWeights, Output<Pack>& out) {
      Vector3<Pack> b;
      residual(shared, data, x[0], env, b, out);
      return Pack(1.0);
    }
  };
  static PackedElements<NodalGravity> packed(const Shared& shared,
                                             const std::vector<Data>& elements) {
    PackedElements<NodalGravity> result{shared, {}};
    each_pack(0, elements.size(), [&](const PackOf& pack) {
      Packed::Data data{pack_of([&](int k) { return elements[pack[k]].m; }), {}};
      pack_into(data.mc, [&](int k) { return elements[pack[k]].mc.data(); });
      result.data.push_back(data);
    });
    return result;
  }

  template <Want want, class S>
  static S evaluate(const Shared& shared, const Data& data, const NodeState<S>* x,
                    const Environment& env, RateWeights, Output<S>& out) {
    Vector3<S> b;
    residual(shared, data, x[0], env, b, out);
    if constexpr (want == Want::tangent) {
      const Matrix3<S> bh = hat(b);
      out.K << Matrix3<S>::Zero(), S(-data.m) * bh, Matrix3<S>::Zero(),
          -hat(Vector3<S>(data.mc.template cast<S>())) * bh;
    }
    return S(1);
  }

  static Energies energies(const Shared& shared, const Data& data, const NodeState<double>* x,
                           const Environment& env) {
    const Vec3 moment = data.m * x[0].H.r + x[0].H.p * data.mc;
    return {.kinetic = 0.0, .strain = 0.0, .potential = -env.load_factor * shared.g.dot(moment)};
  }

 private:
  // Not inlined: the same to the last bit with and without the tangent.
  template <class Constants, class S>
  [[gnu::noinline]] static void residual(const Shared& shared, const Constants& data,
                                         const NodeState<S>& x, const Environment& env,
                                         Vector3<S>& b, Output<S>& out) {
    const Vector3<S> g = (env.load_factor * shared.g).template cast<S>();
    b = rotated_back<S>(x.H.p, g);
    out.r = six<S>(-S(data.m) * b, b.cross(Vector3<S>(data.mc.template cast<S>())));
  }
};

}  // namespace mbd
