#include "solvers/linear/elimination.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "solvers/linear/dissection.hpp"

namespace mbd {
namespace {

constexpr int most_merged_rows = 6;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

double pivot_flops(double n, double rows) {
  return 2.0 / 3.0 * n * n * n + 2.0 * n * n * rows + 2.0 * n * rows * rows;
}

// Runs of pivots with nearly the same blocks below, in an order in which each comes right after all that hangs on it.
class Fronts {
 public:
  // `boundary` of each, by name; `size` of each in unknowns.
  Fronts(const std::vector<int>& sequence, const std::vector<std::vector<int>>& boundary,
         std::function<int(int)> size)
      : sequence_(sequence), boundary_(boundary), size_(std::move(size)) {}

  // Those of `width` unknowns or more, and all above them. False, and the sequence as it was: there are none.
  bool find(int width) {
    const std::vector<int> before = sequence_;
    sort();
    merge();
    std::vector<char> taken(runs_.size(), 0);
    bool any = false;
    for (std::size_t r = 0; r < runs_.size(); ++r) {  // what lies above comes later
      if (taken[r] == 0 && runs_[r].width < width) continue;
      taken[r] = 1;
      any = true;
      found_.push_back({runs_[r].first, runs_[r].last});
      double w = runs_[r].width, b = runs_[r].below;
      // sum over its columns of 2 (rows below)^2, nearly
      flops_ += 2.0 * (w * w * w / 3.0 + w * w * b + w * b * b);
      const int parent = parent_[at(runs_[r].last - 1)];
      if (parent >= 0) taken[at(run_of_[at(parent)])] = 1;
    }
    if (!any) sequence_ = before;
    return any;
  }
  const std::vector<int>& sequence() const { return sequence_; }
  const std::vector<Elimination::Front>& found() const { return found_; }
  double flops() const { return flops_; }

 private:
  struct Run {
    int first, last;   // pivots
    int width, below;  // unknowns
    double zeros;      // numbers that would not be there without the merging
  };

  // Each after all that hangs on it, the largest of these last: it may go on in the same front.
  void sort() {
    const std::size_t count = sequence_.size();
    std::vector<int> place(boundary_.size(), -1);
    for (std::size_t k = 0; k < count; ++k) place[at(sequence_[k])] = static_cast<int>(k);
    std::vector<int> parent(count, -1), rows(count, 0), head(count + 1, -1), next(count, -1);
    for (std::size_t k = 0; k < count; ++k)
      for (const int g : boundary_[at(sequence_[k])]) {
        const int p = place[at(g)];
        if (parent[k] < 0 || p < parent[k]) parent[k] = p;
        rows[k] += size_(g);
      }
    // Lists of children by falling rows: the last inserted comes first, and is visited last.
    std::vector<int> by_rows(count);
    for (std::size_t k = 0; k < count; ++k) by_rows[k] = static_cast<int>(k);
    std::stable_sort(by_rows.begin(), by_rows.end(),
                     [&](int a, int b) { return rows[at(a)] > rows[at(b)]; });
    for (const int k : by_rows) {
      const std::size_t up = parent[at(k)] < 0 ? count : at(parent[at(k)]);
      next[at(k)] = head[up];
      head[up] = k;
    }
    // Depth first; a node is named when its children are.
    std::vector<int> order, stack;
    order.reserve(count);
    for (int root = head[count]; root >= 0; root = next[at(root)]) {
      stack.push_back(root);
      while (!stack.empty()) {
        const int k = stack.back();
        const int child = head[at(k)];
        if (child >= 0) {
          head[at(k)] = next[at(child)];
          stack.push_back(child);
          continue;
        }
        order.push_back(k);
        stack.pop_back();
      }
    }
    std::vector<int> now(count), sorted(count);
    for (std::size_t k = 0; k < count; ++k) now[at(order[k])] = static_cast<int>(k);
    parent_.assign(count, -1);
    rows_.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
      const int old = order[k];
      sorted[k] = sequence_[at(old)];
      rows_[k] = rows[at(old)];
      if (parent[at(old)] >= 0) parent_[k] = now[at(parent[at(old)])];
    }
    sequence_ = std::move(sorted);
  }

  // A run and the pivot right above it become one, as long as few numbers are zeros.
  void merge() {
    const auto may = [](double width, double zeros, double numbers) {
      return zeros <= (width <= 48.0 ? 0.25 : width <= 144.0 ? 0.12 : 0.05) * numbers;
    };
    for (int p = 0; p < static_cast<int>(sequence_.size()); ++p) {
      Run run{p, p + 1, size_(sequence_[at(p)]), rows_[at(p)], 0.0};
      while (!runs_.empty()) {
        const Run& before = runs_.back();
        const int parent = parent_[at(before.last - 1)];
        if (parent < run.first || parent >= run.last) break;
        const double width = before.width + run.width;
        const double zeros =
            before.zeros + run.zeros +
            static_cast<double>(before.width) * (run.width + run.below - before.below);
        if (!may(width, zeros, width * (0.5 * width + run.below))) break;
        run.first = before.first;
        run.width += before.width;
        run.zeros = zeros;
        runs_.pop_back();
      }
      runs_.push_back(run);
    }
    run_of_.resize(sequence_.size());
    for (std::size_t r = 0; r < runs_.size(); ++r)
      for (int p = runs_[r].first; p < runs_[r].last; ++p) run_of_[at(p)] = static_cast<int>(r);
  }

