// The equations of motion as a differential-algebraic system F(t, y, ydot) = 0 of index 2, constraints at
// position and velocity level both (Gear, Gupta & Leimkuhler 1985), for integrators of such systems.
//
// y = [ r (3), p (4: w x y z), V (6) of each node but the ground; lambda; mu ]. With p^ = p/|p| and its R,
// q = p* pdot/|p|^2, and N = diag(L^2, L^2, L^2, 1, 1, 1) with the scene's length L, so that units agree,
//   [ R^T rdot ; 2 vec q ] - V - N B^T mu = 0      kinematics: mu is 0 on the solution               (1)
//   (|p|^2 - 1)/2                         = 0      in place of the equation of |p|: no drift          (2)
//   r(H, V, Vdot, lambda, t)              = 0      System::residual                                   (3)
//   gdot(H, V, t) = 0,   g(H, t)          = 0                                                         (4)
// (1) makes dg/dt = gdot + B N B^T mu, so mu = 0 where B has full rank; of redundant constraints some are idle
// (State::idle), their lambda and mu 0.
//
// Newton's matrix dF/dy + c dF/dydot, on body-frame increments dU = [u; psi], dr = R u, dp = p psi/2 + p^ ds,
// with v = R^T rdot, q = (q0, w/2):
//   [ A  -I   0   -N B^T ] dU        A = [ c I  v~ ; 0  (c - q0) I + w~/2 ]
//   [ K   D   B^T   0    ] dV        D = C + c M = dr/dV + c dr/dVdot
//   [ G   B   0     0    ] dlambda   G = dgdot/dU
//   [ B   0   0     0    ] dmu                                                                        (5)
// and ds of its own, but for w ds in the rotational rows of (1). It is solved in dU, dV/c, dlambda/(m c^2) and
// dmu/c with rows divided alike, m the largest entry of M, so that entries keep their size whatever the step.
// Left out: the turning of B^T mu, as mu is 0. R and |p| are those of the last evaluation, not of the matrix:
// in body frames it stays good while the nodes turn.
//
// G from the part of gddot without Vdot, Q(V) = dB[V] V + 2 B_t V + g_tt, which is quadratic in V:
//   dgdot[W] = dB[W] V + B_t W,   Q(V + W) - Q(V - W) = 2 dB[W] V + 2 dB[V] W + 4 B_t W,
//   dB[W] V - dB[V] W = B W~ V,   so   dgdot[W] = (Q(V + W) - Q(V - W))/4 - B V~ W/2,                (6)
// exactly. Nodes that share no constraint are moved together. Without G multipliers do not converge in small
// steps, where they take what remains of gdot for a force m c gdot.
// Not used: the equation of |p| with a term that pulls it to 1, one more constant to choose.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libmbd/core/system.hpp"

namespace mbd {

class StabilizedIndex2 {
 public:
  // Refers to `system`, which must have rates.
  StabilizedIndex2(const System& system, std::unique_ptr<LinearSolver> solver);

  static constexpr Index per_node = 13;
  Index size() const { return size_; }  // of y and of F
  Index first_lambda() const { return per_node * (system_.nodes() - 1); }
  Index first_mu() const { return first_lambda() + system_.multipliers(); }

  // y and ydot of a state with its accelerations; mu, and the rates of multipliers, 0.
  void pack(const State& state, std::span<double> y, std::span<double> ydot) const;
  // Poses (unit quaternions), V, Vdot and lambda of a state of the System; nothing else of it.
  void unpack(std::span<const double> y, std::span<const double> ydot, State& state) const;

  // The accepted state near which evaluations are: its followed angles and load factor.
  void follow(const State& accepted);

  // F by node as (1), (2), (3), then gdot, then g; signals at t, at a jump their limits from the left. False if
  // an element is out of its range.
  bool residual(double t, std::span<const double> y, std::span<const double> ydot,
                std::span<double> F);

  // Assembles (5).
  bool linearize(double t, std::span<const double> y, std::span<const double> ydot, double c);
  FactorStatus factor() { return solver_->factor(); }
  // b := (dF/dy + c dF/dydot)^-1 b, b as F before and as y after, at the y of the last evaluation.
  void solve(std::span<double> b);
  // m, the largest entry of dr/dVdot at the last linearisation.
  double mass() const { return mass_; }

  // Of the last evaluation.
  const State& at() const { return at_; }
  std::string worst_equation() const;
  // Of the last factorisation that failed; may be empty.
  std::string singular_unknown() const;
  // Of y or of F: "beam 'shaft' node 7, moment 2", "revolute 'C', force 1".
  std::string name_of(Index component) const;

 private:
  void set(double t, std::span<const double> y, std::span<const double> ydot);
  BlockGraph lay_out(const BlockGraph& graph);
  void find_joints();
  void color_nodes();
  void add_kinematics(std::span<const Slot> slots) const;
  void set_gradient_of_rates();

  const System& system_;
  std::unique_ptr<LinearSolver> solver_;
  Index nodes_, size_;   // nodes without the ground
  double length_;        // [m] of the scene
  State at_, mu_state_;  // mu_state_: with mu for lambda
  VecX r_, mu_forces_, g_, gdot_, x_;
  std::vector<const Batch*> joints_;  // that have multipliers

  // Blocks of K, B, B^T and of D, by contribution of the System's graph.
  struct Source {
    std::size_t offset = 0;  // in the blocks' values
    int rows = 0, columns = 0;
    int row = -1, column = -1;  // blocks of the System's graph
    enum class Kind : char { ground, node, gradient, forces, own } kind = Kind::ground;
    std::size_t first = 0;  // where they go: places of the solver's graph
  };
  std::vector<Source> sources_;
  std::vector<double> K_, D_;
  std::vector<Slot> K_slots_, D_slots_;
  std::vector<double> G_;         // in the places of B
  std::vector<Index> first_row_;  // by constraint, in lambda
  std::vector<int> color_;        // by node; -1: in no constraint
  int colors_ = 0;
  VecX rates_, more_, less_;

  std::vector<double> norm_;  // by node: |p|
  std::vector<Vec6> rate_;    // by node: v, w
  std::vector<double> q0_;    // by node
  double c_ = 0.0, mass_ = 1.0;
};

}  // namespace mbd
