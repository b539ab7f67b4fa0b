// Resultants of stiff beams as iterates of Newton's method in time, whose tangents are kept over iterations and steps
// (NOTATION.md 5): what a stepper has besides states.
//
// Simplified Newton on the saddle point of Hellinger and Reissner, with a tangent J0 taken at an earlier iterate:
//   r_S(U, S) = B(U)^T S + the rest of r,   E(U) = C S,   C = D^-1;
//   dS = D (E + B0 dU) - S,   [ B0^T D B0 + d(B^T S)/dU|0 + … ] dU = -[ r_S + B0^T (D E - S) ].           (1)
// What is left after an iteration is J0^-1 (J0 - J) of what was before, and J0 - J holds B0 - B and S0 - S, but no D:
// stiffness in tension and shear does not slow it down. With U alone it holds D (B0 - B)^T (B0 - B).
// At S = D E, and where B0 = B, the right side is that of U alone.
//
// An iteration of (1) costs more (38 % of one of a scene of beams alone, models/hard/beck), so it is taken up only by batches of
// which an element is so stiff in tension or shear that U alone may need more of them, (EA, GA) L^2/(EI, GJ) >= stiff, and once
// tangents are taken often: more than a few, and one in several steps. From then on it stays.
#pragma once

#include <span>
#include <vector>

#include "elements/iterated_beams.hpp"
#include "libmbd/core/system.hpp"
#include "solvers/newton/report.hpp"

namespace mbd {

class KeptResultants {
 public:
  static constexpr double stiff = 1e4;
  static constexpr long few_tangents = 10, several_steps = 8;

  // Of batches that are at least as stiff as `from`; nothing is iterated before begin().
  explicit KeptResultants(const System& system, double from = stiff);

  bool begun() const { return begun_; }
  // Whether it should begin now; there is no tangent of its own then.
  bool should_begin(const Counters& counters) const {
    return !begun_ && !parts_.empty() &&
           counters.tangents > few_tangents + counters.substeps / several_steps;
  }
  void begin() { begun_ = true; }

  std::size_t size() const { return begun_ ? numbers_ : 0; }  // of numbers of S
  // What a stepper has to be made for, to go on from what another has saved.
  double signature() const { return static_cast<double>(numbers_); }
  void archive(auto& a) { a(begun_); }

  struct Iterate {
    std::vector<double> S;     // in order of batches, as these have it [N, N.m]
    std::vector<double> DE{};  // set by residual() and keep_tangent()
  };

  void set(const State& state, std::vector<double>& S) const;  // D E
  // System::residual of the iterate; sets its D E.
  bool residual(const State& state, Iterate& at, VecX& r);
  // Makes of a tangent of `state` that has been added to the slots, U times dr/dU, that of S, and keeps its gradients: the
  // residual of the iterate is that of D E there. Sets its D E.
  void keep_tangent(const State& state, double U, Iterate& at, std::span<const Slot> slots);
  // After one of these: S of the next iterate, which dU leads to (increments of all nodes but the ground, 6 each).
  void advance(const VecX& dU, Iterate& at) const;

 private:
  struct Part {
    std::size_t batch;  // of the system
    const IteratedBeams* beams;
    std::size_t first, size, first_kept, kept;
    std::span<double> of(std::vector<double>& all) const {
      return std::span(all).subspan(first, size);
    }
    std::span<const double> kept_of(std::span<const double> all) const {
      return all.subspan(first_kept, kept);
    }
  };

  bool is_finite_feedback(const State& state);

  const System& system_;
  std::vector<Part> parts_;
  std::size_t numbers_ = 0, kept_ = 0;
  bool begun_ = false;
  std::vector<double> tangent_;  // B0, as T^-1 of pairs
  std::vector<SignalValue> signals_;
};

}  // namespace mbd
