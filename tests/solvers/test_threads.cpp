// Steppers of several threads over one model: what ENGINE.md promises of it. Under the preset `thread` the thread sanitizer looks on.
//
// Tried, and killed: scratch of laws of sensors shared by threads (system.cpp, static in place of thread_local).
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <thread>
#include <vector>

#include "libmbd/compile/ports.hpp"
#include "libmbd/compile/time_stepping.hpp"
#include "tests/support/read_text.hpp"

namespace mbd::test::test_threads {
namespace {

// Beams (elastic, damped, bodies fused to them), joints, springs, a law of a sensor, a table, a force of the program.
const std::string arms = R"(
  <function name="f">0 0 0.1 4 0.3 -2</function>
  <section name="s"><stiffness EA="1e5" GA2="4e4" GA3="4e4" GJ="8" EI2="10" EI3="6"/>
    <mass per_length="1.2" inertia="2e-3 1e-3 1e-3"/><damping stiffness_proportional="1e-4"/></section>
  <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="4"/>
  <beam name="c" section="s" from="1 0 0" to="1 1 0" normal="1 0 0" elements="3" order="5"/>
  <revolute name="shoulder" between="ground b.start" axis="0 0 1"/>
  <revolute name="elbow" between="b.end c.start" axis="0 0.1 1"/>
  <body name="m" attached_to="c.end" mass="0.5" inertia="0.01 0.02 0.03"/>
  <spring name="k" between="ground c.end" at_a="0 2 0" stiffness="30" damping="0.2"/>
  <joint_torque joint="shoulder" moment="-3*(shoulder.angle-0.2)-0.3*shoulder.rate"/>
  <load at="c.end" force="f(t) 0 1"/>
  <gravity acceleration="0 -9.81 0"/>
  <record name="shoulder" joint="shoulder" quantities="angle rate"/>
  <record name="tip" at="c.end" quantities="displacement velocity"/>)";

bool wind(const PlacesMotion& at, std::span<Vec6> wrenches) {
  for (std::size_t i = 0; i < wrenches.size(); ++i) wrenches[i].z() = -0.1 * at.velocities[i].z();
  return true;
}

struct Way {
  std::vector<Vec6> V;
  VecX lambda, outputs;
  bool converged = true;
};
Way go(const Model& model, const TransientScene& transient) {
  const auto stepper = make_stepper(*model.system, transient);
  State state = model.initial;
  Way way;
  way.converged = stepper->start(state).converged;
  while (way.converged && state.t < transient.duration - 1e-9)
    way.converged = stepper->step(state).converged;
  way.V = state.V;
  way.lambda = state.lambda;
  way.outputs.resize(static_cast<Index>(ports(model).outputs.size()));
  outputs(model, state, {way.outputs.data(), static_cast<std::size_t>(way.outputs.size())});
  return way;
}

void expect_equal(const Way& a, const Way& b) {
  ASSERT_TRUE(a.converged && b.converged);
  ASSERT_EQ(a.V.size(), b.V.size());
  for (std::size_t n = 0; n < a.V.size(); ++n) EXPECT_EQ(a.V[n], b.V[n]) << n;
  EXPECT_EQ(a.lambda, b.lambda);
  EXPECT_EQ(a.outputs, b.outputs);
}

TEST(Threads, SteppersShareAModel) {
  const Scene scene = read(arms + R"(<transient duration="0.05" step="1e-3"/>)");
  const Model model = compile(scene, {{make_force("wind", {"b@0.5", "c.end"}, wind)}});
  TransientScene radau = *scene.transient;
  radau.method = TimeMethod::radau;
  radau.step = 2e-3;
  const std::array<TransientScene, 2> both{*scene.transient, radau};
  std::array<Way, 2> alone, together;
  for (std::size_t i = 0; i < 2; ++i) alone[i] = go(model, both[i]);
  std::atomic<int> ready = 0;
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < 2; ++i)
    threads.emplace_back([&, i] {
      ++ready;
      while (ready < 2) std::this_thread::yield();
      together[i] = go(model, both[i]);
    });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < 2; ++i) {
    SCOPED_TRACE(i);
    expect_equal(together[i], alone[i]);
  }
  EXPECT_GT(alone[0].outputs.norm(), 0.03);
  EXPECT_NEAR(alone[0].outputs(0), alone[1].outputs(0), 1e-2);
}

// Reading, compiling and running side by side, too.
TEST(Threads, CompileAndStepSideBySide) {
  const std::string text = arms + R"(<transient duration="0.02" step="1 ms"/>)";
  const auto whole = [&] {
    const Scene scene = read(text);
    return go(compile(scene), *scene.transient);
  };
  const Way alone = whole();
  std::array<Way, 2> together;
  std::vector<std::thread> threads;
  for (Way& way : together) threads.emplace_back([&] { way = whole(); });
  for (std::thread& thread : threads) thread.join();
  for (const Way& way : together) expect_equal(way, alone);
}

}  // namespace
}  // namespace mbd::test::test_threads
