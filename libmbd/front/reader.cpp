#include "libmbd/front/reader.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <set>
#include <stdexcept>

#include "libmbd/front/schema.hpp"
#include "libmbd/front/spelling.hpp"

namespace mbd {
namespace {

using schema::Kind;
using tinyxml2::XMLAttribute;
using tinyxml2::XMLElement;

constexpr std::uintmax_t largest_file = 64u << 20;
constexpr long most_repetitions = 1'000'000;  // of all <repeat> together
constexpr double largest_count = 1e9;

bool is_blank(std::string_view text) { return schema::words(text).empty(); }

std::string in_quotes(std::string_view text) { return "\"" + std::string(text) + "\""; }

std::string shortest(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

// Without dots, @, commas and blanks, so that names of columns and places can be taken apart.
bool is_name(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
}

std::string allowed(const schema::Range& range) {
  const bool below = std::isfinite(range.min), above = std::isfinite(range.max);
  if (below && above)
    return "must lie between " + shortest(range.min) + " and " + shortest(range.max);
  if (below && range.min == 0.0) return range.open ? "must be positive" : "must not be negative";
  return (range.open ? "must be greater than " : "must be at least ") + shortest(range.min);
}

bool contains(const schema::Range& range, double value) {
  if (range.open) return value > range.min && value < range.max;
  return value >= range.min && value <= range.max;
}

// One element of the file together with its entry in the schema. Every attribute has been compared with
// the schema before anything is read; the getters below turn text into values, or throw.
class Item {
 public:
  Item(const XMLElement& xml, const std::string& file, const Parameters& parameters)
      : xml_(xml), file_(file), parameters_(parameters), element_(entry(xml, file)) {
    check();
  }

  const XMLElement& xml() const { return xml_; }
  const schema::Element& element() const { return element_; }
  Source source() const { return {file_, xml_.GetLineNum()}; }
  bool has(std::string_view name) const { return attribute(name) != nullptr; }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(source(), label() + ": " + what);
  }
  [[noreturn]] void fail(std::string_view name, const std::string& what) const {
    const XMLAttribute* const given = attribute(name);
    const Source at{file_, given ? given->GetLineNum() : xml_.GetLineNum()};
    const std::string value = given ? "=" + in_quotes(given->Value()) : "";
    throw Error(at, label() + ": " + std::string(name) + value + ": " + what);
  }

  std::string text(std::string_view name) const {
    return expand(name, raw(name, {Kind::text, Kind::name}));
  }

  std::string name(std::string_view attribute = "name") const {
    const std::string result = expand(attribute, raw(attribute, {Kind::name}));
    if (!is_name(result))
      fail(attribute, "a name is made of letters, digits, _ and -, and is not empty");
    return result;
  }

  std::vector<std::string> names(std::string_view attribute) const {
    const std::string all = expand(attribute, raw(attribute, {Kind::names}));
    std::vector<std::string> result;
    for (const std::string_view word : schema::words(all)) {
      if (std::find(result.begin(), result.end(), word) != result.end())
        fail(attribute, in_quotes(word) + " stands there twice");
      result.emplace_back(word);
    }
    if (result.empty()) fail(attribute, "names are missing");
    return result;
  }

  double number(std::string_view name) const {
    return in_range(name, evaluate(name, raw(name, {Kind::number})));
  }

  int count(std::string_view name) const {
    const double value = in_range(name, evaluate(name, raw(name, {Kind::count})));
    if (value != std::floor(value) || std::abs(value) > largest_count)
      fail(name, "is " + shortest(value) + ", must be a whole number");
    return static_cast<int>(value);
  }

  std::vector<double> numbers(std::string_view name) const {
    const schema::Attribute& entry = entry_of(name);
    const std::string all = raw(name, {Kind::numbers});
    const std::vector<std::string_view> parts = schema::words(all);
    const auto [few, many] = entry.sizes;
    const auto size = static_cast<int>(parts.size());
    if (size != few && size != many)
      fail(name, "has " + std::to_string(size) + " components, must have " + std::to_string(few) +
                     (few == many ? "" : " or " + std::to_string(many)) +
                     "; they are separated by blanks and contain none");
    std::vector<double> values;
    for (const std::string_view part : parts)
      values.push_back(in_range(name, evaluate(name, part)));
    return values;
  }

  Vec3 vector(std::string_view name) const {
    const std::vector<double> values = numbers(name);
    return {values[0], values[1], values[2]};
  }

  // A symmetric matrix from xx yy zz [xy xz yz].
  Mat3 symmetric(std::string_view name) const {
    std::vector<double> v = numbers(name);
    v.resize(6, 0.0);
    Mat3 matrix;
    matrix << v[0], v[3], v[4], v[3], v[1], v[5], v[4], v[5], v[2];
    return matrix;
  }

  Expression signal(std::string_view name) const {
    return parse(name, raw(name, {Kind::signal}), Variables::time);
  }

  std::array<Expression, 3> signals(std::string_view name) const {
    const std::string all = raw(name, {Kind::signals});
    const std::vector<std::string_view> parts = three(name, all);
    const auto part = [&](std::size_t i) { return parse(name, parts[i], Variables::time); };
    return {part(0), part(1), part(2)};
  }

  // Tried at the ends of their interval.
  std::array<FieldExpression, 3> fields(std::string_view name, double from, double to) const {
    const std::string all = raw(name, {Kind::fields});
    const std::vector<std::string_view> parts = three(name, all);
    const auto part = [&](std::size_t i) {
      FieldExpression field{std::string(parts[i]), parameters_};
      try {
        for (const double s : {from, to}) field.at(s);
      } catch (const Error& error) {
        fail(name, error.what());
      }
      return field;
    };
    return {part(0), part(1), part(2)};
  }

  // The position of the word among the choices, which is that of the enum they stand for.
  template <class Enum>
  Enum choice(std::string_view name) const {
    const std::string word = raw(name, {Kind::choice});
    const std::vector<std::string_view> choices = schema::words(entry_of(name).choices);
    const auto it = std::find(choices.begin(), choices.end(), word);
    if (it == choices.end()) fail(name, "no such choice" + suggest(word, choices, "choices"));
    return static_cast<Enum>(it - choices.begin());
  }

  Place place(std::string_view name) const {
    const std::string all = expand(name, raw(name, {Kind::place}));
    const std::vector<std::string_view> parts = schema::words(all);
    if (parts.size() != 1) fail(name, "must be one place: " + std::string(places_are));
    return place(name, parts[0]);
  }

  std::pair<Place, Place> places(std::string_view name) const {
    const std::string all = expand(name, raw(name, {Kind::places}));
    const std::vector<std::string_view> parts = schema::words(all);
    if (parts.size() != 2)
      fail(name, "has " + std::to_string(parts.size()) +
                     " places, must have two: " + std::string(places_are));
    return {place(name, parts[0]), place(name, parts[1])};
  }

  double evaluate(std::string_view name, std::string_view text) const {
    const double value = parse(name, text, Variables::none).value();
    if (!std::isfinite(value)) fail(name, in_quotes(text) + " is not finite");
    return value;
  }

  // {expression} becomes its integer value.
  std::string expand(std::string_view name, std::string_view text) const {
    std::string result;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t open = std::min(text.find('{', at), text.size());
      if (text.substr(at, open - at).find('}') != std::string_view::npos) fail(name, "} without {");
      result += text.substr(at, open - at);
      if (open == text.size()) break;
      const std::size_t close = text.find('}', open);
      if (close == std::string_view::npos) fail(name, "{ without }");
      const double value = evaluate(name, text.substr(open + 1, close - open - 1));
      if (value != std::floor(value) || std::abs(value) > largest_count)
        fail(name, std::string(text.substr(open, close - open + 1)) + " is " + shortest(value) +
                       ", must be a whole number");
      result += std::to_string(static_cast<long>(value));
      at = close + 1;
    }
    return result;
  }

