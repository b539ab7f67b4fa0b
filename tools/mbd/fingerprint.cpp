#include "tools/mbd/fingerprint.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "libmbd/results/build_facts.hpp"

namespace mbd {

std::string fingerprint(const std::vector<std::string>& files,
                        const std::vector<std::string>& set) {
  std::string all;
  for (const auto& [name, value] : to_lines(build_facts())) all += name + "=" + value + ";";
  std::size_t sum = 0;
  for (const std::string& file : files) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    sum = sum * 31 + std::hash<std::string>()(text.str());
  }
  for (const std::string& one : set) all += one + ";";
  std::error_code code;  // the commit does not tell builds of a changed tree apart
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", code);
  all += fmt::format("{} {}", std::filesystem::file_size(self, code),
                     std::filesystem::last_write_time(self, code).time_since_epoch().count());
  return fmt::format("{:016x} {}", sum, all);
}

}  // namespace mbd
