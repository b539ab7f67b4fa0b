#include "libmbd/pictures/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libmbd/core/error.hpp"
#include "libmbd/pictures/plot.hpp"
#include "libmbd/scene/label.hpp"

namespace mbd {
namespace {

constexpr double nearness = 1e-9;  // of two times, relative to the common interval

void check_times(const History& history) {
  const std::vector<double>& t = history.values[0];
  for (std::size_t i = 1; i < t.size(); ++i)
    if (!(t[i] > t[i - 1]))
      throw Error(
          Source{history.file.string(), history.lines[i]},
          fmt::format(
              "\"{}\" is {} after {}, must increase from row to row to be compared; {}",
              excerpt(history.columns[0].name), t[i], t[i - 1],
              history.columns[0].name == "load_factor"
                  ? "a path that turns back has more than one state at a load: compare parts "
                    "of it in which the load rises"
                  : "sort the rows, or remove those that repeat"));
}

std::optional<std::size_t> find(const History& history, const std::string& name) {
  for (std::size_t i = 0; i < history.columns.size(); ++i)
    if (history.columns[i].name == name) return i;
  return std::nullopt;
}

// The columns that the names choose here; a name may be one that only the other history has.
std::vector<std::size_t> chosen_here(const History& here, const History& other,
                                     std::span<const std::string> names) {
  std::vector<std::size_t> chosen;
  if (names.empty()) {
    for (std::size_t i = 1; i < here.columns.size(); ++i) chosen.push_back(i);
    return chosen;
  }
  for (const std::string& name : names) {
    try {
      for (const std::size_t i : choose_columns(here, {&name, 1}))
        if (i > 0 && std::find(chosen.begin(), chosen.end(), i) == chosen.end())
          chosen.push_back(i);
    } catch (const Error& unknown) {
      try {
        choose_columns(other, {&name, 1});
      } catch (const Error&) {
        throw unknown;
      }
    }
  }
  return chosen;
}

// A history at a time: one of its rows, or the polynomial through some that lie around.
struct Stencil {
  std::size_t begin = 0;
  std::vector<double> weights;  // of the rows from `begin`

  double value(const std::vector<double>& column) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i) sum += weights[i] * column[begin + i];
    return sum;
  }
};

Stencil stencil_at(const std::vector<double>& t, double at, double near) {
  const auto after = static_cast<std::size_t>(std::lower_bound(t.begin(), t.end(), at) - t.begin());
  for (const std::size_t i : {after > 0 ? after - 1 : 0, std::min(after, t.size() - 1)})
    if (std::abs(t[i] - at) <= near) return {i, {1.0}};
  const std::size_t points = std::min<std::size_t>(4, t.size());
  const std::size_t begin =
      std::min(after > points / 2 ? after - points / 2 : 0, t.size() - points);
  Stencil stencil{begin, std::vector<double>(points, 1.0)};
  for (std::size_t i = 0; i < points; ++i)
    for (std::size_t j = 0; j < points; ++j)
      if (j != i) stencil.weights[i] *= (at - t[begin + j]) / (t[begin + i] - t[begin + j]);
  return stencil;
}

// Rows whose time lies in [from, to]: the first and the one after the last.
std::array<std::size_t, 2> rows_within(const std::vector<double>& t, double from, double to) {
  return {static_cast<std::size_t>(std::lower_bound(t.begin(), t.end(), from) - t.begin()),
          static_cast<std::size_t>(std::upper_bound(t.begin(), t.end(), to) - t.begin())};
}

std::string with_unit(double value, const std::string& unit) {
  return fmt::format("{:.6g}{}{}", value, unit.empty() ? "" : " ", unit);
}

void check_common_axis(const History& first, const History& second) {
  const Column &x = first.columns[0], &x_second = second.columns[0];
  if (x.name != x_second.name ||
      (x.unit != x_second.unit && !x.unit.empty() && !x_second.unit.empty()))
    throw Error(
        fmt::format("{}: the first column is \"{}\" [{}], of {} it is \"{}\" [{}]; both must begin "
                    "with the same, "
                    "which they are compared over",
                    first.file.string(), excerpt(x.name), excerpt(x.unit), second.file.string(),
                    excerpt(x_second.name), excerpt(x_second.unit)));
  check_times(first);
  check_times(second);
}

void pair_columns(const History& first, const History& second, std::span<const std::string> names,
                  Comparison& result) {
  for (const std::size_t i : chosen_here(first, second, names)) {
    const Column& column = first.columns[i];
    const std::optional<std::size_t> other = find(second, column.name);
    if (!other) {
      result.only_first.push_back(column.name);
      continue;
    }
    const std::string& unit = second.columns[*other].unit;
    if (unit != column.unit)
      throw Error(
          fmt::format("{}: column \"{}\" is in [{}], in {} it is in [{}]; only columns of one "
                      "unit can be compared: name others",
                      first.file.string(), excerpt(column.name),
                      column.unit.empty() ? "1" : excerpt(column.unit), second.file.string(),
                      unit.empty() ? "1" : excerpt(unit)));
    result.columns.push_back({column.name, column.unit, i, *other});
  }
  for (const std::size_t i : chosen_here(second, first, names))
    if (!find(first, second.columns[i].name)) result.only_second.push_back(second.columns[i].name);
  if (result.columns.empty())
    throw Error(fmt::format("{}: has no column to compare with {}; {}", first.file.string(),
                            second.file.string(),
                            names.empty() ? "record the same in both models"
                                          : "name records or columns that both have"));
}

