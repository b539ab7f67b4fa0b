#include "libmbd/language/item.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "libmbd/language/units.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/text/spelling.hpp"

namespace mbd {
namespace {

using schema::Kind;

constexpr double largest_count = 1e9;
constexpr std::string_view places_are =
    "write ground, the name of a body, or beam.start, beam.end, beam@0.5";

const schema::Element* model_entry(const xml::Element& xml, const std::string& file) {
  const schema::Element* const found = schema::find_element(xml.name);
  if (!found || !found->parents.empty())
    throw Error(Source{file, xml.line},
                "<" + excerpt(xml.name) + ">: a model must be one <mbd name=\"…\"> element");
  return found;
}

}  // namespace

Item::Item(const xml::Element& xml, const ReadingContext& context)
    : xml_(xml),
      context_(context),
      element_(model_entry(xml, context.file)),
      around_(element_->name) {
  check(false);
}

Item::Item(const xml::Element& xml, const Item& parent) : Item(xml, parent.context_, parent) {}

// The parent's check has found the element in the schema.
Item::Item(const xml::Element& xml, const ReadingContext& context, const Item& parent)
    : xml_(xml),
      context_(context),
      element_(schema::find_element(xml.name)),
      around_(element_->name == "repeat" ? parent.around_ : element_->name) {
  check(parent.element_->name == "defaults");
}

Item::Given Item::attribute(std::string_view name) const {
  for (const xml::Attribute& a : xml_.attributes)
    if (a.name == name) return {&a, &context_.file};
  if (const auto it = context_.defaults.find(element_->name); it != context_.defaults.end())
    for (const DefaultValue& d : it->second)
      if (d.attribute.name == name) return {&d.attribute, &d.file};
  return {nullptr, nullptr};
}

bool Item::has(std::string_view name) const { return attribute(name).attribute != nullptr; }

Source Item::source_of(std::string_view name) const {
  const Given given = attribute(name);
  return given.attribute ? Source{*given.file, given.attribute->line} : source();
}

std::string Item::label() const {
  std::string_view name;
  for (const xml::Attribute& a : xml_.attributes)
    if (a.name == "name") name = a.value;
  return mbd::label(element_->name, name);
}

void Item::fail(const std::string& what) const { throw Error(source(), label() + ": " + what); }

void Item::fail(std::string_view name, const std::string& what) const {
  const xml::Attribute* const given = attribute(name).attribute;
  const std::string value = given ? "=" + in_quotes(excerpt(given->value)) : "";
  throw Error(source_of(name), label() + ": " + std::string(name) + value + ": " + what);
}

void Item::refuse(std::string_view name, const std::string& what) const {
  throw Error(source_of(name), label() + ": " + std::string(name) + " " + what);
}

// --- what may stand where ---

// What may stand in <repeat> depends on what it stands in.
std::vector<std::string_view> Item::children_here() const {
  std::vector<std::string_view> here = schema::children(element_->name);
  if (around_ != element_->name) {
    const std::vector<std::string_view> there = schema::children(around_);
    std::erase_if(here, [&there](std::string_view name) {
      return std::find(there.begin(), there.end(), name) == there.end();
    });
  }
  return here;
}

void Item::check_child(const xml::Element& child, const std::vector<std::string_view>& here) const {
  if (std::find(here.begin(), here.end(), child.name) != here.end()) return;
  const std::string name = "<" + excerpt(child.name) + ">";
  const std::string where = "<" + std::string(element_->name) + ">" +
                            (around_ == element_->name ? "" : " in <" + std::string(around_) + ">");
  const Source at{context_.file, child.line};
  const std::string usual = schema::usual_word(child.name);
  if (here.empty())
    throw Error(at, name + " cannot stand in " + where + ", which has no elements; " +
                        (usual.empty() ? "move it out" : usual));
  if (!schema::find_element(child.name)) {
    throw Error(
        at, "unknown element " + name +
                (usual.empty() ? suggest(child.name, here, "elements in " + where) : "; " + usual));
  }
  throw Error(at, name + " cannot stand in " + where + "; the elements there are: " + list(here) +
                      (usual.empty() ? "" : "; " + usual));
}

void Item::check(bool is_default) const {
  for (const xml::Attribute& a : xml_.attributes) {
    const schema::Attribute* const known = schema::find_attribute(*element_, a.name);
    if (!known)
      throw Error(Source{context_.file, a.line},
                  label() + ": " + schema::unknown_attribute(*element_, a.name));
    if (is_default && known->kind == Kind::name && known->name == "name")
      fail(a.name, "in <defaults> there is no name; each element has its own");
    if (is_default && known->fallback == schema::required && schema::is_of_one_item(*known))
      refuse(a.name, "does not belong in <defaults>; each element has its own");
  }
  if (is_default) {
    if (!xml_.children.empty() || xml_.text_line > 0)
      fail("in <defaults> an element has attributes only; leave out its contents");
    return;
  }
  for (const schema::Attribute& entry : element_->attributes)
    if (entry.fallback == schema::required && !has(entry.name)) fail(schema::missing(entry));
  if (!xml_.children.empty()) {
    const std::vector<std::string_view> here = children_here();
    for (const xml::Element& child : xml_.children) check_child(child, here);
  }
  if (xml_.text_line > 0 && element_->content.empty())
    throw Error(Source{context_.file, xml_.text_line},
                label() + ": text " + in_quotes(excerpt(schema::words(xml_.text)[0])) +
                    " … does not belong here; comments are written <!-- … -->");
}

const schema::Attribute& Item::entry_of(std::string_view name) const {
  const schema::Attribute* const found = schema::find_attribute(*element_, name);
  if (!found) throw std::logic_error("not in the schema: " + std::string(name));
  return *found;
}

// The text as written, or the default.
std::string Item::raw(std::string_view name, std::initializer_list<Kind> kinds) const {
  const schema::Attribute& entry = entry_of(name);
  if (std::find(kinds.begin(), kinds.end(), entry.kind) == kinds.end())
    throw std::logic_error("of another kind in the schema: " + std::string(name));
  if (const Given given = attribute(name); given.attribute) return given.attribute->value;
  if (entry.fallback == schema::optional || entry.fallback == schema::required)
    fail(schema::missing(entry));
  return std::string(entry.fallback);
}

void Item::try_attributes() const {
  for (const xml::Attribute& a : xml_.attributes) {
    switch (entry_of(a.name).kind) {
      case Kind::name:
      case Kind::text:
        text(a.name);
        break;
      case Kind::names:
        names(a.name);
        break;
      case Kind::place:
        place(a.name);
        break;
      case Kind::places:
        places(a.name);
        break;
      case Kind::number:
        if (!is_word(a.name)) number(a.name);
        break;
      case Kind::count:
        count(a.name);
        break;
      case Kind::numbers:
        numbers(a.name);
        break;
      case Kind::signal:
        signal(a.name);
        break;
      case Kind::signals:
        signals(a.name);
        break;
      case Kind::fields:
        fields(a.name);
        break;
      case Kind::law:
      case Kind::rate_law:
        law(a.name);
        break;
      case Kind::choice:
        chosen(a.name);
        break;
    }
  }
}

// --- words ---

std::string Item::text_of(std::string_view name) const {
  const Given given = attribute(name);
  return given.attribute ? given.attribute->value : std::string();
}

std::string Item::text(std::string_view name) const {
  return expand(name, raw(name, {Kind::text, Kind::name}));
}

std::string Item::name(std::string_view attribute) const {
  return expand(attribute, raw(attribute, {Kind::name}));
}

std::vector<std::string> Item::names(std::string_view attribute) const {
  const std::string all = expand(attribute, raw(attribute, {Kind::names}));
  std::vector<std::string> result;
  for (const std::string_view word : schema::words(all)) {
    if (std::find(result.begin(), result.end(), word) != result.end())
      refuse(attribute, "hold " + in_quotes(excerpt(word)) + " twice; leave one out");
    result.emplace_back(word);
  }
  if (result.empty()) refuse(attribute, "are missing; give one at least");
  return result;
}

std::size_t Item::chosen(std::string_view name) const {
  const std::string word = raw(name, {Kind::choice});
  const std::vector<std::string_view> choices = schema::words(entry_of(name).choices);
  const auto it = std::find(choices.begin(), choices.end(), word);
  if (it == choices.end()) fail(name, "no such choice" + suggest(word, choices, "choices"));
  return static_cast<std::size_t>(it - choices.begin());
}

// {expression} becomes its integer value.
std::string Item::expand(std::string_view name, std::string_view text) const {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t open = std::min(text.find('{', at), text.size());
    if (text.substr(at, open - at).find('}') != std::string_view::npos)
      fail(name, "} without {; an expression in a name is written {i+1}");
    result += text.substr(at, open - at);
    if (open == text.size()) break;
    const std::size_t close = text.find('}', open);
    if (close == std::string_view::npos)
      fail(name, "{ without }; an expression in a name is written {i+1}");
    const double value = evaluate(name, text.substr(open + 1, close - open - 1));
    if (value != std::floor(value) || std::abs(value) > largest_count)
      fail(name, excerpt(text.substr(open, close - open + 1)) + " is " + schema::shortest(value) +
                     ", must be a whole number");
    result += std::to_string(static_cast<long>(value));
    at = close + 1;
  }
  return result;
}

