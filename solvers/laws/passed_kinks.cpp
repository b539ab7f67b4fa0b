#include "solvers/laws/passed_kinks.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "solvers/laws/crossed_kink.hpp"

namespace mbd {
namespace {

constexpr double near_share = 0.01;  // of the rise over the chord
constexpr double inside = 1e-9;      // of a cubic: at its ends it is where the states are

bool is_place(const NearKink& kink) {
  return kink.of == ArgumentOf::length || kink.of == ArgumentOf::angle;
}

// Where x = x0 + h v0 s + … turns within 0 < s < 1, with x and the rise over the chord there.
struct Turn {
  double s, x, rise;
};
std::array<std::optional<Turn>, 2> turns_of(double x0, double v0, double x1, double v1, double h) {
  const double d = x1 - x0, p = h * v0, q = h * v1;
  const double b = 3.0 * d - 2.0 * p - q, a = p + q - 2.0 * d;  // x = x0 + p s + b s^2 + a s^3
  std::array<std::optional<Turn>, 2> turns;
  const double discriminant = b * b - 3.0 * a * p;
  if (!(discriminant > 0.0)) return turns;
  // Without cancellation: -b - sign(b) root over 3 a, and p over that.
  const double w = -(b + std::copysign(std::sqrt(discriminant), b));
  const std::array<double, 2> roots = {w / (3.0 * a), p / w};
  for (std::size_t i = 0; i < 2; ++i) {
    const double s = roots[i];
    if (!(s > inside && s < 1.0 - inside)) continue;
    const double x = x0 + s * (p + s * (b + s * a));
    turns[i] = Turn{s, x, std::abs(x - (x0 + s * d))};
  }
  return turns;
}

}  // namespace

void PassedKinks::look(const State& state, double h, Place& place) {
  constexpr double share = 1e-5;  // of the time, for rates
  place.t = state.t;
  place.kinks = system_.near_kinks(state);
  moved_ = state;
  const double dt = share * h;
  for (std::size_t n = 1; n < moved_.pose.size(); ++n)
    moved_.pose[n] = state.pose[n] * exp_se3<double>(Vec6(dt * state.V[n]));
  const std::vector<NearKink> there = system_.near_kinks(moved_);
  place.rates.assign(place.kinks.size(), 0.0);
  for (std::size_t k = 0; k < std::min(place.kinks.size(), there.size()); ++k)
    place.rates[k] = (there[k].x - place.kinks[k].x) / dt;
}

std::optional<double> PassedKinks::turn(const State& begin, std::span<const State> inside_states,
                                        const State& end) {
  const std::optional<double> kink = turn(begin, inside_states, end, true),
                              feature = features_.end(begin, inside_states, end);
  return kink && feature ? std::min(*kink, *feature) : kink ? kink : feature;
}

std::optional<double> PassedKinks::turn(const State& begin, std::span<const State> inside_states,
                                        const State& end, bool nearly) {
  if (!any_) {
    const std::vector<NearKink> all = system_.near_kinks(begin);
    any_ = std::any_of(all.begin(), all.end(), is_place);
  }
  if (!*any_) return std::nullopt;
  const double h = end.t - begin.t;
  look(begin, h, before_);
  std::optional<double> first;
  for (std::size_t i = 0; i <= inside_states.size() && !first; ++i) {
    look(i < inside_states.size() ? inside_states[i] : end, h, after_);
    if (after_.kinks.size() != before_.kinks.size()) return std::nullopt;
    const double length = after_.t - before_.t;
    for (std::size_t k = 0; k < after_.kinks.size(); ++k) {
      const NearKink &a = before_.kinks[k], &b = after_.kinks[k];
      if (!is_place(a)) continue;
      for (const auto& turn : turns_of(a.x, before_.rates[k], b.x, after_.rates[k], length)) {
        if (!turn) continue;
        const double margin = nearly ? near_share * turn->rise : 0.0;
        for (const double kink : {a.kink.at, b.kink.at}) {
          const bool below = a.x < kink && b.x<kink, above = a.x> kink && b.x > kink;
          if ((below && turn->x + margin > kink) || (above && turn->x - margin < kink)) {
            const double t = before_.t + turn->s * length;
            first = first ? std::min(*first, t) : t;
          }
        }
      }
    }
    std::swap(before_, after_);
  }
  return first;
}

bool PassedKinks::passes(const State& begin, std::span<const State> inside_states,
                         const State& end) {
  bool passed = features_.end(begin, inside_states, end).has_value();
  passed = turn(begin, inside_states, end, false).has_value() || passed;
  if (!any_ || !*any_) return passed;
  const std::vector<NearKink> from = system_.near_kinks(begin), to = system_.near_kinks(end);
  last_.resize(from.size());
  for (std::size_t k = 0; k < std::min(from.size(), to.size()); ++k) {
    if (!is_place(from[k])) continue;
    if (last_[k].steps < few) ++last_[k].steps;
    if (const std::optional<double> kink = crossed_kink(from[k], to[k])) {
      passed = passed || (last_[k].steps < few && last_[k].kink == *kink);
      last_[k] = {*kink, 0};
    }
  }
  return passed;
}

}  // namespace mbd
