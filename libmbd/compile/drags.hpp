// Drag of a scene as elements on nodes: of beams and bodies, in still fluid and in a flow, each with a batch if
// the scene has one of it.
#pragma once

#include <map>
#include <memory>
#include <span>

#include "elements/node/batches.hpp"
#include "libmbd/compile/loads.hpp"
#include "libmbd/core/system.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd {

class Drags {
 public:
  explicit Drags(const Nodes& nodes) : nodes_(nodes), system_(nodes.system) {}

  // Of scenes that have passed check_scene. Throws Error for drag on the ground.
  void add(const DragScene& drag);

  void finish();  // hands the batches to the system

 private:
  void add_at(const DragScene& drag, const Attachment& at);
  // `nodes`: those of each element in turn, with `from` and `to` among the ends of elements.
  void add_along(const DragScene& drag, std::span<const BeamNode> nodes);
  drag::Flow flow(const DragScene& drag);

  const Nodes& nodes_;
  System& system_;
  std::map<double, int> constants_;  // signals of constants, shared
  std::unique_ptr<ElementBatch<LineDrag<false>>> line_;
  std::unique_ptr<ElementBatch<LineDrag<true>>> line_in_flow_;
  std::unique_ptr<ElementBatch<LineDrag<false, true>>> rigid_line_;
  std::unique_ptr<ElementBatch<LineDrag<true, true>>> rigid_line_in_flow_;
  std::unique_ptr<ElementBatch<PointDrag<false>>> point_;
  std::unique_ptr<ElementBatch<PointDrag<true>>> point_in_flow_;
};

// Whether the fluid flows: some component is not zero for all times.
bool flows(const DragScene& drag);

}  // namespace mbd
