#include "libmbd/section/crossing.hpp"

#include <algorithm>
#include <numeric>

namespace mbd::section {
namespace {

// Twice the area of the triangle a b c, positive when they go round counter-clockwise.
double area(const Point& a, const Point& b, const Point& c) {
  return (b(0) - a(0)) * (c(1) - a(1)) - (b(1) - a(1)) * (c(0) - a(0));
}

bool cross(const Chord& a, const Chord& b) {
  const double c = area(a.from, a.to, b.from), d = area(a.from, a.to, b.to),
               e = area(b.from, b.to, a.from), f = area(b.from, b.to, a.to);
  if (c == 0.0 && d == 0.0) {  // on one line
    const Point along = a.to - a.from;
    const double size = along.squaredNorm();
    const double p = (b.from - a.from).dot(along), q = (b.to - a.from).dot(along);
    return std::min(p, q) <= size && std::max(p, q) >= 0.0;
  }
  return c * d <= 0.0 && e * f <= 0.0;
}

}  // namespace

std::optional<std::pair<std::size_t, std::size_t>> first_crossing(
    const std::vector<Chord>& chords,
    const std::function<bool(std::size_t a, std::size_t b)>& neighbours) {
  std::vector<std::size_t> order(chords.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto left = [&](std::size_t i) { return std::min(chords[i].from(0), chords[i].to(0)); };
  const auto right = [&](std::size_t i) { return std::max(chords[i].from(0), chords[i].to(0)); };
  std::ranges::sort(order, {}, left);
  std::optional<std::pair<std::size_t, std::size_t>> found;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size() && left(order[j]) <= right(order[i]); ++j) {
      const auto [a, b] = std::minmax(order[i], order[j]);
      if (found && std::pair(a, b) > *found) continue;
      const Chord &p = chords[a], &q = chords[b];
      if (std::max(p.from(1), p.to(1)) < std::min(q.from(1), q.to(1)) ||
          std::max(q.from(1), q.to(1)) < std::min(p.from(1), p.to(1)))
        continue;
      if (!neighbours(a, b) && cross(p, q)) found = {a, b};
    }
  return found;
}

}  // namespace mbd::section
