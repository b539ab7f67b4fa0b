#include "libmbd/scene/laws.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "libmbd/scene/spline.hpp"

namespace mbd {
namespace {

void check_table(const TableScene& table, const std::string& who, std::string_view attribute) {
  const auto fail = [&](const std::string& what) {
    throw Error(table.source, fmt::format("{}: table of {}: {}", who, attribute, what));
  };
  if (table.points.size() < 2)
    fail(fmt::format("it has {} points, must have two at least", table.points.size()));
  for (std::size_t i = 0; i < table.points.size(); ++i) {
    const auto [x, f] = table.points[i];
    if (!std::isfinite(x) || !std::isfinite(f))
      fail(fmt::format("point {} is {}, {}, must be finite numbers", i + 1, x, f));
    if (i > 0 && !(x > table.points[i - 1][0]))
      fail(fmt::format("point {} is at {:g} and the one before it at {:g}; they must rise", i + 1,
                       x, table.points[i - 1][0]));
  }
}

// Where the limits from both sides differ by more than rounding of x explains.
void check_continuous(const Expression& law, char variable, const Source& source,
                      const std::string& who, std::string_view attribute) {
  constexpr double round_off = 1e-10;
  for (const double x : law.breakpoints()) {
    const Taylor2 left = law(x, Side::left), right = law(x, Side::right);
    const double size =
        std::abs(left.v) + std::abs(right.v) + (std::abs(left.d) + std::abs(right.d)) * std::abs(x);
    if (!(std::abs(right.v - left.v) <= round_off * size))
      throw Error(source,
                  fmt::format("{}: {}: it jumps from {:.6g} to {:.6g} at {} = {:.9g}; a law "
                              "must be continuous, give it a steep slope instead",
                              who, attribute, left.v, right.v, variable, x));
  }
}

// From `begin` on: c0 + s (c1 + s (c2 + s c3)), s = t - from.
struct Piece {
  double begin, from;
  double c[4];
};

std::string text_of(const Piece& piece) {
  const auto& c = piece.c;
  const std::string s = fmt::format("(t-({}))", piece.from);
  if (c[2] == 0.0 && c[3] == 0.0) return fmt::format("({})+{}*({})", c[0], s, c[1]);
  return fmt::format("({})+{}*(({})+{}*(({})+{}*({})))", c[0], s, c[1], s, c[2], s, c[3]);
}

std::string text_of(std::span<const Piece> pieces) {
  if (pieces.size() == 1) return text_of(pieces.front());
  const std::size_t half = pieces.size() / 2;
  return fmt::format("t<({})?({}):({})", pieces[half].begin, text_of(pieces.first(half)),
                     text_of(pieces.subspan(half)));
}

}  // namespace

void check_law(const LawScene& law, LawOf of, const Source& source, const std::string& who,
               std::string_view attribute) {
  const char variable = of == LawOf::rate ? 'v' : 'x';
  if (const auto* const table = std::get_if<TableScene>(&law)) {
    check_table(*table, who, attribute);
  } else {
    const Expression& expression = std::get<Expression>(law);
    const Taylor2 at = expression(0.0);
    if (!std::isfinite(at.v) || !std::isfinite(at.d))
      throw Error(source, fmt::format("{}: {} at {} = 0 is {} and its slope {}, must be finite "
                                      "numbers",
                                      who, attribute, variable, at.v, at.d));
    check_continuous(expression, variable, source, who, attribute);
  }
  if (of != LawOf::rate) return;
  const Law made = make_law(law);
  const LawValue at = made(0.0);
  if (!(std::abs(at.f) <= 1e-12 * std::abs(at.df)))
    throw Error(source,
                fmt::format("{}: {} at v = 0 is {:.6g}, must be 0: what acts at rest is the "
                            "spring's",
                            who, attribute, at.f));
}

Law make_law(const LawScene& law) {
  if (const auto* const expression = std::get_if<Expression>(&law)) return Law::of(*expression);
  const TableScene& table = std::get<TableScene>(law);
  const std::vector<Law::Knot> knots = knots_of(table);
  return table.interpolation == Interpolation::linear ? Law::linear(knots) : Law::smooth(knots);
}

std::vector<Law::Knot> knots_of(const TableScene& table) {
  std::vector<Law::Knot> knots;
  for (const auto& [x, f] : table.points) knots.push_back({x, f, 0.0});
  if (table.interpolation == Interpolation::linear) return knots;
  // A spline is a cubic between its breaks, which need not be the points.
  const auto count = static_cast<Index>(table.points.size());
  const double first = table.points.front()[0], width = table.points.back()[0] - first;
  Eigen::MatrixXd values(1, count);
  VecX at(count);
  for (Index i = 0; i < count; ++i) {
    const auto& [x, f] = table.points[static_cast<std::size_t>(i)];
    values(0, i) = f;
    at(i) = i + 1 == count ? 1.0 : (x - first) / width;
  }
  const Spline spline(values, at, static_cast<int>(std::min<Index>(3, count - 1)));
  knots.clear();
  for (const double u : spline.breaks())
    knots.push_back({first + u * width, spline.value(u)(0), spline.derivative(u)(0) / width});
  return knots;
}

std::string function_text(const TableScene& table) {
  const std::vector<Law::Knot> knots = knots_of(table);
  const bool smooth = table.interpolation != Interpolation::linear;
  const auto slope = [&](std::size_t i) {  // of the line from knot i to the next
    return (knots[i + 1].f - knots[i].f) / (knots[i + 1].x - knots[i].x);
  };
  const std::size_t last = knots.size() - 1;
  std::vector<Piece> pieces;
  const auto& first = knots.front();
  pieces.push_back({first.x, first.x, {first.f, smooth ? first.df : slope(0), 0.0, 0.0}});
  for (std::size_t i = 0; i < last; ++i) {
    const auto& [x, f, df] = knots[i];
    if (!smooth) {
      if (i > 0) pieces.push_back({x, x, {f, slope(i), 0.0, 0.0}});
      continue;
    }
    const double h = knots[i + 1].x - x, mean = slope(i), next = knots[i + 1].df;
    pieces.push_back(
        {x, x, {f, df, (3.0 * mean - 2.0 * df - next) / h, (df + next - 2.0 * mean) / (h * h)}});
  }
  if (smooth)
    pieces.push_back({knots[last].x, knots[last].x, {knots[last].f, knots[last].df, 0, 0}});
  return text_of(pieces);
}

LawScene scaled_law(const LawScene& law, double factor, double stretch) {
  if (const auto* const expression = std::get_if<Expression>(&law)) {
    const Expression::Term one[] = {{factor, expression}};
    return Expression::sum(one, stretch);
  }
  TableScene table = std::get<TableScene>(law);
  for (auto& [x, f] : table.points) {
    x *= stretch;
    f *= factor;
  }
  return table;
}

}  // namespace mbd
