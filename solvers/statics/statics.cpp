#include "solvers/statics/statics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "solvers/newton/increments.hpp"
#include "solvers/statics/equilibrium.hpp"
#include "solvers/statics/nearest_modes.hpp"
#include "solvers/statics/stability.hpp"

namespace mbd {
namespace {

constexpr double smallest_increment = 1e-6;  // of the load
constexpr int easy_iterations = 6;  // with as many or fewer the next load step is twice as large
constexpr double smallest_passed = 1e-5;  // of the load: not cut further where stability changes
constexpr double off_the_path = 0.5;      // of (1)
constexpr double astray = 1.0;            // of (2)
constexpr double smallest_motion = 1e-4;  // that (2) judges: of the scene's length, or [rad]
constexpr double smallest_change = 0.1;   // of forces, or moments, that (1) judges, of their size
constexpr double smallest_share = 1e-3;   // and of the size of both
constexpr double jump = 1e-2;  // of the scene's length, or [rad]: more than a smallest step moves
constexpr double giving_way =
    30.0;  // growth of the motion per load that tells a limit point from others

// Motion and multipliers per load at an equilibrium whose tangent has been factored; empty if it is not finite.
VecX motion_per_load(const System& system, const LinearSolver& solver, const State& state) {
  VecX rate;
  system.load_rate(state, rate);
  VecX z = -rate.tail(system.unknowns());
  solver.solve({z.data(), static_cast<std::size_t>(z.size())});
  return z.allFinite() ? z : VecX();
}

VecX motion_per_load_anew(const System& system, LinearSolver& solver, const State& state) {
  VecX r;
  system.linearize(state, {}, r, solver);
  return solver.factor() == FactorStatus::ok ? motion_per_load(system, solver, state) : VecX();
}

// Why there is no equilibrium a little beyond this one, if its tangent tells.
std::string reason(const System& system, LinearSolver& solver, const State& start,
                   const State& last, const std::string& failure) {
  const VecX w = motion_weights(system);
  const VecX first = motion_per_load_anew(system, solver, start),
             now = motion_per_load_anew(system, solver, last);
  if (first.size() == 0 || now.size() == 0) return failure;
  const double before = std::sqrt(first.dot(w.cwiseProduct(first))),
               size = std::sqrt(now.dot(w.cwiseProduct(now)));
  if (!(size > giving_way * before)) return failure;
  const std::optional<CriticalMode> mode = critical_mode(system, solver, last);
  if (!mode) return failure;
  return fmt::format(
      "the structure gives way: its tangent is nearly singular, in a mode in which {} most (a "
      "limit "
      "point, or a bifurcation; <path> in place of <static> follows the equilibria through it)",
      name_of_motion(system, mode->shape));
}

// Of a load step, so that what prescribed motions turn is less than half a turn: beyond that another turn would do as well.
double most_ahead(const System& system, const State& state) {
  constexpr double most_turned = 2.0;  // [rad]
  VecX rate;
  system.load_rate(state, rate);
  double most = 0.0;
  for (const ConstraintInfo& c : system.constraints()) {
    double turned = 0.0;
    for (Index i = 0; i < c.rows; ++i)
      if (!c.is_position[static_cast<std::size_t>(i)])
        turned = std::hypot(turned, rate(6 * system.nodes() + c.first_row + i));
    most = std::max(most, turned);
  }
  return most > most_turned ? most_turned / most : 1.0;
}

using Resultants = std::vector<Vec6>;

// Where the equilibria over the load lead, and whether one belongs to them.
class LoadPath {
 public:
  LoadPath(const System& system, const State& state) : system_(&system) {
    system.linearized_resultants(state, {}, S_);
  }
  const Resultants& resultants() const { return S_; }
  bool is_known() const { return rate_.size() > 0; }

  void foretell(double ahead, State& trial, Resultants& S) const {
    if (rate_.size() > 0) retract(*system_, trial, ahead * rate_);
    if (bend_.size() > 0) retract(*system_, trial, 0.5 * ahead * ahead * bend_);
    S = S_;
    for (std::size_t i = 0; i < S_rate_.size(); ++i) S[i] += ahead * S_rate_[i];
    for (std::size_t i = 0; i < S_bend_.size(); ++i) S[i] += 0.5 * ahead * ahead * S_bend_[i];
  }

