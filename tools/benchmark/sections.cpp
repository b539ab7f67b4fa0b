// The analysis of a section of square elements of one material: Section/<elements of a side>/<order>.
#include <benchmark/benchmark.h>

#include <numbers>
#include <vector>

#include "libmbd/section/analysis.hpp"
#include "libmbd/section/cells.hpp"

namespace {

using namespace mbd;

section::Mesh squares(int side, int order) {
  std::vector<section::Cell> cells;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      section::Cell& cell = cells.emplace_back();
      cell.map = [i, j, side](double xi, double eta) {
        return section::Point(0.1 * (i + xi) / side, 0.1 * (j + eta) / side);
      };
      cell.normal = [](double, double) { return 0.5 * std::numbers::pi; };
      cell.marked = {false, false, false, false};
    }
  const std::vector<section::MeshMaterial> steel{
      {section::stiffness_of(section::isotropic(210e9, 0.3)), 7800.0, "steel"}};
  return section::mesh_of(cells, {order, 1}, steel, 1e-8);
}

void analyse(benchmark::State& bench) {
  const section::Mesh mesh =
      squares(static_cast<int>(bench.range(0)), static_cast<int>(bench.range(1)));
  for (auto _ : bench) benchmark::DoNotOptimize(section::analyse(mesh).stiffness(0, 0));
  bench.counters["unknowns"] = 3.0 * static_cast<double>(mesh.nodes.size());
}
BENCHMARK(analyse)
    ->Name("Section")
    ->ArgsProduct({{25, 50, 100}, {1, 2}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
