#include "solvers/time/error_control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libmbd/core/error.hpp"

namespace mbd {
namespace {

constexpr double finest = 1e-14;  // relative tolerance
// Lengths of the scene, or radians: smaller motions are as wrong as one of that size.
constexpr double least_motion = 1e-6;

}  // namespace

ErrorNorm::ErrorNorm(const System& system, const ErrorTolerances& tolerances, double duration)
    : tolerances_(tolerances), length_(system.length_scale()), duration_(duration) {
  const auto check = [](double value, std::string_view what, bool optional) {
    if (!(std::isfinite(value) && (value > 0.0 || (optional && value == 0.0))))
      throw Error(fmt::format("the {} must be positive, not {}", what, value));
  };
  check(tolerances.relative, "tolerance", false);
  check(tolerances.position, "position_tolerance", true);
  check(tolerances.rotation, "rotation_tolerance", true);
  check(tolerances.velocity, "velocity_tolerance", true);
  check(tolerances.angular_velocity, "angular_velocity_tolerance", true);
  if (tolerances.relative < finest)
    throw Error(
        fmt::format("a tolerance of {} is below round-off; {} is the finest that makes sense",
                    tolerances.relative, finest));
  measure(0.0, 0.0);
}

void ErrorNorm::measure(const State& begin, const State& end) {
  double speed = 0.0, spin = 0.0;
  for (const State* state : {&begin, &end})
    for (const Vec6& V : state->V) {
      speed = std::max(speed, V.head<3>().norm());
      spin = std::max(spin, V.tail<3>().norm());
    }
  constexpr double units = 8.0;  // of round-off, as in Newton's iterations (increments.cpp)
  double farthest = length_;
  for (const Pose<double>& H : end.pose) farthest = std::max(farthest, H.r.cwiseAbs().maxCoeff());
  round_off_ = units * std::numeric_limits<double>::epsilon() * farthest;
  step_ = std::abs(end.t - begin.t);
  measure(speed, spin);
  if (tolerances_.of == ErrorsOf::motion) measure_travel(begin, end);
}

void ErrorNorm::measure_travel(const State& begin, const State& end) {
  if (start_.empty()) start_ = begin.pose;
  const auto look = [this](const State& state, double& travel, double& turn) {
    for (std::size_t n = 1; n < start_.size(); ++n) {
      travel = std::max(travel, (state.pose[n].r - start_[n].r).norm());
      turn = std::max(turn, 2.0 * (start_[n].p.conjugate() * state.pose[n].p).vec().norm());
    }
  };
  look(begin, most_travel_, most_turn_);
  travel_ = most_travel_;
  turn_ = most_turn_;
  look(end, travel_, turn_);
  // As of velocities: a part that only turns moves its points.
  travel_ = std::max({travel_, 1e-3 * turn_ * length_, least_motion * length_});
  turn_ = std::max(turn_, 1e-3 * travel_ / length_);
}

void ErrorNorm::measure(double speed, double spin) {
  speed_ = std::max(length_ / duration_, speed);
  spin_ = std::max(1.0 / duration_, spin);
  // A part that only turns moves its points, and one that only moves turns what it drives.
  speed_ = std::max(speed_, 1e-3 * spin_ * length_);
  spin_ = std::max(spin_, 1e-3 * speed_ / length_);
}

ErrorTolerances ErrorNorm::limits() const {
  const auto limit = [](double given, double relative) { return given > 0.0 ? given : relative; };
  const double r = tolerances_.relative;
  const bool motion = tolerances_.of == ErrorsOf::motion;
  return {
      .relative = r,
      .position = limit(tolerances_.position, r * (motion ? std::min(travel_, length_) : length_)),
      .rotation = limit(tolerances_.rotation, r * (motion ? std::min(turn_, 1.0) : 1.0)),
      .velocity = limit(tolerances_.velocity, r * speed_),
      .angular_velocity = limit(tolerances_.angular_velocity, r * spin_),
      .of = tolerances_.of};
}

double ErrorNorm::operator()(std::span<const Vec6> eU, std::span<const Vec6> eV,
                             double factor) const {
  position_ = rotation_ = velocity_left_ = 0.0;
  worst_row_ = -1;
  double worst = 0.0, sum = 0.0;
  const ErrorTolerances allowed = limits();
  const double floor = round_off_ / factor, floor_rate = step_ > 0.0 ? floor / step_ : 0.0;
  const double limit[4] = {std::max(allowed.position, floor),
                           std::max(allowed.rotation, floor / length_),
                           std::max(allowed.velocity, floor_rate),
                           std::max(allowed.angular_velocity, floor_rate / length_)};
  const auto look = [&](const Vec6& e, std::size_t n, std::size_t kind) {
    for (Index i = 0; i < 6; ++i) {
      const double size = std::abs(e(i)) / limit[kind + (i < 3 ? 0 : 1)];
      sum += size;
      if (size > worst) {
        worst = size;
        worst_row_ = 6 * static_cast<Index>(n) + i;
      }
    }
  };
  for (std::size_t n = 1; n < eU.size(); ++n) {
    position_ = std::max(position_, eU[n].head<3>().norm());
    rotation_ = std::max(rotation_, eU[n].tail<3>().norm());
    look(eU[n], n, 0);
    if (eV.empty()) continue;
    if (tolerances_.of == ErrorsOf::velocities) {
      look(eV[n], n, 2);
    } else {
      const double speed = eV[n].head<3>().norm() / speed_, spin = eV[n].tail<3>().norm() / spin_;
      velocity_left_ = std::max({velocity_left_, speed, spin});
      sum += speed + spin;
    }
  }
  if (!std::isfinite(sum)) return std::numeric_limits<double>::quiet_NaN();
  return worst / factor;
}

double ErrorNorm::velocity_share(double rate) const {
  return std::min({1.0, speed_ / (rate * length_), spin_ / rate});
}

double first_step(const System& system, const State& state, double span) {
  constexpr double share = 1e-3;  // of the scene's length, of a radian
  const double length = system.length_scale();
  double h = 1e-2 * span;
  for (std::size_t n = 1; n < state.V.size(); ++n) {
    const Vec6 &V = state.V[n], &A = state.Vdot[n];
    const double speed = std::max(V.head<3>().norm() / length, V.tail<3>().norm());
    const double rise = std::max(A.head<3>().norm() / length, A.tail<3>().norm());
    if (speed * h > 10.0 * share) h = 10.0 * share / speed;
    if (rise * h * h > share) h = std::sqrt(share / rise);
  }
  return h;
}

void StepController::start(double h) {
  h_ = std::min(h, most_);
  steady_ = 0;
  rising_ = true;
}

void StepController::accepted(double h, double error) {
  constexpr double safety = 0.85, most = 6.0, least = 0.5;
  constexpr double worth = 1.1;  // gains below are not worth a factorisation,
  constexpr double much = 2.0;   // above are not waited for
  constexpr int patience = 8;    // steps that a gain between is waited for
  constexpr double tight = 0.9;  // an error above: the next one would be too large
  const double e = std::max(error, 1e-8);
  const double gain = safety * std::pow(e, -1.0 / order_);
  if (h < h_ * 0.999) return;  // cut short by a breakpoint: says little
  if (e > tight) {
    h_ = h * std::clamp(gain, least, 1.0);
    steady_ = 0;
    rising_ = false;
    return;
  }
  allowed_ = steady_ == 0 ? gain : std::min(allowed_, gain);
  ++steady_;
  if (allowed_ < worth && rising_) rising_ = false;
  if (allowed_ >= worth && (rising_ || steady_ >= patience || (allowed_ >= much && steady_ >= 2))) {
    h_ = std::min(h * std::min(allowed_, most), most_);
    steady_ = 0;
  } else if (steady_ >= patience) {
    steady_ = 0;
  }
}

void StepController::rejected(double h, double error) {
  constexpr double safety = 0.8, least = 0.1, most = 0.8;
  h_ = h * std::clamp(std::isfinite(error) ? safety * std::pow(error, -1.0 / order_) : least, least,
                      most);
  steady_ = 0;
  rising_ = false;
}

void StepController::failed(double h) {
  h_ = 0.4 * h;
  steady_ = 0;
  rising_ = false;
}

}  // namespace mbd
