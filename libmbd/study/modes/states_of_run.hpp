// States on the way of a scene, for studies that look at small motions about them.
#pragma once

#include <atomic>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/scene/scene.hpp"
#include "solvers/statics/statics.hpp"

namespace mbd {

// The scene with its <transient> for `duration` [s], or what follows it in whole steps; without one by Radau to 1e-8.
// Expectations, plots and paths are left out.
Scene scene_of_run(const Scene& scene, double duration);

// The equilibrium of the scene's <static> from a state on, which it becomes.
StaticReport find_equilibrium(const Scene& scene, const Model& model, State& state);

// What a model of scene_of_run() starts from: its initial state, in the equilibrium of its <static> if it has one. Throws
// Error where there is none.
State start_of_run(const Scene& scene, const Model& model);

// Gives a state the accelerations and multipliers that belong to its positions and velocities, whatever an integrator's are.
// Returns an empty string, or why there are none.
std::string make_consistent(const System& system, State& state);

// The states at rising times, none beyond the duration, from start_of_run(). `study`: who asks, in messages. Throws Error
// where the run ends before, or is interrupted.
std::vector<State> states_of_run(const Scene& scene, const Model& model, State start,
                                 const std::vector<double>& times, const char* study,
                                 const std::atomic<bool>* interrupted = nullptr);

}  // namespace mbd
