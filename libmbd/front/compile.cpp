// Scene -> Model: the only place that knows both what a scene says and which types exist.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "elements/element_batch.hpp"
#include "elements/gravity.hpp"
#include "elements/mass.hpp"
#include "joints/any_joint_batch.hpp"
#include "joints/driven_rotation.hpp"
#include "libmbd/front/loads.hpp"
#include "libmbd/front/model.hpp"
#include "libmbd/front/reference_line.hpp"
#include "libmbd/front/schema.hpp"
#include "libmbd/front/section_table.hpp"
#include "libmbd/front/spelling.hpp"
#include "solvers/initial.hpp"

namespace mbd {
namespace {

// Two points of a joint closer than this, relative to the scene's length, are one.
constexpr double open_tolerance = 1e-9;
// Two beam parameters closer than this are one.
constexpr double same_parameter = 1e-9;

// Rotation whose third column is `third`; the first is any perpendicular one.
Mat3 frame_with_third(const Vec3& third) {
  const Vec3 e3 = third.normalized();
  Index smallest = 0;
  e3.cwiseAbs().minCoeff(&smallest);
  const Vec3 e1 = Vec3::Unit(smallest).cross(e3).normalized();
  Mat3 R;
  R << e1, e3.cross(e1), e3;
  return R;
}

// Where an element ends: for resultants.
struct ElementEnd {
  const BeamElasticBatch* batch;
  Index element;
  double xi;
};

struct CompiledBeam {
  const BeamScene* scene;
  std::vector<double> boundaries;             // parameters, with 0 and 1
  std::vector<int> boundary_nodes;            // node at each
  std::vector<std::vector<ElementEnd>> ends;  // elements that meet at each
  std::vector<BeamNode> nodes;  // those of each element in turn; ends of elements twice
};

// A node something is attached to, and the rigid frame of the place in it.
struct Attachment {
  int node = 0;
  bool is_point = false;  // a beam node: joints act at the node itself
};

class Compiler {
 public:
  explicit Compiler(const Scene& scene) : scene_(scene), system_(std::make_unique<System>()) {}

  Model compile() {
    check_names();
    check_sections();
    for (const BeamScene& beam : scene_.beams) find_boundaries(beam);
    for (const BodyScene& body : scene_.bodies) add_body(body);
    for (CompiledBeam& beam : beams_) add_beam(beam);
    for (const BodyScene& body : scene_.bodies) attach_body(body);
    for (const PointMassScene& mass : scene_.point_masses) add_point_mass(mass);
    measure();
    if (scene_.transient) add_inertia();
    if (scene_.gravity) add_gravity();
    add_loads();
    add_joints();

    for (auto& [key, batch] : elastic_) system_->add_batch(std::move(batch));
    if (!scene_.transient && !scene_.statics)
      throw Error({scene_.file, 1},
                  "the scene asks for no analysis; add <static/> or <transient .../>");
    system_->finish(scene_.transient.has_value(), length_);

    Model model;
    model.initial = system_->reference_state();
    set_velocities(model.initial);
    check(model.initial);
    add_channels(model);
    model.system = std::move(system_);
    return model;
  }

 private:
  // --- names and sections ---

  void check_names() const {
    std::map<std::string, const Source*> seen;
    const auto add = [&seen](const std::string& name, const Source& source, std::string_view what) {
      if (name.empty()) throw Error(source, fmt::format("{} has no name", what));
      const auto [other, is_new] = seen.emplace(name, &source);
      if (!is_new) {
        throw Error(
            source,
            fmt::format(
                "the name \"{}\" is taken{}; names of beams, bodies and joints must differ", name,
                other->second->line > 0 ? fmt::format(" (line {})", other->second->line) : ""));
      }
    };
    for (const BeamScene& b : scene_.beams) add(b.name, b.source, "a beam");
    for (const BodyScene& b : scene_.bodies) add(b.name, b.source, "a body");
    for (const JointScene& j : scene_.joints) add(j.name, j.source, "a joint");
  }

