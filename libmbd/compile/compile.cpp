// Scene -> Model: the only place that knows both what a scene says and which types exist.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

#include "elements/beam/beam_classical.hpp"
#include "elements/beam/beam_damping_batch.hpp"
#include "elements/beam/beam_elastic_batch.hpp"
#include "elements/beam/beam_place.hpp"
#include "elements/node/batches.hpp"
#include "elements/node/force_batch.hpp"
#include "libmbd/compile/control.hpp"
#include "libmbd/compile/extending.hpp"
#include "libmbd/compile/fusion.hpp"
#include "libmbd/compile/joints.hpp"
#include "libmbd/compile/model.hpp"
#include "libmbd/compile/nodal_terms.hpp"
#include "libmbd/compile/plugin.hpp"
#include "libmbd/compile/reductions.hpp"
#include "libmbd/compile/redundancy.hpp"
#include "libmbd/compile/section_point.hpp"
#include "libmbd/compile/springs.hpp"
#include "libmbd/core/stop.hpp"
#include "libmbd/language/check_scene.hpp"
#include "libmbd/language/quantities.hpp"
#include "libmbd/language/schema.hpp"
#include "libmbd/material/solid_shapes.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/places.hpp"
#include "libmbd/scene/reference_line.hpp"
#include "libmbd/scene/section_table.hpp"
#include "libmbd/text/spelling.hpp"
#include "solvers/constraints/initial.hpp"

namespace mbd {
namespace {

// A place of an element, for resultants: where it ends, or within it.
struct ElementPlace {
  const BeamElasticBatch* batch;
  Index element;
  double xi;
  const BeamDampingBatch* damping;  // null without damping
  Index damping_element;
};

void add_viscous(const ElementPlace& at, const State& state, std::vector<Vec6>& S) {
  if (at.damping == nullptr || state.V.empty()) return;
  std::vector<Vec6> viscous(S.size());
  at.damping->resultants(state, at.damping_element, viscous);
  for (std::size_t i = 0; i < S.size(); ++i) S[i] += viscous[i];
}

// Sectional forces at the quadrature points of its element, elastic and viscous.
std::vector<Vec6> resultants_at_points(const ElementPlace& at, const State& state) {
  const std::size_t points = at.batch->table().rule.points.size();
  std::vector<Vec6> S(points);
  at.batch->resultants(state, at.element, S);
  add_viscous(at, state, S);
  return S;
}

// The same, linear in small deformations about the reference configuration: strains of increments dU of all nodes but the
// ground, rates of strain of velocities that `rest`, a state in that configuration, has. Those of a batch are found together,
// when one of its elements is asked for first.
class LinearResultants {
 public:
  LinearResultants(State rest, std::vector<double> dU)
      : rest_(std::move(rest)), dU_(std::move(dU)) {}

  std::vector<Vec6> operator()(const ElementPlace& at) {
    const std::size_t points = at.batch->table().rule.points.size();
    const auto [found, is_new] = of_batch_.try_emplace(at.batch);
    std::vector<Vec6>& all = found->second;
    if (is_new) {
      all.resize(static_cast<std::size_t>(at.batch->resultant_count()));
      at.batch->linearized_resultants(rest_, dU_, all);
    }
    const auto first = all.begin() + static_cast<std::ptrdiff_t>(points) * at.element;
    std::vector<Vec6> S(first, first + static_cast<std::ptrdiff_t>(points));
    add_viscous(at, rest_, S);
    return S;
  }

 private:
  State rest_;
  std::vector<double> dU_;
  std::map<const BeamElasticBatch*, std::vector<Vec6>> of_batch_;
};

// At its place: the polynomial through the quadrature points, where the strains of a Gauss rule are most accurate.
Vec6 resultants_there(const ElementPlace& at, const std::vector<Vec6>& S) {
  const VecX l = lagrange(at.batch->table().rule.points, at.xi);
  Vec6 sum = Vec6::Zero();
  for (std::size_t i = 0; i < S.size(); ++i) sum += l(static_cast<Index>(i)) * S[i];
  return sum;
}

struct CompiledBeam {
  const BeamScene* scene;
  std::vector<double> boundaries;               // parameters, with 0 and 1
  std::vector<Attachment> boundary_nodes;       // node at each
  std::vector<std::vector<ElementPlace>> ends;  // elements that meet at each; none of a rigid beam
  std::vector<BeamNode> nodes;  // those of each element in turn; ends of elements twice
};

class Compiler {
 public:
  // `linear_about`: of a part that becomes component modes, the place of the frame in which it deforms little.
  explicit Compiler(const Scene& scene, const std::optional<Place>& linear_about = {})
      : scene_(scene),
        linear_about_(linear_about),
        reduced_(scene),
        system_(std::make_unique<System>()) {}

  Model compile(const Extensions& extensions) {
    check_scene(scene_);
    if (!scene_.transient && !scene_.statics && !scene_.path)
      throw Error(
          scene_.source,
          label("mbd", scene_.name) +
              ": there is nothing to do; give <static/>, <transient …/> or both, or <path/>");
    for (const InputScene& input : scene_.inputs)
      system_->add_input({input.name, input.unit, input.factor, input.value, input.controller});
    find_boundaries();
    fuse();
    add_parts();
    measure();
    const std::vector<Mat6> all = with_added_masses();
    if (scene_.transient) add_inertia(all);
    add_mass_damping();
    if (scene_.gravity) add_gravity();
    if (scene_.base_motion) add_base_motion();
    if (!reductions_.empty()) add_components();
    const Nodes nodes = nodes_of_scene();
    NodalTerms::compile(scene_, nodes);
    joints_.emplace(scene_, *system_, length_, nodes.find, [this](std::size_t joint) {
      return fusion_->is_fused(joint) || reduced_.of(scene_.joints[joint]) != nullptr;
    });
    joints_->add_all();
    hold_strains();
    add_springs(nodes.find);
    for (const ExtensionScene& extension : scene_.extensions)
      add_force(make_plugin_force(extension), extension.source);
    for (const std::shared_ptr<const Force>& force : extensions.forces)
      add_force(force, scene_.source);
    if (!extensions.parts.empty()) add_parts_of(extensions);
    add_control();
    for (auto& [key, batch] : elastic_) system_->add_batch(std::move(batch));
    for (auto& [key, batch] : held_batches_) system_->add_batch(std::move(batch));
    for (auto& [key, batch] : damping_) system_->add_batch(std::move(batch));
    system_->finish(scene_.transient.has_value(), length_);

    Model model;
    model.initial = system_->reference_state();
    if (const std::string unusable = system_->unusable_signal(model.initial); !unusable.empty())
      throw Error(unusable);
    set_velocities(model.initial);
    model.makers = joints_->makers();
    for (const HeldElement& one : held_)
      model.makers.insert(model.makers.end(), one.rows(), {one.beam->source, label(*one.beam)});
    check(model.makers, model.initial);
    check_plugins(model.initial);
    find_repetitions(model);
    if (scene_.path) add_path_channel(model);
    add_channels(model);
    add_lines(model);
    add_places(model);
    model.joints = joints_->frames();
    model.fused = joints_->fused();
    for (const Mat6& M : masses_) model.mass += M(0, 0);
    for (const auto& part : reductions_) model.mass += part->model().mass;
    model.system = std::move(system_);
    return model;
  }

 private:
  void add_parts() {
    for (const ReductionScene& reduction : scene_.reductions) add_reduction(reduction);
    for (const RigidScene& rigid : scene_.rigids)
      if (reduced_.of(rigid.of.front()) == nullptr) add_rigid(rigid);
    for (const BodyScene& body : scene_.bodies) add_body(body);
    for (CompiledBeam& beam : beams_)
      if (reduced_.of(beam.scene->name) == nullptr) add_beam(beam);
    for (const BodyScene& body : scene_.bodies) body_of_.try_emplace(body.name, &body);
    for (const BodyScene& body : scene_.bodies) attach_body(body);
    for (const PointMassScene& mass : scene_.point_masses)
      if (reduced_.of(mass) == nullptr) add_point_mass(mass);
  }

  void add_control() {
    ControlCompiler control(
        scene_, *system_, *joints_,
        [this](const SensorName& of, const std::string& who) { return sensor_place(of, who); },
        [this](const SensorName& of) -> Sample {
          const Quantities one{of.quantity};
          return of.record.at ? place_sample(of.record, one) : sample_of(of.record, *of.quantity);
        });
    control.feed_back();
    control.add_controllers();
  }

  // --- sections ---

  const Section& section_of(const BeamScene& beam) const {
    if (sections_.empty())
      for (const Section& s : scene_.sections) sections_.try_emplace(s.name, &s);
    if (const auto it = sections_.find(beam.section); it != sections_.end()) return *it->second;
    std::vector<std::string_view> names;
    for (const Section& s : scene_.sections) names.push_back(s.name);
    throw Error(beam.source,
                fmt::format("{}: there is no section \"{}\"{}", label(beam), excerpt(beam.section),
                            suggest(beam.section, names, "sections")));
  }

  // --- beams ---

  void find_boundaries() {
    for (const RigidScene& rigid : scene_.rigids)
      for (const std::string& name : rigid.of) rigids_.try_emplace(name, &rigid);
    const ElementEnds ends(scene_);
    for (const BeamScene& beam : scene_.beams) {
      CompiledBeam compiled{&beam, {}, {}, {}, {}};
      const int elements = rigid_of(beam.name) != nullptr ? 1 : beam.elements;
      compiled.boundaries = ends.of(beam, elements);
      beam_of_.try_emplace(beam.name, beams_.size());
      beams_.push_back(std::move(compiled));
    }
  }

  void fuse() {
    std::vector<Fusion::Beam> beams;
    for (const CompiledBeam& beam : beams_)
      if (rigid_of(beam.scene->name) == nullptr && reduced_.of(beam.scene->name) == nullptr)
        beams.push_back({beam.scene, beam.boundaries});
    fusion_.emplace(scene_, beams);
    group_nodes_.assign(static_cast<std::size_t>(fusion_->groups()), -1);
  }

