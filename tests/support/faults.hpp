// Programs that are started while it lives meet one fault of the system (tests/faults/faults.cpp says which there are).
#pragma once

#include <cstdlib>
#include <string>

#include "tests/support/this_build.hpp"

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

// Not in a program with sanitizers, which must be loaded first themselves.
inline bool faults_work() { return !sanitized(); }

}  // namespace mbd::test