  void check_sections() const {
    for (const Section& s : scene_.sections) check_section(s);
  }

  const Section& section_of(const BeamScene& beam) const {
    for (const Section& s : scene_.sections)
      if (s.name == beam.section) return s;
    std::vector<std::string_view> names;
    for (const Section& s : scene_.sections) names.push_back(s.name);
    throw Error(beam.source,
                fmt::format("beam \"{}\": there is no section \"{}\"{}", beam.name, beam.section,
                            suggest(beam.section, names, "sections are")));
  }

  // --- beams ---

  void find_boundaries(const BeamScene& beam) {
    if (beam.elements < 1)
      throw Error(beam.source, fmt::format("beam \"{}\" must have at least one element, not {}",
                                           beam.name, beam.elements));
    CompiledBeam compiled{&beam, {}, {}, {}, {}};
    for (int e = 0; e <= beam.elements; ++e)
      compiled.boundaries.push_back(static_cast<double>(e) / beam.elements);
    const auto add = [&](const Place& place) {
      if (place.kind != Place::Kind::beam || place.name != beam.name) return;
      for (const double s : compiled.boundaries)
        if (std::abs(s - place.parameter) < same_parameter) return;
      compiled.boundaries.push_back(place.parameter);
    };
    for (const BodyScene& b : scene_.bodies)
      if (b.attached_to) add(*b.attached_to);
    for (const JointScene& j : scene_.joints) {
      add(j.a);
      add(j.b);
    }
    for (const LoadScene& l : scene_.loads) add(l.at);
    for (const PointMassScene& m : scene_.point_masses) add(m.at);
    for (const DistributedLoadScene& l : scene_.distributed_loads) {
      for (const double s : {l.from, l.to})
        if (s >= 0.0 && s <= 1.0) add({Place::Kind::beam, l.beam, s});
    }
    for (const RecordScene& r : scene_.records)
      if (r.at) add(*r.at);
    std::sort(compiled.boundaries.begin(), compiled.boundaries.end());
    beams_.push_back(std::move(compiled));
  }

  BeamElasticBatch& elastic_batch(const BeamScene& beam) {
    const auto key = std::tuple(beam.metric, beam.form, beam.rule, beam.order);
    auto& batch = elastic_[key];
    if (!batch) {
      try {
        batch = make_beam_elastic(beam.metric, beam.form, beam.rule, beam.order);
      } catch (const Error& e) {
        throw Error(beam.source, fmt::format("beam \"{}\": {}", beam.name, e.what()));
      }
    }
    return *batch;
  }

