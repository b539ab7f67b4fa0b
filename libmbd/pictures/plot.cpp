#include "libmbd/pictures/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libmbd/core/error.hpp"
#include "libmbd/results/expect.hpp"
#include "libmbd/results/report.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/text/svg.hpp"
#include "libmbd/text/text.hpp"

namespace mbd::plot {
namespace {

// --- layout, in units of the picture ---
constexpr double panel_width = 720.0;
constexpr double panel_height = 420.0;
constexpr double least_left = 112.0, right = 30.0;  // of the axes, from the panel's edges
constexpr double beside = 24.0;                     // base line of the label beside the y axis
constexpr double tick_gap = 8.0;                    // from the axis to its labels
constexpr double line_height = 30.0, bottom = 72.0;
constexpr double font = 22.0;           // 11 px on a screen 360 px wide
constexpr double letter = 0.56 * font;  // width of a letter, rather too much than too little
constexpr double text_width = panel_width - 48.0;
constexpr double legend_line = 60.0, legend_gap = 26.0;
constexpr std::size_t few_points = 30, sparse_markers = 7;

enum class Marker { circle, square, triangle, diamond, cross, ring };
struct Style {
  std::string_view colour, dashes;
  Marker marker;
};

constexpr Style pale_style = {"#b0b0b0", "", Marker::circle};
constexpr Style styles[] = {
    {"#000000", "", Marker::circle},           {"#0b62a4", "11 5", Marker::square},
    {"#c1440e", "3 4", Marker::triangle},      {"#4f8a10", "14 4 3 4", Marker::diamond},
    {"#7a3e9d", "6 3 2 3 2 3", Marker::cross}, {"#806000", "20 6", Marker::ring}};

// The first `count` letters, and where the rest begins.
std::size_t bytes_of(std::string_view text, std::size_t count) {
  std::size_t at = 0;
  for (; at < text.size(); ++at)
    if ((static_cast<unsigned char>(text[at]) & 0xC0) != 0x80 && count-- == 0) break;
  return at;
}

double width_of(std::string_view text) { return letter * static_cast<double>(letters(text)); }

// Text in lines no wider than `width`, broken at blanks where there are some.
std::vector<std::string> wrapped(std::string_view text, double width) {
  constexpr std::size_t most_lines = 6;
  const auto most = static_cast<std::size_t>(width / letter);
  std::vector<std::string> lines;
  while (!text.empty()) {
    if (letters(text) <= most) {
      lines.emplace_back(text);
      break;
    }
    if (lines.size() + 1 == most_lines) {
      lines.push_back(std::string(text.substr(0, bytes_of(text, most - 1))) + "…");
      break;
    }
    const std::size_t end = bytes_of(text, most);
    const std::size_t blank = text.rfind(' ', end);
    const bool at_blank = blank != std::string_view::npos && blank > 0;
    lines.emplace_back(text.substr(0, at_blank ? blank : end));
    text.remove_prefix(at_blank ? blank + 1 : end);
  }
  return lines;
}

// A text whose middle gives way: its beginning and its end, the component, tell curves apart.
std::string shortened(const std::string& text, double width) {
  const auto most = static_cast<std::size_t>(width / letter);
  const std::size_t all = letters(text);
  if (all <= most) return text;
  const std::size_t front = most / 3;
  return text.substr(0, bytes_of(text, front)) + "…" +
         text.substr(bytes_of(text, all - (most - 1 - front)));
}

std::string superscript(int number) {
  constexpr std::string_view digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = number < 0 ? "⁻" : "";
  for (const char c : std::to_string(std::abs(number))) text += digits[c - '0'];
  return text;
}

std::string with_minus(std::string text) {
  if (text.starts_with('-')) text.replace(0, 1, "−");
  return text;
}

// --- axes ---

struct Extent {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
  void add(double value) {
    min = std::min(min, value);
    max = std::max(max, value);
  }
  bool empty() const { return !(min <= max); }
};

// What changes by less than this share of its size is a constant to a picture: its labels would need more
// than seven digits, and it is at the level of the solvers' tolerances rather than a motion.
constexpr double constant_below = 1e-6;

// Never empty, never a point, never beyond what arithmetic can do. A span below `constant` of its greatest
// magnitude gets a range of 1 % about it.
Extent drawable(Extent e, double margin, double constant = constant_below) {
  constexpr double huge = 1e300;
  if (e.empty()) return {0.0, 1.0};
  e = {std::clamp(e.min, -huge, huge), std::clamp(e.max, -huge, huge)};
  const double size = std::max(std::abs(e.min), std::abs(e.max));
  if (e.max - e.min <= constant * size || e.max == e.min) {
    const double half = size > 0.0 ? 0.01 * size : 1.0;
    return {e.min - half, e.max + half};
  }
  const double space = margin * (e.max - e.min);
  return {e.min - space, e.max + space};
}

struct Axis {
  Extent extent;  // of a logarithmic axis: of the logarithms to base ten
  std::vector<double> ticks;
  std::vector<std::string> labels;
  std::string factor;  // "×10⁻³" of the labels, or empty
  bool log = false;
  std::vector<double> between = {};  // marks without labels

