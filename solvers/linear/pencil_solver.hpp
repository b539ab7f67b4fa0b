// The linear systems of an implicit Runge-Kutta step: with P0, P1, P2 assembled over one graph of blocks,
//   E(x) = [ s (P0 + x P1 + x^2 P2)_nodes , P0 elsewhere ]
// for one real x and some complex ones. Blocks of multipliers (constraint gradients) are taken from P0 as they are.
#pragma once

#include <algorithm>
#include <complex>
#include <limits>
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

  // The next factorisations choose their pivots anew, where they are kept: for an x of another size, and after one at which
  // E(x) was nearly singular, whose pivots may let all others grow.
  virtual void forget_pivots() {}

  // y += P_power x.
  virtual void multiply(int power, std::span<const double> x, std::span<double> y) const = 0;

  // Factorises E(x) and E(z) for each of z, at least one, with the scale s. On `singular`, singular_row() names the unknown
  // with the worst pivot, or is -1.
  virtual FactorStatus factor(double s, double x, std::span<const std::complex<double>> z) = 0;
  FactorStatus factor(double s, double x, std::complex<double> z) {
    return factor(s, x, std::span<const std::complex<double>>(&z, 1));
  }
  // One of the two, where the other is not needed: it may be lost.
  virtual FactorStatus factor_real(double s, double x) { return factor(s, x, x); }
  virtual FactorStatus factor_complex(double s, std::complex<double> z) {
    return factor(s, z.real(), z);
  }
  virtual Index singular_row() const = 0;

  // b := E(x)^-1 b, b := E(z[which])^-1 b. NaN if the last factorisation was not ok.
  virtual void solve(std::span<double> b) const = 0;
  virtual void solve(std::span<std::complex<double>> b, std::size_t which = 0) const = 0;
  // Those of several, one after the other in B; of the first z.
  virtual void solve_columns(std::span<double> B, Index columns) const { each(B, columns); }
  virtual void solve_columns(std::span<std::complex<double>> B, Index columns) const {
    each(B, columns);
  }
  // b := E(z)^-T b. NaN where the solver has none: that of KLU has.
  virtual void solve_transposed(std::span<std::complex<double>> b) const {
    std::ranges::fill(b, std::numeric_limits<double>::quiet_NaN());
  }

  // Estimate of 1/(|E(x)| |E(x)^-1|) for the real x.
  virtual double reciprocal_condition() const = 0;

  virtual LinearFacts facts() const { return {}; }

 private:
  template <class T>
  void each(std::span<T> B, Index columns) const {
    for (Index i = 0; i < columns; ++i) {
      const std::size_t n = B.size() / static_cast<std::size_t>(columns);
      solve(B.subspan(static_cast<std::size_t>(i) * n, n));
    }
  }
};

std::unique_ptr<PencilSolver> make_klu_pencil_solver();

}  // namespace mbd
