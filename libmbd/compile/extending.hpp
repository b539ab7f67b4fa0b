// Elements and joints of a program's own, written as those of the library are (elements/element.hpp, joints/joint.hpp), in the
// system of a scene that is being compiled:
//
//   mbd::Extensions own;
//   own.parts.push_back([](mbd::Extending& to) {
//     auto tethers = std::make_unique<mbd::ElementBatch<Tether>>("tether", Tether::Shared{});
//     tethers->add({400.0}, std::array{0, to.place("weight").node}, "my tether");
//     to.add_batch(std::move(tethers));
//     to.add_joint<PointInPlane>("slope", "weight", "ground", H);
//   });
//   mbd::Model model = mbd::compile(scene, own);
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "elements/element_batch.hpp"
#include "joints/joint_batch.hpp"
#include "libmbd/core/se3.hpp"
#include "libmbd/core/system.hpp"

namespace mbd {

// Where something can be attached. What is fixed together shares a node, so a place need not be where its node is.
struct PlaceInNode {
  int node = 0;             // of the system; 0 is the ground
  Pose<double> frame{};     // of the place, in its node
  Pose<double> inertial{};  // of the place, as the scene is drawn
};

// A joint that was added. Lives as long as the system does.
struct OwnJoint {
  const joint::AnyJointBatch* batch = nullptr;
  Index index = 0;

  // As AnyJointBatch says: [rad]; [m]; on b, axes of b [N, N.m].
  double angle(const State& state) const { return batch->angle(state, index); }
  double displacement(const State& state) const { return batch->displacement(state, index); }
  Vec6 reaction(const State& state) const { return batch->reaction(state, index); }
};

class Extending {
 public:
  virtual ~Extending() = default;

  // The nodes of a place that has one ("arm.end", "hub", "ground"), or all of a beam, along its reference line. Throws Error for
  // a name without nodes.
  virtual std::vector<PlaceInNode> places(const std::string& name) const = 0;

  // Of a place with one node. Throws Error as places() does, and for a beam.
  PlaceInNode place(const std::string& name) const;

  // Of what is there so far: nodes and their poses.
  virtual const System& system() const = 0;
  // Whether the scene has a transient: only then have nodes rates.
  virtual bool has_rates() const = 0;

  // Elements (ElementBatch), or a batch of one's own. Its type must be none that the system has. Throws Error for no batch,
  // or such a type.
  virtual void add_batch(std::unique_ptr<Batch> batch) = 0;

  // A joint of type J, whose frames a and b are both at H where the scene is drawn (inertial, axes e1 e2 e3), or b at H_b.
  // Laws of time are the library's: J has none. `parameter` is that of J. Throws Error for places without nodes, for two of the
  // same node, for a name of J that a type of the library has; compile() does for a joint that is open.
  template <joint::Joint J>
  OwnJoint add_joint(const std::string& name, const std::string& a, const std::string& b,
                     const Pose<double>& H, double parameter = 0.0) {
    return add_joint<J>(name, a, b, H, H, parameter);
  }
  template <joint::Joint J>
  OwnJoint add_joint(const std::string& name, const std::string& a, const std::string& b,
                     const Pose<double>& H_a, const Pose<double>& H_b, double parameter) {
    static_assert(J::traits.law == joint::Law::none);
    joint::Definition definition;
    definition.parameter = parameter;
    return add_joint(
        name, {a, b}, {H_a, H_b}, definition, J::name, +[]() {
          return std::unique_ptr<joint::AnyJointBatch>(
              std::make_unique<joint::JointBatch<J, false>>());
        });
  }

 protected:
  using MakeJoints = std::unique_ptr<joint::AnyJointBatch> (*)();
  virtual OwnJoint add_joint(const std::string& name, const std::array<std::string, 2>& places,
                             const std::array<Pose<double>, 2>& frames,
                             joint::Definition definition, std::string_view type,
                             MakeJoints make) = 0;
};

}  // namespace mbd
