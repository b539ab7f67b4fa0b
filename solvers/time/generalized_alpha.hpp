// Index-3 Lie-group generalized-alpha (NOTATION.md 4; Arnold & Bruels 2007; HB 43-46).
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
// The factorisation is kept as long as its contraction is good (kept_tangent.hpp). Predictor: Vdot linear, lambda
// quadratic in time.
//
// Balance of momenta (Balance::momentum). In (1) M Vdot - V~^T M V is the rate of the momentum M V seen
// from the moving node; a scheme that averages such rates lets the total drift at its own order. In
// inertial axes, about one point, mu = Ad(H)^-T M V has the plain rate mu' = f and internal forces cancel in
// the sum, so the same scheme on mu keeps the total to round-off. With a the algorithmic rate,
//   mu_f = mu_i + h [ (1 - gamma) a_i + gamma a_f ],
//   (1 - alpha_m) a_f + alpha_m a_i = (1 - alpha_f) f_f + alpha_f f_i,
// and V_f(Q) from (1) as before, inertia enters r as
//   Ad(H_f)^T f_f = c M V_f - Ad(H_f)^T p,   c = (1 - alpha_m) / ((1 - alpha_f) gamma h),             (3)
// p known from the last state. Linear systems give the same as (1). Angular momentum is kept too;
// energy is not (order 2, as in (1)).
//
// Parts that nothing ties to the ground may keep their momenta as a whole instead (free_momenta.hpp).
//
// Start. Forces that jump give a node of little mass, of which a finer mesh has many, an acceleration without
// bound; h A would make velocities ring about their course in proportion to it, for long with rho near 1. So the
// scheme goes on from
//   (M + h^2 K) A = M Vdot,   B A = B Vdot,                                                           (4)
// in place of A = Vdot: the same to order h^2 in what the step resolves, and the static response over h^2 in what
// it does not. Vdot of the state itself stays what the equations of motion say. With a balance of momenta,
// f = a takes M (A - Vdot), less what h^2 K adds to the sum over the nodes.
//
// Ringing. With constraints of positions alone, velocities normal to them, accelerations and multipliers follow a
// recursion of their own, that rho damps and what is not resolved feeds: near rho = 1 it may grow without bound, the
// faster the shorter a step that fails is cut. Where gdot rings (it changes sign from step to step, and is no small part
// of the motion) velocities are put on their constraints at each accepted step from then on, by the smallest change in
// the norm of (2): of order h^2, as the error is; and the accelerations of the first such step, and of each that
// fails, are made consistent anew. Beyond rho = 0.91 a step that fails is taken for ringing. A run in which nothing rings is
// what it would be without.
//
// Where the step changes, A - Vdot, which is proportional to h, is scaled with it; at a kink of a law it is 0, as the step
// after a short load may be many times one of those that resolved it, and A - Vdot from within it times h a kick.
// Landings, steps that fail, and rank-tolerant ones, with -eps I in place of the zero block of (2): one_step.hpp.
//
// Adaptive steps. With A(t) = Vdot(t + (alpha_m - alpha_f) h) to first order, (1) leaves of the motion
//   e = h^2 (beta - 1/6 - (gamma - 1/2)/2) (Vdot_f - Vdot_i) + O(h^4)                              (5)
// a step, which is of order h^3. What is stiffer than the step resolves is damped in it as in the step
// itself, e := S^-1 M' e with S and M' of (2). The error of the whole goes with h^2, so the tolerance of (5) is
// taken as tolerance^(3/2), times a constant: the error then goes with the tolerance. Velocities are not
// estimated: their error is of the same order.
#pragma once

#include <memory>
#include <vector>

#include "libmbd/core/system.hpp"
#include "solvers/newton/kept_resultants.hpp"
#include "solvers/newton/kept_tangent.hpp"
#include "solvers/time/dense_output.hpp"
#include "solvers/time/free_momenta.hpp"
#include "solvers/time/one_step.hpp"

namespace mbd {

struct GeneralizedAlphaOptions {
  double step = 0.0;  // h [s]; 0: adaptive, by the tolerances
  ErrorTolerances tolerances{};
  double end = 0.0;           // [s] of adaptive steps
  double max_step = 0.0;      // [s] of adaptive ones; 0: a twentieth of the time until the end
  double rho_infinity = 0.0;  // [0, 1]
  Balance balance = Balance::acceleration;
  int max_halvings = 5;  // of a step that fails
  NewtonOptions newton;
  // Real time, in fixed steps; 0: off. A step, or a part of it between breakpoints, has at most so many iterations and one
  // factorisation, and no second try: it is taken as it is then, StepReport::undone, and the next one begins with a new
  // tangent. It fails only where numbers are none, elements are out of range, iterations part with a tangent of their own, something
  // turns too far, or the factorisation is singular. The first step after start(), or after a jump of a load or drive, has a second one for
  // its start, and the jump itself has one.
  int max_cost = 0;
  // With a balance of accelerations: momenta of parts that nothing ties to the ground (free_momenta.hpp).
  bool keep_momenta = false;
};

// The four parameters of (1).
struct GeneralizedAlphaParameters {
  double alpha_m, alpha_f, gamma, beta;
};

GeneralizedAlphaParameters generalized_alpha_parameters(double rho_infinity);

class GeneralizedAlpha final : public OneStep {
 public:
  // Throws Error for a step that is not positive, rho_infinity outside [0, 1], or adaptive steps without
  // tolerance or end. Refers to `system`.
  GeneralizedAlpha(const System& system, std::unique_ptr<LinearSolver> solver,
                   const GeneralizedAlphaOptions& options);

