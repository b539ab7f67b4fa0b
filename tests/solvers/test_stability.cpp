// The count of negative eigenvalues, the eigenvalue nearest to zero, the sign of a determinant, and the
// derivative of the residual by the load factor.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>

#include "solvers/linear/block_solver.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "solvers/statics/equilibrium.hpp"
#include "solvers/statics/stability.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/dense_solver.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_stability {
namespace {

using std::numbers::pi;

// --- matrices ---

struct BlockMatrix {
  BlockGraph graph;
  Eigen::MatrixXd dense;
};

// Random symmetric blocks along a chain, with multipliers between them: [K B^T; B 0].
BlockMatrix random_saddle(std::mt19937& random, int nodes, double shift) {
  BlockMatrix m;
  std::normal_distribution<double> normal;
  for (int i = 0; i < nodes; ++i) m.graph.blocks.push_back({6, BlockGraph::Kind::node});
  for (int i = 0; i + 1 < nodes; i += 2)
    m.graph.blocks.push_back({2, BlockGraph::Kind::multiplier});
  for (int i = 0; i < nodes; ++i)
    for (int j = std::max(0, i - 1); j < std::min(nodes, i + 2); ++j)
      m.graph.contributions.push_back({i, j});
  for (int k = nodes; k < static_cast<int>(m.graph.blocks.size()); ++k)
    for (const int node : {2 * (k - nodes), 2 * (k - nodes) + 1}) {
      m.graph.contributions.push_back({k, node});
      m.graph.contributions.push_back({node, k});
    }
  m.graph.contributions.push_back({0, -1});  // to the ground: thrown away
  std::vector<Index> first;
  Index n = 0;
  for (const auto& block : m.graph.blocks) {
    first.push_back(n);
    n += block.size;
  }
  m.dense.setZero(n, n);
  for (const auto& [r, c] : m.graph.contributions) {
    if (c < 0 || r < c) continue;
    const auto R = static_cast<std::size_t>(r), C = static_cast<std::size_t>(c);
    for (Index i = 0; i < m.graph.blocks[R].size; ++i)
      for (Index j = 0; j < m.graph.blocks[C].size; ++j) {
        const Index row = first[R] + i, column = first[C] + j;
        if (row < column) continue;
        double value = normal(random);
        if (row == column) value = value + shift;
        m.dense(row, column) = m.dense(column, row) = value;
      }
  }
  return m;
}

void fill(LinearSolver& solver, const BlockMatrix& m) {
  solver.analyze(m.graph);
  solver.set_zero();
  std::vector<Index> first;
  Index n = 0;
  for (const auto& block : m.graph.blocks) {
    first.push_back(n);
    n += block.size;
  }
  for (std::size_t k = 0; k < m.graph.contributions.size(); ++k) {
    const auto& [r, c] = m.graph.contributions[k];
    const Slot slot = solver.slots()[k];
    if (c < 0) {
      slot.data[0] += 1e9;
      continue;
    }
    const auto R = static_cast<std::size_t>(r), C = static_cast<std::size_t>(c);
    for (int j = 0; j < m.graph.blocks[C].size; ++j)
      for (int i = 0; i < m.graph.blocks[R].size; ++i)
        slot.data[j * slot.ld + i] += m.dense(first[R] + i, first[C] + j);
  }
}

using MakeInertia = std::unique_ptr<InertiaSolver> (*)();
class InertiaSolvers : public testing::TestWithParam<MakeInertia> {};
INSTANTIATE_TEST_SUITE_P(All, InertiaSolvers,
                         testing::Values(&make_inertia_solver, &make_block_inertia_solver),
                         [](const auto& test) { return test.index == 0 ? "mumps" : "blocks"; });

// Against the eigenvalues of the dense matrix, by another algorithm.
TEST_P(InertiaSolvers, CountsNegativeEigenvalues) {
  std::mt19937 random(7);
  for (const int nodes : {1, 2, 3, 8, 25})
    for (const double shift : {-20.0, -2.0, 0.0, 3.0, 30.0}) {
      const BlockMatrix m = random_saddle(random, nodes, shift);
      const std::unique_ptr<InertiaSolver> solver = GetParam()();
      fill(*solver, m);
      ASSERT_EQ(solver->factor(), FactorStatus::ok);
      const Eigen::VectorXd values = dense::eigenvalues(m.dense);
      EXPECT_EQ(solver->negative_eigenvalues(), (values.array() < 0.0).count())
          << nodes << " nodes, shift " << shift;
      EXPECT_EQ(solver->asymmetry(), 0.0);
      // It also solves.
      VecX x = VecX::Random(m.dense.rows()), b = m.dense * x;
      solver->solve({b.data(), static_cast<std::size_t>(b.size())});
      EXPECT_LT((b - x).norm(), 1e-8 * x.norm());
    }
}

TEST_P(InertiaSolvers, SeesThatAMatrixIsNotSymmetric) {
  std::mt19937 random(3);
  BlockMatrix m = random_saddle(random, 4, 10.0);
  m.dense(0, 7) += 0.5;
  const std::unique_ptr<InertiaSolver> solver = GetParam()();
  fill(*solver, m);
  ASSERT_EQ(solver->factor(), FactorStatus::ok);
  EXPECT_NEAR(solver->asymmetry(), 0.5 / m.dense.topLeftCorner(24, 24).cwiseAbs().maxCoeff(),
              1e-12);
}

TEST_P(InertiaSolvers, NotANumberIsNoCount) {
  std::mt19937 random(3);
  BlockMatrix m = random_saddle(random, 4, 10.0);
  m.dense(3, 3) = std::nan("");
  const std::unique_ptr<InertiaSolver> solver = GetParam()();
  fill(*solver, m);
  EXPECT_NE(solver->factor(), FactorStatus::ok);
  EXPECT_FALSE(solver->negative_eigenvalues());
}

TEST(KluSolver, SignOfTheDeterminant) {
  std::mt19937 random(11);
  int negative = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const BlockMatrix m = random_saddle(random, 1 + trial % 7, 0.3);
    const std::unique_ptr<LinearSolver> solver = make_klu_solver();
    fill(*solver, m);
    ASSERT_EQ(solver->factor(), FactorStatus::ok);
    const int sign = dense::determinant(m.dense) < 0.0 ? -1 : 1;
    EXPECT_EQ(solver->determinant_sign(), sign) << "trial " << trial;
    negative += sign < 0 ? 1 : 0;
  }
  EXPECT_GT(negative, 5);
  EXPECT_LT(negative, 35);
}

