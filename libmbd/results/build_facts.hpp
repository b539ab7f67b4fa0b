// What this library was built from, by what and how: for `mbd --version` and reports.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mbd {

struct BuildFacts {
  std::string_view commit;    // of git, 12 digits; "unknown" without git or outside its repository
  bool modified = false;      // files differed from the commit
  std::string_view compiler;  // "GNU 12.2.0"
  std::string_view build_type;       // "Release"; empty if none was chosen
  std::vector<std::string> options;  // what changes code or speed: "-march=native", "sanitizers", …
  std::vector<std::pair<std::string_view, std::string_view>> libraries;  // name, version
  int model_format = 0;  // newest version of model files it reads
};

const BuildFacts& build_facts();

// The same as lines "name: value", in order: commit, compiler, build, libraries, model format.
std::vector<std::pair<std::string, std::string>> to_lines(const BuildFacts& facts);

// The file that has this library in it: its own, or the program's or module's that it is linked into.
std::string library_file();

// The processor this runs on and its number of cores: "Intel Xeon …, 2 cores".
std::string machine();

// CPU time that this process has used [s]. By getrusage: the kernel updates std::clock() at its ticks alone in a process
// whose CPU time is limited.
double used_cpu();

}  // namespace mbd
