#include "solvers/modes/rotation_path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "libmbd/core/se3.hpp"
#include "libmbd/core/stop.hpp"
#include "solvers/newton/increments.hpp"
#include "solvers/newton/root.hpp"
#include "solvers/statics/equilibrium.hpp"
#include "solvers/statics/stability.hpp"

namespace mbd {
namespace {

constexpr double range_as_motion = 0.3;  // how long the range of the parameter is beside the scene
constexpr double most_turn = 0.5;        // [rad] of the tangent in a step; steps aim at half of it
constexpr double most_correction = 0.3;  // of a step: farther off, it may be another path
constexpr int easy = 4;                  // iterations up to which steps grow
constexpr double smallest_step = 1e-6;   // of the largest
constexpr double located = 1e-8;         // of a step, a fold

class Path {
 public:
  // `force`: pushes; null: the parameter is the rate.
  Path(SmallMotions& motions, const SteadyRotation& start, const VecX* force,
       const RotationPathOptions& options)
      : motions_(motions),
        system_(motions.system()),
        options_(options),
        rotation_(start),
        force_(force),
        n_(motions.unknowns()),
        w_(motion_weights(system_)),
        c_(range_as_motion / (options.to - options.from)) {}

  RotationPathReport go(const State& state) {
    Point at{state, force_ ? 0.0 : rotation_.rate, 0.0, {}};
    if (!tangent(at, nullptr)) {
      report_.end = "the tangent is singular at its start";
      return report_;
    }
    if ((at.tangent(n_) > 0.0) != options_.rising) at.tangent = -at.tangent;
    trace(std::move(at));
    return report_;
  }

 private:
  struct Point {
    State state;
    double p = 0.0, arc = 0.0;
    VecX tangent;  // of (U, lambda, p)
  };

  double dot(const VecX& a, const VecX& b) const {
    return a.head(n_).dot(w_.cwiseProduct(b.head(n_))) + c_ * c_ * a(n_) * b(n_);
  }

  SteadyRotation at(double p) const {
    SteadyRotation here = rotation_;
    if (!force_) here.rate = p;
    return here;
  }

  // dr/dW: r is of second degree in W but for drag, so that central differences are exact.
  VecX rate_derivative(State state, double rate) const {
    const double h = 1e-2 * (options_.to - options_.from);
    VecX ahead, behind;
    turn_steadily(at(rate + h), state);
    system_.residual(state, ahead);
    turn_steadily(at(rate - h), state);
    system_.residual(state, behind);
    return (ahead - behind).tail(n_) / (2.0 * h);
  }

  // a = -K^-1 r, b = -K^-1 f at a point.
  bool solve(State& state, double p, VecX* a, VecX& b) {
    const SteadyRotation here = at(p);
    turn_steadily(here, state);
    if (!motions_.about(state)) {
      why_ = range_failure(system_.out_of_range(state));
      return false;
    }
    hold_free_turn(motions_, here);
    ++report_.counters.residuals;
    ++report_.counters.tangents;
    ++report_.counters.factorizations;
    if (a) *a = -motions_.residual().tail(n_);
    if (force_) {
      b = VecX::Zero(n_);
      b.head(force_->size()) = *force_;
      if (a) *a += p * b;
    } else {
      b = -rate_derivative(state, p);
    }
    if (!motions_.factor(0.0)) return false;
    if (a) motions_.solve_all(*a);
    motions_.solve_all(b);
    return b.allFinite() && (!a || a->allFinite());
  }

  bool tangent(Point& point, const VecX* before) {
    VecX b;
    if (!solve(point.state, point.p, nullptr, b)) return false;
    point.tangent.resize(n_ + 1);
    point.tangent << b, 1.0;
    point.tangent /= std::sqrt(dot(point.tangent, point.tangent));
    if (before && dot(point.tangent, *before) < 0.0) point.tangent = -point.tangent;
    return point.tangent.allFinite();
  }

  // The point at h from another, and its tangent; none if it is not found soon, and near.
  std::optional<Point> step(const Point& from, double h, int& iterations) {
    Point point;
    point.state = from.state;
    point.p = from.p + h * from.tangent(n_);
    point.arc = from.arc + h;
    retract(system_, point.state, h * from.tangent.head(n_));
    IncrementNorm norm(system_, options_.newton);
    norm.observe(from.state.lambda);
    VecX moved = VecX::Zero(n_ + 1), a, b, x(n_ + 1);
    double previous = 0.0;
    for (int k = 0; k < options_.newton.max_iterations; ++k, ++iterations) {
      stop::check();
      ++report_.counters.iterations;
      if (!solve(point.state, point.p, &a, b)) return std::nullopt;
      if (k == 0) norm.set_floor(point.state, motions_.stiffness());
      x << a, 0.0;
      VecX along(n_ + 1);
      along << b, 1.0;
      x -= dot(from.tangent, x) / dot(from.tangent, along) * along;
      moved += x;
      if (!x.allFinite() || dot(moved, moved) > std::pow(most_correction * h, 2) ||
          largest_rotation_in(system_, x) > largest_turn_of_rotation)
        return std::nullopt;
      retract(system_, point.state, x.head(n_));
      point.p += x(n_);
      norm.observe(point.state.lambda);
      const double e = std::max(norm({x.data(), static_cast<std::size_t>(n_)}, 1.0),
                                c_ * std::abs(x(n_)) / options_.newton.tolerance);
      if (has_converged(e, previous)) {
        if (!tangent(point, &from.tangent)) return std::nullopt;
        return point;
      }
      previous = e;
    }
    return std::nullopt;
  }

