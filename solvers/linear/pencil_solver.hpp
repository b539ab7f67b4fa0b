// The linear systems of an implicit Runge-Kutta step: with P0, P1, P2 assembled over one graph of blocks,
//   E(x) = [ s (P0 + x P1 + x^2 P2)_nodes , P0 elsewhere ]
// for one real and one complex x. Blocks of multipliers (constraint gradients) are taken from P0 as they are.
#pragma once

#include <complex>
#include <memory>
#include <span>

#include "libmbd/core/linear_solver.hpp"

namespace mbd {

class PencilSolver {
 public:
  virtual ~PencilSolver() = default;

  // Symbolic analysis, once. Slots stay valid until the next call.
  virtual void analyze(const BlockGraph& graph) = 0;

  // Where P_power (0, 1, 2) is added: one slot for each contribution, in order.
  virtual std::span<const Slot> slots(int power) const = 0;
  virtual void set_zero() = 0;  // all three

  // y += P_power x.
  virtual void multiply(int power, std::span<const double> x, std::span<double> y) const = 0;

  // Factorises E(x) and E(z) with the scale s. On `singular`, singular_row() names the unknown with the worst
  // pivot, or is -1.
  virtual FactorStatus factor(double s, double x, std::complex<double> z) = 0;
  virtual Index singular_row() const = 0;

  // b := E(x)^-1 b, b := E(z)^-1 b. NaN if the last factorisation was not ok.
  virtual void solve(std::span<double> b) const = 0;
  virtual void solve(std::span<std::complex<double>> b) const = 0;

  // Estimate of 1/(|E(x)| |E(x)^-1|) for the real x.
  virtual double reciprocal_condition() const = 0;

  virtual LinearFacts facts() const { return {}; }
};

std::unique_ptr<PencilSolver> make_klu_pencil_solver();

}  // namespace mbd
