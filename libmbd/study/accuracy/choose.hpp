// A run that chooses its own settings for an accuracy of its recorded quantities.
//
// Error: of each quantity the rms over the places of Findings of the length of the difference of its vector, over the
// largest length of it in the run (of what depends on where the origin is, its largest change); that of a run is its
// worst quantity's. What is not above `accuracy` times others of its unit is zero within what is asked, and is measured
// by those; that, rotations and branches: norm.hpp. Of a path, loads and recorded numbers at its special points count.
//
// What is believed is a difference, never a formula: a run and one with all its knobs finer (a tenth of the
// tolerance, one order more, of one element two). The finer run's own error, by the rate at which earlier
// differences fell, is added.
//
//   time   radau with tolerances: tau and tau/10 on a coarse mesh; from their difference e the next tau is
//          tau (target / e)^(1/p), p measured, 1 until it is. Rounded down to 1, 2, 5 10^k. Where the first mesh errs by
//          more than e, the next tau is not tried on it but on the next mesh.
//   space  one order more: the next mesh by the measured rate, or, before there is one, by the decay sigma of
//          Legendre coefficients (resolution.hpp): sigma^1.5, between that of strains (sigma) and of displacements
//          (sigma^2). Where sigma is small, or strains jump from element to element, the motion is not smooth at the
//          size of the elements, and their number is doubled instead. Of the first mesh a run that takes more than a
//          twentieth of the limit is not repeated with one order more: the last coefficients say how much it errs. Where
//          sigma is large, half the elements with a higher order are taken if they have fewer nodes (2^(N+1) the error).
//          A finer mesh has shorter elements in every beam: where places divide beams, twice as many may be the same mesh.
//   loads  where nodes do not see what loads along beams do (load_sampling.hpp), elements that do: one more run tells whether it
//          matters.
//   last   of tables with kinks inside elements, which every order smooths alike, a run whose elements end there. And what
//          is cheaper and, measured against the run that verified the choice (and that one), as good: at coarse accuracies
//          the scene's own time steps, fixed steps of radau (fewer than the tolerance took), and half the elements, as long
//          as each does.
//
// Not used: the integrator's own estimates, which are of a step, and a priori constants of elements, which are of
// beams of one kind. Differences that do not fall are chaos or ringing that is not resolved: then nothing is claimed.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/run/run.hpp"
#include "libmbd/study/trial/setting.hpp"
#include "libmbd/study/trial/trial.hpp"

namespace mbd {

inline constexpr double finest_accuracy = 1e-9, coarsest_accuracy = 0.1;

struct ChooseOptions {
  double accuracy = 1e-3;  // largest rms error of the quantities
  std::vector<std::string> quantities =
      {};                // names as of choose_columns(); none: all that the scene records
  double limit = 600.0;  // CPU time for choosing [s]
  std::function<void(const std::string& what)> progress = {};  // told before each pilot run
};

// One of the runs that led to the choice.
struct Pilot {
  Setting setting;
  std::string text;
  double cpu = 0.0;  // [s]
  // Believed, of the worst quantity; nothing: it was not compared to a finer one.
  std::optional<double> error;
  std::optional<double> in_time, in_space;  // its parts, where a run with one knob finer was made
  bool cut_off = false;                     // it would have taken longer than it may
  std::string failure;                      // why it did not come to its end
};

struct Choice {
  Setting setting;                           // to be run
  double accuracy = 0.0;                     // requested
  std::vector<std::string> quantities = {};  // of which; none: all
  std::optional<double> error;               // believed of it; nothing: not known
  std::string worst;                         // the quantity of `error`
  bool met = false;                          // error <= accuracy
  std::string reason;                        // if not: why no better setting was taken
  std::vector<Pilot> pilots;
  double cpu = 0.0;  // of the pilots [s]
  std::vector<std::string> notes;
};

// Throws Error for an accuracy that cannot be had or a quantity that is not recorded, and as run() does when the scene
// cannot be run at all.
Choice choose(const Scene& scene, const ChooseOptions& options);

// What a report tells of it.
ChosenAccuracy summary_of(const Choice& choice);

// The error of a run against a better one, both of one scene.
struct Disagreement {
  double rms =
      0.0;  // of the worst quantity; infinite where the runs have not the same places or columns
  std::string worst = {};
  // From where on the worst differs by more than the accuracy; nothing: nowhere.
  std::optional<double> from = {};
  // Quantities measured by the largest of their unit: below the accuracy beside that; of those asked for by name, round-off.
  std::vector<std::string> as_zero = {};
};
// `length` [m] of the scene: moments of less than 1e-9 of the largest recorded force times that, and forces so far below
// moments, are zero; 0: none are.
Disagreement disagreement(const Findings& run, const Findings& better, double accuracy,
                          const std::vector<std::string>& quantities = {}, double length = 0.0);

}  // namespace mbd
