#include "libmbd/language/schema.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <deque>
#include <stdexcept>

#include "joints/joint_list.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/scene/scene.hpp"
#include "libmbd/text/spelling.hpp"

namespace mbd::schema {
namespace {

using namespace field;

constexpr std::string_view top = "mbd";
constexpr std::string_view anywhere = "mbd repeat defaults";
constexpr std::string_view once = "mbd defaults";

// --- attributes that are no fields of an item ---

// Of a <table>, or of the text of a <law>.
constexpr auto interpolation_of = [](std::string_view doc) {
  Attribute a{"interpolation", Kind::choice, "", "linear", doc};
  a.choices = words_of<Interpolation>;
  return a;
};

constexpr auto what_of = [](std::string_view fallback, std::string_view doc,
                            std::string_view choices) {
  return Attribute{"of", Kind::choice, "", fallback, doc, field::any, {3, 3}, choices};
};

// For the time of the program.
std::string_view kept(std::string text) {
  static std::deque<std::string> all;
  return all.emplace_back(std::move(text));
}

// Entries of D, or of what is viscous in its place: the diagonal, and couplings, which are 0 unless they are given.
// `words_instead`: what those of the diagonal may be instead of a number.
std::vector<Attribute> entries(const Blocks& units, std::string_view fallback, const Range& range,
                               std::string_view more_of_first, std::string_view more_of_couplings,
                               std::string_view words_instead = {}) {
  constexpr std::array<std::string_view, 6> names = {"EA", "GA2", "GA3", "GJ", "EI2", "EI3"};
  constexpr std::array<std::string_view, 6> short_words = {
      "axial",   "shear along b2",   "shear along b3",
      "torsion", "bending about b2", "bending about b3"};
  std::vector<Attribute> all;
  for (std::size_t i = 0; i < 6; ++i)
    all.push_back({names[i],
                   Kind::number,
                   units[i < 3 ? 0 : 2],
                   fallback,
                   kept("D" + std::string(2, static_cast<char>('1' + i)) + ", " +
                        std::string(short_words[i]) + (i == 0 ? std::string(more_of_first) : "")),
                   range,
                   {3, 3},
                   words_instead});
  auto words = short_words;
  words[0] = "extension";
  words[3] = "twist";
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = i + 1; j < 6; ++j)
      all.push_back({kept("D" + std::to_string(i + 1) + std::to_string(j + 1)), Kind::number,
                     units[(i < 3 ? 0 : 1) + (j < 3 ? 0 : 1)], "0",
                     kept("coupling of " + std::string(words[i]) + " and " + std::string(words[j]) +
                          (i == 0 && j == 1 ? std::string(more_of_couplings) : ""))});
  return all;
}

// --- attributes of items ---

// As one would write it; only of what may be preset.
template <class T>
std::string text_of(const T& value) {
  if constexpr (std::is_same_v<T, double>)
    return shortest(value);
  else if constexpr (std::is_same_v<T, int>)
    return std::to_string(value);
  else if constexpr (std::is_same_v<T, bool>)
    return value ? "on" : "off";
  else if constexpr (std::is_same_v<T, Vec3>)
    return shortest(value(0)) + " " + shortest(value(1)) + " " + shortest(value(2));
  else if constexpr (std::is_enum_v<T>)
    return std::string(name_of(value));
  else
    throw std::logic_error("not to be preset");
}

// `line`: of several types that a part may have, the one whose attributes these are.
template <class Item>
std::vector<Attribute> attributes_of(const auto& line) {
  std::vector<Attribute> all;
  Item::each_field([&]<class F>(const F& field) {
    if constexpr (requires { field.about; }) {
      Attribute a = field.about.attribute;
      if (a.name.empty() || field.about.has(second_place)) return;
      if constexpr (std::is_default_constructible_v<Item> && requires { field.member; })
        if constexpr (std::is_default_constructible_v<Item>)  // clang 14 wants it said by itself
          if (a.fallback == preset) a.fallback = kept(text_of(Item{}.*field.member));
      all.push_back(a);
    } else if constexpr (is_variant<std::decay_t<decltype(std::declval<Item>().*field.member)>>) {
      const auto more = attributes_of<std::decay_t<decltype(line)>>(line);
      all.insert(all.end(), more.begin(), more.end());
    }
  });
  return all;
}

template <class Item>
Element element_of(std::string_view parents, std::string_view content = {}) {
  return {Item::item.element, parents, Item::item.doc, attributes_of<Item>(Straight{}), content,
          Item::item.group};
}

template <class Line>
Element beam_element(const Line& line) {
  return {Line::item.element, anywhere, Line::item.doc, attributes_of<BeamScene>(line)};
}

// One for each kind of shape: with the attributes that are of it.
Element shape_element(SectionShape::Kind kind) {
  SectionShape shape;
  shape.kind = kind;
  const auto k = static_cast<std::size_t>(kind);
  Element element{SectionShape::kinds[k], "section station defaults", SectionShape::docs[k], {}};
  SectionShape::each_field([&](const auto& field) {
    if constexpr (requires { field.is_there; }) {
      if (field.is_there != nullptr && !field.is_there(shape)) return;
      Attribute a = field.about.attribute;
      if (a.fallback == preset) a.fallback = kept(text_of(shape.*field.member));
      element.attributes.push_back(a);
    }
  });
  return element;
}

const std::vector<JointKind>& joints() {
  static const std::vector<JointKind> all = [] {
    std::vector<JointKind> list;
    joint::for_each(joint::Types{}, [&]<class J>() {
      list.push_back({J::name, J::doc, J::traits});
    });
    return list;
  }();
  return all;
}

std::vector<Attribute> of(const JointKind& kind) {
  const joint::Traits& traits = kind.traits;
  const bool two = traits.points == joint::Points::two;
  std::vector<Attribute> result = attributes_of<JointScene>(Straight{});
  std::erase_if(result, [&](const Attribute& a) {
    return (a.name == "at" && two) || ((a.name == "at_a" || a.name == "at_b") && !two) ||
           (a.name == "axis" && !traits.axis) || (a.name == "second_axis" && !traits.second_axis);
  });
  if (const joint::Parameter& p = traits.parameter; p.name[0] != '\0')
    result.push_back({p.name, Kind::number, p.unit, required, p.doc});
  return result;
}

// As messages, manual and grammar list them; others follow, and the joints.
constexpr std::string_view order =
    "mbd parameter include defaults material layup ply section station stiffness mass damping tube "
    "bar rectangle box I C mesh region airfoil points sector web beam arc curve point "
    "body shape drive motion load distributed rigid point_mass spring bushing matrix law "
    "joint_spring "
    "joint_torque table drag added_mass extension base_motion gravity static path mark stop "
    "transient modes record "
    "motion_output plot expect repeat";

std::vector<Element> elements_of_files() {
  return {
      {"mbd",
       "",
       "A model. SI units, inertial axes i1 i2 i3.",
       {{"name", Kind::name, "", required, "name of the model, for reports"},
        {"version", Kind::count, "", "1",
         "of the format of this file; a newer one than mbd knows is refused", Range{1.0, 1e6}},
        {"xmlns:xsi", Kind::text, "", optional, "for XML editors, not read"},
        {"xsi:noNamespaceSchemaLocation", Kind::text, "", optional,
         "for XML editors, not read: where they find mbd.xsd"}}},
      {"parameter",
       top,
       "A named number. Later expressions may use it; --set replaces its value.",
       {{"name", Kind::name, "", required, "a word that expressions below may use"},
        {"value", Kind::number, any_unit, required,
         "its value, unless --set gives another; with a unit it is converted to SI units and "
         "rad"}}},
      {"include",
       top,
       "Reads the elements of another model file here, as if they stood in this one. That file's "
       "name for its model is not used.",
       {{"file", Kind::text, "", required, "its name, relative to the file that includes it"}}},
      {"defaults",
       top,
       "Elements with some of their attributes, no name and no content: what later elements of "
       "that kind have when they do not say otherwise.",
       {}},
      {"repeat",
       "mbd repeat curve layup section airfoil",
       "Reads its contents several times.",
       {{"count", Kind::count, "", required, "how often its contents are read", Range{0.0, 1e6}},
        {"index", Kind::name, "", "i",
         "parameter that counts from 0; {i+1} in names and places becomes its value"}}},
  };
}

std::vector<Element> elements_of_sections() {
  std::vector<Attribute> damping = attributes_of<SectionDamping>(Straight{});
  for (Attribute& a :
       entries(viscosity_units, "0", not_negative, ": viscous, besides beta D; and so below", ""))
    damping.push_back(a);
  return {
      element_of<PlyScene>("layup repeat defaults"),
      element_of<MeshRegionScene>("mesh defaults"),
      {"points",
       "airfoil",
       "The points of the outer surface of an airfoil: x2 and x3 in turn, in its unit, all round; "
       "three or more, the last not the first again.",
       {},
       "pairs of numbers"},
      element_of<AirfoilSectorScene>("airfoil repeat defaults"),
      element_of<AirfoilWebScene>("airfoil repeat defaults"),
      element_of<Station>("section repeat defaults"),
      {"stiffness", "section station defaults",
       "D, from strains [stretch, shears; twist, curvatures] to [N1 Q2 Q3; M1 M2 M3]: its "
       "entries by name, the first six at least, or all of them row by row.",
       entries(stiffness_units, optional, positive,
               "; as all of the diagonal it may be inf: no compliance, the strain is zero",
               "; D21 is the same, and so below", "inf"),
       "36 numbers"},
      {"mass",
       "section station defaults",
       "M per length about the reference line: [m I, -m c~; m c~, J], c = (0, x2, x3).",
       {{"per_length", Kind::number, "kg/m", required, "mass per unit length", positive},
        {"inertia", Kind::numbers, "kg.m", required,
         "per length about the reference line: J11 J22 J33 [J12 J13 J23]", field::any,
         std::array{3, 6}},
        {"center", Kind::numbers, "m", "0 0", "mass centre in the section: x2 x3", field::any,
         std::array{2, 2}}}},
      {"damping", "section defaults", SectionDamping::item.doc, damping},
  };
}

std::vector<Element> elements_of_parts() {
  const std::vector<Attribute> mark = attributes_of<PathMarkScene>(Straight{});
  std::vector<Attribute> law = attributes_of<BushingLawScene>(Straight{});
  law.push_back(interpolation_of(
      "of a table: linear or a cubic spline, whose pieces meet between the points; linear "
      "beyond the first and the last point"));
  return {
      beam_element(Straight{}),
      beam_element(Arc{}),
      beam_element(Curve{}),
      element_of<CurvePoint>("curve repeat defaults"),
      element_of<ShapeScene>("body beam arc curve defaults"),
      {"matrix",
       "bushing",
       "Its stiffness or damping, symmetric, in place of the attributes: row by row, "
       "displacements before rotations, in SI units.",
       {what_of("stiffness", "what it is", "stiffness damping")},
       "36 numbers"},
      {"law", "bushing", BushingLawScene::item.doc, law, "pairs of numbers"},
      {"table",
       "spring joint_spring",
       "A law in place of an expression: x and force (or v and force) in turn, in SI units, x "
       "rising.",
       {what_of("force", "what it gives, as the attribute of that name",
                "force damping_force moment damping_moment"),
        interpolation_of(
            "between its points: linear or a cubic spline; linear beyond the first and the "
            "last")},
       "pairs of numbers"},
      {"mark", "path repeat defaults",
       "A point of the path to be located, shown and drawn: where a column passes a value.", mark},
      {"stop", "path repeat defaults", "A mark at which the path ends.", mark},
      element_of<ControlStateScene>("controller"),
      element_of<ControlOutputScene>("controller"),
      element_of<PidScene>("controller"),
      element_of<StateSpaceScene>("controller"),
  };
}

std::vector<Element> elements_of_kinds() {
  std::vector<Element> list;
  const Scene kinds;
  each_kind(kinds, [&list]<class Items>(const Items&) {
    using Item = typename Items::value_type;
    constexpr bool many = requires(Items items) { items.size(); };
    if constexpr (!Item::item.element.empty())
      list.push_back(element_of<Item>(many ? anywhere : once));
    if constexpr (std::is_same_v<Item, FunctionScene>) {
      list.back().content = "pairs of numbers";
      list.back().attributes.push_back(
          interpolation_of("of a table: linear or a cubic spline, whose pieces meet between the "
                           "points; linear beyond the first and the last point"));
    }
  });
  return list;
}

const std::vector<Element>& table() {
  static const std::vector<Element> all = [] {
    std::vector<Element> list;
    for (const auto& part :
         {elements_of_files(), elements_of_sections(), elements_of_parts(), elements_of_kinds()})
      list.insert(list.end(), part.begin(), part.end());
    for (std::size_t k = 0; k < std::size(SectionShape::kinds); ++k)
      list.push_back(shape_element(static_cast<SectionShape::Kind>(k)));
    const std::vector<std::string_view> ordered = words(order);
    const auto place = [&ordered](const Element& e) {
      return std::find(ordered.begin(), ordered.end(), e.name) - ordered.begin();
    };
    std::stable_sort(list.begin(), list.end(),
                     [&](const Element& a, const Element& b) { return place(a) < place(b); });
    for (const JointKind& kind : joints())
      list.push_back({kind.name, anywhere, kind.doc, of(kind)});
    return list;
  }();
  return all;
}

template <class Range>
auto find(const Range& range, std::string_view name) {
  const auto it = std::find_if(std::begin(range), std::end(range),
                               [&](const auto& entry) { return entry.name == name; });
  return it == std::end(range) ? nullptr : &*it;
}

template <class Range>
std::vector<std::string_view> names_of(const Range& range) {
  std::vector<std::string_view> result;
  for (const auto& entry : range) result.push_back(entry.name);
  return result;
}

}  // namespace

