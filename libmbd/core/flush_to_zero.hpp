// Results below 2.2e-308 are zero while one of these lives, in its thread.
//
// What a damped motion leaves in directions in which nothing moves shrinks step by step into such numbers, and processors take
// some ten times as long for them: a plane mechanism then steps three times slower. On x86 alone; others do well with them.
// Numbers so small that are given, as 1e-308*exp(1000*t) has one, are what they are.
#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace mbd {

class FlushToZero {
 public:
#if defined(__SSE2__)
  FlushToZero() : before_(_mm_getcsr()) { _mm_setcsr(before_ | results_are_zero); }
  // Exceptions that were raised meanwhile stay raised.
  ~FlushToZero() { _mm_setcsr((_mm_getcsr() & ~results_are_zero) | (before_ & results_are_zero)); }
#else
  FlushToZero() {}
  ~FlushToZero() {}
#endif
  FlushToZero(const FlushToZero&) = delete;
  FlushToZero& operator=(const FlushToZero&) = delete;

 private:
#if defined(__SSE2__)
  static constexpr unsigned results_are_zero = 0x8000;
  unsigned before_;
#endif
};

}  // namespace mbd
