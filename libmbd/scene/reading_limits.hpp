// What one model may cost to read.
#pragma once

namespace mbd {

struct ReadingLimits {
  long repetitions = 1'000'000;  // of all <repeat> together, each times the number of its contents
  int section_unknowns = 200'000;  // of the finite elements of a section
};

// Of this process. For programs that read many models of unknown origin (tests/fuzz), and only before the first: nothing
// guards it.
inline ReadingLimits& reading_limits() {
  static ReadingLimits limits;
  return limits;
}

}  // namespace mbd
