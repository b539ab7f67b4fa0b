// Long work without Python's lock, which Ctrl-C ends.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <functional>

namespace mbd::python {

namespace py = pybind11;

// Runs work(interrupted) on a thread of its own, with the lock released, and returns when it has ended. Meanwhile looks for
// signals and calls `show` (if it is there) a few times a second, with the lock. What a signal handler or `show` raises
// sets `interrupted`, which the work looks at to end soon. Returns what was raised (None: nothing), or throws what the work has
// thrown; that after an interruption only if it is no mbd::Error.
py::object in_background(const std::function<void(const std::atomic<bool>&)>& work,
                         const std::function<void()>& show = {});

// Raises what in_background() returned; a KeyboardInterrupt as mbd.Interrupted with the results so far (or None).
void raise_if(const py::object& raised, const py::object& results);

}  // namespace mbd::python
