// Writing results: every failure (no permission, disk full) is an Error that says which file and why. Nothing is
// written through a link, or over a directory, a device or a pipe.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace mbd {

// Makes the directory and its parents, and checks that files can be written there.
void make_directory(const std::filesystem::path& directory);

// Writes a file so that at any time either the old or the whole new one is there: under a name of its own beside it,
// then renamed. What is no regular file (a device or a pipe that is named, /dev/stdout) is written to as it is.
void write_file(const std::filesystem::path& file, std::string_view text);

// Held by one at a time, of all processes; goes with the process, however that ends. Throws Error where another has it.
class DirectoryLock {
 public:
  explicit DirectoryLock(const std::filesystem::path& directory);
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  int file_ = -1;
};

// Text appended in pieces. What is on disk always ends with the end of a piece.
class AppendedFile {
 public:
  // Takes the place of a file or a link of this name. Throws Error for anything else of that name.
  explicit AppendedFile(std::filesystem::path path);
  ~AppendedFile();
  AppendedFile(const AppendedFile&) = delete;
  AppendedFile& operator=(const AppendedFile&) = delete;

  void append(std::string_view text);
  void close();
  const std::filesystem::path& path() const { return path_; }

 private:
  [[noreturn]] void fail(const char* what);

  std::filesystem::path path_;
  int file_ = -1;
  std::uintmax_t written_ = 0;  // bytes, all of them whole pieces
};

}  // namespace mbd
