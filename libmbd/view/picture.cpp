#include "libmbd/view/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <utility>

#include "libmbd/core/error.hpp"
#include "libmbd/text/svg.hpp"
#include "libmbd/text/text.hpp"
#include "libmbd/view/letters.hpp"

namespace mbd {
namespace {

using Point = std::array<double, 2>;

constexpr int trail_decimals = 3;       // of a pixel: paths are looked at closely
constexpr double field_of_view = 35.0;  // [degrees] from bottom to top, as in the page
constexpr double degree = std::numbers::pi / 180.0;
constexpr double seam =
    0.5;  // [pixels] faces are drawn so much larger in SVG, that nothing shines through

// ---- whence -------------------------------------------------------------------------------------

// What points up is an axis; the others follow it cyclically.
int up_axis(const Vec3& up) {
  Index k = 2;
  up.cwiseAbs().maxCoeff(&k);
  return static_cast<int>(k);
}

Vec3 corner_view(const Vec3& up) {
  const int k = up_axis(up);
  Vec3 d = Vec3::Zero();
  d((k + 1) % 3) = k == 2 ? 0.6 : 0.75;
  d((k + 2) % 3) = k == 2 ? -1.0 : 0.9;
  d(k) = 0.5 * up(k);
  return d;
}

// What is flat is looked at from its front.
Vec3 first_view(const Stage& stage) {
  const Vec3 up = stage.up(), sides = stage.bounds()[1] - stage.bounds()[0];
  const int k = up_axis(up);
  int flat = -1, count = 0;
  for (int i = 0; i < 3; ++i)
    if (sides(i) < 0.02 * sides.maxCoeff()) flat = i, ++count;
  if (count != 1) return corner_view(up);
  Vec3 d = Vec3::Zero();
  if (flat == k) {  // from above, axis 1 to the right where axis 3 is up
    d(k) = up(k);
    d(k == 2 ? 1 : (k + 2) % 3) = k == 2 ? -0.35 : 0.35;
    return d;
  }
  d(flat) = flat == 1 && k == 2 ? -1.0 : 1.0;
  for (int i = 0; i < 3; ++i)
    if (i != flat) d(i) += i == k ? 0.3 * up(k) : 0.25;
  return d;
}

Vec3 direction_of(const Stage& stage, const std::string& from) {
  const Vec3 up = stage.up();
  const int k = up_axis(up);
  if (from.empty()) return first_view(stage);
  if (from == "iso") return corner_view(up);
  const bool is_negative = from[0] == '-';
  if (const std::string axis = from.substr(is_negative ? 1 : 0);
      axis == "x" || axis == "y" || axis == "z") {
    Vec3 d = Vec3::Zero();
    d(axis[0] - 'x') = is_negative ? -1.0 : 1.0;
    return d;
  }
  const auto wrong = [&from] {
    return Error(fmt::format(
        "from {}: write iso, x, y, z, -x, -y, -z, or two angles in degrees as 30,20 (azimuth, "
        "elevation from -90 to 90)",
        from));
  };
  const std::size_t comma = from.find(',');
  if (comma == std::string::npos) throw wrong();
  const auto number = [&](std::string_view text) {
    double value = 0.0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
      throw wrong();
    return value;
  };
  const std::string_view all(from);
  const double azimuth = number(all.substr(0, comma)), elevation = number(all.substr(comma + 1));
  if (std::abs(elevation) > 90.0 || std::abs(azimuth) > 1e4) throw wrong();
  Vec3 d = Vec3::Zero();
  d((k + 1) % 3) = std::cos(elevation * degree) * std::cos(azimuth * degree);
  d((k + 2) % 3) = std::cos(elevation * degree) * std::sin(azimuth * degree);
  d(k) = std::sin(elevation * degree) * up(k);
  return d;
}

// ---- what all pictures have ---------------------------------------------------------------------

struct Words {
  std::string text;
  Point at{};           // start of its base line
  double height = 9.0;  // of capitals
  Colour colour{0.25, 0.27, 0.3};
};
struct Patch {  // of the legend
  double x, y, width, height;
  Colour colour;
};
struct Labels {
  std::vector<Words> words;
  std::vector<Patch> patches;
};

// [pixels] for what has its size in the picture, not in space.
double pen(const PictureOptions& options) {
  return std::max(0.8, std::min(options.width / 960.0, options.height / 600.0));
}

struct Projected {
  Point at{};
  double depth = 0.0;  // ahead of the eye
};
Projected project(const Camera& camera, const Vec3& x) {
  const Vec3 d = x - camera.eye;
  const double depth = d.dot(camera.ahead);
  return {{camera.middle[0] + camera.focal * d.dot(camera.right) / depth,
           camera.middle[1] - camera.focal * d.dot(camera.above) / depth},
          depth};
}

// The part of a line that is ahead of the eye; nothing where none is.
std::optional<std::array<Projected, 2>> project_line(const Camera& camera, Vec3 a, Vec3 b) {
  const double near = 1e-3 * camera.eye.norm() + 1e-300;
  const double da = (a - camera.eye).dot(camera.ahead), db = (b - camera.eye).dot(camera.ahead);
  if (da < near && db < near) return std::nullopt;
  if (da < near) a = b + (a - b) * ((db - near) / (db - da));
  if (db < near) b = a + (b - a) * ((da - near) / (da - db));
  return std::array<Projected, 2>{project(camera, a), project(camera, b)};
}

// Lines of a plane under the model, at whole numbers of cells; axes at the origin, if it is near.
void add_ground(Figure& figure, const Stage& stage, Labels& labels, const Camera& camera,
                const PictureOptions& options) {
  const Vec3 low = stage.bounds()[0], high = stage.bounds()[1], centre = stage.centre(),
             up = stage.up();
  const int k = up_axis(up), a = (k + 1) % 3, b = (k + 2) % 3;
  const double spread = std::max((high - low).maxCoeff(), 0.5 * stage.size());
  const double step = std::pow(10.0, std::floor(std::log10(spread / 3.0)));
  const double cell = spread / step > 12.0 ? 2.0 * step : step;
  const int half = static_cast<int>(std::ceil(0.65 * spread / cell)) + 1;
  Vec3 at = 0.5 * (low + high);
  for (int i = 0; i < 3; ++i) at(i) = std::round((at(i) + centre(i)) / cell) * cell - centre(i);
  at(k) = (up(k) > 0.0 ? low(k) : high(k)) - up(k) * 0.02 * spread;
  if (std::abs(at(k) + centre(k)) < 0.1 * spread) at(k) = -centre(k) - up(k) * 0.004 * spread;
  for (int i = -half; i <= half; ++i)
    for (const auto& [u, v] : {std::pair{a, b}, {b, a}}) {
      Vec3 p = at, q = at;
      p(u) += i * cell, q(u) += i * cell;
      p(v) -= half * cell, q(v) += half * cell;
      figure.lines.push_back({p, q, 0.8 * pen(options), -1, {0.87, 0.885, 0.9}, true});
    }
  if (centre.norm() > 3.0 * stage.size()) return;
  constexpr Colour colours[] = {{0.82, 0.2, 0.17}, {0.18, 0.62, 0.27}, {0.17, 0.44, 0.84}};
  for (int i = 0; i < 3; ++i) {
    Vec3 tip = -centre;
    tip(i) += 0.1 * stage.size();
    figure.lines.push_back({-centre, tip, 2.0 * pen(options), -1, colours[i], false});
    tip(i) += 0.025 * stage.size();
    const Projected word = project(camera, tip);
    if (word.depth > 0.0)
      labels.words.push_back({std::to_string(i + 1),
                              {word.at[0] - 3.0 * pen(options), word.at[1] + 4.0 * pen(options)},
                              9.0 * pen(options),
                              colours[i]});
  }
}

std::string short_number(double value) { return fmt::format("{:.4g}", value); }

void add_words(Labels& labels, const Stage& stage, double instant, const PictureOptions& options) {
  const double k = pen(options), margin = 14.0 * k;
  if (stage.frames() > 1) {
    // As many digits for all frames.
    const std::vector<double>& keys = stage.keys();
    const auto [low, high] = std::minmax_element(keys.begin(), keys.end());
    const double range = std::max(*high - *low, 1e-300);
    const int digits = std::clamp(2 - static_cast<int>(std::floor(std::log10(range))), 0, 9);
    labels.words.push_back({stage.is_time()
                                ? fmt::format("t = {:.{}f} s", stage.key(instant), digits)
                                : fmt::format("load factor {:.{}f}", stage.key(instant), digits),
                            {margin, options.height - margin},
                            10.0 * k});
  }
  if (const Stage::Legend* const legend = stage.legend()) {
    constexpr int patches = 48;
    const double wide = 180.0 * k, high = 9.0 * k, x = options.width - margin - wide,
                 y = options.height - margin - high - 16.0 * k;
    for (int i = 0; i < patches; ++i)
      labels.patches.push_back({x + wide * i / patches, y, wide / patches + 0.5, high,
                                Stage::shade((i + 0.5) / patches)});
    const auto put = [&](const std::string& text, double right, double at) {
      const double height = 8.5 * k, width = lettering(text, height).width;
      labels.words.push_back({text, {x + right * (wide - width), at}, height});
    };
    put(legend->title, 0.5, y - 7.0 * k);
    put(short_number(legend->low), 0.0, y + high + 14.0 * k);
    put(short_number(legend->high), 1.0, y + high + 14.0 * k);
  }
}

// Light from beside the eye.
Colour lit(const Colour& colour, const Vec3& normal, const Camera& camera) {
  const Vec3 light = (0.6 * camera.right + camera.above - camera.ahead).normalized();
  const double shade = std::min(
      1.15, 0.66 + 0.42 * std::max(0.0, normal.dot(light)) + 0.06 * normal.dot(camera.above));
  const auto one = [shade](double c) { return std::clamp(c * shade, 0.0, 1.0); };
  return {one(colour.r), one(colour.g), one(colour.b)};
}

// A face that is turned to the eye.
struct Seen {
  const Figure::Face* face;
  Colour colour;
  double depth;  // in the middle
};

std::vector<Seen> seen_faces(const Figure& figure, const Camera& camera) {
  const double near = 1e-3 * camera.eye.norm() + 1e-300;
  std::vector<Seen> seen;
  for (const Figure::Face& face : figure.faces) {
    const Vec3* const p = figure.points.data() + face.first;
    Vec3 normal = Vec3::Zero(), middle = Vec3::Zero();
    bool is_ahead = true;
    for (int i = 0; i < face.count; ++i) {
      const Vec3 &a = p[i], &b = p[(i + 1) % face.count];
      normal += (a - p[0]).cross(b - p[0]);
      middle += a / face.count;
      is_ahead = is_ahead && (a - camera.eye).dot(camera.ahead) > near;
    }
    const double length = normal.norm();
    if (!is_ahead || !(length > 0.0)) continue;
    normal /= length;
    if (normal.dot(camera.eye - middle) <= 0.0) {
      if (!face.two_sided) continue;
      normal = -normal;
    }
    seen.push_back(
        {&face, lit(face.colour, normal, camera), (middle - camera.eye).dot(camera.ahead)});
  }
  return seen;
}

// An arrow in the picture: its shaft, and triangles.
struct FlatArrow {
  Point tail{}, neck{};
  std::vector<std::array<Point, 3>> heads;
};
std::optional<FlatArrow> flat(const Figure::Arrow& arrow, const Camera& camera, double k) {
  const auto ends = project_line(camera, arrow.tail, arrow.tip);
  if (!ends) return std::nullopt;
  const Point a = (*ends)[0].at, b = (*ends)[1].at;
  const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
  if (!(length > 1e-9)) return std::nullopt;
  const double ux = (b[0] - a[0]) / length, uy = (b[1] - a[1]) / length,
               head = std::min(11.0 * k, 0.5 * length), half = 0.4 * head;
  FlatArrow made{a, {b[0] - ux * head, b[1] - uy * head}, {}};
  for (int i = 0; i < arrow.heads; ++i) {
    const Point tip{b[0] - ux * 0.8 * head * i, b[1] - uy * 0.8 * head * i},
        back{tip[0] - ux * head, tip[1] - uy * head};
    made.heads.push_back({tip, Point{back[0] - uy * half, back[1] + ux * half},
                          Point{back[0] + uy * half, back[1] - ux * half}});
  }
  return made;
}

// ---- SVG ----------------------------------------------------------------------------------------

nlohmann::ordered_json json(const Vec3& v) { return {v(0), v(1), v(2)}; }

// Consecutive elements of one part stand in one group with its name.
class Groups {
 public:
  Groups(std::string& svg, const Stage& stage) : svg_(svg), stage_(stage) {}
  ~Groups() { close(); }
  Groups(const Groups&) = delete;
  Groups& operator=(const Groups&) = delete;

