#include "libmbd/core/law.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libmbd/core/spectral.hpp"

namespace mbd {
namespace {

constexpr int gauss_points = 20, most_halvings = 30;
constexpr std::size_t most_pieces = 2048;
constexpr double agreement = 1e-13;

struct Integral {
  double value = 0.0;
  double size = 0.0;  // integral of |f|
};

Integral gauss(const Expression& f, double a, double b) {
  static const auto rule = gauss_rule<double>(gauss_points);
  Integral sum;
  const double h = 0.5 * (b - a), m = 0.5 * (a + b);
  for (std::size_t i = 0; i < rule.points.size(); ++i) {
    const double term = rule.weights[i] * h * f(m + h * rule.points[i]).v;
    sum.value += term;
    sum.size += std::abs(term);
  }
  return sum;
}

// From a to b without a breakpoint between them: all pieces that do not agree with their halves are halved, those at most, of
// which the whole is known better each time. Of a narrow peak the first pieces see next to nothing, and to agree by that
// measure they would be halved for ever.
double smooth_integral(const Expression& f, double a, double b) {
  struct Piece {
    double a, b;
    Integral whole;
  };
  // Kept, as nothing is allocated in steps.
  thread_local std::vector<Piece> pieces, halves;
  pieces.assign(1, {a, b, gauss(f, a, b)});
  double value = 0.0, done = 0.0, size = pieces.front().whole.size;
  for (int k = 0; k < most_halvings && !pieces.empty() && pieces.size() <= most_pieces; ++k) {
    halves.clear();
    double all = done;
    for (const Piece& p : pieces) {
      const double m = 0.5 * (p.a + p.b);
      halves.push_back({p.a, m, gauss(f, p.a, m)});
      halves.push_back({m, p.b, gauss(f, m, p.b)});
      all += halves.rbegin()[0].whole.size + halves.rbegin()[1].whole.size;
    }
    size = std::max(size, all);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const Piece first = halves[2 * i], second = halves[2 * i + 1];
      const double both = first.whole.value + second.whole.value;
      if (std::abs(both - pieces[i].whole.value) > agreement * size) {
        halves[kept++] = first;
        halves[kept++] = second;
      } else {
        value += both;
        done += first.whole.size + second.whole.size;
      }
    }
    halves.resize(kept);
    std::swap(pieces, halves);
  }
  for (const Piece& p : pieces) value += p.whole.value;
  return value;
}

double integral_of(const Expression& f, double x) {
  const double low = std::min(0.0, x), high = std::max(0.0, x);
  double sum = 0.0, from = low;
  for (const double at : f.breakpoints()) {
    if (!(at > low && at < high)) continue;
    sum += smooth_integral(f, from, at);
    from = at;
  }
  sum += smooth_integral(f, from, high);
  return x < 0.0 ? -sum : sum;
}

// Slopes that differ by less, over the larger, or as much as they do within 1e-12 of the argument's unit or of its size, are
// one: those of sin(x) at pi/2 and of what goes on level from there are both round-off.
constexpr double same_slope = 1e-9, sharpest = 1e-12;
constexpr double reach = 1e-9;  // a kink is at x within this of it, or of its size

}  // namespace

// Divided off its middle, where kinks are and slopes may have no value.
std::optional<Kink> hidden_kink(const std::function<double(double)>& slope_at, double x) {
  const double seen = 1e-6, off_middle = 0.45, kept = 0.5, off = reach * std::max(1.0, std::abs(x));
  double low = x - off, high = x + off, below = slope_at(low), above = slope_at(high);
  double most = std::abs(above - below);
  if (!(most > seen * std::max(std::abs(below), std::abs(above)))) return std::nullopt;
  for (int i = 0; i < 14; ++i) {  // to 1e-12
    const double between = low + off_middle * (high - low), slope = slope_at(between);
    const bool first = std::abs(slope - below) > std::abs(above - slope);
    (first ? high : low) = between;
    (first ? above : below) = slope;
    most = std::max(most, std::abs(above - below));  // x^2 is as large on both sides of 0
  }
  if (!(std::abs(above - below) > kept * most)) return {};
  return Kink{0.5 * (low + high), below, above};
}

