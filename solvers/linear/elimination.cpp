#include "solvers/linear/elimination.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <queue>
#include <utility>

namespace mbd {
namespace {

constexpr int most_merged_rows = 6;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// Blocks that share a pivot.
struct Group {
  std::vector<int> members;
  int size = 0;
  int nodes_left = 0;  // of a multiplier on its own: nodes that come before it
};

class MinimumDegree {
 public:
  MinimumDegree(const BlockGraph& graph, PivotOrder order) : graph_(graph) {
    make_groups(order);
    make_neighbours();
  }

  Elimination run() {
    Elimination result;
    const std::size_t count = groups_.size();
    degree_.resize(count);
    done_.assign(count, 0);
    elements_of_.resize(count);
    boundary_.resize(count);
    mark_.assign(count, -1);
    outside_.assign(count, 0);
    outside_mark_.assign(count, -1);
    for (std::size_t g = 0; g < count; ++g) {
      for (const int other : neighbours_[g]) degree_[g] += groups_[at(other)].size;
      if (groups_[g].nodes_left == 0) queue_.push({degree_[g], static_cast<int>(g)});
    }
    std::vector<int> order(count, -1);
    int next = 0;
    while (!queue_.empty()) {
      const auto [degree, g] = queue_.top();
      queue_.pop();
      if (done_[at(g)] != 0 || degree != degree_[at(g)]) continue;
      order[at(g)] = next++;
      sequence_.push_back(g);
      eliminate(g);
    }
    // In the order of elimination.
    result.pivot_of.resize(graph_.blocks.size());
    result.place_of.resize(graph_.blocks.size());
    result.begin.assign(1, 0);
    for (const int g : sequence_) {
      const Group& group = groups_[at(g)];
      const int p = static_cast<int>(result.pivots.size());
      Elimination::Pivot pivot{.first_member = static_cast<int>(result.members.size()),
                               .members = static_cast<int>(group.members.size()),
                               .size = group.size,
                               .merged = group.members.size() > 1};
      int place = 0;
      for (const int block : group.members) {
        result.members.push_back(block);
        result.pivot_of[at(block)] = p;
        result.place_of[at(block)] = place;
        place += graph_.blocks[at(block)].size;
      }
      result.pivots.push_back(pivot);
      auto& below = boundary_[at(g)];
      for (int& other : below) other = order[at(other)];
      std::sort(below.begin(), below.end());
      result.below.insert(result.below.end(), below.begin(), below.end());
      result.begin.push_back(result.below.size());
      double rows = 0.0;
      const double n = group.size;
      for (const int other : below) rows += groups_[at(sequence_[at(other)])].size;
      result.flops += 2.0 / 3.0 * n * n * n + 2.0 * n * n * rows + 2.0 * n * rows * rows;
      below = {};
    }
    return result;
  }

 private:
  void make_groups(PivotOrder order) {
    const int blocks = static_cast<int>(graph_.blocks.size());
    const auto is_node = [this](int b) {
      return graph_.blocks[at(b)].kind == BlockGraph::Kind::node;
    };
    group_of_.assign(at(blocks), -1);
    std::vector<std::vector<int>> nodes_of(at(blocks));  // by multiplier
    for (const auto& [row, column] : graph_.contributions)
      if (row >= 0 && column >= 0 && !is_node(row) && is_node(column))
        nodes_of[at(row)].push_back(column);
      else if (row >= 0 && column >= 0 && is_node(row) && !is_node(column))
        nodes_of[at(column)].push_back(row);
    const auto add_group = [this](int b) {
      group_of_[at(b)] = static_cast<int>(groups_.size());
      groups_.push_back({{b}, graph_.blocks[at(b)].size, 0});
    };
    for (int b = 0; b < blocks; ++b)
      if (is_node(b)) add_group(b);
    std::vector<int> merged(groups_.size(), 0);  // rows of multipliers
    // Those on one node have no choice; then the others, each with the node that has taken least.
    for (const bool single : {true, false})
      for (int b = 0; b < blocks; ++b) {
        if (is_node(b)) continue;
        auto& nodes = nodes_of[at(b)];
        if (single) {
          std::sort(nodes.begin(), nodes.end());
          nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
        }
        if ((nodes.size() <= 1) != single) continue;
        const int size = graph_.blocks[at(b)].size;
        int best = -1;
        if (order == PivotOrder::merged)
          for (const int node : nodes) {
            const int g = group_of_[at(node)];
            if (merged[at(g)] + size > most_merged_rows) continue;
            if (best < 0 || merged[at(g)] < merged[at(best)]) best = g;
          }
        if (best < 0) continue;
        merged[at(best)] += size;
        group_of_[at(b)] = best;
        groups_[at(best)].members.push_back(b);
        groups_[at(best)].size += size;
      }
    for (int b = 0; b < blocks; ++b)
      if (group_of_[at(b)] < 0) {
        add_group(b);
        groups_.back().nodes_left = static_cast<int>(nodes_of[at(b)].size());
      }
    // Whom to tell that a node is gone.
    waiting_.resize(groups_.size());
    for (int b = 0; b < blocks; ++b)
      if (!is_node(b) && groups_[at(group_of_[at(b)])].members.front() == b)
        for (const int node : nodes_of[at(b)])
          waiting_[at(group_of_[at(node)])].push_back(group_of_[at(b)]);
  }

