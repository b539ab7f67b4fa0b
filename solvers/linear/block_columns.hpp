// Compressed columns over a graph of blocks. All columns of a block column have the same row pattern, so a block lies in
// them as a dense block with the column's height as leading dimension: contributions are added in place.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "libmbd/core/linear_solver.hpp"
#include "libmbd/core/system.hpp"

namespace mbd {

class BlockColumns {
 public:
  void analyze(const BlockGraph& graph);

  // Values, zero, and the places of the contributions in them; `trash` takes what is added to the ground. Behind the
  // values there is room to read on by one register.
  void allocate(std::vector<double>& values, std::vector<double>& trash,
                std::vector<Slot>& slots) const;
  static constexpr std::size_t read_beyond = 8;

  // A block that is there: its row, and the place of its first entry in the values.
  struct Entry {
    int row;
    Index offset;
  };
  int blocks() const { return static_cast<int>(first.size()) - 1; }
  int size(int block) const {
    return first[static_cast<std::size_t>(block) + 1] - first[static_cast<std::size_t>(block)];
  }
  // Of a block column: its entries by rising row are entries[begin[c]] to entries[begin[c + 1]], the leading dimension is
  // height[c].
  std::vector<std::size_t> begin;
  std::vector<Entry> entries;
  std::vector<Index> height;
  std::vector<int> first;   // unknown of each block, and their number
  std::vector<char> kinds;  // of blocks: 1 of a node
  int n = 0;
  Index nonzeros = 0;

  // The same by scalars: made when it is first asked for.
  struct Scalars {
    std::vector<int> Ap, Ai;
    std::vector<char> between_nodes;  // by nonzero: in a block of two nodes
  };
  Scalars scalars() const;

 private:
  struct Place {
    Index offset;  // -1: the ground
    Index ld;
  };
  std::vector<Place> places_;
  int largest_ = 1;
};

// The three matrices of a pencil (pencil_solver.hpp) over the same columns.
class PencilBlocks {
 public:
  void analyze(const BlockGraph& graph);
  std::span<const Slot> slots(int power) const { return slots_[static_cast<std::size_t>(power)]; }
  void set_zero();
  // y += P_power x.
  void multiply(int power, std::span<const double> x, std::span<double> y) const;

  BlockColumns columns;
  std::array<std::vector<double>, 3> P;

 private:
  std::array<std::vector<double>, 3> trash_;
  std::array<std::vector<Slot>, 3> slots_;
};

// largest_stiffness (solvers/newton/increments.hpp) of the tangent at a state, that of statics without weights.
double largest_stiffness(const System& system, const State& state,
                         const TangentWeights& weights = {});

}  // namespace mbd
