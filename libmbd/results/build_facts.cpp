#include "libmbd/results/build_facts.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include <mbd_build.hpp>   // written when the build is configured: tools/cmake/mbd_build.hpp.in
#include <mbd_commit.hpp>  // written when it is built: tools/cmake/write_commit.cmake

#include "libmbd/language/schema.hpp"

// What programs ask for by its name: tools/cmake/abi.hpp.in.
extern "C" {
extern const char MBD_ABI_SYMBOL;
const char MBD_ABI_SYMBOL = 0;
}

namespace mbd {
namespace {

// The widest vectors that the compiler was allowed to use.
std::string_view vectors() {
#if defined(__AVX512F__)
  return "AVX-512";
#elif defined(__AVX2__)
  return "AVX2";
#elif defined(__AVX__)
  return "AVX";
#elif defined(__SSE2__)
  return "SSE2";
#elif defined(__ARM_FEATURE_SVE)
  return "SVE";
#elif defined(__ARM_NEON)
  return "NEON";
#else
  return "";
#endif
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace

const BuildFacts& build_facts() {
  static const BuildFacts facts = [] {
    BuildFacts f;
    f.commit = MBD_COMMIT;
    f.modified = MBD_COMMIT_MODIFIED;
    f.compiler = MBD_BUILD_COMPILER;
    f.build_type = MBD_BUILD_TYPE;
    if (const std::string_view flags = MBD_BUILD_FLAGS; !flags.empty())
      f.options.emplace_back(flags);
    if (!vectors().empty()) f.options.emplace_back(vectors());
#ifndef NDEBUG
    f.options.emplace_back("assertions");
#endif
#if MBD_BUILD_SANITIZE
    f.options.emplace_back("address and undefined-behaviour sanitizers");
#endif
#ifdef MBD_RUNTIME_ORDER_ONLY
    f.options.emplace_back("beam orders at run time only");
#else
    f.options.emplace_back("fixed beam orders");
#endif
    f.libraries = {MBD_BUILD_LIBRARIES};
    f.model_format = schema::format_version;
    return f;
  }();
  return facts;
}

std::vector<std::pair<std::string, std::string>> to_lines(const BuildFacts& facts) {
  std::vector<std::string> build = facts.options, libraries;
  if (!facts.build_type.empty()) build.insert(build.begin(), std::string(facts.build_type));
  for (const auto& [name, version] : facts.libraries)
    libraries.push_back(fmt::format("{} {}", name, version));
  return {{"commit", std::string(facts.commit) + (facts.modified ? ", modified" : "")},
          {"compiler", std::string(facts.compiler)},
          {"build", joined(build)},
          {"libraries", joined(libraries)},
          {"model format", std::to_string(facts.model_format)}};
}

std::string library_file() {
  static const char own = 0;
  Dl_info file{};
  return dladdr(&own, &file) != 0 && file.dli_fname != nullptr ? file.dli_fname : "";
}

double used_cpu() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

std::string machine() {
  std::ifstream file("/proc/cpuinfo");
  std::string name = "processor not known";
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) {
      name = line.substr(std::min(line.find(':') + 2, line.size()));
      break;
    }
  return fmt::format("{}, {} cores", name, std::thread::hardware_concurrency());
}

}  // namespace mbd