  double scaled(double value) const { return log ? std::log10(value) : value; }
  bool shows(double value) const { return !log || value > 0.0; }
  double place(double value, double from, double to) const {
    return from + (scaled(value) - extent.min) / (extent.max - extent.min) * (to - from);
  }
};

Axis make_axis(const Extent& extent, int wanted) {
  Axis axis{extent, {}, {}, {}};
  Ticks ticks = make_ticks(extent.min, extent.max, wanted);
  const double size = std::max(std::abs(extent.min), std::abs(extent.max));
  int power = 0;
  if (size >= 1e5 || size < 1e-2 || (size < 1.0 && ticks.step < 7e-6)) {
    power = 3 * static_cast<int>(std::floor(std::log10(size) / 3.0));
    axis.factor = "×10" + superscript(power);
  }
  const double scale = std::pow(10.0, -power);
  const int decimals =
      std::clamp(static_cast<int>(-std::floor(std::log10(ticks.step * scale) + 1e-9)), 0, 12);
  for (const double at : ticks.at)
    axis.labels.push_back(with_minus(fmt::format("{:.{}f}", at * scale + 0.0, decimals)));
  axis.ticks = std::move(ticks.at);
  return axis;
}

// Of a label of a tick, in the widest of usual fonts (DejaVu Sans): a viewer may have no other.
double tick_width(const std::string& text) {
  const bool minus = text.starts_with("−");
  const auto dots = static_cast<double>(std::count(text.begin(), text.end(), '.'));
  return font * (0.64 * static_cast<double>(letters(text)) - 0.32 * dots + (minus ? 0.2 : 0.0));
}

double widest_label(const Axis& axis) {
  double widest = 0.0;
  for (const std::string& text : axis.labels) widest = std::max(widest, tick_width(text));
  return widest;
}

// "10⁻³", "5×10⁻³"; plain numbers from .01 to 1000.
std::string log_label(double value) {
  if (value >= 0.99e-2 && value < 1.01e3) return fmt::format("{:.10g}", value);
  int power = static_cast<int>(std::floor(std::log10(value) + 1e-9));
  const std::string lead = fmt::format("{:.10g}", value / std::pow(10.0, power));
  return (lead == "1" ? "" : lead + "×") + "10" + superscript(power);
}

Axis make_log_axis(const Extent& extent, int wanted) {
  LogTicks ticks = make_log_ticks(std::pow(10.0, extent.min), std::pow(10.0, extent.max), wanted);
  Axis axis{extent, std::move(ticks.at), {}, {}, true, std::move(ticks.between)};
  for (const double at : axis.ticks) axis.labels.push_back(log_label(at));
  return axis;
}

// Of an axis of x.
constexpr double axis_width = panel_width - least_left - right;

// Least distance of two ticks, as a share of the axis.
double least_gap(const Axis& axis) {
  const double span = axis.extent.max - axis.extent.min;
  double least = axis.ticks.size() < 2 ? 0.0 : span;
  for (std::size_t i = 1; i < axis.ticks.size(); ++i)
    least = std::min(least, axis.scaled(axis.ticks[i]) - axis.scaled(axis.ticks[i - 1]));
  return least / span;
}

// With these ticks, if their labels have room; they rise.
std::optional<Axis> make_axis_at(const Extent& extent, bool log, const std::vector<double>& ticks) {
  Axis axis{extent, {}, {}, {}, log};
  for (const double at : ticks) {
    if (!axis.shows(at) || axis.scaled(at) < extent.min || axis.scaled(at) > extent.max) continue;
    axis.ticks.push_back(at);
    axis.labels.push_back(with_minus(fmt::format("{:g}", at)));
  }
  if (axis.ticks.empty()) return std::nullopt;
  const bool room =
      axis.ticks.size() == 1 || widest_label(axis) + letter / 2 <= least_gap(axis) * axis_width;
  return room ? std::optional(axis) : std::nullopt;
}

// As many ticks, five if possible, as have room for their labels beside each other.
Axis make_x_axis(const Extent& extent, bool log) {
  for (int wanted = log ? 7 : 5;; --wanted) {
    Axis axis = log ? make_log_axis(extent, wanted) : make_axis(extent, wanted);
    if (wanted == 1 || widest_label(axis) + letter <= least_gap(axis) * axis_width) return axis;
  }
}

// An axis of angles that begins and ends at multiples of pi/2 has ticks there: 0, π/2, π, 3π/2, 2π.
std::optional<Axis> make_angle_axis(const std::array<double, 2>& range) {
  constexpr double quarter = std::numbers::pi / 2;
  const double first = std::round(range[0] / quarter), last = std::round(range[1] / quarter);
  const bool whole =
      std::abs(first * quarter - range[0]) < 1e-9 && std::abs(last * quarter - range[1]) < 1e-9;
  if (!whole || last - first < 1.0 || last - first > 8.0) return std::nullopt;
  Axis axis{{range[0], range[1]}, {}, {}, {}};
  for (int n = static_cast<int>(first); n <= static_cast<int>(last); ++n) {
    const int over = n % 2 == 0 ? n / 2 : n;
    std::string text = over == 0    ? "0"
                       : over == 1  ? "π"
                       : over == -1 ? "-π"
                                    : fmt::format("{}π", over);
    if (n % 2 != 0) text += "/2";
    axis.ticks.push_back(n * quarter);
    axis.labels.push_back(with_minus(text));
  }
  return axis;
}

// --- curves ---

// Runs of points in one column of half pixels become their first, lowest, highest and last.
class Path {
 public:
  void move(Point p) {
    finish();
    begin_ = true;
    add(p);
  }
  void line(Point p) {
    if (!run_.empty() && std::floor(2.0 * p[0]) != std::floor(2.0 * run_[0][0])) finish();
    add(p);
  }
  std::string take() {
    finish();
    return std::move(text_);
  }

 private:
  void add(Point p) { run_.push_back(p); }

  void finish() {
    if (run_.empty()) return;
    const auto lower = [](const Point& a, const Point& b) { return a[1] < b[1]; };
    const auto [low, high] = std::minmax_element(run_.begin(), run_.end(), lower);
    std::array<std::ptrdiff_t, 4> kept = {0, low - run_.begin(), high - run_.begin(),
                                          static_cast<std::ptrdiff_t>(run_.size()) - 1};
    std::sort(kept.begin(), kept.end());
    for (std::size_t i = 0; i < kept.size(); ++i)
      if (i == 0 || kept[i] != kept[i - 1]) {
        const Point& p = run_[static_cast<std::size_t>(kept[i])];
        text_ += fmt::format("{}{:.1f},{:.1f}", begin_ ? 'M' : ' ', p[0], p[1]);
        begin_ = false;
      }
    run_.clear();
  }