std::span<const Element> elements() { return table(); }
std::span<const JointKind> joint_kinds() { return joints(); }

const Element* find_element(std::string_view name) { return find(table(), name); }
const Attribute* find_attribute(const Element& element, std::string_view name) {
  return find(element.attributes, name);
}

const JointKind* find_joint_kind(std::string_view name) { return find(joints(), name); }

std::vector<std::string_view> children(std::string_view parent) {
  std::vector<std::string_view> result;
  for (const Element& element : table()) {
    const std::vector<std::string_view> parents = words(element.parents);
    if (std::find(parents.begin(), parents.end(), parent) != parents.end())
      result.push_back(element.name);
  }
  return result;
}

std::vector<std::string_view> attribute_names(const Element& element) {
  return names_of(element.attributes);
}

std::vector<std::string_view> words(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n\f\v";
  std::vector<std::string_view> result;
  for (std::size_t at = text.find_first_not_of(blanks); at != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(blanks, at), text.size());
    result.push_back(text.substr(at, end - at));
    at = text.find_first_not_of(blanks, end);
  }
  return result;
}

std::string shortest(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string fault(const Attribute& attribute, double value) {
  const Range& range = attribute.range;
  const std::string is = "is " + shortest(value) + ", must ";
  if (!std::isfinite(value)) return is + "be a finite number";
  const bool inside = range.open ? value > range.min && value < range.max
                                 : value >= range.min && value <= range.max;
  // Of any quantity: only compared.
  if (inside) return attribute.unit == any_unit ? std::string() : fault_of_size(value);
  const bool below = std::isfinite(range.min), above = std::isfinite(range.max);
  if (below && above)
    return is + "lie between " + shortest(range.min) + " and " + shortest(range.max);
  if (below && range.min == 0.0) return is + (range.open ? "be positive" : "not be negative");
  return is + (range.open ? "be greater than " : "be at least ") + shortest(range.min);
}

std::string fault_of_size(double value) {
  constexpr double smallest = 1e-60, largest = 1e60;
  const double size = std::abs(value);
  if (size == 0.0 || (size >= smallest && size <= largest)) return {};
  return "is " + shortest(value) + ", too " + (size < smallest ? "small" : "large") +
         " to compute with: it must be of a size from 1e-60 to 1e60" +
         (size < smallest ? ", or 0" : "") + "; check it and its unit";
}

std::string missing(const Attribute& attribute) {
  const bool has_unit = attribute.unit != pure_number && attribute.unit != any_unit;
  return "attribute \"" + std::string(attribute.name) +
         "\" is missing: " + std::string(attribute.doc) +
         (has_unit ? " [" + std::string(attribute.unit) + "]" : "");
}

bool is_of_one_item(const Attribute& a) {
  return a.kind == Kind::name || a.kind == Kind::place || a.kind == Kind::places ||
         (a.kind == Kind::numbers && a.unit == "m");
}

std::string unknown_attribute(const Element& element, std::string_view name) {
  return "unknown attribute \"" + excerpt(name) + "\"" +
         suggest(name, attribute_names(element),
                 "attributes of <" + std::string(element.name) + ">");
}

std::string usual_word(std::string_view word) {
  struct Usual {
    std::string_view word, instead;
    bool absent = false;
  };
  static constexpr Usual table[] = {
      {"clamp", "write <fixed between=\"ground beam.start\" …/>"},
      {"weld", "write <fixed …/>"},
      {"hinge", "write <revolute axis=… …/>"},
      {"pin", "write <revolute axis=… …/>, or <spherical …/> for a ball"},
      {"ball", "write <spherical …/>"},
      {"slider", "write <prismatic axis=… …/>"},
      {"roller", "write <point_on_line axis=… …/>: free along the line, free to turn"},
      {"rope", "write <distance …/>, which holds a length also in pressure, or a slender <beam>"},
      {"cable", "write <distance …/>, which holds a length also in pressure, or a slender <beam>"},
      {"damper", "write <spring damping=… …/>, with or without a stiffness"},
      {"dashpot", "write <spring damping=… …/>, with or without a stiffness"},
      {"shaker", "write <base_motion acceleration=…/>, or <motion of=… displacement=…/>"},
      {"contact", "there is none; a spring whose law pushes on one side only may do", true},
      {"collision", "there is no contact; a spring whose law pushes on one side only may do", true},
      {"friction", "write damping_moment=\"T*tanh(v/v0)\" of a <joint_spring>", true},
      {"limit", "write a <joint_spring> whose law begins at the limit", true},
      {"limits", "write a <joint_spring> whose law begins at the limit", true},
      {"stop",
       "a run in time ends at its duration; an end stop of a joint is a <joint_spring> whose law "
       "begins there",
       true},
      {"gear", "there is none; a <screw> ties an angle to a displacement", true},
      {"rack", "there is none; a <screw> ties an angle to a displacement", true},
      {"cam", "there is none", true},
      {"belt", "there is none", true},
      {"pulley", "there is none", true},
      {"wheel", "there is no rolling", true},
      {"tire", "there is no rolling", true},
      {"tyre", "there is no rolling", true},
      {"rolling", "there is none", true},
      {"control", "write <controller period=…>, or a law of sensors: moment=\"-k*elbow.angle\""},
      {"sensor",
       "laws of loads and controllers know the motion by names: elbow.angle, arm.end.velocity.2"},
      {"motor", "write <joint_torque …/>, or <drive …/> if it prescribes the motion"},
      {"actuator", "write <joint_torque …/>, or <drive …/> if it prescribes the motion"},
      {"shell", "there are beams and bodies only", true},
      {"plate", "there are beams and bodies only", true},
      {"solid", "there are beams and bodies only", true},
      {"force", "write <load at=… force=\"…\"/>"},
      {"moment", "write <load at=… moment=\"…\"/>"},
      {"deflection", "write displacement"},
      {"torque",
       "write moment (of a beam) or reaction_moment (of a joint); what turns a joint is "
       "<joint_torque …/>"},
      {"reaction", "write reaction_force and reaction_moment"},
      {"stress", "this version has resultants, force and moment; stress follows from the section"},
      {"strain", "this version has resultants, force and moment; strain follows from the section"},
  };
  for (const Usual& usual : table)
    if (usual.word == word)
      return std::string(usual.instead) +
             (usual.absent ? "; see \"What is not there\" in models/MANUAL.md" : "");
  return {};
}

bool is_name(std::string_view text) {
  constexpr std::size_t longest = 200;
  return !text.empty() && text.size() <= longest &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  c == '_' || c == '-';
         });
}

}  // namespace mbd::schema