// --- structures ---

// A column on two hinges that hold its spin, under a dead force P along it, in units of pi^2 EI2/L^2; stiff
// in stretch and shear; `ratio` times as stiff about b3 as about b2.
Scene column(double P, double ratio) {
  const auto number = [](double x) { return std::to_string(x); };
  return read_model_text(
      "<mbd name=\"column\"><section name=\"s\"><stiffness EA=\"1e7\" GA2=\"1e7\" GA3=\"1e7\" "
      "GJ=\"100\" "
      "EI2=\"1\" EI3=\"" +
          number(ratio) +
          "\"/></section><beam name=\"b\" section=\"s\" from=\"0 0 0\" to=\"1 0 0\" normal=\"0 0 "
          "1\" "
          "elements=\"6\" order=\"4\"/><universal name=\"foot\" between=\"ground b.start\" "
          "axis=\"0 1 0\" second_axis=\"0 0 1\"/><point_on_line name=\"head\" "
          "between=\"b.end ground\" axis=\"1 0 0\"/><load at=\"b.end\" force=\"" +
          number(-P * pi * pi) + " 0 0\"/><static steps=\"4\"/></mbd>",
      "column.xml");
}

struct Column {
  Model model;
  State state;
};
Column straight_column(double P, double ratio) {
  const Scene scene = column(P, ratio);
  Column c{compile(scene), {}};
  c.state = c.model.initial;
  const std::unique_ptr<LinearSolver> solver = make_klu_solver();
  solver->analyze(c.model.system->graph());
  Counters counters;
  std::string failure;
  EXPECT_TRUE(newton_equilibrium(*c.model.system, *solver, {.tolerance = 1e-12}, c.state, counters,
                                 failure))
      << failure;
  return c;
}

// Euler: a straight column has an unstable way for each n with P > n^2 pi^2 EI/L^2, about each axis.
TEST(StabilityCount, EulerColumn) {
  const struct {
    double P, ratio;
    Index expected;
  } cases[] =
      {
          {0.0, 1.0, 0},  {0.99, 1.0, 0}, {1.01, 1.0, 2}, {3.99, 1.0, 2},
          {4.02, 1.0, 4}, {9.1, 1.0, 6},  {1.5, 2.0, 1},  {2.05, 2.0, 2},
          {4.02, 2.0, 3}, {8.1, 2.0, 4},  {1.05, 1.1, 1}};  // the last: 10 % more EI about one axis is seen
  for (const auto& [P, ratio, expected] : cases) {
    Column c = straight_column(P, ratio);
    StabilityCount count(*c.model.system);
    EXPECT_EQ(count(c.state), expected) << "P = " << P << ", EI3 = " << ratio << " EI2";
    EXPECT_LT(count.asymmetry(), 1e-12);
  }
}