  // The element's own text, elements inside it left out.
  std::string content() const {
    std::string all;
    for (const tinyxml2::XMLNode* node = xml_.FirstChild(); node; node = node->NextSibling())
      if (const tinyxml2::XMLText* const piece = node->ToText()) all += piece->Value();
    return all;
  }

 private:
  static constexpr std::string_view places_are =
      "ground, the name of a body, or beam.start, beam.end, beam@0.5";

  std::vector<std::string_view> three(std::string_view name, std::string_view all) const {
    std::vector<std::string_view> parts = schema::words(all);
    if (parts.size() != 3)
      fail(name, "has " + std::to_string(parts.size()) +
                     " components, must have 3; they are separated by blanks and contain none");
    return parts;
  }

  // The parent's check has found the element in the schema; only a root has no parent.
  static const schema::Element& entry(const XMLElement& xml, const std::string& file) {
    const schema::Element* const found = schema::find_element(xml.Name());
    if (!xml.Parent()->ToElement() && (!found || !found->parents.empty()))
      throw Error(Source{file, xml.GetLineNum()},
                  "<" + std::string(xml.Name()) + ">: a model is one <mbd name=\"…\"> element");
    return *found;
  }

  // What may stand in <repeat> depends on what it stands in.
  void check_child(const XMLElement& child) const {
    std::string_view around = element_.name;
    for (const XMLElement* e = &xml_; around == "repeat"; e = e->Parent()->ToElement())
      around = e->Parent()->ToElement()->Name();
    std::vector<std::string_view> here = schema::children(element_.name);
    if (around != element_.name) {
      const std::vector<std::string_view> there = schema::children(around);
      std::erase_if(here, [&there](std::string_view name) {
        return std::find(there.begin(), there.end(), name) == there.end();
      });
    }
    if (std::find(here.begin(), here.end(), child.Name()) != here.end()) return;
    const std::string name = "<" + std::string(child.Name()) + ">";
    const std::string where = "<" + std::string(element_.name) + ">" +
                              (around == element_.name ? "" : " in <" + std::string(around) + ">");
    const Source at{file_, child.GetLineNum()};
    if (here.empty())
      throw Error(at, name + " cannot stand in " + where + ", which has no elements");
    if (!schema::find_element(child.Name()))
      throw Error(at,
                  "unknown element " + name + suggest(child.Name(), here, "elements in " + where));
    throw Error(at, name + " cannot stand in " + where + "; the elements there are: " + list(here));
  }

