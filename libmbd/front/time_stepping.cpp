#include "libmbd/front/time_stepping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libmbd/front/schema.hpp"
#include "solvers/generalized_alpha.hpp"
#include "solvers/ida.hpp"
#include "solvers/klu_solver.hpp"
#include "solvers/radau.hpp"

namespace mbd {
namespace {

constexpr double largest_steps = 1e12;
constexpr double most_rows = 1e9;
constexpr double usual_rows = 1000.0;  // of adaptive steps
constexpr double whole = 1e-9;  // of the duration: how far from a whole number of steps it may be
constexpr double round_off = 1e-13;  // of times, of the duration

bool is_whole(double ratio) { return std::abs(ratio - std::round(ratio)) <= round_off * ratio; }

// BDF of order 3 and more amplify undamped oscillations, of which beams have many.
[[maybe_unused]] bool has_beams(const System& system) {
  return std::any_of(system.batches().begin(), system.batches().end(),
                     [](const auto& batch) { return batch->type().starts_with("beam"); });
}

}  // namespace

std::string_view name_of(TimeMethod method) {
  const schema::Element& element = *schema::find_element("transient");
  return schema::words(
      schema::find_attribute(element, "method")->choices)[static_cast<std::size_t>(method)];
}

long number_of_steps(const TransientScene& transient) {
  const double duration = transient.duration, step = transient.step.value_or(0.0);
  if (!(duration > 0.0) || !(step > 0.0))
    throw Error(
        transient.source,
        fmt::format("transient: duration={} and step={} must both be positive", duration, step));
  const double steps = std::round(duration / step);
  if (!(steps <= largest_steps))
    throw Error(transient.source,
                fmt::format("transient: {} s in steps of {} s are too many steps; take larger ones",
                            duration, step));
  if (steps < 1.0 || std::abs(steps * step - duration) > whole * duration) {
    const double above = std::ceil(duration / step);
    throw Error(transient.source,
                fmt::format("transient: duration={} is not a whole number of steps of {} s; with "
                            "step=\"{}/{:.0f}\" it is, or with duration=\"{:.0f}*{}\"",
                            duration, step, duration, above, above, step));
  }
  return static_cast<long>(steps);
}

bool takes_newton_tolerance(const TransientScene& transient) {
  return transient.method == TimeMethod::generalized_alpha ||
         (transient.method == TimeMethod::radau && transient.step);
}

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
          .angular_velocity = transient.angular_velocity_tolerance.value_or(0.0)};
}

double rho_infinity_of(const TransientScene& transient) {
  return transient.rho_infinity.value_or(0.0);
}

Balance balance_of(const TransientScene& transient) {
  return transient.balance.value_or(Balance::acceleration);
}

#ifndef MBD_FUZZ  // whose program steps nothing, and is built without the integrators
std::unique_ptr<Stepper> make_stepper(const System& system, const TransientScene& transient) {
  const double step = transient.step.value_or(0.0), max_step = transient.max_step.value_or(0.0);
  switch (transient.method) {
    case TimeMethod::generalized_alpha:
      return std::make_unique<GeneralizedAlpha>(
          system, make_klu_solver(),
          GeneralizedAlphaOptions{.step = step,
                                  .tolerances = error_tolerances(transient),
                                  .end = transient.duration,
                                  .max_step = max_step,
                                  .rho_infinity = rho_infinity_of(transient),
                                  .balance = balance_of(transient),
                                  .newton = newton_options(transient)});
    case TimeMethod::radau:
      return std::make_unique<Radau>(system, make_klu_solver(), make_klu_pencil_solver(),
                                     RadauOptions{.step = step,
                                                  .tolerances = error_tolerances(transient),
                                                  .end = transient.duration,
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
#endif

std::vector<std::string> change_stepping(TransientScene& transient, const SteppingChange& change) {
  std::vector<std::string> notes;
  const auto drop = [&notes](std::string_view name, auto& value, std::string_view why) {
    if (value) notes.push_back(fmt::format("{} of the model is not used: {}", name, why));
    value.reset();
  };
  const std::optional<double> rows = row_interval(transient);  // of the model itself
  if ((change.step && transient.tolerance) || (change.tolerance && transient.step))
    if (!transient.output_steps) transient.output = rows;
  if (change.step) {
    constexpr std::string_view why = "the steps are fixed";
    transient.step = change.step;
    transient.tolerance.reset();
    drop("position_tolerance", transient.position_tolerance, why);
    drop("rotation_tolerance", transient.rotation_tolerance, why);
    drop("velocity_tolerance", transient.velocity_tolerance, why);
    drop("angular_velocity_tolerance", transient.angular_velocity_tolerance, why);
    drop("max_step", transient.max_step, why);
  }
  if (change.tolerance) {
    transient.tolerance = change.tolerance;
    transient.step.reset();
  }
  if (change.method) {
    transient.method = *change.method;
    if (transient.method != TimeMethod::generalized_alpha) {
      const std::string why =
          fmt::format("it belongs to generalized_alpha, not {}", name_of(transient.method));
      drop("rho_infinity", transient.rho_infinity, why);
      drop("balance", transient.balance, why);
    }
  }
  if (transient.method == TimeMethod::generalized_alpha) {
    constexpr std::string_view why =
        "generalized_alpha estimates errors of positions and rotations only";
    drop("velocity_tolerance", transient.velocity_tolerance, why);
    drop("angular_velocity_tolerance", transient.angular_velocity_tolerance, why);
  }
  if (!takes_newton_tolerance(transient))
    drop("newton_tolerance", transient.newton_tolerance,
         fmt::format("{} derives its own from the tolerance", name_of(transient.method)));
  return notes;
}

std::optional<double> row_interval(const TransientScene& transient) {
  if (transient.output_steps) return std::nullopt;
  if (transient.output) return transient.output;
  return transient.step ? *transient.step : transient.duration / usual_rows;
}

RowTimes::RowTimes(const Scene& scene) {
  const TransientScene& transient = *scene.transient;
  end_ = transient.step ? static_cast<double>(number_of_steps(transient)) * *transient.step
                        : transient.duration;
  slack_ = round_off * transient.duration;
  if (const std::optional<double> interval = row_interval(transient)) {
    interval_ = *interval;
    if (!(transient.duration / interval_ <= most_rows) && transient.output)
      throw Error(transient.source,
                  fmt::format("transient: {} s with a row of results every {} s are too many rows; "
                              "give a larger output",
                              transient.duration, interval_));
    if (transient.step) {
      const double ratio = interval_ / *transient.step;
      at_steps_ = std::abs(ratio - 1.0) <= round_off;
      inside_steps_ = !is_whole(ratio);
    }
  } else {
    at_steps_ = true;
    for (const ExpectScene& expect : scene.expects)
      if (expect.of == ExpectScene::Of::value_at && expect.at > 0.0 && expect.at < end_)
        list_.push_back(expect.at);
    std::sort(list_.begin(), list_.end());
    list_.erase(std::unique(list_.begin(), list_.end()), list_.end());
    inside_steps_ = transient.step && !list_.empty();
  }
  next_ = at(0);
}

// Of those before the end, where there is a row anyhow.
double RowTimes::at(long k) const {
  constexpr double none = std::numeric_limits<double>::infinity();
  if (interval_ > 0.0) {
    const double t = static_cast<double>(k + 1) * interval_;
    return at_steps_ || t > end_ - slack_ ? none : t;
  }
  return k < std::ssize(list_) ? list_[static_cast<std::size_t>(k)] : none;
}

void RowTimes::advance() { next_ = at(++k_); }

}  // namespace mbd
