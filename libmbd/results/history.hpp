// Results read back: history.csv, or any table of numbers with a line of column names.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libmbd/compile/model.hpp"

namespace mbd {

// A table of finite numbers: at least one column and one row, names of columns unique and not empty.
struct History {
  std::filesystem::path file;
  std::vector<Column> columns;              // units as the file gives them, "" for pure numbers
  std::vector<std::vector<double>> values;  // values[column][row]
  std::vector<int> lines;                   // of the file, for each row
  std::string run;                          // which it is of (history.hpp); "": not said
  std::vector<std::string> notes;           // what was left out, for the user

  std::size_t rows() const { return lines.size(); }
};

// Reads a file, or history.csv in a directory. Lines that begin with # are comments, but for
// "# units: s, m, …"; blank lines are skipped. A last line without end that is not a whole row, as a killed
// program leaves it, is left out with a note; if mbd wrote the file, whatever that line holds. Of a file that says which run
// it is of, notes say what report.json beside it gives reason to doubt.
// Throws Error with file, line and remedy: no such file, not text, no header or rows, empty or repeated
// names, a row of another length, a cell that is not a finite number.
History read_history(const std::filesystem::path& file_or_directory);

// "C.displacement" of the column "C.displacement.3"; of others their whole name.
std::string_view quantity_of(std::string_view column);
// "C" of the column "C.displacement.3"; of a name without a dot, all of it.
std::string_view record_of(std::string_view column);

// Columns by name: a column, a quantity (its components) or a record (all its columns), in the order of
// the names, each once. No names: all but the first column. Throws Error with the nearest spelling and the
// records there are.
std::vector<std::size_t> choose_columns(const History& history, std::span<const std::string> names);

// One column. Throws Error with the nearest spelling.
std::size_t choose_column(const History& history, const std::string& name);

// ---- which run a file is of ---------------------------------------------------------------------
// A word of its own in history.csv, report.json, motion.bin and run.h5, so that those who read one of them can tell whether what lies
// beside it is of the same run, and how that run ended.

// 16 random hexadecimal digits.
std::string new_run_id();

// Of the text of a history.csv, or the beginning of it; empty where it does not say.
std::string run_id_in(std::string_view history);

// For the user of results in `directory` that are of the run `id` ("": of a version that did not say): `file` and
// report.json are of different runs; there is no report.json (the run goes on, or was killed); the run failed. Sentences.
std::vector<std::string> doubts_about_run(const std::filesystem::path& file, std::string_view id);

}  // namespace mbd
