#include "libmbd/study/modes/states_of_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/scene/label.hpp"
#include "solvers/constraints/initial.hpp"
#include "solvers/linear/block_solver.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/time/stepper.hpp"

namespace mbd {

Scene scene_of_run(const Scene& given, double duration) {
  Scene scene = given;
  scene.path.reset();
  scene.expects.clear();
  scene.plots.clear();
  scene.motion_output.emplace();  // small motions are shown with their resultants
  if (!scene.transient) {
    scene.transient.emplace();
    scene.transient->source = given.source;
    scene.transient->method = TimeMethod::radau;
    scene.transient->tolerance = 1e-8;
  }
  TransientScene& transient = *scene.transient;
  transient.duration =
      transient.step ? *transient.step * std::ceil(duration / *transient.step - 1e-9) : duration;
  transient.output.reset();
  return scene;
}

StaticReport find_equilibrium(const Scene& scene, const Model& model, State& state) {
  const std::unique_ptr<LinearSolver> solver =
      make_linear_solver(scene.statics->linear_solver, PivotOrder::merged);
  return solve_statics(*model.system, *solver, static_options(scene, *scene.statics), state);
}

State start_of_run(const Scene& scene, const Model& model) {
  State start = model.initial;
  if (!scene.statics) return start;
  const StaticReport found = find_equilibrium(scene, model, start);
  if (!found.converged) throw Error(scene.source, "static equilibrium: " + found.failure);
  return start;
}

std::string make_consistent(const System& system, State& state) {
  double mass = 0.0;
  Counters counters;
  const std::unique_ptr<LinearSolver> solver = make_klu_solver();
  solver->analyze(system.graph());
  return initial_accelerations(system, *solver, state, mass, counters);
}

std::vector<State> states_of_run(const Scene& scene, const Model& model, State state,
                                 const std::vector<double>& times, const char* study,
                                 const std::atomic<bool>* interrupted) {
  const System& system = *model.system;
  check_initial_state(system, state, 1.0 / scene.transient->duration);
  const std::unique_ptr<Stepper> stepper = make_stepper(system, *scene.transient);
  std::vector<State> result;
  State inside = state;
  const auto fail = [&](const std::string& why) {
    throw Error(scene.source, fmt::format("{}: the run ends at {:.9g} s: {}", study, state.t, why));
  };
  stepper->on_substep([&](const DenseStep& step) {
    while (result.size() < times.size() && times[result.size()] < step.end()) {
      step.at(std::max(times[result.size()], step.begin()), inside);
      result.push_back(inside);
    }
  });
  StepReport report = stepper->start(state);
  if (!report.converged) fail(report.failure);
  while (result.size() < times.size()) {
    if (interrupted != nullptr && *interrupted) fail("interrupted");
    if (state.t >= scene.transient->duration || times[result.size()] <= state.t) {
      result.push_back(state);
      continue;
    }
    report = stepper->step(state);
    if (!report.converged) fail(report.failure);
  }
  return result;
}

}  // namespace mbd