  void add_beam(CompiledBeam& compiled) {
    const BeamScene& beam = *compiled.scene;
    const Section& scene_section = section_of(beam);
    const SectionTable section(scene_section);
    if (scene_.transient && !section.has_mass())
      throw Error(scene_section.source,
                  fmt::format("section \"{}\" of beam \"{}\" has no mass; a transient needs one",
                              scene_section.name, beam.name));
    const ReferenceLine line = make_reference_line(beam);
    BeamElasticBatch& batch = elastic_batch(beam);
    int stiffness = section.is_uniform() ? batch.add_stiffness(section.stiffness(0.0)) : -1;
    const SpectralTable& table = batch.table();
    const auto order = static_cast<std::size_t>(beam.order);
    int count = 0;
    const auto add_node = [&](double s) {
      const Pose<double> H = line.at(s);
      include(H.r);
      masses_.push_back(Mat6::Zero());
      return static_cast<int>(
          system_->add_node(fmt::format("beam '{}' node {}", beam.name, ++count), H));
    };

    compiled.boundary_nodes.push_back(add_node(0.0));
    compiled.ends.resize(compiled.boundaries.size());
    for (std::size_t e = 0; e + 1 < compiled.boundaries.size(); ++e) {
      const double s0 = compiled.boundaries[e], s1 = compiled.boundaries[e + 1];
      const auto at = [&](double xi) { return s0 + 0.5 * (s1 - s0) * (1.0 + xi); };
      std::vector<int> nodes{compiled.boundary_nodes.back()};
      std::vector<Pose<double>> poses{line.at(s0)};
      std::vector<double> places{s0};
      for (std::size_t k = 1; k <= order; ++k) {
        places.push_back(k == order ? s1 : at(table.nodes.points[k]));
        nodes.push_back(add_node(places[k]));
        poses.push_back(line.at(places[k]));
      }
      const double J = 0.5 * (s1 - s0) * line.length;
      const std::vector<double> Js(order + 1, J);
      if (!section.is_uniform()) {
        for (std::size_t i = 0; i < table.rule.points.size(); ++i) {
          const int one = batch.add_stiffness(section.stiffness(at(table.rule.points[i])));
          if (i == 0) stiffness = one;
        }
      }
      const Index element =
          batch.add_element(Js, poses, nodes, stiffness, section.is_uniform() ? 0 : 1,
                            fmt::format("beam '{}' element {}", beam.name, e + 1));
      compiled.boundary_nodes.push_back(nodes.back());
      compiled.ends[e].push_back({&batch, element, -1.0});
      compiled.ends[e + 1].push_back({&batch, element, 1.0});
      for (std::size_t k = 0; k <= order; ++k) {
        const double weight = table.nodes.weights[k] * J;
        compiled.nodes.push_back({nodes[k], places[k], weight});
        if (section.has_mass())
          masses_[static_cast<std::size_t>(nodes[k])] += weight * section.mass(places[k]);
      }
    }
  }

  const CompiledBeam* find_beam(const std::string& name) const {
    for (const CompiledBeam& b : beams_)
      if (b.scene->name == name) return &b;
    return nullptr;
  }

  static std::size_t boundary_at(const CompiledBeam& beam, double s) {
    std::size_t best = 0;
    for (std::size_t i = 0; i < beam.boundaries.size(); ++i)
      if (std::abs(beam.boundaries[i] - s) < std::abs(beam.boundaries[best] - s)) best = i;
    return best;
  }

  // --- places ---

  Attachment find(const Place& place, const Source& source, std::string_view who) const {
    switch (place.kind) {
      case Place::Kind::ground:
        return {0, false};
      case Place::Kind::body:
        if (const auto it = body_nodes_.find(place.name); it != body_nodes_.end())
          return {it->second, false};
        break;
      case Place::Kind::beam:
        if (!(place.parameter >= 0.0 && place.parameter <= 1.0))
          throw Error(source, fmt::format("{}: the parameter {} of beam \"{}\" must lie in [0, 1]",
                                          who, place.parameter, place.name));
        if (const CompiledBeam* beam = find_beam(place.name))
          return {beam->boundary_nodes[boundary_at(*beam, place.parameter)], true};
        break;
    }
    std::vector<std::string_view> names;
    for (const BeamScene& b : scene_.beams) names.push_back(b.name);
    for (const BodyScene& b : scene_.bodies) names.push_back(b.name);
    throw Error(source, fmt::format("{}: there is no {} \"{}\"{}", who,
                                    place.kind == Place::Kind::body ? "body" : "beam", place.name,
                                    suggest(place.name, names, "beams and bodies are")));
  }

  Pose<double> reference(int node) const { return system_->reference_pose(node); }

  // --- bodies ---

