// Pictures as SVG: what the writers of plots, shapes, sections, effects and 3-D pictures have in common, so that a file opens
// and scales alike whoever made it. Lengths are pixels, y points down. `more`: further attributes, as they are.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace mbd::svg {

// The number, to so many decimals, without zeros at its end. Of what is no number: 0.
std::string number(double x, int decimals = 2);

struct Head {
  double width = 0.0, height = 0.0;
  std::string_view font = "sans-serif";
  double letters = 0.0;   // their size; 0: said where they stand
  std::string more = {};  // how large it is shown, what it is for those who do not see it
  std::string title = {}, metadata = {};
};

// A whole file, on a white ground.
std::string document(const Head& head, std::string_view body);

std::string text(double x, double y, std::string_view words, std::string_view more = "");

// From (x0, y0) to (x1, y1).
std::string line(double x0, double y0, double x1, double y1, std::string_view more);

std::string circle(double x, double y, double radius, std::string_view more, int decimals = 2);

// `title` is shown where the mouse rests on it.
std::string rectangle(double x, double y, double width, double height, std::string_view more,
                      std::string_view title = "");

using Points = std::span<const std::array<double, 2>>;
std::string polyline(Points points, std::string_view more, int decimals = 2);
std::string polygon(Points points, std::string_view more);

}  // namespace mbd::svg
