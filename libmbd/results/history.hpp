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
  std::vector<std::string> notes;           // what was left out, for the user

  std::size_t rows() const { return lines.size(); }
};

// Reads a file, or history.csv in a directory. Lines that begin with # are comments, but for
// "# units: s, m, …"; blank lines are skipped. A last line without end that is not a whole row, as a killed
// program leaves it, is left out with a note; if mbd wrote the file, whatever that line holds.
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

}  // namespace mbd
