#include "solvers/time/ida.hpp"

#include <ida/ida.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <stdexcept>

#include "libmbd/core/error.hpp"
#include "libmbd/core/flush_to_zero.hpp"
#include "libmbd/core/stop.hpp"
#include "solvers/constraints/redundancy.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/newton/increments.hpp"
#include "solvers/newton/sundials.hpp"
#include "solvers/time/dense_output.hpp"
#include "solvers/time/stabilized_index2.hpp"

namespace mbd {
namespace {

MBD_LOADED(MBD_SUNDIALS_IDA, IDAFree);
MBD_LOADED(MBD_SUNDIALS_IDA, IDAReInit);
MBD_LOADED(MBD_SUNDIALS_IDA, IDASetMaxStep);
MBD_LOADED(MBD_SUNDIALS_IDA, IDASetErrHandlerFn);
MBD_LOADED(MBD_SUNDIALS_IDA, IDAInit);
MBD_LOADED(MBD_SUNDIALS_IDA, IDASetUserData);
MBD_LOADED(MBD_SUNDIALS_IDA, IDAWFtolerances);
MBD_LOADED(MBD_SUNDIALS_IDA, IDASetId);
MBD_LOADED(MBD_SUNDIALS_IDA, IDASetSuppressAlg);
MBD_LOADED(MBD_SUNDIALS_IDA, IDASetMaxOrd);
MBD_LOADED(MBD_SUNDIALS_IDA, IDASetNonlinConvCoef);
MBD_LOADED(MBD_SUNDIALS_IDA, IDASetLinearSolver);
MBD_LOADED(MBD_SUNDIALS_IDA, IDASetJacFn);
MBD_LOADED(MBD_SUNDIALS_IDA, IDASetLinearSolutionScaling);
MBD_LOADED(MBD_SUNDIALS_IDA, IDASetDeltaCjLSetup);
MBD_LOADED(MBD_SUNDIALS_IDA, IDASetStopTime);
MBD_LOADED(MBD_SUNDIALS_IDA, IDASolve);
MBD_LOADED(MBD_SUNDIALS_IDA, IDAGetNumSteps);
MBD_LOADED(MBD_SUNDIALS_IDA, IDAGetNumErrTestFails);
MBD_LOADED(MBD_SUNDIALS_IDA, IDAGetNumNonlinSolvIters);
MBD_LOADED(MBD_SUNDIALS_IDA, IDAGetNumStepSolveFails);
MBD_LOADED(MBD_SUNDIALS_IDA, IDAGetCurrentTime);
MBD_LOADED(MBD_SUNDIALS_IDA, IDAGetLastStep);
MBD_LOADED(MBD_SUNDIALS_IDA, IDAGetDky);
MBD_LOADED(MBD_SUNDIALS_IDA, IDAGetEstLocalErrors);
MBD_LOADED(MBD_SUNDIALS_IDA, IDAGetErrWeights);
MBD_LOADED(MBD_SUNDIALS_IDA, IDAGetCurrentStep);
MBD_LOADED(MBD_SUNDIALS_IDA, IDAGetReturnFlagName);
MBD_LOADED(MBD_SUNDIALS_IDA, IDACreate);

using sundials::values;
using sundials::Vector;

constexpr long most_tiny_steps = 500;    // in a row, shorter than that: a start takes a tenth of it
constexpr double idle_share = 0.01;      // of the tolerance, for what idle rows may be open
constexpr double newton_share = 0.03;    // of the error test, for what Newton's iterations leave
constexpr double multiplier_slack = 10;  // on the relative one, for what they leave of multipliers
// cj = dydot/dy may change by this factor before the matrix is factorised anew. IDA's own 0.25 makes up for it
// by scaling the increments, which is wrong for constraints and multipliers.
constexpr double cj_change = 0.1;
// Where powers are taken in a step: Gauss's points, 1/2 -+ sqrt(0.15).
constexpr std::array<double, 3> work_nodes = {0.11270166537925831, 0.5, 0.88729833462074169};

struct IdaDeleter {
  void operator()(void* memory) const { IDAFree(&memory); }
};

void check(int status) {
  if (status != IDA_SUCCESS) throw std::runtime_error("IDA refuses a setting");
}

}  // namespace

// The memory of IDA, what it calls, and its last step as a function of time.
class Ida::Integrator final : public DenseStep {
 public:
  Integrator(const System& system, const IdaOptions& options, Counters& counters)
      : system_(system),
        options_(options),
        counters_(counters),
        equations_(system, make_klu_solver()),
        norm_(system, options.tolerances, 1.0) {
    for (Vector* const v : {&y_, &ydot_, &kinds_, &work_, &rates_})
      *v = sundials::make_vector(equations_.size(), context_);
    if (!memory_) throw std::bad_alloc();
    const auto kinds = values(kinds_.get());  // 1: in the error test
    std::fill(kinds.begin(), kinds.begin() + equations_.first_lambda(), 1.0);
    for (const ConstraintInfo& c : system.constraints())
      is_moment_.insert(is_moment_.end(), c.is_position.begin(), c.is_position.end());
    is_moment_.flip();
  }