  void add_body(const BodyScene& body) {
    if (!(body.mass >= 0.0))
      throw Error(body.source,
                  fmt::format("body \"{}\": the mass must not be negative", body.name));
    if (!(body.inertia - body.inertia.transpose()).isZero(1e-12 * (body.inertia.norm() + 1e-300)))
      throw Error(body.source, fmt::format("body \"{}\": the inertia is not symmetric", body.name));
    const Vec3 principal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(
                               Eigen::Matrix3d(body.inertia), Eigen::EigenvaluesOnly)
                               .eigenvalues();
    if (principal(0) < -1e-12 * principal(2))
      throw Error(body.source,
                  fmt::format("body \"{}\": the inertia has a negative principal value {}",
                              body.name, principal(0)));
    // A mass distribution obeys the triangle inequality; allow what was rounded in print.
    if (principal(0) + principal(1) < principal(2) * (1.0 - 1e-3) && principal(2) > 0.0)
      throw Error(
          body.source,
          fmt::format(
              "body \"{}\": no mass distribution has the principal inertias {}, {}, {} (each "
              "is at most the sum of the others)",
              body.name, principal(0), principal(1), principal(2)));
    if (body.attached_to) return;
    if (!(body.orientation.transpose() * body.orientation).isIdentity(1e-9) ||
        !(body.orientation.determinant() > 0.0))
      throw Error(body.source,
                  fmt::format("body \"{}\": the orientation is not a rotation matrix", body.name));
    include(body.at);
    include(body.at + body.orientation * body.center);
    masses_.push_back(rigid_mass(body.mass, body.center, body.inertia));
    body_nodes_[body.name] = static_cast<int>(system_->add_node(
        fmt::format("body '{}'", body.name), make_pose(body.orientation, body.at)));
  }

  void attach_body(const BodyScene& body) {
    if (!body.attached_to) return;
    const Attachment at =
        find(*body.attached_to, body.source, fmt::format("body \"{}\"", body.name));
    if (at.node == 0)
      throw Error(body.source,
                  fmt::format("body \"{}\" is attached to the ground; leave it out", body.name));
    include(reference(at.node) * body.center);
    masses_[static_cast<std::size_t>(at.node)] += rigid_mass(body.mass, body.center, body.inertia);
    body_nodes_[body.name] = at.node;
  }

  void add_point_mass(const PointMassScene& point) {
    const std::string who = point.name.empty() ? std::string("point mass")
                                               : fmt::format("point mass \"{}\"", point.name);
    if (!(point.mass >= 0.0))
      throw Error(point.source, fmt::format("{}: the mass must not be negative", who));
    const Attachment at = find(point.at, point.source, who);
    if (at.node == 0)
      throw Error(point.source, fmt::format("{} on the ground does nothing; leave it out", who));
    include(reference(at.node) * point.offset);
    masses_[static_cast<std::size_t>(at.node)] +=
        rigid_mass(point.mass, point.offset, Mat3::Zero());
  }

  void set_velocities(State& state) const {
    for (const BodyScene& body : scene_.bodies) {
      if (body.velocity.isZero() && body.angular_velocity.isZero()) continue;
      if (body.attached_to)
        throw Error(
            body.source,
            fmt::format(
                "body \"{}\" moves with what it is attached to: it has no velocity of its own",
                body.name));
      if (state.V.empty())
        throw Error(
            body.source,
            fmt::format("body \"{}\" has an initial velocity, but the scene has no transient",
                        body.name));
      const auto n = static_cast<std::size_t>(body_nodes_.at(body.name));
      state.V[n] = six<double>(body.orientation.transpose() * body.velocity, body.angular_velocity);
    }
  }

  // --- the scene's size ---

  void include(const Vec3& x) {
    if (!x.allFinite()) throw Error({scene_.file, 0}, "a position of the scene is not finite");
    low_ = any_ ? Vec3(low_.cwiseMin(x)) : x;
    high_ = any_ ? Vec3(high_.cwiseMax(x)) : x;
    any_ = true;
  }

  void measure() {
    for (const JointScene& j : scene_.joints)
      if (j.at) include(*j.at);
    if (!any_) throw Error({scene_.file, 1}, "the scene is empty: it has no beam and no body");
    length_ = (high_ - low_).norm();
    if (!(length_ > 0.0)) length_ = 1.0;  // a body about its own mass centre
  }

  // --- nodal terms ---

