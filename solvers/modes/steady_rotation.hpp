// Steady rotation: a scene, or all of it but what is at rest (housings of bearings), turns about an axis that is fixed in
// space, at a constant rate W, without changing its shape. With W~ the twist of that rotation in inertial axes, V =
// Ad(H^-1) W~ of what turns, 0 of what rests, and Vdot = 0 in body axes:
//   r(H, V(H), 0, lambda) = 0,   dr = (dr/dU + dr/dV V~) dU + B^T dlambda,                            (1)
// which is K of small_motions.hpp in body axes: centrifugal stiffening and softening, gyroscopic moments among it. Drives
// stay at their angle of the state.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "solvers/modes/small_motions.hpp"
#include "solvers/newton/report.hpp"

namespace mbd {

struct SteadyRotation {
  double rate = 0.0;             // [rad/s] about `axis`, right-handed
  Vec3 axis = Vec3::UnitX();     // inertial, of length 1
  Vec3 through = Vec3::Zero();   // a point of it, inertial [m]
  std::vector<char> rests = {};  // by node: does not turn; empty: all turn

  bool turns(std::size_t node) const { return rests.empty() || rests[node] == 0; }
  // The twist of the rotation at a pose, body axes [m/s, rad/s], whether it turns or not.
  Vec6 twist(const Pose<double>& H) const;
};

// Axes in which small motions are looked at: of a rotor that is not round on bearings that are alike in all directions
// those that turn, of a round rotor on any bearings those that rest.
enum class ModeAxes { turning, resting };

// The state with what turns turned by an angle [rad], and velocities with it; multipliers as they are.
State turned_by(double angle, const SteadyRotation& rotation, const State& state);

// Gives the state the velocities of the rotation, and no accelerations.
void turn_steadily(const SteadyRotation& rotation, State& state);

// Assembles small motions about it in axes that all turn, or all rest.
bool about_rotation(SmallMotions& motions, const SteadyRotation& rotation, ModeAxes axes,
                    const State& state);

struct SteadyReport {
  bool converged = false;
  double rate = 0.0;  // reached [rad/s]
  int steps = 0;      // of the rate
  Counters counters;
  std::string failure;  // when not converged
};

// Moves `state`, in equilibrium at `from` [rad/s], to that of `rotation`, by Newton's method in as many steps of the rate
// as it takes. On failure it is the last equilibrium found. `motions` is assembled about it in body axes.
SteadyReport find_steady_rotation(SmallMotions& motions, const SteadyRotation& rotation,
                                  double from, const NewtonOptions& options, State& state);

// Newton's method at the rate of `rotation`, from a state near it. On failure, `failure` says why, and `state` is where it ended.
bool solve_steady_rotation(SmallMotions& motions, const SteadyRotation& rotation,
                           const NewtonOptions& options, State& state, Counters& counters,
                           std::string& failure);

// Increments turn nothing by more than this [rad].
inline constexpr double largest_turn_of_rotation = 0.5;

// Where no constraint holds the angle about the axis, as a drive does, K is singular in turning axes: a spring is added to it,
// which feels nothing of what has no torque about the axis. Until the next about().
void hold_free_turn(SmallMotions& motions, const SteadyRotation& rotation);

// Rows of State::lambda that hold the angle of the rotation itself, by drives.
using IsDriven = std::function<bool(Index)>;

// What keeps the rotation from taking place: a constraint, in words; empty if nothing does. `motions` is assembled about the
// state.
std::string held_fast(const SmallMotions& motions, const SteadyRotation& rotation,
                      const State& state, const IsDriven& driven);

// A drive that does not go with a steady rotation: one that turns what turns, and has no constant rate in the last tenth of a run of
// `duration` [s], nor after it; any other that moves. In words; empty if there is none. Inputs are held. `motions` is assembled about the state.
std::string unsteady_drive(const SmallMotions& motions, const SteadyRotation& rotation,
                           const State& state, double duration);

// Why small motions in these axes do not stay as they are while the scene turns (weight and dead loads, what is not alike
// in all directions and turns otherwise than the axes): in words, empty if they do. What turns is turned by some angles,
// and forces and the answer to forces are compared, beside the round-off between two angles that are nearly the same. `motions`
// is left assembled in these axes.
std::string broken_symmetry(SmallMotions& motions, const SteadyRotation& rotation, ModeAxes axes,
                            const State& state, const IsDriven& driven);

}  // namespace mbd
