// Programs that are started while it lives meet one fault of the system (tests/faults/faults.cpp says which there are).
#pragma once

#include <cstdlib>
#include <string>

namespace mbd::test {

class Fault {
 public:
  Fault(const char* library, const std::string& what) {
    setenv("LD_PRELOAD", library, 1);
    setenv("MBD_FAULT", what.c_str(), 1);
  }
  ~Fault() {
    unsetenv("LD_PRELOAD");
    unsetenv("MBD_FAULT");
  }
  Fault(const Fault&) = delete;
  Fault& operator=(const Fault&) = delete;
};

// Another's memory does not go with the sanitizers' own.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool faults_work = false;
#else
inline constexpr bool faults_work = true;
#endif

}  // namespace mbd::test
