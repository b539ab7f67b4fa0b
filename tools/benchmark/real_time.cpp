// Steps one by one, as real time has to take them: mean, 999 of 1000 and the worst, in microseconds, with and without a bound on their
// cost. The worst of a shared machine is its scheduler's; CPU time of the thread is measured, not time on the clock.
#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <string>
#include <vector>

#include "libmbd/mbd.hpp"

namespace mbd {
namespace {

// Seven rigid links on hinges across one another, a servo in each.
constexpr const char* arm_of_seven = R"(<mbd name="arm">
  <body name="l1" at="0 0 0.1" mass="4" inertia="0.02 0.02 0.01"/>
  <body name="l2" at="0 0 0.3" mass="4" inertia="0.02 0.02 0.01"/>
  <body name="l3" at="0 0 0.5" mass="3" inertia="0.02 0.02 0.01"/>
  <body name="l4" at="0 0 0.7" mass="3" inertia="0.02 0.02 0.01"/>
  <body name="l5" at="0 0 0.9" mass="2" inertia="0.01 0.01 0.01"/>
  <body name="l6" at="0 0 1.1" mass="1" inertia="0.01 0.01 0.01"/>
  <body name="l7" at="0 0 1.2" mass="0.5" inertia="0.01 0.01 0.01"/>
  <revolute name="j1" between="ground l1" at="0 0 0" axis="0 0 1"/>
  <revolute name="j2" between="l1 l2" at="0 0 0.2" axis="0 1 0"/>
  <revolute name="j3" between="l2 l3" at="0 0 0.4" axis="0 0 1"/>
  <revolute name="j4" between="l3 l4" at="0 0 0.6" axis="0 1 0"/>
  <revolute name="j5" between="l4 l5" at="0 0 0.8" axis="0 0 1"/>
  <revolute name="j6" between="l5 l6" at="0 0 1" axis="0 1 0"/>
  <revolute name="j7" between="l6 l7" at="0 0 1.15" axis="0 0 1"/>
  <joint_torque joint="j1" moment="-40*(j1.angle-sin(3*t))-4*j1.rate"/>
  <joint_torque joint="j2" moment="-200*(j2.angle-0.5*sin(2*t))-20*j2.rate"/>
  <joint_torque joint="j3" moment="-40*(j3.angle-sin(4*t))-4*j3.rate"/>
  <joint_torque joint="j4" moment="-100*(j4.angle-sin(3*t))-10*j4.rate"/>
  <joint_torque joint="j5" moment="-20*(j5.angle-sin(5*t))-2*j5.rate"/>
  <joint_torque joint="j6" moment="-20*(j6.angle-sin(4*t))-2*j6.rate"/>
  <joint_torque joint="j7" moment="-5*(j7.angle-sin(6*t))-0.5*j7.rate"/>
  <gravity acceleration="0 0 -9.81"/>
  <transient duration="4" step="1 ms" rho_infinity="0.8"/>
</mbd>)";

double cpu_now() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
}

void real_time(benchmark::State& bench, const Scene& scene, int max_cost) {
  constexpr long most_steps = 4000;
  const Model model = compile(scene);
  std::vector<double> costs;
  long undone = 0;
  for (auto _ : bench) {
    GeneralizedAlpha stepper(*model.system, make_block_solver(PivotOrder::nodes_first),
                             {.step = *scene.transient->step,
                              .rho_infinity = rho_infinity_of(*scene.transient),
                              .newton = {},
                              .max_cost = max_cost});
    State state = model.initial;
    if (!stepper.start(state).converged) bench.SkipWithError("no start");
    for (long i = 0; i < most_steps; ++i) {
      const double before = cpu_now();
      const StepReport report = stepper.step(state);
      costs.push_back(cpu_now() - before);
      if (report.undone) ++undone;
      if (report.converged) continue;
      bench.SkipWithError(report.failure.c_str());
      break;
    }
  }
  std::sort(costs.begin(), costs.end());
  double sum = 0.0;
  for (const double c : costs) sum += c;
  const auto n = static_cast<double>(costs.size());
  bench.counters["mean_us"] = sum / n;
  bench.counters["p99.9_us"] = costs[static_cast<std::size_t>(0.999 * (n - 1.0))];
  bench.counters["worst_us"] = costs.back();
  bench.counters["undone"] = static_cast<double>(undone) / n;
}

void RealTime(benchmark::State& bench, bool four_bar) {
  const Scene scene = four_bar ? read_model(std::string(MBD_SOURCE_DIR) + "/models/four_bar.xml")
                               : read_model_text(arm_of_seven, "arm");
  real_time(bench, scene, static_cast<int>(bench.range(0)));
}
BENCHMARK_CAPTURE(RealTime, four_bar, true)
    ->ArgName("max_cost")
    ->Arg(0)
    ->Arg(3)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(RealTime, arm, false)
    ->ArgName("max_cost")
    ->Arg(0)
    ->Arg(3)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mbd
