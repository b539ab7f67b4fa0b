// Numbers 0, 1, … in sets that are joined pair by pair.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace mbd {

class DisjointSets {
 public:
  explicit DisjointSets(int count = 0) : up_(static_cast<std::size_t>(count)) {
    std::iota(up_.begin(), up_.end(), 0);
  }

  int count() const { return static_cast<int>(up_.size()); }
  int add() {  // one more, in a set of its own
    up_.push_back(count());
    return up_.back();
  }
  // The least number in the set of n.
  int root(int n) {
    while (at(n) != n) n = at(n) = at(at(n));
    return n;
  }
  void join(int a, int b) {
    const int A = root(a), B = root(b);
    at(std::max(A, B)) = std::min(A, B);
  }

 private:
  int& at(int n) { return up_[static_cast<std::size_t>(n)]; }
  std::vector<int> up_;  // by number: itself, or a lesser one of its set
};

}  // namespace mbd
