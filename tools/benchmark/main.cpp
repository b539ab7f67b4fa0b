// Cost of the parts: `mbd_benchmark` (Google Benchmark; --benchmark_filter=… to choose).
//   Elastic/<metric>/<form>/<N>/<want>   a batch of 8 elements; `per_element` is the time of one
//   Classical/<N>/<want>                 the same of the classical beam
//   Damping/<metric>/<N>/<want>          the same of the viscous term
//   Linear/<model>/<solver>/factor|solve one factorisation (refactor) or solution of the tangent, block LU or KLU
//   Run/<model>                          stepping of a whole model, CPU seconds
//   Ladder/<rung>                        a chain with one effect more on each rung (ladder.cpp)
//   Roofline/…                           block LU against what the processor can do (roofline.cpp)
//   Section/<elements of a side>/<order> analysis of a section of square elements (sections.cpp)
// Times on a shared machine are noisy: compare ratios within one run.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <random>

#include "elements/beam/beam_damping_batch.hpp"
#include "elements/beam/beam_elastic_batch.hpp"
#include "libmbd/compile/model.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/scene/transient.hpp"
#include "solvers/linear/block_solver.hpp"
#include "solvers/statics/statics.hpp"
#include "solvers/time/generalized_alpha.hpp"
#include "tools/benchmark/ladder.hpp"
#include "tools/benchmark/roofline.hpp"
#include "tools/benchmark/sink.hpp"