  std::vector<int> sequence_;
  const std::vector<std::vector<int>>& boundary_;
  std::function<int(int)> size_;
  std::vector<int> parent_, rows_, run_of_;  // by pivot
  std::vector<Run> runs_;
  std::vector<Elimination::Front> found_;
  double flops_ = 0.0;
};

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
  }

  // While nothing that is eliminated is coupled with more than `most` unknowns.
  void run(int most = std::numeric_limits<int>::max()) {
    while (!queue_.empty()) {
      const auto [degree, g] = queue_.top();
      if (degree > most) return;
      queue_.pop();
      if (done_[at(g)] == 0 && degree == degree_[at(g)]) take(g);
    }
  }

  // All that is left, in this order but for multipliers, which wait for their nodes.
  void follow(const std::vector<int>& order) {
    std::vector<char> held(groups_.size(), 0);
    for (const int g : order) {
      if (groups_[at(g)].nodes_left > 0) {
        held[at(g)] = 1;
        continue;
      }
      take(g);
      for (const int m : waiting_[at(g)])
        if (held[at(m)] != 0 && groups_[at(m)].nodes_left == 0) take(m);
    }
  }

  // What is left, and how it is coupled by now.
  QuotientGraph rest() const {
    QuotientGraph rest;
    std::vector<int> number(groups_.size(), -1), mark(groups_.size(), -1);
    for (std::size_t g = 0; g < groups_.size(); ++g)
      if (done_[g] == 0) {
        number[g] = static_cast<int>(rest.names.size());
        rest.names.push_back(static_cast<int>(g));
        rest.weights.push_back(groups_[g].size);
      }
    rest.begin.push_back(0);
    for (const int g : rest.names) {
      mark[at(g)] = g;
      const auto add = [&](const std::vector<int>& list) {
        for (const int i : list)
          if (done_[at(i)] == 0 && mark[at(i)] != g) {
            mark[at(i)] = g;
            rest.neighbours.push_back(number[at(i)]);
          }
      };
      add(neighbours_[at(g)]);
      for (const int e : elements_of_[at(g)])
        if (!is_gone(e)) add(boundary_[at(e)]);
      rest.begin.push_back(static_cast<int>(rest.neighbours.size()));
    }
    return rest;
  }

  double flops() const { return flops_; }

  Elimination result(const EliminationChoices& choices) {
    Elimination result;
    result.flops = flops_;
    Fronts fronts(sequence_, boundary_, [this](int g) { return size(g); });
    if (flops_ >= choices.front_flops && fronts.find(choices.front_width))
      sequence_ = fronts.sequence();
    // In the order of elimination.
    std::vector<int> order(groups_.size(), -1);
    for (std::size_t k = 0; k < sequence_.size(); ++k)
      order[at(sequence_[k])] = static_cast<int>(k);
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
    }
    result.fronts = fronts.found();
    std::size_t f = 0;
    for (int p = 0; p < static_cast<int>(sequence_.size()); ++p) {
      while (f < result.fronts.size() && result.fronts[f].last <= p) ++f;
      int last = p;
      if (f < result.fronts.size() && result.fronts[f].first <= p) last = result.fronts[f].last - 1;
      for (int k = p + 1; k <= last; ++k) result.below.push_back(k);
      const auto& below = boundary_[at(sequence_[at(last)])];
      result.below.insert(result.below.end(), below.begin(), below.end());
      result.begin.push_back(result.below.size());
    }
    result.front_flops = fronts.flops();
    boundary_.clear();
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

  void take(int g) {
    sequence_.push_back(g);
    eliminate(g);
    double rows = 0.0;
    for (const int other : boundary_[at(g)]) rows += size(other);
    flops_ += pivot_flops(size(g), rows);
  }

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
  double flops_ = 0.0;
  std::vector<char> done_;  // 1: eliminated, 2: and absorbed by another
  using Entry = std::pair<int, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

Elimination eliminate(const BlockGraph& graph, PivotOrder order,
                      const EliminationChoices& choices) {
  MinimumDegree by_degree(graph, order);
  by_degree.run();
  if (by_degree.flops() < choices.dissection_flops) return by_degree.result(choices);
  constexpr int inside =
      12;  // unknowns: of two nodes, as what lies inside beams and chains is coupled with
  MinimumDegree dissected(graph, order);
  dissected.run(inside);
  const std::vector<int> sequence = dissect(dissected.rest());
  dissected.follow(sequence);
  if (sequence.empty() || dissected.flops() >= by_degree.flops()) return by_degree.result(choices);
  Elimination result = dissected.result(choices);
  result.dissected = true;
  return result;
}

}  // namespace mbd