Law Law::smooth(std::span<const Knot> knots) {
  Table table;
  const Knot &first = knots.front(), &last = knots.back();
  table.push_back({first.x, {first.f, first.df, 0.0, 0.0}, 0.0});
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const Knot &a = knots[i], &b = knots[i + 1];
    const double h = b.x - a.x, slope = (b.f - a.f) / h;
    table.push_back(
        {a.x,
         {a.f, a.df, (3.0 * slope - 2.0 * a.df - b.df) / h, (a.df + b.df - 2.0 * slope) / (h * h)},
         sum});
    sum += h * (0.5 * (a.f + b.f) + h * (a.df - b.df) / 12.0);
  }
  table.push_back({last.x, {last.f, last.df, 0.0, 0.0}, sum});
  return Law(std::move(table));
}

Law Law::linear(std::span<const Knot> knots) {
  Table table;
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const Knot &a = knots[i], &b = knots[i + 1];
    const double h = b.x - a.x, slope = (b.f - a.f) / h;
    if (i == 0) table.push_back({a.x, {a.f, slope, 0.0, 0.0}, 0.0});
    table.push_back({a.x, {a.f, slope, 0.0, 0.0}, sum});
    sum += 0.5 * h * (a.f + b.f);
    if (i + 2 == knots.size()) table.push_back({b.x, {b.f, slope, 0.0, 0.0}, sum});
  }
  return Law(std::move(table));
}

const Law::Piece& Law::piece_at(const Table& table, double x) {
  const auto behind =
      std::upper_bound(table.begin() + 1, table.end(), x,
                       [](double value, const Piece& piece) { return value < piece.from; });
  return *(behind - 1);
}

double Law::antiderivative(const Table& table, double x) {
  const Piece& p = piece_at(table, x);
  const double s = x - p.from;
  return p.before + s * (p.c[0] + s * (p.c[1] / 2.0 + s * (p.c[2] / 3.0 + s * (p.c[3] / 4.0))));
}

LawValue Law::operator()(double x) const {
  if (const auto* const expression = std::get_if<Expression>(&law_)) {
    const Taylor2 value = (*expression)(x);
    return {value.v, value.d};
  }
  const Piece& p = piece_at(std::get<Table>(law_), x);
  const double s = x - p.from;
  return {p.c[0] + s * (p.c[1] + s * (p.c[2] + s * p.c[3])),
          p.c[1] + s * (2.0 * p.c[2] + s * 3.0 * p.c[3])};
}

double Law::integral(double x) const {
  if (const auto* const expression = std::get_if<Expression>(&law_))
    return integral_of(*expression, x);
  const Table& table = std::get<Table>(law_);
  return antiderivative(table, x) - antiderivative(table, 0.0);
}

std::vector<double> Law::knots() const {
  std::vector<double> all;
  if (const auto* const table = std::get_if<Table>(&law_))
    for (std::size_t i = 1; i < table->size(); ++i) all.push_back((*table)[i].from);
  return all;
}

std::optional<Kink> Law::nearest_kink(double x) const {
  std::optional<Kink> nearest;
  const auto offer = [&](const Kink& kink, double round_off) {
    const double size = std::max(std::abs(kink.below), std::abs(kink.above));
    if (!std::isfinite(size) ||
        !(std::abs(kink.above - kink.below) <= std::max(same_slope * size, round_off)))
      if (!nearest || std::abs(kink.at - x) < std::abs(nearest->at - x)) nearest = kink;
  };
  if (const auto* const expression = std::get_if<Expression>(&law_)) {
    for (const double at : expression->breakpoints()) {
      const Taylor2 below = (*expression)(at, Side::left), above = (*expression)(at, Side::right);
      const double curvature = std::max(std::abs(below.dd), std::abs(above.dd));
      offer({at, below.d, above.d},
            std::isfinite(curvature) ? sharpest * std::max(1.0, std::abs(at)) * curvature : 0.0);
    }
    if (!nearest || std::abs(nearest->at - x) > 2.0 * reach * std::max(1.0, std::abs(x)))
      if (const auto hidden = hidden_kink([&](double at) { return (*expression)(at).d; }, x))
        nearest = hidden;
    return nearest;
  }
  const Table& table = std::get<Table>(law_);
  for (std::size_t i = 1; i < table.size(); ++i) {
    const auto& c = table[i - 1].c;
    const double s = table[i].from - table[i - 1].from, second = 2.0 * s * c[2],
                 third = 3.0 * s * s * c[3];
    offer({table[i].from, c[1] + (second + third), table[i].c[1]},
          same_slope * (std::abs(c[1]) + std::abs(second) + std::abs(third)));
  }
  return nearest;
}

}  // namespace mbd
