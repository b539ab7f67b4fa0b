#include "libmbd/run/section_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "libmbd/material/shaped_sections.hpp"
#include "libmbd/scene/label.hpp"
#include "libmbd/text/spelling.hpp"
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

// The shades and what they stand for, at a height in the picture; closes it.
std::string legend(double bar, double least, double most) {
  std::string svg;
  constexpr int shades = 48;
  const double width = (picture_width - 2.0 * border) / shades;
  for (int i = 0; i < shades; ++i)
    svg += fmt::format(
        "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.0f}\" fill=\"{}\"/>\n",
        border + i * width, bar, width + 0.2, bar_height,
        code_of(Stage::shade((i + 0.5) / shades)));
  svg += fmt::format(
      "<text x=\"{:.0f}\" y=\"{:.1f}\">{:.4g}</text>\n<text x=\"{:.0f}\" y=\"{:.1f}\" "
      "text-anchor=\"end\">{:.4g}</text>\n</svg>\n",
      border, bar + bar_height + letter_size, least, picture_width - border,
      bar + bar_height + letter_size, most);
  return svg;
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
  const bool is_length = quantity == "warping",
             has_unit = is_length || stress_quantity_unit(quantity) == "Pa";
  const std::string unit = !has_unit ? "" : is_length ? " [m]" : " [Pa]";
  const Vec6& S = load.resultants;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "style=\"max-width:{2:.0f}px\" font-family=\"sans-serif\" font-size=\"{3:.0f}\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
      "<text x=\"{4:.0f}\" y=\"{5:.0f}\">{6}: {7}{8}</text>\n"
      "<text x=\"{4:.0f}\" y=\"{9:.0f}\">N1 {10:.4g}, Q2 {11:.4g}, Q3 {12:.4g} N; M1 {13:.4g}, M2 "
      "{14:.4g}, M3 {15:.4g} N.m</text>\n"
      "<text x=\"{4:.0f}\" y=\"{16:.0f}\">b2 to the right, b3 up; {17:.4g} m wide</text>\n",
      picture_width, height, 2.0 * picture_width, letter_size, border, line_height,
      xml_escaped(label("section", name)), xml_escaped(quantity), unit, 2.0 * line_height, S(0),
      S(1), S(2), S(3), S(4), S(5), 3.0 * line_height, size(0));
  const auto shade = [&](double value) {
    return code_of(Stage::shade(most > least ? (value - least) / (most - least) : 0.0));
  };
  for (const Cell& cell : cells.all()) {
    // Its own colour as line, too: nothing of the ground is seen between cells.
    const std::string fill = cell.value ? shade(*cell.value) : "#cccccc";
    svg += fmt::format("<polygon fill=\"{0}\" stroke=\"{0}\" stroke-width=\"0.4\" points=\"", fill);
    for (const section::Point& x : cell.corners)
      svg += fmt::format("{:.2f},{:.2f} ", left + scale * (x(0) - low(0)),
                         bottom - scale * (x(1) - low(1)));
    svg += "\"/>\n";
  }
  return svg + legend(bar, least, most);
}

}  // namespace mbd
