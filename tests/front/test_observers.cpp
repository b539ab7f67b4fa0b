// History files, reports and files as such: what is written can be read back, and what cannot be
// written is said.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "libmbd/language/reader.hpp"
#include "libmbd/results/expect.hpp"
#include "libmbd/results/observers.hpp"
#include "libmbd/results/report.hpp"
#include "libmbd/results/summary.hpp"
#include "libmbd/run/run.hpp"
#include "tests/support/temporary_directory.hpp"

namespace mbd::test::test_observers {
namespace {

namespace fs = std::filesystem;

class Files : public testing::Test {
 protected:
  static std::string read(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }

  const TemporaryDirectory scratch_;
  const fs::path directory_ = scratch_.path();
};

using HistoryFile = Files;
using WrittenFile = Files;

const std::vector<Column> three = {{"time", "s"}, {"C.displacement.1", "m"}, {"A.angle", "rad"}};

TEST_F(HistoryFile, ReadsBackExactly) {
  const std::vector<std::vector<double>> rows = {{0.0, 1.0 / 3.0, -0.0},
                                                 {0.1, 1e-310, std::numeric_limits<double>::max()},
                                                 {0.1 + 0.2, -2.5e-7, 123456789.0}};
  const fs::path file = directory_ / "history.csv";
  {
    HistoryWriter writer(file, "test", three);
    for (const auto& row : rows) writer.write_row(row);
    writer.finished({});
    EXPECT_EQ(writer.rows(), 3);
  }
  std::istringstream text(read(file));
  std::string line;
  std::getline(text, line);
  EXPECT_EQ(line, "# model: test");
  std::getline(text, line);
  EXPECT_EQ(line, "# mbd " + std::string(version()));
  std::getline(text, line);
  EXPECT_EQ(line, "# units: s, m, rad");
  std::getline(text, line);
  EXPECT_EQ(line, "time,C.displacement.1,A.angle");
  for (const auto& row : rows) {
    std::getline(text, line);
    const char* at = line.c_str();
    for (const double value : row) {
      char* end = nullptr;
      EXPECT_EQ(std::strtod(at, &end), value);
      at = end + 1;
    }
  }
  EXPECT_FALSE(std::getline(text, line));
}

TEST_F(HistoryFile, IsWholeRowsAtAnyTime) {
  const fs::path file = directory_ / "history.csv";
  HistoryWriter writer(file, "test", three);
  EXPECT_TRUE(read(file).ends_with("A.angle\n"));  // the header is there at once
  std::size_t last = 0;
  for (int i = 0; i < 20000; ++i) {
    writer.write_row(std::vector<double>{1e-3 * i, std::sin(i), std::cos(i)});
    if (i % 1000 != 0) continue;
    const std::string text = read(file);
    EXPECT_EQ(text.back(), '\n');
    EXPECT_GE(text.size(), last);
    last = text.size();
  }
  EXPECT_GT(last, 500'000u);  // not kept in memory
}

// A link is replaced, not followed; what is no file is left alone. (A full disk: tests/front/test_faults.cpp.)
TEST_F(HistoryFile, TakesThePlaceOfALink) {
  const fs::path file = directory_ / "history.csv", other = directory_ / "mine";
  write_file(other, "mine\n");
  fs::create_symlink(other, file);
  { HistoryWriter writer(file, "test", three); }
  EXPECT_FALSE(fs::is_symlink(file));
  EXPECT_EQ(read(other), "mine\n");
  fs::create_directory(directory_ / "path.csv");
  EXPECT_THROW(HistoryWriter(directory_ / "path.csv", "test", three), Error);
}

TEST_F(WrittenFile, IsReplacedAsAWhole) {
  const fs::path file = directory_ / "report.json";
  write_file(file, "old");
  write_file(file, "new");
  EXPECT_EQ(read(file), "new");
  EXPECT_FALSE(fs::exists(directory_ / "report.json.part"));
  EXPECT_THROW(write_file(directory_ / "nowhere" / "report.json", "x"), Error);
}

TEST_F(WrittenFile, DirectoryMustBeUsable) {
  make_directory(directory_ / "a" / "b");
  EXPECT_TRUE(fs::is_directory(directory_ / "a" / "b"));
  make_directory(directory_ / "a" / "b");
  write_file(directory_ / "file", "x");
  EXPECT_THROW(make_directory(directory_ / "file"), Error);
  EXPECT_THROW(make_directory(directory_ / "file" / "below"), Error);
}

TEST(Report, IsJsonAndTellsTheFailure) {
  RunReport report;
  report.model = "a \"name\" \xff";  // not UTF-8
  report.transient = TransientScene{.duration = 1.0, .step = 0.1, .rho_infinity = 0.9};
  report.batches = {{"revolute", 3, 100}};
  report.expects = {{{}, "C.x at 1", 1.0, 1.05, 0.1, "calc"},
                    {{}, "C.y at 1", 1.0, std::nullopt, 0.1, "calc"}};
  EXPECT_TRUE(report.expects[0].pass());
  EXPECT_FALSE(report.expects[1].pass());
  EXPECT_FALSE(report.as_expected());
  nlohmann::json json = nlohmann::json::parse(to_json(report));
  EXPECT_EQ(json["status"], "complete, not as expected");
  EXPECT_TRUE(json["failure"].is_null());
  EXPECT_EQ(json["settings"]["transient"]["step"], 0.1);
  EXPECT_EQ(json["counts"]["batches"][0]["bytes"], 100);
  EXPECT_EQ(json["expectations"][0]["got"], 1.05);
  EXPECT_TRUE(json["expectations"][1]["got"].is_null());
  report.failure = "step 3 of 10: …";
  json = nlohmann::json::parse(to_json(report));
  EXPECT_EQ(json["status"], "failed");
  EXPECT_EQ(json["failure"], "step 3 of 10: …");
}

TEST(Report, NothingPassesThatIsNotANumber) {
  const ExpectResult result{{}, "q", 1.0, std::numeric_limits<double>::quiet_NaN(), 1.0, ""};
  EXPECT_FALSE(result.pass());
}

TEST(Run, DurationIsAWholeNumberOfSteps) {
  EXPECT_EQ(number_of_steps({.duration = 36.0, .step = 9e-3}), 4000);
  EXPECT_EQ(number_of_steps({.duration = 1.0, .step = 0.1}), 10);
  EXPECT_EQ(number_of_steps({.duration = 0.3, .step = 0.1}), 3);
  for (const auto& [duration, step] :
       {std::pair{1.0, 0.3}, {1.0, 2.0}, {1.0, 1.00001}, {1.0, 1e-300}})
    EXPECT_THROW(number_of_steps({.duration = duration, .step = step}), Error)
        << duration << " " << step;
  try {
    number_of_steps({.source = {"m.xml", 7}, .duration = 1.0, .step = 0.3});
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "m.xml:7: transient: duration=1 is not a whole number of steps of 0.3 s; with "
                 "step=\"1/4\" it is, "
                 "or with duration=\"4*0.3\"");
  }
}

// ---- load steps as rows -----------------------------------------------------------------------

using LoadSteps = Files;

const std::string cantilever = R"(
      <section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="100"/>
        <mass per_length="1" inertia="1e-3 5e-4 5e-4"/></section>
      <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="2" order="3"/>
      <load at="b.end" force="0 0 -100"/>
      <record name="tip" at="b.end" quantities="displacement"/>)";
const std::string clamp = R"(<fixed name="clamp" between="ground b.start"/>)";

Scene static_scene(const std::string& more) {
  return read_model_text("<mbd name=\"cantilever\">" + cantilever + more + "</mbd>");
}

struct Rows : Observer {
  void accepted(const Sample& sample) override {
    rows.emplace_back(sample.row.begin(), sample.row.end());
    if (static_cast<long>(rows.size()) == most) throw Error("seen enough");
  }
  std::vector<std::vector<double>> rows;
  long most = -1;
};

TEST_F(LoadSteps, AreRowsFromTheReferenceToTheWholeLoad) {
  Rows rows;
  const Scene scene = static_scene(clamp + R"(<static steps="5"/>
      <expect quantity="tip.displacement.3" value="0" tolerance="1" source="calc"/>
      <expect quantity="tip.displacement.3" of="minimum" value="0" tolerance="1" source="calc"/>
      <expect quantity="tip.displacement.3" of="maximum" value="0" tolerance="1e-300" source="calc"/>
      <expect quantity="load_factor" of="minimum" value="0" tolerance="1e-300" source="calc"/>
      <expect quantity="load_factor" value="1" tolerance="1e-300" source="calc"/>)");
  const RunReport report = run(scene, {.output = directory_ / "out", .observers = {&rows}});
  ASSERT_TRUE(report.as_expected()) << summary(report);
  ASSERT_GE(rows.rows.size(), 3u);
  EXPECT_EQ(report.rows, report.static_counters.steps + 1);
  EXPECT_EQ(report.rows, static_cast<long>(rows.rows.size()));
  EXPECT_EQ(report.load_factor, 1.0);
  EXPECT_EQ(rows.rows[0], std::vector<double>(4, 0.0));
  EXPECT_NEAR(rows.rows[1][0], 0.2, 1e-15);
  EXPECT_EQ(rows.rows.back()[0], 1.0);
  for (std::size_t i = 1; i < rows.rows.size(); ++i) {
    EXPECT_GT(rows.rows[i][0], rows.rows[i - 1][0]);
    EXPECT_LT(rows.rows[i][3], rows.rows[i - 1][3]);
  }
  EXPECT_EQ(report.expects[0].got, rows.rows.back()[3]);  // the last row
  EXPECT_EQ(report.expects[1].got, rows.rows.back()[3]);  // of all rows
  EXPECT_EQ(report.energy_start.total(), 0.0);            // the reference state
  EXPECT_GT(report.energy_end.strain, 0.0);

  const std::string csv = read(directory_ / "out" / "history.csv");
  EXPECT_NE(csv.find("# units: 1, m, m, m\nload_factor,tip.displacement.1,"), std::string::npos)
      << csv;
  const std::string svg = read(directory_ / "out" / "history.svg");
  EXPECT_NE(svg.find(">load_factor<"), std::string::npos);
}

TEST_F(LoadSteps, PlotsAreOverTheFirstColumn) {
  Scene scene = static_scene(clamp + R"(<static/><plot y="tip.displacement.3"/>)");
  EXPECT_EQ(scene.plots[0].x, "");
  EXPECT_TRUE(run(scene, {.output = directory_ / "out"}).complete());
  EXPECT_NE(read(directory_ / "out" / "history.svg").find(">load_factor<"), std::string::npos);
  scene.plots[0].x = "time";
  EXPECT_THROW(run(scene, {.output = directory_ / "time"}), Error);
  EXPECT_FALSE(fs::exists(directory_ / "time"));
}

TEST_F(LoadSteps, OfATransientAreNoRows) {
  Rows rows;
  const RunReport report =
      run(static_scene(clamp + R"(<static steps="5"/><transient duration="2e-3" step="1e-3"/>)"),
          {.output = directory_ / "out", .observers = {&rows}});
  EXPECT_TRUE(report.complete()) << report.failure;
  ASSERT_EQ(rows.rows.size(), 3u);
  EXPECT_EQ(rows.rows[0][0], 0.0);
  EXPECT_LT(rows.rows[0][3], -0.1);  // in equilibrium
  EXPECT_NE(read(directory_ / "out" / "history.csv").find("\ntime,"), std::string::npos);
}

TEST_F(LoadSteps, KeepTheirRowsWhenTheRunEnds) {
  Rows rows;
  rows.most = 2;
  const RunReport report = run(
      static_scene(
          clamp +
          R"(<static steps="5"/><expect quantity="tip.displacement.3" value="0" tolerance="1" source="calc"/>)"),
      {.output = directory_ / "out", .observers = {&rows}});
  EXPECT_EQ(report.failure, "seen enough");
  EXPECT_EQ(rows.rows.size(), 2u);
  EXPECT_EQ(report.static_counters.steps, 1);  // no more of them were solved for
  EXPECT_FALSE(report.expects[0].got);
  EXPECT_NE(read(directory_ / "out" / "history.csv").find("\n0.2,"), std::string::npos);
  EXPECT_NE(read(directory_ / "out" / "report.json").find("seen enough"), std::string::npos);
}

// ---- runs that do not start -------------------------------------------------------------------

using NoStart = Files;

// Refused with the line of what was to be done; nothing is written, and what there was stays.
TEST_F(NoStart, LeavesEarlierResultsAlone) {
  const std::string transient = R"(<transient duration="1" step="0.1"/>)";
  for (const auto& [more, words] : {std::pair{std::string("\n<static/>"), ":7: static: "},
                                    {"\n<static/>" + transient, ":7: static: "}}) {
    for (const char* const name : {"history.csv", "history.svg", "report.json"})
      write_file(directory_ / name, "earlier");
    for (const fs::path& output : {directory_, directory_ / "new" / "below"}) {
      try {
        run(static_scene(more), {.output = output});
        ADD_FAILURE() << "no error: " << more;
      } catch (const Error& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find(words), std::string::npos) << text;
      }
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(directory_), {}), 3);
    for (const fs::directory_entry& entry : fs::directory_iterator(directory_))
      EXPECT_EQ(read(entry.path()), "earlier");
    EXPECT_THROW(run(static_scene(more)), Error);  // nor without results
  }
}

TEST_F(NoStart, PlacesForResultsAreCheckedAndLeftAsTheyWere) {
  write_file(directory_ / "file", "x");
  const Scene scene = static_scene("<static/>");  // would not start either
  for (const fs::path& output : {directory_ / "file", directory_ / "file" / "below",
                                 directory_ / "new" / std::string(300, 'a')}) {
    try {
      run(scene, {.output = output});
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("--out"), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(directory_), {}), 1);
}

TEST(Expectations, ColumnsAreFoundOrTheNearestIsNamed) {
  EXPECT_EQ(find_column(three, "A.angle", {}, "plot"), 2u);
  try {
    find_column(three, "A.angel", {"m.xml", 3}, "plot");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what())
                  .find("m.xml:3: plot: \"A.angel\" is not a column of the results; did you "
                        "mean \"A.angle\"?"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace mbd::test::test_observers
