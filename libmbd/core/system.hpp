// A compiled mechanism: nodes, multipliers, signals and batches. Const once built; State is what varies.
//
//   residual:  r(U, V, Vdot, lambda, t) = [ F_internal + F_inertia - F_external + B^T lambda ; g ]
//   tangent:   S = [ K + D T^-1, B^T ; B, 0 ]   weighted as TangentWeights says
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libmbd/core/batch.hpp"
#include "libmbd/core/linear_solver.hpp"
#include "libmbd/core/state.hpp"

namespace mbd {

// Multipliers of one joint, or of strains of a beam at a point (held_strains.hpp); for messages and output.
struct ConstraintInfo {
  std::string name;     // "revolute 'C'"
  Index first_row = 0;  // in State::lambda
  Index rows = 0;
  std::vector<std::string> row_names;  // "force 1", …
  std::vector<bool> is_position;       // a gap [m] and a force [N]; otherwise an angle and a moment
  bool of_strains = false, gives = false;  // within a beam; with a compliance, it ties nothing
};

// A drive moves something: its second derivative is an acceleration. A load is a force.
enum class SignalUse { drive, load };

// A time at which a signal or one of its derivatives jumps.
struct Breakpoint {
  double t = 0.0;        // [s]
  bool restart = false;  // accelerations and multipliers jump: an integrator starts afresh
  bool smooth = false;   // none of its first two derivatives jumps: of steps that fit an error
};

// A number of the motion that laws of loads and controllers know.
class Sensor {
 public:
  virtual ~Sensor() = default;

  // In SI units. Of a state without rates, rates are 0.
  virtual double value(const State& state) const = 0;

  // The nodes on whose motion it depends, without the ground, and its derivatives by increments dU, at fixed velocities, and by
  // velocities V of each: body axes, in the order of nodes(). Of sensors that controllers alone read there are none.
  virtual std::vector<int> nodes() const { return {}; }
  virtual void derive(const State& /*state*/, std::span<Vec6> /*by_motion*/,
                      std::span<Vec6> /*by_velocity*/) const {}
};

// What is evaluated at the instants k period, k = 0, 1, 2, …, and holds what it gives until the next.
class Controller {
 public:
  virtual ~Controller() = default;
  virtual std::string name() const = 0;
  virtual double period() const = 0;                // [s]
  virtual std::vector<double> initial() const = 0;  // of its own states
  // At state.t, the accepted state before its outputs change: sets inputs of the model and its own states. Empty, or what is
  // wrong: an output that is not finite.
  virtual std::string sample(const State& state, std::span<double> own,
                             std::vector<InputValue>& inputs) const = 0;
  // Of all that sample() depends on besides its arguments: what a checkpoint of another model is told by.
  virtual std::uint64_t signature() const { return 0; }
};

class System {
 public:
  // --- building (by compile) ---
  System();                                                    // with the ground as node 0
  Index add_node(std::string name, const Pose<double>& pose);  // returns its index
  Index add_constraint(ConstraintInfo info);                   // returns its first multiplier
  // Returns its index in State::signals. `use` says which of its jumps make the accelerations jump, `name` what
  // messages call it: `rod.xml:12: load "push": force 2 "1/t"`.
  Index add_signal(Signal signal, SignalUse use = SignalUse::drive, std::string name = {});
  // Returns its index in State::inputs.
  Index add_input(InputInfo input);
  Index add_sensor(std::unique_ptr<Sensor> sensor);  // returns its place
  // The law of that signal, of a load, has sensors: those at these places, in the order of Expression::sensors(). Its loads must
  // be linear in it.
  void feed_back(Index signal, std::vector<std::size_t> sensors);
  void add_controller(std::unique_ptr<Controller> controller);
  Index add_angle();  // one more followed angle; returns its index
  void add_batch(std::unique_ptr<Batch> batch);
  void finish(bool with_rates, double length_scale);  // after the last add
  // Makes room for State::idle in the graph: diagonal blocks of the multipliers. After finish().
  void allow_idle_rows();
  // Of a scene whose constraints may repeat each other; otherwise it is length_scale().
  void set_reaction_length(double length) { reaction_length_ = length; }

