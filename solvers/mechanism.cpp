#include "solvers/mechanism.hpp"

#include <fmt/format.h>

#include <Eigen/SparseCore>
#include <Eigen/SparseQR>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <string_view>

#include "joints/any_joint_batch.hpp"
#include "joints/joint_list.hpp"
#include "libmbd/core/se3.hpp"

namespace mbd {
namespace {

constexpr double independent = 1e-8;  // least distance of a unit row from the span of others
constexpr double involved = 1e-6;     // least share of a row that is named

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

// Takes the constraint rows out of a linearisation; everything else is thrown away.
class ConstraintRows : public LinearSolver {
 public:
  struct Piece {
    int constraint = 0, node = 0;  // node 1 is the first after the ground
    Eigen::MatrixXd B;
  };

  void analyze(const BlockGraph& graph) override {
    int nodes = 0, largest = 6;
    for (const auto& block : graph.blocks) {
      nodes += block.kind == BlockGraph::Kind::node ? 1 : 0;
      largest = std::max(largest, block.size);
    }
    trash_.setZero(largest, largest);
    const auto is_row = [&](const BlockGraph::Contribution& c) {
      return c.row >= nodes && c.column >= 0 && c.column < nodes;
    };
    pieces_.reserve(static_cast<std::size_t>(
        std::count_if(graph.contributions.begin(), graph.contributions.end(), is_row)));
    for (const auto& c : graph.contributions) {
      if (!is_row(c)) {
        slots_.push_back({trash_.data(), trash_.rows()});
        continue;
      }
      const int rows = graph.blocks[static_cast<std::size_t>(c.row)].size;
      pieces_.push_back({c.row - nodes, c.column + 1, Eigen::MatrixXd::Zero(rows, 6)});
      slots_.push_back({pieces_.back().B.data(), rows});
    }
  }
  std::span<const Slot> slots() const override { return slots_; }
  void set_zero() override {
    for (Piece& piece : pieces_) piece.B.setZero();
  }
  FactorStatus factor() override { return FactorStatus::singular; }
  Index singular_row() const override { return -1; }
  void solve(std::span<double> x) const override { std::fill(x.begin(), x.end(), std::nan("")); }
  double reciprocal_condition() const override { return 0.0; }
  Index nonzeros() const override { return 0; }

  const std::vector<Piece>& pieces() const { return pieces_; }

 private:
  std::vector<Piece> pieces_;
  std::vector<Slot> slots_;
  Eigen::MatrixXd trash_;
};

// Rows that earlier ones imply. `order`: of the rows, those that come first are blamed last.
struct Dependence {
  std::vector<Index> rank_of_first;  // rank of the first n rows, for each n from 0
  std::vector<RedundantRow> redundant;
};

Dependence find_dependent(const Triplets& entries, Index columns, const std::vector<Index>& order) {
  const auto rows = static_cast<Index>(order.size());
  Dependence result;
  result.rank_of_first.assign(order.size() + 1, 0);
  if (rows == 0) return result;

  std::vector<Index> place(order.size());
  for (Index i = 0; i < rows; ++i)
    place[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])] = i;
  VecX size = VecX::Zero(rows);
  for (const auto& e : entries) {
    const Index i = place[static_cast<std::size_t>(e.row())];
    size(i) = std::hypot(size(i), e.value());
  }
  // B^T with unit columns; an empty column stays empty and is dependent.
  Triplets scaled;
  scaled.reserve(entries.size());
  for (const auto& e : entries) {
    const Index i = place[static_cast<std::size_t>(e.row())];
    if (size(i) > 0.0) scaled.emplace_back(e.col(), static_cast<int>(i), e.value() / size(i));
  }
  Sparse Bt(std::max(columns, rows), rows);  // SparseQR wants no more columns than rows
  Bt.setFromTriplets(scaled.begin(), scaled.end());
  Bt.makeCompressed();

