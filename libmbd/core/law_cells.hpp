// Where a law of time changes, found before anything moves: cells that are short where it does and long where it does
// not, so that no feature of it lies inside one.
//
// In a cell of half width r about m, f^(k)(t) = sum over j < 6 of c_j (t - m)^j + R,
//   |R| <= r^6 max over the cell of |f^(k+6)|/6!,                                                    (1)
// with the maximum from interval arithmetic (Expression::enclose): nothing is sampled that could fall beside a pulse.
// Cells are halved, the worst first, until (1), or the change of f^(k) itself, is below 1e-4 of the range of f^(k)
// over the whole time (at least 1e-3 of its size, and 1e-6 of what the derivative below it changes by in that time):
// a sine has about five cells in a period, a bump at least five, down to bumps of a hundredth of the range.
//
// A cell is not made shorter than 1e-9 of the whole time, nor are there more than a given number: what is left then
// is not resolved, and said.
//
// Not used: samples of f at many times, between which a pulse hides; |R| by finite differences, for the same reason.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "libmbd/core/expression.hpp"

namespace mbd {

struct LawCells {
  std::vector<double> ends;          // [s] rising, the begin and the end among them
  std::optional<double> unresolved;  // [s] of a place where the law is not resolved

  long count() const { return static_cast<long>(ends.size()) - 1; }
  // Width of the narrowest cell that lies in part between two times [s].
  double narrowest(double from, double to) const;
};

inline constexpr long most_cells = 200'000;

// Of f, and of its derivatives `more` (1 and 2 can be asked for), from begin to end [s]. Breakpoints are ends of cells.
LawCells find_cells(const Expression& f, std::span<const int> more, double begin, double end,
                    long most = most_cells);

}  // namespace mbd
