// A compiled scene: a const System, the State it starts from, and the columns a run writes.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "elements/node/force.hpp"
#include "libmbd/core/state.hpp"
#include "libmbd/core/system.hpp"
#include "libmbd/language/quantities.hpp"
#include "libmbd/scene/scene.hpp"
#include "solvers/constraints/redundancy.hpp"
#include "solvers/newton/report.hpp"

namespace mbd {

// One number of a run at an accepted state, e.g. "C.displacement.3" [m].
struct Column {
  std::string name;
  std::string unit;
  std::string frame = {};                      // along whose axes; empty: of no axes
  const schema::Quantity* quantity = nullptr;  // of a record; null: a number of a path's
};

// Some neighbouring columns, and how to read them from a state (a, of the model's System).
struct Channel {
  std::vector<Column> columns;
  std::function<void(const State&, std::span<double>)> sample;
};

// Where on a path the state is that is being sampled.
struct PathPlace {
  double arc_length = 0.0;
  int branch = 0;
  PathEvent event = PathEvent::none;
  Index negative = 0;  // eigenvalues; -1: not known, within round-off of a singular point
};

struct Model {
  std::unique_ptr<const System> system;
  State initial;  // reference configuration, initial velocities; not yet in equilibrium
  std::vector<Channel> channels;  // in the order of the scene's records
  // For pictures: the nodes of each flexible beam from its start to its end, points of each rigid one, and those of
  // free bodies.
  struct Line {
    std::string name;
    std::vector<int> nodes;
    std::vector<Pose<double>> frames;  // of the sections, in their nodes
    std::vector<double> s;             // of each node: fraction of the reference length
    // Quadrature points, fractions of the reference length, and the resultants there of elastic and viscous forces
    // [N1 Q2 Q3 M1 M2 M3], section axes [N, N.m]. None without <motion_output>.
    std::vector<double> stations = {};
    std::function<void(const State&, std::span<Vec6>)> resultants = {};

    std::size_t size() const { return nodes.size(); }
    Pose<double> pose(std::span<const Pose<double>> of_nodes, std::size_t k) const {
      return of_nodes[static_cast<std::size_t>(nodes[k])] * frames[k];
    }
  };
  struct RigidPoint {
    int node;
    Vec3 point;  // node frame [m]
  };
  // Where a place of the scene is, of those with a node.
  struct PlaceFrame {
    Place place;
    int node;
    Pose<double> frame;  // of the place, in its node
  };
  // A joint that the system has: its frames coincide where it is closed (joints/joint.hpp).
  struct JointFrames {
    std::string name;
    int node_a, node_b;
    Pose<double> a, b;                           // in these nodes
    std::function<double(const State&)> angle;   // [rad]; none: it has none
    std::function<Vec6(const State&)> reaction;  // on b, joint axes [N, N.m]
  };
  std::vector<PlaceFrame> places;
  std::vector<JointFrames> joints;
  std::vector<Line> lines;
  std::vector<std::vector<RigidPoint>> rigid_lines;
  std::vector<RigidPoint> bodies;
  double mass = 0.0;                // of everything that moves, without added mass [kg]
  std::shared_ptr<PathPlace> path;  // of a scene with <path>: its first channel reads it
  // Who made each row of State::lambda: a joint, a drive or a motion, as messages call it.
  struct Maker {
    Source source;
    std::string label;  // `revolute "A"`
  };
  std::vector<Maker> makers;
  std::vector<Maker>
      fused;  // fixed joints without multipliers: what they join is one node (fusion.hpp)
  // Constraints that repeat others (solvers/constraints/redundancy.hpp); `initial` leaves as many rows idle.
  std::vector<RedundantRow> redundant;
};

// Checks the scene as a mechanism and builds it. Throws Error, naming file, line and item, for unknown
// or duplicate names, open joints (with the gap), sections that are not positive definite, free massless
// nodes in a transient, relative angles beyond the metric's range.
Model compile(const Scene& scene);

// The same with forces of the program, which the scene and its studies know nothing of. Throws Error for places that they do
// not have.
Model compile(const Scene& scene, const Extensions& extensions);

// Why the forces of a scene have no potential; empty if they have one. Where they have, equilibria are
// stable or not by the inertia of their tangent (stability.hpp).
std::string without_potential(const Scene& scene);
inline bool has_potential(const Scene& scene) { return without_potential(scene).empty(); }

}  // namespace mbd
