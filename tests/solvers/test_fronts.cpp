// Dense fronts of block LU and their products, and orders of elimination of frames, against dense matrices.
//
// Mutations that they were seen to find: no product for U in update_above; rows of a pivot not exchanged in U of a front;
// multipliers that do not wait in follow(); a front whose rows are those below its first pivot; the last columns of
// DenseProduct without their sign.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <complex>
#include <set>
#include <utility>
#include <vector>

#include "solvers/linear/block_columns.hpp"
#include "solvers/linear/block_lu.hpp"
#include "solvers/linear/block_solver.hpp"
#include "solvers/linear/dense_product.hpp"
#include "solvers/linear/dissection.hpp"
#include "solvers/linear/elimination.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/random.hpp"

namespace mbd::test::test_fronts {
namespace {

using Eigen::MatrixXd;
using Kind = BlockGraph::Kind;
using Complex = std::complex<double>;

constexpr double never = 1e300;
constexpr EliminationChoices with_fronts{
    .dissection_flops = never, .front_flops = 0.0, .front_width = 12};
constexpr EliminationChoices without{
    .dissection_flops = never, .front_flops = never, .front_width = 12};

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// Beams of `inside` nodes between the corners of a grid; joints of two and six rows between some neighbours and at one edge.
BlockGraph frame(int a, int b, int c, int inside, bool joints) {
  BlockGraph graph;
  const auto name = [&](int i, int j, int k) { return (i * b + j) * c + k; };
  const auto add_node = [&] {
    graph.blocks.push_back({6, Kind::node});
    return static_cast<int>(graph.blocks.size()) - 1;
  };
  for (int i = 0; i < a * b * c; ++i) add_node();
  const auto beam = [&](int from, int to) {
    std::vector<int> nodes{from};
    for (int i = 0; i < inside; ++i) nodes.push_back(add_node());
    nodes.push_back(to);
    for (const int p : nodes)
      for (const int q : nodes) graph.contributions.push_back({p, q});
  };
  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i < a; ++i)
    for (int j = 0; j < b; ++j)
      for (int k = 0; k < c; ++k) {
        if (i + 1 < a) beam(name(i, j, k), name(i + 1, j, k));
        if (j + 1 < b) beam(name(i, j, k), name(i, j + 1, k));
        if (k + 1 < c) beam(name(i, j, k), name(i, j, k + 1));
        if ((i + j + k) % 3 == 0 && j + 1 < b) pairs.push_back({name(i, j, k), name(i, j + 1, k)});
        if (i == 0 && j % 2 == 0) pairs.push_back({name(i, j, k), -1});
      }
  if (!joints) return graph;
  for (const auto& [first, second] : pairs) {
    const int joint = static_cast<int>(graph.blocks.size());
    graph.blocks.push_back({second < 0 ? 6 : 2, Kind::multiplier});
    for (const int end : {first, second}) {
      graph.contributions.push_back({joint, end});
      graph.contributions.push_back({end, joint});
    }
  }
  return graph;
}

double value_of(Rng& rng, double) { return uniform(rng, -1.0, 1.0); }
Complex value_of(Rng& rng, Complex) { return {uniform(rng, -1.0, 1.0), uniform(rng, -1.0, 1.0)}; }

template <class T>
using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

// Numbers for a graph, in its columns and as a dense matrix; nodes dominate their rows.
template <class T>
struct Filled {
  BlockColumns columns;
  std::vector<T> values;
  Matrix<T> dense;

