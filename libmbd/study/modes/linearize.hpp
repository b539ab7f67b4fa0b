// A scene linearised, with its inputs and outputs: E x' = A x + B du, dy = C x + D du (solvers/modes/linearization.hpp).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/compile/ports.hpp"
#include "libmbd/scene/scene.hpp"
#include "libmbd/study/modes/modes.hpp"
#include "solvers/modes/linearization.hpp"

namespace mbd {

struct Linearization {
  std::string model, file;
  std::optional<SteadyRotation> rotation;
  std::optional<double> time;  // [s] of the run
  State state;                 // about which
  LinearMotion motion;         // of all nodes
  // On the constraints: [q; q'], each q a displacement [m] or rotation [rad] of a node in its body axes. Nothing about a
  // state that moves otherwise than in a steady rotation.
  std::optional<ReducedMotion> reduced;
  // [1/s] Of what grows fastest in `reduced`, 0: nothing does, beyond round-off; empty where it was not asked for.
  std::optional<double> growth;
  std::vector<Port> states;
  Ports ports;
  VecX outputs;  // at the state
  // dy = C x + D du, du in the units of the inputs, of ports.outputs: without those that the states do not tell, and, about a steady
  // rotation, that are not constant in axes that turn (`notes`). By central differences of the outputs along exact small motions, over
  // steps that go down until they agree; of which they do not to 1e-6 of the largest entry of a quantity, `notes` say.
  MatX C, D;
  std::vector<std::string> notes;
};

// About the equilibrium of a scene, a steady rotation, or the state of a run at a time (ModesOptions says how; `count` and
// `near` are not used). `growth`: whether anything grows is looked for, which takes all poles. Throws Error as study_modes() does.
Linearization linearize(const Scene& scene, const ModesOptions& options = {}, bool growth = false);

// About a state that the program has, of the model with the inputs that it has: in full where it is an equilibrium at rest
// (velocities, and accelerations that the equations of motion give it, to 1e-6 of the largest over a second). Throws Error
// where accelerations are not determined, or an element is outside its range.
Linearization linearize(const Model& model, const State& state);

// linear.json (names, units, and the matrices E, A, B, C, D by rows) and M.mtx, C.mtx, K.mtx, G.mtx (the gradient of the
// constraints), F.mtx: (1) of linearization.hpp in the format of Matrix Market. Throws Error if a file cannot be written.
void write_linearization(const Linearization& linear, const std::filesystem::path& directory);

// The same as one file of HDF5: E, A, B, C, D as tables; inputs, outputs and states with names, units and frames; the matrices of all
// nodes as triplets (row and column from 0, value). Throws Error as Hdf5File does.
void write_linearization(const std::filesystem::path& file, const Linearization& linear,
                         const Scene& scene);

std::string to_text(const Linearization& linear);

}  // namespace mbd
