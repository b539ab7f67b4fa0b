#include "solvers/time/free_momenta.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "libmbd/core/se3.hpp"
#include "solvers/constraints/parts.hpp"
#include "solvers/time/archive.hpp"

namespace mbd {
namespace {

constexpr double round_off = 1e-9;

// M of each node, column by column: momenta are linear in velocities. Of a node whose momentum depends on how others move
// (component modes) what it is in those motions; `by_itself` says of which it does not.
std::vector<Mat6> mass_matrices(const System& system, std::vector<char>& by_itself) {
  const auto n = static_cast<std::size_t>(system.nodes());
  std::vector<Mat6> M(n, Mat6::Zero());
  std::vector<Vec6> p(n);
  State state = system.reference_state();
  for (int k = 0; k < 6; ++k) {
    for (Vec6& V : state.V) V = Vec6::Unit(k);
    system.momenta(state, p);
    for (std::size_t i = 1; i < n; ++i) M[i].col(k) = p[i];
  }
  by_itself.assign(n, 1);
  for (std::size_t i = 1; i < n; ++i)
    state.V[i] =
        Vec6::LinSpaced(1.0, 2.0) * (1.0 + 0.5 * std::sin(1.0 + 2.7 * static_cast<double>(i)));
  system.momenta(state, p);
  for (std::size_t i = 1; i < n; ++i) {
    const Vec6 own = M[i] * state.V[i];
    by_itself[i] = (p[i] - own).norm() <= round_off * (p[i].norm() + own.norm()) ? 1 : 0;
  }
  return M;
}

// The part of dL that turns the body; about an axis without inertia there is none.
Vec3 turn(const Mat3& J, const Vec3& dL) {
  constexpr double no_inertia = 1e-12;
  const Eigen::SelfAdjointEigenSolver<Mat3> principal(J);
  const Vec3& moments = principal.eigenvalues();
  Vec3 x = principal.eigenvectors().transpose() * dL;
  for (int i = 0; i < 3; ++i) x(i) = moments(i) > no_inertia * moments(2) ? x(i) / moments(i) : 0.0;
  return principal.eigenvectors() * x;
}

}  // namespace

FreeMomenta::FreeMomenta(const System& system) {
  const ConnectedParts parts = find_parts(system);
  if (!parts.any_free()) return;
  std::vector<char> by_itself;
  const std::vector<Mat6> M = mass_matrices(system, by_itself);
  for (int k = 0; k < parts.count(); ++k) {
    if (parts.is_held[static_cast<std::size_t>(k)] != 0) continue;
    Part part;
    bool has_masses_only = true;
    for (std::size_t n = 1; n < M.size(); ++n) {
      if (parts.of_node[n] != k) continue;
      Node node{.node = static_cast<Index>(n), .M = M[n], .mass = M[n](0, 0)};
      // [m I, -m c~; m c~, J]
      const Mat3 moment = M[n].bottomLeftCorner<3, 3>();
      if (node.mass > 0.0) node.center = Vec3(moment(2, 1), moment(0, 2), moment(1, 0)) / node.mass;
      const double size = round_off * M[n].cwiseAbs().maxCoeff();
      has_masses_only =
          has_masses_only && by_itself[n] != 0 &&
          ((M[n].topLeftCorner<3, 3>() - node.mass * Mat3::Identity()).cwiseAbs().maxCoeff() <=
           size) &&
          ((moment - node.mass * hat(node.center)).cwiseAbs().maxCoeff() <= size);
      part.mass += node.mass;
      part.nodes.push_back(node);
    }
    if (has_masses_only && part.mass > 0.0) parts_.push_back(std::move(part));
  }
}

FreeMomenta::Sums FreeMomenta::sums(const Part& part, const State& state) {
  Sums sum;
  for (const Node& node : part.nodes) {
    const Pose<double>& H = state.pose[static_cast<std::size_t>(node.node)];
    sum.C += node.mass / part.mass * (H.r + H.p * node.center);
  }
  for (const Node& node : part.nodes) {
    const auto n = static_cast<std::size_t>(node.node);
    Pose<double> H = state.pose[n];
    H.r -= sum.C;
    const Vec6 p = times(node.M, state.V[n]);
    sum.momentum += inertial_wrench<double>(H, p);
    sum.force += inertial_wrench<double>(
        H, times(node.M, state.Vdot[n]) - twist_hat_transpose_times<double>(state.V[n], p));
    // About the node, and then about C: J' = R J R^T - m (s~ d~ + d~ s~ + d~ d~), s from the node to its centre.
    const Mat3 R = H.R(), s = hat(Vec3(R * node.center)), d = hat(H.r);
    sum.J +=
        R * node.M.bottomRightCorner<3, 3>() * R.transpose() - node.mass * (s * d + d * s + d * d);
  }
  return sum;
}

void FreeMomenta::begin(const State& state) {
  for (Part& part : parts_) {
    const Sums now = sums(part, state);
    part.C = now.C;
    part.momentum = now.momentum;
    part.force = part.force_old = part.algorithmic = now.force;
  }
}

void FreeMomenta::scale(double ratio) {
  for (Part& part : parts_) part.algorithmic = part.force + ratio * (part.algorithmic - part.force);
}

void FreeMomenta::find_rate(double h) {
  for (Part& part : parts_) part.rate = (part.force - part.force_old) / h;
}

void FreeMomenta::lag(double by) {
  for (Part& part : parts_) part.algorithmic = part.force + by * part.rate;
}

void FreeMomenta::keep(const Scheme& s, double h, State& end, std::span<Vec6> Q) {
  for (Part& part : parts_) {
    const Sums is = sums(part, end);
    const Vec6 a =
        ((1.0 - s.alpha_f) * is.force + s.alpha_f * part.force - s.alpha_m * part.algorithmic) /
        (1.0 - s.alpha_m);
    const Vec3 C =
        part.C + h / part.mass * part.momentum.head<3>() +
        h * h / part.mass * ((0.5 - s.beta) * part.algorithmic.head<3>() + s.beta * a.head<3>());
    const Vec6 momentum = part.momentum + h * ((1.0 - s.gamma) * part.algorithmic + s.gamma * a);
    const Vec3 dC = C - is.C, dv = (momentum - is.momentum).head<3>() / part.mass;
    const Vec3 dw = turn(is.J, (momentum - is.momentum).tail<3>());
    for (const Node& node : part.nodes) {
      const auto n = static_cast<std::size_t>(node.node);
      Pose<double>& H = end.pose[n];
      const Quaternion<double> back = H.p.conjugate();
      end.V[n].head<3>() += back * Vec3(dv + dw.cross(H.r - is.C));
      end.V[n].tail<3>() += back * dw;
      H.r += dC;
      Vec6 dU = Vec6::Zero();
      dU.head<3>() = back * dC;
      Q[n] += T_inverse_times<double>(Q[n], dU);
    }
    part.C = C;
    part.momentum = momentum;
    part.force_old = part.force;
    part.force = is.force;
    part.algorithmic = a;
  }
}

void FreeMomenta::archive(Archive& a) {
  for (Part& part : parts_)
    a(part.C, part.momentum, part.force, part.force_old, part.rate, part.algorithmic);
}

}  // namespace mbd
