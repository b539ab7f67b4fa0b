// How many instructions a program executes: by valgrind, since counters of the processor are not at hand everywhere.
#pragma once

#include <string>
#include <vector>

namespace mbd {

// Of `command` (a program and its arguments, without a shell), in user mode; its output is discarded. Some 50 times
// slower than the program. The same program on the same input executes the same number, but for a few in a million.
// Throws Error, saying what to do, where there is no valgrind, where it does not know the program's instructions
// (AVX-512 and some of AVX: take a build with -march=x86-64-v2), and where the program fails.
double count_instructions(const std::vector<std::string>& command);

}  // namespace mbd
