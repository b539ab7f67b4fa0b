#include "libmbd/front/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libmbd/front/expect.hpp"

namespace mbd::plot {
namespace {

// --- layout, in units of the picture ---
constexpr double panel_width = 720.0;
constexpr double panel_height = 420.0;
constexpr double left = 112.0, right = 24.0;  // of the axes, from the panel's edges
constexpr double title_height = 40.0, legend_height = 30.0, bottom = 70.0;
constexpr double font = 20.0;
constexpr double letter = 0.53 * font;  // mean width of a letter

struct Style {
  std::string_view colour, dashes;
};
constexpr Style styles[] = {
    {"#000000", ""},         {"#0b62a4", "11 5"},        {"#c1440e", "3 4"},
    {"#4f8a10", "14 4 3 4"}, {"#7a3e9d", "6 3 2 3 2 3"}, {"#806000", "20 6"}};

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20) result += c;
    }
  }
  return result;
}

// Letters, not bytes: those that continue a UTF-8 character are not counted.
std::size_t letters(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }));
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

// Never empty, never a point, never beyond what arithmetic can do.
Extent drawable(Extent e, double margin) {
  constexpr double huge = 1e300;
  if (e.empty()) return {0.0, 1.0};
  e = {std::clamp(e.min, -huge, huge), std::clamp(e.max, -huge, huge)};
  const double size = std::max(std::abs(e.min), std::abs(e.max));
  if (e.max - e.min <= 1e-12 * size || e.max == e.min) {
    const double half = size > 0.0 ? 0.5 * size : 1.0;
    return {e.min - half, e.max + half};
  }
  const double space = margin * (e.max - e.min);
  return {e.min - space, e.max + space};
}

struct Axis {
  Extent extent;
  std::vector<double> ticks;
  std::vector<std::string> labels;
  std::string factor;  // "×10⁻³" of the labels, or empty

  double place(double value, double from, double to) const {
    return from + (value - extent.min) / (extent.max - extent.min) * (to - from);
  }
};

Axis make_axis(const Extent& extent, int wanted) {
  Axis axis{extent, {}, {}, {}};
  Ticks ticks = make_ticks(extent.min, extent.max, wanted);
  const double size = std::max(std::abs(extent.min), std::abs(extent.max));
  int power = 0;
  if (size >= 1e5 || size < 1e-2) {
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

void draw_curve(std::string& svg, const Curve& curve, const Style& style, const Panel& panel,
                const Axis& x, const Axis& y, double x0, double x1, double y0, double y1) {
  const auto to_picture = [&](const Point& p) -> Point {
    constexpr double far = 1e5;  // outside the picture, inside what viewers can draw
    return {std::clamp(x.place(p[0], x0, x1), -far, far),
            std::clamp(y.place(p[1], y0, y1), -far, far)};
  };
  const std::vector<Point>& points = curve.trace.points();
  Path path;
  bool drawing = false;  // the last point is on the path
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool inside = within(panel.x_range, points[i][0]);
    const bool before = i > 0 && within(panel.x_range, points[i - 1][0]);
    if (!inside && !before) {
      drawing = false;
      continue;
    }
    if (!drawing) path.move(to_picture(points[i > 0 ? i - 1 : 0]));
    path.line(to_picture(points[i]));
    drawing = inside;
  }
  const std::string dashes =
      style.dashes.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", style.dashes);
  if (points.size() == 1) {
    const Point p = to_picture(points[0]);
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\" fill=\"{}\"/>\n", p[0], p[1],
                       style.colour);
  } else {
    svg += fmt::format(
        "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\" "
        "stroke-linejoin=\"round\"{}/>\n",
        path.take(), style.colour, dashes);
  }
}

const Style& style_of(std::size_t curve) { return styles[curve % std::size(styles)]; }

// Rows of the legend: curves from each of these to the next.
std::vector<std::size_t> legend_rows(const Panel& panel) {
  std::vector<std::size_t> rows = {0};
  double width = 0.0;
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    const double item = 70.0 + letter * static_cast<double>(letters(panel.curves[i].label));
    if (width > 0.0 && width + item > panel_width - left - right) {
      rows.push_back(i);
      width = 0.0;
    }
    width += item;
  }
  rows.push_back(panel.curves.size());
  return rows;
}

