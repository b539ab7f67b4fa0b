// Cases that reviews of Radau found, each the smallest that shows it.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <limits>

#include "libmbd/core/error.hpp"
#include "tests/support/stepping.hpp"

namespace mbd::test::test_radau_found {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

void expect_has(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text << "\nhas no: " << part;
}

std::string error_of(const System& system, const MakeStepper& make) {
  try {
    State state = system.reference_state();
    static_cast<void>(make(system)->start(state));
  } catch (const Error& e) {
    return e.what();
  }
  return "none";
}

// The tolerance of Newton's iterations is near round-off of a slender rod, where increments stall at 2 to 10 of it.
TEST(RadauFound, FixedStepsWithDefaultToleranceOfNewton) {
  for (const auto& [model, h] :
       {std::pair{"every_joint", 1e-2}, {"every_joint", 1e-3}, {"slider_crank", 1e-3}}) {
    const Driven d = drive(model_scene(model), radau({.step = h}), 0.1);
    EXPECT_TRUE(d.last.converged) << model << ": " << d.last.failure;
  }
}

// At a change point constraints on velocities can only be met if those on positions are: by rank-tolerant steps
// (test_singular.cpp compares with a pendulum).
TEST(RadauFound, FixedStepsPassAChangePoint) {
  const Driven d = drive(model_scene("windows"), radau({.step = 1e-2}), 1.0);
  EXPECT_TRUE(d.last.converged) << d.last.failure;
}

// Constraints of accepted states at loose tolerances, where steps turn far: the projection, with the kept matrix,
// ends at 6e-14 of the length and 5e-12 of the speed.
TEST(RadauFound, ConstraintsAtLooseTolerances) {
  const Driven d =
      drive(model_scene("every_joint"), radau({.tolerances = {.relative = 1e-3}, .end = 2.0}), 2.0);
  ASSERT_TRUE(d.last.converged) << d.last.failure;
  EXPECT_LE(d.g, 1e-14 * d.model.system->length_scale());
  EXPECT_LE(d.gdot, 1e-14 * d.fastest);
}

// After rank-tolerant steps, next to a change point, gradients hardly tell directions apart: constraints hold to less
// than round-off there, but better than the tolerance.
TEST(RadauFound, ConstraintsAfterRankTolerantSteps) {
  const Driven d =
      drive(model_scene("windows"), radau({.tolerances = {.relative = 1e-6}, .end = 10.0}), 10.0);
  ASSERT_TRUE(d.last.converged) << d.last.failure;
  EXPECT_LE(d.g, 1e-8);
  EXPECT_LE(d.gdot, 1e-5);
}

// Settings that would be ignored, or without end.
TEST(RadauFound, StepLimitsWithoutSenseAreRefused) {
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
}  // namespace mbd::test::test_radau_found
