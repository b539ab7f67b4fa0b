#include "libmbd/core/system.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <regex>
#include <set>

#include "elements/element_batch.hpp"
#include "elements/node/mass.hpp"
#include "joints/any_joint_batch.hpp"
#include "libmbd/compile/model.hpp"
#include "libmbd/language/reader.hpp"
#include "solvers/linear/klu_solver.hpp"
#include "tests/support/dense.hpp"
#include "tests/support/dense_solver.hpp"
#include "tests/support/random.hpp"

namespace {

using namespace mbd;
using Eigen::MatrixXd;
using test::eps;
using test::Rng;
using test::Worst;

// models/four_bar.xml: 8 cubic elements, four revolute joints, one of them driven.
struct FourBar {
  Model model = compile(read_model(std::string(MBD_SOURCE_DIR) + "/models/four_bar.xml"));
  const System& system = *model.system;
  static constexpr double length = 0.02;  // between nodes

  // Far from equilibrium, everything moving, every multiplier at work.
  State random_state(Rng& rng) const {
    State s = system.reference_state();
    system.set_time(s, 2.0);
    for (std::size_t n = 1; n < s.pose.size(); ++n) {
      Vec6 U = test::random_vector<6>(rng, 0.05);
      U.head<3>() *= length;
      s.pose[n] = s.pose[n] * exp_se3(U);
      s.V[n] = test::random_vector<6>(rng, 50);
      s.Vdot[n] = test::random_vector<6>(rng, 100);
      s.V[n].head<3>() *= length;
      s.Vdot[n].head<3>() *= length;
    }
    s.lambda =
        VecX::NullaryExpr(system.multipliers(), [&] { return test::uniform(rng, -1e5, 1e5); });
    return s;
  }
  Index dynamic_rows() const { return 6 * (system.nodes() - 1); }
  VecX residual(const State& s) const {
    VecX r;
    EXPECT_TRUE(system.residual(s, r));
    return r.tail(system.unknowns());
  }
  MatrixXd tangent(const State& s, const TangentWeights& w) const {
    test::DenseSolver dense;
    dense.analyze(system.graph());
    VecX r;
    EXPECT_TRUE(system.linearize(s, w, r, dense));
    return dense.matrix();
  }

