#include "tools/python/errors.hpp"

#include <cctype>
#include <exception>
#include <filesystem>
#include <string_view>

#include "libmbd/core/error.hpp"

namespace mbd::python {
namespace {

// "rod.xml:12: beam …": what Error puts before a message whose place is known. Names of files may have such numbers too: what
// is a file decides.
struct Said {
  std::string file;
  int line = 0;  // 0: none
};
Said place_in(std::string_view message) {
  Said first;
  if (message.starts_with("--")) return first;  // an option, whose value may look like it
  for (std::size_t colon = message.find(':'); colon != std::string_view::npos && colon > 0;
       colon = message.find(':', colon + 1)) {
    std::size_t end = colon + 1;
    while (end < message.size() && std::isdigit(static_cast<unsigned char>(message[end])) != 0)
      ++end;
    const std::size_t digits = end - colon - 1;
    if (digits == 0 || digits > 9 || message.substr(end, 2) != ": ") continue;
    const Said said{std::string(message.substr(0, colon)),
                    std::stoi(std::string(message.substr(colon + 1, digits)))};
    std::error_code code;
    if (std::filesystem::is_regular_file(said.file, code)) return said;
    if (first.line == 0) first = said;
  }
  return first;
}

void set(const py::object& error) {
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
}

}  // namespace

py::object exception_class(const char* name) {
  return py::module_::import("mbd.errors").attr(name);
}

void raise_run_error(const std::string& message, double t, const py::object& results) {
  set(exception_class("RunError")(message, t, results));
  throw py::error_already_set();
}

void translate_errors() {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& error) {
      const Said said = place_in(error.what());
      set(exception_class("ModelError")(
          error.what(), said.line > 0 ? py::object(py::str(said.file)) : py::object(py::none()),
          said.line > 0 ? py::object(py::int_(said.line)) : py::object(py::none())));
    } catch (const UnknownName& error) {
      set(exception_class("UnknownName")(error.what()));
    } catch (const UseError& error) {
      set(exception_class("UseError")(error.what()));
    }
  });
}

}  // namespace mbd::python
