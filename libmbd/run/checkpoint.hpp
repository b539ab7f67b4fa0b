// The whole of a run between two steps, in a file of its results' directory: from it the run goes on as if it had not ended, to
// the last bit of history.csv.
#pragma once

#include <filesystem>
#include <string>

#include "libmbd/results/report.hpp"
#include "solvers/time/stepper.hpp"

namespace mbd {

inline constexpr const char* checkpoint_file = "checkpoint.bin";

// When checkpoints are written. The stepper makes itself ready for one at instants that do not depend on the machine's speed:
// after every `rows` rows of results, or, with `seconds` of the clock on the wall, at 256 equal parts of the duration, of which
// those are written that are due.
struct CheckpointEvery {
  double seconds = 0.0;
  long rows = 0;
  static constexpr int parts = 256;

  bool operator==(const CheckpointEvery&) const = default;
};
// "10min", "30 s", "2h", or "100rows". Throws Error for anything else.
CheckpointEvery checkpoint_every(const std::string& text);

struct RunCheckpoint {
  std::string columns;  // names and units of history.csv
  std::string model;    // its parameters, and checksums of its file and of those it includes
  std::string output;   // when rows are written
  CheckpointEvery every;
  std::string history;  // the file, as far as it goes
  Checkpoint stepper;
  long step = 0;            // steps taken
  double monitor_at = 0.0;  // the next state that is looked at [s]
  double force_most = 0.0;  // of the report, as of states looked at so far:
  RunReport report = {};

  void archive(Archive& a);
};

// Throw Error, naming the file, where it cannot be written, is not there, is damaged or is of another version.
void write_checkpoint(const std::filesystem::path& directory, RunCheckpoint& checkpoint);
RunCheckpoint read_checkpoint(const std::filesystem::path& directory);

}  // namespace mbd
