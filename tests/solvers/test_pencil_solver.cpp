// The systems of an implicit Runge-Kutta step by block LU and by KLU against dense LU, real and complex.
#include "solvers/linear/pencil_solver.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <complex>
#include <vector>

#include "solvers/linear/block_solver.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/dense_solver.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_pencil_solver {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

// Random blocks at the places of a mechanism's graph, with diagonal blocks of multipliers among them.
struct Pencil {
  BlockGraph graph;
  std::unique_ptr<PencilSolver> solver;
  DenseSolver dense[3];
  std::vector<char> is_node;  // by unknown

  Pencil(const std::string& model, bool with_own_blocks, LinearMethod method)
      : solver(make_pencil_solver(method)) {
    const Model m = compile(model_scene(model));
    graph = m.system->graph();
    const int blocks = static_cast<int>(graph.blocks.size());
    if (with_own_blocks)
      for (int k = 0; k < blocks; ++k)
        if (graph.blocks[static_cast<std::size_t>(k)].kind == BlockGraph::Kind::multiplier)
          graph.contributions.push_back({k, k});
    for (const auto& block : graph.blocks)
      for (int i = 0; i < block.size; ++i) is_node.push_back(block.kind == BlockGraph::Kind::node);
    solver->analyze(graph);
    for (DenseSolver& d : dense) d.analyze(graph);
  }

  // Diagonal blocks outweigh the others, so that no system is singular by chance.
  void fill(Rng& rng) {
    solver->set_zero();
    for (int power = 0; power < 3; ++power) {
      auto& other = dense[power];
      other.set_zero();
      const auto slots = solver->slots(power), copies = other.slots();
      ASSERT_EQ(slots.size(), graph.contributions.size());
      for (std::size_t k = 0; k < slots.size(); ++k) {
        const auto& c = graph.contributions[k];
        const auto rows = c.row < 0 ? 0 : graph.blocks[static_cast<std::size_t>(c.row)].size;
        const auto cols = c.column < 0 ? 0 : graph.blocks[static_cast<std::size_t>(c.column)].size;
        if (rows == 0 || cols == 0) continue;
        const bool nodes = is_node_block(c.row) && is_node_block(c.column);
        if (power > 0 && !nodes) continue;
        for (Index j = 0; j < cols; ++j)
          for (Index i = 0; i < rows; ++i) {
            const double x = uniform(rng, -1, 1) + (c.row == c.column && i == j ? 20.0 : 0.0);
            slots[k].data[i + j * slots[k].ld] += x;
            copies[k].data[i + j * copies[k].ld] += x;
          }
      }
    }
  }
  bool is_node_block(int block) const {
    return graph.blocks[static_cast<std::size_t>(block)].kind == BlockGraph::Kind::node;
  }
  template <class S>
  Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic> matrix(double s, S x) const {
    const Index n = dense[0].matrix().rows();
    Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic> E(n, n);
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) {
        const bool nodes =
            is_node[static_cast<std::size_t>(i)] != 0 && is_node[static_cast<std::size_t>(j)] != 0;
        E(i, j) = nodes ? s * (dense[0].matrix()(i, j) + x * dense[1].matrix()(i, j) +
                               x * x * dense[2].matrix()(i, j))
                        : S(dense[0].matrix()(i, j));
      }
    return E;
  }
};

class PencilSolvers : public testing::TestWithParam<LinearMethod> {};
INSTANTIATE_TEST_SUITE_P(All, PencilSolvers,
                         testing::Values(LinearMethod::block, LinearMethod::klu),
                         [](const auto& test) { return std::string(name_of(test.param)); });

