#include "solvers/linear/dissection.hpp"

#include <cstddef>

#ifdef MBD_METIS_LIBRARY
#include <dlfcn.h>
#include <metis.h>

#include <mutex>
#include <type_traits>
#endif

namespace mbd {

#ifdef MBD_METIS_LIBRARY

namespace {

static_assert(std::is_same_v<idx_t, int>, "METIS with 64-bit indices");

// Its library is loaded when it is first asked for; nullptr where there is none.
decltype(&::METIS_NodeND) metis() {
  static const auto entry = [] {
    void* const library = dlopen(MBD_METIS_LIBRARY, RTLD_NOW | RTLD_LOCAL);
    void* const found = library == nullptr ? nullptr : dlsym(library, "METIS_NodeND");
    return reinterpret_cast<decltype(&::METIS_NodeND)>(found);
  }();
  return entry;
}

}  // namespace

std::vector<int> dissect(const QuotientGraph& graph) {
  const auto node_nd = metis();
  if (node_nd == nullptr || graph.names.empty()) return {};
  // It takes its chances from rand(), seeded by itself, and sorts and weighs in the arrays that it is given.
  static std::mutex one_at_a_time;
  const std::lock_guard<std::mutex> lock(one_at_a_time);
  QuotientGraph own = graph;
  idx_t count = static_cast<idx_t>(own.names.size());
  std::vector<idx_t> place(own.names.size()), vertex(own.names.size());
  if (node_nd(&count, own.begin.data(), own.neighbours.data(), own.weights.data(), nullptr,
              vertex.data(), place.data()) != METIS_OK)
    return {};
  std::vector<int> sequence;
  sequence.reserve(own.names.size());
  for (const idx_t v : vertex) sequence.push_back(own.names[static_cast<std::size_t>(v)]);
  return sequence;
}

#else

std::vector<int> dissect(const QuotientGraph&) { return {}; }

#endif

}  // namespace mbd
