#include "libmbd/pictures/shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libmbd/results/report.hpp"
#include "libmbd/text/svg.hpp"

namespace mbd {
namespace {

constexpr std::size_t most_shapes = 12;  // more would be a muddle
constexpr int pieces = 8;                // of the curve between two nodes
constexpr double picture_width = 360.0, most_height = 480.0, border = 12.0, letter_size = 11.0,
                 line_height = 16.0;

struct Style {
  const char* colour;
  const char* dashes;
};
constexpr Style styles[] = {
    {"#999999", "none"}, {"#000000", "none"},    {"#0072b2", "none"}, {"#d55e00", "6 2"},
    {"#009e73", "2 2"},  {"#cc79a7", "8 2 2 2"}, {"#e69f00", "none"}, {"#56b4e9", "4 2"},
};

// The two inertial axes over which the points spread most.
std::array<int, 2> axes_of_view(const Vec3& low, const Vec3& high) {
  const Vec3 size = high - low;
  int least = 2;
  for (const int i : {1, 0})
    if (size(i) < size(least)) least = i;
  return {least == 0 ? 1 : 0, least == 2 ? 1 : 2};
}

}  // namespace

ShapesPlot::ShapesPlot(std::filesystem::path file, std::string title)
    : file_(std::move(file)), title_(std::move(title)) {}

// A cubic between two nodes, along the first axes of their sections.
ShapesPlot::Shape ShapesPlot::shape_of(const Sample& sample, std::string label) {
  Shape shape;
  shape.label = std::move(label);
  const auto pose = [&](int n) -> const Pose<double>& {
    return sample.state.pose[static_cast<std::size_t>(n)];
  };
  for (const Model::Line& line : sample.model.lines) {
    const auto section = [&](std::size_t k) { return line.pose(sample.state.pose, k); };
    const auto reference = [&](std::size_t k) {
      return sample.model.system->reference_pose(line.nodes[k]) * line.frames[k];
    };
    std::vector<Vec3> points{section(0).r};
    for (std::size_t i = 1; i < line.size(); ++i) {
      const Pose<double> A = section(i - 1), B = section(i);
      const double length = (reference(i).r - reference(i - 1).r).norm();
      const Vec3 a = length * (A.p * Vec3(Vec3::UnitX())), b = length * (B.p * Vec3(Vec3::UnitX()));
      for (int k = 1; k <= pieces; ++k) {
        const double s = static_cast<double>(k) / pieces, t = 1.0 - s;
        points.emplace_back(t * t * (1.0 + 2.0 * s) * A.r + s * s * (1.0 + 2.0 * t) * B.r +
                            s * t * (t * a - s * b));
      }
    }
    shape.lines.push_back(std::move(points));
  }
  for (const auto& line : sample.model.rigid_lines) {
    std::vector<Vec3>& points = shape.lines.emplace_back();
    for (const Model::RigidPoint& p : line) points.push_back(pose(p.node) * p.point);
  }
  for (const Model::RigidPoint& body : sample.model.bodies)
    shape.bodies.push_back(pose(body.node) * body.point);
  return shape;
}

void ShapesPlot::accepted(const Sample& sample) {
  const double load = sample.state.load_factor;
  const PathEvent event = sample.model.path ? sample.model.path->event : PathEvent::none;
  if (shapes_.empty()) {
    shapes_.push_back(shape_of(sample, fmt::format("load factor {:.4g}", load)));
  } else if (event != PathEvent::none) {
    int& number = events_[static_cast<std::size_t>(event) - 1];
    ++number;
    if (shapes_.size() < most_shapes)
      shapes_.push_back(
          shape_of(sample, fmt::format("{} {}, {:.6g}", name_of(event), number, load)));
  }
  last_ = shape_of(sample, fmt::format("last, {:.6g}", load));
  is_last_shown_ = event != PathEvent::none && shapes_.size() < most_shapes;
}

void ShapesPlot::finished(const RunReport& /*report*/) {
  if (shapes_.empty()) return;
  if (!is_last_shown_) shapes_.push_back(last_);
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (const Shape& shape : shapes_) {
    const auto include = [&](const Vec3& x) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    };
    for (const auto& line : shape.lines) std::for_each(line.begin(), line.end(), include);
    std::for_each(shape.bodies.begin(), shape.bodies.end(), include);
  }
  const auto [across, up] = axes_of_view(low, high);
  const double wide = std::max(high(across) - low(across), 1e-300), tall = high(up) - low(up);
  const double scale =
      std::min((picture_width - 2.0 * border) / wide, most_height / std::max(tall, 1e-300));
  const double top = 2.0 * line_height + border, bottom = top + scale * tall,
               height = bottom + border + line_height * static_cast<double>(shapes_.size() + 1);
  const auto x = [&, a = across](const Vec3& p) {
    return 0.5 * picture_width + scale * (p(a) - 0.5 * (low(a) + high(a)));
  };
  const auto y = [&, u = up](const Vec3& p) { return bottom - scale * (p(u) - low(u)); };

  std::string body =
      svg::text(border, line_height, title_) +
      svg::text(border, 2.0 * line_height,
                fmt::format("i{} to the right, i{} up; {:.4g} m wide", across + 1, up + 1, wide));
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const Style& style = styles[i < std::size(styles) ? i : 1 + (i - 1) % (std::size(styles) - 1)];
    const std::string stroke =
        fmt::format("stroke=\"{}\" stroke-width=\"{}\" stroke-dasharray=\"{}\"", style.colour,
                    i == 0 ? 2.5 : 1.2, style.dashes);
    for (const auto& line : shapes_[i].lines) {
      std::vector<std::array<double, 2>> points;
      for (const Vec3& p : line) points.push_back({x(p), y(p)});
      body += svg::polyline(points, "fill=\"none\" " + stroke);
    }
    for (const Vec3& p : shapes_[i].bodies)
      body += svg::circle(x(p), y(p), 3.0, fmt::format("fill=\"{}\"", style.colour));
    const double at = bottom + border + line_height * static_cast<double>(i + 1);
    body += svg::line(border, at - 4.0, border + 28.0, at - 4.0, stroke) +
            svg::text(border + 34.0, at, shapes_[i].label);
  }
  write_file(file_, svg::document(
                        {.width = picture_width,
                         .height = height,
                         .letters = letter_size,
                         .more = fmt::format("style=\"max-width:{:.0f}px\"", 2.0 * picture_width)},
                        body));
}

}  // namespace mbd