  std::vector<Point> run_;
  std::string text_;
  bool begin_ = true;
};

bool within(const std::optional<std::array<double, 2>>& range, double x) {
  return !range || (x >= (*range)[0] && x <= (*range)[1]);
}

// Filled with white where open, so that it can be told from the curves below.
std::string marker_at(const Point& p, const Style& style) {
  const double x = p[0], y = p[1];
  constexpr double r = 5.0;
  const std::string open =
      fmt::format("fill=\"#ffffff\" stroke=\"{}\" stroke-width=\"2\"", style.colour);
  switch (style.marker) {
    case Marker::circle:
      return svg::circle(x, y, r, fmt::format("class=\"m\" fill=\"{}\"", style.colour));
    case Marker::square:
      return svg::rectangle(x - r, y - r, 2 * r, 2 * r, "class=\"m\" " + open);
    case Marker::triangle:
      return fmt::format(
          "<path class=\"m\" d=\"M{:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f}Z\" {}/>\n", x - 6.0,
          y + r, x + 6.0, y + r, x, y - 6.5, open);
    case Marker::diamond:
      return fmt::format(
          "<path class=\"m\" d=\"M{:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f}Z\" "
          "fill=\"{}\"/>\n",
          x - 6.5, y, x, y + 6.5, x + 6.5, y, x, y - 6.5, style.colour);
    case Marker::cross:
      return fmt::format(
          "<path class=\"m\" d=\"M{:.1f},{:.1f} {:.1f},{:.1f}M{:.1f},{:.1f} {:.1f},{:.1f}\" {}/>\n",
          x - r, y - r, x + r, y + r, x - r, y + r, x + r, y - r, open);
    case Marker::ring:
      break;
  }
  return svg::circle(x, y, r, "class=\"m\" " + open);
}

// As marker_at, but each filled or each hollow; shapes that cannot be either have another.
std::string filled_marker_at(const Point& p, const Style& style, bool hollow, double size) {
  std::vector<Point> corners;
  switch (style.marker) {
    case Marker::circle:
      for (int i = 0; i < 12; ++i)
        corners.push_back(
            {5.5 * std::cos(i * std::numbers::pi / 6), 5.5 * std::sin(i * std::numbers::pi / 6)});
      break;
    case Marker::square:
      corners = {{-5, -5}, {5, -5}, {5, 5}, {-5, 5}};
      break;
    case Marker::triangle:
      corners = {{-6, 5}, {6, 5}, {0, -6.5}};
      break;
    case Marker::diamond:
      corners = {{-6.5, 0}, {0, 6.5}, {6.5, 0}, {0, -6.5}};
      break;
    case Marker::cross:
      corners = {{-6, -5}, {6, -5}, {0, 6.5}};
      break;
    case Marker::ring:
      for (int i = 0; i < 5; ++i)
        corners.push_back({6.5 * std::sin(i * 0.4 * std::numbers::pi),
                           -6.5 * std::cos(i * 0.4 * std::numbers::pi)});
      break;
  }
  std::string d;
  for (const Point& c : corners)
    d += fmt::format("{}{:.1f},{:.1f}", d.empty() ? "M" : " ", p[0] + size * c[0],
                     p[1] + size * c[1]);
  return fmt::format(
      "<path class=\"m{}\" d=\"{}Z\" fill=\"{}\" stroke=\"{}\" stroke-width=\"2\"/>\n",
      hollow ? " hollow" : "", d, hollow ? "#ffffff" : style.colour, style.colour);
}

// Of a curve's point; in the legend, without a number, filled.
std::string marker_of(const Curve& curve, const Style& style, const Point& p, std::size_t number) {
  if (curve.hollow.empty()) return marker_at(p, style);
  const bool hollow = number < curve.hollow.size() && curve.hollow[number];
  return filled_marker_at(p, style, hollow, curve.pale ? 0.7 : 1.0);
}

constexpr auto no_number = static_cast<std::size_t>(-1);

// Attributes of a curve's line, in the axes and in the legend.
std::string stroke(const Curve& curve, const Style& style) {
  if (curve.wide)
    return fmt::format("stroke=\"{}\" stroke-width=\"9\" stroke-opacity=\"0.3\"", style.colour);
  if (curve.pale) return fmt::format("stroke=\"{}\" stroke-width=\"1.5\"", style.colour);
  return fmt::format(
      "stroke=\"{}\" stroke-width=\"2.5\"{}", style.colour,
      style.dashes.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", style.dashes));
}

const Style& style_of(const Panel& panel, std::size_t curve) {
  if (panel.curves[curve].pale) return pale_style;
  const int style = panel.curves[curve].style;
  return styles[(style < 0 ? curve : static_cast<std::size_t>(style)) % std::size(styles)];
}

double greatest(const Curve& curve) {
  double size = 0.0;
  for (const Point& p : curve.trace.points()) size = std::max(size, std::abs(p[1]));
  return size;
}

// Which curves of a panel have markers. A curve that is zero, or round-off beside the others, has none:
// several of them lie on each other, and their markers would be a muddle. Nor do long curves need any where
// one style is all there is.
std::vector<bool> marked_curves(const Panel& panel) {
  constexpr double round_off = 1e-12;
  std::vector<bool> marked;
  std::vector<double> sizes;
  double most = 0.0;
  bool styles_differ = false;
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    sizes.push_back(greatest(panel.curves[i]));
    most = std::max(most, sizes.back());
    styles_differ = styles_differ || &style_of(panel, i) != &style_of(panel, 0);
  }
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    const bool nothing = styles_differ && sizes[i] <= round_off * most;
    const bool few = panel.curves[i].trace.points().size() <= few_points;
    marked.push_back(!nothing && !panel.curves[i].plain && (few || styles_differ));
  }
  return marked;
}

// The axes in the picture: x from x0 to x1, y from the bottom, y0, to the top; y points down.
struct Area {
  const Axis &x, &y;
  double x0, x1, y0, top;

