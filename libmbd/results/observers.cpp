#include "libmbd/results/observers.hpp"

#include <charconv>
#include <cmath>

#include "libmbd/results/report.hpp"

namespace mbd {
namespace {

constexpr std::size_t most_buffered = 1 << 16;  // [bytes]
constexpr auto longest_kept = std::chrono::milliseconds(500);

std::string one_line(std::string text) {
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  return text;
}

// A State without rates is one of load steps.
bool is_static(const Model& model) { return model.initial.V.empty(); }

}  // namespace

std::vector<Column> columns(const Model& model) {
  std::vector<Column> all;
  if (is_static(model))
    all.push_back({"load_factor", ""});
  else
    all.push_back({"time", "s"});
  for (const Channel& channel : model.channels)
    all.insert(all.end(), channel.columns.begin(), channel.columns.end());
  return all;
}

Index sample_row(const Model& model, const State& state, std::span<double> row) {
  row[0] = is_static(model) ? state.load_factor : state.t;
  std::size_t at = 1;
  for (const Channel& channel : model.channels) {
    channel.sample(state, row.subspan(at, channel.columns.size()));
    at += channel.columns.size();
  }
  for (std::size_t i = 0; i < row.size(); ++i)
    if (!std::isfinite(row[i])) return static_cast<Index>(i);
  return -1;
}

HistoryWriter::HistoryWriter(const std::filesystem::path& file, const std::string& model_name,
                             std::span<const Column> columns, const std::string& run)
    : file_(file), flushed_(std::chrono::steady_clock::now()) {
  buffer_ = "# model: " + one_line(model_name) + "\n# mbd " + std::string(version()) + "\n";
  if (!run.empty()) buffer_ += "# run: " + run + "\n";
  buffer_ += "# units: ";
  std::string header;
  for (const Column& column : columns) {
    const std::string_view comma = &column == columns.data() ? "" : ",";
    buffer_.append(comma.empty() ? "" : ", ").append(column.unit.empty() ? "1" : column.unit);
    header.append(comma).append(column.name);
  }
  buffer_ += "\n" + header + "\n";
  flush();
}

HistoryWriter::~HistoryWriter() {
  try {
    flush();
  } catch (...) {  // nobody is left who could be told
  }
}

void HistoryWriter::accepted(const Sample& sample) { write_row(sample.row); }

void HistoryWriter::write_row(std::span<const double> row) {
  constexpr std::size_t longest_number = 32;
  const std::size_t before = buffer_.size();
  buffer_.resize(before + row.size() * (longest_number + 1));
  char* at = buffer_.data() + before;
  for (const double value : row) {
    at = std::to_chars(at, at + longest_number, value).ptr;
    *at++ = ',';
  }
  at[-1] = '\n';
  buffer_.resize(static_cast<std::size_t>(at - buffer_.data()));
  ++rows_;
  if (buffer_.size() >= most_buffered ||
      std::chrono::steady_clock::now() - flushed_ >= longest_kept)
    flush();
}

void HistoryWriter::flush() {
  const std::string piece = std::move(buffer_);
  buffer_.clear();
  flushed_ = std::chrono::steady_clock::now();
  if (!piece.empty()) file_.append(piece);
}

void HistoryWriter::finished(const RunReport& /*report*/) {
  flush();
  file_.close();
}

}  // namespace mbd