  // --- sizes ---
  Index nodes() const { return static_cast<Index>(node_names_.size()); }  // with the ground
  Index multipliers() const { return multipliers_; }
  Index rows() const { return 6 * nodes() + multipliers_; }  // of a residual, ground first
  Index unknowns() const { return rows() - 6; }
  bool with_rates() const { return with_rates_; }
  double length_scale() const { return length_scale_; }  // [m] size of the scene, along its axes
  // [m] its largest distance, which turning it does not change: what moments are compared with forces by where that
  // decides a result (solvers/constraints/redundancy.hpp).
  double reaction_length() const {
    return reaction_length_ > 0.0 ? reaction_length_ : length_scale_;
  }
  const BlockGraph& graph() const { return graph_; }
  bool idle_rows_allowed() const { return !touching_.empty(); }
  // Of each batch, the first of its contributions in graph(), and the end of the last batch's.
  std::span<const std::size_t> first_contributions() const { return first_contributions_; }
  const std::vector<std::unique_ptr<Batch>>& batches() const { return batches_; }
  const std::vector<ConstraintInfo>& constraints() const { return constraints_; }
  const std::vector<Signal>& signals() const { return signals_; }
  SignalUse signal_use(std::size_t i) const { return signal_uses_[i]; }
  const std::string& signal_name(std::size_t i) const { return signal_names_[i]; }
  const std::vector<InputInfo>& inputs() const { return inputs_; }
  const std::vector<std::unique_ptr<Sensor>>& sensors() const { return sensors_; }
  const std::vector<std::unique_ptr<Controller>>& controllers() const { return controllers_; }
  bool feeds_back() const { return !feedback_.empty(); }
  const std::vector<Breakpoint>& breakpoints() const { return breakpoints_; }  // t rising, distinct

  // --- evaluation ---
  State reference_state()
      const;  // all at rest in the reference configuration, inputs at their initial values
  std::vector<InputValue> initial_inputs() const;
  // t and the signals at t; at a jump, their limits from `side`.
  void set_time(State& state, double t, Side side = Side::right) const;
  // The signals alone, of other inputs. Those whose laws have sensors are 0, but at the motion of a state if it is given, with
  // derivatives at held sensors.
  void signals_at(double t, Side side, std::span<const InputValue> inputs,
                  std::vector<SignalValue>& signals, const State* motion = nullptr) const;
  // The state with the signals that laws with sensors give at its motion, added to what is there; the state itself if there are
  // none. For those who evaluate batches by themselves; valid until the next call in this thread.
  const State& fed_back(const State& state) const;
  // The next instant of a controller after state.t [s], infinity if there is none; `slack` is the round-off of times.
  double next_instant(const State& state, double slack) const;
  // Runs the controllers, in their order, of which one has an instant at state.t. Returns whether there is one; `failure` is what
  // went wrong.
  bool sample(State& state, double slack, std::string& failure) const;
  // The first signal of the state that cannot be used, with its value, its time and what to do: a load that is not
  // finite, or a drive that is not, or with rates its first derivative; the second counts where `accelerations`
  // follow from it. Empty if there is none.
  std::string unusable_signal(const State& state, bool accelerations = false) const;
  // Both return false if an element is outside the range of its formulation; out_of_range() names it.
  // Idle rows of the state are 0 in residuals, gaps and rates; in the tangent -1 on the diagonal, else 0.
  bool residual(const State& state, VecX& r) const;
  bool linearize(const State& state, const TangentWeights& weights, VecX& r, LinearSolver& S) const;
  bool linearize(const State& state, const TangentWeights& weights, VecX& r,
                 std::span<const Slot> slots) const;  // adds to what the slots hold
  // The same, and the powers of the tangent (Batch::linearize_powers), added to what P[k] hold; constraints in P[0].
  bool linearize_powers(const State& state, std::span<const Mat6> V_hat, VecX& r,
                        const std::array<std::span<const Slot>, 3>& P) const;
  // Resultants as iterates (Batch::linearized_resultants): their number; S = D (E + B dU), dU an increment of the
  // unknowns or empty; and the tangent of statics with the geometric stiffness of S (empty: of D E).
  Index resultant_count() const;
  void linearized_resultants(const State& state, const VecX& dU, std::vector<Vec6>& S) const;
  bool linearize_mixed(const State& state, std::span<const Vec6> S, VecX& r,
                       LinearSolver& solver) const;
  // (V dr/dV + A dr/dVdot) T_inv alone, added to what the slots hold: no stiffness, no constraints.
  void add_rate_tangent(const State& state, const TangentWeights& weights,
                        std::span<const Slot> slots) const;
  // dr/d(load factor): the loads, with the sign of the residual, and how constraints move with
  // prescribed motions.
  void load_rate(const State& state, VecX& r) const;
  std::string out_of_range(const State& state) const;
  void law_arguments(const State& state, std::vector<LawArgument>& all) const;
  std::vector<NearKink> near_kinks(const State& state) const;  // of those of them that have kinks
  // Each law of sensors, by the name of what acts, and what they read at a state.
  void each_law_of_sensors(const State& state,
                           const std::function<void(const std::string&, const Expression&,
                                                    std::span<const double>)>& look) const;
  // All of size multipliers().
  void constraints(const State& state, VecX& g, VecX& gdot) const;
  void constraint_rates(const State& state, VecX& gdot, VecX& gddot_rest) const;
  void follow_angles(State& state) const;  // on accepted states only
  Energies energies(const State& state) const;
  Work power(const State& state) const;  // of loads, drives and damping [W]
  // Momentum of what moves with each node, node frame; `p` has one entry a node [N.s, N.m.s].
  void momenta(const State& state, std::span<Vec6> p) const;
  // Linear momentum, and angular momentum about the inertial origin, inertial axes [N.s, N.m.s].
  Vec6 momentum(const State& state) const;