// In the room of a solver of statics the count is the same, and that has nothing to solve with afterwards until it is
// filled again. (A count that left the solver as it was would solve by other factors: seen to fail without `taken`.)
TEST(StabilityCount, InTheRoomOfASolver) {
  for (const double P : {0.99, 1.01, 4.02, 9.1}) {
    Column c = straight_column(P, 1.0);
    const System& system = *c.model.system;
    const std::unique_ptr<LinearSolver> solver = make_block_solver(PivotOrder::merged);
    solver->analyze(system.graph());
    const auto solve = [&] {
      VecX x = VecX::Ones(system.unknowns());
      solver->solve({x.data(), static_cast<std::size_t>(x.size())});
      return x;
    };
    VecX r;
    system.linearize(c.state, {}, r, *solver);
    ASSERT_EQ(solver->factor(), FactorStatus::ok);
    const VecX before = solve();
    StabilityCount own(system), shared(system, *solver);
    EXPECT_EQ(shared(c.state), own(c.state)) << "P = " << P;
    EXPECT_EQ(shared.asymmetry(), own.asymmetry());
    EXPECT_FALSE(solve().allFinite());
    system.linearize(c.state, {}, r, *solver);
    ASSERT_EQ(solver->factor(), FactorStatus::ok);
    EXPECT_EQ(solve(), before);
  }
  // One without such room has its own beside it.
  Column c = straight_column(4.02, 1.0);
  const std::unique_ptr<LinearSolver> klu = make_klu_solver();
  klu->analyze(c.model.system->graph());
  EXPECT_EQ(StabilityCount(*c.model.system, *klu)(c.state), 4);
}

// Against the dense generalised eigenproblem.
TEST(CriticalMode, IsTheEigenpairNearestToZero) {
  Column c = straight_column(1.3, 2.0);
  const System& system = *c.model.system;
  const std::unique_ptr<LinearSolver> solver = make_klu_solver();
  solver->analyze(system.graph());
  const std::optional<CriticalMode> mode = critical_mode(system, *solver, c.state);
  ASSERT_TRUE(mode);
  const VecX w = motion_weights(system);
  EXPECT_NEAR(mode->shape.dot(w.cwiseProduct(mode->shape)), 1.0, 1e-12);

  // Energy of the exact mode, sin(pi s): 1/2 tau = 1/4 (pi^4 EI - P pi^2)/L^3 a^2 over its measure
  // |u|^2/L^2 + |psi|^2, means over the nodes.
  const double a2 = 1.0;
  double measure = 0.0;
  for (Index n = 1; n < system.nodes(); ++n) {
    const double s = system.reference_pose(static_cast<Index>(n)).r(0);
    measure += a2 * (std::pow(std::sin(pi * s), 2) + std::pow(pi * std::cos(pi * s), 2)) /
               static_cast<double>(system.nodes() - 1);
  }
  const double tau = 0.5 * (std::pow(pi, 4) - 1.3 * pi * pi * pi * pi) / measure;
  EXPECT_NEAR(mode->eigenvalue, tau, 1e-3 * std::abs(tau));
  EXPECT_LT(tau, 0.0);
  EXPECT_NE(name_of_motion(system, mode->shape).find("beam 'b' node"), std::string::npos);
}

// --- the derivative by the load factor ---

// Central differences of sixth order of the residual.
VecX difference(const System& system, State state) {
  const double at = state.load_factor, h = 1e-2;
  VecX sum = VecX::Zero(system.rows()), r;
  const double weights[] = {3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0};
  for (int k = 1; k <= 3; ++k)
    for (const double sign : {1.0, -1.0}) {
      state.load_factor = at + sign * k * h;
      system.residual(state, r);
      sum += sign * weights[k - 1] / h * r;
    }
  return sum;
}

// Every kind of load, and prescribed motions.
TEST(LoadRate, IsTheDerivativeOfTheResidual) {
  const Scene scene = read_model_text(
      R"(<mbd name="loads"><section name="s"><stiffness EA="1e4" GA2="1e4" GA3="1e4" GJ="10" EI2="10"
      EI3="10"/><mass per_length="1" inertia="2 1 1"/></section>
      <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2"/>
      <beam name="c" section="s" from="1 0 0" to="1 1 0" normal="0 0 1" elements="1"/>
      <fixed name="clamp" between="ground b.start"/>
      <revolute name="hinge" between="b.end c.start" axis="0 0 1"/>
      <drive joint="hinge" angle="0.7"/>
      <motion name="push" of="c.end" displacement="0.01 -0.1 0.02"/>
      <load at="b.end" force="1 2 3" moment="3 2 1" follower_force="5 4 3" follower_moment="1 1 2" offset="0.1 0.2 0.3"/>
      <distributed beam="b" force="0 0 -1" follower_force="0 1 0"/>
      <gravity acceleration="0 0 -9.81"/>
      <static/></mbd>)",
      "loads.xml");
  const Model model = compile(scene);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  State state = model.initial;
  VecX x(model.system->unknowns());
  for (Index i = 0; i < x.size(); ++i) x(i) = 0.2 * normal(random);
  retract(*model.system, state, x);
  state.load_factor = 0.6;
  VecX rate;
  model.system->load_rate(state, rate);
  const VecX expected = difference(*model.system, state);
  EXPECT_GT(expected.tail(model.system->multipliers()).norm(), 0.1);
  EXPECT_LT((rate - expected).norm(), 1e-9 * expected.norm());
}

}  // namespace
}  // namespace mbd::test::test_stability
