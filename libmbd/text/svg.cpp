#include "libmbd/text/svg.hpp"

#include <fmt/format.h>

#include <cmath>

#include "libmbd/text/text.hpp"

namespace mbd::svg {
namespace {

std::string blank_before(std::string_view more) {
  return more.empty() ? "" : " " + std::string(more);
}

std::string shape_of(std::string_view element, Points points, std::string_view more, int decimals) {
  std::string made = fmt::format("<{}{} points=\"", element, blank_before(more));
  for (std::size_t i = 0; i < points.size(); ++i)
    made += fmt::format("{}{},{}", i == 0 ? "" : " ", number(points[i][0], decimals),
                        number(points[i][1], decimals));
  return made + "\"/>\n";
}

}  // namespace

std::string number(double x, int decimals) {
  if (!std::isfinite(x)) return "0";
  std::string digits = fmt::format("{:.{}f}", x, decimals);
  if (digits.find('.') != std::string::npos) {
    digits.erase(digits.find_last_not_of('0') + 1);
    if (digits.back() == '.') digits.pop_back();
  }
  return digits == "-0" ? "0" : digits;
}

std::string document(const Head& head, std::string_view body) {
  const std::string width = number(head.width), height = number(head.height);
  std::string made = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\"{} font-family=\"{}\"", width,
      height, blank_before(head.more), head.font);
  if (head.letters > 0.0) made += fmt::format(" font-size=\"{}\"", number(head.letters));
  made += ">\n";
  if (!head.title.empty()) made += "<title>" + xml_escaped(head.title) + "</title>\n";
  if (!head.metadata.empty()) made += "<metadata>" + xml_escaped(head.metadata) + "</metadata>\n";
  made += fmt::format("<rect width=\"{}\" height=\"{}\" fill=\"#ffffff\"/>\n", width, height);
  return made.append(body) + "</svg>\n";
}

std::string text(double x, double y, std::string_view words, std::string_view more) {
  return fmt::format("<text x=\"{}\" y=\"{}\"{}>{}</text>\n", number(x), number(y),
                     blank_before(more), xml_escaped(words));
}

std::string line(double x0, double y0, double x1, double y1, std::string_view more) {
  return fmt::format("<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"{}/>\n", number(x0), number(y0),
                     number(x1), number(y1), blank_before(more));
}

std::string circle(double x, double y, double radius, std::string_view more, int decimals) {
  return fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{}/>\n", number(x, decimals),
                     number(y, decimals), number(radius), blank_before(more));
}

std::string rectangle(double x, double y, double width, double height, std::string_view more,
                      std::string_view title) {
  const std::string made =
      fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{}", number(x), number(y),
                  number(width), number(height), blank_before(more));
  if (title.empty()) return made + "/>\n";
  return made + "><title>" + xml_escaped(title) + "</title></rect>\n";
}

std::string polyline(Points points, std::string_view more, int decimals) {
  return shape_of("polyline", points, more, decimals);
}

std::string polygon(Points points, std::string_view more) {
  return shape_of("polygon", points, more, 2);
}

}  // namespace mbd::svg
