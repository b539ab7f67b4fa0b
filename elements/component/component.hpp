// A part of a structure whose small deformations are component modes: n nodes with all that moves between them, as one
// element (Craig, Bampton, "Coupling of substructures for dynamic analyses", AIAA Journal 6, 1968; on SE(3) Sonneville, Brüls,
// "A formulation on the special Euclidean group for dynamic analysis of multibody systems", J. Comput. Nonlinear Dynam. 9,
// 2014). Node 0 carries the frame that floats with it: deformations are small, motions of it need not be.
//
// Motion:   node k has g_k = A_k^-1 H_0^-1 H_k, the identity where nothing is deformed;  u_k = log g_k      (1)
// Energy:   E = u.K u/2,   u = [u_1 … u_n-1]                                                              (2)
// Force:    W = K u + C u' - P^T b,   b = R_0^T a,   on the pair (0, k) as a bushing's (bushing.hpp (2)),
//           u_k' = T^-1(u_k) z_k                                                                          (3)
//           and on node 0   -[ m b ; s x b ],   s = S_0 + P u                                             (4)
// Inertia:  r_k = (M V')_k - V_k~^T (M V)_k,   V = [V_0 … V_n-1] in body axes                              (5)
// Symbols: K [N/m, N, N.m], C the same times s: symmetric, positive (semi)definite, 6(n-1); M [kg, kg.m, kg.m2] and
// M_a [kg/s …], 6n, of velocities of all nodes, M_a V being damping; a: acceleration of gravity less that of the base,
// inertial [m/s2]; m [kg] and static moment S_0 + P u about node 0, its axes [kg.m]: of the part as it is deformed.
//
// M is that of velocities in body axes, and has no pose in it: rigid motion has exactly its mass, momenta of free parts and
// energy are kept exactly. (3), (4) are gradients of E - a.(m r_0 + R_0 s). M and K are those where nothing is deformed. What
// forces do to the stiffness comes from (1) alone, and is only about right: a cantilever's end, whose place is
// v + phi x v/2, comes nearer by 3/4 w^2/L where a beam's does by 3/5 (more parts come nearer to that; more modes do not).
// So answers are wrong by about a third of what forces change of the stiffness: ComponentBatch::geometric_shares().
// Tangents: bushing.hpp (3), bushing_damper.hpp (3), mass.hpp (1); db = b~ psi_0.
// Limit: relative rotations as of a bushing.
#pragma once

#include <span>
#include <vector>

#include "elements/pair/bushing_damper.hpp"

namespace mbd::component {

template <class S>
using VectorX = Eigen::Matrix<S, Eigen::Dynamic, 1>;
template <class S>
using MatrixX = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
using MatX = Eigen::MatrixXd;

struct Data {
  std::vector<Pose<double>> A;  // of nodes 1 to n-1, in node 0
  MatX K, C, M_a;               // C, M_a: 0 x 0 for none
  double mass = 0.0;
  Vec3 static_moment = Vec3::Zero();  // S_0
  MatX P;                             // 3 x 6(n-1)

  Index nodes() const { return static_cast<Index>(A.size()) + 1; }
};

// Residual and its derivatives by the motion at fixed velocities, and by velocities.
template <class S>
struct Output {
  VectorX<S> r;
  MatrixX<S> K, D_V;
};

template <class S>
VectorX<S> velocities(std::span<const NodeState<S>> x) {
  VectorX<S> V(6 * static_cast<Index>(x.size()));
  for (std::size_t k = 0; k < x.size(); ++k)
    V.template segment<6>(6 * static_cast<Index>(k)) = x[k].V;
  return V;
}

// (5) without damping; with a momentum rate c (State::momentum_rate, mass.hpp (2)) c M V. M V comes back in p.
// Not inlined: the same to the last bit with and without the tangent.
template <class S>
[[gnu::noinline]] void inertia_residual(const MatX& M, std::span<const NodeState<S>> x, double rate,
                                        VectorX<S>& p, VectorX<S>& r) {
  p = M.template cast<S>() * velocities(x);
  if (rate != 0.0) {
    r = S(rate) * p;
    return;
  }
  VectorX<S> Vdot(p.size());
  for (std::size_t k = 0; k < x.size(); ++k)
    Vdot.template segment<6>(6 * static_cast<Index>(k)) = x[k].Vdot;
  r = M.template cast<S>() * Vdot;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const auto i = 6 * static_cast<Index>(k);
    r.template segment<6>(i) -=
        twist_hat_transpose_times(x[k].V, Vector6<S>(p.template segment<6>(i)));
  }
}

