#include "libmbd/results/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <set>
#include <unordered_set>

#include "libmbd/core/error.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/text/files.hpp"
#include "libmbd/text/spelling.hpp"
#include "libmbd/text/text.hpp"

namespace mbd {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view units_line = "# units:", written_by_mbd = "# mbd ", run_line = "# run: ";

std::string_view unquoted(std::string_view text) {
  return text.size() >= 2 && text.front() == '"' && text.back() == '"'
             ? text.substr(1, text.size() - 2)
             : text;
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(',', at), line.size());
    cells.push_back(trimmed(line.substr(at, end - at)));
    at = end + 1;
  }
  return cells;
}

std::optional<double> number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::vector<Column> read_header(const Source& source, std::string_view line) {
  std::vector<Column> columns;
  std::unordered_set<std::string> names;
  for (const std::string_view cell : cells_of(line)) {
    const std::string name(unquoted(cell));
    const std::string which = "column " + std::to_string(columns.size() + 1);
    if (name.empty())
      throw Error(source, which +
                              " has no name; the first line that is no comment must name the "
                              "columns, as in time,C.displacement.1");
    if (number(name))
      throw Error(source, which + " is called " + excerpt(name) +
                              ", a number; the first line that is no comment must name the "
                              "columns, as in time,C.displacement.1: add such a line");
    if (!names.insert(name).second)
      throw Error(source, which + ": there is another column \"" + excerpt(name) +
                              "\"; give each a name of its own");
    columns.push_back({name, ""});
  }
  return columns;
}

// What is wrong with a row, or "".
std::string read_row(std::string_view line, std::span<const Column> columns,
                     std::vector<double>& row) {
  row.clear();
  const std::vector<std::string_view> cells = cells_of(line);
  if (cells.size() != columns.size())
    return "has " + std::to_string(cells.size()) + " cell" + (cells.size() == 1 ? "" : "s") +
           ", the header names " + std::to_string(columns.size()) +
           " columns; every row must have as many cells as there are columns";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::optional<double> value = number(cells[i]);
    if (!value)
      return "column \"" + excerpt(columns[i].name) + "\" holds \"" + excerpt(cells[i]) +
             "\", not a finite number; write it like -1.5e-3";
    row.push_back(*value);
  }
  return {};
}

fs::path file_of(const fs::path& path) {
  constexpr std::string_view where =
      "; name the directory that mbd run wrote (results/MODEL's name) or a CSV file";
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  if (!fs::exists(status))
    throw Error(excerpt(path.string()) + ": there is no such file or directory" +
                std::string(where));
  if (!fs::is_directory(status)) {
    if (!fs::is_regular_file(status))
      throw Error(path.string() + ": is neither a file nor a directory" + std::string(where));
    return path;
  }
  for (const char* name : {"history.csv", "path.csv"})
    if (fs::is_regular_file(path / name, code)) return path / name;
  throw Error(path.string() + ": there is no history.csv in this directory, and no path.csv" +
              std::string(where));
}

void add_units(History& history, const std::string& line) {
  const std::vector<std::string_view> units =
      cells_of(std::string_view(line).substr(units_line.size()));
  if (units.size() != history.columns.size()) {
    history.notes.push_back(history.file.string() + ": the line \"# units:\" has " +
                            std::to_string(units.size()) + " units for " +
                            std::to_string(history.columns.size()) + " columns and is not used");
    return;
  }
  for (std::size_t i = 0; i < units.size(); ++i)
    if (units[i] != "1") history.columns[i].unit = units[i];
}