  // From `state`, which has consistent accelerations and multipliers; `span` [s] is the whole time to come.
  void start(const State& state, double span) {
    equations_.pack(state, values(y_.get()), values(ydot_.get()));
    equations_.follow(state);
    norm_ = ErrorNorm(system_, options_.tolerances, span);
    max_step_ = options_.max_step > 0.0 ? options_.max_step : longest_step * span;
    c_ = 0.0;
    last_ = {};
    void* const memory = memory_.get();
    if (initialized_) {
      check(IDAReInit(memory, state.t, y_.get(), ydot_.get()));
      check(IDASetMaxStep(memory, max_step_));
      return;
    }
    check(IDASetErrHandlerFn(
        memory, [](int, const char*, const char*, char*, void*) {}, nullptr));
    check(IDAInit(
        memory,
        [](realtype t, N_Vector y, N_Vector ydot, N_Vector F, void* self) {
          return static_cast<Integrator*>(self)->residual(t, y, ydot, F);
        },
        state.t, y_.get(), ydot_.get()));
    check(IDASetUserData(memory, this));
    check(IDAWFtolerances(memory, [](N_Vector y, N_Vector w, void* self) {
      static_cast<Integrator*>(self)->set_weights(values(y), values(w));
      return 0;
    }));
    check(IDASetId(memory, kinds_.get()));
    check(IDASetSuppressAlg(memory, SUNTRUE));
    check(IDASetMaxOrd(memory, options_.max_order));
    check(IDASetNonlinConvCoef(memory, newton_share));
    check(IDASetLinearSolver(memory, linear_.solver.get(), linear_.matrix.get()));
    check(IDASetJacFn(memory, [](realtype t, realtype c, N_Vector y, N_Vector ydot, N_Vector,
                                 SUNMatrix, void* self, N_Vector, N_Vector, N_Vector) {
      return static_cast<Integrator*>(self)->linearize(t, c, y, ydot);
    }));
    check(IDASetLinearSolutionScaling(memory, SUNFALSE));
    check(IDASetDeltaCjLSetup(memory, cj_change));
    check(IDASetMaxStep(memory, max_step_));
    initialized_ = true;
  }