  // Columns in their order: a column is set aside when those before it span it.
  Eigen::SparseQR<Sparse, Eigen::NaturalOrdering<int>> qr;
  qr.setPivotThreshold(independent);
  qr.compute(Bt);
  const Index rank = qr.rank();
  const auto& permutation = qr.colsPermutation().indices();  // position -> column
  std::vector<char> is_independent(order.size(), 0);
  for (Index k = 0; k < rank; ++k) is_independent[static_cast<std::size_t>(permutation(k))] = 1;
  for (std::size_t n = 0; n < order.size(); ++n)
    result.rank_of_first[n + 1] = result.rank_of_first[n] + is_independent[n];

  // Its columns are not sorted; turning it over twice sorts them (so says the manual of Eigen).
  const Eigen::SparseMatrix<double, Eigen::RowMajor> by_rows = qr.matrixR();
  const Sparse R = by_rows;
  const Sparse R11 = R.topLeftCorner(rank, rank);
  for (Index k = rank; k < rows; ++k) {
    VecX share = VecX(R.col(k)).head(rank);
    if (rank > 0) share = VecX(R11.triangularView<Eigen::Upper>().solve(Eigen::VectorXd(share)));
    std::vector<Index> by_size;
    for (Index i = 0; i < rank; ++i)
      if (std::abs(share(i)) > involved) by_size.push_back(i);
    std::sort(by_size.begin(), by_size.end(), [&share](Index a, Index b) {
      return std::abs(share(a)) != std::abs(share(b)) ? std::abs(share(a)) > std::abs(share(b))
                                                      : a < b;
    });
    RedundantRow row;
    row.row = order[static_cast<std::size_t>(permutation(k))];
    for (const Index i : by_size)
      row.repeats.push_back(order[static_cast<std::size_t>(permutation(i))]);
    result.redundant.push_back(std::move(row));
  }
  std::sort(result.redundant.begin(), result.redundant.end(),
            [](const RedundantRow& a, const RedundantRow& b) { return a.row < b.row; });
  return result;
}

// Of which constraints are drives and motions.
std::vector<char> prescribed_constraints(const System& system) {
  std::set<std::string_view> prescribed;
  joint::for_each(joint::Prescribed{}, [&]<class J>() { prescribed.insert(J::name); });
  const auto nodes = static_cast<int>(system.nodes()) - 1;
  std::vector<char> result(system.constraints().size(), 0);
  const auto first = system.first_contributions();
  const auto& contributions = system.graph().contributions;
  for (std::size_t b = 0; b < system.batches().size(); ++b) {
    if (!prescribed.contains(system.batches()[b]->type())) continue;
    const std::size_t end = b + 1 < first.size() ? first[b + 1] : contributions.size();
    for (std::size_t i = first[b]; i < end; ++i)
      if (contributions[i].row >= nodes)
        result[static_cast<std::size_t>(contributions[i].row - nodes)] = 1;
  }
  return result;
}

// Part of each node, -1 for the ground: nodes that elements couple are one.
std::vector<int> rigid_parts(const System& system, Index& count) {
  const auto nodes = static_cast<int>(system.nodes());
  std::vector<int> parent(static_cast<std::size_t>(nodes));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&parent](int n) {
    while (parent[static_cast<std::size_t>(n)] != n) n = parent[static_cast<std::size_t>(n)];
    return n;
  };
  const auto first = system.first_contributions();
  const auto& contributions = system.graph().contributions;
  for (std::size_t b = 0; b < system.batches().size(); ++b) {
    if (dynamic_cast<const joint::AnyJointBatch*>(system.batches()[b].get())) continue;
    const std::size_t end = b + 1 < first.size() ? first[b + 1] : contributions.size();
    for (std::size_t i = first[b]; i < end; ++i) {
      const auto [row, column] = contributions[i];
      if (row < 0 || column < 0) continue;
      const int p = root(row + 1), q = root(column + 1);
      parent[static_cast<std::size_t>(std::max(p, q))] = std::min(p, q);
    }
  }
  std::vector<int> part(static_cast<std::size_t>(nodes), -1);
  count = 0;
  for (int n = 1; n < nodes; ++n) {
    const int r = root(n);
    part[static_cast<std::size_t>(n)] =
        r == n ? static_cast<int>(count++) : part[static_cast<std::size_t>(r)];
  }
  return part;
}

}  // namespace

