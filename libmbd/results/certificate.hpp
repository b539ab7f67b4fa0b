// What a run says for its own correctness: checks, each a number beside its bounds, and the worst of their verdicts.
//
// Of every run, from what is sampled anyhow: balance of energy, constraints at two levels, how Newton's iterations
// contracted, round-off. Of a run that is to be certified (RunOptions::certify) also constraints at the level of
// accelerations, momenta against the impulse of loads and joints, the condition of the iteration matrix and what
// round-off leaves of velocities and multipliers; and what libmbd/study/trust/certify.hpp finds by other runs of the scene.
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
#include "solvers/newton/report.hpp"

namespace mbd {

struct Scene;
struct RunReport;
class DenseStep;

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
};

// Of a value beside its bounds; one that is not finite fails.
Check bounded_check(Check check);

struct Certificate {
  std::vector<Check> checks;
  bool certified = false;  // with the dear ones

  Verdict verdict() const;       // the worst
  const Check* culprit() const;  // the first of the worst; nullptr if all pass
};

// Watches one run.
class Audit {
 public:
  // `certify`: also what costs more than the samples that are taken anyhow. All arguments must outlive it.
  Audit(const Scene& scene, const System& system, bool certify);
  ~Audit();
  Audit(const Audit&) = delete;
  Audit& operator=(const Audit&) = delete;

  bool certifies() const { return certify_; }
  void step(const StepReport& report, const State& state);  // each accepted time step
  void piece(const DenseStep& step);                        // each piece of one; to be certified
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
  std::string where(const Worst& worst) const;
  Vec6 wrench(const State& state, double& forces, double& moments) const;
  double reciprocal_condition(double h) const;
  void add_motion(Certificate& all, const RunReport& report) const;
  void add_equilibrium(Certificate& all, const RunReport& report) const;
  void add_round_off(Certificate& all) const;

  const Scene& scene_;
  const System& system_;
  bool certify_;
  bool free_;  // nothing acts from outside: no loads, no gravity, no joint with the ground

  long steps_ = 0, slow_steps_ = 0, long_steps_ = 0;
  Worst contraction_, floor_;
  double last_time_ = 0.0;  // [s]

  int samples_ = 0;
  Worst position_, velocity_,
      acceleration_;                       // of constraints, in units of the scene (increments.hpp)
  double fastest_ = 0.0, quickest_ = 0.0;  // [rad/s], [rad/s2]
  double energy_begin_ = 0.0, energy_end_ = 0.0;  // less works [J]
  double least_ = 0.0, most_ = 0.0;               // total energy [J]
  double energy_moved_ = 0.0;  // largest of kinetic energy, change of the total and works [J]
  Worst put_in_;               // energy [J]
  double farthest_ = 0.0, largest_force_ = 0.0;  // [m], [N]
  Vec6 momentum_begin_ = Vec6::Zero();
  double linear_ = 0.0, angular_ = 0.0;  // largest momenta [N.s], [N.m.s]
  Worst linear_drift_, angular_drift_;
  Vec6 impulse_ = Vec6::Zero();
  double linear_impulse_ = 0.0, angular_impulse_ = 0.0;  // of the sizes of forces, of moments
  State last_, piece_;

  mutable State scratch_;
  mutable VecX r_, unloaded_, g_, gdot_, rest_;
};

}  // namespace mbd