  void check() const {
    for (const XMLAttribute* a = xml_.FirstAttribute(); a; a = a->Next()) {
      const Source at{file_, a->GetLineNum()};
      if (!schema::find_attribute(element_, a->Name()))
        throw Error(at, label() + ": unknown attribute " + in_quotes(a->Name()) +
                            suggest(a->Name(), schema::attribute_names(element_),
                                    "attributes of <" + std::string(element_.name) + ">"));
    }
    for (const schema::Attribute& entry : element_.attributes)
      if (entry.fallback == schema::required && !has(entry.name))
        fail("attribute " + in_quotes(entry.name) + " is missing: " + std::string(entry.doc) +
             (entry.unit.empty() ? "" : " [" + std::string(entry.unit) + "]"));
    for (const tinyxml2::XMLNode* node = xml_.FirstChild(); node; node = node->NextSibling()) {
      const Source at{file_, node->GetLineNum()};
      if (const XMLElement* const child = node->ToElement()) check_child(*child);
      if (node->ToText() && element_.content.empty() && !is_blank(node->Value()))
        throw Error(at, label() + ": text " + in_quotes(schema::words(node->Value())[0]) +
                            " … does not belong here; comments are written <!-- … -->");
      if (node->ToUnknown() || node->ToDeclaration())
        throw Error(at, label() + ": <!…> and <?…> do not belong here");
    }
  }

  std::string label() const {
    std::string text(element_.name);
    if (const char* const given = xml_.Attribute("name")) text += " " + in_quotes(given);
    return text;
  }

  const XMLAttribute* attribute(std::string_view name) const {
    return xml_.FindAttribute(std::string(name).c_str());
  }

  const schema::Attribute& entry_of(std::string_view name) const {
    const schema::Attribute* const found = schema::find_attribute(element_, name);
    if (!found) throw std::logic_error("not in the schema: " + std::string(name));
    return *found;
  }

  // The text as written, or the default.
  std::string raw(std::string_view name, std::initializer_list<Kind> kinds) const {
    const schema::Attribute& entry = entry_of(name);
    if (std::find(kinds.begin(), kinds.end(), entry.kind) == kinds.end())
      throw std::logic_error("of another kind in the schema: " + std::string(name));
    if (const XMLAttribute* const given = attribute(name)) return given->Value();
    if (entry.fallback == schema::optional || entry.fallback == schema::required)
      fail("attribute " + in_quotes(name) + " is missing: " + std::string(entry.doc));
    return std::string(entry.fallback);
  }

  double in_range(std::string_view name, double value) const {
    const schema::Range& range = entry_of(name).range;
    if (!contains(range, value)) fail(name, "is " + shortest(value) + ", " + allowed(range));
    return value;
  }

  Expression parse(std::string_view name, std::string_view text, Variables variables) const {
    try {
      return Expression::parse(text, parameters_, variables);
    } catch (const Error& error) {
      fail(name, error.what());
    }
  }

  Place place(std::string_view attribute, std::string_view text) const {
    Place result;
    if (text == "ground") return result;
    const std::size_t end = std::min(text.find_first_of(".@"), text.size());
    result.name = text.substr(0, end);
    const std::string_view rest = text.substr(end);
    const auto no_place = [&]() {
      fail(attribute, in_quotes(text) + " is not a place: " + std::string(places_are));
    };
    if (!is_name(result.name)) no_place();
    result.kind = rest.empty() ? Place::Kind::body : Place::Kind::beam;
    if (rest == ".end") {
      result.parameter = 1.0;
    } else if (rest.starts_with('@')) {
      result.parameter = evaluate(attribute, rest.substr(1));
      if (!contains({0.0, 1.0}, result.parameter))
        fail(attribute, "the parameter of a beam " + allowed({0.0, 1.0}) + ", from start to end");
    } else if (!rest.empty() && rest != ".start") {
      no_place();
    }
    return result;
  }