namespace {

using namespace mbd;

using MakeBatch = std::function<std::unique_ptr<BeamElasticBatch>()>;
using MakeDamping = std::function<std::unique_ptr<BeamDampingBatch>()>;

int add_section(BeamElasticBatch& batch, const Mat6& D) { return batch.add_stiffness(D); }
int add_section(BeamDampingBatch& batch, const Mat6& C) { return batch.add_viscosity(C); }

template <class Make>
void beams(benchmark::State& bench, const Make& make, int order, bool tangent) {
  constexpr int elements = 8;
  auto batch = make();
  System system;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Mat6 D = Mat6::Zero();
  D.diagonal() << 1e7, 2.5e6, 2.5e6, 246.0, 309.0, 309.0;
  D(0, 3) = D(3, 0) = -8676.0;
  D(1, 4) = D(4, 1) = D(2, 5) = D(5, 2) = 5013.0;
  const int stiffness = add_section(*batch, D);
  const SpectralTable table = spectral_table(order, Rule::gauss);
  int last = 0;
  for (int e = 0; e < elements; ++e) {
    std::vector<int> nodes;
    std::vector<Pose<double>> poses;
    for (int k = 0; k <= order; ++k) {
      Pose<double> H;
      H.r(0) = 0.06 * (e + 0.5 * (1.0 + table.nodes.points[static_cast<std::size_t>(k)]));
      poses.push_back(H);
      if (e == 0 || k > 0) last = static_cast<int>(system.add_node("node", H));
    }
    for (int k = 0; k <= order; ++k) nodes.push_back(last - (order - k));
    batch->add_element(std::vector<double>(static_cast<std::size_t>(order) + 1, 0.03), poses, nodes,
                       stiffness, 0, "element");
  }
  system.add_batch(std::move(batch));
  const bool rates = std::is_same_v<Make, MakeDamping>;
  system.finish(rates, 1.0);
  State state = system.reference_state();
  for (std::size_t n = 1; n < state.pose.size(); ++n) {
    Vec6 u;
    for (Index i = 0; i < 6; ++i) u(i) = 1e-3 * uniform(random);
    state.pose[n] = state.pose[n] * exp_se3(u);
    if (rates) state.V[n] = 1e3 * u;
  }
  Sink sink;
  sink.analyze(system.graph());
  VecX r;
  for (auto _ : bench) {
    if (tangent)
      system.linearize(state, {.U = 1.0, .V = rates ? 1.0 : 0.0}, r, sink);
    else
      system.residual(state, r);
    benchmark::DoNotOptimize(r.data());
    benchmark::ClobberMemory();
  }
  bench.counters["per_element"] = benchmark::Counter(
      elements, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

Scene load(const std::string& name) {
  return read_model(std::string(MBD_SOURCE_DIR) + "/models/" + name + ".xml");
}

void linear(benchmark::State& bench, const std::string& name, LinearMethod method, bool factor) {
  const Model model = compile(load(name));
  auto solver = make_linear_solver(method, PivotOrder::nodes_first);
  solver->analyze(model.system->graph());
  VecX r;
  const double h = 1e-3;
  model.system->linearize(model.initial, {.U = 0.25 * h * h, .V = 0.5 * h, .A = 1.0, .T_inv = {}},
                          r, *solver);
  solver->factor();
  VecX x = VecX::Random(model.system->unknowns());
  for (auto _ : bench) {
    if (factor) {
      benchmark::DoNotOptimize(solver->factor());
    } else {
      VecX y = x;
      solver->solve({y.data(), static_cast<std::size_t>(y.size())});
      benchmark::DoNotOptimize(y.data());
    }
  }
  bench.counters["unknowns"] = static_cast<double>(model.system->unknowns());
  bench.counters["nonzeros"] = static_cast<double>(solver->nonzeros());
}

void run(benchmark::State& bench, const std::string& name) {
  const Scene scene = load(name);
  for (auto _ : bench) {
    const Model model = compile(scene);
    State state = model.initial;
    if (scene.statics) {
      auto solver = make_block_solver(PivotOrder::merged);
      if (!solve_statics(*model.system, *solver, {.steps = scene.statics->steps, .newton = {}},
                         state)
               .converged)
        bench.SkipWithError("statics failed");
    }
    GeneralizedAlpha stepper(*model.system, make_block_solver(PivotOrder::nodes_first),
                             {.step = scene.transient->step.value(),
                              .rho_infinity = rho_infinity_of(*scene.transient),
                              .newton = {}});
    if (!stepper.start(state).converged) bench.SkipWithError("no start");
    const long steps = std::lround(scene.transient->duration / scene.transient->step.value());
    for (long i = 0; i < steps; ++i) {
      if (!stepper.step(state).converged) {
        bench.SkipWithError("a step failed");
        break;
      }
    }
    const Counters& c = stepper.counters();
    bench.counters["steps"] = static_cast<double>(c.steps);
    bench.counters["iterations_per_step"] =
        static_cast<double>(c.iterations) / static_cast<double>(c.steps);
    bench.counters["factorizations"] = static_cast<double>(c.factorizations);
  }
}

void register_all() {
  const std::pair<Metric, const char*> metrics[] = {{Metric::matrix, "matrix"},
                                                    {Metric::quaternion, "quaternion"},
                                                    {Metric::geodesic, "geodesic"}};
  const std::pair<Form, const char*> forms[] = {{Form::energy, "energy"}, {Form::paper, "paper"}};
  for (const auto& [metric, metric_name] : metrics) {
    for (const auto& [form, form_name] : forms) {
      for (int order = 2; order <= 6; ++order) {
        for (const bool tangent : {false, true}) {
          benchmark::RegisterBenchmark(fmt::format("Elastic/{}/{}/{}/{}", metric_name, form_name,
                                                   order, tangent ? "residual+tangent" : "residual")
                                           .c_str(),
                                       beams<MakeBatch>, MakeBatch([metric, form, order] {
                                         return make_beam_elastic(metric, form, Rule::gauss, order);
                                       }),
                                       order, tangent);
        }
      }
    }
  }
  for (int order = 2; order <= 6; ++order) {
    for (const bool tangent : {false, true}) {
      benchmark::RegisterBenchmark(
          fmt::format("Classical/{}/{}", order, tangent ? "residual+tangent" : "residual").c_str(),
          beams<MakeBatch>, MakeBatch([order] { return make_beam_classical(Rule::gauss, order); }),
          order, tangent);
    }
  }
  for (const auto& [metric, metric_name] : metrics) {
    for (int order = 2; order <= 6; ++order) {
      for (const bool tangent : {false, true}) {
        benchmark::RegisterBenchmark(fmt::format("Damping/{}/{}/{}", metric_name, order,
                                                 tangent ? "residual+tangent" : "residual")
                                         .c_str(),
                                     beams<MakeDamping>, MakeDamping([metric, order] {
                                       return make_beam_damping(metric, Rule::gauss, order);
                                     }),
                                     order, tangent);
      }
    }
  }
  for (const char* model : {"four_bar", "shaft", "chain"}) {
    for (const LinearMethod method : {LinearMethod::block, LinearMethod::klu})
      for (const bool factor : {true, false}) {
        benchmark::RegisterBenchmark(
            fmt::format("Linear/{}/{}/{}", model, method == LinearMethod::klu ? "KLU" : "block",
                        factor ? "factor" : "solve")
                .c_str(),
            linear, std::string(model), method, factor)
            ->Unit(benchmark::kMicrosecond);
      }
  }
  for (const char* model : {"four_bar", "shaft"}) {
    benchmark::RegisterBenchmark(fmt::format("Run/{}", model).c_str(), run, std::string(model))
        ->Unit(benchmark::kMillisecond);
  }
}

}  // namespace

int main(int argc, char** argv) {
  register_all();
  mbd::register_ladder();
  mbd::register_roofline();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
