#include "solvers/statics/equilibrium.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libmbd/core/stop.hpp"
#include "solvers/constraints/redundancy.hpp"
#include "solvers/newton/increments.hpp"

namespace mbd {
namespace {

constexpr double largest_rotation = 1.0;  // [rad] of a Newton increment; larger ones are shortened
constexpr double small_increment = 1e-4;  // of the scene's length, or [rad]: not searched along
constexpr int searching = 3;              // times as many iterations with a line search
constexpr double smallest_share = 1.0 / 256.0;
constexpr double nearly_singular = 1e-14;  // reciprocal condition: worth a look for neutral motions
constexpr double most_followed = 1e3;      // [rad] of an increment; what turns more is astray
constexpr double driven = 1e-9;  // of forces times the scene's length: what drives a motion

// Of loads, reactions and what is left over, as energy of a motion of unit size: force times the scene's length.
double size_of_forces(const System& system, const VecX& r, const State& state) {
  VecX load;
  system.load_rate(state, load);
  double size = 0.0;
  const double L = system.length_scale();
  for (const VecX* f : {&r, static_cast<const VecX*>(&load)})
    for (Index i = 6; i < 6 * system.nodes(); ++i)
      size = std::max(size, std::abs((*f)(i)) * (i % 6 < 3 ? L : 1.0));
  return size;
}

// Largest motion of an increment: displacements over the scene's length, rotations [rad].
double motion(const System& system, const VecX& x) {
  double largest = 0.0, sum = 0.0;  // a NaN would not pass through max()
  for (Index n = 0; n < 6 * (system.nodes() - 1); n += 6) {
    const double u = x.segment<3>(n).norm() / system.length_scale(),
                 psi = x.segment<3>(n + 3).norm();
    largest = std::max({largest, u, psi});
    sum += u + psi;
  }
  return std::isfinite(sum) ? largest : std::numeric_limits<double>::infinity();
}

// The share of the increment x that is taken, with the trial state and its residual; 0 if none helps.
double search(const System& system, const LinearSolver& solver, const State& state, const VecX& x,
              Counters& counters, State& trial, double first) {
  VecX r, next(x.size());
  const double size = motion(system, x);
  double share = first;
  while (share >= smallest_share) {
    trial = state;
    retract(system, trial, x, share);
    ++counters.residuals;
    double remaining = std::numeric_limits<double>::infinity(), curvature = remaining;
    if (system.residual(trial, r) && r.allFinite()) {
      next = -r.tail(x.size());
      solver.solve({next.data(), static_cast<std::size_t>(next.size())});
      remaining = motion(system, next);
      if (remaining <= (1.0 - 0.25 * share) * size) return share;
      curvature = motion(system, next - (1.0 - share) * x);
    }
    // The share at which the second-order remainder would be as long as the increment.
    const double estimate = 0.5 * share * share * size / curvature;
    share = std::isfinite(estimate) ? std::clamp(estimate, 0.1 * share, 0.5 * share) : 0.25 * share;
  }
  return 0.0;
}

// Newton's iterations from a state towards an equilibrium.
struct Newton {
  const System& system;
  LinearSolver& solver;
  const NewtonOptions& options;
  State& state;
  Counters& counters;
  std::string& failure;
  MixedIterate& mixed;
  const Holds holds;  // of neutral motions that are known
  const VecX weights = motion_weights(system);
  NeutralMotions free{};
  double stiffness = 0.0;                 // the largest of the start
  VecX r{}, x = VecX(system.unknowns());  // residual, increment
  State trial{};
  std::vector<Vec6> next{};  // resultants

