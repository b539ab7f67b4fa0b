#include "libmbd/language/check_scene.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <stdexcept>

#include "libmbd/language/schema.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/laws.hpp"
#include "libmbd/scene/places.hpp"
#include "libmbd/scene/section_table.hpp"
#include "libmbd/scene/transient.hpp"
#include "libmbd/text/spelling.hpp"

namespace mbd {
namespace {

// An item of the scene and the element of the schema it is an instance of.
class Checked {
 public:
  Checked(std::string_view element, const std::string& name, const Source& source)
      : element_(schema::find_element(element)), source_(source), label_(label(element, name)) {
    if (!element_) throw std::logic_error("not in the schema: " + std::string(element));
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(source_, label_ + ": " + what);
  }
  void fail_if(bool bad, const std::string& what) const {
    if (bad) fail(what);
  }

  void number(std::string_view attribute, double value) const { check(attribute, value, ""); }
  void number(std::string_view attribute, const std::optional<double>& value) const {
    if (value) number(attribute, *value);
  }
  void numbers(std::string_view attribute, std::span<const double> values) const {
    for (std::size_t i = 0; i < values.size(); ++i)
      check(attribute, values[i], "component " + std::to_string(i + 1) + " ");
  }
  void vector(std::string_view attribute, const Vec3& value) const {
    numbers(attribute, {value.data(), 3});
  }
  void vector(std::string_view attribute, const std::optional<Vec3>& value) const {
    if (value) vector(attribute, *value);
  }

  void required(std::string_view attribute, bool given) const {
    if (!given) fail(schema::missing(entry(attribute)));
  }

  void place(std::string_view attribute, const Place& p) const {
    fail_if(p.kind == Place::Kind::beam && !(p.parameter >= 0.0 && p.parameter <= 1.0),
            std::string(attribute) + ": " + excerpt(p.name) + "@" + schema::shortest(p.parameter) +
                " is no place; it must lie between 0, the start of the beam, and 1, its end");
  }
  void place(std::string_view attribute, const std::optional<Place>& p) const {
    if (p) place(attribute, *p);
  }

  const schema::Element& element() const { return *element_; }

 private:
  const schema::Attribute& entry(std::string_view attribute) const {
    const schema::Attribute* const found = schema::find_attribute(*element_, attribute);
    if (!found) throw std::logic_error("not in the schema: " + std::string(attribute));
    return *found;
  }
  void check(std::string_view attribute, double value, const std::string& which) const {
    if (const std::string fault = schema::fault(entry(attribute), value); !fault.empty())
      fail(std::string(attribute) + " " + which + fault);
  }

  const schema::Element* element_;
  const Source& source_;
  std::string label_;
};

// Names that must differ, and who has them.
class NamesTaken {
 public:
  explicit NamesTaken(std::string of) : of_(std::move(of)) {}

  void add(const Checked& item, const std::string& name, const Source& source) {
    item.fail_if(!schema::is_name(name), "the name " + in_quotes(excerpt(name)) + " is no name; " +
                                             std::string(schema::names_are));
    const auto [first, is_new] = seen_.try_emplace(name, &source);
    item.fail_if(!is_new, "the name " + in_quotes(name) + " is taken" +
                              place(*first->second, source) + "; names of " + of_ +
                              " must differ (in <repeat>: name=\"" + name + "{i}\")");
  }

 private:
  static std::string place(const Source& first, const Source& here) {
    if (first.line <= 0) return {};
    const std::string line = std::to_string(first.line);
    return first.file == here.file ? " (line " + line + ")" : " (" + first.file + ":" + line + ")";
  }

