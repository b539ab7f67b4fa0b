// What <fixed> joins becomes one node: which joints need no multipliers, because what they join moves as one anyway.
//
// Members are what would have a node each: free bodies, rigid groups, and places of flexible beams at which elements
// meet or end. A fixed joint is fused where that changes nothing but the number of unknowns. It is kept, with its
// multipliers, where
//   one of its two things is the ground, or its reactions are recorded;
//   its group of fixed joints holds something twice (a loop), or another joint, spring or bushing acts within the
//   group, or its initial velocities do not agree: what is said of these is said of constraints;
//   inertia="no_gyroscopic" asks for the inertia of each node about its own mass centre.
#pragma once

#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "libmbd/core/disjoint_sets.hpp"
#include "libmbd/core/se3.hpp"
#include "libmbd/scene/reference_line.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd {

// Which of the boundaries, rising, is the nearest to s; of two the first.
std::size_t nearest_boundary(std::span<const double> boundaries, double s);

class Fusion {
 public:
  // A flexible beam, and where its elements end.
  struct Beam {
    const BeamScene* beam;
    std::span<const double> boundaries;  // fractions of its length, rising
  };

  // Both must outlive it. Unknown names, which compile reports, are passed over. Throws Error as make_reference_line.
  Fusion(const Scene& scene, std::span<const Beam> beams);

  // The group of what is one node; -1: it is a node of its own.
  int group_of_body(const std::string& body) const;
  int group_of_rigid(const std::string& rigid) const;
  int group_of_boundary(const std::string& beam, std::size_t boundary) const;

  int groups() const { return groups_; }
  bool is_fused(std::size_t joint) const { return fused_[joint] != 0; }  // index in Scene::joints

 private:
  struct Member {
    Pose<double> pose;                                              // of its node
    Vec3 velocity = Vec3::Zero(), angular_velocity = Vec3::Zero();  // inertial axes
  };
  // The member at a place; -1: the ground, or what is not known.
  struct Found {
    int member = -1;
    Pose<double> pose;
    bool is_point = false;
    double size = 0.0;  // of a beam, its length [m]
  };

  Found find(const Place& place);
  Found find(const Place& place, int depth);
  const ReferenceLine& line_of(const BeamScene& beam);
  Member member_of(const RigidScene& rigid);
  void index(std::span<const Beam> beams);
  // `refused`: members of groups that stay apart; `of_joint`: a member of the group of each joint, or -1.
  void refuse_other_velocities(std::vector<int>& refused);
  void number_groups(const std::vector<int>& refused, const std::vector<int>& of_joint);

  const Scene& scene_;
  std::unordered_map<std::string_view, const BodyScene*> bodies_;
  std::unordered_map<std::string_view, const RigidScene*> rigid_of_;
  std::unordered_map<std::string_view, const Beam*> beams_;
  std::unordered_map<std::string_view, const BeamScene*> lines_of_;
  std::unordered_map<std::string, int> members_;  // by kind and name
  std::unordered_map<std::string_view, ReferenceLine> lines_;
  std::vector<Member> all_;
  DisjointSets joined_;  // members
  std::vector<int> group_;
  std::vector<char> fused_;
  int groups_ = 0;
};

}  // namespace mbd
