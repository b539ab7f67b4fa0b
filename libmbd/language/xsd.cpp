// The grammar for XML editors, from the schema's table.
//
// One complex type for each element; an element that holds others has a group of those that may also stand
// in a <repeat> there, because <repeat> holds what may stand around it: its type depends on where it is.
// <defaults> holds elements with their attributes, all optional, and nothing else: for each kind the
// optional attributes are one attribute group, which both its types use. All elements but the root are
// local declarations, so that no other can be a document's root.
//
// Required in the grammar is what the model requires, unless <defaults> may have given it, which XSD 1.0
// cannot know: a grammar that refuses right models would be worse than one that misses a fault which the
// reader finds. Names, places and positions stay required: they are of one item, and no sensible default.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "libmbd/language/manual.hpp"

namespace mbd {
namespace {

using schema::Attribute;
using schema::Element;
using schema::Kind;

constexpr std::string_view repeat = "repeat";
constexpr std::string_view defaults = "defaults";

constexpr std::string_view head = R"(<?xml version="1.0" encoding="UTF-8"?>
<!-- Grammar of the model files of mbd, for XML editors. Written by `mbd schema` from
     libmbd/language/schema.cpp: change that, not this. Numbers are expressions with units, which only mbd reads. -->
<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema">
)";

// A name as written: with expressions in braces, and a place of it.
constexpr std::string_view name_pattern = R"(([A-Za-z0-9_\-]|\{[^{}]+\})+)";

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
}

std::string documentation(std::string_view text) {
  return "<xs:annotation><xs:documentation>" + escaped(text) +
         "</xs:documentation></xs:annotation>";
}

// The types of attributes other than choices.
std::string simple_types() {
  const std::string place =
      fmt::format(R"({}(\.start|\.end|@([^\s{{}}]|\{{[^{{}}]+\}})+)?)", name_pattern);
  const auto type = [](std::string_view name, std::string_view base, std::string_view facet,
                       std::string_view value, std::string_view doc) {
    return fmt::format(
        "  <xs:simpleType name=\"{}\">\n    {}\n    <xs:restriction base=\"xs:{}\">"
        "<xs:{} value=\"{}\"/></xs:restriction>\n  </xs:simpleType>\n",
        name, documentation(doc), base, facet, escaped(value), "");
  };
  return type("name.text", "string", "pattern", name_pattern,
              "letters, digits, _ and -; {i+1} becomes a whole number") +
         type("place.text", "string", "pattern", R"(\s*)" + place + R"(\s*)",
              "ground, a body, or beam.start, beam.end, beam@0.5") +
         type("places.text", "string", "pattern", R"(\s*)" + place + R"(\s+)" + place + R"(\s*)",
              "two places, separated by a blank") +
         type("words.text", "token", "minLength", "1", "words separated by blanks") +
         type("numbers.text", "token", "minLength", "1",
              "expressions of parameters, separated by blanks; a unit may follow") +
         type("nothing.text", "token", "maxLength", "0", "no text");
}

std::string type_of(Kind kind) {
  switch (kind) {
    case Kind::name:
      return "name.text";
    case Kind::place:
      return "place.text";
    case Kind::places:
      return "places.text";
    case Kind::names:
      return "words.text";
    case Kind::text:
    case Kind::choice:
      return "xs:string";
    default:
      return "numbers.text";
  }
}

// Meaning, unit, what its text is, default.
std::string meaning(const Attribute& a) {
  std::string text(a.doc);
  if (a.unit == any_unit)
    text += " [any unit]";
  else if (!a.unit.empty())
    text += fmt::format(" [{}]", a.unit);
  if (a.kind != Kind::text && a.kind != Kind::choice) text += "; " + manual::value_of(a);
  if (a.fallback == schema::required)
    text += "; required";
  else if (a.fallback != schema::optional)
    text += fmt::format("; default {}", a.fallback);
  return text;
}

std::string declaration(const Attribute& a, bool required) {
  const std::string use = required ? " use=\"required\"" : "";
  if (a.kind != Kind::choice)
    return fmt::format("    <xs:attribute name=\"{}\" type=\"{}\"{}>{}</xs:attribute>\n", a.name,
                       type_of(a.kind), use, documentation(meaning(a)));
  std::string text = fmt::format(
      "    <xs:attribute name=\"{}\"{}>{}\n      <xs:simpleType><xs:restriction "
      "base=\"xs:string\">\n",
      a.name, use, documentation(meaning(a)));
  for (const std::string_view choice : schema::words(a.choices))
    text += fmt::format("        <xs:enumeration value=\"{}\"/>\n", choice);
  return text + "      </xs:restriction></xs:simpleType>\n    </xs:attribute>\n";
}

bool is_item_name(const Attribute& a) { return a.name == "name" && a.kind == Kind::name; }

class Grammar {
 public:
  explicit Grammar(std::span<const Element> elements) : elements_(elements) {}

  std::string text() const {
    const Element& root = elements_.front();
    std::string all(head);
    all += element_declaration(root.name, root.name, root.doc, 2);
    all += simple_types();
    for (const Element& element : elements_) {
      if (element.name == repeat) continue;  // a type for each place
      all += group_of_repeated(element);
      all += shared_attributes(element);
      all += complex_type(element);
      if (may_repeat(element.name)) all += repeat_type(element);
    }
    if (find(defaults) != nullptr)
      for (const std::string_view name : children(defaults)) all += defaults_type(*find(name));
    return all + "</xs:schema>\n";
  }

