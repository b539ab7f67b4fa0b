#include "solvers/laws/passed_features.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "libmbd/core/law_cells.hpp"
#include "solvers/laws/law_steps.hpp"

namespace mbd {
namespace {

constexpr long most_cells_of_a_law = 20'000;  // cells of a law
constexpr double beside = 0.5;                // of the range
constexpr double aside =
    1e-3;  // of a law's range, out of its values at both places: what it does between them
constexpr double scatter = 0.02;  // the same of tables, which are measured

bool switches_twice(const Expression& f, double a, double b) {
  return std::ranges::count_if(f.breakpoints(), [&](double x) { return a < x && x < b; }) >= 2;
}

}  // namespace

// A polynomial of fewer degrees than cells are made of has one cell, wherever it is. Over all that a scene can hold: where it is
// alone, a peak far away is zero to the last bit.
bool PassedFeatures::Known::is_polynomial(const Expression& f) {
  constexpr std::size_t degrees = 6;
  constexpr double everywhere = 1e12;
  if (!f.breakpoints().empty()) return false;
  std::array<Interval, Expression::most_coefficients> c;
  f.enclose(-everywhere, everywhere, c);
  return std::all_of(c.begin() + degrees, c.end(),
                     [](const Interval& x) { return x.lo == 0.0 && x.hi == 0.0; });
}

// Ranges stay near what is travelled: what a law does far away would hide what it does here.
void PassedFeatures::Known::cover(double x) {
  if (is_plain) return;
  if (!std::isfinite(x) || (lo <= x && x <= hi && !places.empty())) return;
  if (places.empty()) {
    const double half = std::max(0.1 * std::abs(x), std::numeric_limits<double>::min());
    lo = x - half;
    hi = x + half;
  } else {
    const double a = std::min(lo, x), b = std::max(hi, x), more = beside * (b - a);
    if (x < lo) lo = a - more;
    if (x > hi) hi = b + more;
  }
  find();
}

void PassedFeatures::Known::find() {
  std::vector<double> ends;
  if (!is_table()) {
    ends = find_cells(*expression(), {}, lo, hi, most_cells_of_a_law).ends;
  } else {
    for (const double knot : law->knots())
      if (lo < knot && knot < hi) ends.push_back(knot);
  }
  places.assign(1, lo);
  for (const double end : ends) {
    if (!(end > places.back())) continue;
    places.push_back(0.5 * (places.back() + end));
    places.push_back(end);
  }
  values.clear();
  least = std::numeric_limits<double>::infinity();
  most = -least;
  for (const double x : places) {
    values.push_back(at(x));
    if (!std::isfinite(values.back())) continue;
    least = std::min(least, values.back());
    most = std::max(most, values.back());
  }
}

void PassedFeatures::look(const State& state, std::vector<double>& x) {
  x.clear();
  std::size_t k = 0;
  const auto add = [&](double argument, const auto& make) {
    if (k == known_.size()) known_.push_back(make());
    known_[k].cover(argument);
    x.push_back(argument);
    ++k;
  };
  system_.law_arguments(state, arguments_);
  for (const LawArgument& one : arguments_)
    add(one.x, [&one] {
      Known law;
      law.law = one.law;
      law.is_plain = !law.is_table() && Known::is_polynomial(*law.expression());
      return law;
    });
  if (!system_.feeds_back()) return;
  system_.each_law_of_sensors(
      state, [&](const std::string&, const Expression& law, std::span<const double> readings) {
        // What a law is multiplied with may be zero, what is added to a sensor is what it is.
        for (const double zero : {0.0, 1.0})
          for (std::size_t i = 0; i < readings.size() && (zero == 0.0 || readings.size() > 1); ++i)
            add(readings[i], [&] {
              std::vector<double> others(readings.begin(), readings.end());
              std::ranges::replace(others, 0.0, zero);
              Known of;
              of.other = law.of_sensor(i, others, state.t);
              of.is_plain = !of.other || Known::is_polynomial(*of.other);
              return of;
            });
      });
}

// What part of the way from one argument to another the law goes as far as it may, if it does more.
std::optional<double> PassedFeatures::over(Known& law, double from, double to) {
  if (law.is_plain) return std::nullopt;
  const auto [a, b] = std::minmax(from, to);
  const auto first = std::ranges::upper_bound(law.places, a),
             last = std::ranges::lower_bound(law.places, b);
  // With the middles. Pieces between knots of a table, or between what conditions compare with, are not made to be short where the
  // law does something: two of them are a peak.
  constexpr std::ptrdiff_t two = 3;
  if (last - first <= two) return std::nullopt;
  const auto allowed = law.is_table() || switches_twice(*law.expression(), a, b)
                           ? two
                           : static_cast<std::ptrdiff_t>(2 * LawSteps::reach);
  if (last - first <= allowed) return std::nullopt;
  const double f = law.at(from), g = law.at(to);
  const double margin = (law.is_table() ? scatter : aside) * (law.most - law.least);
  const auto values = std::span(law.values)
                          .subspan(static_cast<std::size_t>(first - law.places.begin()),
                                   static_cast<std::size_t>(last - first));
  if (std::ranges::none_of(values, [&](double y) {
        return y < std::min(f, g) - margin || y > std::max(f, g) + margin;
      }))
    return std::nullopt;
  const double end = to > from ? *(first + (allowed - 1)) : *(last - allowed);
  return (end - from) / (to - from);
}

std::optional<double> PassedFeatures::end(const State& begin, std::span<const State> inside,
                                          const State& end) {
  if (any_ && !*any_) return std::nullopt;
  look(begin, before_);
  any_ = std::ranges::any_of(known_, [](const Known& law) { return !law.is_plain; });
  if (!*any_) return std::nullopt;
  double from = begin.t;
  for (std::size_t i = 0; i <= inside.size(); ++i) {
    const State& there = i < inside.size() ? inside[i] : end;
    look(there, after_);
    if (after_.size() != before_.size()) return std::nullopt;
    double part = 2.0;
    for (std::size_t k = 0; k < after_.size(); ++k)
      if (const auto share = over(known_[k], before_[k], after_[k])) part = std::min(part, *share);
    if (part <= 1.0) return from + part * (there.t - from);
    from = there.t;
    std::swap(before_, after_);
  }
  return std::nullopt;
}

}  // namespace mbd
