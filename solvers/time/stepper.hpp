// What advances a State over a System in time: generalized-alpha, Radau IIA, IDA.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libmbd/core/system.hpp"
#include "solvers/laws/law_steps.hpp"
#include "solvers/newton/report.hpp"
#include "solvers/time/archive.hpp"

namespace mbd {

// A step that has been accepted, as a function of time.
class DenseStep {
 public:
  virtual ~DenseStep() = default;
  virtual double begin() const = 0;  // [s]
  virtual double end() const = 0;
  // The state at t in [begin, end], with the signals at t; at a jump at the end of the step their left limits.
  // `out` must be a state of the same System.
  virtual void at(double t, State& out) const = 0;
  // The states at both ends, of steppers that keep them while the step is shown; else nullptr, and at() tells.
  virtual const State* first() const { return nullptr; }
  virtual const State* last() const { return nullptr; }

  // States at which the method balances forces, with weights: what they sum to, times the length of the step, is the change of
  // momentum in it but for what the axes of bodies turn. None: of methods that balance them otherwise.
  struct Balance {
    static constexpr std::size_t most = 7;
    std::array<const State*, most> states{};
    std::array<double, most> weights{};
    std::size_t size = 0;
  };
  virtual Balance balance() const { return {}; }
};

// The whole of a stepper between two steps, and its state: made by Stepper::save(), for this program on this kind of machine.
struct Checkpoint {
  std::vector<char> bytes;
};

// What round-off leaves unknown because of the size of a step h. Positions are known to eps of their size, so
// constraints of positions leave velocities uncertain by eps/h and multipliers by eps/h^2 (BBC); constraints of
// velocities leave multipliers uncertain by eps/h. Sizes, not bounds: one response of the linear system to
// round-off of either sign in every constraint.
struct RoundOff {
  double velocity = 0.0;              // [m/s]
  double force = 0.0;                 // of multipliers [N]
  double moment = 0.0;                // of multipliers [N.m]
  double reciprocal_condition = 0.0;  // estimate, of the scaled matrix of Newton's iterations
};

struct Landing;

class Stepper {
 public:
  virtual ~Stepper() = default;

  // Consistent accelerations and multipliers at state.t (the state must satisfy its constraints at
  // position and velocity level: check_initial_state). Also after a user has changed the state.
  virtual StepReport start(State& state) = 0;

  // Fixed steps: from the last multiple of the step, counted from start(), to the next. Adaptive steps: one
  // step of the method, which ends at options.end, or where stop_at() says, at the latest, and there exactly. On
  // failure the state is the last one that was reached, which may lie inside the step.
  //
  // Inputs of the state may have been set since the last step (State::inputs). Where loads jump by that, accelerations
  // and multipliers are made consistent first, as at any jump, so that a value held over a step acts from its beginning
  // and costs no order. What a drive prescribes must go on without a jump, and with its rate.
  // It fails before start(), and for a state of another time.
  virtual StepReport step(State& state) = 0;

  // Adaptive steps end there at the latest, and there exactly; fixed ones do not look at it.
  void stop_at(double t) { stop_ = t; }

  // The stepper and its state, to go on from. Both who saves and who restores take a new tangent at the next step, so that
  // they go on alike to the last bit: also in another process of the same program. `state` must be the one reached.
  // Throws Error before start(), and for methods that keep a history of their own (IDA): start() from the state then.
  Checkpoint save(const State& state);
  // In place of start(), of a stepper of the same System with the same options; the state becomes the one that was saved.
  // Throws Error for a checkpoint of another model, method, setting or version, or one that is cut off.
  void restore(const Checkpoint& checkpoint, State& state);

  // The same for taking steps again, with other inputs: the tangent is kept. What follows go_back() is equal to what came
  // before to the tolerance of Newton's iterations.
  Checkpoint remember(const State& state) const;
  void go_back(const Checkpoint& checkpoint, State& state);

  const Counters& counters() const { return counters_; }
  const StepSizes& sizes() const { return sizes_; }

  // What limits adaptive steps, from start() on; of fixed ones it knows nothing.
  const LawSteps& laws() const { return laws_; }
  // Over how many cells of a law (law_steps.hpp) adaptive steps may reach: 4 at most, less than a bump has. Of a run that
  // estimates the error of another, which must not take the same steps where laws limit them.
  void reach_over(std::size_t cells) { cells_ = cells; }

  // Of the last accepted step; nothing before the first, after a restart, and of steppers that do not know it.
  virtual std::optional<RoundOff> round_off() { return std::nullopt; }

  // Of the solver of its steps.
  virtual LinearFacts linear_facts() const { return {}; }

