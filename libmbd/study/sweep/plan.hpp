// Which values a sweep gives to parameters of a model: a grid, a Latin hypercube, or the rows of a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mbd {

// A point is a value for each parameter, as text: "30", "30 rpm".
struct SweepPlan {
  std::vector<std::string> parameters;
  std::vector<std::vector<std::string>> points;  // by parameter; none twice

  // The unit that every value of a parameter ends with, "" if one has none or another, or is no number.
  std::string unit(std::size_t parameter) const;

  // Values as numbers, in the unit that all have; nothing if one is no number, or has another unit.
  std::optional<std::vector<double>> numbers(std::size_t parameter) const;
};

inline constexpr std::size_t most_points = 1'000'000;

// All combinations of "rpm=10:60:1" (from, to, step; to belongs to it if steps meet it to 1e-9 of one), "d=1,2,5" (a list)
// or "d=2"; of the last the values vary fastest. A unit after the last number is that of all: "rpm=10:60:1 rpm". Throws
// Error for anything else, for a parameter given twice, and for more than most_points.
SweepPlan grid_plan(std::span<const std::string> vary);

// `count` points of the box "rpm=10:60", "d=1:2 mm": each parameter has one value in each of `count` equal parts of its
// range, at random in it; the parts are paired at random. The same seed gives the same points. Throws Error.
SweepPlan latin_plan(std::span<const std::string> vary, std::size_t count, std::uint64_t seed);

// The rows of a CSV file whose first line that is no comment (#) names parameters. Throws Error with file and line.
SweepPlan file_plan(const std::filesystem::path& file);

// Of values given one by one, in the order of `parameters`. Throws Error for points of another size or twice.
SweepPlan list_plan(std::vector<std::string> parameters,
                    std::vector<std::vector<std::string>> points);

}  // namespace mbd
