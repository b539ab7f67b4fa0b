#include "libmbd/text/files.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <system_error>
#include <thread>

#include "libmbd/core/error.hpp"

namespace mbd {
namespace {

namespace fs = std::filesystem;

std::string reason() { return errno ? std::strerror(errno) : "unknown reason"; }

// A new file, or -1 with errno: never one that is there, never through a link.
int open_new(const fs::path& path) {
  return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
}

// False with errno if not all of it could be written.
bool write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t size = ::write(file, text.data(), text.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(size));
  }
  return true;
}

// Beside the file, of this process: two that write the same file do not share it.
fs::path part_of(const fs::path& file) {
  return file.parent_path() /
         ("." + file.filename().string() + "." + std::to_string(::getpid()) + ".part");
}

}  // namespace

void make_directory(const fs::path& directory) {
  std::error_code code;
  fs::create_directories(directory, code);
  if (code || !fs::is_directory(directory, code))
    throw Error(directory.string() + ": cannot make this directory for results" +
                (code ? " (" + code.message() + ")" : ": there is a file of this name") +
                "; choose another with --out");
  const fs::path probe = part_of(directory / "mbd_write_test");
  fs::remove(probe, code);
  errno = 0;
  const int file = open_new(probe);
  if (file < 0)
    throw Error(directory.string() + ": cannot write here (" + reason() +
                "); choose another directory with --out");
  ::close(file);
  fs::remove(probe, code);
}

void write_file(const fs::path& file, std::string_view text) {
  std::error_code code;
  // Of links only those of the system itself are followed: /dev/stdout is one.
  const bool follows = file.string().starts_with("/dev/");
  const fs::file_status there = follows ? fs::status(file, code) : fs::symlink_status(file, code);
  if (fs::is_character_file(there) || fs::is_fifo(there) || fs::is_socket(there)) {
    const int device = ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
    const bool written = device >= 0 && write_all(device, text);
    const std::string why = reason();
    if (device >= 0) ::close(device);
    if (!written) throw Error(file.string() + ": cannot be written (" + why + ")");
    return;
  }
  const fs::path part = part_of(file);
  try {
    AppendedFile out(part);
    out.append(text);
    out.close();
  } catch (const Error& error) {
    fs::remove(part, code);
    const std::string what = error.what();  // begins with the part's name, which nobody knows
    throw Error(file.string() + what.substr(std::min(part.string().size(), what.size())));
  }
  fs::rename(part, file, code);
  if (!code) return;
  const std::string why = code.message();
  fs::remove(part, code);
  throw Error(file.string() + ": cannot be written (" + why + ")");
}

DirectoryLock::DirectoryLock(const fs::path& directory)
    : file_(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  // A system of files that knows no locks does without. Who only asks whether it is locked has it for a moment.
  constexpr int tries = 3;
  for (int i = 0; i < tries; ++i) {
    if (i > 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (file_ < 0 || ::flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  }
  ::close(file_);
  throw Error(directory.string() +
              ": another run is writing its results here; wait for it, or choose another directory "
              "with --out");
}

DirectoryLock::~DirectoryLock() {
  if (file_ >= 0) ::close(file_);
}

AppendedFile::AppendedFile(fs::path path) : path_(std::move(path)) {
  std::error_code code;
  const fs::file_status there = fs::symlink_status(path_, code);
  if (fs::exists(there) && !fs::is_regular_file(there) && !fs::is_symlink(there))
    throw Error(path_.string() +
                ": cannot be written (it is a directory, a device or a pipe, which results do not "
                "replace)");
  fs::remove(path_, code);  // a link, not what it shows to
  errno = 0;
  file_ = open_new(path_);
  if (file_ < 0) fail("cannot be written");
}

AppendedFile::~AppendedFile() {
  if (file_ >= 0) ::close(file_);
}

void AppendedFile::append(std::string_view text) {
  errno = 0;
  if (!write_all(file_, text)) fail("cannot be written");
  written_ += text.size();
}

void AppendedFile::close() {
  errno = 0;
  const int file = file_;
  file_ = -1;
  if (file >= 0 && ::close(file) != 0) fail("cannot be closed");
}

void AppendedFile::fail(const char* what) {
  const std::string why = reason();
  std::error_code code;
  if (file_ >= 0) {  // take back a piece that is there in part
    ::close(file_);
    file_ = -1;
    if (written_ > 0)
      std::filesystem::resize_file(path_, written_, code);
    else
      std::filesystem::remove(path_, code);
  }
  throw Error(path_.string() + ": " + what + " (" + why + ")" +
              (written_ > 0 ? "; it holds what was written before" : ""));
}

}  // namespace mbd