  void add_inertia() {
    auto batch = std::make_unique<ElementBatch<Mass>>(Mass::name, Mass::Shared{});
    for (int n = 1; n < system_->nodes(); ++n)
      batch->add({masses_[static_cast<std::size_t>(n)]}, std::array{n}, system_->node_name(n));
    system_->add_batch(std::move(batch));
    for (const BodyScene& body : scene_.bodies) {
      if (body.attached_to) continue;
      const bool held =
          std::any_of(scene_.joints.begin(), scene_.joints.end(), [&body](const JointScene& j) {
            return (j.a.kind == Place::Kind::body && j.a.name == body.name) ||
                   (j.b.kind == Place::Kind::body && j.b.name == body.name);
          });
      if (!held && !(scaled_definiteness(
                         masses_[static_cast<std::size_t>(body_nodes_.at(body.name))]) > definite))
        throw Error(
            body.source,
            fmt::format(
                "body \"{}\" is free and lacks mass or inertia: its motion is not determined",
                body.name));
    }
  }

  void add_gravity() {
    auto batch = std::make_unique<ElementBatch<NodalGravity>>(
        NodalGravity::name, NodalGravity::Shared{scene_.gravity->acceleration});
    for (int n = 1; n < system_->nodes(); ++n) {
      const Mat6& M = masses_[static_cast<std::size_t>(n)];
      // M = [ m I, -m c~ ; m c~, J ]
      const Vec3 mc = axial<double>(M.bottomLeftCorner<3, 3>());
      if (M(0, 0) > 0.0) batch->add({M(0, 0), mc}, std::array{n}, system_->node_name(n));
    }
    system_->add_batch(std::move(batch));
  }

  void add_loads() {
    Loads loads(*system_);
    for (const LoadScene& load : scene_.loads) {
      const int node = find(load.at, load.source, "load").node;
      loads.add(load, node);
    }
    for (const DistributedLoadScene& load : scene_.distributed_loads) {
      // Checks the beam's name; its ends are places like any other.
      find({Place::Kind::beam, load.beam, 0.0}, load.source, "distributed load");
      loads.add(load, find_beam(load.beam)->nodes);
    }
    loads.finish();
  }

  // --- joints ---

  struct Reading {  // how output reads a joint
    std::function<double(const State&)> angle;
    std::function<Vec6(const State&)> relative_velocity, reaction;
  };

  // The batch of a joint type, made when first called for; nullptr if there is no such type.
  joint::AnyJointBatch* joint_batch(std::string_view type) {
    for (const auto& batch : system_->batches()) {
      auto* joints = dynamic_cast<joint::AnyJointBatch*>(batch.get());
      if (joints != nullptr && joints->type() == type) return joints;
    }
    auto batch = joint::make_joint_batch(type);
    joint::AnyJointBatch* made = batch.get();
    if (made != nullptr) system_->add_batch(std::move(batch));
    return made;
  }

  // Frames a and b in their nodes.
  struct Frames {
    int P, Q;
    Pose<double> a, b;
  };

  Index add_one(joint::AnyJointBatch& batch, const Frames& f, const std::string& name, int signal,
                bool follow_angle) {
    ConstraintInfo info;
    info.name = name;
    info.rows = static_cast<Index>(batch.rows().size());
    for (const joint::Row& row : batch.rows()) {
      const bool is_position = row.kind == joint::Row::Kind::position;
      info.is_position.push_back(is_position);
      info.row_names.push_back(is_position ? fmt::format("position {}", row.i)
                               : row.kind == joint::Row::Kind::direction
                                   ? fmt::format("direction a{}.b{}", row.i, row.j)
                                   : std::string("angle"));
    }
    const auto index = static_cast<Index>(system_->constraints().size());
    const Index multiplier = system_->add_constraint(std::move(info));
    return batch.add(f.a, f.b, f.P, f.Q, signal, index, multiplier,
                     follow_angle ? system_->add_angle() : -1);
  }

