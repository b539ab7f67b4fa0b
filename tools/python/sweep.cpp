// A model over many values of its parameters.

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "libmbd/study/sweep/sweep.hpp"
#include "tools/mbd/shares.hpp"
#include "tools/python/background.hpp"
#include "tools/python/errors.hpp"
#include "tools/python/model.hpp"

namespace mbd::python {
namespace {

using Points = std::vector<std::vector<std::string>>;

// A sweep and the model it is of.
struct SweptModel {
  SweptModel(std::shared_ptr<const ModelHandle> m, const SweepPlan& plan,
             const SweepOptions& options)
      : model(std::move(m)), table(reader(), plan, options) {}
  ReadSweptModel reader() const {
    return [this](const Overrides& values) { return model->read(values); };
  }
  std::shared_ptr<const ModelHandle> model;
  SweepTable table;
};

std::unique_ptr<SweptModel> make_table(const std::shared_ptr<ModelHandle>& model,
                                       const SweepPlan& plan,
                                       const std::vector<std::string>& quantities,
                                       const std::optional<std::string>& keep,
                                       const std::string& fingerprint, const std::string& command,
                                       const std::string& share) {
  SweepOptions options;
  options.quantities = quantities;
  if (keep) options.keep = *keep;
  options.fingerprint = fingerprint;
  options.command = command;
  if (!share.empty()) options.share = share_of(share);
  const py::gil_scoped_release release;
  return std::make_unique<SweptModel>(model, plan, options);
}

// Returns what was raised meanwhile, or None.
py::object run_here(SweptModel& t, int jobs, const py::object& progress) {
  SweepOptions options;
  options.jobs = jobs;
  std::atomic<std::size_t> done = 0;
  std::size_t shown = 0;
  std::function<void()> show;
  if (!progress.is_none()) {
    options.progress = [&done](std::size_t now, std::size_t) { done = now; };
    show = [&] {
      if (const std::size_t now = done; now != shown)
        progress(shown = now, t.table.study().rows.size());
    };
  }
  return in_background(
      [&](const std::atomic<bool>& interrupted) {
        options.interrupted = &interrupted;
        t.table.run(t.reader(), options);
      },
      show);
}

py::dict found(const SweptModel& t) {
  const SweepStudy& study = t.table.study();
  const auto points = static_cast<py::ssize_t>(study.rows.size());
  py::list columns, status, messages;
  py::array_t<double> values({points, static_cast<py::ssize_t>(study.columns.size())}),
      time(points), cpu(points);
  for (const Column& column : study.columns)
    columns.append(py::make_tuple(column.name, column.unit));
  for (py::ssize_t i = 0; i < points; ++i) {
    const SweepRow& row = study.rows[static_cast<std::size_t>(i)];
    for (py::ssize_t c = 0; c < values.shape(1); ++c)
      values.mutable_at(i, c) =
          row.values.empty() ? std::nan("") : row.values[static_cast<std::size_t>(c)];
    const bool is_open = row.status == SweepRow::Status::open;
    time.mutable_at(i) = is_open ? std::nan("") : row.t;
    cpu.mutable_at(i) = is_open ? std::nan("") : row.cpu;
    status.append(std::string(word_of(row.status)));
    messages.append(row.message);
  }
  py::dict all;
  all["model"] = study.model;
  all["parameters"] = study.plan.parameters;
  all["points"] = study.plan.points;
  all["columns"] = columns;
  all["values"] = values;
  all["status"] = status;
  all["t"] = time;
  all["cpu"] = cpu;
  all["messages"] = messages;
  all["found"] = study.found;
  all["whole"] = study.whole();
  all["csv"] = to_csv(study);
  all["text"] = to_text(study);
  return all;
}

std::vector<std::string> column_names(const SweptModel& t) {
  std::vector<std::string> names;
  for (const Column& column : t.table.study().columns) names.push_back(column.name);
  return names;
}

// A row as a worker sends it.
using Row = std::tuple<std::string, double, double, std::vector<double>, std::string>;

Row run_one(const ModelHandle& model, const Overrides& values,
            const std::vector<std::string>& names) {
  std::vector<Column> columns;
  for (const std::string& name : names) columns.push_back({name, {}});
  const py::gil_scoped_release release;
  const SweepRow row =
      run_point([&](const Overrides& more) { return model.read(more); }, values, columns);
  return {std::string(word_of(row.status)), row.t, row.cpu, row.values, row.message};
}

// What goes wrong with Slurm is wrong use of the machine, not of the model.
std::string submit_to_slurm(const std::vector<std::string>& command,
                            const std::vector<std::size_t>& numbers, std::size_t tasks, int jobs,
                            const std::string& logs, const std::vector<std::string>& options) {
  const py::gil_scoped_release release;
  try {
    return submit({command, numbers, tasks, jobs, logs, options});
  } catch (const Error& error) {
    throw UseError(error.what());
  }
}

// `done` is asked once a second, and may raise: that ends it, too.
std::string wait_for_slurm(const std::string& id, const py::function& done) {
  const py::gil_scoped_release release;
  return wait_for(id, [&] {
    const py::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    return py::cast<bool>(done());
  });
}

void add(SweptModel& t, std::size_t point, const Row& given) {
  const auto& [status, time, cpu, values, message] = given;
  const SweepStudy& study = t.table.study();
  SweepRow row{status_of(status), time, cpu, values, message};
  const bool is_done = row.status == SweepRow::Status::done;
  if (point >= study.rows.size() || row.status == SweepRow::Status::open ||
      row.values.size() != (is_done ? study.columns.size() : 0))
    throw UseError("a row that is none of this sweep");
  t.table.add(point, std::move(row));
}

}  // namespace

void bind_sweep(py::module_& module) {
  py::class_<SweepPlan>(module, "SweepPlan", "Which values a sweep gives to parameters.")
      .def_readonly("parameters", &SweepPlan::parameters)
      .def_readonly("points", &SweepPlan::points)
      .def_static("grid", [](const std::vector<std::string>& vary) { return grid_plan(vary); })
      .def_static("latin", [](const std::vector<std::string>& vary, std::size_t count,
                              std::uint64_t seed) { return latin_plan(vary, count, seed); })
      .def_static("file", [](const std::string& file) { return file_plan(file); })
      .def_static("list", [](std::vector<std::string> parameters, Points points) {
        return list_plan(std::move(parameters), std::move(points));
      });
  py::class_<SweptModel>(module, "SweepTable", "A sweep as it goes.")
      .def(py::init(&make_table), py::arg("model"), py::arg("plan"), py::arg("quantities"),
           py::arg("keep"), py::arg("fingerprint"), py::arg("command"), py::arg("share"))
      .def("run", &run_here, py::arg("jobs"), py::arg("progress"))
      .def("add", &add)
      .def("open", [](const SweptModel& t) { return t.table.open(); })
      .def("look_again", [](SweptModel& t) { t.table.look_again(); })
      .def("leave", [](SweptModel& t) { t.table.leave(); })
      .def("columns", &column_names)
      .def("found", &found);
  module.def("submit_to_slurm", &submit_to_slurm, py::arg("command"), py::arg("numbers"),
             py::arg("tasks"), py::arg("jobs"), py::arg("logs"), py::arg("options"));
  module.def("wait_for_slurm", &wait_for_slurm, py::arg("id"), py::arg("done"));
  module.def(
      "cancel_in_slurm", [](const std::string& id) { cancel(id); }, py::arg("id"));
  module.def("run_point", &run_one, py::arg("model"), py::arg("values"), py::arg("columns"));
}

}  // namespace mbd::python
