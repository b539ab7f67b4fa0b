#include "libmbd/compile/time_stepping.hpp"

#include <algorithm>

#include "libmbd/compile/model.hpp"
#include "solvers/constraints/parts.hpp"
#include "solvers/linear/block_solver.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/time/free_momenta.hpp"
#include "solvers/time/generalized_alpha.hpp"
#include "solvers/time/ida.hpp"
#include "solvers/time/radau.hpp"

namespace mbd {
namespace {

// BDF of order 3 and more amplify undamped oscillations, of which beams have many.
bool has_beams(const System& system) {
  return std::any_of(system.batches().begin(), system.batches().end(),
                     [](const auto& batch) { return batch->is_structure(); });
}

}  // namespace

NewtonOptions newton_options(const TransientScene& transient) {
  NewtonOptions newton =
      transient.method == TimeMethod::radau ? RadauOptions().newton : NewtonOptions();
  if (transient.newton_tolerance) newton.tolerance = *transient.newton_tolerance;
  return newton;
}

ErrorTolerances error_tolerances(const TransientScene& transient) {
  return {.relative = transient.tolerance.value_or(0.0),
          .position = transient.position_tolerance.value_or(0.0),
          .rotation = transient.rotation_tolerance.value_or(0.0),
          .velocity = transient.velocity_tolerance.value_or(0.0),
          .angular_velocity = transient.angular_velocity_tolerance.value_or(0.0),
          .of = transient.errors.value_or(ErrorsOf::velocities)};
}

bool follows_from_motion(const schema::Quantity& quantity) {
  using schema::Quantity;
  return quantity.from == Quantity::From::pose && quantity.of != Quantity::Of::whole_system;
}

ErrorsOf errors_of(const Scene& scene) {
  const TransientScene& transient = *scene.transient;
  if (transient.errors) return *transient.errors;
  if (transient.method != TimeMethod::radau || !transient.tolerance ||
      transient.velocity_tolerance || transient.angular_velocity_tolerance || scene.records.empty())
    return ErrorsOf::velocities;
  for (const RecordScene& record : scene.records)
    for (const std::string& name : record.quantities) {
      const schema::Quantity* const quantity =
          schema::find_quantity(schema::quantities_of(record), name);
      if (!quantity || !follows_from_motion(*quantity)) return ErrorsOf::velocities;
    }
  return ErrorsOf::motion;
}

TransientScene transient_of(const Scene& scene) {
  TransientScene transient = *scene.transient;
  if (transient.method == TimeMethod::radau && transient.tolerance)
    transient.errors = errors_of(scene);
  return transient;
}

namespace {

// What the balance is where a scene does not say it.
struct DefaultBalance {
  Balance balance = Balance::acceleration;
  bool keep_momenta = false;
};
DefaultBalance default_balance(const System& system, const TransientScene& transient) {
  const ConnectedParts parts = find_parts(system);
  if (transient.inertia != InertiaTerms::full || !parts.any_free()) return {};
  const auto free = std::count(parts.is_held.begin(), parts.is_held.end(), 0);
  if (FreeMomenta(system).count() == free) return {.keep_momenta = true};
  return {.balance = parts.all_free() ? Balance::momentum : Balance::acceleration};
}

}  // namespace

Balance balance_of(const System& system, const TransientScene& transient) {
  return transient.balance ? *transient.balance : default_balance(system, transient).balance;
}

bool keeps_momenta(const System& system, const TransientScene& transient) {
  return transient.method == TimeMethod::generalized_alpha && !transient.balance &&
         default_balance(system, transient).keep_momenta;
}

std::unique_ptr<Stepper> make_stepper(const System& system, const TransientScene& transient) {
  const double step = transient.step.value_or(0.0), max_step = transient.max_step.value_or(0.0);
  const auto solver = [&transient] {
    return make_linear_solver(transient.linear_solver, PivotOrder::nodes_first);
  };
  switch (transient.method) {
    case TimeMethod::generalized_alpha:
      return std::make_unique<GeneralizedAlpha>(
          system, solver(),
          GeneralizedAlphaOptions{.step = step,
                                  .tolerances = error_tolerances(transient),
                                  .end = transient.duration,
                                  .max_step = max_step,
                                  .rho_infinity = rho_infinity_of(transient),
                                  .balance = balance_of(system, transient),
                                  .newton = newton_options(transient),
                                  .keep_momenta = keeps_momenta(system, transient)});
    case TimeMethod::radau:
      return std::make_unique<Radau>(system, solver(), make_pencil_solver(transient.linear_solver),
                                     RadauOptions{.step = step,
                                                  .tolerances = error_tolerances(transient),
                                                  .end = transient.duration,
                                                  .stages = radau_stages(transient),
                                                  .max_step = max_step,
                                                  .newton = newton_options(transient)});
    case TimeMethod::ida:
      return std::make_unique<Ida>(system, make_klu_solver(),
                                   IdaOptions{.tolerances = error_tolerances(transient),
                                              .end = transient.duration,
                                              .max_step = max_step,
                                              .max_order = has_beams(system) ? 2 : 5});
  }
  throw Error(transient.source, "transient: unknown method");
}

StaticOptions static_options(const Scene& scene, const StaticScene& statics) {
  StaticOptions options;
  options.steps = statics.steps;
  options.newton.tolerance = statics.tolerance;
  options.newton.line_search = statics.line_search;
  options.solver = statics.solver;
  options.has_potential = has_potential(scene);
  Scene symmetric = scene;
  for (BeamScene& beam : symmetric.beams) beam.form = Form::energy;
  options.conservative = has_potential(symmetric);
  return options;
}

}  // namespace mbd
