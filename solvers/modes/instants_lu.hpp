// LU of equations at instants that are coupled through time within nodes, and through space within instants: blocks are those
// of a graph of one instant (elimination.hpp), each times the instants. So they are dense, some 6 N by 6 N for N instants, and
// all is done by products of dense matrices:
//   D_p = P_p^T L_pp U_pp,  L_ip = D_ip U_pp^-1,  U_pi = L_pp^-1 P_p D_pi,  D_ij -= L_ip U_pj
// with D what elimination has left. Rows are exchanged within a pivot only; whether that was enough is for the caller to
// judge, by a residual.
#pragma once

#include <Eigen/LU>
#include <complex>
#include <vector>

#include "libmbd/core/linear_solver.hpp"
#include "solvers/linear/elimination.hpp"

namespace mbd {

template <class T>
class InstantsLu {
 public:
  using Dense = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

  // Of one instant the graph.
  InstantsLu(const BlockGraph& graph, Index instants);

  void set_zero();
  // Adds factor * value to the entry of row `row` at instant i and column `column` at instant j, unknowns of one instant.
  // They are coupled in the graph.
  void add(Index i, Index row, Index j, Index column, T value) {
    const Unknown& r = unknowns_[static_cast<std::size_t>(row)];
    const Unknown& c = unknowns_[static_cast<std::size_t>(column)];
    block(r.pivot, c.pivot)(i * r.size + r.place, j * c.size + c.place) += value;
  }
  // False if a number is not finite.
  bool factor();
  // Rows: the unknowns of the first instant, those of the second, ….
  Dense solve(const Dense& b) const;

 private:
  struct Unknown {
    std::size_t pivot;
    Index place, size;  // within the pivot; of it
  };
  struct Pivot {
    Index size;   // times instants
    Index first;  // its first row, by pivots
    Dense diagonal;
    Eigen::PartialPivLU<Dense> lu;
    std::vector<std::size_t> below;  // pivots
    std::vector<Dense> L, U;         // by `below`
  };
  Dense& block(std::size_t p, std::size_t q);
  // Rows of all instants as they come, or (`back`) the other way round, to those by pivots.
  void reorder(const Dense& from, Dense& to, bool back) const;

  Index instants_;
  std::vector<Unknown> unknowns_;
  std::vector<Pivot> pivots_;
};

extern template class InstantsLu<double>;
extern template class InstantsLu<std::complex<double>>;

}  // namespace mbd