// --- numbers ---

double Item::factor(std::string_view name, std::string_view unit, std::string_view wanted) const {
  if (wanted == any_unit && context_.parameters.contains(unit))
    fail(name, in_quotes(unit) + " is a parameter and may be a unit: write a product with *");
  try {
    return unit_factor(unit, wanted);
  } catch (const Error& error) {
    // A moment per angle may say so.
    if (name.starts_with("angular_stiffness") || name.starts_with("angular_damping")) try {
        return unit_factor(unit, std::string(wanted) + "/rad");
      } catch (const Error&) {  // the first is told
      }
    fail(name, error.what());
  }
}

// "L mm" where L is 6000 mm already would be converted twice.
void Item::check_one_unit(std::string_view name, std::string_view text,
                          std::string_view unit) const {
  for (const std::string_view word : words_of(text))
    if (const auto it = context_.units.find(word); it != context_.units.end())
      fail(name, in_quotes(it->first) + " was given in " + it->second +
                     " and is in SI units now; leave out the unit " + in_quotes(unit) + " here");
}

std::vector<std::string_view> Item::words_of(std::string_view expression) {
  const auto in_word = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  };
  std::vector<std::string_view> result;
  for (std::size_t i = 0; i < expression.size();) {
    std::size_t end = i;
    while (end < expression.size() && in_word(expression[end])) ++end;
    if (end > i) result.push_back(expression.substr(i, end - i));
    i = std::max(end, i + 1);
  }
  return result;
}