double height_of(const Panel& panel) {
  const double legend =
      panel.curves.size() > 1 ? static_cast<double>(legend_rows(panel).size() - 1) : 0.0;
  return panel_height + legend_height * legend + (panel.title.empty() ? 0.0 : title_height);
}

std::string text_at(double x, double y, std::string_view anchor, std::string_view text,
                    std::string_view more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y,
                     anchor, more, escaped(text));
}

void draw_panel(std::string& svg, const Panel& panel, std::size_t number, double at_x,
                double at_y) {
  const double x0 = at_x + left, x1 = at_x + panel_width - right;
  const double y0 = at_y + height_of(panel) - bottom;  // bottom of the axes; y points down
  double top = at_y + 22.0;

  if (!panel.title.empty()) {
    const double width = 1.15 * letter * static_cast<double>(letters(panel.title));
    const double size = font * std::min(1.0, (panel_width - 2.0 * right) / width);
    svg += text_at(at_x + panel_width / 2, at_y + 28.0, "middle", panel.title,
                   fmt::format(" font-weight=\"bold\" font-size=\"{:.1f}\"", size));
    top += title_height;
  }
  if (panel.curves.size() > 1) {
    const std::vector<std::size_t> rows = legend_rows(panel);
    for (std::size_t row = 0; row + 1 < rows.size(); ++row) {
      double x = x0;
      for (std::size_t i = rows[row]; i < rows[row + 1]; ++i) {
        const Style& style = style_of(i);
        svg += fmt::format(
            "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" "
            "stroke-width=\"3\"{}/>\n",
            x, top - 2.0, x + 44.0, top - 2.0, style.colour,
            style.dashes.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", style.dashes));
        svg += text_at(x + 50.0, top + 4.0, "start", panel.curves[i].label);
        x += 70.0 + letter * static_cast<double>(letters(panel.curves[i].label));
      }
      top += legend_height;
    }
  }

  Extent span_x, span_y;
  for (const Curve& curve : panel.curves)
    for (const Point& p : curve.trace.points())
      if (within(panel.x_range, p[0])) {
        span_x.add(p[0]);
        span_y.add(p[1]);
      }
  if (panel.x_range) span_x = {(*panel.x_range)[0], (*panel.x_range)[1]};
  const std::optional<Axis> angles = panel.x_range ? make_angle_axis(*panel.x_range) : std::nullopt;
  const double margin = panel.x_range || panel.x_is_time ? 0.0 : 0.04;
  const Axis x = angles ? *angles : make_axis(drawable(span_x, margin), 6);
  const Axis y = make_axis(drawable(span_y, 0.04), 6);

  for (std::size_t i = 0; i < x.ticks.size(); ++i) {
    const double at = x.place(x.ticks[i], x0, x1);
    svg += fmt::format("<path d=\"M{0:.1f},{1:.1f} {0:.1f},{2:.1f}\" stroke=\"#dddddd\"/>\n", at,
                       y0, top);
    svg += text_at(at, y0 + 24.0, "middle", x.labels[i]);
  }
  for (std::size_t i = 0; i < y.ticks.size(); ++i) {
    const double at = y.place(y.ticks[i], y0, top);
    const bool zero = y.ticks[i] == 0.0;
    svg += fmt::format("<path d=\"M{:.1f},{:.1f} {:.1f},{:.1f}\" stroke=\"{}\"/>\n", x0, at, x1, at,
                       zero ? "#888888" : "#dddddd");
    svg += text_at(x0 - 8.0, at + 7.0, "end", y.labels[i]);
  }
  svg += fmt::format(
      "<clipPath id=\"c{}\"><rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" "
      "height=\"{:.1f}\"/></clipPath>\n",
      number, x0, top, x1 - x0, y0 - top);
  svg += fmt::format("<g clip-path=\"url(#c{})\">\n", number);
  for (std::size_t i = 0; i < panel.curves.size(); ++i)
    draw_curve(svg, panel.curves[i], style_of(i), panel, x, y, x0, x1, y0, top);
  svg += "</g>\n";
  svg += fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" "
      "stroke=\"#000000\"/>\n",
      x0, top, x1 - x0, y0 - top);

  const auto with_factor = [](const std::string& label, const std::string& factor) {
    return factor.empty() ? label : label.empty() ? factor : label + "  " + factor;
  };
  svg += text_at((x0 + x1) / 2, y0 + 54.0, "middle", with_factor(panel.x_label, x.factor));
  const double middle = (y0 + top) / 2;
  svg += text_at(at_x + 24.0, middle, "middle", with_factor(panel.y_label, y.factor),
                 fmt::format(" transform=\"rotate(-90 {:.1f} {:.1f})\"", at_x + 24.0, middle));
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

std::string to_svg(std::span<const Panel> panels, const Layout& layout) {
  const auto columns = static_cast<std::size_t>(std::max(1, layout.columns));
  std::string body;
  double y = 0.0;
  for (std::size_t begin = 0; begin < panels.size(); begin += columns) {
    double height = 0.0;
    for (std::size_t i = begin; i < std::min(begin + columns, panels.size()); ++i) {
      draw_panel(body, panels[i], i, panel_width * static_cast<double>(i - begin), y);
      height = std::max(height, height_of(panels[i]));
    }
    y += height;
  }
  const double width =
      panel_width * static_cast<double>(std::clamp<std::size_t>(panels.size(), 1, columns));
  if (!layout.note.empty()) {
    y += 30.0;
    body += text_at(width / 2, y - 12.0, "middle", layout.note);
  }
  y = std::max(y, 40.0);
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
             "width=\"{0:.0f}\" "
             "height=\"{1:.0f}\" font-family=\"Helvetica, Arial, sans-serif\" "
             "font-size=\"{2:.0f}\">\n"
             "<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#ffffff\"/>\n",
             width, y, font) +
         body + "</svg>\n";
}

}  // namespace mbd::plot

