// Loads of a scene as elements on nodes: each kind of load gets a batch if the scene has one of it.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "elements/element_batch.hpp"
#include "elements/point_load.hpp"
#include "libmbd/core/system.hpp"
#include "libmbd/front/scene.hpp"

namespace mbd {

// A node of a beam as its element sees it.
struct BeamNode {
  int node;
  double s;       // fraction of the beam's reference length
  double weight;  // w_a J: reference length the node stands for in its element [m]
};

// The nodes between two places, which are ends of elements, each once and with the length it stands for there. `nodes`:
// those of each element in turn; from < to, fractions of the reference length.
std::vector<BeamNode> nodes_between(std::span<const BeamNode> nodes, double from, double to);

class Loads {
 public:
  explicit Loads(System& system) : system_(system) {}

  // Both throw Error for a load that does nothing or cannot be evaluated.
  void add(const LoadScene& load, int node);
  // `nodes`: those of each element in turn, with `from` and `to` among the ends of elements.
  void add(const DistributedLoadScene& load, std::span<const BeamNode> nodes);

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
  void add_dead(const load::Signals& signals, double weight, int node);
  void add_follower(const load::Signals& signals, double weight, const Vec3& offset, int node);

  System& system_;
  std::map<double, int> constants_;  // signals of constants, shared
  std::unique_ptr<ElementBatch<PointLoad>> dead_;
  std::unique_ptr<ElementBatch<FollowerLoad>> follower_;
  std::unique_ptr<ElementBatch<DeadForceArm>> arm_;
};

}  // namespace mbd