  double place_x(double value) const { return x.place(value, x0, x1); }
  double place_y(double value) const { return y.place(value, y0, top); }
  bool shows(const Point& p) const { return x.shows(p[0]) && y.shows(p[1]); }
};

void draw_curve(std::string& body, std::size_t number, const Style& style, bool marked,
                const Panel& panel, const Area& area) {
  const Curve& curve = panel.curves[number];
  const auto to_picture = [&](const Point& p) -> Point {
    constexpr double far = 1e5;  // outside the picture, inside what viewers can draw
    return {std::clamp(area.place_x(p[0]), -far, far), std::clamp(area.place_y(p[1]), -far, far)};
  };
  const std::vector<Point>& points = curve.trace.points();
  Path path;
  bool drawing = false;  // the last point is on the path
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool shown = area.shows(points[i]);
    const bool shown_before = i > 0 && area.shows(points[i - 1]);
    const bool inside = within(panel.x_range, points[i][0]);
    const bool before = shown_before && within(panel.x_range, points[i - 1][0]);
    if (!shown || (!inside && !before)) {
      drawing = false;
      continue;
    }
    if (!drawing) path.move(to_picture(points[shown_before ? i - 1 : i]));
    path.line(to_picture(points[i]));
    drawing = inside;
  }
  if (points.size() > 1 && !curve.points_only)
    body += fmt::format("<path d=\"{}\" fill=\"none\" stroke-linejoin=\"round\" {}/>\n",
                        path.take(), stroke(curve, style));
  if (!marked && !curve.points_only) return;
  if (points.size() <= few_points || curve.points_only || !curve.hollow.empty()) {
    for (std::size_t i = 0; i < points.size(); ++i)
      if (area.shows(points[i])) body += marker_of(curve, style, to_picture(points[i]), i);
    return;
  }
  // Each curve has its own phase, so that markers of curves that coincide stand side by side.
  const auto curves = static_cast<double>(panel.curves.size());
  const double phase = (static_cast<double>(number) + 0.5) / curves;
  for (std::size_t n = 0; n < sparse_markers; ++n) {
    const double at = (static_cast<double>(n) + phase) / static_cast<double>(sparse_markers);
    const auto i = static_cast<std::size_t>(at * static_cast<double>(points.size() - 1));
    if (area.shows(points[i])) body += marker_at(to_picture(points[i]), style);
  }
}

std::string legend_text(const Curve& curve) {
  return shortened(curve.label, text_width - legend_line);
}

double legend_width(const Curve& curve) {
  return legend_line + width_of(legend_text(curve)) + legend_gap;
}

// Rows of the legend: the curves in each. None where fewer than two have a label.
std::vector<std::vector<std::size_t>> legend_rows(const Panel& panel) {
  std::vector<std::vector<std::size_t>> rows;
  double width = 0.0;
  std::size_t entries = 0;
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    if (panel.curves[i].label.empty()) continue;
    const double item = legend_width(panel.curves[i]);
    if (rows.empty() || width + item - legend_gap > text_width) {
      rows.emplace_back();
      width = 0.0;
    }
    rows.back().push_back(i);
    width += item;
    ++entries;
  }
  if (entries < 2) rows.clear();
  return rows;
}

// What stands above the axes, in this order.
struct Head {
  std::vector<std::string> title;
  std::vector<std::vector<std::size_t>> legend;
  std::vector<std::string> y_label;  // where it does not stand beside the axis
  double height = 0.0;
};

constexpr double axes_height = panel_height - 22.0 - bottom;

std::string with_factor(const std::string& label, const std::string& factor) {
  return factor.empty() ? label : label.empty() ? factor : label + "  " + factor;
}

// The axes of a panel, and what is written at them.
struct Axes {
  Axis x, y;
  std::string x_label, y_label;
};

// Whether a point has a place on the panel's axes.
bool drawn(const Panel& panel, const Point& p) {
  return (!panel.x_log || p[0] > 0.0) && (!panel.y_log || p[1] > 0.0);
}

Axes axes_of(const Panel& panel) {
  const auto exponent = [](double value) {  // within what powers of ten can do
    return value > 0.0 ? std::clamp(std::log10(value), -300.0, 300.0) : -300.0;
  };
  Extent span_x, span_y;
  for (const Curve& curve : panel.curves)
    for (const Point& p : curve.trace.points())
      if (within(panel.x_range, p[0]) && drawn(panel, p)) {
        span_x.add(panel.x_log ? exponent(p[0]) : p[0]);
        span_y.add(panel.y_log ? exponent(p[1]) : p[1]);
      }
  for (const Level& level : panel.levels)
    if (!panel.y_log || level.y > 0.0) span_y.add(panel.y_log ? exponent(level.y) : level.y);
  if (panel.x_range) {
    span_x = {(*panel.x_range)[0], (*panel.x_range)[1]};
    if (panel.x_log) span_x = {exponent(span_x.min), exponent(span_x.max)};
  }
  const std::optional<Axis> angles =
      panel.x_range && !panel.x_log ? make_angle_axis(*panel.x_range) : std::nullopt;
  const bool given = panel.x_range || panel.x_is_time;  // not for us to widen
  const auto extent_of = [](const Extent& span, bool log, double margin, double constant) {
    if (!log) return drawable(span, margin, constant);
    Extent extent = drawable(span, margin, 0.0);
    if (extent.max - extent.min < 0.02) extent = {extent.min - 0.5, extent.max + 0.5};
    return extent;
  };
  const Extent extent_x =
      extent_of(span_x, panel.x_log, given ? 0.0 : 0.04, given ? 1e-12 : constant_below);
  const Extent extent_y = extent_of(span_y, panel.y_log, 0.04, constant_below);
  const std::optional<Axis> chosen =
      angles ? angles : make_axis_at(extent_x, panel.x_log, panel.x_ticks);
  Axes axes{chosen ? *chosen : make_x_axis(extent_x, panel.x_log),
            panel.y_log ? make_log_axis(extent_y, 8) : make_axis(extent_y, 6),
            {},
            {}};
  axes.x_label = with_factor(panel.x_label, axes.x.factor);
  axes.y_label = with_factor(panel.y_label, axes.y.factor);
  return axes;
}

