// What a model says: plain data, SI units, each item with its place in the file. A Scene is made by
// the XML reader or by a C++ program; compile() turns it into a Model. Nothing here computes.
//
// Vectors are inertial (i1 i2 i3) in the reference configuration unless a member says otherwise. What else there is to say
// of a member, its unit among it, stands in the list of fields of its struct (field.hpp).
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libmbd/scene/analyses.hpp"
#include "libmbd/scene/beams.hpp"
#include "libmbd/scene/bodies.hpp"
#include "libmbd/scene/control.hpp"
#include "libmbd/scene/inputs.hpp"
#include "libmbd/scene/joints.hpp"
#include "libmbd/scene/loads.hpp"
#include "libmbd/scene/springs.hpp"

namespace mbd {

struct Scene {
  std::string file;                   // for messages; empty when built in C++
  std::vector<std::string> includes;  // files it was read from besides, in order
  Source source;                      // of the <mbd> element
  std::string name;
  std::vector<std::pair<std::string, double>> parameters;
  std::vector<InputScene> inputs;  // their order is that of State::inputs
  std::vector<MaterialScene> materials;
  std::vector<LayupScene> layups;
  std::vector<FunctionScene> functions;
  std::vector<ControllerScene> controllers;  // their order is that in which they sample
  std::vector<Section> sections;
  std::vector<BeamScene> beams;
  std::vector<BodyScene> bodies;
  std::vector<RigidScene> rigids;
  std::vector<ReductionScene> reductions;
  std::vector<JointScene> joints;
  std::vector<DriveScene> drives;
  std::vector<MotionScene> motions;
  std::vector<LoadScene> loads;
  std::vector<DistributedLoadScene> distributed_loads;
  std::vector<PointMassScene> point_masses;
  std::vector<SpringScene> springs;
  std::vector<BushingScene> bushings;
  std::vector<JointSpringScene> joint_springs;
  std::vector<JointTorqueScene> joint_torques;
  std::vector<DragScene> drags;
  std::vector<AddedMassScene> added_masses;
  std::vector<ExtensionScene> extensions;
  std::optional<Gravity> gravity;
  std::optional<BaseMotionScene> base_motion;
  std::optional<StaticScene> statics;  // equilibrium at t = 0, before the transient if there is one
  std::optional<TransientScene> transient;
  std::optional<PathScene> path;  // instead of both
  std::optional<ModesScene> modes;
  std::vector<RecordScene> records;
  std::optional<MotionOutputScene> motion_output;
  std::vector<PlotScene> plots;
  std::vector<ExpectScene> expects;
};

// Calls f with the items of each kind: a vector, or an optional one. A new kind of item is its struct, its member in
// Scene, and its line here.
template <class SomeScene, class F>
requires std::is_same_v<std::remove_const_t<SomeScene>, Scene>
void each_kind(SomeScene& scene, const F& f) {
  f(scene.inputs);
  f(scene.materials);
  f(scene.layups);
  f(scene.functions);
  f(scene.controllers);
  f(scene.sections);
  f(scene.beams);
  f(scene.bodies);
  f(scene.point_masses);
  f(scene.rigids);
  f(scene.reductions);
  f(scene.joints);
  f(scene.drives);
  f(scene.motions);
  f(scene.loads);
  f(scene.distributed_loads);
  f(scene.springs);
  f(scene.bushings);
  f(scene.joint_springs);
  f(scene.joint_torques);
  f(scene.drags);
  f(scene.added_masses);
  f(scene.extensions);
  f(scene.base_motion);
  f(scene.gravity);
  f(scene.statics);
  f(scene.path);
  f(scene.transient);
  f(scene.modes);
  f(scene.records);
  f(scene.motion_output);
  f(scene.plots);
  f(scene.expects);
}

// Calls f with every item.
template <class SomeScene, class F>
void each_item(SomeScene& scene, const F& f) {
  each_kind(scene, [&f](auto& items) { field::each_part(items, f); });
}

}  // namespace mbd
