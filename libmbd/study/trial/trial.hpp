// One run of a scene for a study, in a process of its own: its cost, and what it found.
#pragma once

#include <atomic>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/results/report.hpp"
#include "libmbd/study/trial/resolution.hpp"

namespace mbd {

// What a run found, at places that are the same for all runs of a scene.
struct Findings {
  // Of history.csv, without the first; of path.csv, without those that say where on the path a point is.
  std::vector<std::string> columns;
  std::vector<std::string> units;
  // Where: times [s], evenly spread over the run and its end among them; of load steps the load factor 1; of a path
  // its limit points, bifurcations and marks, by number 1, 2, ….
  std::vector<double> at;
  std::vector<std::vector<double>> rows;  // values, by place and column
  // Largest kinetic or strain energy at these places [J]: what a total energy of zero is zero beside.
  double energy = 0.0;
  // Of a path: by place the number of the branch that it is on, 0 the one it begins on. None: it has no such places.
  std::vector<int> branch = {};
};

struct Trial {
  bool complete = false;
  bool stopped = false;  // before its end, because it took too long
  bool lost = false;     // its process ended without a word: by a signal, for want of memory
  std::string failure;   // why it is not complete
  // CPU time, least of the repeats [s]: of stepping (or of load steps, or points), and of the whole run, reading
  // excepted. Of a run that was stopped: what it had used.
  double cpu_stepping = 0.0, cpu = 0.0;
  int repeats = 0;
  // Largest resident size of the process, above what it began with [bytes].
  double memory = 0.0;
  Counters counters;  // of load steps and time steps
  Index nodes = 0, unknowns = 0, multipliers = 0;
  Findings findings;                  // also of a run that is not complete, up to where it came
  std::vector<BeamResolution> beams;  // over the states of all rows; if asked for
};

struct TrialOptions {
  int samples = 200;        // of a transient
  bool resolution = false;  // look at how well elements resolve the beams (Trial::beams)
  bool audit = true;        // as runs are; false: what a certificate takes is left out of its cost
  double limit = 1e30;      // CPU time at which it is stopped [s]
  double wall =
      1e30;  // wall time at which it is stopped [s]: it may wait for a processor that others use
  // Repeated up to `repeats` times, as long as all together have taken less than `repeat_within` [s].
  int repeats = 3;
  double repeat_within = 1.0;
  const std::atomic<bool>* interrupted = nullptr;  // becomes true: stop now
};

// Runs `scene` in a child process, waiting for it: its memory is its own, and whatever becomes of it (a signal, no
// memory) is a failure of the trial. Errors of the scene are failures too. Throws Error only when there can be no
// child process.
Trial run_trial(const Scene& scene, const TrialOptions& options);

// As text, with every number to its last bit, and back: nothing for what is not such a text, or only the beginning.
std::string serialize(const Trial& trial);
std::optional<Trial> deserialize(const std::string& text);

}  // namespace mbd
