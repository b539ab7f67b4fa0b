// Curves as SVG, legible on a phone and in grey: panels below each other, black first, a line style and
// a colour for each curve.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libmbd/front/observers.hpp"

namespace mbd::plot {

using Point = std::array<double, 2>;

// Points of a curve in bounded memory: when there are too many, each run of eight neighbours is replaced
// by those of them with the least and greatest x and y, at most four, in order. So extremes are kept.
class Trace {
 public:
  Trace() = default;
  explicit Trace(std::size_t capacity) : capacity_(capacity) {}
  void add(Point point);
  const std::vector<Point>& points() const { return points_; }

 private:
  void thin();

  std::size_t capacity_ = 1 << 16;
  std::vector<Point> points_;
};

struct Curve {
  std::string label;
  Trace trace;
};

struct Panel {
  std::string title = {}, x_label = {}, y_label = {};
  std::optional<std::array<double, 2>> x_range = {};  // default: what the curves span
  bool x_is_time = false;  // or the load factor: then the curves fill the width
  std::vector<Curve> curves = {};
};

struct Layout {
  int columns = 1;   // of panels
  std::string note;  // a line below the last panel
};

std::string to_svg(std::span<const Panel> panels, const Layout& layout = {});

// Positions of ticks: a step of 1, 2 or 5 times a power of ten, about `wanted` of them in [min, max].
struct Ticks {
  double step = 1.0;
  std::vector<double> at;
};
Ticks make_ticks(double min, double max, int wanted);

}  // namespace mbd::plot

namespace mbd {

// history.svg: the panels of the scene's <plot> elements, or, when it has none, one panel for each
// recorded quantity over time, or over the load factor of load steps.
class HistoryPlot : public Observer {
 public:
  // Throws Error for names that are not columns.
  HistoryPlot(std::filesystem::path file, const Scene& scene, const Model& model);

  void accepted(const Sample& sample) override;
  void finished(const RunReport& report) override;

 private:
  struct Source {  // of one curve
    std::size_t panel, curve;
    std::size_t x, y;  // columns
    double x_scale, y_scale;
  };

  std::filesystem::path file_;
  std::vector<plot::Panel> panels_;
  std::vector<Source> sources_;
  plot::Layout layout_;
};

}  // namespace mbd
