#include "libmbd/compile/fusion.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>

#include "joints/fixed.hpp"
#include "libmbd/scene/reference_line.hpp"

namespace mbd {
namespace {

// The end of a beam is at its joint's point if no farther away than this, relative to the longer beam: less than what
// joints.cpp allows, relative to the scene, which says what is open.
constexpr double same_point = 3e-10;
// Of velocities of one group, relative to them.
constexpr double same_velocity = 1e-11;

std::string key(char kind, std::string_view name) { return kind + std::string(name); }
std::string key(std::string_view beam, std::size_t boundary) {
  return key('.', beam) + '@' + std::to_string(boundary);
}

}  // namespace

std::size_t nearest_boundary(std::span<const double> boundaries, double s) {
  const auto above = std::lower_bound(boundaries.begin(), boundaries.end(), s);
  auto i = static_cast<std::size_t>(above - boundaries.begin());
  if (i == boundaries.size()) return i - 1;
  if (i > 0 && std::abs(boundaries[i - 1] - s) <= std::abs(boundaries[i] - s)) --i;
  return i;
}

Fusion::Found Fusion::find(const Place& place) { return find(place, 0); }

const ReferenceLine& Fusion::line_of(const BeamScene& beam) {
  ReferenceLine& line = lines_[beam.name];
  if (!line.at) line = make_reference_line(beam);
  return line;
}

// A rigid group has the frame of its first, and the velocity of those of its bodies that have any.
Fusion::Member Fusion::member_of(const RigidScene& rigid) {
  Member one;
  if (const auto first = bodies_.find(rigid.of.front()); first != bodies_.end())
    one.pose = make_pose(first->second->orientation, first->second->at);
  else if (const auto beam = lines_of_.find(rigid.of.front()); beam != lines_of_.end())
    one.pose = line_of(*beam->second).at(0.0);
  for (const std::string& name : rigid.of) {
    const auto body = bodies_.find(name);
    if (body == bodies_.end()) continue;
    const BodyScene& b = *body->second;
    if (b.velocity.isZero() && b.angular_velocity.isZero()) continue;
    one.angular_velocity = b.orientation * b.angular_velocity;
    one.velocity = b.velocity + one.angular_velocity.cross(one.pose.r - b.at);
  }
  return one;
}

Fusion::Found Fusion::find(const Place& place, int depth) {
  constexpr int deepest = 100;  // bodies attached to each other in a ring are refused later
  if (place.kind == Place::Kind::ground || depth > deepest) return {};
  const auto member = [this](std::string name, const auto& make) {
    const auto [it, is_new] = members_.try_emplace(std::move(name), static_cast<int>(all_.size()));
    if (is_new) {
      all_.push_back(make());
      joined_.add();
    }
    return it->second;
  };
  const auto of_body = [](const BodyScene& body) {
    return Member{make_pose(body.orientation, body.at), body.velocity,
                  body.orientation * body.angular_velocity};  // which is given in body axes
  };
  const auto rigid = rigid_of_.find(place.name);
  if (place.kind == Place::Kind::body) {
    const auto it = bodies_.find(place.name);
    if (it == bodies_.end()) return {};
    const BodyScene& body = *it->second;
    if (body.attached_to) return find(*body.attached_to, depth + 1);
    const Pose<double> pose = make_pose(body.orientation, body.at);
    if (rigid != rigid_of_.end())
      return {member(key('r', rigid->second->name), [&] { return member_of(*rigid->second); }),
              pose, false};
    return {member(key('b', body.name), [&] { return of_body(body); }), pose, false};
  }
  const auto scene = lines_of_.find(place.name);
  if (scene == lines_of_.end()) return {};
  if (rigid != rigid_of_.end())
    return {member(key('r', rigid->second->name), [&] { return member_of(*rigid->second); }),
            line_of(*scene->second).at(place.parameter), true, line_of(*scene->second).length};
  const auto it = beams_.find(place.name);
  if (it == beams_.end()) return {};
  const Beam& beam = *it->second;
  const std::size_t i = nearest_boundary(beam.boundaries, place.parameter);
  const ReferenceLine& line = line_of(*beam.beam);
  const Pose<double> pose = line.at(beam.boundaries[i]);
  return {member(key(place.name, i), [&] { return Member{pose}; }), pose, true, line.length};
}

void Fusion::index(std::span<const Beam> beams) {
  for (const BodyScene& body : scene_.bodies) bodies_.try_emplace(body.name, &body);
  for (const BeamScene& beam : scene_.beams) lines_of_.try_emplace(beam.name, &beam);
  // What is in a reduction has no node for what is outside.
  for (const ReductionScene& reduction : scene_.reductions)
    for (const std::string& name : reduction.of) bodies_.erase(name), lines_of_.erase(name);
  for (const RigidScene& rigid : scene_.rigids)
    for (const std::string& name : rigid.of) rigid_of_.try_emplace(name, &rigid);
  for (const Beam& beam : beams) beams_.try_emplace(beam.beam->name, &beam);
}

namespace {

// Joints of which more is said than that they hold.
std::unordered_set<std::string_view> joints_in_use(const Scene& scene) {
  std::unordered_set<std::string_view> used;
  for (const RecordScene& record : scene.records)
    if (record.joint) used.insert(*record.joint);
  for (const DriveScene& drive : scene.drives) used.insert(drive.joint);
  for (const JointSpringScene& spring : scene.joint_springs) used.insert(spring.joint);
  for (const JointTorqueScene& torque : scene.joint_torques) used.insert(torque.joint);
  return used;
}

}  // namespace

Fusion::Fusion(const Scene& scene, std::span<const Beam> beams) : scene_(scene) {
  fused_.assign(scene.joints.size(), 0);
  if (scene.transient && scene.transient->inertia != InertiaTerms::full) return;
  const auto is_fixed = [](const JointScene& j) { return j.kind == joint::Fixed::name; };
  if (std::none_of(scene.joints.begin(), scene.joints.end(), is_fixed)) return;
  index(beams);

  const std::unordered_set<std::string_view> used = joints_in_use(scene);

  std::vector<int> refused;                   // members of groups that stay apart
  std::vector<std::pair<int, int>> together;  // what acts between two members
  std::vector<int> of_joint(scene.joints.size(), -1);
  for (std::size_t i = 0; i < scene.joints.size(); ++i) {
    const JointScene& j = scene.joints[i];
    const Found A = find(j.a), B = find(j.b);
    if (A.member < 0 || B.member < 0) continue;
    const Vec3 point = j.at ? *j.at : (B.is_point || !A.is_point ? B : A).pose.r;
    const auto is_open = [&](const Found& end) {
      return end.is_point &&
             !((end.pose.r - point).norm() <= same_point * std::max(A.size, B.size));
    };
    if (!is_fixed(j) || used.contains(j.name) || A.member == B.member || is_open(A) || is_open(B)) {
      together.emplace_back(A.member, B.member);
      continue;
    }
    of_joint[i] = A.member;
    if (joined_.root(A.member) == joined_.root(B.member)) refused.push_back(A.member);
    joined_.join(A.member, B.member);
  }
  const auto acts = [&](const auto& items) {
    for (const auto& item : items) {
      const Found A = find(item.a), B = find(item.b);
      if (A.member >= 0 && B.member >= 0) together.emplace_back(A.member, B.member);
    }
  };
  acts(scene.springs);
  acts(scene.bushings);
  for (const auto& [a, b] : together)
    if (joined_.root(a) == joined_.root(b)) refused.push_back(a);

  refuse_other_velocities(refused);
  number_groups(refused, of_joint);
}

// Members that would not move as their group does.
void Fusion::refuse_other_velocities(std::vector<int>& refused) {
  for (int m = 0; m < static_cast<int>(all_.size()); ++m) {
    const Member &one = all_[static_cast<std::size_t>(m)],
                 &first = all_[static_cast<std::size_t>(joined_.root(m))];
    const Vec3 turning = first.angular_velocity.cross(one.pose.r - first.pose.r);
    const Vec3 velocity = first.velocity + turning;
    const double speed = std::max({first.velocity.norm(), one.velocity.norm(), turning.norm()});
    const double spin = std::max(first.angular_velocity.norm(), one.angular_velocity.norm());
    if (!((one.velocity - velocity).norm() <= same_velocity * speed) ||
        !((one.angular_velocity - first.angular_velocity).norm() <= same_velocity * spin))
      refused.push_back(m);
  }
}

void Fusion::number_groups(const std::vector<int>& refused, const std::vector<int>& of_joint) {
  std::vector<char> apart(all_.size(), 0), has_joint(all_.size(), 0);
  for (const int m : refused) apart[static_cast<std::size_t>(joined_.root(m))] = 1;
  for (std::size_t i = 0; i < of_joint.size(); ++i) {
    if (of_joint[i] < 0) continue;
    const auto r = static_cast<std::size_t>(joined_.root(of_joint[i]));
    if (apart[r] != 0) continue;
    fused_[i] = 1;
    has_joint[r] = 1;
  }
  group_.assign(all_.size(), -1);
  for (int m = 0; m < static_cast<int>(all_.size()); ++m) {
    const int r = joined_.root(m);
    if (has_joint[static_cast<std::size_t>(r)] == 0) continue;
    int& group = group_[static_cast<std::size_t>(r)];  // the root comes first
    if (group < 0) group = groups_++;
    group_[static_cast<std::size_t>(m)] = group;
  }
}

int Fusion::group_of_body(const std::string& body) const {
  const auto it = members_.find(key('b', body));
  return it == members_.end() || group_.empty() ? -1 : group_[static_cast<std::size_t>(it->second)];
}

int Fusion::group_of_rigid(const std::string& rigid) const {
  const auto it = members_.find(key('r', rigid));
  return it == members_.end() || group_.empty() ? -1 : group_[static_cast<std::size_t>(it->second)];
}

int Fusion::group_of_boundary(const std::string& beam, std::size_t boundary) const {
  const auto it = members_.find(key(beam, boundary));
  return it == members_.end() || group_.empty() ? -1 : group_[static_cast<std::size_t>(it->second)];
}

}  // namespace mbd
