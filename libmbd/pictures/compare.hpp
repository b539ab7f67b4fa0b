// Two runs against each other: norms of the differences of their columns, and one picture of both.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libmbd/results/history.hpp"

namespace mbd {

// second - first of one column, in its unit.
struct ColumnDifference {
  std::string name, unit;
  std::size_t in_first = 0, in_second = 0;  // columns
  double rms = 0.0;                // over the samples of the comparison, each with weight 1
  double largest = 0.0, at = 0.0;  // magnitude, and the time of it
  // Largest magnitude in all rows of the first, of any component of the quantity: so a component that is
  // round-off beside the others is not compared with itself.
  double scale = 0.0;

  // Relative to `scale`; where that is zero, 0 for equal columns and otherwise nothing.
  std::optional<double> relative_rms() const { return relative(rms); }
  std::optional<double> relative_largest() const { return relative(largest); }
  bool above(double tolerance) const { return !relative_rms() || !(*relative_rms() <= tolerance); }

 private:
  std::optional<double> relative(double value) const {
    if (scale > 0.0) return value / scale;
    return value == 0.0 ? std::optional(0.0) : std::nullopt;
  }
};

struct Comparison {
  std::vector<ColumnDifference> columns;
  std::vector<std::string> only_first, only_second;  // columns
  std::size_t samples = 0, interpolated = 0;         // interpolated: samples where one run had none
  double from = 0.0, to = 0.0;                       // the common interval
  std::string sampling;                              // a sentence: at which times, and how
};

// Compares the columns that `names` choose (see choose_columns) or all, over the first column of both,
// which must have the same name and increase. If the runs have the same sample times (to 1e-9 of the common
// interval), there; otherwise at those of the one with fewer samples in the common interval, the other
// interpolated by the cubic through its four neighbouring samples. Throws Error, saying what to do, for
// histories without common times or columns, columns of different units, and names that neither has.
Comparison compare(const History& first, const History& second,
                   std::span<const std::string> names = {});

// What the two are called in tables and legends: the last parts of their paths in which they differ.
std::array<std::string, 2> short_names(const History& first, const History& second);

// For people: the sampling, what the norms are relative to, and a line for each column.
std::string to_text(const Comparison& comparison, const History& first, const History& second);

// A panel for each quantity: the first run broad and pale, the second thin, dark and dashed on top.
std::string overlay_svg(const Comparison& comparison, const History& first, const History& second);

}  // namespace mbd
