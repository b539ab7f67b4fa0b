#include "solvers/modes/linearizable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

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

}  // namespace

std::string kink_at(const System& system, std::span<const State> states) {
  const std::vector<NearKink> all = system.near_kinks(states.front());
  std::vector<char> stays(all.size(), 1);
  for (const State& state : states) {
    const Sizes sizes(system, state);
    const std::vector<NearKink> here = system.near_kinks(state);
    for (std::size_t k = 0; k < here.size(); ++k)
      if (std::abs(here[k].x - here[k].kink.at) > round_off * sizes.of(here[k])) stays[k] = 0;
  }
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (stays[k] == 0) continue;
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
