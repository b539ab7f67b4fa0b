// Radau IIA of s = 3, 5 or 7 stages (order 2s - 1) on SE(3), constraints at velocity level, with projection.
//
// In a step each node moves in local coordinates about the motion that it would go on with,
// H(t) = H_i exp((t - t_i) V_i) exp(q): q stays small, V = V_i + T(q) (q' - q~ V_i). The stages at
// t_j = t_i + c_j h satisfy, with D = A^-1 of the tableau (radau_tableau.hpp),
//   q'_j = 1/h sum_l D_jl q_l,   V_j = V_i + T(q_j) (q'_j - q_j~ V_i),   Vdot_j = 1/h sum_l D_jl (V_l - V_i),
//   r(H_j, V_j, Vdot_j, lambda_j, t_j) = 0,   gdot(H_j, V_j, t_j) = 0;                              (1)
// the last stage is the end of the step. The unknowns are q_j and lambda_j: rates follow exactly.
// (With q about the fixed pose H_i, the Newton matrix of (2) is wrong by h omega: twice the iterations where
// things spin.)
//
// Simplified Newton on body-frame increments dU with dq = T^-1(q) dU. With dV = d/dt dU + V~ dU the stages
// share K = dr/dU, C = dr/dV, M = dr/dVdot and V_i~, and D = T diag(gamma, mu, mu*, …) T^-1 uncouples them:
//   [ s (P0 + x P1 + x^2 P2) , B^T ; B , 0 ] [ W ; s dL ] = -[ s T^-1 r ; T^-1 gdot / x ],          (2)
//   P0 = K + C V~,  P1 = C + M V~,  P2 = M,   x = gamma/h (real) and each mu/h (complex),  s = (h/gamma)^2.
// (2) leaves out how B turns as the node moves. P0, P1, P2 are kept from step to step while the iterations
// contract, and factorised anew for another h.
//
// Position constraints: gdot = 0 at the stages leaves g of the order of the local error. It is removed after
// each step by the smallest motion, and change of velocity, in the norm of the real matrix of (2); both
// constraints hold to round-off, and the order is kept.
//
// Error estimate (IV.8): e_Q, e_V from one solve with the real matrix,
//   E(gamma/h) [e_Q ; .] = [ M dV + (C + gamma/h M) dQ ; h/gamma B dQ ],   e_V = (gamma/h + V~) e_Q - dQ,
//   dQ = 1/h sum e_l q_l,   dV = Vdot_i + 1/h sum e_l (V_l - V_i),
// of order h^(s + 1); e of three stages is -1/3 (13 + 7 sqrt 6, 13 - 7 sqrt 6, 1).                    (3)
// The step goes on with the solution of order 2s - 1; rows inside steps err by h^(s + 2) (dense_output.hpp). The tolerance
// of (3) is taken as tolerance^((s + 1)/(s + 2)) times a constant, so that errors of rows go with the tolerance.
//
// Near a singular configuration, where velocities can meet their constraints only if positions do, a step that
// fails is tried with -eps I in place of the zero block (one_step.hpp).
//
// Orders: 2s - 1 of the motion, and of velocities; s of multipliers and accelerations (index 2; Hairer, Lubich,
// Roche 1989). Dense output: dense_output.hpp.
//
// The number of stages is given, or of adaptive steps chosen as they go (radau_stages.hpp); fixed steps that leave it open
// have three.
// Stiffly accurate and L-stable: what is faster than the step resolves is damped.
// Not used: constraints at position level, which lower the order of velocities to 3; stabilising multipliers
// (Gear, Gupta, Leimkuhler), which add unknowns that are zero.
#pragma once

#include <array>
#include <complex>
#include <memory>
#include <utility>
#include <vector>

#include "libmbd/core/choices.hpp"
#include "libmbd/core/system.hpp"
#include "solvers/linear/pencil_solver.hpp"
#include "solvers/newton/kept_resultants.hpp"
#include "solvers/newton/kept_tangent.hpp"
#include "solvers/time/collocation_step.hpp"
#include "solvers/time/dense_output.hpp"
#include "solvers/time/one_step.hpp"
#include "solvers/time/radau_tableau.hpp"

namespace mbd {

class RadauStages;

struct RadauOptions {
  double step = 0.0;  // h [s]; 0: adaptive, by the tolerances
  ErrorTolerances tolerances{};
  double end = 0.0;        // [s] of adaptive steps
  std::size_t stages = 3;  // 3, 5 or 7; 0: chosen as it goes
  double max_step = 0.0;   // [s] of adaptive ones; 0: a twentieth of the time until the end
  int max_halvings = 5;    // of a fixed step that fails
  // On increments of the stages, of motion as of velocities (newton.tolerance; of adaptive steps a hundredth of
  // the tolerance) and of multipliers. newton.tangent is not used: tangents are always kept.
  NewtonOptions newton{.tolerance = 1e-12, .multiplier_tolerance = 1e-9};
};

class Radau final : public OneStep {
 public:
  // `solver` is for the accelerations at the start and after jumps, `pencil` for the steps. Throws Error for
  // settings without sense. Refers to `system`.
  Radau(const System& system, std::unique_ptr<LinearSolver> solver,
        std::unique_ptr<PencilSolver> pencil, const RadauOptions& options);

