// What acts between two frames a, b fixed to nodes P, Q: bushings here, springs and torques of joints in
// joints/. A force is a wrench f on b, in b, at its origin, and what it exerts on a is its opposite.
//
//   g = H_a^-1 H_b,   zeta = B dU the increment of g in b,   B = [ -Ad(g^-1) Ad(a^-1)  Ad(b^-1) ]  (6x12)   (1)
//   z = B V the relative twist, with the frames' own twists: z = V_b - y,  y = Ad(g^-1) V_a                 (2)
//   r = B^T f                                                                                               (3)
//   dr = B^T L zeta + [ (Ad(g^-1) Ad(a^-1))^T f^U zeta ; 0 ],   L = df/dzeta (all of it)                    (4)
//   at fixed V:  dz = -y~ zeta                                                                              (5)
// (4) is metrics.hpp (4), carried to the nodes. a, b: poses of the frames in their nodes; f^U, y~: se3.hpp.
#pragma once

#include "elements/element.hpp"
#include "elements/metrics.hpp"

namespace mbd::two_frames {

struct Ends {
  Pose<double> a, b;  // H_P^-1 H_a and H_Q^-1 H_b
};

template <class S>
using Output = ElementOutput<S, 2>;

template <class S>
struct Frames {
  using Square = typename Output<S>::Square;

  Pose<S> g;
  Matrix<S, 6, 12> B;

  // Not inlined: residuals are the same to the last bit with and without the tangent.
  [[gnu::noinline]] Frames(const Ends& ends, const NodeState<S>* x) {
    const Pose<S> a = ends.a.template cast<S>(), b = ends.b.template cast<S>();
    g = relative(x[0].H * a, x[1].H * b);
    B << -(adjoint_inverse(g).matrix() * adjoint_inverse(a).matrix()), adjoint_inverse(b).matrix();
  }

  // z of (2).
  Vector6<S> twist(const NodeState<S>* x) const {
    return B.template leftCols<6>() * x[0].V + B.template rightCols<6>() * x[1].V;
  }
  // y of (2).
  Vector6<S> twist_of_a(const NodeState<S>* x) const {
    return -(B.template leftCols<6>() * x[0].V);
  }

  void tangent(const Vector6<S>& f, const Matrix6<S>& L, Square& K) const {
    K.noalias() = B.transpose() * (L * B);
    K.template topRows<6>() -= B.template leftCols<6>().transpose() * (wrench_hat<S>(f) * B);
  }
  // V dr/dz B of a wrench with df/dz = C.
  void rate_tangent(const S& V, const Matrix6<S>& C, Square& D) const {
    D.noalias() = B.transpose() * ((V * C) * B);
  }
};

}  // namespace mbd::two_frames