  // One step that does not pass `stop`. Returns IDA's status; `t` is where the step ended.
  int step(double stop, double& t) {
    stop_ = stop;
    singular_ = false;
    thrown_.clear();
    unusable_.reset();
    void* const memory = memory_.get();
    if (const int status = IDASetStopTime(memory, stop); status < 0) return status;
    const int status = IDASolve(memory, stop, &t, y_.get(), ydot_.get(), IDA_ONE_STEP);
    Steps now;
    IDAGetNumSteps(memory, &now.steps);
    IDAGetNumErrTestFails(memory, &now.rejected);
    IDAGetNumNonlinSolvIters(memory, &now.iterations);
    IDAGetNumStepSolveFails(memory, &now.retries);
    counters_.steps += now.steps - last_.steps;
    counters_.substeps += now.steps - last_.steps;
    counters_.rejected += now.rejected - last_.rejected;
    counters_.retries += now.retries - last_.retries;
    counters_.iterations += now.iterations - last_.iterations;
    iterations_ = static_cast<int>(now.iterations - last_.iterations);
    last_ = now;
    return status;
  }
  int iterations() const { return iterations_; }  // of the last step
  // When a signal could not be used that the last step met, however short it then became [s].
  std::optional<double> unusable() const { return unusable_; }

  // The end of the last step.
  void end_state(State& state) const {
    equations_.unpack(values(y_.get()), values(ydot_.get()), state);
  }
  void accepted(const State& begin, const State& end) {
    begin_ = &begin;
    end_ = &end;
    powers_ = {};
    equations_.follow(end);
  }
  // At work_nodes of the last step.
  void set_powers(const std::array<Work, 3>& powers) { powers_ = powers; }

  double begin() const override { return begin_->t; }
  double end() const override { return end_->t; }
  void at(double t, State& out) const override {
    double now = 0.0, h = 0.0;
    IDAGetCurrentTime(memory_.get(), &now);
    IDAGetLastStep(memory_.get(), &h);
    const double inside = std::clamp(t, now - h, now);  // but for round-off it is
    make_room(*begin_, out);
    out.pose[0] = begin_->pose[0];
    out.V[0] = begin_->V[0];
    out.Vdot[0] = begin_->Vdot[0];
    if (t < end_->t) {
      IDAGetDky(memory_.get(), inside, 0, work_.get());
      IDAGetDky(memory_.get(), inside, 1, rates_.get());
      equations_.unpack(values(work_.get()), values(rates_.get()), out);
    } else {
      end_state(out);
    }
    system_.set_time(out, t, t < end_->t ? Side::right : Side::left);
    const double s = t < end_->t ? (t - begin_->t) / (end_->t - begin_->t) : 1.0;
    out.work = work_inside(s, end_->t - begin_->t, work_nodes, powers_, begin_->work, end_->work);
    out.angles = begin_->angles;
    system_.follow_angles(out);
  }

  // Where the estimated error of the last step was largest.
  std::string worst_error() const {
    IDAGetEstLocalErrors(memory_.get(), work_.get());
    IDAGetErrWeights(memory_.get(), rates_.get());
    const auto e = values(work_.get()), w = values(rates_.get());
    std::size_t worst = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(equations_.first_lambda()); ++i)
      if (!(std::abs(e[i]) * w[i] <= std::abs(e[worst]) * w[worst])) worst = i;
    return equations_.name_of(static_cast<Index>(worst));
  }

  // Why a step ended with a negative status.
  std::string failure(int status) {
    if (!thrown_.empty()) return thrown_;
    if (singular_) return singular_failure(equations_.singular_unknown());
    if (const std::string element = system_.out_of_range(equations_.at()); !element.empty())
      return range_failure(element);
    double h = 0.0;
    IDAGetCurrentStep(memory_.get(), &h);
    switch (status) {
      case IDA_ERR_FAIL:
        return fmt::format(
            "the estimated error stays too large at {}, with a step of {:.3g} s; look for a jump "
            "or an impact there, or allow a larger tolerance",
            worst_error(), h);
      case IDA_TOO_MUCH_ACC:
        return fmt::format(
            "the tolerance asks for more than round-off allows, with a step of {:.3g} s (worst "
            "equation: {}); look for a singularity there, or allow a larger tolerance",
            h, equations_.worst_equation());
      case IDA_CONV_FAIL:
      case IDA_RES_FAIL:
      case IDA_REP_RES_ERR:
      case IDA_LSETUP_FAIL:
      case IDA_LSOLVE_FAIL:
        return fmt::format(
            "Newton's iterations do not converge, with a step of {:.3g} s (worst equation: {}); "
            "look for a lock, a jump or an instability there",
            h, equations_.worst_equation());
      default: {
        char* const name = IDAGetReturnFlagName(status);
        std::string text =
            fmt::format("IDA ends with {} (worst equation: {})", name, equations_.worst_equation());
        std::free(name);
        return text;
      }
    }
  }

