// Loads of a scene as elements on nodes: each kind of load gets a batch if the scene has one of it.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "elements/node/batches.hpp"
#include "libmbd/compile/places.hpp"
#include "libmbd/core/system.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd {

// R (laws), component by component.
std::array<Expression, 3> turned_law(const std::array<Expression, 3>& laws, const Mat3& R);

// The nodes between two places, which are ends of elements, each once and with the length it stands for there. `nodes`:
// those of each element in turn; from < to, fractions of the reference length.
std::vector<BeamNode> nodes_between(std::span<const BeamNode> nodes, double from, double to);

class Loads {
 public:
  explicit Loads(const Nodes& nodes) : nodes_(nodes), system_(nodes.system) {}

  // Both throw Error for a load that does nothing or cannot be evaluated.
  void add(const LoadScene& load);
  // `from` and `to` must be among the ends of elements.
  void add(const DistributedLoadScene& load);

  void finish();  // hands the batches to the system

 private:
  template <class E>
  ElementBatch<E>& batch(std::unique_ptr<ElementBatch<E>>& made);

  using Components = std::optional<std::array<Expression, 3>>;
  // `kind`: "" or "follower_", before force and moment in messages.
  load::Signals signals(const LoadScene& load, int node, std::string_view kind,
                        const Components& force, const Components& moment);
  // `name`: as of System::add_signal, without the expression.
  int signal(const Expression& e, const std::string& name);
  void add_dead(const load::Signals& signals, double weight, const Vec3& offset, int node);
  void add_follower(const load::Signals& signals, double weight, const Vec3& offset, int node);
  class Distribution;

  const Nodes& nodes_;
  System& system_;
  std::map<double, int> constants_;  // signals of constants, shared
  std::unique_ptr<ElementBatch<PointLoad>> dead_;
  std::unique_ptr<ElementBatch<FollowerLoad>> follower_;
  std::unique_ptr<ElementBatch<DeadForceArm>> arm_;
};

}  // namespace mbd
