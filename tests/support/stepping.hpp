// Drives any Stepper through a scene; tables of what it records at even times, by dense output.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "libmbd/compile/model.hpp"
#include "libmbd/results/observers.hpp"
#include "solvers/constraints/initial.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/newton/increments.hpp"
#include "solvers/statics/statics.hpp"
#include "solvers/time/generalized_alpha.hpp"
#include "solvers/time/radau.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test {

using MakeStepper = std::function<std::unique_ptr<Stepper>(const System&)>;

inline MakeStepper radau(const RadauOptions& options) {
  return [options](const System& system) -> std::unique_ptr<Stepper> {
    return std::make_unique<Radau>(system, make_klu_solver(), make_klu_pencil_solver(), options);
  };
}
inline MakeStepper generalized_alpha(const GeneralizedAlphaOptions& options) {
  return [options](const System& system) -> std::unique_ptr<Stepper> {
    return std::make_unique<GeneralizedAlpha>(system, make_klu_solver(), options);
  };
}

// The state a run starts from: in equilibrium, if the scene asks for it.
inline State start_of(const Scene& scene, const Model& model) {
  State state = model.initial;
  if (scene.statics) {
    const auto solver = make_klu_solver();
    const StaticReport report = solve_statics(*model.system, *solver, {}, state);
    EXPECT_TRUE(report.converged) << report.failure;
  }
  return state;
}

struct Driven {
  Model model;
  State state;
  Counters counters;
  StepSizes sizes;
  StepReport last;
  Table table;
  double g = 0.0, gdot = 0.0,
         fastest = 0.0;  // largest of accepted states; rates in scene lengths or radians
};

// From the start to `duration`, or a failure, which the test has to look for. Samples at 0, interval, …;
// interval 0: none. `seen` after each step.
inline Driven drive(Scene scene, const MakeStepper& make, double duration, double interval = 0.0,
                    const std::function<void(const Driven&)>& seen = {}) {
  scene.transient->duration = duration;
  scene.transient->step = duration / 10.0;  // not used
  Driven d;
  d.model = compile(scene);
  const System& system = *d.model.system;
  d.state = start_of(scene, d.model);
  const auto stepper = make(system);
  State dense = d.state;
  long samples = 0;
  std::vector<double> row(columns(d.model).size());
  for (const Column& column : columns(d.model)) d.table.names.push_back(column.name);
  d.table.columns.resize(row.size());
  if (interval > 0.0)
    stepper->on_substep([&](const DenseStep& step) {
      const double slack = 1e-9 * interval;
      while (static_cast<double>(samples) * interval <= std::min(step.end(), duration) + slack) {
        step.at(std::min(static_cast<double>(samples) * interval, step.end()), dense);
        sample_row(d.model, dense, row);
        for (std::size_t i = 0; i < row.size(); ++i) d.table.columns[i].push_back(row[i]);
        ++samples;
      }
    });
  d.last = stepper->start(d.state);
  while (d.last.converged && d.state.t < duration * (1.0 - 1e-9)) {
    d.last = stepper->step(d.state);
    const ConstraintResiduals c = constraint_residuals(system, d.state);
    d.g = std::max(d.g, c.position);
    VecX gdot, rest;
    system.constraint_rates(d.state, gdot, rest);
    d.gdot = std::max(d.gdot, largest_violation(system, gdot));
    d.fastest = std::max(d.fastest, fastest(system, d.state));
    d.counters = stepper->counters();
    d.sizes = stepper->sizes();
    if (seen) seen(d);
  }
  d.counters = stepper->counters();
  d.sizes = stepper->sizes();
  return d;
}

using Columns = std::vector<const std::vector<double>*>;

inline Columns components(const Table& t, const std::string& name, int count = 3) {
  Columns columns;
  for (int i = 1; i <= count; ++i) columns.push_back(&t[name + "." + std::to_string(i)]);
  return columns;
}
inline Columns columns_of(const std::vector<std::vector<double>>& x) {
  Columns columns;
  for (const std::vector<double>& one : x) columns.push_back(&one);
  return columns;
}

inline RecordScene joint_record(const std::string& joint) {
  RecordScene record;
  record.name = "joint_" + joint;
  record.joint = joint;
  record.quantities = {"reaction_force", "reaction_moment"};
  return record;
}
inline RecordScene body_record(const std::string& place, std::vector<std::string> quantities) {
  RecordScene record;
  record.name = "body_" + place;
  record.at = Place{};
  record.at->kind = Place::Kind::body;
  record.at->name = place;
  record.quantities = std::move(quantities);
  return record;
}

}  // namespace mbd::test
