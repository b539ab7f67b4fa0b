// Nodes by their places, so that parts of a mesh share those on common lines.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "libmbd/section/mesh.hpp"

namespace mbd::section {

class Places {
 public:
  // Points nearer to each other than half of `cell` are one.
  Places(std::vector<Point>& nodes, double cell) : nodes_(nodes), cell_(cell) {}

  int at(const Point& x) {
    const std::array<long, 2> key{index(x(0)), index(x(1))};
    for (long i = -1; i <= 1; ++i)
      for (long j = -1; j <= 1; ++j)
        if (const auto it = known_.find({key[0] + i, key[1] + j}); it != known_.end())
          if ((nodes_[static_cast<std::size_t>(it->second)] - x).norm() < 0.5 * cell_)
            return it->second;
    nodes_.push_back(x);
    return known_[key] = static_cast<int>(nodes_.size()) - 1;
  }

 private:
  long index(double x) const { return std::lround(x / cell_); }
  std::vector<Point>& nodes_;
  double cell_;
  std::map<std::array<long, 2>, int> known_;
};

}  // namespace mbd::section
