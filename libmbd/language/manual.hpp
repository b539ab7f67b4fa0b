// The manual of model files, made from the schema: a Markdown page, a page for each element, and a grammar
// for XML editors. models/MANUAL.md and models/mbd.xsd are what these functions give.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "libmbd/language/schema.hpp"

namespace mbd {

// The whole manual, in Markdown (GitHub's): how a model is written, every element with its attributes, the
// joints, the quantities of records, and a whole model for each group of elements.
std::string to_markdown();

// The section of one element of schema::elements(), in Markdown.
std::string to_markdown(const schema::Element& element);

// The page of one element of schema::elements() for a terminal: plain text, at most `width` columns where
// words allow it.
std::string to_text(const schema::Element& element, std::size_t width = 80);

// All elements by group with a line on each, plain text.
std::string list_of_elements(std::size_t width = 80);

// XML Schema 1.0 of models whose elements these are; the first is the root. It accepts every model that is
// right and refuses misspelled elements, attributes and choices, elements out of place, and missing
// attributes: of those that <defaults> may give, only names, places and positions. Numbers are expressions, which it does not
// look into.
std::string to_xsd(std::span<const schema::Element> elements = schema::elements());

namespace manual {

// What the text of an attribute is: "number > 0", "3 or 6 numbers", "linear or smooth".
std::string value_of(const schema::Attribute& attribute);

// Lines of words, at most `width` characters of UTF-8 each, all but the first after `indent` blanks.
std::string wrap(std::string_view text, std::size_t width, std::size_t indent = 0);

std::size_t characters(std::string_view utf8);

}  // namespace manual
}  // namespace mbd
