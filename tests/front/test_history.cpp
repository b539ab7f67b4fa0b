// Results read back: what a table may be, what is refused and how, and choosing columns by name.

#include <gtest/gtest.h>

#include <fstream>

#include "libmbd/core/error.hpp"
#include "libmbd/results/history.hpp"
#include "tests/support/temporary_directory.hpp"

namespace mbd::test::test_history {
namespace {

namespace fs = std::filesystem;
using mbd::History;

class ReadHistory : public ::testing::Test {
 protected:
  fs::path file(const std::string& text) {
    std::ofstream(directory_ / "history.csv", std::ios::binary) << text;
    return directory_ / "history.csv";
  }
  std::string message(const fs::path& path) {
    try {
      read_history(path);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  void refused(const std::string& text, const std::string& place, const std::string& what) {
    const std::string path = file(text).string();
    const std::string got = message(path);
    EXPECT_TRUE(got.starts_with(path + place)) << got;
    EXPECT_NE(got.find(what), std::string::npos) << got;
  }

  const TemporaryDirectory scratch_;
  const fs::path directory_ = scratch_.path();
};

const std::string good =
    "# model: m\n# mbd 0.1.0\n# units: s, m, m, 1\ntime,C.displacement.1,C.displacement.2,E.total\n"
    "0,1,2,3\n0.5,-1e-3,2.5E2,4\n";

TEST_F(ReadHistory, ReadsWhatARunWrites) {
  file(good);
  const History h = read_history(directory_);
  ASSERT_EQ(h.columns.size(), 4u);
  EXPECT_EQ(h.columns[1].name, "C.displacement.1");
  EXPECT_EQ(h.columns[1].unit, "m");
  EXPECT_EQ(h.columns[3].unit, "");
  EXPECT_EQ(h.values[1], (std::vector<double>{1.0, -1e-3}));
  EXPECT_EQ(h.values[2], (std::vector<double>{2.0, 250.0}));
  EXPECT_EQ(h.lines, (std::vector<int>{5, 6}));
  EXPECT_TRUE(h.notes.empty());
}

TEST_F(ReadHistory, ReadsOtherTables) {
  const History h =
      read_history(file("\xEF\xBB\xBF\"x\" , y\r\n1, 2\r\n\r\n# remark\r\n3 ,+4.5\r\n5,6"));
  ASSERT_EQ(h.columns.size(), 2u);
  EXPECT_EQ(h.columns[0].name, "x");
  EXPECT_EQ(h.columns[1].name, "y");
  EXPECT_EQ(h.values[1], (std::vector<double>{2.0, 4.5, 6.0}));
  EXPECT_TRUE(h.notes.empty());
}

TEST_F(ReadHistory, LeavesOutALastLineThatIsCutShort) {
  for (const char* const rest : {"1,2", "1,2,3,4e", "1,2,3,4"}) {  // the last might have been 4.5
    const History h = read_history(file(good + rest));
    EXPECT_EQ(h.rows(), 2u) << rest;
    ASSERT_EQ(h.notes.size(), 1u) << rest;
    EXPECT_NE(h.notes[0].find("history.csv:7: the last line is cut short"), std::string::npos);
  }
  EXPECT_EQ(read_history(file("x,y\n1,2\n3")).rows(), 1u);
}

TEST_F(ReadHistory, UnitsOfAnotherNumberAreNotUsed) {
  const History h = read_history(file("# units: s\ntime,a\n0,1\n"));
  EXPECT_EQ(h.columns[0].unit, "");
  ASSERT_EQ(h.notes.size(), 1u);
}

TEST_F(ReadHistory, RefusesWhatIsNoTable) {
  refused("", ": ", "is empty");
  refused("# only\n", ": ", "is empty");
  refused("time,a\n", ": ", "has no rows");
  refused(std::string("a\0b\n", 4), ": ", "is not text");
  refused("0,1\n2,3\n", ":1: ", "column 1 is called 0, a number");
  refused("time,,a\n0,1,2\n", ":1: ", "column 2 has no name");
  refused("time,a,a\n0,1,2\n", ":1: ", "another column \"a\"");
  refused("time,a\n0,1\n1\n2,3\n", ":3: ", "has 1 cell, the header names 2 columns");
  refused("time,a\n0,1\n1,2,3\n", ":3: ", "has 3 cells");
  refused("time,a\n0,1\n1,x\n", ":3: ", "column \"a\" holds \"x\", not a finite number");
  for (const char* const cell : {"nan", "inf", "1e999", "", "1 2", "0x1p"})
    refused(std::string("time,a\n0,") + cell + "\n", ":2: ", "not a finite number");
  refused("<mbd name=\"m\">\n", ": ", "is a model, not the results of a run; run it first");
  refused("\n<!--\n" + std::string(5000, 'a') + "\n-->\n<mbd>\n", ": ", "is a model");
  refused("<svg xmlns=\"a\">\n", ": ", "is XML, not a table");
  EXPECT_NE(message(directory_ / "none").find("no such file"), std::string::npos);
  EXPECT_NE(message("/dev/null").find("neither a file nor a directory"), std::string::npos);
  fs::remove(directory_ / "history.csv");
  EXPECT_NE(message(directory_).find("there is no history.csv"), std::string::npos);
}

TEST_F(ReadHistory, ColumnsAreChosenByRecordQuantityOrName) {
  EXPECT_EQ(quantity_of("C.displacement.3"), "C.displacement");
  EXPECT_EQ(quantity_of("C.displacement"), "C.displacement");
  EXPECT_EQ(quantity_of("3"), "3");
  EXPECT_EQ(record_of("C.displacement.3"), "C");
  const History h =
      read_history(file("time,C.velocity.1,C.velocity.2,C.angle,D.velocity.1\n0,1,2,3,4\n"));
  using Chosen = std::vector<std::size_t>;
  const auto choose = [&](const std::vector<std::string>& names) {
    return choose_columns(h, names);
  };
  EXPECT_EQ(choose({}), (Chosen{1, 2, 3, 4}));
  EXPECT_EQ(choose({"C"}), (Chosen{1, 2, 3}));
  EXPECT_EQ(choose({"D", "C.velocity"}), (Chosen{4, 1, 2}));
  EXPECT_EQ(choose({"C.velocity.2", "C", "time"}), (Chosen{2, 1, 3, 0}));
  EXPECT_EQ(choose_column(h, "C.angle"), 3u);
  try {
    choose({"C.velocty"});
    FAIL();
  } catch (const Error& error) {
    const std::string got = error.what();
    EXPECT_NE(got.find("did you mean \"C.velocity\"? The records are: C, D"), std::string::npos)
        << got;
  }
  EXPECT_THROW(choose_column(h, "C.velocity"), Error);
  const History only_time = read_history(file("time\n0\n"));
  EXPECT_THROW(choose_columns(only_time, std::vector<std::string>{"C"}), Error);
}

}  // namespace
}  // namespace mbd::test::test_history
