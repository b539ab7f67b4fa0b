#include "libmbd/core/law_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>

#include "libmbd/core/interval.hpp"
#include "libmbd/core/stop.hpp"

namespace mbd {
namespace {

constexpr double resolved = 1e-4;       // |R|, of the scale
constexpr double least_of_size = 1e-3;  // of the size, and
constexpr double least_of_rate =
    1e-6;                          // of the change by the derivative below it: a scale is not less
constexpr double shortest = 1e-9;  // of the whole time
constexpr std::size_t order = 6;   // of the remainder
constexpr std::size_t derivatives = 3;
constexpr double none = std::numeric_limits<double>::infinity();

struct Cell {
  double a, b;
  std::array<double, derivatives> rest;  // by derivative, where it is looked at
  double key = 0.0;                      // the largest rest over its scale, when it was looked at
  bool operator<(const Cell& other) const {
    return key != other.key ? key < other.key : b - a < other.b - other.a;
  }
};

class Search {
 public:
  Search(const Expression& f, std::span<const int> more, double begin, double end)
      : f_(f), length_(end - begin) {
    looked_at_[0] = true;
    for (const int k : more) looked_at_[static_cast<std::size_t>(k)] = true;
    low_.fill(none);
    high_.fill(-none);
  }

  void observe(double t, Side side) {
    const Taylor2 x = f_(t, side);
    const double values[derivatives] = {x.v, x.d, x.dd};
    for (std::size_t k = 0; k < derivatives; ++k)
      if (std::isfinite(values[k])) {
        low_[k] = std::min(low_[k], values[k]);
        high_[k] = std::max(high_[k], values[k]);
      }
  }

  double key(const Cell& cell) const {
    double worst = 0.0, before = 0.0;
    for (std::size_t k = 0; k < derivatives; ++k) {
      const double range = std::max(high_[k] - low_[k], 0.0);
      const double size = std::max(std::abs(high_[k]), std::abs(low_[k]));
      const double scale = std::max({range, std::isfinite(size) ? least_of_size * size : 0.0,
                                     least_of_rate * before / length_});
      before = scale;
      if (!looked_at_[k]) continue;
      // What underflows is nothing.
      const double over = cell.rest[k] / std::max(resolved * scale, 1e-290);
      worst = over <= worst ? worst : over;  // a NaN stays
    }
    return std::isnan(worst) ? none : worst;
  }

  Cell cell(double a, double b) {
    stop::check();
    observe(a + 0.5 * (b - a), Side::right);
    Cell result{a, b, {}};
    std::array<Interval, order + derivatives> c;
    f_.enclose(a, b, c);
    const double r = std::pow(0.5 * (b - a), double(order));
    double product = 1.0;  // (order + k)!/order!, of c
    for (std::size_t k = 0; k < derivatives; ++k) {
      product *= k == 0 ? 1.0 : double(order + k);
      if (!looked_at_[k]) continue;
      const double remainder = product * interval::magnitude(c[order + k]) * r;
      const double change = (k == 2 ? 2.0 : 1.0) * (c[k].hi - c[k].lo);
      result.rest[k] = std::isnan(remainder) ? change : std::min(remainder, change);
    }
    result.key = key(result);
    return result;
  }

 private:
  const Expression& f_;
  double length_;
  std::array<bool, derivatives> looked_at_{};
  std::array<double, derivatives> low_{}, high_{};
};

}  // namespace

double LawCells::narrowest(double from, double to) const {
  auto next = std::upper_bound(ends.begin(), ends.end(), from);
  double width = none;
  for (; next != ends.end(); ++next) {
    if (next == ends.begin()) continue;
    width = std::min(width, *next - *std::prev(next));
    if (*next >= to) break;
  }
  return width;
}

LawCells find_cells(const Expression& f, std::span<const int> more, double begin, double end,
                    long most) {
  LawCells result;
  std::vector<double> knots{begin};
  for (const double t : f.breakpoints())
    if (begin < t && t < end) knots.push_back(t);
  knots.push_back(end);
  if (f.is_constant()) {
    result.ends = {begin, end};
    return result;
  }
  Search search(f, more, begin, end);
  for (std::size_t i = 0; i < knots.size(); ++i) {
    if (i > 0) search.observe(knots[i], Side::left);
    if (i + 1 < knots.size()) search.observe(knots[i], Side::right);
  }
  std::priority_queue<Cell> queue;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i)
    queue.push(search.cell(knots[i], knots[i + 1]));
  result.ends = std::move(knots);
  long count = static_cast<long>(queue.size());
  while (!queue.empty() && queue.top().key > 1.0) {
    Cell worst = queue.top();
    queue.pop();
    // Scales have grown since it was looked at.
    worst.key = search.key(worst);
    if (!queue.empty() && worst < queue.top()) {
      queue.push(worst);
      continue;
    }
    if (!(worst.key > 1.0)) continue;
    const double middle = worst.a + 0.5 * (worst.b - worst.a);
    const bool floor = worst.b - worst.a < 2.0 * shortest * (end - begin) ||
                       !(worst.a < middle && middle < worst.b);
    if (floor || count >= most) {
      if (!result.unresolved) result.unresolved = middle;
      if (!floor) break;
      continue;
    }
    queue.push(search.cell(worst.a, middle));
    queue.push(search.cell(middle, worst.b));
    result.ends.push_back(middle);
    ++count;
  }
  std::sort(result.ends.begin(), result.ends.end());
  return result;
}

}  // namespace mbd