Error unknown(const History& history, const std::string& name, bool only_columns) {
  std::vector<std::string_view> known, listed;
  std::set<std::string_view> seen;
  for (const Column& column : history.columns) {
    known.emplace_back(column.name);
    if (only_columns) continue;
    for (const std::string_view group : {quantity_of(column.name), record_of(column.name)})
      if (seen.insert(group).second) known.push_back(group);
  }
  seen.clear();
  for (std::size_t i = 1; i < history.columns.size(); ++i) {  // the first is time, no record
    const std::string_view record = record_of(history.columns[i].name);
    if (seen.insert(record).second) listed.push_back(record);
  }
  if (only_columns) listed.assign(known.begin(), known.end());
  const std::string_view near = nearest(name, known);
  return Error(history.file.string() + ": \"" + excerpt(name) + "\" is not a " +
               (only_columns ? "column" : "record, quantity or column") + " of these results" +
               (near.empty() ? "." : "; did you mean \"" + std::string(near) + "\"?") +
               (listed.empty() ? " There are no records; add a <record> to the model"
                               : std::string(" The ") + (only_columns ? "columns" : "records") +
                                     " are: " + list(listed)));
}

// Where a table should begin, there is XML: most often the model, given in place of its results.
Error not_a_table(const History& history, std::string text, std::istream& rest) {
  std::string more(1 << 16, '\0');  // a model may begin with a long comment
  rest.read(more.data(), static_cast<std::streamsize>(more.size()));
  text += more.substr(0, static_cast<std::size_t>(rest.gcount()));
  const std::string file = history.file.string();
  if (text.find("<mbd") != std::string::npos)
    return Error(file + ": is a model, not the results of a run; run it first (mbd run " + file +
                 ") and name the directory of its results");
  return Error(file +
               ": is XML, not a table; name the directory that mbd run wrote, or a CSV file");
}

// Whether a run writes there now.
bool is_being_written(const std::filesystem::path& directory) {
  try {
    const DirectoryLock lock(directory);
    return false;
  } catch (const Error&) {
    return true;
  }
}

std::ifstream open_text(const fs::path& file) {
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw Error(file.string() + ": cannot be read (" + std::strerror(errno) +
                "); check its permissions");
  char beginning[4096];
  stream.read(beginning, sizeof beginning);
  if (std::any_of(beginning, beginning + stream.gcount(), [](char c) {
        return static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\r' && c != '\t';
      }))
    throw Error(file.string() + ": is not text; name a history.csv, the table that mbd run writes");
  stream.clear();
  stream.seekg(0);
  return stream;
}

}  // namespace

