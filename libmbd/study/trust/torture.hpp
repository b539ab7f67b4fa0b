// Whether a model gives what physics says it must, whatever it is given in: moved, in other units, written down in
// another order, in another step or tolerance.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/results/certificate.hpp"
#include "libmbd/study/trust/sameness.hpp"

namespace mbd {

// The kinds of trials, in the order in which they are made, and what --trials calls them.
//   motion      moved rigidly by about its own size, three seeds
//   far         moved by 1e3 and 1e6 of its size
//   units       in mm, t, s, and in units larger or smaller by random powers of ten
//   order       its parts listed in another order, two seeds
//   threads     two runs at once, and a third: the same to the last bit
//   steps       of a transient, fixed steps from 1e-7 of the duration to a tenth of it: each comes to its end, or ends with
//               a reason, and what it wrote is finite
//   tolerances  of a transient, Radau at tolerances over decades: errors fall, or have reached their floor
//   loads       of a <static>, its load in 1, 3 and 10 steps: the same equilibrium
inline constexpr std::array<std::string_view, 8> trial_kinds = {
    "motion", "far", "units", "order", "threads", "steps", "tolerances", "loads"};

struct TortureTrial {
  std::string kind = {};  // one of trial_kinds, or "run", of the model as it is
  std::string name = {};  // "seed 1", "1e6 lengths away"
  Verdict verdict = Verdict::pass;
  std::string reason = {};  // of the verdict, or what was seen; for a user
  bool compared = false;
  double difference = 0.0, bound = 0.0;  // the worst beside its bound, as of Sameness
  std::string quantity = {};             // whose
  double until = 0.0;                    // up to where it was compared
  double cpu = 0.0;                      // [s]
};

struct Torture {
  std::string model, file, date;
  std::vector<TortureTrial> trials;
  std::vector<std::string> notes;  // what was shortened, left out, or not tried
  double cpu = 0.0;                // of all runs [s]
  bool interrupted = false;

  Verdict verdict() const;
  const TortureTrial* culprit() const;  // the first of the worst; nullptr if all pass
};

struct TortureOptions {
  std::vector<std::string> kinds = {};  // of trial_kinds; none: all
  double budget = 60.0;    // CPU time of all runs [s]; a long transient is shortened for it
  std::uint64_t seed = 1;  // of random motions, units and orders
  std::function<void(const std::string& what)> progress = {};  // before each run
  const std::atomic<bool>* interrupted = nullptr;  // becomes true: finish with what is there
};

// Throws Error for unknown kinds, and a scene that cannot be compiled. A scene that does not run is a trial that fails.
Torture torture(const Scene& scene, const TortureOptions& options);

std::string to_text(const Torture& torture);  // a table for the terminal
std::string to_csv(const std::vector<Torture>& all);
std::string to_json(const Torture& torture);

}  // namespace mbd
