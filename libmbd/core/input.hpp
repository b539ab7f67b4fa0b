// What a program sets while a model runs: the inputs of its laws (`<input>`), as functions of time that it gives piece by
// piece.
#pragma once

#include <string>

#include "libmbd/core/taylor.hpp"

namespace mbd {

// An input of a System.
struct InputInfo {
  std::string name;
  std::string unit;     // of its values, as written in the model; empty: SI, or a pure number
  double factor = 1.0;  // what makes SI of them
  double initial = 0.0;
  std::string set_by = {};  // the controller of the model that sets it; empty: the program does
};

// From `since` [s] on the input is  u(t) = f + fdot tau + fddot tau^2/2,  tau = t - since,  in its own unit. Set between
// steps; a Stepper sees it at the next one (Stepper::step).
struct InputValue {
  double f = 0.0, fdot = 0.0, fddot = 0.0;
  double since = 0.0;

  template <class S>
  Taylor<S> at(S t) const {
    const S tau = t - S(since), rate = S(fdot) + S(fddot) * tau;
    return {S(f) + tau * (S(fdot) + S(0.5) * S(fddot) * tau), rate, S(fddot)};
  }

  // A value that stays, from now on.
  void hold(double value, double now) { *this = {value, 0.0, 0.0, now}; }
  // In a straight line from its value now to `value` at `then` > now.
  void ramp(double value, double now, double then) {
    const double from = at(now).v;
    *this = {from, (value - from) / (then - now), 0.0, now};
  }
};

}  // namespace mbd