  // A node at H for a member of that group, or one of its own for -1, and H in the node's frame.
  struct Made {
    int node;
    Pose<double> frame{};
  };
  Made make_node(int group, const std::string& name, const Pose<double>& H) {
    int* const shared = group < 0 ? nullptr : &group_nodes_[static_cast<std::size_t>(group)];
    if (shared != nullptr && *shared >= 0) return {*shared, frame_in(*shared, H)};
    masses_.push_back(Mat6::Zero());
    const auto node = static_cast<int>(system_->add_node(name, H));
    if (shared != nullptr) *shared = node;
    return {node};
  }

  // H in the node's frame: the identity where they differ by round-off.
  Pose<double> frame_in(int node, const Pose<double>& H) const {
    constexpr double round_off = 1e-15;
    Pose<double> frame = relative(reference(node), H);
    if (frame.p.vec().norm() <= round_off) frame.p = Quaternion<double>::Identity();
    if (frame.r.norm() <= round_off * (1.0 + H.r.norm())) frame.r.setZero();
    return frame;
  }

  BeamElasticBatch& elastic_batch(const BeamScene& beam) {
    const auto key = std::tuple(beam.kinematics, beam.metric, beam.form, beam.rule, beam.order);
    auto& batch = elastic_[key];
    if (!batch) {
      try {
        batch = beam.kinematics == Kinematics::classical
                    ? make_beam_classical(beam.rule, beam.order)
                    : make_beam_elastic(beam.metric, beam.form, beam.rule, beam.order);
      } catch (const Stopped&) {
        throw;
      } catch (const Error& e) {
        throw Error(beam.source, fmt::format("{}: {}", label(beam), e.what()));
      }
    }
    return *batch;
  }

  // Of rates of strain; null where there is none of it, and in statics.
  BeamDampingBatch* damping_batch(const BeamScene& beam, const Section& section) {
    if (!scene_.transient || !section.damping) return nullptr;
    const SectionDamping& damping = *section.damping;
    if (damping.stiffness_proportional == 0.0 && damping.viscous.isZero(0.0)) return nullptr;
    if (beam.kinematics == Kinematics::classical)
      throw Error(beam.source,
                  fmt::format("{}: kinematics=\"classical\" has no viscous forces, which the "
                              "damping of {} asks for; leave kinematics out, or give that damping "
                              "mass_proportional only",
                              label(beam), label(section)));
    auto& batch = damping_[std::tuple(beam.metric, beam.rule, beam.order)];
    if (!batch) batch = make_beam_damping(beam.metric, beam.rule, beam.order);
    return batch.get();
  }

  double mass_proportional(const Section& section) const {
    return scene_.transient && section.damping ? section.damping->mass_proportional : 0.0;
  }

  void add_mass_damping(int node, const Mat6& P) {
    mass_damping_.try_emplace(node, Mat6::Zero()).first->second += P;
  }

  // A table that stays, with what it is of.
  struct KeptTable {
    KeptTable(const Section& of, double length) : section(of), table(section, length) {}
    KeptTable(const KeptTable&) = delete;
    KeptTable& operator=(const KeptTable&) = delete;
    const Section section;
    const SectionTable table;
  };
  static std::vector<beam::SectionSample> samples_of(const SectionTable& table, double s0,
                                                     double s1) {
    std::vector<beam::SectionSample> all;
    for (const auto& [s, weight] : table.rule(s0, s1))
      all.push_back(
          {2.0 * (s - s0) / (s1 - s0) - 1.0, 2.0 * weight / (s1 - s0), table.stiffness(s)});
    return all;
  }

  // What statics ask for of a uniform beam that is much stiffer in tension and shear than it bends: these forces become unknowns
  // (held_strains.hpp), of a stiffness beside the moderate one that is left in the section, so that no step of Newton's knows how
  // stiff it is, and critical loads no round-off of places. Of what may be infinite (check_held).
  struct StiffStrains {
    Section section;
    StrainSet strains{};
    Mat6 stiffness = Mat6::Zero();
  };

  // A beam whose elements are being added. Indices are of the batches' stiffnesses and viscosities, -1 where they vary.
  struct Growing {
    CompiledBeam& compiled;
    const SectionTable& section;
    const ReferenceLine& line;
    BeamElasticBatch& elastic;
    BeamDampingBatch* damping;  // null without damping
    int stiffness = -1, viscosity = -1;
    double mass_damping;
    std::shared_ptr<const KeptTable> table = {};  // of a section that varies
    const StiffStrains* stiff = nullptr;          // null: there are none
    int count = 0;                                // of nodes

    const std::string& name() const { return compiled.scene->name; }
  };

  // The nodes of an element, both ends included.
  struct ElementNodes {
    std::vector<int> nodes;
    std::vector<Pose<double>> poses, frames;  // in each node's
    std::vector<double> places;

    void add(const Made& made, const Pose<double>& pose, double s) {
      nodes.push_back(made.node);
      poses.push_back(pose);
      frames.push_back(made.frame);
      places.push_back(s);
    }
  };

  static bool is_none(const Pose<double>& frame) {
    return frame.p.vec().isZero(0.0) && frame.r.isZero(0.0);
  }

  void add_beam(CompiledBeam& compiled) {
    stop::check();
    const BeamScene& beam = *compiled.scene;
    const Section& scene_section = section_of(beam);
    const ReferenceLine line = make_reference_line(beam);
    const double of_element = line.length / beam.elements;
    const std::optional<StiffStrains> stiff = stiff_strains(beam, scene_section, of_element);
    const SectionTable section(stiff ? stiff->section : scene_section, of_element);
    if (scene_.transient && !section.has_mass())
      throw Error(
          scene_section.source,
          fmt::format("{}: the mass is missing, which beam \"{}\" needs in a <transient>; give "
                      "<mass per_length=… inertia=…/>",
                      label(scene_section), beam.name));
    if (const RigidScene* const rigid = rigid_of(beam.name)) {
      add_rigid_beam(compiled, section, mass_proportional(scene_section), line, *rigid);
      return;
    }
    if (!std::holds_alternative<Straight>(beam.line)) check_turns(compiled, line);
    if (any(section.held())) check_held(beam, scene_section);
    BeamElasticBatch& batch = elastic_batch(beam);
    BeamDampingBatch* const damping = damping_batch(beam, scene_section);
    Growing growing{.compiled = compiled,
                    .section = section,
                    .line = line,
                    .elastic = batch,
                    .damping = damping,
                    .mass_damping = mass_proportional(scene_section),
                    .stiff = stiff ? &*stiff : nullptr};
    if (!section.is_uniform())
      growing.table = std::make_shared<const KeptTable>(scene_section, of_element);
    if (section.is_uniform()) {
      const Mat6 D = section.stiffness(0.0);
      growing.stiffness = batch.add_stiffness(D);
      if (damping) growing.viscosity = damping->add_viscosity(section.viscosity_of(D, 0.0));
    }
    Made end = add_boundary(growing, 0);
    compiled.ends.resize(compiled.boundaries.size());
    for (std::size_t e = 0; e + 1 < compiled.boundaries.size(); ++e) add_element(growing, e, end);
  }

  Made add_node(Growing& beam, double s, int group) {
    const Pose<double> H = beam.line.at(s);
    include(H.r);
    return make_node(group, fmt::format("beam '{}' node {}", beam.name(), ++beam.count), H);
  }

  Made add_boundary(Growing& beam, std::size_t boundary) {
    CompiledBeam& compiled = beam.compiled;
    const double s = compiled.boundaries[boundary];
    const int group = fusion_->group_of_boundary(beam.name(), boundary);
    const Made made = add_node(beam, s, group);
    compiled.boundary_nodes.push_back({made.node, true, beam.line.at(s), nullptr, group >= 0});
    return made;
  }

  // From the node at its beginning to `end`, which becomes the one at its end.
  void add_element(Growing& beam, std::size_t e, Made& end) {
    CompiledBeam& compiled = beam.compiled;
    const double s0 = compiled.boundaries[e], s1 = compiled.boundaries[e + 1];
    const std::vector<double>& points = beam.elastic.table().nodes.points;
    const auto order = static_cast<std::size_t>(compiled.scene->order);
    ElementNodes element;
    element.add(end, beam.line.at(s0), s0);
    for (std::size_t k = 1; k < order; ++k) {
      const double s = s0 + 0.5 * (s1 - s0) * (1.0 + points[k]);
      element.add(add_node(beam, s, -1), beam.line.at(s), s);
    }
    end = add_boundary(beam, e + 1);
    element.add(end, beam.line.at(s1), s1);
    const double J = 0.5 * (s1 - s0) * beam.line.length;
    add_stiffness(beam, e, element, J);
    add_masses(beam, s0, s1, element, J);
  }

  // The element's part in the batches.
  void add_stiffness(Growing& beam, std::size_t e, const ElementNodes& of, double J) {
    CompiledBeam& compiled = beam.compiled;
    BeamElasticBatch& batch = beam.elastic;
    BeamDampingBatch* const damping = beam.damping;
    const double s0 = compiled.boundaries[e], s1 = compiled.boundaries[e + 1];
    const bool uniform = beam.section.is_uniform();
    int stiffness = beam.stiffness, viscosity = beam.viscosity;  // the first of the element
    if (!uniform)
      for (const Mat6& D : beam.section.stiffnesses(s0, s1, batch.table().rule)) {
        const int one = batch.add_stiffness(D);
        if (stiffness < 0) stiffness = one;
        if (!damping) continue;
        const int viscous = damping->add_viscosity(beam.section.viscosity_of(D, 0.5 * (s0 + s1)));
        if (viscosity < 0) viscosity = viscous;
      }
    const std::string name = fmt::format("beam '{}' element {}", beam.name(), e + 1);
    const int stride = uniform ? 0 : 1;
    const std::vector<double> Js(of.nodes.size(), J);
    const Index element = batch.add_element(Js, of.poses, of.nodes, stiffness, stride, name);
    const Index damped =
        damping ? damping->add_element(Js, of.poses, of.nodes, viscosity, stride, name) : -1;
    if (!uniform)
      batch.set_varying(element,
                        [table = beam.table, s0, s1] { return samples_of(table->table, s0, s1); });
    if (!std::all_of(of.frames.begin(), of.frames.end(), is_none)) {
      batch.set_frames_of(element, of.frames);
      if (damping) damping->set_frames_of(damped, of.frames);
    }
    if (any(beam.section.held()))
      held_.push_back(
          {compiled.scene, &batch, element, Js, of, beam.section.held(), Mat6::Zero(), name});
    if (beam.stiff != nullptr)
      held_.push_back({compiled.scene, &batch, element, Js, of, beam.stiff->strains,
                       beam.stiff->stiffness, name});
    compiled.ends[e].push_back({&batch, element, -1.0, damping, damped});
    compiled.ends[e + 1].push_back({&batch, element, 1.0, damping, damped});
  }

