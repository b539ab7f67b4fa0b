#include "libmbd/language/check_scene.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <stdexcept>
#include <unordered_map>

#include "joints/fixed.hpp"
#include "libmbd/language/quantities.hpp"
#include "libmbd/language/schema.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/laws.hpp"
#include "libmbd/scene/places.hpp"
#include "libmbd/scene/section_table.hpp"
#include "libmbd/scene/transient.hpp"
#include "libmbd/text/spelling.hpp"

namespace mbd {
namespace {

using field::About;

// An item of the scene, for messages.
class Checked {
 public:
  template <class T>
  explicit Checked(const T& item) : source_(item.source), label_(label(item)) {}
  Checked(const Source& source, std::string label) : source_(source), label_(std::move(label)) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(source_, label_ + ": " + what);
  }
  void fail_if(bool bad, const std::string& what) const {
    if (bad) fail(what);
  }
  void required(const schema::Attribute& attribute, bool given) const {
    if (!given) fail(schema::missing(attribute));
  }

  // What the field says of it: in range and finite; laws of time at the start: later ones end the run that comes to
  // them, and at those of motions compile() looks.
  void check(const About& about, double value) const { in_range(about.attribute, value, ""); }
  void check(const About& about, std::span<const double> values) const {
    for (std::size_t i = 0; i < values.size(); ++i)
      in_range(about.attribute, values[i], "component " + std::to_string(i + 1) + " ");
  }
  template <class Derived>
  void check(const About& about, const Eigen::PlainObjectBase<Derived>& matrix) const {
    check(about, std::span(matrix.data(), static_cast<std::size_t>(matrix.size())));
  }
  void check(const About& about, const Place& p) const {
    fail_if(p.kind == Place::Kind::beam && !(p.parameter >= 0.0 && p.parameter <= 1.0),
            std::string(about.attribute.name) + ": " + excerpt(p.name) + "@" +
                schema::shortest(p.parameter) +
                " is no place; it must lie between 0, the start of the beam, and 1, its end");
  }
  void check(const About& about, const Expression& law, std::string_view component = "") const {
    if (about.has(field::prescribed) || law.has_inputs() || law.has_sensors())
      return;  // compile() looks at these
    const double value = law(0.0).v;
    fail_if(!std::isfinite(value), std::string(about.attribute.name) + std::string(component) +
                                       " is " + schema::shortest(value) +
                                       " at t = 0, must be a finite number");
    if (const std::string fault = schema::fault_of_size(value);
        std::abs(value) > 1.0 && !fault.empty())
      fail(std::string(about.attribute.name) + std::string(component) + " at t = 0 " + fault);
  }
  void check(const About& about, const LawVector& laws) const {
    for (std::size_t i = 0; i < 3; ++i)
      check(about, laws[i], " component " + std::to_string(i + 1));
  }
  void check(const About& about, const LawScene& law) const {
    check_law(law, about.has(field::of_rate) ? LawOf::rate : LawOf::displacement, source_, label_,
              about.attribute.name);
  }

 private:
  void in_range(const schema::Attribute& a, double value, const std::string& which) const {
    if (const std::string fault = schema::fault(a, value); !fault.empty())
      fail(std::string(a.name) + " " + which + fault);
  }

