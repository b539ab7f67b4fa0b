// Stability of an equilibrium, and the way in which it is lost.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libmbd/core/system.hpp"
#include "libmbd/core/types.hpp"
#include "solvers/linear/inertia_solver.hpp"

namespace mbd {

// Weights of the measure of motions, by unknown: |x|^2 = mean over the nodes of |u|^2/L^2 + |psi|^2, L the
// scene's length; multipliers do not count.
VecX motion_weights(const System& system);

// Motions that constraints leave and nothing answers: x with B x = 0 and K x = 0, such as the spin of a pendulum on a ball
// joint about the vertical. Shapes as columns, orthonormal in motion_weights, multipliers zero.
//
// Found by inverse iteration of [K + s W, B^T; B, 0], s W a spring on every node, s of `neutral_share` of the largest
// stiffness: an eigenvalue of K below that is zero but for round-off, unless the motion strains a beam, which may be so
// slender that its bending is as soft, or near to buckling. Of those that do, what leads from an equilibrium along equilibria is
// neutral: the spin of a bent beam whose section is as stiff in all directions.
struct NeutralMotions {
  Eigen::MatrixXd shapes;
  Index count() const { return shapes.cols(); }
  // Takes its part in the span of the shapes out of an increment of the unknowns, which is then the least.
  void take_out(const VecX& weights, Eigen::Ref<VecX> x) const;
};

// Coordinates of which a spring on each takes neutral motions away and nothing else: as K x = 0 of a neutral motion, in a basis
// of it and of motions that leave its coordinate alone the spring has a place of its own. So any stiffness will do: equilibria
// are the same, and the number of negative eigenvalues of all other motions.
struct Holds {
  std::vector<Index> rows;  // of the unknowns
};
// Where they move most.
Holds holds_of(const VecX& weights, const NeutralMotions& neutral);
// As stiff as what is there, on the matrix that has been added to slots.
void add_holds(const System& system, std::span<const Slot> slots, const Holds& holds);

// Counts the ways in which potential energy falls from an equilibrium: negative eigenvalues of the symmetric
// tangent [K B^T; B 0], less one for each constraint (each brings one of either sign where the constraints
// are independent). 0: stable. Holds where the forces have a potential (conservative loads, energy form): the
// tangent is symmetric at equilibrium then.
class StabilityCount {
 public:
  explicit StabilityCount(const System& system);
  // In the room of `solver`, which has been analysed for the system, where that can be: each count then leaves nothing of
  // what was added to it and factored.
  StabilityCount(const System& system, LinearSolver& solver);

  // Empty within round-off of a singular tangent. What `holds` hold is not counted.
  // `resultants`: those found with it by mixed Newton (equilibrium.hpp), which are known better than D E where D is
  // large; empty: D E.
  std::optional<Index> operator()(const State& equilibrium, const Holds& holds = {},
                                  std::span<const Vec6> resultants = {});

  // max |S_ij - S_ji| / max |S_ij| at the last one: round-off where there is a potential.
  double asymmetry() const { return solver_->asymmetry(); }

 private:
  const System& system_;
  std::unique_ptr<InertiaSolver> solver_;
  VecX r_;
};

// The eigenpair S x = tau W x, W of motion_weights, with tau nearest to zero: tau vanishes at limit and
// bifurcation points. x^T W x = 1. By inverse iteration.
struct CriticalMode {
  double eigenvalue = 0.0;  // [N.m], energy: twice that of a unit motion
  VecX shape;               // increment of the unknowns
};

// `solver` has been analysed for the system; it is used for the tangent at `state`. `guess` of the shape may
// be empty; `resultants` and `holds` as above. Empty if the tangent cannot be factored.
std::optional<CriticalMode> critical_mode(const System& system, LinearSolver& solver,
                                          const State& state, const VecX& guess = {},
                                          std::span<const Vec6> resultants = {},
                                          const Holds& holds = {});

inline constexpr double neutral_share = 1e-12;
// A largest stiffness [N/m] that is round-off of multipliers: nothing is stiff.
inline bool is_nothing(double stiffness) { return stiffness < 1e-13; }

// Whether the beams that hang together move otherwise than as one rigid body in an increment of the unknowns: however soft
// they are beside their stretching, they answer then.
bool strains_beams(const System& system, const State& state, const VecX& x);

// Leaves in `solver`, which has been analysed for the system, the factors of that matrix. Empty if there are no neutral
// motions, or more than can be told.
// `resultants` as above.
NeutralMotions find_neutral_motions(const System& system, LinearSolver& solver, const State& state,
                                    std::span<const Vec6> resultants = {});

// Whether equilibria lead on along each of them, as of what is free to spin: a flat linkage's second motion to the first order leads
// nowhere. `solver` has the factors that find_neutral_motions leaves at the state.
bool lead_along_equilibria(const System& system, const LinearSolver& solver, const State& state,
                           const NeutralMotions& neutral);

// Whether what grows with the load factor does work on one of them.
bool drives(const System& system, const State& state, const NeutralMotions& neutral);

// The largest motion of an increment in words: "beam 'arch' node 19 moves along its axis 2".
std::string name_of_motion(const System& system, const VecX& shape);

}  // namespace mbd
