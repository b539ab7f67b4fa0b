// Loads of a scene as elements on nodes: each kind of load gets a batch if the scene has one of it.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "elements/node/batches.hpp"
#include "libmbd/core/system.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd {

// A point of a beam that stands for a piece of it: a node as its element sees it, or of a rigid beam a point of
// quadrature, which many have the node of.
struct BeamNode {
  int node;
  double s;              // fraction of the beam's reference length
  double weight;         // reference length it stands for in its element: w_a J [m]
  Pose<double> frame{};  // of the section, in the node's
};

// R (laws), component by component.
std::array<Expression, 3> turned_law(const std::array<Expression, 3>& laws, const Mat3& R);

// The nodes between two places, which are ends of elements, each once and with the length it stands for there. `nodes`:
// those of each element in turn; from < to, fractions of the reference length.
std::vector<BeamNode> nodes_between(std::span<const BeamNode> nodes, double from, double to);

class Loads {
 public:
  explicit Loads(System& system) : system_(system) {}

  // Both throw Error for a load that does nothing or cannot be evaluated.
  // `frame`: the place in the node's.
  void add(const LoadScene& load, int node, const Pose<double>& frame = {});
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
  void add_dead(const load::Signals& signals, double weight, const Vec3& offset, int node);
  void add_follower(const load::Signals& signals, double weight, const Vec3& offset, int node);
  // Of a rigid beam: all points with the same signals are one load at their centre.
  struct Sum {
    double weight = 0.0;
    Vec3 moment = Vec3::Zero();  // sum of weight x offset [m2]
  };
  using Sums = std::map<load::Signals, Sum>;

  System& system_;
  std::map<double, int> constants_;  // signals of constants, shared
  std::unique_ptr<ElementBatch<PointLoad>> dead_;
  std::unique_ptr<ElementBatch<FollowerLoad>> follower_;
  std::unique_ptr<ElementBatch<DeadForceArm>> arm_;
};

}  // namespace mbd