  // Of the linear solver that IDA calls.
  int factor() {
    return guarded([&] {
      ++counters_.factorizations;
      singular_ = equations_.factor() != FactorStatus::ok;
      return singular_ ? 1 : 0;
    });
  }
  int solve(N_Vector x, N_Vector b) {
    return guarded([&] {
      const auto to = values(x), from = values(b);
      std::copy(from.begin(), from.end(), to.begin());
      equations_.solve(to);
      return std::all_of(to.begin(), to.end(), [](double v) { return std::isfinite(v); }) ? 0 : 1;
    });
  }

 private:
  struct Steps {
    long steps = 0, rejected = 0, iterations = 0, retries = 0;
  };

  // Nothing may be thrown through IDA.
  template <class F>
  int guarded(const F& evaluate) {
    try {
      return evaluate();
    } catch (const std::exception& e) {
      thrown_ = e.what();
      return -1;
    }
  }
  // A positive value is a failure for which IDA tries a shorter step.
  int residual(double t, N_Vector y, N_Vector ydot, N_Vector F) {
    return guarded([&] {
      stop::check();
      ++counters_.residuals;
      const auto f = values(F);
      const bool in_range = equations_.residual(std::min(t, stop_), values(y), values(ydot), f);
      if (!system_.unusable_signal(equations_.at()).empty()) {
        unusable_ = equations_.at().t;
        return 1;
      }
      const bool finite =
          std::all_of(f.begin(), f.end(), [](double x) { return std::isfinite(x); });
      return in_range && finite ? 0 : 1;
    });
  }
  int linearize(double t, double c, N_Vector y, N_Vector ydot) {
    return guarded([&] {
      ++counters_.tangents;
      c_ = c;
      return equations_.linearize(std::min(t, stop_), values(y), values(ydot), c) ? 0 : 1;
    });
  }
  // Reciprocals of what is tolerated, times the root of their number, since IDA takes the mean. Multipliers count
  // in Newton's iterations only: lambda as far as V does, m c dV, and a share of its own; mu as r does, c dr.
  void set_weights(std::span<const double> y, std::span<double> w) {
    constexpr Index per_node = StabilizedIndex2::per_node;
    const double length = system_.length_scale(), root = std::sqrt(static_cast<double>(w.size()));
    double speed = 0.0, spin = 0.0;
    for (Index i = 0; i < equations_.first_lambda(); i += per_node) {
      const Eigen::Map<const Vec6> V(y.data() + i + 7);
      speed = std::max(speed, V.head<3>().norm());
      spin = std::max(spin, V.tail<3>().norm());
    }
    norm_.measure(speed, spin);
    const ErrorTolerances limits = norm_.limits();
    for (Index i = 0; i < equations_.first_lambda(); i += per_node) {
      double* const x = w.data() + i;
      std::fill_n(x, 3, root / limits.position);
      // A quaternion changes by half the angle.
      std::fill_n(x + 3, 4, 2.0 * root / limits.rotation);
      std::fill_n(x + 7, 3, root / limits.velocity);
      std::fill_n(x + 10, 3, root / limits.angular_velocity);
    }
    const Index m = system_.multipliers();
    const double* const lambda = y.data() + equations_.first_lambda();
    double force = 0.0;
    for (Index i = 0; i < m; ++i)
      force = std::max(force, std::abs(lambda[i]) / (moment(i) ? length : 1.0));
    const double of_force =
        multiplier_slack * limits.relative * force + equations_.mass() * c_ * limits.velocity;
    const double of_mu = c_ * std::min(limits.position / length, limits.rotation);
    for (Index i = 0; i < m; ++i) {
      // No matrix yet: c is not known.
      double* const x = w.data() + equations_.first_lambda() + i;
      x[0] = c_ > 0.0 ? root / (moment(i) ? of_force * length : of_force) : 0.0;
      x[m] = c_ > 0.0 ? root / (moment(i) ? of_mu : of_mu / length) : 0.0;
    }
  }
  bool moment(Index i) const { return is_moment_[static_cast<std::size_t>(i)]; }

