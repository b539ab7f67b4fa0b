// history.csv but for the line that says which run it is of: what two runs have in common.
#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace mbd::test {

inline std::string history_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (const std::size_t at = text.find("# run: "); at != std::string::npos)
    text.erase(at, text.find('\n', at) + 1 - at);
  return text;
}

}  // namespace mbd::test