  ~Radau() override;

  std::optional<RoundOff> round_off() override;
  LinearFacts linear_facts() const override { return pencil_->facts(); }

 private:
  static constexpr std::size_t most = RadauTableau::most_stages;
  using Stages = std::array<std::vector<Vec6>, most>;

  static Settings settings_with_newton(const RadauOptions& options);

  void begin_at(State& state) override;
  bool solve_step(double t, double h, StepReport& report) override;
  double estimated_error(bool again) override;
  void accept() override;
  double longest_from(const State& state) const override;
  void settle() override;
  void forget() override;
  void pass_failure(double h) override;
  const State& solved() const override { return stage_[last()]; }
  std::span<const State> inside() const override { return {stage_.data(), last()}; }

  std::string signature() const override;
  void archive(Archive& a) override;
  void take_new_tangent() override;
  void analyze_pencil();
  std::size_t last() const { return t_->stages - 1; }
  void use_stages(std::size_t stages);
  void choose_stages();
  std::string turns_too_far() const;  // what in this step, if anything
  void predict(bool extrapolate);
  template <std::size_t s>
  void extrapolate_of(std::size_t j);
  void update_stages();
  template <std::size_t s>
  void update_stages_of();
  bool residuals();
  bool linearize(const State& at, std::size_t stage);
  bool factorize(StepReport& report);
  bool has_crept() const;
  bool iterate(StepReport& report);
  bool make_ready(StepReport& report);
  template <std::size_t s>
  void set_right_sides();
  template <std::size_t s>
  void solve_pencils();
  // In tolerances: with what Newton's iterations take for round-off, and without.
  struct Increment {
    double floored = 0.0, exact = 0.0;
  };
  template <std::size_t s>
  Increment set_increments(double slack, double share);
  Increment increments(double slack, double share);
  void move_stages();
  static void note(double increment, StepReport& report);
  void explain_failure(StepReport& report);
  void explain_not_finite(StepReport& report) const;
  void estimate(bool filtered);
  template <std::size_t... l>
  void estimate_of(bool filtered, std::index_sequence<l...>);
  void project();
  void show(const std::array<Work, most>& power);
  double time_of(std::size_t stage) const;

  const std::size_t stages_;             // as asked for
  const RadauTableau* t_;                // of the stages of the step under way
  std::unique_ptr<RadauStages> choice_;  // of their number, where they may change
  std::unique_ptr<PencilSolver> pencil_;
  KeptTangent kept_;
  HermiteStep dense_;             // of three stages,
  CollocationStep dense_higher_;  // of more

  double h_ = 0.0;  // step under way [s]
  State moved_;
  std::array<State, most> stage_;
  Stages q_, dV_;            // dV = V - V_i
  std::vector<Vec6> carry_;  // what the last V has lost by round-off (Kahan)
  std::array<std::vector<Pose<double>>, most> reference_;  // H_i exp(c_j h V_i)
  std::vector<Vec6>
      Q_;  // of the whole step, H_f = H_i exp(Q), for an observer; before, scratch of project()
  std::array<VecX, most> r_, delta_;
  std::array<std::vector<std::complex<double>>, most / 2> z_;
  std::vector<Mat6> V_hat_;  // V~ by node, of the last linearisation
  std::vector<Vec6> eQ_, eV_;
  VecX x_, y_, g_, gdot_;

  KeptResultants mixed_;
  std::array<KeptResultants::Iterate, most> resultants_;

  // The last accepted step, from which stages are extrapolated.
  bool history_ = false;
  std::size_t stages_old_ = 3;
  double t_old_ = 0.0, h_old_ = 0.0;
  Stages q_old_;
  std::vector<Pose<double>> pose_old_;  // at its start
  std::vector<Vec6> V_old_;
  std::array<VecX, most> lambda_old_;
  std::array<std::vector<double>, most> S_old_;

  double stiffness_ = 0.0;         // largest entry of K [N/m], of the last linearisation
  std::array<long, 3> counted_{};  // iterations, tangents, factorisations until the last step
  bool linearized_ = false;        // P0, P1, P2 are there
  bool fresh_ = false;             // and of this step
  double factored_step_ = 0.0;     // h of the last factorisation; 0: none
  bool relinearize_next_ = true;
};

}  // namespace mbd