// The times at which both are compared: those of the coarser one in the interval that both cover.
struct Samples {
  bool at_first;                            // the first is the coarser
  std::size_t begin;                        // its first row in the interval
  std::size_t n1, n2;                       // rows of each in the interval
  const std::vector<double>&coarse, &fine;  // all times of either
  std::vector<Stencil> stencils;            // the finer one at them
};

Samples common_samples(const History& first, const History& second, Comparison& result) {
  const std::vector<double>&t1 = first.values[0], &t2 = second.values[0];
  result.from = std::max(t1.front(), t2.front());
  result.to = std::min(t1.back(), t2.back());
  const double near = nearness * std::max(result.to - result.from, 0.0);
  const std::array<std::size_t, 2> rows1 = rows_within(t1, result.from - near, result.to + near);
  const std::array<std::size_t, 2> rows2 = rows_within(t2, result.from - near, result.to + near);
  const std::size_t n1 = rows1[1] - rows1[0], n2 = rows2[1] - rows2[0];
  if (result.to < result.from || n1 == 0 || n2 == 0)
    throw Error(
        fmt::format("{}: covers {} from {:.9g} to {:.9g}, {} from {:.9g} to {:.9g}, with no "
                    "sample in common; run both over a common interval",
                    first.file.string(), excerpt(first.columns[0].name), t1.front(), t1.back(),
                    second.file.string(), t2.front(), t2.back()));
  const bool at_first = n1 <= n2;
  const std::array<std::size_t, 2>& rows = at_first ? rows1 : rows2;
  Samples samples{at_first, rows[0], n1, n2, at_first ? t1 : t2, at_first ? t2 : t1, {}};
  for (std::size_t row = rows[0]; row < rows[1]; ++row) {
    samples.stencils.push_back(stencil_at(samples.fine, samples.coarse[row], near));
    if (samples.stencils.back().weights.size() > 1) ++result.interpolated;
  }
  result.samples = samples.stencils.size();
  return samples;
}

void measure(const History& first, const History& second, const Samples& samples,
             ColumnDifference& d) {
  const std::vector<double>&v1 = first.values[d.in_first], &v2 = second.values[d.in_second];
  for (std::size_t i = 1; i < first.columns.size(); ++i)
    if (quantity_of(first.columns[i].name) == quantity_of(d.name))
      for (const double value : first.values[i]) d.scale = std::max(d.scale, std::abs(value));
  double sum = 0.0;
  std::vector<double> differences;
  for (std::size_t i = 0; i < samples.stencils.size(); ++i) {
    const double own = (samples.at_first ? v1 : v2)[samples.begin + i];
    const double other = samples.stencils[i].value(samples.at_first ? v2 : v1);
    const double difference = std::abs(other - own);
    differences.push_back(difference);
    if (difference > d.largest || i == 0) {
      d.largest = difference;
      d.at = samples.coarse[samples.begin + i];
    }
  }
  // scaled, so that squares neither overflow nor vanish
  if (d.largest > 0.0)
    for (const double difference : differences)
      sum += (difference / d.largest) * (difference / d.largest);
  d.rms = d.largest * std::sqrt(sum / static_cast<double>(differences.size()));
}

std::string words_of_sampling(const History& first, const History& second, const Samples& samples,
                              const Comparison& result) {
  const Column& x = first.columns[0];
  const std::string of_x =
      fmt::format("{} from {} to ", excerpt(x.name), result.from) + with_unit(result.to, x.unit);
  const std::array<std::string, 2> called = short_names(first, second);
  const std::string& coarser = called[samples.at_first ? 0 : 1];
  const std::string& finer = called[samples.at_first ? 1 : 0];
  const std::string count =
      result.samples == 1 ? "the one sample" : fmt::format("the {} samples", result.samples);
  std::string words;
  if (result.interpolated > 0)
    words = fmt::format(
        "at {} of {}, the coarser, in {}; {} has no sample at {} of them and is interpolated there "
        "by {}",
        count, coarser, of_x, finer, result.interpolated,
        samples.fine.size() >= 4
            ? "the cubic through 4 neighbouring samples"
            : fmt::format("the polynomial through its {} samples", samples.fine.size()));
  else
    words = fmt::format(
        "at {} that both have{}, {}", count,
        samples.n1 == samples.n2 ? "" : fmt::format(" (all of {}, the coarser)", coarser), of_x);
  const std::size_t outside =
      first.values[0].size() - samples.n1 + second.values[0].size() - samples.n2;
  if (outside > 0) words += fmt::format("; {} rows outside this interval are not used", outside);
  return words;
}

}  // namespace

