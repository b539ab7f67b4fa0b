#include "libmbd/front/label.hpp"

#include <algorithm>

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
  return size;
}

std::string label(std::string_view element, std::string_view name) {
  return excerpt(element) + (name.empty() ? "" : " \"" + excerpt(name) + "\"");
}

std::string_view element_of(const BeamScene& beam) {
  return std::holds_alternative<Straight>(beam.line) ? "beam"
         : std::holds_alternative<Arc>(beam.line)    ? "arc"
                                                     : "curve";
}

}  // namespace mbd
