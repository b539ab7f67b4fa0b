// Runs that are killed and go on: history.csv is that of a run that was not killed, to the last bit.
//
// Tried in the library, and killed: the count of steps begun at 1; the time of the next row not advanced.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "libmbd/run/run.hpp"
#include "tests/support/history_text.hpp"
#include "tests/support/read_text.hpp"
#include "tests/support/temporary_directory.hpp"

namespace mbd::test::test_restart {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

const std::string model = R"(
  <section name="s"><stiffness EA="1e5" GA2="4e4" GA3="4e4" GJ="80" EI2="100" EI3="60"/>
    <mass per_length="1.2" inertia="2e-3 1e-3 1e-3"/></section>
  <beam name="b" section="s" from="0 0 0" to="2 0 0" normal="0 0 1" elements="2" order="2"/>
  <revolute name="hub" between="ground b.start" axis="0 0 1"/>
  <controller name="c" period="7 ms">
    <pid name="u" error="0.5*sin(2*t)-hub.angle" proportional="60" integral="90" derivative="8" filter="0.02"/>
  </controller>
  <joint_torque joint="hub" moment="u-0.2*hub.rate"/>
  <load at="b.end" force="0 0 t&lt;0.11?3:1"/>
  <record name="tip" at="b.end" quantities="displacement velocity"/>
  <record name="hub" joint="hub" quantities="angle rate reaction_moment"/>
  <record name="all" quantities="total_energy work_of_loads"/>)";

// Kills the run after some rows, as Ctrl-C does.
class Killer final : public Observer {
 public:
  Killer(long rows, std::atomic<bool>& flag) : rows_(rows), flag_(flag) {}
  void accepted(const Sample&) override {
    if (++seen_ == rows_) flag_ = true;
  }

 private:
  long rows_, seen_ = 0;
  std::atomic<bool>& flag_;
};

RunReport run_in(const fs::path& directory, const Scene& scene, const std::string& every,
                 bool restart, long kill_at = 0) {
  RunOptions options;
  options.output = directory;
  if (!every.empty()) options.checkpoint_every = checkpoint_every(every);
  options.restart = restart;
  std::atomic<bool> flag = false;
  Killer killer(kill_at, flag);
  if (kill_at > 0) {
    options.observers.push_back(&killer);
    options.interrupted = &flag;
  }
  return run(scene, options);
}

TEST(Restart, IsTheSameToTheLastBit) {
  const TemporaryDirectory whole, killed;
  for (const char* settings :
       {R"(step="2 ms")", R"(step="5 ms" method="radau" output="4 ms")", R"(tolerance="1e-5")",
        R"(tolerance="1e-6" method="radau" output="6 ms")",
        R"(tolerance="1e-7" method="radau" stages="auto" output="6 ms")"})
    for (const char* every : {"9rows", "1e-9 s"}) {
      SCOPED_TRACE(fmt::format("{} {}", settings, every));
      const Scene scene = read(model + fmt::format(R"(<transient duration="0.3" {}/>)", settings));
      const RunReport first = run_in(whole.path(), scene, every, false);
      ASSERT_TRUE(first.complete()) << first.failure;
      EXPECT_FALSE(fs::exists(whole.path() / checkpoint_file));
      const std::string wanted = history_text(whole.path() / "history.csv");
      ASSERT_GT(first.rows, 30);
      if (std::string_view(every) !=
          "9rows") {  // whether they are due, and written, changes no digit
        ASSERT_TRUE(run_in(killed.path(), scene, "1h", false).complete());
        EXPECT_TRUE(history_text(killed.path() / "history.csv") == wanted);
      }
      // Killed twice, the second time in the part that went on.
      const std::string id = run_in(killed.path(), scene, every, false, 14).id;
      ASSERT_TRUE(fs::exists(killed.path() / checkpoint_file));
      EXPECT_FALSE(run_in(killed.path(), scene, "", true, 25).complete());
      ASSERT_TRUE(fs::exists(killed.path() / checkpoint_file));
      const RunReport last = run_in(killed.path(), scene, "", true);
      ASSERT_TRUE(last.complete()) << last.failure;
      EXPECT_EQ(last.id, id) << "it is the same run";
      EXPECT_EQ(last.rows, first.rows);
      EXPECT_TRUE(history_text(killed.path() / "history.csv") == wanted);
      EXPECT_NE(last.id, first.id);
      EXPECT_TRUE(text_of(killed.path() / "history.svg") == text_of(whole.path() / "history.svg"));
      EXPECT_EQ(last.energy_end.total(), first.energy_end.total());
      EXPECT_EQ(last.kinetic_most, first.kinetic_most);
      EXPECT_FALSE(fs::exists(killed.path() / checkpoint_file));
    }
}