  std::optional<StiffStrains> stiff_strains(const BeamScene& beam, const Section& section,
                                            double of_element) const {
    // Of an element in tension or shear, of its bending: round-off of places would be 1e-7 of critical loads.
    constexpr double stiff = 1e5, far_from_singular = 1e-3;
    if (scene_.transient || linear_about_ || beam.kinematics == Kinematics::classical ||
        beam.form == Form::paper || beam.rule == Rule::gauss_lobatto || !section.stations.empty())
      return std::nullopt;
    StiffStrains result{.section = section};
    Mat6& D = result.section.stiffness;
    const double bends = 12.0 / (of_element * of_element) * D.diagonal().tail<3>().minCoeff();
    std::vector<Index> chosen;
    for (Index c = 0; c < 3; ++c)
      if (std::isfinite(D(c, c)) && D(c, c) > stiff * bends) chosen.push_back(c);
    if (chosen.empty()) return std::nullopt;
    // Couplings with what is not chosen stay in the section, which they must leave definite.
    Mat6 left = Mat6::Zero();
    for (const Index c : chosen) {
      result.strains[static_cast<std::size_t>(c)] = true;
      left(c, c) = bends;
      for (Index j = 0; j < 6; ++j)
        if (std::ranges::find(chosen, j) == chosen.end())
          left(c, c) += 100.0 * D(c, j) * D(c, j) / D(j, j);
    }
    for (const Index c : chosen)
      for (const Index j : chosen) {
        result.stiffness(c, j) = D(c, j) - left(c, j);
        D(c, j) = left(c, j);
      }
    Mat6 finite = D;
    for (Index c = 0; c < 6; ++c)
      if (!std::isfinite(finite(c, c))) finite(c, c) = 1.0;
    if (!(scaled_definiteness(finite) > far_from_singular) ||
        !(definiteness_of_some(result.stiffness) > far_from_singular))
      return std::nullopt;
    return result;
  }

  // An element with strains of infinite stiffness, or much stiffer than it bends: rows of them follow those of joints.
  struct HeldElement {
    const BeamScene* beam;
    BeamElasticBatch* elastic;
    Index element;
    std::vector<double> J;
    ElementNodes of;
    StrainSet held;
    Mat6 stiffness;  // zero: infinite
    std::string name;

    std::size_t rows() const {
      return J.size() < 2
                 ? 0
                 : (J.size() - 1) *
                       static_cast<std::size_t>(std::count(held.begin(), held.end(), true));
    }
  };

  static void check_held(const BeamScene& beam, const Section& section) {
    const auto refuse = [&](std::string_view what) {
      throw Error(beam.source, fmt::format("{}: {} has infinite stiffnesses, which {}", label(beam),
                                           label(section), what));
    };
    if (beam.kinematics == Kinematics::classical)
      refuse("kinematics=\"classical\" does not know; leave kinematics out");
    if (beam.form == Form::paper)
      refuse("form=\"paper\" does not know: its forces are no gradient; leave form out");
    if (beam.rule == Rule::gauss_lobatto)
      refuse(
          "rule=\"gauss_lobatto\" would hold at more points than an element has motions for; "
          "leave rule out");
  }

  // Of each quadrature point a constraint, with the strains that are held for rows.
  void hold_strains() {
    constexpr std::array<std::string_view, 6> names = {"axial force",      "shear force 2",
                                                       "shear force 3",    "torque",
                                                       "bending moment 2", "bending moment 3"};
    for (const HeldElement& one : held_) {
      const bool gives = !one.stiffness.isZero(0.0);
      std::vector<HeldStrains::Rows> rows;
      for (std::size_t i = 0; i + 1 < one.J.size(); ++i) {
        ConstraintInfo info;
        info.name = fmt::format("{} point {}", one.name, i + 1);
        info.of_strains = true;
        info.gives = gives;
        for (std::size_t c = 0; c < names.size(); ++c) {
          if (!one.held[c]) continue;
          info.row_names.emplace_back(names[c]);
          info.is_position.push_back(c < 3);
        }
        info.rows = std::ssize(info.row_names);
        const auto constraint = static_cast<Index>(system_->constraints().size());
        rows.push_back({system_->add_constraint(std::move(info)), constraint});
      }
      auto& batch = held_batches_[std::tuple(one.beam->metric, one.beam->order, gives)];
      if (!batch) batch = make_held_strains(one.beam->metric, one.beam->order, gives);
      const bool own = std::all_of(one.of.frames.begin(), one.of.frames.end(), is_none);
      const Index number =
          batch->add_element(one.J, one.of.poses, one.of.nodes, one.held, one.stiffness, rows,
                             own ? std::span<const Pose<double>>() : one.of.frames, one.name);
      one.elastic->set_held(one.element, *batch, number);
    }
  }

  void add_masses(Growing& beam, double s0, double s1, const ElementNodes& of, double J) {
    const SectionTable& section = beam.section;
    const Quadrature& rule = beam.elastic.table().nodes;
    const std::vector<Mat6> masses = section.has_mass() && !section.is_uniform()
                                         ? section.masses(s0, s1, rule)
                                         : std::vector<Mat6>();
    for (std::size_t k = 0; k < of.nodes.size(); ++k) {
      const double weight = rule.weights[k] * J;
      beam.compiled.nodes.push_back({of.nodes[k], of.places[k], weight, of.frames[k]});
      if (!section.has_mass()) continue;
      Mat6 M = masses.empty() ? weight * section.mass(of.places[k]) : beam.line.length * masses[k];
      if (!is_none(of.frames[k])) M = transformed_mass(M, of.frames[k]);
      masses_[static_cast<std::size_t>(of.nodes[k])] += M;
      if (beam.mass_damping > 0.0) add_mass_damping(of.nodes[k], beam.mass_damping * M);
    }
  }

  // --- component modes ---

  std::shared_ptr<ReducedPart> reduced_part(const ReductionScene& reduction) const {
    return *std::ranges::find_if(reductions_,
                                 [&](const auto& part) { return &part->scene() == &reduction; });
  }

  void add_reduction(const ReductionScene& reduction) {
    ReducedPart& part =
        *reductions_.emplace_back(std::make_shared<ReducedPart>(scene_, reduced_, reduction));
    const System& own = *part.model().system;
    for (Index n = 1; n < own.nodes(); ++n) include(own.reference_pose(n).r);
    for (const int n : part.modes().nodes)
      part.set_node(n, make_node(-1, own.node_name(n), own.reference_pose(n)).node);
    for (const Model::Line& line : part.model().lines) {
      CompiledBeam& beam = beams_[beam_of_.at(line.name)];
      for (std::size_t k = 0; k < line.size(); ++k)
        if (const int node = part.node_of(line.nodes[k]); node >= 0)
          beam.nodes.push_back({node, line.s[k], 0.0, line.frames[k]});
    }
    // Of bodies, whether something acts on them or not; without, they have no node.
    for (const Model::PlaceFrame& known : part.model().places)
      if (known.place.kind == Place::Kind::body)
        body_nodes_[known.place.name] = attachment_of(part, known);
  }

  static Attachment attachment_of(const ReducedPart& part, const Model::PlaceFrame& known) {
    const Pose<double> pose = part.model().system->reference_pose(known.node) * known.frame;
    return {part.node_of(known.node), known.place.kind == Place::Kind::beam, pose, nullptr,
            !is_none(known.frame)};
  }

  // Of a place in a reduction; none where it has no node.
  std::optional<Attachment> find_reduced(const Place& place) const {
    const std::shared_ptr<ReducedPart> part = reduced_part(*reduced_.of(place));
    const Model::PlaceFrame* const known = part->find(place);
    if (known == nullptr || part->node_of(known->node) < 0) return {};
    return attachment_of(*part, *known);
  }

  Index index_of(const ReductionScene& reduction) const {
    return &reduction - scene_.reductions.data();
  }

  // After gravity and the motion of the base, which act on them.
  void add_components() {
    auto batch = std::make_unique<ComponentBatch>(
        scene_.gravity ? scene_.gravity->acceleration : Vec3(Vec3::Zero()), base_);
    auto inertia = std::make_unique<ComponentInertia>();
    for (const auto& part : reductions_) {
      std::vector<int> nodes;
      for (const int n : part->modes().nodes) nodes.push_back(part->node_of(n));
      inertia->add(part->modes().M, nodes);
      batch->add(part->modes().element, std::move(nodes), label(part->scene()));
    }
    components_ = batch.get();
    system_->add_batch(std::move(batch));
    if (scene_.transient) system_->add_batch(std::move(inertia));
  }

  // A record of a place within: as the part by itself has it, in the motion that the whole gives its nodes.
  Channel reduced_channel(const RecordScene& record) const {
    const ReductionScene& reduction = *reduced_.of(*record.at);
    const auto before = std::ranges::count_if(
        std::span(scene_.records.data(), &record),
        [&](const RecordScene& r) { return r.at && reduced_.of(*r.at) == &reduction; });
    const std::shared_ptr<const ReducedPart> part = reduced_part(reduction);
    const Channel& own = part->model().channels[static_cast<std::size_t>(before)];
    return {own.columns, [part, batch = components_, k = index_of(reduction), sample = own.sample](
                             const State& state, std::span<double> out) {
              sample(part->state_within(state, *batch, k), out);
            }};
  }

