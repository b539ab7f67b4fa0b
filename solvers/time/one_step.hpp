// Drives a method of one step: fixed steps, which land on breakpoints and are halved where they fail, and
// adaptive ones by an estimate of their error (error_control.hpp).
//
// Adaptive steps do not pass over what laws of time do (law_steps.hpp), nor over kinks of laws of the motion (passed_kinks.hpp),
// whatever their error is; fixed ones count the latter.
//
// A step ends on every breakpoint of the signals inside it, and starts afresh where accelerations jump. A fixed
// step that fails is tried in halves, down to 2^-max_halvings.
//
// Signals that are not finite. A step that meets one fails before its first iteration: the signal is the cause, and
// is named. Parts of a fixed step go near the last time before it; adaptive ones go there, and try no smaller ones.
//
// Rank-tolerant steps. Near a singular configuration, where all links of a mechanism come into line, B loses
// rank and Newton's iterations their convergence, though the motion goes smoothly through it. A step that fails
// is then tried with -eps I in place of the zero block of its matrix, in units of 1/mass: with B of full rank
// that costs a factor eps a iteration; where it is not, the motion is still determined, and multipliers stay
// finite. Those that it does not determine creep on for ever, and such a step ends where the motion has settled.
//
// Idle rows (redundancy.hpp) are looked at after each step. Where they have parted from the others, or the step
// fails, rows are chosen anew at the start of the step; where that does not help the step is tried with all rows,
// which is then a rank-tolerant one, and rows are chosen at its end: so a mechanism leaves a singular configuration
// in which more constraints depend on each other than elsewhere.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "libmbd/core/system.hpp"
#include "solvers/laws/passed_kinks.hpp"
#include "solvers/newton/increments.hpp"
#include "solvers/time/error_control.hpp"
#include "solvers/time/stepper.hpp"

namespace mbd {

class OneStep : public Stepper {
 public:
  StepReport start(State& state) final;
  StepReport step(State& state) final;

 protected:
  // Of a fixed step: what sums of steps can be wrong by, and more.
  static constexpr double time_rounding = 1e-6;
  static constexpr double same_step = 1e-3;  // steps that differ less share a tangent

  // What the options of all methods say by these names.
  struct Settings {
    double step;
    ErrorTolerances tolerances;
    double end, max_step;
    int max_halvings;
    NewtonOptions newton;
    bool adaptive() const { return step == 0.0 && tolerances.relative != 0.0; }
  };
  template <class Options>
  static Settings settings_of(const Options& o) {
    return {o.step, o.tolerances, o.end, o.max_step, o.max_halvings, o.newton};
  }

  // `error_order`: the estimated error of a step goes with h to this power. Throws Error for settings without
  // sense.
  OneStep(const System& system, std::unique_ptr<LinearSolver> solver, const Settings& settings,
          int error_order);

  // Whether the signals of a state inside the step can be used; otherwise report.failure says which cannot, and
  // none that reaches that time can be solved.
  bool usable(const State& state, StepReport& report);

  void archive(Archive& a) override;
  // The settings that all methods have, and a method's own.
  std::string signature_of(std::string_view method, std::initializer_list<double> own) const;

  // Of adaptive steps from now on, of which the next is of h [s]: their errors go with another power of h.
  void change_error_order(int order, double h);

  // Of adaptive steps from a state, whatever their errors are [s].
  virtual double longest_from(const State&) const {
    return std::numeric_limits<double>::infinity();
  }

  bool bounded_ = false;  // a step that fails is not tried otherwise

  // eps of rank-tolerant steps, in units of 1/mass.
  static constexpr double rank_tolerance = 1e-3;
  double rank_tolerance_ = rank_tolerance;
  // -eps I onto the multipliers' own blocks, of a rank-tolerant step.
  void add_rank_tolerance(std::span<const Slot> own) const;
  // Of fixed steps: a failure is not tried in halves.
  bool is_shortest() const { return halvings_ == settings_.max_halvings; }
  // On the tolerance of multipliers, of which some are not determined in a rank-tolerant step.
  double multiplier_slack() const;

