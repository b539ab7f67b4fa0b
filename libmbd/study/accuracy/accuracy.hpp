// What accuracy costs: a scene with many settings, its errors against a reference, and the CPU time of each.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/study/trial/norm.hpp"
#include "libmbd/study/trial/setting.hpp"
#include "libmbd/study/trial/trial.hpp"

namespace mbd {

// Some components, one vector, whose error is measured. Norms of errors: |d| is the Euclidean length of the difference
// of the components at one place; `rms` is the root of the mean of |d|^2 over all places up to `until`, each with
// weight 1, `largest` the largest |d|; both are divided by `scale`.
struct Quantity : Components {
  // Largest length of the reference's vector up to `until`. Where that is round-off beside other columns of its unit, the
  // largest of those, of energies also Findings::energy; 1 if all are zero.
  double scale = 0.0;
  // Of the reference itself: the difference of the two ways to it, and a tenth of what the last refinement changed if that
  // is more.
  double reference_rms = 0.0, reference_largest = 0.0;
  // Up to which time its refinements approach each other [s]: the end, unless the motion is chaotic or rings faster than
  // any run resolved. 0: nowhere, there is no reference.
  double until = 0.0;
  bool is_zero = false;         // but for round-off, see `scale`
  bool reference_known = true;  // false: of a reference from a file, and the numbers are 0
};

struct QuantityError {
  bool known = false;  // the run came to `until`, and there is a reference
  double rms = 0.0, largest = 0.0;
  double at = 0.0;  // of the largest: where
  // Not well above the reference's own error (three times): the true one may be anything below the sum of both.
  bool below_reference = false;
};

struct TrialPoint {
  Setting setting;
  std::string text;  // to_text() of it
  Trial trial;
  std::vector<QuantityError> errors;  // by quantity
};

// Error ~ knob^slope, by least squares of logarithms over points of one family, which agree in all other knobs.
struct OrderFit {
  Knob knob = Knob::step;
  std::size_t quantity = 0;
  std::vector<std::size_t> points;  // used: errors below 0.1, and three times above the reference's
  double slope = 0.0;
  double spread = 0.0;  // largest departure of a point from the line, as a factor
  std::optional<double>
      theory;  // of smooth solutions: -2N over elements at their ends, 2 or 5 over steps, 1 over tolerances
};

// The cheapest setting at hand for an accuracy.
struct Advice {
  std::size_t quantity = 0;
  double accuracy = 0.0;  // a power of ten, of rms
  std::size_t point = 0;
};

struct AccuracyStudy {
  std::string model, file, date, command;
  std::string machine;                                     // processor and its number of cores
  std::vector<std::pair<std::string, std::string>> build;  // build_facts()
  std::string place;  // what Findings::at is: "time", "load factor", "number of the special point"
  std::size_t places = 0;  // how many
  double end = 0.0;        // the last of them
  // How the reference was made, a sentence, and the settings of its two ways (or its file).
  std::string reference;
  std::vector<TrialPoint> ways;  // the runs that made it, in the order of their refinement
  Findings truth;
  std::vector<Quantity> quantities;
  std::vector<TrialPoint> points;  // in the order of the variations
  std::vector<std::vector<std::size_t>>
      fronts;  // by quantity: points that none beats in both rms and CPU, by CPU
  std::vector<OrderFit> fits;
  std::vector<Advice> advice;
  std::vector<std::string> notes;
  std::size_t untried = 0;  // settings, for want of budget or by a signal
  bool whole() const { return untried == 0; }
  double seconds = 0.0, budget = 0.0;  // wall time used, and allowed
};

struct AccuracyOptions {
  // Names; none: those that the scene expects, plots or records, at most 4.
  std::vector<std::string> quantities = {};
  Variations variations = {};                           // empty knobs: default_variations()
  std::optional<std::filesystem::path> reference = {};  // a history.csv, in place of one's own
  double budget = 120.0;                                // wall time of it all [s]
  // Of the reference, at most. With a budget that is never used up, what is tried does not depend on the machine.
  int refinements = 12;
  // Where finished trials are kept and found again (OUT/trials); none: nowhere. `fingerprint` says what they belong to.
  std::optional<std::filesystem::path> keep = {};
  std::string fingerprint = {}, command = {};
  // Told before each trial: how many are done, how many there are (0: not known), seconds to come.
  std::function<void(const std::string& what, std::size_t done, std::size_t all, double eta)>
      progress = {};
  const std::atomic<bool>* interrupted = nullptr;  // becomes true: finish with what is there
};

// Throws Error for a scene that does not run with its own settings, unknown quantities and knobs.
AccuracyStudy study_accuracy(const Scene& scene, const AccuracyOptions& options);

}  // namespace mbd