  // For pictures: through its nodes, and to its ends as if these were rigid on the nearest node of the part.
  Model::Line reduced_line(const CompiledBeam& beam) const {
    const std::shared_ptr<const ReducedPart> part = reduced_part(*reduced_.of(beam.scene->name));
    const Model& own = part->model();
    const Model::Line& line = *std::ranges::find(own.lines, beam.scene->name, &Model::Line::name);
    Model::Line drawn{line.name, {}, {}, {}};
    for (std::size_t k = 0; k < line.size(); ++k) {
      int node = part->node_of(line.nodes[k]);
      if (node < 0 && k > 0 && k + 1 < line.size()) continue;
      const Pose<double> H = own.system->reference_pose(line.nodes[k]) * line.frames[k];
      if (node < 0) {
        const int nearest = *std::ranges::min_element(part->modes().nodes, {}, [&](int n) {
          return (own.system->reference_pose(n).r - H.r).norm();
        });
        node = part->node_of(nearest);
      }
      drawn.nodes.push_back(node);
      drawn.frames.push_back(frame_in(node, H));
      drawn.s.push_back(line.s[k]);
    }
    if (!line.resultants) return drawn;
    drawn.stations = line.stations;
    drawn.resultants = [part, batch = components_, k = index_of(part->scene()),
                        within = line.resultants](const State& state, std::span<Vec6> out) {
      within(part->state_within(state, *batch, k), out);
    };
    return drawn;
  }

  // --- what is rigid ---

  const RigidScene* rigid_of(const std::string& name) const {
    const auto it = rigids_.find(name);
    return it == rigids_.end() ? nullptr : it->second;
  }

  void add_rigid(const RigidScene& rigid) {
    const auto frame = [&]() -> Pose<double> {
      for (const BodyScene& body : scene_.bodies)
        if (body.name == rigid.of.front()) return make_pose(body.orientation, body.at);
      return make_reference_line(*find_beam(rigid.of.front())->scene).at(0.0);
    };
    rigid_nodes_[&rigid] = make_node(fusion_->group_of_rigid(rigid.name),
                                     fmt::format("rigid '{}'", rigid.name), frame())
                               .node;
  }

  // Its mass and its loads are integrated between the boundaries by the finest rule there is, exactly where they vary
  // as polynomials of degree 15 do.
  void add_rigid_beam(CompiledBeam& compiled, const SectionTable& section, double alpha,
                      const ReferenceLine& line, const RigidScene& rigid) {
    const SpectralTable table = spectral_table(beam::max_order, Rule::gauss);
    const int node = rigid_nodes_.at(&rigid);
    for (const double s : compiled.boundaries)
      compiled.boundary_nodes.push_back({node, true, line.at(s), &rigid});
    compiled.ends.resize(compiled.boundaries.size());
    const auto add_mass = [&](double s, double weight) {
      if (!section.has_mass()) return;
      const Mat6 M =
          transformed_mass(weight * section.mass(s), relative(reference(node), line.at(s)));
      masses_[static_cast<std::size_t>(node)] += M;
      if (alpha > 0.0) add_mass_damping(node, alpha * M);
    };
    for (std::size_t e = 0; e + 1 < compiled.boundaries.size(); ++e) {
      const double s0 = compiled.boundaries[e], s1 = compiled.boundaries[e + 1];
      for (std::size_t k = 0; k < table.nodes.points.size(); ++k) {
        const double s = k + 1 == table.nodes.points.size()
                             ? s1
                             : s0 + 0.5 * (s1 - s0) * (1.0 + table.nodes.points[k]);
        const double weight = 0.5 * (s1 - s0) * line.length * table.nodes.weights[k];
        const Pose<double> H = line.at(s);
        include(H.r);
        compiled.nodes.push_back({node, s, weight, relative(reference(node), H)});
        if (section.is_uniform()) add_mass(s, weight);
      }
      if (section.is_uniform()) continue;
      for (const auto& [s, weight] : section.rule(s0, s1)) add_mass(s, weight * line.length);
    }
  }

  // The turn of an element between its ends is only known up to whole turns: so here it is followed along
  // the line. The range is that of the metric, or of the classical interpolation.
  static void check_turns(const CompiledBeam& compiled, const ReferenceLine& line) {
    constexpr int pieces = 16;
    const BeamScene& beam = *compiled.scene;
    const bool classical = beam.kinematics == Kinematics::classical;
    const double most = classical                           ? beam::ClassicalRange::max_angle
                        : beam.metric == Metric::matrix     ? MatrixMetric::max_angle
                        : beam.metric == Metric::quaternion ? QuaternionMetric::max_angle
                                                            : GeodesicMetric::max_angle;
    for (std::size_t e = 0; e + 1 < compiled.boundaries.size(); ++e) {
      const double s0 = compiled.boundaries[e], s1 = compiled.boundaries[e + 1];
      double turn = 0.0;
      Quaternion<double> before = line.at(s0).p;
      for (int i = 1; i <= pieces; ++i) {
        const Quaternion<double> here = line.at(s0 + (s1 - s0) * i / pieces).p;
        turn += log_so3<double>(before.conjugate() * here).norm();
        before = here;
      }
      if (!(turn < most))
        throw Error(
            beam.source,
            fmt::format("{}: element {} of {} turns by {:.0f} degrees, beyond the {:.0f} of its "
                        "{}; give the beam more elements",
                        label(beam), e + 1, compiled.boundaries.size() - 1,
                        turn * 180.0 / std::numbers::pi, most * 180.0 / std::numbers::pi,
                        classical ? "interpolation" : "metric"));
    }
  }

  const CompiledBeam* find_beam(const std::string& name) const {
    const auto it = beam_of_.find(name);
    return it == beam_of_.end() ? nullptr : &beams_[it->second];
  }

  static std::size_t boundary_at(const CompiledBeam& beam, double s) {
    return nearest_boundary(beam.boundaries, s);
  }

  // Whether elements meet, or end, at s.
  static bool is_boundary(const CompiledBeam& beam, double s) {
    return std::abs(beam.boundaries[boundary_at(beam, s)] - s) < same_parameter;
  }
  // The element in which s lies, of those between the boundaries.
  static std::size_t element_at(const CompiledBeam& beam, double s) {
    std::size_t e = 0;
    while (e + 2 < beam.boundaries.size() && beam.boundaries[e + 1] < s) ++e;
    return e;
  }
  static ElementPlace within(const CompiledBeam& beam, std::size_t e, double s) {
    ElementPlace place = beam.ends[e].back();
    const double s0 = beam.boundaries[e], s1 = beam.boundaries[e + 1];
    place.xi = 2.0 * (s - s0) / (s1 - s0) - 1.0;
    return place;
  }
  // The node of a flexible beam at s; nullptr where there is none.
  static const BeamNode* node_at(const CompiledBeam& beam, double s) {
    for (const BeamNode& node : beam.nodes)
      if (std::abs(node.s - s) < same_parameter) return &node;
    return nullptr;
  }

  // --- places ---

  Attachment find(const Place& place, const Source& source, std::string_view who) const {
    switch (place.kind) {
      case Place::Kind::ground:
        return {};
      case Place::Kind::body:
        if (const auto it = body_nodes_.find(place.name); it != body_nodes_.end()) {
          if (it->second.node < 0) refuse_within(place, source, who);
          return it->second;
        }
        break;
      case Place::Kind::beam:
        if (const CompiledBeam* beam = find_beam(place.name)) {
          if (reduced_.of(place) == nullptr)
            return beam->boundary_nodes[boundary_at(*beam, place.parameter)];
          if (const std::optional<Attachment> at = find_reduced(place)) return *at;
          refuse_within(place, source, who);
        }
        break;
    }
    std::vector<std::string_view> names;
    const bool is_body = place.kind == Place::Kind::body;
    for (const BeamScene& b : scene_.beams) {
      if (is_body && b.name == place.name)
        throw Error(source, fmt::format("{}: \"{}\" is a beam; write {}.start, {}.end or {}@0.5",
                                        who, place.name, place.name, place.name, place.name));
      names.push_back(b.name);
    }
    for (const BodyScene& b : scene_.bodies) {
      if (!is_body && b.name == place.name)
        throw Error(source, fmt::format("{}: \"{}\" is a body, which has no parameter; write {}",
                                        who, place.name, place.name));
      names.push_back(b.name);
    }
    throw Error(source, fmt::format("{}: there is no {} \"{}\"{}", who, is_body ? "body" : "beam",
                                    place.name, suggest(place.name, names, "beams and bodies")));
  }

  [[noreturn]] void refuse_within(const Place& place, const Source& source,
                                  std::string_view who) const {
    throw Error(source, fmt::format("{}: {} lies within {}, which has no node there; let something "
                                    "act there, or give another place",
                                    who, in_quotes(text_of(place)), label(*reduced_.of(place))));
  }

  Pose<double> reference(int node) const { return system_->reference_pose(node); }

  // The place in the frame of its node: the identity, but in something rigid or fused.
  Pose<double> frame_of(const Attachment& at) const {
    return at.is_offset() ? relative(reference(at.node), at.pose) : Pose<double>{};
  }

  // --- bodies ---