  // The point `ahead` of the last, whose rate of motion is known up to its last increment.
  LoadPath next(const State& state, VecX rate, const MixedIterate& mixed, double ahead) const {
    LoadPath next = *this;
    next.S_ = mixed.resultants;
    next.bend_.resize(0);
    next.S_rate_.clear();
    next.S_bend_.clear();
    next.rate_ = std::move(rate);
    if (next.rate_.size() == 0) return next;
    if (rate_.size() > 0) next.bend_ = (next.rate_ - rate_) / ahead;
    // Where the tangent was taken: elsewhere rates strain what is stiff.
    const State& at = mixed.linearized.pose.empty() ? state : mixed.linearized;
    next.S_rate_ = rates_of_resultants(*system_, at, next.rate_);
    if (S_rate_.empty()) return next;
    next.S_bend_ = next.S_rate_;
    for (std::size_t i = 0; i < next.S_bend_.size(); ++i)
      next.S_bend_[i] = (next.S_rate_[i] - S_rate_[i]) / ahead;
    return next;
  }

  // (1) of statics.hpp; true where it cannot be told.
  bool leads_to(const LoadPath& next, double ahead) const {
    if (S_rate_.empty() || next.S_rate_.empty()) return true;
    const double L = system_->length_scale();
    double all = 0.0;
    for (const Vec6& S : next.S_)
      all += S.head<3>().squaredNorm() + S.tail<3>().squaredNorm() / (L * L);
    for (const Index first : {0, 3}) {
      const double whole = std::sqrt(all) * (first == 0 ? 1.0 : L);
      double off = 0.0, change = 0.0, size = 0.0;
      for (std::size_t i = 0; i < S_.size(); ++i) {
        const Vec3 dS = (next.S_[i] - S_[i]).segment<3>(first),
                   mean = 0.5 * (S_rate_[i] + next.S_rate_[i]).segment<3>(first);
        off += (dS - ahead * mean).squaredNorm();
        change += dS.squaredNorm();
        size += next.S_[i].segment<3>(first).squaredNorm();
      }
      if (std::sqrt(off) >
          off_the_path * std::max({std::sqrt(change), smallest_change * std::sqrt(size),
                                   smallest_share * whole}))
        return false;
    }
    return true;
  }

 private:
  const System* system_;
  VecX rate_, bend_;  // of motion and multipliers
  Resultants S_, S_rate_, S_bend_;
};

// (2) of statics.hpp; true where nothing was foretold.
bool is_near(const System& system, const State& last, const std::optional<State>& foretold,
             const State& found) {
  if (!foretold) return true;
  const double off = motion_between(system, *foretold, found);
  return off <= std::max(smallest_motion, astray * motion_between(system, last, *foretold));
}

// Of a step too small to be cut, in which stability changes.
std::string words_of_passing(const System& system, LinearSolver& solver, const State& at,
                             const Resultants& resultants, double from, double to,
                             const std::optional<Index>& before,
                             const std::optional<Index>& after) {
  const std::optional<CriticalMode> mode = critical_mode(system, solver, at, {}, resultants);
  const int digits = std::clamp(static_cast<int>(-std::log10((to - from) / to)), 1, 5);
  return fmt::format(
      "at load factor {:.{}g} a branch leaves the equilibria followed, and their stability "
      "changes{}{}: "
      "they are followed straight on; <path> in place of <static> finds the branch",
      0.5 * (from + to), digits,
      before && after ? fmt::format(" (negative eigenvalues {} -> {})", *before, *after)
                      : std::string(),
      mode ? fmt::format(", in a mode in which {} most", name_of_motion(system, mode->shape))
           : std::string());
}

// The equilibria over the load, step by step.
struct LoadSteps {
  const System& system;
  LinearSolver& solver;
  const StaticOptions& options;
  State start;  // without load
  LoadPath path;
  double increment = 1.0 / std::max(1, options.steps);  // of the load
  const VecX weights = motion_weights(system);
  StabilityCount* count = nullptr;  // null where there is no potential
  int sign = 0;                     // of the determinant at the last equilibrium; 0: not known
  // Negative eigenvalues of an equilibrium, besides its neutral motions.
  struct Counted {
    Index neutral, negative;
    double load_factor;
  };
  std::optional<Counted> counted{};  // of the last one
  // Of the last one with as many neutral motions as without load: near a branch its own is one for all that can be told, where other
  // stiffnesses are much larger.
  std::optional<Counted> as_at_start{};
  NeutralMotions free{};  // motions there
  bool cut = false;       // the last step was
  bool judges_rates = true;
  double whole = 0.0;  // the increment before it was cut where the path was left; 0: it was not
  StaticReport report{};

