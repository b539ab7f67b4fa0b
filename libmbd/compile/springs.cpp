#include "libmbd/compile/springs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libmbd/scene/label.hpp"
#include "libmbd/scene/laws.hpp"
#include "libmbd/scene/reference_line.hpp"
#include "libmbd/text/spelling.hpp"

namespace mbd {

namespace {

// f(shared, data, states of the nodes) of the element added last.
template <class E, class F>
auto reader_of(const ElementBatch<E>& batch, const F& f) {
  return [all = &batch, e = batch.size() - 1, f](const State& state) {
    typename ElementBatch<E>::NodeStates x;
    all->gather(state, static_cast<std::size_t>(e), x);
    return f(all->shared(), all->data(e), x.data());
  };
}

}  // namespace

template <class E>
ElementBatch<E>& Springs::batch(std::unique_ptr<ElementBatch<E>>& made) {
  if (!made) made = std::make_unique<ElementBatch<E>>(E::name, typename E::Shared{});
  return *made;
}

Characteristic Springs::characteristic(double coefficient, const std::optional<LawScene>& law,
                                       std::vector<Law>& laws) {
  Characteristic result{coefficient, -1};
  if (law) {
    result.law = static_cast<int>(laws.size());
    laws.push_back(make_law(*law));
  }
  return result;
}

std::optional<std::array<Attachment, 2>> Springs::ends(const Place& a, const Place& b,
                                                       const Source& source,
                                                       const std::string& who) const {
  const Attachment P = find_(a, source, who), Q = find_(b, source, who);
  if (P.node == Q.node && P.rigid != nullptr) return std::nullopt;
  if (P.node == Q.node)
    throw Error(source, fmt::format("{}: it is between a thing and itself{}; give two places that "
                                    "move apart",
                                    who, P.node == 0 ? ", the ground" : ""));
  return std::array{P, Q};
}

void Springs::add(const SpringScene& spring) {
  constexpr double same = 1e-9;  // relative to the scene's length
  const std::string who = label(spring);
  const auto places = ends(spring.a, spring.b, spring.source, who);
  if (!places) return;
  const auto& [P, Q] = *places;
  const std::array ends_of{P.node, Q.node};
  const auto point = [&](const std::optional<Vec3>& given, const Attachment& at,
                         std::string_view attribute) {
    if (!given && at.node == 0)
      throw Error(spring.source,
                  fmt::format("{}: the ground has no point of its own; give {}", who, attribute));
    return given ? *given : at.pose.r;
  };
  const Vec3 a = point(spring.at_a, P, "at_a"), b = point(spring.at_b, Q, "at_b");
  const double distance = (b - a).norm();
  if (!(distance > same * length_))
    throw Error(spring.source,
                fmt::format("{}: its two points are the same, and the line between them has no "
                            "direction; move one of them (at_a, at_b), or give a <bushing>",
                            who));
  const two_points::Ends points{inverse(system_.reference_pose(P.node)) * a,
                                inverse(system_.reference_pose(Q.node)) * b, distance};
  const std::string name = fmt::format("spring '{}'", spring.name);
  Reading& reading = readings_[spring.name];
  reading.what = who;
  reading.length = [P = P.node, Q = Q.node, points,
                    rates = rates_](const State& state) -> schema::SpringReading::Length {
    std::array<NodeState<double>, 2> x;
    for (const auto& [node, at] : {std::pair{P, &x[0]}, {Q, &x[1]}}) {
      const auto n = static_cast<std::size_t>(node);
      *at = {state.pose[n], rates ? state.V[n] : Vec6(Vec6::Zero()), Vec6::Zero()};
    }
    const two_points::Line<double> line(points, x.data());
    return {line.l, line.rate(x.data())};
  };
  if (spring.stiffness > 0.0 || spring.force) {
    ElementBatch<Spring>& all = batch(springs_);
    all.add({points, spring.length.value_or(distance),
             characteristic(spring.stiffness, spring.force, all.shared().laws)},
            ends_of, name);
    reading.efforts.push_back(reader_of(all, Spring::tension));
  }
  if (rates_ && (spring.damping > 0.0 || spring.damping_force)) {
    ElementBatch<Damper>& all = batch(dampers_);
    all.add({points, characteristic(spring.damping, spring.damping_force, all.shared().laws)},
            ends_of, name);
    reading.efforts.push_back(reader_of(all, Damper::tension));
  }
}

void Springs::add(const BushingScene& bushing) {
  const std::string who = label(bushing);
  const auto places = ends(bushing.a, bushing.b, bushing.source, who);
  if (!places) return;
  const auto& [P, Q] = *places;
  const std::array ends_of{P.node, Q.node};
  check_axes(bushing.axis, bushing.second_axis, bushing.source, who);
  const Vec3 point = bushing.at ? *bushing.at : (Q.node != 0 ? Q : P).pose.r;
  const Mat3 R =
      bushing.axis ? frame_with_third(*bushing.axis, bushing.second_axis) : Mat3(Mat3::Identity());
  const Pose<double> H = make_pose(R, point);
  const two_frames::Ends frames{relative(system_.reference_pose(P.node), H),
                                relative(system_.reference_pose(Q.node), H)};
  const std::string name = fmt::format("bushing '{}'", bushing.name);
  Reading& reading = readings_[bushing.name];
  reading.what = who;
  reading.of = schema::Quantity::Of::bushing;
  if (!bushing.stiffness.isZero(0.0) || !bushing.laws.empty()) {
    ElementBatch<Bushing>& all = batch(bushings_);
    Bushing::Data data{.ends = frames, .K = bushing.stiffness};
    for (const BushingLawScene& law : bushing.laws) {
      data.laws[static_cast<std::size_t>(law.component - 1)] =
          static_cast<int>(all.shared().laws.size());
      all.shared().laws.push_back(make_law(law.force));
    }
    all.add(data, ends_of, name);
    reading.wrenches.push_back(reader_of(all, Bushing::wrench));
  }
  if (rates_ && !bushing.damping.isZero(0.0)) {
    ElementBatch<BushingDamper>& all = batch(bushing_dampers_);
    all.add({frames, bushing.damping}, ends_of, name);
    reading.wrenches.push_back(reader_of(all, BushingDamper::wrench));
  }
}

template <>
Springs::Along<joint::Turning>& Springs::along() {
  return turning_;
}
template <>
Springs::Along<joint::Sliding>& Springs::along() {
  return sliding_;
}

template <class Coordinate>
void Springs::add_along(const JointSpringScene& spring, const joint::Definition& d) {
  const joint::Axis axis{{d.a, d.b}, d.angle};
  const std::array nodes{d.P, d.Q};
  const std::string name = fmt::format("joint spring '{}'", spring.name);
  Reading& reading = readings_[spring.name];
  reading.what = label(spring);
  reading.of = std::is_same_v<Coordinate, joint::Turning>
                   ? schema::Quantity::Of::spring_of_angle
                   : schema::Quantity::Of::spring_of_displacement;
  // At the angle that the joint has now.
  const auto read = [&reading, axis]<class E>(const ElementBatch<E>& all, auto effort) {
    reading.efforts.push_back([batch = &all, e = all.size() - 1, axis, effort](const State& state) {
      typename ElementBatch<E>::NodeStates x;
      batch->gather(state, static_cast<std::size_t>(e), x);
      const double near = axis.angle < 0 ? 0.0 : state.angles[static_cast<std::size_t>(axis.angle)];
      return -effort(batch->shared(), batch->data(e), x.data(), near);
    });
  };
  if (spring.stiffness > 0.0 || spring.force) {
    auto& all = batch(along<Coordinate>().springs);
    all.add({axis, spring.rest, characteristic(spring.stiffness, spring.force, all.shared().laws)},
            nodes, name);
    read(all, joint::JointSpring<Coordinate>::effort);
  }
  if (rates_ && (spring.damping > 0.0 || spring.damping_force)) {
    auto& all = batch(along<Coordinate>().dampers);
    all.add({axis, characteristic(spring.damping, spring.damping_force, all.shared().laws)}, nodes,
            name);
    read(all, joint::JointDamper<Coordinate>::effort);
  }
}

void Springs::add(const JointSpringScene& spring) {
  const bool turns = spring.coordinate == JointSpringScene::Coordinate::angle;
  const joint::Definition& definition =
      joints_.coordinate(spring.joint, turns, spring.source, label(spring));
  if (turns)
    add_along<joint::Turning>(spring, definition);
  else
    add_along<joint::Sliding>(spring, definition);
}

template <class Coordinate>
void Springs::add_torque(const JointTorqueScene& torque, const Expression& law,
                         std::string_view what) {
  const joint::Definition& d = joints_.coordinate(
      torque.joint, std::is_same_v<Coordinate, joint::Turning>, torque.source, label(torque));
  if (law.is_constant() && law.value() == 0.0) return;
  const auto signal = system_.add_signal(
      law.is_constant() ? Signal::constant(law.value()) : Signal::from_expression(law),
      SignalUse::load,
      said(torque.source, fmt::format("{} of \"{}\": {} \"{}\"", label(torque), torque.joint, what,
                                      excerpt(law.text()))));
  batch(along<Coordinate>().torques)
      .add({{d.a, d.b}, static_cast<int>(signal)}, std::array{d.P, d.Q},
           fmt::format("{} of joint '{}'", what, torque.joint));
}

void Springs::add(const JointTorqueScene& torque) {
  if (torque.moment) add_torque<joint::Turning>(torque, *torque.moment, "moment");
  if (torque.force) add_torque<joint::Sliding>(torque, *torque.force, "force");
}

schema::SpringReading Springs::reading(const RecordScene& record,
                                       const schema::Quantity& quantity) const {
  const auto found = readings_.find(*record.spring);
  if (found == readings_.end()) {
    std::vector<std::string_view> names;
    for (const auto& [known, r] : readings_) names.push_back(known);
    throw Error(record.source,
                fmt::format("{}: there is no spring \"{}\"{}", label(record),
                            excerpt(*record.spring), suggest(*record.spring, names, "springs")));
  }
  const Reading& reading = found->second;
  if (quantity.of != reading.of) {
    std::vector<std::string_view> own;
    for (const schema::Quantity& q : schema::spring_quantities())
      if (q.of == reading.of) own.push_back(q.name);
    throw Error(record.source, fmt::format("{}: {} has no {}; it has: {}", label(record),
                                           reading.what, quantity.name, list(own)));
  }
  schema::SpringReading result;
  result.length = reading.length;
  result.wrench = [all = reading.wrenches](const State& s) {
    Vec6 sum = Vec6::Zero();
    for (const auto& one : all) sum -= one(s);
    return sum;
  };
  result.effort = [all = reading.efforts](const State& s) {
    double sum = 0.0;
    for (const auto& one : all) sum += one(s);
    return sum;
  };
  return result;
}

void Springs::finish() {
  const auto hand_over = [this](auto& made) {
    if (made) system_.add_batch(std::move(made));
  };
  hand_over(springs_);
  hand_over(dampers_);
  hand_over(bushings_);
  hand_over(bushing_dampers_);
  const auto all = [&](auto& of) {
    hand_over(of.springs);
    hand_over(of.dampers);
    hand_over(of.torques);
  };
  all(turning_);
  all(sliding_);
}

}  // namespace mbd