  void add_body(const BodyScene& body) {
    stop::check();
    const std::string who = label(body);
    const Mat3& I = body.inertia;
    const MassProperties& is = masses_of_.emplace(body.name, mass_properties(body)).first->second;
    if (!(I - I.transpose()).isZero(1e-12 * (I.norm() + 1e-300)))
      throw Error(body.source,
                  who + ": inertia is not symmetric; it must be a matrix xx yy zz xy xz yz");
    const Vec3 principal =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(Eigen::Matrix3d(I), Eigen::EigenvaluesOnly)
            .eigenvalues();
    if (principal(0) < -1e-12 * principal(2))
      throw Error(
          body.source,
          fmt::format("{}: inertia: its principal values are {:g}, {:g}, {:g}, and none must be "
                      "negative; check the signs",
                      who, principal(0), principal(1), principal(2)));
    // A mass distribution obeys the triangle inequality; allow what was rounded in print.
    if (principal(0) + principal(1) < principal(2) * (1.0 - 1e-3) && principal(2) > 0.0)
      throw Error(
          body.source,
          fmt::format("{}: inertia: no body has the principal values {:g}, {:g}, {:g}: each must "
                      "be at most the sum of the others; check the numbers",
                      who, principal(0), principal(1), principal(2)));
    if (body.attached_to || reduced_.of(body.name) != nullptr) return;
    include(body.at);
    include(body.at + body.orientation * is.center);
    const Pose<double> pose = make_pose(body.orientation, body.at);
    const Mat6 M = rigid_mass(is.mass, is.center, is.inertia);
    if (const RigidScene* const rigid = rigid_of(body.name)) {
      const int node = rigid_nodes_.at(rigid);
      masses_[static_cast<std::size_t>(node)] +=
          transformed_mass(M, relative(reference(node), pose));
      body_nodes_[body.name] = {node, false, pose, rigid};
      return;
    }
    const int group = fusion_->group_of_body(body.name);
    const auto [node, frame] = make_node(group, fmt::format("body '{}'", body.name), pose);
    body_nodes_[body.name] = {node, false, pose, nullptr, group >= 0};
    masses_[static_cast<std::size_t>(node)] += group >= 0 ? transformed_mass(M, frame) : M;
  }

  // What a body is attached to may itself be an attached body, before or after it in the scene: those come first, as
  // many as they are, without recursion.
  void attach_body(const BodyScene& body) {
    std::vector<const BodyScene*> chain;
    std::unordered_set<std::string_view> above;
    for (const BodyScene* next = &body;
         next != nullptr && next->attached_to && !body_nodes_.contains(next->name);) {
      chain.push_back(next);
      above.insert(next->name);
      const Place& to = *next->attached_to;
      next = nullptr;
      if (to.kind != Place::Kind::body) break;
      if (above.contains(to.name))
        throw Error(chain.back()->source,
                    fmt::format("{}: attached_to: it is attached to itself{}; give another place",
                                label(*chain.back()),
                                to.name == chain.back()->name ? "" : ", through others"));
      if (const auto it = body_of_.find(to.name); it != body_of_.end()) next = it->second;
    }
    for (auto it = chain.rbegin(); it != chain.rend(); ++it) attach_to_what_is_there(**it);
  }

  void attach_to_what_is_there(const BodyScene& body) {
    stop::check();
    const Place& to = *body.attached_to;
    const Attachment at = find(to, body.source, label(body));
    if (at.node == 0 && body.shapes.empty())
      throw Error(body.source, label(body) +
                                   ": attached_to: on the ground it does nothing; leave "
                                   "the body out, or give it a <shape> to be seen");
    body_nodes_[body.name] = {at.node, false, at.pose, at.rigid, at.is_fused};
    if (at.node == 0) return;
    const MassProperties& is = masses_of_.at(body.name);
    include(at.pose * is.center);
    const Mat6 M = rigid_mass(is.mass, is.center, is.inertia);
    masses_[static_cast<std::size_t>(at.node)] +=
        at.is_offset() ? transformed_mass(M, frame_of(at)) : M;
  }

  void add_point_mass(const PointMassScene& point) {
    const Attachment at = find(point.at, point.source, label(point));
    if (at.node == 0)
      throw Error(
          point.source,
          label(point) + ": on the ground it does nothing; give another place, or leave it out");
    include(at.pose * point.offset);
    masses_[static_cast<std::size_t>(at.node)] +=
        rigid_mass(point.mass, frame_of(at) * point.offset, Mat3::Zero());
  }

  void set_velocities(State& state) const {
    for (const BodyScene& body : scene_.bodies) {
      if (body.velocity.isZero() && body.angular_velocity.isZero()) continue;
      if (state.V.empty())
        throw Error(body.source, label(body) +
                                     ": velocity: there is no motion in statics; leave it "
                                     "out or give <transient …/>");
      const Attachment& at = body_nodes_.at(body.name);
      const Vec6 own =
          six<double>(body.orientation.transpose() * body.velocity, body.angular_velocity);
      if (const ReductionScene* const reduction = reduced_.of(body.name)) {
        set_velocities(state, body, at.pose, own, *reduction);
        continue;
      }
      Vec6& V = state.V[static_cast<std::size_t>(at.node)];
      const Vec6 of_node = at.is_offset() ? Vec6(adjoint(frame_of(at)).matrix() * own) : own;
      if (at.rigid != nullptr) check_is_alike(V, of_node, body, label(*at.rigid));
      V = of_node;
    }
  }

  // What begins undeformed begins to move as a rigid body.
  void set_velocities(State& state, const BodyScene& body, const Pose<double>& pose,
                      const Vec6& own, const ReductionScene& reduction) const {
    const std::shared_ptr<const ReducedPart> part = reduced_part(reduction);
    for (const int n : part->modes().nodes) {
      const int node = part->node_of(n);
      Vec6& V = state.V[static_cast<std::size_t>(node)];
      const Vec6 of_node = adjoint(relative(system_->reference_pose(node), pose)).matrix() * own;
      check_is_alike(V, of_node, body, label(reduction));
      V = of_node;
    }
  }

  static void check_is_alike(const Vec6& V, const Vec6& other, const BodyScene& body,
                             const std::string& whole) {
    if (!V.isZero(0.0) && !V.isApprox(other, 1e-9))
      throw Error(body.source,
                  fmt::format("{}: velocity: {} moves otherwise by that of another of its "
                              "bodies; leave one of them out",
                              label(body), whole));
  }

  // --- the scene's size ---

  void include(const Vec3& x) {
    if (!x.allFinite())
      throw Error(scene_.source, label("mbd", scene_.name) +
                                     ": a position of the scene is not finite; check its numbers");
    low_ = any_ ? Vec3(low_.cwiseMin(x)) : x;
    high_ = any_ ? Vec3(high_.cwiseMax(x)) : x;
    any_ = true;
    points_.push_back(x);
  }

  // The largest distance of two points of the scene; their size where they are one.
  double largest_distance() const {
    Vec3 center = Vec3::Zero();
    for (const Vec3& x : points_) center += x / static_cast<double>(points_.size());
    const auto farthest_from = [&](const Vec3& from) {
      return *std::max_element(points_.begin(), points_.end(), [&](const Vec3& a, const Vec3& b) {
        return (a - from).squaredNorm() < (b - from).squaredNorm();
      });
    };
    const Vec3 one = farthest_from(center);
    const double radius = (one - center).norm();
    double most = (farthest_from(one) - one).norm();
    std::vector<Vec3> ends;  // no others can be farther apart than `most`
    for (const Vec3& x : points_)
      if ((x - center).norm() >= (1.0 - 1e-12) * (most - radius)) ends.push_back(x);
    for (std::size_t i = 0; i < ends.size(); ++i)
      for (std::size_t k = 0; k < i; ++k) most = std::max(most, (ends[i] - ends[k]).norm());
    return most > 0.0 ? most : largest_gyration();
  }

  void measure() {
    for (const JointScene& j : scene_.joints)
      for (const std::optional<Vec3>& point : {j.at, j.at_a, j.at_b})
        if (point) include(*point);
    for (const SpringScene& s : scene_.springs)
      for (const std::optional<Vec3>& point : {s.at_a, s.at_b})
        if (point) include(*point);
    for (const BushingScene& b : scene_.bushings)
      if (b.at) include(*b.at);
    if (!any_)
      throw Error(scene_.source,
                  label("mbd", scene_.name) + ": the scene is empty; give it a beam or a body");
    length_ = (high_ - low_).norm();
    if (!(length_ > 0.0)) length_ = largest_gyration();
  }

  // Diameter of gyration of bodies about their own mass centre, which have no other size; 1 m of points.
  double largest_gyration() const {
    double most = 0.0;
    for (const auto& [name, is] : masses_of_)
      if (is.mass > 0.0) most = std::max(most, 2.0 * std::sqrt(0.5 * is.inertia.trace() / is.mass));
    return most > 0.0 ? most : 1.0;
  }

  // --- nodal terms ---

  // `all`: with_added_masses().
  void add_inertia(const std::vector<Mat6>& all) {
    const auto batch_of = [&]<class E>(const auto& data) {
      auto batch = std::make_unique<ElementBatch<E>>(E::name, typename E::Shared{});
      for (int n = 1; n < system_->nodes(); ++n)
        batch->add(data(static_cast<std::size_t>(n)), std::array{n}, system_->node_name(n));
      system_->add_batch(std::move(batch));
    };
    if (scene_.transient->inertia == InertiaTerms::full)
      batch_of.operator()<Mass>([&](std::size_t n) { return Mass::Data{all[n]}; });
    else
      batch_of.operator()<MassNoGyroscopic>([&](std::size_t n) {
        return MassNoGyroscopic::Data{all[n], central_inertia(masses_[n])};
      });
    for (const BodyScene& body : scene_.bodies) {
      if (body.attached_to || body_nodes_.at(body.name).rigid != nullptr ||
          reduced_.of(body.name) != nullptr)
        continue;
      const auto is_body = [&body](const Place& place) {
        return place.kind == Place::Kind::body && place.name == body.name;
      };
      const bool held =
          std::any_of(scene_.joints.begin(), scene_.joints.end(),
                      [&](const JointScene& j) { return is_body(j.a) || is_body(j.b); }) ||
          std::any_of(scene_.motions.begin(), scene_.motions.end(),
                      [&](const MotionScene& m) { return is_body(m.of); });
      if (!held && !(scaled_definiteness(
                         all[static_cast<std::size_t>(body_nodes_.at(body.name).node)]) > definite))
        throw Error(body.source,
                    label(body) +
                        ": it is free and lacks mass or inertia, so that nothing determines its "
                        "motion; give it both, or a joint that holds it");
    }
  }

  void add_mass_damping() {
    if (mass_damping_.empty()) return;
    auto batch =
        std::make_unique<ElementBatch<MassDamping>>(MassDamping::name, MassDamping::Shared{});
    for (const auto& [node, P] : mass_damping_)
      batch->add({P}, std::array{node}, system_->node_name(node));
    system_->add_batch(std::move(batch));
  }

