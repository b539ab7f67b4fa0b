// Integration in time: true error and CPU time over the tolerance, and over fixed steps, for the dynamic models.
//
// Error of a run: the largest, over 200 times evenly spread and all nodes, of the difference of positions over the
// length of the scene, and of rotations in radians, against Radau IIA at a tolerance far below. It has the units in
// which tolerances are given, so that error / tolerance is the constant of proportionality. The mesh is the model's
// unless said: errors of the mesh are not in it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <memory>
#include <optional>

#include "libmbd/compile/model.hpp"
#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/core/error.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/scene/transient.hpp"
#include "libmbd/study/accuracy/power_law.hpp"
#include "libmbd/text/files.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/statics/statics.hpp"
#include "tools/studies/study.hpp"

namespace mbd::studies {
namespace {

constexpr int samples = 200;
constexpr double most_seconds = 15.0;  // CPU time of a run; one that takes longer is given up

struct Case {
  const char* model;
  double duration;   // [s]; 0: the model's
  int order;         // of all beams; 0: the model's
  double reference;  // tolerance of the reference
  double finest;     // tolerance of the runs
};

// Undamped axial waves of stiff beams have to be resolved for tight tolerances; where that takes too long,
// the tolerances end early.
constexpr Case cases[] = {
    {"pendulum", 0, 0, 1e-12, 1e-9},
    {"heavy_top", 0, 0, 1e-12, 1e-9},
    {"dzhanibekov", 0, 0, 1e-12, 1e-9},
    {"double_pendulum", 0, 0, 1e-12, 1e-9},
    {"chain", 0, 0, 1e-11, 1e-9},
    {"windows", 0, 0, 1e-11, 1e-9},
    {"free_beam", 0, 0, 1e-11, 1e-9},
    {"shaft", 0, 4, 1e-11, 1e-9},
    {"slider_crank", 0.05, 0, 1e-10, 1e-8},
    {"every_joint", 0, 0, 1e-8, 1e-6},
    {"double_pendulum_beams", 0, 0, 1e-8, 1e-6},
    {"four_bar", 6, 5, 1e-8, 1e-6},
    {"cart_pole", 0, 0, 1e-9, 1e-7},
};

struct Setting {
  TimeMethod method;
  double tolerance;  // 0: fixed steps
  double step;
};

struct Result {
  bool complete = false;
  std::string failure;
  double cpu = 0.0;  // [s] of stepping
  Counters counters;
  std::vector<std::vector<Pose<double>>> motion;  // by sample
};

std::unique_ptr<Stepper> stepper(const System& system, const Scene& scene, double end,
                                 const Setting& setting) {
  TransientScene transient = *scene.transient;
  transient.duration = end;
  SteppingChange change{.method = setting.method};
  (setting.tolerance > 0.0 ? change.tolerance : change.step) =
      setting.tolerance > 0.0 ? setting.tolerance : setting.step;
  change_stepping(transient, change);
  transient.newton_tolerance = std::nullopt;
  return make_stepper(system, transient);
}

Result run(const Model& model, const Scene& scene, double end, const Setting& setting,
           double seconds) {
  const System& system = *model.system;
  Result result;
  State state = model.initial;
  if (scene.statics) {
    StaticOptions options;
    options.steps = scene.statics->steps;
    const auto solver = make_klu_solver();
    if (!solve_statics(system, *solver, options, state).converged) throw Error("no equilibrium");
  }
  const auto integrator = stepper(system, scene, end, setting);
  State dense = state;
  int next = 1;
  const auto time = [&](int k) { return end * k / samples; };
  integrator->on_substep([&](const DenseStep& step) {
    for (; next <= samples && time(next) <= step.end() * (1.0 + 1e-12); ++next) {
      step.at(std::min(time(next), step.end()), dense);
      result.motion.push_back(dense.pose);
    }
  });
  const std::clock_t start = std::clock();
  StepReport report = integrator->start(state);
  while (report.converged && state.t < end * (1.0 - 1e-12)) {
    report = integrator->step(state);
    result.cpu = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    if (result.cpu > seconds) {
      result.failure = fmt::format("takes more than {} s of CPU time", seconds);
      return result;
    }
  }
  result.counters = integrator->counters();
  result.failure = report.failure;
  result.complete = report.converged && result.motion.size() == samples;
  return result;
}

double distance(const Result& a, const Result& b, double length) {
  double worst = 0.0;
  for (std::size_t k = 0; k < a.motion.size(); ++k)
    for (std::size_t n = 1; n < a.motion[k].size(); ++n) {
      const Pose<double>&A = a.motion[k][n], &B = b.motion[k][n];
      worst = std::max(worst, (A.r - B.r).norm() / length);
      worst = std::max(worst, log_so3<double>(A.p.conjugate() * B.p).norm());
    }
  return worst;
}

// One case: its reference, and the points of its curves.
class Runs {
 public:
  Runs(const Case& of, Csv& csv) : case_(of), csv_(csv) {
    for (BeamScene& beam : scene_.beams)
      if (of.order > 0) beam.order = of.order;
    model_ = compile(scene_);
    end_ = of.duration > 0.0 ? of.duration : scene_.transient->duration;
    reference_ =
        run(model_, scene_, end_, {TimeMethod::radau, of.reference, 0.0}, 20.0 * most_seconds);
    std::printf("%s: reference %.2f s %s\n", of.model, reference_.cpu, reference_.failure.c_str());
  }