  const XMLElement& xml_;
  const std::string& file_;
  const Parameters& parameters_;
  const schema::Element& element_;
};

// Where each name of one kind was given.
class Names {
 public:
  void add(const Item& item, const std::string& name) {
    const auto [it, added] = lines_.try_emplace(name, item.source().line);
    if (!added)
      item.fail("the name " + in_quotes(name) + " is taken by line " + std::to_string(it->second) +
                "; give each its own (in <repeat>: name=\"" + name + "{i}\")");
  }

 private:
  std::map<std::string, int> lines_;
};

class Reader {
 public:
  Reader(std::string file, const Overrides& overrides) : overrides_(overrides) {
    scene_.file = std::move(file);
  }

  Scene read(std::string_view text) {
    if (text.find('\0') != std::string_view::npos)
      throw Error(Source{scene_.file, 1}, "not an XML file: it contains zero bytes");
    tinyxml2::XMLDocument document;
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) bad_xml(document);
    const XMLElement* const root = document.RootElement();
    if (!root) throw Error(Source{scene_.file, 1}, "no model: it is one <mbd name=\"…\"> element");
    if (const XMLElement* const second = root->NextSiblingElement())
      throw Error(Source{scene_.file, second->GetLineNum()},
                  "<" + std::string(second->Name()) +
                      ">: a model is one <mbd> element, and this is a second");
    const Item model(*root, scene_.file, parameters_);
    scene_.name = model.name();
    check_overrides(*root);
    read_children(*root);
    check_expects();
    return std::move(scene_);
  }

 private:
  using Read = void (Reader::*)(const Item&);

  [[noreturn]] void bad_xml(const tinyxml2::XMLDocument& document) const {
    using namespace tinyxml2;
    const auto what = [&]() -> std::string {
      switch (document.ErrorID()) {
        case XML_ERROR_EMPTY_DOCUMENT:
          return "the file is empty";
        case XML_ERROR_MISMATCHED_ELEMENT:
          return "this element is not closed, or closed by another name";
        case XML_ERROR_PARSING_ATTRIBUTE:
          return "an attribute is not of the form name=\"value\", or is given twice";
        case XML_ERROR_PARSING_COMMENT:
          return "a comment is not of the form <!-- … -->";
        case XML_ELEMENT_DEPTH_EXCEEDED:
          return "elements are nested too deeply";
        default:
          return XMLDocument::ErrorIDToName(document.ErrorID());
      }
    }();
    throw Error(Source{scene_.file, std::max(1, document.ErrorLineNum())},
                "not well-formed XML: " + what);
  }

  // Every --set names a parameter of the model, once.
  void check_overrides(const XMLElement& root) const {
    std::vector<std::string_view> known;
    for (const XMLElement* e = root.FirstChildElement("parameter"); e;
         e = e->NextSiblingElement("parameter"))
      if (const char* const name = e->Attribute("name")) known.emplace_back(name);
    std::set<std::string_view> seen;
    for (const auto& [name, value] : overrides_) {
      if (std::find(known.begin(), known.end(), name) == known.end())
        throw Error("--set " + name + "=" + value + ": " + scene_.file + " has no such parameter" +
                    suggest(name, known, "parameters"));
      if (!seen.insert(name).second) throw Error("--set " + name + "=" + value + ": set twice");
    }
  }

  void read_children(const XMLElement& parent) {
    static const std::map<std::string_view, Read> readers = {
        {"parameter", &Reader::parameter},
        {"section", &Reader::section},
        {"beam", &Reader::beam},
        {"arc", &Reader::beam},
        {"curve", &Reader::beam},
        {"distributed", &Reader::distributed},
        {"point_mass", &Reader::point_mass},
        {"body", &Reader::body},
        {"drive", &Reader::drive},
        {"motion", &Reader::motion},
        {"load", &Reader::load},
        {"gravity", &Reader::gravity},
        {"static", &Reader::statics},
        {"transient", &Reader::transient},
        {"record", &Reader::record},
        {"plot", &Reader::plot},
        {"expect", &Reader::expect},
        {"repeat", &Reader::repeat},
    };
    for (const XMLElement* e = parent.FirstChildElement(); e; e = e->NextSiblingElement()) {
      const Item item(*e, scene_.file, parameters_);
      if (schema::find_joint_kind(e->Name()))
        joint(item);
      else
        (this->*readers.at(e->Name()))(item);
    }
  }

  template <class T>
  static void set_once(std::optional<T>& slot, const Item& item, T value) {
    if (slot)
      item.fail("there may be one; another is on line " + std::to_string(slot->source.line));
    slot = std::move(value);
  }

  static void one_of(const Item& item, std::string_view a, std::string_view b) {
    if (item.has(a) == item.has(b))
      item.fail("give one of the attributes " + in_quotes(a) + " and " + in_quotes(b) +
                (item.has(a) ? ", not both" : ""));
  }

