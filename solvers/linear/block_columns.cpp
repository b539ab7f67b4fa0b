#include "solvers/linear/block_columns.hpp"

#include "solvers/newton/increments.hpp"

#include <algorithm>

namespace mbd {

void BlockColumns::analyze(const BlockGraph& graph) {
  const std::size_t blocks_count = graph.blocks.size();
  first.assign(blocks_count + 1, 0);
  kinds.resize(blocks_count);
  largest_ = 1;
  for (std::size_t b = 0; b < blocks_count; ++b) {
    first[b + 1] = first[b] + graph.blocks[b].size;
    kinds[b] = graph.blocks[b].kind == BlockGraph::Kind::node ? 1 : 0;
    largest_ = std::max(largest_, graph.blocks[b].size);
  }
  n = first.back();

  // Rows of each block column, sorted and once each.
  std::vector<std::size_t> start(blocks_count + 1, 0);
  for (const auto& [row, column] : graph.contributions)
    if (row >= 0 && column >= 0) ++start[static_cast<std::size_t>(column) + 1];
  for (std::size_t c = 0; c < blocks_count; ++c) start[c + 1] += start[c];
  std::vector<int> rows(start.back());
  std::vector<std::size_t> end(start.begin(), start.end() - 1);
  for (const auto& [row, column] : graph.contributions)
    if (row >= 0 && column >= 0) rows[end[static_cast<std::size_t>(column)]++] = row;
  begin.assign(1, 0);
  entries.clear();
  height.assign(blocks_count, 0);
  nonzeros = 0;
  for (std::size_t c = 0; c < blocks_count; ++c) {
    const auto from = rows.begin() + static_cast<std::ptrdiff_t>(start[c]),
               to = rows.begin() + static_cast<std::ptrdiff_t>(start[c + 1]);
    std::sort(from, to);
    const auto last = std::unique(from, to);
    for (auto r = from; r != last; ++r) {
      entries.push_back({*r, nonzeros + height[c]});
      height[c] += size(*r);
    }
    begin.push_back(entries.size());
    nonzeros += height[c] * graph.blocks[c].size;
  }

  places_.clear();
  places_.reserve(graph.contributions.size());
  for (const auto& [row, column] : graph.contributions) {
    if (row < 0 || column < 0) {
      places_.push_back({-1, largest_});
      continue;
    }
    const auto C = static_cast<std::size_t>(column);
    const auto at =
        std::lower_bound(entries.begin() + static_cast<std::ptrdiff_t>(begin[C]),
                         entries.begin() + static_cast<std::ptrdiff_t>(begin[C + 1]), row,
                         [](const Entry& entry, int wanted) { return entry.row < wanted; });
    places_.push_back({at->offset, height[C]});
  }
}

void BlockColumns::allocate(std::vector<double>& values, std::vector<double>& trash,
                            std::vector<Slot>& slots) const {
  values.assign(static_cast<std::size_t>(nonzeros) + read_beyond, 0.0);
  trash.assign(static_cast<std::size_t>(largest_ * largest_), 0.0);
  slots.clear();
  slots.reserve(places_.size());
  for (const Place& place : places_)
    slots.push_back({place.offset < 0 ? trash.data() : values.data() + place.offset, place.ld});
}

BlockColumns::Scalars BlockColumns::scalars() const {
  Scalars result;
  result.Ap.reserve(static_cast<std::size_t>(n) + 1);
  result.Ai.reserve(static_cast<std::size_t>(nonzeros));
  result.between_nodes.reserve(static_cast<std::size_t>(nonzeros));
  result.Ap.push_back(0);
  for (int c = 0; c < blocks(); ++c) {
    const auto C = static_cast<std::size_t>(c);
    for (int k = 0; k < size(c); ++k) {
      for (std::size_t e = begin[C]; e < begin[C + 1]; ++e) {
        const auto R = static_cast<std::size_t>(entries[e].row);
        const bool nodes = kinds[C] != 0 && kinds[R] != 0;
        for (int i = first[R]; i < first[R + 1]; ++i) {
          result.Ai.push_back(i);
          result.between_nodes.push_back(nodes ? 1 : 0);
        }
      }
      result.Ap.push_back(static_cast<int>(result.Ai.size()));
    }
  }
  return result;
}

void PencilBlocks::analyze(const BlockGraph& graph) {
  columns.analyze(graph);
  for (std::size_t power = 0; power < 3; ++power)
    columns.allocate(P[power], trash_[power], slots_[power]);
}

void PencilBlocks::set_zero() {
  for (auto& values : P) std::fill(values.begin(), values.end(), 0.0);
}

void PencilBlocks::multiply(int power, std::span<const double> x, std::span<double> y) const {
  const auto& values = P[static_cast<std::size_t>(power)];
  for (int c = 0; c < columns.blocks(); ++c) {
    const auto C = static_cast<std::size_t>(c);
    for (int j = 0; j < columns.size(c); ++j) {
      const double X = x[static_cast<std::size_t>(columns.first[C] + j)];
      for (std::size_t e = columns.begin[C]; e < columns.begin[C + 1]; ++e) {
        const auto R = static_cast<std::size_t>(columns.entries[e].row);
        const double* const block =
            values.data() + columns.entries[e].offset + j * columns.height[C];
        for (int i = 0; i < columns.size(columns.entries[e].row); ++i)
          y[static_cast<std::size_t>(columns.first[R] + i)] += block[i] * X;
      }
    }
  }
}

double largest_stiffness(const System& system, const State& state, const TangentWeights& weights) {
  BlockColumns columns;
  columns.analyze(system.graph());
  std::vector<double> values, trash;
  std::vector<Slot> slots;
  columns.allocate(values, trash, slots);
  VecX r;
  system.linearize(state, weights, r, slots);
  return largest_stiffness_behind(system, slots);
}

}  // namespace mbd
