// A model run over many values of its parameters, several at once, each in a process of its own: one table of what came
// out, in which failures are rows too.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/study/sweep/plan.hpp"
#include "libmbd/study/sweep/rows.hpp"

namespace mbd {

// What is kept of a column: its value in the last row of results (the end of a transient, of load steps, of a path), or of
// all rows, each with weight 1: the least, the largest, the largest absolute value, the mean, the root of the mean square.
enum class SweepOf { end, minimum, maximum, largest, mean, rms };

// Of N processes that see one directory each takes every Nth point, wherever it is: a task of a cluster, a rank of MPI.
struct SweepShare {
  std::size_t number = 1, of = 1;  // points number, number + of, … (counted from 1)
};

// Of "2/8". Throws Error for anything else.
SweepShare share_of(std::string_view text);

struct SweepStudy {
  std::string model, file, command;
  SweepPlan plan;
  SweepShare share;
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
  // Where rows are kept as they come, and found again by another sweep of the same `fingerprint` with whatever points and
  // shares: sweep.rows in this directory, or sweep.I-of-N.rows. None: nowhere. Rows that were lost are tried again.
  std::optional<std::filesystem::path> keep = {};
  std::string fingerprint = {}, command = {};
  SweepShare share = {};
  std::function<void(std::size_t done, std::size_t all)> progress = {};  // after each row
  const std::atomic<bool>* interrupted = nullptr;  // becomes true: end with what is there
};

// Reads the model with values of parameters; throws Error as read_model() does.
using ReadSweptModel = std::function<Scene(const Overrides&)>;

// A sweep as it goes: which rows are there and which are to come. run() makes them here; a cluster's workers may in its place
// (add), or other shares of the same directory (look_again).
class SweepTable {
 public:
  // Throws Error when the model can be compiled neither as it is nor at the first point, for unknown quantities and
  // parameters, and where another process has the same share of the same directory.
  SweepTable(const ReadSweptModel& read, const SweepPlan& plan, const SweepOptions& options);
  ~SweepTable();
  SweepTable(const SweepTable&) = delete;
  SweepTable& operator=(const SweepTable&) = delete;

  const SweepStudy& study() const;
  // Points of the share that have no row, or a lost one.
  std::vector<std::size_t> open() const;
  // Keeps a row, on disk too. Throws Error where that cannot be.
  void add(std::size_t point, SweepRow row);
  // Takes over what other shares have kept meanwhile.
  void look_again();
  // Runs what is open, and looks again at the end. Throws Error when there can be no process. Its processes are forked: no
  // other thread may be inside this library.
  void run(const ReadSweptModel& read, const SweepOptions& options);
  // Lets another process have the share, before this goes. No rows are to be added after it.
  void leave();

 private:
  void fill();
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

// A SweepTable that is run. Throws what they throw.
SweepStudy study_sweep(const ReadSweptModel& read, const SweepPlan& plan,
                       const SweepOptions& options);

// One point, in this thread: a row of the values of columns named as in SweepStudy. What is wrong is said in the
// row, but for unknown words after an @ (Error).
SweepRow run_point(const ReadSweptModel& read, const Overrides& values,
                   const std::vector<Column>& columns);

// For the terminal: how many, how long, the first failures.
std::string to_text(const SweepStudy& study);

// A line for each point in the order of the plan: its number, the parameters (without the unit that all values of one
// end with, which the line "# units:" has), status, columns, t, cpu, message. What is not known is empty; cells with commas
// or quotes are in quotes; numbers have as many digits as it takes to read them back.
std::string to_csv(const SweepStudy& study);

}  // namespace mbd
