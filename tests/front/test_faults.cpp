// Faults of the system, one at a time (tests/faults): exit status and message are right, and files are whole or absent.
// Requests to end are seen from inside long work.
//
// What failed before: an allocation that fails was a bare "std::bad_alloc"; a request to end was looked at between rows
// only; two runs wrote one directory; a link in the results' place was written through; a certificate that fails was
// status 0; "...xml" wrote into results/...

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/file.h>

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>

#include "libmbd/core/error.hpp"
#include "libmbd/language/reader.hpp"
#include "libmbd/results/build_facts.hpp"
#include "libmbd/run/run.hpp"
#include "libmbd/text/files.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_directory.hpp"

namespace mbd::test::test_faults {
namespace {

namespace fs = std::filesystem;

std::string model_file(const char* name) {
  return std::string(MBD_SOURCE_DIR) + "/models/" + name + ".xml";
}

// ---- requests to end ---------------------------------------------------------------------------

// Work that takes T alone and is told to end at T/10 ends before 0.6 T.
void expect_stops(const Scene& scene) {
  const double begun = used_cpu();
  try {
    run(scene, {.estimate_error = false});
  } catch (const Error&) {
  }
  const double whole = used_cpu() - begun;
  std::atomic<bool> stop = false;
  const double again = used_cpu();
  std::jthread watch([&stop, again, whole](const std::stop_token& over) {
    while (used_cpu() < again + 0.1 * whole && !over.stop_requested())
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    stop = true;
  });
  std::string said;
  try {
    said = run(scene, {.estimate_error = false, .interrupted = &stop}).failure;
  } catch (const Error& error) {
    said = error.what();
  }
  EXPECT_NE(said.find("interrupted"), std::string::npos) << said;
  EXPECT_LT(used_cpu() - again, 0.6 * whole);
}

TEST(StopsSlow, InsideALoadStep) {
  expect_stops(read_model_text(
      R"(<mbd name="m"><section name="s"><stiffness EA="1e6" GA2="4e5" GA3="4e5" GJ="80" EI2="100" EI3="100"/></section>
      <beam name="b" section="s" from="0 0 0" to="1 0 0" normal="0 0 1" elements="4000"/>
      <fixed name="clamp" between="ground b.start"/><load at="b.end" force="0 0 -1000"/><static steps="1"/></mbd>)"));
}

TEST(StopsSlow, WhileLawsAreLookedThrough) {
  std::string law;
  for (int i = 1; i < 600; ++i) law += fmt::format("{}(t&lt;{}?0:1)", i > 1 ? "+" : "", i / 600.0);
  expect_stops(read_model_text(
      "<mbd name=\"m\"><body name=\"b\" mass=\"1\" inertia=\"1 1 1\"/><load at=\"b\" force=\"" +
      law + " 0 0\"/><transient duration=\"1\" step=\"0.1\"/></mbd>"));
}

// ---- files -------------------------------------------------------------------------------------

TEST(Directory, IsOfOneRunAtATime) {
  const TemporaryDirectory directory;
  const Scene scene = read_model(model_file("pendulum"));
  const fs::path out = directory.path() / "out";
  run(scene, {.output = out, .estimate_error = false});
  const std::string before = contents(out / "history.csv");
  {
    const DirectoryLock other(out);
    try {
      run(scene, {.output = out, .estimate_error = false});
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("another run is writing its results here"),
                std::string::npos)
          << error.what();
    }
    EXPECT_EQ(contents(out / "history.csv"), before);
  }
  EXPECT_TRUE(run(scene, {.output = out, .estimate_error = false}).complete());
}

TEST(Directory, HoldsNoModelThatResultsWouldReplace) {
  const TemporaryDirectory directory;
  fs::copy_file(model_file("pendulum"), directory.path() / "history.csv");
  const std::string before = contents(directory.path() / "history.csv");
  const Scene scene = read_model(directory.path() / "history.csv");
  EXPECT_THROW(run(scene, {.output = directory.path(), .estimate_error = false}), Error);
  EXPECT_EQ(contents(directory.path() / "history.csv"), before);
}

// Results that are links: what they show to stays as it is.
TEST(Directory, IsNotWrittenThroughLinks) {
  const TemporaryDirectory directory;
  const fs::path out = directory.path() / "out", mine = directory.path() / "mine";
  fs::create_directory(out);
  for (const char* const name : {"history.csv", "history.svg", "report.json"}) {
    write_file(mine, "mine\n");
    fs::remove(out / name);
    fs::create_symlink(mine, out / name);
    EXPECT_TRUE(run(read_model(model_file("pendulum")), {.output = out, .estimate_error = false})
                    .complete());
    EXPECT_FALSE(fs::is_symlink(out / name)) << name;
    EXPECT_EQ(contents(mine), "mine\n") << name;
  }
}

TEST(Directory, HasAName) {
  const TemporaryDirectory directory;
  fs::copy_file(model_file("pendulum"), directory.path() / "...xml");
  const Ended ended =
      Program({"run", (directory.path() / "...xml").string()}, directory.path() / "program").wait();
  EXPECT_EQ(ended.status, 1);
  EXPECT_NE(ended.err.find("no name of a directory for results"), std::string::npos) << ended.err;
}

// ---- verdicts ----------------------------------------------------------------------------------

// Half a step's worth of turns: the certificate fails, and so does the command, asked for it or not.
TEST(Verdict, OfACertificateIsTheExitStatus) {
  const TemporaryDirectory directory;
  for (const bool asked : {false, true}) {
    std::vector<std::string> arguments = {
        "run", model_file("double_pendulum"),      "--step", "0.1", "-q",
        "-o",  (directory.path() / "out").string()};
    if (asked) arguments.push_back("--certify");
    const Ended ended = Program(arguments, directory.path() / "program").wait();
    EXPECT_EQ(ended.status, 1) << ended.err;
    EXPECT_NE(ended.err.find("the certificate fails"), std::string::npos) << ended.err;
  }
}

}  // namespace
}  // namespace mbd::test::test_faults
