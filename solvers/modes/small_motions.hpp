// Small motions u about a state in which each node rests or turns steadily (accelerations Vdot = 0 in body axes), in
// axes at each node that turn with the twist W of its own choice, g from them to body axes:
//   H = H0 exp(Ad(g^-1) u),   dV = Ad(g^-1)(u' + W~ u),   dVdot = Ad(g^-1)(d/dt - (V - W)~)(u' + W~ u)     (HB 15)
//   M u'' + C u' + K u + B^T dlambda = 0,   B u = 0                                                 (1)
//   K = dr/dU + dr/dV W~ - dr/dVdot (V - W)~ W~,   C = dr/dV + dr/dVdot (2W - V)~,   M = dr/dVdot
// Everything the residual knows is in them: geometric stiffness of resultants and multipliers, centrifugal and
// gyroscopic terms, damping, follower loads. Constraints stay constraints; there is no penalty. W = V: body axes. (1) has
// constant coefficients where what turns otherwise than its axes is alike in all directions (steady_rotation.hpp).
#pragma once

#include <Eigen/SparseCore>
#include <complex>
#include <memory>
#include <span>
#include <string>

#include "libmbd/core/system.hpp"
#include "solvers/linear/pencil_solver.hpp"
#include "solvers/modes/motion_pencil.hpp"

namespace mbd {

class SmallMotions final : public MotionPencil {
 public:
  // `system` has rates (System::with_rates) and outlives this.
  explicit SmallMotions(const System& system);

  // Assembles (1) about a state; its Vdot is not used. `axes`: W by node, body axes; empty: those of the state, W = V.
  // False if an element is out of range.
  bool about(const State& state, std::span<const Vec6> axes = {});
  // About a state on its way, in body axes and with its Vdot, as if K, C, M and B stayed as they are: K gets dr/dVdot Vdot~.
  bool frozen_at(const State& state);

  Index motions() const override { return motions_; }    // 6 for each node but the ground
  Index unknowns() const { return system_.unknowns(); }  // and the multipliers
  double length_scale() const override { return system_.length_scale(); }
  const System& system() const { return system_; }
  const State& state() const { return state_; }  // it is assembled about
  const VecX& residual() const { return r_; }    // of the state, as System::residual

  bool is_damped_or_turns() const override { return has_rates_; }
  bool is_symmetric() const;  // K and C are, but for round-off of their diagonals
  double stiffness() const { return stiffness_; }  // largest entry of K [N/m] (largest_stiffness)
  double mass() const { return mass_; }            // the same of M [kg]

  using MotionPencil::mass_times;
  using MotionPencil::rate_times;
  Eigen::MatrixXd mass_times(const Eigen::MatrixXd& X) const override { return M_ * X; }
  Eigen::MatrixXd rate_times(const Eigen::MatrixXd& X) const override { return C_ * X; }

  // (1) as matrices, of motions and multipliers; without zeros.
  const Eigen::SparseMatrix<double>& mass_matrix() const { return M_; }
  const Eigen::SparseMatrix<double>& rate_matrix() const { return C_; }
  Eigen::SparseMatrix<double> stiffness_matrix() const { return nonzeros(0); }
  Eigen::SparseMatrix<double> constraint_gradient() const;

  // B x: how motions open constraints.
  VecX opening(const VecX& x) const;

  // Adds a spring to K that holds one of the motions, as stiff as the stiffest. Until the next about().
  void hold(Index motion);

  bool factor(double s) override;
  bool factor(std::complex<double> s) override;
  void solve(Eigen::MatrixXd& B) const override { solve_columns(B); }
  void solve(Eigen::MatrixXcd& B) const override { solve_columns(B); }
  // The motions of Q^-T [b; 0], of a complex shift.
  VecXc solve_transposed(const VecXc& b) const;
  // x = Q^-1 b, of all unknowns; scaled rows and multipliers are this function's business.
  void solve_all(VecX& b) const;
  double reciprocal_condition() const { return pencil_->reciprocal_condition(); }

 private:
  Eigen::SparseMatrix<double> nonzeros(int power) const;
  bool assemble(std::span<const Vec6> axes);
  template <class Change>
  void each_block(const Change& change) const;
  void turn_axes(std::span<const Mat6> W_hat);
  void accelerate();
  template <class Columns>
  void solve_columns(Columns& B) const;

  const System& system_;
  std::unique_ptr<PencilSolver> pencil_;
  Index motions_;
  State state_;
  VecX r_;
  Eigen::SparseMatrix<double> M_, C_;  // of motions alone, without zeros
  bool has_rates_ = false;
  double stiffness_ = 0.0, mass_ = 0.0, scale_ = 1.0;
};

}  // namespace mbd
