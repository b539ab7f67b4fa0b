#include "libmbd/compile/joints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "joints/driven_rotation.hpp"
#include "joints/driven_translation.hpp"
#include "joints/prescribed_rotation.hpp"
#include "joints/prescribed_translation.hpp"
#include "libmbd/compile/extending.hpp"
#include "libmbd/core/stop.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/reference_line.hpp"
#include "libmbd/text/spelling.hpp"

namespace mbd {
namespace {

// Two points of a joint closer than this, relative to the scene's length, are one.
constexpr double open_tolerance = 1e-9;
// Cosine of the angle between two axes that are called perpendicular.
constexpr double perpendicular = 1e-9;

// Kinds of joints that have an angle, or a displacement.
std::string kinds_with(bool angle) {
  std::vector<std::string_view> names;
  for (const schema::JointKind& kind : schema::joint_kinds())
    if (angle ? kind.traits.angle : kind.traits.displacement) names.push_back(kind.name);
  return list(names);
}

void check_direction(const std::optional<Vec3>& v, std::string_view attribute, const Source& source,
                     const std::string& who) {
  if (v && !(v->stableNorm() > 0.0 && std::isfinite(v->stableNorm())))
    throw Error(source, fmt::format("{}: {} has zero length; give a direction, such as 0 0 1", who,
                                    attribute));
}

}  // namespace

Mat3 frame_with_third(const Vec3& third, const std::optional<Vec3>& first) {
  const Vec3 e3 = third.stableNormalized();
  Index smallest = 0;
  e3.cwiseAbs().minCoeff(&smallest);
  const Vec3 across = first
                          ? Vec3(first->stableNormalized() - e3.dot(first->stableNormalized()) * e3)
                          : Vec3(Vec3::Unit(smallest).cross(e3));
  const Vec3 e1 = across.normalized();
  Mat3 R;
  R << e1, e3.cross(e1), e3;
  return R;
}

void check_axes(const std::optional<Vec3>& axis, const std::optional<Vec3>& second_axis,
                const Source& source, const std::string& who) {
  check_direction(axis, "axis", source, who);
  check_direction(second_axis, "second_axis", source, who);
  if (!second_axis) return;
  const double cosine = axis->stableNormalized().dot(second_axis->stableNormalized());
  if (!(std::abs(cosine) <= perpendicular))
    throw Error(source, fmt::format("{}: second_axis must be perpendicular to axis; they are "
                                    "at {:.10g} degrees",
                                    who, std::acos(cosine) * 180.0 / std::numbers::pi));
}

joint::AnyJointBatch* JointCompiler::find_batch(std::string_view type) const {
  for (const auto& batch : system_.batches()) {
    auto* joints = dynamic_cast<joint::AnyJointBatch*>(batch.get());
    if (joints != nullptr && joints->type() == type) return joints;
  }
  return nullptr;
}

// The batch of a joint type, made when first called for.
joint::AnyJointBatch* JointCompiler::batch_of(std::string_view type) {
  if (joint::AnyJointBatch* const made = find_batch(type)) return made;
  auto batch = joint::make_joint_batch(type);
  joint::AnyJointBatch* made = batch.get();
  system_.add_batch(std::move(batch));
  return made;
}

OwnJoint JointCompiler::add_own(const std::string& name, std::string_view type,
                                std::unique_ptr<joint::AnyJointBatch> (*make)(),
                                const joint::Definition& definition) {
  joint::AnyJointBatch* batch = find_batch(type);
  if (batch == nullptr) {
    std::unique_ptr<joint::AnyJointBatch> made = make();
    batch = made.get();
    system_.add_batch(std::move(made));
  }
  const Added added =
      add(batch, fmt::format("{} '{}'", type, name), label(type, name), scene_.source, definition);
  return {added.batch, added.index};
}

JointCompiler::Added JointCompiler::add(joint::AnyJointBatch* batch, const std::string& name,
                                        const std::string& label, const Source& source,
                                        joint::Definition definition) {
  ConstraintInfo info;
  info.name = name;
  const std::vector<joint::RowFacts> rows = batch->rows();
  for (const joint::RowFacts& row : rows) {
    info.is_position.push_back(row.is_length);
    info.row_names.push_back(row.name);
  }
  info.rows = static_cast<Index>(rows.size());
  makers_.insert(makers_.end(), rows.size(), {source, label});
  definition.constraint = static_cast<Index>(system_.constraints().size());
  definition.multiplier = system_.add_constraint(std::move(info));
  if (batch->traits().angle) definition.angle = system_.add_angle();
  return {batch, batch->add(definition, name), definition.angle};
}

void JointCompiler::add_all() {
  std::vector<std::string_view> names;
  for (const JointScene& j : scene_.joints) names.push_back(j.name);
  const std::unordered_set<std::string_view> known(names.begin(), names.end());
  for (const DriveScene& d : scene_.drives) {
    if (!known.contains(d.joint))
      throw Error(d.source, fmt::format("drive: there is no joint \"{}\"{}", excerpt(d.joint),
                                        suggest(d.joint, names, "joints")));
  }
  for (std::size_t i = 0; i < scene_.joints.size(); ++i) {
    const JointScene& j = scene_.joints[i];
    if (is_fused_(i)) {
      fused_.push_back({j.source, label(j)});
      readings_[j.name].what = label(j);
    } else {
      add_joint(j);
    }
  }
  for (const MotionScene& m : scene_.motions) add_motion(m);
}

// The point of a place in a joint of two points.
Vec3 JointCompiler::own_point(const Place& place, const Attachment& at, const JointScene& j,
                              std::string_view attribute) const {
  if (place.kind == Place::Kind::ground)
    throw Error(j.source, fmt::format("{}: the ground has no point of its own; give {}", label(j),
                                      attribute));
  return at.pose.r;
}

// A joint of a thing to itself: within a rigid part it is left out, and else an error.
void JointCompiler::leave_out(const JointScene& j, const Attachment& A) {
  const std::string who = label(j);
  if (A.rigid == nullptr)
    throw Error(j.source,
                fmt::format("{}: it joins a thing to itself{}; give two places that move apart",
                            who, A.node == 0 ? ", the ground" : ""));
  // It keeps what it joins from moving apart, which nothing can.
  readings_[j.name].why_none = fmt::format(
      "lies within {}, which transmits no forces that could be told apart", label(*A.rigid));
  for (const DriveScene& d : scene_.drives)
    if (d.joint == j.name)
      throw Error(d.source, fmt::format("drive: {} lies within {}, where nothing moves; leave "
                                        "the drive out",
                                        who, label(*A.rigid)));
}

// In the joint, of A and of B. A beam is joined at its node, but by an arm; ground and bodies anywhere.
std::array<Vec3, 2> JointCompiler::points_of(const JointScene& j, const joint::Traits& traits,
                                             const Attachment& A, const Attachment& B) const {
  if (traits.points == joint::Points::two)
    return {j.at_a ? *j.at_a : own_point(j.a, A, j, "at_a"),
            j.at_b ? *j.at_b : own_point(j.b, B, j, "at_b")};
  if (j.at) return {*j.at, *j.at};
  const bool at_b = traits.points == joint::Points::one_away
                        ? B.node != 0
                        : B.is_point || (!A.is_point && B.node != 0);
  const Vec3 point = (at_b ? B : A).pose.r;
  return {point, point};
}

void JointCompiler::check_closed(const JointScene& j, const Attachment& end,
                                 const Vec3& point) const {
  if (!end.is_point) return;
  const double gap = (end.pose.r - point).norm();
  if (!(gap <= open_tolerance * length_))
    throw Error(j.source, fmt::format("{}: it is open: {} is {:.6g} m from the joint's point "
                                      "({:.9g}, {:.9g}, {:.9g}); mend the "
                                      "geometry or leave out at=",
                                      label(j), system_.node_name(end.node), gap, point(0),
                                      point(1), point(2)));
}

joint::Definition JointCompiler::definition_of(const JointScene& j, const joint::Traits& traits,
                                               const Attachment& A, const Attachment& B) const {
  const auto [point_a, point_b] = points_of(j, traits, A, B);
  if (traits.points != joint::Points::one_away) {
    check_closed(j, A, point_a);
    check_closed(j, B, point_b);
  }
  const Mat3 R = j.axis ? frame_with_third(*j.axis, j.second_axis) : Mat3(Mat3::Identity());
  joint::Definition f;
  f.a = relative(reference(A.node), make_pose(R, point_a));
  f.b = relative(reference(B.node), make_pose(R, point_b));
  f.P = A.node;
  f.Q = B.node;
  if (j.parameter) f.parameter = *j.parameter;
  if (traits.points == joint::Points::two) {
    f.parameter = (point_b - point_a).norm();
    if (!(f.parameter > open_tolerance * length_))
      throw Error(j.source,
                  fmt::format("{}: its two points are the same; a distance needs a length "
                              "(at_a, at_b), a spherical joint holds points together",
                              label(j)));
  }
  return f;
}

void JointCompiler::add_joint(const JointScene& j) {
  const std::string who = label(j);
  const joint::Traits& traits = schema::find_joint_kind(j.kind)->traits;
  const Attachment A = find_(j.a, j.source, who), B = find_(j.b, j.source, who);
  if (A.node == B.node) return leave_out(j, A);
  check_axes(j.axis, j.second_axis, j.source, who);
  if (j.parameter && !(std::abs(*j.parameter) > 0.0))
    throw Error(j.source, fmt::format("{}: the {} is zero; give another, or a revolute joint", who,
                                      traits.parameter.name));
  const joint::Definition f = definition_of(j, traits, A, B);
  const auto [batch, i, followed] =
      add(batch_of(j.kind), fmt::format("{} '{}'", j.kind, j.name), who, j.source, f);
  definitions_[j.name] = f;
  definitions_[j.name].angle = followed;
  const auto bind = [b = batch, n = i](auto member) {
    return [b, n, member](const State& s) { return (b->*member)(s, n); };
  };
  Reading& reading = readings_[j.name];
  reading.what = label(j);
  if (traits.angle) reading.angle = bind(&joint::AnyJointBatch::angle);
  if (traits.displacement) reading.displacement = bind(&joint::AnyJointBatch::displacement);
  reading.relative_velocity = bind(&joint::AnyJointBatch::relative_velocity);
  reading.reaction = bind(&joint::AnyJointBatch::reaction);
  add_drives(j, f, 6 - batch->rows().size());
}

// `free`: how many motions the joint leaves.
void JointCompiler::add_drives(const JointScene& j, const joint::Definition& definition,
                               std::size_t free) {
  const DriveScene* previous = nullptr;
  for (const DriveScene& d : scene_.drives) {
    if (d.joint != j.name) continue;
    const auto is_turning = [](const DriveScene& x) { return x.rate || x.angle; };
    if (previous != nullptr && (free == 0 || is_turning(d) == is_turning(*previous)))
      throw Error(
          d.source,
          fmt::format(
              "drive: {} is driven twice{}; leave one drive out", label(j),
              previous->source.line > 0 ? fmt::format(" (line {})", previous->source.line) : ""));
    add_drive(d, j, definition);
    previous = &d;
    --free;
  }
}

void JointCompiler::add_drive(const DriveScene& d, const JointScene& j,
                              const joint::Definition& definition) {
  const joint::Traits& traits = schema::find_joint_kind(j.kind)->traits;
  const std::string who = fmt::format("drive: joint \"{}\"", excerpt(j.name));
  const bool turns = d.rate || d.angle;
  if (turns ? !traits.angle : !traits.displacement)
    throw Error(d.source,
                fmt::format("drive: {} has no {} to drive; joints that have one: {}", label(j),
                            turns ? "angle" : "displacement", kinds_with(turns)));
  joint::Definition f = definition;
  f.parameter = 0.0;
  f.signals[0] = d.rate    ? add_law(*d.rate, true, d.source, who, "angle")
                 : d.angle ? add_law(*d.angle, false, d.source, who, "angle")
                 : d.speed ? add_law(*d.speed, true, d.source, who, "displacement")
                           : add_law(*d.displacement, false, d.source, who, "displacement");
  const auto [batch, i, followed] =
      add(batch_of(turns ? joint::DrivenRotation::name : joint::DrivenTranslation::name),
          fmt::format("drive of '{}'", j.name), who, d.source, f);
  // What drives it belongs to what the joint transmits.
  Reading& reading = readings_[j.name];
  reading.reaction = [b = batch, n = i, joint = reading.reaction](const State& s) {
    return Vec6(joint(s) + b->reaction(s, n));
  };
}

void check_prescribed(const Expression& law, const Source& source, const std::string& who) {
  if (law.has_sensors())
    throw Error(
        source,
        fmt::format("{}: \"{}\" depends on a sensor, and a motion that is prescribed cannot "
                    "answer to the motion; let a <load> or a <joint_torque> of sensors act",
                    who, excerpt(law.text())));
  if (law.has_inputs() && !law.breakpoints().empty())
    throw Error(source,
                fmt::format("{}: \"{}\" depends on an input and switches in time: how far it jumps "
                            "there is not known; write the switch into the input",
                            who, excerpt(law.text())));
}

// A signal that may drive: continuous with its rate. Returns its index.
int JointCompiler::add_law(const Expression& law, bool is_rate, const Source& source,
                           const std::string& who, std::string_view what) {
  const double duration = scene_.transient ? scene_.transient->duration : 1.0;
  const auto signal = [&]() -> Signal {
    try {
      if (is_rate) return Signal::from_rate(law, 0.0, 0.0, duration);
      return law.is_constant() ? Signal::constant(law.value()) : Signal::from_expression(law);
    } catch (const Stopped&) {
      throw;
    } catch (const Error& e) {
      throw Error(source, fmt::format("{}: {}", who, e.what()));
    }
  }();
  check_prescribed(law, source, who);
  std::vector<Jump> jumps = signal.jumps();
  if (const auto hidden = signal.undeclared_jump(0.0, duration)) jumps.push_back(*hidden);
  for (const Jump& jump : jumps) {
    if (jump.derivative < 2 && jump.t >= 0.0 && jump.t <= duration) {
      throw Error(source,
                  fmt::format("{}: the {} jumps by {:.6g} at t = {:.9g} s, an impact; make the law "
                              "continuous",
                              who, jump.derivative != 0 ? std::string_view("rate") : what,
                              jump.size, jump.t));
    }
  }
  // The scene is drawn where the law starts; without a transient the value at t = 0 grows from nothing.
  const double nothing = 1e-12 * (what == "displacement" ? length_ : 1.0);
  if (const double start = signal(0.0, Side::right, system_.initial_inputs()).f;
      scene_.transient && !(std::abs(start) <= nothing))
    throw Error(source,
                fmt::format("{}: the {} is {:.6g} at t = 0, but must start at 0: it counts from "
                            "the geometry as given; subtract this from the law",
                            who, what, start));
  return static_cast<int>(system_.add_signal(
      signal, SignalUse::drive,
      said(source, fmt::format("{}: {} \"{}\"", who,
                               is_rate ? fmt::format("the rate of the {}", what) : what,
                               excerpt(law.text())))));
}

void check_motion(const MotionScene& m, const Attachment& at) {
  const std::string who = label(m);
  if (at.node == 0)
    throw Error(m.source, fmt::format("{}: the ground does not move; give a beam or a body", who));
  if (m.displacement && m.velocity)
    throw Error(m.source, fmt::format("{}: give a displacement or a velocity, not both", who));
  if (m.angle && m.rate)
    throw Error(m.source, fmt::format("{}: give an angle or a rate, not both", who));
  const bool turns = m.angle || m.rate;
  if (m.rotation && (turns || m.axis))
    throw Error(m.source,
                fmt::format("{}: give a rotation vector, or an axis and an angle or rate", who));
  if (turns != m.axis.has_value())
    throw Error(m.source, fmt::format("{}: {}", who,
                                      turns ? "an angle or a rate needs an axis; give one"
                                            : "an axis needs an angle or a rate; or leave it out"));
  check_direction(m.axis, "axis", m.source, who);
  if (!m.displacement && !m.velocity && !m.rotation && !turns)
    throw Error(m.source,
                fmt::format("{}: it prescribes nothing; give a displacement, a velocity, a "
                            "rotation, or an axis and an angle or a rate",
                            who));
}

// Adds one joint of the motion to the ground, whose signals are along R.
void JointCompiler::prescribe(const MotionScene& m, int node, std::string_view type, const Mat3& R,
                              const Vec3& point, std::array<int, 3> signals) {
  const Pose<double> H = make_pose(R, point);
  joint::Definition f;
  f.a = H;
  f.b = relative(reference(node), H);
  f.Q = node;
  f.signals = signals;
  const auto [batch, i, followed] =
      add(batch_of(type), fmt::format("motion '{}'", m.name), label(m), m.source, f);
  Reading& reading = readings_[m.name];
  reading.what = label(m);
  reading.reaction = [b = batch, n = i, R, before = reading.reaction](const State& s) {
    const Vec6 r = b->reaction(s, n);
    const Vec6 f_i = six<double>(R * Vec3(linear(r)), R * Vec3(angular(r)));
    return before ? Vec6(before(s) + f_i) : f_i;
  };
};

// The node's pose is the reference moved by d(t) and turned by exp(theta(t)), both in inertial axes; only
// what is given is held. Frames a and b have inertial axes, or e3 along the axis of turning.
void JointCompiler::add_motion(const MotionScene& m) {
  const std::string who = label(m);
  const Attachment at = find_(m.of, m.source, who);
  check_motion(m, at);
  const auto laws = [&](const std::array<Expression, 3>& components, bool is_rate,
                        std::string_view what) {
    std::array<int, 3> signals{};
    for (std::size_t i = 0; i < 3; ++i)
      signals[i] = add_law(components[i], is_rate, m.source, who, what);
    return signals;
  };
  const auto hold = [&](std::string_view type, const Mat3& R, const std::array<int, 3>& signals) {
    prescribe(m, at.node, type, R, at.pose.r, signals);
  };
  if (m.displacement || m.velocity)
    hold(joint::PrescribedTranslation::name, Mat3::Identity(),
         laws(m.displacement ? *m.displacement : *m.velocity, m.velocity.has_value(),
              "displacement"));
  if (m.rotation)
    hold(joint::PrescribedRotation::name, Mat3::Identity(), laws(*m.rotation, false, "rotation"));
  if (m.angle || m.rate)
    hold(
        joint::PrescribedRotation::name, frame_with_third(*m.axis),
        {-1, -1, add_law(m.rate ? *m.rate : *m.angle, m.rate.has_value(), m.source, who, "angle")});
}

// --- what acts along free coordinates ---

const joint::Definition& JointCompiler::coordinate(const std::string& joint, bool turns,
                                                   const Source& source,
                                                   const std::string& who) const {
  for (const JointScene& j : scene_.joints) {
    if (j.name != joint) continue;
    const joint::Traits& traits = schema::find_joint_kind(j.kind)->traits;
    if (turns ? !traits.angle : !traits.displacement)
      throw Error(source, fmt::format("{}: {} has no {}; joints that have one: {}", who, label(j),
                                      turns ? "angle" : "displacement", kinds_with(turns)));
    if (const std::string& why = readings_.at(joint).why_none; !why.empty())
      throw Error(source, fmt::format("{}: {} {}; leave it out", who, label(j), why));
    return definitions_.at(joint);
  }
  std::vector<std::string_view> names;
  for (const JointScene& j : scene_.joints) names.push_back(j.name);
  throw Error(source, fmt::format("{}: there is no joint \"{}\"{}", who, excerpt(joint),
                                  suggest(joint, names, "joints")));
}

// --- output ---

std::vector<Model::JointFrames> JointCompiler::frames() const {
  std::vector<Model::JointFrames> all;
  for (const JointScene& j : scene_.joints)
    if (const auto it = definitions_.find(j.name); it != definitions_.end()) {
      const joint::Definition& f = it->second;
      const Reading& reading = readings_.at(j.name);
      all.push_back({j.name, f.P, f.Q, f.a, f.b, reading.angle, reading.reaction});
    }
  return all;
}

schema::JointReading JointCompiler::reading(const RecordScene& record,
                                            const schema::Quantity& quantity) const {
  using Of = schema::Quantity::Of;
  const auto it = readings_.find(*record.joint);
  if (it == readings_.end()) {
    std::vector<std::string_view> names;
    for (const auto& [known, r] : readings_) names.push_back(known);
    throw Error(record.source,
                fmt::format("{}: there is no joint \"{}\"{}", label(record), excerpt(*record.joint),
                            suggest(*record.joint, names, "joints and motions")));
  }
  const Reading& r = it->second;
  if (!r.why_none.empty())
    throw Error(record.source, fmt::format("{}: joint \"{}\" {}; leave the record out",
                                           label(record), excerpt(*record.joint), r.why_none));
  const bool turning = quantity.of == Of::joint_with_angle;
  const bool sliding = quantity.of == Of::joint_with_displacement;
  if ((turning && !r.angle) || (sliding && !r.displacement))
    throw Error(record.source,
                fmt::format("{}: {} has no {}; joints that have one: {}", label(record), r.what,
                            turning ? "angle" : "displacement", kinds_with(turning)));
  schema::JointReading result = r;
  result.rates = scene_.transient.has_value();
  return result;
}

}  // namespace mbd
