#include "libmbd/language/manual.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "libmbd/language/manual_chapters.hpp"
#include "libmbd/language/quantities.hpp"

namespace mbd {
namespace manual {

std::size_t characters(std::string_view utf8) {
  return static_cast<std::size_t>(std::count_if(utf8.begin(), utf8.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
}

std::string wrap(std::string_view text, std::size_t width, std::size_t indent) {
  std::string result;
  std::size_t column = indent;
  for (const std::string_view word : schema::words(text)) {
    const std::size_t size = characters(word);
    if (column > indent && column + 1 + size > width) {
      result += "\n" + std::string(indent, ' ');
      column = indent;
    } else if (column > indent) {
      result += ' ';
      ++column;
    }
    result += word;
    column += size;
  }
  return result;
}

namespace {

std::string shortest(double value) {
  return value == std::floor(value) && std::abs(value) < 1e9
             ? std::to_string(static_cast<long>(value))
             : schema::shortest(value);
}

std::string of_range(const schema::Range& range) {
  const bool below = std::isfinite(range.min), above = std::isfinite(range.max);
  if (below && above) {
    const std::string between = shortest(range.min) + " to " + shortest(range.max);
    return range.open ? " between " + shortest(range.min) + " and " + shortest(range.max)
                      : " from " + between;
  }
  if (below) return (range.open ? " > " : " >= ") + shortest(range.min);
  if (above) return (range.open ? " < " : " <= ") + shortest(range.max);
  return {};
}

std::string one_of(std::string_view words) {
  const std::vector<std::string_view> all = schema::words(words);
  std::string text;
  for (std::size_t i = 0; i < all.size(); ++i)
    text += (i == 0 ? "" : i + 1 == all.size() ? " or " : ", ") + std::string(all[i]);
  return text;
}

}  // namespace

std::string value_of(const schema::Attribute& attribute) {
  using schema::Kind;
  switch (attribute.kind) {
    case Kind::name:
      return "name";
    case Kind::text:
      return "text";
    case Kind::place:
      return "place";
    case Kind::places:
      return "two places";
    case Kind::names:
      return "words";
    case Kind::number:
      return "number" + of_range(attribute.range) +
             (attribute.choices.empty() ? "" : ", or " + std::string(attribute.choices));
    case Kind::count:
      return "whole number" + of_range(attribute.range);
    case Kind::numbers: {
      const auto [few, many] = attribute.sizes;
      const std::string sizes =
          few == many ? std::to_string(few) : fmt::format("{} or {}", few, many);
      const std::string range = of_range(attribute.range);
      return sizes + " numbers" + (range.empty() ? "" : ", each" + range);
    }
    case Kind::signal:
      return "expression of t";
    case Kind::signals:
      return "3 expressions of t";
    case Kind::fields:
      return "3 expressions of s, t";
    case Kind::law:
      return "expression of x";
    case Kind::rate_law:
      return "expression of v";
    case Kind::choice:
      return one_of(attribute.choices);
  }
  return {};
}

namespace {

using schema::Attribute;
using schema::Element;
using schema::Quantity;

constexpr std::string_view page_is_generated =
    "<!-- Written by `mbd schema --markdown` from the schema's table: change that, not this. -->\n";

// "required", "optional" or the default.
std::string fallback_of(const Attribute& attribute) {
  if (attribute.fallback == schema::required) return "required";
  if (attribute.fallback == schema::optional) return "optional";
  return std::string(attribute.fallback);
}

// Not shown: namespaces that XML editors need.
bool is_shown(const Attribute& attribute) {
  return attribute.name.find(':') == std::string_view::npos;
}

// ---- Markdown ---------------------------------------------------------------------------------

// What Markdown would take for markup, outside `code`.
std::string escaped(std::string_view text) {
  std::string result;
  bool code = false;
  for (const char c : text) {
    if (c == '`') code = !code;
    if (c == '|' || (!code && (c == '<' || c == '*' || c == '_'))) result += '\\';
    result += c;
  }
  return result;
}

std::string code(std::string_view text) { return "`" + std::string(text) + "`"; }

// The columns aligned but for the last, so that the table reads well as text too.
std::string table(std::vector<std::string> header, std::vector<std::vector<std::string>> rows) {
  std::vector<std::size_t> widths(header.size(), 3);
  rows.insert(rows.begin(), std::move(header));
  for (const auto& row : rows)
    for (std::size_t i = 0; i + 1 < row.size(); ++i)
      widths[i] = std::max(widths[i], characters(row[i]));
  std::string text;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    text += '|';
    for (std::size_t i = 0; i < rows[r].size(); ++i) {
      const std::string& cell = rows[r][i];
      text += " " + cell;
      if (i + 1 < rows[r].size()) text += std::string(widths[i] - characters(cell), ' ');
      text += " |";
    }
    text += '\n';
    if (r > 0) continue;
    for (const std::size_t width : widths) text += "|" + std::string(width + 2, '-');
    text += "|\n";
  }
  return text;
}

std::string anchor(std::string_view title) {  // as GitHub makes it of a heading
  std::string text;
  for (const char c : title) {
    if (c == ' ')
      text += '-';
    else if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-')
      text += c;
    else if (c >= 'A' && c <= 'Z')
      text += static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

std::string tags(std::span<const std::string_view> names, std::string_view none,
                 std::string_view quote) {
  std::string text;
  for (const std::string_view name : names)
    text += fmt::format("{}{}<{}>{}", text.empty() ? "" : ", ", quote, name, quote);
  return text.empty() ? std::string(none) : text;
}

// What the element may stand in and may hold.
std::string family(const Element& element, std::string_view quote) {
  const std::vector<std::string_view> parents = schema::words(element.parents);
  const std::vector<std::string_view> children = schema::children(element.name);
  std::string text;
  if (!parents.empty()) text += "Stands in " + tags(parents, "", quote) + ". ";
  if (!element.content.empty()) text += "Its text: " + std::string(element.content) + ". ";
  if (!children.empty()) text += "Holds " + tags(children, "", quote) + ". ";
  if (!text.empty()) text.pop_back();
  return text;
}

std::string rows_of_attributes(const Element& element) {
  std::vector<std::vector<std::string>> rows;
  for (const Attribute& a : element.attributes)
    if (is_shown(a))
      rows.push_back({code(a.name), std::string(a.unit), escaped(fallback_of(a)),
                      escaped(value_of(a)), escaped(a.doc)});
  return rows.empty() ? "" : table({"attribute", "unit", "default", "value", "meaning"}, rows);
}

std::string quantities_table(std::span<const Quantity> quantities) {
  std::vector<std::vector<std::string>> rows;
  for (const Quantity& q : quantities)
    rows.push_back(
        {code(q.name), std::string(q.unit), std::to_string(q.components), escaped(q.doc)});
  return table({"quantity", "unit", "columns", "meaning"}, rows);
}

// Which quantities a joint has besides its reactions, and so what can be driven.
std::string coordinates(const joint::Traits& traits) {
  if (traits.angle && traits.displacement) return "angle, displacement";
  return traits.angle ? "angle" : traits.displacement ? "displacement" : "";
}

std::string geometry(const joint::Traits& traits) {
  std::string text = traits.points == joint::Points::two        ? "a point of a and one of b"
                     : traits.points == joint::Points::one_away ? "a point, anywhere"
                                                                : "a point";
  if (traits.axis) text += ", an axis";
  if (traits.second_axis) text += ", a second axis";
  if (traits.parameter.name[0] != '\0') text += ", " + std::string(traits.parameter.name);
  return text;
}

std::string joints_table() {
  std::vector<std::vector<std::string>> rows;
  for (const schema::JointKind& joint : schema::joint_kinds())
    rows.push_back(
        {code(joint.name), geometry(joint.traits), coordinates(joint.traits), escaped(joint.doc)});
  return table({"joint", "needs", "coordinate", "what it does"}, rows) +
         "\nA coordinate can be recorded, and, where the joint leaves it free, driven.\n";
}

struct QuantitiesOf {
  std::string_view title;
  std::span<const Quantity> quantities;
};
std::vector<QuantitiesOf> all_quantities() {
  return {{"Of a place", schema::place_quantities()},
          {"Of a joint or a motion", schema::joint_quantities()},
          {"Of a spring", schema::spring_quantities()},
          {"Of the whole system", schema::system_quantities()}};
}

std::string words_table() {
  std::vector<std::vector<std::string>> rows;
  for (const Word& word : constants()) rows.push_back({code(word.name), std::string(word.doc)});
  rows.push_back({code("t"), "time [s], in loads, drives and motions"});
  rows.push_back({code("s"), "fraction of a beam's length, in distributed loads"});
  for (const Word& word : functions())
    rows.push_back({code(fmt::format("{}({})", word.name, word.arguments)), escaped(word.doc)});
  return table({"word", "meaning"}, rows);
}

// The elements of a group that this schema has.
std::vector<const Element*> elements_of(const Group& group) {
  std::vector<const Element*> result;
  if (group.elements.empty()) {
    for (const schema::JointKind& joint : schema::joint_kinds())
      result.push_back(schema::find_element(joint.name));
    return result;
  }
  for (const std::string_view name : schema::words(group.elements))
    if (const Element* const element = schema::find_element(name)) result.push_back(element);
  for (const Element& element : schema::elements())
    if (element.group == group.title) result.push_back(&element);
  return result;
}

const Group* group_of(const Element& element) {
  for (const Group& group : groups()) {
    const std::vector<const Element*> members = elements_of(group);
    if (std::find(members.begin(), members.end(), &element) != members.end()) return &group;
  }
  return nullptr;
}

std::string group_section(const Group& group) {
  std::string text = fmt::format("## {}\n\n{}\n", group.title, group.text);
  if (group.elements.empty()) text += joints_table() + "\n";
  for (const Element* element : elements_of(group)) text += to_markdown(*element) + "\n";
  if (group.elements.find("record") != std::string_view::npos)
    for (const QuantitiesOf& of : all_quantities())
      text += fmt::format("#### {}\n\n{}\n", of.title, quantities_table(of.quantities));
  return text + "For example:\n\n```xml\n" + std::string(group.example) + "```\n\n";
}

// ---- plain text -------------------------------------------------------------------------------

std::string wrapped(std::string_view text, std::size_t width, std::size_t indent) {
  return std::string(indent, ' ') + wrap(text, width, indent) + "\n";
}

// Of `parts` with what is not empty, "a, b, c".
std::string joined(std::initializer_list<std::string> parts) {
  std::string text;
  for (const std::string& part : parts)
    if (!part.empty()) text += (text.empty() ? "" : ", ") + part;
  return text;
}

std::string attributes_text(const Element& element, std::size_t width) {
  std::string text;
  for (const Attribute& a : element.attributes) {
    if (!is_shown(a)) continue;
    const bool given = a.fallback != schema::required && a.fallback != schema::optional;
    const std::string unit = a.unit.empty()       ? ""
                             : a.unit == any_unit ? "any unit"
                                                  : std::string(a.unit);
    const std::string head = joined({value_of(a) + (unit.empty() ? "" : " [" + unit + "]"),
                                     (given ? "default " : "") + fallback_of(a)});
    text += fmt::format("  {:<18} {}\n", a.name, wrap(head, width, 21));
    text += wrapped(a.doc, width, 21);
  }
  return text;
}

std::string quantities_text(std::size_t width) {
  std::string text;
  for (const QuantitiesOf& of : all_quantities()) {
    text += fmt::format("\nQuantities {}:\n", "o" + std::string(of.title.substr(1)));
    for (const Quantity& q : of.quantities)
      text += fmt::format(
          "  {:<22} {}\n", q.name,
          wrap(fmt::format("[{}] {}{}", q.unit, q.components > 1 ? "3 columns, " : "", q.doc),
               width, 25));
  }
  return text;
}

// A model with the element: of its group, or else of a chapter.
std::string_view example_with(const Element& element) {
  const std::string tag = "<" + std::string(element.name);
  const Group* const group = group_of(element);
  const std::string_view own = group == nullptr ? std::string_view() : group->example;
  if (own.find(tag) != std::string_view::npos) return own;
  for (const Chapter& chapter : chapters()) {
    constexpr std::string_view opens = "```xml\n", closes = "```\n";
    for (std::size_t at = 0; (at = chapter.text.find(opens, at)) != std::string_view::npos;) {
      at += opens.size();
      const std::size_t end = std::min(chapter.text.find(closes, at), chapter.text.size());
      const std::string_view block = chapter.text.substr(at, end - at);
      if (block.find(tag) != std::string_view::npos) return block;
    }
  }
  return own;
}

std::string indented(std::string_view block) {
  std::string text;
  while (!block.empty()) {
    const std::size_t end = std::min(block.find('\n'), block.size() - 1) + 1;
    text += "  " + std::string(block.substr(0, end));
    block.remove_prefix(end);
  }
  return text;
}

}  // namespace
}  // namespace manual

std::string to_markdown(const schema::Element& element) {
  using namespace manual;
  std::string text = fmt::format("### {}\n\n{}\n", element.name, wrap(escaped(element.doc), 100));
  if (const std::string around = family(element, "`"); !around.empty())
    text += "\n" + wrap(around, 100) + "\n";
  if (const std::string rows = rows_of_attributes(element); !rows.empty()) text += "\n" + rows;
  return text;
}

std::string to_markdown() {
  using namespace manual;
  std::string text = "# Model files\n\n" + std::string(page_is_generated) + "\n";
  text += std::string(opening()) + "\nContents: ";
  std::string links;
  const auto link = [&](std::string_view title) {
    links += fmt::format("{}[{}](#{})", links.empty() ? "" : ",\n", title, anchor(title));
  };
  for (const Chapter& chapter : chapters()) link(chapter.title);
  for (const Group& group : groups()) link(group.title);
  text += links + ".\n\n";
  for (const Chapter& chapter : chapters()) {
    text += fmt::format("## {}\n\n{}", chapter.title, chapter.text);
    if (chapter.words) text += words_table();
    text += "\n";
  }
  for (const Group& group : groups()) text += group_section(group);
  text.pop_back();
  return text;
}

std::string to_text(const schema::Element& element, std::size_t width) {
  using namespace manual;
  std::string text = fmt::format("<{}>\n", element.name) + wrapped(element.doc, width, 2);
  if (const std::string around = family(element, ""); !around.empty())
    text += wrapped(around, width, 2);
  if (std::any_of(element.attributes.begin(), element.attributes.end(), is_shown))
    text += "\nAttributes:\n" + attributes_text(element, width);
  if (element.name == "record") text += quantities_text(width);
  if (const schema::JointKind* joint = schema::find_joint_kind(element.name)) {
    const std::string of = coordinates(joint->traits);
    if (!of.empty())
      text += "\nIt has the coordinate" + std::string(of.find(',') == of.npos ? " " : "s ") + of +
              ", for records and drives.\n";
  }
  if (const std::string_view example = example_with(element); !example.empty())
    text += "\nFor example:\n" + indented(example);
  return text;
}

std::string list_of_elements(std::size_t width) {
  using namespace manual;
  std::string text;
  for (const Group& group : groups()) {
    text += std::string(group.title) + "\n";
    for (const schema::Element* element : elements_of(group))
      text += fmt::format("  {:<14} {}\n", element->name, wrap(element->doc, width, 17));
  }
  return text;
}

}  // namespace mbd