// The text of one number or signal, with the unit that follows it converted to `unit`.
Expression Item::parse(std::string_view name, std::string_view text, Variables variables,
                       std::string_view unit, const Parameters& parameters) const {
  const auto expression = [&](std::string_view of) {
    try {
      return Expression::parse(of, parameters, variables);
    } catch (const Error& error) {
      const schema::Attribute* const entry = schema::find_attribute(*element_, name);
      const bool words = entry && entry->kind == Kind::number && !entry->choices.empty();
      fail(name, error.what() +
                     (words ? "; besides a number it may be: " + std::string(entry->choices) : ""));
    }
  };
  const NumberAndUnit parts = split_unit(text);
  if (parts.unit.empty()) return expression(text);
  Expression number = expression(parts.number);
  check_one_unit(name, parts.number, parts.unit);
  const double scale = factor(name, parts.unit, unit);
  if (scale == 1.0) return number;
  return expression("(" + std::string(parts.number) + ")*" + schema::shortest(scale));
}

double Item::evaluate(std::string_view name, std::string_view text, std::string_view unit) const {
  return parse(name, text, Variables::none, unit).value();
}

double Item::any_number(std::string_view name) const {
  return evaluate(name, raw(name, {Kind::number, Kind::count}), entry_of(name).unit);
}

