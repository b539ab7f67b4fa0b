// From a <transient> to the stepper that carries it out, from a <static> to the options of its solution.
#pragma once

#include <memory>

#include "libmbd/core/system.hpp"
#include "libmbd/language/quantities.hpp"
#include "libmbd/scene/transient.hpp"
#include "solvers/statics/statics.hpp"
#include "solvers/time/error_control.hpp"
#include "solvers/time/stepper.hpp"

namespace mbd {

// The settings that make_stepper() uses, with the method's own where the scene gives none.
NewtonOptions newton_options(const TransientScene& transient);
ErrorTolerances error_tolerances(const TransientScene& transient);

// Of radau with a tolerance: which errors its steps are held by. Where the scene does not say: of motion, if everything that
// it records follows from the motion alone; else of velocities too.
ErrorsOf errors_of(const Scene& scene);
// The scene's <transient>, which says that too where it is of use.
TransientScene transient_of(const Scene& scene);

// Of positions, rotations, angles of joints, lengths of joints and springs. Not of what is of the whole system, which has
// energies of stiff strains in it.
bool follows_from_motion(const schema::Quantity& quantity);

// Of generalized_alpha. Where the scene gives none: of accelerations, and parts that nothing ties to the ground keep their
// momenta as a whole (keeps_momenta), if inertia is full. Where some of these have added mass, which that does not know: of
// momenta of every node if no part is tied, else of accelerations alone.
Balance balance_of(const System& system, const TransientScene& transient);
bool keeps_momenta(const System& system, const TransientScene& transient);

// What integrates `system`, compiled from a scene with this transient, from t = 0. Throws Error for a method
// that is not there, and as the stepper's constructor does.
std::unique_ptr<Stepper> make_stepper(const System& system, const TransientScene& transient);

// `statics` of the scene, which decides whether stability is counted and whether loads have a potential.
StaticOptions static_options(const Scene& scene, const StaticScene& statics);

}  // namespace mbd
