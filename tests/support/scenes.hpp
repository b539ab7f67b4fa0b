// Runs scenes into tables, and measures errors and orders of accuracy.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "libmbd/language/reader.hpp"
#include "libmbd/run/run.hpp"
#include "tests/support/csv.hpp"

namespace mbd::test {

inline constexpr Metric all_metrics[] = {Metric::matrix, Metric::quaternion, Metric::geodesic};
inline constexpr Form all_forms[] = {Form::energy, Form::paper};

inline std::string name_of(Metric metric) {
  return metric == Metric::matrix       ? "matrix"
         : metric == Metric::quaternion ? "quaternion"
                                        : "geodesic";
}
inline std::string name_of(Form form) { return form == Form::energy ? "energy" : "paper"; }

// A model without what only its default run can meet or draw.
inline Scene model_scene(const std::string& name, const Overrides& overrides = {}) {
  Scene scene =
      read_model(std::filesystem::path(MBD_SOURCE_DIR) / "models" / (name + ".xml"), overrides);
  scene.expects.clear();
  scene.plots.clear();
  return scene;
}

inline Scene with(Scene scene, Metric metric, Form form) {
  for (BeamScene& beam : scene.beams) {
    beam.metric = metric;
    beam.form = form;
  }
  return scene;
}

inline Table reference_table(const std::string& name) {
  return read_csv(std::filesystem::path(MBD_SOURCE_DIR) / "tests" / "reference" / (name + ".csv"));
}

// Keeps every n-th accepted state, the first among them.
class TableMaker : public Observer {
 public:
  explicit TableMaker(long every) : every_(every) {}
  void accepted(const Sample& sample) override {
    if (table.names.empty()) {
      for (const Column& column : columns(sample.model)) table.names.push_back(column.name);
      table.columns.resize(table.names.size());
    }
    if (count_++ % every_ != 0) return;
    for (std::size_t i = 0; i < sample.row.size(); ++i) table.columns[i].push_back(sample.row[i]);
  }
  Table table;

 private:
  long every_, count_ = 0;
};

struct History {
  RunReport report;
  Table table;
};

// Without the second run that estimates the error in time: tests compare with references.
inline History run_to_table(const Scene& scene, long every = 1) {
  TableMaker maker(every);
  History history;
  history.report = run(scene, {.observers = {&maker}, .estimate_error = false});
  history.table = std::move(maker.table);
  return history;
}

// Columns x_i of one quantity and y_i of its reference, rows [begin, end): sqrt(sum |x - y|^2 / sum |y|^2).
inline double relative_rms(const std::vector<const std::vector<double>*>& x,
                           const std::vector<const std::vector<double>*>& y, std::size_t begin,
                           std::size_t end) {
  double error = 0.0, size = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t k = begin; k < end; ++k) {
      error += std::pow(x[i]->at(k) - y[i]->at(k), 2);
      size += std::pow(y[i]->at(k), 2);
    }
  }
  return std::sqrt(error / size);
}

// Slopes log(e_k / e_(k+1)) / log(h_k / h_(k+1)).
inline std::vector<double> orders(std::span<const double> h, std::span<const double> error) {
  std::vector<double> order;
  for (std::size_t k = 0; k + 1 < h.size(); ++k)
    order.push_back(std::log(error[k] / error[k + 1]) / std::log(h[k] / h[k + 1]));
  return order;
}

// Least-squares slope of log(error) against log(h).
inline double fitted_order(std::span<const double> h, std::span<const double> error) {
  const auto n = static_cast<double>(h.size());
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (std::size_t k = 0; k < h.size(); ++k) {
    const double a = std::log(h[k]), b = std::log(error[k]);
    x += a, y += b, xx += a * a, xy += a * b;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

// Errors of runs in steps h, and the orders that they show.
struct StepErrors {
  std::vector<double> position, velocity, reaction;

  std::string in_words(std::span<const double> h) const {
    const auto of = [&](const char* what, const std::vector<double>& error) {
      return std::string(what) + ' ' + testing::PrintToString(fitted_order(h, error)) + ' ' +
             testing::PrintToString(error);
    };
    return of("position", position) + ", " + of("velocity", velocity) + ", " +
           of("reaction", reaction);
  }
};

}  // namespace mbd::test