  // masses_ and what the fluid adds to them.
  std::vector<Mat6> with_added_masses() const {
    std::vector<Mat6> all = masses_;
    for (const AddedMassScene& added : scene_.added_masses) {
      if (added.at) {
        const Attachment at = find(*added.at, added.source, label(added));
        if (at.node == 0)
          throw Error(added.source,
                      label(added) + ": on the ground it does nothing; give a beam or a body");
        all[static_cast<std::size_t>(at.node)] +=
            at.is_offset() ? transformed_mass(*added.matrix, frame_of(at)) : *added.matrix;
        continue;
      }
      const double m = *added.density * *added.coefficient * 0.25 * std::numbers::pi *
                       *added.diameter * *added.diameter;
      const Part part = part_of(added);
      const auto nodes = nodes_of_scene().along(added.beam, added.source, label(added));
      for (const BeamNode& here : nodes_between(nodes, part.from, part.to)) {
        Mat6 M = Mat6::Zero();
        M(1, 1) = M(2, 2) = here.weight * m;
        all[static_cast<std::size_t>(here.node)] +=
            here.is_offset() ? transformed_mass(M, here.frame) : M;
      }
    }
    return all;
  }

  Nodes nodes_of_scene() const {
    return {*system_, scene_.transient.has_value(),
            [this](const Place& place, const Source& source, std::string_view who) {
              return find(place, source, who);
            },
            [this](const std::string& beam, const Source& source, std::string_view who) {
              find({Place::Kind::beam, beam, 0.0}, source, who);
              return std::span<const BeamNode>(find_beam(beam)->nodes);
            }};
  }

  // Adds mass and static moment of each node that has mass.
  template <class E>
  void add_massive(ElementBatch<E>& batch, const Source& source, std::string_view who) const {
    if (reductions_.empty() &&
        std::all_of(masses_.begin(), masses_.end(), [](const Mat6& M) { return M(0, 0) == 0.0; }))
      throw Error(source, fmt::format("{}: nothing in the scene has a mass; give sections <mass "
                                      "per_length=… inertia=…/> or bodies a mass, or leave it out",
                                      who));
    for (int n = 1; n < system_->nodes(); ++n) {
      const Mat6& M = masses_[static_cast<std::size_t>(n)];
      // M = [ m I, -m c~ ; m c~, J ]
      const Vec3 mc = axial<double>(M.bottomLeftCorner<3, 3>());
      if (M(0, 0) > 0.0) batch.add({M(0, 0), mc}, std::array{n}, system_->node_name(n));
    }
  }

  void add_gravity() {
    auto batch = std::make_unique<ElementBatch<NodalGravity>>(
        NodalGravity::name, NodalGravity::Shared{scene_.gravity->acceleration});
    add_massive(*batch, scene_.gravity->source, "gravity");
    if (batch->size() > 0) system_->add_batch(std::move(batch));
  }

  void add_base_motion() {
    const BaseMotionScene& base = *scene_.base_motion;
    using Law = BaseMotion::Law;
    const Law law = base.acceleration ? Law::acceleration
                    : base.velocity   ? Law::velocity
                                      : Law::displacement;
    const auto& components = base.acceleration ? *base.acceleration
                             : base.velocity   ? *base.velocity
                                               : *base.displacement;
    const std::string_view name = base.acceleration ? "acceleration"
                                  : base.velocity   ? "velocity"
                                                    : "displacement";
    BaseMotion::Shared shared{law, {-1, -1, -1}};
    bool moves = false;
    for (std::size_t i = 0; i < 3; ++i) {
      if (components[i].is_constant() && (law != Law::acceleration || components[i].value() == 0.0))
        continue;
      moves = true;
      shared.signals[i] = add_base_law(components[i], base, law, name, i);
    }
    if (!moves) return;
    base_ = shared;
    auto batch = std::make_unique<ElementBatch<BaseMotion>>(BaseMotion::name, shared);
    add_massive(*batch, base.source, "base_motion");
    if (batch->size() > 0) system_->add_batch(std::move(batch));
  }

  // A law whose derivative is an acceleration everywhere in the run. Returns its signal.
  int add_base_law(const Expression& law, const BaseMotionScene& base, BaseMotion::Law kind,
                   std::string_view name, std::size_t i) {
    const double duration = scene_.transient ? scene_.transient->duration : 0.0;
    const Signal signal =
        law.is_constant() ? Signal::constant(law.value()) : Signal::from_expression(law);
    const int derivatives = static_cast<int>(kind);  // taken of the law
    const std::string who =
        fmt::format("base_motion: {} {} \"{}\"", name, i + 1, excerpt(law.text()));
    check_prescribed(law, base.source, who);
    std::vector<Jump> jumps = signal.jumps();
    if (derivatives > 0 && duration > 0.0)
      if (const auto hidden = signal.undeclared_jump(0.0, duration)) jumps.push_back(*hidden);
    for (const Jump& jump : jumps)
      if (jump.derivative < derivatives && jump.t >= 0.0 && jump.t <= duration)
        throw Error(base.source,
                    fmt::format("{}: {} jumps by {:.6g} at t = {:.9g} s, an impact; make the law "
                                "continuous",
                                who, jump.derivative == 0 ? "it" : "its rate", jump.size, jump.t));
    const SignalValue start = signal(0.0, Side::right, system_->initial_inputs());
    const double acceleration = derivatives == 0   ? start.f
                                : derivatives == 1 ? start.fdot
                                                   : start.fddot;
    if (!std::isfinite(acceleration))
      throw Error(base.source,
                  fmt::format("{}: the acceleration it asks for at t = 0 is {}, must be a finite "
                              "number",
                              who, schema::shortest(acceleration)));
    return static_cast<int>(system_->add_signal(
        signal, derivatives == 0 ? SignalUse::load : SignalUse::drive, said(base.source, who)));
  }

  // --- forces of a program ---

  void add_force(const std::shared_ptr<const Force>& force, const Source& source) {
    std::vector<ForceBatch::At> places;
    const std::string who = fmt::format("force \"{}\"", force->name());
    for (const std::string& name : force->places()) {
      const std::vector<ForceBatch::At> at = nodes_called(name, who, source);
      if (at.front().node == 0)
        throw Error(source, fmt::format("{}: {} is on the ground, where a force of the program "
                                        "does nothing; give what moves",
                                        who, in_quotes(excerpt(name))));
      places.insert(places.end(), at.begin(), at.end());
    }
    if (places.empty())
      throw Error(source, fmt::format("force \"{}\" acts on no place; give it one", force->name()));
    system_->add_batch(std::make_unique<ForceBatch>(force, std::move(places), length_));
  }

  // One that throws, or gives no numbers, is refused before anything is run with it.
  void check_plugins(const State& state) const {
    std::size_t k = 0;
    for (const auto& batch : system_->batches()) {
      const auto* const force = dynamic_cast<const ForceBatch*>(batch.get());
      if (force == nullptr || k == scene_.extensions.size()) continue;
      const Source& source = scene_.extensions[k++].source;
      if (const std::string fault = force->out_of_range(state); fault.ends_with(")"))
        throw Error(source, fault);
    }
  }

  // Those of a beam, each once: where two elements meet, both have one.
  static std::vector<const BeamNode*> distinct_nodes(const CompiledBeam& beam) {
    std::vector<const BeamNode*> nodes;
    for (const BeamNode& node : beam.nodes)
      if (nodes.empty() || node.s != nodes.back()->s) nodes.push_back(&node);
    return nodes;
  }

  // What a program adds.
  class Parts final : public Extending {
   public:
    explicit Parts(Compiler& compiler) : compiler_(compiler) {}

    std::vector<PlaceInNode> places(const std::string& name) const override {
      std::vector<PlaceInNode> all;
      for (const ForceBatch::At& at : compiler_.nodes_called(name, who, compiler_.scene_.source))
        all.push_back({at.node, at.frame, compiler_.reference(at.node) * at.frame});
      return all;
    }
    const System& system() const override { return *compiler_.system_; }
    bool has_rates() const override { return compiler_.scene_.transient.has_value(); }
    void add_batch(std::unique_ptr<Batch> batch) override {
      const Source& source = compiler_.scene_.source;
      if (batch == nullptr) throw Error(source, fmt::format("{} gives no batch", who));
      for (const auto& other : system().batches())
        if (other->type() == batch->type())
          throw Error(source, fmt::format("{} adds a batch of type {}, which there is; give it a "
                                          "name of its own",
                                          who, in_quotes(excerpt(batch->type()))));
      compiler_.system_->add_batch(std::move(batch));
    }

   private:
    static constexpr std::string_view who = "a part of the program";

    OwnJoint add_joint(const std::string& name, const std::array<std::string, 2>& places,
                       const std::array<Pose<double>, 2>& frames, joint::Definition definition,
                       std::string_view type, MakeJoints make) override {
      const PlaceInNode a = place(places[0]), b = place(places[1]);
      const Source& source = compiler_.scene_.source;
      if (a.node == b.node)
        throw Error(source,
                    fmt::format("{} joins a thing to itself; give two places that move apart",
                                label(type, name)));
      if (joint::make_joint_batch(type) != nullptr)
        throw Error(source, fmt::format("{}: the library has joints of that type; give yours "
                                        "another name",
                                        label(type, name)));
      definition.P = a.node;
      definition.Q = b.node;
      definition.a = relative(compiler_.reference(a.node), frames[0]);
      definition.b = relative(compiler_.reference(b.node), frames[1]);
      return compiler_.joints_->add_own(name, type, make, definition);
    }

    Compiler& compiler_;
  };

  void add_parts_of(const Extensions& extensions) {
    Parts parts(*this);
    for (const auto& add : extensions.parts) add(parts);
  }