  void parameter(const Item& item) {
    const std::string name = item.name();
    double value = 0.0;
    const auto set = std::find_if(overrides_.begin(), overrides_.end(),
                                  [&](const auto& entry) { return entry.first == name; });
    if (set == overrides_.end()) {
      value = item.number("value");
    } else {
      try {
        value = Expression::parse(set->second, parameters_, Variables::none).value();
      } catch (const Error& error) {
        throw Error("--set " + name + "=" + set->second + ": " + error.what());
      }
    }
    define(item, name, value);
    scene_.parameters.emplace_back(name, value);
  }

  void define(const Item& item, const std::string& name, double value) {
    if (name.find('-') != std::string::npos || (name[0] >= '0' && name[0] <= '9'))
      item.fail("expressions cannot use the name " + in_quotes(name) +
                "; it must have letters, digits and _ only and not begin with a digit");
    if (Expression::is_reserved(name))
      item.fail(in_quotes(name) + " means something else in expressions; choose another name");
    if (!parameters_.try_emplace(name, value).second)
      item.fail("there is a parameter " + in_quotes(name) + " already; choose another name");
  }

  // f(item) for what stands in an element, and in any <repeat> there.
  template <class F>
  void each(const XMLElement& parent, const F& f) {
    for (const XMLElement* e = parent.FirstChildElement(); e; e = e->NextSiblingElement()) {
      const Item item(*e, scene_.file, parameters_);
      if (item.element().name == "repeat")
        repeat(item, [&] { each(*e, f); });
      else
        f(item);
    }
  }

  void section(const Item& item) {
    Section section;
    section.source = item.source();
    section.name = item.name();
    sections_.add(item, section.name);
    bool stiff = false;
    each(item.xml(), [&](const Item& part) {
      if (part.element().name == "station")
        section.stations.push_back(station(part));
      else
        matrix(item, part, section, stiff);
    });
    if (section.stations.empty()) {
      if (!stiff)
        item.fail(
            "<stiffness> is missing: give EA, GA2, GA3, GJ, EI2, EI3 or 36 numbers, or stations");
      if (item.has("interpolation"))
        item.fail("interpolation", "is between stations; leave it out or give <station>s");
    } else if (stiff || section.mass) {
      item.fail("stiffness and mass stand in the stations, or there are no stations");
    }
    section.interpolation = item.choice<Section::Interpolation>("interpolation");
    scene_.sections.push_back(std::move(section));
  }

  Station station(const Item& item) {
    Station station;
    station.source = item.source();
    station.at = item.number("at");
    bool stiff = false;
    each(item.xml(), [&](const Item& part) { matrix(item, part, station, stiff); });
    if (!stiff) item.fail("<stiffness> is missing: give EA, GA2, GA3, GJ, EI2, EI3 or 36 numbers");
    return station;
  }

  // <stiffness> or <mass> of a section or station.
  template <class Of>
  static void matrix(const Item& item, const Item& part, Of& of, bool& stiff) {
    const bool is_mass = part.element().name == "mass";
    if (is_mass ? of.mass.has_value() : stiff)
      part.fail("the " + std::string(item.element().name) + " has one already");
    if (is_mass) {
      of.mass = mass(part);
    } else {
      of.stiffness = stiffness(part);
      stiff = true;
    }
  }

  static Mat6 stiffness(const Item& item) {
    Mat6 D = Mat6::Zero();
    const std::string text = item.content();
    const std::vector<std::string_view> words = schema::words(text);
    if (words.empty()) {
      constexpr std::array<std::string_view, 6> diagonal = {"EA", "GA2", "GA3", "GJ", "EI2", "EI3"};
      for (int i = 0; i < 6; ++i) {
        D(i, i) = item.number(diagonal[static_cast<std::size_t>(i)]);
        for (int j = i + 1; j < 6; ++j)
          D(i, j) = D(j, i) = item.number("D" + std::to_string(i + 1) + std::to_string(j + 1));
      }
      return D;
    }
    if (item.xml().FirstAttribute())
      item.fail("give the 36 numbers or the entries by name, not both");
    if (words.size() != 36)
      item.fail("has " + std::to_string(words.size()) +
                " numbers, must have 36, row by row; an expression contains no blanks");
    for (int k = 0; k < 36; ++k)
      D(k / 6, k % 6) = item.evaluate("text", words[static_cast<std::size_t>(k)]);
    const double round_off = 1e-12 * D.cwiseAbs().maxCoeff();
    for (int i = 0; i < 6; ++i)
      for (int j = i + 1; j < 6; ++j) {
        if (std::abs(D(i, j) - D(j, i)) > round_off)
          item.fail("row " + std::to_string(i + 1) + ", column " + std::to_string(j + 1) + " is " +
                    shortest(D(i, j)) + " but row " + std::to_string(j + 1) + ", column " +
                    std::to_string(i + 1) + " is " + shortest(D(j, i)) +
                    "; a stiffness matrix is symmetric");
        D(j, i) = D(i, j);
      }
    return D;
  }

