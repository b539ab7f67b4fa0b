// A scene as Python holds it, and what a run of it gives.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/results/observers.hpp"
#include "libmbd/scene/scene.hpp"
#include "libmbd/study/modes/linearize.hpp"

namespace mbd::python {

namespace py = pybind11;

// What several objects of Python refer to; it lives as long as they do.
struct Compiled {
  std::shared_ptr<const Scene> scene;
  Model model;
};

class ModelHandle {
 public:
  // Reads it with other values of parameters. Knows nothing of Python.
  using Read = std::function<Scene(const Overrides&)>;
  explicit ModelHandle(Read read)
      : read_(std::move(read)), scene_(std::make_shared<const Scene>(read_({}))) {}

  const Scene& scene() const { return *scene_; }
  Scene read(const Overrides& overrides) const { return read_(overrides); }
  // Compiled at the first call. Throws Error as compile() does. To be called without Python's lock.
  std::shared_ptr<const Compiled> compiled() const;

 private:
  Read read_;
  std::shared_ptr<const Scene> scene_;
  mutable std::mutex mutex_;
  mutable std::shared_ptr<const Compiled> compiled_;
};

// All rows of a run, one after the other.
class Rows final : public Observer {
 public:
  void accepted(const Sample& sample) override {
    if (names.empty()) names = columns(sample.model);
    numbers.insert(numbers.end(), sample.row.begin(), sample.row.end());
  }
  std::vector<Column> names;
  std::vector<double> numbers;
};

// A table with named columns, which views into it keep alive.
struct Table {
  std::vector<Column> columns;
  std::vector<double> numbers;  // row by row
  std::string report;           // report.json
  std::string failure;          // empty: it came to its end
  double t = 0.0;               // reached [s]

  std::size_t rows() const { return columns.empty() ? 0 : numbers.size() / columns.size(); }
};

// A view that cannot be written to, of what `owner` holds.
py::array view(const double* data, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
               const py::object& owner);

// Which columns a name stands for: one, those of a quantity, or of a record; neighbours. Throws UnknownName.
struct Range {
  std::size_t first = 0, count = 0;
  bool is_column = false;
};
Range find_columns(const std::vector<Column>& columns, const std::string& name,
                   const std::string& model);

// "a, b, c", shortened; and a sentence that suggests the nearest.
// Matrices and names of a linearisation.
py::dict dict_of(const Linearization& linear);

std::string known_names(const std::string& name, const std::vector<std::string>& known,
                        const char* what);

void bind_model(py::module_& module);
void bind_stepper(py::module_& module);
void bind_studies(py::module_& module);
void bind_sweep(py::module_& module);

}  // namespace mbd::python
