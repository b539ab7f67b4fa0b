// What a run prints at its end: what there is to say, in 80 columns, and nothing of what there is not.

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>

#include "libmbd/results/summary.hpp"
#include "libmbd/run/run.hpp"
#include "tests/support/scenes.hpp"

namespace mbd::test::test_summary {
namespace {

// A transient run of which there is something to say in every line.
RunReport eventful() {
  RunReport report;
  report.model = "four_bar";
  report.statics = StaticScene{};
  report.transient = TransientScene{.duration = 36.0, .step = 9e-3, .rho_infinity = 0.9};
  report.t = 36.0;
  report.rows = 4001;
  report.static_counters = {.steps = 1, .iterations = 4, .tangents = 4, .factorizations = 4};
  report.most_static_iterations = 4;
  report.transient_counters = {.steps = 4000,
                               .substeps = 4012,
                               .retries = 3,
                               .tolerant = 1,
                               .restarts = 2,
                               .iterations = 10000,
                               .tangents = 700,
                               .factorizations = 699};
  report.most_iterations = 9;
  report.sampled_states = 200;
  report.position = {3e-13, 1.5, "revolute 'C', force 1"};
  report.velocity = {2e-9, 2.25, "revolute 'D', moment 2"};
  report.energy_start.kinetic = 10.0;
  report.energy_end.kinetic = 12.5;
  report.energy_least = 10.0;
  report.energy_most = 20.0;
  report.kinetic_most = 20.0;
  report.work = {1.5, 2.0};
  report.compile = {0.5, 0.25};
  report.equilibrium = {0.25, 0.25};
  report.integration = {4.0, 3.0};
  report.output = {0.25, 0.125};
  report.notes = {
      "the integrator took out much of the energy that moved; if it is not meant to, "
      "take smaller steps"};
  report.expects = {{{}, "C.displacement.1 at 1", 1.0, 1.25, 0.5, "calc"},
                    {{}, "C.displacement.2 at 36", 1.0, 2.0, 0.5, "calc"}};
  report.results = {"results/four_bar/history.csv", "results/four_bar/history.svg",
                    "results/four_bar/report.json"};
  return report;
}

void expect_width(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(line.size(), 80u) << line;
    EXPECT_FALSE(line.ends_with(' ')) << line;
  }
  EXPECT_TRUE(text.ends_with("\n"));
  EXPECT_EQ(text.find('\t'), std::string::npos);
}

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Summary, SaysAllOfAnEventfulRun) {
  EXPECT_EQ(summary(eventful()), R"(four_bar: 36 s simulated
static         1 load step; 4 iterations (4 a step, at most 4); 4 tangents,
               4 factorisations
transient      generalized_alpha, step 0.009 s; 4000 steps, 4012 substeps,
               3 retries, 2 restarts, 1 rank-tolerant step;
               10000 iterations (2.5 a step, at most 9); 700 tangents,
               699 factorisations
wall time      5 s: compile 0.5, static 0.25, transient 4, output 0.25
CPU time       3.62 s: compile 0.25, static 0.25, transient 3, output 0.12
largest residual of a constraint
  position     3e-13 m or rad, revolute 'C', force 1, at 1.5 s
  velocity     2e-09 m/s or rad/s, revolute 'D', moment 2, at 2.25 s
energy [J]
      10  at the start
  +  1.5  work of loads
  +    2  work of drives
  = 12.5  at the end
  +    1  taken out by the integrator, 5 % of the energy that moved
note: the integrator took out much of the energy that moved; if it is not meant
      to, take smaller steps
1 of 2 expectations met
      quantity                expected   got    error  allowed
ok    C.displacement.1 at 1          1  1.25  2.5e-01  5.0e-01
FAIL  C.displacement.2 at 36         1     2  1.0e+00  5.0e-01
results in results/four_bar
  history.csv  4001 rows: time and what is recorded
  history.svg  its plots, for a browser
  report.json  settings, counts, costs and checks of this run
)");
}

