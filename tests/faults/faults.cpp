// Faults of the system, one at a time: preloaded into a program (LD_PRELOAD), it lets one call fail and no other.
//   MBD_FAULT="write NAME N"   the Nth write(2) to a file whose name holds NAME: ENOSPC
//   MBD_FAULT="open NAME N"    the Nth open(2) to write it: EMFILE
//   MBD_FAULT="plant NAME N"   before the Nth open(2) that makes it, a link of its name to the file MBD_FAULT_VICTIM is there
//   MBD_FAULT="rename NAME N"  the Nth rename(2) to it: EIO
//   MBD_FAULT="mkdir NAME N"   the Nth mkdir(2) of it: EACCES
//   MBD_FAULT="malloc NAME N"  the Nth allocation after a file whose name holds NAME was opened by fopen: no memory
//   MBD_FAULT="clock DAYS 0"   the time of day is that many days less whenever it is asked for
//   MBD_FAULT="F STATUS N"     the Nth call of a solver's function F ends with that status: klu_analyze, klu_factor, klu_refactor,
//                              klu_solve, the same of klu_z_, IDASolve, KINSol
// N is counted from 1; with 0 none fails, and with a number behind it so many in a row do. The file MBD_FAULT_COUNT gets, at the end, how many there were, how many
// allocations from then on were not given back, and, with 0, which of them were the first from their place in the program. NAME *
// is any file but devices, pipes and what the system shows of itself. Only calls that the program makes itself are seen, not those inside
// of libc.
#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <klu.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

namespace {

struct Fault {
  char call[16] = {}, name[128] = {};
  long at = -1;  // none
  long in_row = 1;
};

const Fault& fault() {
  static const Fault read = [] {
    Fault f;
    if (const char* const text = std::getenv("MBD_FAULT"))
      if (std::sscanf(text, "%15s %127s %ld %ld", f.call, f.name, &f.at, &f.in_row) < 3) f.at = -1;
    return f;
  }();
  return read;
}

std::atomic<bool> armed = false;  // malloc
std::atomic<long> seen = 0;
std::atomic<long> live = 0;  // allocations since it was armed, less what was given back

// A place is the innermost frames of a stack: enough to tell the callers of the allocators of libraries apart.
constexpr int frames = 12;
constexpr std::size_t most_places = 1 << 16;
std::uint64_t places[most_places];  // hashes, by open addressing
long first_at[most_places];
std::size_t place_count = 0;

void look_at_place(long n) {
  void* stack[frames];
  const int depth = backtrace(stack, frames);
  std::uint64_t hash = 1469598103934665603u;
  for (int i = 0; i < depth; ++i)
    hash = (hash ^ reinterpret_cast<std::uintptr_t>(stack[i])) * 1099511628211u;
  hash |= 1;
  std::size_t at = hash % most_places;
  while (places[at] != 0 && places[at] != hash) at = (at + 1) % most_places;
  if (places[at] == hash || place_count >= most_places / 2) return;
  places[at] = hash;
  first_at[place_count++] = n;
}

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
  if (f.at < 0 || std::strcmp(f.call, call) != 0 || (path != nullptr && !is_meant(path)))
    return false;
  const long n = ++seen;
  return f.at > 0 && n >= f.at && n < f.at + f.in_row;
}

