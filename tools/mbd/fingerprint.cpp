#include "tools/mbd/fingerprint.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>

#include "libmbd/material/scene_files.hpp"
#include "libmbd/results/build_facts.hpp"

namespace mbd {

std::string fingerprint(const std::vector<std::string>& files,
                        const std::vector<std::string>& set) {
  std::string all;
  for (const auto& [name, value] : to_lines(build_facts())) all += name + "=" + value + ";";
  std::uint64_t sum = 0;
  for (const std::string& file : files) sum = sum * 31 + checksum_of_file(file);
  for (const std::string& one : set) all += one + ";";
  // The commit does not tell builds of a changed tree apart. The library may be a file of its own.
  const auto add = [&](const std::filesystem::path& file) {
    std::error_code code;
    all += fmt::format("{} {};", std::filesystem::file_size(file, code),
                       std::filesystem::last_write_time(file, code).time_since_epoch().count());
  };
  std::error_code code;
  add(std::filesystem::read_symlink("/proc/self/exe", code));
  add(library_file());
  return fmt::format("{:016x} {}", sum, all);
}

}  // namespace mbd