namespace mbd {
namespace {

constexpr std::size_t most_default_panels = 24;

std::string with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " [" + unit + "]";
}

}  // namespace

HistoryPlot::HistoryPlot(std::filesystem::path file, const Scene& scene, const Model& model)
    : file_(std::move(file)) {
  const std::vector<Column> known = columns(model);
  for (const PlotScene& plot : scene.plots) {
    const std::size_t x = plot.x.empty() ? 0 : find_column(known, plot.x, plot.source, "plot");
    plot::Panel panel{plot.title, plot.x_label, plot.y_label, plot.x_range, x == 0, {}};
    if (panel.x_label.empty())
      panel.x_label = with_unit(known[x].name, plot.x_scale == 1.0 ? known[x].unit : "");
    for (const std::string& name : plot.y) {
      const std::size_t y = find_column(known, name, plot.source, "plot");
      sources_.push_back({panels_.size(), panel.curves.size(), x, y, plot.x_scale, plot.y_scale});
      panel.curves.push_back({name, {}});
      if (plot.y_label.empty()) {
        const std::string unit = plot.y_scale == 1.0 ? known[y].unit : "";
        panel.y_label = plot.y.size() == 1 ? with_unit(name, unit)
                        : unit.empty()     ? ""
                                           : "[" + unit + "]";
      }
    }
    panels_.push_back(std::move(panel));
  }
  if (!scene.plots.empty()) return;

  // Columns "record.quantity.1" … of one quantity stand next to each other.
  std::string last;
  std::size_t left_out = 0;
  for (std::size_t y = 1; y < known.size(); ++y) {
    const std::string& name = known[y].name;
    const std::size_t first_dot = name.find('.');
    const std::string quantity =
        first_dot == std::string::npos ? name : name.substr(0, name.find('.', first_dot + 1));
    const bool is_new = quantity != last;
    last = quantity;
    if (is_new && panels_.size() < most_default_panels)
      panels_.push_back({"",
                         with_unit(known[0].name, known[0].unit),
                         with_unit(quantity, known[y].unit),
                         {},
                         true,
                         {}});
    else if (is_new)
      ++left_out;
    if (left_out > 0) continue;
    sources_.push_back({panels_.size() - 1, panels_.back().curves.size(), 0, y, 1.0, 1.0});
    panels_.back().curves.push_back({name, {}});
  }
  if (left_out > 0)
    layout_.note =
        fmt::format("{} more recorded quantities are not shown; <plot> chooses", left_out);
}

void HistoryPlot::accepted(const Sample& sample) {
  for (const Source& s : sources_)
    panels_[s.panel].curves[s.curve].trace.add(
        {s.x_scale * sample.row[s.x], s.y_scale * sample.row[s.y]});
}

void HistoryPlot::finished(const RunReport& /*report*/) {
  write_file(file_, plot::to_svg(panels_, layout_));
}

}  // namespace mbd