  void of(int part) {
    if (open_ && part == part_) return;
    close();
    const std::string name = stage_.part_name(part);
    svg_ += name.empty() ? "<g>\n" : fmt::format("<g data-part=\"{}\">\n", xml_escaped(name));
    part_ = part;
    open_ = true;
  }

 private:
  void close() {
    if (open_) svg_ += "</g>\n";
    open_ = false;
  }
  std::string& svg_;
  const Stage& stage_;
  int part_ = -1;
  bool open_ = false;
};

// The body of a picture, the farthest first.
class SvgBody {
 public:
  SvgBody(const Figure& figure, const Stage& stage, const Camera& camera, double k)
      : figure_(figure), camera_(camera), k_(k) {
    for (const Figure::Line& line : figure.lines)
      if (line.behind)
        if (const auto p = project_line(camera, line.a, line.b)) add(line, *p);
    Groups groups(svg_, stage);
    add_solids(groups);
    for (const Figure::Trail& trail : figure.trails) {
      groups.of(trail.part);
      add(trail);
    }
    for (const Figure::Arrow& arrow : figure.arrows)
      if (const auto made = flat(arrow, camera, k)) {
        groups.of(arrow.part);
        add(*made, code_of(arrow.colour));
      }
  }

  std::string text(const Labels& labels) && {
    for (const Patch& patch : labels.patches)
      svg_ += svg::rectangle(patch.x, patch.y, patch.width, patch.height,
                             fmt::format("fill=\"{}\"", code_of(patch.colour)));
    for (const Words& words : labels.words)
      svg_ += svg::text(words.at[0], words.at[1], words.text,
                        fmt::format("font-size=\"{:.3g}\" fill=\"{}\"", 1.38 * words.height,
                                    code_of(words.colour)));
    return std::move(svg_);
  }

