#include "tools/python/model.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string_view>
#include <utility>

#include "libmbd/language/read_tree.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/results/history.hpp"
#include "libmbd/results/report.hpp"
#include "libmbd/results/summary.hpp"
#include "libmbd/run/describe.hpp"
#include "libmbd/run/run.hpp"
#include "libmbd/study/accuracy/choose.hpp"
#include "libmbd/study/effects/ablation.hpp"
#include "libmbd/study/modes/modes.hpp"
#include "libmbd/study/modes/modes_report.hpp"
#include "libmbd/study/trust/certify.hpp"
#include "libmbd/text/files.hpp"
#include "libmbd/text/spelling.hpp"
#include "libmbd/view/drawing.hpp"
#include "libmbd/view/motion.hpp"
#include "libmbd/view/page.hpp"
#include "tools/mbd/overrides.hpp"
#include "tools/mbd/rotation_options.hpp"
#include "tools/mbd/view_assets.hpp"
#include "tools/python/background.hpp"
#include "tools/python/errors.hpp"

namespace mbd::python {
namespace {

namespace fs = std::filesystem;

// An element of a scene built in Python: (name, line, [(attribute, text)], [children], text).
xml::Element element_of(const py::handle& item, int depth = 0) {
  constexpr int deepest = 100;
  if (depth > deepest) throw UseError("elements stand in each other more than 100 deep");
  const auto parts = py::cast<py::tuple>(item);
  if (parts.size() != 5)
    throw UseError("an element has a name, a line, attributes, children, text");
  xml::Element element{py::cast<std::string>(parts[0]), py::cast<int>(parts[1]), {}, {}, {}, 0};
  std::set<std::string> seen;
  for (const py::handle pair : py::cast<py::list>(parts[2])) {
    auto [name, value] = py::cast<std::pair<std::string, std::string>>(pair);
    if (!seen.insert(name).second)
      throw UseError(element.name + ": attribute " + name + " is given twice");
    element.attributes.push_back({std::move(name), std::move(value), element.line});
  }
  for (const py::handle child : py::cast<py::list>(parts[3]))
    element.children.push_back(element_of(child, depth + 1));
  element.text = py::cast<std::string>(parts[4]);
  if (!element.text.empty()) element.text_line = element.line;
  return element;
}

// The parameters that were set, and more.
Overrides with_more(Overrides all, const Overrides& more) {
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

std::shared_ptr<ModelHandle> from_file(const std::string& file, const Overrides& set) {
  const py::gil_scoped_release release;
  return std::make_shared<ModelHandle>(
      [=](const Overrides& more) { return read_model(file, with_more(set, more)); });
}

std::shared_ptr<ModelHandle> from_text(const std::string& text, const std::string& file,
                                       const Overrides& set) {
  const py::gil_scoped_release release;
  return std::make_shared<ModelHandle>(
      [=](const Overrides& more) { return read_model_text(text, file, with_more(set, more)); });
}

std::shared_ptr<ModelHandle> from_elements(const py::object& root, const std::string& file,
                                           const Overrides& set) {
  const xml::Element element = element_of(root);
  const py::gil_scoped_release release;
  return std::make_shared<ModelHandle>(
      [=](const Overrides& more) { return read_model_tree(element, file, with_more(set, more)); });
}

struct RunSettings {
  TransientOptions transient;
  std::vector<std::string> without;
  std::optional<double> accuracy;
  std::vector<std::string> quantities;
  double choose_within = 600.0;
  bool certify = false, estimate_error = true, motion = false;
  std::optional<int> frames;
  std::optional<std::string> out;
};

// As run_command.cpp does it. The table is there before modes are looked for.
void run_scene(const ModelHandle& handle, const RunSettings& settings,
               const std::atomic<bool>& interrupted,
               const std::function<void(const Progress&)>& progress, Table& table) {
  Scene scene = handle.scene();
  if (!settings.without.empty()) scene = without(scene, settings.without);
  if (scene.modes && scene.modes->at) require_state_at(scene, *scene.modes->at);
  RunOptions options;
  options.notes = apply(settings.transient, scene);
  if (settings.motion) {
    if (!scene.motion_output) scene.motion_output.emplace();
    if (settings.frames) scene.motion_output->frames = settings.frames;
  }
  if (settings.accuracy) {
    const double accuracy = *settings.accuracy;
    if (!(accuracy >= finest_accuracy) || !(accuracy <= coarsest_accuracy))
      throw UseError(
          fmt::format("accuracy = {:g}: give a number between {:g} and {:g}, the rms error "
                      "of what is recorded over its largest value",
                      accuracy, finest_accuracy, coarsest_accuracy));
    const Choice choice = choose(
        scene,
        {.accuracy = accuracy, .quantities = settings.quantities, .limit = settings.choose_within});
    options.accuracy = summary_of(choice);
    options.notes.insert(options.notes.end(), choice.notes.begin(), choice.notes.end());
    scene = with(scene, choice.setting);
  }
  if (settings.out) options.output = fs::path(*settings.out);
  options.certify = settings.certify;
  options.estimate_error = settings.estimate_error;
  options.progress = progress;
  options.interrupted = &interrupted;
  Rows rows;
  options.observers = {&rows};
  RunReport report = run(scene, options);
  if (settings.certify && report.complete()) {
    certify(scene, {.within = 60.0}, report);
    if (options.output) write_file(*options.output / "report.json", to_json(report));
  }
  table.columns = std::move(rows.names);
  table.numbers = std::move(rows.numbers);
  table.report = to_json(report);
  table.failure = report.failure;
  table.t = report.t;
  if (scene.modes && options.output && report.complete())
    write_modes(study_modes(scene, modes_options(ModesArguments{}, scene)), *options.output);
}

py::object run_model(const ModelHandle& handle, const RunSettings& settings,
                     const py::object& progress) {
  auto table = std::make_shared<Table>();
  std::mutex mutex;
  Progress last, shown;
  std::function<void()> show;
  std::function<void(const Progress&)> note;
  if (!progress.is_none()) {
    note = [&](const Progress& now) {
      const std::scoped_lock lock(mutex);
      last = now;
    };
    show = [&] {
      {
        const std::scoped_lock lock(mutex);
        if (last.step == shown.step) return;
        shown = last;
      }
      progress(shown.t, shown.duration, shown.step);
    };
  }
  py::object raised = in_background(
      [&](const std::atomic<bool>& interrupted) {
        run_scene(handle, settings, interrupted, note, *table);
      },
      show);
  if (raised.is_none() && last.step > shown.step) {  // the end, too
    try {
      progress(last.t, last.duration, last.step);
    } catch (py::error_already_set& error) {
      raised = error.value();
    }
  }
  return py::make_tuple(table->columns.empty() ? py::object(py::none()) : py::cast(table), raised);
}

// The page of a run that kept its motion in `directory`, or of the model.
PageParts parts_of_pages() {
  const PageParts parts = view_assets();
  if (parts.html.empty())
    throw UseError(
        "this mbd was built without three.js and makes no pages; install it (Debian: libjs-three), "
        "configure and build mbd again");
  return parts;
}

std::string page_of_results(const std::string& directory, const std::optional<int>& frames) {
  const py::gil_scoped_release release;
  const PageParts parts = parts_of_pages();
  const Motion motion = read_motion(fs::path(directory) / "motion.bin");
  std::optional<History> history;
  std::error_code code;
  for (const char* name : {"history.csv", "path.csv"})
    if (!history && fs::is_regular_file(fs::path(directory) / name, code))
      history = read_history(fs::path(directory) / name);
  PageOptions options;
  options.frames = frames;
  return motion_page(parts, motion, history ? &*history : nullptr, options).html;
}

std::string page_of_model(const ModelHandle& handle) {
  const py::gil_scoped_release release;
  const PageParts parts = parts_of_pages();
  try {
    const auto compiled = handle.compiled();
    return model_page(parts, drawing(*compiled->scene, compiled->model)).html;
  } catch (const Error& error) {
    return model_page(parts, drawing(handle.scene(), error.what())).html;
  }
}

std::shared_ptr<Table> read_table(const std::string& where) {
  const py::gil_scoped_release release;
  const History history = read_history(where);
  auto table = std::make_shared<Table>();
  table->columns = history.columns;
  table->numbers.reserve(history.rows() * history.columns.size());
  for (std::size_t row = 0; row < history.rows(); ++row)
    for (const std::vector<double>& column : history.values) table->numbers.push_back(column[row]);
  return table;
}

py::object values_of(const py::object& self, const std::string& name, const std::string& model) {
  const auto& table = py::cast<const Table&>(self);
  const Range range = find_columns(table.columns, name, model);
  const auto rows = static_cast<py::ssize_t>(table.rows());
  const auto row = static_cast<py::ssize_t>(table.columns.size() * sizeof(double));
  const double* const first = table.numbers.data() + range.first;
  if (range.is_column) return view(first, {rows}, {row}, self);
  return view(first, {rows, static_cast<py::ssize_t>(range.count)}, {row, sizeof(double)}, self);
}

}  // namespace

std::shared_ptr<const Compiled> ModelHandle::compiled() const {
  const std::scoped_lock lock(mutex_);
  if (!compiled_) compiled_ = std::make_shared<const Compiled>(Compiled{scene_, compile(*scene_)});
  return compiled_;
}

py::array view(const double* data, std::vector<py::ssize_t> shape, std::vector<py::ssize_t> strides,
               const py::object& owner) {
  py::array array(py::dtype::of<double>(), std::move(shape), std::move(strides), data, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

std::string known_names(const std::string& name, const std::vector<std::string>& known,
                        const char* what) {
  std::vector<std::string_view> words(known.begin(), known.end());
  return suggest(name, words, what);
}

Range find_columns(const std::vector<Column>& columns, const std::string& name,
                   const std::string& model) {
  Range range;
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].name == name) return {i, 1, true};
  for (const auto& of : {&quantity_of, &record_of}) {
    for (std::size_t i = 0; i < columns.size(); ++i)
      if ((*of)(columns[i].name) == name) {
        if (range.count == 0) range.first = i;
        range.count = i - range.first + 1;
      }
    if (range.count > 0) return range;
  }
  std::vector<std::string> known;
  for (const Column& column : columns)
    for (const std::string_view word : {std::string_view(column.name), quantity_of(column.name)})
      if (std::find(known.begin(), known.end(), word) == known.end()) known.emplace_back(word);
  throw UnknownName(fmt::format("{}: \"{}\" is not recorded{}", model, name,
                                known_names(name, known, "columns and quantities")));
}

void bind_model(py::module_& module) {
  py::class_<Table, std::shared_ptr<Table>>(module, "Table", "Rows of a run.")
      .def_property_readonly("columns",
                             [](const Table& table) {
                               std::vector<std::pair<std::string, std::string>> all;
                               for (const Column& c : table.columns)
                                 all.emplace_back(c.name, c.unit);
                               return all;
                             })
      .def_property_readonly(
          "values",
          [](const py::object& self) {
            const auto& table = py::cast<const Table&>(self);
            const auto width = static_cast<py::ssize_t>(table.columns.size());
            return view(table.numbers.data(), {static_cast<py::ssize_t>(table.rows()), width},
                        {width * static_cast<py::ssize_t>(sizeof(double)), sizeof(double)}, self);
          })
      .def_readonly("report", &Table::report)
      .def_readonly("failure", &Table::failure)
      .def_readonly("t", &Table::t)
      .def("get", &values_of, py::arg("name"), py::arg("model"));

  py::class_<ModelHandle, std::shared_ptr<ModelHandle>>(module, "Model", "A model as it was read.")
      .def_static("from_file", &from_file, py::arg("file"), py::arg("set"))
      .def_static("from_text", &from_text, py::arg("text"), py::arg("file"), py::arg("set"))
      .def_static("from_elements", &from_elements, py::arg("root"), py::arg("file"), py::arg("set"))
      .def_property_readonly("name", [](const ModelHandle& m) { return m.scene().name; })
      .def_property_readonly("file", [](const ModelHandle& m) { return m.scene().file; })
      .def_property_readonly("includes", [](const ModelHandle& m) { return m.scene().includes; })
      .def_property_readonly("parameters",
                             [](const ModelHandle& m) {
                               py::dict all;
                               for (const auto& [name, value] : m.scene().parameters)
                                 all[py::str(name)] = value;
                               return all;
                             })
      .def_property_readonly("duration",
                             [](const ModelHandle& m) -> std::optional<double> {
                               if (!m.scene().transient) return std::nullopt;
                               return m.scene().transient->duration;
                             })
      .def("columns",
           [](const ModelHandle& m) {
             std::shared_ptr<const Compiled> compiled;
             {
               const py::gil_scoped_release release;
               compiled = m.compiled();
             }
             std::vector<std::pair<std::string, std::string>> all;
             for (const Column& c : columns(compiled->model)) all.emplace_back(c.name, c.unit);
             return all;
           })
      .def("check",
           [](const ModelHandle& m) {
             const py::gil_scoped_release release;
             const auto compiled = m.compiled();
             return to_json(check_model(*compiled->scene, compiled->model));
           })
      .def("explain",
           [](const ModelHandle& m) {
             const py::gil_scoped_release release;
             const auto compiled = m.compiled();
             return to_json(explain_model(*compiled->scene, compiled->model));
           })
      .def("page", &page_of_model)
      .def(
          "run",
          [](const ModelHandle& m, const py::object& progress, const std::string& method,
             const std::string& step, const std::string& tolerance, const std::string& output,
             const std::string& stages, const std::vector<std::string>& without,
             const std::optional<double>& accuracy, const std::vector<std::string>& quantities,
             double choose_within, bool certify, bool estimate_error, bool motion,
             const std::optional<int>& frames, const std::optional<std::string>& out) {
            return run_model(m,
                             {{method, step, tolerance, output, stages},
                              without,
                              accuracy,
                              quantities,
                              choose_within,
                              certify,
                              estimate_error,
                              motion,
                              frames,
                              out},
                             progress);
          },
          py::arg("progress"), py::arg("method"), py::arg("step"), py::arg("tolerance"),
          py::arg("output"), py::arg("stages"), py::arg("without"), py::arg("accuracy"),
          py::arg("quantities"), py::arg("choose_within"), py::arg("certify"),
          py::arg("estimate_error"), py::arg("motion"), py::arg("frames"), py::arg("out"));

  module.def("read_table", &read_table, py::arg("file_or_directory"));
  module.def("page_of_results", &page_of_results, py::arg("directory"), py::arg("frames"));
}

}  // namespace mbd::python