  // M of [v; w] about the reference line: [m I, -m c~; m c~, J], c = (0, x2, x3).
  static Mat6 mass(const Item& item) {
    const double m = item.number("per_length");
    const std::vector<double> center = item.numbers("center");
    Mat3 c_tilde;
    c_tilde << 0.0, -center[1], center[0], center[1], 0.0, 0.0, -center[0], 0.0, 0.0;
    Mat6 M = Mat6::Zero();
    M.topLeftCorner<3, 3>() = m * Mat3::Identity();
    M.topRightCorner<3, 3>() = -m * c_tilde;
    M.bottomLeftCorner<3, 3>() = m * c_tilde;
    M.bottomRightCorner<3, 3>() = item.symmetric("inertia");
    return M;
  }

  void beam(const Item& item) {
    BeamScene beam;
    beam.source = item.source();
    beam.name = place_name(item);
    beam.section = item.text("section");
    if (item.element().name == "arc")
      beam.line = Arc{item.vector("from"), item.vector("center"), item.vector("axis"),
                      item.number("angle")};
    else if (item.element().name == "curve")
      beam.line = curve(item);
    else
      beam.line = Straight{item.vector("from"), item.vector("to")};
    beam.normal = item.vector("normal");
    beam.elements = item.count("elements");
    beam.order = item.count("order");
    beam.metric = item.choice<Metric>("metric");
    beam.rule = item.choice<Rule>("rule");
    beam.form = item.choice<Form>("form");
    scene_.beams.push_back(std::move(beam));
  }

  Curve curve(const Item& item) {
    Curve curve;
    if (item.has("degree")) curve.degree = item.count("degree");
    each(item.xml(), [&](const Item& part) {
      CurvePoint point;
      point.source = part.source();
      point.at = part.vector("at");
      if (part.has("normal")) point.normal = part.vector("normal");
      point.twist = part.number("twist");
      curve.points.push_back(std::move(point));
    });
    if (curve.points.size() < 2)
      item.fail("has " + std::to_string(curve.points.size()) +
                " <point>s; a curve needs two at least");
    return curve;
  }

  // Beams and bodies share their names, because places do.
  std::string place_name(const Item& item) {
    const std::string name = item.name();
    if (name == "ground") item.fail("\"ground\" is the inertial frame; choose another name");
    places_.add(item, name);
    return name;
  }

  void body(const Item& item) {
    BodyScene body;
    body.source = item.source();
    body.name = place_name(item);
    if (item.has("attached_to")) {
      for (const std::string_view other : {"at", "orientation", "velocity", "angular_velocity"})
        if (item.has(other))
          item.fail(other,
                    "a body with attached_to takes this from its place; leave one of them out");
      body.attached_to = item.place("attached_to");
    }
    if (item.has("at")) body.at = item.vector("at");
    if (item.has("orientation")) body.orientation = orientation(item);
    if (item.has("velocity")) body.velocity = item.vector("velocity");
    if (item.has("angular_velocity")) body.angular_velocity = item.vector("angular_velocity");
    body.mass = item.number("mass");
    body.center = item.vector("center");
    body.inertia = item.symmetric("inertia");
    scene_.bodies.push_back(std::move(body));
  }

