#include "tools/studies/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>

#include "libmbd/compile/model.hpp"
#include "libmbd/text/files.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/statics/statics.hpp"

namespace mbd::studies {
namespace {

Series spectral(const std::string& form_name, Form form, const std::string& name, Metric metric) {
  return {form_name, name, [form, metric](BeamScene& beam) {
            beam.form = form;
            beam.metric = metric;
          }};
}

}  // namespace

const std::vector<Series>& all_series() {
  static const std::vector<Series> series = {
      spectral("paper", Form::paper, "matrix", Metric::matrix),
      spectral("paper", Form::paper, "quaternion", Metric::quaternion),
      spectral("paper", Form::paper, "geodesic", Metric::geodesic),
      spectral("energy", Form::energy, "matrix", Metric::matrix),
      spectral("energy", Form::energy, "quaternion", Metric::quaternion),
      spectral("energy", Form::energy, "geodesic", Metric::geodesic),
      {"energy", "classical", [](BeamScene& beam) { beam.kinematics = Kinematics::classical; }},
  };
  return series;
}

std::string name_of(Rule rule) { return rule == Rule::gauss ? "gauss" : "gauss_lobatto"; }

Solution solve(const Scene& scene, int repeats) {
  const Model model = compile(scene);
  StaticOptions options;
  options.steps = scene.statics->steps;
  options.newton.tolerance = scene.statics->tolerance;
  Solution solution;
  solution.reference = model.initial;
  double total = 0.0;
  for (int i = 0; i < repeats || (repeats > 1 && total < 0.02); ++i) {
    State state = model.initial;
    const auto solver = make_klu_solver();
    const std::clock_t start = std::clock();
    const StaticReport report = solve_statics(*model.system, *solver, options, state);
    const double cpu = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    total += cpu;
    solution.cpu = i == 0 ? cpu : std::min(solution.cpu, cpu);
    solution.converged = report.converged;
    solution.iterations = report.counters.iterations;
    solution.load_steps = report.counters.steps;
    solution.state = std::move(state);
    if (!report.converged) break;
  }
  return solution;
}

Csv& Csv::operator<<(const std::string& cell) {
  if (!first_) text_ += ',';
  text_ += cell;
  first_ = false;
  return *this;
}

Csv& Csv::operator<<(double value) { return *this << fmt::format("{:.17g}", value); }

void Csv::end_row() {
  text_ += '\n';
  first_ = true;
}

void add_points(plot::Panel& panel, const std::string& label, int style,
                const std::vector<plot::Point>& points) {
  for (const plot::Point& point : points) {  // curves of one point have no line
    panel.curves.push_back({&point == points.data() ? label : "", {}, style});
    panel.curves.back().trace.add(point);
  }
}

void write(const std::filesystem::path& directory, const std::string& name,
           const std::string& text) {
  make_directory(directory);
  write_file(directory / name, text);
}

}  // namespace mbd::studies
