// Ctrl-C and its like (SIGINT, SIGTERM, SIGHUP) as a flag that long work looks at, to end with what it has.
#pragma once

#include <array>
#include <atomic>
#include <csignal>

namespace mbd {

inline constexpr int interrupted_status = 130;  // as a shell says it of a program that Ctrl-C ended

// While it lives, the first signal sets the flag; a second one of the same kind ends the program. What the
// caller of the program ignores (nohup) stays ignored. One at a time.
class InterruptHandler {
 public:
  InterruptHandler();
  ~InterruptHandler();
  InterruptHandler(const InterruptHandler&) = delete;
  InterruptHandler& operator=(const InterruptHandler&) = delete;

  static const std::atomic<bool>& flag();

 private:
  std::array<void (*)(int), 3> before_{};
};

}  // namespace mbd
