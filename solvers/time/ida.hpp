// IDA of SUNDIALS over a System: BDF of variable order 1 … 5 and variable step, on the equations of
// stabilized_index2.hpp, with our own tangent and sparse LU. Nothing of the time integration is shared with
// the other steppers: a referee for them.
//
// Error test of IDA, on r, p and V of all nodes and not on multipliers: sqrt(sum (e_i/w_i)^2) <= 1, with w
//   of positions   relative x length of the scene
//   of rotations   relative x 1 rad
//   of velocities  relative x the fastest at the start of the step, which is at least a length, or a radian,
//                  in the time from start() to the end
// or the limits in physical units that are given instead (ErrorTolerances). It is a sum, not the mean that IDA
// takes: no component is wrong by more than its w in a step. That is the local error; the error at the end is
// what the motion makes of all of them.
// g and gdot hold to Newton's tolerance, a few hundredths of that of the error test, not to round-off.
// Accelerations and multipliers of accepted states satisfy the equations of motion to that tolerance, and are
// less accurate than V by 1/h. Dense output: IDA's interpolant, of the order of the step; inside a step
// accelerations are its derivative, which jumps from step to step by about the tolerance over h.
// Work: Gauss's rule of three points over each step, and inside it the polynomial through these.
// Idle rows stay those of the start. BDF of order 3 and more amplifies some undamped oscillations,
// until the steps resolve them: stiff elastic scenes (four_bar.xml) need max_order 2.
#pragma once

#include <memory>

#include "libmbd/core/system.hpp"
#include "solvers/laws/passed_kinks.hpp"
#include "solvers/time/error_control.hpp"
#include "solvers/time/stepper.hpp"

namespace mbd {

struct IdaOptions {
  ErrorTolerances tolerances{.relative = 1e-6};
  double end = 0.0;       // [s]
  double max_step = 0.0;  // [s]; 0: a twentieth of the time until the end
  int max_order = 5;      // of BDF, 1 … 5; 2 and less are stable for all oscillations
};

class Ida final : public Stepper {
 public:
  // `solver` is for the accelerations at the start and after jumps; the steps have a KLU of their own. Throws
  // Error for settings without sense. Refers to `system`.
  Ida(const System& system, std::unique_ptr<LinearSolver> solver, const IdaOptions& options);
  ~Ida() override;
  Ida(const Ida&) = delete;
  Ida& operator=(const Ida&) = delete;

  // Throws Error if options.end is not after state.t.
  StepReport start(State& state) override;

  // One step of IDA, which ends at the next breakpoint or options.end at the latest, and there exactly. All
  // breakpoints are restarts (Counters::restarts): BDF of higher order needs smooth derivatives.
  StepReport step(State& state) override;

 private:
  class Integrator;  // what knows SUNDIALS

  StepReport restart(State& state) override;
  const System& system() const override { return system_; }
  StepReport one_step(State& state);
  void add_up(State& state);  // work, and kinks that were passed over
  StepReport with_other_rows(State& state, StepReport report);

  const System& system_;
  std::unique_ptr<LinearSolver> solver_;
  IdaOptions options_;
  std::unique_ptr<Integrator> integrator_;
  double span_ = 0.0;   // time from start() to the end [s]
  double slack_ = 0.0;  // round-off of times [s]
  long tiny_ = 0;       // steps in a row that are shorter
  double last_usable_ =
      0.0;  // where signals end that can be used, as far as it is known: else infinity [s]
  std::string unusable_;  // which does not go on
  bool parted_ = false;   // idle rows have, in the last step, which began at begin_
  State begin_, scratch_;
  PassedKinks passed_{system_};
};

}  // namespace mbd
