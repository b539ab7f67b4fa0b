// A bushing: an elastic connection of two frames a, b (two_frames.hpp) that coincide in the reference
// configuration, in all six directions.
//
// q = [rho; theta] = log g, the geodesic motion parameters (metrics.hpp): for small motions displacement and
// rotation of b relative to a; for large ones the screw that takes a to b, the same seen from either side.
// Energy:   E = q.K q/2 + sum F_i(q_i),   F_i the integrals of the laws f_i                               (1)
// Force:    W = K q + [f_i(q_i)],   wrench on b   f = T^-1(q)^T W, on a   -T^-1(-q)^T W                   (2)
// Tangent:  L = T^-T (K + diag f_i') T^-1 + Lin(W)   (metrics.hpp (3)), taken to the nodes by
//           two_frames.hpp (4)                                                                            (3)
// Symbols: K symmetric [N/m, N, N.m], f_i law of q_i [N, N.m], q [m, rad]; axes of the frames.
// Source: Borri, Trainelli, Bottasso, "On representations and parameterizations of motion", Multibody
// System Dynamics 4, 2000 (parameters and T); (2), (3) as the pair of a beam (metrics.hpp).
// Limit: T^-1 is singular at a relative rotation of pi; beyond 0.9 of it is out of range.
// Not used: displacement and rotation vector taken apart: K would depend on which side is called a.
#pragma once

#include <array>
#include <vector>

#include "elements/pair/two_frames.hpp"
#include "libmbd/core/batch.hpp"
#include "libmbd/core/law.hpp"

namespace mbd {

namespace bushing {

using Pair = GeodesicMetric;

// cos(angle/2) of the largest relative rotation.
inline double limit() {
  static const double value = std::cos(0.5 * Pair::max_angle);
  return value;
}

}  // namespace bushing

struct Bushing {
  static constexpr const char* name = "bushing";
  static constexpr int nodes = 2;
  static constexpr bool has_K = true;
  static constexpr bool has_D = false;
  static constexpr bool needs_rates = false;

  struct Shared {
    std::vector<Law> laws;
  };
  struct Data {
    two_frames::Ends ends;
    Mat6 K = Mat6::Zero();                            // [N/m, N; N, N.m]
    std::array<int, 6> laws{-1, -1, -1, -1, -1, -1};  // their places in Shared; -1: none
  };
  template <class S>
  using Output = two_frames::Output<S>;

  static int node_count(const Shared&) { return 2; }

  template <Want want, class S>
  static S evaluate(const Shared& shared, const Data& data, const NodeState<S>* x,
                    const Environment&, RateWeights, Output<S>& out) {
    const two_frames::Frames<S> frames(data.ends, x);
    const bushing::Pair::Pair<S> pair(frames.g);
    Vec6 slope;
    Vector6<S> W, f;
    residual(shared, data, frames, pair, slope, W, f, out);
    if constexpr (want == Want::tangent) {
      Mat6 K = data.K;
      K.diagonal() += slope;
      const DualMatrix<S> T = pair.T_inverse();
      const Matrix6<S> Tm = T.matrix();
      const Matrix6<S> KT = K.template cast<S>() * Tm;
      const Matrix6<S> L = Tm.transpose() * KT + linearized_force(pair, T, W);
      frames.tangent(f, L, out.K);
    }
    return pair.e0 - S(bushing::limit());
  }

  static Energies energies(const Shared& shared, const Data& data, const NodeState<double>* x,
                           const Environment&) {
    const Vec6 q = bushing::Pair::Pair<double>(two_frames::Frames<double>(data.ends, x).g).q();
    double E = 0.5 * q.dot(data.K * q);
    for (std::size_t i = 0; i < 6; ++i)
      if (data.laws[i] >= 0)
        E += shared.laws[static_cast<std::size_t>(data.laws[i])].integral(q(static_cast<Index>(i)));
    return {.strain = E};
  }

  template <class Visit>
  static void each_law(const Shared& shared, const Data& data, const NodeState<double>* x,
                       const Environment&, const Visit& visit) {
    const Vec6 q = bushing::Pair::Pair<double>(two_frames::Frames<double>(data.ends, x).g).q();
    for (std::size_t i = 0; i < 6; ++i)
      if (data.laws[i] >= 0)
        visit(shared.laws[static_cast<std::size_t>(data.laws[i])], q(static_cast<Index>(i)),
              i < 3 ? ArgumentOf::length : ArgumentOf::angle);
  }

  // f of (2) [N, N.m]: the bushing exerts -f on b.
  static Vec6 wrench(const Shared& shared, const Data& data, const NodeState<double>* x) {
    const two_frames::Frames<double> frames(data.ends, x);
    Vec6 slope, W, f;
    Output<double> out;
    residual(shared, data, frames, bushing::Pair::Pair<double>(frames.g), slope, W, f, out);
    return f;
  }

 private:
  // Not inlined: the same to the last bit with and without the tangent.
  template <class S>
  [[gnu::noinline]] static void residual(const Shared& shared, const Data& data,
                                         const two_frames::Frames<S>& frames,
                                         const bushing::Pair::Pair<S>& pair, Vec6& slope,
                                         Vector6<S>& W, Vector6<S>& f, Output<S>& out) {
    const Vector6<S> q = pair.q();
    W = data.K.template cast<S>() * q;
    slope.setZero();
    for (std::size_t i = 0; i < 6; ++i) {
      if (data.laws[i] < 0) continue;
      const auto k = static_cast<Index>(i);
      const LawValue at = shared.laws[static_cast<std::size_t>(data.laws[i])](value_of(q(k)));
      W(k) += lifted(at, q(k));
      slope(k) = at.df;
    }
    f = pair.forces(W).on_k();
    out.r.noalias() = frames.B.transpose() * f;
  }
};

}  // namespace mbd
