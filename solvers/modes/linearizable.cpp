#include "solvers/modes/linearizable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
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

// Whether a motion that constraints leave free changes the argument of a law to the first order; else its kink is none of
// the motion: a guy across a rail, what a joint or a drive holds. All laws with kinks at one state, and the place of this one.
class Moves {
 public:
  Moves(const System& system, const State& state)
      : system_(system),
        state_(state),
        units_(system, state),
        u_(random_free_motion(system, state, units_)) {}

  bool operator()(const std::vector<NearKink>& all, std::size_t k) const {
    constexpr double none = 1e-9;  // of the motion
    const ArgumentOf of = all[k].of;
    const double L = system_.length_scale(),
                 unit = of == ArgumentOf::length || of == ArgumentOf::speed ? L : 1.0;
    if (u_.size() == 0) return false;
    // Without the third order of the motion.
    const std::optional<double> far = rate(all, k, step), near = rate(all, k, 0.5 * step);
    if (!far || !near) return true;  // not known
    return std::abs((4.0 * *near - *far) / 3.0) > none * unit;
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
  std::optional<Moves> moves;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (stays[k] == 0) continue;
    if (!moves) moves.emplace(system, states.front());
    if (!(*moves)(all, k)) continue;
    const NearKink& near = all[k];
    const auto [variable, unit] = words_of(near.of);
    return fmt::format(
        "{} is at a kink of its law: at {} = {:.6g} {} the slope is {:.6g} from below and {:.6g} "
        "from above, so motions near this state are not linear; make the law smooth there, or take "
        "a state that is on one side of it",
        near.element, variable, near.kink.at, unit, near.kink.below, near.kink.above);
  }
  return {};
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
  const auto share = [&](const NearKink& near) {
    return std::abs(near.x - near.kink.at) / sizes.of(near);
  };
  const auto nearest = std::ranges::min_element(all, {}, share);
  if (nearest == all.end()) return {};
  const auto [variable, unit] = words_of(nearest->of);
  return fmt::format(
      "linear while {} stays on this side of its kink at {} = {:.6g} {}, which is {:.3g} {} away",
      nearest->element, variable, nearest->kink.at, unit, std::abs(nearest->x - nearest->kink.at),
      unit);
}

}  // namespace mbd
