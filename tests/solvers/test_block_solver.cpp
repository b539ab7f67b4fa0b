// Block LU on random graphs of nodes and multipliers against dense LU with full pivoting; what it leaves to KLU.
// Tried in it, and killed: exchanges of rows forgotten beside the pivot, or in transposed solutions, or in the sign; factors of
// the other triangle in updates; KLU with the values of before; no row named; a condition in other units; multipliers before
// their nodes; solutions not judged. Not seen: definite blocks without a bound on their growth, which the judgement replaces.
#include "solvers/linear/block_solver.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <map>
#include <vector>

#include "libmbd/compile/model.hpp"
#include "libmbd/language/reader.hpp"
#include "solvers/linear/elimination.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/statics/statics.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/dense_solver.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_block_solver {
namespace {

using Eigen::MatrixXd;
using Kind = BlockGraph::Kind;

std::span<double> span_of(VecX& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

// [M B^T; B 0], slightly unsymmetric, M definite by its diagonal blocks.
struct Saddle {
  BlockGraph graph;
  int nodes = 0;

  explicit Saddle(int count) : nodes(count) {
    for (int i = 0; i < count; ++i) {
      graph.blocks.push_back({6, Kind::node});
      graph.contributions.push_back({i, i});
    }
  }
  void couple(int i, int j) {
    graph.contributions.push_back({i, j});
    graph.contributions.push_back({j, i});
  }
  int constrain(int rows, const std::vector<int>& ends) {
    const int c = static_cast<int>(graph.blocks.size());
    graph.blocks.push_back({rows, Kind::multiplier});
    for (const int end : ends) couple(c, end);
    return c;
  }
  int size() const {
    int n = 0;
    for (const auto& block : graph.blocks) n += block.size;
    return n;
  }
};

// The same numbers, entry by entry, in both solvers. `value(contribution, i, j)`; B^T is that of B.
template <class Value>
void fill(const BlockGraph& graph, LinearSolver& solver, DenseSolver& dense, const Value& value) {
  solver.set_zero();
  dense.set_zero();
  for (std::size_t k = 0; k < graph.contributions.size(); ++k) {
    const auto [row, column] = graph.contributions[k];
    const int rows = row < 0 ? 1 : graph.blocks[static_cast<std::size_t>(row)].size;
    const int columns = column < 0 ? 1 : graph.blocks[static_cast<std::size_t>(column)].size;
    for (int j = 0; j < columns; ++j)
      for (int i = 0; i < rows; ++i) {
        const double x = value(k, i, j);
        const Slot a = solver.slots()[k], b = dense.slots()[k];
        a.data[i + j * a.ld] += x;
        b.data[i + j * b.ld] += x;
      }
  }
}

// `mass` of the diagonals of nodes; constraint rows of the size `gradient`.
void fill_saddle(const Saddle& s, LinearSolver& solver, DenseSolver& dense, Rng& rng,
                 double mass = 20.0, double gradient = 1.0) {
  std::map<std::pair<std::pair<int, int>, std::pair<int, int>>, double> B;
  fill(s.graph, solver, dense, [&](std::size_t k, int i, int j) {
    const auto [row, column] = s.graph.contributions[k];
    const bool motion = std::max(row, column) < s.nodes;
    if (motion) return mass * (uniform(rng, -0.05, 0.05) + (row == column && i == j ? 1.0 : 0.0));
    const auto key = row > column ? std::pair{std::pair{row, column}, std::pair{i, j}}
                                  : std::pair{std::pair{column, row}, std::pair{j, i}};
    const auto [at, is_new] = B.try_emplace(key, 0.0);
    if (is_new) at->second = gradient * uniform(rng, -1.0, 1.0);
    return at->second;
  });
}

VecX random_vector_of(Rng& rng, Index n) {
  return VecX::NullaryExpr(n, [&] { return uniform(rng, -1.0, 1.0); });
}

// max_i |b - A x|_i / (|A| |x| + |b|)_i.
double backward_error(const MatrixXd& A, const VecX& x, const VecX& b) {
  const VecX r = (b - A * x).cwiseAbs(), size = A.cwiseAbs() * x.cwiseAbs() + b.cwiseAbs();
  return r.cwiseQuotient(size).maxCoeff();
}

Saddle random_saddle(Rng& rng) {
  const int nodes = 1 + static_cast<int>(rng() % 12);
  Saddle s(nodes);
  const auto node = [&] { return static_cast<int>(rng() % static_cast<unsigned>(nodes)); };
  for (int k = 0; k < nodes; ++k) {
    const int i = node(), j = node();
    if (i != j) s.couple(i, j);
  }
  // No more rows than coordinates of the first of their nodes, so that B has full rank but for chance.
  std::vector<int> room(static_cast<std::size_t>(nodes), 6);
  for (int k = 0; k < nodes; ++k) {
    std::vector<int> ends{node()};
    int& left = room[static_cast<std::size_t>(ends[0])];
    const int rows = std::min(1 + static_cast<int>(rng() % 6), left);
    left -= rows;
    if (rows == 0) continue;
    if (nodes > 1 && rng() % 3 != 0) {
      int other = node();
      while (other == ends[0]) other = node();
      ends.push_back(other);
    }
    s.constrain(rows, ends);
    s.graph.contributions.push_back({-1, 0});  // and something to the ground
  }
  return s;
}

class Orders : public testing::TestWithParam<PivotOrder> {};
INSTANTIATE_TEST_SUITE_P(All, Orders, testing::Values(PivotOrder::nodes_first, PivotOrder::merged),
                         [](const auto& test) {
                           return test.param == PivotOrder::merged ? "merged" : "nodes_first";
                         });

TEST_P(Orders, RandomSaddleSystemsAreDenseLU) {
  Rng rng(231);
  Worst error("backward error, by rows", 1e-9),
      difference("difference from dense LU, 2-norm", 1e-9);
  long by_klu = 0;
  constexpr int systems = 300;
  for (int k = 0; k < systems; ++k) {
    const Saddle s = random_saddle(rng);
    const auto solver = make_block_solver(GetParam());
    DenseSolver dense;
    solver->analyze(s.graph);
    dense.analyze(s.graph);
    for (int pass = 0; pass < 2; ++pass) {  // and once more with other values
      fill_saddle(s, *solver, dense, rng);
      ASSERT_EQ(solver->factor(), FactorStatus::ok);
      const VecX b = random_vector_of(rng, s.size());
      VecX x = b;
      solver->solve(span_of(x));
      error.add(backward_error(dense.matrix(), x, b));
      const VecX want = dense::solve(dense.matrix(), b);
      ASSERT_EQ(dense.factor(), FactorStatus::ok);
      difference.add((x - want).norm() / want.norm() *
                     std::min(1.0, 1e6 * dense.reciprocal_condition()));
      const double det = dense::determinant(dense.matrix());
      ASSERT_EQ(solver->determinant_sign(), det > 0.0 ? 1 : -1) << k;
    }
    by_klu += solver->facts().fallbacks;
    EXPECT_EQ(solver->facts().factorizations, 2);
  }
  // These all have pivots in their blocks.
  EXPECT_LE(by_klu, systems / 50);
  testing::Test::RecordProperty("by_klu", std::to_string(by_klu));
}

// Transposed solutions are in it. The 1-norm of rows scaled to their largest entry; an estimate from below
// of the inverse's norm.
TEST_P(Orders, ReciprocalConditionIsThatOfADenseInverse) {
  Rng rng(232);
  for (int k = 0; k < 60; ++k) {
    const Saddle s = random_saddle(rng);
    const auto solver = make_block_solver(GetParam());
    DenseSolver dense;
    solver->analyze(s.graph);
    dense.analyze(s.graph);
    fill_saddle(s, *solver, dense, rng);
    ASSERT_EQ(solver->factor(), FactorStatus::ok);
    MatrixXd A = dense.matrix();
    for (Index i = 0; i < A.rows(); ++i) A.row(i) /= A.row(i).cwiseAbs().maxCoeff();
    const MatrixXd inverse = dense::inverse(A);
    const double exact = 1.0 / (A.cwiseAbs().colwise().sum().maxCoeff() *
                                inverse.cwiseAbs().colwise().sum().maxCoeff());
    const double said = solver->reciprocal_condition();
    EXPECT_GE(said, exact * (1.0 - 1e-9)) << k;
    EXPECT_LE(said, 4.0 * exact) << k;
  }
}

// A structure of one node; one held to the ground only; two joints between the same nodes; a ring.
TEST_P(Orders, SmallStructures) {
  Rng rng(233);
  std::vector<Saddle> all;
  all.emplace_back(1);
  all.emplace_back(1);
  for (int rows = 1; rows <= 6; ++rows) {
    all.emplace_back(1);
    all.back().constrain(rows, {0});
  }
  all.emplace_back(2);
  all.back().constrain(3, {0, 1});
  all.back().constrain(2, {1, 0});
  all.emplace_back(7);
  for (int i = 0; i < 7; ++i) all.back().constrain(5, {i, (i + 1) % 7});
  Worst error("backward error, by rows", 1e-10);
  for (const Saddle& s : all) {
    const auto solver = make_block_solver(GetParam());
    DenseSolver dense;
    solver->analyze(s.graph);
    dense.analyze(s.graph);
    fill_saddle(s, *solver, dense, rng);
    ASSERT_EQ(solver->factor(), FactorStatus::ok);
    EXPECT_EQ(solver->facts().fallbacks, 0);
    const VecX b = random_vector_of(rng, s.size());
    VecX x = b;
    solver->solve(span_of(x));
    error.add(backward_error(dense.matrix(), x, b));
  }
  const auto solver = make_block_solver(GetParam());
  solver->analyze({});
  EXPECT_EQ(solver->factor(), FactorStatus::ok);
  solver->solve({});
}

// The same against the largest x of its kind: motions, multipliers of a joint. What is small beside them is round-off.
double error_by_kind(const Saddle& s, const MatrixXd& A, const VecX& x, const VecX& b) {
  const Index motions = 6 * s.nodes;
  VecX most(x.size());
  most.head(motions).setConstant(x.head(motions).cwiseAbs().maxCoeff());
  if (x.size() > motions)
    most.tail(x.size() - motions).setConstant(x.tail(x.size() - motions).cwiseAbs().maxCoeff());
  const VecX r = (b - A * x).cwiseAbs(), size = A.cwiseAbs() * most + b.cwiseAbs();
  return r.cwiseQuotient(size).maxCoeff();
}

// Masses of 1e9 beside gradients of 1, and the other way round; joints that weigh 1e9 beside those of 1.
TEST_P(Orders, IllScaledConstraints) {
  Rng rng(234);
  Worst error("backward error, by rows and kinds", 1e-12);
  for (int k = 0; k < 100; ++k) {
    const Saddle s = random_saddle(rng);
    const auto solver = make_block_solver(GetParam());
    DenseSolver dense;
    solver->analyze(s.graph);
    dense.analyze(s.graph);
    const double mass = k % 2 == 0 ? 1e9 : 1e-9;
    fill_saddle(s, *solver, dense, rng, mass);
    if (k % 4 < 2)  // every second joint by 1e9: rows and columns
      for (std::size_t c = 0; c < s.graph.contributions.size(); ++c) {
        const auto [row, column] = s.graph.contributions[c];
        const int multiplier = std::max(row, column);
        if (multiplier < s.nodes || std::min(row, column) < 0 || multiplier % 2 == 0) continue;
        for (const Slot slot : {solver->slots()[c], dense.slots()[c]})
          for (int j = 0; j < s.graph.blocks[static_cast<std::size_t>(column)].size; ++j)
            for (int i = 0; i < s.graph.blocks[static_cast<std::size_t>(row)].size; ++i)
              slot.data[i + j * slot.ld] *= 1e9;
      }
    ASSERT_EQ(solver->factor(), FactorStatus::ok);
    const VecX b = random_vector_of(rng, s.size());
    VecX x = b;
    solver->solve(span_of(x));
    error.add(error_by_kind(s, dense.matrix(), x, b));
  }
}

// Rows that repeat others, with -1e-8 on the diagonal of their multipliers, as rank-tolerant steps have it, and idle ones with
// -1 there and no row.
TEST_P(Orders, RedundantConstraints) {
  Rng rng(235);
  Saddle s(3);
  const int first = s.constrain(5, {0, 1}), second = s.constrain(5, {0, 1}),
            idle = s.constrain(3, {2});
  for (const int c : {first, second, idle}) s.graph.contributions.push_back({c, c});
  const auto solver = make_block_solver(GetParam());
  DenseSolver dense;
  solver->analyze(s.graph);
  dense.analyze(s.graph);
  MatrixXd B(5, 12);
  for (Index i = 0; i < B.size(); ++i) B(i) = uniform(rng, -1, 1);
  fill(s.graph, *solver, dense, [&](std::size_t k, int i, int j) {
    const auto [row, column] = s.graph.contributions[k];
    if (row == column && row < 3) return i == j ? 2.0 : 0.1;
    if (row == column) return i == j ? (row == idle ? -1.0 : -1e-8) : 0.0;
    const int multiplier = std::max(row, column), node = std::min(row, column);
    if (multiplier == idle) return 0.0;
    return row > column ? B(i, 6 * node + j) : B(j, 6 * node + i);
  });
  ASSERT_EQ(solver->factor(), FactorStatus::ok);
  VecX b = random_vector_of(rng, s.size()), want = b;
  solver->solve(span_of(b));
  want = dense::solve(dense.matrix(), want);
  const Index motions = 18;
  EXPECT_LE((b - want).head(motions).norm(), 1e-6 * want.head(motions).norm());
  EXPECT_LE((b - want).tail(3).norm(), 1e-12 * want.tail(3).norm());
}

// Nodes whose own blocks are empty (or next to nothing), held by their neighbours: no block has a pivot, the matrix is as
// good as can be.
TEST_P(Orders, WhatHasNoPivotsInBlocksIsLeftToKlu) {
  Rng rng(236);
  for (const double own : {0.0, 1e-17}) {
    Saddle s(6);
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < i; ++j) s.couple(i, j);
    const auto solver = make_block_solver(GetParam());
    DenseSolver dense;
    solver->analyze(s.graph);
    dense.analyze(s.graph);
    const auto value = [&](std::size_t k, int, int) {
      const auto [row, column] = s.graph.contributions[k];
      if (row == column) return own * uniform(rng, -1.0, 1.0);
      return uniform(rng, -1.0, 1.0);
    };
    long before = 0;
    for (int pass = 0; pass < 60; ++pass) {
      fill(s.graph, *solver, dense, value);
      ASSERT_EQ(solver->factor(), FactorStatus::ok);
      if (pass % 2 == 0) {  // before any solution
        ASSERT_EQ(solver->determinant_sign(), dense::determinant(dense.matrix()) > 0.0 ? 1 : -1);
      }
      const VecX b = random_vector_of(rng, s.size());
      VecX x = b;
      solver->solve(span_of(x));
      ASSERT_LE(backward_error(dense.matrix(), x, b), 1e-9) << own << ", " << pass;
      ASSERT_EQ(solver->facts().factorizations, pass + 1);
      ASSERT_EQ(solver->facts().fallbacks, before + 1) << own << ", " << pass;
      ++before;
    }
    EXPECT_FALSE(solver->facts().reason.empty());
    // A matrix that has pivots again is done by blocks, once KLU's turn is over.
    for (int pass = 0; pass < 200; ++pass) {
      fill_saddle(s, *solver, dense, rng);
      ASSERT_EQ(solver->factor(), FactorStatus::ok);
      VecX x = random_vector_of(rng, s.size());
      const VecX b = x;
      solver->solve(span_of(x));
      ASSERT_LE(backward_error(dense.matrix(), x, b), 1e-9);
    }
    EXPECT_LT(solver->facts().fallbacks, before + 100);
  }
}

// A row of zeros is named, as KLU names it, nothing is solved with, and afterwards all is as before.
TEST_P(Orders, SingularIsSaid) {
  Rng rng(237);
  Saddle s(3);
  s.couple(0, 1);
  s.constrain(4, {1, 2});
  const auto solver = make_block_solver(GetParam());
  DenseSolver dense;
  solver->analyze(s.graph);
  dense.analyze(s.graph);
  VecX x = VecX::Ones(s.size());
  solver->solve(span_of(x));
  EXPECT_TRUE(std::isnan(x(0)));  // nothing has been factorised
  fill(s.graph, *solver, dense, [&](std::size_t k, int i, int j) {
    const auto [row, column] = s.graph.contributions[k];
    return row == column && i == j && !(row == 2 && i == 4) ? 1.0 : 0.0;
  });
  ASSERT_EQ(solver->factor(), FactorStatus::singular);
  const auto klu = make_klu_solver();
  klu->analyze(s.graph);
  fill(s.graph, *klu, dense, [&](std::size_t k, int i, int j) {
    const auto [row, column] = s.graph.contributions[k];
    return row == column && i == j && !(row == 2 && i == 4) ? 1.0 : 0.0;
  });
  ASSERT_EQ(klu->factor(), FactorStatus::singular);
  EXPECT_EQ(solver->singular_row(), klu->singular_row());
  EXPECT_GE(solver->singular_row(), 0);
  x.setOnes();
  solver->solve(span_of(x));
  EXPECT_TRUE(std::isnan(x(0)));
  EXPECT_EQ(solver->reciprocal_condition(), 0.0);
  EXPECT_EQ(solver->determinant_sign(), 0);
  fill_saddle(s, *solver, dense, rng);
  ASSERT_EQ(solver->factor(), FactorStatus::ok);
  EXPECT_EQ(solver->singular_row(), -1);
  const VecX b = random_vector_of(rng, s.size());
  x = b;
  solver->solve(span_of(x));
  EXPECT_LE(backward_error(dense.matrix(), x, b), 1e-9);
}

// The same input gives the same bits: by another solver, and after other values in between.
TEST_P(Orders, SameInputSameBits) {
  Rng shapes(238);
  for (int k = 0; k < 20; ++k) {
    const Saddle s = random_saddle(shapes);
    const auto one = make_block_solver(GetParam()), other = make_block_solver(GetParam());
    DenseSolver dense;
    one->analyze(s.graph);
    other->analyze(s.graph);
    dense.analyze(s.graph);
    Rng values(17), different(18);
    const VecX b = random_vector_of(different, s.size());
    const auto solved = [&](LinearSolver& solver, Rng rng) {
      fill_saddle(s, solver, dense, rng);
      EXPECT_EQ(solver.factor(), FactorStatus::ok);
      VecX x = b;
      solver.solve(span_of(x));
      return x;
    };
    const VecX first = solved(*one, values), changed = solved(*one, different),
               again = solved(*one, values), second = solved(*other, values);
    EXPECT_NE(first, changed);
    EXPECT_EQ(first, again);
    EXPECT_EQ(first, second);
  }
}

// Matrices of mechanisms at work, by both orders, against KLU: one of steps in time, one of statics.
TEST_P(Orders, OfMechanisms) {
  for (const char* name :
       {"four_bar", "every_joint", "shaft", "windows", "swept_cantilever", "portal_frame"}) {
    const Model model = compile(model_scene(name));
    const System& system = *model.system;
    const double h = 1e-3;
    const TangentWeights weights =
        system.with_rates() ? TangentWeights{.U = 0.25 * h * h, .V = 0.5 * h, .A = 1.0, .T_inv = {}}
                            : TangentWeights{};
    const auto solver = make_block_solver(GetParam()), klu = make_klu_solver();
    Rng rng(239);
    const VecX b = random_vector_of(rng, system.unknowns());
    VecX r, x, want;
    for (LinearSolver* one : {solver.get(), klu.get()}) {
      one->analyze(system.graph());
      system.linearize(model.initial, weights, r, *one);
      ASSERT_EQ(one->factor(), FactorStatus::ok) << name;
      (one == klu.get() ? want : x) = b;
      one->solve(span_of(one == klu.get() ? want : x));
    }
    if (system.with_rates()) {
      EXPECT_EQ(solver->facts().fallbacks, 0) << name;
    }
    const Index motions = 6 * (system.nodes() - 1);
    EXPECT_LE((x - want).head(motions).norm(), 1e-7 * want.head(motions).norm()) << name;
    EXPECT_EQ(solver->determinant_sign(), klu->determinant_sign()) << name;
    EXPECT_EQ(solver->nonzeros(), klu->nonzeros());
  }
}

// Three hinges, two bars, a force at the crown: bars that turn freely about their hinges have no pivots of their own. KLU does
// it, in as many iterations as alone. (With signs of factors that nobody had judged it took 56 instead of 3.)
TEST(BlockSolver, ThreeHingedArch) {
  const Scene scene = read_model_text(
      "<mbd name=\"three_hinged\"><section name=\"s\"><stiffness EA=\"1e9\" GA2=\"1e9\" "
      "GA3=\"1e9\" "
      "GJ=\"1e6\" EI2=\"1e7\" EI3=\"1e7\"/></section>"
      "<beam name=\"l\" section=\"s\" from=\"0 0 0\" to=\"1 0 1\" normal=\"0 1 0\"/>"
      "<beam name=\"r\" section=\"s\" from=\"1 0 1\" to=\"2 0 0\" normal=\"0 1 0\"/>"
      "<revolute name=\"A\" between=\"ground l.start\" axis=\"0 1 0\"/>"
      "<spherical name=\"B\" between=\"ground r.end\"/>"
      "<revolute name=\"C\" between=\"l.end r.start\" axis=\"0 1 0\"/>"
      "<load at=\"l.end\" force=\"0 0 -1e3\"/><static/></mbd>",
      "three_hinged.xml");
  const Model model = compile(scene);
  const System& system = *model.system;
  long iterations[2] = {};
  double sinks[2] = {};
  for (const LinearMethod method : {LinearMethod::block, LinearMethod::klu}) {
    const auto solver = make_linear_solver(method, PivotOrder::merged);
    State state = model.initial;
    const StaticReport report = solve_statics(
        system, *solver, {.newton = {}, .has_potential = true, .conservative = true}, state);
    ASSERT_TRUE(report.converged) << report.failure;
    const std::size_t k = method == LinearMethod::klu ? 1 : 0;
    iterations[k] = report.counters.iterations;
    if (k == 0) {
      EXPECT_GT(solver->facts().fallbacks, 0);
    }
    // Which of the nodes is the crown: the one that sinks most.
    for (std::size_t n = 1; n < state.pose.size(); ++n)
      sinks[k] = std::max(sinks[k],
                          system.reference_pose(static_cast<Index>(n)).r(2) - state.pose[n].r(2));
  }
  EXPECT_EQ(iterations[0], iterations[1]);
  // N = F/sqrt(2), and N L / EA over sin 45 degrees.
  EXPECT_NEAR(sinks[0], std::sqrt(2.0) * 1e3 / 1e9, 1e-4 * std::sqrt(2.0) * 1e3 / 1e9);
  EXPECT_NEAR(sinks[0], sinks[1], 1e-9 * sinks[1]);
}

// A chain of bodies on joints: what is eliminated fills nothing that was not there, and costs in proportion to its length.
TEST_P(Orders, EliminationOfAChain) {
  const auto chain = [](int n) {
    Saddle s(n);
    s.constrain(3, {0});
    for (int i = 1; i < n; ++i) s.constrain(3, {i - 1, i});
    return s;
  };
  const Saddle s = chain(200);
  const Elimination e = eliminate(s.graph, GetParam());
  std::size_t blocks = 0;
  for (std::size_t p = 0; p < e.pivots.size(); ++p) {
    EXPECT_LE(e.begin[p + 1] - e.begin[p], 2u);
    blocks += static_cast<std::size_t>(e.pivots[p].members);
    for (std::size_t k = e.begin[p]; k < e.begin[p + 1]; ++k)
      EXPECT_GT(e.below[k], static_cast<int>(p));
  }
  EXPECT_EQ(blocks, s.graph.blocks.size());
  for (const auto& [row, column] : s.graph.contributions) {
    if (row < s.nodes || column < 0) continue;
    const int multiplier = e.pivot_of[static_cast<std::size_t>(row)],
              node = e.pivot_of[static_cast<std::size_t>(column)];
    if (GetParam() == PivotOrder::nodes_first) {
      EXPECT_GT(multiplier, node);
    }
  }
  for (const auto& pivot : e.pivots)
    EXPECT_LE(pivot.size, GetParam() == PivotOrder::merged ? 12 : 6);
  const double twice = eliminate(chain(400).graph, GetParam()).flops;
  EXPECT_LT(twice, 2.05 * e.flops);
}

// A multiplier that finds no room in its nodes' pivots comes after them; a star of joints on one body.
TEST(Elimination, MultipliersWithoutRoomComeLater) {
  Saddle s(1);
  for (int k = 0; k < 5; ++k) s.constrain(2, {0});
  const Elimination e = eliminate(s.graph, PivotOrder::merged);
  ASSERT_EQ(e.pivots.size(), 3u);
  EXPECT_EQ(e.pivots[0].size, 12);
  EXPECT_TRUE(e.pivots[0].merged);
  EXPECT_EQ(e.pivots[1].size, 2);
  EXPECT_EQ(e.pivots[2].size, 2);
}

}  // namespace
}  // namespace mbd::test::test_block_solver
