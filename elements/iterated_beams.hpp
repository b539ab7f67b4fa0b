// Resultants of a batch of beams as iterates of Newton's method in time, with a tangent that is kept (NOTATION.md 5;
// solvers/newton/kept_resultants.hpp): what the elastic terms can do besides BeamElasticBatch.
//
// Numbers are kept by the stepper, in an order of the batch's own: of an iterate S and D E at the quadrature points of all
// elements [N, N.m], section frames; of a tangent T0, the T^-1 of its pairs.
#pragma once

#include <cstddef>
#include <span>

#include "libmbd/core/linear_solver.hpp"
#include "libmbd/core/state.hpp"

namespace mbd {

class IteratedBeams {
 public:
  virtual ~IteratedBeams() = default;

  // The largest of (EA, GA) L^2/(EI, GJ) of the elements, L their lengths.
  virtual double slenderness() const = 0;
  // How many numbers make S, as many D E, and T0.
  struct Sizes {
    std::size_t resultants, tangent;
  };
  virtual Sizes sizes() const = 0;

  // As Batch::residual, of the iterates S: B^T S + B0^T (D E - S). Sets D E.
  virtual bool residual_kept(const State& state, std::span<const double> T0,
                             std::span<const double> S, std::span<double> DE, VecX& r) const = 0;
  // Sets T0, unless it is empty, and D E.
  virtual void keep(const State& state, std::span<double> T0, std::span<double> DE) const = 0;
  // Adds U d(B^T S)/dU of the resultants S - D E to the slots of the batch.
  virtual void add_geometric_stiffness(const State& state, double U, std::span<const double> S,
                                       std::span<const double> DE,
                                       std::span<const Slot> slots) const = 0;
  // S = D E + D B0 dU; dU as of Batch::linearized_resultants.
  virtual void advance(std::span<const double> T0, std::span<const double> dU,
                       std::span<const double> DE, std::span<double> S) const = 0;
};

}  // namespace mbd