// What all panels of a picture share, so that their axes and labels stand below each other.
struct Frame {
  double left = least_left;    // of the axes: leaves room for the widest label of a tick
  bool y_label_above = false;  // because one is too long to stand beside its axis
};

Frame frame_of(std::span<const Axes> all) {
  Frame frame;
  for (const Axes& axes : all) {
    constexpr double descent = 0.3 * font;
    frame.left =
        std::max(frame.left, beside + descent + tick_gap + widest_label(axes.y) + tick_gap);
    frame.y_label_above = frame.y_label_above || width_of(axes.y_label) > axes_height;
  }
  return frame;
}

Head head_of(const Panel& panel, const std::string& y_label, bool y_label_above) {
  Head head;
  head.title = wrapped(panel.title, text_width / 1.1);  // bold letters are wider
  head.legend = legend_rows(panel);
  if (y_label_above && !y_label.empty()) head.y_label = wrapped("↑ " + y_label, text_width);
  head.height = line_height * static_cast<double>(head.title.size() + head.legend.size() +
                                                  panel.levels.size() + head.y_label.size()) +
                (head.title.empty() ? 0.0 : 10.0);
  return head;
}

std::string text_at(double x, double y, std::string_view anchor, std::string_view text,
                    std::string_view more = "") {
  return svg::text(x, y, text, fmt::format("{}text-anchor=\"{}\"", more, anchor));
}

constexpr std::string_view bold = "font-weight=\"bold\" ";
// White round its letters: what it is written on does not matter.
constexpr std::string_view halo =
    "stroke=\"#ffffff\" stroke-width=\"5\" stroke-linejoin=\"round\" paint-order=\"stroke\" ";

// Of a level, and of its sample.
std::string level_line(double x0, double x1, double y) {
  return fmt::format(
      "<path class=\"level\" d=\"M{0:.1f},{2:.1f} {1:.1f},{2:.1f}\" stroke=\"#000000\" "
      "stroke-width=\"2\" stroke-dasharray=\"2 5\"/>\n",
      x0, x1, y);
}

void draw_slope(std::string& body, const Slope& slope, const Area& area) {
  for (const Point& p : {slope.from, slope.to})
    if (!area.shows(p)) return;
  const Point from = {area.place_x(slope.from[0]), area.place_y(slope.from[1])};
  const Point to = {area.place_x(slope.to[0]), area.place_y(slope.to[1])};
  const double low = std::max(from[1], to[1]);  // y points down
  const double corner = to[1] < from[1] ? to[0] : from[0];
  body += fmt::format(
      "<path class=\"slope\" d=\"M{:.1f},{:.1f} {:.1f},{:.1f} {:.1f},{:.1f}Z\" fill=\"none\" "
      "stroke=\"#000000\" stroke-width=\"1.5\"/>\n",
      from[0], from[1], to[0], to[1], corner, low);
  const double half = width_of(slope.text) / 2 + 4.0;
  const double middle =
      std::clamp((from[0] + to[0]) / 2, area.x0 + half, std::max(area.x0 + half, area.x1 - half));
  body += text_at(middle, std::min(low + font, area.y0 - 8.0), "middle", slope.text, halo);
}

// The left end of all rows of the legend: above the axes, or as far left as the widest needs.
double legend_left(const Panel& panel, const Head& head, double at_x, double x0) {
  double left = x0;
  for (const std::vector<std::size_t>& row : head.legend) {
    double width = -legend_gap;
    for (const std::size_t i : row) width += legend_width(panel.curves[i]);
    left = std::max(at_x + 24.0, std::min(left, at_x + panel_width - 24.0 - width));
  }
  return left;
}

void draw_legend_entry(std::string& body, const Panel& panel, std::size_t i, bool marked,
                       double left, double y) {
  const Curve& curve = panel.curves[i];
  const Style& style = style_of(panel, i);
  const auto sample = [&](const Curve& drawn) {
    body += svg::line(left, y - 4.0, left + legend_line - 8.0, y - 4.0, stroke(drawn, style));
  };
  for (std::size_t other = 0; other < panel.curves.size(); ++other)  // the broad one below it
    if (other != i && panel.curves[other].wide && panel.curves[other].label.empty() &&
        &style_of(panel, other) == &style)
      sample(panel.curves[other]);
  if (!curve.points_only) sample(curve);
  if (marked || curve.points_only)
    body += marker_of(curve, style, {left + (legend_line - 8.0) / 2, y - 4.0}, no_number);
  body += text_at(left + legend_line, y + 4.0, "start", legend_text(curve));
}

// What stands above the axes. Returns where that ends.
double draw_head(std::string& body, const Panel& panel, const Head& head,
                 const std::vector<bool>& marked, double at_x, double top, double x0) {
  for (const std::string& line : head.title) {
    body += text_at(at_x + panel_width / 2, top + 10.0, "middle", line, bold);
    top += line_height;
  }
  if (!head.title.empty()) top += 10.0;
  const double legend_x = legend_left(panel, head, at_x, x0);
  for (const std::vector<std::size_t>& row : head.legend) {
    double item = legend_x;
    for (const std::size_t i : row) {
      draw_legend_entry(body, panel, i, marked[i], item, top);
      item += legend_width(panel.curves[i]);
    }
    top += line_height;
  }
  for (const Level& level : panel.levels) {
    body += level_line(legend_x, legend_x + legend_line - 8.0, top - 4.0);
    body += text_at(legend_x + legend_line, top + 4.0, "start",
                    shortened(level.text, text_width - legend_line));
    top += line_height;
  }
  for (const std::string& line : head.y_label) {
    body += text_at(at_x + 24.0, top + 4.0, "start", line);
    top += line_height;
  }
  return top;
}