Comparison compare(const History& first, const History& second,
                   std::span<const std::string> names) {
  check_common_axis(first, second);
  Comparison result;
  pair_columns(first, second, names, result);
  const Samples samples = common_samples(first, second, result);
  for (ColumnDifference& d : result.columns) measure(first, second, samples, d);
  result.sampling = words_of_sampling(first, second, samples, result);
  return result;
}

std::array<std::string, 2> short_names(const History& first, const History& second) {
  std::array<std::filesystem::path, 2> rest = {first.file.lexically_normal(),
                                               second.file.lexically_normal()};
  if (rest[0].filename() == rest[1].filename())
    for (std::filesystem::path& path : rest) path = path.parent_path();
  std::array<std::filesystem::path, 2> names = {rest[0].filename(), rest[1].filename()};
  while (names[0] == names[1] && rest[0].has_relative_path() && rest[1].has_relative_path() &&
         rest[0] != rest[1]) {
    for (std::size_t i = 0; i < 2; ++i) {
      rest[i] = rest[i].parent_path();
      names[i] = rest[i].filename() / names[i];
    }
  }
  std::array<std::string, 2> result = {names[0].string(), names[1].string()};
  if (result[0].empty()) result[0] = "first";
  if (result[1].empty() || result[1] == result[0]) result[1] = "second";
  return result;
}

std::string to_text(const Comparison& comparison, const History& first, const History& second) {
  const std::array<std::string, 2> called = short_names(first, second);
  std::string text =
      fmt::format("{} - {}, {}\n", called[1], called[0], comparison.sampling) +
      fmt::format(
          "rms and largest magnitude of each difference, relative to the largest magnitude of any\n"
          "component of the quantity in all of {}\n",
          called[0]);
  std::size_t width = 6;
  for (const ColumnDifference& d : comparison.columns) {
    const std::string name = d.unit.empty() ? d.name : d.name + " [" + d.unit + "]";
    width = std::max(width, name.size());
  }
  const std::string x = first.columns[0].name;
  const std::size_t at = std::max<std::size_t>(8, x.size());
  const auto row = [&](std::string_view name, std::string_view rms, std::string_view most,
                       std::string_view largest, std::string_view place, std::string_view scale) {
    text += fmt::format("{:<{}}  {:>8}  {:>8}  {:>8}  {:>{}}  {:>8}\n", name, width, rms, most,
                        largest, place, at, scale);
  };
  row("", "rel. rms", "rel.", "largest", "at", "relative");
  row("column", "", "largest", "", x, "to");
  const auto relative = [](const std::optional<double>& value) {
    return value ? fmt::format("{:.2e}", *value) : "-";
  };
  bool zero = false;
  for (const ColumnDifference& d : comparison.columns) {
    const std::string name = d.unit.empty() ? d.name : d.name + " [" + d.unit + "]";
    row(name, relative(d.relative_rms()), relative(d.relative_largest()),
        fmt::format("{:.2e}", d.largest), fmt::format("{:.6g}", d.at),
        fmt::format("{:.2e}", d.scale));
    zero = zero || !d.relative_rms();
  }
  if (zero)
    text += fmt::format("-: the quantity is zero in {}, so there is no relative difference\n",
                        called[0]);
  for (const auto& [names, who] : {std::pair(&comparison.only_first, &called[0]),
                                   std::pair(&comparison.only_second, &called[1])})
    for (const std::string& name : *names) text += fmt::format("only in {}: {}\n", *who, name);
  return text;
}

std::string overlay_svg(const Comparison& comparison, const History& first, const History& second) {
  const std::array<std::string, 2> called = short_names(first, second);
  std::vector<std::size_t> chosen;
  for (const ColumnDifference& d : comparison.columns) chosen.push_back(d.in_first);
  plot::QuantityPanels made = plot::quantity_panels(first.columns, chosen, 0);
  const auto add = [](plot::Curve& curve, const History& history, std::size_t column) {
    for (std::size_t row = 0; row < history.rows(); ++row)
      curve.trace.add({history.values[0][row], history.values[column][row]});
  };
  for (const auto& place : made.places) {
    plot::Panel& panel = made.panels[place.panel];
    plot::Curve& curve = panel.curves[place.curve];
    const auto d =
        std::find_if(comparison.columns.begin(), comparison.columns.end(),
                     [&](const ColumnDifference& c) { return c.in_first == place.column; });
    // One entry of the legend for both; the title says which run is which.
    plot::Curve thin{d->name, {}, static_cast<int>(place.curve), false};
    curve = {"", {}, static_cast<int>(place.curve), true};
    add(curve, first, d->in_first);
    add(thin, second, d->in_second);
    panel.curves.push_back(std::move(thin));
  }
  plot::Layout layout;
  layout.title = called[0] + " (broad) and " + called[1] + " (thin)";
  if (made.left_out > 0)
    layout.note =
        fmt::format("{} more quantities are not shown; name the records to compare", made.left_out);
  return plot::to_svg(made.panels, layout);
}

}  // namespace mbd
