// Damping of a bushing (bushing.hpp): forces that depend on the rate of its motion parameters.
//
// Rate:     qdot = T^-1(q) z,   z the relative twist of the frames (two_frames.hpp (2))                    (1)
// Force:    W = C qdot,   wrench on b   f = T^-1(q)^T W,   power -qdot.C qdot                              (2)
// Tangent:  df/dz = T^-T C T^-1,   df/dzeta = T^-T C (G T^-1 - T^-1 y~) + Lin(W),
//           G = d(T^-1(q) z)/dq at fixed z                                                                (3)
// G: T^-1(q) is the transpose of T^-1(-q) part by part (metrics.hpp (1)), so with M = d(A(p)^T x)/dp of the
// pair p = -q, in dual numbers and with x = angular(z) + eps linear(z),   G = -M.                          (4)
// Symbols: C symmetric, positive semidefinite [N.s/m, N.s; N.s, N.m.s]: force or moment along component i of
// the wrench conjugate to q per rate of q_j. C = beta K is damping proportional to the stiffness.
// Source: derivative of (2) as it stands. Limit: as of bushing.hpp.
// Not used: f = C z, resolved in b. It is as objective and simpler, but favours one side: exchanging a and b
// changes it at large motions, and C = beta K would not be the rate of the elastic wrench.
#pragma once

#include "elements/pair/bushing.hpp"

namespace mbd {

namespace bushing {

// G of (4), of the pair whose relative motion is g.
template <class S>
Matrix6<S> parameter_gradient(const Pose<S>& g, const Vector6<S>& z) {
  const Pair::Pair<S> back(inverse(g));
  DualMatrix<S> M;
  back.linearize(DualMatrix<S>{}, angular(z), linear(z), M.A, M.B);
  return -M.matrix();
}

}  // namespace bushing

struct BushingDamper {
  static constexpr const char* name = "bushing damper";
  static constexpr int nodes = 2;
  static constexpr bool has_K = true;
  static constexpr bool has_D = true;
  static constexpr bool needs_rates = true;

  struct Shared {};
  struct Data {
    two_frames::Ends ends;
    Mat6 C = Mat6::Zero();
  };
  template <class S>
  using Output = two_frames::Output<S>;

  static int node_count(const Shared&) { return 2; }

  template <Want want, class S>
  static S evaluate(const Shared&, const Data& data, const NodeState<S>* x, const Environment&,
                    RateWeights weights, Output<S>& out) {
    const two_frames::Frames<S> frames(data.ends, x);
    const bushing::Pair::Pair<S> pair(frames.g);
    Vector6<S> z, W, f;
    residual(data, frames, pair, x, z, W, f, out);
    if constexpr (want == Want::tangent) {
      const DualMatrix<S> T = pair.T_inverse();
      const Matrix6<S> Tm = T.matrix();
      const Matrix6<S> TC = Tm.transpose() * data.C.template cast<S>();
      const Matrix6<S> dqdot =
          bushing::parameter_gradient(frames.g, z) * Tm - Tm * twist_hat<S>(frames.twist_of_a(x));
      const Matrix6<S> L = TC * dqdot + linearized_force(pair, T, W);
      frames.tangent(f, L, out.K);
      const Matrix6<S> rates = TC * Tm;
      frames.rate_tangent(S(weights.V), rates, out.D);
    }
    return pair.e0 - S(bushing::limit());
  }

  static double damping_power(const Shared&, const Data& data, const NodeState<double>* x,
                              const Environment&) {
    const two_frames::Frames<double> frames(data.ends, x);
    const Vec6 qdot = bushing::Pair::Pair<double>(frames.g).T_inverse() * Vec6(frames.twist(x));
    return -qdot.dot(data.C * qdot);
  }

  // f of (2) [N, N.m]: the damper exerts -f on b.
  static Vec6 wrench(const Shared&, const Data& data, const NodeState<double>* x) {
    const two_frames::Frames<double> frames(data.ends, x);
    Vec6 z, W, f;
    Output<double> out;
    residual(data, frames, bushing::Pair::Pair<double>(frames.g), x, z, W, f, out);
    return f;
  }

 private:
  // Not inlined: the same to the last bit with and without the tangent.
  template <class S>
  [[gnu::noinline]] static void residual(const Data& data, const two_frames::Frames<S>& frames,
                                         const bushing::Pair::Pair<S>& pair, const NodeState<S>* x,
                                         Vector6<S>& z, Vector6<S>& W, Vector6<S>& f,
                                         Output<S>& out) {
    z = frames.twist(x);
    W = data.C.template cast<S>() * Vector6<S>(pair.T_inverse() * z);
    f = pair.forces(W).on_k();
    out.r.noalias() = frames.B.transpose() * f;
  }
};

}  // namespace mbd