  void add_joints() {
    for (const DriveScene& d : scene_.drives) find_joint(d.joint, d.source, "drive");
    for (const JointScene& j : scene_.joints) add_joint(j);
  }

  const JointScene& find_joint(const std::string& name, const Source& source,
                               std::string_view who) const {
    std::vector<std::string_view> names;
    for (const JointScene& j : scene_.joints) {
      if (j.name == name) return j;
      names.push_back(j.name);
    }
    throw Error(source, fmt::format("{}: there is no joint \"{}\"{}", who, name,
                                    suggest(name, names, "joints are")));
  }

  void add_joint(const JointScene& j) {
    const std::string who = fmt::format("{} joint \"{}\"", j.kind, j.name);
    const schema::JointKind* kind = schema::find_joint_kind(j.kind);
    if (kind == nullptr)
      throw Error(j.source, fmt::format("there is no joint type \"{}\"", j.kind));
    const Attachment A = find(j.a, j.source, who), B = find(j.b, j.source, who);
    if (A.node == B.node) throw Error(j.source, fmt::format("{} joins a thing to itself", who));
    if (kind->has_axis && !j.axis) throw Error(j.source, fmt::format("{} needs an axis", who));
    if (!kind->has_axis && j.axis)
      throw Error(j.source, fmt::format("{} has no axis; leave it out", who));
    if (j.axis && !(j.axis->norm() > 0.0))
      throw Error(j.source, fmt::format("{}: axis has zero length; give a direction", who));

    // A beam is joined at its node; ground and bodies anywhere.
    const Vec3 point = j.at                                         ? *j.at
                       : B.is_point || (!A.is_point && B.node != 0) ? reference(B.node).r
                                                                    : reference(A.node).r;
    for (const Attachment& end : {A, B}) {
      if (!end.is_point) continue;
      const double gap = (reference(end.node).r - point).norm();
      if (!(gap <= open_tolerance * length_))
        throw Error(
            j.source,
            fmt::format(
                "{} is open: {} is {:.6g} m from the joint's point ({:.9g}, {:.9g}, {:.9g})", who,
                system_->node_name(end.node), gap, point(0), point(1), point(2)));
    }
    const Pose<double> H =
        make_pose(j.axis ? frame_with_third(*j.axis) : Mat3(Mat3::Identity()), point);
    const Frames f{A.node, B.node, relative(reference(A.node), H), relative(reference(B.node), H)};

    const DriveScene* drive = nullptr;
    for (const DriveScene& d : scene_.drives) {
      if (d.joint != j.name) continue;
      if (drive != nullptr) throw Error(d.source, fmt::format("{} is driven twice", who));
      drive = &d;
    }
    joint::AnyJointBatch* batch = joint_batch(j.kind);
    const Index i = add_one(*batch, f, fmt::format("{} '{}'", j.kind, j.name), -1, kind->has_angle);
    Reading& reading = readings_[j.name];
    if (kind->has_angle) reading.angle = [batch, i](const State& s) { return batch->angle(s, i); };
    reading.relative_velocity = [batch, i](const State& s) {
      return batch->relative_velocity(s, i);
    };
    reading.reaction = [batch, i](const State& s) { return batch->reaction(s, i); };
    if (drive != nullptr) add_drive(*drive, j, *kind, f);
  }

