#include "libmbd/study/sweep/rows.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <sstream>

#include "libmbd/core/error.hpp"
#include "libmbd/text/files.hpp"
#include "libmbd/text/text.hpp"

namespace mbd {
namespace {

using Status = SweepRow::Status;

constexpr std::array<std::string_view, 5> words_of_status = {"open", "done", "failed", "refused",
                                                             "lost"};
constexpr std::string_view rows_heading = "mbd sweep rows 1";

std::string shielded(std::string_view text) {
  std::string all;
  for (const char c : text) {
    if (c == '\\')
      all += "\\\\";
    else if (c == '\n')
      all += "\\n";
    else if (c == '\t')
      all += "\\t";
    else if (c == '\r')
      all += ' ';
    else
      all += c;
  }
  return all;
}

std::string unshielded(std::string_view text) {
  std::string all;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\' || i + 1 == text.size()) {
      all += text[i];
      continue;
    }
    const char c = text[++i];
    all += c == 'n' ? '\n' : c == 't' ? '\t' : c;
  }
  return all;
}

std::vector<std::string_view> tabbed(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find('\t', at), line.size());
    cells.push_back(line.substr(at, end - at));
    at = end + 1;
  }
  return cells;
}

bool read_number(std::string_view text, double& value) {
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  return code == std::errc() && end == text.data() + text.size();
}

}  // namespace

std::string_view word_of(Status status) {
  return words_of_status[static_cast<std::size_t>(status)];
}

Status status_of(std::string_view word) {
  const auto found = std::find(words_of_status.begin(), words_of_status.end(), word);
  if (found == words_of_status.end())
    throw Error(fmt::format("\"{}\" is no status of a row; there are {}", excerpt(word),
                            fmt::join(words_of_status, ", ")));
  return static_cast<Status>(found - words_of_status.begin());
}

std::string line_of(const SweepRow& row) {
  return fmt::format("{}\t{}\t{}\t{}\t{}\n", word_of(row.status), row.t, row.cpu,
                     fmt::join(row.values, " "), shielded(row.message));
}

std::optional<SweepRow> row_of(std::string_view line, std::size_t columns) {
  const std::vector<std::string_view> cells = tabbed(line);
  if (cells.size() != 5) return std::nullopt;
  const auto word = std::find(words_of_status.begin(), words_of_status.end(), cells[0]);
  SweepRow row;
  if (word == words_of_status.end() || !read_number(cells[1], row.t) ||
      !read_number(cells[2], row.cpu))
    return std::nullopt;
  row.status = static_cast<Status>(word - words_of_status.begin());
  std::string_view values = cells[3];
  while (!values.empty()) {
    const std::size_t end = std::min(values.find(' '), values.size());
    double value = 0.0;
    if (!read_number(values.substr(0, end), value)) return std::nullopt;
    row.values.push_back(value);
    values.remove_prefix(std::min(end + 1, values.size()));
  }
  if (row.status == Status::open || row.values.size() != (row.status == Status::done ? columns : 0))
    return std::nullopt;
  row.message = unshielded(cells[4]);
  return row;
}

std::string key_of(const SweepPlan& plan, std::size_t point) {
  std::string key;
  for (std::size_t i = 0; i < plan.parameters.size(); ++i)
    key += (i > 0 ? "," : "") + plan.parameters[i] + "=" + shielded(plan.points[point][i]);
  return key;
}

KeptRows::KeptRows(const std::filesystem::path& directory, const std::string& name,
                   const std::string& fingerprint, std::size_t columns)
    : directory_(directory),
      own_(directory / name),
      head_(fmt::format("{}\n{}\n", rows_heading, shielded(fingerprint))),
      columns_(columns) {
  make_directory(directory);
  open_own();
  look_again();
}

KeptRows::~KeptRows() { leave(); }

void KeptRows::leave() {
  if (out_ >= 0) ::close(out_);
  out_ = -1;
}

void KeptRows::open_own() {
  out_ =
      ::open(own_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
  struct stat facts {};
  if (out_ < 0 || ::fstat(out_, &facts) != 0) fail();
  if (!S_ISREG(facts.st_mode))
    throw Error(own_.string() + ": is no file; remove it, or choose another directory with --out");
  // A system of files that knows no locks does without.
  if (::flock(out_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    leave();
    throw Error(
        own_.string() +
        ": another sweep, or the same share of one, is at work here; wait for it, or choose "
        "another directory with --out");
  }
  std::ostringstream all;
  all << std::ifstream(own_, std::ios::binary).rdbuf();
  const std::string text = all.str();
  // Only ever shortened to whole lines: whenever it is killed, what was done stays.
  const bool same = text.starts_with(head_);
  const std::size_t whole = same ? text.rfind('\n') + 1 : 0;
  if (whole < text.size() && ::ftruncate(out_, static_cast<off_t>(whole)) != 0) fail();
  if (!same && ::write(out_, head_.data(), head_.size()) != static_cast<ssize_t>(head_.size()))
    fail();
  if (same) read(own_, text);
}

const SweepRow* KeptRows::find(const std::string& key) const {
  const auto found = rows_.find(key);
  return found == rows_.end() ? nullptr : &found->second;
}

void KeptRows::take(const std::string& key, SweepRow row) {
  SweepRow& there = rows_[key];
  if (row.status == Status::lost && there.status != Status::open) return;  // tried again elsewhere
  there = std::move(row);
}

void KeptRows::read(const std::filesystem::path& file, std::string_view text) {
  std::uintmax_t& from = read_[file];
  if (from == 0) {
    if (!text.starts_with(head_)) return;
    from = head_.size();
    text.remove_prefix(head_.size());
  }
  for (std::size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
    const std::string_view line = text.substr(0, end);
    const std::size_t tab = line.find('\t');
    if (tab != std::string_view::npos)
      if (auto row = row_of(line.substr(tab + 1), columns_))
        take(std::string(line.substr(0, tab)), std::move(*row));
    from += end + 1;
    text.remove_prefix(end + 1);
  }
}

void KeptRows::look_again() {
  std::error_code code;
  std::filesystem::directory_iterator entries(directory_, code);
  for (; !code && entries != std::filesystem::directory_iterator(); entries.increment(code)) {
    const std::filesystem::path& file = entries->path();
    const std::string name = file.filename().string();
    if (file == own_ || !name.starts_with("sweep.") || !name.ends_with(".rows")) continue;
    const std::uintmax_t size = std::filesystem::file_size(file, code);
    std::uintmax_t& from = read_[file];
    if (code || size < from) from = 0;  // begun anew
    if (code || size == from) {
      code.clear();
      continue;
    }
    std::ifstream stream(file, std::ios::binary);
    stream.seekg(static_cast<std::streamoff>(from));
    std::ostringstream more;
    more << stream.rdbuf();
    read(file, more.str());
  }
}

void KeptRows::add(const std::string& key, const SweepRow& row) {
  const std::string line = key + "\t" + line_of(row);
  for (std::size_t done = 0; done < line.size();) {
    const ssize_t n = ::write(out_, line.data() + done, line.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail();
    done += static_cast<std::size_t>(n);
  }
  rows_[key] = row;
}

void KeptRows::fail() const {
  throw Error(fmt::format("{}: cannot be written ({}); check the disk and its permissions",
                          own_.string(), std::strerror(errno)));
}

}  // namespace mbd