  static Mat3 orientation(const Item& item) {
    const std::vector<double> v = item.numbers("orientation");
    Mat3 R;
    if (v.size() == 3) {
      const Eigen::Vector3d turn(v[0], v[1], v[2]);
      const double angle = turn.norm();
      if (angle > 0.0)
        R = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
      else
        R.setIdentity();
      return R;
    }
    R << v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8];
    constexpr double tolerance = 1e-9;
    if ((R.transpose() * R - Mat3::Identity()).cwiseAbs().maxCoeff() > tolerance ||
        R.determinant() < 0.0)
      item.fail("orientation",
                "the matrix is not a rotation to 9 digits; give more digits, write "
                "its entries as expressions, or give a rotation vector");
    return R;
  }

  void joint(const Item& item) {
    JointScene joint;
    joint.source = item.source();
    joint.kind = item.element().name;
    joint.name = item.name();
    joints_.add(item, joint.name);
    std::tie(joint.a, joint.b) = item.places("between");
    if (item.has("at")) joint.at = item.vector("at");
    const joint::Traits& traits = schema::find_joint_kind(joint.kind)->traits;
    if (traits.axis) joint.axis = item.vector("axis");
    if (traits.second_axis) joint.second_axis = item.vector("second_axis");
    if (traits.parameter.name[0] != '\0') joint.parameter = item.number(traits.parameter.name);
    if (item.has("at_a")) joint.at_a = item.vector("at_a");
    if (item.has("at_b")) joint.at_b = item.vector("at_b");
    scene_.joints.push_back(std::move(joint));
  }

  void drive(const Item& item) {
    const std::initializer_list<std::string_view> laws{"rate", "angle", "speed", "displacement"};
    const auto given = std::count_if(laws.begin(), laws.end(),
                                     [&](std::string_view law) { return item.has(law); });
    if (given != 1)
      item.fail(std::string("give one of the attributes rate, angle, speed and displacement") +
                (given > 1 ? ", not more; another coordinate has a drive of its own" : ""));
    DriveScene drive;
    drive.source = item.source();
    drive.joint = item.text("joint");
    if (item.has("rate")) drive.rate = item.signal("rate");
    if (item.has("angle")) drive.angle = item.signal("angle");
    if (item.has("speed")) drive.speed = item.signal("speed");
    if (item.has("displacement")) drive.displacement = item.signal("displacement");
    scene_.drives.push_back(std::move(drive));
  }

  void motion(const Item& item) {
    MotionScene motion;
    motion.source = item.source();
    motion.name = item.name();
    joints_.add(item, motion.name);
    motion.of = item.place("of");
    if (item.has("displacement")) motion.displacement = item.signals("displacement");
    if (item.has("velocity")) motion.velocity = item.signals("velocity");
    if (item.has("rotation")) motion.rotation = item.signals("rotation");
    if (item.has("axis")) motion.axis = item.vector("axis");
    if (item.has("angle")) motion.angle = item.signal("angle");
    if (item.has("rate")) motion.rate = item.signal("rate");
    scene_.motions.push_back(std::move(motion));
  }

  static constexpr std::array<std::string_view, 4> loads_ = {"force", "moment", "follower_force",
                                                             "follower_moment"};
  static void some_load(const Item& item) {
    if (std::none_of(loads_.begin(), loads_.end(), [&](auto name) { return item.has(name); }))
      item.fail("give a force, a moment or both: force, moment, follower_force, follower_moment");
  }

  void load(const Item& item) {
    some_load(item);
    LoadScene load;
    load.source = item.source();
    if (item.has("name")) load.name = item.name();
    load.at = item.place("at");
    if (item.has("force")) load.force = item.signals("force");
    if (item.has("moment")) load.moment = item.signals("moment");
    if (item.has("follower_force")) load.follower_force = item.signals("follower_force");
    if (item.has("follower_moment")) load.follower_moment = item.signals("follower_moment");
    if (item.has("offset") && !load.force && !load.follower_force)
      item.fail("offset", "is where a force acts, and there is none; leave it out");
    load.offset = item.vector("offset");
    scene_.loads.push_back(std::move(load));
  }

  void distributed(const Item& item) {
    some_load(item);
    DistributedLoadScene load;
    load.source = item.source();
    if (item.has("name")) load.name = item.name();
    load.beam = item.text("beam");
    load.from = item.number("from");
    load.to = item.number("to");
    if (!(load.from < load.to))
      item.fail("to", "the load must end behind its beginning, at " + shortest(load.from));
    const auto fields = [&](std::string_view name, auto& slot) {
      if (item.has(name)) slot = item.fields(name, load.from, load.to);
    };
    fields("force", load.force);
    fields("moment", load.moment);
    fields("follower_force", load.follower_force);
    fields("follower_moment", load.follower_moment);
    scene_.distributed_loads.push_back(std::move(load));
  }

  void point_mass(const Item& item) {
    PointMassScene mass;
    mass.source = item.source();
    if (item.has("name")) mass.name = item.name();
    mass.at = item.place("at");
    mass.mass = item.number("mass");
    mass.offset = item.vector("offset");
    scene_.point_masses.push_back(std::move(mass));
  }

  void gravity(const Item& item) {
    set_once(scene_.gravity, item, Gravity{item.source(), item.vector("acceleration")});
  }

  void statics(const Item& item) {
    set_once(scene_.statics, item,
             StaticScene{item.source(), item.count("steps"), item.number("tolerance")});
  }

  void transient(const Item& item) {
    TransientScene transient;
    transient.source = item.source();
    transient.duration = item.number("duration");
    transient.step = item.number("step");
    transient.rho_infinity = item.number("rho_infinity");
    transient.balance = item.choice<Balance>("balance");
    if (item.has("tolerance")) transient.tolerance = item.number("tolerance");
    set_once(scene_.transient, item, std::move(transient));
  }

  void record(const Item& item) {
    if (item.has("at") && item.has("joint"))
      item.fail(
          "give one of the attributes \"at\" and \"joint\", not both (neither: the whole "
          "system)");
    RecordScene record;
    record.source = item.source();
    record.name = item.name();
    records_.add(item, record.name);
    if (item.has("at")) record.at = item.place("at");
    if (item.has("joint")) record.joint = item.text("joint");
    record.quantities = item.names("quantities");
    const auto known = record.at      ? schema::place_quantities()
                       : record.joint ? schema::joint_quantities()
                                      : schema::system_quantities();
    for (const std::string& quantity : record.quantities) {
      const schema::Quantity* const found = schema::find_quantity(known, quantity);
      if (!found)
        item.fail("quantities", "unknown quantity " + in_quotes(quantity) +
                                    suggest(quantity, schema::names(known),
                                            record.at      ? "quantities of a place"
                                            : record.joint ? "quantities of a joint"
                                                           : "quantities of the whole system"));
      if (found->of == schema::Quantity::Of::beam_place && record.at->kind != Place::Kind::beam)
        item.fail("quantities", in_quotes(quantity) +
                                    " is a resultant of a beam; record it at a beam "
                                    "(beam@0.5) or of a joint");
    }
    scene_.records.push_back(std::move(record));
  }

  void plot(const Item& item) {
    PlotScene plot;
    plot.source = item.source();
    plot.x = item.text("x");
    plot.y = item.names("y");
    plot.x_scale = item.number("x_scale");
    plot.y_scale = item.number("y_scale");
    if (item.has("x_label")) plot.x_label = item.text("x_label");
    if (item.has("y_label")) plot.y_label = item.text("y_label");
    if (item.has("title")) plot.title = item.text("title");
    if (item.has("x_range")) {
      const std::vector<double> ends = item.numbers("x_range");
      if (!(ends[0] < ends[1])) item.fail("x_range", "the second number must be the greater");
      plot.x_range = {ends[0], ends[1]};
    }
    scene_.plots.push_back(std::move(plot));
  }

  void expect(const Item& item) {
    ExpectScene expect;
    expect.source = item.source();
    expect.quantity = item.text("quantity");
    expect.of = item.choice<ExpectScene::Of>("of");
    const bool timed = expect.of == ExpectScene::Of::value_at;
    if (item.has("at") && !timed)
      item.fail("at", "an extreme is taken over the whole run; leave it out");
    if (item.has("at")) expect.at = item.number("at");
    if (timed && !item.has("at")) untimed_.push_back(expect.source);
    expect.value = item.number("value");
    expect.tolerance = item.number("tolerance");
    expect.reference = item.text("source");
    if (!item.has("when") || holds(item)) scene_.expects.push_back(std::move(expect));
  }

  // Whether every parameter=value of `when` is so.
  bool holds(const Item& item) const {
    bool all = true;
    for (const std::string& condition : item.names("when")) {
      const std::size_t equals = condition.find('=');
      const auto known = parameters_.find(std::string_view(condition).substr(0, equals));
      if (equals == std::string::npos || known == parameters_.end())
        item.fail("when", in_quotes(condition) + " is not of the form parameter=value");
      all = all &&
            known->second == item.evaluate("when", std::string_view(condition).substr(equals + 1));
    }
    return all;
  }

  // A value needs its time, unless there is equilibrium only.
  void check_expects() const {
    if (scene_.transient && !untimed_.empty())
      throw Error(untimed_.front(), "expect: attribute \"at\" is missing: time of the value [s]");
  }

  void repeat(const Item& item) {
    repeat(item, [&] { read_children(item.xml()); });
  }

  template <class Body>
  void repeat(const Item& item, const Body& body) {
    const int count = item.count("count");
    const std::string index = item.name("index");
    for (int i = 0; i < count; ++i) {
      if (++repetitions_ > most_repetitions)
        item.fail("more than " + std::to_string(most_repetitions) + " repetitions in one model");
      define(item, index, i);
      body();
      parameters_.erase(index);
    }
  }

  const Overrides& overrides_;
  Scene scene_;
  Parameters parameters_;
  Names sections_, places_, joints_, records_;
  std::vector<Source> untimed_;  // expected values without a time
  long repetitions_ = 0;
};

}  // namespace

Scene read_model(const std::filesystem::path& file, const Overrides& overrides) {
  const std::string name = file.string();
  std::error_code code;
  if (std::filesystem::is_directory(file, code))
    throw Error(name + ": is a directory, not a model");
  const std::uintmax_t size = std::filesystem::file_size(file, code);
  if (!code && size > largest_file)
    throw Error(name + ": has " + std::to_string(size >> 20) +
                " MB, a model may have 64; use <repeat>");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(name + ": no such file, or it cannot be read");
  std::string text;
  char buffer[1 << 16];
  while (stream.read(buffer, sizeof buffer) || stream.gcount() > 0) {
    text.append(buffer, static_cast<std::size_t>(stream.gcount()));
    if (text.size() > largest_file) throw Error(name + ": is larger than 64 MB; use <repeat>");
  }
  if (stream.bad()) throw Error(name + ": cannot be read to its end");
  return read_model_text(text, name, overrides);
}

Scene read_model_text(std::string_view text, const std::string& file, const Overrides& overrides) {
  return Reader(file, overrides).read(text);
}

}  // namespace mbd
