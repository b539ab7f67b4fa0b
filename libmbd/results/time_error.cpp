#include "libmbd/results/time_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/core/error.hpp"
#include "solvers/laws/crossed_kink.hpp"

namespace mbd {
namespace {

constexpr double other_steps = 1.75;        // r of (1)
constexpr double other_tolerances = 10.0;   // times as large, or as small
constexpr double largest_tolerance = 0.01;  // that makes sense
// Of a node in a fixed step [rad]: of a top with 0.3 (1) is right to a factor of 3, with 0.5 it says an eighth of the error,
// with 1 a hundredth. Radau's terms of higher order are smaller.
constexpr double most_turn_alpha = 0.4, most_turn_radau = 1.0;
constexpr double same_steps = 0.9;  // of the run's own: the other one says nothing
constexpr double as_many = 0.75;    // of fixed ones, where 1/r are meant
// Newton iterations of the run's own, after which longer steps are given up: where they are hard to take they may cost many times
// the run.
constexpr double most_iterations = 1.0;
// Of what is recorded, of the largest motion: smaller ones are not judged by themselves.
constexpr double tiny_change = 1e-7;
constexpr double no_motion = 1e-12;  // lengths of the scene, or rad

double angle_between(const Pose<double>& a, const Pose<double>& b) {
  const auto q = a.p.conjugate() * b.p;
  return 2.0 * std::atan2(q.vec().norm(), std::abs(q.w()));
}

TransientScene in_steps(TransientScene t, double times, double tolerance_times) {
  const auto scale = [](std::optional<double>& value, double by) {
    if (value) *value *= by;
  };
  scale(t.step, times);
  if (!t.tolerance) return t;
  t.tolerance = std::clamp(*t.tolerance * tolerance_times, 1e-13, largest_tolerance);
  for (auto* limit : {&t.position_tolerance, &t.rotation_tolerance, &t.velocity_tolerance,
                      &t.angular_velocity_tolerance})
    scale(*limit, tolerance_times);
  // Otherwise both take the same steps where only the longest one limits them.
  t.max_step = times * t.max_step.value_or(0.05 * t.duration);
  return t;
}

// On which side of the kinks of laws of the motion a run is: at how many of them it comes to the other.
class Sides {
 public:
  explicit Sides(const System& system) : system_(system) {}
  int passed(const State& state) {
    if (!any_) return 0;
    const std::vector<NearKink> now = system_.near_kinks(state);
    any_ = !now.empty();
    int passed = 0;
    for (std::size_t k = 0; k < now.size() && now.size() == last_.size(); ++k)
      if (crossed_kink(last_[k], now[k])) ++passed;
    last_ = now;
    return passed;
  }

