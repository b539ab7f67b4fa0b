// Reactions that constraints share between them, in rows inside steps as at their ends; IDA on such loops.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "libmbd/core/se3.hpp"
#include "tests/support/landings.hpp"

namespace mbd::test::test_redundant_rows {
namespace {

// Bennett's linkage: four hinges that close by their lengths a, b and twists alpha, beta with
// sin(alpha)/a = sin(beta)/b, and tan(theta_1/2) tan(theta_2/2) = cos((beta+alpha)/2)/cos((beta-alpha)/2) or with
// sines; three constraints repeat others wherever it stands. Links by Denavit's and Hartenberg's parameters.
Scene bennett(double tolerance, const std::string& more) {
  const double a = 1.0, b = 1.5, alpha = 0.55, beta = std::asin(b * std::sin(alpha) / a),
               first = 0.9;
  const auto step = [](double theta, double along, double twist) {
    Vec6 turn = Vec6::Zero(), move = Vec6::Zero(), bend = Vec6::Zero();
    turn(5) = theta;
    move(0) = along;
    bend(3) = twist;
    return Pose<double>(exp_se3<double>(turn) * exp_se3<double>(move) * exp_se3<double>(bend));
  };
  std::array<Vec3, 4> point, axis;
  double gap = 1.0;
  for (const double sign : {1.0, -1.0})
    for (const double ratio : {std::sin((beta + alpha) / 2) / std::sin((beta - alpha) / 2),
                               std::cos((beta + alpha) / 2) / std::cos((beta - alpha) / 2)}) {
      const double second = 2.0 * std::atan(sign * ratio / std::tan(first / 2));
      const double thetas[] = {first, second, -first, -second};
      Pose<double> H;
      std::array<Vec3, 4> p, z;
      for (std::size_t k = 0; k < 4; ++k) {
        p[k] = H.r;
        z[k] = H.R().col(2);
        H = H * step(thetas[k], k % 2 == 0 ? a : b, k % 2 == 0 ? alpha : beta);
      }
      const double open = H.r.norm() + (H.R() - Mat3::Identity()).norm();
      if (open < gap) {
        gap = open;
        point = p;
        axis = z;
      }
    }
  EXPECT_LT(gap, 1e-14);
  const auto words = [](const Vec3& v) { return fmt::format("{} {} {}", v(0), v(1), v(2)); };
  std::string items;
  for (std::size_t k = 0; k < 3; ++k)
    items += fmt::format(R"(<body name="l{}" at="{}" mass="{}" inertia="0.1 0.2 0.15"/>)", k,
                         words(0.5 * (point[k] + point[k + 1])), 1.0 + double(k));
  const char* const ends[] = {"ground", "l0", "l1", "l2", "ground"};
  for (std::size_t k = 0; k < 4; ++k)
    items += fmt::format(
        R"(<revolute name="J{0}" between="{1} {2}" at="{3}" axis="{4}"/>
           <record name="J{0}" joint="J{0}" quantities="reaction_force reaction_moment"/>)",
        k, ends[k], ends[k + 1], words(point[k]), words(axis[k]));
  return scene_of(items + fmt::format(R"(<record name="l1" at="l1" quantities="position"/>
      <gravity acceleration="0 -9.81 0"/><transient duration="4" tolerance="{}" {}/>)",
                                      tolerance, more));
}

// Largest difference of vectors of reactions in rows, over the largest reaction.
double difference(const Table& a, const Table& b, const std::string& what) {
  double worst = 0.0, size = 0.0;
  for (int joint = 0; joint < 4; ++joint) {
    for (std::size_t k = 0; k < b.rows(); ++k) {
      Vec3 d, x;
      for (int i = 0; i < 3; ++i) {
        const std::string name = fmt::format("J{}.{}.{}", joint, what, i + 1);
        d(i) = a[name][k] - b[name][k];
        x(i) = b[name][k];
      }
      worst = std::max(worst, d.norm());
      size = std::max(size, x.norm());
    }
  }
  return worst / size;
}

