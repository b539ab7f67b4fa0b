// The interface between assembly and linear algebra: the System hands over a graph of
// blocks and the list of contributions, asks once for the place of each, and adds dense blocks there.
// What stands behind it (scalar sparse LU, block elimination along the graph) is the solver's business.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libmbd/core/types.hpp"

namespace mbd {

// A square block matrix as a graph. Block -1 is the ground: what is added there is thrown away.
struct BlockGraph {
  enum class Kind : char { node, multiplier };
  struct Block {
    int size = 0;
    Kind kind = Kind::node;
  };
  struct Contribution {
    int row = 0;
    int column = 0;
  };
  std::vector<Block> blocks;                // in the order of the unknowns
  std::vector<Contribution> contributions;  // several may share a place
};

// Where a contribution is added: column-major, `ld` apart.
struct Slot {
  double* data = nullptr;
  Index ld = 0;

  void add(const Mat6& block) const {
    Eigen::Map<Mat6, 0, Eigen::OuterStride<>>(data, Eigen::OuterStride<>(ld)) += block;
  }
};

enum class FactorStatus { ok, poor_pivot, singular };

// What a solver says of itself and of its factorisations since the last analyze().
struct LinearFacts {
  std::string method;       // "block LU, nodes first"
  long factorizations = 0;  // all of them
  long fallbacks = 0;       // of these, done by KLU because blocks have no good pivots
  long refinements = 0;     // of solutions
  std::string reason = {};  // of the last fallback
};

class LinearSolver {
 public:
  virtual ~LinearSolver() = default;

  // Symbolic analysis, once. Slots stay valid until the next call.
  virtual void analyze(const BlockGraph& graph) = 0;

  // One slot for each contribution, in order.
  virtual std::span<const Slot> slots() const = 0;

  virtual void set_zero() = 0;

  // Numerical factorisation of what has been added. On `singular`, singular_row() names the unknown
  // with the worst pivot, or is -1.
  virtual FactorStatus factor() = 0;
  virtual Index singular_row() const = 0;

  // x := S^-1 x. NaN if the last factorisation was not ok: there is none to solve with.
  virtual void solve(std::span<double> x) const = 0;

  // Estimate of 1 / (|S| |S^-1|) of the last factorisation.
  virtual double reciprocal_condition() const = 0;

  // Sign of the determinant of the last factorisation: 1 or -1; 0 if not known.
  virtual int determinant_sign() const { return 0; }

  virtual Index nonzeros() const = 0;

  virtual LinearFacts facts() const { return {}; }

  // A new, empty solver of the same kind; nullptr if there is no other.
  virtual std::unique_ptr<LinearSolver> another() const { return nullptr; }
};

}  // namespace mbd