 private:
  // Faces and lines between them.
  void add_solids(Groups& groups) {
    struct Item {
      double depth;
      const Seen* face;
      const Figure::Line* line;
    };
    const std::vector<Seen> seen = seen_faces(figure_, camera_);
    std::vector<Item> items;
    for (const Seen& face : seen) items.push_back({face.depth, &face, nullptr});
    for (const Figure::Line& line : figure_.lines)
      if (!line.behind)
        items.push_back(
            {(0.5 * (line.a + line.b) - camera_.eye).dot(camera_.ahead), nullptr, &line});
    std::stable_sort(items.begin(), items.end(),
                     [](const Item& a, const Item& b) { return a.depth > b.depth; });
    for (const Item& item : items) {
      if (item.face != nullptr) {
        groups.of(item.face->face->part);
        add(*item.face);
      } else if (const auto p = project_line(camera_, item.line->a, item.line->b)) {
        groups.of(item.line->part);
        add(*item.line, *p);
      }
    }
  }

  void add(const Figure::Line& line, const std::array<Projected, 2>& p) {
    stroke(p[0].at, p[1].at, code_of(line.colour), line.width * (line.behind ? 1.0 : k_));
  }

  void add(const Seen& seen) {
    const Figure::Face& face = *seen.face;
    svg_ += "<path d=\"";
    for (int i = 0; i < face.count; ++i) {
      const Point p = project(camera_, figure_.points[face.first + static_cast<std::size_t>(i)]).at;
      svg_ += fmt::format("{}{:.2f} {:.2f}", i == 0 ? "M" : "L", p[0], p[1]);
    }
    const std::string colour = code_of(seen.colour);
    if (face.opacity < 1.0)
      svg_ += fmt::format("z\" fill=\"{}\" fill-opacity=\"{:.2g}\"/>\n", colour, face.opacity);
    else
      svg_ += fmt::format("z\" fill=\"{0}\" stroke=\"{0}\" stroke-width=\"{1}\"/>\n", colour, seam);
  }

