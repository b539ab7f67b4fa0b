// Curves as SVG, legible on a phone and in grey: panels below each other; curves differ by dashes, markers
// and colour, black first. The picture shrinks to the width it is given; its letters are 11 pixels high
// where that is 360.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libmbd/results/history.hpp"
#include "libmbd/results/observers.hpp"

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

// A curve of 30 points or less has a marker at each of them; where there are several styles, longer ones
// have a few, and those that are zero, or round-off beside the others, have none.
struct Curve {
  std::string label;  // in the legend, which there is for two and more; empty: not there
  Trace trace;
  int style = -1;     // dashes, marker and colour; default: the number of the curve in its panel
  bool wide = false;  // a broad pale line without dashes, under those that are not
  bool points_only = false;  // markers, no line
  bool pale = false;         // thin and grey, below the others: what is there, but does not matter
  bool plain = false;        // no markers
  std::vector<bool> hollow = {};  // by point; where there are some, all other markers are filled
};

// A line across the axes, which then reach it; its text is a line of the legend, where it hides no point.
struct Level {
  double y;
  std::string text;
};

// A right triangle below the line from `from` to `to`, which rises or falls to the right.
struct Slope {
  Point from, to;
  std::string text;  // below it
};

// What changes by less than 1e-6 of its size is drawn as a constant, in a range of 1 % about it. On a
// logarithmic axis there is only what is positive: a curve is interrupted where it is not.
struct Panel {
  std::string title = {}, x_label = {}, y_label = {};
  std::optional<std::array<double, 2>> x_range = {};  // default: what the curves span
  bool x_is_time = false;             // or the load factor: then the curves fill the width
  bool x_log = false, y_log = false;  // logarithmic axes
  std::vector<double> x_ticks = {};   // where there are ticks, if there is room for their labels
  std::vector<Curve> curves = {};
  std::vector<Level> levels = {};
  std::vector<Slope> slopes = {};
};

struct Layout {
  int columns = 1;        // of panels
  std::string note = {};  // below the last panel
  std::string title = {};
  std::string ids = "c";   // beginning of all ids: pictures in one page need different ones
  std::string label = {};  // what it is, for those who do not see it
};

// Long titles and notes are broken into lines, long entries of a legend lose their middle. The axes of all
// panels begin at the same place, right of the widest label of a tick; the labels of y stand beside the
// axes or, when one is too long for that, all above.
std::string to_svg(std::span<const Panel> panels, const Layout& layout = {});

// One panel for each quantity of the chosen columns, its components next to each other, 24 at most.
struct QuantityPanels {
  struct Place {  // of a column's curve
    std::size_t panel, curve, column;
  };
  std::vector<Panel> panels;  // their curves without points
  std::vector<Place> places;
  std::size_t left_out = 0;  // quantities
};
QuantityPanels quantity_panels(std::span<const Column> columns, std::span<const std::size_t> chosen,
                               std::size_t x);

// The SVG of the chosen columns of a history over its column x.
std::string history_svg(const History& history, std::span<const std::size_t> chosen, std::size_t x,
                        const std::string& title = {});

// Throws Error, saying what to do, unless `file` may be the name of a picture: it ends in .svg, is no
// directory and stands in one.
void check_picture(const std::filesystem::path& file);

// Positions of ticks: a step of 1, 2 or 5 times a power of ten, about `wanted` of them in [min, max].
struct Ticks {
  double step = 1.0;
  std::vector<double> at;
};
Ticks make_ticks(double min, double max, int wanted);

// Ticks of a logarithmic axis, 0 < min < max: powers of ten, every n-th if there are more than about `wanted`;
// where there are fewer than three, also their multiples by 2 and 5 (unless fewer than five are wanted and the
// powers are two), or, of a short axis, those of make_ticks. The marks between, without labels, are 2, 3 … 9
// times a power of ten, or the powers left out.
struct LogTicks {
  std::vector<double> at, between;
};
LogTicks make_log_ticks(double min, double max, int wanted);

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
    std::size_t first = curve;  // of a path: that from its start
  };
  void follow_path(const PathPlace& place, std::span<const double> row);

  std::filesystem::path file_;
  std::vector<plot::Panel> panels_;
  std::vector<Source> sources_;
  plot::Layout layout_;
  int branch_ = 0;  // of the path's last point
};

}  // namespace mbd
