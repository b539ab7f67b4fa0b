// Cholesky factors of Hermitian positive definite matrices that are sums over the elements of a plane mesh, with three
// unknowns a node.
//
// Multifrontal (Duff, Reid 1983) on a nested dissection (George 1973): the set of elements is halved along its longer
// side until few are left; a node is eliminated in the smallest set that has all its elements. Fronts are dense, so
// nearly all arithmetic is in products of dense matrices. Not used: Eigen's simplicial factors, which take twenty times
// as long on 1e4 elements; CHOLMOD's supernodal ones, which are GPL.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "libmbd/core/stop.hpp"
#include "libmbd/section/mesh.hpp"

namespace mbd::section {

// What is eliminated where; the same for all matrices of a mesh.
struct Front {
  std::vector<int> own;       // nodes eliminated here
  std::vector<int> border;    // other nodes of these elements and of the children's
  std::vector<int> children;  // fronts before this one
  std::vector<int> elements;  // assembled here
};

// Children stand before their parents. Every node is of some element.
std::vector<Front> dissect(const Mesh& mesh);

template <class Scalar>
class Factors {
 public:
  using MatrixX = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  // The matrix of an element: rows and columns 3 i + c for component c of its node i; the lower half is read.
  using ElementMatrix = std::function<const MatrixX&(int element)>;

  // `fronts` and `mesh` are kept by reference. `definite()` says whether it came to its end.
  Factors(const Mesh& mesh, const std::vector<Front>& fronts, const ElementMatrix& matrix)
      : fronts_(fronts), factors_(fronts.size()) {
    std::vector<MatrixX> updates(fronts.size());
    std::vector<Index> place(mesh.nodes.size(), -1);  // in the front at hand
    for (std::size_t f = 0; f < fronts.size() && definite_; ++f)
      updates[f] = eliminate(mesh, f, matrix, updates, place);
  }
  bool definite() const { return definite_; }

  // b (3 nodes x columns) becomes the solution.
  void solve(MatrixX& b) const {
    MatrixX own, border;
    for (std::size_t f = 0; f < fronts_.size(); ++f) {
      if (fronts_[f].own.empty()) continue;
      gather(b, fronts_[f].own, own);
      factors_[f].own.template triangularView<Eigen::Lower>().solveInPlace(own);
      scatter(own, fronts_[f].own, b, Scalar(0));
      if (fronts_[f].border.empty()) continue;
      border.noalias() = -factors_[f].border * own;
      scatter(border, fronts_[f].border, b, Scalar(1));
    }
    for (std::size_t f = fronts_.size(); f-- > 0;) {
      if (fronts_[f].own.empty()) continue;
      gather(b, fronts_[f].own, own);
      if (!fronts_[f].border.empty()) {
        gather(b, fronts_[f].border, border);
        own.noalias() -= factors_[f].border.adjoint() * border;
      }
      factors_[f].own.template triangularView<Eigen::Lower>().adjoint().solveInPlace(own);
      scatter(own, fronts_[f].own, b, Scalar(0));
    }
  }

 private:
  struct Factor {
    MatrixX own, border;  // L of the nodes eliminated here, and below it
  };

  static void gather(const MatrixX& all, const std::vector<int>& nodes, MatrixX& part) {
    part.resize(3 * static_cast<Index>(nodes.size()), all.cols());
    for (std::size_t i = 0; i < nodes.size(); ++i)
      part.template middleRows<3>(3 * static_cast<Index>(i)) =
          all.template middleRows<3>(3 * nodes[i]);
  }
  static void scatter(const MatrixX& part, const std::vector<int>& nodes, MatrixX& all,
                      Scalar keep) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      auto rows = all.template middleRows<3>(3 * nodes[i]);
      rows = keep * rows + part.template middleRows<3>(3 * static_cast<Index>(i));
    }
  }

  // Adds the lower half of `part`, whose blocks are those of `nodes`.
  static void add(const MatrixX& part, const std::vector<int>& nodes,
                  const std::vector<Index>& place, MatrixX& front) {
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      const auto from = static_cast<Index>(3 * j);
      const Index column = 3 * place[static_cast<std::size_t>(nodes[j])];
      front.template block<3, 3>(column, column) += part.template block<3, 3>(from, from);
      for (std::size_t i = j + 1; i < nodes.size(); ++i) {
        const Index row = 3 * place[static_cast<std::size_t>(nodes[i])];
        const auto block = part.template block<3, 3>(static_cast<Index>(3 * i), from);
        if (row >= column)
          front.template block<3, 3>(row, column) += block;
        else
          front.template block<3, 3>(column, row) += block.adjoint();
      }
    }
  }

  MatrixX eliminate(const Mesh& mesh, std::size_t f, const ElementMatrix& matrix,
                    std::vector<MatrixX>& updates, std::vector<Index>& place) {
    stop::check();
    const Front& front = fronts_[f];
    Index next = 0;
    for (const int node : front.own) place[static_cast<std::size_t>(node)] = next++;
    for (const int node : front.border) place[static_cast<std::size_t>(node)] = next++;
    MatrixX all = MatrixX::Zero(3 * next, 3 * next);
    for (const int e : front.elements)
      add(matrix(e), mesh.elements[static_cast<std::size_t>(e)].nodes, place, all);
    for (const int child : front.children) {
      MatrixX& update = updates[static_cast<std::size_t>(child)];
      add(update, fronts_[static_cast<std::size_t>(child)].border, place, all);
      update.resize(0, 0);
    }
    const auto own = 3 * static_cast<Index>(front.own.size()), border = 3 * next - own;
    Factor& factor = factors_[f];
    if (own == 0) return all;
    factor.own = all.topLeftCorner(own, own);
    Eigen::LLT<Eigen::Ref<MatrixX>> llt(factor.own);
    definite_ = definite_ && llt.info() == Eigen::Success;
    factor.border = all.bottomLeftCorner(border, own);
    if (border == 0) return {};
    factor.own.template triangularView<Eigen::Lower>()
        .adjoint()
        .template solveInPlace<Eigen::OnTheRight>(factor.border);
    MatrixX update = all.bottomRightCorner(border, border);
    update.template selfadjointView<Eigen::Lower>().rankUpdate(factor.border, Scalar(-1));
    return update;
  }

  const std::vector<Front>& fronts_;
  std::vector<Factor> factors_;
  bool definite_ = true;
};

}  // namespace mbd::section
