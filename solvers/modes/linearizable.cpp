#include "solvers/modes/linearizable.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "solvers/constraints/free_motions.hpp"
#include "solvers/constraints/rank_loss.hpp"

namespace mbd {
namespace {

constexpr double round_off = 1e-9;

struct Words {
  char variable;
  const char* unit;
};

Words words_of(ArgumentOf of) {
  switch (of) {
    case ArgumentOf::length:
      return {'x', "m"};
    case ArgumentOf::angle:
      return {'x', "rad"};
    case ArgumentOf::speed:
      return {'v', "m/s"};
    case ArgumentOf::angular_speed:
      break;
  }
  return {'v', "rad/s"};
}

std::string slopes_in_words(const Kink& kink, bool cancels = false) {
  return fmt::format(" is {:.6g} from below and {:.6g} from above, ", kink.below, kink.above) +
         (cancels
              ? "and kinks of other laws make up for it, which small motions do not see: they "
                "take one slope of each; give them as one law, their sum"
              : "so motions near this state are not linear; make the law smooth there, or take a "
                "state that is on one side of it");
}

// What arguments of each kind are round-off of, by the size and the motion of the scene.
struct Sizes {
  double length, turn;  // fastest turn [rad/s], of displacements over the length too

  Sizes(const System& system, const State& state) : length(system.length_scale()), turn(1e-3) {
    for (const Vec6& V : state.V)
      turn = std::max({turn, V.head<3>().norm() / length, V.tail<3>().norm()});
  }
  double of(const NearKink& near) const {
    const double at = std::abs(near.kink.at);
    switch (near.of) {
      case ArgumentOf::length:
        return std::max(at, length);
      case ArgumentOf::angle:
        return std::max(at, 1.0);
      case ArgumentOf::speed:
        return std::max(at, turn * length);
      case ArgumentOf::angular_speed:
        break;
    }
    return std::max(at, turn);
  }
};

bool is_at(const NearKink& near, const Sizes& sizes) {
  return std::abs(near.x - near.kink.at) <= round_off * sizes.of(near);
}
bool alike(const NearKink& a, const NearKink& b) { return a.element == b.element && a.of == b.of; }

// What a motion that constraints leave free changes the argument of a law by, to the first order; if it is nothing, its kink is
// none of the motion: a guy across a rail, what a joint or a drive holds. All laws with kinks at one state, and the place of this
// one.
class Changes {
 public:
  Changes(const System& system, const State& state)
      : system_(system),
        state_(state),
        units_(system, state),
        u_(random_free_motion(system, state, units_, 5)) {}

  // What the motion changes the argument of law k by; 0 of round-off, nothing if it is not known.
  std::optional<double> operator()(const std::vector<NearKink>& all, std::size_t k) const {
    constexpr double none = 1e-9;  // of the motion
    const ArgumentOf of = all[k].of;
    const double L = system_.length_scale(),
                 unit = of == ArgumentOf::length || of == ArgumentOf::speed ? L : 1.0;
    if (u_.size() == 0) return 0.0;
    // Without the third order of the motion.
    const std::optional<double> far = rate(all, k, step), near = rate(all, k, 0.5 * step);
    if (!far || !near) return std::nullopt;
    const double change = (4.0 * *near - *far) / 3.0;
    return std::abs(change) > none * unit ? change : 0.0;
  }

 private:
  static constexpr double step = 1e-4;  // of u

  // Of the argument, along u, by a central difference.
  std::optional<double> rate(const std::vector<NearKink>& all, std::size_t k, double by) const {
    const std::optional<double> ahead = argument(all, k, by), behind = argument(all, k, -by);
    if (!ahead || !behind) return std::nullopt;
    return (*ahead - *behind) / (2.0 * by);
  }
  std::optional<double> argument(const std::vector<NearKink>& all, std::size_t k, double by) const {
    const bool speed = all[k].of == ArgumentOf::speed || all[k].of == ArgumentOf::angular_speed;
    State state = state_;
    if (!speed) state = units_.moved(std::move(state), u_, by);
    for (std::size_t n = 1; speed && n < state.V.size(); ++n)
      state.V[n] += by * units_.of_node(u_, n);
    const std::vector<NearKink> there = system_.near_kinks(state);
    if (!std::ranges::equal(all, there, alike)) return std::nullopt;
    return there[k].x;
  }

