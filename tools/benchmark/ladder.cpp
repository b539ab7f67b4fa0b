// Ladder/<rung>: a chain of bars with one effect more on each rung. `step_us` is the CPU time of a step of
// generalized-alpha, `iterations` those of Newton a step, `evaluate_us` one residual with tangent, and `added_us` what that is
// above the rung before: the cost of the rung's own effect, beside `own_us`, what the batches that came with it take by
// themselves. Numbers of one run: compare within it.
#include "tools/benchmark/ladder.hpp"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/results/build_facts.hpp"
#include "libmbd/scene/transient.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/time/generalized_alpha.hpp"
#include "tools/benchmark/sink.hpp"

namespace mbd {
namespace {

struct Rung {
  const char* name;
  const char* section;  // what it adds inside <section>
  const char* items;    // and to the scene; {i} counts the bars
};

// Each is the scene of the one before and its own line. The first is rigid; the second takes that back.
constexpr Rung rungs[] = {
    {"1_rigid_chain", "", ""},
    {"2_flexible", "", ""},
    {"3_gravity", "", R"(<gravity acceleration="0 0 -9.81"/>)"},
    {"4_damping", R"(<damping stiffness_proportional="1e-4"/>)", ""},
    {"5_drag", "",
     R"(<repeat count="4" index="i"><drag beam="bar{i}" density="1000" diameter="0.02" normal_coefficient="1"
        tangential_coefficient="0.01"/></repeat>)"},
    {"6_tip_load", "", R"(<load at="bar3.end" force="0 sin(3*t) 0"/>)"},
};

Scene scene_of(std::size_t rung) {
  std::string section, items;
  for (std::size_t r = 0; r <= rung; ++r) {
    section += rungs[r].section;
    items += rungs[r].items;
  }
  const std::string text = fmt::format(
      R"(<mbd name="ladder"><section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="20" EI2="25" EI3="25"/>
<mass per_length="0.5" inertia="4e-5 2e-5 2e-5"/>{}</section>
<repeat count="4" index="i"><beam name="bar{{i}}" section="s" from="i 0 0" to="i+1 0 0" normal="0 0 1" elements="2"
order="3"/></repeat>
<spherical name="top" between="ground bar0.start"/>
<repeat count="3" index="i"><spherical name="j{{i}}" between="bar{{i}}.end bar{{i+1}}.start"/></repeat>
{}<transient duration="1" step="1e-3"/>{}<record name="tip" at="bar3.end" quantities="position"/></mbd>)",
      section,
      rung > 0 ? "" : R"(<repeat count="4" index="i"><rigid name="r{i}" of="bar{i}"/></repeat>)",
      items);
  return read_model_text(text, "ladder.xml");
}

// CPU time of one of `repeats` in a row, least of seven passes [s].
double seconds_of(const auto& work, int repeats) {
  double least = 1e30;
  for (int pass = 0; pass < 7; ++pass) {
    const double begin = used_cpu();
    for (int i = 0; i < repeats; ++i) work();
    least = std::min(least, (used_cpu() - begin) / repeats);
  }
  return least;
}

// One residual with tangent of the whole system, and of each batch by type.
struct Cost {
  double all = 0.0;
  std::map<std::string, double, std::less<>> own;
};

Cost cost_of(std::size_t rung) {
  const Model model = compile(scene_of(rung));
  const System& system = *model.system;
  Sink sink;
  sink.analyze(system.graph());
  VecX r = VecX::Zero(system.rows());
  const TangentWeights weights{1.0, 1e3, 1e6, {}};
  Cost cost;
  cost.all = seconds_of([&] { system.linearize(model.initial, weights, r, sink); }, 200);
  for (const auto& batch : system.batches())
    cost.own[std::string(batch->type())] =
        seconds_of([&] { batch->linearize(model.initial, weights, r, sink.slots()); }, 200);
  return cost;
}

void ladder(benchmark::State& bench, std::size_t rung) {
  const Scene scene = scene_of(rung);
  const Model model = compile(scene);
  constexpr int steps = 200;
  long iterations = 0, all = 0;
  double cpu = 0.0;
  for (auto _ : bench) {
    bench.PauseTiming();
    State state = model.initial;
    GeneralizedAlpha stepper(*model.system, make_klu_solver(),
                             {.step = *scene.transient->step,
                              .rho_infinity = rho_infinity_of(*scene.transient),
                              .newton = {}});
    if (!stepper.start(state).converged) bench.SkipWithError("no start");
    bench.ResumeTiming();
    const double begin = used_cpu();
    for (int i = 0; i < steps; ++i) {
      const StepReport report = stepper.step(state);
      if (!report.converged) {
        bench.SkipWithError(report.failure.c_str());
        return;
      }
      iterations += report.iterations;
      ++all;
    }
    cpu += used_cpu() - begin;
  }
  const Cost here = cost_of(rung);
  bench.counters["unknowns"] = static_cast<double>(model.system->unknowns());
  bench.counters["iterations"] = static_cast<double>(iterations) / static_cast<double>(all);
  bench.counters["step_us"] = 1e6 * cpu / static_cast<double>(all);
  bench.counters["evaluate_us"] = 1e6 * here.all;
  if (rung == 0) return;
  const Cost before = cost_of(rung - 1);
  double own = 0.0;
  for (const auto& [type, cost] : here.own)
    if (!before.own.contains(type)) own += cost;
  bench.counters["added_us"] = 1e6 * (here.all - before.all);
  bench.counters["own_us"] = 1e6 * own;
}

}  // namespace

void register_ladder() {
  for (std::size_t rung = 0; rung < std::size(rungs); ++rung)
    benchmark::RegisterBenchmark(fmt::format("Ladder/{}", rungs[rung].name).c_str(),
                                 [rung](benchmark::State& bench) { ladder(bench, rung); })
        ->Unit(benchmark::kMillisecond);
}

}  // namespace mbd
