// What a model file may say: one table of elements and their attributes, from the fields of a scene's items
// (libmbd/scene/field.hpp) and from what stands in a file only. The reader, its messages, the manual and the XSD come
// from here.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "joints/traits.hpp"
#include "libmbd/language/units.hpp"
#include "libmbd/scene/field.hpp"

namespace mbd::schema {

using field::Attribute;
using field::Kind;
using field::optional;
using field::Range;
using field::required;

struct Element {
  std::string_view name;
  std::string_view parents;  // elements it may stand in, separated by blanks; empty: the root
  std::string_view doc;
  std::vector<Attribute> attributes;
  std::string_view content = {};  // what its text is, if it may have any
  std::string_view group = {};    // of the manual, of those that manual_chapters.cpp does not list
};

// Version of the format of model files: the newest that this library reads.
inline constexpr int format_version = 1;

// One for each type of joints/joint_list.hpp.
struct JointKind {
  std::string_view name, doc;
  joint::Traits traits;
};

std::span<const Element> elements();
std::span<const JointKind> joint_kinds();

const Element* find_element(std::string_view name);  // nullptr when there is none; so below
const Attribute* find_attribute(const Element& element, std::string_view name);
const JointKind* find_joint_kind(std::string_view name);

std::vector<std::string_view> children(std::string_view parent);
std::vector<std::string_view> attribute_names(const Element& element);
std::vector<std::string_view> words(std::string_view text);  // split at white space

// What a message says of a number that the attribute does not allow: "is 9, must lie between 1 and 8".
// Empty if it may be: finite, of a size that can be computed with, and in range.
std::string fault(const Attribute& attribute, double value);

// The same of a number whose size only is in question: 0, or from 1e-60 to 1e60, so that products of three or four of them,
// and their inverses, are numbers. What is beyond is a slip, and would be told as something else: as a structure that nothing
// holds.
std::string fault_of_size(double value);

// What a message says when the attribute is not given: its name, meaning and unit.
std::string missing(const Attribute& attribute);

// Names, places and positions: what <defaults> cannot give where it is required.
bool is_of_one_item(const Attribute& attribute);

// What a message says of an attribute that the element does not have, with the nearest that it has.
std::string unknown_attribute(const Element& element, std::string_view name);

// What to write instead of a usual word that the schema does not have, or not there ("clamp", "friction", "stop" of a
// run in time); empty for others.
std::string usual_word(std::string_view word);

// Letters, digits, _ and -, one at least and 200 at most: so names of columns and places can be taken apart.
bool is_name(std::string_view text);
inline constexpr std::string_view names_are =
    "a name must be made of letters, digits, _ and -, is not empty and has 200 at most";

std::string shortest(double value);  // with the fewest digits that give it back

}  // namespace mbd::schema