  // Row of a residual in words: "beam 'shaft' node 7, moment 2", "revolute 'C', force 1".
  std::string name_of(Index row) const;
  const Pose<double>& reference_pose(Index node) const {
    return reference_[static_cast<std::size_t>(node)];
  }
  const std::string& node_name(Index node) const {
    return node_names_[static_cast<std::size_t>(node)];
  }

 private:
  // A signal whose law has sensors. The load acts as p(U) f, p = dr/df, and the law adds p (df/dU, df/dV) to the tangent, by
  // blocks of the nodes where the load acts and those that the sensors look at.
  struct Feedback {
    std::size_t signal;
    std::vector<std::size_t> sensors;
    const Expression* law = nullptr;
    std::vector<const Batch*> loads{};  // that it acts by
    std::vector<int> acts_on{}, looks_at{};
    std::size_t first_slot = 0;
  };
  void connect_feedback();
  void read(const Feedback& f, const State& state, std::vector<double>& readings) const;
  double value_of(const Feedback& f, const State& state, std::vector<double>& readings) const;
  // Calls look(K, C, node of the column, number of the slot), K = dr/dU and C = dr/dV; `state` is fed back.
  template <class F>
  void each_feedback_block(const State& state, const F& look) const;
  void add_feedback(const State& state, const TangentWeights& weights, double U,
                    std::span<const Slot> slots) const;
  bool feedback_finite(const State& state) const;
  void force_per_signal(const Feedback& f, const State& state, VecX& p) const;

  void clear_idle(const State& state, VecX& multipliers, Index first) const;
  void leave_out_idle(const State& state, VecX& r, std::span<const Slot> slots) const;

  // A contribution in the rows or in the columns of a constraint.
  struct Touching {
    std::size_t contribution;
    bool in_rows;
  };
  std::vector<std::vector<Touching>> touching_;  // by constraint, where idle rows are allowed
  std::size_t first_own_ = 0;                    // of their diagonal blocks, in graph_

  std::vector<std::string> node_names_;
  std::vector<Pose<double>> reference_;
  std::vector<ConstraintInfo> constraints_;
  std::vector<Signal> signals_;
  std::vector<std::unique_ptr<Batch>> batches_;
  BlockGraph graph_;
  std::vector<std::size_t> first_contributions_;
  std::vector<SignalUse> signal_uses_;
  std::vector<std::string> signal_names_;
  std::vector<InputInfo> inputs_;
  std::vector<std::unique_ptr<Sensor>> sensors_;
  std::vector<Feedback> feedback_;
  std::vector<std::unique_ptr<Controller>> controllers_;
  std::vector<Breakpoint> breakpoints_;
  Index multipliers_ = 0;
  Index angles_ = 0;
  bool with_rates_ = true;
  double length_scale_ = 1.0;
  double reaction_length_ = 0.0;
};

}  // namespace mbd