  std::string of_;
  std::map<std::string, const Source*> seen_;
};

void check(const Section& section) {
  const Checked item("section", section.name, section.source);
  for (const Station& station : section.stations)
    Checked("station", {}, station.source).number("at", station.at);
  item.fail_if(section.stations.empty() && section.interpolation != Interpolation::linear,
               "interpolation is between stations; leave it out or give <station>s");
  if (const auto& damping = section.damping) {
    const Checked of("damping", {}, damping->source);
    of.number("stiffness_proportional", damping->stiffness_proportional);
    of.number("mass_proportional", damping->mass_proportional);
    constexpr std::string_view diagonal[] = {"EA", "GA2", "GA3", "GJ", "EI2", "EI3"};
    for (Index i = 0; i < 6; ++i)
      of.number(diagonal[static_cast<std::size_t>(i)], damping->viscous(i, i));
  }
  check_section(section);
}

void check(const BeamScene& beam) {
  const Checked item(element_of(beam), beam.name, beam.source);
  item.vector("normal", beam.normal);
  item.number("elements", beam.elements);
  item.number("order", beam.order);
  if (beam.kinematics == Kinematics::classical) {
    const BeamScene defaults;
    item.fail_if(beam.metric != defaults.metric,
                 "metric is of kinematics=\"motion\", not of \"classical\"; leave one of them out");
    item.fail_if(beam.form != defaults.form,
                 "form is of kinematics=\"motion\", not of \"classical\"; leave one of them out");
  }
  if (const auto* const line = std::get_if<Straight>(&beam.line)) {
    item.vector("from", line->from);
    item.vector("to", line->to);
  } else if (const auto* const arc = std::get_if<Arc>(&beam.line)) {
    item.vector("from", arc->from);
    item.vector("center", arc->center);
    item.vector("axis", arc->axis);
    item.number("angle", arc->angle);
  } else {
    const std::vector<CurvePoint>& points = std::get<Curve>(beam.line).points;
    for (const CurvePoint& p : points) {
      const Checked point("point", {}, p.source);
      point.vector("at", p.at);
      point.vector("normal", p.normal);
      point.number("twist", p.twist);
    }
  }
}

void check(const BodyScene& body) {
  const Checked item("body", body.name, body.source);
  const auto taken = [&](std::string_view attribute, bool given) {
    item.fail_if(
        body.attached_to && given,
        std::string(attribute) + " is taken from the place of attached_to; leave one of them out");
  };
  item.place("attached_to", body.attached_to);
  item.vector("at", body.at);
  item.vector("velocity", body.velocity);
  item.vector("angular_velocity", body.angular_velocity);
  item.vector("center", body.center);
  item.number("mass", body.mass);
  item.numbers("orientation", {body.orientation.data(), 9});
  item.numbers("inertia", {body.inertia.data(), 9});
  taken("at", !body.at.isZero(0.0));
  taken("orientation", body.orientation != Mat3::Identity());
  taken("velocity", !body.velocity.isZero(0.0));
  taken("angular_velocity", !body.angular_velocity.isZero(0.0));
  constexpr double digits = 1e-9;
  item.fail_if(
      (body.orientation.transpose() * body.orientation - Mat3::Identity()).cwiseAbs().maxCoeff() >
              digits ||
          body.orientation.determinant() < 0.0,
      "orientation is not a rotation to 9 digits; give more digits, write the entries as "
      "expressions, or give a rotation vector");
}

void check(const JointScene& joint) {
  const schema::JointKind* const kind = schema::find_joint_kind(joint.kind);
  if (!kind) {
    std::vector<std::string_view> known;
    for (const schema::JointKind& k : schema::joint_kinds()) known.push_back(k.name);
    throw Error(joint.source, label(joint) + ": there is no joint <" + excerpt(joint.kind) + ">" +
                                  suggest(joint.kind, known, "kinds"));
  }
  const Checked item(joint.kind, joint.name, joint.source);
  const auto given = [&](std::string_view attribute, bool is_given) {
    const schema::Attribute* const known = schema::find_attribute(item.element(), attribute);
    item.fail_if(is_given && !known, schema::unknown_attribute(item.element(), attribute));
    if (known && known->fallback == schema::required) item.required(attribute, is_given);
  };
  item.place("between", joint.a);
  item.place("between", joint.b);
  const std::string parameter = kind->traits.parameter.name;
  given("at", joint.at.has_value());
  given("at_a", joint.at_a.has_value());
  given("at_b", joint.at_b.has_value());
  given("axis", joint.axis.has_value());
  given("second_axis", joint.second_axis.has_value());
  given(parameter.empty() ? "parameter" : parameter, joint.parameter.has_value());
  for (const auto& [attribute, value] :
       {std::pair{"at", &joint.at}, std::pair{"at_a", &joint.at_a}, std::pair{"at_b", &joint.at_b},
        std::pair{"axis", &joint.axis}, std::pair{"second_axis", &joint.second_axis}})
    if (*value) item.vector(attribute, *value);
  if (joint.parameter) item.number(parameter, joint.parameter);
}

void check(const MotionScene& motion) {
  const Checked item("motion", motion.name, motion.source);
  item.place("of", motion.of);
  item.vector("axis", motion.axis);
}

void check(const DriveScene& drive) {
  const Checked item("drive", {}, drive.source);
  const int laws = drive.rate.has_value() + drive.angle.has_value() + drive.speed.has_value() +
                   drive.displacement.has_value();
  item.fail_if(laws == 0, "give one of the attributes rate, angle, speed and displacement");
  item.fail_if(laws > 1,
               "give one of the attributes rate, angle, speed and displacement, not more; another "
               "coordinate has a drive of its own");
}

// At the start; later ones end the run that comes to them.
void check_finite(const Checked& item, std::string_view attribute, std::size_t component,
                  const Expression& e) {
  const double value = e(0.0).v;
  item.fail_if(!std::isfinite(value),
               std::string(attribute) + " component " + std::to_string(component + 1) + " is " +
                   schema::shortest(value) + " at t = 0, must be a finite number");
}

// Of both kinds of loads.
template <class Load>
void check_some(const Checked& item, const Load& load) {
  item.fail_if(!load.force && !load.moment && !load.follower_force && !load.follower_moment,
               "give a force, a moment or both: force, moment, follower_force, follower_moment");
}

void check(const LoadScene& load) {
  const Checked item("load", load.name, load.source);
  check_some(item, load);
  const auto finite = [&](std::string_view name,
                          const std::optional<std::array<Expression, 3>>& value) {
    for (std::size_t i = 0; value && i < 3; ++i) check_finite(item, name, i, (*value)[i]);
  };
  finite("force", load.force);
  finite("moment", load.moment);
  finite("follower_force", load.follower_force);
  finite("follower_moment", load.follower_moment);
  item.place("at", load.at);
  item.vector("offset", load.offset);
  item.fail_if(!load.force && !load.follower_force && !load.offset.isZero(0.0),
               "offset is where a force acts, and there is none; leave it out");
}

void check(const DistributedLoadScene& load) {
  const Checked item("distributed", load.name, load.source);
  check_some(item, load);
  item.number("from", load.from);
  item.number("to", load.to);
  item.fail_if(!(load.from < load.to), "to is " + schema::shortest(load.to) +
                                           ", must lie behind from, " +
                                           schema::shortest(load.from));
  // At the ends, where poles and roots sit; elsewhere compile() evaluates them.
  const auto fields = [&](std::string_view name,
                          const std::optional<std::array<FieldExpression, 3>>& value) {
    for (std::size_t i = 0; value && i < 3; ++i)
      for (const double s : {load.from, load.to}) {
        std::optional<Expression> here;
        try {
          here = (*value)[i].at(s);
        } catch (const Error& error) {
          item.fail(std::string(name) + " component " + std::to_string(i + 1) +
                    ", at s = " + schema::shortest(s) + ": " + error.what());
        }
        check_finite(item, name, i, *here);
      }
  };
  fields("force", load.force);
  fields("moment", load.moment);
  fields("follower_force", load.follower_force);
  fields("follower_moment", load.follower_moment);
}

void check(const PointMassScene& mass) {
  const Checked item("point_mass", mass.name, mass.source);
  item.place("at", mass.at);
  item.number("mass", mass.mass);
  item.vector("offset", mass.offset);
}

// `members`: of the rigid ones before, each with the name of its own.
void check(const RigidScene& rigid, const Scene& scene,
           std::map<std::string, std::string>& members) {
  const Checked item("rigid", rigid.name, rigid.source);
  item.fail_if(rigid.of.empty(), "of is empty; name beams and free bodies that are to be one");
  std::vector<std::string_view> known;
  for (const BeamScene& b : scene.beams) known.push_back(b.name);
  for (const BodyScene& b : scene.bodies) {
    known.push_back(b.name);
    item.fail_if(
        b.attached_to && std::find(rigid.of.begin(), rigid.of.end(), b.name) != rigid.of.end(),
        "of: body " + in_quotes(excerpt(b.name)) +
            " is attached to something and moves with that; leave it out");
  }
  for (const std::string& name : rigid.of) {
    item.fail_if(std::find(known.begin(), known.end(), name) == known.end(),
                 "of: there is no beam or body " + in_quotes(excerpt(name)) +
                     suggest(name, known, "beams and bodies"));
    const auto [first, is_new] = members.try_emplace(name, rigid.name);
    item.fail_if(!is_new, "of: " + in_quotes(name) + " is part of rigid " +
                              in_quotes(first->second) + " already; name it once");
  }
}

void check(const SpringScene& spring) {
  const Checked item("spring", spring.name, spring.source);
  item.place("between", spring.a);
  item.place("between", spring.b);
  item.vector("at_a", spring.at_a);
  item.vector("at_b", spring.at_b);
  item.number("stiffness", spring.stiffness);
  item.number("damping", spring.damping);
  item.number("length", spring.length);
  const bool elastic = spring.stiffness > 0.0 || spring.force;
  item.fail_if(!elastic && !(spring.damping > 0.0) && !spring.damping_force,
               "it does nothing; give a stiffness, a damping, a force or a damping_force");
  item.fail_if(!elastic && spring.length.has_value(),
               "length is where a spring exerts nothing, and it is a damper only; leave it out");
  if (spring.force)
    check_law(*spring.force, LawOf::displacement, spring.source, label(spring), "force");
  if (spring.damping_force)
    check_law(*spring.damping_force, LawOf::rate, spring.source, label(spring), "damping_force");
}

// Of a potential, or of a power that is never positive: symmetric and without a negative eigenvalue.
void check_semidefinite(const Checked& item, std::string_view what, const Mat6& M) {
  const std::string name(what);
  for (Index i = 0; i < 6; ++i)
    for (Index j = 0; j < 6; ++j)
      item.fail_if(!std::isfinite(M(i, j)),
                   name + ": row " + std::to_string(i + 1) + ", column " + std::to_string(j + 1) +
                       " is " + schema::shortest(M(i, j)) + ", must be a finite number");
  const Vec6 diagonal = M.diagonal();
  item.numbers(name, {diagonal.data(), 3});
  item.numbers("angular_" + name, {diagonal.data() + 3, 3});
  constexpr double round_off = 1e-10;
  for (Index i = 0; i < 6; ++i) {
    for (Index j = i + 1; j < 6; ++j)
      item.fail_if(
          !(std::abs(M(i, j) - M(j, i)) <= round_off * (std::abs(M(i, j)) + std::abs(M(j, i)))),
          name + ": row " + std::to_string(i + 1) + ", column " + std::to_string(j + 1) + " is " +
              schema::shortest(M(i, j)) + " but row " + std::to_string(j + 1) + ", column " +
              std::to_string(i + 1) + " is " + schema::shortest(M(j, i)) +
              "; the matrix must be symmetric");
  }
  for (Index i = 0; i < 6; ++i)
    item.fail_if(M(i, i) == 0.0 && !M.row(i).isZero(0.0),
                 name + ": component " + std::to_string(i + 1) +
                     " is 0 but coupled to others; check the diagonal");
  item.fail_if(definiteness_of_some(M) < -round_off,
               name + ": it is negative for some motion; check signs and sizes of the couplings");
}

void check(const BushingScene& bushing) {
  const Checked item("bushing", bushing.name, bushing.source);
  item.place("between", bushing.a);
  item.place("between", bushing.b);
  item.vector("at", bushing.at);
  item.vector("axis", bushing.axis);
  item.vector("second_axis", bushing.second_axis);
  item.fail_if(bushing.second_axis && !bushing.axis,
               "second_axis is perpendicular to axis, which is missing; give it too");
  check_semidefinite(item, "stiffness", bushing.stiffness);
  check_semidefinite(item, "damping", bushing.damping);
  item.fail_if(bushing.stiffness.isZero(0.0) && bushing.damping.isZero(0.0) && bushing.laws.empty(),
               "it does nothing; give a stiffness, a damping or a <law>");
  for (auto it = bushing.laws.begin(); it != bushing.laws.end(); ++it) {
    Checked("law", {}, it->source).number("component", it->component);
    item.fail_if(
        std::any_of(bushing.laws.begin(), it,
                    [&](const BushingLawScene& l) { return l.component == it->component; }),
        "component " + std::to_string(it->component) + " has two laws; leave one out");
    check_law(it->force, LawOf::displacement, it->source, label(bushing),
              it->component <= 3 ? "force" : "moment");
  }
}

void check(const JointSpringScene& spring) {
  const Checked item("joint_spring", spring.name, spring.source);
  const bool turns = spring.coordinate == JointSpringScene::Coordinate::angle;
  item.number(turns ? "angular_stiffness" : "stiffness", spring.stiffness);
  item.number(turns ? "angular_damping" : "damping", spring.damping);
  item.number(turns ? "rest_angle" : "rest_displacement", spring.rest);
  item.fail_if(!(spring.stiffness > 0.0) && !(spring.damping > 0.0) && !spring.force &&
                   !spring.damping_force,
               "it does nothing; give a stiffness or a damping (of an angle: angular_stiffness, "
               "angular_damping), or a law");
  if (spring.force)
    check_law(*spring.force, LawOf::displacement, spring.source, label(spring),
              turns ? "moment" : "force");
  if (spring.damping_force)
    check_law(*spring.damping_force, LawOf::rate, spring.source, label(spring),
              turns ? "damping_moment" : "damping_force");
}

void check(const JointTorqueScene& torque) {
  const Checked item("joint_torque", torque.name, torque.source);
  item.fail_if(!torque.moment && !torque.force, "give a moment, a force or both");
  const auto finite = [&](std::string_view name, const std::optional<Expression>& law) {
    if (!law) return;
    const double value = (*law)(0.0).v;
    item.fail_if(!std::isfinite(value), std::string(name) + " is " + schema::shortest(value) +
                                            " at t = 0, must be a finite number");
  };
  finite("moment", torque.moment);
  finite("force", torque.force);
}

// Of what acts along a beam or at a place: attributes of one of the two, and none of the other.
struct Given {
  std::string_view attribute;
  bool given;
  bool needed;
};
template <class Item>
void check_beam_or_place(const Checked& item, const Item& x, std::initializer_list<Given> of_beam,
                         std::initializer_list<Given> of_place) {
  item.fail_if(x.at && !x.beam.empty(),
               "give one of the attributes \"beam\" (along it) and \"at\" (at a place), not both");
  item.fail_if(!x.at && x.beam.empty(),
               "give one of the attributes \"beam\" (along it) and \"at\" (at a place)");
  for (const Given& other : x.at ? of_beam : of_place)
    item.fail_if(other.given,
                 std::string(other.attribute) + " is of what acts " +
                     (x.at ? "along a beam, not at a place" : "at a place, not along a beam") +
                     "; leave it out");
  for (const Given& own : x.at ? of_place : of_beam)
    if (own.needed) item.required(own.attribute, own.given);
  item.number("from", x.from);
  item.number("to", x.to);
  const Part part = part_of(x);
  item.fail_if(!(part.from < part.to), "to is " + schema::shortest(part.to) +
                                           ", must lie behind from, " +
                                           schema::shortest(part.from));
  item.place("at", x.at);
}

void check(const DragScene& drag) {
  const Checked item("drag", drag.name, drag.source);
  check_beam_or_place(item, drag,
                      {{"from", drag.from.has_value(), false},
                       {"to", drag.to.has_value(), false},
                       {"diameter", drag.diameter.has_value(), true},
                       {"normal_coefficient", drag.normal_coefficient.has_value(), true},
                       {"tangential_coefficient", drag.tangential_coefficient.has_value(), true}},
                      {{"area", drag.area.has_value(), true},
                       {"coefficient", drag.coefficient.has_value(), true},
                       {"offset", drag.offset.has_value(), false}});
  item.number("density", drag.density);
  item.number("diameter", drag.diameter);
  item.number("normal_coefficient", drag.normal_coefficient);
  item.number("tangential_coefficient", drag.tangential_coefficient);
  item.number("area", drag.area);
  item.number("coefficient", drag.coefficient);
  item.vector("offset", drag.offset);
  for (std::size_t i = 0; drag.flow && i < 3; ++i) check_finite(item, "flow", i, (*drag.flow)[i]);
}

void check(const AddedMassScene& mass) {
  const Checked item("added_mass", mass.name, mass.source);
  check_beam_or_place(item, mass,
                      {{"from", mass.from.has_value(), false},
                       {"to", mass.to.has_value(), false},
                       {"density", mass.density.has_value(), true},
                       {"diameter", mass.diameter.has_value(), true},
                       {"coefficient", mass.coefficient.has_value(), true}},
                      {{"matrix", mass.matrix.has_value(), true}});
  item.number("density", mass.density);
  item.number("diameter", mass.diameter);
  item.number("coefficient", mass.coefficient);
  if (!mass.matrix) return;
  const Mat6& M = *mass.matrix;
  item.numbers("matrix", {M.data(), 36});
  item.fail_if(M != M.transpose(),
               "matrix is not symmetric; the energy of a fluid at rest is a "
               "quadratic form of the velocities: M = M^T");
  item.fail_if(definiteness_of_some(M) < -definite,
               "matrix: some motion would have negative energy; check the signs");
}

void check(const BaseMotionScene& base) {
  const Checked item("base_motion", {}, base.source);
  const int laws =
      base.acceleration.has_value() + base.velocity.has_value() + base.displacement.has_value();
  item.fail_if(laws == 0, "give one of the attributes acceleration, velocity and displacement");
  item.fail_if(laws > 1,
               "give one of the attributes acceleration, velocity and displacement, not more");
  // Laws of velocity and displacement are derived by compile(), which looks at the derivatives.
  for (std::size_t i = 0; base.acceleration && i < 3; ++i)
    check_finite(item, "acceleration", i, (*base.acceleration)[i]);
}

void check(const StaticScene& statics) {
  const Checked item("static", {}, statics.source);
  item.number("steps", statics.steps);
  item.number("tolerance", statics.tolerance);
}

void check(const PathScene& path) {
  const Checked item("path", {}, path.source);
  item.number("step", path.step);
  item.number("max_step", path.max_step);
  item.number("points", path.points);
  item.number("length", path.length);
  item.number("tolerance", path.tolerance);
  for (const PathMarkScene& mark : path.marks)
    Checked(mark.stops ? "stop" : "mark", {}, mark.source).number("value", mark.value);
}

void check(const TransientScene& transient) {
  const Checked item("transient", {}, transient.source);
  item.number("duration", transient.duration);
  const std::string method = " method=" + in_quotes(name_of(transient.method));
  const bool alpha = transient.method == TimeMethod::generalized_alpha;
  const bool ida = transient.method == TimeMethod::ida;
  item.fail_if(
      transient.step && transient.tolerance,
      "give one of the attributes \"step\" (fixed steps) and \"tolerance\" (steps that follow "
      "the estimated error), not both; that of Newton's increments is newton_tolerance");
  item.fail_if(transient.step && ida,
               "step:" + method + " has no fixed steps; give \"tolerance\" in place of it");
  item.fail_if(
      !transient.step && !transient.tolerance,
      ida ? "attribute \"tolerance\" is missing: the relative error, which" + method + " needs"
          : "give one of the attributes \"step\" (fixed steps) and \"tolerance\" (steps that "
            "follow the estimated error)");
  item.number("step", transient.step);
  item.number("tolerance", transient.tolerance);
  for (const auto& [name, value] :
       {std::pair{"position_tolerance", &transient.position_tolerance},
        {"rotation_tolerance", &transient.rotation_tolerance},
        {"velocity_tolerance", &transient.velocity_tolerance},
        {"angular_velocity_tolerance", &transient.angular_velocity_tolerance},
        {"max_step", &transient.max_step}}) {
    item.number(name, *value);
    item.fail_if(
        transient.step && *value,
        std::string(name) + " belongs to \"tolerance\", and the steps are fixed; leave it out");
  }
  for (const auto& [name, value] :
       {std::pair{"velocity_tolerance", &transient.velocity_tolerance},
        {"angular_velocity_tolerance", &transient.angular_velocity_tolerance}})
    item.fail_if(*value && alpha, std::string(name) + ":" + method +
                                      " estimates errors of positions and rotations only; leave it "
                                      "out, or give method=\"radau\"");
  item.number("rho_infinity", transient.rho_infinity);
  const auto of_alpha = [&](std::string_view name, bool given) {
    item.fail_if(given && !alpha, std::string(name) +
                                      " belongs to method=\"generalized_alpha\", not to" + method +
                                      "; leave it out");
  };
  of_alpha("rho_infinity", transient.rho_infinity.has_value());
  of_alpha("balance", transient.balance.has_value());
  item.fail_if(transient.balance == Balance::momentum && transient.inertia != InertiaTerms::full,
               "balance=\"momentum\" balances the whole of inertia; leave out inertia, or give "
               "balance=\"acceleration\"");
  item.number("newton_tolerance", transient.newton_tolerance);
  item.fail_if(transient.newton_tolerance && !takes_newton_tolerance(transient),
               "newton_tolerance:" + method + (ida ? "" : " with a \"tolerance\"") +
                   " derives its own from \"tolerance\"; leave it out");
  item.number("output", transient.output);
  item.fail_if(
      transient.output && transient.output_steps,
      "output is a time between rows or the ends of steps, not both; leave one of them out");
}

void check(const RecordScene& record) {
  const Checked item("record", record.name, record.source);
  item.place("at", record.at);
  item.fail_if(record.at && record.joint,
               "give one of the attributes \"at\" and \"joint\", not both (neither: the whole "
               "system)");
  item.fail_if(record.spring && (record.at || record.joint),
               "spring is what is recorded in place of " + std::string(record.at ? "at" : "joint") +
                   "; leave one of them out");
  item.fail_if(record.quantities.empty(), "quantities are missing; give one at least");
  for (auto it = record.quantities.begin(); it != record.quantities.end(); ++it)
    item.fail_if(std::find(record.quantities.begin(), it, *it) != it,
                 "quantities hold " + in_quotes(excerpt(*it)) + " twice; leave one out");
  const auto known = record.at       ? schema::place_quantities()
                     : record.joint  ? schema::joint_quantities()
                     : record.spring ? schema::spring_quantities()
                                     : schema::system_quantities();
  for (const std::string& quantity : record.quantities) {
    const schema::Quantity* const found = schema::find_quantity(known, quantity);
    const std::string_view usual = schema::usual_word(quantity);
    item.fail_if(!found && !usual.empty(),
                 "quantities: unknown quantity " + in_quotes(quantity) + "; " + std::string(usual));
    item.fail_if(!found, "quantities: unknown quantity " + in_quotes(excerpt(quantity)) +
                             suggest(quantity, schema::names(known),
                                     record.at       ? "quantities of a place"
                                     : record.joint  ? "quantities of a joint"
                                     : record.spring ? "quantities of a spring"
                                                     : "quantities of the whole system"));
    item.fail_if(
        found->of == schema::Quantity::Of::beam_place && record.at->kind != Place::Kind::beam,
        "quantities: " + in_quotes(quantity) +
            " is a resultant of a beam; record it at a beam (beam@0.5) or of a joint");
  }
}

void check(const PlotScene& plot) {
  const Checked item("plot", {}, plot.source);
  item.fail_if(plot.y.empty(), "y are missing; give one at least");
  item.number("x_scale", plot.x_scale);
  item.number("y_scale", plot.y_scale);
  if (!plot.x_range) return;
  item.numbers("x_range", *plot.x_range);
  item.fail_if(!((*plot.x_range)[0] < (*plot.x_range)[1]),
               "x_range: the second number must be the greater");
}

void check(const ExpectScene& expect) {
  const Checked item("expect", {}, expect.source);
  item.number("at", expect.at);
  item.number("value", expect.value);
  item.number("tolerance", expect.tolerance);
  item.fail_if(expect.of != ExpectScene::Of::value_at && expect.at != 0.0,
               "at is the time of a value; an extreme is taken over the whole run, leave it out");
}

void check_names(const Scene& scene) {
  NamesTaken sections("sections"), parts("beams, bodies, joints and motions"), records("records"),
      loads("loads, masses, drags and joint torques");
  for (const Section& s : scene.sections)
    sections.add(Checked("section", s.name, s.source), s.name, s.source);
  const auto place = [&parts](const Checked& item, const std::string& name, const Source& source) {
    item.fail_if(name == "ground", "\"ground\" is the inertial frame; choose another name");
    parts.add(item, name, source);
  };
  for (const BeamScene& b : scene.beams)
    place(Checked(element_of(b), b.name, b.source), b.name, b.source);
  for (const BodyScene& b : scene.bodies)
    place(Checked("body", b.name, b.source), b.name, b.source);
  for (const RigidScene& r : scene.rigids)
    place(Checked("rigid", r.name, r.source), r.name, r.source);
  for (const JointScene& j : scene.joints)
    parts.add(Checked(j.kind, j.name, j.source), j.name, j.source);
  for (const MotionScene& m : scene.motions)
    parts.add(Checked("motion", m.name, m.source), m.name, m.source);
  for (const RecordScene& r : scene.records)
    records.add(Checked("record", r.name, r.source), r.name, r.source);
  const auto optional = [&loads](std::string_view element, const auto& l) {
    if (!l.name.empty()) loads.add(Checked(element, l.name, l.source), l.name, l.source);
  };
  for (const LoadScene& l : scene.loads) optional("load", l);
  for (const DistributedLoadScene& l : scene.distributed_loads) optional("distributed", l);
  for (const PointMassScene& m : scene.point_masses) optional("point_mass", m);
  NamesTaken springs("springs, bushings and joint springs");
  for (const SpringScene& s : scene.springs)
    springs.add(Checked("spring", s.name, s.source), s.name, s.source);
  for (const BushingScene& b : scene.bushings)
    springs.add(Checked("bushing", b.name, b.source), b.name, b.source);
  for (const JointSpringScene& s : scene.joint_springs)
    springs.add(Checked("joint_spring", s.name, s.source), s.name, s.source);
  for (const JointTorqueScene& t : scene.joint_torques) optional("joint_torque", t);
  for (const DragScene& d : scene.drags) optional("drag", d);
  for (const AddedMassScene& m : scene.added_masses) optional("added_mass", m);
}

// With more nodes the entries of the matrix are more than the linear solver can count (int), long after they are
// more than fit into memory; here nothing has been built yet.
void check_size(const Scene& scene) {
  constexpr long most_nodes = 1'000'000;
  long nodes = std::ssize(scene.bodies);
  for (const BeamScene& b : scene.beams) {
    nodes += 1 + long{b.elements} * long{b.order};
    if (nodes > most_nodes)
      Checked(element_of(b), b.name, b.source)
          .fail("with it the model has " + std::to_string(nodes) + " nodes, of which it may have " +
                std::to_string(most_nodes) + "; take fewer elements or a lower order");
  }
}

}  // namespace

void check_scene(const Scene& scene) {
  const Checked model("mbd", scene.name, scene.source);
  model.required("name", !scene.name.empty());
  model.fail_if(!schema::is_name(scene.name), "the name " + in_quotes(excerpt(scene.name)) +
                                                  " is no name; " + std::string(schema::names_are));
  for (const Section& s : scene.sections) check(s);
  for (const BeamScene& b : scene.beams) check(b);
  check_size(scene);
  for (const BodyScene& b : scene.bodies) check(b);
  std::map<std::string, std::string> members;
  for (const RigidScene& r : scene.rigids) check(r, scene, members);
  for (const JointScene& j : scene.joints) check(j);
  for (const DriveScene& d : scene.drives) check(d);
  for (const MotionScene& m : scene.motions) check(m);
  for (const LoadScene& l : scene.loads) check(l);
  for (const DistributedLoadScene& l : scene.distributed_loads) check(l);
  for (const PointMassScene& m : scene.point_masses) check(m);
  for (const SpringScene& s : scene.springs) check(s);
  for (const BushingScene& b : scene.bushings) check(b);
  for (const JointSpringScene& s : scene.joint_springs) check(s);
  for (const JointTorqueScene& t : scene.joint_torques) check(t);
  for (const DragScene& d : scene.drags) check(d);
  for (const AddedMassScene& m : scene.added_masses) check(m);
  if (scene.base_motion) check(*scene.base_motion);
  if (scene.gravity)
    Checked("gravity", {}, scene.gravity->source)
        .vector("acceleration", scene.gravity->acceleration);
  if (scene.statics) check(*scene.statics);
  if (scene.path) check(*scene.path);
  if (scene.path && (scene.statics || scene.transient))
    Checked("path", {}, scene.path->source)
        .fail(std::string("it takes the place of <") + (scene.statics ? "static" : "transient") +
              ">; leave one of them out");
  if (scene.transient) check(*scene.transient);
  for (const RecordScene& r : scene.records) check(r);
  for (const PlotScene& p : scene.plots) check(p);
  for (const ExpectScene& e : scene.expects) check(e);
  check_names(scene);
}

}  // namespace mbd