  void add(const Figure::Trail& trail) {
    std::vector<Point> points;
    for (const Vec3& x : trail.points) points.push_back(project(camera_, x).at);
    const Point now = project(camera_, trail.now).at;
    const std::string colour = code_of(trail.colour);
    svg_ += svg::polyline(
        points,
        fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"{:.2g}\" stroke-opacity=\"0.7\"",
                    colour, 1.4 * k_),
        trail_decimals);
    svg_ +=
        svg::circle(now[0], now[1], 3.5 * k_, fmt::format("fill=\"{}\"", colour), trail_decimals);
  }

  void add(const FlatArrow& arrow, const std::string& colour) {
    stroke(arrow.tail, arrow.neck, colour, 2.4 * k_);
    for (const auto& head : arrow.heads)
      svg_ += fmt::format("<path d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}L{:.2f} {:.2f}z\" fill=\"{}\"/>\n",
                          head[0][0], head[0][1], head[1][0], head[1][1], head[2][0], head[2][1],
                          colour);
  }

  void stroke(const Point& a, const Point& b, const std::string& colour, double width) {
    svg_ += fmt::format(
        "<path d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}\" stroke=\"{}\" stroke-width=\"{:.2g}\"/>\n", a[0],
        a[1], b[0], b[1], colour, width);
  }

