#include "libmbd/compile/drags.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "libmbd/scene/label.hpp"
#include "libmbd/scene/places.hpp"

namespace mbd {
namespace {

template <class E>
void add_one(std::unique_ptr<ElementBatch<E>>& batch, const typename E::Data& data, int node,
             const std::string& name) {
  if (!batch) batch = std::make_unique<ElementBatch<E>>(E::name, typename E::Shared{});
  batch->add(data, std::array{node}, name);
}

bool is_zero(const Expression& e) { return e.is_constant() && e.value() == 0.0; }

}  // namespace

bool flows(const DragScene& drag) {
  return drag.flow && !std::all_of(drag.flow->begin(), drag.flow->end(), is_zero);
}

drag::Flow Drags::flow(const DragScene& drag) {
  drag::Flow result;
  for (std::size_t i = 0; i < 3; ++i) {
    const Expression& e = (*drag.flow)[i];
    if (is_zero(e)) continue;
    if (e.has_sensors())
      throw Error(
          drag.source,
          fmt::format("{}: flow {} \"{}\" depends on a sensor; drag answers to the motion by "
                      "itself, and other forces of it are a <load> with sensors",
                      label(drag), i + 1, excerpt(e.text())));
    const auto add = [&](const Signal& signal) {
      return static_cast<int>(system_.add_signal(
          signal, SignalUse::load,
          said(drag.source,
               fmt::format("{}: flow {} \"{}\"", label(drag), i + 1, excerpt(e.text())))));
    };
    if (!e.is_constant()) {
      result.signals[i] = add(Signal::from_expression(e));
      continue;
    }
    const auto [it, is_new] = constants_.try_emplace(e.value(), -1);
    if (is_new) it->second = add(Signal::constant(e.value()));
    result.signals[i] = it->second;
  }
  return result;
}

void Drags::add(const DragScene& drag) {
  // In statics nothing moves, and what does not flow drags nothing.
  const bool drags = nodes_.rates || flows(drag);
  if (drag.at) {
    const Attachment at = nodes_.find_moving(drag, *drag.at, label(drag));
    if (drags) add_at(drag, at);
  } else {
    const std::span<const BeamNode> nodes = nodes_.along(drag.beam, drag.source, label(drag));
    if (drags) add_along(drag, nodes);
  }
}

void Drags::add_at(const DragScene& drag, const Attachment& at) {
  const double b = 0.5 * drag.density * *drag.coefficient * *drag.area;
  const Vec3 offset = nodes_.frame_of(at) * drag.offset.value_or(Vec3::Zero());
  const std::string name = fmt::format("drag on {}", system_.node_name(at.node));
  if (flows(drag))
    add_one(point_in_flow_, {b, offset, flow(drag)}, at.node, name);
  else
    add_one(point_, {b, offset, {}}, at.node, name);
}

void Drags::add_along(const DragScene& drag, std::span<const BeamNode> nodes) {
  const double half = 0.5 * drag.density * *drag.diameter;
  const double across = half * *drag.normal_coefficient,
               along = half * std::numbers::pi * *drag.tangential_coefficient;
  const bool flowing = flows(drag), rigid = nodes.front().node == nodes.back().node;
  const drag::Flow velocity = flowing ? flow(drag) : drag::Flow{};
  const Part part = part_of(drag);
  for (const BeamNode& here : nodes_between(nodes, part.from, part.to)) {
    const std::string name = fmt::format("drag on {}", system_.node_name(here.node));
    const double n = here.weight * across, t = here.weight * along;
    const drag::Frame frame{here.frame.R(), here.frame.r};
    const bool placed = here.is_offset() || rigid;
    if (placed && flowing)
      add_one(rigid_line_in_flow_, {n, t, velocity, frame}, here.node, name);
    else if (placed)
      add_one(rigid_line_, {n, t, {}, frame}, here.node, name);
    else if (flowing)
      add_one(line_in_flow_, {n, t, velocity, {}}, here.node, name);
    else
      add_one(line_, {n, t, {}, {}}, here.node, name);
  }
}

void Drags::finish() {
  if (line_) system_.add_batch(std::move(line_));
  if (line_in_flow_) system_.add_batch(std::move(line_in_flow_));
  if (rigid_line_) system_.add_batch(std::move(rigid_line_));
  if (rigid_line_in_flow_) system_.add_batch(std::move(rigid_line_in_flow_));
  if (point_) system_.add_batch(std::move(point_));
  if (point_in_flow_) system_.add_batch(std::move(point_in_flow_));
}

}  // namespace mbd
