#include "libmbd/view/run_file.hpp"

#include <chrono>
#include <fstream>
#include <iterator>
#include <vector>

#include "libmbd/language/quantities.hpp"
#include "libmbd/results/build_facts.hpp"
#include "libmbd/results/report.hpp"
#include "libmbd/text/text.hpp"
#include "libmbd/view/drawing.hpp"
#include "libmbd/view/hdf5.hpp"

namespace mbd {
namespace {

constexpr std::string_view format = "mbd run 1";
constexpr std::size_t most_kept = 1 << 17;  // numbers: 1 MB, so that a full disk leaves something
constexpr std::size_t most_rows = 256;      // of the history, handed over together
constexpr auto longest_kept = std::chrono::milliseconds(500);

std::string unit_of(const std::string& unit) { return unit.empty() ? "1" : unit; }

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void add_model(Hdf5File& file, const Scene& scene) {
  file.add_group("model", {{"name", scene.name}});
  if (scene.file.empty()) return;  // built in C++
  file.add_text("model/text", text_of(scene.file), {{"file", scene.file}});
  for (std::size_t i = 0; i < scene.includes.size(); ++i)
    file.add_text("model/include_" + std::to_string(i + 1), text_of(scene.includes[i]),
                  {{"file", scene.includes[i]}});
}

}  // namespace

void require_hdf5(std::string_view file) {
  const std::string why = why_no_hdf5();
  if (!why.empty()) throw Error(std::string(file) + ": " + why);
}

void add_origin(Hdf5File& file, std::string_view format_of_file, const Scene& scene) {
  file.add_attributes(
      {{"format", std::string(format_of_file)},
       {"model", scene.name},
       {"file", scene.file},
       {"mbd", std::string(version())},
       {"commit", std::string(build_facts().commit) + (build_facts().modified ? ", modified" : "")},
       {"date", utc_now("%Y-%m-%dT%H:%M:%SZ")}});
  Hdf5Attributes parameters;
  for (const auto& [name, value] : scene.parameters) parameters.emplace_back(name, value);
  file.add_group("parameters", parameters);
  add_model(file, scene);
}

struct RunFile::Content {
  // A block of a motion_row(), or a part of each of its items: `width` numbers from `first` on, of every `stride`.
  struct Block {
    Hdf5File::Series series;
    std::size_t begin, count, stride, first, width;
  };

  Content(const std::filesystem::path& path, const Scene& scene, const Model& model,
          const std::string& run, std::span<const Column> columns, std::string_view drawing)
      : file(path) {
    add_origin(file, format, scene);
    file.add_attributes({{"run", run}});
    file.add_text("drawing", std::string(drawing));
    add_history(scene, columns);
    add_motion(model, columns.front());
    report = file.add_bytes("report");
    file.start();
  }

  void add_history(const Scene& scene, std::span<const Column> columns) {
    file.add_group("history");
    for (const Column& column : columns) {
      Hdf5Attributes attributes = {{"unit", unit_of(column.unit)}};
      if (const auto* const quantity = schema::recorded_in(scene, column.name).quantity) {
        attributes.emplace_back("label",
                                std::string(quantity->name) + ": " + std::string(quantity->doc));
        if (const std::string frame(schema::in_words(quantity->axes)); !frame.empty())
          attributes.emplace_back("frame", frame);
      }
      history.push_back(file.add_series("history/" + column.name, {}, attributes));
    }
  }