History read_history(const fs::path& file_or_directory) {
  History history;
  history.file = file_of(file_or_directory);
  std::ifstream stream = open_text(history.file);

  Source source{history.file.string(), 0};
  std::string units;
  bool ours = false;
  std::vector<double> row;
  for (std::string line; std::getline(stream, line);) {
    const bool has_end = !stream.eof();
    ++source.line;
    if (source.line == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    if (trimmed(line).empty()) continue;
    if (line.starts_with('#')) {
      ours = ours || line.starts_with(written_by_mbd);
      if (line.starts_with(units_line)) units = line;
      if (ours && line.starts_with(run_line))
        history.run = trimmed(std::string_view(line).substr(run_line.size()));
      continue;
    }
    if (history.columns.empty()) {
      if (trimmed(line).starts_with('<')) throw not_a_table(history, line, stream);
      history.columns = read_header(source, line);
      history.values.resize(history.columns.size());
      if (!units.empty()) add_units(history, units);
      continue;
    }
    const std::string wrong = read_row(line, history.columns, row);
    // A number cut short may still be one, so what mbd did not end is not believed.
    if (!has_end && (ours || !wrong.empty())) {
      history.notes.push_back(source.file + ":" + std::to_string(source.line) +
                              ": the last line is cut short and was left out");
      continue;
    }
    if (!wrong.empty()) throw Error(source, "this row " + wrong);
    for (std::size_t i = 0; i < row.size(); ++i) history.values[i].push_back(row[i]);
    history.lines.push_back(source.line);
  }
  if (stream.bad()) throw Error(source, "cannot be read on from here; check the disk");
  if (history.columns.empty())
    throw Error(history.file.string() +
                ": is empty, there is no line with the names of columns; run the model again");
  if (history.rows() == 0)
    throw Error(history.file.string() +
                ": has no rows, its run ended before the first state; run the model again");
  for (std::string& doubt : doubts_about_run(history.file, history.run))
    history.notes.push_back(std::move(doubt));
  return history;
}

std::string_view quantity_of(std::string_view column) {
  const std::size_t dot = column.rfind('.');
  if (dot == std::string_view::npos || dot == 0 || dot + 1 == column.size()) return column;
  const std::string_view component = column.substr(dot + 1);
  const bool digits = component.find_first_not_of("0123456789") == std::string_view::npos;
  return digits ? column.substr(0, dot) : column;
}

std::string_view record_of(std::string_view column) { return column.substr(0, column.find('.')); }

std::vector<std::size_t> choose_columns(const History& history,
                                        std::span<const std::string> names) {
  std::vector<std::size_t> chosen;
  const std::size_t size = history.columns.size();
  if (names.empty()) {
    for (std::size_t i = 1; i < size; ++i) chosen.push_back(i);
    if (chosen.empty())
      throw Error(history.file.string() + ": has only the column \"" +
                  excerpt(history.columns[0].name) + "\"; add a <record> to the model");
    return chosen;
  }
  std::vector<bool> taken(size, false);
  for (const std::string& name : names) {
    // a column first, so that every column can be named
    bool found = false;
    for (const auto& what :
         {+[](std::string_view column) { return column; }, +quantity_of, +record_of}) {
      for (std::size_t i = 0; i < size; ++i)
        if (what(history.columns[i].name) == name) {
          found = true;
          if (!taken[i]) chosen.push_back(i);
          taken[i] = true;
        }
      if (found) break;
    }
    if (!found) throw unknown(history, name, false);
  }
  return chosen;
}

std::size_t choose_column(const History& history, const std::string& name) {
  for (std::size_t i = 0; i < history.columns.size(); ++i)
    if (history.columns[i].name == name) return i;
  throw unknown(history, name, true);
}

std::string new_run_id() {
  std::random_device random;
  std::uint64_t bits = 0;
  for (int i = 0; i < 2; ++i) bits = bits << 32 | (random() & 0xffffffffU);
  return fmt::format("{:016x}", bits);
}

std::string run_id_in(std::string_view history) {
  while (history.starts_with('#')) {
    const std::string_view line = history.substr(0, history.find('\n'));
    if (line.starts_with(run_line)) return std::string(trimmed(line.substr(run_line.size())));
    history.remove_prefix(std::min(line.size() + 1, history.size()));
  }
  return {};
}

std::vector<std::string> doubts_about_run(const std::filesystem::path& file, std::string_view id) {
  namespace fs = std::filesystem;
  if (id.empty()) return {};
  const fs::path directory = file.parent_path().empty() ? fs::path(".") : file.parent_path();
  const fs::path report = directory / "report.json";
  std::error_code code;
  if (!fs::exists(report, code)) {
    if (is_being_written(directory))
      return {
          fmt::format("{}: its run goes on; this is what it has written so far", file.string())};
    return {fmt::format(
        "{}: there is no report.json beside it: its run was killed, or the file has been moved",
        file.string())};
  }
  std::ifstream stream(report, std::ios::binary);
  const auto json = nlohmann::json::parse(stream, nullptr, false);
  const auto word = [&json](const char* name) {
    const auto at = json.is_object() ? json.find(name) : json.end();
    return at != json.end() && at->is_string() ? at->get<std::string>() : std::string();
  };
  if (!json.is_object())
    return {fmt::format("{}: is not what a run writes, and says nothing of {}", report.string(),
                        file.filename().string())};
  if (word("run") != id)
    return {
        fmt::format("{} and {} are of different runs; what the one says does not hold for the "
                    "other",
                    file.string(), report.filename().string())};
  if (const std::string failure = word("failure"); !failure.empty())
    return {fmt::format("{}: its run failed: {}", file.string(), failure)};
  return {};
}

}  // namespace mbd