  // d residual / d of what `move(state, unknown, h)` moves, order 8
  template <class Move>
  MatrixXd difference(const State& s, Index columns, double h, const Move& move) const {
    MatrixXd K(system.unknowns(), columns);
    for (Index c = 0; c < columns; ++c) {
      K.col(c) = test::first_difference(
          [&](double step) {
            State moved = s;
            move(moved, c, step);
            return residual(moved);
          },
          h);
    }
    return K;
  }
  MatrixXd pose_difference(const State& s) const {
    return difference(s, dynamic_rows(), 0.01, [](State& x, Index c, double h) {
      auto& H = x.pose[static_cast<std::size_t>(1 + c / 6)];
      H = H * exp_se3<double>(h * (c % 6 < 3 ? length : 1.0) * Vec6::Unit(c % 6));
    });
  }
  // rows of moments and columns of rotations divided by the length
  double size(const MatrixXd& K) const {
    MatrixXd scaled = K;
    for (Index i = 0; i < K.rows(); ++i)
      if (i < dynamic_rows() && i % 6 > 2) scaled.row(i) /= length;
    for (Index i = 0; i < K.cols(); ++i)
      if (i < dynamic_rows() && i % 6 > 2) scaled.col(i) /= length;
    return scaled.cwiseAbs().maxCoeff();
  }
  double error(const MatrixXd& got, const MatrixXd& want) const {
    return size(got - want) / size(want);
  }
};

TEST(System, RowsHaveNames) {
  const FourBar f;
  EXPECT_EQ(f.system.nodes(), 1 + 7 + 13 + 7);
  EXPECT_EQ(f.system.multipliers(), 4 * 5 + 1);
  EXPECT_EQ(f.system.rows(), 6 * f.system.nodes() + f.system.multipliers());
  EXPECT_EQ(f.system.unknowns(), f.system.rows() - 6);
  EXPECT_TRUE(f.system.with_rates());

  const char* components[] = {"force 1", "force 2", "force 3", "moment 1", "moment 2", "moment 3"};
  std::set<std::string> names;
  std::set<std::string> owners;
  for (Index row = 0; row < f.system.rows(); ++row) {
    const std::string name = f.system.name_of(row);
    EXPECT_TRUE(names.insert(name).second) << name << " twice";
    const std::size_t comma = name.rfind(", ");
    ASSERT_NE(comma, std::string::npos) << name;
    owners.insert(name.substr(0, comma));
    if (row < 6)
      EXPECT_EQ(name, std::string("ground, ") + components[row]);
    else if (row < 6 * f.system.nodes())
      EXPECT_TRUE(std::regex_match(
          name,
          std::regex(std::string("beam '(bar1|bar2|bar3)' node [0-9]+, ") + components[row % 6])))
          << name;
    else
      EXPECT_TRUE(
          std::regex_match(name, std::regex("(revolute|drive|driven rotation) .*'[ABCD]', .+")))
          << name;
  }
  for (const char* joint : {"revolute 'A'", "revolute 'B'", "revolute 'C'", "revolute 'D'"})
    EXPECT_EQ(owners.count(joint), 1U) << joint;
  EXPECT_EQ(f.system.name_of(6 * 8), f.system.node_name(8) + ", force 1");
  EXPECT_EQ(f.system.name_of(-1), "no equation");
  EXPECT_EQ(f.system.name_of(f.system.rows()), "no equation");
}

TEST(System, ReferenceStateIsAtRestWithSignalsAtZero) {
  const FourBar f;
  const State s = f.system.reference_state();
  ASSERT_EQ(s.pose.size(), static_cast<std::size_t>(f.system.nodes()));
  ASSERT_EQ(s.V.size(), s.pose.size());
  EXPECT_EQ(s.lambda.size(), f.system.multipliers());
  EXPECT_EQ(s.t, 0.0);
  EXPECT_EQ(s.load_factor, 1.0);
  EXPECT_TRUE(s.lambda.isZero(0.0));
  for (const Vec6& V : s.V) EXPECT_TRUE(V.isZero(0.0));
  // assembled: constraints hold, nothing is strained
  const VecX r = f.residual(s);
  EXPECT_LT(r.tail(f.system.multipliers()).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT(r.cwiseAbs().maxCoeff(), 1e-7);  // N: 1e-15 of the tangent times the length
  EXPECT_EQ(f.system.energies(s).kinetic, 0.0);
  EXPECT_LT(f.system.energies(s).strain, 1e-20);

  State later = s;
  f.system.set_time(later, 3.0);
  ASSERT_EQ(later.signals.size(), 1U);
  // the rate law integrated: 0.3 (t - (6/pi) sin(pi t/6))
  EXPECT_NEAR(later.signals[0].f, 0.3 * (3 - 6 / std::numbers::pi), 1e-15);
  EXPECT_NEAR(later.signals[0].fdot, 0.3, 1e-15);
  EXPECT_NEAR(later.signals[0].fddot, 0.05 * std::numbers::pi, 1e-15);
}

TEST(System, ResidualIsTheSameWithAndWithoutTangent) {
  const FourBar f;
  Rng rng(61);
  test::DenseSolver dense;
  dense.analyze(f.system.graph());
  const auto klu = make_klu_solver();
  klu->analyze(f.system.graph());
  for (int i = 0; i < 5; ++i) {
    const State s = f.random_state(rng);
    VecX without, with, with_klu = VecX::Constant(3, 7.0);  // neither size nor values matter
    EXPECT_TRUE(f.system.residual(s, without));
    EXPECT_TRUE(f.system.linearize(s, {2.0, 3.0, 4.0, {}}, with, dense));
    EXPECT_TRUE(f.system.linearize(s, {}, with_klu, *klu));
    EXPECT_EQ(without.size(), f.system.rows());
    EXPECT_TRUE((without.array() == with.array()).all());
    EXPECT_TRUE((without.array() == with_klu.array()).all());
    // assembled twice is not assembled double
    const MatrixXd once = dense.matrix();
    f.system.linearize(s, {2.0, 3.0, 4.0, {}}, with, dense);
    EXPECT_TRUE((once.array() == dense.matrix().array()).all());
  }
}

// S = [ U K + (V C + A M) T_inv, B^T ; B, 0 ], each part by differences of order 8: 1e-10 of the part's
// largest entry, moments and rotations scaled by the distance between nodes.
TEST(System, TangentIsTheDerivative) {
  const FourBar f;
  Rng rng(62);
  const State s = f.random_state(rng);
  const Index n = f.dynamic_rows(), m = f.system.multipliers();

  std::vector<Mat6> T_inv{Mat6::Identity()};
  MatrixXd T = MatrixXd::Zero(n, n);
  for (Index k = 0; k < n; k += 6) {
    Vec6 Q = test::random_vector<6>(rng, 0.5);
    Q.head<3>() *= FourBar::length;
    T_inv.push_back(T_inverse(Q).matrix());
    T.block<6, 6>(k, k) = T_inv.back();
  }

  MatrixXd by_pose = f.pose_difference(s);
  for (Index c = 0; c < n; ++c)
    if (c % 6 < 3) by_pose.col(c) /= FourBar::length;
  // quadratic in V and linear in Vdot: large steps, so that these terms stand out from the elastic ones
  const MatrixXd by_V = f.difference(s, n, 3e3, [](State& x, Index c, double h) {
    x.V[static_cast<std::size_t>(1 + c / 6)](c % 6) += h;
  });
  const MatrixXd by_Vdot = f.difference(s, n, 1e8, [](State& x, Index c, double h) {
    x.Vdot[static_cast<std::size_t>(1 + c / 6)](c % 6) += h;
  });
  const MatrixXd by_lambda =
      f.difference(s, m, 1e4, [](State& x, Index c, double h) { x.lambda(c) += h; });
  EXPECT_LT(by_V.bottomRows(m).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT(by_lambda.bottomRows(m).cwiseAbs().maxCoeff(), 1e-16);

  Worst B("B", 1e-10), Bt("Bt", 1e-10);
  const auto part = [&](double U, double V, double A, bool with_T, const MatrixXd& want) {
    TangentWeights w;
    w.U = U;
    w.V = V;
    w.A = A;
    if (with_T) w.T_inv = T_inv;
    const MatrixXd S = f.tangent(s, w);
    B.add(f.error(S.bottomLeftCorner(m, n), by_pose.bottomRows(m)));
    Bt.add(f.error(S.topRightCorner(n, m), by_lambda.topRows(n)));
    EXPECT_TRUE(S.bottomRightCorner(m, m).isZero(0.0));
    return f.error(S.topLeftCorner(n, n), want);
  };
  const MatrixXd K = by_pose.topRows(n), C = by_V.topRows(n), M = by_Vdot.topRows(n);
  const auto report = [&](const char* name, double e) {
    EXPECT_LT(e, 1e-10) << name;
    this->RecordProperty(name, testing::PrintToString(e));
  };
  report("U", part(1, 0, 0, true, K));
  report("V", part(0, 1, 0, false, C));
  report("A", part(0, 0, 1, false, M));
  report("V_T_inv", part(0, 1, 0, true, C * T));
  report("A_T_inv", part(0, 0, 1, true, M * T));
  const double h = 1e-2;  // all at once, none negligible
  report("together", part(h * h * h, 0.7, 300, true, h * h * h * K + (0.7 * C + 300 * M) * T));

  // what the comparison would not miss: joints' geometric stiffness, gyroscopic terms, T_inv
  State mutant = s;
  mutant.lambda.setZero();
  EXPECT_GT(f.error(f.tangent(mutant, {}).topLeftCorner(n, n), K), 1e-6);
  EXPECT_GT(part(0, 1, 0, true, C), 1e-3);
  EXPECT_GT(f.size(C), 0.0);
}

// Every model of the repository, perturbed: the residual to the last bit, and the derivative of the residual
// along a random direction against the tangent, row by row relative to its terms, order 8: 1e-9.
TEST(System, ResidualAndTangentOfEveryModel) {
  Rng rng(68);
  Worst error("error", 1e-9);
  for (const auto& file :
       std::filesystem::directory_iterator(std::string(MBD_SOURCE_DIR) + "/models")) {
    if (file.path().extension() != ".xml") continue;
    const Model model = compile(read_model(file.path()));
    const System& system = *model.system;
    const std::string name = file.path().filename().string();
    State s = system.reference_state();
    const double length = 1e-3 * system.length_scale();
    std::vector<Vec6> U(s.pose.size(), Vec6::Zero());
    for (std::size_t n = 1; n < s.pose.size(); ++n) {
      const auto random = [&](double bound) {
        Vec6 x = test::random_vector<6>(rng, bound);
        x.head<3>() *= length;
        return x;
      };
      U[n] = random(1.0);
      s.pose[n] = s.pose[n] * exp_se3<double>(random(0.03));
      if (!system.with_rates()) continue;
      s.V[n] = random(10.0);
      s.Vdot[n] = random(100.0);
    }
    const VecX mu =
        VecX::NullaryExpr(system.multipliers(), [&] { return test::uniform(rng, -100, 100); });
    s.lambda =
        VecX::NullaryExpr(system.multipliers(), [&] { return test::uniform(rng, -100, 100); });
    system.set_time(s, 0.2);

    const auto klu = make_klu_solver();
    klu->analyze(system.graph());
    test::DenseSolver dense;
    dense.analyze(system.graph());
    VecX without, with, with_klu;
    EXPECT_TRUE(system.residual(s, without)) << name;
    EXPECT_TRUE(system.linearize(s, {}, with, dense));
    EXPECT_TRUE(system.linearize(s, {}, with_klu, *klu));
    EXPECT_TRUE((without.array() == with.array()).all()) << name;
    EXPECT_TRUE((without.array() == with_klu.array()).all()) << name;

    VecX x(system.unknowns());
    for (std::size_t n = 1; n < U.size(); ++n) x.segment<6>(6 * static_cast<Index>(n - 1)) = U[n];
    x.tail(mu.size()) = mu;
    const VecX difference = test::first_difference(
        [&](double h) {
          State moved = s;
          for (std::size_t n = 1; n < U.size(); ++n)
            moved.pose[n] = s.pose[n] * exp_se3<double>(h * U[n]);
          moved.lambda += h * mu;
          VecX r;
          system.residual(moved, r);
          return VecX(r.tail(system.unknowns()));
        },
        0.01);
    const VecX terms = dense.matrix().cwiseAbs() * x.cwiseAbs();
    for (Index i = 0; i < terms.size(); ++i) {
      if (terms(i) > 0.0)
        error.add(std::abs(difference(i) - dense.matrix().row(i) * x) / terms(i), name);
      else
        EXPECT_EQ(difference(i), 0.0) << name << ", " << system.name_of(6 + i);
    }
  }
}

// The wrenches on all nodes, the ground among them, are in equilibrium: at rest no force comes from outside.
TEST(System, InternalForcesAreSelfEquilibrated) {
  const FourBar f;
  Rng rng(63);
  Worst error("error", 256 * eps);
  for (int i = 0; i < 5; ++i) {
    State s = f.random_state(rng);
    for (std::size_t n = 1; n < s.V.size(); ++n) {
      s.V[n].setZero();
      s.Vdot[n].setZero();
    }
    VecX r;
    f.system.residual(s, r);
    Vec6 sum = Vec6::Zero();
    double gross = 0;
    for (std::size_t n = 0; n < s.pose.size(); ++n) {
      const Vec6 F = r.segment<6>(6 * static_cast<Index>(n));
      const Vec3 force = s.pose[n].p * Vec3(linear(F)), moment = s.pose[n].p * Vec3(angular(F));
      sum += six<double>(force, moment + s.pose[n].r.cross(force));
      gross += force.norm();
    }
    EXPECT_GT(r.head<6>().norm(), 1.0) << "the ground bears nothing";
    error.add(sum.cwiseAbs().maxCoeff() / gross);
  }
}

// d(T + phi)/dt + lambda.(B V) = r.V along any motion, differences of order 8: 1e-9.
TEST(System, PowerBalance) {
  const FourBar f;
  Rng rng(64);
  Worst error("error", 1e-9);
  for (int i = 0; i < 5; ++i) {
    const State s = f.random_state(rng);
    const auto energy = [&](double tau) {
      State moved = s;
      for (std::size_t n = 1; n < s.pose.size(); ++n) {
        moved.pose[n] = s.pose[n] * exp_se3<double>(tau * s.V[n]);
        moved.V[n] += tau * s.Vdot[n];
      }
      return Matrix<double, 1, 1>(f.system.energies(moved).total());
    };
    VecX gdot, g_t, rest;
    f.system.constraint_rates(s, gdot, rest);
    State at_rest = s;
    for (auto& V : at_rest.V) V.setZero();
    f.system.constraint_rates(at_rest, g_t, rest);
    const VecX r = f.residual(s);
    double power = 0, gross = 0;
    for (std::size_t n = 1; n < s.pose.size(); ++n) {
      const double one = r.segment<6>(6 * static_cast<Index>(n - 1)).dot(s.V[n]);
      power += one;
      gross += std::abs(one);
    }
    const double constraint = s.lambda.dot(gdot - g_t);
    const double rate = test::first_difference(energy, 2e-4)(0);
    error.add(std::abs(power - constraint - rate) / gross);
    EXPECT_GT(std::abs(1.1 * power - constraint - rate) / gross, 1e-6);
  }
}

// --- the linear solver ---

VecX solved(const LinearSolver& solver, VecX b) {
  solver.solve(std::span(b.data(), static_cast<std::size_t>(b.size())));
  return b;
}

TEST(System, KluSolvesAsDenseDoes) {
  const FourBar f;
  Rng rng(65);
  const auto klu = make_klu_solver();
  klu->analyze(f.system.graph());
  test::DenseSolver dense;
  dense.analyze(f.system.graph());
  Worst error("error", 1e-8), residual("residual", 1e-11);  // forward, of mixed units; backward
  // refactored with weights that are decades apart: dynamics of small and large steps, statics
  for (const double weight : {1e-6, 1e-3, 1.0, 1e-8, 1e-6}) {
    State s = f.random_state(rng);
    s.lambda *= 1e-3;
    TangentWeights w;
    w.U = weight;
    w.V = 0.1;
    w.A = weight < 1 ? 1.0 : 0.0;
    VecX r;
    f.system.linearize(s, w, r, *klu);
    f.system.linearize(s, w, r, dense);
    ASSERT_EQ(klu->factor(), FactorStatus::ok);
    ASSERT_EQ(dense.factor(), FactorStatus::ok);
    EXPECT_GT(klu->reciprocal_condition(), 0.0);
    // right-hand sides of the size of the rows, so that no unknown is lost beside others
    const VecX rows = dense.matrix().rowwise().norm();
    const VecX b = rows.cwiseProduct(
        VecX::NullaryExpr(rows.size(), [&] { return test::uniform(rng, -1, 1); }));
    const VecX x = solved(*klu, b), want = solved(dense, b);
    error.add((x - want).norm() / want.norm());
    const auto defect = [&](const VecX& y) {  // componentwise: of each row, relative to its terms
      const VecX terms = dense.matrix().cwiseAbs() * y.cwiseAbs() + b.cwiseAbs();
      return (dense.matrix() * y - b).cwiseQuotient(terms).cwiseAbs().maxCoeff();
    };
    residual.add(defect(x));
    EXPECT_GT(defect(1.1 * x), 1e-3);
  }
  EXPECT_GT(klu->nonzeros(), f.system.unknowns());
  EXPECT_LT(klu->nonzeros(), dense.nonzeros() / 4);
}

// A graph of blocks of sizes 6, 1, 5, places shared and places on the ground, against the same sums by hand.
TEST(System, SlotsAddUp) {
  BlockGraph graph;
  graph.blocks = {{6, BlockGraph::Kind::node},
                  {1, BlockGraph::Kind::multiplier},
                  {5, BlockGraph::Kind::multiplier}};
  const int first[] = {0, 6, 7}, size[] = {6, 1, 5};
  graph.contributions = {{0, 0}, {0, 1}, {1, 0}, {0, 0},   {-1, 0}, {0, -1},
                         {2, 0}, {0, 2}, {2, 2}, {-1, -1}, {1, 1}};
  Rng rng(66);
  const auto klu = make_klu_solver();
  klu->analyze(graph);
  for (int round = 0; round < 3; ++round) {
    klu->set_zero();
    MatrixXd want = MatrixXd::Zero(12, 12);
    for (std::size_t c = 0; c < graph.contributions.size(); ++c) {
      const auto [row, column] = graph.contributions[c];
      const int height = row < 0 ? 6 : size[row], width = column < 0 ? 6 : size[column];
      const Slot slot = klu->slots()[c];
      ASSERT_NE(slot.data, nullptr);
      for (int j = 0; j < width; ++j) {
        for (int i = 0; i < height; ++i) {
          const double x = test::uniform(rng, -1, 1);
          slot.data[i + j * slot.ld] += x;
          if (row >= 0 && column >= 0) want(first[row] + i, first[column] + j) += x;
        }
      }
    }
    ASSERT_EQ(klu->factor(), FactorStatus::ok);
    const VecX b = VecX::NullaryExpr(12, [&] { return test::uniform(rng, -1, 1); });
    EXPECT_LT((want * solved(*klu, b) - b).norm(), 1e-12);
    EXPECT_NEAR(std::log10(klu->reciprocal_condition() / test::dense::reciprocal_condition(want)),
                0.0, 1.5);
  }
}

// Two bodies, one of which has no inertia about its third axis.
struct Bodies {
  System system;
  explicit Bodies(double inertia) {
    auto mass = std::make_unique<ElementBatch<Mass>>("inertia", Mass::Shared{});
    Mat3 J = Mat3::Identity();
    mass->add({rigid_mass(2, Vec3(0.1, 0, 0), J)},
              std::array{static_cast<int>(system.add_node("body 'a'", {}))}, "a");
    J(2, 2) = inertia;
    mass->add({rigid_mass(2, Vec3::Zero(), J)},
              std::array{static_cast<int>(system.add_node("body 'b'", {}))}, "b");
    system.add_batch(std::move(mass));
    system.finish(true, 1.0);
  }
};

TEST(System, SingularityIsReportedByName) {
  const Bodies sick(0.0), sound(0.5);
  VecX r;
  TangentWeights w;
  w.U = 0;
  w.A = 1;
  for (const bool use_klu : {true, false}) {
    const std::unique_ptr<LinearSolver> solver =
        use_klu ? make_klu_solver() : std::make_unique<test::DenseSolver>();
    solver->analyze(sick.system.graph());
    sick.system.linearize(sick.system.reference_state(), w, r, *solver);
    EXPECT_EQ(solver->factor(), FactorStatus::singular);
    EXPECT_EQ(sick.system.name_of(6 + solver->singular_row()), "body 'b', moment 3");
    // the same solver recovers
    sound.system.linearize(sound.system.reference_state(), w, r, *solver);
    EXPECT_EQ(solver->factor(), FactorStatus::ok);
    EXPECT_NEAR(solved(*solver, VecX::Unit(12, 11))(11), 2.0, 1e-14);
    // and finds it again where a factorisation had gone well before
    sick.system.linearize(sick.system.reference_state(), w, r, *solver);
    EXPECT_EQ(solver->factor(), FactorStatus::singular);
    EXPECT_EQ(sick.system.name_of(6 + solver->singular_row()), "body 'b', moment 3");
  }
}

// The contract of LinearSolver: without a factorisation there is no solution, least of all a stale one.
TEST(System, SolverHasNoSolutionAfterASingularFactorisation) {
  const Bodies sick(0.0), sound(0.5);
  VecX r;
  TangentWeights w;
  w.U = 0;
  w.A = 1;
  const auto solver = make_klu_solver();
  solver->analyze(sound.system.graph());
  sound.system.linearize(sound.system.reference_state(), w, r, *solver);
  ASSERT_EQ(solver->factor(), FactorStatus::ok);
  sick.system.linearize(sick.system.reference_state(), w, r, *solver);
  ASSERT_EQ(solver->factor(), FactorStatus::singular);
  EXPECT_TRUE(std::isnan(solved(*solver, VecX::Unit(12, 11))(11)));
  EXPECT_EQ(solver->reciprocal_condition(), 0.0);
}

// A body fixed to the ground twice: rank lost by rounding or exactly, but not unnoticed.
TEST(System, RedundantConstraintsAreSingular) {
  Rng rng(67);
  System system;
  const Pose<double> H = test::random_pose(rng);
  const int node = static_cast<int>(system.add_node("body 'a'", H));
  auto mass = std::make_unique<ElementBatch<Mass>>("inertia", Mass::Shared{});
  mass->add({rigid_mass(2, Vec3(0.1, 0, 0), Mat3::Identity())}, std::array{node}, "a");
  system.add_batch(std::move(mass));
  auto joints = joint::make_joint_batch("fixed");
  for (const char* name : {"fixed 'one'", "fixed 'two'"}) {
    const Pose<double> at = test::random_pose(rng);
    const auto constraint = static_cast<Index>(system.constraints().size());
    const Index first = system.add_constraint(
        {name, 0, 6, {"1", "2", "3", "4", "5", "6"}, std::vector<bool>(6, false)});
    joints->add({.a = H * at, .b = at, .Q = node, .constraint = constraint, .multiplier = first});
  }
  system.add_batch(std::move(joints));
  system.finish(true, 1.0);
  TangentWeights w;
  w.A = 1;
  VecX r;
  const auto klu = make_klu_solver();
  klu->analyze(system.graph());
  system.linearize(system.reference_state(), w, r, *klu);
  const FactorStatus status = klu->factor();
  if (status == FactorStatus::ok) {
    EXPECT_LT(klu->reciprocal_condition(), 1e-13);
  } else {
    const std::string name = system.name_of(6 + klu->singular_row());
    EXPECT_TRUE(name.starts_with("fixed '") || name.starts_with("body 'a'")) << name;
  }
}

}  // namespace
