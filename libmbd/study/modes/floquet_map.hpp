// Floquet's exponents over values of parameters: where a motion that repeats is stable, and frequencies of small motions about
// it, as of a rotor under its weight, which has no Campbell diagram by constant coefficients.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/study/modes/floquet.hpp"
#include "libmbd/study/sweep/plan.hpp"
#include "libmbd/study/sweep/sweep.hpp"

namespace mbd {

struct FloquetMap {
  std::string model;
  SweepPlan plan;
  struct Point {
    std::optional<FloquetStudy> study;
    std::string failure;  // where there is none; empty and no study: not reached
  };
  std::vector<Point> points;  // of the plan
};

struct FloquetMapOptions {
  FloquetOptions floquet = {};                      // but for the period
  std::function<double(const Scene&)> period = {};  // [s] of the scene of a point
  std::function<void(std::size_t done, std::size_t all)> progress = {};
};

// Points one after the other; what fails is a point that says so. Interrupted it ends with what there is. Throws Error where
// all points fail, the reason of the first.
FloquetMap map_floquet(const ReadSweptModel& read, SweepPlan plan,
                       const FloquetMapOptions& options);

// For the terminal: how many points are stable, the largest growth, the first failures.
std::string to_text(const FloquetMap& map);
// A row for each small motion of each point: parameters, verdict, growth over a period, mode, exponent, frequencies; one for a
// point that failed.
std::string to_csv(const FloquetMap& map);
// Of one parameter that takes more than one value: frequencies over it, and growth, but for round-off. Of two: which points are stable. Of others
// nothing, and of values that are no numbers of one unit.
std::optional<std::string> floquet_svg(const FloquetMap& map);

}  // namespace mbd
