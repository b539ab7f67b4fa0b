// Those who watch a run. A run shows the states of which it writes rows to its observers, in order, with the
// numbers the model records of them: accepted ones, and (row_interval) interpolated between those.
#pragma once

#include <chrono>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/text/files.hpp"

namespace mbd {

struct RunReport;

// One of those states.
struct Sample {
  const Model& model;
  const State& state;
  std::span<const double> row;  // numbers of columns(model), all finite
};

class Observer {
 public:
  virtual ~Observer() = default;

  // An Error thrown here ends the run, which keeps what was accepted before and reports the failure.
  virtual void accepted(const Sample& sample) = 0;

  // After the last state, also of a run that failed.
  virtual void finished(const RunReport& /*report*/) {}
};

// The columns of history.csv: time [s], or of a scene without <transient> load_factor; then those of the
// model's channels.
std::vector<Column> columns(const Model& model);

// Fills a row, as long as columns(model). Returns the first column whose number is not finite, or -1.
Index sample_row(const Model& model, const State& state, std::span<double> row);

// history.csv: lines with #, one line with the names of the columns, then a row for each state, every
// number with as many digits as it takes to read it back exactly.
//   # model: four_bar
//   # mbd 0.1.0
//   # run: 5d0c3f6a91b2e784      (history.hpp)
//   # units: s, rad, m, …
//   time,A.angle,C.displacement.1,…
//   0,0,0,…
// Without <transient> the rows are load steps: the first column is load_factor, 0 in the first row (the
// reference state) and 1 in the last.
// What is on disk is a valid file at any time, at most half a second and 64 KB behind the run.
class HistoryWriter : public Observer {
 public:
  HistoryWriter(const std::filesystem::path& file, const std::string& model_name,
                std::span<const Column> columns, const std::string& run = {});
  ~HistoryWriter() override;  // what was accepted is written, also where a run ends by an exception

  void accepted(const Sample& sample) override;
  void finished(const RunReport& report) override;

  void write_row(std::span<const double> row);
  void flush();
  long rows() const { return rows_; }

 private:
  AppendedFile file_;
  std::string buffer_;
  std::chrono::steady_clock::time_point flushed_;
  long rows_ = 0;
};

}  // namespace mbd
