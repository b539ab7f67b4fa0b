#include "tests/support/this_build.hpp"

namespace mbd::test {

const char* const mbd_program = MBD_PROGRAM;

bool sanitized() { return MBD_SANITIZED; }

bool fixed_orders() {
#ifdef MBD_RUNTIME_ORDER_ONLY
  return false;
#else
  return true;
#endif
}

}  // namespace mbd::test