  // All nodes of a beam of that name, or the node of a place.
  std::vector<ForceBatch::At> nodes_called(const std::string& name, std::string_view who,
                                           const Source& source) const {
    std::vector<std::string> known{"ground"};
    if (name == known.front()) return {{}};
    for (const BodyScene& body : scene_.bodies) {
      const Attachment& at = body_nodes_.at(body.name);
      if (at.node < 0) continue;  // within a reduction
      if (body.name == name) return {{at.node, at.node == 0 ? at.pose : frame_of(at)}};
      known.push_back(body.name);
    }
    for (const CompiledBeam& beam : beams_) {
      std::vector<ForceBatch::At> nodes;
      for (const BeamNode* const node : distinct_nodes(beam)) {
        nodes.push_back({node->node, node->frame});
        known.push_back(text_of({Place::Kind::beam, beam.scene->name, node->s}));
        if (known.back() == name) return {nodes.back()};
      }
      if (nodes.empty()) continue;  // within a reduction
      if (beam.scene->name == name) return nodes;
      known.push_back(beam.scene->name);
    }
    const std::vector<std::string_view> words(known.begin(), known.end());
    throw Error(source, fmt::format("{}: there is no node at \"{}\"{}", who, excerpt(name),
                                    suggest(name, words, "places and beams")));
  }

  void add_springs(const FindPlace& find_place) {
    springs_.emplace(*system_, length_, scene_.transient.has_value(), *joints_, find_place);
    for (const SpringScene& spring : scene_.springs) springs_->add(spring);
    for (const BushingScene& bushing : scene_.bushings) springs_->add(bushing);
    for (const JointSpringScene& spring : scene_.joint_springs) springs_->add(spring);
    for (const JointTorqueScene& torque : scene_.joint_torques) springs_->add(torque);
    springs_->finish();
  }

  // --- sensors ---

  SensorPlace sensor_place(const SensorName& of, const std::string& who) const {
    const Place& place = *of.record.at;
    const CompiledBeam* const beam =
        place.kind == Place::Kind::beam ? find_beam(place.name) : nullptr;
    Attachment at = find(place, {}, who);
    if (beam != nullptr && reduced_.of(place) == nullptr && !is_boundary(*beam, place.parameter)) {
      const BeamNode* const node = at.rigid == nullptr ? node_at(*beam, place.parameter) : nullptr;
      if (at.rigid == nullptr && node == nullptr) {
        const BeamNode* nearest = nullptr;
        for (const BeamNode* const other : distinct_nodes(*beam))
          if (nearest == nullptr ||
              std::abs(other->s - place.parameter) < std::abs(nearest->s - place.parameter))
            nearest = other;
        throw Error(fmt::format(
            "{}: sensor \"{}\": beam \"{}\" has no node there; the nearest is at {}; a "
            "<controller> "
            "may sample between nodes",
            who, of.record.name, place.name, text_of({Place::Kind::beam, place.name, nearest->s})));
      }
      if (node != nullptr) return {node->node, node->frame, reference(node->node) * node->frame};
      const Pose<double> H = make_reference_line(*beam->scene).at(place.parameter);
      return {at.node, relative(reference(at.node), H), H};
    }
    if (at.node == 0) return {0, {}, {}};
    return {at.node, frame_of(at), at.pose};
  }

  // --- checks ---

  // Without a transient prescribed motions grow with the load, from none.
  void check(const std::vector<Model::Maker>& makers, State initial) const {
    if (!scene_.transient) initial.load_factor = 0.0;
    if (const std::optional<OpenConstraint> open = find_open_constraint(
            *system_, initial, scene_.transient ? 1.0 / scene_.transient->duration : 1.0)) {
      const Model::Maker& maker = makers[static_cast<std::size_t>(open->multiplier)];
      throw Error(maker.source, fmt::format("{}: {}: {}", maker.label, open->row, open->what));
    }
  }

  // Constraints that repeat others leave rows idle.
  void find_repetitions(Model& model) {
    if (!has_loops(*system_)) return;
    system_->set_reaction_length(largest_distance());
    Redundancy found = find_redundancy(*system_, model.initial);
    if (found.rows.empty()) return;
    refuse_contradictions(scene_, *system_, model.initial, model.makers, found);
    system_->allow_idle_rows();
    model.initial.idle = std::move(found.idle);
    model.redundant = std::move(found.rows);
  }

  // --- output ---

  using Sample = std::function<void(const State&, std::span<double>)>;
  using Quantities = std::vector<const schema::Quantity*>;

  static Channel channel(const RecordScene& record, const Quantities& quantities, Sample sample) {
    Channel c;
    for (const schema::Quantity* const q : quantities)
      for (int i = 1; i <= q->components; ++i)
        c.columns.push_back({q->components == 1 ? fmt::format("{}.{}", record.name, q->name)
                                                : fmt::format("{}.{}.{}", record.name, q->name, i),
                             std::string(q->unit), std::string(in_words(q->axes)), q});
    c.sample = std::move(sample);
    return c;
  }

  void add_lines(Model& model) const {
    for (const CompiledBeam& beam : beams_) {
      const bool is_rigid = rigid_of(beam.scene->name) != nullptr;
      if (reduced_.of(beam.scene->name) != nullptr) {
        if (!is_rigid) model.lines.push_back(reduced_line(beam));
        continue;
      }
      if (is_rigid) {
        std::vector<Model::RigidPoint>& line = model.rigid_lines.emplace_back();
        for (const BeamNode& node : beam.nodes) line.push_back({node.node, node.frame.r});
        continue;
      }
      Model::Line line{beam.scene->name, {}, {}, {}};
      for (const BeamNode* const node : distinct_nodes(beam)) {
        line.nodes.push_back(node->node);
        line.frames.push_back(node->frame);
        line.s.push_back(node->s);
      }
      if (scene_.motion_output) add_resultants(beam, line);
      model.lines.push_back(std::move(line));
    }
    for (const BodyScene& body : scene_.bodies)
      if (const Attachment& at = body_nodes_.at(body.name); !body.attached_to && at.node >= 0)
        model.bodies.push_back({at.node, frame_of(at).r});
  }

  void add_resultants(const CompiledBeam& beam, Model::Line& line) const {
    std::vector<ElementPlace> elements;
    for (std::size_t e = 0; e + 1 < beam.boundaries.size(); ++e) {
      const double s0 = beam.boundaries[e], s1 = beam.boundaries[e + 1];
      elements.push_back(beam.ends[e].back());
      for (const double xi : elements.back().batch->table().rule.points)
        line.stations.push_back(s0 + 0.5 * (s1 - s0) * (1.0 + xi));
    }
    line.resultants = [elements = std::move(elements), at_points = at_points()](
                          const State& state, std::span<Vec6> out) {
      const AtPoints of = at_points(state);
      auto next = out.begin();
      for (const ElementPlace& element : elements) next = std::ranges::copy(of(element), next).out;
    };
  }

  void add_places(Model& model) const {
    std::set<std::tuple<Place::Kind, std::string, double>> seen;
    const auto add = [&](const Place& place) {
      if (!seen.emplace(place.kind, place.name, place.parameter).second) return;
      if (reduced_.of(place) != nullptr && !find_reduced(place)) return;
      const Attachment at = find(place, scene_.source, {});
      model.places.push_back({place, at.node, frame_of(at)});
    };
    for (const BodyScene& body : scene_.bodies) add({Place::Kind::body, body.name, 0.0});
    each_node_place(scene_, add);
  }

  void add_path_channel(Model& model) const {
    model.path = std::make_shared<PathPlace>();
    Channel c;
    c.columns = {{"arc_length", ""}, {"branch", ""}, {"event", ""}};
    const bool counted = has_potential(scene_);
    if (counted) c.columns.push_back({"negative_eigenvalues", ""});
    c.sample = [place = model.path, counted](const State&, std::span<double> out) {
      out[0] = place->arc_length;
      out[1] = place->branch;
      out[2] = static_cast<double>(place->event);
      if (counted) out[3] = static_cast<double>(place->negative);
    };
    model.channels.push_back(std::move(c));
  }

  void add_channels(Model& model) const {
    for (const RecordScene& record : scene_.records) {
      Quantities all;
      for (const std::string& name : record.quantities)
        all.push_back(schema::find_quantity(schema::quantities_of(record), name));  // checked
      if (record.at) {
        model.channels.push_back(reduced_.of(*record.at) != nullptr
                                     ? reduced_channel(record)
                                     : channel(record, all, place_sample(record, all)));
        continue;
      }
      for (const schema::Quantity* const q : all)
        model.channels.push_back(channel(record, {q}, sample_of(record, *q)));
    }
  }

  // Of a joint, a spring or the whole system.
  Sample sample_of(const RecordScene& record, const schema::Quantity& q) const {
    const auto bound = [&q]<class Reading>(Reading reading) -> Sample {
      return [reading = std::move(reading), sample = std::get<schema::SampleOf<Reading>>(q.sample)](
                 const State& s, std::span<double> out) { sample(reading, s, out); };
    };
    if (record.joint) return bound(joints_->reading(record, q));
    if (record.spring) return bound(springs_->reading(record, q));
    return bound(schema::SystemReading{system_.get(), scene_.transient.has_value()});
  }

  // All quantities of a place, which is looked at once.
  Sample place_sample(const RecordScene& record, const Quantities& quantities) const {
    using From = schema::Quantity::From;
    const CompiledBeam* const beam =
        record.at->kind == Place::Kind::beam ? find_beam(record.at->name) : nullptr;
    std::function<Vec6(const State&)> forces;
    bool moves = false, rates = false;
    std::shared_ptr<const schema::SectionPointReading> point;
    for (const schema::Quantity* const q : quantities) {
      if (q->from == From::strain)
        forces = resultants(record, beam);
      else
        moves = true;
      rates = rates || q->from == From::velocity || q->from == From::acceleration;
    }
    // Rates are zero in a scene without a transient.
    PlaceReader motion;
    if (moves) motion = motion_of(record, beam, rates && scene_.transient);
    if (record.section_point && forces) point = section_points_.of(scene_, record, *beam->scene);
    return [motion, forces, point, quantities](const State& s, std::span<double> out) {
      schema::PlaceReading at;
      at.section_point = point.get();
      if (motion) motion(s, at);
      if (forces) at.resultants = forces(s);
      for (const schema::Quantity* const q : quantities) {
        std::get<schema::SampleOf<schema::PlaceReading>>(q->sample)(at, s, out);
        out = out.subspan(static_cast<std::size_t>(q->components));
      }
    };
  }