  const System& system_;
  const State& state_;
  UnitMotions units_;
  VecX u_;  // empty: nothing is free
};

// What the sensors of all laws of sensors read, in the order of these.
std::vector<double> readings_at(const System& system, const State& state) {
  std::vector<double> all;
  system.each_law_of_sensors(
      state, [&](const std::string&, const Expression&, std::span<const double> readings) {
        all.insert(all.end(), readings.begin(), readings.end());
      });
  return all;
}

// What readings change by along motions that constraints leave free, at other velocities: two such, and both; empty if nothing
// is free.
std::vector<std::vector<double>> changes_of_readings(const System& system, const State& state) {
  constexpr double step = 1e-4, none = 1e-9;  // of a motion; of what changes most
  const UnitMotions units(system, state);
  const VecX u = random_free_motion(system, state, units, 5),
             w = random_free_motion(system, state, units, 6);
  if (u.size() == 0) return {};
  const auto along = [&](const VecX& motion, const VecX& speed) {
    const auto at = [&](double by) {
      State there = units.moved(state, motion, by);
      for (std::size_t n = 1; n < there.V.size(); ++n) there.V[n] += by * units.of_node(speed, n);
      return readings_at(system, there);
    };
    const std::vector<double> ahead = at(step), behind = at(-step), near_ahead = at(0.5 * step),
                              near_behind = at(-0.5 * step);
    std::vector<double> changes;
    double most = 0.0;
    for (std::size_t i = 0; i < ahead.size(); ++i) {  // without the third order
      changes.push_back((8.0 * (near_ahead[i] - near_behind[i]) - (ahead[i] - behind[i])) /
                        (6.0 * step));
      most = std::max(most, std::abs(changes.back()));
    }
    for (double& one : changes)
      if (!(std::abs(one) > none * most)) one = 0.0;
    return changes;
  };
  std::vector<std::vector<double>> all{along(u, w), along(w, -u)};
  all.push_back(all[0]);
  for (std::size_t i = 0; i < all[2].size(); ++i) all[2][i] += all[1][i];
  return all;
}

// A law along y + h c of its readings.
class LawAlong {
 public:
  LawAlong(const Expression& law, const State& state, std::span<const double> y,
           std::span<const double> c)
      : law_(law), state_(state), y_(y), c_(c), there_(y.size()) {}

  double value(double h) {
    move(h);
    return law_(state_.t, state_.side, state_.inputs, there_).v;
  }
  double slope(double h) {
    return slopes(h, [](double one) { return one; });
  }
  // If nothing cancelled.
  double size(double h) {
    return slopes(h, [](double one) { return std::abs(one); });
  }

 private:
  void move(double h) {
    for (std::size_t i = 0; i < y_.size(); ++i) there_[i] = y_[i] + h * c_[i];
  }
  template <class Of>
  double slopes(double h, const Of& of) {
    move(h);
    double sum = 0.0;
    for (std::size_t i = 0; i < y_.size(); ++i)
      if (c_[i] != 0.0)
        sum += of(c_[i] * law_.derivative(i, state_.t, state_.side, state_.inputs, there_));
    return sum;
  }

