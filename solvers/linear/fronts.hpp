// Fronts of block LU: pivots that follow one another and have the same blocks below, as dense matrices. A front of w
// unknowns over b others has L (w + b by w) and U^T (as large), by columns; diagonal blocks of pivots are those of
// block_lu.hpp. Rows come in the order of its members: its own pivots, then those below.
//
// What it takes from fronts above, L_ij U_jk, is two products for each of them, scattered there when it has been factored;
// what pivots outside fronts take from it is subtracted block by block when its turn comes.
#pragma once

#include <cstddef>
#include <vector>

#include "libmbd/core/types.hpp"
#include "solvers/linear/elimination.hpp"

namespace mbd {

// What does not depend on values.
struct FrontPlan {
  struct Front {
    int first, last;  // pivots
    Index width, rows,
        ld;  // unknowns: of its own; and below; rows of its matrices, which have zeros at the end
    std::size_t numbers;  // of its first number in L, in U^T
    std::size_t first_member, last_member, own_members;
    std::size_t first_target;
    std::size_t first_group, last_group;
  };
  struct Member {
    int pivot;
    Index row;  // its first, in the front
    int size;
  };
  // Rows begin to end - 1 of a front are columns of another, `front`, and all rows from `begin` on are rows of that.
  struct Group {
    std::size_t front;
    Index begin, end;
    std::size_t first_run, last_run;
  };
  struct Run {
    Index from, to, count;  // rows
  };
  std::vector<Front> all;
  std::vector<Member> members;
  std::vector<Group> groups;
  std::vector<Run> runs;
  std::size_t targets = 0;         // blocks
  std::size_t numbers = 0;         // of L, of U^T
  std::size_t update_numbers = 0;  // of the largest product
  Index largest = 0;               // ld
  Index widest_product = 0, deepest_product = 0;

  FrontPlan() = default;
  // Targets are numbered from `first_target` on.
  FrontPlan(const Elimination& elimination, std::size_t first_target);

  // The block of the pivots `row` and `column` in front f, row >= column.
  std::size_t target(int f, int row, int column) const;
  bool begins(std::size_t f, std::size_t pivot) const {
    return f < all.size() && static_cast<std::size_t>(all[f].first) == pivot;
  }
  // Whether it is the last of the front before f.
  bool ends(std::size_t f, std::size_t pivot) const {
    return f > 0 && static_cast<std::size_t>(all[f - 1].last) == pivot + 1;
  }

 private:
  std::size_t place(const Front& front, int pivot) const;
  void add_groups(const Elimination& elimination);
};

}  // namespace mbd