TEST(Summary, IsSilentAboutWhatDidNotHappen) {
  RunReport report = eventful();
  report.statics.reset();
  report.transient_counters.substeps = report.transient_counters.steps;
  report.transient_counters.retries = report.transient_counters.restarts = 0;
  report.transient_counters.tolerant = 0;
  report.position = report.velocity = {};
  report.work = {};
  report.notes.clear();
  report.expects.clear();
  report.results.clear();
  const std::string text = summary(report);
  for (const char* const word : {"static", "substep", "step sizes", "retr", "restart", "rank",
                                 "residual", "work", "note", "expect", "results", "history"})
    EXPECT_FALSE(says(text, word)) << word << " in\n" << text;
}

// What the integrator puts in stands where the sum is then right.
TEST(Summary, EnergyAddsUp) {
  RunReport report = eventful();
  report.energy_end.kinetic = 14.5;
  EXPECT_TRUE(says(summary(report),
                   "  +    1  put in by the integrator, 5 % of the energy that moved\n"
                   "  = 14.5  at the end\n"))
      << summary(report);
  report.energy_start = report.energy_end = {};  // nothing moves: no share of nothing
  report.work = {};
  report.kinetic_most = report.energy_least = report.energy_most = 0.0;
  EXPECT_FALSE(says(summary(report), "%")) << summary(report);
}

TEST(Summary, AFailedRunSaysHowFarItCameAndWhy) {
  RunReport report = eventful();
  report.t = 1.5;
  report.failure =
      "step 167 of 4000, the relative rotation of an element is out of range: beam "
      "'bar2' element 3; take smaller steps or more elements";
  report.expects[1].got.reset();
  const std::string text = summary(report);
  EXPECT_TRUE(text.starts_with("four_bar: FAILED at 1.5 s of 36 s: step 167 of 4000, the"));
  EXPECT_TRUE(says(text, "\nThe results up to there are kept.\n")) << text;
  EXPECT_TRUE(says(text, "not reached"));
  expect_width(text);
  report.results.clear();
  EXPECT_FALSE(says(summary(report), "kept"));
  report.transient.reset();
  report.load_factor = 0.25;
  EXPECT_TRUE(summary(report).starts_with("four_bar: FAILED at load factor 0.25: "));
}

TEST(Summary, LongQuantitiesFitOrStandAlone) {
  RunReport report = eventful();
  report.expects[0] = {
      {}, "middle.displacement_local.3 at 1.25", -0.12345678912, -0.123456781, 1.25e-10, "calc"};
  std::string text = summary(report);
  expect_width(text);
  EXPECT_FALSE(says(text, "expected")) << text;  // `got` and `error` say it
  EXPECT_TRUE(says(text, "ok  ") || says(text, "FAIL"));
  report.expects[0].what = std::string(70, 'q');
  text = summary(report);
  expect_width(text);
  EXPECT_TRUE(says(text, std::string(70, 'q') + "\n")) << text;
}

// Of models as they are.
TEST(Summary, IsAtMostEightyColumnsWide) {
  for (const char* const name :
       {"bend45", "shaft", "heavy_top", "portal_frame", "slider_crank", "cart_pole"}) {
    Scene scene =
        read_model(std::filesystem::path(MBD_SOURCE_DIR) / "models" / (std::string(name) + ".xml"));
    const RunReport report = run(scene);
    const std::string text = summary(report);
    SCOPED_TRACE(text);
    expect_width(text);
    EXPECT_TRUE(text.starts_with(std::string(name) + ": "));
    EXPECT_TRUE(says(text, "expectations met"));
    EXPECT_EQ(says(text, "load step"), scene.statics.has_value());
    EXPECT_GT(scene.statics ? report.most_static_iterations : report.most_iterations, 0);
  }
}

}  // namespace
}  // namespace mbd::test::test_summary
