// Runs a scene from its start to its end: compile, equilibrium, time steps, results.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "libmbd/results/observers.hpp"
#include "libmbd/results/report.hpp"
#include "libmbd/run/checkpoint.hpp"
#include "libmbd/scene/scene.hpp"
#include "libmbd/scene/transient.hpp"

namespace mbd {

struct Progress {
  double t = 0.0, duration = 0.0;  // [s]
  long step = 0, steps = 0;        // done, and to do: 0 if not known
  int iterations = 0;              // of this step
};

struct RunOptions {
  std::optional<std::filesystem::path> output = {};  // directory of history.csv, .svg, report.json
  std::string id = {};  // that files of this run bear (results/history.hpp); none: a new one
  std::vector<Observer*> observers = {};        // more of them; they must outlive the run
  std::vector<std::string> notes = {};          // that the report begins with
  std::optional<ChosenAccuracy> accuracy = {};  // for the report
  bool audit = true;     // the certificate; false: none, and no step is looked at for one
  bool certify = false;  // the dear checks of the certificate too (certificate.hpp)
  // Of a transient that comes to its end, a second run in other steps, of 0.4 to 0.9 times its cost as a rule, at most of
  // some three, which estimates its error (time_error.hpp).
  bool estimate_error = true;
  // Of a transient with an output directory: from there a run that was killed goes on with `restart`, and history.csv is that of
  // one that was not, to the last bit. Without an estimate of the error in time, and without motion.
  std::optional<CheckpointEvery> checkpoint_every = {};
  bool restart = false;  // `checkpoint_every` then follows from the checkpoint, and may be left out
  std::function<void(const Progress&)> progress = {};  // after each time step
  // True ends the run: looked at from inside compilation, Newton's iterations and searches (core/stop.hpp), so at most
  // one factorisation later.
  const std::atomic<bool>* interrupted = nullptr;
};

// Throws Error for what is wrong with the scene or the directory (one run at a time writes into a directory, and none
// over what it reads), and when there is no first state: the
// initial accelerations, the first load step or the equilibrium before a transient fail. Nothing is
// written then, and an earlier result stays. What goes wrong later ends the run and is told in
// RunReport::failure; the results up to there are kept.
// Of a transient, observers see the states of which rows are written (row_interval): where steps end, or
// interpolated to the order of the method (DenseStep).
// A scene without <transient> has for accepted states its reference state, at load factor 0, and each
// load step. The equilibrium before a transient has none of its own.
RunReport run(const Scene& scene, const RunOptions& options = {});

}  // namespace mbd
