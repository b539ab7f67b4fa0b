// What acts on nodes, kind by kind: a term is made with Nodes, has add() for each kind of item that it compiles, and
// finish(), which hands its batches to the system.
#pragma once

#include "libmbd/compile/drags.hpp"
#include "libmbd/compile/loads.hpp"

namespace mbd {

template <class... Term>
struct NodalTermList {
  // Items find their term by their type.
  static void compile(const Scene& scene, const Nodes& nodes) {
    (compile_one<Term>(scene, nodes), ...);
  }

 private:
  template <class One>
  static void compile_one(const Scene& scene, const Nodes& nodes) {
    One term(nodes);
    each_item(scene, [&term](const auto& item) {
      if constexpr (requires { term.add(item); }) term.add(item);
    });
    term.finish();
  }
};

// In the order of their batches.
using NodalTerms = NodalTermList<Loads, Drags>;

}  // namespace mbd