  double round_off_of_positions(const State& state) const;  // [m]
  // Right-hand side of a response to round-off: 0 for the motion, and for the constraints `size` [m or m/s] (over
  // the scene's length for angles) of either sign.
  void set_round_off(double size, std::span<double> x) const;
  // Its solution: motion times `rate` is velocity, multipliers times `force_rate` are forces and moments.
  RoundOff round_off_of(std::span<const double> x, double rate, double force_rate) const;

  // Why Newton's iterations end without a solution; `out_of_range` as of System.
  std::string newton_failure(const std::string& out_of_range, const VecX& r) const;

  const System& system_;
  std::unique_ptr<LinearSolver> solver_;  // of accelerations at the start and after jumps
  const Settings settings_;
  IncrementNorm norm_;
  std::unique_ptr<ErrorNorm> error_norm_;  // of adaptive steps, made by start()
  double mass_ = 0.0;                      // largest entry of dr/dVdot at the last start
  State begin_, end_;                      // of the step under way
  bool tolerant_ = false;                  // it is rank-tolerant
  double usual_ = 0.0;                     // [s] what it would be if nothing cut it short

 private:
  // What a method is. `state` has consistent accelerations: what was before is forgotten.
  virtual void begin_at(State& state) = 0;
  // Solves a step of h [s] from begin_ to t; not yet accepted. False: report.failure says why.
  virtual bool solve_step(double t, double h, StepReport& report) = 0;
  // Estimated error of the step that has been solved, in units of what is allowed. `again`: one before it was
  // rejected.
  virtual double estimated_error(bool again) = 0;
  // Completes end_, and keeps what the next step needs.
  virtual void accept() = 0;
  // After a step has failed, or was rank-tolerant: its tangents are not kept.
  virtual void settle() = 0;
  // After an adaptive step that ended where a law has a kink: what follows from the past, before it, does not go on.
  virtual void pass_kink() {}
  // After an adaptive step of h [s] whose iterations failed, which is tried shorter.
  virtual void pass_failure(double) {}
  // Other rows are idle: neither tangents nor multipliers of the past are of use.
  virtual void forget() = 0;
  // The end of the step that has been solved, and states inside it, if any are known.
  virtual const State& solved() const = 0;
  virtual std::span<const State> inside() const { return {}; }

  StepReport restart(State& state) final;
  const System& system() const final { return system_; }
  void prepare();
  StepReport fixed_step(State& state);
  StepReport adaptive_step(State& state);
  bool turns_in_step(double h, Landing& landing);
  StepReport past_the_end(double t) const;
  static double fitted(double wanted, double rest);
  void record_error(double error);
  // Of a step of h to be tried at t, and of one that was taken: whether that ends the run, and report.failure says why.
  // `unusable`: why it has to end where it does, if a signal is the reason.
  bool is_too_short(double h, double t, const std::string& unusable, StepReport& report) const;
  bool stays_short(double h, bool last, double t, StepReport& report);
  bool try_step(const State& state, double t, StepReport& report);
  bool attempt(double t, double h, StepReport& report);
  bool attempt_with_other_rows(double t, double h, StepReport& report);
  void take_step(State& state);

  int error_order_;
  std::unique_ptr<StepController> controller_;  // of adaptive steps
  PassedKinks passed_{system_};
  double origin_ = 0.0;  // time of start() [s]
  double slack_ = 0.0;   // round-off of times [s]
  // Of a step that met a signal that cannot be used: the last time at which all can [s].
  std::optional<double> last_usable_;
  long count_ = 0;    // whole fixed steps since
  int halvings_ = 0;  // of the fixed steps now tried, and how many in a row have gone well
  int good_ = 0;
  int contradictions_ = 0;    // adaptive steps that idle rows made shorter, less those they did not
  int short_steps_ = 0;       // in a row, which are nearly round-off of times
  std::string shortened_by_;  // why the last step that was too long is too long
  bool parted_ = false;       // idle rows have, in the last attempt
  bool choose_rows_ = false;  // at the end of the step under way
};

}  // namespace mbd