  const Source& source_;
  std::string label_;
};

template <class T, class Value>
void check_field(const Checked& item, const T& x, const field::Field<T, Value>& field) {
  using Plain = typename field::Plain<Value>::type;
  if (field.about.attribute.name.empty() || (field.is_there && !field.is_there(x))) return;
  if constexpr (std::is_arithmetic_v<Value> &&
                std::is_default_constructible_v<T>)  // an optional number that is not given
    if (field.about.attribute.fallback == field::optional && x.*field.member == T{}.*field.member)
      return;
  constexpr bool is_checked = requires(const Plain& value) { item.check(field.about, value); };
  if constexpr (is_checked && !std::is_enum_v<Plain> && !std::is_same_v<Plain, bool>)
    field::each_in(x.*field.member, [&](const auto& value) { item.check(field.about, value); });
}
// Of fields along a beam: at the ends, where poles and roots sit; elsewhere compile() evaluates them.
template <class T>
void check_field(const Checked& item, const T& x,
                 const field::Field<T, std::optional<FieldVector>>& field) {
  const std::string_view name = field.about.attribute.name;
  for (std::size_t i = 0; x.*field.member && i < 3; ++i)
    for (const double s : {x.from, x.to}) {
      const std::string component = " component " + std::to_string(i + 1);
      std::optional<Expression> here;
      try {
        here = (*(x.*field.member))[i].at(s);
      } catch (const Error& error) {
        item.fail(std::string(name) + component + ", at s = " + schema::shortest(s) + ": " +
                  error.what());
      }
      item.check(field.about, *here, component);
    }
}
// Its laws are named after the bushing.
void check_field(const Checked&, const BushingLawScene&,
                 const field::Field<BushingLawScene, LawScene>&) {}

// What the lists of fields say.
template <class T>
void check_fields(const Checked& item, const T& x) {
  T::each_field([&]<class F>(const F& field) {
    if constexpr (requires { field.is_there; })
      check_field(item, x, field);
    else if constexpr (requires { field.member; })
      field::each_part(x.*field.member, [&](const auto& part) {
        if constexpr (requires { part.source; })
          check_fields(Checked(part), part);
        else
          check_fields(item, part);
      });
  });
}

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

// --- what no list says, of each kind ---

template <class T>
void check(const Checked&, const T&, const Scene&) {}

void check(const Checked& item, const Section& section, const Scene&) {
  item.fail_if(section.stations.empty() && section.interpolation != Interpolation::linear,
               "interpolation is between stations; leave it out or give <station>s");
  if (section.damping) {
    const schema::Element* const element = schema::find_element("damping");
    constexpr std::string_view diagonal[] = {"EA", "GA2", "GA3", "GJ", "EI2", "EI3"};
    for (Index i = 0; i < 6; ++i)
      Checked(*section.damping)
          .check(About{*schema::find_attribute(*element, diagonal[i])},
                 section.damping->viscous(i, i));
  }
  check_section(section);
}

constexpr double digits_of_rotation = 1e-9;
bool is_rotation(const Mat3& R) {
  return (R.transpose() * R - Mat3::Identity()).cwiseAbs().maxCoeff() <= digits_of_rotation &&
         R.determinant() > 0.0;
}
constexpr std::string_view not_a_rotation =
    "orientation is not a rotation to 9 digits; give more digits, write the entries as "
    "expressions, or give a rotation vector";

std::string no_colour(const std::string& word) {
  std::vector<std::string_view> known;
  for (const NamedColour& colour : named_colours) known.push_back(colour.name);
  return "colour is " + in_quotes(excerpt(word)) + ", must be #rrggbb or a name" +
         suggest(word, known, "names");
}

void check_shape(const Checked& item, const ShapeScene& shape, bool of_body, bool alone) {
  const int forms = shape.box.has_value() + shape.cylinder.has_value() + shape.sphere.has_value() +
                    !shape.mesh.empty();
  item.fail_if(forms > 1,
               "give one of box, cylinder, sphere and mesh; another form of the body "
               "has a <shape> of its own");
  item.fail_if(!of_body && forms > 0,
               "box, cylinder, sphere and mesh are of a body; a beam has a rectangle or an "
               "ellipse. Attach a body to it: <body attached_to=\"beam@0.5\">");
  item.fail_if(of_body && (shape.has_outline() || shape.to),
               "rectangle, ellipse and to are of a beam; a body has a box, cylinder, sphere or "
               "mesh");
  item.fail_if(shape.rectangle && shape.ellipse, "give a rectangle or an ellipse, not both");
  item.fail_if(shape.to && !shape.has_outline(),
               "to is what the rectangle or ellipse becomes at the end; give one of them, or "
               "leave it out");
  const bool is_placed = !shape.at.isZero(0.0) || shape.orientation != Mat3::Identity();
  item.fail_if(
      (shape.density || is_placed) && forms == 0,
      "density, at and orientation are of a form; give a box, cylinder, sphere or mesh, or "
      "leave them out");
  item.fail_if(shape.unit && shape.mesh.empty(),
               "unit is of a mesh; lengths of other forms have units of their own");
  item.fail_if(forms == 0 && !shape.has_outline() && shape.colour.empty(),
               of_body ? "give a form (box, cylinder, sphere or mesh), or a colour"
                       : "give an outline (rectangle or ellipse), or a colour");
  item.fail_if(forms == 0 && !alone,
               "a shape without a form colours the body as it is drawn without shapes, and must be "
               "its only one");
  item.fail_if(!is_rotation(shape.orientation), std::string(not_a_rotation));
  item.fail_if(!shape.colour.empty() && !colour_code(shape.colour), no_colour(shape.colour));
}

void check(const Checked& item, const BeamScene& beam, const Scene& scene) {
  if (beam.shape)
    check_shape({beam.shape->source, label(beam) + ", shape"}, *beam.shape, false, true);
  if (beam.mesh == Mesh::stations)
    if (const Section* const section = section_of(scene, beam))
      item.fail_if(section->stations.empty(),
                   "mesh=\"stations\" divides at the stations of its section, but section \"" +
                       section->name + "\" has none; leave mesh out or give stations");
  if (beam.kinematics != Kinematics::classical) return;
  const BeamScene defaults;
  item.fail_if(beam.metric != defaults.metric,
               "metric is of kinematics=\"motion\", not of \"classical\"; leave one of them out");
  item.fail_if(beam.form != defaults.form,
               "form is of kinematics=\"motion\", not of \"classical\"; leave one of them out");
}

void check(const Checked& item, const BodyScene& body, const Scene&) {
  for (const ShapeScene& shape : body.shapes)
    check_shape({shape.source, label(body) + ", shape"}, shape, true, body.shapes.size() == 1);
  const auto taken = [&](std::string_view attribute, bool given) {
    item.fail_if(
        body.attached_to && given,
        std::string(attribute) + " is taken from the place of attached_to; leave one of them out");
  };
  taken("at", !body.at.isZero(0.0));
  taken("orientation", body.orientation != Mat3::Identity());
  taken("velocity", !body.velocity.isZero(0.0));
  taken("angular_velocity", !body.angular_velocity.isZero(0.0));
  item.fail_if(!is_rotation(body.orientation), std::string(not_a_rotation));
}

const schema::JointKind& kind_of(const JointScene& joint) {
  if (const schema::JointKind* const kind = schema::find_joint_kind(joint.kind)) return *kind;
  std::vector<std::string_view> known;
  for (const schema::JointKind& k : schema::joint_kinds()) known.push_back(k.name);
  throw Error(joint.source, label(joint) + ": there is no joint <" + excerpt(joint.kind) + ">" +
                                suggest(joint.kind, known, "kinds"));
}

// Has what its kind has, and no more.
void check(const Checked& item, const JointScene& joint, const Scene&) {
  const std::string_view parameter = kind_of(joint).traits.parameter.name;
  const schema::Element& element = *schema::find_element(joint.kind);
  const auto given = [&](std::string_view attribute, bool is_given) {
    const schema::Attribute* const known = schema::find_attribute(element, attribute);
    if (is_given && !known) item.fail_if(true, schema::unknown_attribute(element, attribute));
    if (known && known->fallback == schema::required) item.required(*known, is_given);
    return known;
  };
  JointScene::each_field([&]<class Value>(const field::Field<JointScene, Value>& field) {
    if constexpr (std::is_same_v<Value, std::optional<Vec3>>)
      given(field.about.attribute.name, (joint.*field.member).has_value());
  });
  const schema::Attribute* const number =
      given(parameter.empty() ? "parameter" : parameter, joint.parameter.has_value());
  if (joint.parameter) item.check(About{*number}, *joint.parameter);
}

void check(const Checked& item, const DriveScene& drive, const Scene&) {
  const int laws = drive.rate.has_value() + drive.angle.has_value() + drive.speed.has_value() +
                   drive.displacement.has_value();
  item.fail_if(laws == 0, "give one of the attributes rate, angle, speed and displacement");
  item.fail_if(laws > 1,
               "give one of the attributes rate, angle, speed and displacement, not more; another "
               "coordinate has a drive of its own");
}

// Of both kinds of loads.
template <class Load>
void check_some(const Checked& item, const Load& load) {
  item.fail_if(!load.force && !load.moment && !load.follower_force && !load.follower_moment,
               "give a force, a moment or both: force, moment, follower_force, follower_moment");
}

void check(const Checked& item, const LoadScene& load, const Scene&) {
  check_some(item, load);
  item.fail_if(!load.force && !load.follower_force && !load.offset.isZero(0.0),
               "offset is where a force acts, and there is none; leave it out");
}

void check_order(const Checked& item, double from, double to) {
  item.fail_if(!(from < to), "to is " + schema::shortest(to) + ", must lie behind from, " +
                                 schema::shortest(from));
}

void check(const Checked& item, const DistributedLoadScene& load, const Scene&) {
  check_some(item, load);
  check_order(item, load.from, load.to);
}

// What rigid parts may be made of: beams and bodies; of an attached one, that it is.
using Members = std::unordered_map<std::string_view, bool>;

Members members_of(const Scene& scene) {
  Members known;
  for (const BeamScene& b : scene.beams) known.emplace(b.name, false);
  for (const BodyScene& b : scene.bodies) known.emplace(b.name, b.attached_to.has_value());
  return known;
}

// Names are gathered where one is unknown only: there may be thousands.
void require_part(const Checked& item, const Scene& scene, const Members& known,
                  const std::string& name) {
  if (known.contains(name)) return;
  std::vector<std::string_view> names;
  for (const BeamScene& b : scene.beams) names.push_back(b.name);
  for (const BodyScene& b : scene.bodies) names.push_back(b.name);
  item.fail("of: there is no beam or body " + in_quotes(excerpt(name)) +
            suggest(name, names, "beams and bodies"));
}

// `taken`: by groups of the kind before, each with the name of its own.
template <class Group>
void take_part(const Checked& item, const Group& group, const std::string& name,
               std::map<std::string, std::string>& taken) {
  const auto [first, is_new] = taken.try_emplace(name, group.name);
  item.fail_if(!is_new, "of: " + in_quotes(name) + " is part of " +
                            std::string(Group::item.element) + " " + in_quotes(first->second) +
                            " already; name it once");
}

void check_members(const RigidScene& rigid, const Scene& scene, const Members& known,
                   std::map<std::string, std::string>& taken) {
  const Checked item(rigid);
  item.fail_if(rigid.of.empty(), "of is empty; name beams and free bodies that are to be one");
  for (const std::string& name : rigid.of) {
    require_part(item, scene, known, name);
    item.fail_if(known.at(name), "of: body " + in_quotes(excerpt(name)) +
                                     " is attached to something and moves with that; leave it out");
    take_part(item, rigid, name, taken);
  }
}

void check_parts(const ReductionScene& reduction, const Scene& scene, const Members& known,
                 std::map<std::string, std::string>& taken) {
  const Checked item(reduction);
  item.fail_if(reduction.of.empty(), "of is empty; name beams and bodies");
  for (const std::string& name : reduction.of) {
    require_part(item, scene, known, name);
    take_part(item, reduction, name, taken);
  }
}

// What is in one, against the rest of the scene.
void check_reductions(const Scene& scene) {
  const Members known = members_of(scene);
  std::map<std::string, std::string> taken;  // by part
  for (const ReductionScene& reduction : scene.reductions)
    check_parts(reduction, scene, known, taken);
  const auto reduction_of = [&taken](std::string_view part) -> std::string {
    const auto it = taken.find(std::string(part));
    return it == taken.end() ? std::string() : it->second;
  };
  const auto of_place = [&](const Place& place) {
    return place.kind == Place::Kind::ground ? std::string() : reduction_of(place.name);
  };
  for (const ReductionScene& reduction : scene.reductions) {
    const Checked item(reduction);
    item.fail_if(reduction.frame && of_place(*reduction.frame) != reduction.name,
                 "frame is none of its places; give one of a beam or body in it");
    item.fail_if(scene.transient && scene.transient->inertia != InertiaTerms::full,
                 "inertia=\"no_gyroscopic\" is of nodes with masses of their own, which it has "
                 "not; leave one of them out");
  }
  for (const RigidScene& rigid : scene.rigids)
    for (const std::string& name : rigid.of)
      Checked(rigid).fail_if(
          reduction_of(name) != reduction_of(rigid.of.front()),
          "of: " + in_quotes(name) + " and " + in_quotes(rigid.of.front()) +
              " are not in the same reduction; put all of them into it, or none");
  for (const BodyScene& body : scene.bodies)
    if (const std::string of = reduction_of(body.name); body.attached_to && !of.empty())
      Checked(body).fail_if(of_place(*body.attached_to) != of,
                            "it is part of reduction " + in_quotes(of) +
                                ", but what it is attached to is not; put that into it too, or "
                                "leave the body out of it");
  each_kind_along(scene, [&](const auto& items) {
    for (const auto& along : items)
      if constexpr (std::is_same_v<std::decay_t<decltype(along.beam)>, std::string>)
        Checked(along).fail_if(!reduction_of(along.beam).empty(),
                               "it acts along beam " + in_quotes(along.beam) +
                                   ", which is part of reduction " +
                                   in_quotes(reduction_of(along.beam)) +
                                   "; leave the beam out of that, or let <load>s act at places");
  });
  for (const RecordScene& record : scene.records)
    for (const JointScene& joint : scene.joints)
      Checked(record).fail_if(
          record.joint == joint.name && joint.kind == joint::Fixed::name &&
              !of_place(joint.a).empty() && of_place(joint.a) == of_place(joint.b),
          label(joint) + " is part of reduction " + in_quotes(of_place(joint.a)) +
              ", where its reactions are not known; leave the record out");
}

void check(const Checked& item, const SpringScene& spring, const Scene&) {
  const bool elastic = spring.stiffness > 0.0 || spring.force;
  item.fail_if(!elastic && !(spring.damping > 0.0) && !spring.damping_force,
               "it does nothing; give a stiffness, a damping, a force or a damping_force");
  item.fail_if(!elastic && spring.length.has_value(),
               "length is where a spring exerts nothing, and it is a damper only; leave it out");
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
  const schema::Element& element = *schema::find_element("bushing");
  for (const auto& [attribute, first] : {std::pair{name, 0}, std::pair{"angular_" + name, 3}})
    item.check(About{*schema::find_attribute(element, attribute)},
               Vec3(diagonal.segment<3>(first)));
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

void check(const Checked& item, const BushingScene& bushing, const Scene&) {
  item.fail_if(bushing.second_axis && !bushing.axis,
               "second_axis is perpendicular to axis, which is missing; give it too");
  check_semidefinite(item, "stiffness", bushing.stiffness);
  check_semidefinite(item, "damping", bushing.damping);
  item.fail_if(bushing.stiffness.isZero(0.0) && bushing.damping.isZero(0.0) && bushing.laws.empty(),
               "it does nothing; give a stiffness, a damping or a <law>");
  for (auto it = bushing.laws.begin(); it != bushing.laws.end(); ++it) {
    item.fail_if(
        std::any_of(bushing.laws.begin(), it,
                    [&](const BushingLawScene& l) { return l.component == it->component; }),
        "component " + std::to_string(it->component) + " has two laws; leave one out");
    check_law(it->force, LawOf::displacement, it->source, label(bushing),
              it->component <= 3 ? "force" : "moment");
  }
}

void check(const Checked& item, const JointSpringScene& spring, const Scene&) {
  item.fail_if(!(spring.stiffness > 0.0) && !(spring.damping > 0.0) && !spring.force &&
                   !spring.damping_force,
               "it does nothing; give a stiffness or a damping (of an angle: angular_stiffness, "
               "angular_damping), or a law");
}

void check(const Checked& item, const JointTorqueScene& torque, const Scene&) {
  item.fail_if(!torque.moment && !torque.force, "give a moment, a force or both");
}

// Of what acts along a beam or at a place: attributes of one of the two, and none of the other.
template <class T>
void check_beam_or_place(const Checked& item, const T& x) {
  item.fail_if(x.at && !x.beam.empty(),
               "give one of the attributes \"beam\" (along it) and \"at\" (at a place), not both");
  item.fail_if(!x.at && x.beam.empty(),
               "give one of the attributes \"beam\" (along it) and \"at\" (at a place)");
  const auto each = [&x](const auto& look) {
    T::each_field([&](const auto& field) {
      if constexpr (requires { (x.*field.member).has_value(); })
        look(field.about, (x.*field.member).has_value());
    });
  };
  each([&](const About& about, bool given) {
    item.fail_if(given && about.has(x.at ? field::along_beam : field::at_place),
                 std::string(about.attribute.name) + " is of what acts " +
                     (x.at ? "along a beam, not at a place" : "at a place, not along a beam") +
                     "; leave it out");
  });
  each([&](const About& about, bool given) {
    if (about.has(x.at ? field::at_place : field::along_beam) && about.has(field::needed))
      item.required(about.attribute, given);
  });
  check_order(item, part_of(x).from, part_of(x).to);
}

void check(const Checked& item, const DragScene& drag, const Scene&) {
  check_beam_or_place(item, drag);
}

void check(const Checked& item, const AddedMassScene& mass, const Scene&) {
  check_beam_or_place(item, mass);
  if (!mass.matrix) return;
  const Mat6& M = *mass.matrix;
  item.fail_if(M != M.transpose(),
               "matrix is not symmetric; the energy of a fluid at rest is a "
               "quadratic form of the velocities: M = M^T");
  item.fail_if(definiteness_of_some(M) < -definite,
               "matrix: some motion would have negative energy; check the signs");
}

void check(const Checked& item, const BaseMotionScene& base, const Scene&) {
  const int laws =
      base.acceleration.has_value() + base.velocity.has_value() + base.displacement.has_value();
  item.fail_if(laws == 0, "give one of the attributes acceleration, velocity and displacement");
  item.fail_if(laws > 1,
               "give one of the attributes acceleration, velocity and displacement, not more");
}

void check(const Checked& item, const PathScene&, const Scene& scene) {
  item.fail_if(scene.statics || scene.transient, std::string("it takes the place of <") +
                                                     (scene.statics ? "static" : "transient") +
                                                     ">; leave one of them out");
}

void check_stages(const Checked& item, const TransientScene& transient, const std::string& method) {
  item.fail_if(transient.stages && transient.method != TimeMethod::radau,
               "stages belong to method=\"radau\", not to" + method + "; leave them out");
  item.fail_if(transient.stages == StageCount::automatic && transient.step,
               "stages=\"auto\" follows the errors of steps, and fixed steps have none; give a "
               "number, or a tolerance in place of step");
}

void check(const Checked& item, const TransientScene& transient, const Scene&) {
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
  for (const auto& [name, value] :
       {std::pair{"position_tolerance", &transient.position_tolerance},
        {"rotation_tolerance", &transient.rotation_tolerance},
        {"velocity_tolerance", &transient.velocity_tolerance},
        {"angular_velocity_tolerance", &transient.angular_velocity_tolerance},
        {"max_step", &transient.max_step}})
    item.fail_if(
        transient.step && *value,
        std::string(name) + " belongs to \"tolerance\", and the steps are fixed; leave it out");
  item.fail_if(transient.errors && transient.step,
               "errors belongs to \"tolerance\", and the steps are fixed; leave it out");
  item.fail_if(transient.errors && transient.method != TimeMethod::radau,
               "errors:" + method +
                   (alpha ? " estimates errors of positions and rotations only"
                          : " holds those of velocities as well") +
                   "; leave it out, or give method=\"radau\"");
  item.fail_if(transient.errors == ErrorsOf::motion &&
                   (transient.velocity_tolerance || transient.angular_velocity_tolerance),
               "errors=\"motion\" holds no velocities; leave it out, or the tolerances of "
               "velocities");
  for (const auto& [name, value] :
       {std::pair{"velocity_tolerance", &transient.velocity_tolerance},
        {"angular_velocity_tolerance", &transient.angular_velocity_tolerance}})
    item.fail_if(*value && alpha, std::string(name) + ":" + method +
                                      " estimates errors of positions and rotations only; leave it "
                                      "out, or give method=\"radau\"");
  const auto of_alpha = [&](std::string_view name, bool given) {
    item.fail_if(given && !alpha, std::string(name) +
                                      " belongs to method=\"generalized_alpha\", not to" + method +
                                      "; leave it out");
  };
  of_alpha("rho_infinity", transient.rho_infinity.has_value());
  of_alpha("balance", transient.balance.has_value());
  check_stages(item, transient, method);
  item.fail_if(transient.balance == Balance::momentum && transient.inertia != InertiaTerms::full,
               "balance=\"momentum\" balances the whole of inertia; leave out inertia, or give "
               "balance=\"acceleration\"");
  item.fail_if(transient.newton_tolerance && !takes_newton_tolerance(transient),
               "newton_tolerance:" + method + (ida ? "" : " with a \"tolerance\"") +
                   " derives its own from \"tolerance\"; leave it out");
  item.fail_if(
      transient.output && transient.output_steps,
      "output is a time between rows or the ends of steps, not both; leave one of them out");
}

void check(const Checked& item, const ModesScene& modes, const Scene& scene) {
  const std::string contradiction = modes.contradiction();
  item.fail_if(!contradiction.empty(), contradiction);
  std::vector<std::string_view> parts;
  for (const BodyScene& body : scene.bodies) parts.push_back(body.name);
  for (const BeamScene& beam : scene.beams) parts.push_back(beam.name);
  for (const std::string& name : modes.at_rest)
    item.fail_if(std::find(parts.begin(), parts.end(), name) == parts.end(),
                 "at_rest: no body and no beam is called " + in_quotes(excerpt(name)) +
                     suggest(name, parts, "bodies and beams"));
}

void check(const Checked& item, const RecordScene& record, const Scene&) {
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
  const auto known = schema::quantities_of(record);
  for (const std::string& quantity : record.quantities) {
    const schema::Quantity* const found = schema::find_quantity(known, quantity);
    const std::string usual = schema::usual_word(quantity);
    item.fail_if(!found && !usual.empty(),
                 "quantities: unknown quantity " + in_quotes(quantity) + "; " + std::string(usual));
    item.fail_if(!found, "quantities: unknown quantity " + in_quotes(excerpt(quantity)) +
                             suggest(quantity, schema::names(known),
                                     record.at       ? "quantities of a place"
                                     : record.joint  ? "quantities of a joint"
                                     : record.spring ? "quantities of a spring"
                                                     : "quantities of the whole system"));
    item.fail_if(schema::needs_beam(record, *found),
                 "quantities: " + in_quotes(quantity) +
                     " is a resultant of a beam; record it at a beam (beam@0.5) or of a joint");
    item.fail_if(found->of_section_point() && !record.section_point,
                 "quantities: " + in_quotes(quantity) +
                     " is of a point of a section; give section_point=\"x2 x3\"");
  }
  item.fail_if(record.section_point && !(record.at && record.at->kind == Place::Kind::beam),
               "section_point is of a place of a beam; give at=\"beam@0.5\", or leave it out");
  item.fail_if(
      record.section_point &&
          std::ranges::none_of(record.quantities,
                               [&](const std::string& name) {
                                 return schema::find_quantity(known, name)->of_section_point();
                               }),
      "section_point is of stresses and strains, of which quantities hold none; leave it "
      "out or add one, such as ply_stress");
}

void check(const Checked& item, const MotionOutputScene& motion, const Scene& scene) {
  item.fail_if(motion.frames && !scene.transient,
               "frames are at equal times, and there is no <transient>; leave it out: every row of "
               "load steps is a frame");
}

void check(const Checked& item, const PlotScene& plot, const Scene&) {
  item.fail_if(plot.y.empty(), "y are missing; give one at least");
  item.fail_if(plot.x_range && !((*plot.x_range)[0] < (*plot.x_range)[1]),
               "x_range: the second number must be the greater");
}

void check(const Checked& item, const ExpectScene& expect, const Scene&) {
  item.fail_if(expect.of != ExpectScene::Of::value_at && expect.at != 0.0,
               "at is the time of a value; an extreme is taken over the whole run, leave it out");
}

void check_names(const Scene& scene) {
  std::map<std::string_view, NamesTaken> taken;
  each_item(scene, [&]<class T>(const T& x) {
    if constexpr (!T::item.names.empty()) {
      if (x.name.empty() && T::item.names == field::of_loads) return;
      constexpr bool has_places = std::is_same_v<T, BeamScene> || std::is_same_v<T, BodyScene> ||
                                  std::is_same_v<T, RigidScene> ||
                                  std::is_same_v<T, ReductionScene>;
      const Checked item(x);
      item.fail_if(has_places && x.name == "ground",
                   "\"ground\" is the inertial frame; choose another name");
      taken.try_emplace(T::item.names, std::string(T::item.names))
          .first->second.add(item, x.name, x.source);
    }
  });
}

// With more nodes the entries of the matrix are more than the linear solver can count (int), long after they are
// more than fit into memory; here nothing has been built yet.
void check_size(const Scene& scene) {
  constexpr long most_nodes = 1'000'000;
  long nodes = std::ssize(scene.bodies);
  for (const BeamScene& b : scene.beams) {
    nodes += 1 + long{stated_elements(scene, b)} * long{b.order};
    if (nodes > most_nodes)
      Checked(b).fail("with it the model has " + std::to_string(nodes) +
                      " nodes, of which it may have " + std::to_string(most_nodes) +
                      "; take fewer elements or a lower order");
  }
}

}  // namespace

void check_scene(const Scene& scene) {
  const Checked model(scene.source, label("mbd", scene.name));
  const schema::Element& element = *schema::find_element("mbd");
  model.required(*schema::find_attribute(element, "name"), !scene.name.empty());
  model.fail_if(!schema::is_name(scene.name), "the name " + in_quotes(excerpt(scene.name)) +
                                                  " is no name; " + std::string(schema::names_are));
  each_item(scene, [&scene](const auto& x) {
    const Checked item(x);
    check_fields(item, x);
    check(item, x, scene);
  });
  check_size(scene);
  if (!scene.rigids.empty()) {
    const Members known = members_of(scene);
    std::map<std::string, std::string> taken;
    for (const RigidScene& rigid : scene.rigids) check_members(rigid, scene, known, taken);
  }
  if (!scene.reductions.empty()) check_reductions(scene);
  check_names(scene);
}

}  // namespace mbd
