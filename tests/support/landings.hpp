// Scenes whose loads and drives change between two steps, and mechanisms that lock: for every Stepper.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "solvers/newton/report.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test {

inline Scene scene_of(const std::string& items, const Overrides& overrides = {}) {
  return read_model_text("<mbd name=\"test\">" + items + "</mbd>", "test.xml", overrides);
}

// Breakpoints on steps of 0.1 s cost none, kinks no restart, and times that differ by round-off are one (not those that differ by
// more: a pulse that is narrow has its impulse, CutShort.NarrowPulsesHaveTheirImpulse).
inline void expect_breakpoints_counted(const std::function<Counters(const Scene&)>& run_for_1_s) {
  const auto counters = [&](const std::string& force) {
    return run_for_1_s(scene_of(R"xml(
      <body name="ball" mass="2" inertia="1 1 1"/><load at="ball" force=")xml" +
                                force + R"xml( 0 0"/><transient duration="1" step="0.1"/>)xml"));
  };
  Counters c = counters("t&gt;0.3?1:0");
  EXPECT_EQ(c.substeps, 10);
  EXPECT_EQ(c.restarts, 1);
  c = counters("t&gt;0.35?t-0.35:0");
  EXPECT_EQ(c.substeps, 11);
  EXPECT_EQ(c.restarts, 0);
  c = counters("(t&gt;0.3?1:0)+(t&gt;0.1*3?1:0)+(t&gt;0.3+2e-14?1:0)");
  EXPECT_EQ(c.substeps, 10);
  EXPECT_EQ(c.restarts, 1);
}

// A disk under a moment cos(5 t) from an instant no step meets, and the relative error of its angle at 1 s:
// theta'' = cos(5 t)/2 from t0 on.
inline Scene late_disk(double step) {
  return scene_of(R"xml(<parameter name="h" value="1"/>
    <body name="disk" mass="1" inertia="1 1 2"/>
    <revolute name="R" between="ground disk" axis="0 0 1"/>
    <load at="disk" moment="0 0 t&lt;sqrt(0.11)?0:cos(5*t)"/>
    <transient duration="1" step="h" rho_infinity="0.5"/>)xml",
                  {{"h", std::to_string(step)}});
}
inline double late_disk_error(const State& state) {
  const double t0 = std::sqrt(0.11);
  const double exact =
      0.5 * ((std::cos(5 * t0) - std::cos(5.0)) / 25.0 - std::sin(5 * t0) / 5.0 * (1.0 - t0));
  const double angle = 2.0 * std::atan2(state.pose[1].p.z(), state.pose[1].p.w());
  return std::abs(angle - exact) / std::abs(exact);
}

// A crank of 1 drives a rocker of 1 through a rod of 1 over a base of 2: at cos(theta) = 1/4 the rod and
// the rocker are in line, and the crank cannot go on.
inline constexpr const char* locking = R"xml(
  <parameter name="rate" value="1"/><parameter name="h" value="0.01"/>
  <body name="crank" at="0 0 0" mass="1" center="0.5 0 0" inertia="1e-3 0.1 0.1"/>
  <body name="rod" at="1 0 0" orientation="0 0 atan2(sqrt(3)/2,0.5)" mass="1" center="0.5 0 0" inertia="0.01 0.1 0.1"/>
  <body name="rocker" at="2 0 0" orientation="0 0 atan2(sqrt(3)/2,-0.5)" mass="1" center="0.5 0 0" inertia="1e-3 0.1 0.1"/>
  <revolute name="A" between="ground crank" at="0 0 0" axis="0 0 1"/>
  <spherical name="B" between="crank rod" at="1 0 0"/>
  <spherical name="C" between="rod rocker" at="1.5 sqrt(3)/2 0"/>
  <revolute name="D" between="ground rocker" at="2 0 0" axis="0 0 1"/>
  <drive joint="A" rate="t&lt;0.5?rate*(1-cos(2*pi*t))/2:rate"/>
  <transient duration="4" step="h" rho_infinity="0.8"/>
  <record name="A" joint="A" quantities="angle"/>)xml";
inline const double lock_time = std::acos(0.25) + 0.25;  // [s]: the law loses 0.25 s

}  // namespace mbd::test