bool Item::is_word(std::string_view name) const {
  const std::string text = raw(name, {Kind::number});
  const std::vector<std::string_view> parts = schema::words(text);
  const std::vector<std::string_view> known = schema::words(entry_of(name).choices);
  if (parts.size() != 1 || std::find(known.begin(), known.end(), parts[0]) == known.end())
    return false;
  if (context_.parameters.contains(parts[0]))
    fail(name, "is a word of this attribute and a parameter of the model; write (" +
                   std::string(parts[0]) + ") for the parameter, or give it another name");
  return true;
}

double Item::number(std::string_view name) const {
  const double value = any_number(name);
  if (const std::string fault = schema::fault(entry_of(name), value); !fault.empty())
    refuse(name, fault);
  return value;
}

int Item::count(std::string_view name) const {
  const double value = number(name);
  if (value != std::floor(value) || std::abs(value) > largest_count)
    refuse(name, "is " + schema::shortest(value) + ", must be a whole number");
  return static_cast<int>(value);
}

// As many components as one of `sizes` says, or one more, which is the unit of all.
std::vector<Item::Component> Item::components(std::string_view name, std::string_view all,
                                              std::initializer_list<int> sizes) const {
  std::vector<std::string_view> parts = schema::words(all);
  const auto fits = [&](std::size_t size) {
    return std::find(sizes.begin(), sizes.end(), static_cast<int>(size)) != sizes.end();
  };
  std::string_view unit;
  if (!parts.empty() && fits(parts.size() - 1) && !fits(parts.size()) &&
      reads_like_unit(parts.back())) {
    unit = parts.back();
    parts.pop_back();
  }
  if (!fits(parts.size())) {
    std::string allowed;
    for (const int size : sizes)
      if (const std::string text = std::to_string(size); allowed.empty())
        allowed = text;
      else if (allowed != text)
        allowed += " or " + text;
    const bool with_unit = !parts.empty() && unit.empty() && reads_like_unit(parts.back()) &&
                           !context_.parameters.contains(parts.back());
    const std::size_t size = parts.size() - (with_unit ? 1 : 0);
    fail(name,
         "has " + std::to_string(size) + (size == 1 ? " component" : " components") +
             (with_unit ? " and " + in_quotes(excerpt(parts.back())) : "") + ", must have " +
             allowed +
             "; they are separated by blanks and contain none, and a unit stands last or directly "
             "behind its number");
  }
  std::vector<Component> result;
  for (const std::string_view part : parts) {
    const NumberAndUnit own = split_unit(part);
    if (!own.unit.empty() && !unit.empty())
      fail(name, in_quotes(excerpt(part)) + " has a unit, and " + in_quotes(unit) +
                     " follows all components; leave one of them out");
    result.push_back({own.number, own.unit.empty() ? unit : own.unit});
  }
  return result;
}

std::vector<double> Item::numbers(std::string_view name) const {
  const schema::Attribute& entry = entry_of(name);
  const std::string all = raw(name, {Kind::numbers});
  std::vector<double> values;
  for (const auto& [text, unit] : components(name, all, {entry.sizes[0], entry.sizes[1]})) {
    double value = evaluate(name, text);
    if (!unit.empty()) {
      check_one_unit(name, text, unit);
      value *= factor(name, unit, entry.unit);
    }
    if (const std::string fault = schema::fault(entry, value); !fault.empty())
      refuse(name, "component " + std::to_string(values.size() + 1) + " " + fault);
    values.push_back(value);
  }
  return values;
}

Vec3 Item::vector(std::string_view name) const {
  const std::vector<double> values = numbers(name);
  return {values[0], values[1], values[2]};
}