// With one complex x, and with two and three, as steps of 3, 5 and 7 stages have them; and fewer after more.
TEST_P(PencilSolvers, IsDenseLU) {
  Rng rng(8);
  // Without blocks of their own some of the multipliers of every_joint would be undetermined by chance.
  for (const auto& [model, own] : {std::pair{"four_bar", false},
                                   {"four_bar", true},
                                   {"every_joint", true},
                                   {"dzhanibekov", false}}) {
    Pencil p(model, own, GetParam());
    const Index n = p.dense[0].matrix().rows();
    Worst real("real", 1e-12), complex("complex", 1e-12), products("products", 1e-15);
    for (int pass = 0; pass < 3; ++pass) {  // from the second on, pivots are kept
      p.fill(rng);
      const double x = uniform(rng, 0.5, 2.0), s = 1.0 / (x * x);
      std::vector<Complex> z(
          std::array<std::size_t, 3>{1, 3, 2}.at(static_cast<std::size_t>(pass)));
      for (Complex& one : z) one = {uniform(rng, 0.3, 1.5), uniform(rng, 0.3, 1.5)};
      ASSERT_EQ(p.solver->factor(s, x, z), FactorStatus::ok) << model;
      VecX b = VecX::NullaryExpr(n, [&] { return uniform(rng, -1, 1); });
      const VecX want = dense::solve(p.matrix<double>(s, x), b);
      p.solver->solve(std::span<double>(b.data(), static_cast<std::size_t>(n)));
      real.add((b - want).norm() / want.norm(), model);
      for (std::size_t which = 0; which < z.size(); ++which) {
        VectorXcd c = VectorXcd::NullaryExpr(
            n, [&] { return Complex(uniform(rng, -1, 1), uniform(rng, -1, 1)); });
        const VectorXcd want_c = dense::solve(p.matrix<Complex>(s, z[which]), c);
        p.solver->solve(std::span<Complex>(c.data(), static_cast<std::size_t>(n)), which);
        complex.add((c - want_c).norm() / want_c.norm(), model);
      }
      EXPECT_GT(p.solver->reciprocal_condition(), 0.0);
      EXPECT_LE(p.solver->reciprocal_condition(), 1.0);
      for (int power = 0; power < 3; ++power) {
        VecX y = VecX::Ones(n);
        p.solver->multiply(power, {b.data(), static_cast<std::size_t>(n)},
                           {y.data(), static_cast<std::size_t>(n)});
        const VecX product = VecX::Ones(n) + p.dense[power].matrix() * b;
        products.add((y - product).norm() / (1.0 + product.norm()), model);
      }
    }
  }
}

// The pencil of a mechanism at work, with the powers as Radau takes them.
TEST_P(PencilSolvers, OfAMechanism) {
  const Model model = compile(model_scene("four_bar"));
  const System& system = *model.system;
  const auto solver = make_pencil_solver(GetParam());
  solver->analyze(system.graph());
  solver->set_zero();
  State state = model.initial;
  system.set_time(state, 2.0);
  VecX r;
  system.linearize(state, {}, r, solver->slots(0));
  system.add_rate_tangent(state, {.U = 0, .V = 1, .A = 0, .T_inv = {}}, solver->slots(1));
  system.add_rate_tangent(state, {.U = 0, .V = 0, .A = 1, .T_inv = {}}, solver->slots(2));
  const double h = 9e-3, x = 3.6378 / h, s = 1.0 / (x * x);
  const Complex z(2.6811 / h, 3.0504 / h);
  ASSERT_EQ(solver->factor(s, x, z), FactorStatus::ok);
  DenseSolver dense;
  dense.analyze(system.graph());
  system.linearize(state, {.U = s, .V = s * x, .A = s * x * x, .T_inv = {}}, r, dense);
  ASSERT_EQ(dense.factor(), FactorStatus::ok);
  Rng rng(9);
  VecX b = VecX::NullaryExpr(system.unknowns(), [&] { return uniform(rng, -1, 1); }), want = b;
  solver->solve(std::span<double>(b.data(), static_cast<std::size_t>(b.size())));
  dense.solve({want.data(), static_cast<std::size_t>(want.size())});
  const Index motions = 6 * (system.nodes() - 1);
  testing::Test::RecordProperty(
      "difference",
      testing::PrintToString((b - want).head(motions).norm() / want.head(motions).norm()));
  EXPECT_LE((b - want).head(motions).norm(), 1e-8 * want.head(motions).norm());
  EXPECT_LE((b - want).tail(system.multipliers()).norm(),
            1e-8 * want.tail(system.multipliers()).norm());
}

