#include "libmbd/text/tables.hpp"

#include <algorithm>

#include "libmbd/text/text.hpp"

namespace mbd::study {

std::string capital(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z')
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string one_line(std::string_view text) {
  std::string line(text);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  return line;
}

void paragraph(std::string& text, std::string_view name, std::string_view words) {
  constexpr std::size_t indent = 11;
  std::string head(name);
  if (letters(name) < indent) head.append(indent - letters(name), ' ');
  text += wrapped(std::move(head), words, indent);
}

void table(std::string& text, const std::vector<std::vector<std::string>>& rows) {
  constexpr std::size_t indent = 2, gap = 2;
  std::vector<std::size_t> size;
  for (const auto& row : rows)
    for (std::size_t i = 0; i + 1 < row.size(); ++i) {
      if (size.size() <= i) size.push_back(0);
      size[i] = std::max(size[i], letters(row[i]));
    }
  for (const auto& row : rows) {
    std::string head(indent, ' ');
    for (std::size_t i = 0; i + 1 < row.size(); ++i)
      head.append(size[i] - letters(row[i]), ' ').append(row[i]).append(gap, ' ');
    const std::size_t width = letters(head);
    text += wrapped(std::move(head), row.back(), width);
  }
}

std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string markdown_escaped(std::string_view text) {
  std::string result;
  for (const char c : xml_escaped(one_line(text))) {
    if (std::string_view("\\`*_[]|#~").find(c) != std::string_view::npos) result += '\\';
    result += c;
  }
  return result;
}

}  // namespace mbd::study