  const Figure& figure_;
  const Camera& camera_;
  double k_;
  std::string svg_;
};

// ---- pixels -------------------------------------------------------------------------------------

class Canvas {
 public:
  enum class Layer { behind, solid, veil, front };
  struct Corner {
    double x, y, nearness;  // 1/depth
  };

  Canvas(int width, int height, int samples)
      : samples_(samples),
        width_(width * samples),
        height_(height * samples),
        colours_(3 * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 1.0F),
        nearness_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0.0F) {}

  void triangle(Corner a, Corner b, Corner c, const Colour& colour, Layer layer,
                double opacity = 1.0) {
    for (Corner* const p : {&a, &b, &c}) p->x *= samples_, p->y *= samples_;
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (!(std::abs(area) > 1e-12)) return;
    const auto bound = [](double low, double high, int most) {
      return std::pair{
          static_cast<int>(std::clamp(std::floor(low), 0.0, static_cast<double>(most))),
          static_cast<int>(std::clamp(std::ceil(high), 0.0, static_cast<double>(most)))};
    };
    const auto [x0, x1] = bound(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}), width_);
    const auto [y0, y1] = bound(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}), height_);
    for (int y = y0; y < y1; ++y) {
      const double py = y + 0.5;
      for (int x = x0; x < x1; ++x) {
        const double px = x + 0.5;
        const double u = ((b.x - px) * (c.y - py) - (b.y - py) * (c.x - px)) / area,
                     v = ((c.x - px) * (a.y - py) - (c.y - py) * (a.x - px)) / area,
                     w = 1.0 - u - v;
        if (u < 0.0 || v < 0.0 || w < 0.0) continue;
        const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                               static_cast<std::size_t>(x);
        if (layer == Layer::solid || layer == Layer::veil) {
          const auto nearness =
              static_cast<float>(u * a.nearness + v * b.nearness + w * c.nearness);
          if (nearness < nearness_[at]) continue;
          if (layer == Layer::solid) nearness_[at] = nearness;
        }
        float* const pixel = colours_.data() + 3 * at;
        const auto blend = [opacity](float& old, double now) {
          old = static_cast<float>(old + opacity * (now - old));
        };
        blend(pixel[0], colour.r), blend(pixel[1], colour.g), blend(pixel[2], colour.b);
      }
    }
  }
  void line(const Corner& a, const Corner& b, double width, const Colour& colour, Layer layer) {
    double dx = b.x - a.x, dy = b.y - a.y;
    const double length = std::hypot(dx, dy);
    if (!(length > 1e-9)) {
      dx = 1.0, dy = 0.0;
    } else {
      dx /= length, dy /= length;
    }
    const double h = 0.5 * width;
    constexpr double before = 1.0005;  // what it lies on
    const auto at = [&](const Corner& p, double along, double across) {
      return Corner{p.x + h * (along * dx - across * dy), p.y + h * (along * dy + across * dx),
                    before * p.nearness};
    };
    triangle(at(a, -1, -1), at(a, -1, 1), at(b, 1, 1), colour, layer);
    triangle(at(a, -1, -1), at(b, 1, 1), at(b, 1, -1), colour, layer);
  }
  void disc(const Point& at, double radius, const Colour& colour) {
    constexpr int sides = 20;
    const auto corner = [&](int i) {
      const double angle = 2.0 * std::numbers::pi * i / sides;
      return Corner{at[0] + radius * std::cos(angle), at[1] + radius * std::sin(angle), 0.0};
    };
    for (int i = 0; i < sides; ++i)
      triangle({at[0], at[1], 0.0}, corner(i), corner(i + 1), colour, Layer::front);
  }

  Pixels pixels() const {
    Pixels made{width_ / samples_, height_ / samples_, {}};
    made.rgb.reserve(static_cast<std::size_t>(3 * made.width * made.height));
    const float share = 255.0F / static_cast<float>(samples_ * samples_);
    for (int y = 0; y < made.height; ++y)
      for (int x = 0; x < made.width; ++x)
        for (int c = 0; c < 3; ++c) {
          float sum = 0.0F;
          for (int j = 0; j < samples_; ++j)
            for (int i = 0; i < samples_; ++i)
              sum += colours_[3 * (static_cast<std::size_t>(y * samples_ + j) *
                                       static_cast<std::size_t>(width_) +
                                   static_cast<std::size_t>(x * samples_ + i)) +
                              static_cast<std::size_t>(c)];
          made.rgb.push_back(static_cast<std::uint8_t>(std::lround(share * sum)));
        }
    return made;
  }

 private:
  int samples_, width_, height_;
  std::vector<float> colours_, nearness_;
};

