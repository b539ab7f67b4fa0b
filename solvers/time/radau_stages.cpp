#include "solvers/time/radau_stages.hpp"

#include <algorithm>

namespace mbd {
namespace {

constexpr int window = 8, settling = 5, detour = 6;  // steps
constexpr int longest_pause = 1024;                  // windows
constexpr double gain = 1.1;
constexpr double tight = 1e-5;
constexpr double changed = 2.0;  // the pace has: what was in vain may not be now

int first_pause(double tolerance) { return tolerance <= tight ? 2 : 6; }

}  // namespace

RadauStages::RadauStages(double tolerance)
    : wait_(first_pause(tolerance)), pause_(first_pause(tolerance)) {}

void RadauStages::begin_window() {
  steps_ = 0;
  time_ = work_ = 0.0;
}

bool RadauStages::failed() {
  if (at_ == 0) {
    if (away_ > 0) away_ = detour;
    return false;
  }
  home_ = at_;
  away_ = detour;
  at_ = 0;
  return true;
}

bool RadauStages::accepted(double h, double work) {
  const bool away = away_ > 0;
  if (away) {
    step_ = h;
    if (--away_ == 0) at_ = home_;
  } else {
    last_step_[at_] = h;
  }
  ++steps_;
  if (!trying_ || steps_ > settling) {
    time_ += h;
    work_ += work;
  }
  const bool back = away && away_ == 0;
  if (away_ > 0 || steps_ < window + (trying_ ? settling : 0)) return back;
  return (trying_ ? judge() : try_others()) || back;
}

// The end of a trial.
bool RadauStages::judge() {
  const double rate = time_ / work_;
  trying_ = false;
  begin_window();
  if (rate > gain * rate_) {
    rate_ = rate;
    wait_ = 2;
    return false;
  }
  pause_ = std::min(2 * pause_, longest_pause);
  wait_ = pause_;
  up_ = !up_;
  step_ = last_step_[from_];
  at_ = from_;
  return true;
}

// The end of a window.
bool RadauStages::try_others() {
  const double rate = time_ / work_;
  if (rate < rate_ / changed) wait_ = 1;
  rate_ = rate;
  begin_window();
  if (--wait_ > 0) return false;
  if (up_ ? at_ + 1 == ladder.size() : at_ == 0) up_ = !up_;
  from_ = at_;
  step_ = last_step_[at_];
  at_ = up_ ? at_ + 1 : at_ - 1;
  if (!up_ && last_step_[at_] > 0.0) step_ = std::min(step_, 0.5 * (step_ + last_step_[at_]));
  trying_ = true;
  return true;
}

}  // namespace mbd
