// What pages of studies share: their style, and text as HTML.
#pragma once

#include <string>
#include <string_view>

namespace mbd::study {

// Reads on a phone and in print.
extern const std::string_view page_style;

// Up to <main> and the heading; `title` and `by` are text.
std::string page_begin(std::string_view title, std::string_view by);
// The rest, with what pages do: tables of class `runs` or `orders` are sorted by a click on the head of a column (numbers
// before words), pictures grow by a double click, are shifted by dragging, and are whole again by Escape.
extern const std::string page_end;

// Each line escaped.
std::string escaped_lines(std::string_view text);

// Escaped, and numbers with an exponent are not broken at its sign.
std::string prose(std::string_view text);

}  // namespace mbd::study
