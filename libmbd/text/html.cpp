#include "libmbd/text/html.hpp"

#include <algorithm>

namespace mbd {

std::string in_script(std::string_view json) {
  std::string safe;
  safe.reserve(json.size());
  for (const char c : json)
    if (c == '<')
      safe += "\\u003c";
    else
      safe += c;
  return safe;
}

std::string filled(std::string_view html,
                   std::span<const std::pair<std::string_view, std::string_view>> words) {
  std::string page;
  while (!html.empty()) {
    const std::size_t at = html.find('@');
    page += html.substr(0, at);
    if (at == std::string_view::npos) break;
    html.remove_prefix(at);
    const auto word = std::find_if(words.begin(), words.end(), [&](const auto& entry) {
      return html.starts_with(entry.first);
    });
    page += word == words.end() ? html.substr(0, 1) : word->second;
    html.remove_prefix(word == words.end() ? 1 : word->first.size());
  }
  return page;
}

}  // namespace mbd
