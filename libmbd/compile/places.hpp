// Where things of a scene act: the nodes of its places, and of its beams.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "libmbd/core/se3.hpp"
#include "libmbd/core/system.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd {

// What a place of a scene is attached to.
struct Attachment {
  int node = 0;
  bool is_point = false;              // of a beam: joints act at the place itself
  Pose<double> pose{};                // reference pose of the place, inertial
  const RigidScene* rigid = nullptr;  // which the place is part of
  bool is_fused = false;  // its node is that of something else it is fixed to (fusion.hpp)

  // Whether the axes or the origin of its node may be others than the place's.
  bool is_offset() const { return rigid != nullptr || is_fused; }
};

// A point of a beam that stands for a piece of it: a node as its element sees it (in something it is fused with at
// `frame`), or of a rigid beam a point of quadrature, which many have the node of.
struct BeamNode {
  int node;
  double s;              // fraction of the beam's reference length
  double weight;         // reference length it stands for in its element: w_a J [m]
  Pose<double> frame{};  // of the section, in the node's

  bool is_offset() const { return !frame.p.vec().isZero(0.0) || !frame.r.isZero(0.0); }
};

// Finds the node of a place; throws Error in the name of `who`.
using FindPlace = std::function<Attachment(const Place&, const Source&, std::string_view who)>;

// What terms on nodes are compiled with.
struct Nodes {
  System& system;
  bool rates;  // whether the scene has a transient
  FindPlace find;
  // Those of each element of a beam in turn; checks its name.
  std::function<std::span<const BeamNode>(const std::string& beam, const Source&,
                                          std::string_view who)>
      along;

  // The place in the frame of its node: the identity, but in something rigid or fused.
  Pose<double> frame_of(const Attachment& at) const {
    return at.is_offset() ? relative(system.reference_pose(at.node), at.pose) : Pose<double>{};
  }

  // As find(), of what does nothing on the ground.
  template <class Item>
  Attachment find_moving(const Item& item, const Place& place, std::string_view who) const {
    const Attachment at = find(place, item.source, who);
    if (at.node == 0)
      throw Error(item.source,
                  std::string(who) + ": on the ground it does nothing; give a beam or a body");
    return at;
  }
};

}  // namespace mbd
