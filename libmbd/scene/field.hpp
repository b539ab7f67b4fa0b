// What a model may say of a kind of item, once: each struct of a scene lists its fields, and the schema, the reader, the
// checks of ranges, the manual, the labels and the transforms of scenes follow from its list.
//
// A list is a static member template, each_field(f), which calls f(Field(…)) for one field after the other; so it costs
// nothing where it is not walked. What an attribute is and how many numbers it has follows from the type of the member;
// the list says what the type does not.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "libmbd/core/choices.hpp"
#include "libmbd/scene/values.hpp"

namespace mbd::field {

// What the text of an attribute is. Numbers are expressions of the model's parameters, signals also of
// time t; components are separated by white space and contain none.
enum class Kind {
  name,      // of an item, unique among its like: letters, digits, _ and -
  text,      // anything
  place,     // ground, a body, or beam.start, beam.end, beam@0.5
  places,    // two places
  names,     // names of items, quantities or columns of history.csv
  number,    // one expression
  count,     // one expression, a whole number
  numbers,   // as many expressions as `sizes` says
  signal,    // one expression of t
  signals,   // three expressions of t
  fields,    // three expressions of s, the fraction of a beam's length, and t
  law,       // one expression of a displacement x
  rate_law,  // one expression of a rate v
  choice     // one of `choices`
};

// Numbers allowed; the ends belong to it unless `open`.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool open = false;
};
inline constexpr Range any{};
inline constexpr Range positive{0.0, std::numeric_limits<double>::infinity(), true};
inline constexpr Range not_negative{0.0};
inline constexpr Range unit_interval{0.0, 1.0};
inline constexpr Range at_least_one{1.0, 1e6};

// In place of a default value: what it means to leave the attribute out. `preset`: the value that the struct has.
inline constexpr std::string_view required = "(required)";
inline constexpr std::string_view optional = "(optional)";
inline constexpr std::string_view preset = "(preset)";

// A number without unit, and one that may have any.
inline constexpr std::string_view pure_number;
inline constexpr std::string_view any_unit = "any";

struct Attribute {
  std::string_view name;
  Kind kind = Kind::text;
  std::string_view unit;      // SI; pure_number, or any_unit
  std::string_view fallback;  // `required`, `optional`, or the default as one would write it
  std::string_view doc;
  Range range = any;                  // of number, count and each of numbers
  std::array<int, 2> sizes = {3, 3};  // of numbers: either
  // Separated by blanks, in the order of the enum they stand for; of a number: words it may be instead.
  std::string_view choices = {};
};

// What a field is besides what its type says.
enum Is : unsigned {
  item_name = 1,         // what others call the item by
  first_place = 1 << 1,  // of the two in one attribute, and
  second_place = 1 << 2,
  point = 1 << 3,     // of space: moves with the scene
  inertial = 1 << 4,  // along inertial axes: turns with the scene
  rotation =
      1 << 5,  // from inertial axes, as a matrix; written as a rotation vector, or row by row
  prescribed = 1 << 6,  // a law of motion, whose derivatives compile() looks at
  of_rate = 1 << 7,     // a law of a rate v
  varied = 1 << 8,      // known to so many digits only, though there is no mass in its unit
  // Of what acts along a beam or at a place: it is of one of the two, which may need it.
  along_beam = 1 << 9,
  at_place = 1 << 10,
  needed = 1 << 11,
  own_rotation = 1 << 12  // written as `rotation`, but from other axes, which move with the scene
};

// Units of the blocks of a matrix of six: of forces over displacements, mixed, and of moments over rotations.
using Blocks = std::array<std::string_view, 3>;

// Words that a number may be instead.
struct OrWords {
  std::string_view words;
};

struct About {
  Attribute attribute;  // no name: not an attribute of its own
  unsigned is = 0;
  Blocks blocks = {};

  constexpr bool has(Is what) const { return (is & what) != 0; }
  constexpr void add(Range range) { attribute.range = range; }
  constexpr void add(const Blocks& units) { blocks = units; }
  constexpr void add(OrWords or_words) { attribute.choices = or_words.words; }
  constexpr void add(Is what) {
    is |= what;
    if (what == item_name) attribute.kind = Kind::name;
    if (what == first_place) attribute.kind = Kind::places;
    if (what == of_rate) attribute.kind = Kind::rate_law;
    if (what == rotation || what == own_rotation) attribute.sizes = {3, 9};
  }
};

template <class T>
struct Plain {
  using type = T;
};
template <class T>
struct Plain<std::optional<T>> {
  using type = T;
};

