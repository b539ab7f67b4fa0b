#include "libmbd/run/describe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "elements/beam/beam_elastic_batch.hpp"
#include "libmbd/compile/control.hpp"
#include "libmbd/compile/drags.hpp"
#include "libmbd/compile/time_stepping.hpp"
#include "libmbd/language/schema.hpp"
#include "libmbd/material/solid_shapes.hpp"
#include "libmbd/results/expect.hpp"
#include "libmbd/results/observers.hpp"
#include "libmbd/run/run.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/places.hpp"
#include "libmbd/scene/section_table.hpp"
#include "solvers/constraints/initial.hpp"
#include "solvers/constraints/mechanism.hpp"
#include "solvers/linear/block_solver.hpp"
#include "solvers/linear/klu_solver.hpp"

namespace mbd {
namespace {

using Json = nlohmann::ordered_json;
using schema::shortest;
using Names = std::vector<std::string>;

// ---- words -------------------------------------------------------------------------------------

std::string entry(std::string_view name, const std::string& text) {
  constexpr std::size_t indent = 15;
  return wrapped(fmt::format("  {:<{}}", name, indent - 2), text, indent);
}

// "1 body", "2 bodies".
std::string counted(Index n, std::string_view plural) {
  std::string word(plural);
  if (n == 1) {
    if (plural.ends_with("ies"))
      word.replace(word.size() - 3, 3, "y");
    else if (plural.ends_with("sses"))
      word.resize(word.size() - 2);
    else if (plural.ends_with("s"))
      word.resize(word.size() - 1);
  }
  return fmt::format("{} {}", n, word);
}

std::string joined(const std::vector<std::string>& items, std::string_view between = ", ") {
  std::string text;
  for (const std::string& item : items) {
    if (!text.empty()) text += between;
    text += item;
  }
  return text;
}

// The first of many, and how many more.
std::vector<std::string> some(std::vector<std::string> items) {
  constexpr std::size_t most = 6;
  if (items.size() <= most) return items;
  const std::size_t more = items.size() - (most - 1);
  items.resize(most - 1);
  items.push_back(fmt::format("and {} more", more));
  return items;
}

std::string title(const std::string& model, const std::string& file) {
  const std::string name = model.empty() ? "(a model without a name)" : excerpt(model);
  return file.empty() ? name + "\n" : fmt::format("{} ({})\n", name, file);
}

std::string kind_key(std::string what) {  // "point masses" -> "point_masses"
  std::replace(what.begin(), what.end(), ' ', '_');
  return what;
}

std::string dump(const Json& all) {
  // Names from a model may hold bytes that are not UTF-8: replaced, not refused.
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Index beam_elements(const System& system) {
  Index n = 0;
  for (const auto& batch : system.batches())
    if (dynamic_cast<const BeamElasticBatch*>(batch.get()) != nullptr) n += batch->size();
  return n;
}

// ---- check -------------------------------------------------------------------------------------

std::vector<Count> stated_counts(const Scene& scene) {
  Index elements = 0;
  for (const BeamScene& beam : scene.beams) elements += stated_elements(scene, beam);
  const auto damped = std::count_if(scene.sections.begin(), scene.sections.end(),
                                    [](const Section& s) { return s.damping.has_value(); });
  std::vector<Count> counts;
  each_kind(scene, [&]<class Items>(const Items& items) {
    using Item = typename Items::value_type;
    if constexpr (requires { items.size(); })
      counts.push_back({std::string(Item::item.plural), std::ssize(items)});
    if constexpr (std::is_same_v<Item, InputScene>)  // without outputs of controllers
      counts.back().count = std::count_if(items.begin(), items.end(), [](const InputScene& input) {
        return input.controller.empty();
      });
    if constexpr (std::is_same_v<Item, Section>) counts.push_back({"damped sections", damped});
    if constexpr (std::is_same_v<Item, BeamScene>) counts.push_back({"elements", elements});
  });
  return counts;
}

Index stated(const CheckReport& report, std::string_view what) {
  for (const Count& count : report.stated)
    if (count.what == what) return count.count;
  return 0;
}

std::string constraint_at(const System& system, Index row) {
  return row < 0 ? "" : row_in_words(system, row);
}

void add_mechanism(const System& system, const State& state, const Scene& scene,
                   CheckReport& report) {
  report.mechanism = analyze_mechanism(system, state);
  const Mechanism& mechanism = report.mechanism;
  std::vector<Index> always;  // redundant if beams bend, too
  for (const RedundantRow& row : mechanism.redundant) {
    report.redundant.push_back(to_text(system, row));
    always.push_back(row.row);
  }
  // Rows of constraints, and rows that are redundant, both rise.
  auto row = mechanism.rigid_redundant.begin();
  for (const ConstraintInfo& blamed : system.constraints()) {
    Names rows;
    for (; row != mechanism.rigid_redundant.end() && row->row < blamed.first_row + blamed.rows;
         ++row)
      if (!std::binary_search(always.begin(), always.end(), row->row))
        rows.push_back(blamed.row_names[static_cast<std::size_t>(row->row - blamed.first_row)]);
    if (!rows.empty()) report.redundant_if_rigid.push_back(blamed.name + ": " + joined(rows));
    report.rows_redundant_if_rigid += static_cast<Index>(rows.size());
  }
  if (scene.statics && mechanism.freedoms() > 0)
    report.notes.push_back(fmt::format(
        "the mechanism is free to move in {}, and <static> seeks an equilibrium: there is a unique "
        "one only where springs, loads or gravity hold it; what nothing answers stays as it is, "
        "and "
        "what loads drive needs a joint, a drive or a motion",
        counted(mechanism.freedoms(), "ways")));
}

// Limits that take the place of a relative tolerance: ", position_tolerance 1e-09 m".
std::string error_limits(const TransientScene& transient) {
  std::string text;
  const auto add = [&text](std::string_view name, const std::optional<double>& value,
                           std::string_view unit) {
    if (value) text += fmt::format(", {} {} {}", name, shortest(*value), unit);
  };
  add("position_tolerance", transient.position_tolerance, "m");
  add("rotation_tolerance", transient.rotation_tolerance, "rad");
  add("velocity_tolerance", transient.velocity_tolerance, "m/s");
  add("angular_velocity_tolerance", transient.angular_velocity_tolerance, "rad/s");
  add("max_step", transient.max_step, "s");
  if (transient.errors == ErrorsOf::motion) text += ", errors of motion alone";
  return text;
}

std::string plan(const TransientScene& transient, long steps) {
  std::string text = fmt::format("transient of {} s by {}", shortest(transient.duration),
                                 name_of(transient.method));
  if (transient.method == TimeMethod::radau && stages_of(transient) == StageCount::automatic)
    text += " of as many stages as come farthest";
  else if (transient.stages)
    text += fmt::format(" of {} stages", name_of(*transient.stages));
  if (transient.step)
    text += fmt::format(" in {} of {:.12g} s", counted(steps, "steps"), *transient.step);
  else
    text += fmt::format(", steps for a tolerance of {}{}", shortest(*transient.tolerance),
                        error_limits(transient));
  const std::optional<double> interval = row_interval(transient);
  if (!interval)
    text += ", rows where they end";
  else if (interval != transient.step)
    text += fmt::format(", rows every {:.12g} s", *interval);
  return text;
}

std::string plan(const CheckReport& report) {
  std::vector<std::string> parts;
  if (report.statics)
    parts.push_back(
        fmt::format("static equilibrium in load steps, the first of 1/{}", report.statics->steps));
  if (report.path)
    parts.push_back(fmt::format("path of equilibria, first step {} of the load, at most {}",
                                shortest(report.path->step),
                                counted(report.path->points, "points")));
  if (report.transient) parts.push_back(plan(*report.transient, report.steps));
  return joined(parts, ", then ");
}

std::string residual(const WorstConstraint& worst, std::string_view unit) {
  if (worst.where.empty()) return "none";
  return fmt::format("{:.2g} {} at {}", worst.value, unit, worst.where);
}

Json worst_at_start(const WorstConstraint& worst) {
  return {{"largest", worst.value}, {"where", worst.where}};
}

Json settings(const CheckReport& report) {
  Json all = Json::object();
  if (report.statics)
    all["static"] = {{"steps", report.statics->steps}, {"tolerance", report.statics->tolerance}};
  if (report.path)
    all["path"] = {{"step", report.path->step},
                   {"max_step", report.path->max_step},
                   {"points", report.path->points},
                   {"branch", report.path->branch}};
  if (const auto& transient = report.transient) {
    Json& of = all["transient"] = {{"method", name_of(transient->method)},
                                   {"duration", transient->duration}};
    if (transient->step) {
      of["step"] = *transient->step;
      of["steps"] = report.steps;
    } else {
      of["tolerance"] = *transient->tolerance;
      const auto given = [&of](const char* name, const std::optional<double>& value) {
        if (value) of[name] = *value;
      };
      given("position_tolerance", transient->position_tolerance);
      given("rotation_tolerance", transient->rotation_tolerance);
      given("velocity_tolerance", transient->velocity_tolerance);
      given("angular_velocity_tolerance", transient->angular_velocity_tolerance);
      given("max_step", transient->max_step);
      if (transient->errors) of["errors"] = name_of(*transient->errors);
    }
    const std::optional<double> interval = row_interval(*transient);
    of["output"] = interval ? Json(*interval) : Json("steps");
    if (transient->method == TimeMethod::radau) of["stages"] = name_of(stages_of(*transient));
    if (transient->method == TimeMethod::generalized_alpha)
      of["rho_infinity"] = rho_infinity_of(*transient);
  }
  return all;
}

// ---- explain -----------------------------------------------------------------------------------

// Finds effects and what is absent. Each pair of them is settled in one place, so that nothing is said
// to be both, or neither.
class Explainer {
 public:
  Explainer(const Scene& scene, const Model& model, Explanation& explanation)
      : scene_(scene), system_(*model.system), fused_(model.fused), result_(explanation) {}

  void explain() {
    beams();
    inertia();
    damping();
    gravity();
    base_motion();
    loads();
    fluid();
    joints();
    springs();
    control();
    modes();
    analyses();
    limits();
  }

 private:
  // `<gravity>, line 12`, with the file if it is not that of the model.
  std::string at(const std::string& what, const Source& source) const {
    if (source.line <= 0) return what;
    return source.file == scene_.file ? fmt::format("{}, line {}", what, source.line)
                                      : fmt::format("{}, {}:{}", what, source.file, source.line);
  }

  template <class List, class Which>
  Names from(const List& list, const Which& which) const {
    Names names;
    for (const auto& item : list)
      if (which(item)) names.push_back(at(label(item), item.source));
    return names;
  }
  template <class List>
  Names from(const List& list) const {
    return from(list, [](const auto&) { return true; });
  }

  void present(std::string what, Names names) {
    result_.effects.push_back({std::move(what), std::move(names)});
  }
  void absent(std::string what, std::string why) {
    result_.absent.push_back({std::move(what), std::move(why)});
  }
  void either(const std::string& what, Names names, const std::string& why) {
    if (names.empty())
      absent(what, why);
    else
      present(what, std::move(names));
  }

  // Of kinds of which there is no more to say.
  template <class Item>
  void stated(const std::vector<Item>& items) {
    either(std::string(Item::item.explained), from(items),
           fmt::format("no <{}>", Item::item.element));
  }

  // Said where there is any.
  void control() {
    Names laws;
    each_item(scene_, [&](const auto& item) {
      if (has_sensors(item)) laws.push_back(at(label(item), item.source));
    });
    if (!laws.empty())
      present("loads that answer to the motion at once, by sensors in their laws", laws);
    Names sampled;
    for (const ControllerScene& controller : scene_.controllers)
      sampled.push_back(
          at(fmt::format("{} every {} s", label(controller), shortest(controller.period)),
             controller.source));
    if (!sampled.empty())
      present("controllers, which sample the motion and hold what they give", sampled);
  }

  const Batch* batch(std::string_view type) const {
    for (const auto& one : system_.batches())
      if (one->type() == type) return one.get();
    return nullptr;
  }

  bool is_used(const Section& section) const {
    return std::any_of(scene_.beams.begin(), scene_.beams.end(),
                       [&](const BeamScene& beam) { return beam.section == section.name; });
  }
  bool is_within_rigid(const JointScene& joint) const {
    const RigidScene* const a = rigid_with(scene_, joint.a.name);
    return a != nullptr && a == rigid_with(scene_, joint.b.name);
  }
  bool is_flexible(const BeamScene& beam) const {
    return rigid_with(scene_, beam.name) == nullptr && reduction_with(scene_, beam.name) == nullptr;
  }

  static constexpr std::array<std::string_view, 6> held_names = {
      "stretching", "shearing along b2", "shearing along b3",
      "twisting",   "bending about b2",  "bending about b3"};

  static bool is_coupled(const Section& section) {
    const auto off_diagonal = [](const Mat6& D) { return !D.isDiagonal(0.0); };
    if (section.stations.empty()) return off_diagonal(section.stiffness);
    return std::any_of(section.stations.begin(), section.stations.end(),
                       [&](const Station& station) { return off_diagonal(station.stiffness); });
  }

  // Sections whose D and M were not stated, with what is not known of D.
  Names computed() const {
    Names names;
    const auto add = [&](const Section& section, const auto& of) {
      if (!of.shape || !of.found || !is_used(section)) return;
      std::string what = label(section) + " by <" + std::string(element_of(*of.shape)) + ">";
      names.push_back(at(what, of.shape->source) + fmt::format(" (D to {:.0e}{})",
                                                               of.found->error.maxCoeff(),
                                                               of.found->mass ? "" : ", mass not"));
    };
    for (const Section& section : scene_.sections) {
      add(section, section);
      for (const Station& station : section.stations) add(section, station);
    }
    return names;
  }

  void beams() {
    if (!scene_.rigids.empty())
      present("beams and bodies that are one rigid body", from(scene_.rigids));
    if (!scene_.reductions.empty())
      present("beams and bodies that deform by component modes, little and linearly",
              from(scene_.reductions));
    const Names flexible =
        from(scene_.beams, [this](const BeamScene& beam) { return is_flexible(beam); });
    if (flexible.empty()) {
      absent("elastic deformation", scene_.beams.empty()
                                        ? "no <beam>, <arc> or <curve>: every body is rigid"
                                        : "every beam is part of a <rigid> or a <reduction>");
      return;
    }
    present("stretching, shearing, bending and twisting of beams, of any size of rotation",
            flexible);
    const Names classical = from(scene_.beams, [this](const BeamScene& beam) {
      return beam.kinematics == Kinematics::classical && is_flexible(beam);
    });
    if (!classical.empty())
      present("classical beams, displacement and rotation interpolated apart", classical);
    const auto used = [this](auto which) {
      return from(scene_.sections,
                  [this, which](const Section& s) { return is_used(s) && which(s); });
    };
    for (std::size_t c = 0; c < held_names.size(); ++c)
      if (Names held = used([c](const Section& s) { return infinite_stiffnesses(s)[c]; });
          !held.empty())
        present(fmt::format("no {} of beams: its stiffness is infinite", held_names[c]),
                std::move(held));
    either("coupling of stretching, shearing, bending and twisting", used(is_coupled),
           "the stiffness of every section used is diagonal");
    if (Names names = computed(); !names.empty())
      present("stiffness and mass computed from material and shape", std::move(names));
    either("sections that vary along a beam",
           used([](const Section& s) { return !s.stations.empty(); }),
           "no section used has stations");
    either("curved beams",
           from(scene_.beams,
                [](const BeamScene& beam) {
                  const auto* const curve = std::get_if<Curve>(&beam.line);
                  return curve != nullptr ? curve->points.size() > 2
                                          : std::holds_alternative<Arc>(beam.line);
                }),
           "every reference line is straight");
  }

  // What has mass, whether or not it matters.
  Names masses() const {
    Names names = from(scene_.sections, [this](const Section& s) {
      return is_used(s) && (s.mass || (!s.stations.empty() && s.stations.front().mass));
    });
    const Names bodies = from(scene_.bodies, [](const BodyScene& b) {
      const MassProperties is = mass_properties(b);
      return is.mass > 0.0 || !is.inertia.isZero(0.0);
    });
    const Names points =
        from(scene_.point_masses, [](const PointMassScene& m) { return m.mass > 0.0; });
    names.insert(names.end(), bodies.begin(), bodies.end());
    names.insert(names.end(), points.begin(), points.end());
    return names;
  }

  void inertia() {
    if (!scene_.transient) {
      absent("inertia and velocities", "no <transient>: only an equilibrium is sought");
      return;
    }
    if (scene_.transient->inertia == InertiaTerms::full) {
      either("inertia, with its centrifugal and gyroscopic forces", masses(), "nothing has mass");
    } else {
      either("inertia, with its centrifugal forces", masses(), "nothing has mass");
      absent("gyroscopic moments",
             at("<transient>", scene_.transient->source) + ": inertia=\"no_gyroscopic\"");
    }
    either("velocities at the start",
           from(scene_.bodies,
                [](const BodyScene& b) {
                  return !b.velocity.isZero(0.0) || !b.angular_velocity.isZero(0.0);
                }),
           "no <body> states any");
  }

  // Of beams; that of the integrator is named with it.
  void damping() {
    const auto damped = [this](auto of_kind) {
      return from(scene_.sections, [this, of_kind](const Section& s) {
        return is_used(s) && s.damping && of_kind(*s.damping);
      });
    };
    const Names viscous = damped([](const SectionDamping& d) {
      return d.stiffness_proportional > 0.0 || !d.viscous.isZero(0.0);
    });
    const Names massive = damped([](const SectionDamping& d) { return d.mass_proportional > 0.0; });
    const std::string what = "structural damping: viscous sectional forces",
                      drag = "damping proportional to mass, of rigid motion too";
    if (!scene_.transient && !(viscous.empty() && massive.empty())) {
      absent("structural damping", "no <transient>, and so no rates: " +
                                       joined(some(viscous.empty() ? massive : viscous)));
      return;
    }
    if (!viscous.empty()) present(what, viscous);
    if (!massive.empty()) present(drag, massive);
    if (viscous.empty() && massive.empty()) {
      const Names zero = damped([](const SectionDamping&) { return true; });
      std::string why = zero.empty() ? "no <damping> in a <section> used"
                                     : "what is stated is zero: " + joined(some(zero));
      if (scene_.transient && scene_.transient->method != TimeMethod::generalized_alpha)
        why += fmt::format("; {} damps numerically", name_of(scene_.transient->method));
      else if (scene_.transient)
        why += rho_infinity_of(*scene_.transient) < 1.0
                   ? fmt::format("; rho_infinity = {} damps numerically",
                                 shortest(rho_infinity_of(*scene_.transient)))
                   : "; with rho_infinity = 1 nothing is damped";
      absent("structural damping", why);
    }
  }

  void gravity() {
    if (!scene_.gravity) {
      absent("gravity", "no <gravity>");
      return;
    }
    const std::string here = at("<gravity>", scene_.gravity->source);
    const Batch* const nodes = batch("gravity");
    if (nodes == nullptr || nodes->size() == 0)
      absent("gravity", here + ": it has nothing to act on, as nothing has mass");
    else if (scene_.gravity->acceleration.isZero(0.0))
      absent("gravity", here + ": its acceleration is zero");
    else
      present("gravity", {here});
  }

  void base_motion() {
    if (!scene_.base_motion) {
      absent("motion of the base", "no <base_motion>");
      return;
    }
    const std::string here = at("<base_motion>", scene_.base_motion->source);
    either("motion of the base, relative to which everything is",
           batch("base motion") != nullptr ? Names{here} : Names{},
           here + ": its acceleration is zero");
  }

  void fluid() {
    const bool moves = scene_.transient.has_value();
    const std::string still = "in statics nothing moves, and a fluid without flow drags nothing: ";
    const Names idle = from(scene_.drags, [&](const DragScene& d) { return !moves && !flows(d); });
    if (!idle.empty()) absent("drag of a fluid at rest", still + joined(some(idle)));
    if (idle.empty() || idle.size() < scene_.drags.size())
      either("drag of a fluid",
             from(scene_.drags, [&](const DragScene& d) { return moves || flows(d); }),
             "no <drag>");
    if (moves || scene_.added_masses.empty())
      either("added mass of a fluid", from(scene_.added_masses), "no <added_mass>");
    else
      absent("added mass of a fluid",
             "no <transient>: nothing is accelerated: " + joined(some(from(scene_.added_masses))));
  }

  void loads() {
    const auto is_dead = [](const auto& load) { return load.force || load.moment; };
    const auto follows = [](const auto& load) {
      return load.follower_force || load.follower_moment;
    };
    stated(scene_.loads);
    stated(scene_.distributed_loads);
    each_kind(scene_, [this]<class Items>(const Items& items) {
      using Item = typename Items::value_type;
      constexpr bool elsewhere =
          std::is_same_v<Item, LoadScene> || std::is_same_v<Item, DistributedLoadScene> ||
          std::is_same_v<Item, JointTorqueScene> || std::is_same_v<Item, MotionScene>;
      if constexpr (std::is_same_v<Item, InputScene>)
        either(std::string(Item::item.explained),
               from(items, [](const InputScene& input) { return input.controller.empty(); }),
               "no <input>");
      else if constexpr (!Item::item.explained.empty() && !elsewhere)
        stated(items);
    });
    if (scene_.loads.empty() && scene_.distributed_loads.empty()) return;

    // Components that are zero are not in a batch: what is stated may do nothing.
    const auto kind = [&](const std::string& what, const char* type, const auto& which,
                          const std::string& why) {
      Names names = from(scene_.loads, which);
      const Names more = from(scene_.distributed_loads, which);
      names.insert(names.end(), more.begin(), more.end());
      if (!names.empty() && batch(type) == nullptr)
        absent(what, "those stated are zero: " + joined(some(names)));
      else
        either(what, names, why);
    };
    kind("loads of fixed direction", "dead load", is_dead,
         "every load follows its section or body");
    kind("loads that follow their section or body", "follower load", follows,
         "no follower_force or follower_moment");
  }

  void joints() {
    if (scene_.joints.empty()) absent("joints", "none stated");
    for (const schema::JointKind& kind : schema::joint_kinds()) {
      const Names names = from(scene_.joints, [&](const JointScene& j) {
        return j.kind == kind.name && !is_within_rigid(j);
      });
      if (!names.empty()) present(fmt::format("{} joints", kind.name), names);
    }
    if (!fused_.empty()) {
      Names names;
      for (const Model::Maker& joint : fused_) names.push_back(joint.label);
      absent(fmt::format("multipliers of {}", counted(std::ssize(fused_), "fixed joints")),
             "fused: what they join is one node: " + joined(some(names)));
    }
    if (const Names idle =
            from(scene_.joints, [this](const JointScene& j) { return is_within_rigid(j); });
        !idle.empty())
      absent("joints within what is rigid", "they hold what cannot move: " + joined(some(idle)));
    Names drives;
    for (const DriveScene& drive : scene_.drives)
      drives.push_back(at(label("drive", drive.joint), drive.source));
    either("driven joints", drives, "no <drive>");
    stated(scene_.motions);
  }

  void springs() {
    either("springs between two points",
           from(scene_.springs,
                [](const SpringScene& s) { return s.stiffness > 0.0 || s.force.has_value(); }),
           "no <spring> has a stiffness or a force");
    dampers(
        "dampers between two points",
        from(scene_.springs,
             [](const SpringScene& s) { return s.damping > 0.0 || s.damping_force.has_value(); }),
        "no <spring> has a damping");
    either("bushings",
           from(scene_.bushings,
                [](const BushingScene& b) { return !b.stiffness.isZero(0.0) || !b.laws.empty(); }),
           "no <bushing> has a stiffness or a law");
    dampers("damping of bushings",
            from(scene_.bushings, [](const BushingScene& b) { return !b.damping.isZero(0.0); }),
            "no <bushing> has a damping");
    const auto elastic = [](const JointSpringScene& s) {
      return s.stiffness > 0.0 || s.force.has_value();
    };
    const auto damped = [](const JointSpringScene& s) {
      return s.damping > 0.0 || s.damping_force.has_value();
    };
    either("springs of joints", from(scene_.joint_springs, elastic),
           "no <joint_spring> has a stiffness or a law");
    dampers("dampers of joints", from(scene_.joint_springs, damped),
            "no <joint_spring> has a damping");
    stated(scene_.joint_torques);
  }

  // Nothing damps in equilibria.
  void dampers(const std::string& what, const Names& names, const std::string& why) {
    if (!names.empty() && !scene_.transient)
      absent(what,
             "no <transient>: those stated do nothing in an equilibrium: " + joined(some(names)));
    else
      either(what, names, why);
  }

  void analyses() {
    if (scene_.statics)
      present(fmt::format("equilibrium at t = 0, loads raised in steps, the first of 1/{}",
                          scene_.statics->steps),
              {at("<static>", scene_.statics->source)});
    else
      absent("equilibrium before the first step",
             scene_.beams.empty() || scene_.path
                 ? "no <static>"
                 : "no <static>: beams start in their stated shape, unstrained");
    if (scene_.path) {
      const std::string here = at("<path>", scene_.path->source);
      present("equilibria over the load factor, through limit points", {here});
      const std::string why = without_potential(scene_);
      if (why.empty())
        present("stability: negative eigenvalues of the tangent at each of them", {here});
      else
        absent("count of negative eigenvalues", why);
      if (scene_.path->branch != 0)
        present(fmt::format("branch from bifurcation {}", std::abs(scene_.path->branch)), {here});
      else
        absent("other branches", here + ": branch=\"0\"");
    }
    if (!scene_.transient) {
      absent("course in time", "no <transient>");
      return;
    }
    const TransientScene transient = transient_of(scene_);
    const std::string here = at("<transient>", transient.source);
    const bool alpha = transient.method == TimeMethod::generalized_alpha;
    const std::string balance =
        balance_of(system_, transient) == Balance::momentum ? "momenta"
        : keeps_momenta(system_, transient)
            ? "accelerations, and of the momenta of parts that nothing holds"
            : "accelerations";
    present(fmt::format("course in time by {}, {}{}", name_of(transient.method),
                        transient.step ? fmt::format("steps of {} s", shortest(*transient.step))
                                       : fmt::format("steps for a relative error of {}",
                                                     shortest(*transient.tolerance)) +
                                             error_limits(transient),
                        alpha ? ", balance of " + balance : ""),
            {here});
    if (const double rho = rho_infinity_of(transient); !alpha)
      present("numerical damping of what the step does not resolve, by the method", {here});
    else if (rho < 1.0)
      present(fmt::format("numerical damping of what the step does not resolve, rho_infinity = {}",
                          shortest(rho)),
              {here});
    else
      absent("numerical damping", here + ": rho_infinity = 1 damps nothing");

    Names times;
    for (const Breakpoint& b : system_.breakpoints())
      if (b.restart && b.t > 0.0 && b.t < transient.duration)
        times.push_back("t = " + shortest(b.t) + " s");
    if (!system_.signals().empty())
      either("new starts of the integrator where drives, motions or loads jump", times,
             "none of them jumps after the start");
  }

  // Said where they are asked for, as they change nothing in the run.
  void modes() {
    if (scene_.modes)
      present("modes of small motions, beside the run", {at("<modes>", scene_.modes->source)});
  }

  // What no model of this version can have. Said each time, as its absence is easily overlooked.
  void limits() {
    absent("friction, clearance and contact", "this version has none");
    if (!scene_.beams.empty())
      absent("plastic or nonlinear material, warping as a freedom",
             "a beam has the linear stiffness of its section");
  }

  const Scene& scene_;
  const System& system_;
  const std::vector<Model::Maker>& fused_;
  Explanation& result_;
};

std::vector<Term> make_terms(const System& system) {
  const BlockGraph& graph = system.graph();
  const std::span<const std::size_t> first = system.first_contributions();
  std::vector<Term> terms;
  for (std::size_t i = 0; i < system.batches().size(); ++i) {
    const Batch& batch = *system.batches()[i];
    Term term{std::string(batch.type()), batch.size(), 0, batch.bytes()};
    for (std::size_t k = first[i]; k < first[i + 1]; ++k) {
      const auto [row, column] = graph.contributions[k];
      if (row >= 0 && column >= 0)
        term.contributions += Index{graph.blocks[static_cast<std::size_t>(row)].size} *
                              graph.blocks[static_cast<std::size_t>(column)].size;
    }
    terms.push_back(std::move(term));
  }
  return terms;
}

std::size_t bytes_of(const State& state) {
  return sizeof(State) + state.pose.size() * sizeof(state.pose[0]) +
         (state.V.size() + state.Vdot.size()) * sizeof(Vec6) +
         static_cast<std::size_t>(state.lambda.size()) * sizeof(double) +
         state.signals.size() * sizeof(SignalValue) + state.angles.size() * sizeof(double);
}

}  // namespace

CheckReport check_model(const Scene& scene, const Model& model) {
  CheckReport report;
  report.model = scene.name;
  report.file = scene.file;
  report.stated = stated_counts(scene);
  report.statics = scene.statics;
  if (scene.transient) report.transient = transient_of(scene);
  report.path = scene.path;
  if (scene.transient) (void)RowTimes(scene);  // refuses what a run refuses
  if (scene.transient && scene.transient->step) report.steps = number_of_steps(*scene.transient);
  check_outputs(scene, model);
  report.columns = static_cast<Index>(columns(model).size());

  const System& system = *model.system;
  report.elements = beam_elements(system);
  report.nodes = system.nodes();
  report.unknowns = system.unknowns();
  report.multipliers = system.multipliers();
  report.fused = std::ssize(model.fused);

  bool any = false;
  const auto include = [&](const Vec3& r) {
    report.low = any ? Vec3(report.low.cwiseMin(r)) : r;
    report.high = any ? Vec3(report.high.cwiseMax(r)) : r;
    any = true;
  };
  const State reference = system.reference_state();
  for (Index n = 1; n < system.nodes(); ++n) include(system.reference_pose(n).r);
  for (const Model::Line& line : model.lines)
    for (std::size_t k = 0; k < line.size(); ++k) include(line.pose(reference.pose, k).r);
  if (scene.transient) report.mass = model.mass;

  report.energy = system.energies(model.initial);
  const ConstraintResiduals residuals = constraint_residuals(system, model.initial);
  report.position = {residuals.position, 0.0, constraint_at(system, residuals.position_row)};
  report.velocity = {residuals.velocity, 0.0, constraint_at(system, residuals.velocity_row)};
  add_mechanism(system, model.initial, scene, report);
  return report;
}

namespace {

std::string size_in_words(const CheckReport& report) {
  const std::string elements =
      report.elements > 0 ? counted(report.elements, "beam elements") + ", " : "";
  const Index held = report.mechanism.held_strains, stiff = report.mechanism.stiff_strains;
  return fmt::format(
      "{}{} with the ground, {}, of which {}{}{}", elements, counted(report.nodes, "nodes"),
      counted(report.unknowns, "unknowns"), counted(report.multipliers, "multipliers"),
      held == 0 ? std::string() : fmt::format(" ({} of strains that are held at zero)", held),
      stiff == 0
          ? std::string()
          : fmt::format(" ({} sectional forces of stretches and shears much stiffer than bending)",
                        stiff));
}

}  // namespace

std::string to_text(const CheckReport& report) {
  std::string text = title(report.model, report.file);
  std::vector<std::string> items;
  for (const Count& count : report.stated)
    if (count.count > 0) items.push_back(counted(count.count, count.what));
  text += entry("stated", joined(items));
  text += entry("system", size_in_words(report));
  if (report.fused > 0)
    text +=
        entry("fused", fmt::format("{}: what {} is one node", counted(report.fused, "fixed joints"),
                                   report.fused == 1 ? "it joins" : "they join"));
  const auto corner = [](const Vec3& x) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", x(0) + 0.0, x(1) + 0.0, x(2) + 0.0);
  };
  text += entry("size", fmt::format("from {} to {} m", corner(report.low), corner(report.high)) +
                            (report.mass ? fmt::format("; mass {:.6g} kg", *report.mass) : ""));
  text += entry(
      "mechanism",
      fmt::format("{}{}; the joints leave {}; drives and motions "
                  "prescribe {}; {} left",
                  report.elements > 0 ? "with rigid beams: " : "",
                  counted(report.mechanism.rigid_parts, "parts"),
                  counted(report.mechanism.joint_freedoms, "freedoms"), report.mechanism.prescribed,
                  report.mechanism.freedoms() == 0
                      ? "none is"
                      : fmt::format("{} {}", report.mechanism.freedoms(),
                                    report.mechanism.freedoms() == 1 ? "is" : "are")));
  text += entry("redundant",
                report.redundant.empty()
                    ? "no constraint"
                    : counted(static_cast<Index>(report.redundant.size()), "constraints") + ":");
  for (const std::string& sentence : report.redundant) text += wrapped("    ", sentence, 6);
  if (!report.redundant_if_rigid.empty()) {
    text += entry("", counted(report.rows_redundant_if_rigid, "more") +
                          " would be, were the beams rigid; as they deform, each has a force of "
                          "its own:");
    for (const std::string& sentence : report.redundant_if_rigid)
      text += wrapped("    ", sentence, 6);
  }
  text += entry("start",
                fmt::format("energy: {:.6g} J kinetic, {:.6g} J potential, {:.6g} J strain",
                            report.energy.kinetic, report.energy.potential, report.energy.strain));
  if (report.multipliers > 0) {
    text += entry("", "largest gap: " + residual(report.position, "m or rad"));
    if (report.transient)
      text += entry("", "largest gap rate: " + residual(report.velocity, "m/s or rad/s"));
  }
  text += entry("to be run", plan(report));
  text += entry("results",
                fmt::format("{} in history.csv, {} to be met", counted(report.columns, "columns"),
                            counted(stated(report, "expectations"), "expectations")));
  for (const std::string& note : report.notes) text += wrapped("note: ", note, 6);
  return text;
}

std::string to_json(const CheckReport& report) {
  Json all = Json::object();
  all["model"] = report.model;
  all["file"] = report.file;
  all["version"] = version();
  Json& counts = all["stated"] = Json::object();
  for (const Count& count : report.stated) counts[kind_key(count.what)] = count.count;
  all["system"] = {{"elements", report.elements},
                   {"nodes", report.nodes},
                   {"unknowns", report.unknowns},
                   {"multipliers", report.multipliers},
                   {"held_strains", report.mechanism.held_strains},
                   {"stiff_strains", report.mechanism.stiff_strains},
                   {"fused_joints", report.fused}};
  all["size"] = {{"low", {report.low(0), report.low(1), report.low(2)}},
                 {"high", {report.high(0), report.high(1), report.high(2)}},
                 {"mass", report.mass ? Json(*report.mass) : Json()}};
  all["mechanism"] = {{"rigid_parts", report.mechanism.rigid_parts},
                      {"joint_freedoms", report.mechanism.joint_freedoms},
                      {"prescribed", report.mechanism.prescribed},
                      {"freedoms", report.mechanism.freedoms()},
                      {"redundant", report.redundant},
                      {"redundant_if_beams_were_rigid", report.redundant_if_rigid}};
  all["start"] = {{"energy",
                   {{"kinetic", report.energy.kinetic},
                    {"strain", report.energy.strain},
                    {"potential", report.energy.potential},
                    {"total", report.energy.total()}}},
                  {"constraint_residuals",
                   {{"position", worst_at_start(report.position)},
                    {"velocity", worst_at_start(report.velocity)}}}};
  all["settings"] = settings(report);
  all["columns"] = report.columns;
  all["notes"] = report.notes;
  return dump(all);
}

Explanation explain_model(const Scene& scene, const Model& model) {
  const System& system = *model.system;
  Explanation result;
  result.model = scene.name;
  result.file = scene.file;
  result.terms = make_terms(system);
  for (const Term& term : result.terms) result.batch_bytes += term.bytes;
  result.nodes = system.nodes();
  result.unknowns = system.unknowns();
  result.multipliers = system.multipliers();
  const std::unique_ptr<LinearSolver> solver = make_klu_solver();
  solver->analyze(system.graph());
  result.nonzeros = solver->nonzeros();
  const auto add_solver = [&](const char* analysis, LinearMethod method, PivotOrder order) {
    result.linear_solvers.emplace_back(analysis,
                                       describe_linear_solver(method, order, system.graph()));
  };
  if (scene.statics) add_solver("static", scene.statics->linear_solver, PivotOrder::merged);
  if (scene.path) add_solver("path", LinearMethod::klu, PivotOrder::merged);
  if (scene.transient)
    add_solver("transient",
               scene.transient->method == TimeMethod::ida ? LinearMethod::klu
                                                          : scene.transient->linear_solver,
               PivotOrder::nodes_first);
  result.state_bytes = bytes_of(model.initial);
  Explainer(scene, model, result).explain();
  return result;
}

std::string to_text(const Explanation& e) {
  std::size_t width = 24;
  for (const Term& term : e.terms) width = std::max(width, letters(term.type));
  std::string text = title(e.model, e.file);
  Index contributions = 0;
  const auto row = [&](std::string_view what, const auto& number, const auto& nonzeros,
                       const auto& bytes) {
    text += "  " + std::string(what) + std::string(width - letters(what), ' ') +
            fmt::format(" {:>6} {:>8} {:>9}", number, nonzeros, bytes);
    text.erase(text.find_last_not_of(' ') + 1);
    text += "\n";
  };
  text += "\n";
  row("term", "number", "nonzeros", "bytes");
  for (const Term& term : e.terms) {
    row(term.type, term.size, term.contributions, term.bytes);
    contributions += term.contributions;
  }
  row("all terms", "", contributions, e.batch_bytes);
  row("the matrix", "", e.nonzeros, "");
  text += "\n";
  text += wrapped(
      "  ",
      fmt::format("{} with the ground, {}, of which {}; a state has {}.", counted(e.nodes, "nodes"),
                  counted(e.unknowns, "unknowns"), counted(e.multipliers, "multipliers"),
                  counted(static_cast<Index>(e.state_bytes), "bytes")),
      2);
  text += wrapped("  ",
                  "Nonzeros of a term are numbers that it adds to the matrix; several terms may "
                  "add to the same place.",
                  2);
  for (const auto& [analysis, linear_solver] : e.linear_solvers)
    text += wrapped("  ", fmt::format("Linear systems of <{}>: {}.", analysis, linear_solver), 2);
  text += "\nSimulated, and where it is stated\n";
  for (const Effect& effect : e.effects)
    text += wrapped("  ", effect.what + ": " + joined(some(effect.from), "; "), 6);
  text += "\nAbsent, and why\n";
  for (const Absence& absence : e.absent)
    text += wrapped("  ", absence.what + ": " + absence.why, 6);
  return text;
}

std::string to_json(const Explanation& e) {
  Json terms = Json::array(), effects = Json::array(), absent = Json::array();
  for (const Term& term : e.terms)
    terms.push_back({{"type", term.type},
                     {"size", term.size},
                     {"nonzeros_added", term.contributions},
                     {"bytes", term.bytes}});
  for (const Effect& effect : e.effects)
    effects.push_back({{"effect", effect.what}, {"from", effect.from}});
  for (const Absence& absence : e.absent)
    absent.push_back({{"effect", absence.what}, {"why", absence.why}});
  Json all = Json::object();
  all["model"] = e.model;
  all["file"] = e.file;
  all["version"] = version();
  all["terms"] = terms;
  all["totals"] = {{"nodes", e.nodes},
                   {"unknowns", e.unknowns},
                   {"multipliers", e.multipliers},
                   {"nonzeros", e.nonzeros},
                   {"bytes_of_terms", e.batch_bytes},
                   {"bytes_of_a_state", e.state_bytes}};
  Json& linear_solvers = all["linear_solvers"] = Json::object();
  for (const auto& [analysis, linear_solver] : e.linear_solvers)
    linear_solvers[analysis] = linear_solver;
  all["simulated"] = effects;
  all["absent"] = absent;
  return dump(all);
}

}  // namespace mbd
