// All joints of one type behind one interface: what compile needs to fill it and output to read it.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "joints/joint.hpp"
#include "libmbd/core/batch.hpp"

namespace mbd::joint {

// One joint between nodes P and Q (0 is the ground).
struct Definition {
  Pose<double> a{}, b{};  // frames in their nodes: H_P^-1 H_a and H_Q^-1 H_b
  int P = 0, Q = 0;
  Index constraint = 0;                    // index of the constraint among the System's
  Index multiplier = 0;                    // first row in State::lambda
  double parameter = 0.0;                  // of the type
  std::array<int, 3> signals{-1, -1, -1};  // as many as the type's law has
  Index angle = -1;                        // followed angle, of the types that have one
};

class AnyJointBatch : public Batch {
 public:
  virtual std::vector<RowFacts> rows() const = 0;
  virtual Traits traits() const = 0;

  // Returns the joint's index. `name` is for messages.
  virtual Index add(const Definition& joint, std::string name = {}) = 0;

  // Free angle about e3, unwrapped [rad].
  virtual double angle(const State& state, Index joint) const = 0;

  // Displacement along e3 of b [m].
  virtual double displacement(const State& state, Index joint) const = 0;

  // Relative twist of b with respect to a (as fixed in its node), resolved in b [m/s, rad/s].
  virtual Vec6 relative_velocity(const State& state, Index joint) const = 0;

  // Wrench that the joint exerts on b, at b's origin, resolved in b [N, N.m].
  virtual Vec6 reaction(const State& state, Index joint) const = 0;
};

// A batch of the joint type or prescribed motion with that name; nullptr if there is none.
std::unique_ptr<AnyJointBatch> make_joint_batch(std::string_view name);

// The same of a type of joint_list.hpp. Compiled in joint_types.cpp: the kernels of all types take long.
template <class J>
std::unique_ptr<AnyJointBatch> make_batch_of();

}  // namespace mbd::joint