// Its derivative by velocities, p = M V; that by accelerations is M, or with a momentum rate 0.
MatX inertia_tangent(const MatX& M, std::span<const NodeState<double>> x, double rate,
                     const VecX& p);

// (1) and what follows from it, of one motion of the nodes.
template <class S>
class Motion {
 public:
  Motion(const Data& data, std::span<const NodeState<S>> x) : data_(data), x_(x) {
    const Index n = data.nodes();
    u_.resize(6 * (n - 1));
    rate_.resize(6 * (n - 1));
    for (Index k = 0; k + 1 < n; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const std::array<NodeState<S>, 2> ends{x[0], x[i + 1]};
      frames_.emplace_back(two_frames::Ends{data.A[i], {}}, ends.data());
      pairs_.emplace_back(frames_.back().g);
      z_.push_back(frames_.back().twist(ends.data()));
      y_.push_back(frames_.back().twist_of_a(ends.data()));
      T_.push_back(pairs_.back().T_inverse());
      u_.template segment<6>(6 * k) = pairs_.back().q();
      rate_.template segment<6>(6 * k) = T_.back() * z_.back();
    }
    b_.setZero();
  }

  const VectorX<S>& u() const { return u_; }          // (1) [m, rad]
  const VectorX<S>& u_rate() const { return rate_; }  // u' of (3)
  // Its static moment, (4).
  Vector3<S> static_moment() const {
    return data_.static_moment.template cast<S>() + Vector3<S>(data_.P.template cast<S>() * u_);
  }

  // Residual; how far from the limit, which is not positive beyond it.
  // Not inlined: the same to the last bit with and without the tangent.
  [[gnu::noinline]] S residual(const Vec3& a, VectorX<S>& r) {
    const Index n = data_.nodes();
    r.setZero(6 * n);
    b_ = rotated_back<S>(x_[0].H.p, Vector3<S>(a.template cast<S>()));
    W_ = data_.K.template cast<S>() * u_ - data_.P.transpose().template cast<S>() * b_;
    if (data_.C.size() > 0) W_ += data_.C.template cast<S>() * rate_;
    s_ = static_moment();
    r.template head<6>() = six<S>(S(-data_.mass) * b_, b_.cross(s_));
    S margin(1);
    f_.clear();
    for (Index k = 0; k + 1 < n; ++k) {
      const auto i = static_cast<std::size_t>(k);
      f_.push_back(pairs_[i].forces(Vector6<S>(W_.template segment<6>(6 * k))).on_k());
      r.template head<6>() += frames_[i].B.template leftCols<6>().transpose() * f_.back();
      r.template segment<6>(6 * k + 6) +=
          frames_[i].B.template rightCols<6>().transpose() * f_.back();
      const S left = pairs_[i].e0 - S(bushing::limit());
      if (left < margin) margin = left;
    }
    if (data_.M_a.size() > 0) r += data_.M_a.template cast<S>() * velocities<S>(x_);
    return margin;
  }

