// Whether lines cross: of contours, and of the surfaces of walls.
#pragma once

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "libmbd/section/mesh.hpp"

namespace mbd::section {

inline double cross(const Point& a, const Point& b) { return a(0) * b(1) - a(1) * b(0); }

struct Chord {
  Point from, to;
  int of = 0;  // what it is a part of
};

// The first two that cross or touch, by their places in the list, of those that are not neighbours (asked for a < b).
std::optional<std::pair<std::size_t, std::size_t>> first_crossing(
    const std::vector<Chord>& chords,
    const std::function<bool(std::size_t a, std::size_t b)>& neighbours);

}  // namespace mbd::section