  // Shown each accepted piece of a step, before what happens at its end (a restart at a jump).
  void on_substep(std::function<void(const DenseStep&)> observer) {
    observer_ = std::move(observer);
  }

 protected:
  static constexpr double time_floor = 1e-12;   // round-off of times, of the time until the end
  static constexpr double longest_step = 0.05;  // adaptive ones, of the time until the end

  // Consistent accelerations and multipliers; nothing from before state.t is used after it.
  virtual StepReport restart(State& state) = 0;

  // Of start(). Throws Error for a state that is not one of the system.
  void begin_watching(const System& system, const State& state);
  // Of step(), before it: whether the state may be stepped from, after a restart if its inputs have changed so that the
  // method needs one.
  enum class InputChange { jump, any };
  bool may_step(const System& system, State& state, InputChange restarts, StepReport& report);
  // Of start(), in place of restart(): controllers that have an instant there see the state with its accelerations, and then what
  // they give acts.
  StepReport first_restart(const System& system, State& state, double slack);
  // Where a step that would end at `end` has to stop: next_landing(), or an instant of a controller.
  static Landing landing_of(const System& system, const State& state, double end, double slack,
                            double apart);
  // Of step(), after it.
  void watch(const State& state) { watched_ = state.t; }
  // At the end of a step that landed on breakpoints, of which the last is at t. `sampled` as in Landing. False: `report`
  // says why.
  bool restart_at(double t, State& state, double slack, StepReport& report, bool sampled = false);
  // Of an accepted step, `cut` by a breakpoint or the end.
  void record_size(double h, bool cut);

  // What it has besides its settings, which signature() tells; archive() reads into a stepper that has not been started.
  virtual std::string signature() const { return {}; }
  virtual void archive(Archive& a);
  virtual void take_new_tangent() {}

  Counters counters_;
  StepSizes sizes_;
  LawSteps laws_;
  std::size_t cells_ = LawSteps::reach;
  std::function<void(const DenseStep&)> observer_;
  double stop_ = std::numeric_limits<double>::infinity();  // [s]

 private:
  std::string signed_with_solver() const;
  Checkpoint kept(const State& state) const;
  void resume(const Checkpoint& checkpoint, State& state);
  std::uint64_t fingerprint_of_model() const;
  virtual const System& system() const = 0;

  bool goes_on_from(const State& state, StepReport& report) const;

  std::optional<double> watched_;   // the time that was reached [s]; none: not started
  std::vector<InputValue> inputs_;  // with which
  mutable std::optional<std::uint64_t> fingerprint_;
};

// Throws Error unless the arrays of the state are as long as the system wants them.
void check_sizes(const System& system, const State& state);

// Where a step that would end at `end` has to stop.
struct Landing {
  double t = 0.0;           // [s] `end`, or a breakpoint before it
  bool breakpoint = false;  // it is one
  bool restart = false;     // what accelerates jumps there, at the time that follows:
  double restart_at = 0.0;  // the last of the breakpoints that are one but for `slack`
  bool sampled =
      false;  // by an instant of controllers alone: nothing jumps where their outputs stay as they are
};
// `slack` is the round-off of times: breakpoints closer than that to the start have been passed.
// Smooth ones count where no other breakpoint is nearer to them than `apart`, the step that is wanted: not the points of a
// table that steps go over. Infinity: none do.
Landing next_landing(std::span<const Breakpoint> breakpoints, double t, double end, double slack,
                     double apart);

// `t`, or a breakpoint that is there but for `slack`.
double start_time(std::span<const Breakpoint> breakpoints, double t, double slack);

// The last time, but for `slack`, at which all signals can be used, from state.t, where they can, to `t`, where some
// cannot; `why` says then which is the first that cannot, and when. By bisection.
double last_usable(const System& system, State state, double t, double slack, std::string& why);

// Throws Error for a system without inertia, or a largest step that is negative; 0 stands for the usual one.
void check_motion(const System& system, double max_step);
// From `start` to `end` [s]; throws Error if that is not after it.
double time_between(double start, double end);

// What to say of a tangent that is singular at an unknown; empty: not known which.
std::string singular_failure(const std::string& unknown);

// Vdot and multipliers that satisfy the equations of motion at state.t, from the right, and the constraints
// at the level of accelerations. Returns an empty string, or why there are none. `mass` becomes the largest
// entry of dr/dVdot; the solver holds [M B^T; B 0] then.
std::string initial_accelerations(const System& system, LinearSolver& solver, State& state,
                                  double& mass, Counters& counters);

}  // namespace mbd