Mat3 Item::symmetric(std::string_view name) const {
  std::vector<double> v = numbers(name);
  v.resize(6, 0.0);
  Mat3 matrix;
  matrix << v[0], v[3], v[4], v[3], v[1], v[5], v[4], v[5], v[2];
  return matrix;
}

Mat3 Item::orientation(std::string_view name) const {
  const std::vector<double> v = numbers(name);
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
  return R;
}

Expression Item::signal(std::string_view name) const {
  return parse(name, raw(name, {Kind::signal}), Variables::time, entry_of(name).unit);
}

Expression Item::sampled(std::string_view name, const Parameters& parameters) const {
  return sampled(name, raw(name, {Kind::signal}), parameters);
}

Expression Item::sampled(std::string_view name, std::string_view text,
                         const Parameters& parameters) const {
  return parse(name, text, Variables::sampled, any_unit, parameters);
}

std::array<Expression, 3> Item::signals(std::string_view name) const {
  const std::string all = raw(name, {Kind::signals});
  const std::vector<Component> parts = components(name, all, {3});
  const auto part = [&](std::size_t i) {
    const std::string text = std::string(parts[i].text) +
                             (parts[i].unit.empty() ? "" : " " + std::string(parts[i].unit));
    return parse(name, text, Variables::time, entry_of(name).unit);
  };
  return {part(0), part(1), part(2)};
}

Expression Item::law(std::string_view name) const {
  const schema::Attribute& entry = entry_of(name);
  return parse(name, raw(name, {Kind::law, Kind::rate_law}),
               entry.kind == Kind::law ? Variables::x : Variables::v, entry.unit);
}

// Tried at one place, for their grammar.
std::array<FieldExpression, 3> Item::fields(std::string_view name) const {
  const std::string all = raw(name, {Kind::fields});
  const std::vector<Component> parts = components(name, all, {3});
  const auto part = [&](std::size_t i) {
    const auto tried = [&](double scale) {
      FieldExpression field{std::string(parts[i].text), context_.parameters, scale};
      try {
        field.at(0.4567);  // where few have poles
      } catch (const Error& error) {
        fail(name, error.what());
      }
      return field;
    };
    FieldExpression field = tried(1.0);
    if (parts[i].unit.empty()) return field;
    check_one_unit(name, parts[i].text, parts[i].unit);
    return tried(factor(name, parts[i].unit, entry_of(name).unit));
  };
  return {part(0), part(1), part(2)};
}

// --- places ---

Place Item::place(std::string_view name) const {
  const std::string all = expand(name, raw(name, {Kind::place}));
  const std::vector<std::string_view> parts = schema::words(all);
  if (parts.size() != 1) fail(name, "must be one place: " + std::string(places_are));
  return place(name, parts[0]);
}

std::pair<Place, Place> Item::places(std::string_view name) const {
  const std::string all = expand(name, raw(name, {Kind::places}));
  const std::vector<std::string_view> parts = schema::words(all);
  if (parts.size() != 2)
    fail(name, "has " + std::to_string(parts.size()) +
                   " places, must have two: " + std::string(places_are));
  return {place(name, parts[0]), place(name, parts[1])};
}

Place Item::place(std::string_view attribute, std::string_view text) const {
  Place result;
  if (text == "ground") return result;
  const std::size_t end = std::min(text.find_first_of(".@"), text.size());
  result.name = text.substr(0, end);
  const std::string_view rest = text.substr(end);
  const auto no_place = [&]() {
    fail(attribute, in_quotes(excerpt(text)) + " is not a place; " + std::string(places_are));
  };
  if (!schema::is_name(result.name)) no_place();
  result.kind = rest.empty() ? Place::Kind::body : Place::Kind::beam;
  if (rest == ".end")
    result.parameter = 1.0;
  else if (rest.starts_with('@'))
    result.parameter = evaluate(attribute, rest.substr(1));
  else if (!rest.empty() && rest != ".start")
    no_place();
  return result;
}

}  // namespace mbd
