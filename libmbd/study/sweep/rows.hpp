// What a point of a sweep gives, as a line of text: what its process says, and what is kept in files that several processes,
// on one machine or on many that see one directory, write side by side.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/study/sweep/plan.hpp"

namespace mbd {

struct SweepRow {
  // done; failed: the run ended too early; refused: the model is wrong there, or does not start; lost: the process ended
  // without a word (a signal, no memory).
  enum class Status { open, done, failed, refused, lost } status = Status::open;
  double t = 0.0, cpu = 0.0;   // reached, and CPU time of the process [s]
  std::vector<double> values;  // by column of the study; of done ones only
  std::string message;         // why it is not done
};

std::string_view word_of(SweepRow::Status status);
// Throws Error for a word that is none.
SweepRow::Status status_of(std::string_view word);

// Status, t, CPU time, values and message with tabs between them, and the end of the line.
std::string line_of(const SweepRow& row);
// Of such a line without its end; nothing for what is not one with that many values.
std::optional<SweepRow> row_of(std::string_view line, std::size_t columns);

// A point by its names and values.
std::string key_of(const SweepPlan& plan, std::size_t point);

// Files sweep.rows and sweep.*.rows of a directory: a heading, the fingerprint, then a line for each row as it came. Each is
// written by one process at a time, which only adds to it; all are read. What a killed program leaves of the last line is
// not believed, nor is a file of another fingerprint.
class KeptRows {
 public:
  // Reads all of them. The process's own, `name`, is locked while this lives. Throws Error where another has it, and for
  // what cannot be written.
  KeptRows(const std::filesystem::path& directory, const std::string& name,
           const std::string& fingerprint, std::size_t columns);
  ~KeptRows();
  KeptRows(const KeptRows&) = delete;
  KeptRows& operator=(const KeptRows&) = delete;

  const SweepRow* find(const std::string& key) const;
  // On disk when it returns, as far as the system tells. Throws Error.
  void add(const std::string& key, const SweepRow& row);
  // Reads what other processes have added meanwhile.
  void look_again();
  // Lets the lock go, or, in a process that was forked, leaves it to its parent. Nothing can be added after it.
  void leave();

 private:
  void open_own();
  void read(const std::filesystem::path& file, std::string_view text);
  void take(const std::string& key, SweepRow row);
  [[noreturn]] void fail() const;

  std::filesystem::path directory_, own_;
  std::string head_;
  std::size_t columns_ = 0;
  int out_ = -1;
  std::map<std::filesystem::path, std::uintmax_t> read_;  // bytes, up to the end of a line
  std::map<std::string, SweepRow> rows_;
};

}  // namespace mbd
