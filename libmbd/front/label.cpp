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

std::string label(std::string_view element, std::string_view name) {
  return excerpt(element) + (name.empty() ? "" : " \"" + excerpt(name) + "\"");
}

std::string_view element_of(const BeamScene& beam) {
  return std::holds_alternative<Straight>(beam.line) ? "beam"
         : std::holds_alternative<Arc>(beam.line)    ? "arc"
                                                     : "curve";
}

}  // namespace mbd
