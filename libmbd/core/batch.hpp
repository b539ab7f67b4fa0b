// A batch: contiguous elements or joints of one type, behind one virtual call per evaluation.
// Rows of the residual: 6 per node (node 0, the ground, first: what lands there is the reaction of the
// ground and is not solved for), then the multipliers.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/core/law.hpp"
#include "libmbd/core/linear_solver.hpp"
#include "libmbd/core/state.hpp"
#include "libmbd/core/types.hpp"

namespace mbd {

// What the tangent multiplies: S = U dr/dU + (V dr/dV + A dr/dVdot) T^-1(Q) in the dynamic rows, with
// dU the body-frame increments of the nodes. Constraint rows and columns are not weighted, so U is also
// the scale of the multipliers (NOTATION.md 4). Statics: {1, 0, 0}.
struct TangentWeights {
  double U = 1.0;
  double V = 0.0;
  double A = 0.0;
  std::span<const Mat6> T_inv = {};  // by node; empty for the identity

  // D T^-1 of the node: D by velocities or accelerations, weighted already.
  Mat6 at_node(const Mat6& D, std::size_t node) const {
    return T_inv.empty() ? D : Mat6(D * T_inv[node]);
  }
};

struct Energies {
  double kinetic = 0.0;    // [J]
  double strain = 0.0;     // [J]
  double potential = 0.0;  // of gravity, zero at the inertial origin [J]
  double total() const { return kinetic + strain + potential; }
};

// A law of an element ("spring 'k'"), and the x where it is evaluated.
struct LawArgument {
  const std::string* element;
  const Law* law;
  double x;
  ArgumentOf of;
};

// An element with a law that has kinks, and the one nearest to where the law is evaluated.
struct NearKink {
  std::string element;  // "spring 'k'"
  double x = 0.0;       // argument of the law
  Kink kink;
  ArgumentOf of = ArgumentOf::length;
};

class Batch {
 public:
  virtual ~Batch() = default;

  virtual std::string_view type() const = 0;  // e.g. "beam elastic, geodesic, energy form, N = 3"
  virtual Index size() const = 0;             // number of elements or joints
  virtual std::size_t bytes() const = 0;      // of data, indices and slots

  // Holds nodes together as one deformable body: elements of structures, and damping within such.
  virtual bool is_structure() const { return false; }

  // Appends this batch's contributions to the graph; they keep the place they get there.
  virtual void connect(BlockGraph& graph) = 0;

  // Adds internal minus external forces to the dynamic rows of r and sets the batch's constraint rows.
  // False if an element is outside the range in which its formulation holds (out_of_range names it).
  virtual bool residual(const State& state, VecX& r) const = 0;

  // The same residual, to the last bit, and its tangent.
  virtual bool linearize(const State& state, const TangentWeights& weights, VecX& r,
                         std::span<const Slot> slots) const = 0;

  // --- resultants as iterates of Newton's method (NOTATION.md 5): of elements that are stiff in some strains ---
  // How many there are, one at each quadrature point of each element; 0: none is one.
  virtual Index resultant_count() const { return 0; }
  // S = D (E + B dU), the resultants of the strains linearised at a state, in order of elements and points,
  // [N; N.m] in section frames. dU: increments of all nodes but the ground, 6 each; empty: S = D E.
  virtual void linearized_resultants(const State& /*state*/, std::span<const double> /*dU*/,
                                     std::span<Vec6> /*S*/) const {}
  // linearize() with U = 1 and no rates, its residual to the last bit, where the geometric stiffness is that of
  // the resultants given: K = B^T D B + d(B^T S)/dU.
  virtual bool linearize_mixed(const State& state, std::span<const Vec6> /*S*/, VecX& r,
                               std::span<const Slot> slots) const {
    return linearize(state, {}, r, slots);
  }

  // Adds (V dr/dV + A dr/dVdot) T_inv to the tangent and nothing else; `weights.U` is not used.
  virtual void add_rate_tangent(const State& /*state*/, const TangentWeights& /*weights*/,
                                std::span<const Slot> /*slots*/) const {}

  // The residual, and the powers of x in the tangent of a method whose velocities and accelerations change by
  // (x + V_hat) dU and x (x + V_hat) dU:
  //   P[0] += dr/dU + dr/dV V_hat,   P[1] += dr/dV + dr/dVdot V_hat,   P[2] += dr/dVdot,
  // in one pass. V_hat by node.
  virtual bool linearize_powers(const State& state, std::span<const Mat6> /*V_hat*/, VecX& r,
                                const std::array<std::span<const Slot>, 3>& P) const {
    return linearize(state, {}, r, P[0]);
  }

  // Adds dr/d(load factor) at fixed motion and multipliers: what loads and prescribed motions contribute.
  virtual void load_rate(const State& /*state*/, VecX& /*r*/) const {}

  // The first element out of range, or an empty string.
  virtual std::string out_of_range(const State& /*state*/) const { return {}; }

  // Appends all laws of x and v; their order stays.
  virtual void law_arguments(const State& /*state*/, std::vector<LawArgument>& /*all*/) const {}

  // Constraint rows at position and velocity level: g [m, rad] and gdot = B V + g_t.
  virtual void constraints(const State& /*state*/, VecX& /*g*/, VecX& /*gdot*/) const {}

  // Constraint rows at velocity level, gdot = B V + g_t, and the part of gddot without Vdot,
  // (d/dt B) V + (d/dt) g_t. Only joints have them.
  virtual void constraint_rates(const State& /*state*/, VecX& /*gdot*/,
                                VecX& /*gddot_rest*/) const {}

  // Sets the followed angles to the present ones, less than half a turn away: on accepted states only.
  virtual void follow_angles(State& /*state*/) const {}

  virtual Energies energies(const State& /*state*/) const { return {}; }

  // Power of the external loads on the bodies [W], gravity excepted; 0 for a state without rates.
  virtual double load_power(const State& /*state*/) const { return 0.0; }

  // Power that drives and prescribed motions give to the mechanism [W].
  virtual double drive_power(const State& /*state*/) const { return 0.0; }

  // Power of forces that depend on rates, on the bodies [W]: negative where they take energy out.
  virtual double damping_power(const State& /*state*/) const { return 0.0; }

  // Adds to each node's p the momentum M V of what moves with it, node frame [N.s, N.m.s].
  virtual void add_momenta(const State& /*state*/, std::span<Vec6> /*p*/) const {}
};

}  // namespace mbd
