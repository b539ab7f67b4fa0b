// Runs in processes of their own: what they find is what a run finds, and whatever becomes of them is told.
#include "libmbd/study/trial/trial.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/machine.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_trial {
namespace {

// Shows rows at the same places as a trial of that many samples.
Table rows_of(Scene scene, int samples) {
  scene.transient->output = scene.transient->duration / samples;
  TableMaker maker(1);
  RunOptions options;
  options.observers = {&maker};
  EXPECT_TRUE(run(scene, options).complete());
  return maker.table;
}

TEST(Trial, FindsWhatARunFinds) {
  const Scene scene = model_scene("pendulum");
  const Trial trial = run_trial(scene, {.samples = 50, .repeats = 2, .repeat_within = 1e9});
  ASSERT_TRUE(trial.complete) << trial.failure;
  EXPECT_EQ(trial.repeats, 2);
  const Table rows = rows_of(scene, 50);
  ASSERT_EQ(trial.findings.at.size(), rows.columns[0].size());
  ASSERT_EQ(trial.findings.columns.size() + 1, rows.names.size());
  for (std::size_t k = 0; k < trial.findings.at.size(); ++k) {
    EXPECT_EQ(trial.findings.at[k], rows.columns[0][k]);
    for (std::size_t c = 0; c < trial.findings.columns.size(); ++c) {
      EXPECT_EQ(trial.findings.columns[c], rows.names[c + 1]);
      EXPECT_EQ(trial.findings.rows[k][c], rows.columns[c + 1][k]);  // to the last bit
    }
  }
  EXPECT_GT(trial.counters.steps, 0);
  EXPECT_GT(trial.counters.residuals, 0);
  EXPECT_GT(trial.memory, 1e4);
  EXPECT_GE(trial.cpu, trial.cpu_stepping);
}

// With a limit the kernel updates some clocks at its ticks alone, 4 ms apart and more: what stepping takes is still told,
// of a run of hundreds of them, of which reading and writing are little.
TEST(Trial, KnowsWhatSteppingTakesWithALimit) {
  Scene scene = model_scene("shaft");
  *scene.transient->step *= 0.02;
  const Trial trial = run_trial(scene, {.limit = 0.9 * no_limit, .repeats = 1});
  ASSERT_TRUE(trial.complete) << trial.failure;
  EXPECT_GT(trial.cpu_stepping, 0.1 * trial.cpu);  // half of it; less on a busy machine
}

TEST(Trial, OfLoadStepsFindsTheLastAndOfAPathItsSpecialPoints) {
  const Trial bend = run_trial(model_scene("bend45"), {.repeats = 1});
  ASSERT_TRUE(bend.complete) << bend.failure;
  EXPECT_EQ(bend.findings.at, std::vector{1.0});
  const Trial arch = run_trial(model_scene("shallow_arch"), {.repeats = 1});
  ASSERT_TRUE(arch.complete) << arch.failure;
  ASSERT_GE(arch.findings.at.size(), 2u);
  EXPECT_EQ(arch.findings.columns[0], "load_factor");
  for (const std::string& name : arch.findings.columns) EXPECT_NE(name, "arc_length");
}

TEST(Trial, ThatTakesTooLongIsStoppedAndKeepsWhatItFound) {
  Scene scene = model_scene("pendulum");
  scene.transient->duration = 1e4;
  // A row each step: more than ten of them in 0.2 s on any machine.
  const Trial trial = run_trial(scene, {.samples = 10'000'000, .limit = 0.2});
  EXPECT_FALSE(trial.complete);
  EXPECT_TRUE(trial.stopped);
  EXPECT_NE(trial.failure.find("more than 0.2 s"), std::string::npos) << trial.failure;
  EXPECT_GT(trial.findings.at.size(), 10u);
  EXPECT_LT(trial.findings.at.back(), 1e4);
}

TEST(Trial, OfAWrongSceneOrAFailingRunSaysWhy) {
  Scene wrong = model_scene("pendulum");
  wrong.bodies[0].mass = -1.0;
  const Trial refused = run_trial(wrong, {});
  EXPECT_FALSE(refused.complete);
  EXPECT_FALSE(refused.stopped);
  EXPECT_NE(refused.failure.find("mass"), std::string::npos) << refused.failure;

  Scene failing = model_scene("pendulum");  // by a column that is not finite from some time on
  failing.loads.push_back({});
  failing.loads.back().name = "load";
  failing.loads.back().at = {Place::Kind::body, "bob", 0.0};
  const auto zero = Expression::parse("0", {}, Variables::time);
  failing.loads.back().force = {Expression::parse("sqrt(1 - t)", {}, Variables::time), zero, zero};
  const Trial failed = run_trial(failing, {.repeats = 1});
  EXPECT_FALSE(failed.complete);
  EXPECT_FALSE(failed.stopped || failed.lost);
  EXPECT_FALSE(failed.failure.empty());
  EXPECT_GT(failed.findings.at.size(), 10u);
  EXPECT_LE(failed.findings.at.back(), 1.0);
}

// What the parent holds is not its.
TEST(Trial, CountsItsOwnMemory) {
  const Scene scene = model_scene("pendulum");
  const double before = run_trial(scene, {.repeats = 1}).memory;
  const std::vector<double> ballast(20'000'000 / sizeof(double), 1.0);
  const double after = run_trial(scene, {.repeats = 1}).memory;
  EXPECT_EQ(ballast.back(), 1.0);
  EXPECT_LT(std::abs(after - before), 5e6);
}

TEST(Trial, IsStoppedWhenInterrupted) {
  Scene scene = model_scene("pendulum");
  scene.transient->duration = 1e6;
  const std::atomic<bool> interrupted = true;
  const Trial trial = run_trial(scene, {.interrupted = &interrupted});
  EXPECT_FALSE(trial.complete);
}

TEST(Trial, AsTextIsTheSameToTheLastBit) {
  Trial trial;
  trial.complete = true;
  trial.cpu = 0.1;
  trial.cpu_stepping = 1.0 / 3.0;
  trial.repeats = 3;
  trial.memory = 12345678.0;
  trial.nodes = 4;
  trial.unknowns = 24;
  trial.multipliers = 11;
  trial.counters.steps = 7;
  trial.counters.factorizations = 9;
  trial.failure = "two\nlines";
  trial.findings = {{"a.x", "b"}, {"m", ""}, {0.0, 0.1}, {{1.0 / 7.0, -3e-300}, {1e300, 0.1}}};
  const std::string text = serialize(trial);
  const std::optional<Trial> back = deserialize(text);
  ASSERT_TRUE(back);
  EXPECT_EQ(serialize(*back), text);
  EXPECT_EQ(back->findings.rows, trial.findings.rows);
  EXPECT_EQ(back->findings.units, trial.findings.units);
  EXPECT_EQ(back->counters.factorizations, 9);
  EXPECT_EQ(back->failure, "two lines");
  for (std::size_t n = 0; n < text.size(); n += 3)
    EXPECT_FALSE(deserialize(text.substr(0, n))) << n;  // as a killed program leaves it
  EXPECT_TRUE(deserialize(serialize({})));
}

}  // namespace
}  // namespace mbd::test::test_trial