  bool iterate() {
    mixed.sign = 0;
    mixed.sign_varied = false;
    mixed.out_of_range.clear();
    if (mixed.resultants.empty()) take_resultants();
    IncrementNorm norm(system, options);
    double previous = 0.0;
    const int most =
        options.line_search ? searching * options.max_iterations : options.max_iterations;
    for (int k = 0; k < most; ++k) {
      stop::check();
      linearize();
      stop::check();
      ++counters.iterations;
      ++counters.residuals;
      ++counters.tangents;
      ++counters.factorizations;
      if (k == 0) {
        stiffness = largest_stiffness_behind(system, solver.slots());
        norm.set_floor(state, stiffness);
      }
      FactorStatus status = factor(k == 0);
      if (k == 0 && !is_held()) status = factor_under_load();
      if (!is_held() || !is_regular(status)) return false;
      if (k == 0 && rests()) return is_admissible();
      x = -r.tail(x.size());
      solver.solve({x.data(), static_cast<std::size_t>(x.size())});
      if (free.count() > 0) free.take_out(weights, x);
      const double e = norm({x.data(), static_cast<std::size_t>(x.size())}, 1.0);
      if (!std::isfinite(e))
        return fail(
            fmt::format("the residual is not finite at {}", system.name_of(worst_row(system, r))));
      const int sign = free.count() > 0 ? 0 : solver.determinant_sign();
      mixed.sign_varied |= k > 0 && sign != mixed.sign;
      mixed.sign = sign;
      const double share = take(e);
      if (share == 0.0)
        return fail(
            fmt::format("no share of Newton's increment brings it nearer to equilibrium "
                        "(worst equation: {})",
                        system.name_of(worst_row(system, r))));
      norm.observe(state.lambda);
      if (share == 1.0 && has_converged(e, previous)) return is_admissible();
      previous = e;
    }
    return fail(fmt::format("Newton's iterations do not converge (worst equation: {})",
                            system.name_of(worst_row(system, r))));
  }

  bool fail(std::string why) {
    failure = std::move(why);
    return false;
  }

  void take_resultants() { system.linearized_resultants(state, {}, mixed.resultants); }

  void linearize() {
    if (options.line_search) take_resultants();
    if (!system.linearize_mixed(state, mixed.resultants, r, solver) && mixed.out_of_range.empty())
      mixed.out_of_range = system.out_of_range(state);
  }

  // Neutral motions, whose pivots are round-off or zero, are looked for at first and held from then on.
  FactorStatus factor(bool first) {
    if (!holds.rows.empty()) {
      add_holds(system, solver.slots(), holds);
      return solver.factor();
    }
    if (first) {
      if (!is_nothing(stiffness)) {  // or there is nothing to factor
        const FactorStatus status = solver.factor();
        if (status == FactorStatus::ok && !(solver.reciprocal_condition() < nearly_singular))
          return status;
      }
      free = find_neutral_motions(system, solver, state, mixed.resultants);
      counters.factorizations += free.count() == 0 ? 2 : 1;
      if (free.count() > 0) return FactorStatus::ok;
      linearize();
      return solver.factor();
    }
    if (free.count() == 0) return solver.factor();
    free = find_neutral_motions(system, solver, state, mixed.resultants);
    ++counters.factorizations;
    return free.count() > 0 ? FactorStatus::ok : FactorStatus::singular;
  }

  // With the multipliers that loads ask for: a weight on a rod is held by the tension that it makes itself.
  FactorStatus factor_under_load() {
    x = -r.tail(x.size());
    solver.solve({x.data(), static_cast<std::size_t>(x.size())});
    if (!x.tail(state.lambda.size()).allFinite()) return FactorStatus::ok;
    state.lambda += x.tail(state.lambda.size());
    linearize();
    ++counters.tangents;
    ++counters.factorizations;
    free = {};
    return factor(true);
  }

  // Loads drive none of the neutral motions.
  bool is_held() {
    if (free.count() == 0) return true;
    const VecX drives = free.shapes.transpose() * r.tail(x.size());
    if (drives.norm() <= driven * size_of_forces(system, r, state)) return true;
    return fail(fmt::format(
        "nothing holds the motion in which {} most, which loads drive; hold it by a joint or a "
        "spring",
        name_of_motion(system, free.shapes * drives)));
  }

  // Where nothing is stiff and nothing acts, iterations would go after the round-off of gaps.
  bool rests() const {
    const Index motions = 6 * (system.nodes() - 1), multipliers = system.multipliers();
    return free.count() > 0 && is_nothing(stiffness) &&
           is_nothing(r.tail(x.size()).head(motions).lpNorm<Eigen::Infinity>()) &&
           largest_violation(system, r.tail(multipliers)) <= options.tolerance;
  }

  bool is_regular(FactorStatus status) {
    if (status == FactorStatus::ok) return true;
    const Index row = solver.singular_row();
    return fail(fmt::format("the tangent is singular{}: the structure can move freely there",
                            row >= 0 ? " at " + system.name_of(row + 6) : std::string()));
  }