template <class T>
constexpr void describe_type(Attribute& a) {
  if constexpr (std::is_same_v<T, Place>) {
    a.kind = Kind::place;
  } else if constexpr (std::is_same_v<T, std::string>) {
    a.kind = Kind::text;
  } else if constexpr (std::is_same_v<T, std::vector<std::string>>) {
    a.kind = Kind::names;
  } else if constexpr (std::is_same_v<T, double>) {
    a.kind = Kind::number;
  } else if constexpr (std::is_same_v<T, int>) {
    a.kind = Kind::count;
  } else if constexpr (std::is_same_v<T, Expression>) {
    a.kind = Kind::signal;
  } else if constexpr (std::is_same_v<T, LawVector>) {
    a.kind = Kind::signals;
  } else if constexpr (std::is_same_v<T, FieldVector>) {
    a.kind = Kind::fields;
  } else if constexpr (std::is_same_v<T, LawScene>) {
    a.kind = Kind::law;
  } else if constexpr (std::is_same_v<T, bool>) {
    a.kind = Kind::choice;
    a.choices = "off on";
  } else if constexpr (std::is_enum_v<T>) {
    a.kind = Kind::choice;
    a.choices = words_of<T>;
  } else {
    a.kind = Kind::numbers;
    if constexpr (std::is_same_v<T, Mat3>) a.sizes = {3, 6};   // symmetric
    if constexpr (std::is_same_v<T, Mat6>) a.sizes = {6, 21};  // its diagonal, or its upper half
    if constexpr (std::is_same_v<T, std::array<double, 2>>) a.sizes = {2, 2};
  }
}

// A member of an item. `more`: a Range, Is, Blocks, OrWords, or when it is there: bool(const Item&).
template <class Item, class Value>
struct Field {
  template <class... More>
  constexpr Field(Value Item::*m, std::string_view name, std::string_view unit,
                  std::string_view fallback, std::string_view doc, const More&... more)
      : member(m), about{{name, Kind::text, unit, fallback, doc}} {
    describe_type<typename Plain<Value>::type>(about.attribute);
    (add(more), ...);
  }
  // Numbers that are read and checked by what is special to the item.
  constexpr Field(Value Item::*m, const Blocks& units) : member(m), about{{}, 0, units} {}

  Value Item::*member;
  About about;
  bool (*is_there)(const Item&) = nullptr;  // null: always

 private:
  template <class More>
  constexpr void add(const More& more) {
    if constexpr (std::is_convertible_v<More, bool (*)(const Item&)>)
      is_there = more;
    else
      about.add(more);
  }
};

// A member that consists of items: an optional one, many of them, or one of several types.
template <class Item, class Value>
struct Parts {
  constexpr explicit Parts(Value Item::*m) : member(m) {}
  Value Item::*member;
};

// An attribute that is read and checked by what is special to the item.
struct Extra {
  template <class... More>
  constexpr Extra(std::string_view name, Kind kind, std::string_view unit,
                  std::string_view fallback, std::string_view doc, const More&... more)
      : about{{name, kind, unit, fallback, doc}} {
    (about.add(more), ...);
  }
  About about;
};

template <class Value, class F>
void each_in(Value& value, const F& f) {
  f(value);
}
template <class T, class F>
void each_in(std::optional<T>& value, const F& f) {
  if (value) f(*value);
}
template <class T, class F>
void each_in(const std::optional<T>& value, const F& f) {
  if (value) f(*value);
}

template <class T>
inline constexpr bool is_variant = false;
template <class... T>
inline constexpr bool is_variant<std::variant<T...>> = true;

// f(part) for what a member consists of.
template <class Value, class F>
void each_part(Value& value, const F& f) {
  if constexpr (is_variant<std::remove_const_t<Value>>)
    std::visit(f, value);
  else if constexpr (requires { value.begin(); })
    for (auto& part : value) f(part);
  else
    each_in(value, f);
}

// look(value, about) for every value that the item and its parts have; of an item that is not const they may be changed.
template <class Item, class Look>
void each_value(Item& item, const Look& look) {
  std::remove_const_t<Item>::each_field([&]<class F>(const F& field) {
    if constexpr (requires { field.is_there; }) {
      if (field.is_there == nullptr || field.is_there(item))
        each_in(item.*field.member, [&](auto& value) { look(value, field.about); });
    } else if constexpr (requires { field.member; }) {
      each_part(item.*field.member, [&](auto& part) { each_value(part, look); });
    }
  });
}

// Several functions as one, for look().
template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

// What a struct is of: its element, and of a list of them what they are called together.
struct ItemKind {
  std::string_view element;  // none: it follows from the item
  std::string_view doc;
  std::string_view plural = {};
  std::string_view names = {};      // among whom its name must differ
  bool is_an_effect = false;        // each may be left out by itself (libmbd/study/effects)
  std::string_view explained = {};  // what `mbd explain` calls them, unless it says more of them
  std::string_view group = {};      // of the manual, unless manual_chapters.cpp lists the element
};

// Among whom names must differ.
inline constexpr std::string_view of_sections = "sections", of_materials = "materials",
                                  of_layups = "layups",
                                  of_parts = "beams, bodies, joints and motions",
                                  of_springs = "springs, bushings and joint springs",
                                  of_loads = "loads, masses, drags and joint torques",
                                  of_records = "records", of_inputs = "inputs",
                                  of_functions = "functions", of_controllers = "controllers";

}  // namespace mbd::field
