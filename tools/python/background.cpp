#include "tools/python/background.hpp"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "libmbd/core/error.hpp"
#include "tools/python/errors.hpp"

namespace mbd::python {

py::object in_background(const std::function<void(const std::atomic<bool>&)>& work,
                         const std::function<void()>& show) {
  std::atomic<bool> interrupted = false;
  std::exception_ptr failure;
  py::object raised = py::none();
  const auto keep = [&](py::error_already_set& error) {
    if (raised.is_none()) raised = error.value();
    interrupted = true;
  };
  {
    const py::gil_scoped_release release;
    std::mutex mutex;
    std::condition_variable ended;
    bool done = false;
    std::thread thread([&] {
      try {
        work(interrupted);
      } catch (...) {
        failure = std::current_exception();
      }
      const std::scoped_lock lock(mutex);
      done = true;
      ended.notify_one();
    });
    std::unique_lock lock(mutex);
    while (!ended.wait_for(lock, std::chrono::milliseconds(50), [&] { return done; })) {
      lock.unlock();
      {
        const py::gil_scoped_acquire acquire;
        try {
          if (PyErr_CheckSignals() != 0) throw py::error_already_set();
          if (show && !interrupted) show();
        } catch (py::error_already_set& error) {
          keep(error);
        }
      }
      lock.lock();
    }
    lock.unlock();
    thread.join();
  }
  if (!failure) return raised;
  try {
    std::rethrow_exception(failure);
  } catch (const Error&) {
    if (raised.is_none()) throw;
  }
  return raised;
}

void raise_if(const py::object& raised, const py::object& results) {
  if (raised.is_none()) return;
  py::object error = raised;
  if (py::isinstance(raised, py::reinterpret_borrow<py::object>(PyExc_KeyboardInterrupt)))
    error = exception_class("Interrupted")(results);
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
  throw py::error_already_set();
}

}  // namespace mbd::python
