#include "libmbd/scene/transient.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mbd {
namespace {

constexpr double largest_steps = 1e12;
constexpr double most_rows = 1e9;
constexpr double usual_rows = 1000.0;  // of adaptive steps
constexpr double whole = 1e-9;  // of the duration: how far from a whole number of steps it may be
constexpr double round_off = 1e-13;  // of times, of the duration

bool is_whole(double ratio) { return std::abs(ratio - std::round(ratio)) <= round_off * ratio; }

}  // namespace

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

double rho_infinity_of(const TransientScene& transient) {
  return transient.rho_infinity.value_or(0.0);
}

StageCount stages_of(const TransientScene& transient) {
  return transient.stages.value_or(transient.step ? StageCount::three : StageCount::automatic);
}

std::size_t radau_stages(const TransientScene& transient) {
  switch (stages_of(transient)) {
    case StageCount::automatic:
      return 0;
    case StageCount::three:
      return 3;
    case StageCount::five:
      return 5;
    case StageCount::seven:
      return 7;
  }
  return 3;
}

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
    if (transient.stages == StageCount::automatic) drop("stages", transient.stages, why);
    drop("errors", transient.errors, why);
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
    if (transient.method != TimeMethod::radau)
      drop("stages", transient.stages,
           fmt::format("it belongs to radau, not {}", name_of(transient.method)));
  }
  if (change.stages) transient.stages = change.stages;
  if (transient.method == TimeMethod::generalized_alpha) {
    constexpr std::string_view why =
        "generalized_alpha estimates errors of positions and rotations only";
    drop("velocity_tolerance", transient.velocity_tolerance, why);
    drop("angular_velocity_tolerance", transient.angular_velocity_tolerance, why);
  }
  if (transient.method != TimeMethod::radau)
    drop("errors", transient.errors,
         fmt::format("it belongs to radau, not {}", name_of(transient.method)));
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
      throw Error(
          transient.source,
          fmt::format("transient: {} s with a row of results every {:.12g} s are too many rows; "
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
