// What goes wrong, as exceptions of the package (mbd/errors.py).
#pragma once

#include <pybind11/pybind11.h>

#include <stdexcept>
#include <string>

namespace mbd::python {

namespace py = pybind11;

// A call that makes no sense: a shape, a number that is not finite, a state of another model. mbd.UseError.
class UseError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A name that is not there; the message says which are. mbd.UnknownName, a KeyError.
class UnknownName : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A class of mbd/errors.py.
py::object exception_class(const char* name);

// Of a run that ended before its end: mbd.RunError with the time reached [s] and the results so far (or None). Throws.
[[noreturn]] void raise_run_error(const std::string& message, double t, const py::object& results);

// From mbd::Error (to mbd.ModelError, with file and line of its message), UseError and UnknownName.
void translate_errors();

}  // namespace mbd::python