// Against steps a thousand times finer, where the rows end with the steps but for 1e-9.
// Of five and seven stages steps are so long that idle rows open within them: some are rank-tolerant.
// Mutations: minimum_norm() without null_of_idle(): 0.6 to 6 at every tolerance; multipliers of stages interpolated as they are: 0.66
// of seven stages; find_redundancy() at the end of rank-tolerant steps as if they were on the constraints: 0.05 of five.
TEST(RedundantRows, ReactionsInsideStepsAreThoseOfLeastNorm) {
  const auto table = [](double tolerance, int stages) {
    const History history = run_to_table(
        bennett(tolerance, fmt::format(R"(method="radau" stages="{}" output="0.02")", stages)));
    EXPECT_EQ(history.report.failure, "");
    EXPECT_EQ(history.report.redundant.empty(), false);
    return history.table;
  };
  const Table exact = table(1e-9, 3);
  for (const int stages : {3, 5, 7}) {
    double before = 1.0;
    for (const auto& [tolerance, bound] : {std::pair{1e-3, 0.03}, {1e-4, 0.012}, {1e-5, 3e-3}}) {
      const Table rows = table(tolerance, stages);
      const double force = difference(rows, exact, "reaction_force");
      const double moment = difference(rows, exact, "reaction_moment");
      RecordProperty(fmt::format("stages_{}_tolerance_{:g}", stages, tolerance),
                     fmt::format("{:.2g} {:.2g}", force, moment));
      EXPECT_LT(force, bound) << tolerance << " " << stages;
      EXPECT_LT(moment, bound) << tolerance << " " << stages;
      EXPECT_LT(std::max(force, moment), before) << tolerance << " " << stages;
      before = std::max(force, moment);
    }
  }
}

// Bricard's linkage, of which one row is idle, by more stages: the motion against published numbers (models/hard/bricard.xml),
// reactions in rows inside steps against those of three stages in far shorter ones.
TEST(RedundantRows, OfBricardsLinkageByMoreStages) {
  const auto table = [](double tolerance, StageCount stages) {
    Scene scene = model_scene("hard/bricard");
    scene.transient->tolerance = tolerance;
    scene.transient->stages = stages;
    const History history = run_to_table(scene);
    EXPECT_EQ(history.report.failure, "");
    EXPECT_EQ(history.report.redundant.size(), 1u);
    return history.table;
  };
  const Table exact = table(1e-10, StageCount::three);
  for (const StageCount stages : {StageCount::five, StageCount::seven}) {
    const Table rows = table(1e-8, stages);
    const std::pair<std::size_t, Vec3> known[] = {{20, {.5105014612, -1.6491675994, .1401231146}},
                                                  {40, {-.9693403448, -1.2212468950, .7542780108}},
                                                  {200, {.9999999638, -1.0002690127, .9997309511}}};
    double worst = 0.0;
    for (const auto& [row, p] : known)
      for (int i = 0; i < 3; ++i)
        worst = std::max(worst, std::abs(rows[fmt::format("P3.position.{}", i + 1)][row] - p(i)));
    EXPECT_LT(worst, 1e-7);
    double difference = 0.0, size = 0.0;
    for (std::size_t k = 0; k < exact.rows(); ++k)
      for (int i = 1; i <= 3; ++i) {
        const std::string name = fmt::format("P5.reaction_force.{}", i);
        difference = std::max(difference, std::abs(rows[name][k] - exact[name][k]));
        size = std::max(size, std::abs(exact[name][k]));
      }
    RecordProperty(std::string(name_of(stages)),
                   fmt::format("{:.2g} {:.2g}", worst, difference / size));
    EXPECT_LT(difference, 1e-3 * size);
  }
}

// The same in the rows of steps and inside them, of one run: nothing but the row's place differs.
TEST(RedundantRows, AreThoseAtStepsNearby) {
  const History steps = run_to_table(bennett(1e-4, R"(method="radau" output="steps")"));
  const History rows = run_to_table(bennett(1e-4, R"(method="radau" output="0.01")"));
  const auto largest = [](const Table& t) {
    double most = 0.0;
    for (int i = 1; i <= 3; ++i)
      for (const double x : t[fmt::format("J1.reaction_moment.{}", i)])
        most = std::max(most, std::abs(x));
    return most;
  };
  EXPECT_LT(largest(rows.table), 1.1 * largest(steps.table));
}

// Mutation: step() of Ida without its second try, and without what is tolerated: ends with "contradict each other".
TEST(RedundantRows, IdaFollowsLoops) {
  const auto table = [](const std::string& method, double tolerance) {
    const History history =
        run_to_table(bennett(tolerance, fmt::format(R"(method="{}" output="0.1")", method)));
    EXPECT_EQ(history.report.failure, "") << method << " " << tolerance;
    return history.table;
  };
  const Table exact = table("radau", 1e-10);
  for (const double tolerance : {1e-4, 1e-6, 1e-7, 1e-8, 1e-9}) {
    const Table rows = table("ida", tolerance);
    ASSERT_EQ(rows.rows(), exact.rows());
    for (std::size_t k = 0; k < exact.rows(); ++k)
      for (int i = 1; i <= 3; ++i) {
        const std::string name = fmt::format("l1.position.{}", i);
        ASSERT_NEAR(rows[name][k], exact[name][k], 300.0 * tolerance) << tolerance << " " << k;
      }
  }
}

}  // namespace
}  // namespace mbd::test::test_redundant_rows