// Draws a figure: what is behind, solids, what is translucent, and what lies before.
class PixelPicture {
 public:
  PixelPicture(Canvas& canvas, const Figure& figure, const Camera& camera, double k)
      : canvas_(canvas), figure_(figure), camera_(camera), k_(k) {
    for (const Figure::Line& line : figure.lines)
      if (line.behind) draw(line);
    std::vector<Seen> veils;
    for (const Seen& one : seen_faces(figure, camera)) {
      if (one.face->opacity < 1.0)
        veils.push_back(one);
      else
        draw(one, Layer::solid);
    }
    for (const Figure::Line& line : figure.lines)
      if (!line.behind) draw(line);
    std::sort(veils.begin(), veils.end(),
              [](const Seen& a, const Seen& b) { return a.depth > b.depth; });
    for (const Seen& one : veils) draw(one, Layer::veil);
    for (const Figure::Trail& trail : figure.trails) draw(trail);
    for (const Figure::Arrow& arrow : figure.arrows)
      if (const auto made = flat(arrow, camera, k)) draw(*made, arrow.colour);
  }

  void draw(const Labels& labels) {
    for (const Patch& patch : labels.patches) {
      const Corner a{patch.x, patch.y, 0.0}, b{patch.x + patch.width, patch.y, 0.0},
          c{patch.x + patch.width, patch.y + patch.height, 0.0},
          d{patch.x, patch.y + patch.height, 0.0};
      canvas_.triangle(a, b, c, patch.colour, Layer::front);
      canvas_.triangle(a, c, d, patch.colour, Layer::front);
    }
    for (const Words& words : labels.words)
      for (const auto& stroke : lettering(words.text, words.height).strokes)
        for (std::size_t i = 1; i < stroke.size(); ++i)
          canvas_.line({words.at[0] + stroke[i - 1][0], words.at[1] + stroke[i - 1][1], 0.0},
                       {words.at[0] + stroke[i][0], words.at[1] + stroke[i][1], 0.0},
                       0.14 * words.height, words.colour, Layer::front);
  }

 private:
  using Layer = Canvas::Layer;
  using Corner = Canvas::Corner;

  static Corner corner(const Projected& p) { return {p.at[0], p.at[1], 1.0 / p.depth}; }
  static Corner flat_corner(const Point& p) { return {p[0], p[1], 0.0}; }

  void draw(const Figure::Line& line) {
    if (const auto p = project_line(camera_, line.a, line.b))
      canvas_.line(corner((*p)[0]), corner((*p)[1]), line.width * (line.behind ? 1.0 : k_),
                   line.colour, line.behind ? Layer::behind : Layer::solid);
  }

  void draw(const Seen& seen, Layer layer) {
    const Vec3* const p = figure_.points.data() + seen.face->first;
    const Corner first = corner(project(camera_, p[0]));
    for (int i = 1; i + 1 < seen.face->count; ++i)
      canvas_.triangle(first, corner(project(camera_, p[i])), corner(project(camera_, p[i + 1])),
                       seen.colour, layer, seen.face->opacity);
  }

  void draw(const Figure::Trail& trail) {
    for (std::size_t i = 1; i < trail.points.size(); ++i)
      canvas_.line(flat_corner(project(camera_, trail.points[i - 1]).at),
                   flat_corner(project(camera_, trail.points[i]).at), 1.4 * k_, trail.colour,
                   Layer::front);
    canvas_.disc(project(camera_, trail.now).at, 3.5 * k_, trail.colour);
  }