  using PlaceReader = std::function<void(const State&, schema::PlaceReading&)>;

  PlaceReader motion_of(const RecordScene& record, const CompiledBeam* beam, bool rates) const {
    Attachment at = find(*record.at, record.source, label(record));
    if (beam != nullptr && reduced_.of(*record.at) == nullptr &&
        !is_boundary(*beam, record.at->parameter)) {
      const double s = record.at->parameter;
      const BeamNode* const node = at.rigid == nullptr ? node_at(*beam, s) : nullptr;
      if (at.rigid == nullptr && node == nullptr) return motion_within(*beam, s, rates);
      at = node != nullptr
               ? Attachment{node->node, true, reference(node->node), nullptr}
               : Attachment{at.node, true, make_reference_line(*beam->scene).at(s), at.rigid};
    }
    const Pose<double> frame = frame_of(at);
    return [n = static_cast<std::size_t>(at.node), start = at.pose, frame, rates,
            Ad = adjoint_inverse(frame).matrix()](const State& s, schema::PlaceReading& reading) {
      reading.start = start;
      reading.H = s.pose[n] * frame;
      if (!rates) return;
      reading.V = Ad * s.V[n];
      reading.Vdot = Ad * s.Vdot[n];
    };
  }

  // Of a place between the nodes of an element of a flexible beam: its motion is interpolated, also in the
  // reference configuration, so that what does not move is not displaced.
  PlaceReader motion_within(const CompiledBeam& beam, double s, bool rates) const {
    const std::size_t e = element_at(beam, s);
    const ElementPlace element = within(beam, e, s);
    const auto order = static_cast<std::size_t>(beam.scene->order);
    struct Node {
      std::size_t node;
      Pose<double> frame;
      Mat6 Ad;
    };
    std::vector<Node> nodes;
    for (std::size_t k = 0; k <= order; ++k) {
      const BeamNode& node = beam.nodes[e * (order + 1) + k];
      nodes.push_back(
          {static_cast<std::size_t>(node.node), node.frame, adjoint_inverse(node.frame).matrix()});
    }
    const auto motion = [nodes, l = lagrange(element.batch->table().nodes.points, element.xi),
                         kinematics = beam.scene->kinematics,
                         metric = beam.scene->metric](const State& state, bool moving) {
      std::array<NodeState<double>, beam::max_order + 1> x;
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        const auto& [n, frame, Ad] = nodes[k];
        x[k].H = state.pose[n] * frame;
        if (moving) x[k].V = Ad * state.V[n], x[k].Vdot = Ad * state.Vdot[n];
      }
      return beam::motion_within(kinematics, metric, std::span(x.data(), nodes.size()), l, moving);
    };
    return [motion, rates, start = motion(system_->reference_state(), false).H](
               const State& state, schema::PlaceReading& reading) {
      const NodeState<double> x = motion(state, rates);
      reading.start = start;
      reading.H = x.H;
      reading.V = x.V;
      reading.Vdot = x.Vdot;
    };
  }

  // Mean of the elements that meet at the place (NOTATION.md 3), or of that in which it lies.
  std::function<Vec6(const State&)> resultants(const RecordScene& record,
                                               const CompiledBeam* beam) const {
    if (beam == nullptr)
      find(*record.at, record.source, label(record));  // which says what there is
    if (const ReductionScene* const reduction = reduced_.of(*record.at))
      throw Error(record.source,
                  fmt::format("{}: {} is part of {}: its sectional forces and moments are known to "
                              "records, and not to sensors; record them, or leave them out",
                              label(record), label(*beam->scene), label(*reduction)));
    if (const RigidScene* const rigid = rigid_of(beam->scene->name))
      throw Error(record.source,
                  fmt::format("{}: {} is rigid (part of {}), so that its sectional forces and "
                              "moments are not determined; leave them out",
                              label(record), label(*beam->scene), label(*rigid)));
    const double s = record.at->parameter;
    const std::vector<ElementPlace> places =
        is_boundary(*beam, s) ? beam->ends[boundary_at(*beam, s)]
                              : std::vector{within(*beam, element_at(*beam, s), s)};
    return [places, at_points = at_points()](const State& state) {
      const AtPoints of = at_points(state);
      Vec6 sum = Vec6::Zero();
      for (const ElementPlace& at : places) sum += resultants_there(at, of(at));
      return Vec6(sum / static_cast<double>(places.size()));
    };
  }

  // Sectional forces at the points of elements, in a state.
  using AtPoints = std::function<std::vector<Vec6>(const ElementPlace&)>;
  std::function<AtPoints(const State&)> at_points() const {
    if (!linear_about_)
      return [](const State& state) -> AtPoints {
        return [&state](const ElementPlace& at) { return resultants_at_points(at, state); };
      };
    const int frame = find(*linear_about_, scene_.source, {}).node;
    return [system = system_.get(), frame](const State& state) -> AtPoints {
      std::vector<double> dU;
      State rest = deformation_at_rest(*system, frame, state, dU);
      return LinearResultants(std::move(rest), std::move(dU));
    };
  }

  // How a state is deformed against the frame of a node: increments of all nodes but the ground, body axes, and a state in
  // the reference configuration that has their rates for velocities.
  static State deformation_at_rest(const System& system, int frame, const State& state,
                                   std::vector<double>& dU) {
    State rest = system.reference_state();
    const auto f = static_cast<std::size_t>(frame);
    for (std::size_t n = 1; n < state.pose.size(); ++n) {
      const Pose<double> in = relative(rest.pose[f], rest.pose[n]);
      const Vec6 U = log_se3<double>(relative(state.pose[f] * in, state.pose[n]));
      dU.insert(dU.end(), U.data(), U.data() + 6);
      if (state.V.empty()) continue;
      const Vec6 carried = body_twist<double>(in * exp_se3<double>(U), state.V[f]);
      rest.V[n] = T_inverse_times<double>(U, Vec6(state.V[n] - carried));
    }
    return rest;
  }

  const Scene& scene_;
  std::optional<Place> linear_about_;
  ReductionMembers reduced_;
  std::unique_ptr<System> system_;
  std::vector<std::shared_ptr<ReducedPart>> reductions_;  // in the order of the scene
  const ComponentBatch* components_ = nullptr;            // of these; of the system
  BaseMotion::Shared base_;
  std::map<std::tuple<Kinematics, Metric, Form, Rule, int>, std::unique_ptr<BeamElasticBatch>>
      elastic_;
  std::vector<HeldElement> held_;
  std::map<std::tuple<Metric, int, bool>, std::unique_ptr<HeldStrains>> held_batches_;
  std::map<std::tuple<Metric, Rule, int>, std::unique_ptr<BeamDampingBatch>> damping_;
  std::map<int, Mat6> mass_damping_;  // by node, of those that have any [kg/s, kg.m/s, kg.m2/s]
  std::vector<CompiledBeam> beams_;
  std::map<std::string, Attachment> body_nodes_;
  std::map<std::string, MassProperties> masses_of_;  // of bodies
  std::map<const RigidScene*, int> rigid_nodes_;
  std::unordered_map<std::string_view, const RigidScene*> rigids_;  // by the names of their parts
  std::unordered_map<std::string_view, std::size_t> beam_of_;       // in beams_, by name
  mutable std::unordered_map<std::string_view, const Section*> sections_;
  std::optional<Fusion> fusion_;
  std::vector<int> group_nodes_;  // by group of the fusion; -1: not yet made
  std::unordered_map<std::string_view, const BodyScene*> body_of_;  // by name
  std::optional<JointCompiler> joints_;
  std::optional<Springs> springs_;
  mutable SectionPoints section_points_;
  std::vector<Mat6> masses_{Mat6::Zero()};  // by node, without added mass
  Vec3 low_ = Vec3::Zero(), high_ = Vec3::Zero();
  std::vector<Vec3> points_;
  bool any_ = false;
  double length_ = 1.0;
};

}  // namespace

std::string without_potential(const Scene& scene) {
  for (const BeamScene& beam : scene.beams)
    if (beam.form == Form::paper && rigid_with(scene, beam.name) == nullptr)
      return label(beam) + " has the paper's form, which is not the gradient of an energy";
  if (const std::string feeds = first_feedback(scene); !feeds.empty())
    return feeds +
           " answers to the motion as a law of sensors says, which is not the gradient of an "
           "energy";
  const auto fault = [](const auto& load) -> std::string {
    if (load.moment) return label(load) + " has a dead moment, whose work depends on the way";
    if (load.follower_force || load.follower_moment)
      return label(load) + " follows what it acts on, and its work depends on the way";
    return {};
  };
  for (const LoadScene& load : scene.loads)
    if (std::string what = fault(load); !what.empty()) return what;
  for (const DistributedLoadScene& load : scene.distributed_loads)
    if (std::string what = fault(load); !what.empty()) return what;
  for (const DragScene& drag : scene.drags)
    if (flows(drag)) return label(drag) + " is of a flow, whose work depends on the way";
  for (const ExtensionScene& extension : scene.extensions)
    if (!has_potential(extension))
      return "the plug-in's force \"" + extension.force + "\" has no potential that it tells";
  return {};
}

Model compile(const Scene& scene) { return Compiler(scene).compile({}); }

Model compile_part(const Scene& part, const Place& frame) {
  return Compiler(part, frame).compile({});
}

Model compile(const Scene& scene, const Extensions& extensions) {
  return Compiler(scene).compile(extensions);
}

PlaceInNode Extending::place(const std::string& name) const {
  const std::vector<PlaceInNode> all = places(name);
  if (all.size() > 1)
    throw Error(fmt::format("a part of the program: {} is a beam of {} nodes; give one of its ends",
                            in_quotes(excerpt(name)), all.size()));
  return all.front();
}

}  // namespace mbd
