// Faults of the system, one at a time: preloaded into a program (LD_PRELOAD), it lets one call fail and no other.
//   MBD_FAULT="write NAME N"   the Nth write(2) to a file whose name holds NAME: ENOSPC
//   MBD_FAULT="open NAME N"    the Nth open(2) to write it: EMFILE
//   MBD_FAULT="rename NAME N"  the Nth rename(2) to it: EIO
//   MBD_FAULT="mkdir NAME N"   the Nth mkdir(2) of it: EACCES
//   MBD_FAULT="malloc NAME N"  the Nth allocation after a file whose name holds NAME was opened by fopen: no memory
// N is counted from 1; with 0 none fails, and how many there were is written into the file MBD_FAULT_COUNT at the end. NAME *
// is any file but devices, pipes and what the system shows of itself. Only calls that the program makes itself are seen, not those inside
// of libc.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

struct Fault {
  char call[16] = {}, name[128] = {};
  long at = -1;  // none
};

const Fault& fault() {
  static const Fault read = [] {
    Fault f;
    if (const char* const text = std::getenv("MBD_FAULT"))
      if (std::sscanf(text, "%15s %127s %ld", f.call, f.name, &f.at) != 3) f.at = -1;
    return f;
  }();
  return read;
}

std::atomic<bool> armed = false;  // malloc
std::atomic<long> seen = 0;

// Whether the file's own name holds that of the fault.
bool is_meant(const char* path) {
  if (std::strcmp(fault().name, "*") == 0)
    return std::strncmp(path, "/dev/", 5) != 0 && std::strncmp(path, "/proc/", 6) != 0 &&
           std::strchr(path, ':') == nullptr;  // pipe:[…]
  const char* const slash = std::strrchr(path, '/');
  return std::strstr(slash != nullptr ? slash : path, fault().name) != nullptr;
}

bool fails(const char* call, const char* path) {
  const Fault& f = fault();
  return f.at >= 0 && std::strcmp(f.call, call) == 0 && (path == nullptr || is_meant(path)) &&
         ++seen == f.at;
}

[[gnu::destructor]] void tell() {
  const char* const file = std::getenv("MBD_FAULT_COUNT");
  if (fault().at != 0 || file == nullptr) return;
  const long count = seen;  // before the file is one more
  if (std::FILE* const out = std::fopen(file, "w")) {
    std::fprintf(out, "%ld\n", count);
    std::fclose(out);
  }
}

template <class F>
F next(const char* name) {
  return reinterpret_cast<F>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

ssize_t write(int file, const void* data, size_t size) {
  static const auto real = next<ssize_t (*)(int, const void*, size_t)>("write");
  if (std::strcmp(fault().call, "write") == 0) {
    char link[64], path[4096];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t length = readlink(link, path, sizeof path - 1);
    path[length > 0 ? length : 0] = '\0';
    if (fails("write", path)) {
      errno = ENOSPC;
      return -1;
    }
  }
  return real(file, data, size);
}

int open(const char* path, int flags, ...) {
  static const auto real = next<int (*)(const char*, int, ...)>("open");
  va_list more;
  va_start(more, flags);
  const auto mode = (flags & O_CREAT) != 0 ? va_arg(more, mode_t) : mode_t{0};
  va_end(more);
  if ((flags & O_ACCMODE) != O_RDONLY && fails("open", path)) {
    errno = EMFILE;
    return -1;
  }
  return real(path, flags, mode);
}

int mkdir(const char* path, mode_t mode) {
  static const auto real = next<int (*)(const char*, mode_t)>("mkdir");
  if (fails("mkdir", path)) {
    errno = EACCES;
    return -1;
  }
  return real(path, mode);
}

int rename(const char* from, const char* to) {
  static const auto real = next<int (*)(const char*, const char*)>("rename");
  if (fails("rename", to)) {
    errno = EIO;
    return -1;
  }
  return real(from, to);
}

// libstdc++ opens files so.
FILE* fopen64(const char* path, const char* mode) {
  static const auto real = next<FILE* (*)(const char*, const char*)>("fopen64");
  FILE* const file = real(path, mode);
  if (std::strcmp(fault().call, "malloc") == 0 && is_meant(path)) armed = true;
  return file;
}
FILE* fopen(const char* path, const char* mode) { return fopen64(path, mode); }

void* __libc_malloc(size_t size);

void* malloc(size_t size) {
  static std::atomic<bool> looking = false;  // fault() may allocate
  if (armed && !looking.exchange(true)) {
    const bool now = fails("malloc", nullptr);
    looking = false;
    if (now) {
      errno = ENOMEM;
      return nullptr;
    }
  }
  return __libc_malloc(size);
}
}
