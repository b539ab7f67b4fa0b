// All joints of one type behind one interface: what compile needs to fill it and output to read it.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "joints/joint.hpp"
#include "libmbd/core/batch.hpp"

namespace mbd::joint {

class AnyJointBatch : public Batch {
 public:
  virtual std::span<const Row> rows() const = 0;

  // Frames a and b in nodes P and Q (0 is the ground): H_P^-1 H_a and H_Q^-1 H_b. `constraint` and
  // `multiplier` as System::add_constraint gave them; `signal` of the driven angle, or -1; `angle`, a turn
  // counter to follow the free angle with, or -1. Returns the joint's index.
  virtual Index add(const Pose<double>& a, const Pose<double>& b, int P, int Q, int signal,
                    Index constraint, Index multiplier, Index angle) = 0;

  // Free angle about e3, unwrapped [rad].
  virtual double angle(const State& state, Index joint) const = 0;

  // Relative twist of b with respect to a, resolved in b [m/s, rad/s].
  virtual Vec6 relative_velocity(const State& state, Index joint) const = 0;

  // Wrench that the joint exerts on b, at b's origin, resolved in b [N, N.m].
  virtual Vec6 reaction(const State& state, Index joint) const = 0;
};

// A batch of the joint type with that name, or of the driven rotation; nullptr if there is none.
std::unique_ptr<AnyJointBatch> make_joint_batch(std::string_view name);

}  // namespace mbd::joint
