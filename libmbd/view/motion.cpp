#include "libmbd/view/motion.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "libmbd/core/error.hpp"
#include "libmbd/text/text.hpp"

namespace mbd {
namespace {

static_assert(std::endian::native == std::endian::little, "motion.bin has the least byte first");

constexpr std::size_t most_kept = 1 << 13;  // numbers: 64 kB, which the processor still holds
constexpr auto longest_kept = std::chrono::milliseconds(500);
constexpr std::string_view format = "mbd motion 2";
constexpr std::size_t most_in_a_row = 1ULL << 40;

using Json = nlohmann::ordered_json;

// The head of a file: what it says of its rows, the checksum of its drawing, the drawing.
constexpr std::string_view before_drawing = ",\"drawing\":", after_drawing = "}";

std::string_view drawing_in(std::string_view head) {
  const std::size_t begin = head.find(before_drawing) + before_drawing.size();
  const std::size_t end = head.rfind(after_drawing);
  return end == std::string_view::npos || end < begin ? "" : head.substr(begin, end - begin);
}

}  // namespace

MotionBlocks motion_blocks(const Model& model) {
  MotionBlocks blocks;
  const auto nodes = static_cast<std::size_t>(model.system->nodes() - 1);
  blocks.pose = 7 * nodes;
  blocks.twist = model.system->with_rates() ? 6 * nodes : 0;
  for (const Model::Line& line : model.lines) blocks.resultant += 6 * line.stations.size();
  blocks.joint = 7 * model.joints.size();
  return blocks;
}

void motion_row(const Model& model, const State& state, std::span<double> row) {
  auto out = row.begin();
  const auto put = [&out](const auto& vector) {
    for (Index i = 0; i < vector.size(); ++i) *out++ = vector(i);
  };
  *out++ = model.system->with_rates() ? state.t : state.load_factor;
  for (std::size_t n = 1; n < state.pose.size(); ++n) {
    put(state.pose[n].r);
    put(state.pose[n].p.coeffs());  // x, y, z, w
  }
  for (std::size_t n = 1; n < state.V.size(); ++n) put(state.V[n]);
  std::vector<Vec6> resultants;
  for (const Model::Line& line : model.lines) {
    resultants.resize(line.stations.size());
    line.resultants(state, resultants);
    for (const Vec6& resultant : resultants) put(resultant);
  }
  for (const Model::JointFrames& joint : model.joints) {
    *out++ = joint.angle ? joint.angle(state) : 0.0;
    put(joint.reaction(state));
  }
}

MotionWriter::MotionWriter(const std::filesystem::path& file, std::string_view drawing,
                           const MotionBlocks& blocks, const std::string& run)
    : file_(file), flushed_(std::chrono::steady_clock::now()) {
  Json head = {{"format", format},
               {"row", blocks.size()},
               {"blocks",
                {{"key", blocks.key},
                 {"pose", blocks.pose},
                 {"twist", blocks.twist},
                 {"resultant", blocks.resultant},
                 {"joint", blocks.joint}}}};
  head["checksum"] = checksum(drawing);
  if (!run.empty()) head["run"] = run;
  std::string line = head.dump(-1, ' ', false, Json::error_handler_t::replace);
  line.pop_back();
  line.append(before_drawing).append(drawing).append(after_drawing);
  line.append((8 - (line.size() + 1) % 8) % 8, ' ');
  file_.append(line + "\n");
}

MotionWriter::~MotionWriter() {
  try {
    flush();
  } catch (...) {  // nobody is left who could be told
  }
}

void MotionWriter::write(std::span<const double> row) {
  rows_.insert(rows_.end(), row.begin(), row.end());
  if (rows_.size() >= most_kept || std::chrono::steady_clock::now() - flushed_ >= longest_kept)
    flush();
}

void MotionWriter::flush() {
  flushed_ = std::chrono::steady_clock::now();
  if (rows_.empty()) return;
  try {
    file_.append({reinterpret_cast<const char*>(rows_.data()), rows_.size() * sizeof(double)});
  } catch (...) {
    rows_.clear();  // not tried again
    throw;
  }
  rows_.clear();
}

void MotionWriter::close() {
  flush();
  file_.close();
}

Motion read_motion(const std::filesystem::path& file) {
  const auto fail = [&file](const std::string& what) -> void {
    throw Error(file.string() + ": " + what + "; run the model again with --motion");
  };
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw Error(file.string() + ": cannot be read (" + std::strerror(errno) +
                "); run the model with --motion, or state <motion_output/> in it");
  Motion motion;
  motion.file = file;
  std::getline(stream, motion.head);
  if (stream.eof()) fail("is cut short, or not the motion of a run");
  const Json head = Json::parse(motion.head, nullptr, false);
  try {
    if (head.is_discarded() || head.at("format") != format) fail("is not the motion of a run");
    const Json& blocks = head.at("blocks");
    const auto count = [&](const char* name) {
      const Json& value = blocks.at(name);
      if (!value.is_number_unsigned() || value.get<std::size_t>() > most_in_a_row)
        fail("contradicts itself");
      return value.get<std::size_t>();
    };
    motion.blocks = {count("key"), count("pose"), count("twist"), count("resultant"),
                     count("joint")};
    if (motion.blocks.key != 1 || head.at("row") != motion.blocks.size() ||
        !head.at("drawing").is_object())
      fail("contradicts itself");
    // Places of nodes, sides, triangles: who draws looks them up as they stand.
    if (head.at("checksum") != checksum(drawing_in(motion.head))) fail("is damaged");
    motion.run = head.value("run", "");
  } catch (const Json::exception&) {
    fail("is not the motion of a run");
  }
  std::error_code code;
  const auto bytes = std::filesystem::file_size(file, code);
  const std::size_t begin = motion.head.size() + 1;
  if (code || bytes < begin) fail("cannot be read");
  motion.rows = (bytes - begin) / (sizeof(double) * motion.blocks.size());
  if (motion.rows == 0) fail("holds no frame");
  return motion;
}

namespace {

// `count` numbers from the start of each of some rows.
std::vector<double> read_rows(const Motion& motion, std::span<const std::size_t> rows,
                              std::size_t count) {
  std::vector<double> numbers(rows.size() * count);
  std::ifstream stream(motion.file, std::ios::binary);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    stream.seekg(static_cast<std::streamoff>(motion.head.size() + 1 +
                                             rows[i] * motion.blocks.size() * sizeof(double)));
    stream.read(reinterpret_cast<char*>(numbers.data() + i * count),
                static_cast<std::streamsize>(count * sizeof(double)));
    if (!stream)
      throw Error(motion.file.string() +
                  ": cannot be read to its end; check the disk, or run the model again");
  }
  return numbers;
}

}  // namespace

