#include "libmbd/compile/reductions.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "elements/node/batches.hpp"
#include "elements/node/mass_damping.hpp"
#include "joints/fixed.hpp"
#include "libmbd/core/stop.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/places.hpp"
#include "libmbd/scene/section_table.hpp"
#include "solvers/modes/linearizable.hpp"

namespace mbd {

ReductionMembers::ReductionMembers(const Scene& scene) {
  for (const ReductionScene& reduction : scene.reductions)
    for (const std::string& name : reduction.of) of_.try_emplace(name, &reduction);
}

const ReductionScene* ReductionMembers::of(std::string_view part) const {
  const auto it = of_.find(part);
  return it == of_.end() ? nullptr : it->second;
}

const ReductionScene* ReductionMembers::of(const JointScene& joint) const {
  const ReductionScene* const a = joint.kind == joint::Fixed::name ? of(joint.a) : nullptr;
  return a != nullptr && a == of(joint.b) ? a : nullptr;
}

namespace {

bool is_same(const Place& a, const Place& b) {
  return a.kind == b.kind && a.name == b.name && a.parameter == b.parameter;
}

// Where something else acts on what is in the reduction, or holds it, by name, each once; if nothing does, its first part.
std::vector<Place> interfaces_of(const Scene& scene, const ReductionMembers& members,
                                 const ReductionScene& reduction) {
  std::vector<Place> places;
  const auto look = [&](const Place& place) {
    if (members.of(place) == &reduction) places.push_back(place);
  };
  each_item(scene, [&]<class Item>(const Item& item) {
    if constexpr (std::is_same_v<Item, RecordScene>) return;
    if constexpr (std::is_same_v<Item, JointScene> || std::is_same_v<Item, PointMassScene>)
      if (members.of(item) == &reduction) return;
    if constexpr (std::is_same_v<Item, BodyScene>) {
      if (members.of(item.name) == &reduction) return;
    }
    each_place_of(item, look);
  });
  std::ranges::stable_sort(places, {}, [](const Place& place) { return text_of(place); });
  places.erase(std::unique(places.begin(), places.end(), is_same), places.end());
  if (!places.empty()) return places;
  const std::string& first = *std::ranges::min_element(reduction.of);
  const bool is_beam = std::ranges::any_of(
      scene.beams, [&first](const BeamScene& beam) { return beam.name == first; });
  return {{is_beam ? Place::Kind::beam : Place::Kind::body, first, 0.0}};
}

// What is in the reduction, as a scene, with an end of elements at each of its interfaces.
Scene part_of(const Scene& scene, const ReductionMembers& members, const ReductionScene& reduction,
              const std::vector<Place>& interfaces) {
  const auto is_in = [&](const auto& named) { return members.of(named.name) == &reduction; };
  const auto is_of = [&](const auto& item) { return members.of(item) == &reduction; };
  Scene part;
  part.file = scene.file;
  part.source = reduction.source;
  part.name = reduction.name;
  part.materials = scene.materials;
  part.layups = scene.layups;
  std::ranges::copy_if(scene.sections, std::back_inserter(part.sections), [&](const Section& s) {
    return std::ranges::any_of(scene.beams,
                               [&](const BeamScene& b) { return is_in(b) && b.section == s.name; });
  });
  std::ranges::copy_if(scene.beams, std::back_inserter(part.beams), is_in);
  std::ranges::copy_if(scene.bodies, std::back_inserter(part.bodies), is_in);
  for (BodyScene& body : part.bodies) body.velocity = body.angular_velocity = Vec3::Zero();
  std::ranges::copy_if(scene.rigids, std::back_inserter(part.rigids),
                       [&](const RigidScene& r) { return members.of(r.of.front()) == &reduction; });
  std::ranges::copy_if(scene.joints, std::back_inserter(part.joints), is_of);
  std::ranges::copy_if(scene.point_masses, std::back_inserter(part.point_masses), is_of);
  for (const Place& place : interfaces)
    part.point_masses.push_back({reduction.source, {}, place, 0.0, Vec3::Zero()});
  TransientScene transient;
  transient.source = reduction.source;
  transient.duration = 1.0;
  transient.step = 1.0;
  part.transient = transient;
  part.motion_output = scene.motion_output;
  std::ranges::copy_if(scene.records, std::back_inserter(part.records), [&](const RecordScene& r) {
    return r.at && members.of(*r.at) == &reduction;
  });
  return part;
}

void check_stiffnesses(const Scene& part, const ReductionScene& reduction) {
  for (const Section& section : part.sections)
    if (const auto held = infinite_stiffnesses(section);
        std::find(held.begin(), held.end(), true) != held.end())
      throw Error(reduction.source,
                  fmt::format("{}: {} has infinite stiffnesses, which component modes do not know; "
                              "give them numbers, or leave its beams out of the reduction",
                              label(reduction), label(section)));
}

void check_masses(const Scene& part, const ReductionScene& reduction) {
  for (const Section& section : part.sections)
    if (!section.mass && (section.stations.empty() || !section.stations.front().mass))
      throw Error(reduction.source,
                  fmt::format("{}: {} has no mass, which component modes need; give it "
                              "<mass per_length=… inertia=…/>",
                              label(reduction), label(section)));
}

// What the rates of each node meet that is proportional to its mass; empty: none does.
std::vector<Mat6> mass_damping_of(const System& system) {
  std::vector<Mat6> all;
  State moving = system.reference_state();
  for (const auto& batch : system.batches()) {
    if (batch->type() != MassDamping::name) continue;
    all.assign(static_cast<std::size_t>(system.nodes()), Mat6::Zero());
    for (Index c = 0; c < 6; ++c) {
      std::ranges::fill(moving.V, Vec6(Vec6::Unit(c)));
      VecX r = VecX::Zero(system.rows());
      batch->residual(moving, r);
      for (Index n = 1; n < system.nodes(); ++n)
        all[static_cast<std::size_t>(n)].col(c) = r.segment<6>(6 * n);
    }
  }
  return all;
}

}  // namespace

ReducedPart::ReducedPart(const Scene& scene, const ReductionMembers& members,
                         const ReductionScene& reduction)
    : reduction_(&reduction) {
  stop::check();
  std::vector<Place> places = interfaces_of(scene, members, reduction);
  if (reduction.frame) {
    const auto frame = std::ranges::find_if(
        places, [&](const Place& place) { return is_same(place, *reduction.frame); });
    std::rotate(places.begin(), frame, frame + 1);
  }
  const Scene part = part_of(scene, members, reduction, places);
  check_stiffnesses(part, reduction);
  check_masses(part, reduction);
  model_ = std::make_unique<const Model>(compile_part(part, places.front()));
  const System& system = *model_->system;
  if (system.multipliers() > 0)
    throw Error(reduction.source,
                fmt::format("{}: what is fixed in it is fixed twice, or keeps multipliers for "
                            "another reason; leave out the <fixed> that repeats others",
                            label(reduction)));
  std::vector<int> interfaces;
  for (const Place& place : places) {
    const int node = find(place)->node;
    if (std::ranges::find(interfaces, node) == interfaces.end()) interfaces.push_back(node);
  }
  SmallMotions motions(system);
  motions.about(system.reference_state());
  if (const std::string kink = kink_at(system, {&motions.state(), 1}); !kink.empty())
    throw Error(reduction.source, fmt::format("{}: {}", label(reduction), kink));
  try {
    modes_ = component_modes(motions, interfaces, reduction.modes, mass_damping_of(system));
  } catch (const Stopped&) {
    throw;
  } catch (const Error& e) {
    throw Error(reduction.source, fmt::format("{}: {}", label(reduction), e.what()));
  }
  node_of_.assign(static_cast<std::size_t>(system.nodes()), -1);
  const Pose<double> frame = system.reference_pose(modes_.nodes.front());
  for (Index n = 1; n < system.nodes(); ++n)
    in_frame_.push_back(relative(frame, system.reference_pose(n)));
}

const Model::PlaceFrame* ReducedPart::find(const Place& place) const {
  for (const Model::PlaceFrame& known : model_->places)
    if (is_same(known.place, place)) return &known;
  return nullptr;
}

State ReducedPart::state_within(const State& whole, const ComponentBatch& batch,
                                Index component) const {
  State own = model_->initial;
  own.t = whole.t;
  own.side = whole.side;
  own.load_factor = whole.load_factor;
  const bool rates = !whole.V.empty();
  const std::vector<NodeState<double>> nodes =
      batch.within(whole, component, in_frame_, modes_.shapes, rates);
  for (std::size_t n = 1; n < own.pose.size(); ++n) {
    own.pose[n] = nodes[n - 1].H;
    if (!rates) continue;
    own.V[n] = nodes[n - 1].V;
    own.Vdot[n] = nodes[n - 1].Vdot;
  }
  return own;
}

}  // namespace mbd
