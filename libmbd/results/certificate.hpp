// What a run says for its own correctness: checks, each a number beside its bounds, and the worst of their verdicts.
//
// Of every run: balance of energy, constraints at two levels, how Newton's iterations contracted, round-off; momenta
// against the impulse of all that acts from outside; what the mesh of flexible beams leaves out of their deformation
// (elements/beam/mesh_error.hpp); and the error that steps make, by a second run (time_error.hpp). Of
// a run that is to be certified (RunOptions::certify) also constraints at the level of accelerations, the condition of
// the iteration matrix and what round-off leaves of velocities and multipliers; and what
// libmbd/study/trust/certify.hpp finds by other runs of the scene.
//
// Momenta. Of each part (parts.hpp) p = sum of the momenta of its nodes, L their moment about x, a fixed point for a
// part that is held, the mean position of the nodes for one that is free:
//
//   p' = F,   L' = M_x - x' x p                                                                      (1)
//
// F, M_x the sum over its nodes of all forces but inertia: loads, gravity, drag, damping of mass, motion of the base,
// and joints, springs, dampers, bushings to the ground. Between nodes of the part forces cancel; of beams this is taken
// for granted but in certified runs. The integral of (1) over each piece of a step is by the trapezoidal rule, of
// order 2 as generalized-alpha, or Simpson's with the other methods. What p has changed by beyond it, over the largest
// sum of the sizes of the nodes' momenta; or a hundredth of what has passed, the sum of the sizes of the impulses of each
// load and each joint to the ground, where that is larger. The account starts afresh whenever 20 times those momenta have
// passed: errors of long runs are those of a few swings, and forces that balance each other, of which errors of second
// order are left, do not add up.
//
// Bounds are of two kinds. What a tolerance says has to hold to ten times of it (warn) and a thousand (fail). Errors of
// a method, which only smaller steps lessen, are small to 1 % (warn) and spoil what is found from 10 % on (fail).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/core/state.hpp"
#include "libmbd/core/system.hpp"
#include "libmbd/results/load_sampling.hpp"
#include "libmbd/results/time_error.hpp"
#include "solvers/constraints/parts.hpp"
#include "solvers/newton/report.hpp"

namespace mbd {

struct Scene;
struct RunReport;
class BeamElasticBatch;
class ComponentBatch;
class DenseStep;
namespace beam {
class MeshErrorRule;
}

enum class Verdict { pass, warn, fail };
std::string_view name_of(Verdict verdict);  // "pass", "warn", "fail"

struct Check {
  std::string name = {};  // "energy balance"
  double value = 0.0;
  double warn = 0.0;       // what is above gives a warning
  double fail = 0.0;       // and above this a failure
  std::string unit = {};   // of the three; empty: a ratio
  std::string where = {};  // "revolute 'C', position 1, at 0.3 s"; empty: of the run as a whole
  std::string why = {};    // what the number is, and where its bounds come from
  Verdict verdict = Verdict::pass;

  // Not of what is not known, and of runs that end early: `why` says it then.
  bool has_value() const { return verdict == Verdict::pass || fail > 0.0 || value != 0.0; }
  // "0.031", "2e-5 m", or "not known: " and why.
  std::string value_in_words() const;
};

// Of a value beside its bounds; one that is not finite fails.
Check bounded_check(Check check);

struct Certificate {
  std::vector<Check> checks;
  bool certified = false;  // with the dear ones

  void add(Check check);         // bounded_check() of it
  Verdict verdict() const;       // the worst
  const Check* culprit() const;  // the first of the worst; nullptr if all pass
  // What a verdict is about, and what it says nothing of: short phrases.
  std::vector<std::string> covers() const;
  std::vector<std::string> not_covered() const;
};

// The check of --certify whose run has beams of one order more.
inline constexpr std::string_view mesh_run = "beams of one order more";

// The check that an estimate makes: "error in time".
Check check_of(const TimeError& error);

// Watches one run.
class Audit {
 public:
  // `certify`: also what costs more than the samples that are taken anyhow. All arguments must outlive it.
  Audit(const Scene& scene, const System& system, bool certify);
  ~Audit();

  // Of the loads of the scene, before the certificate is made.
  void set_load_sampling(LoadSampling sampling) { loads_ = std::move(sampling); }
  Audit(const Audit&) = delete;
  Audit& operator=(const Audit&) = delete;

  bool certifies() const { return certify_; }
  void step(const StepReport& report, const State& state);  // each accepted time step
  void piece(const DenseStep& step);                        // each piece of one
  void sample(const State& state);                          // some accepted states
  // At the end, with what the report counts.
  Certificate certificate(const RunReport& report) const;

