// A model over many values of its parameters.

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <mutex>
#include <optional>

#include "libmbd/study/sweep/sweep.hpp"
#include "tools/python/background.hpp"
#include "tools/python/errors.hpp"
#include "tools/python/model.hpp"

namespace mbd::python {
namespace {

using Points = std::vector<std::vector<std::string>>;

py::tuple sweep(const ModelHandle& model, const SweepPlan& plan,
                const std::vector<std::string>& quantities, int jobs,
                const std::optional<std::string>& keep, const std::string& fingerprint,
                const std::string& command, const py::object& progress) {
  SweepOptions options;
  options.quantities = quantities;
  options.jobs = jobs;
  if (keep) options.keep = *keep;
  options.fingerprint = fingerprint;
  options.command = command;
  std::atomic<std::size_t> done = 0;
  std::size_t shown = 0;
  std::function<void()> show;
  if (!progress.is_none()) {
    options.progress = [&done](std::size_t now, std::size_t) { done = now; };
    show = [&] {
      if (const std::size_t now = done; now != shown) progress(shown = now, plan.points.size());
    };
  }
  std::optional<SweepStudy> study;
  const py::object raised = in_background(
      [&](const std::atomic<bool>& interrupted) {
        options.interrupted = &interrupted;
        study =
            study_sweep([&](const Overrides& values) { return model.read(values); }, plan, options);
      },
      show);
  if (!study) return py::make_tuple(py::none(), raised);
  const auto points = static_cast<py::ssize_t>(study->rows.size());
  py::list columns, status, messages, texts;
  py::array_t<double> values({points, static_cast<py::ssize_t>(study->columns.size())}), t(points),
      cpu(points);
  for (const Column& column : study->columns)
    columns.append(py::make_tuple(column.name, column.unit));
  constexpr std::array words = {"open", "done", "failed", "refused", "lost"};
  for (py::ssize_t i = 0; i < points; ++i) {
    const SweepRow& row = study->rows[static_cast<std::size_t>(i)];
    for (py::ssize_t c = 0; c < values.shape(1); ++c)
      values.mutable_at(i, c) =
          row.values.empty() ? std::nan("") : row.values[static_cast<std::size_t>(c)];
    const bool is_open = row.status == SweepRow::Status::open;
    t.mutable_at(i) = is_open ? std::nan("") : row.t;
    cpu.mutable_at(i) = is_open ? std::nan("") : row.cpu;
    status.append(words[static_cast<std::size_t>(row.status)]);
    messages.append(row.message);
  }
  py::dict all;
  all["model"] = study->model;
  all["parameters"] = plan.parameters;
  all["points"] = plan.points;
  all["columns"] = columns;
  all["values"] = values;
  all["status"] = status;
  all["t"] = t;
  all["cpu"] = cpu;
  all["messages"] = messages;
  all["found"] = study->found;
  all["csv"] = to_csv(*study);
  all["text"] = to_text(*study);
  return py::make_tuple(all, raised);
}

}  // namespace

void bind_sweep(py::module_& module) {
  py::class_<SweepPlan>(module, "SweepPlan", "Which values a sweep gives to parameters.")
      .def_readonly("points", &SweepPlan::points)
      .def_static("grid", [](const std::vector<std::string>& vary) { return grid_plan(vary); })
      .def_static("latin", [](const std::vector<std::string>& vary, std::size_t count,
                              std::uint64_t seed) { return latin_plan(vary, count, seed); })
      .def_static("file", [](const std::string& file) { return file_plan(file); })
      .def_static("list", [](std::vector<std::string> parameters, Points points) {
        return list_plan(std::move(parameters), std::move(points));
      });
  module.def("sweep", &sweep, py::arg("model"), py::arg("plan"), py::arg("quantities"),
             py::arg("jobs"), py::arg("keep"), py::arg("fingerprint"), py::arg("command"),
             py::arg("progress"));
}

}  // namespace mbd::python