  StaticReport run(State& state) {
    begin(state);
    while (report.load_factor < 1.0) {
      Step step = attempt(state);
      const bool leaves = step.found && leaves_path(state, step);
      if (leaves && increment < smallest_passed) {
        pass(state, step);
      } else if (leaves) {
        ++report.counters.retries;
        whole = std::max(whole, increment);
        increment *= 0.5;
        cut = true;
        continue;
      }
      if (!step.found) {
        if (!shorten(state, step.failure)) return std::move(report);
        continue;
      }
      accept(state, step);
      if (options.accepted && !options.accepted(state)) return std::move(report);
      if (step.iterations <= easy_iterations && !cut) increment *= 2.0;
      cut = false;
    }
    report.converged = true;
    if (count == nullptr)
      if (const auto modes =
              nearest_modes(system, solver, state, path.resultants(), holds_of(weights, free)))
        report.diverging = modes->negative();
    return std::move(report);
  }

  // A load step on trial, and what was found at its end.
  struct Step {
    double load_factor = 0.0, ahead = 0.0;  // at its end; more than at its beginning
    State state;
    MixedIterate mixed;
    NeutralMotions neutral;
    std::optional<State> foretold;
    bool found = false, searched = false;
    int iterations = 0;
    std::string failure;
    std::optional<LoadPath> path;   // from there
    std::optional<Index> negative;  // eigenvalues there
  };

  std::optional<Index> negative_at(const State& at, const Resultants& S,
                                   const NeutralMotions& motions) {
    ++report.counters.tangents;
    return count ? (*count)(at, holds_of(weights, motions), S) : std::nullopt;
  }

  // The rate of the path without load, where there is an equilibrium to start from and loads drive nothing that is neutral, and
  // the sign of the determinant there.
  void begin(State& state) {
    constexpr double most =
        1.0;  // [rad] of a first prediction; Newton's own increments are shortened beyond
    State unloaded = start;
    MixedIterate mixed;
    NeutralMotions neutral;
    std::string failure;
    if (!find_equilibrium(system, solver, options.newton, unloaded, report.counters, failure,
                          &neutral, &mixed) ||
        drives(system, unloaded, neutral) ||
        !lead_along_equilibria(system, solver, unloaded, neutral))
      return;
    if (motion_between(system, start, unloaded) > 0.0) system.follow_angles(unloaded);
    start = state = unloaded;
    sign = mixed.sign;
    VecX rate = motion_per_load(system, solver, unloaded);
    if (neutral.count() > 0 && rate.size() > 0) neutral.take_out(weights, rate);
    free = neutral;
    if (rate.size() == 0 || largest_rotation_in(system, rate) / std::max(1, options.steps) < most)
      path = path.next(unloaded, std::move(rate), mixed, 1.0);
    if (sign != 0 || neutral.count() > 0)
      if (const auto negative = negative_at(start, path.resultants(), neutral))
        counted = as_at_start = Counted{neutral.count(), *negative, 0.0};
  }

  Step attempt(const State& state) {
    increment = std::min({increment, 1.0 - report.load_factor, most_ahead(system, state)});
    double next = report.load_factor + increment;
    if (next > 1.0 - 1e-9) next = 1.0;
    Step step;
    step.load_factor = next;
    step.ahead = next - report.load_factor;
    step.state = state;
    path.foretell(step.ahead, step.state, step.mixed.resultants);
    step.state.load_factor = next;
    if (path.is_known()) step.foretold = step.state;
    const long before = report.counters.iterations;
    NewtonOptions newton = options.newton;
    newton.line_search = false;
    const bool by_newton = options.solver == StaticSolver::newton;
    const auto equilibrium = by_newton ? newton_equilibrium : kinsol_equilibrium;
    if (!drives(system, state, free)) step.neutral = free;
    step.found = equilibrium(system, solver, newton, step.state, report.counters, step.failure,
                             &step.neutral, &step.mixed);
    // Beyond the range of its metric an element is wound the other way round.
    if (step.found && !step.mixed.out_of_range.empty()) {
      step.found = false;
      step.failure = range_failure(step.mixed.out_of_range);
    }
    if (!step.found && options.newton.line_search && by_newton) {
      newton.line_search = true;
      step.neutral = {};
      step.state = state;
      step.state.load_factor = next;
      step.mixed = {};
      step.found = step.searched =
          newton_equilibrium(system, solver, newton, step.state, report.counters, step.failure,
                             &step.neutral, &step.mixed);
    }
    step.iterations = static_cast<int>(report.counters.iterations - before);
    return step;
  }

