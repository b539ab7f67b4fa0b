// The bend of models/bend45.xml let go: its tip load falls to zero in 50 ms, and it swings back through its
// plane. Error of the tip's motion over the number of elements at one time step, against a mesh far finer at the
// same step: what is left is the error of the mesh, of motion and classical beams alike.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <ctime>

#include "libmbd/language/reader.hpp"
#include "libmbd/run/run.hpp"
#include "tools/studies/study.hpp"

namespace mbd::studies {
namespace {

constexpr int dynamic_orders[] = {1, 2, 3, 4};
constexpr int dynamic_meshes[] = {1, 2, 4, 8, 16};
constexpr int finest_order = 6, finest_mesh = 24;

constexpr const char* released_bend = R"(<mbd name="released_bend">
  <section name="square">
    <stiffness EA="1.00e7" GA2="4.17e6" GA3="4.17e6" GJ="7.03e5" EI2="8.33e5" EI3="8.33e5" D16="-8.33e3"/>
    <mass per_length="1e-3" inertia="1.4e-4 .7e-4 .7e-4"/>
  </section>
  <arc name="bend" section="square" from="0 0 0" center="100 0 0" axis="0 0 -1" angle="45*deg"
       normal="0 0 1" elements="8" order="4"/>
  <fixed name="clamp" between="ground bend.start"/>
  <load at="bend.end" force="0 0 0.05>t?300*(1+cos(20*pi*t)):0"/>
  <static steps="4"/>
  <transient duration="0.2" step="1e-3" rho_infinity="0.5"/>
  <record name="tip" at="bend.end" quantities="displacement"/>
</mbd>)";

// The tip at every step.
class Tip : public Observer {
 public:
  void accepted(const Sample& sample) override {
    path.emplace_back(sample.row[1], sample.row[2], sample.row[3]);
  }
  std::vector<Vec3> path;
};

struct Motion {
  bool complete = false;
  double cpu = 0.0;  // [s]
  std::vector<Vec3> tip;
};
Motion motion(const Series& series, int order, int elements) {
  Scene scene = read_model_text(released_bend, "released_bend");
  BeamScene& beam = scene.beams.at(0);
  series.choose(beam);
  beam.order = order;
  beam.elements = elements;
  Tip tip;
  const std::clock_t start = std::clock();
  Motion result;
  try {
    const RunReport report = run(scene, {.output = {}, .observers = {&tip}, .progress = {}});
    result.complete = report.complete();
  } catch (const Error&) {  // no equilibrium to start from, on the coarsest meshes
  }
  result.cpu = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  result.tip = std::move(tip.path);
  return result;
}

// sqrt(sum |x - y|^2 / sum |y|^2) over all steps.
double distance(const std::vector<Vec3>& x, const std::vector<Vec3>& y) {
  double error = 0.0, size = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    error += (x.at(i) - y[i]).squaredNorm();
    size += y[i].squaredNorm();
  }
  return std::sqrt(error / size);
}

}  // namespace

void dynamic(const std::filesystem::path& directory) {
  const Series usual{"", "", [](BeamScene&) {}};  // geodesic metric, energy form
  const Motion reference = motion(usual, finest_order, finest_mesh);
  Csv csv(fmt::format(
      "# bend45 let go: rms of the tip's error over 201 steps of 1 ms / rms of its displacement, "
      "against {} elements of order {} at the same step; CPU time of the whole run\n"
      "form,series,order,elements,complete,error,cpu_seconds",
      finest_mesh, finest_order));
  std::vector<plot::Panel> panels;
  for (const bool over_cpu : {false, true})
    panels.push_back({.title = over_cpu ? "over CPU time" : "over elements",
                      .x_label = over_cpu ? "CPU time [s]" : "number of elements",
                      .y_label = "error of the tip's motion",
                      .x_log = true,
                      .y_log = true});
  int style = 0;
  for (const Series& series : all_series()) {
    for (const int order : dynamic_orders) {
      const std::string label = order == dynamic_orders[0] ? series.form + ", " + series.name : "";
      plot::Curve over_elements{label, {}, style}, over_cpu{label, {}, style};
      for (const int elements : dynamic_meshes) {
        const Motion m = motion(series, order, elements);
        csv << series.form << series.name << long{order} << long{elements} << long{m.complete};
        if (m.complete) {
          const double error = distance(m.tip, reference.tip);
          csv << error << m.cpu;
          over_elements.trace.add({static_cast<double>(elements), error});
          over_cpu.trace.add({m.cpu, error});
        } else {
          csv << ""
              << "";
        }
        csv.end_row();
      }
      panels[0].curves.push_back(std::move(over_elements));
      panels[1].curves.push_back(std::move(over_cpu));
    }
    ++style;
    std::printf("dynamic, %s, %s\n", series.form.c_str(), series.name.c_str());
    std::fflush(stdout);
  }
  write(directory, "dynamic.csv", csv.text());
  write(directory, "dynamic.svg",
        plot::to_svg(panels, {.columns = 2,
                              .note = "N = 1 … 4 from above; generalized-alpha, 1 ms",
                              .title = "bend45 let go: the mesh's error in motion"}));
}

}  // namespace mbd::studies
