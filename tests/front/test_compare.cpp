// Two runs against each other, and the commands plot and compare.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>

#include "libmbd/core/error.hpp"
#include "libmbd/pictures/compare.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_directory.hpp"

namespace mbd::test::test_compare {
namespace {

namespace fs = std::filesystem;
using mbd::History;
using test::contents;
using test::Ended;
using test::Program;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

History sampled(const std::string& name, std::size_t rows, double from, double step,
                const std::function<double(double)>& f) {
  History h;
  h.file = name + "/history.csv";
  h.columns = {{"time", "s"}, {"C.u.1", "m"}};
  h.values.resize(2);
  for (std::size_t i = 0; i < rows; ++i) {
    const double t = from + step * static_cast<double>(i);
    h.values[0].push_back(t);
    h.values[1].push_back(f(t));
    h.lines.push_back(static_cast<int>(i) + 2);
  }
  return h;
}

double cubic(double t) { return 1.0 - 2.0 * t + 3.0 * t * t - t * t * t; }

std::string refusal(const History& first, const History& second,
                    const std::vector<std::string>& names = {}) {
  try {
    compare(first, second, names);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Compare, NormsAtEqualTimesAreThoseByHand) {
  const History a = sampled("a", 4, 0.0, 1.0, [](double t) { return t - 4.0; });
  History b = a;
  b.file = "b/history.csv";
  b.values[1] = {-4.0, -2.0, -3.0, -1.0};  // differences 0, 1, -1, 0
  b.values[1][2] -= 1.0;                   // … -2
  const Comparison c = compare(a, b);
  ASSERT_EQ(c.columns.size(), 1u);
  EXPECT_EQ(c.samples, 4u);
  EXPECT_EQ(c.interpolated, 0u);
  EXPECT_NEAR(c.columns[0].rms, std::sqrt(5.0 / 4.0), 1e-15);
  EXPECT_EQ(c.columns[0].largest, 2.0);
  EXPECT_EQ(c.columns[0].at, 2.0);
  EXPECT_EQ(c.columns[0].scale, 4.0);
  EXPECT_NEAR(*c.columns[0].relative_rms(), std::sqrt(5.0) / 8.0, 1e-15);
  EXPECT_TRUE(c.columns[0].above(0.27));
  EXPECT_FALSE(c.columns[0].above(0.28));
  EXPECT_TRUE(contains(c.sampling, "at the 4 samples that both have, time from 0 to 3 s"))
      << c.sampling;
}

TEST(Compare, InterpolatesTheFinerByACubic) {
  const History coarse = sampled("coarse", 8, 0.0, 0.31, cubic);
  const History fine = sampled("fine", 40, -0.2, 0.05, cubic);  // to 1.75
  for (const bool swap : {false, true}) {
    const Comparison c = swap ? compare(fine, coarse) : compare(coarse, fine);
    EXPECT_EQ(c.samples, 6u);  // 0 … 1.55
    EXPECT_EQ(c.interpolated, 4u) << "0 and 1.55 are samples of both";
    EXPECT_EQ(c.from, 0.0);
    EXPECT_NEAR(c.to, 1.75, 1e-12);
    EXPECT_LT(c.columns[0].largest, 1e-14);
    EXPECT_TRUE(contains(c.sampling, "of coarse, the coarser")) << c.sampling;
    EXPECT_TRUE(contains(c.sampling,
                         "fine has no sample at 4 of them and is interpolated there by "
                         "the cubic through 4 neighbouring samples"))
        << c.sampling;
  }
  // fourth order: a sixteenth of the error at half the step
  const auto wave = [](double t) { return std::sin(3.0 * t); };
  const auto error = [&](double step) {
    const auto rows = static_cast<std::size_t>(std::lround(4.0 / step)) + 1;
    return compare(sampled("a", 13, 0.0, 0.317, wave), sampled("b", rows, 0.0, step, wave))
        .columns[0]
        .rms;
  };
  const double order = std::log2(error(0.05) / error(0.025));
  EXPECT_GT(order, 3.3);
  EXPECT_LT(order, 4.7);
}

TEST(Compare, ZeroColumnsHaveNoRelativeDifference) {
  const History zero = sampled("a", 3, 0.0, 1.0, [](double) { return 0.0; });
  const History other = sampled("b", 3, 0.0, 1.0, [](double) { return 1e-20; });
  EXPECT_EQ(compare(zero, zero).columns[0].relative_rms(), 0.0);
  const Comparison c = compare(zero, other);
  EXPECT_FALSE(c.columns[0].relative_rms());
  EXPECT_TRUE(c.columns[0].above(1e6));
  EXPECT_NEAR(c.columns[0].rms, 1e-20, 1e-34);
  EXPECT_TRUE(contains(to_text(c, zero, other), "the quantity is zero in a"));
}

TEST(Compare, ListsColumnsOfOneAndRefusesWhatCannotBeCompared) {
  const History a = sampled("a", 3, 0.0, 1.0, cubic);
  History b = a;
  b.file = "b/history.csv";
  b.columns.push_back({"D.u.1", "m"});
  b.values.push_back({1.0, 2.0, 3.0});
  EXPECT_EQ(compare(a, b).only_second, std::vector<std::string>{"D.u.1"});
  EXPECT_EQ(compare(b, a).only_first, std::vector<std::string>{"D.u.1"});
  EXPECT_TRUE(compare(a, b, std::vector<std::string>{"C"}).only_second.empty());
  EXPECT_TRUE(contains(refusal(a, b, {"D"}), "has no column to compare"));
  EXPECT_TRUE(contains(refusal(a, b, {"E"}), "\"E\" is not a record"));

  EXPECT_TRUE(contains(refusal(a, sampled("c", 3, 5.0, 1.0, cubic)), "no sample in common"));
  History c = a;
  c.values[0][2] = 1.0;
  EXPECT_TRUE(contains(refusal(a, c), "a/history.csv:4: \"time\" is 1 after 1")) << refusal(a, c);
  c = a;
  c.columns[1].unit = "mm";
  EXPECT_TRUE(contains(refusal(a, c), "is in [m], in a/history.csv it is in [mm]"));
  c = a;
  c.columns[0].name = "s";
  EXPECT_TRUE(contains(refusal(a, c), "the first column is \"time\""));
}

TEST(Compare, NamesAreTheShortestThatDiffer) {
  const auto names = [](const std::string& a, const std::string& b) {
    History first, second;
    first.file = a;
    second.file = b;
    return short_names(first, second);
  };
  using Two = std::array<std::string, 2>;
  EXPECT_EQ(names("r/a/history.csv", "r/b/history.csv"), (Two{"a", "b"}));
  EXPECT_EQ(names("r/a/history.csv", "s/a/history.csv"), (Two{"r/a", "s/a"}));
  EXPECT_EQ(names("a.csv", "b.csv"), (Two{"a.csv", "b.csv"}));
  EXPECT_EQ(names("a/history.csv", "a/history.csv"), (Two{"a", "second"}));
}

class ResultsCommands : public ::testing::Test {
 protected:
  void SetUp() override {
    write("a", "0,1,5\n1,2,5\n2,4,5\n");
    write("b", "0,1,5\n1,2.04,5\n2,4,5\n");
  }
  void write(const std::string& name, const std::string& rows) {
    fs::create_directories(directory_ / name);
    std::ofstream(directory_ / name / "history.csv")
        << "# mbd 0\n# units: s, m, N\ntime,C.displacement.1,C.force.1\n"
        << rows;
  }
  std::string at(const std::string& name) { return (directory_ / name).string(); }
  Ended run(const std::vector<std::string>& arguments) {
    return Program(arguments, directory_ / "scratch").wait();
  }

  const TemporaryDirectory scratch_;
  const fs::path directory_ = scratch_.path();
};

TEST_F(ResultsCommands, PlotDrawsWhatIsNamed) {
  Ended ended = run({"plot", at("a")});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.out, "wrote " + at("a/plot.svg") + "\n");
  std::string svg = contents(at("a/plot.svg"));
  EXPECT_TRUE(contains(svg, ">C.displacement.1 [m]<") && contains(svg, ">C.force.1 [N]<"));
  EXPECT_TRUE(contains(svg, ">time [s]<"));

  ended = run({"plot", at("a"), "C.displacement", "--x", "C.force.1", "--title", "A < B", "--out",
               at("x.svg")});
  EXPECT_EQ(ended.status, 0) << ended.err;
  svg = contents(at("x.svg"));
  EXPECT_TRUE(contains(svg, ">C.displacement.1 [m]<") && contains(svg, ">C.force.1 [N]<"));
  EXPECT_FALSE(contains(svg, ">time [s]<"));
  EXPECT_TRUE(contains(svg, ">A &lt; B<"));
}

TEST_F(ResultsCommands, WrongPlotsAreErrorsAndWriteNothing) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong = {
      {{"plot", at("none")}, "no such file or directory"},
      {{"plot", at("a"), "C.dispalcement"}, "did you mean \"C.displacement\"?"},
      {{"plot", at("a"), "tipp"}, "The records are: C\n"},
      {{"plot", at("a"), "--x", "tme"}, "did you mean \"time\"?"},
      {{"plot", at("a"), "--out", at("a/history.csv")}, "ends in .svg"},
      {{"plot", at("a"), "--out", at("none/a.svg")}, "there is no directory"},
      {{"compare", at("a"), at("b"), "--tolerance", "-1"}, "--tolerance is -1"},
      {{"compare", at("a"), at("none")}, "no such file or directory"},
      {{"compare", at("a"), at("b"), "--out", at("none/a.svg")}, "there is no directory"}};
  for (const auto& [arguments, what] : wrong) {
    const Ended ended = run(arguments);
    EXPECT_EQ(ended.status, 1) << what;
    EXPECT_TRUE(contains(ended.err, what)) << ended.err;
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_EQ(ended.out, "");
  }
  for (const auto& entry : fs::recursive_directory_iterator(directory_))
    EXPECT_NE(entry.path().extension(), ".svg") << entry.path();
}

TEST_F(ResultsCommands, CompareSaysHowAndExitsByTolerance) {
  Ended ended = run({"compare", at("a"), at("b")});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(contains(ended.out, "b - a, at the 3 samples that both have")) << ended.out;
  EXPECT_TRUE(contains(ended.out, "component of the quantity in all of a"));
  EXPECT_TRUE(contains(ended.out, "5.77e-03  1.00e-02")) << ended.out;  // 0.04/√3/4, 0.04/4
  const std::string svg = contents(at("b/compare.svg"));
  EXPECT_TRUE(contains(svg, ">a (broad) and b (thin)<")) << svg;
  EXPECT_TRUE(contains(svg, "stroke-opacity"));  // the first run, told from the second in grey

  EXPECT_EQ(run({"compare", at("a"), at("b"), "--tolerance", "6e-3"}).status, 0);
  EXPECT_EQ(run({"compare", at("a"), at("b"), "--tolerance", "5e-3"}).status, 2);
  EXPECT_EQ(run({"compare", at("a"), at("b"), "C.force", "--tolerance", "0"}).status, 0);
}

// Of two runs with two components: a legend of two entries, one row above the axes.
TEST(Compare, LegendNamesEachComponentOnce) {
  History a = sampled("a", 100, 0.0, 0.1, [](double t) { return std::sin(t); });
  a.columns.push_back({"C.u.2", "m"});
  a.values.push_back(a.values[1]);
  History b = a;
  b.file = "b/history.csv";
  const std::string svg = overlay_svg(compare(a, b), a, b);
  for (const std::string name : {">C.u.1<", ">C.u.2<"}) {
    const std::size_t first = svg.find(name);
    ASSERT_NE(first, std::string::npos) << name;
    EXPECT_EQ(svg.find(name, first + 1), std::string::npos) << name;
  }
  EXPECT_TRUE(contains(svg, ">a (broad) and b (thin)<"));
}

TEST_F(ResultsCommands, HelpHasExamples) {
  for (const std::string command : {"plot", "compare"}) {
    const Ended ended = run({command, "--help"});
    EXPECT_EQ(ended.status, 0);
    EXPECT_TRUE(contains(ended.out, "mbd " + command + " results/four_bar")) << ended.out;
  }
}

}  // namespace
}  // namespace mbd::test::test_compare