Mechanism analyze_mechanism(const System& system, const State& state) {
  Mechanism result;
  result.constraints = system.multipliers();

  ConstraintRows rows;
  rows.analyze(system.graph());
  VecX r(system.rows());
  system.linearize(state, {}, r, rows);

  // Lengths: rotations times L.
  const double L = system.length_scale();
  const auto nodes = static_cast<std::size_t>(system.nodes());
  const std::vector<int> part = rigid_parts(system, result.rigid_parts);
  std::vector<int> origin(static_cast<std::size_t>(result.rigid_parts), -1);  // a node of each part
  for (std::size_t n = nodes; n-- > 1;)
    origin[static_cast<std::size_t>(part[n])] = static_cast<int>(n);

  Triplets flexible, rigid;
  for (const ConstraintRows::Piece& piece : rows.pieces()) {
    const ConstraintInfo& info = system.constraints()[static_cast<std::size_t>(piece.constraint)];
    const auto n = static_cast<std::size_t>(piece.node);
    const int p = part[n];
    const Pose<double>& H = state.pose[n];
    const Pose<double>& H_0 =
        state.pose[static_cast<std::size_t>(origin[static_cast<std::size_t>(p)])];
    // The increment of the node when its part moves by dU_0 in its origin's axes: Ad(H^-1 H_0) dU_0.
    const Mat6 along = adjoint(relative(H, H_0)).matrix();
    const Eigen::MatrixXd of_part = piece.B * along;
    for (Index i = 0; i < info.rows; ++i)
      for (int j = 0; j < 6; ++j) {
        const double unit = j < 3 ? 1.0 : 1.0 / L;
        const auto row = static_cast<int>(info.first_row + i);
        if (piece.B(i, j) != 0.0)
          flexible.emplace_back(row, 6 * (piece.node - 1) + j, unit * piece.B(i, j));
        if (of_part(i, j) != 0.0) rigid.emplace_back(row, 6 * p + j, unit * of_part(i, j));
      }
  }

  // Joints first, so that a drive is blamed before the joint it drives.
  const std::vector<char> is_prescribed = prescribed_constraints(system);
  std::vector<Index> order;
  Index of_joints = 0;
  for (const bool prescribed : {false, true}) {
    for (std::size_t c = 0; c < is_prescribed.size(); ++c)
      for (Index i = 0; (is_prescribed[c] != 0) == prescribed && i < system.constraints()[c].rows;
           ++i)
        order.push_back(system.constraints()[c].first_row + i);
    if (!prescribed) of_joints = static_cast<Index>(order.size());
  }
  result.redundant = find_dependent(flexible, 6 * (system.nodes() - 1), order).redundant;
  Dependence as_rigid = find_dependent(rigid, 6 * result.rigid_parts, order);
  const Index joints_rank = as_rigid.rank_of_first[static_cast<std::size_t>(of_joints)];
  result.joint_freedoms = 6 * result.rigid_parts - joints_rank;
  result.prescribed = as_rigid.rank_of_first.back() - joints_rank;
  result.rigid_redundant = std::move(as_rigid.redundant);
  return result;
}

std::string row_in_words(const System& system, Index row) {
  return system.name_of(6 * system.nodes() + row);
}

std::string to_text(const System& system, const RedundantRow& row) {
  constexpr std::size_t most = 3;
  std::string text = row_in_words(system, row.row);
  if (row.repeats.empty()) return text + " holds nothing that moves";
  text += " repeats ";
  for (std::size_t i = 0; i < std::min(most, row.repeats.size()); ++i)
    text += (i == 0 ? "" : ", ") + row_in_words(system, row.repeats[i]);
  if (row.repeats.size() > most) text += fmt::format(" and {} more", row.repeats.size() - most);
  return text;
}

}  // namespace mbd
