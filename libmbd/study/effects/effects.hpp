// What each effect of a scene costs and what it is worth: the scene run without each of them in turn, and the cheapest
// model within a tolerance.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/study/effects/ablation.hpp"
#include "libmbd/study/trial/norm.hpp"
#include "libmbd/study/trial/trial.hpp"

namespace mbd {

// How far a quantity is from that of the whole model: |d| the Euclidean length of the difference of its components at
// one of the places of Findings; `rms` the root of the mean of |d|^2 over all places, `largest` the largest |d|, both
// over the largest length that the whole model's vector has.
struct Change {
  bool known =
      false;  // false: it no longer exists (forces of a rigid beam), or the run is not complete
  double rms = 0.0, largest = 0.0;
  double at = 0.0;  // of the largest: where
};

struct EffectQuantity : Components {
  double scale = 1.0;
  bool is_zero = false;  // but for round-off: `scale` is that of others of its unit
  // What the whole model's own steps contribute: rms of its change with half the step or a tenth of the tolerance.
  double own = 0.0;
};

// CPU times of runs in turn, whole model and other, as ratios other / whole: the noise of a machine that slows down is in
// both.
struct Paired {
  std::vector<double> ratios;
  double median() const;  // 1 without any
  double least() const;
  double most() const;
};

struct EffectRun {
  Ablation ablation;
  Trial trial;                  // the last of its runs
  std::vector<Change> changes;  // by quantity
  Paired cpu;
  std::optional<double>
      instructions;  // executed, over those of the whole model; if they were counted

  bool complete() const { return trial.complete; }
  bool saves_time() const;      // in every pair of runs, and by more than noise
  bool keeps_all() const;       // every quantity still exists
  double worst() const;         // largest rms of the known changes
  std::size_t culprit() const;  // of which quantity
};

struct CheapestModel {
  std::vector<std::size_t> left_out;  // runs, in the order in which they were left out
  std::vector<Change> changes;        // verified, by quantity, over the whole scene
  Paired cpu;
  bool verified = false;  // it was run as a whole and kept the tolerance
  double worst() const;
};

struct EffectsStudy {
  std::string model, file, date, command, machine;
  std::vector<std::pair<std::string, std::string>> build;  // build_facts()
  double tolerance = 0.0;
  double end = 0.0;        // up to which the effects were compared: time [s], or load factor
  double whole_end = 0.0;  // of the model
  Trial whole;
  std::optional<double> instructions;  // of a run of it
  std::vector<EffectQuantity> quantities;
  std::vector<EffectRun> runs;  // in the order of ablations_of()
  CheapestModel cheapest;
  std::vector<std::string> notes;
  bool interrupted = false;
  double seconds = 0.0;  // wall time
};

struct EffectsOptions {
  std::vector<std::string> quantities = {};  // names, as of columns; none: all that are recorded
  double tolerance = 1e-2;                   // of Change::rms, of every quantity
  double budget = 120.0;  // CPU time of all runs [s]; of a long transient a part is compared for it
  std::string command = {};
  // Instructions that a run of the whole model executes without the effects of these keys; none: they are not counted.
  std::function<double(const std::vector<std::string>& keys)> instructions = {};
  std::function<void(const std::string& what, std::size_t done, std::size_t all)> progress = {};
  const std::atomic<bool>* interrupted = nullptr;  // becomes true: finish with what is there
};

// Throws Error for a scene that does not run, records nothing, or has no effect that could be left out.
EffectsStudy study_effects(const Scene& scene, const EffectsOptions& options);

}  // namespace mbd
