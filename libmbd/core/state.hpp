// All that varies while a System is simulated. Everything else is const after compile.
#pragma once

#include <vector>

#include "libmbd/core/input.hpp"
#include "libmbd/core/se3.hpp"
#include "libmbd/core/signal.hpp"
#include "libmbd/core/types.hpp"

namespace mbd {

// Work done on the bodies since the state's start, by a quadrature rule over the steps taken [J]; or its rate [W].
struct Work {
  double loads = 0.0;    // by external loads, gravity excepted
  double drives = 0.0;   // by drives and prescribed motions
  double damping = 0.0;  // by damping, dampers and drag; negative where they take energy out

  double total() const { return loads + drives + damping; }
  Work& operator+=(const Work& other) {
    loads += other.loads;
    drives += other.drives;
    damping += other.damping;
    return *this;
  }
  friend Work operator*(double factor, const Work& w) {
    return {factor * w.loads, factor * w.drives, factor * w.damping};
  }
  friend Work operator+(Work a, const Work& b) { return a += b; }
};

// Arrays by node; node 0 is the ground, whose pose is the identity and never changes.
// A State of a static System has no rates: V and Vdot are empty.
struct State {
  double t = 0.0;           // [s]
  Side side = Side::right;  // of t, from which the signals are (System::set_time)
  double load_factor =
      1.0;  // on every load of the scene, gravity and (in statics) prescribed motions
            // included; 1 but in load stepping and path following
  std::vector<Pose<double>>
      pose;                // H = (p, r): rotation as a unit quaternion, position, inertial [-, m]
  std::vector<Vec6> V;     // [v; w], body frame of the node            [m/s, rad/s]
  std::vector<Vec6> Vdot;  // its time derivative, body frame            [m/s2, rad/s2]
  VecX lambda;             // constraint multipliers, as each joint's file defines them [N, N.m]
  // Rows of lambda, rising, that repeat others (solvers/constraints/redundancy.hpp): not imposed, their multipliers 0. Only of
  // a System that allows them.
  std::vector<Index> idle;
  std::vector<SignalValue> signals;  // drives and load signals at t (System::set_time)
  std::vector<InputValue>
      inputs;  // in the order of System::inputs(): what a program sets between steps
  std::vector<double>
      control;  // of System::controllers(): of each the count of its next instant, then its own states
  Work work;
  double momentum_rate = 0.0;  // [1/s] c of a stepper that balances momenta; 0: none (mass.hpp)
  std::vector<double> angles;  // unwrapped angle of each followed joint at the last accepted state;
                               // the present angle is the one nearest to it [rad]
};

}  // namespace mbd