  Filled(const BlockGraph& graph, Rng& rng, bool symmetric = false, double shift = 1.0) {
    columns.analyze(graph);
    values.assign(static_cast<std::size_t>(columns.nonzeros) + BlockColumns::read_beyond, T(0));
    dense.setZero(columns.n, columns.n);
    visit([&](T&, int i, int j, int, bool) { dense(i, j) = value_of(rng, T()); });
    if (symmetric) dense = (0.5 * (dense + dense.transpose())).eval();
    visit([&](T& x, int i, int j, int height, bool own) {
      if (own && i == j) dense(i, j) += shift * height;
      x = dense(i, j);
    });
  }
  // visit(number, row, column, height of the column, whether in the block of a node itself)
  template <class Visit>
  void visit(const Visit& use) {
    for (int c = 0; c < columns.blocks(); ++c)
      for (std::size_t e = columns.begin[at(c)]; e < columns.begin[at(c) + 1]; ++e) {
        const int r = columns.entries[e].row;
        for (int j = 0; j < columns.size(c); ++j)
          for (int i = 0; i < columns.size(r); ++i)
            use(values[static_cast<std::size_t>(columns.entries[e].offset + i +
                                                j * columns.height[at(c)])],
                columns.first[at(r)] + i, columns.first[at(c)] + j,
                static_cast<int>(columns.height[at(c)]), r == c && columns.kinds[at(c)] != 0);
      }
  }
};

template <class T>
void expect_solutions(PivotOrder order, const EliminationChoices& choices) {
  Rng rng(5);
  const BlockGraph graph = frame(4, 3, 3, 0, true);
  Filled<T> A(graph, rng);
  const Elimination e = eliminate(graph, order, choices);
  ASSERT_GE(e.fronts.size(), 2u);
  const BlockLuPlan plan(A.columns, e);
  BlockLu<T> lu(plan);
  using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;
  const Vector b = Vector::NullaryExpr(A.columns.n, [&] { return value_of(rng, T()); });
  for (int pass = 0; pass < 2; ++pass) {  // nothing is left of the first
    ASSERT_TRUE(lu.factor(A.values.data(), nullptr));
    Vector x = b;
    lu.solve(x.data());
    EXPECT_LT((A.dense * x - b).norm(), 1e-11 * b.norm());
    x = b;
    lu.solve_transposed(x.data());
    EXPECT_LT((A.dense.transpose() * x - b).norm(), 1e-11 * b.norm());
  }
  if constexpr (std::is_same_v<T, double>) {
    EXPECT_EQ(lu.determinant_sign(), dense::determinant_sign(A.dense));
  }
}

TEST(Fronts, SolveWhatDenseMatricesDo) {
  for (const PivotOrder order : {PivotOrder::nodes_first, PivotOrder::merged}) {
    expect_solutions<double>(order, with_fronts);
    expect_solutions<Complex>(order, with_fronts);
  }
}

TEST(Fronts, CountNegativeEigenvalues) {
  Rng rng(6);
  for (const double shift : {-1.0, 0.1, 0.3, 1.0}) {
    const BlockGraph graph = frame(4, 3, 3, 0, true);
    Filled<double> A(graph, rng, true, shift);
    const BlockLuPlan plan(A.columns, eliminate(graph, PivotOrder::merged, with_fronts));
    ASSERT_GE(plan.fronts.all.size(), 2u);
    BlockLu<double> lu(plan);
    PivotInertia inertia;
    ASSERT_TRUE(lu.factor(A.values.data(), nullptr, &inertia));
    EXPECT_EQ(inertia.negative, (dense::eigenvalues(A.dense).array() < 0.0).count()) << shift;
  }
}

// Same numbers as block by block, but for round-off.
TEST(Fronts, AgreeWithBlocks) {
  Rng rng(7);
  const BlockGraph graph = frame(6, 6, 2, 2, false);
  Filled<double> A(graph, rng);
  VecX x[2];
  for (const bool dense : {false, true}) {
    const Elimination e = eliminate(graph, PivotOrder::merged, dense ? with_fronts : without);
    EXPECT_EQ(e.fronts.empty(), !dense);
    const BlockLuPlan plan(A.columns, e);
    BlockLu<double> lu(plan);
    ASSERT_TRUE(lu.factor(A.values.data(), nullptr));
    x[dense] = VecX::Ones(A.columns.n);
    lu.solve(x[dense].data());
  }
  EXPECT_LT((x[0] - x[1]).norm(), 1e-13 * x[0].norm());
}

// What is said to be below each pivot is what an elimination leaves there; fronts are runs of pivots, closed upwards.
void expect_elimination(const BlockGraph& graph, PivotOrder order,
                        const EliminationChoices& choices) {
  const Elimination e = eliminate(graph, order, choices);
  const std::size_t pivots = e.pivots.size();
  std::vector<std::set<int>> coupled(pivots);
  for (const auto& [row, column] : graph.contributions) {
    if (row < 0 || column < 0) continue;
    const int i = e.pivot_of[at(row)], j = e.pivot_of[at(column)];
    if (i != j) coupled[at(std::min(i, j))].insert(std::max(i, j));
    if (order == PivotOrder::nodes_first && graph.blocks[at(row)].kind == Kind::multiplier &&
        graph.blocks[at(column)].kind == Kind::node) {
      EXPECT_GT(i, j);
    }
  }
  std::vector<char> in_front(pivots, 0);
  for (const auto& front : e.fronts)
    for (int p = front.first; p < front.last; ++p) in_front[at(p)] = 1;
  std::size_t members = 0;
  for (std::size_t p = 0; p < pivots; ++p) {
    members += at(e.pivots[p].members);
    const std::set<int> below(e.below.begin() + static_cast<std::ptrdiff_t>(e.begin[p]),
                              e.below.begin() + static_cast<std::ptrdiff_t>(e.begin[p + 1]));
    EXPECT_EQ(below.size(), e.begin[p + 1] - e.begin[p]);
    if (in_front[p] != 0) {
      EXPECT_TRUE(std::includes(below.begin(), below.end(), coupled[p].begin(), coupled[p].end()));
      for (const int above : below) EXPECT_EQ(in_front[at(above)], 1);
    } else {
      EXPECT_EQ(below, coupled[p]);
    }
    if (!below.empty())
      for (auto k = std::next(below.begin()); k != below.end(); ++k)
        coupled[at(*below.begin())].insert(*k);
  }
  EXPECT_EQ(members, graph.blocks.size());
}

TEST(Fronts, EliminationLeavesWhatItSays) {
  const BlockGraph graph = frame(5, 4, 3, 2, true);
  for (const PivotOrder order : {PivotOrder::nodes_first, PivotOrder::merged})
    for (const double dissection : {0.0, never})
      for (const double fronts : {0.0, never})
        expect_elimination(
            graph, order,
            {.dissection_flops = dissection, .front_flops = fronts, .front_width = 24});
}

// Small systems are eliminated block by block in the order of their degrees, as they always were.
TEST(Fronts, NoneInSmallSystems) {
  const Elimination e = eliminate(frame(9, 9, 1, 2, false), PivotOrder::merged);
  EXPECT_TRUE(e.fronts.empty());
  EXPECT_FALSE(e.dissected);
}

// Of large space frames nested dissection saves a third and more: 18 x 18 x 18 nodes.
TEST(Dissection, SavesInLargeSpaceFrames) {
  QuotientGraph two{.names = {7, 9}, .weights = {6, 6}, .begin = {0, 1, 2}, .neighbours = {1, 0}};
  if (dissect(two).empty()) GTEST_SKIP() << "METIS is not installed";
  const BlockGraph graph = frame(18, 18, 18, 0, false);
  const Elimination by_degree = eliminate(graph, PivotOrder::merged, without),
                    dissected = eliminate(graph, PivotOrder::merged);
  EXPECT_TRUE(dissected.dissected);
  EXPECT_FALSE(dissected.fronts.empty());
  EXPECT_LT(dissected.flops, 0.67 * by_degree.flops);
  EXPECT_EQ(eliminate(graph, PivotOrder::merged).members, dissected.members);
}

// A frame large enough for fronts behind the interface, its equations as the judge sees them.
TEST(Fronts, SolveALargeFrame) {
  Rng rng(8);
  const BlockGraph graph = frame(8, 8, 8, 0, false);
  Filled<double> A(graph, rng);
  const std::unique_ptr<LinearSolver> solver = make_block_solver(PivotOrder::merged);
  solver->analyze(graph);
  solver->set_zero();
  std::set<std::pair<int, int>> done;
  for (std::size_t k = 0; k < graph.contributions.size(); ++k) {
    const auto [row, column] = graph.contributions[k];
    if (!done.insert({row, column}).second) continue;
    const Slot slot = solver->slots()[k];
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 6; ++i)
        slot.data[i + j * slot.ld] += A.dense(6 * row + i, 6 * column + j);
  }
  ASSERT_EQ(solver->factor(), FactorStatus::ok);
  const VecX b = VecX::NullaryExpr(A.columns.n, [&] { return uniform(rng, -1.0, 1.0); });
  VecX x = b;
  solver->solve({x.data(), static_cast<std::size_t>(x.size())});
  EXPECT_LT((A.dense * x - b).norm(), 1e-12 * b.norm());
  EXPECT_NE(solver->facts().method.find("fronts"), std::string::npos) << solver->facts().method;
  EXPECT_EQ(solver->facts().fallbacks, 0);
  EXPECT_NE(describe_linear_solver(LinearMethod::block, PivotOrder::merged, graph).find("fronts"),
            std::string::npos);
}

