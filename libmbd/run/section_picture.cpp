#include "libmbd/run/section_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "libmbd/material/shaped_sections.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/text/spelling.hpp"
#include "libmbd/text/svg.hpp"
#include "libmbd/text/text.hpp"
#include "libmbd/view/figure.hpp"

namespace mbd {
namespace {

constexpr double picture_width = 480.0, most_height = 480.0, border = 12.0, letter_size = 11.0,
                 line_height = 16.0, bar_height = 10.0;
constexpr int most_cells = 20'000, most_divisions = 4;

struct Cell {
  std::vector<section::Point> corners;
  std::optional<double> value;
};

class Cells {
 public:
  Cells(const section::StressField& field, const Vec6& resultants, const std::string& quantity)
      : field_(field), resultants_(resultants), quantity_(quantity) {
    const auto elements = static_cast<int>(field.mesh().elements.size());
    int n = most_divisions;
    while (n > 1 && elements * n * n > most_cells) --n;
    for (int e = 0; e < elements; ++e)
      if (field.mesh().elements[static_cast<std::size_t>(e)].shape == section::Shape::triangle)
        add_triangles(e, n);
      else
        add_squares(e, n);
  }
  const std::vector<Cell>& all() const { return all_; }

 private:
  void add_squares(int e, int n) {
    const auto at = [n](double k) { return 2.0 * k / n - 1.0; };
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        add({{e, at(i), at(j)},
             {e, at(i + 1), at(j)},
             {e, at(i + 1), at(j + 1)},
             {e, at(i), at(j + 1)}});
  }
  // On (0, 0), (1, 0), (0, 1): those that lie as it does, and those between.
  void add_triangles(int e, int n) {
    const auto at = [n](double k) { return k / n; };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        add({{e, at(i), at(j)}, {e, at(i + 1), at(j)}, {e, at(i), at(j + 1)}});
        if (i + j + 1 < n)
          add({{e, at(i + 1), at(j)}, {e, at(i + 1), at(j + 1)}, {e, at(i), at(j + 1)}});
      }
  }
  void add(const std::vector<section::ElementPoint>& corners) {
    Cell cell;
    section::ElementPoint middle{corners[0].element, 0.0, 0.0};
    for (const section::ElementPoint& corner : corners) {
      cell.corners.push_back(field_.position(corner));
      middle.xi += corner.xi / static_cast<double>(corners.size());
      middle.eta += corner.eta / static_cast<double>(corners.size());
    }
    if (quantity_ == "warping")
      cell.value = field_.warping(middle).row(0).dot(resultants_);
    else
      cell.value = stress_quantity(quantity_, field_.mesh().material_of(middle.element),
                                   field_.at(middle).stress * resultants_);
    all_.push_back(std::move(cell));
  }

  const section::StressField& field_;
  const Vec6& resultants_;
  const std::string& quantity_;
  std::vector<Cell> all_;
};

// The shades and what they stand for, at a height in the picture.
std::string legend(double bar, double least, double most) {
  std::string body;
  constexpr int shades = 48;
  const double width = (picture_width - 2.0 * border) / shades;
  for (int i = 0; i < shades; ++i)
    body += svg::rectangle(border + i * width, bar, width + 0.2, bar_height,
                           fmt::format("fill=\"{}\"", code_of(Stage::shade((i + 0.5) / shades))));
  const double below = bar + bar_height + letter_size;
  return body + svg::text(border, below, fmt::format("{:.4g}", least)) +
         svg::text(picture_width - border, below, fmt::format("{:.4g}", most),
                   "text-anchor=\"end\"");
}

// What is shown, of which resultants S, and its size [m].
std::string words(const std::string& what, const std::string& quantity, const Vec6& S,
                  double width) {
  const bool is_length = quantity == "warping",
             has_unit = is_length || stress_quantity_unit(quantity) == "Pa";
  const std::string unit = !has_unit ? "" : is_length ? " [m]" : " [Pa]";
  return svg::text(border, line_height, what + unit) +
         svg::text(
             border, 2.0 * line_height,
             fmt::format("N1 {:.4g}, Q2 {:.4g}, Q3 {:.4g} N; M1 {:.4g}, M2 {:.4g}, M3 {:.4g} N.m",
                         S(0), S(1), S(2), S(3), S(4), S(5))) +
         svg::text(border, 3.0 * line_height,
                   fmt::format("b2 to the right, b3 up; {:.4g} m wide", width));
}

}  // namespace

std::string section_picture(const Scene& scene, const std::string& section,
                            std::optional<double> station, const SectionLoad& load,
                            const std::string& quantity) {
  std::string name = section;
  const SectionShape& shape = shape_of_section(scene, name, station);
  std::vector<std::string_view> known = stress_quantities();
  known.emplace_back("warping");
  if (std::ranges::find(known, quantity) == known.end())
    throw Error(fmt::format("colour {}: there is no such quantity{}", in_quotes(excerpt(quantity)),
                            suggest(quantity, known, "quantities")));
  const auto field = stress_field(scene, shape, label("section", name));
  const Cells cells(*field, load.resultants, quantity);
  section::Point low = section::Point::Constant(1e300), high = -low;
  double least = 1e300, most = -1e300;
  for (const Cell& cell : cells.all()) {
    for (const section::Point& x : cell.corners) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    if (!cell.value) continue;
    least = std::min(least, *cell.value);
    most = std::max(most, *cell.value);
  }
  if (!(least <= most))
    throw Error(shape.source,
                fmt::format("{}: colour {}: none of its materials has the strengths that it is of; "
                            "state them, or take another quantity: {}",
                            label("section", name), quantity, list(known)));
  const section::Point size = high - low;
  const double scale = std::min((picture_width - 2.0 * border) / size(0), most_height / size(1)),
               top = 3.0 * line_height + border, bottom = top + scale * size(1),
               left = 0.5 * (picture_width - scale * size(0)), bar = bottom + border,
               height = bar + bar_height + line_height + border;
  std::string body =
      words(label("section", name) + ": " + quantity, quantity, load.resultants, size(0));
  const auto shade = [&](double value) {
    return code_of(Stage::shade(most > least ? (value - least) / (most - least) : 0.0));
  };
  for (const Cell& cell : cells.all()) {
    // Its own colour as line, too: nothing of the ground is seen between cells.
    const std::string fill = cell.value ? shade(*cell.value) : "#cccccc";
    std::vector<std::array<double, 2>> corners;
    for (const section::Point& x : cell.corners)
      corners.push_back({left + scale * (x(0) - low(0)), bottom - scale * (x(1) - low(1))});
    body += svg::polygon(corners,
                         fmt::format("fill=\"{0}\" stroke=\"{0}\" stroke-width=\"0.4\"", fill));
  }
  return svg::document({.width = picture_width,
                        .height = height,
                        .letters = letter_size,
                        .more = fmt::format("style=\"max-width:{:.0f}px\"", 2.0 * picture_width)},
                       body + legend(bar, least, most));
}

}  // namespace mbd
