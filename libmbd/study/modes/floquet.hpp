// Stability of a motion that repeats: a scene's periodic motion, found from where a run of it goes, and the small motions about
// it (solvers/modes/periodic_motion.hpp).
#pragma once

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/scene/scene.hpp"
#include "solvers/modes/periodic_motion.hpp"
#include "solvers/modes/steady_rotation.hpp"

namespace mbd {

struct FloquetOptions {
  double period = 0.0;  // [s]; of loads, drives and motion
  // Periods that are integrated before the one that Newton's method starts from. Once more with twice as many, 8 at least, where
  // what is found is unstable and not where the run goes.
  int settle = 2;
  // Newton's method starts from the steady rotation, a turn in a period, that the scene has without gravity, and not from a
  // run: of a rotor whose run does not settle. Its rate is not used. Nothing is integrated then, but the motion begins after
  // `settle` periods all the same: by then the drive has run up.
  std::optional<SteadyRotation> rotation = {};
  std::vector<std::string> at_rest = {};  // bodies and flexible beams that do not turn
  int harmonics = 0;                      // of the period; 0: as many as the motion needs
  int count = 10;                         // exponents shown, the least stable
  const std::atomic<bool>* interrupted = nullptr;
};

struct NamedFloquetMode : FloquetMode {
  std::string most;  // the node that moves most
};

// Growth over a period that is round-off, or less than can be told from it.
inline constexpr double neutral_growth = 1e-6;

enum class Stability { stable, neutral, unstable };

struct FloquetStudy {
  std::string model, file;
  double begin = 0.0, period = 0.0;  // [s]
  int harmonics = 0;
  PeriodicReport report;
  std::vector<NamedFloquetMode> modes;  // the least stable first
  std::size_t resolved = 0;             // exponents that were found and are resolved
  bool all = false;                     // those of every motion that the harmonics resolve
  // What is not known of growth over a period, where laws jump between the instants: of the first order of these.
  double uncertain = 0.0;
  // Why there is no verdict but "unstable": something may grow that was not looked at. Empty: nothing was found.
  std::string undecided;
  std::vector<std::string> notes;

  // The fastest motions that harmonics can be [Hz]: of faster ones nothing is said.
  double fastest() const { return harmonics / period; }
  // Largest growth over a period, Re l T; further from 0 than neutral_growth, and than what is not known, there is a verdict.
  double growth() const { return modes.empty() ? 0.0 : modes.front().exponent.real() * period; }
  Stability stability() const {
    const double least = std::max(neutral_growth, uncertain);
    return growth() > least                         ? Stability::unstable
           : undecided.empty() && growth() < -least ? Stability::stable
                                                    : Stability::neutral;
  }
};

// The run is that of scene_of_run(). Throws Error as compile() does, where the run or
// Newton's method fails, and for loads and drives that do not repeat. `motion`: file for a period of the motion
// (libmbd/view/motion.hpp); empty: none.
FloquetStudy study_floquet(const Scene& scene, const FloquetOptions& options,
                           const std::filesystem::path& motion = {});

std::string to_text(const FloquetStudy& study);
std::string to_csv(const FloquetStudy& study);

}  // namespace mbd
