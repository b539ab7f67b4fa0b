// What springs and dampers between two points share: the line from point a of node P to point b of node Q.
//
// c_a, c_b are the points in the axes of their nodes; n is the unit vector from a to b and l their distance.
//   p = r + R c,   dp = P dU,   P = R [ I  -c~ ]  (3x6),   dU = [u; psi] of the node                 (1)
//   dl = n.(dp_b - dp_a) = h.dU,   h = [ -P_a^T n ; P_b^T n ]  (12)                                  (2)
//   dn = (I - n n^T)/l (dp_b - dp_a)                                                                 (3)
// A tension T pulls with r = T h (internal force: conjugate to dU, in body frames), and with
// y = v + w x c the velocity of a point in its node's axes, l' = n.(R_b y_b - R_a y_a).
// At fixed T the wrench changes with the direction of the line and with the axes of the nodes:
//   dr = T dh = [ -P_a^T ; P_b^T ] T dn + T [ 0  (-[I; c~] n_a~) psi_a ; 0  ([I; c~] n_b~) psi_b ],
//   n_a = R_a^T n, n_b = R_b^T n                                                                     (4)
// Frames: nodes P and Q; inertial where products of R appear. Units: SI.
// Limit: n is not defined at l = 0; less than 1e-9 of a reference distance is out of range.
// Not used: the relative pose g and pair_tangent of metrics.hpp; a line knows nothing of the relative
// rotation, and (4) has fewer products.
#pragma once

#include "elements/element.hpp"

namespace mbd::two_points {

inline constexpr double shortest = 1e-9;  // of the reference distance

// Where the points are.
struct Ends {
  Vec3 a, b;              // c_a, c_b                                [m]
  double distance = 1.0;  // of a and b in the reference configuration [m]
};

template <class S>
using Output = ElementOutput<S, 2>;

template <class S>
struct Line {
  using Vector12 = Matrix<S, 12, 1>;
  using Square = typename Output<S>::Square;

  Matrix3<S> Ra, Rb;
  Vector3<S> ca, cb;
  Vector3<S> n;  // inertial
  S l;
  Vector12 h;

  // Not inlined: residuals are the same to the last bit with and without the tangent.
  [[gnu::noinline]] Line(const Ends& ends, const NodeState<S>* x)
      : Ra(x[0].H.R()),
        Rb(x[1].H.R()),
        ca(ends.a.template cast<S>()),
        cb(ends.b.template cast<S>()) {
    using std::sqrt;
    const Vector3<S> d = x[1].H.r + Rb * cb - (x[0].H.r + Ra * ca);
    l = sqrt(S(d.squaredNorm()));
    n = d / l;
    const Vector3<S> na = Ra.transpose() * n, nb = Rb.transpose() * n;
    h << -na, -ca.cross(na), nb, cb.cross(nb);
  }

  S margin(const Ends& ends) const { return l / S(ends.distance) - S(shortest); }

  // Velocities of the points, node axes, and that of the distance.
  Vector3<S> velocity_a(const NodeState<S>* x) const {
    return linear(x[0].V) + angular(x[0].V).cross(ca);
  }
  Vector3<S> velocity_b(const NodeState<S>* x) const {
    return linear(x[1].V) + angular(x[1].V).cross(cb);
  }
  S rate(const NodeState<S>* x) const {
    return n.dot(Vector3<S>(Rb * velocity_b(x) - Ra * velocity_a(x)));
  }

  // Gradient of the rate with respect to dU at fixed velocities: by (3) and by d(R y) = R (psi x y).
  Vector12 rate_gradient(const NodeState<S>* x) const {
    const Vector3<S> ya = velocity_a(x), yb = velocity_b(x);
    const Vector3<S> relative = Rb * yb - Ra * ya;
    const Vector3<S> q = (relative - n * n.dot(relative)) / l;
    const Vector3<S> qa = Ra.transpose() * q, qb = Rb.transpose() * q;
    Vector12 gradient;
    gradient << -qa, -ca.cross(qa) - ya.cross(-h.template head<3>()), qb,
        cb.cross(qb) + yb.cross(h.template segment<3>(6));
    return gradient;
  }

  // (4) at the tension T.
  void geometric(const S& T, Square& K) const {
    Matrix<S, 3, 6> Pa, Pb;
    Pa << Ra, -(Ra * hat(ca));
    Pb << Rb, -(Rb * hat(cb));
    const Matrix3<S> across = (T / l) * (Matrix3<S>::Identity() - n * n.transpose());
    const Matrix<S, 3, 6> Sa = across * Pa, Sb = across * Pb;
    K.template block<6, 6>(0, 0).noalias() = Pa.transpose() * Sa;
    K.template block<6, 6>(0, 6).noalias() = -(Pa.transpose() * Sb);
    K.template block<6, 6>(6, 0).noalias() = -(Pb.transpose() * Sa);
    K.template block<6, 6>(6, 6).noalias() = Pb.transpose() * Sb;
    const Matrix3<S> Na = T * hat(Vector3<S>(h.template head<3>())),  // of -n_a
        Nb = T * hat(Vector3<S>(h.template segment<3>(6)));
    K.template block<3, 3>(0, 3) += Na;
    K.template block<3, 3>(3, 3) += hat(ca) * Na;
    K.template block<3, 3>(6, 9) += Nb;
    K.template block<3, 3>(9, 9) += hat(cb) * Nb;
  }
};

}  // namespace mbd::two_points