// Marks and ticks of the axes, and lines across at these.
void draw_grid(std::string& body, const Area& area, double at_x) {
  const auto& [x, y, x0, x1, y0, top] = area;
  for (const double mark : x.between) {
    const double at = area.place_x(mark);
    body += fmt::format("<path d=\"M{0:.1f},{1:.1f} {0:.1f},{2:.1f}\" stroke=\"#000000\"/>\n", at,
                        y0, y0 - 6.0);
  }
  for (const double mark : y.between) {
    const double at = area.place_y(mark);
    body += fmt::format("<path d=\"M{1:.1f},{0:.1f} {2:.1f},{0:.1f}\" stroke=\"#000000\"/>\n", at,
                        x0, x0 + 6.0);
  }
  for (std::size_t i = 0; i < x.ticks.size(); ++i) {
    const double at = area.place_x(x.ticks[i]);
    body += fmt::format("<path d=\"M{0:.1f},{1:.1f} {0:.1f},{2:.1f}\" stroke=\"#dddddd\"/>\n", at,
                        y0, top);
    const double last =
        at_x + panel_width - 4.0 - tick_width(x.labels[i]) / 2;  // inside the picture
    body += text_at(std::min(at, last), y0 + 26.0, "middle", x.labels[i]);
  }
  for (std::size_t i = 0; i < y.ticks.size(); ++i) {
    const double at = area.place_y(y.ticks[i]);
    const bool zero = y.ticks[i] == 0.0;
    body += fmt::format("<path d=\"M{:.1f},{:.1f} {:.1f},{:.1f}\" stroke=\"{}\"/>\n", x0, at, x1,
                        at, zero ? "#888888" : "#dddddd");
    body += text_at(x0 - tick_gap, at + 7.0, "end", y.labels[i]);
  }
}

// What is drawn in the axes. `id` is that of its clip path.
void draw_contents(std::string& body, const Panel& panel, const Area& area,
                   const std::vector<bool>& marked, const std::string& id) {
  const auto& [x, y, x0, x1, y0, top] = area;
  body += fmt::format(
      "<clipPath id=\"{}\"><rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" "
      "height=\"{:.1f}\"/></clipPath>\n",
      id, x0, top, x1 - x0, y0 - top);
  body += fmt::format("<g clip-path=\"url(#{})\">\n", id);
  // Under the curves: no point is hidden.
  for (const Slope& slope : panel.slopes) draw_slope(body, slope, area);
  for (const Level& level : panel.levels)
    if (y.shows(level.y)) body += level_line(x0, x1, area.place_y(level.y));
  const auto layer = [](const Curve& curve) { return curve.pale ? 0 : curve.wide ? 1 : 2; };
  for (const int at : {0, 1, 2})
    for (std::size_t i = 0; i < panel.curves.size(); ++i)
      if (layer(panel.curves[i]) == at)
        draw_curve(body, i, style_of(panel, i), marked[i], panel, area);
  body += "</g>\n";
  body += svg::rectangle(x0, top, x1 - x0, y0 - top, "fill=\"none\" stroke=\"#000000\"");
}

// Draws it and returns its height. `id` is that of its clip path.
double draw_panel(std::string& body, const Panel& panel, const Axes& axes, const Frame& frame,
                  const std::string& id, double at_x, double at_y) {
  const Head head = head_of(panel, axes.y_label, frame.y_label_above);
  const std::vector<bool> marked = marked_curves(panel);
  const std::vector<std::string> x_label = wrapped(axes.x_label, text_width);
  const double more_below =
      line_height * static_cast<double>(std::max<std::size_t>(x_label.size(), 1) - 1);
  const double height = panel_height + head.height + more_below;
  const double x0 = at_x + frame.left, x1 = at_x + panel_width - right;
  const double y0 = at_y + height - bottom - more_below;  // bottom of the axes; y points down
  const double top = draw_head(body, panel, head, marked, at_x, at_y + 22.0, x0);
  const Area area{axes.x, axes.y, x0, x1, y0, top};
  draw_grid(body, area, at_x);
  draw_contents(body, panel, area, marked, id);

  double below = y0 + 58.0;
  for (const std::string& line : x_label) {
    const double half = width_of(line) / 2;  // under the axis if it fits there
    const double middle = std::min((x0 + x1) / 2, at_x + panel_width - 24.0 - half);
    body += text_at(std::max(middle, at_x + panel_width / 2), below, "middle", line);
    below += line_height;
  }
  if (head.y_label.empty()) {
    const double middle = (y0 + top) / 2;
    body += text_at(at_x + beside, middle, "middle", axes.y_label,
                    fmt::format("transform=\"rotate(-90 {:.1f} {:.1f})\" ", at_x + beside, middle));
  }
  return height;
}

}  // namespace

void Trace::add(Point point) {
  if (points_.size() >= capacity_) thin();
  points_.push_back(point);
}

void Trace::thin() {
  constexpr std::size_t group = 8;
  std::size_t kept = 0;
  for (std::size_t begin = 0; begin < points_.size(); begin += group) {
    const std::size_t end = std::min(begin + group, points_.size());
    std::array<std::size_t, 4> extreme = {begin, begin, begin, begin};  // least and greatest x, y
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t axis : {0u, 1u}) {
        if (points_[i][axis] < points_[extreme[2 * axis]][axis]) extreme[2 * axis] = i;
        if (points_[i][axis] > points_[extreme[2 * axis + 1]][axis]) extreme[2 * axis + 1] = i;
      }
    std::sort(extreme.begin(), extreme.end());
    const auto last = std::unique(extreme.begin(), extreme.end());
    for (auto it = extreme.begin(); it != last; ++it) points_[kept++] = points_[*it];
  }
  points_.resize(kept);
}