// Found by a reviewer: a stop that is stiffer in an included file was taken for the same. Mutation: the model's own file alone.
TEST(Restart, LooksAtIncludedFiles) {
  const TemporaryDirectory directory;
  const fs::path file = directory.path() / "m.xml", results = directory.path() / "out";
  std::ofstream(file) << R"(<mbd name="m"><body name="m" at="1 0 0" mass="1" inertia="1 1 1"/>
      <revolute name="hinge" between="ground m" at="0 0 0" axis="0 1 0"/><include file="stop.xml"/>
      <gravity acceleration="0 0 -9.81"/><transient duration="0.2" step="1e-3"/>
      <record name="hinge" joint="hinge" quantities="angle"/></mbd>)";
  const auto scene_with = [&](int stiffness) {
    std::ofstream(directory.path() / "stop.xml") << fmt::format(
        R"(<mbd name="stop"><joint_spring name="stop" joint="hinge" moment="x > 1.5 ? {}*(x-1.5) : 0"/></mbd>)",
        stiffness);
    return read_model(file);
  };
  EXPECT_FALSE(run_in(results, scene_with(100), "5rows", false, 23).complete());
  const Scene stiffer = scene_with(1000);
  EXPECT_THROW(run_in(results, stiffer, "", true), Error);
  const Scene same = scene_with(100);
  EXPECT_TRUE(run_in(results, same, "", true).complete());
}

TEST(Restart, SaysWhatIsWrong) {
  const TemporaryDirectory directory;
  const fs::path& path = directory.path();
  const std::string end = R"(<transient duration="0.1" step="2 ms"/>)";
  const Scene scene = read(model + end);
  const auto said = [&](const Scene& other, const std::string& every = "", bool restart = true) {
    try {
      run_in(path, other, every, restart);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_SAYS(said(scene), "there is no checkpoint to go on from");
  EXPECT_FALSE(run_in(path, scene, "5rows", false, 23).complete());
  const std::string kept = text_of(path / checkpoint_file),
                    history = history_text(path / "history.csv");
  const auto put = [&](const std::string& bytes) {
    std::ofstream(path / checkpoint_file, std::ios::binary) << bytes;
  };
  EXPECT_SAYS(said(scene, "6rows"), "another --checkpoint-every");
  EXPECT_SAYS(said(read(model + R"(<transient duration="0.2" step="2 ms"/>)")), "of another model");
  EXPECT_SAYS(said(read(model + R"(<transient duration="0.1" step="1 ms"/>)")), "checkpoint.bin: ");
  EXPECT_SAYS(said(read(model + R"(<transient duration="0.1" step="2 ms" method="radau"/>)")),
              "checkpoint.bin: ");
  std::string heavier = model + end;
  heavier.replace(heavier.find("1.2"), 3, "1.3");
  EXPECT_SAYS(said(read(heavier)), "of another model");
  std::string other_gain = model + end;
  other_gain.replace(other_gain.find("integral=\"90\""), 13, "integral=\"91\"");
  EXPECT_SAYS(said(read(other_gain)), "of another model");
  put(kept.substr(0, kept.size() / 2));
  EXPECT_SAYS(said(scene), "is damaged");
  std::string changed = kept;
  changed[kept.size() / 3] = static_cast<char>(changed[kept.size() / 3] + 1);
  put(changed);
  EXPECT_SAYS(said(scene), "is damaged");
  put("");
  EXPECT_SAYS(said(scene), "is damaged");
  EXPECT_EQ(history_text(path / "history.csv"), history);  // nothing has been written over
  put(kept);
  EXPECT_EQ(said(scene), "no error");

  EXPECT_SAYS(said(read(model + R"(<transient duration="0.1" tolerance="1e-4" method="ida"/>)"),
                   "5rows", false),
              "method=\"ida\"");
  EXPECT_SAYS(said(read(model + end + "<motion_output/>"), "5rows", false), "<motion_output>");
  for (const char* text : {"", "10", "rows", "-3s", "2.5rows", "5 kg", "0min", "nan s"}) {
    SCOPED_TRACE(text);
    EXPECT_THROW(checkpoint_every(text), Error);
  }
  EXPECT_EQ(checkpoint_every("10min").seconds, 600.0);
  EXPECT_EQ(checkpoint_every("2 h").seconds, 7200.0);
  EXPECT_EQ(checkpoint_every("100rows").rows, 100);
}

}  // namespace
}  // namespace mbd::test::test_restart
