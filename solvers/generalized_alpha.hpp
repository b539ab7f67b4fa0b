// Index-3 Lie-group generalized-alpha (formulation.md 4; Arnold & Bruels 2007; HB 43-46).
//
//   H_f = H_i exp(Q),   Q = h V_i + h^2 [ (1/2 - beta) A_i + beta A_f ],
//   V_f = V_i + h [ (1 - gamma) A_i + gamma A_f ],
//   (1 - alpha_m) A_f + alpha_m A_i = (1 - alpha_f) Vdot_f + alpha_f Vdot_i,
//   r(H_f, V_f, Vdot_f, lambda_f, t_f) = 0, constraints at position level;                            (1)
//   alpha_m = (2 rho - 1)/(rho + 1), alpha_f = rho/(rho + 1), gamma = 1/2 + alpha_f - alpha_m,
//   beta = (gamma + 1/2)^2 / 4.
// Newton on body-frame increments dU with dQ = T^-1(Q) dU, scaled by s = beta h^2 (Bottasso, Bauchau,
// Cardona): unknowns [dU; s dlambda],
//   [ s K + ((1 - alpha_m)/(1 - alpha_f) M + gamma h C) T^-1(Q) , B^T ; B , 0 ] = -[ s r_dyn ; g ]     (2)
// with K = dr/dU, C = dr/dV, M = dr/dVdot.
//
// The factorisation is kept as long as the measured contraction theta is good (speed.md): with e the size
// of an increment in tolerances, theta = max(e_k/e_(k-1), 0.3 theta, 0.1), stop when
// e min(1, theta/(1 - theta)) < 1; accepting after one iteration doubles theta, because nothing was
// measured. Predictor: Vdot linear, lambda quadratic in time.
#pragma once

#include <memory>
#include <vector>

#include "libmbd/core/system.hpp"
#include "solvers/increments.hpp"
#include "solvers/report.hpp"

namespace mbd {

struct GeneralizedAlphaOptions {
  double step = 0.0;          // h [s]
  double rho_infinity = 0.0;  // [0, 1]
  NewtonOptions newton;
};

// The four parameters of (1).
struct GeneralizedAlphaParameters {
  double alpha_m, alpha_f, gamma, beta;
};
GeneralizedAlphaParameters generalized_alpha_parameters(double rho_infinity);

class GeneralizedAlpha {
 public:
  // Throws Error for a step that is not positive or rho_infinity outside [0, 1]. Refers to `system`.
  GeneralizedAlpha(const System& system, std::unique_ptr<LinearSolver> solver,
                   const GeneralizedAlphaOptions& options);

  // Consistent accelerations and multipliers at state.t (the state must satisfy its constraints at
  // position and velocity level: check_initial_state), and the algorithmic acceleration. Also after a
  // user has changed the state, or at a jump of a load.
  StepReport start(State& state);

  // From t to t + h; on failure the state is as before.
  StepReport step(State& state);

  const Counters& counters() const { return counters_; }
  const LinearSolver& linear_solver() const { return *solver_; }

 private:
  void predict(const State& state, double t, bool extrapolate);
  void update_poses();
  bool factorize(StepReport& report, bool& in_range);
  bool iterate(StepReport& report);
  void accept(State& state);

  const System& system_;
  std::unique_ptr<LinearSolver> solver_;
  GeneralizedAlphaOptions options_;
  GeneralizedAlphaParameters a_;
  IncrementNorm norm_;
  Counters counters_;

  State begin_, end_;           // of the step under way
  std::vector<Vec6> Q_;         // H_f = H_i exp(Q)
  std::vector<Vec6> A_;         // algorithmic acceleration at the last accepted time
  std::vector<Vec6> A_end_;     // predicted, at the end of the step
  std::vector<Vec6> Vdot_old_;  // at the accepted time before the last
  VecX lambda_old_, lambda_older_;
  double start_time_ = 0.0;  // [s]
  long history_ = 0;         // accepted steps since start()
  std::vector<Mat6> T_inv_;  // T^-1(Q) by node
  VecX r_, x_;
  bool factored_ = false;
  bool refactor_next_ = true;
  double theta_ = 0.1;  // contraction of the kept tangent
};

}  // namespace mbd