Ticks make_ticks(double min, double max, int wanted) {
  const double rough = (max - min) / std::max(1, wanted);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double lead = rough / power;
  const double step = power * (lead < 1.42 ? 1.0 : lead < 3.17 ? 2.0 : lead < 7.08 ? 5.0 : 10.0);
  Ticks ticks{step, {}};
  const double first = std::ceil(min / step - 1e-9), last = std::floor(max / step + 1e-9);
  for (double n = first; n <= last && ticks.at.size() < 100; n += 1.0)
    ticks.at.push_back(n * step + 0.0);
  return ticks;
}

LogTicks make_log_ticks(double min, double max, int wanted) {
  constexpr double slack = 1e-9;
  const auto power = [](int n) { return std::pow(10.0, n); };
  const int first = static_cast<int>(std::ceil(std::log10(min) - slack));
  const int last = static_cast<int>(std::floor(std::log10(max) + slack));
  LogTicks ticks;
  const auto keep = [&](std::vector<double>& list, double value) {
    if (value >= min * (1 - slack) && value <= max * (1 + slack)) list.push_back(value);
  };
  if (last - first < 2) {
    const bool powers_only = last - first == 1 && wanted < 5;
    for (int n = first - 1; n <= last; ++n)
      for (int lead = 1; lead <= 9; ++lead) {
        const bool labelled = lead == 1 || (!powers_only && (lead == 2 || lead == 5));
        keep(labelled ? ticks.at : ticks.between, lead * power(n));
      }
    if (ticks.at.size() < 2) ticks = {make_ticks(min, max, wanted).at, {}};
    return ticks;
  }
  const int every = (last - first + std::max(1, wanted)) / std::max(1, wanted);
  for (int n = first - 1; n <= last; ++n) {
    const bool labelled = ((n % every) + every) % every == 0;
    if (labelled || (every > 1 && every <= 10)) keep(labelled ? ticks.at : ticks.between, power(n));
    if (every == 1)
      for (int lead = 2; lead <= 9; ++lead) keep(ticks.between, lead * power(n));
  }
  return ticks;
}

std::string to_svg(std::span<const Panel> panels, const Layout& layout) {
  const auto columns = static_cast<std::size_t>(std::max(1, layout.columns));
  const double width =
      panel_width * static_cast<double>(std::clamp<std::size_t>(panels.size(), 1, columns));
  std::string body;
  double y = 0.0;
  for (const std::string& line : wrapped(layout.title, (width - 48.0) / 1.1)) {
    y += line_height;
    body += text_at(width / 2, y, "middle", line, bold);
  }
  if (y > 0.0) y += 12.0;
  std::vector<Axes> axes;
  for (const Panel& panel : panels) axes.push_back(axes_of(panel));
  const Frame frame = frame_of(axes);
  for (std::size_t begin = 0; begin < panels.size(); begin += columns) {
    double height = 0.0;
    for (std::size_t i = begin; i < std::min(begin + columns, panels.size()); ++i)
      height = std::max(height,
                        draw_panel(body, panels[i], axes[i], frame, layout.ids + std::to_string(i),
                                   panel_width * static_cast<double>(i - begin), y));
    y += height;
  }
  const std::vector<std::string> note = wrapped(layout.note, width - 48.0);
  for (const std::string& line : note) {
    y += line_height;
    body += text_at(width / 2, y - 8.0, "middle", line);
  }
  if (!note.empty()) y += 8.0;
  y = std::max(y, 40.0);
  const std::string label = layout.label.empty() ? ""
                                                 : fmt::format("role=\"img\" aria-label=\"{}\" ",
                                                               xml_escaped(layout.label));
  y = std::round(y);
  return svg::document(
      {.width = width,
       .height = y,
       .font = "Helvetica, Arial, sans-serif",
       .letters = font,
       .more = fmt::format("{}width=\"{}\" height=\"{}\" style=\"max-width:100%;height:auto\"",
                           label, width, y)},
      body);
}

namespace {

constexpr std::size_t most_default_panels = 24;

std::string with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " [" + unit + "]";
}

// "C.displacement [m]" of its components, "[m], [rad]" of columns of several quantities; `scale` is what
// the numbers are multiplied by.
std::string label_of(std::span<const Column> columns, double scale) {
  const std::string factor = scale == 1.0 ? "" : fmt::format("{} × ", scale);
  if (columns.size() == 1) return factor + with_unit(columns[0].name, columns[0].unit);
  std::string units;
  bool alike = true;
  std::vector<std::string> seen;
  for (const Column& column : columns) {
    alike = alike && quantity_of(column.name) == quantity_of(columns[0].name);
    const std::string unit = "[" + (column.unit.empty() ? "1" : column.unit) + "]";
    if (std::find(seen.begin(), seen.end(), unit) != seen.end()) continue;
    seen.push_back(unit);
    units += (units.empty() ? "" : ", ") + unit;
  }
  if (alike && seen.size() == 1)
    return factor + with_unit(std::string(quantity_of(columns[0].name)), columns[0].unit);
  return factor + units;
}

std::string left_out_note(std::size_t left_out, std::string_view remedy) {
  return left_out == 0 ? "" : fmt::format("{} more quantities are not shown; {}", left_out, remedy);
}

}  // namespace

