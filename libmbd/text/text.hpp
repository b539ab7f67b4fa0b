// Small things done to text, for messages and what people read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace mbd {

// For messages: the first letters of a text that may be long or hold anything, on one line.
std::string excerpt(std::string_view text);

std::string in_quotes(std::string_view text);

// As text or attribute (in double quotes) of XML and HTML: & < > " as entities, bytes that are no UTF-8 as U+FFFD,
// without control characters.
std::string xml_escaped(std::string_view text);

// Without white space at its ends.
std::string_view trimmed(std::string_view text);

// Bytes of the UTF-8 character at `at`; 0 if there is none.
std::size_t utf8_size(std::string_view text, std::size_t at);

// Letters, not bytes: those that continue a UTF-8 character are not counted.
std::size_t letters(std::string_view text);

inline constexpr std::size_t line_width = 80;  // of what is printed for people

// A line that begins with `head`, broken at blanks to that width and gone on with `indent` blanks.
// A tab is a blank at which it is not broken.
std::string wrapped(std::string head, std::string_view words, std::size_t indent);

// By which a damaged file is known (hash.hpp).
std::uint64_t checksum(std::string_view bytes);

// The present date and time in UTC, as strftime() writes it.
std::string utc_now(const char* format);

}  // namespace mbd
