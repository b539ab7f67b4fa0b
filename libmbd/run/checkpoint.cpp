#include "libmbd/run/checkpoint.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <span>

#include "libmbd/language/units.hpp"
#include "libmbd/text/files.hpp"
#include "libmbd/text/text.hpp"

namespace mbd {
namespace {

constexpr std::string_view format = "mbd run checkpoint 3";

}  // namespace

CheckpointEvery checkpoint_every(const std::string& text) {
  const auto refuse = [&]() -> Error {
    return Error(
        "--checkpoint-every " + text +
        ": write a time on the clock, as 10min, 30s or 2h, or a number of rows of results, "
        "as 100rows");
  };
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || !(value > 0.0) || !std::isfinite(value)) throw refuse();
  const std::string unit(trimmed(std::string_view(end, text.data() + text.size())));
  CheckpointEvery every;
  if (unit == "rows" || unit == "row") {
    if (value != std::floor(value) || value > 1e15) throw refuse();
    every.rows = static_cast<long>(value);
    return every;
  }
  if (unit.empty()) throw refuse();
  try {
    every.seconds = value * unit_factor(unit, "s");
  } catch (const Error&) {
    throw refuse();
  }
  return every;
}

void RunCheckpoint::archive(Archive& a) {
  RunReport& r = report;
  a(columns, model, output, every, history, stepper.bytes, step, monitor_at, force_most,
    r.sampled_states, r.position.value, r.position.time, r.position.where, r.velocity.value,
    r.velocity.time, r.velocity.where, r.energy_start, r.energy_end, r.energy_least, r.energy_most,
    r.kinetic_most, r.work, r.momentum_start, r.momentum_end, r.most_iterations);
}

void write_checkpoint(const std::filesystem::path& directory, RunCheckpoint& checkpoint) {
  Archive a;
  std::string begins(format);
  a(begins, checkpoint);
  std::vector<char> bytes = a.take();
  const std::uint64_t sum = checksum({bytes.data(), bytes.size()});
  const auto* const first = reinterpret_cast<const char*>(&sum);
  bytes.insert(bytes.end(), first, first + sizeof sum);
  write_file(directory / checkpoint_file, {bytes.data(), bytes.size()});
}

RunCheckpoint read_checkpoint(const std::filesystem::path& directory) {
  const std::filesystem::path file = directory / checkpoint_file;
  const auto refuse = [&](const std::string& what) { return Error(file.string() + ": " + what); };
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw refuse(
        "there is no checkpoint to go on from: the run has come to its end, or was not begun with "
        "--checkpoint-every; leave out --restart");
  const std::vector<char> all{std::istreambuf_iterator<char>(stream), {}};
  std::span<const char> bytes(all);
  std::uint64_t sum = 0;
  if (bytes.size() > sizeof sum) {
    std::memcpy(&sum, &*(bytes.end() - sizeof sum), sizeof sum);
    bytes = bytes.first(bytes.size() - sizeof sum);
  }
  if (bytes.size() == all.size() || sum != checksum({bytes.data(), bytes.size()}))
    throw refuse(
        "is damaged: it is cut off, or has been changed; begin the run anew, without --restart");
  Archive a(bytes);
  std::string begins;
  a(begins);
  if (begins != format)
    throw refuse("is of another version of mbd; begin the run anew, without --restart");
  RunCheckpoint checkpoint;
  a(checkpoint);
  return checkpoint;
}

}  // namespace mbd