[[gnu::destructor]] void tell() {
  const char* const file = std::getenv("MBD_FAULT_COUNT");
  if (file == nullptr) return;
  const long count = seen, kept = live;  // before the file is one more
  armed = false;
  if (std::FILE* const out = std::fopen(file, "w")) {
    std::fprintf(out, "%ld %ld\n", count, kept);
    for (std::size_t i = 0; i < place_count; ++i) std::fprintf(out, "%ld\n", first_at[i]);
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
  if ((flags & O_CREAT) != 0 && fails("plant", path)) {
    unlink(path);
    if (symlink(std::getenv("MBD_FAULT_VICTIM"), path) != 0) std::abort();
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

static time_t set_back(time_t now) {
  if (fault().at != 0 || std::strcmp(fault().call, "clock") != 0) return now;
  return now - 86400 * std::atol(fault().name) * ++seen;
}
int clock_gettime(clockid_t clock, timespec* at) {
  static const auto real = next<int (*)(clockid_t, timespec*)>("clock_gettime");
  const int status = real(clock, at);
  if (clock == CLOCK_REALTIME) at->tv_sec = set_back(at->tv_sec);
  return status;
}
time_t time(time_t* at) {
  static const auto real = next<time_t (*)(time_t*)>("time");
  const time_t now = set_back(real(nullptr));
  if (at != nullptr) *at = now;
  return now;
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
void __libc_free(void* memory);

// Of the calling thread: what fails() and backtrace() allocate themselves is not counted.
static thread_local bool looking = false;

void* malloc(size_t size) {
  if (armed && !looking) {
    looking = true;
    const bool is_meant = std::strcmp(fault().call, "malloc") == 0;
    const bool now = fails("malloc", nullptr);
    if (is_meant && fault().at == 0) look_at_place(seen);
    looking = false;
    if (now) {
      errno = ENOMEM;
      return nullptr;
    }
    ++live;
  }
  return __libc_malloc(size);
}

// Seen for the balance only.
void* __libc_calloc(size_t count, size_t size);
void* calloc(size_t count, size_t size) {
  if (armed && !looking) ++live;
  return __libc_calloc(count, size);
}
void* __libc_realloc(void* memory, size_t size);
void* realloc(void* memory, size_t size) {
  if (armed && !looking && memory == nullptr) ++live;
  return __libc_realloc(memory, size);
}
void* __libc_memalign(size_t alignment, size_t size);
void* aligned_alloc(size_t alignment, size_t size) {
  if (armed && !looking) ++live;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, size_t alignment, size_t size) {
  if (armed && !looking) ++live;
  *memory = __libc_memalign(alignment, size);
  return *memory != nullptr ? 0 : ENOMEM;
}

void free(void* memory) {
  if (armed && !looking && memory != nullptr) --live;
  __libc_free(memory);
}

// ---- solvers -------------------------------------------------------------------------------------

// Whether this call of the function ends with the fault's status.
static bool ends_so(const char* function, int& status) {
  if (!fails(function, nullptr)) return false;
  status = std::atoi(fault().name);
  return true;
}

#define MBD_KLU_FACTOR(function)                                                 \
  klu_numeric* function(int Ap[], int Ai[], double Ax[], klu_symbolic* symbolic, \
                        klu_common* common) {                                    \
    if (ends_so(#function, common->status)) return nullptr;                      \
    return next<decltype(&function)>(#function)(Ap, Ai, Ax, symbolic, common);   \
  }
MBD_KLU_FACTOR(klu_factor)
MBD_KLU_FACTOR(klu_z_factor)

#define MBD_KLU_REFACTOR(function)                                                            \
  int function(int Ap[], int Ai[], double Ax[], klu_symbolic* symbolic, klu_numeric* numeric, \
               klu_common* common) {                                                          \
    if (ends_so(#function, common->status)) return 0;                                         \
    return next<decltype(&function)>(#function)(Ap, Ai, Ax, symbolic, numeric, common);       \
  }
MBD_KLU_REFACTOR(klu_refactor)
MBD_KLU_REFACTOR(klu_z_refactor)

#define MBD_KLU_SOLVE(function)                                                                 \
  int function(klu_symbolic* symbolic, klu_numeric* numeric, int rows, int columns, double B[], \
               klu_common* common) {                                                            \
    if (ends_so(#function, common->status)) return 0;                                           \
    return next<decltype(&function)>(#function)(symbolic, numeric, rows, columns, B, common);   \
  }
MBD_KLU_SOLVE(klu_solve)
MBD_KLU_SOLVE(klu_z_solve)

klu_symbolic* klu_analyze(int n, int Ap[], int Ai[], klu_common* common) {
  if (ends_so("klu_analyze", common->status)) return nullptr;
  return next<decltype(&klu_analyze)>("klu_analyze")(n, Ap, Ai, common);
}

// SUNDIALS is loaded when it is used, by its functions' names (solvers/newton/sundials.hpp).
static int (*ida_solve)(void*, double, double*, void*, void*, int) = nullptr;
static int (*kinsol)(void*, void*, int, void*, void*) = nullptr;
static int solve_by_ida(void* memory, double until, double* t, void* y, void* ydot, int task) {
  int status = 0;
  return ends_so("IDASolve", status) ? status : ida_solve(memory, until, t, y, ydot, task);
}
static int solve_by_kinsol(void* memory, void* y, int strategy, void* u_scale, void* f_scale) {
  int status = 0;
  return ends_so("KINSol", status) ? status : kinsol(memory, y, strategy, u_scale, f_scale);
}

void* dlsym(void* library, const char* name) {
  static const auto real =
      reinterpret_cast<void* (*)(void*, const char*)>(dlvsym(RTLD_NEXT, "dlsym", "GLIBC_2.34"));
  void* const found = real(library, name);
  if (found != nullptr && std::strcmp(name, "IDASolve") == 0) {
    ida_solve = reinterpret_cast<decltype(ida_solve)>(found);
    return reinterpret_cast<void*>(&solve_by_ida);
  }
  if (found != nullptr && std::strcmp(name, "KINSol") == 0) {
    kinsol = reinterpret_cast<decltype(kinsol)>(found);
    return reinterpret_cast<void*>(&solve_by_kinsol);
  }
  return found;
}
}