std::vector<double> read_motion_rows(const Motion& motion, std::span<const std::size_t> rows) {
  return read_rows(motion, rows, motion.blocks.size());
}

std::vector<double> read_motion_keys(const Motion& motion) {
  std::vector<std::size_t> rows(motion.rows);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  return read_rows(motion, rows, 1);
}

void blend_rows(std::vector<double>& a, const std::vector<double>& b, double u,
                const MotionBlocks& blocks) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (i == 0 || i > blocks.pose || (i - 1) % 7 != 3) {
      a[i] += u * (b[i] - a[i]);
      continue;
    }
    double dot = 0.0, length = 0.0;
    for (std::size_t k = 0; k < 4; ++k) dot += a[i + k] * b[i + k];
    for (std::size_t k = 0; k < 4; ++k) {
      a[i + k] = (1.0 - u) * a[i + k] + (dot < 0.0 ? -u : u) * b[i + k];
      length += a[i + k] * a[i + k];
    }
    for (std::size_t k = 0; k < 4; ++k) a[i + k] /= std::sqrt(length);
    i += 3;
  }
}

std::vector<std::size_t> evenly_chosen(std::size_t all, std::size_t count) {
  std::vector<std::size_t> rows;
  if (count >= all) count = all;
  for (std::size_t k = 0; k < count; ++k)
    rows.push_back(count == 1 ? all - 1 : (k * (all - 1) + (count - 1) / 2) / (count - 1));
  return rows;
}

}  // namespace mbd