  void draw(const FlatArrow& arrow, const Colour& colour) {
    canvas_.line(flat_corner(arrow.tail), flat_corner(arrow.neck), 2.4 * k_, colour, Layer::front);
    for (const auto& head : arrow.heads)
      canvas_.triangle(flat_corner(head[0]), flat_corner(head[1]), flat_corner(head[2]), colour,
                       Layer::front);
  }

  Canvas& canvas_;
  const Figure& figure_;
  const Camera& camera_;
  double k_;
};

// A figure with what stands around it.
struct Framed {
  Figure figure;
  Labels labels;
};
Framed framed(const Stage& stage, double instant, const Camera& camera,
              const PictureOptions& options) {
  Framed made{stage.figure(instant), {}};
  if (options.grid) add_ground(made.figure, stage, made.labels, camera, options);
  if (options.words) add_words(made.labels, stage, instant, options);
  return made;
}

}  // namespace

Camera camera_of(const Stage& stage, const PictureOptions& options) {
  const Vec3 back = direction_of(stage, options.from).normalized(), up = stage.up();
  const int k = up_axis(up);
  Vec3 above = up;
  if (std::abs(back.dot(up)) > 0.99999) {  // from above: axis k+1 to the right
    above = Vec3::Zero();
    above((k + 2) % 3) = back(k) * 1.0 > 0.0 ? 1.0 : -1.0;
    if (back.dot(up) < 0.0 && up(k) > 0.0) above((k + 2) % 3) = 1.0;
  }
  Camera camera;
  camera.ahead = -back;
  camera.right = above.cross(back).normalized();
  camera.above = back.cross(camera.right);
  const double tall = std::tan(0.5 * field_of_view * degree),
               wide = tall * options.width / options.height;
  camera.focal = 0.5 * options.height / tall;
  camera.middle = {0.5 * options.width, 0.5 * options.height};
  // As near as all that is seen in any frame allows, and in the middle.
  const double border = 0.02 * stage.size();
  Vec3 target = 0.5 * (stage.bounds()[0] + stage.bounds()[1]);
  for (int i = 0; i < 5; ++i) {
    double distance = 0.3 * stage.size();
    for (const Vec3& x : stage.outline()) {
      const Vec3 v = x - target;
      distance = std::max(
          distance, v.dot(back) + 1.1 * std::max((std::abs(v.dot(camera.right)) + border) / wide,
                                                 (std::abs(v.dot(camera.above)) + border) / tall));
    }
    camera.eye = target + distance * back;
    std::array<double, 2> low{1e300, 1e300}, high{-1e300, -1e300};
    for (const Vec3& x : stage.outline()) {
      const Vec3 v = x - camera.eye;
      const double depth = v.dot(camera.ahead);
      const std::array<double, 2> at{v.dot(camera.right) / depth, v.dot(camera.above) / depth};
      for (std::size_t j = 0; j < 2; ++j)
        low[j] = std::min(low[j], at[j]), high[j] = std::max(high[j], at[j]);
    }
    target +=
        0.5 * distance * ((low[0] + high[0]) * camera.right + (low[1] + high[1]) * camera.above);
  }
  return camera;
}

std::string picture_svg(const Stage& stage, double instant, const Camera& camera,
                        const PictureOptions& options) {
  const Framed made = framed(stage, instant, camera, options);
  const nlohmann::ordered_json about{
      {"eye", json(camera.eye)},        {"right", json(camera.right)},
      {"above", json(camera.above)},    {"ahead", json(camera.ahead)},
      {"focal", camera.focal},          {"middle", camera.middle},
      {"centre", json(stage.centre())}, {"key", stage.key(instant)}};
  return svg::document(
      {.width = static_cast<double>(options.width),
       .height = static_cast<double>(options.height),
       .more = fmt::format(
           "width=\"{}\" height=\"{}\" stroke-linecap=\"round\" stroke-linejoin=\"round\"",
           options.width, options.height),
       .title = stage.name(),
       .metadata = about.dump()},
      SvgBody(made.figure, stage, camera, pen(options)).text(made.labels));
}

Pixels picture_pixels(const Stage& stage, double instant, const Camera& camera,
                      const PictureOptions& options, int samples) {
  const Framed made = framed(stage, instant, camera, options);
  Canvas canvas(options.width, options.height, samples);
  PixelPicture(canvas, made.figure, camera, pen(options)).draw(made.labels);
  return canvas.pixels();
}

}  // namespace mbd