  double within(double p) const { return std::clamp(p, options_.from, options_.to); }

  // Between a point and the next, h on, where the rate turns back: the nearest that is met.
  void locate_fold(const Point& from, const Point& next, double h) {
    Point best = std::abs(from.tangent(n_)) < std::abs(next.tangent(n_)) ? from : next;
    const auto sense = [&](double x) -> std::optional<double> {
      int iterations = 0;
      std::optional<Point> point = step(from, x, iterations);
      if (!point) return std::nullopt;
      const double f = point->tangent(n_);
      if (std::abs(f) < std::abs(best.tangent(n_))) best = *std::move(point);
      return f;
    };
    find_root(sense, 0.0, from.tangent(n_), h, next.tangent(n_), located * h);
    if (options_.accepted && !options_.accepted({best.state, best.p, best.arc, true}))
      going_ = false;
  }

  // The last point of rates, on the border of the range.
  bool end_at(const Point& from, double p) {
    report_.end = fmt::format("{:.6g}{} is reached", p, force_ ? " of the force" : " rad/s");
    if (force_ || p == from.p) return true;
    Point last = from;
    const double h = (p - from.p) / from.tangent(n_);
    retract(system_, last.state, h * from.tangent.head(n_));
    std::string failure;
    if (!solve_steady_rotation(motions_, at(p), options_.newton, last.state, report_.counters,
                               failure))
      return false;
    accept({std::move(last.state), p, from.arc + h, {}});
    return true;
  }

  bool accept(const Point& point) {
    ++report_.counters.steps;
    if (options_.accepted && !options_.accepted({point.state, point.p, point.arc, false}))
      going_ = false;
    return going_;
  }

  double largest_step(const Point& at) const {
    const double share = c_ * std::abs(at.tangent(n_)),  // of the parameter in the tangent
        moved = std::sqrt(std::max(0.0, 1.0 - share * share));
    return std::min(options_.largest_step * range_as_motion / std::max(share, 1e-300),
                    options_.most_moved / std::max(moved, 1e-300));
  }

  // Whether a closed path is back where it began.
  bool is_back(const Point& start, const Point& at, double h) const {
    if (report_.counters.steps < 4) return false;
    const double apart = distance_between(motions_, start.state, at.state);
    return std::hypot(apart, c_ * (at.p - start.p)) < 0.5 * h &&
           dot(start.tangent, at.tangent) > 0.5;
  }

  void trace(Point at) {
    const Point start = at;
    double h = 0.25 * largest_step(at);
    while (going_) {
      stop::check();
      if (report_.counters.steps >= options_.points) {
        report_.end = "as many points as were asked for are reached";
        return;
      }
      const double ahead = at.p + h * at.tangent(n_);
      int iterations = 0;
      if (ahead != within(ahead) && end_at(at, within(ahead))) return;
      std::optional<Point> next = step(at, h, iterations);
      const double cosine = next ? dot(at.tangent, next->tangent) : -1.0;
      if (!next || next->p != within(next->p) || cosine < std::cos(most_turn)) {
        ++report_.counters.retries;
        h *= 0.5;
        if (h >= smallest_step * largest_step(at) && report_.counters.retries < options_.retries)
          continue;
        report_.end = fmt::format("it cannot be followed beyond {:.6g}{}{}", at.p,
                                  force_ ? " of the force" : " rad/s",
                                  why_.empty() ? std::string() : ": " + why_);
        return;
      }
      if (!force_ && at.tangent(n_) * next->tangent(n_) < 0.0) locate_fold(at, *next, h);
      if (!going_ || !accept(*next)) break;
      if (is_back(start, *next, h)) {
        report_.end = "it is closed";
        return;
      }
      const double turn = std::acos(std::min(1.0, cosine));
      double factor = iterations <= easy ? 2.0 : 1.0;
      if (turn > 0.0) factor = std::clamp(0.5 * most_turn / turn, 0.5, factor);
      at = std::move(*next);
      h = std::min(h * factor, largest_step(at));
    }
    report_.end = "it was ended";
  }

  SmallMotions& motions_;
  const System& system_;
  const RotationPathOptions& options_;
  SteadyRotation rotation_;
  const VecX* force_;
  Index n_;
  VecX w_;
  double c_;  // measure of the parameter
  bool going_ = true;
  std::string why_;
  RotationPathReport report_;
};

}  // namespace

RotationPathReport follow_rotations(SmallMotions& motions, const SteadyRotation& start,
                                    const State& state, const RotationPathOptions& options) {
  return Path(motions, start, nullptr, options).go(state);
}

RotationPathReport follow_pushed_rotations(SmallMotions& motions, const SteadyRotation& start,
                                           const State& state, const VecX& force,
                                           const RotationPathOptions& options) {
  return Path(motions, start, &force, options).go(state);
}

double distance_between(const SmallMotions& motions, const State& a, const State& b) {
  VecX e = VecX::Zero(motions.unknowns());
  for (std::size_t n = 1; n < a.pose.size(); ++n)
    e.segment<6>(6 * static_cast<Index>(n - 1)) = log_se3(relative(a.pose[n], b.pose[n]));
  return std::sqrt(e.dot(motion_weights(motions.system()).cwiseProduct(e)));
}

}  // namespace mbd