  const System& system_;
  const IdaOptions& options_;
  Counters& counters_;
  StabilizedIndex2 equations_;
  std::vector<bool> is_moment_;  // by multiplier
  ErrorNorm norm_;
  double max_step_ = 0.0;  // [s]
  double stop_ = 0.0;      // the step under way does not pass it [s]
  double c_ = 0.0;         // cj of the last matrix since the start [1/s]; 0: none
  bool initialized_ = false, singular_ = false;
  std::string thrown_;
  std::optional<double> unusable_;
  Steps last_;
  int iterations_ = 0;
  const State* begin_ = nullptr;
  const State* end_ = nullptr;
  std::array<Work, 3> powers_{};  // at work_nodes
  sundials::Context context_ = sundials::make_context();
  Vector y_, ydot_, kinds_, work_, rates_;
  sundials::OwnSolver linear_{*this, context_};
  std::unique_ptr<void, IdaDeleter> memory_{IDACreate(context_.get())};
};

Ida::Ida(const System& system, std::unique_ptr<LinearSolver> solver, const IdaOptions& options)
    : system_(system),
      solver_(std::move(solver)),
      options_(options),
      scratch_(system.reference_state()) {
  check_motion(system, options.max_step);
  if (system.nodes() < 2) throw Error("there is nothing that moves");
  if (!std::isfinite(options.end) || !(options.end > 0.0))
    throw Error(fmt::format("IDA needs a time at which it ends, not {}", options.end));
  if (!(options.max_order >= 1 && options.max_order <= 5))
    throw Error(fmt::format("max_order must lie in 1 … 5, not {}", options.max_order));
  solver_->analyze(system.graph());
  integrator_ = std::make_unique<Integrator>(system_, options_, counters_);
}

Ida::~Ida() = default;

StepReport Ida::start(State& state) {
  begin_watching(system_, state);
  span_ = time_between(state.t, options_.end);
  slack_ = time_floor * span_;
  laws_ = LawSteps(system_, state.t, options_.end);
  state.t = start_time(system_.breakpoints(), state.t, slack_);
  sizes_ = {};
  tiny_ = 0;
  last_usable_ = std::numeric_limits<double>::infinity();
  return first_restart(system_, state, slack_);
}

StepReport Ida::restart(State& state) {
  StepReport report;
  double mass = 0.0;
  report.failure = initial_accelerations(system_, *solver_, state, mass, counters_);
  if (!report.failure.empty()) {
    report.kind = Failure::singular;
    return report;
  }
  integrator_->start(state, span_);
  report.converged = true;
  return report;
}

// Where idle rows have parted from the others, or no step is found, which of them are idle is chosen anew at the start
// of the step: those that determine the motion in one configuration may depend on each other in another.
StepReport Ida::step(State& state) {
  const FlushToZero fast;
  StepReport report;
  if (!may_step(system_, state, InputChange::any, report)) return report;
  report = one_step(state);
  watch(state);
  if (report.converged || integrator_->unusable() || !system_.idle_rows_allowed()) return report;
  report = with_other_rows(state, report);
  watch(state);
  return report;
}

