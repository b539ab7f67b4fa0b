#include "libmbd/study/sweep/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <string_view>

#include "libmbd/core/error.hpp"
#include "libmbd/language/schema.hpp"
#include "libmbd/language/units.hpp"
#include "libmbd/text/text.hpp"

namespace mbd {
namespace {

constexpr std::string_view how =
    "; write rpm=10:60:1 (from, to, step), d=1,2,5 (a list), with a unit at the end if there is "
    "one: \"rpm=10:60:1 rpm\"";

std::vector<std::string_view> cut_at(std::string_view text, char at) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(at, begin), text.size());
    parts.push_back(trimmed(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return parts;
}

std::optional<double> number_of(std::string_view text) {
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

// As people write numbers: steps of 0.1 have no digits of round-off.
std::string written(double value) { return fmt::format("{:.12g}", value); }

std::string with_unit(const std::string& value, std::string_view unit) {
  return unit.empty() ? value : value + " " + std::string(unit);
}

struct Given {
  std::string name;
  std::string_view values;
};

Given name_of_varied(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string_view name = trimmed(std::string_view(text).substr(0, equals));
  if (equals == std::string::npos || !schema::is_name(name) ||
      trimmed(std::string_view(text).substr(equals + 1)).empty())
    throw Error(fmt::format("--vary {}: is not a parameter and its values{}", excerpt(text), how));
  return {std::string(name), trimmed(std::string_view(text).substr(equals + 1))};
}

// Ends, or ends and a step, and the unit of all.
struct Span {
  std::vector<double> numbers;
  std::string unit;
};
Span span_of(const std::string& text, std::string_view values) {
  Span span;
  std::vector<std::string_view> parts = cut_at(values, ':');
  const NumberAndUnit last = split_unit(parts.back());
  span.unit = last.unit;
  parts.back() = trimmed(last.number);
  for (const std::string_view part : parts) {
    const std::optional<double> value = number_of(part);
    if (!value)
      throw Error(
          fmt::format("--vary {}: \"{}\" is not a number{}", excerpt(text), excerpt(part), how));
    span.numbers.push_back(*value);
  }
  return span;
}

std::vector<std::string> range_of(const std::string& text, std::string_view values) {
  const Span span = span_of(text, values);
  if (span.numbers.size() != 3)
    throw Error(fmt::format("--vary {}: a range has three numbers, from, to and step{}",
                            excerpt(text), how));
  const double from = span.numbers[0], to = span.numbers[1], step = span.numbers[2];
  if (step == 0.0 || (to - from) / step < 0.0)
    throw Error(
        fmt::format("--vary {}: steps of {:g} do not lead from {:g} to {:g}; give a step of "
                    "the other sign, or other than 0",
                    excerpt(text), step, from, to));
  constexpr double meets = 1e-9;
  const double count = std::floor((to - from) / step + meets) + 1.0;
  if (!(count <= static_cast<double>(most_points)))
    throw Error(fmt::format("--vary {}: has more than {} values; take larger steps", excerpt(text),
                            most_points));
  std::vector<std::string> all;
  for (double k = 0.0; k < count; k += 1.0)
    all.push_back(with_unit(written(from + k * step), span.unit));
  return all;
}

std::vector<std::string> list_of(const std::string& text, std::string_view values) {
  std::vector<std::string> all;
  const std::vector<std::string_view> parts = cut_at(values, ',');
  const std::string_view unit = split_unit(parts.back()).unit;
  for (const std::string_view part : parts) {
    if (part.empty()) throw Error(fmt::format("--vary {}: a value is empty{}", excerpt(text), how));
    const bool bare = number_of(part).has_value();
    all.push_back(bare ? with_unit(std::string(part), unit) : std::string(part));
  }
  return all;
}

void check_points(const SweepPlan& plan) {
  std::set<std::string_view> names;
  for (const std::string& name : plan.parameters)
    if (!names.insert(name).second)
      throw Error(fmt::format("parameter {} is varied twice; put its values together", name));
  std::set<std::vector<std::string>> seen;
  for (const std::vector<std::string>& point : plan.points)
    if (!seen.insert(point).second)
      throw Error(
          fmt::format("the point {} is there twice; leave one out", fmt::join(point, ", ")));
}

}  // namespace

std::string SweepPlan::unit(std::size_t parameter) const {
  return points.empty() || !numbers(parameter)
             ? std::string()
             : std::string(split_unit(points.front()[parameter]).unit);
}

std::optional<std::vector<double>> SweepPlan::numbers(std::size_t parameter) const {
  std::vector<double> all;
  std::string unit;
  for (const std::vector<std::string>& point : points) {
    const NumberAndUnit parts = split_unit(point[parameter]);
    const std::optional<double> number = number_of(trimmed(parts.number));
    if (!number || (!all.empty() && parts.unit != unit)) return std::nullopt;
    all.push_back(*number);
    unit = parts.unit;
  }
  return all;
}

SweepPlan grid_plan(std::span<const std::string> vary) {
  if (vary.empty()) throw Error(fmt::format("nothing is varied{}", how));
  SweepPlan plan;
  plan.points = {{}};
  for (const std::string& text : vary) {
    const Given given = name_of_varied(text);
    const std::vector<std::string> values = given.values.find(':') != std::string_view::npos
                                                ? range_of(text, given.values)
                                                : list_of(text, given.values);
    if (plan.points.size() * values.size() > most_points)
      throw Error(fmt::format("there are more than {} points; vary less", most_points));
    plan.parameters.push_back(given.name);
    std::vector<std::vector<std::string>> more;
    for (const std::vector<std::string>& point : plan.points)
      for (const std::string& value : values) {
        more.push_back(point);
        more.back().push_back(value);
      }
    plan.points = std::move(more);
  }
  check_points(plan);
  return plan;
}

SweepPlan latin_plan(std::span<const std::string> vary, std::size_t count, std::uint64_t seed) {
  if (vary.empty()) throw Error(fmt::format("nothing is varied{}", how));
  if (count < 1 || count > most_points)
    throw Error(
        fmt::format("--latin {}: give a number of points from 1 to {}", count, most_points));
  SweepPlan plan;
  plan.points.resize(count);
  std::mt19937_64 random(seed);
  // The same on every machine, as distributions of the standard library are not.
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (const std::string& text : vary) {
    const Given given = name_of_varied(text);
    const Span span = span_of(text, given.values);
    if (span.numbers.size() != 2 || !(span.numbers[0] < span.numbers[1]))
      throw Error(fmt::format(
          "--vary {}: a Latin hypercube needs two ends that rise, as in rpm=10:60", excerpt(text)));
    plan.parameters.push_back(given.name);
    std::vector<std::size_t> part(count);
    std::iota(part.begin(), part.end(), std::size_t{0});
    for (std::size_t k = count; k > 1; --k)
      std::swap(part[k - 1], part[static_cast<std::size_t>(uniform() * static_cast<double>(k))]);
    const double width = (span.numbers[1] - span.numbers[0]) / static_cast<double>(count);
    for (std::size_t k = 0; k < count; ++k)
      plan.points[k].push_back(
          with_unit(written(span.numbers[0] + (static_cast<double>(part[k]) + uniform()) * width),
                    span.unit));
  }
  check_points(plan);
  return plan;
}

SweepPlan file_plan(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file))
    throw Error(file.string() +
                ": cannot be read; give a CSV file whose first line names parameters");
  SweepPlan plan;
  Source source{file.string(), 0};
  for (std::string line; std::getline(stream, line);) {
    ++source.line;
    // What spreadsheets put before UTF-8.
    constexpr std::string_view mark = "\xEF\xBB\xBF";
    if (source.line == 1 && line.starts_with(mark)) line.erase(0, mark.size());
    if (trimmed(line).empty() || trimmed(line).starts_with('#')) continue;
    const std::vector<std::string_view> cells = cut_at(line, ',');
    if (plan.parameters.empty()) {
      for (const std::string_view cell : cells) {
        if (!schema::is_name(cell))
          throw Error(
              source,
              fmt::format("\"{}\" is not the name of a parameter; the first line that is no "
                          "comment must name parameters, as in rpm,mass",
                          excerpt(cell)));
        plan.parameters.emplace_back(cell);
      }
      continue;
    }
    if (cells.size() != plan.parameters.size())
      throw Error(source, fmt::format("this row has {} values, the first line names {} parameters",
                                      cells.size(), plan.parameters.size()));
    std::vector<std::string> point(cells.begin(), cells.end());
    for (const std::string& value : point)
      if (value.empty()) throw Error(source, "a value is empty; give one for each parameter");
    plan.points.push_back(std::move(point));
    if (plan.points.size() > most_points)
      throw Error(source, fmt::format("there are more than {} points", most_points));
  }
  if (plan.points.empty())
    throw Error(file.string() + ": has no points; give a line of names and a row for each point");
  try {
    check_points(plan);
  } catch (const Error& error) {
    throw Error(file.string() + ": " + error.what());
  }
  return plan;
}

SweepPlan list_plan(std::vector<std::string> parameters,
                    std::vector<std::vector<std::string>> points) {
  SweepPlan plan{std::move(parameters), std::move(points)};
  if (plan.parameters.empty()) throw Error("nothing is varied; name a parameter");
  for (const std::string& name : plan.parameters)
    if (!schema::is_name(name))
      throw Error("\"" + excerpt(name) + "\" is not the name of a parameter");
  for (const std::vector<std::string>& point : plan.points) {
    if (point.size() != plan.parameters.size())
      throw Error(fmt::format("a point has {} values for {} parameters", point.size(),
                              plan.parameters.size()));
    for (const std::string& value : point)
      if (trimmed(value).empty()) throw Error("a value is empty; give one for each parameter");
  }
  if (plan.points.empty() || plan.points.size() > most_points)
    throw Error(fmt::format("give 1 to {} points", most_points));
  check_points(plan);
  return plan;
}

}  // namespace mbd