  bool has_reference() const { return reference_.complete; }

  // Adds a row to the table of its results.
  void add_curves(TimeMethod method, plot::Panel& panel, std::string& table, int& style) {
    const std::string name(name_of(method));
    const double finest =
        method == TimeMethod::generalized_alpha ? std::max(1e-5, case_.finest) : case_.finest;
    plot::Curve curve{name, {}, style++};
    std::vector<plot::Point> proportion;
    double last = 0.0;
    for (double tolerance = 1e-3; tolerance > 0.5 * finest; tolerance *= 0.1) {
      const auto p = point({method, tolerance, 0.0});
      if (!p) continue;
      curve.trace.add(*p);
      proportion.push_back({tolerance, (*p)[1]});
      last = tolerance;
    }
    if (proportion.size() >= 2) {
      const PowerLaw f = fit_power_law(proportion);
      table += fmt::format("| {} | {} | 1e-3 … {:.0e} | {:.2f} | {:.2g} |\n", case_.model, name,
                           last, f.slope, f.mean_ratio);
    } else {
      table += fmt::format("| {} | {} | none reached | | |\n", case_.model, name);
    }
    panel.curves.push_back(std::move(curve));
    if (method == TimeMethod::ida || !scene_.transient->step) return;
    plot::Curve fixed{name + ", fixed steps", {}, style++};
    for (const double part : {1.0, 0.5, 0.25, 0.125})
      if (const auto p = point({method, 0.0, part * *scene_.transient->step})) fixed.trace.add(*p);
    panel.curves.push_back(std::move(fixed));
  }

 private:
  std::optional<plot::Point> point(const Setting& setting) {
    const Result r = run(model_, scene_, end_, setting, most_seconds);
    csv_ << case_.model << long{case_.order} << end_ << case_.reference
         << std::string(name_of(setting.method)) << setting.tolerance << setting.step;
    const double error = r.complete ? distance(r, reference_, model_.system->length_scale()) : 0.0;
    csv_ << (r.complete ? std::optional(error) : std::nullopt) << r.cpu << r.counters.steps
         << r.counters.rejected << r.counters.iterations << r.counters.factorizations
         << '"' + r.failure + '"';
    csv_.end_row();
    std::printf("  %s tolerance %g step %g: error %.2e, %.3f s, %ld steps %s\n",
                std::string(name_of(setting.method)).c_str(), setting.tolerance, setting.step,
                error, r.cpu, r.counters.steps, r.failure.c_str());
    std::fflush(stdout);
    if (!r.complete || !(error > 0.0)) return std::nullopt;
    return plot::Point{r.cpu, error};
  }
  const Case& case_;
  Csv& csv_;
  Scene scene_ = read_model(std::filesystem::path(MBD_SOURCE_DIR) / "models" /
                            (std::string(case_.model) + ".xml"));
  Model model_;
  double end_;
  Result reference_;
};

}  // namespace

void time(const std::filesystem::path& directory) {
  Csv csv(
      "# error: largest over 200 times and all nodes of differences of positions / length of the "
      "scene and of "
      "rotations [rad], against radau at the tolerance given; CPU seconds of stepping\n"
      "model,order,duration,reference_tolerance,method,tolerance,step,error,cpu_seconds,steps,"
      "rejected,"
      "iterations,factorizations,failure");
  std::string table =
      "| model | method | tolerances | slope | error / tolerance (geometric mean) "
      "|\n|---|---|---|---|---|\n";
  std::vector<plot::Panel> panels;
  for (const Case& c : cases) {
    Runs runs(c, csv);
    if (!runs.has_reference()) continue;
    panels.push_back({.title = c.model,
                      .x_label = "CPU time [s]",
                      .y_label = "error",
                      .x_log = true,
                      .y_log = true});
    int style = 0;
    for (const TimeMethod method :
         {TimeMethod::radau, TimeMethod::generalized_alpha, TimeMethod::ida})
      runs.add_curves(method, panels.back(), table, style);
  }
  write(directory, "time.csv", csv.text());
  write(directory, "time_tolerance.md", table);
  std::fputs(table.c_str(), stdout);
  write(directory, "time.svg", plot::to_svg(panels));
}

}  // namespace mbd::studies