  void add_motion(const Model& model, const Column& key) {
    const MotionBlocks size = motion_blocks(model);
    const std::size_t nodes = size.pose / 7, points = size.resultant / 6, joints = size.joint / 7;
    file.add_group("motion");
    motion.push_back(
        {file.add_series("motion/" + key.name, {}, {{"unit", unit_of(key.unit)}}), 0, 1, 1, 0, 1});
    // Of `count` items of `stride` numbers each, from `begin` on in a row.
    const auto add = [&](const char* name, std::size_t begin, std::size_t count, std::size_t stride,
                         std::size_t first, std::size_t width, const char* unit, const char* frame,
                         const char* label) {
      if (count == 0) return;
      std::vector<std::size_t> shape = {count};
      if (width > 1) shape.push_back(width);
      Hdf5Attributes attributes = {{"unit", std::string(unit)}, {"label", std::string(label)}};
      if (*frame != '\0') attributes.emplace_back("frame", std::string(frame));
      motion.push_back({file.add_series(std::string("motion/") + name, shape, attributes), begin,
                        count, stride, first, width});
    };
    std::size_t at = size.key;
    add("position", at, nodes, 7, 0, 3, "m", "inertial axes", "of nodes");
    add("quaternion", at, nodes, 7, 3, 4, "1", "from node to inertial axes",
        "unit quaternion (x, y, z, w) of nodes");
    at += size.pose;
    if (size.twist > 0) {
      add("velocity", at, nodes, 6, 0, 3, "m/s", "node axes", "of nodes");
      add("angular_velocity", at, nodes, 6, 3, 3, "rad/s", "node axes", "of nodes");
    }
    at += size.twist;
    add("force", at, points, 6, 0, 3, "N", "section axes", "N Q2 Q3 at quadrature points");
    add("moment", at, points, 6, 3, 3, "N.m", "section axes", "M1 M2 M3 at quadrature points");
    at += size.resultant;
    add("joint_angle", at, joints, 7, 0, 1, "rad", "", "of b relative to a, 0 of joints without");
    add("joint_force", at, joints, 7, 1, 3, "N", "joint axes", "of the joint on b");
    add("joint_moment", at, joints, 7, 4, 3, "N.m", "joint axes",
        "of the joint on b, about its point of b");

    std::vector<std::string> of_nodes, of_joints, of_points;
    std::vector<double> s;
    for (Index n = 1; n < model.system->nodes(); ++n)
      of_nodes.push_back(model.system->node_name(n));
    for (const Model::JointFrames& joint : model.joints) of_joints.push_back(joint.name);
    for (const Model::Line& line : model.lines) {
      of_points.insert(of_points.end(), line.stations.size(), line.name);
      s.insert(s.end(), line.stations.begin(), line.stations.end());
    }
    if (nodes > 0) file.add_texts("motion/nodes", of_nodes);
    if (joints > 0) file.add_texts("motion/joints", of_joints);
    if (points == 0) return;
    file.add_texts("motion/points", of_points);
    file.add_numbers("motion/points_s", s,
                     {{"unit", std::string("1")},
                      {"label", std::string("fraction of the reference length of the beam")}});
  }

  // Rows by columns.
  void hand_over() {
    const std::size_t width = history.size();
    for (std::size_t i = 0; i < width; ++i) {
      part.clear();
      for (std::size_t at = i; at < rows.size(); at += width) part.push_back(rows[at]);
      file.append(history[i], part);
    }
    rows.clear();
  }

  void keep(std::size_t numbers) {
    kept += numbers;
    if (kept < most_kept && std::chrono::steady_clock::now() - flushed < longest_kept) return;
    kept = 0;
    hand_over();
    file.flush();
    flushed = std::chrono::steady_clock::now();
  }

  Hdf5File file;
  std::vector<Hdf5File::Series> history;
  std::vector<Block> motion;
  Hdf5File::Series report = 0;
  std::vector<double> part;
  std::size_t kept = 0;      // numbers, since the last flush
  std::vector<double> rows;  // of the history, not handed over yet
  std::chrono::steady_clock::time_point flushed = std::chrono::steady_clock::now();
};

RunFile::RunFile(const std::filesystem::path& file, const Scene& scene, std::string run)
    : file_(file), scene_(scene), run_(std::move(run)) {}

RunFile::~RunFile() = default;

void RunFile::accepted(const Sample& sample) {
  if (!content_)
    content_ = std::make_unique<Content>(file_, scene_, sample.model, run_, columns(sample.model),
                                         drawing(scene_, sample.model));
  content_->rows.insert(content_->rows.end(), sample.row.begin(), sample.row.end());
  if (content_->rows.size() >= most_rows * sample.row.size()) content_->hand_over();
  content_->keep(sample.row.size());
}

void RunFile::frame(std::span<const double> row) {
  if (!content_) return;  // nothing was accepted
  std::vector<double>& part = content_->part;
  for (const Content::Block& block : content_->motion) {
    part.clear();
    for (std::size_t i = 0; i < block.count; ++i) {
      const auto from = row.subspan(block.begin + i * block.stride + block.first, block.width);
      part.insert(part.end(), from.begin(), from.end());
    }
    content_->file.append(block.series, part);
  }
  content_->keep(row.size());
}

void RunFile::finished(const RunReport& /*report*/) {
  if (!content_) return;
  content_->hand_over();
  content_->file.flush(true);
}

void RunFile::close(std::string_view report) {
  if (!content_) return;
  content_->file.replace(content_->report, report);
  content_->file.close();
}

}  // namespace mbd