 private:
  const System& system_;
  bool any_ = true;
  std::vector<NearKink> last_;
};

// In place of (1).
double of_kinks(bool longer) { return longer ? 1.0 : 1.5; }

// The distance of two lists of numbers.
double distance(std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

}  // namespace

void TimeError::scale(double by) {
  for (double* one : {&relative, &displacement, &rotation}) *one *= by;
  if (recorded > 0.0) recorded *= by;
}

TimeErrorMeter::TimeErrorMeter(const System& system, const TransientScene& transient,
                               std::vector<Watched> watched)
    : system_(system), transient_(transient), watched_(std::move(watched)) {}

std::vector<double> TimeErrorMeter::recorded_in(const State& state) const {
  std::vector<double> all;
  for (const Watched& one : watched_) {
    all.resize(all.size() + one.count);
    one.read(state, std::span(all).last(one.count));
  }
  return all;
}

void TimeErrorMeter::start(const State& state) {
  start_ = state;
  recorded_at_start_ = recorded_in(state);
  changes_.assign(watched_.size(), 0.0);
}

void TimeErrorMeter::sample(const State& state) {
  for (std::size_t n = 1; n < state.pose.size(); ++n) {
    farthest_ = std::max(farthest_, (state.pose[n].r - start_.pose[n].r).norm());
    turned_ = std::max(turned_, angle_between(state.pose[n], start_.pose[n]));
  }
  if (!(state.t > start_.t && (samples_.empty() || state.t > samples_.back().t))) return;
  samples_.push_back({state.t, state.pose, recorded_in(state)});
  std::span<const double> now = samples_.back().recorded, then = recorded_at_start_;
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    const std::size_t n = watched_[i].count;
    changes_[i] = std::max(changes_[i], distance(now.first(n), then.first(n)));
    now = now.subspan(n);
    then = then.subspan(n);
  }
}

// Why an estimate from steps in which a node turns that fast [rad/s] is none; empty if it is one.
std::string TimeErrorMeter::turns_too_far(double spin, std::size_t node) const {
  const double turn = spin * transient_.step.value_or(0.0);
  const double most = transient_.method == TimeMethod::radau ? most_turn_radau : most_turn_alpha;
  if (!(turn > most)) return {};
  return fmt::format(
      "{} turns by {:.2g} rad in a step, where errors do not go with a power of the step any "
      "more; take steps in which it turns by less than {:g}",
      system_.node_name(static_cast<Index>(node)), turn, most);
}

double TimeErrorMeter::length() const { return std::max(system_.length_scale(), farthest_); }
double TimeErrorMeter::motion() const {
  return std::min(1.0, std::max(farthest_ / length(), turned_));
}

// Of the other run, at the time of a sample; `factor` is that of (1).
void TimeErrorMeter::compare(const State& at, const Sample& sample, double factor,
                             TimeError& error) const {
  const double length = this->length(), motion = this->motion();
  for (std::size_t n = 1; n < at.pose.size(); ++n) {
    const double u = factor * (at.pose[n].r - sample.pose[n].r).norm(),
                 psi = factor * angle_between(at.pose[n], sample.pose[n]);
    const double one = std::max(u / length, psi) / motion;
    if (error.node.empty() || !(one <= error.relative)) {  // or not a number
      error.relative = u == u && psi == psi ? one : u + psi;
      error.displacement = u;
      error.rotation = psi;
      error.node = system_.node_name(static_cast<Index>(n));
      error.time = sample.t;
    }
  }
  error.until = sample.t;
  const std::vector<double> all = recorded_in(at);
  std::span<const double> is = all, was = sample.recorded;
  for (std::size_t i = 0; i < watched_.size(); ++i) {
    const std::size_t n = watched_[i].count;
    const double unit = watched_[i].is_length ? length : 1.0;
    const double one = factor * distance(is.first(n), was.first(n)) / changes_[i];
    if (changes_[i] > tiny_change * motion * unit && !(one <= error.recorded)) {
      error.recorded = one;
      error.record = watched_[i].name;
      error.recorded_time = sample.t;
    }
    is = is.subspan(n);
    was = was.subspan(n);
  }
}

// False if the other run ends early for a reason of its own, or because it goes beyond `most`.
bool TimeErrorMeter::follow(const TransientScene& other, bool longer, double factor,
                            const Work& most, const std::atomic<bool>* interrupted,
                            TimeError& error) const {
  const double last = samples_.back().t, slack = 1e-12 * (last - start_.t);
  std::size_t next = 0;
  State state = start_, at = start_;
  try {
    const std::unique_ptr<Stepper> stepper = make_stepper(system_, other);
    stepper->reach_over(longer ? LawSteps::reach + 1 : LawSteps::reach - 1);
    stepper->on_substep([&](const DenseStep& step) {
      for (; next < samples_.size() && samples_[next].t <= step.end() + slack; ++next) {
        step.at(std::clamp(samples_[next].t, step.begin(), step.end()), at);
        compare(at, samples_[next], factor, error);
      }
    });
    Sides sides(system_);
    double spin = 0.0;  // [rad/s]
    std::size_t spinning = 1;
    StepReport report = stepper->start(state);
    if (other.step) sides.passed(state);
    while (report.converged && next < samples_.size()) {
      if (interrupted != nullptr && *interrupted) {
        error.why_not = "it was interrupted";
        return true;
      }
      const double before = state.t;
      report = stepper->step(state);
      const Counters& work = stepper->counters();
      if (static_cast<double>(work.substeps) > most.substeps ||
          static_cast<double>(work.iterations) > most.iterations) {
        error.why_not = "it costs as much as the run itself";
        return false;
      }
      if (report.converged && !(state.t > before)) break;
      if (other.step) error.kinks += sides.passed(state);
      for (std::size_t n = 1; n < state.V.size(); ++n)
        if (const double w = state.V[n].tail<3>().norm(); w > spin) {
          spin = w;
          spinning = n;
        }
    }
    if (next == samples_.size()) {
      error.why_not = turns_too_far(spin, spinning);
      if (error.kinks > 0) error.scale(of_kinks(longer) / factor);
      return true;
    }
    error.why_not = report.failure;
  } catch (const Error& failure) {
    error.why_not = failure.what();
  }
  return false;
}

TimeError TimeErrorMeter::measure(const Counters& own, const std::atomic<bool>* interrupted) const {
  TimeError error;
  if (samples_.empty()) {
    error.why_not = "there is no state to compare";
    return error;
  }
  if (!(motion() > no_motion)) {
    error.why_not = "nothing moves, and steps that miss what ought to move it look the same";
    return error;
  }
  const bool fixed = transient_.step.has_value();
  const double order = transient_.method == TimeMethod::generalized_alpha ? 2.0 : 3.0;
  for (const bool longer : {true, false}) {
    double times = longer ? other_steps : 1.0 / other_steps;
    if (fixed) {
      const double steps =
          std::max(1.0, std::round((samples_.back().t - start_.t) / *transient_.step));
      const double others = longer ? std::floor(steps / times) : std::ceil(steps / times);
      if (others < 1.0) continue;
      times = steps / others;
    }
    TransientScene other =
        in_steps(transient_, times, longer ? other_tolerances : 1.0 / other_tolerances);
    if (!fixed && *other.tolerance == *transient_.tolerance) continue;
    if (!fixed && !longer && own.substeps > 0)
      other.max_step = std::min(*other.max_step, times * (samples_.back().t - start_.t) /
                                                     static_cast<double>(own.substeps));
    const double power = std::pow(times, order);
    const double factor = fixed ? 1.0 / std::abs(power - 1.0) : (longer ? 1.0 / 3.0 : 1.5);
    error = {};
    error.how = fixed ? fmt::format("steps {:.3g} times as {}", longer ? times : 1.0 / times,
                                    longer ? "long" : "short")
                      : fmt::format("a tolerance of {:.1g}", *other.tolerance);
    Work most;
    if (longer)
      most = {(fixed ? as_many : same_steps) * static_cast<double>(own.substeps),
              most_iterations * static_cast<double>(own.iterations)};
    const bool followed = follow(other, longer, factor, most, interrupted, error);
    if (followed) {
      error.known = error.why_not.empty();
      return error;
    }
  }
  error.why_not =
      fmt::format("the run in {} does not come to its end: {}", error.how, error.why_not);
  return error;
}

}  // namespace mbd
