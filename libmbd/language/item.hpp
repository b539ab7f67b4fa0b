// One element of a model file together with its entry in the schema: what stands in it is compared with
// the schema when it is made; the getters turn text into values.
#pragma once

#include <array>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libmbd/core/expression.hpp"
#include "libmbd/language/schema.hpp"
#include "libmbd/language/xml.hpp"
#include "libmbd/scene/field_expression.hpp"
#include "libmbd/scene/scene.hpp"

namespace mbd {

// What an item is read with: the file it stands in, the parameters so far, and the values that <defaults>
// gave for attributes of each kind of element, with their files.
struct DefaultValue {
  std::string file;
  xml::Attribute attribute;
};
struct ReadingContext {
  std::string file;
  const Parameters& parameters;
  const std::map<std::string, std::vector<DefaultValue>, std::less<>>& defaults;
  // Parameters whose values were given with a unit, and it: no second unit may follow them.
  const std::map<std::string, std::string, std::less<>>& units;
};

// Every getter throws Error with file, line, item, what is wrong and what to do.
class Item {
 public:
  // The root of a model.
  Item(const xml::Element& xml, const ReadingContext& context);
  // A child of `parent`. In <defaults> it must have no content and no name, and may leave out anything.
  Item(const xml::Element& xml, const Item& parent);
  // As if it stood in another context.
  Item(const xml::Element& xml, const ReadingContext& context, const Item& parent);

  const xml::Element& xml() const { return xml_; }
  const schema::Element& element() const { return *element_; }
  const ReadingContext& context() const { return context_; }
  Source source() const { return {context_.file, xml_.line}; }
  bool has(std::string_view name) const;  // given here or by <defaults>

  [[noreturn]] void fail(const std::string& what) const;
  // Of an attribute: "beam "b": metric="geo": …".
  [[noreturn]] void fail(std::string_view name, const std::string& what) const;
  // The same without its text, as messages about a Scene are: "beam "b": order is 9, …".
  [[noreturn]] void refuse(std::string_view name, const std::string& what) const;

  std::string text_of(std::string_view name) const;  // as written
  std::string text(std::string_view name) const;
  std::string name(std::string_view attribute = "name") const;
  std::vector<std::string> names(std::string_view attribute) const;
  double number(std::string_view name) const;      // in range, SI
  double any_number(std::string_view name) const;  // of any range, SI
  bool is_word(std::string_view name) const;       // a word that the number may be instead
  int count(std::string_view name) const;
  std::vector<double> numbers(std::string_view name) const;
  Vec3 vector(std::string_view name) const;
  Mat3 symmetric(std::string_view name) const;    // from xx yy zz [xy xz yz]
  Mat3 orientation(std::string_view name) const;  // from a rotation vector or a matrix
  Expression signal(std::string_view name) const;
  // The same of a controller, whose states the parameters know as their own; and of one of several, `text`.
  Expression sampled(std::string_view name, const Parameters& parameters) const;
  Expression sampled(std::string_view name, std::string_view text,
                     const Parameters& parameters) const;
  std::array<Expression, 3> signals(std::string_view name) const;
  std::array<FieldExpression, 3> fields(std::string_view name) const;
  Expression law(std::string_view name) const;  // of x, or of v
  Place place(std::string_view name) const;
  std::pair<Place, Place> places(std::string_view name) const;
  template <class Enum>
  Enum choice(std::string_view name) const {  // choices are in the order of the enum
    return static_cast<Enum>(chosen(name));
  }

  // The names in an expression: runs of letters, digits and _.
  static std::vector<std::string_view> words_of(std::string_view expression);

  // Reads every attribute given here and throws away what it says.
  void try_attributes() const;

  // A constant expression of an attribute or (name "text") of the element's text.
  double evaluate(std::string_view name, std::string_view text,
                  std::string_view unit = pure_number) const;

 private:
  struct Given {
    const xml::Attribute* attribute;
    const std::string* file;
  };
  Given attribute(std::string_view name) const;
  Source source_of(std::string_view name) const;
  const schema::Attribute& entry_of(std::string_view name) const;
  std::string label() const;
  void check(bool is_default) const;
  std::vector<std::string_view> children_here() const;
  void check_child(const xml::Element& child, const std::vector<std::string_view>& here) const;
  std::string raw(std::string_view name, std::initializer_list<schema::Kind> kinds) const;
  std::string expand(std::string_view name, std::string_view text) const;
  std::size_t chosen(std::string_view name) const;
  Expression parse(std::string_view name, std::string_view text, Variables variables,
                   std::string_view unit) const {
    return parse(name, text, variables, unit, context_.parameters);
  }
  Expression parse(std::string_view name, std::string_view text, Variables variables,
                   std::string_view unit, const Parameters& parameters) const;
  double factor(std::string_view name, std::string_view unit, std::string_view wanted) const;
  void check_one_unit(std::string_view name, std::string_view text, std::string_view unit) const;
  struct Component {
    std::string_view text, unit;  // unit: written after it, after all of them, or empty
  };
  std::vector<Component> components(std::string_view name, std::string_view all,
                                    std::initializer_list<int> sizes) const;
  Place place(std::string_view attribute, std::string_view text) const;

  const xml::Element& xml_;
  const ReadingContext& context_;
  const schema::Element* element_;
  std::string_view around_;  // the nearest element around its contents that is no <repeat>
};

}  // namespace mbd
