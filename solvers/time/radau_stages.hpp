// How many stages adaptive steps of Radau take: those that come farthest for their work.
//
// Work is counted, not timed, so that runs are the same everywhere: of a step, per equation,
//   s (iterations + 1) + 12 tangents + 3 s factorisations,
// about what these take of CPU time in scenes of beams and of bodies. A few steps with other stages are tried, the first of
// them left out while their size settles; those are kept if they come farther by a tenth. After a trial that was in vain
// the next waits twice as long, and tries the other way. A step whose iterations fail (at a singular position, a kink) is
// tried again with the fewest, as are some after it: attempts that fail cost least so. Their time and work count for those
// before, to which it goes back.
// Not used: the contraction of Newton's iterations (RADAU of Hairer and Wanner, 1999), which tells when more stages cost no
// more iterations, but not whether their steps are longer.
#pragma once

#include <array>
#include <cstddef>

namespace mbd {

class RadauStages {
 public:
  // Trials come sooner where the relative tolerance is tight.
  explicit RadauStages(double tolerance);

  std::size_t stages() const { return ladder[at_]; }
  // A step to begin with, after a change [s].
  double step() const { return step_; }
  // After an accepted step of h [s], with all the work since the one before. Whether stages() is another than before.
  bool accepted(double h, double work);
  // After a step whose iterations failed. Whether stages() is another than before.
  bool failed();

  static double work(std::size_t stages, long iterations, long tangents, long factorizations) {
    const auto s = static_cast<double>(stages);
    return s * static_cast<double>(iterations + 1) + 12.0 * static_cast<double>(tangents) +
           3.0 * s * static_cast<double>(factorizations);
  }

  void archive(auto& a) {
    a(at_, from_, home_, trying_, up_, steps_, away_, wait_, pause_, time_, work_, rate_, step_,
      last_step_);
  }

 private:
  static constexpr std::array<std::size_t, 3> ladder = {3, 5, 7};
  bool judge();
  bool try_others();
  void begin_window();

  std::size_t at_ = 0, from_ = 0,
              home_ = 0;  // places on the ladder: now, before a trial, before a failure
  bool trying_ = false, up_ = true;
  int steps_ = 0;                   // of the window
  int away_ = 0;                    // steps with the fewest stages until it goes back to home_
  int wait_, pause_;                // windows until the next trial, and after one in vain
  double time_ = 0.0, work_ = 0.0;  // of the window
  double rate_ = 0.0;               // [s] for a unit of work, of the window before
  double step_ = 0.0;
  std::array<double, ladder.size()> last_step_{};  // with these stages
};

}  // namespace mbd