 private:
  struct Worst {
    double value = 0.0, time = 0.0;
    Index row = -1;
    void look(double v, double t, Index r = -1) {
      if (v > value || v != v) *this = {v, t, r};
    }
  };
  // Momentum, or its moment about x, of a part, against its impulse since the account was opened.
  struct Account {
    Vec3 begin = Vec3::Zero(), impulse = Vec3::Zero();
    double passed = 0.0,
           most_passed = 0.0;  // sum of the sizes of impulses; the largest of an account
    double size = 0.0;         // largest sum of the sizes of the nodes' shares
    // What trapezia are too large by where forces bend, in the last piece and in all; and what is unsure of it until the next.
    Vec3 second = Vec3::Zero(), bend = Vec3::Zero();
    bool has_second = false;
    double unsure = 0.0;
    Worst drift;
  };
  struct Outside {  // the right sides of (1), and sizes of what they sum up
    Vec6 rate = Vec6::Zero();
    double forces = 0.0, moments = 0.0;
  };
  struct Kept {
    Vec3 point = Vec3::Zero();  // x, of a part that is held
    Account linear, angular;
  };
  std::string where(const Worst& worst) const;
  void sample_momenta(const State& state);
  Vec3 point_of(int part, const State& state, Vec3* velocity = nullptr) const;
  bool goes_on(const DenseStep& step) const;
  void outside(const State& state, std::vector<Outside>& all) const;
  void add_impulse(const std::vector<Outside>& all, double weight);
  void impulse_of_ends(const DenseStep& step);
  void correct_impulse(bool goes, double h);
  bool moves() const;
  void add_momenta(Certificate& all) const;
  double reciprocal_condition(double h) const;
  void add_energy(Certificate& all) const;
  void add_constraints(Certificate& all) const;
  void add_steps(Certificate& all, const RunReport& report) const;
  static void add_troubles(Certificate& all, const Counters& c);
  void add_motion(Certificate& all, const RunReport& report) const;
  void add_equilibrium(Certificate& all, const RunReport& report) const;
  void add_round_off(Certificate& all) const;
  void sample_mesh(const State& state);
  void add_mesh(Certificate& all) const;
  void add_loads(Certificate& all) const;
  void sample_components(const State& state);
  void add_components(Certificate& all) const;

  const Scene& scene_;
  const System& system_;
  bool certify_;
  ConnectedParts parts_;
  std::vector<int> nodes_of_;  // by part: how many
  std::vector<const Batch*> on_nodes_,
      between_;  // what may act from outside, on one node or between two

  LoadSampling loads_;
  long steps_ = 0, slow_steps_ = 0, long_steps_ = 0;
  Worst contraction_, floor_;
  double last_time_ = 0.0;  // [s]

  int samples_ = 0;
  Worst position_, velocity_,
      acceleration_;                       // of constraints, in units of the scene (increments.hpp)
  double fastest_ = 0.0, quickest_ = 0.0;  // [rad/s], [rad/s2]
  double energy_begin_ = 0.0, energy_end_ = 0.0;  // less works [J]
  double least_ = 0.0, most_ = 0.0;               // total energy [J]
  double energy_size_ = 0.0;                      // largest sum of the sizes of its kinds [J]
  double energy_moved_ = 0.0;  // largest of kinetic energy, change of the total and works [J]
  Worst put_in_;               // energy [J]
  double farthest_ = 0.0, largest_force_ = 0.0;  // [m], of multipliers [N]
  double largest_outside_ = 0.0;                 // force on a part from outside [N]
  std::vector<Kept> kept_;                       // by part
  std::vector<Outside> outside_begin_, outside_middle_, outside_end_;
  std::vector<Outside> outside_before_;  // of the piece before, at its beginning
  double length_before_ = 0.0;           // of it [s]
  std::vector<int> holds_;  // by constraint: the part that it ties to the ground; -1: none
  double outside_at_ =
      0.0;  // when outside_end_ was found [s]; before the first piece: not a number
  State last_, piece_;
  State ended_;  // of the end of the piece before: Vdot, lambda, inputs

  // The mesh of beams, at some samples: sums over all of them, and the element that misses most.
  struct Flexible {
    const BeamElasticBatch* batch;
    std::unique_ptr<beam::MeshErrorRule> rule;
  };
  std::vector<Flexible> flexible_;
  int mesh_stride_ = 1, mesh_samples_ = 0;
  Worst missed_;  // energy [J]
  std::string missed_most_by_;
  double bent_ = 0.0, unit_ = 0.0;  // largest energy, and that of a stretch of 1 [J]
  const ComponentBatch* components_ = nullptr;
  // What they are wrong by: half the square of a turn within, or of what forces change of their stiffness.
  Worst linear_;
  double turned_ = 0.0,
         stiffened_ = 0.0;  // that turn [rad], and change (of the elastic stiffness), then
  std::string linear_in_;

  mutable State scratch_;
  mutable std::vector<Vec6> p_;
  mutable VecX r_, on_nodes_r_, g_, gdot_, rest_;
};

}  // namespace mbd