  void make_neighbours() {
    neighbours_.resize(groups_.size());
    for (const auto& [row, column] : graph_.contributions) {
      if (row < 0 || column < 0) continue;
      const int i = group_of_[at(row)], j = group_of_[at(column)];
      if (i == j) continue;
      neighbours_[at(i)].push_back(j);
      neighbours_[at(j)].push_back(i);
    }
    for (auto& list : neighbours_) {
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
    }
  }

  int size(int g) const { return groups_[at(g)].size; }

  // What g is coupled with becomes an element, which takes the place of those that g was in.
  void eliminate(int g) {
    done_[at(g)] = 1;
    auto& boundary = boundary_[at(g)];
    const auto take = [&](const std::vector<int>& list) {
      for (const int i : list)
        if (done_[at(i)] == 0 && mark_[at(i)] != g) {
          mark_[at(i)] = g;
          boundary.push_back(i);
        }
    };
    take(neighbours_[at(g)]);
    for (const int e : elements_of_[at(g)]) {
      take(boundary_[at(e)]);
      absorbed_.push_back(e);
    }
    for (const int e : absorbed_) gone(e);
    absorbed_.clear();
    neighbours_[at(g)] = {};
    elements_of_[at(g)] = {};
    int whole = 0;
    for (const int i : boundary) whole += size(i);
    // Of the other elements, what lies outside this one.
    for (const int i : boundary)
      for (const int e : elements_of_[at(i)]) {
        if (is_gone(e)) continue;
        if (outside_mark_[at(e)] != g) {
          outside_mark_[at(e)] = g;
          outside_[at(e)] = 0;
          for (const int k : boundary_[at(e)])
            if (done_[at(k)] == 0) outside_[at(e)] += size(k);
        }
        outside_[at(e)] -= size(i);
      }
    for (const int i : boundary) {
      auto& elements = elements_of_[at(i)];
      auto& list = neighbours_[at(i)];
      // Those within this element say nothing that it does not.
      std::erase_if(elements, [&](int e) { return is_gone(e) || outside_[at(e)] == 0; });
      std::erase_if(list, [&](int k) { return done_[at(k)] != 0 || mark_[at(k)] == g; });
      int degree = whole - size(i);
      for (const int k : list) degree += size(k);
      for (const int e : elements) degree += outside_[at(e)];
      elements.push_back(g);
      degree_[at(i)] = degree;
    }
    for (const int m : waiting_[at(g)]) --groups_[at(m)].nodes_left;
    for (const int i : boundary)
      if (groups_[at(i)].nodes_left == 0) queue_.push({degree_[at(i)], i});
  }

  // The lists of elements that are absorbed are what the factors need: they stay.
  void gone(int e) { done_[at(e)] = 2; }
  bool is_gone(int e) const { return done_[at(e)] == 2; }

  const BlockGraph& graph_;
  std::vector<Group> groups_;
  std::vector<int> group_of_;              // by block
  std::vector<std::vector<int>> waiting_;  // by group: multipliers after it
  std::vector<std::vector<int>> neighbours_, elements_of_, boundary_;
  std::vector<int> degree_, mark_, outside_, outside_mark_, sequence_, absorbed_;
  std::vector<char> done_;  // 1: eliminated, 2: and absorbed by another
  using Entry = std::pair<int, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

Elimination eliminate(const BlockGraph& graph, PivotOrder order) {
  return MinimumDegree(graph, order).run();
}

}  // namespace mbd
