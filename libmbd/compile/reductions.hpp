// <reduction>: parts of a scene that become one element of component modes. What is in one is compiled by itself, as a scene of
// its own, whose modes make the element; and read by itself too: records of places in it are those of that scene, with the
// motion of its nodes that the element's unknowns give.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "elements/component/component_batch.hpp"
#include "libmbd/compile/model.hpp"
#include "solvers/modes/component_modes.hpp"

namespace mbd {

// What is in which reduction. The scene must outlive it.
class ReductionMembers {
 public:
  explicit ReductionMembers(const Scene& scene);

  // That of a beam or body of that name; nullptr: none.
  const ReductionScene* of(std::string_view part) const;
  const ReductionScene* of(const Place& place) const {
    return place.kind == Place::Kind::ground ? nullptr : of(place.name);
  }
  // What is part of the reduction itself: the joint is fixed, between two places of one; the mass is at one.
  const ReductionScene* of(const JointScene& joint) const;
  const ReductionScene* of(const PointMassScene& mass) const { return of(mass.at); }

 private:
  std::unordered_map<std::string_view, const ReductionScene*> of_;
};

// A part by itself, as compile() does a scene; but sectional forces are linear in its deformation in the frame of that place,
// as its modes are: the strains of exact beams in a bend that modes make a straight one of would be none of the part's.
Model compile_part(const Scene& part, const Place& frame);

class ReducedPart {
 public:
  // Throws Error for what cannot be in one, and as compile() does of the part.
  ReducedPart(const Scene& scene, const ReductionMembers& members, const ReductionScene& reduction);

  const ReductionScene& scene() const { return *reduction_; }
  const Model& model() const { return *model_; }  // of the part by itself
  const ComponentModes& modes() const { return modes_; }

  // Of a node of the part's system, in that of the whole; -1: it has none there.
  int node_of(int own) const { return node_of_[static_cast<std::size_t>(own)]; }
  void set_node(int own, int node) { node_of_[static_cast<std::size_t>(own)] = node; }

  // The place in the part's system, and its frame in the node; nullptr: nothing is there that needs a node.
  const Model::PlaceFrame* find(const Place& place) const;

  // The state of the part's system in a state of the whole, of which it is that component.
  State state_within(const State& whole, const ComponentBatch& batch, Index component) const;

 private:
  const ReductionScene* reduction_;
  std::unique_ptr<const Model> model_;
  ComponentModes modes_;
  std::vector<int> node_of_;
  std::vector<Pose<double>> in_frame_;  // of the part's nodes but the ground, in that of the frame
};

}  // namespace mbd
