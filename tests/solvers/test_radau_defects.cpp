// What Radau does not do yet as its header says; each test is the smallest case that shows it.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <limits>

#include "libmbd/core/error.hpp"
#include "tests/support/stepping.hpp"

namespace mbd::test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

void expect_has(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text << "\nhas no: " << part;
}

std::string error_of(const System& system, const MakeStepper& make) {
  try {
    State state = system.reference_state();
    make(system)->start(state);
  } catch (const Error& e) {
    return e.what();
  }
  return "none";
}

// Default settings: increments stay at 2 to 10 tolerances (1e-13), which is round-off of the rod, and count as
// divergence. With 1e-11 every step converges.
TEST(RadauDefects, FixedStepsWithDefaultToleranceOfNewton) {
  for (const auto& [model, h] :
       {std::pair{"every_joint", 1e-2}, {"every_joint", 1e-3}, {"slider_crank", 1e-3}}) {
    const Driven d = drive(model_scene(model), radau({.step = h}), 0.1);
    EXPECT_TRUE(d.last.converged) << model << ": " << d.last.failure;
  }
}

// Fixed steps end at the change point of windows at 0.714 s, whatever the tolerance of Newton's iterations (1e-9
// to 1e-13) and the step (1 to 10 ms), even in parts of a thirty-second; generalized-alpha passes it with both.
TEST(RadauDefects, FixedStepsThroughAChangePoint) {
  for (const double tolerance : {1e-10, 1e-11}) {
    const Driven d = drive(
        model_scene("windows"),
        radau({.step = 1e-3, .newton = {.tolerance = tolerance, .multiplier_tolerance = 1e-8}}),
        1.0);
    EXPECT_TRUE(d.last.converged) << d.last.failure;
    const Driven alpha =
        drive(model_scene("windows"),
              generalized_alpha({.step = 1e-3, .rho_infinity = 0.9, .newton = {}}), 1.0);
    EXPECT_TRUE(alpha.last.converged) << alpha.last.failure;
  }
}

// Constraints of accepted states at loose tolerances, where steps turn far: the projection, with the kept matrix,
// ends at 6e-14 of the length and 5e-12 of the speed.
TEST(RadauDefects, ConstraintsAtLooseTolerances) {
  const Driven d =
      drive(model_scene("every_joint"), radau({.tolerances = {.relative = 1e-3}, .end = 2.0}), 2.0);
  ASSERT_TRUE(d.last.converged) << d.last.failure;
  EXPECT_LE(d.g, 1e-14 * d.model.system->length_scale());
  EXPECT_LE(d.gdot, 1e-14 * d.fastest);
}

// And after rank-tolerant steps: g 4e-10, gdot 2e-6.
TEST(RadauDefects, ConstraintsAfterRankTolerantSteps) {
  const Driven d =
      drive(model_scene("windows"), radau({.tolerances = {.relative = 1e-6}, .end = 10.0}), 10.0);
  ASSERT_TRUE(d.last.converged) << d.last.failure;
  EXPECT_LE(d.g, 1e-12);
  EXPECT_LE(d.gdot, 1e-10);
}

// Settings that would be ignored, or without end.
TEST(RadauDefects, StepLimitsWithoutSenseAreRefused) {
  const Model model = compile(model_scene("pendulum"));
  const System& system = *model.system;
  for (const double most : {-1.0, nan}) {
    expect_has(
        error_of(system, radau({.tolerances = {.relative = 1e-3}, .end = 1.0, .max_step = most})),
        "max_step");
    expect_has(error_of(system, generalized_alpha({.tolerances = {.relative = 1e-3},
                                                   .end = 1.0,
                                                   .max_step = most,
                                                   .newton = {}})),
               "max_step");
  }
  EXPECT_NE(error_of(system, radau({.tolerances = {.relative = 1e-3}, .end = HUGE_VAL})), "none");
}

}  // namespace
}  // namespace mbd::test
