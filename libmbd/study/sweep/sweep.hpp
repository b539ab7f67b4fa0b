// A model run over many values of its parameters, several at once, each in a process of its own: one table of what came
// out, in which failures are rows too.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/study/sweep/plan.hpp"

namespace mbd {

// What is kept of a column: its value in the last row of results (the end of a transient, of load steps, of a path), or of
// all rows, each with weight 1: the least, the largest, the largest absolute value, the mean, the root of the mean square.
enum class SweepOf { end, minimum, maximum, largest, mean, rms };

struct SweepRow {
  // done; failed: the run ended too early; refused: the model is wrong there, or does not start; lost: the process ended
  // without a word (a signal, no memory).
  enum class Status { open, done, failed, refused, lost } status = Status::open;
  double t = 0.0, cpu = 0.0;   // reached, and CPU time of the process [s]
  std::vector<double> values;  // by column of the study; of done ones only
  std::string message;         // why it is not done
};

struct SweepStudy {
  std::string model, file, command;
  SweepPlan plan;
  std::vector<Column> columns;  // "tip.displacement.3", "tip.displacement.3@maximum"
  std::vector<SweepRow> rows;   // by point
  std::size_t found = 0;        // rows that an earlier sweep had done
  double seconds = 0.0;         // wall time

  std::size_t count(SweepRow::Status status) const;
  bool whole() const { return count(SweepRow::Status::open) == 0; }
};

struct SweepOptions {
  // Names of columns, quantities or records, each with or without "@minimum" …; none: all that is recorded, at the end.
  std::vector<std::string> quantities = {};
  int jobs = 1;  // processes at once
  // Where rows are kept as they come, and found again by another sweep of the same `fingerprint` with whatever points:
  // sweep.rows in this directory. None: nowhere. Rows that were lost are tried again.
  std::optional<std::filesystem::path> keep = {};
  std::string fingerprint = {}, command = {};
  std::function<void(std::size_t done, std::size_t all)> progress = {};  // after each row
  const std::atomic<bool>* interrupted = nullptr;  // becomes true: end with what is there
};

// Reads the model with values of parameters; throws Error as read_model() does.
using ReadSweptModel = std::function<Scene(const Overrides&)>;

// Throws Error when the model can be compiled neither as it is nor at the first point, for unknown quantities, and when there can be
// no process. Its processes are forked: no other thread may be inside this library.
SweepStudy study_sweep(const ReadSweptModel& read, const SweepPlan& plan,
                       const SweepOptions& options);

// For the terminal: how many, how long, the first failures.
std::string to_text(const SweepStudy& study);

// A line for each point in the order of the plan: its number, the parameters (without the unit that all values of one
// end with, which the line "# units:" has), status, columns, t, cpu, message. What is not known is empty; cells with commas
// or quotes are in quotes; numbers have as many digits as it takes to read them back.
std::string to_csv(const SweepStudy& study);

}  // namespace mbd
