// What a model is, without a run: a check of it, and what is simulated, term by term.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/core/batch.hpp"
#include "libmbd/results/report.hpp"
#include "libmbd/scene/scene.hpp"
#include "solvers/constraints/mechanism.hpp"

namespace mbd {

// Items of one kind: what = "point masses".
struct Count {
  std::string what;  // plural
  Index count = 0;
};

// What `mbd check` says of a model that has no mistakes.
struct CheckReport {
  std::string model, file;
  std::vector<Count> stated;  // items of the scene, in the order of a model; 0 where there are none

  Index elements = 0;  // of beams, with those that boundaries at attachments add
  Index nodes = 0;     // with the ground, as in report.json
  Index unknowns = 0, multipliers = 0;
  Index fused = 0;  // fixed joints without multipliers, because what they join is one node

  // Of the reference configuration: what a wrong unit shows in.
  Vec3 low = Vec3::Zero(),
       high = Vec3::Zero();    // corners of a box around all nodes, inertial axes [m]
  std::optional<double> mass;  // of everything that moves; of transients only [kg]

  Mechanism mechanism;
  std::vector<std::string> redundant;  // sentences, of the constraints that others imply
  // What they would imply if the beams were rigid, by joint ("revolute 'D': position 3"), and how many rows.
  std::vector<std::string> redundant_if_rigid;
  Index rows_redundant_if_rigid = 0;

  // At the start, before equilibrium is sought.
  Energies energy;                     // [J]
  WorstConstraint position, velocity;  // |g| [m, rad], |gdot| [m/s, rad/s]

  std::optional<StaticScene> statics;
  std::optional<TransientScene> transient;
  std::optional<PathScene> path;
  long steps = 0;     // of the transient
  Index columns = 0;  // of history.csv, with time

  std::vector<std::string> notes;  // what a user should look at before a run
};

// Makes the checks that run() makes before its first step and compile() does not: the number of steps, and
// the columns that plots and expectations ask for. Throws Error as they do. `model`: compiled from `scene`.
CheckReport check_model(const Scene& scene, const Model& model);

// For people, at most 80 letters a line where words allow it.
std::string to_text(const CheckReport& report);
std::string to_json(const CheckReport& report);

// One batch of a System.
struct Term {
  std::string type;
  Index size = 0;           // elements or joints
  Index contributions = 0;  // numbers it adds to the matrix: several may share a place
  std::size_t bytes = 0;    // of its data
};

// What is simulated, and the statements of the scene it comes from: `<gravity>, line 12`.
struct Effect {
  std::string what;
  std::vector<std::string> from;
};

// What is not simulated, and why.
struct Absence {
  std::string what, why;
};

// What `mbd explain` says.
struct Explanation {
  std::string model, file;
  std::vector<Term> terms;  // in the order of System::batches()
  Index nodes = 0;          // with the ground
  Index unknowns = 0, multipliers = 0;
  Index nonzeros = 0;           // of the matrix
  std::size_t batch_bytes = 0;  // of all terms
  std::size_t state_bytes = 0;  // of one State
  // Of each analysis, what solves its linear systems: {"transient", "block LU, nodes first: …"}.
  std::vector<std::pair<std::string, std::string>> linear_solvers;
  std::vector<Effect> effects;
  std::vector<Absence> absent;
};

// `model`: compiled from `scene`. Analyses the matrix, without numbers.
Explanation explain_model(const Scene& scene, const Model& model);

std::string to_text(const Explanation& explanation);
std::string to_json(const Explanation& explanation);

}  // namespace mbd