StepReport Ida::with_other_rows(State& state, StepReport report) {
  if (!parted_) begin_ = state;
  const Redundancy found = find_redundancy(system_, begin_);
  if (found.idle == begin_.idle) return report;
  const std::string failure = report.failure;
  state = begin_;
  state.lambda = without_idle(system_, begin_, found.idle);
  state.idle = found.idle;
  ++counters_.retries;
  report = restart(state);
  if (!report.converged) {
    report.failure = fmt::format("at t = {:.9g} s: {}", state.t, report.failure);
    return report;
  }
  report = one_step(state);
  if (!report.converged) report.failure = failure;
  return report;
}

// Of the step that has been taken, by Gauss's rule.
void Ida::add_up(State& state) {
  counters_.passed_kinks += passed_.passes(begin_, {}, state) ? 1 : 0;
  const double h = state.t - begin_.t;
  std::array<Work, 3> powers;
  Work work = begin_.work;
  for (std::size_t k = 0; k < powers.size(); ++k) {
    integrator_->at(begin_.t + work_nodes[k] * h, scratch_);
    powers[k] = system_.power(scratch_);
    work += h * (k == 1 ? 8.0 : 5.0) / 18.0 * powers[k];
  }
  state.work = work;
  integrator_->set_powers(powers);
}

StepReport Ida::one_step(State& state) {
  StepReport report;
  parted_ = false;
  const double last = std::min(options_.end, stop_);
  Landing landing =
      landing_of(system_, state, last, slack_, std::numeric_limits<double>::infinity());
  if (last_usable_ < landing.t) {
    if (!(last_usable_ - state.t > slack_)) {
      report.failure = fmt::format("from t = {:.9g} s: {}", state.t, unusable_);
      report.kind = Failure::law;
      return report;
    }
    landing = {.t = last_usable_};
  }
  if (!(landing.t - state.t > slack_)) {
    report.failure = fmt::format("t = {:.9g} s is the end of the integration{}", state.t,
                                 last < options_.end ? " (Stepper::stop_at)" : "");
    report.kind = Failure::end;
    return report;
  }
  double reached = state.t;
  const int status =
      integrator_->step(std::min(landing.t, laws_.end_of_step(state.t + slack_, cells_)), reached);
  report.iterations = integrator_->iterations();
  if (integrator_->unusable())  // the steps to come go as far as the signals
    last_usable_ = last_usable(system_, state, *integrator_->unusable(), slack_, unusable_);
  if (status < 0) {
    report.failure =
        fmt::format("from t = {:.9g} s: {}", state.t,
                    integrator_->unusable() ? unusable_ : integrator_->failure(status));
    return report;
  }
  const bool landed = landing.t - reached <= slack_;
  begin_ = state;
  integrator_->end_state(state);
  system_.set_time(state, landed ? landing.t : reached, Side::left);
  system_.follow_angles(state);
  integrator_->accepted(begin_, state);
  if (const std::optional<std::string> open =
          idle_rows_open(system_, state, idle_share * options_.tolerances.relative)) {
    parted_ = true;
    report.failure = fmt::format("at t = {:.9g} s: {}", state.t, *open);
    return report;
  }
  const double h = state.t - begin_.t;
  record_size(h, landed);
  add_up(state);
  if (observer_) observer_(*integrator_);

  if (landed && landing.breakpoint && !restart_at(landing.restart_at, state, slack_, report))
    return report;
  tiny_ = h < slack_ && !landed ? tiny_ + 1 : 0;
  report.converged = tiny_ <= most_tiny_steps;
  if (!report.converged)
    report.failure = fmt::format(
        "at t = {:.9g} s the step has shrunk to {:.3g} s (worst equation: {}); look for a "
        "singularity there",
        state.t, h, integrator_->worst_error());
  return report;
}

}  // namespace mbd
