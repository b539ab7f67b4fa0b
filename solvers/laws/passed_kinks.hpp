// Kinks of laws of the motion (stops, ropes, walls) that a step passes over: an argument x that goes beyond a kink and comes back
// between two places of the step whose states are known has met the law at neither, and no estimate of errors knows of it.
//
// Between two places x is the cubic through x and x' of both; where it turns back beyond the kink, or nearly so, the step should
// end. "Nearly": within 1 % of what the cubic rises over its chord, which is more than cubics are wrong by where steps resolve
// the motion.
// Not used: roots of x - kink, which a step that meets the law at one end finds by its error.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "libmbd/core/system.hpp"
#include "solvers/laws/passed_features.hpp"

namespace mbd {

class PassedKinks {
 public:
  explicit PassedKinks(const System& system) : system_(system), features_(system) {}

  // The first time [s] between the states, of rising times and with velocities, at which an argument has passed a kink, or has
  // come near, and turns back, or by which it has gone over other features of its law (passed_features.hpp); nothing: none does.
  // Costs nothing where there are no such laws.
  std::optional<double> turn(const State& begin, std::span<const State> inside, const State& end);
  // Of steps that are what they are, one after the other: whether an argument has passed a kink in this one and turned back, or
  // had passed it less than `few` steps before and comes back now, or has gone over other features of its law.
  static constexpr int few = 4;
  bool passes(const State& begin, std::span<const State> inside, const State& end);

 private:
  std::optional<double> turn(const State& begin, std::span<const State> inside, const State& end,
                             bool nearly);
  struct Crossing {
    double kink = 0.0;
    int steps = few;  // since then
  };
  struct Place {
    double t = 0.0;
    std::vector<NearKink> kinks;  // with the arguments
    std::vector<double> rates;
  };
  void look(const State& state, double h, Place& place);

  const System& system_;
  PassedFeatures features_;
  std::optional<bool> any_;  // whether a law of a length or an angle has kinks; not yet known
  Place before_, after_;
  std::vector<Crossing> last_;  // of each argument
  State moved_;
};

}  // namespace mbd