 private:
  const Element* find(std::string_view name) const {
    const auto it = std::find_if(elements_.begin(), elements_.end(),
                                 [&](const Element& element) { return element.name == name; });
    return it == elements_.end() ? nullptr : &*it;
  }

  static bool contains(const std::vector<std::string_view>& words, std::string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  }

  std::vector<std::string_view> children(std::string_view parent) const {
    std::vector<std::string_view> result;
    for (const Element& element : elements_)
      if (contains(schema::words(element.parents), parent)) result.push_back(element.name);
    return result;
  }

  bool may_repeat(std::string_view parent) const { return contains(children(parent), repeat); }
  bool may_be_default(std::string_view name) const { return contains(children(defaults), name); }

  // Of what stands in a parent, that which may be repeated there or must not.
  std::vector<std::string_view> children(std::string_view parent, bool repeated) const {
    std::vector<std::string_view> result = children(parent);
    const std::vector<std::string_view> in_repeat = children(repeat);
    std::erase_if(result, [&](std::string_view name) {
      return (may_repeat(parent) && contains(in_repeat, name)) != repeated;
    });
    return result;
  }

  static std::string element_declaration(std::string_view name, std::string_view type,
                                         std::string_view doc, int indent) {
    return fmt::format("{:{}}<xs:element name=\"{}\" type=\"{}\">{}</xs:element>\n", "", indent,
                       name, type, documentation(doc));
  }

  std::string declarations(std::span<const std::string_view> names, std::string_view parent,
                           std::string_view suffix = "") const {
    std::string text;
    for (const std::string_view name : names) {
      const std::string type = name == repeat ? fmt::format("repeat.in.{}", parent)
                                              : std::string(name) + std::string(suffix);
      text += element_declaration(name, type, find(name)->doc, 6);
    }
    return text;
  }

  // What a parent and a <repeat> in it may both hold.
  std::string group_of_repeated(const Element& parent) const {
    if (!may_repeat(parent.name)) return {};
    return fmt::format(
        "  <xs:group name=\"repeated.in.{}\">\n    <xs:choice>\n{}    </xs:choice>\n  "
        "</xs:group>\n",
        parent.name, declarations(children(parent.name, true), parent.name));
  }

  std::string any_number_of(std::string_view inside) const {
    return fmt::format(
        "    <xs:choice minOccurs=\"0\" maxOccurs=\"unbounded\">\n{}    </xs:choice>\n", inside);
  }

  bool is_required(const Element& element, const Attribute& a) const {
    return a.fallback == schema::required &&
           (!may_be_default(element.name) || schema::is_of_one_item(a));
  }

  // Attributes that are the same in both types of what may be a default.
  bool is_shared(const Element& element, const Attribute& a) const {
    return may_be_default(element.name) && !is_required(element, a) && !is_item_name(a);
  }

  std::string shared_attributes(const Element& element) const {
    if (!may_be_default(element.name)) return {};
    std::string inside;
    for (const Attribute& a : element.attributes)
      if (is_shared(element, a)) inside += declaration(a, false);
    return fmt::format("  <xs:attributeGroup name=\"{}.optional\">\n{}  </xs:attributeGroup>\n",
                       element.name, inside);
  }

  std::string attributes(const Element& element, bool as_default) const {
    std::string text;
    for (const Attribute& a : element.attributes) {
      if (a.name.find(':') != std::string_view::npos) continue;  // of another namespace
      if (is_shared(element, a) || (as_default && is_item_name(a))) continue;
      text += declaration(a, !as_default && is_required(element, a));
    }
    if (may_be_default(element.name))
      text += fmt::format("    <xs:attributeGroup ref=\"{}.optional\"/>\n", element.name);
    return text;
  }

  // A simple type may have blanks and comments where a type without content may not.
  static std::string with_text(std::string_view name, std::string_view type,
                               std::string_view attributes) {
    return fmt::format(
        "  <xs:complexType name=\"{}\"><xs:simpleContent><xs:extension base=\"{}\">\n{}"
        "  </xs:extension></xs:simpleContent></xs:complexType>\n",
        name, type, attributes);
  }

  std::string complex_type(const Element& element) const {
    std::string inside;
    if (element.name == defaults) {
      inside = declarations(children(defaults), defaults, ".defaults");
    } else {
      if (may_repeat(element.name))
        inside = fmt::format("      <xs:group ref=\"repeated.in.{}\"/>\n", element.name);
      inside += declarations(children(element.name, false), element.name);
    }
    if (inside.empty())
      return with_text(element.name, element.content.empty() ? "nothing.text" : "xs:string",
                       attributes(element, false));
    return fmt::format("  <xs:complexType name=\"{}\"{}>\n{}{}  </xs:complexType>\n", element.name,
                       element.content.empty() ? "" : " mixed=\"true\"", any_number_of(inside),
                       attributes(element, false));
  }

  std::string repeat_type(const Element& parent) const {
    return fmt::format(
        "  <xs:complexType name=\"repeat.in.{}\">\n{}{}  </xs:complexType>\n", parent.name,
        any_number_of(fmt::format("      <xs:group ref=\"repeated.in.{}\"/>\n", parent.name)),
        attributes(*find(repeat), false));
  }

  std::string defaults_type(const Element& element) const {
    return with_text(std::string(element.name) + ".defaults", "nothing.text",
                     attributes(element, true));
  }

  std::span<const Element> elements_;
};

}  // namespace

std::string to_xsd(std::span<const Element> elements) { return Grammar(elements).text(); }

}  // namespace mbd
