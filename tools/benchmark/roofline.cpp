#include "tools/benchmark/roofline.hpp"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "solvers/linear/block_columns.hpp"
#include "solvers/linear/block_lu.hpp"
#include "solvers/linear/dense_product.hpp"
#include "solvers/linear/elimination.hpp"
#include "solvers/linear/lanes.hpp"

namespace mbd {
namespace {

using benchmark::Counter;

// Per second, in units of 1e9.
Counter rate(double each) { return Counter(1e-9 * each, Counter::kIsIterationInvariantRate); }

// Products and sums in registers, as many independent ones as hide what they wait for. Not an array: it would not stay there.
void peak(benchmark::State& bench) {
  constexpr int chains = 10, length = 4096;
  const Lane factor = Lane{} + 0.999999, term = Lane{} + 1e-9;
  Lane a = Lane{} + 1.0, b = a, c = a, d = a, e = a, f = a, g = a, h = a, i = a, j = a;
  const auto step = [&](Lane & x) __attribute__((always_inline)) {
    x = x * factor + term;
    asm volatile("" : "+v"(x));
  };
  for (auto _ : bench)
    for (int k = 0; k < length; ++k) {
      step(a), step(b), step(c), step(d), step(e);
      step(f), step(g), step(h), step(i), step(j);
    }
  bench.counters["Gflop/s"] = rate(2.0 * lane_count * chains * length);
}

void memory(benchmark::State& bench) {
  const std::vector<double> x(1 << 24, 1.0);
  for (auto _ : bench) {
    Lane sum[4] = {};
    for (std::size_t i = 0; i < x.size(); i += 4 * lane_count)
      for (std::size_t k = 0; k < 4; ++k) {
        Lane one;
        std::memcpy(&one, x.data() + i + k * lane_count, sizeof one);
        sum[k] += one;
      }
    benchmark::DoNotOptimize(sum);
  }
  bench.counters["GB/s"] = rate(static_cast<double>(sizeof(double) * x.size()));
}

void product(benchmark::State& bench, Index m, Index n, Index k) {
  const Index ld = m + DenseProduct::row_slack;
  const auto numbers = [](Index count) {
    return std::vector<double>(static_cast<std::size_t>(count), 0.5);
  };
  std::vector<double> C = numbers(ld * n), A = numbers(ld * k), B = numbers(n * k);
  DenseProduct dense;
  for (auto _ : bench) {
    dense.subtract({C.data(), ld}, {A.data(), ld}, {B.data(), n}, m, n, k, true);
    benchmark::DoNotOptimize(C.data());
  }
  bench.counters["Gflop/s"] = rate(2.0 * static_cast<double>(m * n * k));
}

using MakeGraph = std::function<BlockGraph()>;

// Cubic elements, one a beam, between the corners of a grid of so many fields each way: a cantilever, a plane or a space frame.
BlockGraph frame(int x, int y, int z) {
  BlockGraph graph;
  const auto add_node = [&] {
    graph.blocks.push_back({6, BlockGraph::Kind::node});
    return static_cast<int>(graph.blocks.size()) - 1;
  };
  const auto beam = [&](int from, int to) {
    const int nodes[] = {from, add_node(), add_node(), to};
    for (const int p : nodes)
      for (const int q : nodes) graph.contributions.push_back({p, q});
  };
  const auto name = [&](int i, int j, int k) { return (i * (y + 1) + j) * (z + 1) + k; };
  for (int i = 0; i < (x + 1) * (y + 1) * (z + 1); ++i) add_node();
  for (int i = 0; i <= x; ++i)
    for (int j = 0; j <= y; ++j)
      for (int k = 0; k <= z; ++k) {
        if (i < x) beam(name(i, j, k), name(i + 1, j, k));
        if (j < y) beam(name(i, j, k), name(i, j + 1, k));
        if (k < z) beam(name(i, j, k), name(i, j, k + 1));
      }
  return graph;
}

// Bodies on ball joints.
BlockGraph chain(int bodies) {
  BlockGraph graph;
  for (int i = 0; i < bodies; ++i) {
    graph.blocks.push_back({6, BlockGraph::Kind::node});
    graph.contributions.push_back({i, i});
  }
  for (int i = 0; i < bodies; ++i) {
    const int joint = static_cast<int>(graph.blocks.size());
    graph.blocks.push_back({3, BlockGraph::Kind::multiplier});
    for (int end = std::max(0, i - 1); end <= i; ++end) {
      graph.contributions.push_back({joint, end});
      graph.contributions.push_back({end, joint});
    }
  }
  return graph;
}

// Random numbers, nodes with large diagonals: what is measured does not depend on them.
std::vector<double> values_of(const BlockColumns& columns) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<double> values(static_cast<std::size_t>(columns.nonzeros) +
                             BlockColumns::read_beyond);
  for (double& x : values) x = uniform(random);
  for (int c = 0; c < columns.blocks(); ++c) {
    const auto C = static_cast<std::size_t>(c);
    for (std::size_t e = columns.begin[C]; e < columns.begin[C + 1]; ++e)
      if (columns.entries[e].row == c && columns.kinds[C] != 0)
        for (int i = 0; i < columns.size(c); ++i)
          values[static_cast<std::size_t>(columns.entries[e].offset +
                                          i * (columns.height[C] + 1))] +=
              2.0 * static_cast<double>(columns.height[C]);
  }
  return values;
}

void block_lu(benchmark::State& bench, const MakeGraph& make, PivotOrder order, bool factor) {
  const BlockGraph graph = make();
  BlockColumns columns;
  columns.analyze(graph);
  const Elimination elimination = eliminate(graph, order);
  const BlockLuPlan plan(columns, elimination);
  BlockLu<double> lu(plan);
  const std::vector<double> values = values_of(columns);
  if (!lu.factor(values.data(), nullptr)) return bench.SkipWithError("a block has no pivot");
  std::vector<double> x(static_cast<std::size_t>(columns.n), 1.0);
  for (auto _ : bench) {
    if (factor)
      benchmark::DoNotOptimize(lu.factor(values.data(), nullptr));
    else
      lu.solve(x.data());
    benchmark::DoNotOptimize(x.data());
  }
  bench.counters["unknowns"] = static_cast<double>(columns.n);
  if (factor)
    bench.counters["Gflop/s"] = rate(elimination.flops);
  else
    bench.counters["GB/s"] = rate(static_cast<double>(lu.bytes()));
}

}  // namespace