  // The path, or passes a point where stability changes.
  bool leaves_path(const State& state, Step& step) {
    // Newton's last tangent is that of the solution, up to its last increment.
    VecX rate = motion_per_load(system, solver, step.state);
    if (step.neutral.count() > 0 && rate.size() > 0) step.neutral.take_out(weights, rate);
    step.path = path.next(step.state, std::move(rate), step.mixed, step.ahead);
    step.negative = negative_at(step.state, step.mixed.resultants, step.neutral);
    return changes_stability(step) || (has_signs(step) && step.mixed.sign_varied) ||
           (judges_rates &&
            !(path.leads_to(*step.path, step.ahead) &&
              (step.searched || is_near(system, state, step.foretold, step.state))));
  }

  bool has_signs(const Step& step) const {
    return options.conservative && sign != 0 && step.mixed.sign != 0;
  }
  // With which the count of a step is to be compared.
  const std::optional<Counted>& before_of(const Step& step) const {
    static const std::optional<Counted> none;
    for (const auto* one : {&counted, &as_at_start})
      if (*one && (*one)->neutral == step.neutral.count()) return *one;
    return none;
  }
  bool changes_stability(const Step& step) const {
    const std::optional<Counted>& before = before_of(step);
    if (step.negative && before) return before->negative != *step.negative;
    return has_signs(step) && step.mixed.sign != sign;
  }

  // Goes on where a step too small to be cut leaves the path, unless it jumps.
  void pass(const State& state, Step& step) {
    if (motion_between(system, state, step.state) > jump) {
      step.found = false;
      increment = 0.0;
    } else if (changes_stability(step)) {
      const std::optional<Counted> before = before_of(step);
      std::optional<Index> from, to = step.negative;
      if (before && step.negative) {
        // A spin that is not told to be neutral just there is counted by its round-off, before and after.
        Counted& at_start = as_at_start ? *as_at_start : *counted;
        from = at_start.negative;
        to = at_start.negative + *step.negative - before->negative;
        at_start = {at_start.neutral, *to, step.load_factor};
      }
      report.passed.push_back(words_of_passing(system, solver, step.state, step.mixed.resultants,
                                               before ? before->load_factor : report.load_factor,
                                               step.load_factor, from, to));
      increment = std::max(increment, whole);
      whole = 0.0;
    } else {
      judges_rates = false;  // a kink
    }
  }

  // False when no shorter step would help: the report says why.
  bool shorten(const State& state, const std::string& failure) {
    ++report.counters.retries;
    if (failure.starts_with("nothing holds the motion")) {  // nor under a smaller load
      report.failure = report.load_factor > 0.0
                           ? fmt::format("no equilibrium was found beyond {:.9g} of the load: {}",
                                         report.load_factor, failure)
                           : failure;
      return false;
    }
    increment *= 0.5;
    cut = true;
    if (increment >= smallest_increment) return true;
    report.failure =
        fmt::format("no equilibrium was found beyond {:.9g} of the load: {}", report.load_factor,
                    failure.empty() ? "what is found there does not lie on the path of equilibria "
                                      "that leads there, however small the step is"
                                    : reason(system, solver, start, state, failure));
    return false;
  }

  void accept(State& state, Step& step) {
    state = std::move(step.state);
    path = std::move(*step.path);
    sign = step.mixed.sign;
    report.negative = step.negative;
    counted.reset();
    if (step.negative) counted = Counted{step.neutral.count(), *step.negative, step.load_factor};
    if (counted && as_at_start && counted->neutral == as_at_start->neutral) as_at_start = counted;
    report.searched += step.searched ? 1 : 0;
    report.neutral.clear();
    for (Index i = 0; i < step.neutral.count(); ++i)
      report.neutral.push_back(name_of_motion(system, step.neutral.shapes.col(i)));
    free = std::move(step.neutral);
    system.follow_angles(state);
    report.load_factor = step.load_factor;
    ++report.counters.steps;
    report.most_iterations = std::max(report.most_iterations, step.iterations);
  }
};

}  // namespace

StaticReport solve_statics(const System& system, LinearSolver& solver, const StaticOptions& options,
                           State& state) {
  solver.analyze(system.graph());
  std::optional<StabilityCount> count;
  if (options.has_potential) count.emplace(system, solver);
  state.load_factor = 0.0;
  State start = state;
  return LoadSteps{.system = system,
                   .solver = solver,
                   .options = options,
                   .start = std::move(start),
                   .path = LoadPath(system, state),
                   .count = count ? &*count : nullptr}
      .run(state);
}

}  // namespace mbd