  // Moves the state by a share of the increment, which it returns; 0 if none helps.
  double take(double e) {
    const double turn = largest_rotation_in(system, x);
    const double share = turn > largest_rotation ? largest_rotation / turn : 1.0;
    if (options.line_search && motion(system, x) > small_increment) {
      const double helps = search(system, solver, state, x, counters, trial, share);
      if (helps != 0.0) state = trial;
      return helps;
    }
    if (!options.line_search) {
      std::vector<Vec6>& S = mixed.resultants;
      system.linearized_resultants(state, x, next);
      for (std::size_t i = 0; i < S.size(); ++i) S[i] += share * (next[i] - S[i]);
    }
    if (share == 1.0 && e < 1e3) mixed.linearized = state;
    retract(system, state, x, share);
    return share;
  }

  // What Newton's iterations have converged to is an equilibrium.
  bool is_admissible() {
    if (const std::string element = system.out_of_range(state); !element.empty())
      return fail(range_failure(element));
    if (std::optional<std::string> open = idle_rows_open(system, state))
      return fail(std::move(*open));
    if (options.line_search) take_resultants();
    return true;
  }
};

}  // namespace

void retract(const System& system, State& state, const VecX& increment, double scale) {
  constexpr double sure = 1.0;  // [rad] of a node: less than half a turn between two of them
  const auto nodes = static_cast<Index>(state.pose.size());
  int pieces = 1;
  if (!state.angles.empty()) {
    const double turn = std::abs(scale) * largest_rotation_in(system, increment);
    if (turn > sure && turn < most_followed) pieces = static_cast<int>(std::ceil(turn / sure));
  }
  for (int piece = 0; piece < pieces; ++piece) {
    for (Index n = 1; n < nodes; ++n) {
      Pose<double>& H = state.pose[static_cast<std::size_t>(n)];
      H = H * exp_se3<double>(scale / pieces * increment.segment<6>(6 * (n - 1)));
      renormalize(H);
    }
    if (!state.angles.empty()) system.follow_angles(state);
  }
  state.lambda += scale * increment.segment(6 * (nodes - 1), state.lambda.size());
}

double motion_between(const System& system, const State& a, const State& b) {
  double largest = 0.0;
  for (std::size_t n = 1; n < a.pose.size(); ++n) {
    const Pose<double> g = relative(a.pose[n], b.pose[n]);
    largest = std::max({largest, (b.pose[n].r - a.pose[n].r).norm() / system.length_scale(),
                        2.0 * g.p.vec().norm()});
  }
  return largest;
}

double largest_rotation_in(const System& system, const VecX& increment) {
  double largest = 0.0;
  for (Index n = 0; n < 6 * (system.nodes() - 1); n += 6)
    largest = std::max(largest, increment.segment<3>(n + 3).norm());
  return largest;
}

std::vector<Vec6> rates_of_resultants(const System& system, const State& state,
                                      const VecX& direction) {
  std::vector<Vec6> here, rate;
  system.linearized_resultants(state, {}, here);
  system.linearized_resultants(state, direction, rate);
  for (std::size_t i = 0; i < rate.size(); ++i) rate[i] -= here[i];
  return rate;
}

bool find_equilibrium(const System& system, LinearSolver& solver, NewtonOptions options,
                      State& state, Counters& counters, std::string& failure,
                      NeutralMotions* neutral, MixedIterate* mixed) {
  const State start = state;
  const bool searches = std::exchange(options.line_search, false);
  if (newton_equilibrium(system, solver, options, state, counters, failure, neutral, mixed))
    return true;
  state = start;
  if (!searches) return false;
  options.line_search = true;
  if (neutral != nullptr) *neutral = {};
  if (mixed != nullptr) *mixed = {};
  return newton_equilibrium(system, solver, options, state, counters, failure, neutral, mixed);
}

bool newton_equilibrium(const System& system, LinearSolver& solver, const NewtonOptions& options,
                        State& state, Counters& counters, std::string& failure,
                        NeutralMotions* neutral, MixedIterate* mixed) {
  MixedIterate own;
  Holds holds;
  if (neutral != nullptr && neutral->count() > 0) {
    holds = holds_of(motion_weights(system), *neutral);
    *neutral = {};
  }
  Newton newton{
      system,          solver, options, state, counters, failure, mixed != nullptr ? *mixed : own,
      std::move(holds)};
  if (!newton.iterate()) return false;
  failure.clear();  // of a try before, or of what the load's own multipliers then held
  if (neutral != nullptr && (newton.free.count() > 0 || !newton.holds.rows.empty())) {
    NeutralMotions there = find_neutral_motions(system, solver, state, newton.mixed.resultants);
    ++counters.factorizations;
    *neutral = there.count() >= newton.free.count() ? std::move(there) : std::move(newton.free);
  }
  return true;
}

}  // namespace mbd