QuantityPanels quantity_panels(std::span<const Column> columns, std::span<const std::size_t> chosen,
                               std::size_t x) {
  QuantityPanels result;
  std::vector<std::string_view> quantities;  // of the panels, and those left out
  for (const std::size_t column : chosen) {
    const std::string_view quantity = quantity_of(columns[column].name);
    const auto found = std::find(quantities.begin(), quantities.end(), quantity);
    const auto panel = static_cast<std::size_t>(found - quantities.begin());
    if (found == quantities.end()) {
      quantities.push_back(quantity);
      if (panel < most_default_panels)
        result.panels.push_back(
            {.x_label = with_unit(columns[x].name, columns[x].unit), .x_is_time = x == 0});
      else
        ++result.left_out;
    }
    if (panel >= most_default_panels) continue;
    std::vector<Curve>& curves = result.panels[panel].curves;
    result.places.push_back({panel, curves.size(), column});
    curves.push_back({columns[column].name, {}});
  }
  std::vector<std::vector<Column>> shown(result.panels.size());
  for (const QuantityPanels::Place& place : result.places)
    shown[place.panel].push_back(columns[place.column]);
  for (std::size_t i = 0; i < shown.size(); ++i) result.panels[i].y_label = label_of(shown[i], 1.0);
  return result;
}

std::string history_svg(const History& history, std::span<const std::size_t> chosen, std::size_t x,
                        const std::string& title) {
  QuantityPanels made = quantity_panels(history.columns, chosen, x);
  for (const QuantityPanels::Place& place : made.places) {
    Trace& trace = made.panels[place.panel].curves[place.curve].trace;
    for (std::size_t row = 0; row < history.rows(); ++row)
      trace.add({history.values[x][row], history.values[place.column][row]});
  }
  Layout layout;
  layout.title = title;
  layout.note = left_out_note(made.left_out, "name the records to plot");
  return to_svg(made.panels, layout);
}

void check_picture(const std::filesystem::path& file) {
  std::error_code code;
  const std::filesystem::path directory = file.has_parent_path() ? file.parent_path() : ".";
  if (file.extension() != ".svg" || std::filesystem::is_directory(file, code))
    throw Error(excerpt(file.string()) +
                ": cannot be a picture; choose a name that ends in .svg with --out");
  if (!std::filesystem::is_directory(directory, code))
    throw Error(excerpt(file.string()) + ": there is no directory " + excerpt(directory.string()) +
                "; make it, or choose another with --out");
}

}  // namespace mbd::plot

namespace mbd {

HistoryPlot::HistoryPlot(std::filesystem::path file, const Scene& scene, const Model& model)
    : file_(std::move(file)) {
  const std::vector<Column> known = columns(model);
  for (const PlotScene& plot : scene.plots) {
    const std::size_t x = plot.x.empty() ? 0 : find_column(known, plot.x, plot.source, "plot");
    plot::Panel panel{plot.title, plot.x_label, plot.y_label, plot.x_range, x == 0, {}};
    if (panel.x_label.empty()) panel.x_label = plot::label_of({&known[x], 1}, plot.x_scale);
    std::vector<Column> shown;
    for (const std::string& name : plot.y) {
      const std::size_t y = find_column(known, name, plot.source, "plot");
      sources_.push_back({panels_.size(), panel.curves.size(), x, y, plot.x_scale, plot.y_scale});
      panel.curves.push_back({name, {}});
      shown.push_back(known[y]);
    }
    if (panel.y_label.empty()) panel.y_label = plot::label_of(shown, plot.y_scale);
    panels_.push_back(std::move(panel));
  }
  if (!scene.plots.empty()) return;

  // Of a path, after what the path itself says, and the load factor upwards.
  const bool is_path = model.path != nullptr;
  std::vector<std::size_t> all;
  for (std::size_t y = is_path ? 1 + model.channels.front().columns.size() : 1; y < known.size();
       ++y)
    all.push_back(y);
  plot::QuantityPanels made = plot::quantity_panels(known, all, 0);
  panels_ = std::move(made.panels);
  for (const auto& place : made.places)
    sources_.push_back({place.panel, place.curve, is_path ? place.column : 0,
                        is_path ? 0 : place.column, 1.0, 1.0});
  if (is_path)
    for (plot::Panel& panel : panels_) {
      std::swap(panel.x_label, panel.y_label);
      panel.x_is_time = false;
    }
  layout_.note = plot::left_out_note(made.left_out, "<plot> chooses");
}

// A branch of a path is a curve of its own; events are markers on it.
void HistoryPlot::follow_path(const PathPlace& place, std::span<const double> row) {
  if (place.branch != branch_) {
    branch_ = place.branch;
    for (Source& s : sources_) {
      plot::Panel& panel = panels_[s.panel];
      plot::Curve curve;
      curve.label = panel.curves[s.first].label + (branch_ < 0 ? ", backward" : ", branch");
      s.curve = panel.curves.size();
      panel.curves.push_back(std::move(curve));
    }
  }
  if (place.event == PathEvent::none) return;
  for (const Source& s : sources_) {
    std::vector<plot::Curve>& curves = panels_[s.panel].curves;
    const std::string_view label = name_of(place.event);
    auto it = std::find_if(curves.begin(), curves.end(),
                           [&](const plot::Curve& c) { return c.points_only && c.label == label; });
    if (it == curves.end()) {
      plot::Curve curve;
      curve.label = label;
      curve.points_only = true;
      it = curves.insert(curves.end(), std::move(curve));
    }
    it->trace.add({s.x_scale * row[s.x], s.y_scale * row[s.y]});
  }
}

void HistoryPlot::accepted(const Sample& sample) {
  if (sample.model.path) follow_path(*sample.model.path, sample.row);
  for (const Source& s : sources_)
    panels_[s.panel].curves[s.curve].trace.add(
        {s.x_scale * sample.row[s.x], s.y_scale * sample.row[s.y]});
}

void HistoryPlot::finished(const RunReport& /*report*/) {
  write_file(file_, plot::to_svg(panels_, layout_));
}

}  // namespace mbd