// Of several complex ones each as if it were alone, in merged pivots too (a bob without inertia): of order 9 and 13.
TEST_P(PencilSolvers, OfSeveralShifts) {
  const Model model = compile(model_scene("pendulum"));
  const System& system = *model.system;
  const auto solver = make_pencil_solver(GetParam()), alone = make_pencil_solver(GetParam());
  VecX r;
  for (PencilSolver* const s : {solver.get(), alone.get()}) {
    s->analyze(system.graph());
    s->set_zero();
    const std::vector<Mat6> still(static_cast<std::size_t>(system.nodes()), Mat6::Zero());
    system.linearize_powers(model.initial, still, r, {s->slots(0), s->slots(1), s->slots(2)});
  }
  const Complex z[] = {{4.38e2, 1.017e3}, {70.0, 66.0}, {8.5, 3.3}};
  ASSERT_EQ(solver->factor(1e-4, 100.0, z), FactorStatus::ok);
  for (std::size_t k = 0; k < 3; ++k) {
    ASSERT_EQ(alone->factor(1e-4, 100.0, z[k]), FactorStatus::ok);
    VectorXcd b = VectorXcd::LinSpaced(system.unknowns(), 1.0, 2.0), want = b;
    solver->solve(std::span<Complex>(b.data(), static_cast<std::size_t>(b.size())), k);
    alone->solve(std::span<Complex>(want.data(), static_cast<std::size_t>(want.size())));
    EXPECT_LE((b - want).norm(), 1e-12 * want.norm()) << k;
  }
  EXPECT_EQ(solver->facts().fallbacks, 0);
}

// A zero row and column: said which, and nothing solved with.
TEST_P(PencilSolvers, NamesWhatIsSingular) {
  BlockGraph graph;
  graph.blocks = {{6, BlockGraph::Kind::node}, {6, BlockGraph::Kind::node}};
  graph.contributions = {{0, 0}, {1, 1}};
  const auto solver = make_pencil_solver(GetParam());
  solver->analyze(graph);
  solver->set_zero();
  const auto slots = solver->slots(0);
  for (std::size_t k = 0; k < 2; ++k)
    for (Index i = 0; i < 6; ++i)
      if (!(k == 1 && i == 3)) slots[k].data[i * (slots[k].ld + 1)] = 1.0;
  ASSERT_EQ(solver->factor(1.0, 1.0, Complex(1.0, 1.0)), FactorStatus::singular);
  EXPECT_EQ(solver->singular_row(), 9);
  VecX b = VecX::Ones(12);
  VectorXcd c = VectorXcd::Ones(12);
  solver->solve(std::span<double>(b.data(), 12));
  solver->solve(std::span<Complex>(c.data(), 12));
  EXPECT_TRUE(std::isnan(b(0)));
  EXPECT_TRUE(std::isnan(c(0).real()));
  EXPECT_EQ(solver->reciprocal_condition(), 0.0);
  // and again, once it is not
  slots[1].data[3 * (slots[1].ld + 1)] = 2.0;
  ASSERT_EQ(solver->factor(0.5, 1.0, Complex(1.0, 1.0)), FactorStatus::ok);
  EXPECT_EQ(solver->singular_row(), -1);
  b.setOnes();
  solver->solve(std::span<double>(b.data(), 12));
  EXPECT_NEAR(b(0), 2.0, 1e-15);
  EXPECT_NEAR(b(9), 1.0, 1e-15);
}

}  // namespace
}  // namespace mbd::test::test_pencil_solver
