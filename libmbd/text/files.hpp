// Writing results: every failure (no permission, disk full) is an Error that says which file and why.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string_view>

namespace mbd {

// Makes the directory and its parents, and checks that files can be written there.
void make_directory(const std::filesystem::path& directory);

// Writes a file so that at any time either the old or the whole new one is there.
void write_file(const std::filesystem::path& file, std::string_view text);

// Text appended in pieces. What is on disk always ends with the end of a piece.
class AppendedFile {
 public:
  explicit AppendedFile(std::filesystem::path path);  // empties an existing file
  ~AppendedFile();
  AppendedFile(const AppendedFile&) = delete;
  AppendedFile& operator=(const AppendedFile&) = delete;

  void append(std::string_view text);
  void close();
  const std::filesystem::path& path() const { return path_; }

 private:
  [[noreturn]] void fail(const char* what);

  std::filesystem::path path_;
  std::FILE* file_ = nullptr;
  std::uintmax_t written_ = 0;  // bytes, all of them whole pieces
};

}  // namespace mbd
