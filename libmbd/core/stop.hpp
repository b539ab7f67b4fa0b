// A request to end, looked at from inside long work: between items that are compiled, in Newton's iterations, before
// factorisations, between rows of a QR. It costs two loads; nothing is passed from function to function. What ends so
// ends by an exception, because it may come from any depth: at most one factorisation later.
#pragma once

#include <atomic>

#include "libmbd/core/error.hpp"

namespace mbd {

class Stopped : public Error {
 public:
  Stopped() : Error("interrupted", Failure::stopped) {}
};

// Work for which there is no memory, or whose sizes cannot be counted; says which.
class OutOfMemory : public Error {
 public:
  explicit OutOfMemory(const std::string& message) : Error(message, Failure::memory) {}
};

namespace stop {

// Of this thread; null: nobody asks.
inline thread_local const std::atomic<bool>* flag = nullptr;

inline bool requested() { return flag != nullptr && flag->load(std::memory_order_relaxed); }

// Set by a program whose operator new was only served from what it keeps for the end (tools/mbd/command_line.hpp): what is
// looked at next ends with what it has, while there is memory to do so in order.
inline std::atomic<bool> memory_is_low = false;

// Throws Stopped, or OutOfMemory.
inline void check() {
  if (requested()) throw Stopped();
  if (memory_is_low.load(std::memory_order_relaxed))
    throw OutOfMemory("out of memory (take fewer elements, bodies or rows, or more of it)");
}

// While it lives, this thread looks at `asked` (null: at what it looked at before).
class Scope {
 public:
  explicit Scope(const std::atomic<bool>* asked) : before_(flag) {
    if (asked != nullptr) flag = asked;
  }
  ~Scope() { flag = before_; }
  Scope(const Scope&) = delete;
  Scope& operator=(const Scope&) = delete;
  // From here on nobody asks: what is there is finished.
  static void done() {
    flag = nullptr;
    memory_is_low = false;
  }

 private:
  const std::atomic<bool>* before_;
};

}  // namespace stop
}  // namespace mbd