  const LinearSolver& linear_solver() const { return *solver_; }

  std::optional<RoundOff> round_off() override;
  LinearFacts linear_facts() const override { return solver_->facts(); }

 private:
  void begin_at(State& state) override;
  bool solve_step(double t, double h, StepReport& report) override;
  double estimated_error(bool again) override;
  void accept() override;
  void settle() override;
  void forget() override;
  void pass_kink() override;
  const State& solved() const override { return end_; }

  std::string signature() const override;
  void archive(Archive& a) override;
  void take_new_tangent() override;
  BlockGraph own_graph(bool tolerant) const;
  bool solve_tolerantly(double t, StepReport& report);
  void set_step(double h);
  void filter_start(double h);
  bool surprises(StepReport& report);
  bool outgrows(double h) const;
  bool is_cut_short() const;
  void find_rate();
  void keep_rate();
  void lag_by_rate(double h);
  double most_of(const std::vector<Vec6>& motions) const;
  bool rings();
  void calm_velocities();
  bool restart_calmly(State& state);
  void predict(double t, bool extrapolate);
  void update_poses();
  void take_increment(double s);
  bool residual();
  bool is_round_off(double e);
  bool factorize(StepReport& report, bool& in_range);
  double solve_increment(double s, int k, StepReport& report);
  struct Rest {
    double left;      // in units of the tolerance
    bool is_settled;  // to round-off
  };
  Rest rest_after(double e, double before, double s);
  bool iterate(StepReport& report);
  bool take_unconverged(bool whole, StepReport& report);
  LinearSolver& solver() { return tolerant_ ? *tolerant_solver_ : *solver_; }

  GeneralizedAlphaParameters a_;
  KeptTangent kept_;
  HermiteStep dense_;
  FreeMomenta free_;  // of nothing, unless it is asked to keep them

  double h_ = 0.0;           // step under way [s]; 0: none since the last start
  bool starting_ = false;    // no step has been accepted since the last start
  double taken_ = 0.0;       // the last step that was accepted since then [s]; 0: none
  std::vector<Vec6> rate_;   // of Vdot, before steps that were cut short; empty: not known
  double stiffness_ = 0.0;   // largest entry of dr/dU at the last start
  std::vector<Vec6> Q_;      // H_f = H_i exp(Q)
  std::vector<Vec6> A_;      // algorithmic acceleration at the last accepted time
  std::vector<Mat6> T_inv_;  // T^-1(Q) by node

  // What the predictor extrapolates from: the accepted state before the last, and multipliers before that.
  int history_ = 0;  // how many of them there are
  double t_old_ = 0.0, t_older_ = 0.0;
  std::vector<Vec6> Vdot_old_;
  VecX lambda_old_, lambda_older_;
  std::vector<double> S_, S_old_, S_older_;  // resultants, too, and of the accepted state
  Work power_;                               // at the last accepted state [W]

  int max_cost_ = 0;
  KeptResultants mixed_;
  KeptResultants::Iterate resultants_;

  // Equation (3), by node, inertial axes about the origin: mu, f, a at the last accepted time, and p.
  struct Momentum {
    Vec6 mu = Vec6::Zero(), f = Vec6::Zero(), f_old = Vec6::Zero(), a = Vec6::Zero(),
         past = Vec6::Zero();
    Vec6 at_start = Vec6::Zero();  // f of the last start, before (4)
    Vec6 rate = Vec6::Zero();      // as rate_, of f
  };
  std::vector<Momentum> momentum_;  // empty for Balance::acceleration
  std::vector<Vec6> p_;             // M V, body axes
  State scratch_;                   // its V is what M is applied to
  std::vector<Vec6> error_;

  VecX r_, r_mu_, x_, g_, gdot_, gddot_rest_;

  // Ringing of the rates of gaps: at the last accepted state, and how often in a row they have changed sign.
  VecX gdot_old_;
  int alternations_ = 0;
  long steps_since_start_ = 0;
  bool projects_ = false;      // velocities at accepted states
  bool damps_little_ = false;  // a step that fails is taken for ringing
  bool calm_next_ = false;     // accelerations are made consistent before the next step
  // With the block -eps I; made when it is first needed.
  std::unique_ptr<LinearSolver> tolerant_solver_;
  bool factored_ = false;
  bool refactor_next_ = true;
};

}  // namespace mbd
