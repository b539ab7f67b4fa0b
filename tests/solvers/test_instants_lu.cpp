// LU by blocks of all instants (solvers/modes/instants_lu.hpp) against Eigen's dense LU, on loops of nodes with multipliers.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <complex>
#include <limits>
#include <random>

#include "solvers/modes/instants_lu.hpp"
#include "tests/support/dense.hpp"

namespace mbd::test::test_instants_lu {
namespace {

// Nodes in a loop, each joined with the next by a multiplier of some rows, whose own block is zero.
BlockGraph loop_of(int nodes) {
  BlockGraph graph;
  for (int n = 0; n < nodes; ++n) graph.blocks.push_back({6, BlockGraph::Kind::node});
  for (int n = 0; n < nodes; ++n)
    graph.blocks.push_back({1 + 2 * (n % 3), BlockGraph::Kind::multiplier});
  for (int n = 0; n < nodes; ++n) {
    graph.contributions.push_back({n, n});
    graph.contributions.push_back({nodes + n, nodes + n});
    for (const int end : {n, (n + 1) % nodes}) {
      graph.contributions.push_back({end, nodes + n});
      graph.contributions.push_back({nodes + n, end});
    }
  }
  return graph;
}

template <class T>
T draw(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  if constexpr (std::is_same_v<T, double>)
    return uniform(random);
  else
    return {uniform(random), uniform(random)};
}

template <class T>
void expect_that_of_eigen(bool without_diagonal) {
  using Dense = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  constexpr int nodes = 7;
  constexpr Index instants = 5;
  const BlockGraph graph = loop_of(nodes);
  std::vector<int> first{0};
  for (const BlockGraph::Block& block : graph.blocks) first.push_back(first.back() + block.size);
  const Index unknowns = first.back();
  InstantsLu<T> lu(graph, instants);
  std::mt19937 random(7);
  for (int attempt = 0; attempt < 2; ++attempt) {  // the second time over the factors of the first
    Dense A = Dense::Zero(instants * unknowns, instants * unknowns);
    lu.set_zero();
    for (const auto& [row, column] : graph.contributions) {
      const auto r = static_cast<std::size_t>(row), c = static_cast<std::size_t>(column);
      if (row >= nodes && row == column) continue;
      for (int a = first[r]; a < first[r + 1]; ++a)
        for (int b = first[c]; b < first[c + 1]; ++b) {
          if (without_diagonal && a == b) continue;
          for (Index i = 0; i < instants; ++i)
            for (Index j = 0; j < instants; ++j) {
              // Constraints hold at each instant.
              if (i != j && (row >= nodes || column >= nodes)) continue;
              const T value = draw<T>(random);
              A(i * unknowns + a, j * unknowns + b) += value;
              lu.add(i, a, j, b, value);
            }
        }
    }
    Dense B(A.rows(), 3);
    for (Index k = 0; k < B.size(); ++k) B(k) = draw<T>(random);
    ASSERT_TRUE(lu.factor());
    const Dense X = dense::solve_columns(A, B);
    EXPECT_LT((lu.solve(B) - X).cwiseAbs().maxCoeff(), 1e-8 * X.cwiseAbs().maxCoeff());
  }
}

TEST(InstantsLu, SolvesAsDenseLuDoes) {
  expect_that_of_eigen<double>(false);
  expect_that_of_eigen<std::complex<double>>(false);
}

TEST(InstantsLu, ExchangesRows) {
  expect_that_of_eigen<double>(true);
  expect_that_of_eigen<std::complex<double>>(true);
}

TEST(InstantsLu, SaysWhatIsNotFinite) {
  const BlockGraph graph = loop_of(3);
  InstantsLu<double> lu(graph, 3);
  lu.set_zero();
  lu.add(0, 0, 0, 0, std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(lu.factor());
}

}  // namespace
}  // namespace mbd::test::test_instants_lu
