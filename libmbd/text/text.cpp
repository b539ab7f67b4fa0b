#include "libmbd/text/text.hpp"

#include <algorithm>
#include <ctime>
#include <iterator>

#include "libmbd/core/hash.hpp"

namespace mbd {

std::string excerpt(std::string_view text) {
  constexpr std::size_t most = 80;
  std::size_t size = std::min(text.size(), most);
  while (size < text.size() && (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U) ++size;
  std::string result(text.substr(0, size));
  for (char& c : result)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  return result + (size < text.size() ? "…" : "");
}

std::size_t utf8_size(std::string_view text, std::size_t at) {
  const auto first = static_cast<unsigned char>(text[at]);
  const std::size_t size = first < 0x80                    ? 1
                           : first >= 0xC2 && first < 0xE0 ? 2
                           : first >= 0xE0 && first < 0xF0 ? 3
                           : first >= 0xF0 && first < 0xF5 ? 4
                                                           : 0;
  if (size == 0 || at + size > text.size()) return 0;
  for (std::size_t k = 1; k < size; ++k)
    if ((static_cast<unsigned char>(text[at + k]) & 0xC0U) != 0x80U) return 0;
  // Longer than need be, halves of letters of UTF-16, and beyond the last letter.
  const unsigned second = size > 1 ? static_cast<unsigned char>(text[at + 1]) : 0;
  if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
      (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F))
    return 0;
  return size;
}

std::string in_quotes(std::string_view text) { return "\"" + std::string(text) + "\""; }

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n\f\v";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::size_t letters(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
}

std::string wrapped(std::string head, std::string_view words, std::size_t indent) {
  std::string text = std::move(head);
  std::size_t column = letters(text);
  bool first = true;  // word of its line
  for (std::size_t at = 0; at < words.size();) {
    const std::size_t end = std::min(words.find_first_of(" \n", at), words.size());
    const std::string_view word = words.substr(at, end - at);
    at = end + 1;
    if (word.empty()) continue;
    if (!first && column + 1 + letters(word) > line_width) {
      text.append("\n").append(indent, ' ');
      column = indent;
      first = true;
    }
    if (!first) {
      text += ' ';
      ++column;
    }
    text += word;
    std::replace(text.end() - std::ssize(word), text.end(), '\t', ' ');
    column += letters(word);
    first = false;
  }
  return text + "\n";
}

std::string xml_escaped(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t size = utf8_size(text, i);
    if (size != 1) {  // a letter, or a byte that is none
      result += size == 0 ? std::string_view("\xEF\xBF\xBD") : text.substr(i, size);
      i += std::max<std::size_t>(1, size);
      continue;
    }
    const char c = text[i++];
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20) result += c;
    }
  }
  return result;
}

std::uint64_t checksum(std::string_view bytes) {
  Hash hash;
  hash.add(bytes.data(), bytes.size());
  return hash.value();
}

std::string utc_now(const char* format) {
  const std::time_t time = std::time(nullptr);
  char text[32] = "";
  std::strftime(text, sizeof text, format, std::gmtime(&time));
  return text;
}

}  // namespace mbd