  // After residual(): the geometric stiffness of nodes 1 to n-1 under forces of fixed directions that are in equilibrium with
  // theirs, node 0 held; its symmetric part.
  MatX geometric_stiffness() const requires std::is_same_v<S, double> {
    const Index m = u_.size();
    MatX all = MatX::Zero(m, m), E(m, m + 6), E_rate(m, m + 6), K = MatX::Zero(m + 6, m + 6);
    for (Index k = 0; k + 1 < data_.nodes(); ++k) {
      pair_tangent(k, false, E, E_rate, K);
      const Index j = 6 * k;
      const Vec6 f = frames_[static_cast<std::size_t>(k)].B.template rightCols<6>().transpose() *
                     f_[static_cast<std::size_t>(k)];
      Mat6 own = K.block<6, 6>(j + 6, j + 6);
      own.block<3, 3>(0, 3) -= hat(Vec3(f.head<3>()));
      all.block<6, 6>(j, j) = 0.5 * (own + own.transpose());
    }
    return all;
  }

  // After residual().
  void tangent(Output<S>& out) const {
    const Index n = data_.nodes(), m = 6 * (n - 1);
    out.K.setZero(6 * n, 6 * n);
    out.D_V.setZero(6 * n, 6 * n);
    MatrixX<S> E = MatrixX<S>::Zero(m, 6 * n);
    MatrixX<S> E_rate = MatrixX<S>::Zero(m, 6 * n);
    const bool damped = data_.C.size() > 0;
    for (Index k = 0; k + 1 < n; ++k) pair_tangent(k, damped, E, E_rate, out.K);
    MatrixX<S> dW = data_.K.template cast<S>() * E;
    if (damped) dW += data_.C.template cast<S>() * E_rate;
    const Matrix3<S> b_hat = hat(b_);
    const MatrixX<S> P = data_.P.template cast<S>();
    dW.template middleCols<3>(3) -= P.transpose() * b_hat;
    out.K += E.transpose() * dW;
    out.K.template block<3, 3>(0, 3) -= S(data_.mass) * b_hat;
    out.K.template block<3, 3>(3, 3) -= hat(s_) * b_hat;
    out.K.template middleRows<3>(3) += b_hat * (P * E);
    if (damped) out.D_V = E.transpose() * (data_.C.template cast<S>() * E);
    if (data_.M_a.size() > 0) out.D_V += data_.M_a.template cast<S>();
  }

 private:
  // du_k/dU, du_k'/dU, and the geometric stiffness of the wrench on a pair.
  void pair_tangent(Index k, bool damped, MatrixX<S>& E, MatrixX<S>& E_rate, MatrixX<S>& K) const {
    const auto i = static_cast<std::size_t>(k);
    const auto& B = frames_[i].B;
    const Matrix6<S> T = T_[i].matrix();
    const auto set = [&](MatrixX<S>& all, const Matrix6<S>& of) {
      all.template block<6, 6>(6 * k, 0) = of * B.template leftCols<6>();
      all.template block<6, 6>(6 * k, 6 * k + 6) = of * B.template rightCols<6>();
    };
    set(E, T);
    if (damped)
      set(E_rate, Matrix6<S>(bushing::parameter_gradient(frames_[i].g, z_[i]) * T -
                             T * twist_hat<S>(y_[i])));
    typename two_frames::Frames<S>::Square pair;
    frames_[i].tangent(
        f_[i], linearized_force(pairs_[i], T_[i], Vector6<S>(W_.template segment<6>(6 * k))), pair);
    const Index j = 6 * k + 6;
    K.template block<6, 6>(0, 0) += pair.template block<6, 6>(0, 0);
    K.template block<6, 6>(0, j) += pair.template block<6, 6>(0, 6);
    K.template block<6, 6>(j, 0) += pair.template block<6, 6>(6, 0);
    K.template block<6, 6>(j, j) += pair.template block<6, 6>(6, 6);
  }

  const Data& data_;
  std::span<const NodeState<S>> x_;
  std::vector<two_frames::Frames<S>> frames_;
  std::vector<bushing::Pair::Pair<S>> pairs_;
  std::vector<DualMatrix<S>> T_;
  std::vector<Vector6<S>> z_, y_, f_;
  VectorX<S> u_, rate_, W_;
  Vector3<S> b_, s_;
};

}  // namespace mbd::component