  const Expression& law_;
  const State& state_;
  std::span<const double> y_, c_;
  std::vector<double> there_;
};

// Why a law of sensors has no tangent at its readings y, in words; empty if it has one. `changes`: changes_of_readings(), of
// this law. (No condition tells of it: those are refused where laws are read.)
std::string why_no_tangent(const Expression& law, const State& state, std::span<const double> y,
                           const std::array<std::span<const double>, 3>& changes) {
  constexpr double beside = 1e-9, nearer = 1e-12, same = 1e-6, kept = 0.5, cancelled = 1e-9;
  double rest = 0.0, rest_nearer = 0.0,
         most = 0.0;  // of slopes along two motions, less that along both
  for (std::size_t d = 0; d < changes.size(); ++d) {
    LawAlong path(law, state, y, changes[d]);
    if (const auto jump = hidden_kink([&](double h) { return path.value(h); }, 0.0))
      return fmt::format("it jumps from {:.6g} to {:.6g}, and has no slope", jump->below,
                         jump->above);
    const double size = std::max(path.size(-beside), path.size(beside));
    if (auto kink = hidden_kink([&](double h) { return path.slope(h); }, 0.0);
        kink && !(std::abs(kink->above - kink->below) <= cancelled * size)) {
      if (y.size() > 1) return "along motions the slope" + slopes_in_words(*kink);
      const double c = changes[d][0];
      if (c < 0.0) std::swap(kink->below, kink->above);
      return "the slope" + slopes_in_words({0.0, kink->below / c + 0.0, kink->above / c + 0.0});
    }
    const double sign = d < 2 ? 1.0 : -1.0;
    rest += sign * path.slope(beside);
    rest_nearer += sign * path.slope(nearer);
    most = std::max(most, size);
  }
  // Of smooth laws what is left is as small as the distance.
  if (!(std::abs(rest) > same * most && std::abs(rest_nearer) > kept * std::abs(rest))) return {};
  return "slopes along two motions do not add up to that along both, so motions near this state "
         "are "
         "not linear; make the law smooth there, or take another state";
}

struct KinkOfSensor {
  std::string law, why;
};

std::vector<KinkOfSensor> sensors_at_kinks(const System& system, const State& state) {
  std::vector<KinkOfSensor> found;
  std::vector<std::vector<double>> changes;
  std::size_t first = 0;  // of a law's readings
  system.each_law_of_sensors(
      state, [&](const std::string& name, const Expression& law, std::span<const double> y) {
        if (changes.empty()) changes = changes_of_readings(system, state);
        if (changes.empty()) return;
        const auto own = [&](std::size_t d) {
          return std::span<const double>(changes[d]).subspan(first, y.size());
        };
        std::string why = why_no_tangent(law, state, y, {own(0), own(1), own(2)});
        first += y.size();
        if (why.empty()) return;
        std::vector<std::string> places;
        for (std::size_t i = 0; i < y.size(); ++i)
          places.push_back(fmt::format("{} = {:.6g}", law.sensors()[i], y[i]));
        found.push_back({name, fmt::format("at {} (SI) {}", fmt::join(places, ", "), why)});
      });
  return found;
}

// As kink_at(), of laws of sensors.
std::string sensor_at_kink(const System& system, std::span<const State> states) {
  std::vector<KinkOfSensor> stay = sensors_at_kinks(system, states.front());
  for (const State& state : states.subspan(1)) {
    if (stay.empty()) break;
    const std::vector<KinkOfSensor> here = sensors_at_kinks(system, state);
    std::erase_if(stay, [&](const KinkOfSensor& one) {
      return std::ranges::none_of(here,
                                  [&](const KinkOfSensor& other) { return one.law == other.law; });
    });
  }
  if (stay.empty()) return {};
  return fmt::format("{} is at a kink of its law: {}", stay.front().law, stay.front().why);
}

}  // namespace

std::string kink_at(const System& system, std::span<const State> states) {
  const std::vector<NearKink> all = system.near_kinks(states.front());
  std::vector<char> stays(all.size(), 1);
  for (const State& state : states) {
    const Sizes sizes(system, state);
    const std::vector<NearKink> here = system.near_kinks(state);
    for (std::size_t k = 0; k < all.size(); ++k)
      if (std::ranges::none_of(here, [&](const NearKink& near) {
            return alike(near, all[k]) && is_at(near, sizes);
          }))
        stays[k] = 0;
  }
  std::optional<Changes> changes;
  std::optional<std::size_t> first;  // that the motion changes
  // By how much slopes along the motion, u^T K u and u^T C u, differ between its two sides: in all, and if nothing cancelled.
  double jump[2] = {0.0, 0.0}, most[2] = {0.0, 0.0};
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (stays[k] == 0) continue;
    if (!changes) changes.emplace(system, states.front());
    const std::optional<double> change = (*changes)(all, k);
    if (change == 0.0) continue;
    if (!first) first = k;
    const bool is_rate = all[k].of == ArgumentOf::speed || all[k].of == ArgumentOf::angular_speed;
    const double x = change.value_or(std::numeric_limits<double>::infinity()),
                 one = (all[k].kink.above - all[k].kink.below) * x * std::abs(x);
    jump[is_rate] += one;
    most[is_rate] += std::abs(one);
  }
  if (first) {
    constexpr double same = 1e-6;
    // What one rope lets go another takes up: linear, but of each law one slope would be taken.
    const bool cancels = std::abs(jump[0]) <= same * most[0] && std::abs(jump[1]) <= same * most[1];
    const NearKink& near = all[*first];
    const auto [variable, unit] = words_of(near.of);
    return fmt::format("{} is at a kink of its law: at {} = {:.6g} {} the slope", near.element,
                       variable, near.kink.at, unit) +
           slopes_in_words(near.kink, cancels);
  }
  return sensor_at_kink(system, states);
}

std::string why_not_linear(const System& system, const State& state) {
  if (std::string kink = kink_at(system, {&state, 1}); !kink.empty()) return kink;
  const std::string lost = rank_loss(system, state);
  if (lost.empty()) return {};
  return lost +
         ": to the first order they leave more ways to move than beside it, and motions near it "
         "are not linear; take another configuration";
}

std::string range_of_linearity(const System& system, const State& state) {
  const Sizes sizes(system, state);
  const std::vector<NearKink> all = system.near_kinks(state);
  // What is at its kink and did not forbid to linearise is none of the motion.
  const auto share = [&](const NearKink& near) {
    return is_at(near, sizes) ? std::numeric_limits<double>::infinity()
                              : std::abs(near.x - near.kink.at) / sizes.of(near);
  };
  const auto nearest = std::ranges::min_element(all, {}, share);
  if (nearest == all.end() || is_at(*nearest, sizes)) return {};
  const auto [variable, unit] = words_of(nearest->of);
  return fmt::format(
      "linear while {} stays on this side of its kink at {} = {:.6g} {}, which is {:.3g} {} away",
      nearest->element, variable, nearest->kink.at, unit, std::abs(nearest->x - nearest->kink.at),
      unit);
}

}  // namespace mbd