  void add_drive(const DriveScene& d, const JointScene& j, const schema::JointKind& kind,
                 const Frames& f) {
    if (!kind.has_angle)
      throw Error(d.source,
                  fmt::format("joint \"{}\" is {}: it has no angle to drive", j.name, j.kind));
    if (d.rate.has_value() == d.angle.has_value())
      throw Error(d.source,
                  fmt::format("the drive of joint \"{}\" needs either a rate or an angle", j.name));
    const double duration = scene_.transient ? scene_.transient->duration : 1.0;
    const auto signal = [&]() -> Signal {
      try {
        if (d.angle) {
          return d.angle->is_constant() ? Signal::constant(d.angle->value())
                                        : Signal::from_expression(*d.angle);
        }
        return Signal::from_rate(*d.rate, 0.0, 0.0, duration);
      } catch (const Error& e) {
        throw Error(d.source, fmt::format("drive of joint \"{}\": {}", j.name, e.what()));
      }
    }();
    for (const Jump& jump : signal.jumps()) {
      if (jump.derivative < 2 && jump.t < duration) {
        throw Error(
            d.source,
            fmt::format(
                "drive of joint \"{}\": the {} jumps by {:.6g} at t = {:.9g} s, an impact; make "
                "the law continuous",
                j.name, jump.derivative == 0 ? "angle" : "rate", jump.size, jump.t));
      }
    }
    const auto index = static_cast<int>(system_->add_signal(signal, SignalUse::drive));
    joint::AnyJointBatch* batch = joint_batch(joint::DrivenRotation::name);
    const Index i = add_one(*batch, f, fmt::format("drive of '{}'", j.name), index, false);
    // The driven moment belongs to what the joint transmits.
    Reading& reading = readings_[j.name];
    reading.reaction = [batch, i, joint = reading.reaction](const State& s) {
      return Vec6(joint(s) + batch->reaction(s, i));
    };
  }

  // --- checks ---

  void check(const State& initial) const {
    if (const std::string element = system_->out_of_range(initial); !element.empty())
      throw Error(
          {scene_.file, 0},
          fmt::format("{} turns beyond the range of its metric in the reference configuration; "
                      "give the beam more elements",
                      element));
    try {
      check_initial_state(*system_, initial);
    } catch (const Error& e) {
      throw Error({scene_.file, 0}, e.what());
    }
  }

  // --- output ---

  static Channel channel(const RecordScene& record, const schema::Quantity& q,
                         std::function<void(const State&, std::span<double>)> sample) {
    Channel c;
    for (int i = 1; i <= q.components; ++i) {
      c.columns.push_back({q.components == 1 ? fmt::format("{}.{}", record.name, q.name)
                                             : fmt::format("{}.{}.{}", record.name, q.name, i),
                           std::string(q.unit)});
    }
    c.sample = std::move(sample);
    return c;
  }

  void add_channels(Model& model) const {
    for (const RecordScene& record : scene_.records) {
      for (const std::string& name : record.quantities) {
        const auto known = record.joint ? schema::joint_quantities() : schema::place_quantities();
        const schema::Quantity* q = schema::find_quantity(known, name);
        if (q == nullptr)
          throw Error(record.source,
                      fmt::format("record \"{}\": there is no quantity \"{}\"{}", record.name, name,
                                  suggest(name, schema::names(known), "quantities are")));
        model.channels.push_back(channel(
            record, *q, record.joint ? joint_sample(record, name) : place_sample(record, name)));
      }
    }
  }

  using Sample = std::function<void(const State&, std::span<double>)>;

  static Sample vector(std::function<Vec3(const State&)> f) {
    return [f = std::move(f)](const State& s, std::span<double> out) {
      const Vec3 x = f(s);
      std::copy(x.data(), x.data() + 3, out.begin());
    };
  }

