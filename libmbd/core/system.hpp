// A compiled mechanism: nodes, multipliers, signals and batches. Const once built; State is what varies.
//
//   residual:  r(U, V, Vdot, lambda, t) = [ F_internal + F_inertia - F_external + B^T lambda ; g ]
//   tangent:   S = [ K + D T^-1, B^T ; B, 0 ]   weighted as TangentWeights says
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libmbd/core/batch.hpp"
#include "libmbd/core/linear_solver.hpp"
#include "libmbd/core/state.hpp"

namespace mbd {

// Multipliers of one joint, for messages and output.
struct ConstraintInfo {
  std::string name;     // "revolute 'C'"
  Index first_row = 0;  // in State::lambda
  Index rows = 0;
  std::vector<std::string> row_names;  // "force 1", …
  std::vector<bool> is_position;       // a gap [m] and a force [N]; otherwise an angle and a moment
};

class System {
 public:
  // --- building (by compile) ---
  System();                                                    // with the ground as node 0
  Index add_node(std::string name, const Pose<double>& pose);  // returns its index
  Index add_constraint(ConstraintInfo info);                   // returns its first multiplier
  Index add_signal(Signal signal);  // returns its index in State::signals
  Index add_angle();                // one more followed angle; returns its index
  void add_batch(std::unique_ptr<Batch> batch);
  void finish(bool with_rates, double length_scale);  // after the last add

  // --- sizes ---
  Index nodes() const { return static_cast<Index>(node_names_.size()); }  // with the ground
  Index multipliers() const { return multipliers_; }
  Index rows() const { return 6 * nodes() + multipliers_; }  // of a residual, ground first
  Index unknowns() const { return rows() - 6; }
  bool with_rates() const { return with_rates_; }
  double length_scale() const { return length_scale_; }  // [m] size of the scene
  const BlockGraph& graph() const { return graph_; }
  const std::vector<std::unique_ptr<Batch>>& batches() const { return batches_; }
  const std::vector<ConstraintInfo>& constraints() const { return constraints_; }
  const std::vector<Signal>& signals() const { return signals_; }
  // Times at which a signal or its first two derivatives jump, rising [s].
  const std::vector<double>& jump_times() const { return jump_times_; }

  // --- evaluation ---
  State reference_state() const;  // all at rest in the reference configuration
  // t and the signals at t; at a jump, their limits from `side`.
  void set_time(State& state, double t, Side side = Side::right) const;
  // Both return false if an element is outside the range of its formulation; out_of_range() names it.
  bool residual(const State& state, VecX& r) const;
  bool linearize(const State& state, const TangentWeights& weights, VecX& r, LinearSolver& S) const;
  std::string out_of_range(const State& state) const;
  void constraint_rates(const State& state, VecX& gdot,
                        VecX& gddot_rest) const;  // size multipliers()
  void follow_angles(State& state) const;         // on accepted states only
  Energies energies(const State& state) const;
  double drive_power(const State& state) const;  // delivered to the mechanism [W]

  // Row of a residual in words: "beam 'shaft' node 7, moment 2", "revolute 'C', force 1".
  std::string name_of(Index row) const;
  const Pose<double>& reference_pose(Index node) const {
    return reference_[static_cast<std::size_t>(node)];
  }
  const std::string& node_name(Index node) const {
    return node_names_[static_cast<std::size_t>(node)];
  }

 private:
  std::vector<std::string> node_names_;
  std::vector<Pose<double>> reference_;
  std::vector<ConstraintInfo> constraints_;
  std::vector<Signal> signals_;
  std::vector<std::unique_ptr<Batch>> batches_;
  BlockGraph graph_;
  std::vector<double> jump_times_;
  Index multipliers_ = 0;
  Index angles_ = 0;
  bool with_rates_ = true;
  double length_scale_ = 1.0;
};

}  // namespace mbd
