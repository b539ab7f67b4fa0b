#include "libmbd/text/files.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <system_error>

#include "libmbd/core/error.hpp"

namespace mbd {
namespace {

namespace fs = std::filesystem;

std::string reason() { return errno ? std::strerror(errno) : "unknown reason"; }

}  // namespace

void make_directory(const fs::path& directory) {
  std::error_code code;
  fs::create_directories(directory, code);
  if (code || !fs::is_directory(directory, code))
    throw Error(directory.string() + ": cannot make this directory for results" +
                (code ? " (" + code.message() + ")" : ": there is a file of this name") +
                "; choose another with --out");
  const fs::path probe = directory / ".mbd_write_test";
  errno = 0;
  std::FILE* const file = std::fopen(probe.c_str(), "wb");
  if (!file)
    throw Error(directory.string() + ": cannot write here (" + reason() +
                "); choose another directory with --out");
  std::fclose(file);
  fs::remove(probe, code);
}

void write_file(const fs::path& file, std::string_view text) {
  fs::path part = file;
  part += ".part";
  std::error_code code;
  try {
    AppendedFile out(part);
    out.append(text);
    out.close();
  } catch (const Error&) {
    fs::remove(part, code);
    throw;
  }
  fs::rename(part, file, code);
  if (!code) return;
  const std::string why = code.message();
  fs::remove(part, code);
  throw Error(file.string() + ": cannot be written (" + why + ")");
}

AppendedFile::AppendedFile(fs::path path) : path_(std::move(path)) {
  errno = 0;
  file_ = std::fopen(path_.c_str(), "wb");
  if (!file_) fail("cannot be written");
  std::setvbuf(file_, nullptr, _IONBF,
               0);  // pieces are large; what is written is on its way to disk
}

AppendedFile::~AppendedFile() {
  if (file_) std::fclose(file_);
}

void AppendedFile::append(std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail("cannot be written");
  written_ += text.size();
}

void AppendedFile::close() {
  errno = 0;
  std::FILE* const file = file_;
  file_ = nullptr;
  if (file && std::fclose(file) != 0) fail("cannot be closed");
}

void AppendedFile::fail(const char* what) {
  const std::string why = reason();
  std::error_code code;
  if (file_) {  // take back a piece that is there in part
    std::fclose(file_);
    file_ = nullptr;
    std::filesystem::resize_file(path_, written_, code);
  }
  throw Error(path_.string() + ": " + what + " (" + why + ")" +
              (written_ > 0 ? "; it holds what was written before" : ""));
}

}  // namespace mbd