  Sample place_sample(const RecordScene& record, const std::string& name) const {
    const std::string who = fmt::format("record \"{}\"", record.name);
    if (!record.at)
      throw Error(record.source, fmt::format("{} needs a place (at=) or a joint", who));
    const auto n = static_cast<std::size_t>(find(*record.at, record.source, who).node);
    const Vec3 r0 = reference(static_cast<int>(n)).r;
    if (name == "position") return vector([n](const State& s) { return s.pose[n].r; });
    if (name == "displacement")
      return vector([n, r0](const State& s) { return Vec3(s.pose[n].r - r0); });
    if (name == "displacement_local")
      return vector([n, r0](const State& s) {
        return Vec3(s.pose[n].p.conjugate() * Vec3(s.pose[n].r - r0));
      });
    if (name == "rotation") {
      const Quaternion<double> p0 = reference(static_cast<int>(n)).p;
      return vector(
          [n, p0](const State& s) { return log_so3<double>(s.pose[n].p * p0.conjugate()); });
    }
    if (name == "force" || name == "moment")
      return resultant_sample(record, name == "force" ? 0 : 3);
    // Rates are zero in a scene without a transient.
    const bool rates = scene_.transient.has_value();
    if (name == "velocity")
      return vector([n, rates](const State& s) {
        return rates ? Vec3(s.pose[n].p * linear(s.V[n])) : Vec3(Vec3::Zero());
      });
    if (name == "velocity_local")
      return vector(
          [n, rates](const State& s) { return rates ? linear(s.V[n]) : Vec3(Vec3::Zero()); });
    if (name == "angular_velocity")
      return vector([n, rates](const State& s) {
        return rates ? Vec3(s.pose[n].p * angular(s.V[n])) : Vec3(Vec3::Zero());
      });
    if (name == "angular_velocity_local")
      return vector(
          [n, rates](const State& s) { return rates ? angular(s.V[n]) : Vec3(Vec3::Zero()); });
    if (name == "acceleration") {
      return vector([n, rates](const State& s) {
        if (!rates) return Vec3(Vec3::Zero());
        return Vec3(s.pose[n].p * Vec3(linear(s.Vdot[n]) + angular(s.V[n]).cross(linear(s.V[n]))));
      });
    }
    throw Error(record.source, fmt::format("{}: \"{}\" is not available at a place", who, name));
  }

  // Mean of the elements that meet at the place (formulation.md 2).
  Sample resultant_sample(const RecordScene& record, Index first) const {
    const CompiledBeam* beam =
        record.at->kind == Place::Kind::beam ? find_beam(record.at->name) : nullptr;
    if (beam == nullptr)
      throw Error(
          record.source,
          fmt::format("record \"{}\": only beams have sectional forces and moments", record.name));
    const auto ends = beam->ends[boundary_at(*beam, record.at->parameter)];
    return vector([ends, first](const State& s) {
      Vec3 sum = Vec3::Zero();
      for (const ElementEnd& end : ends)
        sum += end.batch->resultants(s, end.element, end.xi).segment<3>(first);
      return Vec3(sum / static_cast<double>(ends.size()));
    });
  }

  Sample joint_sample(const RecordScene& record, const std::string& name) const {
    const JointScene& j =
        find_joint(*record.joint, record.source, fmt::format("record \"{}\"", record.name));
    const Reading& reading = readings_.at(j.name);
    const bool rates = scene_.transient.has_value();
    if (name == "angle" || name == "rate") {
      if (!reading.angle)
        throw Error(record.source,
                    fmt::format("joint \"{}\" is {}: it has no angle", j.name, j.kind));
      if (name == "angle")
        return [f = reading.angle](const State& s, std::span<double> out) { out[0] = f(s); };
      return [f = reading.relative_velocity, rates](const State& s, std::span<double> out) {
        out[0] = rates ? f(s)(5) : 0.0;
      };
    }
    if (name == "force")
      return vector([f = reading.reaction](const State& s) { return linear(f(s)); });
    return vector([f = reading.reaction](const State& s) { return angular(f(s)); });
  }

  const Scene& scene_;
  std::unique_ptr<System> system_;
  std::map<std::tuple<Metric, Form, Rule, int>, std::unique_ptr<BeamElasticBatch>> elastic_;
  std::vector<CompiledBeam> beams_;
  std::map<std::string, int> body_nodes_;
  std::map<std::string, Reading> readings_;
  std::vector<Mat6> masses_{Mat6::Zero()};  // by node
  Vec3 low_ = Vec3::Zero(), high_ = Vec3::Zero();
  bool any_ = false;
  double length_ = 1.0;
};

}  // namespace

Model compile(const Scene& scene) { return Compiler(scene).compile(); }

}  // namespace mbd