TEST(DenseProduct, IsTheProduct) {
  Rng rng(9);
  DenseProduct product;
  for (const auto& [m, n, k] : std::vector<std::array<Index, 3>>{{1, 1, 1},
                                                                 {5, 3, 0},
                                                                 {12, 4, 7},
                                                                 {13, 5, 128},
                                                                 {24, 16, 129},
                                                                 {31, 17, 300},
                                                                 {70, 48, 48},
                                                                 {8, 33, 2}})
    for (const bool fresh : {false, true})
      for (const double sign : {1.0, -1.0}) {
        const Index ld = m + DenseProduct::row_slack + 3;
        const auto random = [&](Index rows, Index columns) {
          return MatrixXd::NullaryExpr(rows, columns, [&] { return uniform(rng, -1.0, 1.0); })
              .eval();
        };
        MatrixXd A = random(ld, k), B = random(n + 2, k), C = random(ld, n);
        const MatrixXd before = C;
        product.subtract({C.data(), ld}, {A.data(), ld}, {B.data(), n + 2}, m, n, k, fresh, sign);
        const MatrixXd expected = (fresh ? MatrixXd::Zero(m, n).eval() : before.topRows(m).eval()) -
                                  sign * A.topRows(m) * B.topRows(n).transpose();
        EXPECT_LT((C.topRows(m) - expected).norm(), 1e-13 * (1.0 + expected.norm()))
            << m << ' ' << n << ' ' << k;
        // Not more than a register beyond.
        EXPECT_EQ(C.bottomRows(4), before.bottomRows(4));
      }
}

}  // namespace
}  // namespace mbd::test::test_fronts