void register_roofline() {
  benchmark::RegisterBenchmark("Roofline/peak", peak);
  benchmark::RegisterBenchmark("Roofline/memory", memory)->Unit(benchmark::kMillisecond);
  for (const auto& [m, n, k] :
       std::vector<std::array<Index, 3>>{{400, 48, 48}, {400, 96, 64}, {2000, 96, 500}})
    benchmark::RegisterBenchmark(fmt::format("Roofline/product/{}x{}x{}", m, n, k).c_str(), product,
                                 m, n, k);
  struct Case {
    const char* name;
    MakeGraph graph;
    PivotOrder order = PivotOrder::merged;
  };
  const std::vector<Case> cases{
      {"chain of 1000 bodies", [] { return chain(1000); }, PivotOrder::nodes_first},
      {"cantilever of 1000 elements", [] { return frame(1000, 0, 0); }},
      {"plane frame of 1012 beams", [] { return frame(22, 22, 0); }},
      {"plane frame of 9940 beams", [] { return frame(70, 70, 0); }},
      {"space frame of 882 beams", [] { return frame(6, 6, 6); }},
      {"space frame of 9450 beams", [] { return frame(14, 14, 14); }}};
  for (const Case& one : cases)
    for (const bool factor : {true, false})
      benchmark::RegisterBenchmark(
          fmt::format("Roofline/{}/{}", one.name, factor ? "factor" : "solve").c_str(), block_lu,
          one.graph, one.order, factor)
          ->Unit(benchmark::kMicrosecond);
}

}  // namespace mbd
