// mbd accuracy, as a user runs it: its files, wrong use, and Ctrl-C.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>

#include "tests/support/program.hpp"
#include "tests/support/shell.hpp"
#include "tests/support/this_build.hpp"

namespace mbd::test::test_accuracy_command {
namespace {

namespace fs = std::filesystem;

std::string model(const std::string& name) {
  return (fs::path(MBD_SOURCE_DIR) / "models" / (name + ".xml")).string();
}

class AccuracyCommand : public testing::Test {
 protected:
  Program start(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "accuracy");
    arguments.insert(arguments.end(), {"--out", (out_ / "out").string()});
    return {arguments, out_ / "program"};
  }
  Ended run(const std::vector<std::string>& arguments) { return start(arguments).wait(); }
  std::string file(const std::string& name) { return contents(out_ / "out" / name); }

  const TemporaryDirectory directory_;
  const fs::path out_ = directory_.path();
};

// The run with the least error is advised whatever it costs: noise of milliseconds does not choose.
TEST_F(AccuracyCommand, WritesPagePicturesAndData) {
  const Ended ended =
      run({model("pendulum"), "--quantity", "bob.position", "--vary", "method=radau",
           "tolerance=1e-2:1e-4", "--budget", "1e6", "--refinements", "6"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
  EXPECT_NE(ended.out.find("bob.position to 1e-5: radau, tolerance"), std::string::npos)
      << ended.out;
  for (const char* const name : {"accuracy.html", "accuracy.svg", "knobs.svg", "advice.md"})
    EXPECT_GT(file(name).size(), 100u) << name;
  const auto json = nlohmann::json::parse(file("accuracy.json"));
  EXPECT_EQ(json.at("points").size(), 3u);
  const std::string csv = file("accuracy.csv");
  std::size_t lines = 0;
  std::istringstream stream(csv);
  for (std::string line; std::getline(stream, line);) lines += line.starts_with("#") ? 0U : 1U;
  EXPECT_EQ(lines, 4u) << csv;
}

TEST_F(AccuracyCommand, SaysWhatIsWrong) {
  const auto expect = [&](const std::vector<std::string>& arguments, const std::string& part) {
    const Ended ended = run(arguments);
    EXPECT_EQ(ended.status, 1) << ended.out;
    EXPECT_NE(ended.err.find(part), std::string::npos) << ended.err;
    EXPECT_FALSE(fs::exists(out_ / "out" / "accuracy.html"));
  };
  expect({model("pendulum"), "--vary", "ordre=2"}, "did you mean \"order\"?");
  expect({model("pendulum"), "--vary", "order=2"}, "the model has no beams");
  expect({model("bend45"), "--vary", "step=1e-3"}, "the model has no <transient>");
  expect({model("pendulum"), "--quantity", "bib.position"}, "bib");
  expect({model("pendulum"), "--budget", "0"}, "--budget");
  expect({model("pendulum"), "--budget", "nan"}, "--budget");
  expect({model("pendulum"), "--refinements", "0"}, "--refinements");
  expect({model("pendulum"), "--refinements", "13"}, "--refinements");
  expect({model("pendulum"), "--reference", "none.csv"}, "none.csv");
  expect({"none.xml"}, "none.xml");
}

class AccuracyCommandSlow : public AccuracyCommand {};

TEST_F(AccuracyCommandSlow, InterruptedLeavesWhatIsDoneAndGoesOnFromThere) {
  const std::vector<std::string> arguments{model("chain"),        "--vary",   "method=radau",
                                           "tolerance=1e-2:1e-7", "--budget", "1e6",
                                           "--refinements",       "2"};
  Program program = start(arguments);
  const fs::path trials = out_ / "out" / "trials";
  const auto count = [&] {
    std::error_code code;
    std::size_t n = 0;
    for (const auto& entry : fs::directory_iterator(trials, code)) n += entry.exists() ? 1U : 0U;
    return n;
  };
  while (!program.ended() && count() < 4)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const std::size_t before = count();
  ASSERT_GE(before, 4u);
  program.signal(SIGINT);
  const Ended ended = program.wait();
  EXPECT_FALSE(ended.hung);
  // Interrupted before there was a reference it cannot say anything of accuracy; after that it writes what it has.
  EXPECT_TRUE(ended.status == 130 || ended.status == 1) << ended.status << ended.err;
  if (ended.status == 130) {
    EXPECT_GT(file("accuracy.html").size(), 100u);
    EXPECT_TRUE(nlohmann::json::accept(file("accuracy.json")));
  }
  const Ended again = run(arguments);
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_GT(count(), before);
  EXPECT_EQ(nlohmann::json::parse(file("accuracy.json")).at("points").size(), 6u);
}

// Started with SIGINT ignored (by nohup's like, or in the background), neither it nor its runs end by one.
TEST_F(AccuracyCommandSlow, ThatIsToIgnoreInterruptsIgnoresThem) {
  const Output output = shell(
      "setsid --wait bash -c " +
      quote("trap '' INT; " + quote(test::mbd_program) + " accuracy " + quote(model("pendulum")) +
            " --vary method=radau tolerance=1e-3 --budget 1e6 --refinements 2 --quiet --out " +
            quote((out_ / "out").string()) +
            " & while kill -0 $! 2>/dev/null; do kill -INT 0; sleep 0.01; done; wait $!"));
  EXPECT_EQ(output.status, 0) << output.text;
  const auto json = nlohmann::json::parse(file("accuracy.json"));
  EXPECT_EQ(json.at("points").size(), 1u);
}

}  // namespace
}  // namespace mbd::test::test_accuracy_command
